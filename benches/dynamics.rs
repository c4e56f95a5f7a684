//! How long one evaluation of the robot's dynamics takes. `cargo bench --bench dynamics [NAME]`; figures are in
//! `benches/README.md`. `mujoco_dynamics.py` measures another engine beside it.
//!
//! The ERS-7 with a free base, 22 joints, no contact, at a bent and moving state.

use aibo_fit::robot::{BodyId, ContactDamping, Dynamics, Force, Input, LanesDynamics, Model, State};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use nalgebra::{DMatrix, Matrix3, UnitQuaternion, Vector3};

fn main() {
    divan::main();
}

/// Some state in which everything moves.
fn moving(model: &Model) -> State {
    let wave = |k: usize, scale: f64| scale * (1.0 + 0.7 * k as f64).sin();
    let n = model.joints().len();
    State {
        base_position_m: Vector3::new(0.1, 0.2, -0.3),
        base_orientation: UnitQuaternion::from_euler_angles(0.2, -0.4, 0.1),
        base_velocity_m_s: Vector3::new(0.3, -0.2, 0.5),
        base_rate_rad_s: Vector3::new(1.0, -2.0, 0.5),
        angle_rad: (0..n).map(|k| wave(k, 0.6)).collect(),
        rate_rad_s: (0..n).map(|k| wave(k + 3, 4.0)).collect(),
    }
}

/// Forward dynamics with torques alone.
#[divan::bench(sample_count = 200, sample_size = 500)]
fn forward(bencher: Bencher<'_, '_>) {
    let model = Model::ers7();
    let (state, mut dynamics) = (moving(model), Dynamics::new(model));
    let (torque, mut out) = ([0.01; 22], [0.0; 28]);
    bencher.bench_local(move || {
        dynamics.forward(black_box(&state), &Input::torques(black_box(&torque)), &mut out);
        out[6]
    });
}

/// The same of so many robots at once: the time that all of them take together.
#[divan::bench(sample_count = 200, sample_size = 100, args = [4, 8])]
fn forward_lanes(bencher: Bencher<'_, '_>, robots: usize) {
    let model = Model::ers7();
    let mut states = vec![moving(model); robots];
    for (k, state) in states.iter_mut().enumerate() {
        state.angle_rad.iter_mut().for_each(|angle| *angle *= 1.0 - 0.1 * k as f64);
    }
    let (mut dynamics, torque) = (LanesDynamics::new(model), [0.01; 22]);
    let inputs = vec![Input::torques(&torque); robots];
    let mut out = vec![0.0; 28 * robots];
    bencher.counter(ItemsCount::new(robots)).bench_local(move || {
        dynamics.forward(black_box(&states), black_box(&inputs), &mut out);
        out[6]
    });
}

/// Forward dynamics with implicit terms on the joints and a force on every foot.
#[divan::bench(sample_count = 200, sample_size = 500)]
fn forward_on_four_feet(bencher: Bencher<'_, '_>) {
    let model = Model::ers7();
    let (state, mut dynamics) = (moving(model), Dynamics::new(model));
    let feet = model.body_ids().filter(|body| model.bodies()[body.index()].touches_floor());
    let forces: Vec<Force> = feet.map(|foot| Force::at(foot, Vector3::zeros(), Vector3::y() * 4.0)).collect();
    let (torque, diagonal, mut out) = ([0.01; 22], [5e-5; 22], [0.0; 28]);
    bencher.bench_local(move || {
        let input = Input { torque_nm: black_box(&torque), diagonal_kg_m2: &diagonal, forces: black_box(&forces) };
        dynamics.forward(black_box(&state), &input, &mut out);
        out[6]
    });
}

/// The same, with every foot's contact taken implicitly.
#[divan::bench(sample_count = 200, sample_size = 500)]
fn forward_implicit_on_four_feet(bencher: Bencher<'_, '_>) {
    let model = Model::ers7();
    let (state, mut dynamics) = (moving(model), Dynamics::new(model));
    let feet: Vec<BodyId> = model.body_ids().filter(|body| model.bodies()[body.index()].touches_floor()).collect();
    let forces: Vec<Force> = feet.iter().map(|&foot| Force::at(foot, Vector3::zeros(), Vector3::y() * 4.0)).collect();
    let contact = |&body: &BodyId| ContactDamping {
        body,
        at_m: Vector3::zeros(),
        velocity_m_s: Vector3::new(0.1, -0.1, 0.0),
        damping_n_s_m: Matrix3::identity() * 800.0,
        stiffness_n_m: Matrix3::identity() * 2e4,
        spin_damping_nm_s_rad: Matrix3::zeros(),
    };
    let contacts: Vec<ContactDamping> = feet.iter().map(contact).collect();
    let (torque, diagonal, mut out) = ([0.01; 22], [5e-5; 22], [0.0; 28]);
    bencher.bench_local(move || {
        let input = Input { torque_nm: black_box(&torque), diagonal_kg_m2: &diagonal, forces: black_box(&forces) };
        dynamics.forward_implicit(black_box(&state), &input, 1e-4, black_box(&contacts), &mut out);
        out[6]
    });
}

/// Inverse dynamics.
#[divan::bench(sample_count = 200, sample_size = 200)]
fn bias(bencher: Bencher<'_, '_>) {
    let model = Model::ers7();
    let (state, mut dynamics) = (moving(model), Dynamics::new(model));
    let mut out = [0.0; 28];
    bencher.bench_local(move || {
        dynamics.bias(black_box(&state), &mut out);
        out[6]
    });
}

/// Mass matrix.
#[divan::bench(sample_count = 200, sample_size = 200)]
fn mass_matrix(bencher: Bencher<'_, '_>) {
    let model = Model::ers7();
    let (state, mut dynamics) = (moving(model), Dynamics::new(model));
    let mut out = DMatrix::zeros(28, 28);
    bencher.bench_local(move || {
        dynamics.mass_matrix(black_box(&state), &mut out);
        out[(6, 6)]
    });
}

/// Places and velocities of all bodies.
#[divan::bench(sample_count = 200, sample_size = 200)]
fn motions(bencher: Bencher<'_, '_>) {
    let model = Model::ers7();
    let (state, mut dynamics) = (moving(model), Dynamics::new(model));
    bencher.bench_local(move || dynamics.motions(black_box(&state))[5].position_m);
}
