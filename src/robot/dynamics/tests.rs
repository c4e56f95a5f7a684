//! Each evaluation against the others, closed forms, conservation laws, and two other engines.

mod implicit;
mod lanes;

use super::*;
use crate::geometry::robot_file::Base;
use crate::geometry::{Joint, Part, RobotTables};
use crate::robot::{BodyId, JointId};
use nalgebra::{DMatrix, DVector, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::path::Path;

fn three_link() -> Model {
    let text = include_str!("../../../data/examples/robots/three-link.toml");
    Model::from_toml(Path::new("three-link.toml"), text).unwrap()
}

/// A robot with a name for messages.
fn robots() -> Vec<Model> {
    let ers7 = Model::ers7().clone();
    let arm = three_link();
    let hand = arm.body("hand").unwrap();
    let lopsided = arm.with_point_mass(hand, 0.05, Vector3::new(0.02, -0.01, 0.03)).unwrap();
    vec![
        ers7.with_base(Base::Clamped),
        ers7.with_attached(BodyId::BASE, crate::robot::Attached::point(0.2, Vector3::new(0.01, 0.05, -0.03))).unwrap(),
        ers7,
        arm.with_base(Base::Floating),
        lopsided.with_base(Base::Floating),
        arm,
    ]
}

/// A tree that nobody made: any branching, axes along and beside the coordinate axes, shifted and unshifted.
fn random_tree(dice: &mut Dice) -> Model {
    let joints = 1 + (dice.next().abs() * 14.0) as usize;
    let part = |k: usize, dice: &mut Dice| Part {
        name: format!("part{k}"),
        diameters_m: Vector3::repeat(0.1),
        mass_kg: 0.2 + 0.1 * dice.next(),
        stated_inertia_kg_m2: Vector3::repeat(1e-3) + dice.vector(3e-4),
        contact_m: None,
    };
    let joint = |k: usize, dice: &mut Dice| {
        let parent = (dice.next().abs() * (k + 1) as f64) as usize;
        let axis = match (dice.next().abs() * 5.0) as usize {
            0 => Unit::new_normalize(dice.vector(1.0)),
            1 => Vector3::x_axis(),
            2 => -Vector3::y_axis(),
            _ => Vector3::z_axis(),
        };
        let often = |dice: &mut Dice| if dice.next() < 0.0 { Vector3::zeros() } else { dice.vector(0.1) };
        Joint {
            name: format!("joint{k}"),
            kind: "any".to_owned(),
            parent: format!("part{parent}"),
            child: format!("part{}", k + 1),
            axis,
            sign: if dice.next() < 0.0 { -1.0 } else { 1.0 },
            in_parent_m: often(dice),
            in_child_m: often(dice),
            phi_rad: if dice.next() < 0.5 { axis.into_inner() * dice.next() } else { dice.vector(1.0) },
            hardware_rad: None,
            software_rad: None,
            speed_rad_s: None,
            spring: None,
        }
    };
    let mut tables = RobotTables::from_toml(
        Path::new("root.toml"),
        "schema = 1\nname = \"tree\"\nroot = \"part0\"\npart = [{ name = \"part0\", diameter_m = [0.1, 0.1, 0.1], \
         mass_kg = 0.5 }]",
    )
    .unwrap();
    for k in 0..joints {
        tables.parts.push(part(k + 1, dice));
        tables.joints.push(joint(k, dice));
    }
    Model::new(tables).unwrap()
}

/// Numbers between -1 and 1 that look random.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, scale: f64) -> Vector3<f64> {
        Vector3::new(self.next(), self.next(), self.next()) * scale
    }

    fn many(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| self.next() * scale).collect()
    }

    fn state(&mut self, model: &Model) -> State {
        let n = model.joints().len();
        let is_free = f64::from(u8::from(model.base() == Base::Floating));
        State {
            base_position_m: self.vector(2.0),
            base_orientation: UnitQuaternion::from_scaled_axis(self.vector(2.0)),
            base_velocity_m_s: self.vector(is_free),
            base_rate_rad_s: self.vector(5.0 * is_free),
            angle_rad: self.many(n, 3.0),
            rate_rad_s: self.many(n, 8.0),
        }
    }

    fn forces(&mut self, model: &Model) -> Vec<Force> {
        let point = |dice: &mut Self, body| Force {
            body,
            at_m: dice.vector(2.0),
            force_n: dice.vector(3.0),
            moment_nm: dice.vector(0.1),
        };
        model.body_ids().map(|body| point(self, body)).collect()
    }
}

fn solve(model: &Model, state: &State, input: &Input<'_>) -> Vec<f64> {
    let mut dynamics = Dynamics::new(model);
    let mut out = vec![f64::NAN; dynamics.freedoms()];
    dynamics.forward(state, input, &mut out);
    out
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// Largest difference in units of the largest value.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let most = a.iter().zip(b).fold(0.0, |most: f64, (x, y)| most.max((x - y).abs()));
    most / largest(b).max(1e-300)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    /// The articulated-body algorithm against the mass matrix and the bias, with every kind of input.
    #[test]
    fn forward_dynamics_solves_the_equations_of_motion(seed in any::<u64>(), which in 0_usize..12) {
        let mut dice = Dice(seed);
        let model = &robots().get(which).cloned().unwrap_or_else(|| random_tree(&mut dice));
        let n = model.joints().len();
        let state = dice.state(model);
        let (torque, forces) = (dice.many(n, 0.5), dice.forces(model));
        let diagonal: Vec<f64> = dice.many(n, 1e-3).iter().map(|x| x.abs()).collect();
        let input = Input { torque_nm: &torque, diagonal_kg_m2: &diagonal, forces: &forces };
        let found = solve(model, &state, &input);
        let mut dynamics = Dynamics::new(model);
        let mut matrix = DMatrix::zeros(n + 6, n + 6);
        dynamics.mass_matrix(&state, &mut matrix);
        let mut bias = vec![0.0; n + 6];
        dynamics.inverse(&state, &vec![0.0; n + 6], &forces, &mut bias);
        for k in 0..n {
            matrix[(6 + k, 6 + k)] += diagonal[k];
        }
        let first = if model.base() == Base::Clamped { 6 } else { 0 };
        let size = n + 6 - first;
        let full: Vec<f64> = std::iter::repeat_n(0.0, 6).chain(torque.iter().copied()).collect();
        let right = DVector::from_iterator(size, (first..n + 6).map(|k| full[k] - bias[k]));
        let left = matrix.view((first, first), (size, size)).into_owned();
        let expected = left.clone().cholesky().expect("positive definite").solve(&right);
        prop_assert!(apart(&found[first..], expected.as_slice()) < 1e-9, "{}", apart(&found[first..], expected.as_slice()));
        prop_assert!(found[..first].iter().all(|x| *x == 0.0));
    }

    /// What inverse dynamics asks for is what forward dynamics was given.
    #[test]
    fn inverse_dynamics_undoes_forward_dynamics(seed in any::<u64>(), which in 0_usize..12) {
        let mut dice = Dice(seed);
        let model = &robots().get(which).cloned().unwrap_or_else(|| random_tree(&mut dice));
        let n = model.joints().len();
        let state = dice.state(model);
        let (torque, forces) = (dice.many(n, 0.5), dice.forces(model));
        let acceleration = solve(model, &state, &Input { torque_nm: &torque, diagonal_kg_m2: &[], forces: &forces });
        let mut back = vec![0.0; n + 6];
        Dynamics::new(model).inverse(&state, &acceleration, &forces, &mut back);
        prop_assert!(apart(&back[6..], &torque) < 1e-8);
        if model.base() == Base::Floating {
            prop_assert!(largest(&back[..6]) < 1e-8, "{:?}", &back[..6]);
        }
    }

    /// d(E)/dt = tau . q' + f . v for any motion; checked by a difference along the motion.
    #[test]
    fn power_is_the_rate_of_energy(seed in any::<u64>(), which in 0_usize..6) {
        let model = &robots()[which];
        let (n, mut dice) = (model.joints().len(), Dice(seed));
        let mut state = dice.state(model);
        state.rate_rad_s.iter_mut().for_each(|rate| *rate *= 0.2);
        let torque = dice.many(n, 0.5);
        let mut dynamics = Dynamics::new(model);
        let power: f64 = torque.iter().zip(&state.rate_rad_s).map(|(t, w)| t * w).sum();
        let h = 1e-5;
        let energy = |dynamics: &mut Dynamics<'_>, h: f64| {
            let moved = step(dynamics, &state, &torque, h);
            dynamics.energy(&moved).total_j()
        };
        let difference = (energy(&mut dynamics, h) - energy(&mut dynamics, -h)) / (2.0 * h);
        let scale = 1.0 + power.abs() + largest(&solve(model, &state, &Input::torques(&torque))) * 1e-4;
        prop_assert!((difference - power).abs() < 1e-4 * scale, "{difference} against {power}");
    }
}

/// State plus `h` times its rate.
fn moved(state: &State, velocity: &State, acceleration: &[f64], h: f64) -> State {
    let mut next = state.clone();
    next.base_position_m += velocity.base_velocity_m_s * h;
    // A turn at the middle rate: second order, as the rule.
    next.base_orientation = state.base_orientation * UnitQuaternion::from_scaled_axis(velocity.base_rate_rad_s * h);
    next.base_velocity_m_s += Vector3::from_column_slice(&acceleration[..3]) * h;
    next.base_rate_rad_s += Vector3::from_column_slice(&acceleration[3..6]) * h;
    for k in 0..next.angle_rad.len() {
        next.angle_rad[k] += velocity.rate_rad_s[k] * h;
        next.rate_rad_s[k] += acceleration[6 + k] * h;
    }
    next
}

/// A step of the midpoint rule, second order.
fn step(dynamics: &mut Dynamics<'_>, state: &State, torque: &[f64], h: f64) -> State {
    let mut acceleration = vec![0.0; dynamics.freedoms()];
    dynamics.forward(state, &Input::torques(torque), &mut acceleration);
    let middle = moved(state, state, &acceleration, 0.5 * h);
    dynamics.forward(&middle, &Input::torques(torque), &mut acceleration);
    moved(state, &middle, &acceleration, h)
}

#[test]
fn free_flight_keeps_momentum_and_energy() {
    let robot = Model::ers7().with_gravity(Vector3::zeros());
    let mut state = Dice(7).state(&robot);
    state.rate_rad_s.iter_mut().for_each(|rate| *rate *= 0.1);
    let mut dynamics = Dynamics::new(&robot);
    let (before, energy) = (dynamics.momentum(&state), dynamics.energy(&state).total_j());
    let torque = vec![0.0; robot.joints().len()];
    let drift = |steps: usize, dynamics: &mut Dynamics<'_>| {
        let mut now = state.clone();
        for _ in 0..steps {
            now = step(dynamics, &now, &torque, 0.02 / steps as f64);
        }
        let after = dynamics.momentum(&now);
        let linear = (after.linear_kg_m_s - before.linear_kg_m_s).norm() / before.linear_kg_m_s.norm();
        let angular = (after.angular_kg_m2_s - before.angular_kg_m2_s).norm() / before.angular_kg_m2_s.norm();
        [linear, angular, (dynamics.energy(&now).total_j() - energy).abs() / energy]
    };
    let (coarse, fine) = (drift(200, &mut dynamics), drift(400, &mut dynamics));
    for (coarse, fine) in coarse.iter().zip(fine) {
        // Second order: halving the step takes three quarters of the error, down to rounding.
        assert!(fine < 1e-4 && (fine < 1e-9 || fine < 0.35 * coarse), "{coarse} {fine}");
    }
}

#[test]
fn a_clamped_base_is_one_of_huge_mass() {
    let model = three_link();
    let mut dice = Dice(3);
    let state = dice.state(&model);
    let torque = dice.many(3, 0.5);
    let clamped = solve(&model, &state, &Input::torques(&torque));
    // Gravity would move a free base; it is left out, and comes back as a weight on each body.
    let heavy = model.with_mass(BodyId::BASE, 1e12).unwrap().with_base(Base::Floating).with_gravity(Vector3::zeros());
    let motions = Dynamics::new(&model).motions(&state).to_vec();
    let weights: Vec<Force> = model
        .body_ids()
        .skip(1)
        .map(|body| {
            let weight = model.gravity_m_s2() * model.bodies()[body.index()].mass_kg;
            Force::at(body, motions[body.index()].position_m, weight)
        })
        .collect();
    let free = solve(&heavy, &state, &Input { torque_nm: &torque, diagonal_kg_m2: &[], forces: &weights });
    assert!(apart(&free[6..], &clamped[6..]) < 1e-9, "{free:?} {clamped:?}");
    assert!(largest(&free[..6]) < 1e-6);
}

/// Two bars in a plane, by hand: the closed form of the double pendulum.
#[test]
fn double_pendulum_by_hand() {
    let text = r#"
schema = 1
name = "double"
root = "wall"
base = "clamped"
part = [
  { name = "wall", diameter_m = [1.0, 1.0, 1.0], mass_kg = 1.0 },
  { name = "a", diameter_m = [0.01, 0.2, 0.01], mass_kg = 0.7, inertia_kg_m2 = [2e-3, 2e-3, 2e-3] },
  { name = "b", diameter_m = [0.01, 0.2, 0.01], mass_kg = 0.4, inertia_kg_m2 = [1e-3, 1e-3, 1e-3] },
]
joint = [
  { name = "one", parent = "wall", child = "a", axis = [0.0, 0.0, -1.0], sign = -1, parent_mm = [0, 0, 0], child_mm = [0, 150, 0] },
  { name = "two", parent = "a", child = "b", axis = "z", parent_mm = [0, -250, 30], child_mm = [0, 100, 0] },
]
"#;
    let model = Model::from_toml(Path::new("double.toml"), text).unwrap();
    let (m1, m2, i1, i2, l1, d1, d2, g) = (0.7, 0.4, 2e-3, 1e-3, 0.4, 0.15, 0.1, 9.81);
    let (q1, q2, w1, w2) = (0.7_f64, -1.9_f64, 3.0, -4.0);
    let state = State { angle_rad: vec![q1, q2], rate_rad_s: vec![w1, w2], ..State::at_rest(&model) };
    let torque = [0.3, -0.2];
    let c = m2 * l1 * d2;
    let m22 = i2 + m2 * d2 * d2;
    let m12 = m22 + c * q2.cos();
    let m11 = i1 + m1 * d1 * d1 + m22 + m2 * l1 * l1 + 2.0 * c * q2.cos();
    let h = c * q2.sin();
    let gravity2 = m2 * g * d2 * (q1 + q2).sin();
    let gravity1 = (m1 * d1 + m2 * l1) * g * q1.sin() + gravity2;
    let r1 = torque[0] + h * (2.0 * w1 * w2 + w2 * w2) - gravity1;
    let r2 = torque[1] - h * w1 * w1 - gravity2;
    let determinant = m11 * m22 - m12 * m12;
    let expected = [(m22 * r1 - m12 * r2) / determinant, (m11 * r2 - m12 * r1) / determinant];
    let found = solve(&model, &state, &Input::torques(&torque));
    assert!(apart(&found[6..], &expected) < 1e-13, "{found:?} {expected:?}");
}

#[test]
fn a_force_at_a_point_does_the_work_of_that_point() {
    let model = Model::ers7();
    let mut dice = Dice(11);
    let state = dice.state(model);
    let mut dynamics = Dynamics::new(model);
    let foot = model.body("rf_lower").unwrap();
    let at = dynamics.motions(&state)[foot.index()].point_m(&Vector3::new(0.01, -0.04, 0.005));
    let force = Force::at(foot, at, Vector3::new(0.3, 1.2, -0.4));
    let still = vec![0.0; dynamics.freedoms()];
    let (mut with, mut without) = (still.clone(), still.clone());
    dynamics.inverse(&state, &still, &[force], &mut with);
    dynamics.inverse(&state, &still, &[], &mut without);
    let power: f64 = without.iter().zip(&with).zip(state.velocity()).map(|((a, b), v)| (a - b) * v).sum();
    let velocity = dynamics.motions(&state)[foot.index()].point_velocity_m_s(&Vector3::new(0.01, -0.04, 0.005));
    approx::assert_relative_eq!(power, force.force_n.dot(&velocity), max_relative = 1e-12);
    assert_eq!(foot.joint().map(JointId::index), Some(5));
}

/// Reads an array of numbers.
fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// Five states with answers that two other engines agree on to 1e-13.
#[test]
fn states_of_two_other_engines() {
    let file = std::env::var_os("AIBO_FIT_SHARED").map(|shared| Path::new(&shared).join("ers7/dynamics-sample.json"));
    let Some(text) = file.and_then(|file| std::fs::read_to_string(file).ok()) else {
        println!("skipped: AIBO_FIT_SHARED names no folder that holds ers7/dynamics-sample.json");
        return;
    };
    let sample: serde_json::Value = serde_json::from_str(&text).unwrap();
    let model = Model::ers7();
    let mut dynamics = Dynamics::new(model);
    for (index, one) in sample["states"].as_array().unwrap().iter().enumerate() {
        let vector = |key: &str| Vector3::from_vec(numbers(&one[key]));
        let q = numbers(&one["base_quat_wxyz"]);
        let state = State {
            base_position_m: vector("base_pos"),
            base_orientation: UnitQuaternion::new_normalize(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3])),
            base_velocity_m_s: vector("base_vel_world"),
            base_rate_rad_s: vector("base_omega_body"),
            angle_rad: numbers(&one["q"]),
            rate_rad_s: numbers(&one["dq"]),
        };
        let out = &one["out"];
        let acceleration = solve(model, &state, &Input::torques(&numbers(&one["tau"])));
        let mut bias = vec![0.0; 28];
        dynamics.bias(&state, &mut bias);
        let mut matrix = DMatrix::zeros(28, 28);
        dynamics.mass_matrix(&state, &mut matrix);
        let rows: Vec<f64> = out["M"].as_array().unwrap().iter().flat_map(numbers).collect();
        let momentum = dynamics.momentum(&state);
        let energy = dynamics.energy(&state);
        let errors = [
            ("qacc", apart(&acceleration, &numbers(&out["qacc"])), 1e-11),
            ("bias", apart(&bias, &numbers(&out["bias"])), 1e-13),
            ("M", apart(matrix.as_slice(), &rows), 1e-13),
            ("com", apart(momentum.centre_m.as_slice(), &numbers(&out["com"])), 1e-13),
            ("kinetic", apart(&[energy.kinetic_j], &[out["kinetic_energy"].as_f64().unwrap()]), 1e-13),
            ("potential", apart(&[energy.potential_j], &[out["potential_energy"].as_f64().unwrap()]), 1e-12),
        ];
        println!("state {index}: {errors:?}");
        for (what, error, allowed) in errors {
            assert!(error <= allowed, "state {index}: {what} is {error:e} apart");
        }
        let motions = dynamics.motions(&state);
        for (name, place) in out["body_pos"].as_object().unwrap() {
            let body = model.body(name).unwrap();
            let error = (motions[body.index()].position_m - Vector3::from_vec(numbers(place))).amax();
            assert!(error < 1e-14, "state {index}: {name} is {error:e} m apart");
        }
    }
}
