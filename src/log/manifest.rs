//! Which files of a folder are one report's, so that the next report there leaves nothing of the last behind.
//!
//! The folder keeps a list, [`MANIFEST_FILE`], of what was written for a page with a digest of each file. The next run
//! that writes the same page removes what is on the list and what it does not write itself. A file is removed only
//! where it lies inside the folder and still is, byte for byte, what was written; anything else is somebody's own.

use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

/// Name of the list in a folder of results.
pub const MANIFEST_FILE: &str = ".aibo-fit.toml";

/// Files by their path within the folder, with their SHA-256 digests in hexadecimal.
type Files = BTreeMap<String, String>;

/// Files by the page that they belong to.
type Pages = BTreeMap<String, Files>;

/// SHA-256 of some bytes in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The list of a folder. One that cannot be read lists nothing, and so nothing is removed by it.
fn read(folder: &Path) -> Pages {
    let text = fs::read_to_string(folder.join(MANIFEST_FILE));
    text.ok().and_then(|text| toml::from_str(&text).ok()).unwrap_or_default()
}

/// Files of a page that were written into its folder, by their path within it.
pub(super) fn files_of<'a>(page: &Path, written: impl Iterator<Item = (&'a Path, &'a Vec<u8>)>) -> Files {
    let folder = page.parent().unwrap_or(Path::new(""));
    let within = |path: &Path| Some(path.strip_prefix(folder).ok()?.to_str()?.replace('\\', "/"));
    written.filter_map(|(path, content)| Some((within(path)?, sha256(content)))).collect()
}

/// Removes what an earlier run listed for a page and this one has not written, and gives the new list.
///
/// `kept` are files that stay whatever the list says: all that this run wrote or read.
///
/// # Errors
/// The file that could not be removed, and why.
pub(super) fn replace<'a>(
    page: &Path,
    files: Files,
    kept: impl Iterator<Item = &'a Path>,
) -> Result<String, (PathBuf, io::Error)> {
    let folder = super::write::folder_of(page);
    let name = page.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut pages = read(folder);
    let earlier = pages.insert(name, files.clone()).unwrap_or_default();
    // What another page of the folder lists as well stays with that page.
    let listed: BTreeSet<&String> = pages.values().flat_map(BTreeMap::keys).collect();
    let kept: BTreeSet<PathBuf> = kept.filter_map(|path| path.canonicalize().ok()).collect();
    for (path, digest) in earlier.iter().filter(|(path, _)| !listed.contains(path)) {
        if let Some(path) = removable(folder, path, digest).filter(|path| !kept.contains(path)) {
            fs::remove_file(&path).map_err(|source| (path.clone(), source))?;
            remove_empty_above(&path, folder);
        }
    }
    let list = toml::to_string(&pages).expect("a table of tables of strings is TOML");
    Ok(format!("# Files that aibo-fit wrote here: a later run removes those that it does not write again.\n{list}"))
}

/// Removes the folders between a removed file and `folder` as far as nothing else is in them.
fn remove_empty_above(file: &Path, folder: &Path) {
    let Ok(folder) = folder.canonicalize() else { return };
    let mut between = file.ancestors().skip(1).take_while(|above| *above != folder);
    while between.next().is_some_and(|above| fs::remove_dir(above).is_ok()) {}
}

/// A listed file in full, where it lies inside the folder and is what was written.
fn removable(folder: &Path, listed: &str, written: &str) -> Option<PathBuf> {
    let listed = Path::new(listed);
    if !listed.components().all(|part| matches!(part, Component::Normal(_))) {
        return None;
    }
    let path = folder.join(listed);
    let is_file = fs::symlink_metadata(&path).is_ok_and(|meta| meta.is_file());
    let path = is_file.then(|| path.canonicalize().ok()).flatten()?;
    let is_inside = folder.canonicalize().is_ok_and(|folder| path.starts_with(folder));
    (is_inside && sha256(&fs::read(&path).ok()?) == written).then_some(path)
}
