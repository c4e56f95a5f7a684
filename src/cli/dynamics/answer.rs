//! What is answered for a state, under the keys of the shared sample.

use super::read::Asked;
use crate::cli::common::print;
use crate::number::math;
use crate::report::Provenance;
use crate::robot::{Dynamics, Input, Model};
use nalgebra::{DMatrix, DVector, Vector3};
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// The whole answer.
#[derive(Serialize)]
pub(super) struct Answers {
    pub conventions: Conventions,
    pub versions: BTreeMap<&'static str, String>,
    pub robot: String,
    pub states: Vec<StateAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timing: Option<Timing>,
    pub command: String,
    pub inputs: serde_json::Value,
}

/// How the numbers are meant.
#[derive(Serialize)]
pub(super) struct Conventions {
    pub world: String,
    pub quaternion: &'static str,
    pub velocity: &'static str,
    pub acceleration: &'static str,
    pub dynamics: &'static str,
    pub energy: &'static str,
    pub body_pos: &'static str,
    pub units: &'static str,
    pub joint_order: Vec<String>,
}

/// How long an evaluation takes.
#[derive(Serialize)]
pub(super) struct Timing {
    /// Of one forward-dynamics evaluation \[us\].
    pub median_us: f64,
    /// Goes that the median is of.
    pub goes: u32,
}

/// A go takes at least so many evaluations, so that the clock's own time does not count.
const EVALUATIONS: usize = 16;

impl Timing {
    /// The median of so many goes of evaluations at the states in turn.
    pub fn of<T>(goes: u32, states: &[T], mut evaluate: impl FnMut(&T)) -> Self {
        let rounds = EVALUATIONS.div_ceil(states.len());
        let mut go = || {
            let start = Instant::now();
            for _ in 0..rounds {
                states.iter().for_each(&mut evaluate);
            }
            1e6 * start.elapsed().as_secs_f64() / (rounds * states.len()) as f64
        };
        let mut times_us: Vec<f64> = (0..goes).map(|_| go()).collect();
        times_us.sort_by(f64::total_cmp);
        Self { median_us: times_us[times_us.len() / 2], goes }
    }

    /// Prints it.
    pub fn print(&self) {
        let Self { median_us, goes } = self;
        print(&format!("forward dynamics: {median_us:.3} us (median of {goes} goes over the states)\n"));
    }
}

/// A state with its answer.
#[derive(Serialize)]
pub(super) struct StateAnswer {
    pub base_pos: [f64; 3],
    pub base_quat_wxyz: [f64; 4],
    pub base_vel_world: [f64; 3],
    pub base_omega_body: [f64; 3],
    pub q: Vec<f64>,
    pub dq: Vec<f64>,
    pub tau: Vec<f64>,
    pub out: Out,
}

/// What was computed.
#[derive(Serialize)]
#[expect(non_snake_case, reason = "the keys of the format")]
pub(super) struct Out {
    pub qacc: Vec<f64>,
    pub bias: Vec<f64>,
    pub M_times_v: Vec<f64>,
    pub M_diag: Vec<f64>,
    pub M_trace: f64,
    pub M_logdet: f64,
    pub com: [f64; 3],
    pub com_vel: [f64; 3],
    pub kinetic_energy: f64,
    pub potential_energy: f64,
    pub total_energy: f64,
    pub body_pos: BTreeMap<String, [f64; 3]>,
    pub M: Vec<Vec<f64>>,
}

impl Answers {
    pub fn new(model: &Model, states: Vec<StateAnswer>, timing: Option<Timing>, from: &Provenance) -> Self {
        let [x, y, z]: [f64; 3] = model.gravity_m_s2().into();
        Self {
            conventions: Conventions {
                world: format!("right-handed; gravity ({x}, {y}, {z}) m/s^2"),
                quaternion: "w,x,y,z; rotates body-frame vectors into the world",
                velocity: "v = [base linear velocity of the base's centre, WORLD axes (3); base angular velocity, BODY \
                           axes (3); dq]",
                acceleration: "qacc = time derivative of v; gravity acts, so free fall gives -9.81 in y; zero for a \
                               clamped base",
                dynamics: "M qacc + bias = [0 (6); tau]; bias = Coriolis, centrifugal and gravity",
                energy: "kinetic = v.M.v/2; potential = -sum m g.c with zero at world origin",
                body_pos: "world position of each part centre (m), massless parts left out",
                units: "SI",
                joint_order: model.joints().iter().map(|joint| joint.name.clone()).collect(),
            },
            versions: BTreeMap::from([("aibo-fit", from.version.clone())]),
            robot: model.name().to_owned(),
            states,
            timing,
            command: from.command.clone(),
            inputs: serde_json::json!(from.hashed()),
        }
    }
}

/// Answers a state; `None` where a number is not finite.
pub(super) fn answer(dynamics: &mut Dynamics<'_>, asked: &Asked) -> Option<StateAnswer> {
    let (state, n) = (&asked.state, dynamics.freedoms());
    let mut qacc = vec![0.0; n];
    dynamics.forward(state, &Input::torques(&asked.torque_nm), &mut qacc);
    let mut bias = vec![0.0; n];
    dynamics.bias(state, &mut bias);
    let mut matrix = DMatrix::zeros(n, n);
    dynamics.mass_matrix(state, &mut matrix);
    let momentum = &matrix * DVector::from_iterator(n, state.velocity());
    let (energy, whole) = (dynamics.energy(state), dynamics.momentum(state));
    let model = dynamics.model();
    let placed = model.bodies().iter().zip(dynamics.motions(state)).filter(|(body, _)| body.mass_kg > 0.0);
    let body_pos = placed.map(|(body, motion)| (body.name.clone(), motion.position_m.into())).collect();
    // The determinant of a mass matrix leaves the range of a double with some hundred joints.
    let logdet = matrix.clone().cholesky()?.l_dirty().diagonal().map(|pivot: f64| 2.0 * math::ln(pivot)).sum();
    let out = Out {
        qacc,
        bias,
        M_times_v: momentum.iter().copied().collect(),
        M_diag: matrix.diagonal().iter().copied().collect(),
        M_trace: matrix.trace(),
        M_logdet: logdet,
        com: whole.centre_m.into(),
        com_vel: whole.velocity_m_s.into(),
        kinetic_energy: energy.kinetic_j,
        potential_energy: energy.potential_j,
        total_energy: energy.total_j(),
        body_pos,
        M: matrix.row_iter().map(|row| row.iter().copied().collect()).collect(),
    };
    out.is_finite().then(|| {
        let triple = |v: &Vector3<f64>| -> [f64; 3] { (*v).into() };
        let q = &state.base_orientation;
        StateAnswer {
            base_pos: triple(&state.base_position_m),
            base_quat_wxyz: [q.w, q.i, q.j, q.k],
            base_vel_world: triple(&state.base_velocity_m_s),
            base_omega_body: triple(&state.base_rate_rad_s),
            q: state.angle_rad.clone(),
            dq: state.rate_rad_s.clone(),
            tau: asked.torque_nm.clone(),
            out,
        }
    })
}

impl Out {
    fn is_finite(&self) -> bool {
        let scalars = [self.M_logdet, self.kinetic_energy, self.potential_energy, self.total_energy];
        let vectors = self.qacc.iter().chain(&self.bias).chain(&self.M_times_v).chain(&self.com).chain(&self.com_vel);
        vectors.chain(&scalars).all(|x| x.is_finite())
    }
}
