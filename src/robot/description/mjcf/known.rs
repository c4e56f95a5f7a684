//! Attributes that MuJoCo does not have: most are misspelt, and their numbers would be missing without a word.

use crate::robot::description::xml::Element;

/// What MuJoCo 4.0.0 prints as its schema, of the sections that make the robot: section and element, then their attributes.
/// Besides stand those of older releases that changed no motion, and those of frames and replicas, which it does not print.
const SCHEMA: &str = include_str!("known.txt");
/// Sections that have the elements of which a class says the defaults.
const WITH_DEFAULTS: [&str; 3] = ["worldbody", "actuator", "default"];

/// Warns of attributes that the elements of a file cannot have.
pub(super) fn expect_known(root: &Element, warnings: &mut Vec<String>) {
    for section in &root.children {
        let mut open = vec![section];
        while let Some(element) = open.pop() {
            if let Some(known) = attributes(&section.tag, &element.tag) {
                element.expect_attributes(&known, warnings);
            }
            open.extend(element.children.iter().rev());
        }
    }
}

/// The attributes of an element in a section; `None` where none of it is read.
fn attributes(section: &str, tag: &str) -> Option<Vec<&'static str>> {
    let sections = if section == "default" { &WITH_DEFAULTS[..] } else { &[section][..] };
    let of = |line: &'static str| {
        let (element, attributes) = line.split_once(": ")?;
        let (of, name) = element.split_once(' ')?;
        (name == tag && sections.contains(&of)).then(|| attributes.split(' ').collect())
    };
    SCHEMA.lines().find_map(of)
}
