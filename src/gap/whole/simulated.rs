//! One simulation of the whole robot under the study's setpoints, as stated and with all that was found.

use super::numbers::{FoundRobot, found_robot};
use super::robot::{PlacedCause, WholeRobot, placed_causes};
use crate::gap::clamped::{ClampedDiagnosis, ClampedSetup};
use crate::log::{DriveMode, RobotLog, Role};
use crate::robot::description::FoundNumber;
use std::fmt::Write as _;

/// A joint whose error grows by this share and this much is worse with what was found \[rad\].
const WORSE: f64 = 1.1;
const WORSE_RAD: f64 = 1e-3;

/// How far the whole robot is off on held-out logs.
#[derive(Clone, Debug, PartialEq)]
pub struct Whole {
    /// Root of the mean square over all joints as stated \[rad\].
    pub before: f64,
    /// With all that was found, less what is in `left_out` \[rad\].
    pub after: f64,
    /// The same of each joint.
    pub joints: Vec<WholeJoint>,
    /// Predicted logs: the log's name, and `t,<joint>.q` as CSV.
    pub predicted: Vec<(String, String)>,
    /// What was found and makes the whole robot worse than as stated; `robot` lacks it.
    pub left_out: Vec<LeftOut>,
    /// What the whole was simulated with.
    pub robot: FoundRobot,
    /// The first log that is shown.
    pub shown: WholeMotion,
}

/// Readings of a log's joints in its order, at its samples \[rad\].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WholeMotion {
    /// The log's place in the study.
    pub log: usize,
    /// As stated.
    pub before: Vec<Vec<f64>>,
    /// With what was found.
    pub after: Vec<Vec<f64>>,
}

/// A joint of a whole robot.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct WholeJoint {
    /// Its name.
    pub joint: String,
    /// As stated \[rad\].
    pub before: f64,
    /// With all that was found \[rad\].
    pub after: f64,
}

/// A change that makes the whole robot worse.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct LeftOut {
    /// The joint whose numbers and causes it is; `None`: the masses that moments were made of.
    pub joint: Option<String>,
    /// Error of the whole robot with it \[rad\].
    pub with_it: f64,
    /// Without it \[rad\].
    pub without_it: f64,
}

/// What a prediction of logs comes to.
struct Told {
    all: f64,
    joints: Vec<(String, f64)>,
    predicted: Vec<(String, String)>,
    /// The first log's place in the study, and its readings.
    first: (usize, Vec<Vec<f64>>),
}

/// Simulates the whole robot on the held-out logs that setpoints drive, or else on the fitted ones. Where a joint is worse
/// than as stated with all that was found, first the masses that moments were made of are left out, then the changes of
/// joints, the worst first, as long as that helps.
///
/// # Errors
/// Why it cannot be, in words.
pub fn simulated(setup: &ClampedSetup, diagnosis: &ClampedDiagnosis) -> Result<Whole, String> {
    let of = |diagnosis| found_robot(setup, diagnosis).map_err(|error| error.to_string());
    let (stated, found) = (of(None)?, of(Some(diagnosis))?);
    let predict = |numbers: &[FoundNumber], causes: &[PlacedCause]| predicted(setup, numbers, causes);
    let before = predict(&stated.numbers, &[])?;
    let is_mass = |number: &FoundNumber| !number.key.is_of_joint() && !is_of_body(diagnosis, number);
    let kept = kept(&before, &stated, found, placed_causes(diagnosis), &is_mass, &predict);
    let (after, left_out) = (kept.told?, kept.left_out);
    let joints = before.joints.iter().zip(&after.joints).map(|((joint, before), (_, after))| WholeJoint {
        joint: joint.clone(),
        before: *before,
        after: *after,
    });
    let (joints, robot) = (joints.collect(), kept.found);
    let shown = WholeMotion { log: after.first.0, before: before.first.1, after: after.first.1 };
    Ok(Whole { before: before.all, after: after.all, joints, predicted: after.predicted, left_out, robot, shown })
}

/// What numbers and causes make of the logs.
type Predict<'a> = dyn Fn(&[FoundNumber], &[PlacedCause]) -> Result<Told, String> + 'a;

/// What stays of what was found, and what it predicts.
struct Kept {
    told: Result<Told, String>,
    found: FoundRobot,
    left_out: Vec<LeftOut>,
}

/// Leaves out what makes a joint worse than as stated: first the masses, then the changes of joints.
fn kept(
    before: &Told,
    stated: &FoundRobot,
    mut found: FoundRobot,
    mut causes: Vec<PlacedCause>,
    is_mass: &dyn Fn(&FoundNumber) -> bool,
    predict: &Predict<'_>,
) -> Kept {
    let mut told = predict(&found.numbers, &causes);
    let error = |told: &Result<Told, String>| told.as_ref().map_or(f64::INFINITY, |told| told.all);
    let mut left_out: Vec<LeftOut> = Vec::new();
    let mut are_masses_next = found.numbers.iter().any(is_mass);
    // One round for the masses, and one for each joint.
    for _ in 0..=before.joints.len() {
        let Some(worst) = worst(before, &told) else { break };
        let joint = (!std::mem::take(&mut are_masses_next)).then_some(worst);
        let (mut less, mut fewer) = (found.clone(), causes.clone());
        match &joint {
            None => less.numbers.retain(|number| !is_mass(number)),
            Some(joint) => {
                less.numbers.retain(|number| !number.key.is_of_joint() || number.name != *joint);
                less.numbers.extend(stated.numbers.iter().filter(|number| number.name == *joint).cloned());
                fewer.retain(|cause| cause.joint != *joint);
            }
        }
        let tried = predict(&less.numbers, &fewer);
        let (with_it, without_it) = (error(&told), error(&tried));
        // Of a robot that runs away with its masses and without them, a joint may be the reason: it is tried without them.
        let helps = without_it < with_it || joint.is_none() && told.is_err();
        match helps {
            true => {
                left_out.push(LeftOut { joint, with_it, without_it });
                (told, found, causes) = (tried, less, fewer);
            }
            false if joint.is_some() => break,
            false => {}
        }
    }
    let without_it = error(&told);
    left_out.iter_mut().filter(|left| left.without_it.is_infinite()).for_each(|left| left.without_it = without_it);
    Kept { told, found, left_out }
}

/// The joint that is worst off beside what it is as stated; where the robot runs away, the one that is worst as stated.
fn worst(before: &Told, after: &Result<Told, String>) -> Option<String> {
    let Ok(after) = after else {
        let most = before.joints.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        return most.map(|(joint, _)| joint.clone());
    };
    let pairs = before.joints.iter().zip(&after.joints);
    let worse = pairs.filter(|((_, before), (_, after))| *after > WORSE * before && *after > before + WORSE_RAD);
    let most = worse.max_by(|a, b| (a.1.1 - a.0.1).total_cmp(&(b.1.1 - b.0.1)));
    most.map(|((joint, _), _)| joint.clone())
}

/// Whether a number is that of a body that the diagnosis names.
fn is_of_body(diagnosis: &ClampedDiagnosis, number: &FoundNumber) -> bool {
    diagnosis.bodies.iter().any(|body| body.body == number.name)
}

/// Predicts the logs that are shown.
fn predicted(setup: &ClampedSetup, numbers: &[FoundNumber], causes: &[PlacedCause]) -> Result<Told, String> {
    let entries = setup.study.logs.iter().zip(&setup.logs).enumerate();
    let entries = entries.filter(|(_, (entry, _))| entry.drive == DriveMode::Position);
    let (held_out, fitted): (Vec<_>, Vec<_>) = entries.partition(|(_, (entry, _))| entry.role == Role::Validate);
    let shown = if held_out.is_empty() { fitted } else { held_out };
    if shown.is_empty() {
        return Err("no log is driven by setpoints".to_owned());
    }
    let mut robot = WholeRobot::of(setup, numbers, causes)?;
    let (mut joints, mut samples, mut predicted) = (Vec::<(String, f64)>::new(), 0, Vec::new());
    let mut first = None;
    for (place, (entry, log)) in shown {
        let motion = robot.readings(setup, log)?;
        for (joint, motion) in log.joints.iter().zip(&motion) {
            let squares = joint.q_rad.iter().zip(motion).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            match joints.iter_mut().find(|(name, _)| *name == joint.name) {
                Some((_, sum)) => *sum += squares,
                None => joints.push((joint.name.clone(), squares)),
            }
        }
        samples += log.len();
        predicted.push((entry.file.clone(), predicted_csv(log, &motion)));
        first.get_or_insert((place, motion));
    }
    joints.iter_mut().for_each(|(_, sum)| *sum = (*sum / samples as f64).sqrt());
    let all = (joints.iter().map(|(_, rms)| rms * rms).sum::<f64>() / joints.len().max(1) as f64).sqrt();
    Ok(Told { all, joints, predicted, first: first.unwrap_or_default() })
}

/// Predicted readings as a log.
pub(crate) fn predicted_csv(log: &RobotLog, motion: &[Vec<f64>]) -> String {
    let names: Vec<String> = log.joints.iter().map(|joint| format!("{}.q", joint.name)).collect();
    let mut text = format!("t,{}\n", names.join(","));
    for (k, t) in log.t_s.iter().enumerate() {
        let _ = write!(text, "{t:.6}");
        motion.iter().for_each(|joint| {
            let _ = write!(text, ",{:.7}", joint[k]);
        });
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::description::FoundKey;

    fn number(name: &str, key: FoundKey, value: f64) -> FoundNumber {
        let (name, unit) = (name.to_owned(), String::new());
        FoundNumber { name, key, was: None, value, interval: None, unit, place_m: None }
    }

    /// Joints `a` and `b`, 20 mrad off as stated, that numbers put right or further off.
    fn told(numbers: &[FoundNumber], causes: &[PlacedCause]) -> Result<Told, String> {
        let off = |joint: &str| {
            let own = |number: &&FoundNumber| number.name == joint || !number.key.is_of_joint();
            let moved: f64 = numbers.iter().filter(own).map(|number| number.value).sum();
            let caused = causes.iter().filter(|cause| cause.joint == joint).count() as f64;
            (0.02 + moved + 0.01 * caused).abs()
        };
        let joints: Vec<(String, f64)> = ["a", "b"].map(|joint| (joint.to_owned(), off(joint))).to_vec();
        let all = (0.5 * joints.iter().map(|(_, rms)| rms * rms).sum::<f64>()).sqrt();
        if all > 1.0 {
            return Err("it runs away".to_owned());
        }
        Ok(Told { all, joints, predicted: Vec::new(), first: (0, Vec::new()) })
    }

    fn kept_of(found: Vec<FoundNumber>, causes: Vec<PlacedCause>) -> Kept {
        let (stated, found) = (FoundRobot::default(), FoundRobot { numbers: found, cannot_say: Vec::new() });
        let before = told(&[], &[]).unwrap();
        kept(&before, &stated, found, causes, &|number| !number.key.is_of_joint(), &told)
    }

    #[test]
    fn what_makes_the_whole_worse_is_left_out_and_said_the_masses_first() {
        let good = number("a", FoundKey::Kp, -0.018);
        let late = PlacedCause {
            joint: "b".to_owned(),
            form: crate::joint::EffectId::Delay.into(),
            values: vec![0.02],
            spreads: Vec::new(),
        };
        let found = vec![good.clone(), number("b", FoundKey::Kp, 0.03), number("hand", FoundKey::Mass, 0.1)];
        let kept = kept_of(found, vec![late]);
        assert_eq!(kept.found.numbers, std::slice::from_ref(&good));
        let of: Vec<Option<&str>> = kept.left_out.iter().map(|left| left.joint.as_deref()).collect();
        assert_eq!(of, [None, Some("b")]);
        assert!(kept.left_out.iter().all(|left| left.without_it < left.with_it));
        let told = kept.told.unwrap();
        assert!((told.joints[0].1 - 0.002).abs() < 1e-12 && (told.joints[1].1 - 0.02).abs() < 1e-12);
        // What helps every joint stays.
        let kept = kept_of(vec![good.clone(), number("hand", FoundKey::Mass, -0.001)], Vec::new());
        assert!(kept.left_out.is_empty() && kept.found.numbers.len() == 2);
        // Masses without which nothing is better stay where a joint has to go.
        let found = vec![number("b", FoundKey::Kp, 0.03), number("hand", FoundKey::Mass, -0.001)];
        let kept = kept_of(found.clone(), Vec::new());
        assert_eq!(kept.found.numbers, found[1..]);
        assert_eq!(kept.left_out.iter().map(|left| left.joint.as_deref()).collect::<Vec<_>>(), [Some("b")]);
        assert!((kept.told.unwrap().joints[1].1 - 0.019).abs() < 1e-12);
        // Where both make it run away it is said of both.
        let found = vec![number("b", FoundKey::Kp, 9.0), number("hand", FoundKey::Mass, 9.0)];
        let kept = kept_of(found, Vec::new());
        assert!(kept.told.is_ok() && kept.left_out.len() == 2 && kept.left_out[0].without_it.is_finite());
        // One that runs away with its masses does not without them.
        let kept = kept_of(vec![good, number("hand", FoundKey::Mass, 9.0)], Vec::new());
        assert!(kept.told.is_ok() && kept.left_out[0].with_it.is_infinite());
    }
}
