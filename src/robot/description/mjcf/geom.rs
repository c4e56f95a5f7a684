//! `<geom>`: what it weighs, and what of it collides.

use super::compiler::Compiler;
use super::orientation::{from_z, pose};
use crate::robot::description::error::DescriptionError;
use crate::robot::description::inertia::RigidInertia;
use crate::robot::description::parts::Collider;
use crate::robot::description::shape::Shape;
use crate::robot::description::xml::Element;
use nalgebra::{Isometry3, Matrix3, Translation3, Unit, Vector3};

/// Density where nothing is said \[kg/m^3\], or of a shell \[kg/m^2\].
const DENSITY: f64 = 1000.0;

/// What a geom adds to its body.
pub(super) enum Weight {
    /// So much, in the axes of what the geom stands in.
    Known(RigidInertia),
    /// What only a mesh, or a shape that is not known here, could tell.
    Unknown(String),
}

/// Sliding friction where nothing is said.
const FRICTION: f64 = 1.0;

/// What of a geom that its class was applied to collides, in the axes of what it stands in; `None` for what no floor meets
/// and for shapes that are not read. What is wrong with a shape is its weight's to say.
pub(super) fn collider(geom: &Element, compiler: &Compiler) -> Option<Collider> {
    let meets = |name: &str| geom.number(name).ok().flatten().is_none_or(|bits| bits != 0.0);
    if !(meets("contype") || meets("conaffinity")) || geom.text("mesh").is_some() {
        return None;
    }
    let (shape, pose) = shape(geom, geom.text("type").unwrap_or("sphere").trim(), compiler).ok()?;
    let sliding = geom.numbers("friction").ok().flatten().and_then(|numbers| numbers.first().copied());
    Some(Collider { shape, pose, friction: Some(sliding.unwrap_or(FRICTION)) })
}

/// The weight of a geom that its class was applied to.
pub(super) fn weight(geom: &Element, compiler: &Compiler) -> Result<Weight, DescriptionError> {
    let mass = geom.not_negative("mass")?;
    let density = geom.not_negative("density")?;
    if mass == Some(0.0) || (mass.is_none() && density == Some(0.0)) {
        return Ok(Weight::Known(RigidInertia::default()));
    }
    let kind = geom.text("type").unwrap_or("sphere").trim();
    if kind == "plane" {
        return Ok(Weight::Known(RigidInertia::default()));
    }
    if matches!(kind, "mesh" | "sdf" | "hfield") || geom.text("mesh").is_some() {
        return Ok(Weight::Unknown(format!("{} of type {kind}", geom.label())));
    }
    let (shape, pose) = shape(geom, kind, compiler)?;
    let is_shell = geom.word("shellinertia", &[("true", true), ("false", false)])?.unwrap_or(false);
    let (size, moments) = if is_shell { shape.shell() } else { shape.solid() };
    let mass = mass.unwrap_or_else(|| density.unwrap_or(DENSITY) * size);
    let tensor = Matrix3::from_diagonal(&(moments * mass));
    Ok(Weight::Known(RigidInertia::about_centre(mass, &tensor, &pose)))
}

/// Shape and pose; `fromto` gives the long ones pose and length.
fn shape(geom: &Element, kind: &str, compiler: &Compiler) -> Result<(Shape, Isometry3<f64>), DescriptionError> {
    let mut size = geom.numbers("size")?.unwrap_or_default();
    size.truncate(3);
    let mut pose = pose(geom, compiler)?;
    if let Some(ends) = geom.exactly::<6>("fromto")? {
        if !matches!(kind, "capsule" | "cylinder" | "ellipsoid" | "box") {
            return Err(geom.bad("fromto", format!("it for a capsule, cylinder, ellipsoid or box, not for a {kind}")));
        }
        if pose.translation.vector != Vector3::zeros() {
            return Err(geom.bad("fromto", "fromto or pos, not both"));
        }
        let (from, to) = (Vector3::from_column_slice(&ends[..3]), Vector3::from_column_slice(&ends[3..]));
        let axis = Unit::try_new(from - to, 1e-14).ok_or_else(|| geom.bad("fromto", "two points apart"))?;
        let half = 0.5 * (from - to).norm();
        pose = Isometry3::from_parts(Translation3::from(0.5 * (from + to)), from_z(&axis));
        let radius = size.first().copied().unwrap_or(0.0);
        size = if matches!(kind, "capsule" | "cylinder") { vec![radius, half] } else { vec![radius, radius, half] };
    }
    let needed = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        "ellipsoid" | "box" => 3,
        _ => return Err(geom.bad("type", "plane, hfield, sphere, capsule, ellipsoid, cylinder, box or mesh")),
    };
    if size.len() < needed || size[..needed].iter().any(|half| !(*half > 0.0)) {
        return Err(geom.bad("size", format!("{needed} lengths above 0 for a {kind}")));
    }
    let shape = match kind {
        "sphere" => Shape::Sphere(size[0]),
        "capsule" => Shape::Capsule(size[0], size[1]),
        "cylinder" => Shape::Cylinder(size[0], size[1]),
        "ellipsoid" => Shape::Ellipsoid(Vector3::new(size[0], size[1], size[2])),
        _ => Shape::Box(Vector3::new(size[0], size[1], size[2])),
    };
    Ok((shape, pose))
}
