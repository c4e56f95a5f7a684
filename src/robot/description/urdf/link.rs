//! `<link>`: a name, perhaps an inertia.

use super::{expect_elements, number, one, origin, plain};
use crate::robot::description::error::DescriptionError;
use crate::robot::description::inertia::RigidInertia;
use crate::robot::description::xml::Element;
use nalgebra::Matrix3;

/// A link as it is written.
pub(super) struct RawLink<'a> {
    pub name: &'a str,
    pub inertia: RigidInertia,
    pub element: &'a Element,
}

/// Reads a link. Without `<inertial>` it has no mass: what collides says nothing about that.
pub(super) fn read<'a>(link: &'a Element, warnings: &mut Vec<String>) -> Result<RawLink<'a>, DescriptionError> {
    let name = plain(link, "name")?.ok_or_else(|| link.wrong("the attribute `name` is missing"))?;
    let inertia = match one(link, "inertial", warnings) {
        Some(inertial) => inertia(inertial, link, warnings)?,
        None => {
            if link.first("visual").or(link.first("collision")).is_some() {
                warnings.push(link.say("it has a shape and no <inertial>; taken as without mass"));
            }
            RigidInertia::default()
        }
    };
    expect_elements(link, &["inertial", "visual", "collision", "contact", "sensor", "gazebo"], warnings);
    Ok(RawLink { name, inertia, element: link })
}

fn inertia(inertial: &Element, link: &Element, warnings: &mut Vec<String>) -> Result<RigidInertia, DescriptionError> {
    let of = || format!("<inertial> of {}", link.label());
    let missing = |tag: &str| inertial.wrong(format!("<{tag}> is missing in the {}", of()));
    let mass = one(inertial, "mass", warnings).ok_or_else(|| missing("mass"))?;
    let mass_kg = number(mass, "value")?.ok_or_else(|| mass.bad("value", "a mass [kg]"))?;
    if mass_kg < 0.0 {
        return Err(mass.bad("value", format!("a mass not below 0 kg in the {}", of())));
    }
    let tensor = one(inertial, "inertia", warnings).ok_or_else(|| missing("inertia"))?;
    tensor.expect_attributes(&["ixx", "ixy", "ixz", "iyy", "iyz", "izz"], warnings);
    let entry = |name: &str| {
        number(tensor, name)?.ok_or_else(|| tensor.bad(name, format!("a moment of inertia [kg m^2] in the {}", of())))
    };
    let (xy, xz, yz) = (entry("ixy")?, entry("ixz")?, entry("iyz")?);
    let tensor_kg_m2 = Matrix3::new(entry("ixx")?, xy, xz, xy, entry("iyy")?, yz, xz, yz, entry("izz")?);
    Ok(RigidInertia::about_centre(mass_kg, &tensor_kg_m2, &origin(inertial, warnings)?))
}
