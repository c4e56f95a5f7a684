//! Reads MJCF.
//!
//! A reader of our own: `mjcf-rs` was looked at and drops `actuatorfrcrange`, `dampratio` and spatial tendons without a
//! word, and what changes the dynamics must be read or refused. The rules are MuJoCo's; where its documentation is silent
//! they are what MuJoCo 4.0.0 was seen to do: a class copies its parent when it is declared, an orientation replaces an
//! inherited one of any kind, lists (`size`, `gear`, `gainprm`, `biasprm`) replace an inherited one number by number.
//!
//! Refused by name: ball joints, a second or nested free joint, `composite`, `flexcomp`, `attach`, `plugin`, tendons with
//! armature, a body whose inertia would come from a mesh. Closed loops and tendons that act stand in
//! [`Description::left_out`].

mod actuator;
mod body;
mod compiler;
mod defaults;
mod geom;
mod include;
mod inertial;
mod joint;
mod known;
mod named;
mod naming;
mod option;
mod orientation;
#[cfg(test)]
mod tests;
mod totals;
mod unread;

use super::error::DescriptionError;
use super::xml::Element;
use super::{Description, Format, LinkId};
use compiler::Compiler;
use defaults::Classes;
use named::NamedBodies;
use std::path::Path;

/// What MuJoCo reads beside this and what changes no motion of the tree.
const SILENT: &[&str] = &[
    "asset",
    "contact",
    "custom",
    "keyframe",
    "sensor",
    "size",
    "statistic",
    "visual",
    "compiler",
    "option",
    "default",
    "worldbody",
    "actuator",
    "tendon",
    "equality",
];

/// What all parts of the reader share.
struct Reader<'a> {
    compiler: Compiler,
    classes: Classes,
    /// Bodies that other elements name.
    named: NamedBodies,
    /// Those that are fused to nothing though they have no joints.
    unfused: Vec<LinkId>,
    /// Those that weigh what their `<inertial>` says though geoms were asked.
    by_inertial: Vec<LinkId>,
    into: &'a mut Description,
}

/// The robot of a file whose root element is given.
pub(super) fn read(file: &Path, root: Element) -> Result<Description, DescriptionError> {
    let (root, files) = include::included(file, root)?;
    let mut description = Description {
        name: root.text("model").map_or_else(|| super::of_tables::stem(file), str::to_owned),
        format: Format::Mjcf,
        files,
        gravity_m_s2: option::gravity(&root)?,
        links: Vec::new(),
        joints: Vec::new(),
        free_joint: None,
        couplings: Vec::new(),
        equalities: Vec::new(),
        actuators: Vec::new(),
        warnings: Vec::new(),
        left_out: Vec::new(),
        unweighed: None,
    };
    for section in root.children.iter().filter(|section| !SILENT.contains(&section.tag.as_str())) {
        unread::section(section, &mut description)?;
    }
    known::expect_known(&root, &mut description.warnings);
    option::unread(&root, &mut description.warnings)?;
    let compiler = Compiler::read(&root)?;
    let classes = Classes::read(&root)?;
    let (named, unfused, by_inertial) = (NamedBodies::of(&root), Vec::new(), Vec::new());
    let mut reader = Reader { compiler, classes, named, unfused, by_inertial, into: &mut description };
    let replicated = reader.bodies(&root)?;
    reader.totals();
    reader.tendons(&root)?;
    reader.equalities(&root)?;
    reader.actuators(&root, &replicated)?;
    Ok(description)
}
