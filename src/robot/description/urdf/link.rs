//! `<link>`: a name, perhaps an inertia, and what of it collides.

use super::{expect_elements, number, numbers, one, origin, plain};
use crate::robot::description::error::DescriptionError;
use crate::robot::description::inertia::RigidInertia;
use crate::robot::description::parts::Collider;
use crate::robot::description::shape::Shape;
use crate::robot::description::xml::Element;
use nalgebra::{Matrix3, Vector3};

/// A link as it is written.
pub(super) struct RawLink<'a> {
    pub name: &'a str,
    pub inertia: RigidInertia,
    pub colliders: Vec<Collider>,
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
    let colliders = link.all("collision").filter_map(collider).collect();
    Ok(RawLink { name, inertia, colliders, element: link })
}

/// A `<collision>`, where its shape is one that is read. What is not right in one changes no dynamics and is passed over.
fn collider(collision: &Element) -> Option<Collider> {
    let shape = collision.first("geometry")?.children.first()?;
    let length = |name: &str| number(shape, name).ok().flatten().filter(|length| *length > 0.0);
    let shape = match shape.tag.as_str() {
        "sphere" => Shape::Sphere(length("radius")?),
        "cylinder" => Shape::Cylinder(length("radius")?, 0.5 * length("length")?),
        "capsule" => Shape::Capsule(length("radius")?, 0.5 * length("length")?),
        "box" => Shape::Box(0.5 * Vector3::from(numbers::<3>(shape, "size").ok()??)),
        _ => return None,
    };
    let pose = origin(collision, &mut Vec::new()).ok()?;
    Some(Collider { shape, pose, friction: None })
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
