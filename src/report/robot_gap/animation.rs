//! The robot as given, repaired and logged, moving together.

use crate::gap::robot::{Change, RobotCase, RobotDiagnosis, motion_with};
use crate::log::{BaseColumns, RobotLog, RobotScenario, RobotStudyLog, read_robot_study_logs};
use crate::report::animation::PICTURE_S;
use crate::report::{Animation, Recording};
use crate::robot::simulate::{self, SimulateError};
use crate::robot::study::orientation;
use crate::robot::{Dynamics, Model, State};
use nalgebra::Vector3;

/// Longest step \[s\], as a walk takes it.
const STEP_S: f64 = 5e-4;
/// Where the trunk is clamped nothing stands under it; the picture's floor is so far below its middle \[m\].
const BELOW_M: f64 = 0.25;

/// Puts the robot as given, the repaired one and the logged one side by side, in the log that has most of the gap.
///
/// The logged trunk moves as the columns `base.*` say; where the log does not have them, as that of the repaired robot.
///
/// # Errors
/// [`SimulateError`] where the study's logs have gone.
pub fn robot_gap_animation(case: &RobotCase, diagnosis: &RobotDiagnosis) -> Result<Animation, SimulateError> {
    let logs = read_robot_study_logs(&case.study)?;
    let most = |entry: &&RobotStudyLog| diagnosis.location.logs.contains(&entry.file);
    let chosen = case.study.logs.iter().position(|entry| most(&entry)).unwrap_or(0);
    let Some((entry, log)) = case.study.logs.get(chosen).zip(logs.get(chosen)) else {
        return Ok(Animation::new(case.robot(), ""));
    };
    let moved = |changes: &[Change]| motion_with(case, chosen, changes, (PICTURE_S, STEP_S));
    let (given, answer) = (moved(&[])?, moved(&diagnosis.changes)?);
    let (logged, trunk) = logged(&case.nominal.model, log, &answer);
    let model = &case.nominal.model;
    let to_blame = diagnosis.location.joints.iter().filter_map(|name| model.joint(name).ok());
    let lit: Vec<String> = to_blame.map(|id| model.bodies()[id.child().index()].name.clone()).collect();
    let title = format!("{}: as given, repaired and logged", case.robot());
    let note = format!("{}. {} {trunk}", entry.file, diagnosis.answer.sentence);
    let mut animation = Animation::new(title, note)
        .with("as given", Recording::of_run(&case.nominal.model, &given))
        .with("repaired", Recording::of_run(model, &answer))
        .with("logged", logged)
        .lit(&lit);
    if case.study.scenario != RobotScenario::Floor {
        animation.floor_m = answer.base.first().map_or(0.0, |base| base.position_m.y) - BELOW_M;
    }
    Ok(animation)
}

/// The readings of a log as a motion; joints that it lacks move as simulated. Says how its trunk moves.
fn logged(model: &Model, log: &RobotLog, simulated: &simulate::Recording) -> (Recording, &'static str) {
    let (mut dynamics, mut state) = (Dynamics::new(model), State::at_rest(model));
    let mut film = Recording::new(model);
    let columns: Vec<Option<&[f64]>> =
        model.joints().iter().map(|joint| log.joint(&joint.name).map(|columns| columns.q_rad.as_slice())).collect();
    for (k, (t_s, base)) in simulated.t_s.iter().zip(&simulated.base).enumerate() {
        let sample = log.t_s.partition_point(|t| *t < t_s - 1e-9).min(log.len() - 1);
        for (id, column) in model.joint_ids().zip(&columns) {
            let here = simulated.angle_rad[id.index()][k];
            state.angle_rad[id.index()] = column.map_or(here, |readings| readings[sample]);
        }
        let [roll, pitch, yaw] = base.roll_pitch_yaw_rad();
        let [x, y, z] = base.position_m.into();
        let or = |column: fn(&BaseColumns) -> &Option<Vec<f64>>, simulated: f64| {
            let values = log.base.as_ref().and_then(|base| column(base).as_ref());
            values.map_or(simulated, |values| values[sample])
        };
        state.base_position_m = Vector3::new(or(|b| &b.x_m, x), or(|b| &b.y_m, y), or(|b| &b.z_m, z));
        state.base_orientation =
            orientation([or(|b| &b.roll_rad, roll), or(|b| &b.pitch_rad, pitch), or(|b| &b.yaw_rad, yaw)]);
        film.push(*t_s, dynamics.motions(&state));
    }
    let count = log.base.as_ref().map_or(0, |b| {
        [&b.x_m, &b.y_m, &b.z_m, &b.roll_rad, &b.pitch_rad, &b.yaw_rad].iter().filter(|column| column.is_some()).count()
    });
    let trunk = match count {
        6 => "",
        0 => "The log does not say where the trunk is: the logged robot's moves as that of the repaired one.",
        _ => "What the log does not say of the trunk is as of the repaired robot.",
    };
    (film, trunk)
}
