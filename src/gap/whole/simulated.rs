//! One simulation of the whole robot under the study's setpoints, as stated and with all that was found.

use super::numbers::{FoundRobot, found_robot};
use crate::gap::clamped::{ClampedDiagnosis, ClampedSetup};
use crate::identify::smooth_along;
use crate::joint::EffectId;
use crate::log::{DriveMode, RobotLog, Role};
use crate::robot::description::Description;
use crate::robot::simulate::{Column, Control, Joints, Method, Recording, Scenario, Setpoints, run};
use crate::robot::{Model, State};
use std::fmt::Write as _;

/// Longest step \[s\].
const STEP_S: f64 = 1e-3;

/// How far the whole robot is off on held-out logs.
#[derive(Clone, Debug, PartialEq)]
pub struct Whole {
    /// Root of the mean square over all joints as stated \[rad\].
    pub before: f64,
    /// With all that was found \[rad\].
    pub after: f64,
    /// The same of each joint.
    pub joints: Vec<WholeJoint>,
    /// Predicted logs: the log's name, and `t,<joint>.q` as CSV.
    pub predicted: Vec<(String, String)>,
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

/// Simulates the whole robot on the held-out logs that setpoints drive, or else on the fitted ones.
///
/// # Errors
/// Why it cannot be, in words.
pub fn simulated(setup: &ClampedSetup, diagnosis: &ClampedDiagnosis) -> Result<Whole, String> {
    let entries = setup.study.logs.iter().zip(&setup.logs).filter(|(entry, _)| entry.drive == DriveMode::Position);
    let (held_out, fitted): (Vec<_>, Vec<_>) = entries.partition(|(entry, _)| entry.role == Role::Validate);
    let shown = if held_out.is_empty() { fitted } else { held_out };
    if shown.is_empty() {
        return Err("no log is driven by setpoints".to_owned());
    }
    let of = |diagnosis| found_robot(setup, diagnosis).map_err(|error| error.to_string());
    let (stated, found) = (of(None)?, of(Some(diagnosis))?);
    let (mut names, mut squares, mut samples, mut predicted) = (Vec::<String>::new(), Vec::new(), 0, Vec::new());
    for (entry, log) in shown {
        let before = motion(setup, &stated, None, log)?;
        let after = motion(setup, &found, Some(diagnosis), log)?;
        for (k, joint) in log.joints.iter().enumerate() {
            let sum =
                |motion: &[Vec<f64>]| joint.q_rad.iter().zip(&motion[k]).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            let place = names.iter().position(|name| *name == joint.name).unwrap_or_else(|| {
                names.push(joint.name.clone());
                squares.push([0.0; 2]);
                names.len() - 1
            });
            squares[place][0] += sum(&before);
            squares[place][1] += sum(&after);
        }
        samples += log.len();
        predicted.push((entry.file.clone(), csv(log, &after)));
    }
    let root = |square: f64| (square / samples as f64).sqrt();
    let joint =
        |(joint, [before, after]): (String, [f64; 2])| WholeJoint { joint, before: root(before), after: root(after) };
    let joints: Vec<WholeJoint> = names.into_iter().zip(squares).map(joint).collect();
    let all = |of: fn(&WholeJoint) -> f64| {
        (joints.iter().map(|joint| of(joint).powi(2)).sum::<f64>() / joints.len().max(1) as f64).sqrt()
    };
    Ok(Whole { before: all(|joint| joint.before), after: all(|joint| joint.after), joints, predicted })
}

/// The readings of a log's joints at its samples \[rad\].
fn motion(
    setup: &ClampedSetup,
    robot: &FoundRobot,
    diagnosis: Option<&ClampedDiagnosis>,
    log: &RobotLog,
) -> Result<Vec<Vec<f64>>, String> {
    let description: Description = setup.description.with_found(&robot.numbers).map_err(|error| error.to_string())?;
    let description = Description { gravity_m_s2: setup.tree.gravity_m_s2(), ..description };
    let model = Model::of_description(&description).map_err(|error| error.to_string())?;
    let text = |error: crate::robot::simulate::SimulateError| error.to_string();
    let study = &setup.study;
    let control = Control { derivative: study.derivative, hold: study.hold, sample_period_s: study.sample_period_s };
    let mut joints = Joints::passive(&model);
    joints.set_friction(&model, "chosen").map_err(text)?;
    joints.set_control(&model, "printed", control).map_err(text)?;
    for own in diagnosis.iter().flat_map(|d| &d.joints).filter_map(|joint| joint.diagnosis.as_ref()) {
        let id = model.joint(&own.joint).map_err(|error| error.to_string())?;
        // Springs and limits stand in the description; what holds in some logs only is left out.
        let in_description = [EffectId::JointSpring, EffectId::TorqueLimit];
        for cause in own.causes.iter().filter(|cause| cause.only.is_none() && !in_description.contains(&cause.effect)) {
            let values: Vec<f64> = cause.parameters.iter().map(|number| number.value).collect();
            joints.add_effect(&model, id, cause.effect, &values).map_err(text)?;
        }
    }
    let mut start = State::at_rest(&model);
    let mut columns = vec![None; model.joints().len()];
    for id in model.joint_ids() {
        let drive = joints.drive_mut(id);
        let Some(own) = log.joint(&model.joints()[id.index()].name) else {
            drive.is_rigid = true;
            continue;
        };
        let [angle_rad, rate_rad_s, _] = smooth_along(&log.t_s, &own.q_rad)[0];
        start.angle_rad[id.index()] = drive.true_rad(angle_rad);
        start.rate_rad_s[id.index()] = rate_rad_s;
        columns[id.index()] = own.q_ref_rad.clone().map(|angle_rad| Column { angle_rad, on: own.drive.clone() });
    }
    let setpoints = Setpoints { t_s: log.t_s.clone(), columns, hold: study.hold };
    let period_s = (log.t_s[log.len() - 1] - log.t_s[0]) / (log.len() - 1) as f64;
    let scenario =
        Scenario { model: &model, joints: &joints, setpoints: &setpoints, start: &start, surroundings: None, period_s };
    let recording = run(&scenario, Method::Stiff { step_s: STEP_S }).map_err(text)?;
    if let Some(diverged) = &recording.diverged {
        return Err(diverged.to_string());
    }
    let readings = |joint: &crate::log::JointColumns| {
        let id = model.joint(&joint.name).map_err(|error| error.to_string())?;
        let drive = joints.drive(id);
        let at = |t: &f64| drive.reading_rad(between(&recording, id.index(), *t));
        Ok(log.t_s.iter().map(at).collect())
    };
    log.joints.iter().map(readings).collect()
}

/// A joint's angle at an instant \[rad\].
fn between(recording: &Recording, joint: usize, t_s: f64) -> f64 {
    let (t, angle) = (&recording.t_s, &recording.angle_rad[joint]);
    let after = t.partition_point(|own| *own < t_s).clamp(1, t.len() - 1);
    let share = ((t_s - t[after - 1]) / (t[after] - t[after - 1])).clamp(0.0, 1.0);
    angle[after - 1] + share * (angle[after] - angle[after - 1])
}

fn csv(log: &RobotLog, motion: &[Vec<f64>]) -> String {
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
