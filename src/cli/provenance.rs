//! Where a result comes from: version, command line, hashes of the inputs.

use crate::log::LogError;
use crate::report::Provenance;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::OnceLock;

/// The command line after the program's name.
static WORDS: OnceLock<Vec<String>> = OnceLock::new();
/// Options that say where results go and how fast they come, not what they are; those of the first kind have a value.
const WITH_VALUE: [&str; 3] = ["--json", "--out", "--threads"];
const ALONE: [&str; 2] = ["--quiet", "-q"];

/// Remembers the command line.
pub(super) fn remember(words: &[OsString]) {
    let _ = WORDS.set(words.iter().skip(1).map(|word| word.to_string_lossy().into_owned()).collect());
}

/// Hashes the input files in their order.
///
/// # Errors
/// [`LogError::Read`] where a file has gone since it was read.
pub(super) fn provenance(inputs: impl IntoIterator<Item = PathBuf>) -> Result<Provenance, LogError> {
    let words = WORDS.get().map_or(&[][..], Vec::as_slice);
    Provenance::of(format!("aibo-fit {}", telling(words).join(" ")), inputs)
}

/// The words that say what a result is: the same question has the same answer wherever that is written.
fn telling(words: &[String]) -> Vec<&str> {
    let mut told = Vec::with_capacity(words.len());
    let mut words = words.iter().map(String::as_str);
    while let Some(word) = words.next() {
        let is_joined =
            WITH_VALUE.iter().any(|option| word.strip_prefix(option).is_some_and(|rest| rest.starts_with('=')));
        if WITH_VALUE.contains(&word) {
            words.next();
        } else if !is_joined && !ALONE.contains(&word) {
            told.push(word);
        }
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_results_go_is_no_part_of_what_they_are() {
        let words = ["gap", "study.toml", "--json", "a.json", "--out=b", "-q", "--without", "delay", "--threads", "2"];
        let words = words.map(str::to_owned);
        assert_eq!(telling(&words), ["gap", "study.toml", "--without", "delay"]);
    }
}
