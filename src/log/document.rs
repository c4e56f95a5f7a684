//! A TOML file at hand: parsing it, and errors that point into it.

use std::f64::consts::TAU;
use std::fs;
use std::ops::Range;
use std::path::Path;

use serde::de::DeserializeOwned;
use toml::Spanned;

use super::error::LogError;
use super::place::{Place, Subject};
use super::rows::not_text;

/// A number of a file, and where it stands.
pub(crate) type Number = Option<Spanned<f64>>;
/// A text of a file, and where it stands.
pub(crate) type Text = Option<Spanned<String>>;

pub(crate) struct Document<'a> {
    pub(crate) file: &'a Path,
    text: String,
    /// Logs that need not be files.
    at_hand: Vec<String>,
}

/// What a number has to be.
#[derive(Clone, Copy)]
pub(crate) struct Range64 {
    ok: fn(f64) -> bool,
    largest: f64,
    expected: &'static str,
}

impl Range64 {
    /// What is said of it where a value is no number at all.
    pub(super) fn expected(&self) -> &'static str {
        self.expected
    }
}

/// Zero or above; the key's unit is in the format.
pub(crate) const NOT_NEGATIVE: Range64 = range(|x| x >= 0.0, "a number not below 0");
pub(crate) const POSITIVE: Range64 = range(|x| x > 0.0, "a number above 0");
/// A sampling period \[s\].
pub(crate) const PERIOD: Range64 =
    range(|x| x > 0.0 && x < 0.5, "a period above 0 and below 0.5 s; a larger one looks like milliseconds");
/// An angle \[rad\].
pub(crate) const ANGLE: Range64 =
    range(|x| x.abs() <= TAU, "an angle within 2 pi (6.283) rad; a larger one looks like degrees");
pub(crate) const FINITE: Range64 = range(|_| true, "a finite number");

pub(crate) const fn range(ok: fn(f64) -> bool, expected: &'static str) -> Range64 {
    Range64 { ok, largest: f64::MAX, expected }
}

/// A finite number of at most this magnitude.
pub(crate) const fn finite_within(largest: f64, expected: &'static str) -> Range64 {
    Range64 { ok: |_| true, largest, expected }
}

impl<'a> Document<'a> {
    /// The text, without a byte order mark; spans count its bytes.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// A text that is at hand.
    pub(crate) fn of_text(file: &'a Path, text: &str) -> Self {
        Self { file, text: text.strip_prefix('\u{feff}').unwrap_or(text).to_owned(), at_hand: Vec::new() }
    }

    /// The same with logs that are at hand by name.
    pub(super) fn with_logs(self, names: impl IntoIterator<Item = String>) -> Self {
        Self { at_hand: names.into_iter().collect(), ..self }
    }

    /// Whether a log of this name is at hand.
    pub(super) fn has_at_hand(&self, name: &str) -> bool {
        self.at_hand.iter().any(|other| other == name)
    }

    pub(crate) fn open(file: &'a Path) -> Result<Self, LogError> {
        let bytes = fs::read(file).map_err(|source| LogError::Read { file: file.to_path_buf(), source })?;
        if let Some(found) = not_text(&bytes) {
            let error = log_as_study(file);
            return Err(error.unwrap_or_else(|| LogError::NotText { file: file.to_path_buf(), found }));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Self::of_text(file, &text)),
            Err(error) => {
                let at = error.utf8_error().valid_up_to();
                let byte = error.as_bytes().get(at).copied().unwrap_or(0);
                let text = String::from_utf8_lossy(error.as_bytes());
                let at = Box::new(Place::in_text(file, &text, at..at + 1, Subject::Line));
                Err(LogError::NotUtf8 { at, byte })
            }
        }
    }

    /// Refuses robot studies and reads the rest.
    pub(crate) fn parse<T: DeserializeOwned>(&self) -> Result<T, LogError> {
        let whole: Result<toml::Table, _> = toml::from_str(&self.text);
        if whole.is_ok_and(|table| table.contains_key("robot")) {
            let from = self.text.find("[robot").or_else(|| self.text.find("robot")).unwrap_or(0);
            let at = Box::new(Place::in_text(self.file, &self.text, from..from + "[robot]".len(), Subject::Line));
            return Err(LogError::RobotStudy { at });
        }
        self.parse_any()
    }

    /// Reads whatever it is.
    pub(crate) fn parse_any<T: DeserializeOwned>(&self) -> Result<T, LogError> {
        toml::from_str(&self.text).map_err(|source| {
            if let Some(error) = log_as_study(self.file) {
                return error;
            }
            let message = source.message();
            let hint = if self.text.trim_start().starts_with('<') {
                Some(
                    "this is XML; URDF and MJCF are read by `dynamics --robot`, `walk --robot`, and studies and specs that name \
                     them; a study is written by `aibo-fit init LOG --robot FILE`",
                )
            } else if message.contains("expected a sequence") {
                Some("a log is written with double brackets: [[log]]")
            } else if message.contains("escape") {
                Some("write paths with / or in single quotes")
            } else if message.contains("expected f64") || message.contains("floating point") {
                Some("write the number without quotes and with a decimal point")
            } else {
                None
            };
            LogError::Toml { file: self.file.to_path_buf(), source: Box::new(source), hint }
        })
    }

    pub(crate) fn missing(&self, key: impl Into<String>, expected: impl Into<String>) -> LogError {
        LogError::MissingKey { file: self.file.to_path_buf(), key: key.into(), expected: expected.into() }
    }

    pub(crate) fn place(&self, key: &str, span: Range<usize>) -> Box<Place> {
        Box::new(Place::in_text(self.file, &self.text, span, Subject::Key(key.to_owned())))
    }

    pub(crate) fn wrong(&self, key: &str, span: Range<usize>, found: impl Into<String>, expected: &str) -> LogError {
        LogError::Value { at: self.place(key, span), found: found.into(), expected: expected.to_owned() }
    }

    /// A number that may be absent.
    pub(crate) fn number(&self, key: &str, value: &Number, range: Range64) -> Result<Option<f64>, LogError> {
        let Some(spanned) = value else { return Ok(None) };
        self.within(key, spanned.span(), *spanned.get_ref(), range).map(Some)
    }

    /// A number that is there.
    pub(crate) fn within(&self, key: &str, span: Range<usize>, number: f64, range: Range64) -> Result<f64, LogError> {
        if number.is_finite() && number.abs() <= range.largest && (range.ok)(number) {
            Ok(number)
        } else {
            Err(self.wrong(key, span, number.to_string(), range.expected))
        }
    }

    /// A number that has to be there.
    pub(crate) fn needed(&self, key: &str, value: &Number, range: Range64) -> Result<f64, LogError> {
        self.number(key, value, range)?.ok_or_else(|| self.missing(key, range.expected))
    }

    /// One of several words; `None` where the key is absent.
    pub(crate) fn word<T: Copy>(&self, key: &str, value: &Text, words: &[(&str, T)]) -> Result<Option<T>, LogError> {
        let Some(spanned) = value else { return Ok(None) };
        match words.iter().find(|(word, _)| word == spanned.get_ref()) {
            Some((_, meaning)) => Ok(Some(*meaning)),
            None => Err(self.wrong(key, spanned.span(), format!("\"{}\"", spanned.get_ref()), &one_of(words))),
        }
    }

    /// One of several words that has to be there.
    pub(crate) fn needed_word<T: Copy>(&self, key: &str, value: &Text, words: &[(&str, T)]) -> Result<T, LogError> {
        self.word(key, value, words)?.ok_or_else(|| self.missing(key, one_of(words)))
    }
}

/// What files of logs end in, which no study does.
const OF_LOGS: [&str; 7] = ["csv", "db3", "mcap", "bag", "npz", "npy", "parquet"];

/// What to say of a file that is no document, where its name is that of a log.
fn log_as_study(file: &Path) -> Option<LogError> {
    let ending = file.extension()?;
    let is_log = OF_LOGS.iter().any(|of| ending.eq_ignore_ascii_case(of));
    is_log.then(|| LogError::LogAsStudy { file: file.to_path_buf() })
}

fn one_of<T>(words: &[(&str, T)]) -> String {
    let quoted: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
    quoted.join(" or ")
}
