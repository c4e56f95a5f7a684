//! What was found, as numbers of the description, and what no description can say.

use super::masses::{masses, own_inertias};
use crate::gap::clamped::{BodyCause, BodyKind, ClampedDiagnosis, ClampedSetup};
use crate::gap::hypothesis::rotor::armature_kg_m2;
use crate::gap::{CauseShare, Diagnosis, Number, Verdict};
use crate::identify::Estimate;
use crate::joint::EffectId;
use crate::number::quantity;
use crate::robot::description::{Description, FoundKey, FoundNumber, MoverId, NoSuchPart};

/// Numbers that are so near to what they were have not changed.
const SAME: f64 = 1e-9;

/// A robot with what was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FoundRobot {
    /// Numbers of the description that are others, those that the study has beyond it included.
    pub numbers: Vec<FoundNumber>,
    /// What descriptions have no word for.
    pub cannot_say: Vec<String>,
}

/// What study and diagnosis make of a robot; without a diagnosis what the study alone does.
///
/// # Errors
/// [`NoSuchPart`] where the diagnosis is of another robot.
pub fn found_robot(setup: &ClampedSetup, diagnosis: Option<&ClampedDiagnosis>) -> Result<FoundRobot, NoSuchPart> {
    let mut found = FoundRobot::default();
    let bodies = diagnosis.map_or(&[][..], |diagnosis| &diagnosis.bodies);
    let weighed = diagnosis.map_or(&[][..], |diagnosis| &diagnosis.weighed);
    let is_weighed = |body: &FoundNumber| weighed.iter().any(|own| own.key == body.key && own.name == body.name);
    let bodies: Vec<FoundNumber> = bodies.iter().map(|body| of_body(body, &setup.description)).collect();
    let with_bodies = setup.description.with_found(&bodies)?;
    found.numbers.extend(bodies.into_iter().filter(|body| !is_weighed(body)));
    let joints: Vec<&Diagnosis> = diagnosis.iter().flat_map(|d| d.found()).collect();
    found.numbers.extend_from_slice(weighed);
    let (masses, missed) = match weighed.is_empty() {
        true => masses(setup, &with_bodies, &joints),
        false => Default::default(),
    };
    for mass in masses {
        let link = &with_bodies.links[mass.link.0];
        let (was, value) = (link.inertia.mass_kg, mass.factor * link.inertia.mass_kg);
        found.numbers.push(FoundNumber {
            name: link.name.clone(),
            key: FoundKey::Mass,
            was: Some(was),
            value,
            interval: mass.half.map(|half| [value - half * was, value + half * was]),
            unit: "kg".to_owned(),
            place_m: None,
        });
    }
    found.cannot_say.extend(missed.into_iter().map(|joint| {
        format!("{joint}: its moment as found is none that masses of the bodies as they are shaped can give")
    }));
    let [described, changed] = [&with_bodies, &setup.description.with_found(&found.numbers)?];
    let inertias = shares(&own_inertias(setup, described), &own_inertias(setup, changed));
    for at in (0..setup.description.joints.len()).map(MoverId) {
        let name = &setup.description.joints[at.0].name;
        // A joint that lacks nothing keeps its numbers.
        let own = joints.iter().find(|d| d.joint == *name && d.answer.verdict != Verdict::None);
        let links = inertias.iter().find(|(joint, _)| joint == name).map(|(_, share)| *share);
        of_joint(setup, at, own.copied(), links, &mut found);
    }
    Ok(found)
}

/// A body as a number of the description.
pub(super) fn of_body(body: &BodyCause, description: &Description) -> FoundNumber {
    let number = |name: &str| body.parameters.iter().find(|number| number.name == name);
    let place_m = ["x", "y", "z"].map(|axis| number(axis).map_or(0.0, |number| number.value));
    let inertia = &description.links[body.link.0].inertia;
    let mass = number("mass");
    FoundNumber {
        name: body.body.clone(),
        key: match body.kind {
            BodyKind::Payload => FoundKey::Payload,
            BodyKind::BodyMass => FoundKey::Mass,
            BodyKind::BodyCom => FoundKey::Centre,
        },
        was: (body.kind != BodyKind::Payload).then_some(inertia.mass_kg),
        value: mass.map_or(inertia.mass_kg, |mass| mass.value),
        interval: mass.and_then(|mass| mass.interval),
        unit: "kg".to_owned(),
        place_m: (body.kind != BodyKind::BodyMass).then_some(place_m),
    }
}

/// By joint how many times the inertia of its links is what it was.
fn shares(was: &[(String, f64)], now: &[(String, f64)]) -> Vec<(String, f64)> {
    let share = |((joint, was), (_, now)): (&(String, f64), &(String, f64))| (joint.clone(), now / was);
    was.iter().zip(now).map(share).filter(|(_, share)| share.is_finite()).collect()
}

/// `links`: how many times the inertia of what the joint carries is that described, by the masses that were found.
fn of_joint(setup: &ClampedSetup, at: MoverId, own: Option<&Diagnosis>, links: Option<f64>, found: &mut FoundRobot) {
    let mover = &setup.description.joints[at.0];
    let said = setup.beliefs(at);
    let estimate = |name: &str| own?.parameters.iter().find(|p| p.name == name);
    let mut push = |key: FoundKey, was: Option<f64>, value: f64, interval: Option<[f64; 2]>, unit: &str| {
        let is_weighed = found.numbers.iter().any(|number| number.key == key && number.name == mover.name);
        if !is_weighed && (value - was.unwrap_or(0.0)).abs() > SAME * value.abs().max(1e-9) {
            let (name, unit) = (mover.name.clone(), unit.to_owned());
            found.numbers.push(FoundNumber { name, key, was, value, interval, unit, place_m: None });
        }
    };
    let coulomb = estimate("coulomb");
    let coulomb_nm = coulomb.map_or(said.coulomb_nm.unwrap_or(mover.friction_nm), |e| e.value);
    push(FoundKey::Frictionloss, Some(mover.friction_nm), coulomb_nm, coulomb.and_then(|e| e.interval), "N m");
    let viscous = estimate("viscous");
    let viscous_nm = viscous.map_or(said.viscous_nm_s_rad.unwrap_or(mover.damping[0]), |e| e.value);
    push(FoundKey::Damping, Some(mover.damping[0]), viscous_nm, viscous.and_then(|e| e.interval), "N m s/rad");
    let armature = estimate("armature");
    let stated = said.armature_kg_m2.unwrap_or(mover.armature_kg_m2);
    // Links have the inertia that their masses give; of all that was found to turn the rest is the motor's. Both are counted over
    // the motion along which the joint was searched.
    let inertia = estimate("inertia").zip(links).and_then(|(own, share)| Some((own, share * own.nominal?)));
    let of_motor = |own: &Estimate, links: f64, value: f64| {
        let geared = own.nominal.map_or(stated, |nominal| armature_kg_m2(stated, value / nominal));
        (armature.map_or(geared, |e| e.value) + value - links).max(0.0)
    };
    let value = inertia.map_or(armature.map_or(stated, |e| e.value), |(own, links)| of_motor(own, links, own.value));
    let interval =
        inertia.and_then(|(own, links)| own.interval.map(|range| range.map(|end| of_motor(own, links, end))));
    push(FoundKey::Armature, Some(mover.armature_kg_m2), value, interval, "kg m^2");
    let gain = estimate("gain");
    let times = gain.map_or(1.0, |e| e.value);
    let around = |value: f64| gain.and_then(|e| e.interval).map(|range| range.map(|end| end * value));
    let described = setup.servo(at);
    if let Some(kp) = said.kp_nm_rad {
        push(FoundKey::Kp, described.as_ref().map(|servo| servo.gain), times * kp, around(kp), "N m/rad");
        let kd = said.kd_nm_s_rad.unwrap_or(0.0);
        let of_kd = estimate("kd");
        let share = of_kd.map_or(1.0, |e| e.value);
        let interval = of_kd.and_then(|e| e.interval).map(|range| range.map(|end| end * times * kd)).or(around(kd));
        push(FoundKey::Kd, described.as_ref().map(|servo| -servo.bias[2]), times * share * kd, interval, "N m s/rad");
        let limit = own.and_then(|d| d.causes.iter().find(|cause| is_limit(cause)));
        let limit = limit.and_then(|cause| cause.parameters.first());
        let was = setup.described(at).torque_limit_nm;
        if let Some(value) = limit.map(|n| n.value).or(said.torque_limit_nm) {
            push(FoundKey::TorqueLimit, was, value, limit.and_then(|n| n.interval), "N m");
        }
    }
    let Some(own) = own else { return };
    for cause in &own.causes {
        let numbers: Vec<String> = cause
            .parameters
            .iter()
            .map(|n| format!("{} = {}", n.name, quantity(n.value, n.interval, &n.unit)))
            .collect();
        let said = as_numbers(cause, mover.stiffness[0] != 0.0);
        for (key, was, number, unit) in &said {
            push(*key, *was, number.value, number.interval, unit);
        }
        // A description has static friction, but not how it fades.
        if !is_limit(cause) && (said.is_empty() || cause.effect == EffectId::Stribeck) {
            let only = cause.only.as_ref().map_or(String::new(), |only| format!(" {}", only.words));
            found.cannot_say.push(format!("{}: {}{only} ({})", mover.name, cause.effect, numbers.join(", ")));
        }
    }
    if let Some(law) = &own.law {
        found.cannot_say.push(format!("{}: a law ({})", mover.name, law.table.looks_like));
    }
}

/// Whether a cause is a limit of the servo, as a description has it.
fn is_limit(cause: &CauseShare) -> bool {
    cause.effect == EffectId::TorqueLimit && cause.only.is_none()
}

/// What a description says of a cause, with what it was and its unit: nothing of one that holds in some logs only.
fn as_numbers(cause: &CauseShare, has_spring: bool) -> Vec<(FoundKey, Option<f64>, &Number, &'static str)> {
    if cause.only.is_some() {
        return Vec::new();
    }
    match (cause.effect, &cause.parameters[..]) {
        (EffectId::Delay, [late]) => vec![(FoundKey::Delay, None, late, "s")],
        (EffectId::AngleOffset, [zero]) => vec![(FoundKey::EncoderZero, None, zero, "rad")],
        (EffectId::JointSpring, [k, rest]) if !has_spring => {
            vec![(FoundKey::Stiffness, Some(0.0), k, "N m/rad"), (FoundKey::Springref, None, rest, "rad")]
        }
        (EffectId::Stribeck, [most, ..]) => vec![(FoundKey::StaticFriction, None, most, "N m")],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::LogSet;

    #[test]
    fn inertias_are_told_by_what_they_were() {
        let of = |joint: &str, inertia| (joint.to_owned(), inertia);
        let shares = shares(&[of("a", 0.2), of("b", 0.0)], &[of("a", 0.3), of("b", 0.0)]);
        assert!(shares.len() == 1 && shares[0].0 == "a" && (shares[0].1 - 1.5).abs() < 1e-12);
    }

    #[test]
    fn springs_and_limits_of_some_logs_only_are_no_numbers_of_the_description() {
        let number = |name: &str, value| Number {
            name: name.to_owned(),
            value,
            unit: String::new(),
            interval: None,
            interval_naive: None,
        };
        let cause = |effect, only: Option<LogSet>| CauseShare {
            effect,
            form: "",
            only,
            equivalent: vec![effect],
            parameters: vec![number("k", 0.2), number("rest", 0.1)],
            alone: None,
            last: None,
            after: 0.0,
        };
        let late = || Some(LogSet { files: vec!["late.csv".to_owned()], words: "in late.csv only".to_owned() });
        assert_eq!(as_numbers(&cause(EffectId::JointSpring, None), false).len(), 2);
        assert!(as_numbers(&cause(EffectId::JointSpring, late()), false).is_empty());
        assert!(as_numbers(&cause(EffectId::JointSpring, None), true).is_empty());
        assert!(is_limit(&cause(EffectId::TorqueLimit, None)) && !is_limit(&cause(EffectId::TorqueLimit, late())));
    }
}
