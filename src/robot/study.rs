//! A robot study as something to simulate: what does the engineer's robot do where the log was recorded?
//!
//! [`Nominal`] is the robot with what the study believes of it; [`Scene`] is one of its logs: what was asked of the joints
//! and how it began. Nothing of a log but its clock, setpoints, switches and the trunk's first place goes in; the
//! readings are what the answer is compared with.

pub(crate) mod asked;
mod described;

pub use described::{Wanted, check_servos, read_described};

use super::bench::{SETTLE_S, loaded};
use super::simulate::{Column, Control, Joints, Method, Scenario, Setpoints, SimulateError, Surroundings, run};
use super::{BodyId, Dynamics, RobotError};
use super::{Floor, FloorParameters, JointId, Model, PidGains, State, Touching};
use crate::geometry::robot_file::{Base, FRICTION_SET, GAIN_SET, RobotTables};
use crate::geometry::{Leg, LegJoint, LegPose, joint_name};
use crate::identify::LegCase;
use crate::log::{
    ControlSpec, ExtraMass, FloorSpec, JointColumns, LegFrictionSpec, RobotLog, RobotRelease, RobotScenario,
    RobotStudy, RobotStudyLog,
};
use nalgebra::UnitQuaternion;
use std::path::{Path, PathBuf};

/// Kinds of a leg's joints 1, 2, 3.
const LEG_KINDS: [&str; 3] = ["q1", "q2", "q3"];

/// The robot that a study believes in.
pub struct Nominal {
    /// The robot, clamped or free as the scenario says.
    pub model: Model,
    /// Its joints.
    pub joints: Joints,
    /// The floor, in the floor scenario.
    pub floor: Option<Floor>,
    /// Height of the lowest foot at the start \[m\].
    pub drop_height_m: f64,
    /// What in the robot's description looks like a mistake.
    pub warnings: Vec<String>,
    scenario: RobotScenario,
    control: ControlSpec,
    /// For messages.
    file: PathBuf,
}

/// One log of a study: robot, setpoints and start.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The robot with what hangs on it in this log.
    pub model: Model,
    /// What is asked of the joints, within their limits.
    pub setpoints: Setpoints,
    /// How it begins.
    pub start: State,
}

impl Nominal {
    /// The robot of a study: friction set `chosen` with the study's leg friction, gains `printed` with the study's.
    ///
    /// # Errors
    /// [`SimulateError`] where the robot's file cannot be read, or a joint, set or number cannot be.
    pub fn of(study: &RobotStudy) -> Result<Self, SimulateError> {
        let (read, warnings) = Self::robot_of(study)?.unzip();
        let nominal = Self::on(read.as_ref().unwrap_or(Model::ers7()), study)?;
        Ok(Self { warnings: warnings.unwrap_or_default(), ..nominal })
    }

    /// The robot that a study names, and what in its file looks like a mistake; `None`: the embedded one.
    ///
    /// # Errors
    /// [`RobotError`] where its file cannot be read, or is none of a robot that can be simulated.
    pub fn robot_of(study: &RobotStudy) -> Result<Option<(Model, Vec<String>)>, RobotError> {
        let read = |file: &Path| -> Result<(Model, Vec<String>), RobotError> {
            match &study.described {
                Some(spec) => {
                    let read = read_described(file, spec, Wanted::Standing)?;
                    if study.control.gains.is_empty() {
                        check_servos(&read.0)?;
                    }
                    Ok(read)
                }
                None => Ok((Model::new(RobotTables::read(file)?)?, Vec::new())),
            }
        };
        study.model_path.as_deref().map(read).transpose()
    }

    /// The same with a robot that is at hand in the place of the study's.
    ///
    /// # Errors
    /// As [`Nominal::of`].
    pub fn on(robot: &Model, study: &RobotStudy) -> Result<Self, SimulateError> {
        let model = robot.with_base(match study.scenario {
            RobotScenario::Floor => Base::Floating,
            RobotScenario::Air | RobotScenario::Drop => Base::Clamped,
        });
        let joints = joints_of(&model, &study.friction, &study.control, &study.file)?;
        let floor = match study.scenario {
            RobotScenario::Floor => {
                // Feet that stand are held by (2.4) alone, as on the reference walk's floor.
                let floor = FloorParameters { dwell_s: f64::INFINITY, ..floor_on(&model, &study.floor) };
                Some(Floor::new(floor, &model, Touching::Marked)?)
            }
            _ => None,
        };
        Ok(Self {
            model,
            joints,
            floor,
            drop_height_m: study.drop_height_m,
            warnings: Vec::new(),
            scenario: study.scenario,
            control: study.control.clone(),
            file: study.file.clone(),
        })
    }

    /// What a log asks of the joints: `q_ref` as the study's control reads it, clipped to the limits; joints that the log
    /// does not have stay at rest. A joint that is let go has its motor off from then on.
    ///
    /// # Errors
    /// [`SimulateError::Unfit`] where the log names a joint that the robot lacks, or lacks a leg's joint or its setpoints.
    pub fn setpoints(&self, log: &RobotLog, release: Option<&RobotRelease>) -> Result<Setpoints, SimulateError> {
        let unfit = |what: String| SimulateError::Unfit { file: log.file.clone(), what };
        for joint in &log.joints {
            self.model.joint(&joint.name).map_err(|error| unfit(error.to_string()))?;
        }
        let released = release.map(|release| self.released(release)).transpose()?;
        for (id, joint) in self.model.joint_ids().zip(self.model.joints()) {
            if !leads_to_foot(&self.model, id) {
                continue;
            }
            let has_motor = self.joints.drive(id).chain.motor.is_some();
            // Beside a clamped trunk legs do not feel each other: one that the log does not have stands still.
            let of_leg = |other: &JointColumns| {
                self.model.joint(&other.name).is_ok_and(|other| on_one_chain(&self.model, id, other))
            };
            let is_meant = match released {
                Some(released) => on_one_chain(&self.model, id, released),
                None => self.scenario == RobotScenario::Floor || log.joints.iter().any(of_leg),
            };
            let is_needed = has_motor && is_meant;
            let columns = log.joint(&joint.name);
            if is_needed && columns.and_then(|columns| columns.q_ref_rad.as_ref()).is_none() {
                let column = if columns.is_none() { "q" } else { "q_ref" };
                return Err(unfit(format!(
                    "column `{0}.{column}` is missing: every joint of a leg that moves needs `{0}.q` and `{0}.q_ref`",
                    joint.name
                )));
            }
            if !has_motor && columns.is_some_and(|own| own.q_ref_rad.is_some()) {
                return Err(unfit(format!(
                    "column `{0}.q_ref`: joint {0} has no position servo; state its kp [N m/rad]",
                    joint.name
                )));
            }
        }
        let (t_s, hold) = (asked::times(log), self.control.hold);
        let column = |(joint, id): (&crate::geometry::Joint, JointId)| {
            self.joints.drive(id).chain.motor.as_ref()?;
            let columns = log.joint(&joint.name);
            let of = |columns: &JointColumns| {
                let beside = columns.q_ref_rad.as_ref()?;
                Some(asked::setpoints(log, beside, columns.setpoints.as_ref(), &t_s, hold))
            };
            let angle_rad = columns.and_then(of).unwrap_or_else(|| vec![joint.resting_rad(); t_s.len()]);
            let on = columns.and_then(|columns| columns.drive.as_ref());
            Some(Column { angle_rad, on: on.map(|on| asked::switches(log, on, &t_s)) })
        };
        let columns = self.model.joints().iter().zip(self.model.joint_ids()).map(column).collect();
        let table = Setpoints { t_s, columns, hold };
        let mut table = table.clipped(&self.model).0;
        if let Some((release, joint)) = release.zip(released) {
            let end_s = log.t_s.last().copied().unwrap_or(0.0);
            if !(release.time_s < end_s) {
                let what =
                    format!("the joint is let go at {} s, expected before the log's end at {end_s} s", release.time_s);
                return Err(unfit(what));
            }
            table.switch_off(joint, release.time_s);
        }
        Ok(table)
    }

    /// How a log begins: at rest, every driven joint reading its setpoint. On the floor the trunk is level, the lowest foot
    /// at the drop height; a clamped trunk stands as the log's `base` columns say. Before a drop the joints settle under
    /// the load.
    ///
    /// # Errors
    /// As [`run`].
    pub fn start_at(&self, model: &Model, setpoints: &Setpoints, log: &RobotLog) -> Result<State, SimulateError> {
        let first = |column: fn(&crate::log::BaseColumns) -> &Option<Vec<f64>>| {
            let values = log.base.as_ref().and_then(|base| column(base).as_ref());
            values.and_then(|values| values.first().copied()).unwrap_or(0.0)
        };
        let mut start = standing(model, &self.joints, setpoints);
        start.base_position_m = nalgebra::Vector3::new(first(|b| &b.x_m), first(|b| &b.y_m), first(|b| &b.z_m));
        let [roll, pitch, yaw] = [first(|b| &b.roll_rad), first(|b| &b.pitch_rad), first(|b| &b.yaw_rad)];
        match &self.floor {
            Some(floor) => {
                start.base_orientation = orientation([0.0, 0.0, yaw]);
                lift(floor, model, &mut start, self.drop_height_m);
            }
            None => start.base_orientation = orientation([roll, pitch, yaw]),
        }
        if self.scenario == RobotScenario::Drop { settled(model, &self.joints, setpoints, start) } else { Ok(start) }
    }

    /// One log of the study, ready to run.
    ///
    /// # Errors
    /// As [`Nominal::setpoints`] and [`Nominal::start_at`].
    pub fn scene(&self, entry: &RobotStudyLog, log: &RobotLog) -> Result<Scene, SimulateError> {
        let setpoints = self.setpoints(log, entry.release.as_ref())?;
        let model = match entry.release.as_ref().zip(entry.extra.as_ref()) {
            Some((release, extra)) => {
                with_load(&self.model, self.released(release)?, extra, &setpoints, release.time_s)?
            }
            None => self.model.clone(),
        };
        let start = self.start_at(&model, &setpoints, log)?;
        Ok(Scene { model, setpoints, start })
    }

    /// A scene as a problem for [`run`], sampled every `period_s`.
    pub fn scenario<'a>(&'a self, scene: &'a Scene, period_s: f64) -> Scenario<'a> {
        Scenario {
            model: &scene.model,
            joints: &self.joints,
            setpoints: &scene.setpoints,
            start: &scene.start,
            surroundings: self.floor.as_ref().map(|floor| floor as &dyn Surroundings),
            period_s,
        }
    }

    fn released(&self, release: &RobotRelease) -> Result<JointId, SimulateError> {
        let named = |error: super::RobotError| SimulateError::Unfit {
            file: self.file.clone(),
            what: format!("released: {error}"),
        };
        self.model.joint(&release.joint).map_err(named)
    }
}

/// The joints of a robot with friction and control as a study states them; `file` is its name in errors.
///
/// # Errors
/// [`SimulateError`] where the robot lacks a set, or gains are for no joint or kind of joint.
pub fn joints_of(
    model: &Model,
    friction: &LegFrictionSpec,
    control: &ControlSpec,
    file: &Path,
) -> Result<Joints, SimulateError> {
    let mut joints = Joints::passive(model);
    let states_all = friction.coulomb_nm.is_some() && friction.viscous_nm_s_rad.is_some();
    if !states_all || model.joint_ids().any(|id| model.friction(FRICTION_SET, id).is_some()) {
        joints.set_friction(model, FRICTION_SET)?;
    }
    let law = Control { derivative: control.derivative, hold: control.hold, sample_period_s: control.sample_period_s };
    if control.gains.is_empty() || model.joint_ids().any(|id| model.gains(GAIN_SET, id).is_some()) {
        joints.set_control(model, GAIN_SET, law)?;
    }
    let is_known = |row: &str| model.joints().iter().any(|joint| joint.name == row || joint.kind == row);
    if let Some(row) = control.gains.keys().find(|row| !is_known(row)) {
        let names: Vec<&str> = model.joints().iter().map(|joint| joint.name.as_str()).collect();
        let what =
            format!("[control] gains.{row}: {} has no such joint or kind; it has {}", model.name(), names.join(", "));
        return Err(SimulateError::Unfit { file: file.to_path_buf(), what });
    }
    for (id, joint) in model.joint_ids().zip(model.joints()) {
        if let Some(k) = LEG_KINDS.iter().position(|kind| *kind == joint.kind) {
            let law = &mut joints.drive_mut(id).chain.friction;
            law.coulomb_nm = friction.coulomb_nm.map_or(law.coulomb_nm, |by_joint| by_joint[k]);
            law.viscous_nm_s_rad = friction.viscous_nm_s_rad.map_or(law.viscous_nm_s_rad, |by_joint| by_joint[k]);
        }
        let row = control.gains.get(&joint.name).or_else(|| control.gains.get(&joint.kind));
        if let Some(&[kp_nm_rad, ki_nm_rad_s, kd_nm_s_rad]) = row {
            let gains = PidGains { kp_nm_rad, ki_nm_rad_s, kd_nm_s_rad };
            joints.drive_mut(id).set_control(gains, law, model.torque_limit_nm(id));
        }
    }
    joints.add_effects_of_file(model)?;
    Ok(joints)
}

/// The floor of a study's numbers; what it leaves out is as in the reference walk.
pub fn floor_of(spec: &FloorSpec) -> FloorParameters {
    stated(FloorParameters::default(), spec)
}

/// The floor of a study's numbers; what it leaves out is as in the robot's file, else as in the reference walk.
pub fn floor_on(model: &Model, spec: &FloorSpec) -> FloorParameters {
    let (of_file, slope_rad) = model.floor();
    let default = of_file.map_or_else(FloorParameters::default, floor_of);
    let [forward_rad, right_rad] = slope_rad;
    stated(if slope_rad == [0.0; 2] { default } else { default.sloped(forward_rad, right_rad) }, spec)
}

fn stated(default: FloorParameters, spec: &FloorSpec) -> FloorParameters {
    FloorParameters {
        stiffness_n_m: spec.stiffness_n_m.unwrap_or(default.stiffness_n_m),
        damping_n_s_m2: spec.damping_n_s_m2.unwrap_or(default.damping_n_s_m2),
        exponent: spec.exponent.unwrap_or(default.exponent),
        static_friction: spec.static_friction.unwrap_or(default.static_friction),
        coulomb: spec.coulomb.unwrap_or(default.coulomb),
        viscous_s_m: spec.viscous_s_m.unwrap_or(default.viscous_s_m),
        steepness_s_m: spec.steepness_s_m.unwrap_or(default.steepness_s_m),
        stribeck_speed_m_s: spec.stribeck_speed_m_s.unwrap_or(default.stribeck_speed_m_s),
        torsion_radius_m: spec.torsion_radius_m.unwrap_or(default.torsion_radius_m),
        ..default
    }
}

/// Puts the robot where a drop begins: its lowest foot point so high above the floor \[m\], all else as it is.
pub fn lift(floor: &Floor, model: &Model, start: &mut State, height_m: f64) {
    start.base_position_m.y = floor.height_on_m(&mut Dynamics::new(model), start) + height_m;
}

/// At rest, every driven joint where its encoder reads its first setpoint, the others at their place of rest.
pub fn standing(model: &Model, joints: &Joints, setpoints: &Setpoints) -> State {
    let mut start = State::at_rest(model);
    for (id, joint) in model.joint_ids().zip(model.joints()) {
        let drive = joints.drive(id);
        let first = drive.chain.motor.as_ref().and_then(|_| setpoints.at(id, setpoints.t_s[0]));
        start.angle_rad[id.index()] = match (first, &drive.spring) {
            (Some(reading_rad), _) => drive.true_rad(reading_rad),
            (None, Some(spring)) => spring.rest_rad,
            (None, None) => joint.resting_rad(),
        };
    }
    start
}

/// The state into which the joints settle at their first setpoints, all motors on, before a joint is let go.
///
/// # Errors
/// As [`run`]; [`SimulateError::Value`] where they do not settle.
pub fn settled(model: &Model, joints: &Joints, setpoints: &Setpoints, start: State) -> Result<State, SimulateError> {
    let begin_s = setpoints.t_s[0];
    let held = |(id, column): (JointId, &Option<Column>)| {
        column.as_ref()?;
        Some(Column { angle_rad: vec![setpoints.at(id, begin_s)?; 2], on: None })
    };
    let columns = model.joint_ids().zip(&setpoints.columns).map(held).collect();
    let held = Setpoints { t_s: vec![0.0, SETTLE_S], columns, hold: setpoints.hold };
    let scenario = Scenario { model, joints, setpoints: &held, start: &start, surroundings: None, period_s: SETTLE_S };
    let answer = run(&scenario, Method::default())?;
    match answer.diverged {
        None => Ok(answer.end),
        Some(diverged) => {
            let allowed = "joints that come to rest at their setpoints; check gains and effects";
            Err(SimulateError::Value {
                what: "the time at which held joints ran away [s]",
                value: diverged.at_s,
                allowed,
            })
        }
    }
}

/// A robot with a mass on the lower leg of the joint that is let go: its distance is from that joint's axis in the pose
/// at `at_s`.
///
/// # Errors
/// [`SimulateError`] where the joint is not of a leg, or no point of the lower leg's line has the distance.
pub fn with_load(
    model: &Model,
    released: JointId,
    extra: &ExtraMass,
    setpoints: &Setpoints,
    at_s: f64,
) -> Result<Model, SimulateError> {
    let name = &model.joints()[released.index()].name;
    let all = Leg::ALL.into_iter().flat_map(|leg| LegJoint::ALL.map(|joint| (leg, joint)));
    let Some((leg, joint)) = all.into_iter().find(|(leg, joint)| joint_name(*leg, *joint) == *name) else {
        return Err(SimulateError::Setpoints { what: format!("extra: {name} is no joint of a leg") });
    };
    let mut held = LegPose::STRAIGHT;
    for other in LegJoint::ALL {
        let id = model.joint(&joint_name(leg, other))?;
        held = held.with(other, setpoints.at(id, at_s).unwrap_or(0.0));
    }
    let gravity_trunk_m_s2 = model.gravity_m_s2();
    let case = LegCase { leg, joint, held, gravity_trunk_m_s2, mount_m: None, pose_known: true };
    loaded(model, &case, extra)
}

/// `R = Ry(yaw) Rx(pitch) Rz(roll)` of roll, pitch and yaw \[rad\].
pub fn orientation([roll, pitch, yaw]: [f64; 3]) -> UnitQuaternion<f64> {
    let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
    use nalgebra::Vector3 as V;
    about(V::y_axis(), yaw) * about(V::x_axis(), pitch) * about(V::z_axis(), roll)
}

/// Whether a joint is of a leg: it carries what may stand, or is carried by it.
fn leads_to_foot(model: &Model, joint: JointId) -> bool {
    let stands = |body: &BodyId| model.bodies()[body.index()].touches_floor();
    model.body_ids().filter(stands).filter_map(BodyId::joint).any(|foot| on_one_chain(model, joint, foot))
}

/// Whether one of two joints carries the other.
fn on_one_chain(model: &Model, a: JointId, b: JointId) -> bool {
    let carries = |above: JointId, below: JointId| {
        let mut at = Some(below);
        while let Some(joint) = at {
            if joint == above {
                return true;
            }
            at = BodyId::joint(model.carrier(joint));
        }
        false
    };
    carries(a, b) || carries(b, a)
}

#[cfg(test)]
mod tests;
