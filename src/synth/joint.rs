//! A joint of a leg on the bench: its spec as a drop of the whole robot, and what the engineer believes of it.

use super::error::{Blame, SynthError};
use super::spec::JointBench;
use crate::geometry::{Leg, LegJoint, LegPose, joint_name};
use crate::identify::LegCase;
use crate::log::Nominal;
use crate::number::STANDARD_GRAVITY_M_S2;
use crate::robot::Nominal as Robot;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// The joint as an engineer states it: nominal numbers, and the part of gravity that acts on it \[m/s^2\].
pub(super) struct Believed {
    pub nominal: Nominal,
    pub gravity_m_s2: f64,
    /// Where the tables let the bare leg hang \[rad\].
    pub rest_rad: f64,
    /// `q1`, `q2` or `q3`.
    pub kind: String,
}

/// What is believed of the joint: the tables' numbers where the spec states none.
pub(super) fn believed(blame: &Blame<'_>, bench: &JointBench) -> Result<Believed, SynthError> {
    let (leg, joint) = leg_joint(blame, bench)?;
    let mut held = LegPose::STRAIGHT;
    for other in LegJoint::ALL {
        held = held.with(other, bench.angles.get(&joint_name(leg, other)).copied().unwrap_or(0.0));
    }
    let gravity_trunk_m_s2 = bench.gravity.map_or(Vector3::new(0.0, -STANDARD_GRAVITY_M_S2, 0.0), Vector3::from);
    let case = LegCase { leg, joint, held, gravity_trunk_m_s2, mount_m: None, pose_known: true };
    let tables = case.nominal().map_err(|error| blame.geometry("[joint]", error))?;
    let lumped = case.bare().map_err(|error| blame.geometry("[joint]", error))?;
    let number = |name: &str, stated: Option<f64>, table: f64| {
        let key = format!("[joint] {name}");
        blame.number(&key, stated.unwrap_or(table), |x| (0.0..=10.0).contains(&x), "a number from 0 to 10")
    };
    Ok(Believed {
        nominal: Nominal {
            inertia_kg_m2: number("inertia", bench.inertia, tables.inertia_kg_m2)?,
            moment_kg_m: number("moment", bench.moment, tables.moment_kg_m)?,
            coulomb_nm: number("coulomb", bench.coulomb, tables.coulomb_nm)?,
            viscous_nm_s_rad: number("viscous", bench.viscous, tables.viscous_nm_s_rad)?,
        },
        gravity_m_s2: lumped.gravity_m_s2,
        rest_rad: lumped.rest_rad,
        kind: joint.to_string(),
    })
}

/// Setpoints of a log of the joint.
pub(super) fn angles(
    blame: &Blame<'_>,
    bench: &JointBench,
    angle: Option<f64>,
    table: &str,
) -> Result<BTreeMap<String, f64>, SynthError> {
    leg_joint(blame, bench)?;
    let key = format!("{table} angle");
    let angle = angle.ok_or_else(|| blame.value(&key, "nothing", "the angle from which the joint is let go [rad]"))?;
    let mut angles = bench.angles.clone();
    angles.insert(bench.name.clone(), angle);
    Ok(angles)
}

/// The joint's friction is what the spec believes of it, and the others are held as it says.
pub(super) fn prepare(
    robot: &mut Robot,
    bench: &JointBench,
    believed: &Nominal,
) -> Result<(), crate::robot::RobotError> {
    let released = robot.model.joint(&bench.name)?;
    for id in robot.model.joint_ids() {
        robot.joints.drive_mut(id).is_rigid = id != released && !bench.others_give;
    }
    let law = &mut robot.joints.drive_mut(released).chain.friction;
    (law.coulomb_nm, law.viscous_nm_s_rad) = (believed.coulomb_nm, believed.viscous_nm_s_rad);
    Ok(())
}

fn leg_joint(blame: &Blame<'_>, bench: &JointBench) -> Result<(Leg, LegJoint), SynthError> {
    let mut all = Leg::ALL.into_iter().flat_map(|leg| LegJoint::ALL.map(|joint| (leg, joint)));
    all.find(|(leg, joint)| joint_name(*leg, *joint) == bench.name).ok_or_else(|| {
        blame.value("[joint] name", format!("\"{}\"", bench.name), "a joint of a leg: lf1, lf2, lf3, rf1 and so on")
    })
}
