//! The thesis's own lumping (3.8-3.10): bodies on one line, every one about its x axis, the shoulder not shifted.
//!
//! "On the real Aibo the joint q2 turns around the z-axis, but for this model it does not matter which axis is used
//! since the bodies are symmetrical." They nearly are: x and z inertia of upper and lower leg differ by 5 % and 2 %.

use super::error::GeometryError;
use super::inertia::hollow_cylinder_across;
use super::leg::{Leg, LegJoint, LegPose, joint_name, segments};
use super::lump::{BodyLump, LinkBody, LumpedLink};
use super::tables::Ers7Tables;
use crate::log::ExtraMass;

/// Lumps a leg as the thesis does (3.8-3.10): all bodies on one line that hangs straight down.
///
/// `I* = I_S,x + (I_U,x + M_U D_U^2) + (I_L,x + M_L D_L^2) + (I_E,x + M_E D_E^2)` and
/// `M* = M_S D_S + M_U D_U + M_L D_L + M_E D_E` with `D_S = 0` and, from Table A.1 along y, `D_U` = 0.035 m, `D_L` =
/// 0.115 m about q1 and q2, and `D_L` = 0.045 m about q3. `D_E` is the extra mass's `distance_m`. Bodies that the
/// joint does not move are left out. `rest_rad` is 0: the pendulum's angle is counted from hanging, not from the
/// encoder's zero.
///
/// Against the exact [`super::lump()`] at the poses of the reference swings (`data/pose.toml`, knee 5 degrees from
/// straight) it is close: bare q1 0.77 % low in `I*` and 0.20 % in `M*`, loaded q1 0.07 % and 0.02 %, q2 within 0.08 %
/// and 0.06 %, q3 equal. What it lacks is the rest angle: -0.08 to -0.10 rad for q1, 0.52 rad for q2, 0.58 rad for q3.
///
/// # Errors
/// [`GeometryError::UnknownPart`], [`GeometryError::UnknownJoint`] for a robot file without such a leg.
pub fn straight_leg(
    robot: &Ers7Tables,
    leg: Leg,
    joint: LegJoint,
    gravity_m_s2: f64,
    extra: Option<&ExtraMass>,
) -> Result<LumpedLink, GeometryError> {
    let row = |joint: LegJoint| robot.joint(&joint_name(leg, joint));
    let (hip, knee) = (row(LegJoint::Q2)?, row(LegJoint::Q3)?);
    let hip_to_upper_m = hip.in_child_m.y;
    let hip_to_knee_m = hip.in_child_m.y - knee.in_parent_m.y;
    let knee_to_lower_m = knee.in_child_m.y;
    let to_lower_m = if joint == LegJoint::Q3 { knee_to_lower_m } else { hip_to_knee_m + knee_to_lower_m };

    let mut bodies = Vec::with_capacity(4);
    let kinds = [LinkBody::Shoulder, LinkBody::UpperLeg, LinkBody::LowerLeg];
    let distances_m = [0.0, hip_to_upper_m, to_lower_m];
    for (k, kind) in kinds.into_iter().enumerate().skip(joint.index()) {
        let part = robot.part(&row(LegJoint::ALL[k])?.child)?;
        bodies.push(on_the_line(kind, part.mass_kg, part.inertia_per_kg_m2()[(0, 0)], distances_m[k]));
    }
    if let Some(e) = extra {
        let own = hollow_cylinder_across(1.0, e.radius_m, e.length_m);
        bodies.push(on_the_line(LinkBody::Extra, e.mass_kg, own, e.distance_m));
    }
    let axis = segments(robot, leg, &LegPose::STRAIGHT)?[joint.index()].axis;
    Ok(LumpedLink::assemble(leg, joint, axis, gravity_m_s2, bodies))
}

/// One body of (3.8), shifted by (3.9).
fn on_the_line(body: LinkBody, mass_kg: f64, own_per_kg_m2: f64, distance_m: f64) -> BodyLump {
    BodyLump {
        body,
        mass_kg,
        inertia_per_kg_m2: super::inertia::parallel_axis_scalar(own_per_kg_m2, 1.0, distance_m),
        lever_down_m: distance_m,
        lever_normal_m: 0.0,
    }
}
