//! Options that every command has.

use super::CliError;
use crate::log::Outputs;
use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser, ValueParser};
use serde::Serialize;
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

/// Where results go, and how the program behaves.
#[derive(Args, Debug)]
pub(super) struct CommonArgs {
    /// Write everything that was found as JSON to this file
    #[arg(long, value_name = "FILE", value_parser = file_to_write())]
    pub json: Option<PathBuf>,
    /// Folder for report, figures and other files [default: one in fits/ named after log, study or command; check, dynamics and
    /// gate write none unasked]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Worker threads; the results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No text on standard output, no progress
    #[arg(long, short)]
    pub quiet: bool,
}

impl CommonArgs {
    /// Runs the work on the threads asked for.
    pub fn on_threads<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Result<R, CliError> {
        let Some(threads) = self.threads else { return Ok(work()) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build();
        Ok(pool.map_err(|error| CliError::Threads(error.to_string()))?.install(work))
    }

    /// The output folder: as asked for, or `fits/<name>`.
    pub fn folder(&self, name: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| Path::new("fits").join(name))
    }

    /// Adds the JSON where it was asked for.
    pub fn add_json(&self, outputs: &mut Outputs, value: &impl Serialize) -> Result<(), CliError> {
        if let Some(path) = &self.json {
            outputs.add_apart(path, json_text(value)?);
        }
        Ok(())
    }
}

/// What reads the name of a file to be written: `-` would be a file called so, and is meant for standard output.
pub(super) fn file_to_write() -> ValueParser {
    let named = |path: PathBuf| match path.as_os_str() == "-" {
        true => Err("expected the name of a file; standard output is for the text"),
        false => Ok(path),
    };
    ValueParser::new(PathBufValueParser::new().try_map(named))
}

/// A value as indented JSON.
pub(super) fn json_text(value: &impl Serialize) -> Result<String, CliError> {
    let text = serde_json::to_string_pretty(value).map_err(|error| CliError::Encode(error.to_string()))?;
    Ok(text + "\n")
}

/// Writes all results or none; a result never takes the place of a file that was read, nor of another result.
pub(super) fn write_outputs(mut outputs: Outputs, inputs: &[PathBuf]) -> Result<(), CliError> {
    refuse_overwriting(outputs.paths(), inputs)?;
    refuse_sharing(outputs.paths())?;
    outputs.keep(inputs);
    Ok(outputs.write()?)
}

/// Refuses, before a long run, what [`write_outputs`] would refuse after it.
pub(super) fn refuse_clashes(results: &[PathBuf], inputs: &[PathBuf]) -> Result<(), CliError> {
    refuse_overwriting(results.iter().map(PathBuf::as_path), inputs)?;
    refuse_sharing(results.iter().map(PathBuf::as_path))
}

/// Refuses to write where a file was read.
pub(super) fn refuse_overwriting<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: &[PathBuf],
) -> Result<(), CliError> {
    let read: Vec<(&PathBuf, PathBuf)> = inputs.iter().filter_map(|i| Some((i, i.canonicalize().ok()?))).collect();
    for path in outputs {
        let there = path.canonicalize().ok();
        if let Some((input, _)) = read.iter().find(|(_, input)| there.as_ref() == Some(input)) {
            return Err(CliError::Overwrites { input: (*input).clone() });
        }
    }
    Ok(())
}

/// Refuses to write two results to one file, whether it is there or not; a device or a pipe takes them all.
fn refuse_sharing<'a>(outputs: impl IntoIterator<Item = &'a Path>) -> Result<(), CliError> {
    let mut taken = BTreeSet::new();
    for path in outputs {
        let place = place(path);
        let is_file = place.is_file() || !place.exists();
        if is_file && !taken.insert(place) {
            let path = path.display();
            let why =
                "two results would be written to this file; name another for one of them, or choose another --out";
            return Err(CliError::Usage(format!("{path}: {why}")));
        }
    }
    Ok(())
}

/// Where a file is or would be: from the root on, without `.` and `..`, what is there of the way by its own name.
fn place(path: &Path) -> PathBuf {
    let mut place = PathBuf::new();
    for part in std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()).components() {
        if part == Component::ParentDir {
            place.pop();
        } else {
            place.push(part);
        }
        place = place.canonicalize().unwrap_or(place);
    }
    place
}

/// Why a result could not be printed.
static NOT_PRINTED: OnceLock<io::Error> = OnceLock::new();

/// Prints a result; a reader that has gone away (a closed pipe) is no error, anything else is found by [`printed`].
pub(super) fn print(text: &str) {
    let mut out = io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush())
        && error.kind() != io::ErrorKind::BrokenPipe
    {
        // the first one is told
        let _ = NOT_PRINTED.set(error);
    }
}

/// Whether all results could be printed.
///
/// # Errors
/// [`CliError::Print`] with what the system said.
pub(super) fn printed() -> Result<(), CliError> {
    NOT_PRINTED.get().map_or(Ok(()), |error| Err(CliError::Print(error.to_string())))
}

/// Says on stderr what looks like a mistake.
pub(super) fn warn(text: &str) {
    let _ = writeln!(io::stderr().lock(), "warning: {text}");
}

/// Name for the output of a study: its folder's, or the file's own where it lies in the working folder.
pub(super) fn study_name(study: &Path) -> String {
    let folder = study.parent().and_then(Path::file_name).or(study.file_stem());
    folder.map_or_else(|| "study".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// A log's name without folder and extension.
pub(super) fn log_name(log: &Path) -> String {
    log.file_stem().map_or_else(|| "log".to_owned(), |name| name.to_string_lossy().into_owned())
}
