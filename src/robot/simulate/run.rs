//! From the first setpoint to the last.

use super::commands::Commands;
use super::recording::{BaseSample, Diverged, Recording, SpeedWarning};
use super::smooth::Smooth;
use super::stiff::Stiff;
use super::terms::At;
use super::{Scenario, SimulateError};
use crate::geometry::robot_file::Base;
use crate::integrate::{self, Counts};
use crate::robot::{JointId, RobotError, State};
use nalgebra::Vector3;

/// How to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The project's own, of order 2: linearly implicit in the joints' stiffness and damping, with true sticking.
    Stiff {
        /// Longest step \[s\].
        step_s: f64,
    },
    /// One of the methods for smooth systems, with friction made smooth and rates that its step cannot follow slowed down.
    Smooth(integrate::Method),
    /// The same with nothing slowed down: what the printed gains do to an explicit method.
    Explicit(integrate::Method),
}

impl Default for Method {
    fn default() -> Self {
        Method::Stiff { step_s: 1e-3 }
    }
}

/// Everything that a method carries along.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    pub t_s: f64,
    pub body: State,
    /// Integrals of the controllers' errors \[rad s\].
    pub integral_rad_s: Vec<f64>,
}

/// Beyond these a motion counts as diverged.
const RUNAWAY_RAD: f64 = 1e3;
const RUNAWAY_RAD_S: f64 = 1e5;
const RUNAWAY_M: f64 = 1e3;

enum Stepper<'a> {
    Stiff(Box<Stiff<'a>>),
    Smooth(Box<Smooth<'a>>),
}

/// Simulates a scenario.
///
/// A motion that runs away is a result: the recording ends there and says so.
///
/// # Errors
/// [`SimulateError`] where the scenario or the method cannot be.
pub fn run(scenario: &Scenario<'_>, method: Method) -> Result<Recording, SimulateError> {
    scenario.check()?;
    check(method)?;
    if let Method::Smooth(_) | Method::Explicit(_) = method {
        let mut joints = scenario.model.joints().iter().zip(scenario.joints.drives());
        if let Some((joint, _)) = joints.find(|(_, drive)| drive.chain.play.is_some()) {
            return Err(SimulateError::Backlash { joint: joint.name.clone() });
        }
        if let Some(one) = scenario.model.following().first() {
            let robot = scenario.model.name().to_owned();
            let joint = &scenario.model.joints()[one.follower].name;
            let what = format!("joint {joint} follows another (mimic), which only the stiff method holds");
            return Err(RobotError::NotSimulated { robot, what }.into());
        }
    }
    let (setpoints, clipped) = scenario.setpoints.clipped(scenario.model);
    let scenario = Scenario { setpoints: &setpoints, ..*scenario };
    let mut stepper = match method {
        Method::Stiff { step_s } => Stepper::Stiff(Box::new(Stiff::new(&scenario, step_s))),
        Method::Smooth(of) | Method::Explicit(of) => {
            let is_slowed = matches!(method, Method::Smooth(_));
            Stepper::Smooth(Box::new(Smooth::new(&scenario, of, is_slowed)))
        }
    };
    let mut commands = Commands::new(&scenario);
    let (start_s, end_s) = (setpoints.t_s[0], setpoints.t_s[setpoints.t_s.len() - 1]);
    let n = scenario.model.joints().len();
    let mut now = Carried { t_s: start_s, body: scenario.start.clone(), integral_rad_s: vec![0.0; n] };
    scenario.model.follow(&mut now.body);
    let mut recorder = Recorder::new(&scenario, clipped, &now);
    let samples = ((end_s - start_s) / scenario.period_s + 1e-6).floor() as usize;
    recorder.take(&scenario, &commands, &now, Vector3::zeros());
    'samples: for k in 1..=samples {
        let sample_s = start_s + k as f64 * scenario.period_s;
        let (mut before_m_s, mut over_s) = (now.body.base_velocity_m_s, scenario.period_s);
        while now.t_s < sample_s - 1e-12 {
            commands.update(now.t_s);
            evaluate_frames(&scenario, &mut commands, &mut now);
            let until_s = commands.next_s().min(sample_s);
            (before_m_s, over_s) = (now.body.base_velocity_m_s, until_s - now.t_s);
            let why = match &mut stepper {
                Stepper::Stiff(stiff) => stiff.advance(&mut now, &commands.now, until_s),
                Stepper::Smooth(smooth) => smooth.advance(&mut now, &commands.now, until_s),
            };
            if let Some(diverged) = why.or_else(|| runaway(&scenario, &now, method)) {
                recorder.recording.diverged = Some(diverged);
                break 'samples;
            }
        }
        now.t_s = sample_s;
        commands.update(now.t_s);
        recorder.take(&scenario, &commands, &now, (now.body.base_velocity_m_s - before_m_s) / over_s);
    }
    let counts = match &stepper {
        Stepper::Stiff(stiff) => stiff.counts(),
        Stepper::Smooth(smooth) => smooth.counts(),
    };
    Ok(recorder.finish(now.body, counts))
}

/// Laws that are evaluated in frames: those whose frame begins now.
fn evaluate_frames(scenario: &Scenario<'_>, commands: &mut Commands<'_>, now: &mut Carried) {
    commands.tick(now.t_s, |k, command, period_s| {
        let drive = &scenario.joints.drives()[k];
        let at = At {
            t_s: now.t_s,
            angle_rad: now.body.angle_rad[k],
            rate_rad_s: now.body.rate_rad_s[k],
            integral_rad_s: now.integral_rad_s[k],
        };
        let answer = drive.asked(command, at);
        now.integral_rad_s[k] += drive.error_rad(command, now.t_s, at.angle_rad) * period_s;
        answer
    });
}

fn check(method: Method) -> Result<(), SimulateError> {
    let step = |step_s: f64| match (1e-8..=1.0).contains(&step_s) {
        true => Ok(()),
        false => Err(SimulateError::Value { what: "the step [s]", value: step_s, allowed: "1e-8 to 1" }),
    };
    let tolerance = |of: integrate::Tolerance| {
        let value = of.relative.min(of.absolute);
        match value >= 1e-12 && of.relative.max(of.absolute) <= 0.1 {
            true => Ok(()),
            false => Err(SimulateError::Value { what: "the tolerance", value, allowed: "1e-12 to 0.1" }),
        }
    };
    match method {
        Method::Stiff { step_s } => step(step_s),
        Method::Smooth(of) | Method::Explicit(of) => match of {
            integrate::Method::Rk2 { step_s } | integrate::Method::Rk4 { step_s } => step(step_s),
            integrate::Method::DormandPrince(of) | integrate::Method::Adams(of) | integrate::Method::Bdf(of) => {
                tolerance(of)
            }
        },
    }
}

/// What has run away, if anything has.
fn runaway(scenario: &Scenario<'_>, now: &Carried, method: Method) -> Option<Diverged> {
    let body = &now.body;
    let away = |q: &f64, w: &f64| !(q.abs() < RUNAWAY_RAD && w.abs() < RUNAWAY_RAD_S);
    let joint = body.angle_rad.iter().zip(&body.rate_rad_s).position(|(q, w)| away(q, w));
    let base = !(body.base_position_m.norm() < RUNAWAY_M && body.base_rate_rad_s.norm() < RUNAWAY_RAD_S);
    if joint.is_none() && !base {
        return None;
    }
    Some(diverged(scenario, now.t_s, joint, suggestion(method)))
}

/// What may help against a motion that runs away.
pub(super) fn suggestion(method: Method) -> &'static str {
    match method {
        Method::Stiff { .. } => {
            "a law evaluated in frames with a high derivative gain is unstable in itself; else take a shorter step"
        }
        Method::Explicit(_) | Method::Smooth(integrate::Method::Rk2 { .. } | integrate::Method::Rk4 { .. }) => {
            "this method is explicit; take a shorter step, or the stiff method"
        }
        Method::Smooth(_) => "take a tighter tolerance, or the stiff method",
    }
}

pub(super) fn diverged(scenario: &Scenario<'_>, at_s: f64, joint: Option<usize>, why: &str) -> Diverged {
    let joint = joint.and_then(|k| scenario.model.joint_ids().nth(k));
    let joint_name = joint.map(|id| scenario.model.joints()[id.index()].name.clone());
    Diverged { at_s, joint, joint_name, why: why.to_owned() }
}

struct Recorder {
    recording: Recording,
    warnings: Vec<Option<SpeedWarning>>,
}

impl Recorder {
    fn new(scenario: &Scenario<'_>, clipped: Vec<JointId>, now: &Carried) -> Self {
        let n = scenario.model.joints().len();
        let empty = vec![Vec::new(); n];
        let recording = Recording {
            t_s: Vec::new(),
            angle_rad: empty.clone(),
            rate_rad_s: empty.clone(),
            setpoint_rad: empty.clone(),
            motor_nm: empty,
            base: Vec::new(),
            warnings: Vec::new(),
            clipped,
            diverged: None,
            counts: Counts::default(),
            end: now.body.clone(),
        };
        Self { recording, warnings: vec![None; n] }
    }

    fn take(&mut self, scenario: &Scenario<'_>, commands: &Commands<'_>, now: &Carried, acceleration: Vector3<f64>) {
        let r = &mut self.recording;
        r.t_s.push(now.t_s);
        for (k, id) in scenario.model.joint_ids().enumerate() {
            let (angle_rad, rate_rad_s) = (now.body.angle_rad[k], now.body.rate_rad_s[k]);
            r.angle_rad[k].push(angle_rad);
            r.rate_rad_s[k].push(rate_rad_s);
            r.setpoint_rad[k].push(scenario.setpoints.at(id, now.t_s).unwrap_or(f64::NAN));
            let at = At { t_s: now.t_s, angle_rad, rate_rad_s, integral_rad_s: now.integral_rad_s[k] };
            r.motor_nm[k].push(scenario.joints.drives()[k].motor_nm(commands.now[k], at));
            let Some(limit_rad_s) = scenario.model.joints()[k].speed_rad_s.filter(|limit| *limit > 0.0) else {
                continue;
            };
            if rate_rad_s.abs() > limit_rad_s {
                let warning = self.warnings[k].get_or_insert(SpeedWarning {
                    joint: id,
                    from_s: now.t_s,
                    samples: 0,
                    peak_rad_s: 0.0,
                    limit_rad_s,
                });
                warning.samples += 1;
                warning.peak_rad_s = warning.peak_rad_s.max(rate_rad_s.abs());
            }
        }
        let acceleration = match scenario.model.base() {
            Base::Floating => acceleration,
            Base::Clamped => Vector3::zeros(),
        };
        r.base.push(BaseSample {
            position_m: now.body.base_position_m,
            orientation: now.body.base_orientation,
            felt_m_s2: now.body.base_orientation.inverse() * (acceleration - scenario.model.gravity_m_s2()),
        });
    }

    fn finish(self, end: State, counts: Counts) -> Recording {
        Recording { warnings: self.warnings.into_iter().flatten().collect(), end, counts, ..self.recording }
    }
}
