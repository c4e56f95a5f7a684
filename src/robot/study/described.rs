//! A robot that somebody else described, with what a study believes of it.

use crate::geometry::robot_file::GAIN_SET;
use crate::log::{DescribedSpec, JointBeliefs};
use crate::robot::description::{Description, FoundKey, FoundNumber, NoSuchPart};
use crate::robot::{Model, RobotError};
use std::path::Path;

/// How a robot that somebody else described is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Free of the world, as [`Model::standing`].
    Standing,
    /// Its base as the file holds it, in the file's axes.
    AsDescribed,
}

/// Reads a URDF or MJCF, with a study's beliefs in the place of what it says; and what in the file looks like a mistake.
///
/// # Errors
/// [`RobotError`] where the file cannot be read or simulated, names joints or links that it has not, or no joint has a servo.
pub fn read_described(file: &Path, spec: &DescribedSpec, wanted: Wanted) -> Result<(Model, Vec<String>), RobotError> {
    let description = Description::read(file)?;
    let no = |what: String| RobotError::NotSimulated { robot: description.name.clone(), what };
    if let Some(what) = description.too_heavy_to_move() {
        return Err(no(what));
    }
    let believed = with_beliefs(&description, spec).map_err(|error| no(format!("[joints]: {error}")))?;
    let model = match wanted {
        Wanted::Standing => Model::standing(&believed, &spec.feet_m)?,
        Wanted::AsDescribed => Model::of_description(&believed)?,
    };
    if model.joint_ids().all(|joint| model.gains(GAIN_SET, joint).is_none()) {
        let what = "no joint has a position servo: a URDF has none, of an MJCF <position> is one; state kp and kd, in [joints.default] of a \
                    study or by walk --servo";
        return Err(no(what.to_owned()));
    }
    Ok((model, description.warnings))
}

/// A description with what a study says of its joints.
fn with_beliefs(description: &Description, spec: &DescribedSpec) -> Result<Description, NoSuchPart> {
    if let Some(name) = spec.by_joint.keys().find(|name| description.joint(name).is_none()) {
        return Err(NoSuchPart { what: "joint", name: name.clone() });
    }
    let mut numbers = Vec::new();
    for (at, mover) in description.joints.iter().enumerate() {
        // A joint that follows another has no motor of its own.
        let follows = description.couplings.iter().any(|coupling| coupling.follower.0 == at);
        let said = spec.of_joint(&mover.name);
        let is_driven = said.kp_nm_rad.is_some() && !follows;
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
