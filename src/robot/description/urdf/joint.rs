//! `<joint>`: what it joins, how it moves, what limits it, what it follows.

use super::{UNLIMITED, expect_elements, limit, number, numbers, one, origin, plain};
use crate::robot::description::error::DescriptionError;
use crate::robot::description::parts::JointKind;
use crate::robot::description::xml::Element;
use nalgebra::{Isometry3, Unit, Vector3};

/// A joint as it is written.
pub(super) struct RawJoint<'a> {
    pub name: &'a str,
    pub parent: &'a str,
    pub child: &'a str,
    pub pose: Isometry3<f64>,
    /// `None`: fixed.
    pub moves: Option<Moves>,
    /// The joint that it follows, with multiplier and offset.
    pub mimic: Option<(&'a str, f64, f64)>,
    pub element: &'a Element,
}

/// What a joint that is not fixed has.
pub(super) struct Moves {
    pub kind: JointKind,
    pub axis: Unit<Vector3<f64>>,
    pub limit_rad: Option<[f64; 2]>,
    pub effort_nm: Option<f64>,
    pub rate_limit_rad_s: Option<f64>,
    pub damping_nm_s_rad: f64,
    pub friction_nm: f64,
}

/// What may stand in a joint; some of it changes no motion.
const ELEMENTS: &[&str] = &[
    "origin",
    "parent",
    "child",
    "axis",
    "limit",
    "dynamics",
    "mimic",
    "safety_controller",
    "calibration",
    "gazebo",
    "transmission",
    "hardwareInterface",
];

/// Reads a joint.
pub(super) fn read<'a>(joint: &'a Element, warnings: &mut Vec<String>) -> Result<RawJoint<'a>, DescriptionError> {
    let name = plain(joint, "name")?.ok_or_else(|| joint.wrong("the attribute `name` is missing"))?;
    let parent = end(joint, "parent", warnings)?;
    let child = end(joint, "child", warnings)?;
    let kind = match plain(joint, "type")?.unwrap_or_default().trim() {
        "fixed" => None,
        "revolute" => Some(JointKind::Revolute),
        "continuous" => Some(JointKind::Continuous),
        "prismatic" => Some(JointKind::Prismatic),
        kind @ ("floating" | "planar" | "spherical" | "ball" | "universal" | "screw") => {
            let hint = "joints may be revolute, continuous, prismatic or fixed; a free base is chosen with --base free";
            return Err(joint.unsupported(format!("a {kind} joint"), hint));
        }
        _ => return Err(joint.bad("type", "revolute, continuous, prismatic or fixed")),
    };
    expect_elements(joint, ELEMENTS, warnings);
    let moves = kind.map(|kind| moves(joint, kind, warnings)).transpose()?;
    let mimic = match one(joint, "mimic", warnings) {
        Some(mimic) if moves.is_some() => {
            mimic.expect_attributes(&["joint", "multiplier", "offset"], warnings);
            let leader = plain(mimic, "joint")?.ok_or_else(|| mimic.wrong("the attribute `joint` is missing"))?;
            Some((leader, number(mimic, "multiplier")?.unwrap_or(1.0), number(mimic, "offset")?.unwrap_or(0.0)))
        }
        Some(mimic) => {
            warnings.push(mimic.say(format!("{} is fixed and follows nothing", joint.label())));
            None
        }
        None => None,
    };
    Ok(RawJoint { name, parent, child, pose: origin(joint, warnings)?, moves, mimic, element: joint })
}

/// The link of `<parent>` or `<child>`.
fn end<'a>(joint: &'a Element, tag: &'a str, warnings: &mut Vec<String>) -> Result<&'a str, DescriptionError> {
    let end = one(joint, tag, warnings).ok_or_else(|| joint.wrong(format!("<{tag} link=\"...\"> is missing")))?;
    plain(end, "link")?.ok_or_else(|| end.wrong(format!("the attribute `link` is missing in {}", joint.label())))
}

fn moves(joint: &Element, kind: JointKind, warnings: &mut Vec<String>) -> Result<Moves, DescriptionError> {
    let axis = match one(joint, "axis", warnings) {
        Some(axis) => {
            axis.expect_attributes(&["xyz"], warnings);
            let written = Vector3::from(numbers::<3>(axis, "xyz")?.unwrap_or([1.0, 0.0, 0.0]));
            let expected = || axis.bad("xyz", format!("an axis of {} that is not zero", joint.label()));
            Unit::try_new(written, f64::MIN_POSITIVE).ok_or_else(expected)?
        }
        None => Vector3::x_axis(),
    };
    let (mut limit_rad, mut effort_nm, mut rate_limit_rad_s) = (None, None, None);
    match one(joint, "limit", warnings) {
        Some(limits) => {
            limits.expect_attributes(
                &["lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"],
                warnings,
            );
            let is_reached = |most: &f64| *most < UNLIMITED;
            effort_nm = limit(limits, "effort")?.filter(is_reached);
            if effort_nm.is_some_and(|effort_nm| effort_nm < 0.0) {
                warnings.push(limits.say(format!("{}: an effort below 0", joint.label())));
            }
            rate_limit_rad_s = limit(limits, "velocity")?.filter(is_reached);
            if kind != JointKind::Continuous {
                let ends = [limit(limits, "lower")?.unwrap_or(0.0), limit(limits, "upper")?.unwrap_or(0.0)];
                if ends[0] > ends[1] {
                    let what = "lower is above upper; taken as without limits";
                    warnings.push(limits.say(format!("{}: {what}", joint.label())));
                } else if ends[0] == ends[1] {
                    warnings.push(limits.say(format!("{}: by its limits it cannot move", joint.label())));
                }
                let is_limit = |[low, high]: &[f64; 2]| low <= high && (*low > -UNLIMITED || *high < UNLIMITED);
                limit_rad = Some(ends).filter(is_limit);
            }
        }
        None if kind != JointKind::Continuous => warnings.push(joint.say("no <limit>; taken as without limits")),
        None => {}
    }
    let (mut damping_nm_s_rad, mut friction_nm) = (0.0, 0.0);
    if let Some(dynamics) = one(joint, "dynamics", warnings) {
        damping_nm_s_rad = number(dynamics, "damping")?.unwrap_or(0.0);
        friction_nm = number(dynamics, "friction")?.unwrap_or(0.0);
        if damping_nm_s_rad < 0.0 || friction_nm < 0.0 {
            let what = "damping or friction below 0 drives the joint";
            warnings.push(dynamics.say(format!("{}: {what}", joint.label())));
        }
    }
    Ok(Moves { kind, axis, limit_rad, effort_nm, rate_limit_rad_s, damping_nm_s_rad, friction_nm })
}
