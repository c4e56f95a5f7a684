//! `<joint>`: how a body moves against its parent.

use super::compiler::Compiler;
use crate::robot::description::error::DescriptionError;
use crate::robot::description::parts::{JointKind, LinkId, Mover};
use crate::robot::description::urdf::UNLIMITED;
use crate::robot::description::xml::Element;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

/// An axis shorter than this has no direction.
const NOTHING: f64 = 1e-14;

/// Whether a joint frees its body.
pub(super) fn is_free(joint: &Element) -> bool {
    joint.tag == "freejoint" || joint.text("type").is_some_and(|kind| kind.trim() == "free")
}

/// A joint that its class was applied to; `frame` is what it stands in, seen from its body.
pub(super) fn read(
    joint: &Element,
    name: String,
    link: LinkId,
    frame: &Isometry3<f64>,
    compiler: &Compiler,
    warnings: &mut Vec<String>,
) -> Result<Mover, DescriptionError> {
    if joint.text("type").is_some_and(|kind| kind.trim() == "ball") {
        return Err(joint.unsupported("a ball joint", "three hinges in one body move alike but for their singularity"));
    }
    let is_hinge = joint.word("type", &[("hinge", true), ("slide", false)])?.unwrap_or(true);
    if joint.text("springdamper").is_some() {
        warnings.push(joint.say("springdamper is not read; write stiffness and damping"));
    }
    let axis = frame.rotation * Vector3::from(joint.exactly::<3>("axis")?.unwrap_or([0.0, 0.0, 1.0]));
    let angle = |written: f64| if is_hinge { compiler.angle(written) } else { written };
    let limit_rad = range(joint, "range", "limited", compiler)?.map(|range| range.map(angle));
    Ok(Mover {
        name,
        kind: if is_hinge { JointKind::Revolute } else { JointKind::Prismatic },
        link,
        axis: Unit::try_new(axis, NOTHING).ok_or_else(|| joint.bad("axis", "an axis that is not zero"))?,
        place_m: (frame * Point3::from(joint.exactly::<3>("pos")?.unwrap_or_default())).coords,
        drawn_rad: angle(joint.number("ref")?.unwrap_or(0.0)),
        limit_rad,
        effort_nm: None,
        rate_limit_rad_s: None,
        actuator_range_nm: range(joint, "actuatorfrcrange", "actuatorfrclimited", compiler)?,
        armature_kg_m2: joint.not_negative("armature")?.unwrap_or(0.0),
        damping: polynomial(joint, "damping")?,
        friction_nm: joint.not_negative("frictionloss")?.unwrap_or(0.0),
        stiffness: polynomial(joint, "stiffness")?,
        spring_rest_rad: angle(joint.number("springref")?.unwrap_or(0.0)),
        at: joint.at.clone(),
    })
}

/// A range that limits: said to, or there and automatic.
pub(super) fn range(
    of: &Element,
    range: &str,
    limited: &str,
    compiler: &Compiler,
) -> Result<Option<[f64; 2]>, DescriptionError> {
    let is_reached = |ends: &[f64; 2]| ends.iter().any(|end| end.abs() < UNLIMITED);
    let ends = of.limits::<2>(range, UNLIMITED)?;
    if ends.as_ref().is_some_and(|ends| !is_reached(ends)) {
        return Ok(None);
    }
    let words = [("true", Some(true)), ("false", Some(false)), ("auto", None)];
    match (of.word(limited, &words)?.flatten(), ends) {
        (Some(false), _) | (None, None) => Ok(None),
        (Some(true), Some(ends)) if ends[0] < ends[1] => Ok(Some(ends)),
        (Some(true), _) => Err(of.bad(range, format!("two numbers, the smaller first, as {limited}=\"true\" asks"))),
        (None, Some(ends)) if ends[0] == 0.0 && ends[1] == 0.0 => Ok(None),
        (None, Some(_)) if !compiler.is_autolimits => {
            Err(of.bad(range, format!("{limited}=\"true\" or \"false\" beside it where autolimits=\"false\"")))
        }
        (None, Some(ends)) => Ok((ends[0] < ends[1]).then_some(ends)),
    }
}

/// One to three coefficients.
pub(super) fn polynomial(joint: &Element, name: &str) -> Result<[f64; 3], DescriptionError> {
    let given = joint.numbers(name)?.unwrap_or_default();
    if given.len() > 3 || (given.is_empty() && joint.text(name).is_some()) {
        return Err(joint.bad(name, "one to three numbers"));
    }
    let mut all = [0.0; 3];
    all[..given.len()].copy_from_slice(&given);
    Ok(all)
}
