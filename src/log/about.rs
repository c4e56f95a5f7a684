//! `[about]` of a study of any kind: which robot its logs are of, and of which day. No diagnosis depends on it; a fleet's
//! table is sorted by it.

use std::path::Path;

use serde::Deserialize;

use super::day::Day;
use super::document::{Document, Text};
use super::error::LogError;

/// The table as it stands in the file.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawAbout {
    pub robot: Text,
    pub day: Text,
}

/// Whose logs a study has.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct About {
    /// The robot, as its people call it.
    pub robot: Option<String>,
    /// The day of all its logs.
    pub day: Option<Day>,
}

/// Checks the table.
pub(super) fn about(document: &Document<'_>, raw: &RawAbout) -> Result<About, LogError> {
    let wrong = |key: &str, text: &toml::Spanned<String>, expected: &str| {
        Err(document.wrong(key, text.span(), format!("\"{}\"", text.get_ref()), expected))
    };
    let robot = match &raw.robot {
        Some(name) if name.get_ref().trim().is_empty() => return wrong("[about] robot", name, "the robot's name"),
        name => name.as_ref().map(|name| name.get_ref().trim().to_owned()),
    };
    let day = match &raw.day {
        None => None,
        Some(text) => match Day::parse(text.get_ref()) {
            None => return wrong("[about] day", text, "a day such as \"2026-03-01\""),
            day => day,
        },
    };
    Ok(About { robot, day })
}

/// The table `[about]` of a study of any kind; nothing where it has none.
///
/// # Errors
/// [`LogError`] where the file cannot be read or is no TOML, or the table is wrong.
pub fn read_about(path: &Path) -> Result<About, LogError> {
    #[derive(Deserialize)]
    struct Only {
        #[serde(default)]
        about: RawAbout,
    }
    let document = Document::open(path)?;
    let only: Only = document.parse_any()?;
    about(&document, &only.about)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<About, LogError> {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("study.toml");
        std::fs::write(&file, text).unwrap();
        read_about(&file)
    }

    #[test]
    fn robot_and_day_are_read_beside_anything() {
        let found = read("schema = 1\n[joint]\n[about]\nrobot = \" dog-07 \"\nday = \"2026-03-01\"\n").unwrap();
        assert_eq!(found, About { robot: Some("dog-07".to_owned()), day: Day::parse("2026-03-01") });
        assert_eq!(read("schema = 1\n").unwrap(), About::default());
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line_and_key() {
        for (text, key) in [
            ("[about]\nday = \"1 March\"\n", "[about] day"),
            ("[about]\nrobot = \" \"\n", "[about] robot"),
            ("[about]\nowner = \"me\"\n", "owner"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(key) && error.contains("line 2"), "{error}");
        }
    }
}
