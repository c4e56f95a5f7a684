//! A robot that somebody else described, with what a study believes of it.

use crate::geometry::robot_file::GAIN_SET;
use crate::log::{DescribedBeliefs, JointBeliefs};
use crate::robot::description::{Description, FoundKey, FoundNumber, NoSuchPart};
use crate::robot::{Model, RobotError};
use std::path::Path;

/// How a robot that somebody else described is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Free of the world, as [`Model::standing`].
    Standing,
    /// Held: where the file sets its base free, as [`Model::standing`], else as the file holds it, in the file's axes.
    InAir,
}

/// Reads a URDF or MJCF, with a study's beliefs in the place of what it says; and what in the file looks like a mistake.
///
/// # Errors
/// [`RobotError`] where the file cannot be read or simulated, or names joints or links that it has not.
pub fn read_described(
    file: &Path,
    spec: &DescribedBeliefs,
    wanted: Wanted,
) -> Result<(Model, Vec<String>), RobotError> {
    let description = Description::read(file)?.with_equalities();
    if let Some(what) = description.too_heavy_to_move() {
        return Err(RobotError::NotSimulated { robot: description.name, what });
    }
    let believed = with_beliefs(&description, spec).map_err(|NoSuchPart { name, .. }| RobotError::NoJoint {
        robot: description.name.clone(),
        name,
        joints: description.joints.iter().map(|joint| joint.name.clone()).collect(),
    })?;
    let model = match wanted {
        Wanted::InAir if description.free_joint.is_none() => Model::of_description(&believed)?,
        Wanted::InAir | Wanted::Standing => Model::standing(&believed, &spec.feet_m)?,
    };
    Ok((model, description.warnings))
}

/// That no joint of such a robot follows setpoints is an error, unless a study has gains of its own for them.
///
/// # Errors
/// [`RobotError::NotSimulated`] says who may state them.
pub fn check_servos(model: &Model) -> Result<(), RobotError> {
    if model.joint_ids().any(|joint| model.gains(GAIN_SET, joint).is_some()) {
        return Ok(());
    }
    let what = "no joint has a position servo: a URDF has none, of an MJCF <position> is one; state kp and kd, in \
                [joints.default] of a study or by walk --servo";
    Err(RobotError::NotSimulated { robot: model.name().to_owned(), what: what.to_owned() })
}

/// A description with what a study says of its joints.
fn with_beliefs(description: &Description, spec: &DescribedBeliefs) -> Result<Description, NoSuchPart> {
    if let Some(name) = spec.by_joint.keys().find(|name| description.joint(name).is_none()) {
        return Err(NoSuchPart { what: "joint", name: name.clone() });
    }
    let mut numbers = Vec::new();
    for (at, mover) in description.joints.iter().enumerate() {
        // A joint that follows another has no motor of its own.
        let follows = description.couplings.iter().any(|coupling| coupling.follower.0 == at);
        let said = spec.of_joint(&mover.name);
        let mut its = description.actuators.iter().filter(|actuator| actuator.joint.0 == at);
        let has_servo = its.any(|actuator| actuator.as_servo().is_some());
        let is_driven = (said.kp_nm_rad.is_some() || has_servo) && !follows;
        let is_bare = description.actuators.iter().all(|actuator| actuator.joint.0 != at);
        let of_file = mover.effort_nm.filter(|most_nm| is_bare && *most_nm > 0.0);
        let JointBeliefs {
            coulomb_nm, viscous_nm_s_rad, armature_kg_m2, kp_nm_rad, kd_nm_s_rad, torque_limit_nm, ..
        } = said;
        let values = [
            (FoundKey::Frictionloss, coulomb_nm),
            (FoundKey::Damping, viscous_nm_s_rad),
            (FoundKey::Armature, armature_kg_m2),
            (FoundKey::Kp, kp_nm_rad.filter(|_| is_driven)),
            (FoundKey::Kd, kd_nm_s_rad.filter(|_| is_driven)),
            (FoundKey::TorqueLimit, torque_limit_nm.or(of_file).filter(|_| is_driven)),
        ];
        numbers.extend(values.into_iter().filter_map(|(key, value)| {
            let (name, was, interval, unit) = (mover.name.clone(), None, None, String::new());
            Some(FoundNumber { name, key, was, value: value?, interval, unit, place_m: None })
        }));
    }
    description.with_found(&numbers)
}
