//! A described robot as something to simulate: with what study and description believe, numbers that are others, and causes.

use super::parts::{append, parts};
use crate::gap::clamped::{ClampedDiagnosis, ClampedSetup};
use crate::gap::hypothesis::reach::mean_period_s;
use crate::gap::{CauseShare, Number};
use crate::joint::{EffectForm, EffectId, Knee, Motor, TorqueLimit};
use crate::log::RobotLog;
use crate::number::chance::sd_of;
use crate::robot::description::{Description, FoundKey, FoundNumber, MoverId};
use crate::robot::simulate::{Column, Joints, Method, Recording, Scenario, Setpoints, SimulateError, run};
use crate::robot::study::asked;
use crate::robot::{Model, State};

/// Longest step, and where numbers are searched \[s\].
const STEP_S: f64 = 1e-3;
const SEARCHED_STEP_S: f64 = 4e-3;

/// Of each of a log's joints the reading at the first sample and its rate there \[rad, rad/s\].
pub(super) type Beginning = Vec<[f64; 2]>;

/// Of a log what is simulated, and how.
pub(super) struct Stretch {
    /// Between two instants that are recorded \[s\].
    pub period_s: f64,
    pub step_s: f64,
    /// Up to when \[s\].
    pub until_s: f64,
}

impl Stretch {
    /// All of a log.
    pub fn whole(period_s: f64) -> Self {
        Self { period_s, step_s: STEP_S, until_s: f64::INFINITY }
    }

    /// Up to an instant, in the steps of searches.
    pub fn searched(period_s: f64, until_s: f64) -> Self {
        Self { period_s, step_s: SEARCHED_STEP_S, until_s }
    }
}

/// An effect of the catalogue on a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedCause {
    /// The joint's name.
    pub joint: String,
    /// Which effect, and how.
    pub form: EffectForm,
    /// Its values under the catalogue's names, in their order.
    pub values: Vec<f64>,
    /// How far each of them may be off; 0: it is as it is.
    pub spreads: Vec<f64>,
}

/// A value may be off by so many of its standard deviations, and by at least this share of it: the rest of the robot moves
/// as well.
const LOOSE: f64 = 5.0;
const LEAST_LOOSE: f64 = 0.05;

/// How far a value that was found may be off.
fn spread(number: &Number) -> f64 {
    let sd = number.interval.map_or(0.0, |interval| sd_of(number.value, interval));
    (LOOSE * sd).min(0.5 * number.value.abs()).max(LEAST_LOOSE * number.value.abs())
}

/// What a diagnosis puts on joints beside numbers of the description; what holds in some logs only, springs before the link
/// and late readings are left out.
pub fn placed_causes(diagnosis: &ClampedDiagnosis) -> Vec<PlacedCause> {
    let placed = diagnosis.found().flat_map(|own| {
        // Springs and limits stand in the description.
        let in_description = [EffectId::JointSpring, EffectId::TorqueLimit];
        let is_told = |cause: &&CauseShare| cause.only.is_none() && cause.effect.is_known_to_robots();
        let everywhere = own.causes.iter().filter(is_told);
        everywhere.filter_map(move |cause| {
            let form = EffectForm::named_so(cause.effect, Some(cause.form).filter(|form| !form.is_empty())).ok()?;
            let is_said = in_description.contains(&cause.effect) && form.is_default();
            let values = cause.parameters.iter().map(|number| number.value).collect();
            let spreads = cause.parameters.iter().map(spread).collect();
            (!is_said).then(|| PlacedCause { joint: own.joint.clone(), form, values, spreads })
        })
    });
    placed.collect()
}

/// A robot with its joints, ready to run.
pub struct WholeRobot {
    /// Its tree.
    pub model: Model,
    /// Its joints with friction, servos and causes.
    pub joints: Joints,
}

impl WholeRobot {
    /// The robot of a setup with numbers of its description that are others, and causes.
    ///
    /// # Errors
    /// Why it cannot be, in words.
    pub fn of(setup: &ClampedSetup, numbers: &[FoundNumber], causes: &[PlacedCause]) -> Result<Self, String> {
        let description: Description = setup.description.with_found(numbers).map_err(|error| error.to_string())?;
        let description = Description { gravity_m_s2: setup.tree.gravity_m_s2(), ..description };
        let model = Model::of_description(&description).map_err(|error| error.to_string())?;
        let mut joints = Joints::passive(&model);
        joints.set_friction(&model, "chosen").map_err(text)?;
        for (at, mover) in setup.description.joints.iter().enumerate() {
            let Ok(id) = model.joint(&mover.name) else { continue };
            // A joint that follows another has no motor of its own.
            if model.following().iter().any(|one| one.follower == id.index()) {
                continue;
            }
            let found = |key: FoundKey| {
                let own = numbers.iter().find(|number| number.key == key && number.name == mover.name);
                own.map(|number| number.value)
            };
            joints.drive_mut(id).chain.motor = motor(setup, MoverId(at), &found);
        }
        for cause in causes {
            let id = model.joint(&cause.joint).map_err(|error| error.to_string())?;
            joints.add_effect(&model, id, cause.form, &cause.values).map_err(text)?;
        }
        Ok(Self { model, joints })
    }

    /// The readings of a log's joints at its samples \[rad\], from its start, and from the end of each hole, under its setpoints.
    ///
    /// # Errors
    /// Why it cannot be, in words.
    pub fn readings(&mut self, setup: &ClampedSetup, log: &RobotLog) -> Result<Vec<Vec<f64>>, String> {
        let mut readings = Vec::new();
        for part in parts(log) {
            let from = self.beginning(setup, &part);
            let recording = self.motion(setup, &part, &from, &Stretch::whole(mean_period_s(&part.t_s)))?;
            append(&mut readings, self.read(&recording, &part)?);
        }
        Ok(readings)
    }

    /// The whole robot along a stretch of a log without holes, from where it begins under its setpoints.
    pub(super) fn motion(
        &mut self,
        setup: &ClampedSetup,
        log: &RobotLog,
        from: &Beginning,
        stretch: &Stretch,
    ) -> Result<Recording, String> {
        let (mut t_s, hold) = (asked::times(log), setup.study.hold);
        t_s.truncate(t_s.partition_point(|t| *t <= stretch.until_s).max(2));
        let mut start = State::at_rest(&self.model);
        let mut columns = vec![None; self.model.joints().len()];
        for id in self.model.joint_ids() {
            let drive = self.joints.drive_mut(id);
            let name = &self.model.joints()[id.index()].name;
            let own = log.joints.iter().zip(from).find(|(joint, _)| joint.name == *name);
            drive.is_rigid = own.is_none();
            let Some((own, &[reading_rad, rate_rad_s])) = own else { continue };
            start.angle_rad[id.index()] = drive.true_rad(reading_rad);
            start.rate_rad_s[id.index()] = rate_rad_s;
            columns[id.index()] = own.q_ref_rad.as_ref().map(|beside| Column {
                angle_rad: asked::setpoints(log, beside, own.setpoints.as_ref(), &t_s, hold),
                on: own.drive.as_ref().map(|on| asked::switches(log, on, &t_s)),
            });
        }
        for one in self.model.following() {
            let ids: Vec<_> = self.model.joint_ids().collect();
            self.joints.drive_mut(ids[one.follower]).is_rigid = self.joints.drive(ids[one.leader]).is_rigid;
        }
        let setpoints = Setpoints { t_s, columns, hold };
        let (model, joints, period_s) = (&self.model, &self.joints, stretch.period_s);
        let scenario = Scenario { model, joints, setpoints: &setpoints, start: &start, surroundings: None, period_s };
        let recording = run(&scenario, Method::Stiff { step_s: stretch.step_s }).map_err(text)?;
        match &recording.diverged {
            Some(diverged) => Err(diverged.to_string()),
            None => Ok(recording),
        }
    }

    /// What a log's joints read at its samples along a recorded motion \[rad\].
    pub(super) fn read(&self, recording: &Recording, log: &RobotLog) -> Result<Vec<Vec<f64>>, String> {
        let readings = |joint: &crate::log::JointColumns| {
            let id = self.model.joint(&joint.name).map_err(|error| error.to_string())?;
            let drive = self.joints.drive(id);
            Ok(log.t_s.iter().map(|t| drive.reading_rad(between(recording, id.index(), *t))).collect())
        };
        log.joints.iter().map(readings).collect()
    }
}

/// A joint's motor with what was found of its gains and its limit.
fn motor(setup: &ClampedSetup, joint: MoverId, found: &dyn Fn(FoundKey) -> Option<f64>) -> Option<Motor<f64>> {
    let spec = setup.motor(joint)?;
    let mut motor = Motor::new(spec);
    if let Some(kp_nm_rad) = found(FoundKey::Kp).filter(|_| spec.kp_nm_rad > 0.0) {
        motor.gain = kp_nm_rad / spec.kp_nm_rad;
    }
    if let Some(kd_nm_s_rad) = found(FoundKey::Kd).filter(|_| spec.kd_nm_s_rad > 0.0 && motor.gain > 0.0) {
        motor.derivative_share = kd_nm_s_rad / spec.kd_nm_s_rad / motor.gain;
    }
    if let Some(most_nm) = found(FoundKey::TorqueLimit) {
        motor.limit_to(TorqueLimit { most_nm, knee: Knee::Hard });
    }
    Some(motor)
}

fn text(error: SimulateError) -> String {
    error.to_string()
}

/// A joint's angle at an instant \[rad\].
fn between(recording: &Recording, joint: usize, t_s: f64) -> f64 {
    let (t, angle) = (&recording.t_s, &recording.angle_rad[joint]);
    let after = t.partition_point(|own| *own < t_s).clamp(1, t.len() - 1);
    let share = ((t_s - t[after - 1]) / (t[after] - t[after - 1])).clamp(0.0, 1.0);
    angle[after - 1] + share * (angle[after] - angle[after - 1])
}
