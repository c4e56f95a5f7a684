//! The docs as a site: every page is in the list of contents, and every link, anchor and picture is there.

mod support;

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use support::{everything_in, root};

/// A page of the docs, README or another document that links to them.
struct Page {
    path: PathBuf,
    text: String,
}

fn read(path: PathBuf) -> Page {
    let text = std::fs::read_to_string(&path).expect("a page can be read");
    Page { path, text }
}

fn pages() -> Vec<Page> {
    let docs = everything_in(&root().join("docs"));
    let docs = docs.into_iter().filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    let others = ["README.md", "data/README.md"].map(|name| root().join(name));
    docs.chain(others).map(read).collect()
}

/// Lines that are not inside a block.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut inside = false;
    text.lines().filter(move |line| {
        let is_fence = line.starts_with("```");
        inside ^= is_fence;
        !inside && !is_fence
    })
}

/// What `[...](here)` and `![...](here)` point to.
fn targets(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    // A link may stand on two lines.
    let joined: String = prose(text).collect::<Vec<_>>().join("\n");
    let mut rest = joined.as_str();
    while let Some(at) = rest.find("](") {
        rest = &rest[at + 2..];
        if let Some(end) = rest.find(')') {
            found.push(rest[..end].to_owned());
        }
    }
    found
}

/// Anchors of a page's headings, as GitHub and mdbook make them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).filter(|line| line.starts_with('#'));
    let anchor = |line: &str| {
        let words = line.trim_start_matches('#').trim().to_lowercase();
        let kept = words.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>()
    };
    headings.map(anchor).collect()
}

/// Without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => _ = plain.pop(),
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    plain
}

#[test]
fn every_page_is_in_the_list_of_contents_once() {
    let summary = read(root().join("docs/SUMMARY.md"));
    let listed = targets(&summary.text);
    let distinct: BTreeSet<PathBuf> = listed.iter().map(|target| plain(&root().join("docs").join(target))).collect();
    assert_eq!(distinct.len(), listed.len(), "a page is listed twice");
    let there: BTreeSet<PathBuf> = pages().into_iter().map(|page| page.path).collect();
    let there = there.into_iter().filter(|path| path.starts_with(root().join("docs")) && *path != summary.path);
    let missing: Vec<PathBuf> = there.filter(|path| !distinct.contains(path)).collect();
    assert!(missing.is_empty(), "not in docs/SUMMARY.md: {missing:?}");
}

#[test]
fn every_link_leads_to_a_file_and_a_heading_that_are_there() {
    let mut wrong = Vec::new();
    let mut followed = 0;
    for page in pages() {
        for target in targets(&page.text) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            followed += 1;
            let (file, anchor) = target.split_once('#').map_or((&*target, None), |(file, anchor)| (file, Some(anchor)));
            let folder = page.path.parent().expect("a page is in a folder");
            let path = if file.is_empty() { page.path.clone() } else { plain(&folder.join(file)) };
            let is_there = path.exists();
            let has_anchor = anchor.is_none_or(|anchor| {
                is_there && anchors(&std::fs::read_to_string(&path).unwrap_or_default()).contains(anchor)
            });
            if !is_there || !has_anchor {
                wrong.push(format!("{}: {target}", page.path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "links that lead nowhere:\n{}", wrong.join("\n"));
    assert!(followed > 100, "{followed} links");
}

#[test]
fn a_page_of_the_site_links_to_the_site_only() {
    let mut wrong = Vec::new();
    let docs = root().join("docs");
    for page in pages().into_iter().filter(|page| page.path.starts_with(&docs)) {
        let folder = page.path.parent().expect("a page is in a folder").to_path_buf();
        let local = targets(&page.text).into_iter().filter(|target| !target.contains("://"));
        let out = local.filter(|target| !plain(&folder.join(target)).starts_with(&docs));
        wrong.extend(out.map(|target| format!("{}: {target}", page.path.display())));
    }
    // The repository's files are no part of the site: such a link would be dead there.
    assert!(wrong.is_empty(), "links out of docs:\n{}", wrong.join("\n"));
}

#[test]
fn every_picture_of_the_docs_is_shown() {
    let all: String = pages().into_iter().map(|page| page.text).collect();
    let pictures = everything_in(&root().join("docs"))
        .into_iter()
        .filter(|path| path.extension().is_some_and(|ending| ["svg", "gif", "png"].iter().any(|kind| ending == *kind)));
    let unused: Vec<PathBuf> = pictures
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            !all.contains(&name)
        })
        .collect();
    assert!(unused.is_empty(), "pictures that no page shows: {unused:?}");
}
