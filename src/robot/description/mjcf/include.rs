//! `<include>`: the elements of another file in the place of the element.

use crate::robot::description::error::DescriptionError;
use crate::robot::description::format;
use crate::robot::description::xml::{Element, parse};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files that one description may include.
const MOST_FILES: usize = 256;

/// The element with all its includes in place, and the files that were read.
pub(super) fn included(main: &Path, mut root: Element) -> Result<(Element, Vec<PathBuf>), DescriptionError> {
    let mut files = vec![main.to_path_buf()];
    expand(main, &mut root, &mut files)?;
    Ok((root, files))
}

fn expand(main: &Path, element: &mut Element, files: &mut Vec<PathBuf>) -> Result<(), DescriptionError> {
    if !element.children.iter().any(|child| child.tag == "include") {
        return element.children.iter_mut().try_for_each(|child| expand(main, child, files));
    }
    let mut children = Vec::with_capacity(element.children.len());
    for mut child in std::mem::take(&mut element.children) {
        if child.tag == "include" {
            let mut pasted = open(main, &child, files)?;
            expand(main, &mut pasted, files)?;
            children.append(&mut pasted.children);
        } else {
            expand(main, &mut child, files)?;
            children.push(child);
        }
    }
    element.children = children;
    Ok(())
}

/// The root element of the file that an `<include>` names: beside the main file, else beside the including one.
fn open(main: &Path, include: &Element, files: &mut Vec<PathBuf>) -> Result<Element, DescriptionError> {
    // Files that were written on Windows.
    let name = include.needed("file")?.replace('\\', "/");
    let name = Path::new(&name);
    let beside = |file: &Path| file.parent().map_or_else(|| name.to_path_buf(), |folder| folder.join(name));
    let (first, second) = (beside(main), beside(&include.at.file));
    let path = if first.is_file() || !second.is_file() { first } else { second };
    let is_same = |other: &PathBuf| match (other.canonicalize(), path.canonicalize()) {
        (Ok(other), Ok(path)) => other == path,
        _ => *other == path,
    };
    if files.iter().any(is_same) {
        return Err(include.wrong(format!("{} is included twice, or includes itself", path.display())));
    }
    if files.len() > MOST_FILES {
        return Err(include.wrong(format!("more than {MOST_FILES} files are included")));
    }
    let (text, _) = format::text(&path).map_err(|error| include.wrong(error.to_string()))?;
    files.push(path.clone());
    parse(&Arc::from(path.as_path()), &text)
}
