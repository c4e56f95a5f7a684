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
    let (stated, mut found) = (of(None)?, of(Some(diagnosis))?);
    let mut causes = placed_causes(diagnosis);
    let before = predicted(setup, &stated.numbers, &[])?;
    let mut after = predicted(setup, &found.numbers, &causes);
    let mut left_out: Vec<LeftOut> = Vec::new();
    // Every round leaves out something that was there.
    for _ in 0..=before.joints.len() {
        let Some(worst) = worst(&before, &after) else { break };
        let is_mass = |number: &FoundNumber| !number.key.is_of_joint() && !is_of_body(diagnosis, number);
        let joint = found.numbers.iter().all(|number| !is_mass(number)).then_some(worst);
        let (mut less, mut fewer) = (found.clone(), causes.clone());
        match &joint {
            None => less.numbers.retain(|number| !is_mass(number)),
            Some(joint) => {
                less.numbers.retain(|number| !number.key.is_of_joint() || number.name != *joint);
                less.numbers.extend(stated.numbers.iter().filter(|number| number.name == *joint).cloned());
                fewer.retain(|cause| cause.joint != *joint);
            }
        }
        let tried = predicted(setup, &less.numbers, &fewer);
        let error = |told: &Result<Told, String>| told.as_ref().map_or(f64::INFINITY, |told| told.all);
        let (with_it, without_it) = (error(&after), error(&tried));
        if joint.is_some() && !(without_it < with_it) {
            break;
        }
        if without_it < with_it {
            left_out.push(LeftOut { joint, with_it, without_it });
            after = tried;
        }
        (found, causes) = (less, fewer);
    }
    let after = after?;
    let joints = before.joints.iter().zip(&after.joints).map(|((joint, before), (_, after))| WholeJoint {
        joint: joint.clone(),
        before: *before,
        after: *after,
    });
    let (joints, robot) = (joints.collect(), found);
    let shown = WholeMotion { log: after.first.0, before: before.first.1, after: after.first.1 };
    Ok(Whole { before: before.all, after: after.all, joints, predicted: after.predicted, left_out, robot, shown })
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
