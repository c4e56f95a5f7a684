//! One log made ready to be fitted: the samples that count, what acts on the joint, and how the motion begins.

use crate::fit::Rounding;
use crate::geometry::LinkBody;
use crate::joint::{Carriage, Motor, Real};
use crate::log::{DriveMode, ExtraMass, Health, Hold, Log, MotorModel, MotorSpec, Role, Stamped, StudyLog, TauIs};
use crate::pendulum::{Input, Start};
use std::ops::Range;
use std::sync::Arc;

/// A known mass on the link, as it acts about the joint axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// About the joint axis \[kg m^2\].
    pub inertia_kg_m2: f64,
    /// \[kg m\]
    pub moment_kg_m: f64,
    /// Hanging angle of the mass alone less that of the nominal bare link \[rad\]; zero where the geometry is not known.
    pub angle_rad: f64,
    /// Encoder angle at which the mass alone would hang \[rad\]; used where the link is written by its bodies.
    pub hanging_rad: f64,
}

impl Load {
    /// A hollow cylinder whose axis lies along the link, in the direction of the link's centre of mass (3.8-3.10).
    pub fn on_the_link(extra: &ExtraMass) -> Self {
        let across = crate::geometry::inertia::hollow_cylinder_across(extra.mass_kg, extra.radius_m, extra.length_m);
        Self {
            inertia_kg_m2: crate::geometry::inertia::parallel_axis_scalar(across, extra.mass_kg, extra.distance_m),
            moment_kg_m: extra.mass_kg * extra.distance_m,
            angle_rad: 0.0,
            hanging_rad: 0.0,
        }
    }
}

/// One body of the link: its inertia and its lever, per kilogram.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Which one.
    pub body: LinkBody,
    /// About the joint axis \[m^2\].
    pub inertia_per_kg_m2: f64,
    /// Distance of its centre of mass from the axis \[m\].
    pub lever_m: f64,
    /// Angle at which it alone would hang \[rad\].
    pub hanging_rad: f64,
}

/// What drives the joint; the vectors are as long as the experiment's times.
#[derive(Clone, Debug, PartialEq)]
pub enum Signal {
    /// Nothing: a free swing.
    Off,
    /// A torque on the joint.
    Torque {
        /// Held from its sample to the next \[N m\].
        torque_nm: Vec<f64>,
        /// Whether the motor is on; `None`: always.
        on: Option<Vec<bool>>,
    },
    /// A setpoint through the motor's controller.
    Position {
        /// The one in force at each of the times \[rad\].
        setpoint_rad: Vec<f64>,
        /// Setpoints at stamps of their own \[rad\], on the experiment's clock, from before its start to beyond its end;
        /// `None`: they come with the readings.
        apart: Option<Arc<Stamped>>,
        /// How it is read between its samples.
        hold: Hold,
        /// Whether the motor is on; `None`: always.
        on: Option<Vec<bool>>,
    },
}

/// One log made ready.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// As the user named it.
    pub file: String,
    /// Which item of its [`Case`](super::Case) the log is; 0 outside a case.
    pub log_index: usize,
    /// Which part of a log that has holes this is, from 1; 0: the log has none.
    pub part: usize,
    /// Logs of one session were taken in one go; `None`: this log stands alone.
    pub session: Option<String>,
    /// What the log is used for.
    pub role: Role,
    /// Where in the log the experiment begins.
    pub first_sample: usize,
    /// From the experiment's first sample on, relative to the log's first sample \[s\].
    pub t_s: Vec<f64>,
    /// Readings \[rad\].
    pub measured_rad: Vec<f64>,
    /// Samples at the beginning that are not compared: the last held one.
    pub uncompared: usize,
    /// Weights of the compared samples \[s\] (3.7): half the time to either neighbour.
    pub weights_s: Vec<f64>,
    /// What drives the joint.
    pub signal: Signal,
    /// The controller of a position-driven log.
    pub motor: Option<MotorSpec>,
    /// A log that begins held: the two instants between which the joint was let go \[s\].
    pub release_window_s: Option<[f64; 2]>,
    /// Guess of the start.
    pub start: Start<f64>,
    /// The known mass on the link.
    pub load: Option<Load>,
    /// Bodies of the bare link, where its geometry is known.
    pub bodies: Vec<Body>,
    /// What a log that is driven by position says of the torque at the joint \[N m\].
    pub torque_seen_nm: Option<Vec<f64>>,
    /// What a joint of a robot carries along the log; `None`: the same link all the time.
    pub carriage: Option<Carriage>,
    /// Gravity in the plane of motion \[m/s^2\].
    pub gravity_m_s2: f64,
    /// Quantisation step \[rad\]; 0: none known.
    pub resolution_rad: f64,
    /// Phases among the compared samples in which the encoder repeats one rounding error.
    pub runs: Vec<Range<usize>>,
}

/// Phases of one repeated rounding error count once from this length on.
const LONG_RUN: usize = 12;

/// The torque at the joint that a position-driven log says there was \[N m\]. What its law asks for before gain and
/// limits says nothing of what arrives.
fn torque_seen_nm(log: &Log, entry: &StudyLog) -> Option<Vec<f64>> {
    let (logged, tau_is) = (log.tau_nm.as_ref()?, entry.tau_is?);
    match tau_is {
        TauIs::Applied => Some(logged.clone()),
        TauIs::Current { nm_per_a } => Some(logged.iter().map(|current_a| current_a * nm_per_a).collect()),
        TauIs::Commanded => None,
    }
}

impl Experiment {
    /// Prepares a log of which `found` is known; `None` where fewer than three samples are free.
    pub fn new(log: &Log, entry: &StudyLog, found: &Health, resolution_rad: f64, gravity_m_s2: f64) -> Option<Self> {
        let t0 = *log.t_s.first()?;
        let held = found.start.held();
        let (first, uncompared, window) = match held {
            Some(held) => (held.last_held, 1, Some(held.window_s.map(|t| t - t0))),
            None => (0, 0, None),
        };
        // A joint that is caught again is no longer free.
        let end = match (&log.drive, entry.drive) {
            (Some(drive), DriveMode::Off) => (first + uncompared..log.len()).find(|&k| drive[k]).unwrap_or(log.len()),
            _ => log.len(),
        };
        if first + uncompared + 3 > end {
            return None;
        }
        let part = first..end;
        let t_s: Vec<f64> = log.t_s[part.clone()].iter().map(|t| t - t0).collect();
        let measured_rad = log.q_rad[part.clone()].to_vec();
        let on = || log.drive.as_ref().map(|d| d[part.clone()].to_vec());
        let signal = match entry.drive {
            DriveMode::Off => Signal::Off,
            DriveMode::Torque => Signal::Torque { torque_nm: log.tau_nm.as_ref()?[part.clone()].to_vec(), on: on() },
            DriveMode::Position => Signal::Position {
                setpoint_rad: log.q_ref_rad.as_ref()?[part.clone()].to_vec(),
                apart: log.setpoints.as_ref().map(|own| {
                    let t_s = own.t_s.iter().map(|t| t - t0).collect();
                    Arc::new(Stamped { t_s, values: own.values.clone() })
                }),
                hold: entry.motor.map(|m| m.hold).unwrap_or_default(),
                on: on(),
            },
        };
        let start = match (held, window) {
            (Some(held), Some([low, high])) => Start {
                angle_rad: found.held_mean_rad.unwrap_or(measured_rad[0]),
                rate_rad_s: 0.0,
                release_s: Some((held.release_s - t0).clamp(low, high)),
            },
            _ => {
                let (angle_rad, rate_rad_s) = super::smooth::at_start(&t_s, &measured_rad);
                Start { angle_rad, rate_rad_s, release_s: None }
            }
        };
        let weights_s = super::weights::trapezoid(&t_s[uncompared..]);
        let runs = super::weights::repeated_roundings(&measured_rad[uncompared..], resolution_rad, LONG_RUN);
        Some(Self {
            file: entry.file.clone(),
            log_index: 0,
            part: 0,
            session: entry.session.clone(),
            role: entry.role,
            first_sample: first,
            uncompared,
            weights_s,
            signal,
            motor: entry.motor,
            release_window_s: window,
            start,
            load: entry.extra.as_ref().map(Load::on_the_link),
            bodies: Vec::new(),
            torque_seen_nm: torque_seen_nm(log, entry).map(|all| all[part].to_vec()),
            carriage: None,
            gravity_m_s2,
            resolution_rad,
            runs,
            t_s,
            measured_rad,
        })
    }

    /// The experiment cut into parts of about `window_s`, each with a free start of its own.
    ///
    /// Over a short time a motion cannot run far from its log, whatever the parameters: fitting the parts has few local
    /// minima.
    pub(crate) fn parts(&self, window_s: f64) -> Vec<Self> {
        let mut parts = Vec::new();
        let mut from = 0;
        while from + 8 < self.t_s.len() {
            let held_until = if from == 0 { self.start.release_s.unwrap_or(self.t_s[0]) } else { self.t_s[from] };
            let inside = self.t_s[from..].iter().take_while(|t| **t <= held_until + window_s).count();
            let mut to = from + inside.max(8);
            if self.t_s.len().saturating_sub(to) < 8 {
                to = self.t_s.len();
            }
            parts.push(self.part(from..to));
            from = to;
        }
        parts
    }

    /// A part of the log, with the phases of one rounding error in it: between two holes, with its `number` from 1.
    pub(crate) fn part_of_log(&self, range: Range<usize>, number: usize) -> Self {
        let part = self.part(range);
        let compared = &part.measured_rad[part.uncompared..];
        let runs = super::weights::repeated_roundings(compared, self.resolution_rad, LONG_RUN);
        Self { runs, part: number, ..part }
    }

    /// The file, with the part's number where the log has several.
    pub fn label(&self) -> String {
        if self.part == 0 { self.file.clone() } else { format!("{} (part {})", self.file, self.part) }
    }

    /// A part of the log with a start of its own where it does not begin with the log.
    pub(crate) fn part(&self, range: Range<usize>) -> Self {
        let begins = range.start == 0;
        let uncompared = if begins { self.uncompared } else { 0 };
        let cut = |on: &Option<Vec<bool>>| on.as_ref().map(|on| on[range.clone()].to_vec());
        let signal = match &self.signal {
            Signal::Off => Signal::Off,
            Signal::Torque { torque_nm, on } => {
                Signal::Torque { torque_nm: torque_nm[range.clone()].to_vec(), on: cut(on) }
            }
            Signal::Position { setpoint_rad, apart, hold, on } => {
                let setpoint_rad = setpoint_rad[range.clone()].to_vec();
                Signal::Position { setpoint_rad, apart: apart.clone(), hold: *hold, on: cut(on) }
            }
        };
        let t_s = self.t_s[range.clone()].to_vec();
        let measured_rad = self.measured_rad[range.clone()].to_vec();
        let start = if begins {
            self.start
        } else {
            let (angle_rad, rate_rad_s) = super::smooth::at_start(&t_s, &measured_rad);
            Start { angle_rad, rate_rad_s, release_s: None }
        };
        Self {
            first_sample: self.first_sample + range.start,
            uncompared,
            weights_s: super::weights::trapezoid(&t_s[uncompared..]),
            signal,
            release_window_s: self.release_window_s.filter(|_| begins),
            start,
            runs: Vec::new(),
            bodies: self.bodies.clone(),
            torque_seen_nm: self.torque_seen_nm.as_ref().map(|all| all[range.clone()].to_vec()),
            carriage: self.carriage.clone(),
            file: self.file.clone(),
            session: self.session.clone(),
            t_s,
            measured_rad,
            ..*self
        }
    }

    /// What drives the joint: a torque acts as it is, a setpoint through the servo.
    pub(crate) fn driven_by<T: Real>(&self) -> Option<Motor<T>> {
        match self.signal {
            Signal::Off => None,
            Signal::Torque { .. } => Some(Motor::direct()),
            Signal::Position { .. } => self.motor.map(Motor::new),
        }
    }

    /// What the motor is asked for at the most \[N m\].
    pub(crate) fn largest_command_nm(&self) -> f64 {
        match (&self.signal, &self.motor) {
            (Signal::Torque { torque_nm, .. }, _) => torque_nm.iter().map(|t| t.abs()).fold(0.0, f64::max),
            (Signal::Position { setpoint_rad, .. }, Some(motor)) => {
                let errors = setpoint_rad.iter().zip(&self.measured_rad).map(|(r, q)| (r - q).abs());
                let most = match motor.model {
                    MotorModel::Torque => f64::INFINITY,
                    MotorModel::Voltage(motor) => motor.duty_limit,
                };
                motor.nm_per_answer() * (motor.kp_nm_rad * errors.fold(0.0, f64::max)).min(most)
            }
            _ => 0.0,
        }
    }

    /// What acts on the joint.
    pub fn input(&self) -> Input<'_> {
        match &self.signal {
            Signal::Position { apart: Some(apart), hold, on, .. } => {
                Input::Messages { at_s: &apart.t_s, setpoint_rad: &apart.values, hold: *hold, on: on.as_deref() }
            }
            _ => self.input_at_samples(),
        }
    }

    /// The same with setpoints as they are in force at the samples.
    pub fn input_at_samples(&self) -> Input<'_> {
        match &self.signal {
            Signal::Off => Input::Off,
            Signal::Torque { torque_nm, on } => Input::Torque { torque_nm, on: on.as_deref() },
            Signal::Position { setpoint_rad, hold, on, .. } => {
                Input::Position { setpoint_rad, hold: *hold, on: on.as_deref() }
            }
        }
    }

    /// True where a motor acts at some time.
    pub fn is_driven(&self) -> bool {
        self.signal != Signal::Off
    }

    /// What rounding to the encoder's steps alone adds to the criterion (3.7) \[rad^2 s\].
    pub(crate) fn rounding_rad2_s(&self) -> f64 {
        self.weights_s.iter().sum::<f64>() * self.resolution_rad.powi(2) / 12.0
    }

    /// Number of samples that are compared with the model.
    pub fn compared(&self) -> usize {
        self.t_s.len() - self.uncompared
    }

    /// The start from its two coordinates: angle and release instant, or angle and rate.
    pub fn start_from<T: Real>(&self, first: T, second: T) -> Start<T> {
        match self.release_window_s {
            Some(_) => Start { angle_rad: first, rate_rad_s: T::nought(), release_s: Some(second) },
            None => Start { angle_rad: first, rate_rad_s: second, release_s: None },
        }
    }

    /// The two coordinates of a start.
    pub fn start_coordinates(&self, start: &Start<f64>) -> [f64; 2] {
        [start.angle_rad, start.release_s.unwrap_or(start.rate_rad_s)]
    }

    /// Rounding of the readings, for honest intervals.
    pub fn rounding(&self) -> Rounding {
        Rounding { step: self.resolution_rad, runs: self.runs.clone() }
    }
}
