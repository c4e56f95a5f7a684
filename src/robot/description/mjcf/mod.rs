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
mod naming;
mod orientation;
mod shape;
#[cfg(test)]
mod tests;
mod totals;
mod unread;

use super::error::DescriptionError;
use super::xml::Element;
use super::{Description, Format};
use crate::number::STANDARD_GRAVITY_M_S2;
use compiler::Compiler;
use defaults::Classes;
use nalgebra::Vector3;
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
    into: &'a mut Description,
}

/// The robot of a file whose root element is given.
pub(super) fn read(file: &Path, root: Element) -> Result<Description, DescriptionError> {
    let (root, files) = include::included(file, root)?;
    let mut description = Description {
        name: root.text("model").map_or_else(|| super::of_tables::stem(file), str::to_owned),
        format: Format::Mjcf,
        files,
        gravity_m_s2: gravity(&root)?,
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
    let compiler = Compiler::read(&root, &mut description.warnings)?;
    let classes = Classes::read(&root)?;
    let mut reader = Reader { compiler, classes, into: &mut description };
    let replicated = reader.bodies(&root)?;
    reader.totals(&root)?;
    reader.tendons(&root)?;
    reader.equalities(&root)?;
    reader.actuators(&root, &replicated)?;
    Ok(description)
}

/// `<option gravity>`, which `<flag gravity="disable"/>` switches off.
fn gravity(root: &Element) -> Result<Vector3<f64>, DescriptionError> {
    let (mut gravity, mut is_on) = (Vector3::new(0.0, 0.0, -STANDARD_GRAVITY_M_S2), true);
    for option in root.all("option") {
        if let Some(written) = option.exactly::<3>("gravity")? {
            gravity = Vector3::from(written);
        }
        for flag in option.all("flag") {
            is_on = flag.word("gravity", &[("enable", true), ("disable", false)])?.unwrap_or(is_on);
        }
    }
    Ok(if is_on { gravity } else { Vector3::zeros() })
}
