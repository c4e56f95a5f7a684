//! What is never quite right about a robot and its causes, within what is believed of it.

use super::masses::own_inertias;
use crate::gap::clamped::{BELIEVED, ClampedSetup};
use crate::log::{RobotLog, TauIs};
use crate::robot::description::{FoundKey, FoundNumber, MoverId};

/// What turns with a motor is known to this share of what its joint moves.
const ARMATURE: f64 = 0.1;
/// The mass of a body that torques ask for is known to this share, and its place so well \[m\].
const BODY_SHARE: f64 = 0.5;
const PLACE_M: f64 = 0.05;

/// What is never quite right.
pub(super) enum Quantity {
    /// A number of the description.
    Number { key: FoundKey, name: String, unit: &'static str },
    /// Of a body that was found its mass, or its place along an axis of the link's frame.
    Body { key: FoundKey, name: String, axis: Option<usize> },
    /// A value that causes have alike, by their places and by its own among their values.
    Value { causes: Vec<usize>, value: usize },
}

/// Such a quantity with what is believed of it.
pub(super) struct Unknown {
    pub quantity: Quantity,
    pub was: f64,
    /// Where it is believed to be: where it was, or was found to be far from that.
    pub centre: f64,
    pub sd: f64,
}

impl Unknown {
    /// Its value where it has a size.
    pub fn at(&self, size: f64) -> f64 {
        self.centre + size * self.sd
    }

    /// The size within what is believed; numbers of the description and masses are not negative.
    pub fn within(&self, size: f64) -> f64 {
        let least = match self.quantity {
            Quantity::Number { .. } | Quantity::Body { axis: None, .. } => {
                (-self.centre / self.sd).clamp(-BELIEVED, 0.0)
            }
            Quantity::Body { .. } | Quantity::Value { .. } => -BELIEVED,
        };
        size.clamp(least, BELIEVED)
    }

    /// Its size in a list of numbers, in standard deviations.
    pub fn size_in(&self, numbers: &[FoundNumber]) -> f64 {
        self.found_in(numbers).map_or(0.0, |own| self.within((own.value - self.centre) / self.sd))
    }

    /// What a list of numbers has of it.
    fn found_in<'a>(&self, numbers: &'a [FoundNumber]) -> Option<&'a FoundNumber> {
        let Quantity::Number { key, name, .. } = &self.quantity else { return None };
        numbers.iter().find(|number| number.key == *key && number.name == *name)
    }

    /// The same believed where it was found, and known as well in proportion to what was stated, if anything was, where that is
    /// further from what was believed than anyone would go.
    fn with_found(self, numbers: &[FoundNumber]) -> Self {
        match self.found_in(numbers) {
            Some(own) if (own.value - self.was).abs() > BELIEVED * self.sd && own.value > 0.0 => {
                let share = if self.was > 0.0 { own.value / self.was } else { 1.0 };
                Self { centre: own.value, sd: self.sd * share, ..self }
            }
            _ => self,
        }
    }
}

/// Numbers of the description that logs move, with what is believed of them where `found` has none far from that; and bodies
/// in `found`, about where they are there.
pub(super) fn believed(setup: &ClampedSetup, logs: &[&RobotLog], found: &[FoundNumber]) -> Vec<Unknown> {
    let (robot, spreads) = (&setup.description, &setup.study.uncertain);
    let mut all = Vec::new();
    let mut add = |key: FoundKey, name: &str, unit: &'static str, was: f64, sd: f64| {
        if sd > 0.0 {
            let quantity = Quantity::Number { key, name: name.to_owned(), unit };
            all.push(Unknown { quantity, was, centre: was, sd }.with_found(found));
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
            // A drive whose torques are logged has the gain that they show, as well as they are known.
            let is_logged = logs.iter().any(|log| log.joint(name).is_some_and(|own| own.tau_nm.is_some()));
            let is_seen = is_logged && matches!(said.tau_is, Some(TauIs::Applied | TauIs::Current { .. }));
            let shown = found.iter().find(|own| is_seen && own.key == FoundKey::Kp && own.name == name);
            let sd = if is_seen { spreads.torque.of(name) } else { gain };
            let kp = shown.map_or(kp, |own| own.value);
            add(FoundKey::Kp, name, "N m/rad", kp, sd * kp);
        }
        if let Some(kd) = said.kd_nm_s_rad {
            add(FoundKey::Kd, name, "N m s/rad", kd, gain * kd);
        }
    }
    for body in found.iter().filter(|number| is_body(number)) {
        let mass = (body.key == FoundKey::Payload).then_some((None, body.value, BODY_SHARE * body.value));
        let place = body.place_m.into_iter().flatten().enumerate();
        let parts = mass.into_iter().chain(place.map(|(axis, at)| (Some(axis), at, PLACE_M)));
        all.extend(parts.filter(|(_, _, sd)| *sd > 0.0).map(|(axis, was, sd)| {
            let quantity = Quantity::Body { key: body.key, name: body.name.clone(), axis };
            Unknown { quantity, was, centre: was, sd }
        }));
    }
    all
}

/// Whether a number is of a body with a place of its own.
pub(super) fn is_body(number: &FoundNumber) -> bool {
    matches!(number.key, FoundKey::Payload | FoundKey::Centre)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn friction(was: f64, found_nm: f64) -> Unknown {
        let name = || "elbow".to_owned();
        let quantity = Quantity::Number { key: FoundKey::Frictionloss, name: name(), unit: "N m" };
        let found = FoundNumber {
            name: name(),
            key: FoundKey::Frictionloss,
            was: Some(was),
            value: found_nm,
            interval: None,
            unit: "N m".to_owned(),
            place_m: None,
        };
        Unknown { quantity, was, centre: was, sd: 0.03 }.with_found(&[found])
    }

    #[test]
    fn what_was_found_far_from_what_was_believed_is_believed_there_and_as_well_in_proportion() {
        let far = friction(0.1, 0.9);
        assert_eq!((far.was, far.centre), (0.1, 0.9));
        assert!((far.sd - 0.27).abs() < 1e-12, "{}", far.sd);
        assert_eq!((far.within(-9.0), far.within(9.0)), (-BELIEVED, BELIEVED));
        let near = friction(0.1, 0.15);
        assert_eq!((near.centre, near.sd), (0.1, 0.03));
    }

    #[test]
    fn what_was_found_where_nothing_was_stated_is_kept() {
        let (found, little) = (friction(0.0, 0.9), friction(0.0, 0.05));
        assert_eq!((found.was, found.centre, found.sd), (0.0, 0.9, 0.03));
        assert_eq!((little.centre, little.sd), (0.0, 0.03));
    }
}
