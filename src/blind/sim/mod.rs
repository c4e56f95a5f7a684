//! The maker's own simulation: a fixed small step and set-valued friction, nothing shared with the code that diagnoses.
//!
//! Time stepping after Moreau: half a step of position, a whole step of speed with the forces of the middle, half a
//! step of position. Dry friction is an impulse: where it can stop the body within the step, the body stands.

use crate::number::math;

mod bodies;
mod drive;
mod friction;
mod link;
#[cfg(test)]
mod tests;

pub(super) use drive::Drive;
pub(super) use friction::{Curve, Friction, OverAngle, Stribeck};
pub(super) use link::{Knock, Link, Stop};

use super::plan::{Load, LogPlan};
use bodies::State;
use link::Pose;

/// What joins motor and link, where they are two bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coupling {
    /// Motor side's share of the bare inertia.
    pub rotor: f64,
    /// Its share of the friction.
    pub friction: f64,
    /// Total width of the play \[rad\].
    pub play_rad: f64,
    /// Stiffness of the flanks, or of the spring \[N m/rad\]; infinite: inelastic flanks.
    pub stiffness: f64,
    /// \[N m s/rad\]
    pub damping: f64,
    /// Pulls as well as pushes.
    pub spring: bool,
}

/// What the encoder makes of the angle: `gain q + a sin(n q + phi) + drift share`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    pub gain: f64,
    /// How far the zero has wandered at the end of a log \[rad\].
    pub drift_rad: f64,
    /// Age of the angle that is read, logged and seen by the controller alike \[s\]; of driven logs, for a free one is
    /// the same swing later.
    pub late_s: f64,
    pub a_rad: f64,
    pub n: f64,
    pub phi_rad: f64,
}

impl Reading {
    /// `share` is how much of the log is over \[0 to 1\].
    fn angle(&self, q_rad: f64, share: f64) -> f64 {
        let straight_rad = self.gain * q_rad + self.drift_rad * share;
        if self.a_rad == 0.0 {
            return straight_rad;
        }
        straight_rad + self.a_rad * math::sin(self.n * q_rad + self.phi_rad)
    }

    fn slope(&self, q_rad: f64) -> f64 {
        if self.a_rad == 0.0 {
            return self.gain;
        }
        self.gain + self.a_rad * self.n * math::cos(self.n * q_rad + self.phi_rad)
    }
}

/// A joint with everything that may be the matter with it.
#[derive(Clone, Debug)]
pub(super) struct Machine {
    /// `I*` of the bare link with its rotor \[kg m^2\].
    pub inertia_kg_m2: f64,
    /// `g M*` of the bare link \[N m\].
    pub peak_gravity_nm: f64,
    pub friction: Friction,
    pub link: Link,
    pub drive: Drive,
    pub coupling: Option<Coupling>,
    pub reading: Reading,
}

impl Machine {
    /// A joint with which nothing is the matter.
    pub(super) fn plain(inertia_kg_m2: f64, peak_gravity_nm: f64, coulomb_nm: f64, viscous_nm_s_rad: f64) -> Self {
        Self {
            inertia_kg_m2,
            peak_gravity_nm,
            friction: Friction { coulomb_nm, viscous_nm_s_rad, ..Friction::default() },
            link: Link::default(),
            drive: Drive::default(),
            coupling: None,
            reading: Reading { gain: 1.0, drift_rad: 0.0, late_s: 0.0, a_rad: 0.0, n: 0.0, phi_rad: 0.0 },
        }
    }

    /// Torque on the joint at rest, without friction \[N m\].
    fn static_nm(&self, q_rad: f64, setpoint_rad: f64, peak_nm: f64, log: usize) -> f64 {
        let at = Pose { t_s: 0.0, q_rad, v_rad_s: 0.0, log };
        let commanded = self.drive.commanded_nm(setpoint_rad, (self.reading.angle(q_rad, 0.0), 0.0), 0.0);
        self.drive.delivered_nm(commanded, q_rad, 0.0, 0.0)
            + self.link.gravity_nm(&at, peak_nm)
            + self.link.other_nm(&at)
    }

    /// Where the drive holds the joint without friction \[rad\]: halving the range around the setpoint.
    fn rest_rad(&self, setpoint_rad: f64, peak_nm: f64, log: usize) -> f64 {
        let (mut low, mut high) = (setpoint_rad - 1.5, setpoint_rad + 1.5);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if self.static_nm(middle, setpoint_rad, peak_nm, log) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// What a perfect logger would have recorded.
#[derive(Clone, Debug, Default)]
pub(super) struct Trace {
    /// Reading without noise at each sample \[rad\].
    pub q_rad: Vec<f64>,
    /// Commanded torque at each sample \[N m\]; zeros where nothing drives.
    pub tau_nm: Vec<f64>,
}

/// Moves the joint through a log, with steps of at most `longest_s` \[s\].
pub(super) fn simulate(machine: &Machine, plan: &LogPlan, log: usize, longest_s: f64) -> Trace {
    let load = plan.load.as_ref().map_or(Load { inertia_kg_m2: 0.0, peak_gravity_nm: 0.0 }, |extra| extra.load());
    let peak_nm = machine.peak_gravity_nm + load.peak_gravity_nm;
    let end_s = plan.times_s.last().copied().unwrap_or(0.0);
    let arrivals = plan.changes.as_ref().map(|changes| machine.drive.arrivals(changes, end_s, log));
    let start_rad = match &arrivals {
        Some(list) => {
            let setpoint = list.first().map_or(0.0, |(_, value)| *value);
            let band = machine.friction.coulomb_nm / (machine.drive.kp + peak_nm);
            machine.rest_rad(setpoint, peak_nm, log) + plan.start_share * band + plan.start_rad
        }
        None => plan.start_rad,
    };
    let mut run = bodies::Run::new(machine, &load, log, arrivals.as_deref(), end_s);
    let mut state = State::new(start_rad, plan.start_rad_s, run.flank(start_rad), run.first_setpoint());
    let mut trace = Trace::default();
    for &t_s in &plan.times_s {
        let from = state.t_s.max(plan.release_s);
        if t_s > from {
            state.t_s = from;
            let steps = ((t_s - from) / longest_s - 1e-6).ceil().max(1.0);
            let step_s = (t_s - from) / steps;
            for _ in 0..steps as usize {
                run.step(&mut state, step_s);
            }
            state.t_s = t_s;
        }
        trace.q_rad.push(run.read(&state, state.t_s).0);
        trace.tau_nm.push(run.commanded_nm(&mut state));
    }
    trace
}
