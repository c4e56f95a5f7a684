//! The robot as a system of differential equations, for the methods of `integrate`.
//!
//! State: base position (3) and orientation (quaternion, 4), angles, integrals of the controllers' errors, velocity
//! (6 + n). Friction is made smooth with `tanh(s w)`. An explicit method cannot follow rates beyond a few per step, and
//! the controllers' derivative terms reach 1.5e6 1/s; so each joint whose damping is faster than the method's limit gets
//! so much inertia, `max(0, B / limit - I)`, that it is as fast as the limit: the implicit form of its derivative term,
//! `(I + h B) dw = ...`, in every stage. Backward differentiation needs none of this.

use super::run::{Carried, Method, diverged, suggestion};
use super::terms::At;
use super::world::{Around, World};
use super::{Diverged, JointDrive, Scenario};
use crate::integrate::{self, Counts, Ode, Solver};
use crate::joint::Contact;
use crate::number::math;
use crate::pendulum::Command;
use crate::robot::{Input, State};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Steepness of the smooth sign \[s/rad\]: friction is whole from 0.03 rad/s on.
pub(super) const STEEPNESS_S_RAD: f64 = 100.0;
/// Share of the step's frequency that a fixed-step method is left to follow.
const FOLLOWED: f64 = 0.5;
/// Limit for the explicit methods that choose their step \[1/s\].
const LIMIT_1_S: f64 = 1e5;
const HOLDING: f64 = 1e9;

pub(super) struct Smooth<'a> {
    scenario: Scenario<'a>,
    method: integrate::Method,
    solver: Solver,
    system: System<'a>,
    y: Vec<f64>,
}

impl<'a> Smooth<'a> {
    /// With `is_slowed` no joint is faster than the method can follow.
    pub(super) fn new(scenario: &Scenario<'a>, method: integrate::Method, is_slowed: bool) -> Self {
        let limit_1_s = match method {
            _ if !is_slowed => None,
            integrate::Method::Rk2 { step_s } | integrate::Method::Rk4 { step_s } => Some(FOLLOWED / step_s),
            integrate::Method::DormandPrince(_) | integrate::Method::Adams(_) => Some(LIMIT_1_S),
            integrate::Method::Bdf(_) => None,
        };
        let system = System::new(scenario, limit_1_s);
        let n = scenario.model.joints().len();
        let mut y = vec![0.0; system.len()];
        write(scenario.start, &vec![0.0; n], &mut y);
        Self { scenario: *scenario, method, solver: Solver::new(method, y.len()), system, y }
    }

    pub(super) fn counts(&self) -> Counts {
        self.solver.counts()
    }

    pub(super) fn advance(&mut self, now: &mut Carried, commands: &[Command<f64>], until_s: f64) -> Option<Diverged> {
        let n = commands.len();
        self.system.commands.copy_from_slice(commands);
        self.y[7 + n..7 + 2 * n].copy_from_slice(&now.integral_rad_s);
        let done = self.solver.advance(&mut self.system, &mut now.t_s, &mut self.y, until_s);
        read(&self.y, &mut now.body, &mut now.integral_rad_s);
        let stalled = done.err()?;
        // What is fastest in units of what its limit allows is what ran away.
        let fastest = (0..n).max_by(|a, b| now.body.rate_rad_s[*a].abs().total_cmp(&now.body.rate_rad_s[*b].abs()));
        let why = format!("{}; {}", stalled.why, suggestion(Method::Smooth(self.method)));
        Some(diverged(&self.scenario, stalled.at_s, fastest, &why))
    }
}

/// Right-hand side.
struct System<'a> {
    scenario: Scenario<'a>,
    world: World<'a>,
    around: Around,
    commands: Vec<Command<f64>>,
    diagonal_kg_m2: Vec<f64>,
    torque_nm: Vec<f64>,
    acceleration: Vec<f64>,
    body: State,
    integral_rad_s: Vec<f64>,
}

impl<'a> System<'a> {
    fn new(scenario: &Scenario<'a>, limit_1_s: Option<f64>) -> Self {
        let n = scenario.model.joints().len();
        let until_s = scenario.setpoints.t_s.last().copied().unwrap_or(0.0);
        let diagonal = |drive: &JointDrive| match (drive.is_rigid, limit_1_s) {
            (true, _) => HOLDING * drive.chain.link.inertia_kg_m2,
            (false, None) => 0.0,
            (false, Some(limit)) => (drive.damping_nm_s_rad(until_s) / limit - drive.loose_kg_m2).max(0.0),
        };
        Self {
            scenario: *scenario,
            world: World::new(scenario),
            around: Around::new(scenario),
            commands: vec![Command::Off; n],
            diagonal_kg_m2: scenario.joints.drives().iter().map(diagonal).collect(),
            torque_nm: vec![0.0; n],
            acceleration: vec![0.0; 6 + n],
            body: scenario.start.clone(),
            integral_rad_s: vec![0.0; n],
        }
    }
}

impl JointDrive {
    /// All that damps it, at the most, in a run that ends at `until_s` \[N m s/rad\].
    fn damping_nm_s_rad(&self, until_s: f64) -> f64 {
        let law =
            self.chain.motor.as_ref().map_or(0.0, |motor| motor.stiffness_and_damping(crate::joint::Driven::ByLaw).1);
        let springs = self.spring.map_or(0.0, |s| s.damping_nm_s_rad);
        let stop = |stop: &crate::joint::EndStop<f64>| stop.damping_nm_s_rad;
        let stops: f64 = self.stops.iter().chain(&self.chain.stop).map(stop).sum();
        let f = &self.chain.friction;
        let friction = [0.0, until_s].map(|t_s| {
            let at = Contact { t_s, angle_rad: 0.0, speed_rad_s: 0.0, direction: 1.0, gravity_nm: 0.0, motor_nm: 0.0 };
            f.breakaway_nm(&at) * STEEPNESS_S_RAD + f.slope_nm_s_rad(0.0, t_s)
        });
        law + springs + stops + friction[0].max(friction[1])
    }
}

impl Ode for System<'_> {
    fn len(&self) -> usize {
        13 + 3 * self.commands.len()
    }

    fn rate(&mut self, t_s: f64, y: &[f64], rate: &mut [f64]) {
        let n = self.commands.len();
        read(y, &mut self.body, &mut self.integral_rad_s);
        self.world.surround(t_s, &self.body, &mut self.around);
        let (angles, integrals) = rate[7..7 + 2 * n].split_at_mut(n);
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            let rate_rad_s = if drive.is_rigid { 0.0 } else { self.body.rate_rad_s[j] };
            let (angle_rad, integral_rad_s) = (self.body.angle_rad[j], self.integral_rad_s[j]);
            let at = At { t_s, angle_rad, rate_rad_s, integral_rad_s };
            angles[j] = rate_rad_s;
            integrals[j] = drive.error_rad(self.commands[j], t_s, angle_rad);
            let motor_nm = drive.motor_nm(self.commands[j], at);
            let direction = if rate_rad_s < 0.0 { -1.0 } else { 1.0 };
            let f = &drive.chain.friction;
            let whole_nm = drive.friction_nm(at, direction, self.around.gravity_nm[j], motor_nm);
            let viscous_nm = f.viscous_nm_s_rad * rate_rad_s;
            let dry_nm = (whole_nm - viscous_nm.abs()).max(0.0) * math::tanh(STEEPNESS_S_RAD * rate_rad_s);
            self.torque_nm[j] = motor_nm + drive.elastic_nm(angle_rad, rate_rad_s) - viscous_nm - dry_nm;
            if drive.is_rigid {
                self.torque_nm[j] = 0.0;
            }
        }
        let input = Input {
            torque_nm: &self.torque_nm,
            diagonal_kg_m2: &self.diagonal_kg_m2,
            forces: &self.around.external.forces,
        };
        self.world.dynamics.forward(&self.body, &input, &mut self.acceleration);
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            if drive.is_rigid {
                self.acceleration[6 + j] = 0.0;
            }
        }
        rate[7 + 2 * n..].copy_from_slice(&self.acceleration);
        rate[..3].copy_from_slice(self.body.base_velocity_m_s.as_slice());
        // Half the product of the quaternion as it stands and the rate: its length stays.
        let q = Quaternion::new(y[3], y[4], y[5], y[6]);
        let turn = q * Quaternion::from_imag(self.body.base_rate_rad_s) * 0.5;
        rate[3..7].copy_from_slice(&[turn.w, turn.i, turn.j, turn.k]);
    }
}

fn write(body: &State, integral_rad_s: &[f64], y: &mut [f64]) {
    let n = integral_rad_s.len();
    let q = body.base_orientation.quaternion();
    y[..3].copy_from_slice(body.base_position_m.as_slice());
    y[3..7].copy_from_slice(&[q.w, q.i, q.j, q.k]);
    y[7..7 + n].copy_from_slice(&body.angle_rad);
    y[7 + n..7 + 2 * n].copy_from_slice(integral_rad_s);
    for (to, from) in y[7 + 2 * n..].iter_mut().zip(body.velocity()) {
        *to = from;
    }
}

fn read(y: &[f64], body: &mut State, integral_rad_s: &mut [f64]) {
    let n = integral_rad_s.len();
    let v = &y[7 + 2 * n..];
    body.base_position_m = Vector3::new(y[0], y[1], y[2]);
    body.base_orientation = UnitQuaternion::new_normalize(Quaternion::new(y[3], y[4], y[5], y[6]));
    body.angle_rad.copy_from_slice(&y[7..7 + n]);
    integral_rad_s.copy_from_slice(&y[7 + n..7 + 2 * n]);
    body.base_velocity_m_s = Vector3::new(v[0], v[1], v[2]);
    body.base_rate_rad_s = Vector3::new(v[3], v[4], v[5]);
    body.rate_rad_s.copy_from_slice(&v[6..]);
}
