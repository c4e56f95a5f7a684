//! Which format a file has: by what is in it, not by what it is called.

use super::error::DescriptionError;
use super::{Description, MOST_JOINTS, mjcf, urdf, xml};
use crate::geometry::RobotTables;
use crate::log::LogError;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

/// A format of robot descriptions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Our own, that of `data/ers7.toml`.
    Toml,
    /// ROS's.
    Urdf,
    /// MuJoCo's.
    Mjcf,
}

/// Bytes beyond which no file is read; meshes stand in files of their own.
const LARGEST: u64 = 1 << 26;

impl Format {
    /// The format of a file.
    ///
    /// # Errors
    /// [`DescriptionError::File`]; [`DescriptionError::Whole`] for a format that is not read here.
    pub fn of_file(file: &Path) -> Result<Self, DescriptionError> {
        Self::of_bytes(&bytes(file)?).map_err(|what| DescriptionError::Whole { file: file.to_path_buf(), what })
    }

    /// What is no XML is left to the reader of TOML, and what is wrong with it.
    fn of_bytes(bytes: &[u8]) -> Result<Self, String> {
        let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        if start.is_empty() {
            return Err("the file is empty, expected a robot as URDF, MJCF or TOML".into());
        }
        if start.starts_with(b"#usda") || start.starts_with(b"PXR-USDC") {
            return Err("this is USD, which is not supported; export the robot as URDF or MJCF".into());
        }
        if !start.starts_with(b"<") {
            return Ok(Self::Toml);
        }
        match root_tag(&String::from_utf8_lossy(start)) {
            "robot" => Ok(Self::Urdf),
            "mujoco" => Ok(Self::Mjcf),
            "mujocoinclude" => Err("this is a part of an MJCF for others to include; give the file that does".into()),
            "sdf" | "gazebo" => Err("this is SDF, which is not supported; export the robot as URDF or MJCF".into()),
            tag if tag.starts_with("xacro:") => Err(xacro_hint("this is xacro, which is not supported")),
            "" => Err("found XML without an element, expected <robot> (URDF) or <mujoco> (MJCF)".into()),
            tag => Err(format!("found the root element <{tag}>, expected <robot> (URDF) or <mujoco> (MJCF)")),
        }
    }
}

/// What to do with xacro.
pub(super) fn xacro_hint(what: &str) -> String {
    format!("{what}; expand it first: xacro FILE > robot.urdf")
}

/// The name of the first element of a text.
fn root_tag(mut text: &str) -> &str {
    loop {
        let Some(open) = text.find('<') else { return "" };
        text = &text[open + 1..];
        let end = match () {
            () if text.starts_with("!--") => text.find("-->"),
            () if text.starts_with(['!', '?']) => text.find('>'),
            () => {
                let end = text.find(|c: char| c.is_whitespace() || c == '>' || c == '/').unwrap_or(text.len());
                return &text[..end];
            }
        };
        match end {
            Some(end) => text = &text[end..],
            None => return "",
        }
    }
}

fn bytes(file: &Path) -> Result<Vec<u8>, DescriptionError> {
    let unread = |source| LogError::Read { file: file.to_path_buf(), source };
    let mut bytes = Vec::new();
    // A device has no length that could be asked for.
    let opened = std::fs::File::open(file).map_err(unread)?;
    opened.take(LARGEST + 1).read_to_end(&mut bytes).map_err(unread)?;
    if bytes.len() as u64 > LARGEST {
        let what = format!("larger than {} MiB, expected a robot description", LARGEST >> 20);
        return Err(DescriptionError::Whole { file: file.to_path_buf(), what });
    }
    Ok(bytes)
}

/// The text of an XML file, and a warning where it had to be guessed at.
pub(super) fn text(file: &Path) -> Result<(String, Option<String>), DescriptionError> {
    let mut bytes = bytes(file)?;
    // A C string's end at the end of a file stands in files that are in use.
    let text_end = bytes.trim_ascii_end().strip_suffix(b"\0").map(<[u8]>::len);
    bytes.truncate(text_end.unwrap_or(bytes.len()));
    if bytes.contains(&0) {
        let what = "bytes that no text has, expected XML in UTF-8".to_owned();
        return Err(DescriptionError::Whole { file: file.to_path_buf(), what });
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok((text, None)),
        Err(error) => {
            let text = error.as_bytes().iter().map(|byte| char::from(*byte)).collect();
            Ok((text, Some(format!("{}: not UTF-8; read as Latin-1", file.display()))))
        }
    }
}

/// Reads a file of any format.
pub(super) fn read(file: &Path) -> Result<Description, DescriptionError> {
    let mut read = match Format::of_file(file)? {
        Format::Toml => Description::of_tables(&RobotTables::read(file)?, file),
        format => {
            let (text, warning) = text(file)?;
            let root = xml::parse(&Arc::from(file), &text)?;
            let mut read = if format == Format::Urdf { urdf::read(file, &root)? } else { mjcf::read(file, root)? };
            read.warnings.splice(0..0, warning);
            read
        }
    };
    if read.joints.len() > MOST_JOINTS {
        let what = format!("{} joints, expected at most {MOST_JOINTS}", read.joints.len());
        return Err(DescriptionError::Whole { file: file.to_path_buf(), what });
    }
    read.check();
    Ok(read)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_known_by_their_content() {
        let of = |text: &str| Format::of_bytes(text.as_bytes());
        assert_eq!(of("schema = 1\n"), Ok(Format::Toml));
        assert_eq!(of("\u{feff}\n<?xml version='1.0'?><!-- <mujoco> --> <robot name='a'/>"), Ok(Format::Urdf));
        assert_eq!(of("<!DOCTYPE x><mujoco/>"), Ok(Format::Mjcf));
        assert!(of("<mujocoinclude/>").unwrap_err().contains("give the file that does"));
        assert!(of("<sdf version='1.7'/>").unwrap_err().contains("SDF"));
        assert!(of("<xacro:macro/>").unwrap_err().contains("xacro FILE > robot.urdf"));
        assert!(of(" \n").unwrap_err().contains("the file is empty"));
        assert!(of("<!-- nothing").unwrap_err().contains("expected <robot>"));
        assert!(of("<html>").unwrap_err().contains("<html>"));
    }
}
