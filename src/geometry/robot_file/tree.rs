//! Is it a tree? Names that stand once, joints that hang on earlier ones, every part on one joint.

use super::raw::{RawJoint, RawPart, RawRobot, Text};
use crate::log::{Document, LogError};
use std::collections::BTreeSet;

/// Refuses what is no tree.
pub(super) fn check(document: &Document<'_>, raw: &RawRobot) -> Result<(), LogError> {
    once(document, "[[part]]", raw.part.iter().map(|part| &part.name))?;
    once(document, "[[joint]]", raw.joint.iter().map(|joint| &joint.name))?;
    once(document, "[[sensor]]", raw.sensor.iter().map(|sensor| &sensor.name))?;
    part(document, "root", &raw.root, &raw.part)?;
    let mut hung = BTreeSet::from([raw.root.get_ref().as_str()]);
    for joint in &raw.joint {
        let key = |key: &str| format!("[[joint]] {} {key}", joint.name.get_ref());
        part(document, &key("parent"), &joint.parent, &raw.part)?;
        part(document, &key("child"), &joint.child, &raw.part)?;
        if joint.parent.get_ref() == joint.child.get_ref() {
            return Err(wrong(document, &key("child"), &joint.child, "another part than the parent"));
        }
        if joint.child.get_ref() == raw.root.get_ref() {
            return Err(wrong(
                document,
                &key("child"),
                &joint.child,
                "a part that is not the root: this closes a loop",
            ));
        }
        if !hung.contains(joint.parent.get_ref().as_str()) {
            return Err(wrong(document, &key("parent"), &joint.parent, &not_hung(joint, &raw.joint)));
        }
        if !hung.insert(joint.child.get_ref()) {
            let other = raw.joint.iter().find(|other| other.child.get_ref() == joint.child.get_ref());
            let other = other.map_or("another joint", |other| other.name.get_ref());
            let expected = format!("a part that hangs on one joint; {other} moves it already: this closes a loop");
            return Err(wrong(document, &key("child"), &joint.child, &expected));
        }
    }
    match raw.part.iter().find(|part| !hung.contains(part.name.get_ref().as_str())) {
        Some(loose) => Err(wrong(document, "[[part]] name", &loose.name, "a part that is the child of a joint")),
        None => massless_ends(document, raw),
    }
}

/// A part without mass at the end of a chain has no inertia to turn.
fn massless_ends(document: &Document<'_>, raw: &RawRobot) -> Result<(), LogError> {
    let is_end = |part: &&RawPart| raw.joint.iter().all(|joint| joint.parent.get_ref() != part.name.get_ref());
    match raw.part.iter().filter(is_end).find(|part| *part.mass_kg.get_ref() == 0.0) {
        Some(end) => {
            let key = format!("[[part]] {} mass_kg", end.name.get_ref());
            Err(document.wrong(&key, end.mass_kg.span(), "0", "a mass above 0 kg: nothing hangs on this part"))
        }
        None => Ok(()),
    }
}

/// Why a joint's parent is not in the tree yet.
fn not_hung(joint: &RawJoint, joints: &[RawJoint]) -> String {
    let mover = |part: &str| joints.iter().find(|other| other.child.get_ref() == part);
    let mut chain = vec![joint.parent.get_ref().as_str()];
    while let Some(above) = mover(chain[chain.len() - 1]) {
        let parent = above.parent.get_ref().as_str();
        let is_loop = chain.contains(&parent);
        chain.push(parent);
        if is_loop {
            return format!("a part that hangs on the root; {} is a loop", chain.join(" on "));
        }
    }
    match mover(joint.parent.get_ref()) {
        Some(later) => format!("a part that hangs on an earlier joint; put this joint after {}", later.name.get_ref()),
        None => "the root or the child of an earlier joint".to_owned(),
    }
}

fn part(document: &Document<'_>, key: &str, name: &Text, parts: &[RawPart]) -> Result<(), LogError> {
    if parts.iter().any(|part| part.name.get_ref() == name.get_ref()) {
        return Ok(());
    }
    Err(wrong(document, key, name, "the name of a [[part]]"))
}

fn once<'a>(document: &Document<'_>, table: &str, names: impl Iterator<Item = &'a Text>) -> Result<(), LogError> {
    let mut seen = BTreeSet::new();
    for name in names {
        if name.get_ref().is_empty() || !seen.insert(name.get_ref().as_str()) {
            return Err(wrong(document, &format!("{table} name"), name, "a name that no other has"));
        }
    }
    Ok(())
}

fn wrong(document: &Document<'_>, key: &str, found: &Text, expected: &str) -> LogError {
    document.wrong(key, found.span(), format!("\"{}\"", found.get_ref()), expected)
}
