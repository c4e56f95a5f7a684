//! What is never quite right about a robot and its causes, within what is believed of it.

use super::masses::own_inertias;
use super::robot::PlacedCause;
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

    /// Whether it is a torque, or makes one: scaled alike with all the others it moves nothing.
    pub fn is_of_torque(&self, causes: &[PlacedCause]) -> bool {
        match &self.quantity {
            Quantity::Number { .. } => true,
            Quantity::Body { key, axis, .. } => *key == FoundKey::Payload && axis.is_none(),
            Quantity::Value { causes: those, value } => {
                let named = those.first().and_then(|first| causes[*first].form.named_parameters().get(*value));
                named.is_some_and(|named| named.unit.contains("N m") || named.unit.contains("kg"))
            }
        }
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
    let stated = |key: FoundKey, name: &str, unit: &'static str, was: f64, sd: f64| {
        number(key, name, unit, was, sd).map(|own| own.with_found(found))
    };
    let mut all = Vec::new();
    for link in robot.heaviest() {
        let carrier = robot.carriers(link).last().map_or("", |joint| robot.joints[joint.0].name.as_str());
        let body = &robot.links[link.0];
        let mass_kg = body.inertia.mass_kg;
        all.extend(stated(FoundKey::Mass, &body.name, "kg", mass_kg, spreads.mass.of(carrier) * mass_kg));
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
        all.extend(stated(FoundKey::Frictionloss, name, "N m", coulomb_nm, friction * coulomb_nm));
        let viscous = said.viscous_nm_s_rad.unwrap_or(mover.damping[0]);
        all.extend(stated(FoundKey::Damping, name, "N m s/rad", viscous, friction * viscous));
        let armature = said.armature_kg_m2.unwrap_or(mover.armature_kg_m2);
        let links = inertias.iter().find(|(joint, _)| joint == name).map_or(0.0, |(_, inertia)| *inertia);
        all.extend(stated(FoundKey::Armature, name, "kg m^2", armature, ARMATURE * (armature + links)));
        if let Some(kp) = said.kp_nm_rad {
            let is_logged = logs.iter().any(|log| log.joint(name).is_some_and(|own| own.tau_nm.is_some()));
            let is_seen = is_logged && matches!(said.tau_is, Some(TauIs::Applied | TauIs::Current { .. }));
            all.extend(match is_seen {
                true => seen_gain(name, kp, [gain, spreads.torque.of(name)], found),
                false => stated(FoundKey::Kp, name, "N m/rad", kp, gain * kp),
            });
        }
        if let Some(kd) = said.kd_nm_s_rad {
            all.extend(stated(FoundKey::Kd, name, "N m s/rad", kd, gain * kd));
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

/// A number of the description where it is stated, if it is uncertain.
fn number(key: FoundKey, name: &str, unit: &'static str, was: f64, sd: f64) -> Option<Unknown> {
    let quantity = Quantity::Number { key, name: name.to_owned(), unit };
    (sd > 0.0).then_some(Unknown { quantity, was, centre: was, sd })
}

/// The gain of a drive whose torques are logged \[N m/rad\]: where they show it, and known as well as what is stated of it and
/// they, each to a share of its own, do together.
fn seen_gain(name: &str, was: f64, [gain, torque]: [f64; 2], found: &[FoundNumber]) -> Option<Unknown> {
    let known_to = (gain.powi(-2) + torque.powi(-2)).sqrt().recip();
    let own = number(FoundKey::Kp, name, "N m/rad", was, known_to * was)?;
    let shown = own.found_in(found).map(|shown| shown.value).filter(|value| *value > 0.0);
    let centre = shown.unwrap_or(was);
    Some(Unknown { centre, sd: known_to * centre, ..own })
}

/// Whether a number is of a body with a place of its own.
pub(super) fn is_body(number: &FoundNumber) -> bool {
    matches!(number.key, FoundKey::Payload | FoundKey::Centre)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(key: FoundKey, was: f64, value: f64) -> FoundNumber {
        let (name, unit) = ("elbow".to_owned(), String::new());
        FoundNumber { name, key, was: Some(was), value, interval: None, unit, place_m: None }
    }

    fn friction(was: f64, found_nm: f64) -> Unknown {
        let own = number(FoundKey::Frictionloss, "elbow", "N m", was, 0.03).unwrap();
        own.with_found(&[found(FoundKey::Frictionloss, was, found_nm)])
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

    #[test]
    fn a_gain_that_torques_show_is_known_by_them_and_as_stated_and_was_what_is_stated() {
        let shown = [found(FoundKey::Kp, 10.0, 12.5)];
        let of = |gain: f64, torque: f64| seen_gain("elbow", 10.0, [gain, torque], &shown);
        let both = of(0.3, 0.4).unwrap();
        assert_eq!((both.was, both.centre), (10.0, 12.5));
        assert!((both.sd - 0.24 * 12.5).abs() < 1e-12, "{}", both.sd);
        assert_eq!(both.size_in(&shown), 0.0);
        assert!(of(0.0, 0.1).is_none() && of(0.1, 0.0).is_none(), "what is exact is not uncertain");
        let untold = seen_gain("elbow", 10.0, [0.3, 0.4], &[]).unwrap();
        assert!(untold.centre == 10.0 && (untold.sd - 2.4).abs() < 1e-12, "{}", untold.sd);
    }
}
