//! What is never quite right about a robot and its causes, within what is believed of it.

use super::masses::own_inertias;
use crate::gap::clamped::ClampedSetup;
use crate::log::RobotLog;
use crate::robot::description::{FoundKey, FoundNumber, MoverId};

/// Standard deviations within which a number stays.
const BELIEVED: f64 = 3.0;
/// What turns with a motor is known to this share of what its joint moves.
const ARMATURE: f64 = 0.1;

/// What is never quite right.
pub(super) enum Quantity {
    /// A number of the description.
    Number { key: FoundKey, name: String, unit: &'static str },
    /// A value of a cause, by place among the causes and among its values.
    Value { cause: usize, value: usize },
}

/// Such a quantity with what is believed of it.
pub(super) struct Unknown {
    pub quantity: Quantity,
    pub was: f64,
    pub sd: f64,
}

impl Unknown {
    /// Its value where it has a size.
    pub fn at(&self, size: f64) -> f64 {
        self.was + size * self.sd
    }

    /// The size within what is believed; numbers of the description are not negative.
    pub fn within(&self, size: f64) -> f64 {
        let least = match self.quantity {
            Quantity::Number { .. } => (-self.was / self.sd).clamp(-BELIEVED, 0.0),
            Quantity::Value { .. } => -BELIEVED,
        };
        size.clamp(least, BELIEVED)
    }

    /// Its size in a list of numbers, in standard deviations.
    pub fn size_in(&self, numbers: &[FoundNumber]) -> f64 {
        let Quantity::Number { key, name, .. } = &self.quantity else { return 0.0 };
        let own = numbers.iter().find(|number| number.key == *key && number.name == *name);
        own.map_or(0.0, |own| self.within((own.value - self.was) / self.sd))
    }
}

/// Numbers of the description that logs move, with what is believed of them.
pub(super) fn believed(setup: &ClampedSetup, logs: &[&RobotLog]) -> Vec<Unknown> {
    let (robot, spreads) = (&setup.description, &setup.study.uncertain);
    let mut all = Vec::new();
    let mut add = |key: FoundKey, name: &str, unit: &'static str, was: f64, sd: f64| {
        if sd > 0.0 {
            all.push(Unknown { quantity: Quantity::Number { key, name: name.to_owned(), unit }, was, sd });
        }
    };
    for link in robot.heaviest() {
        let carrier = robot.carriers(link).last().map_or("", |joint| robot.joints[joint.0].name.as_str());
        let body = &robot.links[link.0];
        let mass_kg = body.inertia.mass_kg;
        add(FoundKey::Mass, &body.name, "kg", mass_kg, spreads.mass.of(carrier) * mass_kg);
    }
    let inertias = own_inertias(setup, robot);
    for (at, mover) in robot.joints.iter().enumerate() {
        let name = mover.name.as_str();
        if !logs.iter().any(|log| log.joint(name).is_some_and(|own| own.q_ref_rad.is_some())) {
            continue;
        }
        let said = setup.beliefs(MoverId(at));
        let (friction, gain) = (spreads.friction.of(name), spreads.gain.of(name));
        let coulomb_nm = said.coulomb_nm.unwrap_or(mover.friction_nm);
        add(FoundKey::Frictionloss, name, "N m", coulomb_nm, friction * coulomb_nm);
        let viscous = said.viscous_nm_s_rad.unwrap_or(mover.damping[0]);
        add(FoundKey::Damping, name, "N m s/rad", viscous, friction * viscous);
        let armature = said.armature_kg_m2.unwrap_or(mover.armature_kg_m2);
        let links = inertias.iter().find(|(joint, _)| joint == name).map_or(0.0, |(_, inertia)| *inertia);
        add(FoundKey::Armature, name, "kg m^2", armature, ARMATURE * (armature + links));
        if let Some(kp) = said.kp_nm_rad {
            add(FoundKey::Kp, name, "N m/rad", kp, gain * kp);
        }
        if let Some(kd) = said.kd_nm_s_rad {
            add(FoundKey::Kd, name, "N m s/rad", kd, gain * kd);
        }
    }
    all
}
