//! Reads URDF.
//!
//! `urdf-rs` was looked at and not taken: it makes a misspelt attribute 0 and a missing `<inertial>` mass 0 without a word,
//! refuses a `<limit>` without `velocity`, knows no lines, and runs an external `xacro`. Here elements may come in any order,
//! as they do; of repeated ones the first counts, as in Pinocchio.

mod joint;
mod link;
mod order;
#[cfg(test)]
mod tests;

use super::error::DescriptionError;
use super::format::xacro_hint;
use super::xml::Element;
use super::{Description, Format};
use crate::number::STANDARD_GRAVITY_M_S2;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use std::path::Path;

/// What stands for no limit where an attribute has to be there \[rad, rad/s, N m\]: nothing reaches it.
pub(super) const UNLIMITED: f64 = 1e9;

/// The robot under a `<robot>` element.
pub(super) fn read(file: &Path, root: &Element) -> Result<Description, DescriptionError> {
    let mut warnings = Vec::new();
    refuse_xacro(root)?;
    expect_elements(root, ELEMENTS, &mut warnings);
    let links = root.all("link").map(|link| link::read(link, &mut warnings)).collect::<Result<Vec<_>, _>>()?;
    let joints = root.all("joint").map(|joint| joint::read(joint, &mut warnings)).collect::<Result<Vec<_>, _>>()?;
    let name = root.text("name").map_or_else(|| super::of_tables::stem(file), str::to_owned);
    let mut description = Description {
        name,
        format: Format::Urdf,
        files: vec![file.to_path_buf()],
        gravity_m_s2: Vector3::new(0.0, 0.0, -STANDARD_GRAVITY_M_S2),
        links: Vec::new(),
        joints: Vec::new(),
        free_joint: None,
        couplings: Vec::new(),
        equalities: Vec::new(),
        actuators: Vec::new(),
        warnings,
        left_out: Vec::new(),
        unweighed: None,
    };
    order::assemble(&mut description, root, links, joints)?;
    Ok(description)
}

/// What stands in a robot: what moves, and what simulators and controllers keep there.
const ELEMENTS: &[&str] = &["link", "joint", "material", "transmission", "gazebo", "sensor", "ros2_control"];

/// Elements of xacro's namespace are macros that were not expanded; that the namespace is declared says nothing.
fn refuse_xacro(root: &Element) -> Result<(), DescriptionError> {
    let mut open = vec![root];
    while let Some(element) = open.pop() {
        let namespace = element.foreign.as_deref().unwrap_or_default();
        if namespace.ends_with("xacro") {
            return Err(element.unsupported(format!("xacro (an element xacro:{})", element.tag), xacro_hint("macros")));
        }
        // What simulators put into their own elements is theirs.
        open.extend(element.children.iter().rev().filter(|child| child.tag != "gazebo"));
    }
    Ok(())
}

/// An attribute that is used, and that no macro is left in.
fn plain<'a>(element: &'a Element, name: &str) -> Result<Option<&'a str>, DescriptionError> {
    match element.text(name) {
        Some(text) if text.contains("${") || text.contains("$(") => {
            Err(element.unsupported(format!("xacro ({name}=\"{text}\")"), xacro_hint("an expression")))
        }
        text => Ok(text),
    }
}

/// The finite numbers of an attribute that no macro is left in.
fn numbers<const N: usize>(element: &Element, name: &str) -> Result<Option<[f64; N]>, DescriptionError> {
    plain(element, name)?;
    element.exactly(name)
}

/// A number of an attribute that no macro is left in.
fn number(element: &Element, name: &str) -> Result<Option<f64>, DescriptionError> {
    Ok(numbers::<1>(element, name)?.map(|[number]| number))
}

/// A limit; [`UNLIMITED`] where it is infinite or beyond that.
fn limit(element: &Element, name: &str) -> Result<Option<f64>, DescriptionError> {
    plain(element, name)?;
    Ok(element.limits::<1>(name, UNLIMITED)?.map(|[limit]| limit))
}

/// The first child with a tag; says so where there are more.
fn one<'a>(element: &'a Element, tag: &'a str, warnings: &mut Vec<String>) -> Option<&'a Element> {
    if let Some(second) = element.all(tag).nth(1) {
        warnings.push(second.say(format!("a second one in {}; the first counts", element.label())));
    }
    element.first(tag)
}

/// Warns of elements that URDF does not have here, of each kind once.
fn expect_elements(element: &Element, known: &[&str], warnings: &mut Vec<String>) {
    let mut seen: Vec<&str> = known.to_vec();
    for child in element.children.iter().filter(|child| child.foreign.is_none()) {
        if !seen.contains(&child.tag.as_str()) {
            seen.push(&child.tag);
            warnings.push(child.say(format!("unknown element in {}, ignored", element.label())));
        }
    }
}

/// The pose of an `<origin>`: Rz(yaw) Ry(pitch) Rx(roll), radians always; the identity where there is none.
fn origin(element: &Element, warnings: &mut Vec<String>) -> Result<Isometry3<f64>, DescriptionError> {
    let Some(origin) = one(element, "origin", warnings) else { return Ok(Isometry3::identity()) };
    origin.expect_attributes(&["xyz", "rpy", "quat_xyzw"], warnings);
    let place = numbers::<3>(origin, "xyz")?.unwrap_or_default();
    let rotation = match (numbers::<3>(origin, "rpy")?, numbers::<4>(origin, "quat_xyzw")?) {
        (Some(_), Some(_)) => return Err(origin.bad("quat_xyzw", "rpy or quat_xyzw, not both")),
        (None, Some([x, y, z, w])) => UnitQuaternion::try_new(Quaternion::new(w, x, y, z), f64::MIN_POSITIVE)
            .ok_or_else(|| origin.bad("quat_xyzw", "a quaternion that is not zero"))?,
        (rpy, None) => {
            let [roll, pitch, yaw] = rpy.unwrap_or_default();
            UnitQuaternion::from_euler_angles(roll, pitch, yaw)
        }
    };
    Ok(Isometry3::from_parts(Translation3::from(place), rotation))
}
