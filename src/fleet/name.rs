//! What a study's answer is called.

use crate::log::sha256;
use std::path::Path;

/// Characters of a path that are kept, from its end.
const LONGEST: usize = 80;
/// Digits of the hash of the whole path.
const DIGITS: usize = 8;

/// The path with everything but letters, digits, dots and underscores as `-`, and a part of its hash: two paths never
/// share a name.
pub(super) fn name(path: &Path) -> String {
    let stem = path.with_extension("");
    let plain = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '_' | '.') { c } else { '-' };
    let slug: String = stem.to_string_lossy().chars().map(plain).collect();
    let from = slug.len().saturating_sub(LONGEST);
    let hash = sha256(path.as_os_str().as_encoded_bytes());
    format!("{}-{}", slug[from..].trim_start_matches(['-', '.']), &hash[..DIGITS])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_tell_paths_apart() {
        let of = |path: &str| name(Path::new(path));
        assert!(of("logs/dog 7/../study.toml").starts_with("logs-dog-7-..-study-"));
        assert!(of("/logs/ä/study.toml").starts_with("logs---study-"));
        assert_ne!(of("a/b.toml"), of("a-b.toml"));
        assert!(of(&"x/".repeat(400)).len() <= LONGEST + 1 + DIGITS);
    }
}
