//! What a log of the robot would read, were something else true of it.

use super::case::{CaseLog, RobotCase};
use super::cause::{Cause, Change};
use super::scatter::Scatter;
use crate::gap::hypothesis::reach::mean_period_s;
use crate::joint::EffectId;
use crate::log::RobotScenario;
use crate::robot::simulate::{
    BaseSample, Joints, Method, Recording, Scenario, Setpoints, SimulateError, Surroundings, run,
};
use crate::robot::study::{joints_of, lift, settled, standing};
use crate::robot::{BodyId, Floor, FloorParameters, JointId, Model, State, Touching};
use nalgebra::Vector3;

/// What a log would read, sample by sample.
#[derive(Clone, Debug)]
pub(super) struct Predicted {
    /// By joint of the robot \[rad\].
    pub reading_rad: Vec<Vec<f64>>,
    /// \[rad/s\]
    pub rate_rad_s: Vec<Vec<f64>>,
    pub base: Vec<BaseSample>,
}

impl Predicted {
    /// Of a log that is not simulated: it reads nothing.
    fn nothing(case: &RobotCase) -> Self {
        let none = vec![Vec::new(); case.names.len()];
        Self { reading_rad: none.clone(), rate_rad_s: none, base: Vec::new() }
    }

    /// The same after so many samples more at which nothing moves.
    pub fn after(mut self, samples: usize) -> Self {
        fn stand<T: Clone>(column: &mut Vec<T>, samples: usize) {
            if let Some(first) = column.first().cloned() {
                column.splice(0..0, std::iter::repeat_n(first, samples));
            }
        }
        self.reading_rad.iter_mut().chain(&mut self.rate_rad_s).for_each(|column| stand(column, samples));
        stand(&mut self.base, samples);
        self
    }
}

/// A robot of which something else is true.
pub(super) struct Changed {
    pub joints: Joints,
    pub floor: Option<FloorParameters>,
    model: Model,
}

/// The study's floor, or that of the reference walk.
pub(super) fn floor_of(case: &RobotCase) -> FloorParameters {
    case.nominal.floor.as_ref().map_or_else(FloorParameters::default, |floor| *floor.parameters())
}

/// The robot of a log with changes.
pub(super) fn changed(
    case: &RobotCase,
    log: &CaseLog,
    scatter: &Scatter,
    changes: &[Change],
) -> Result<Changed, SimulateError> {
    let mut model = log.scene.model.clone();
    for (body, factor) in log.scene.model.body_ids().zip(&scatter.mass) {
        let mass_kg = log.scene.model.bodies()[body.index()].own_mass_kg();
        if *factor != 1.0 && mass_kg > 0.0 {
            model = model.with_mass(body, mass_kg * factor)?;
        }
    }
    let mut floor = case.nominal.floor.as_ref().map(|floor| {
        let mut floor = *floor.parameters();
        floor.stiffness_n_m *= scatter.floor[0];
        floor.damping_n_s_m2 *= scatter.floor[1];
        floor.static_friction *= scatter.floor[2];
        floor.coulomb *= scatter.floor[2];
        floor
    });
    for Change { cause, values, .. } in changes {
        match (cause, &mut floor) {
            (Cause::Payload, _) => {
                model = model.with_point_mass(BodyId::BASE, values[0], Vector3::new(values[1], 0.0, values[2]))?;
            }
            (Cause::FloorFriction, Some(floor)) => {
                floor.static_friction *= values[0] / floor.coulomb;
                floor.coulomb = values[0];
            }
            (Cause::FloorSlope, Some(floor)) => *floor = floor.sloped(values[0], values[1]),
            (Cause::FloorStiffness, Some(floor)) => floor.stiffness_n_m = values[0],
            _ => {}
        }
    }
    let mut joints = joints_of(&model, &case.study.friction, &case.study.control, &case.study.file)?;
    for (id, more) in model.joint_ids().zip(&scatter.friction) {
        let law = &mut joints.drive_mut(id).chain.friction;
        law.coulomb_nm = (law.coulomb_nm + more[0]).max(0.0);
        law.viscous_nm_s_rad = (law.viscous_nm_s_rad + more[1]).max(0.0);
    }
    // Friction first: effects are counted from it.
    for calibrates in [true, false] {
        for change in changes.iter().filter(|change| change.cause.is_calibration() == calibrates) {
            put(&mut joints, &model, change)?;
        }
    }
    Ok(Changed { joints, floor, model })
}

/// How a log begins of a robot of which something else is true, or parts of it.
fn beginning(
    case: &RobotCase,
    log: &CaseLog,
    (model, joints): (&Model, &Joints),
    setpoints: &Setpoints,
    floor: Option<&Floor>,
) -> Result<State, SimulateError> {
    let mut start = standing(model, joints, setpoints);
    start.base_position_m = log.scene.start.base_position_m;
    start.base_orientation = log.scene.start.base_orientation;
    if let Some(floor) = floor {
        lift(floor, model, &mut start, case.nominal.drop_height_m);
    }
    if case.study.scenario == RobotScenario::Drop { settled(model, joints, setpoints, start) } else { Ok(start) }
}

/// How all of a robot moves in one of a study's logs, were changes true of it.
///
/// # Errors
/// [`SimulateError`] where a change cannot be.
pub fn motion_with(
    case: &RobotCase,
    log: usize,
    changes: &[Change],
    (period_s, step_s): (f64, f64),
) -> Result<Recording, SimulateError> {
    let log = &case.logs[log];
    let Changed { joints, floor, model } = changed(case, log, &Scatter::none(&log.scene.model), changes)?;
    let floor = floor.map(|floor| Floor::new(floor, &model, Touching::Marked)).transpose()?;
    let setpoints = &log.scene.setpoints;
    let start = beginning(case, log, (&model, &joints), setpoints, floor.as_ref())?;
    let surroundings = floor.as_ref().map(|floor| floor as &dyn Surroundings);
    let scenario = Scenario { model: &model, joints: &joints, setpoints, start: &start, surroundings, period_s };
    run(&scenario, Method::Stiff { step_s })
}

fn put(joints: &mut Joints, model: &Model, change: &Change) -> Result<(), SimulateError> {
    for id in model.joint_ids().filter(|id| change.place.joints.contains(&id.index())) {
        let law = &mut joints.drive_mut(id).chain.friction;
        match change.cause {
            Cause::Coulomb => law.coulomb_nm = change.values[0],
            Cause::Viscous => law.viscous_nm_s_rad = change.values[0],
            Cause::Effect(effect) => {
                let mut values = change.values.clone();
                if effect == EffectId::Stribeck {
                    values[0] = values[0].max(law.coulomb_nm);
                }
                joints.add_effect(model, id, effect, &values)?;
            }
            _ => {}
        }
    }
    Ok(())
}

/// Those of some logs that are asked for, simulated; the others read nothing. `None` where one runs away.
pub(super) fn of_those<L>(
    case: &RobotCase,
    logs: &[L],
    asked: &[bool],
    simulated: impl Fn(&L) -> Option<Predicted>,
) -> Option<Vec<Predicted>> {
    let one = |(log, asked): (&L, &bool)| if *asked { simulated(log) } else { Some(Predicted::nothing(case)) };
    logs.iter().zip(asked).map(one).collect()
}

/// Simulates a log up to a time; `None` where the motion runs away. Beside a clamped trunk only limbs with some of the
/// joints that are asked for (`None`: any) are simulated, the others stay where they stand.
///
/// # Errors
/// [`SimulateError`] where a change cannot be.
pub(super) fn predict(
    case: &RobotCase,
    log: &CaseLog,
    joints: Option<&[usize]>,
    (scatter, changes): (&Scatter, &[Change]),
    step_s: f64,
    until_s: f64,
) -> Result<Option<Predicted>, SimulateError> {
    let is_asked_for = |joint: usize| joints.is_none_or(|joints| joints.contains(&joint));
    let moving: Vec<JointId> =
        case.model().joint_ids().filter(|id| log.moves(id.index()) && is_asked_for(id.index())).collect();
    let Changed { joints, floor, model } = changed(case, log, scatter, changes)?;
    let mut setpoints = log.scene.setpoints.clone();
    let keep = setpoints.t_s.partition_point(|t| *t <= until_s + 1e-9).max(2);
    setpoints.t_s.truncate(keep);
    for column in setpoints.columns.iter_mut().flatten() {
        column.angle_rad.truncate(keep);
        if let Some(on) = &mut column.on {
            on.truncate(keep);
        }
    }
    let floor = floor.map(|floor| Floor::new(floor, &model, Touching::Marked)).transpose()?;
    let still = standing(&model, &joints, &setpoints);
    let still: Vec<f64> =
        joints.drives().iter().zip(&still.angle_rad).map(|(drive, q)| drive.reading_rad(*q)).collect();
    let t_s = &log.log.t_s;
    let samples = t_s.partition_point(|t| *t <= until_s + 1e-9);
    if case.is_clamped() && moving.is_empty() {
        let rate_rad_s = vec![vec![0.0; samples]; still.len()];
        let reading_rad = still.into_iter().map(|q| vec![q; samples]).collect();
        return Ok(Some(Predicted { reading_rad, rate_rad_s, base: Vec::new() }));
    }
    let (model, kept) = match case.is_clamped() {
        true => model.limbs(&moving)?,
        false => {
            let all = model.joint_ids().collect();
            (model, all)
        }
    };
    let joints = joints.only(&kept);
    setpoints.columns = kept.iter().map(|id| setpoints.columns[id.index()].take()).collect();
    let Ok(start) = beginning(case, log, (&model, &joints), &setpoints, floor.as_ref()) else { return Ok(None) };
    let scenario = Scenario {
        model: &model,
        joints: &joints,
        setpoints: &setpoints,
        start: &start,
        surroundings: floor.as_ref().map(|floor| floor as &dyn Surroundings),
        period_s: mean_period_s(t_s),
    };
    let recording = run(&scenario, Method::Stiff { step_s })?;
    if recording.diverged.is_some() || recording.t_s.len() + 1 < samples {
        return Ok(None);
    }
    let (n, last) = (samples, recording.t_s.len() - 1);
    let is_uniform = recording.t_s.iter().zip(t_s).all(|(a, b)| (a - b).abs() < 1e-6);
    let readings = |id: JointId| -> Vec<f64> {
        let drive = joints.drive(id);
        (0..n)
            .map(|k| match is_uniform {
                true => recording.angle_rad[id.index()][k.min(last)],
                false => recording.angle_at_rad(id, t_s[k].min(recording.t_s[last])),
            })
            .map(|angle_rad| drive.reading_rad(angle_rad))
            .collect()
    };
    let mut reading_rad: Vec<Vec<f64>> = still.into_iter().map(|q| vec![q; n]).collect();
    let mut rate_rad_s = vec![vec![0.0; recording.t_s.len()]; reading_rad.len()];
    for ((id, own), rate) in kept.iter().zip(model.joint_ids()).zip(&recording.rate_rad_s) {
        (reading_rad[id.index()], rate_rad_s[id.index()]) = (readings(own), rate.clone());
    }
    let is_finite = reading_rad.iter().flatten().all(|q| q.is_finite());
    Ok(is_finite.then_some(Predicted { reading_rad, rate_rad_s, base: recording.base }))
}
