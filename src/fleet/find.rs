//! Which studies there are.

use super::FleetError;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A study, and the folder below which its path says whose it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Found {
    /// As the user named it.
    pub path: PathBuf,
    /// The part of its pattern before the first wildcard; of studies named one by one the folder that has all of them.
    pub base: PathBuf,
}

/// The studies of all patterns, each once, in the order of their paths.
pub(super) fn find(patterns: &[String]) -> Result<Vec<Found>, FleetError> {
    let mut found: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
    let mut one_by_one: Vec<PathBuf> = Vec::new();
    for pattern in patterns {
        let wrong = |what: &str| FleetError::Pattern { pattern: pattern.clone(), what: what.to_owned() };
        let path = Path::new(pattern);
        if path.is_file() {
            one_by_one.push(path.to_path_buf());
            continue;
        }
        if path.is_dir() {
            return Err(wrong("a folder"));
        }
        let matched = glob::glob(pattern).map_err(|error| wrong(error.msg))?;
        let base: PathBuf =
            path.components().take_while(|part| !has_wildcard(&part.as_os_str().to_string_lossy())).collect();
        let before = found.len();
        let mut is_known = false;
        // A folder that may not be entered has no studies.
        for study in matched.filter_map(Result::ok).filter(|study| study.is_file()) {
            is_known |= found.contains_key(&study);
            found.entry(study).or_insert_with(|| base.clone());
        }
        if found.len() == before && !is_known {
            return Err(FleetError::Nothing { pattern: pattern.clone() });
        }
    }
    let base = common_folder(&one_by_one);
    for study in one_by_one {
        found.entry(study).or_insert_with(|| base.clone());
    }
    Ok(found.into_iter().map(|(path, base)| Found { path, base }).collect())
}

/// A pattern as it is written in a shell.
pub(super) fn in_shell(pattern: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '/' | '.' | '-' | '_');
    if pattern.chars().all(is_plain) { pattern.to_owned() } else { format!("'{}'", pattern.replace('\'', "'\\''")) }
}

fn has_wildcard(part: &str) -> bool {
    part.contains(['*', '?', '['])
}

/// The folder that has all files.
fn common_folder(files: &[PathBuf]) -> PathBuf {
    let mut folders = files.iter().filter_map(|file| file.parent());
    let Some(first) = folders.next() else { return PathBuf::new() };
    folders.fold(first.to_path_buf(), |common, folder| {
        let shared = common.components().zip(folder.components()).take_while(|(a, b)| a == b);
        shared.map(|(part, _)| part).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn patterns_find_each_study_once_and_know_where_their_wildcards_begin() {
        let dir = tempfile::tempdir().unwrap();
        let at = |path: &str| dir.path().join(path);
        for path in ["logs/a/1/study.toml", "logs/b/study.toml", "logs/b/other.toml"] {
            fs::create_dir_all(at(path).parent().unwrap()).unwrap();
            fs::write(at(path), "").unwrap();
        }
        let word = |path: &str| at(path).to_string_lossy().into_owned();
        let found = find(&[word("logs/**/study.toml"), word("logs/b/*.toml")]).unwrap();
        let base = [at("logs"), at("logs"), at("logs/b")];
        let paths = [at("logs/a/1/study.toml"), at("logs/b/study.toml"), at("logs/b/other.toml")];
        let mut expected: Vec<Found> = paths.into_iter().zip(base).map(|(path, base)| Found { path, base }).collect();
        expected.sort_by(|a, b| a.path.cmp(&b.path));
        assert_eq!(found, expected);
        let named = find(&[word("logs/a/1/study.toml"), word("logs/b/study.toml")]).unwrap();
        assert!(named.iter().all(|study| study.base == at("logs")), "{named:?}");
    }

    #[test]
    fn a_pattern_is_quoted_where_a_shell_would_take_it_apart() {
        assert_eq!(in_shell("logs/a-1/study.toml"), "logs/a-1/study.toml");
        assert_eq!(in_shell("logs/**/it's.toml"), "'logs/**/it'\\''s.toml'");
    }

    #[test]
    fn what_matches_nothing_is_said_with_what_was_expected() {
        let dir = tempfile::tempdir().unwrap();
        let word = |path: &str| dir.path().join(path).to_string_lossy().into_owned();
        for (pattern, said) in [
            (word("absent/*.toml"), "no such study"),
            (word("absent.toml"), "no such study"),
            (word(""), "a folder"),
            (word("a***b"), "'logs/**/study.toml'"),
        ] {
            let error = find(std::slice::from_ref(&pattern)).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
