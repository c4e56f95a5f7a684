//! The general tree against the ERS-7's own recursion, and against its own definitions.

use super::{Tree, TreeBase, TreeDynamics, TreeState};
use crate::geometry::RobotTables;
use crate::robot::description::{Coupling, Description, JointKind, MoverId};
use crate::robot::{Dynamics, Input, Model, State};
use approx::assert_relative_eq;
use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};
use std::path::Path;

const ERS7: &str = include_str!("../../../data/ers7.toml");

fn ers7() -> Description {
    let tables = RobotTables::from_toml(Path::new("ers7.toml"), ERS7).unwrap();
    Description::of_tables(&tables, Path::new("ers7.toml"))
}

/// Some state without symmetry.
fn moving(tree: &Tree) -> TreeState {
    let n = tree.joints().len();
    TreeState {
        base_position_m: Vector3::new(0.3, -0.2, 0.7),
        base_orientation: UnitQuaternion::from_euler_angles(0.4, -0.8, 2.1),
        base_velocity_m_s: Vector3::new(0.5, -1.0, 0.2),
        base_rate_rad_s: Vector3::new(-2.0, 0.7, 1.3),
        position: (0..n).map(|k| 0.7 * (1.3 * k as f64 + 0.2).sin()).collect(),
        rate: (0..n).map(|k| 3.0 * (0.9 * k as f64 + 1.0).cos()).collect(),
    }
}

#[test]
fn the_ers7_moves_as_in_its_own_recursion() {
    let tree = Tree::new(&ers7(), TreeBase::Free).unwrap();
    let state = moving(&tree);
    let own = State {
        base_position_m: state.base_position_m,
        base_orientation: state.base_orientation,
        base_velocity_m_s: state.base_velocity_m_s,
        base_rate_rad_s: state.base_rate_rad_s,
        angle_rad: state.position.clone(),
        rate_rad_s: state.rate.clone(),
    };
    let n = tree.freedoms();
    assert_eq!(n, 28);
    let (mut general, mut fast) = (TreeDynamics::new(&tree), Dynamics::new(Model::ers7()));
    let (mut ours, mut theirs) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    general.mass_matrix(&state, &mut ours);
    fast.mass_matrix(&own, &mut theirs);
    assert_relative_eq!(ours, theirs, epsilon = 1e-14);
    let torque: Vec<f64> = (0..22).map(|k| 0.05 * f64::from(k).sin()).collect();
    let (mut force, mut ours, mut theirs) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    general.bias(&state, &mut ours);
    fast.bias(&own, &mut theirs);
    assert_relative_eq!(DVector::from_vec(ours.clone()), DVector::from_vec(theirs.clone()), epsilon = 1e-12);
    general.forces_of(&torque, &mut force);
    general.forward(&state, &force, &mut ours).unwrap();
    fast.forward(&own, &Input::torques(&torque), &mut theirs);
    assert_relative_eq!(DVector::from_vec(ours), DVector::from_vec(theirs), max_relative = 1e-9, epsilon = 1e-7);
    assert_relative_eq!(general.energy(&state).kinetic_j, fast.energy(&own).kinetic_j, max_relative = 1e-12);
}

#[test]
fn inverse_undoes_forward_and_energy_is_that_of_the_mass_matrix() {
    let mut description = ers7();
    description.joints[2].kind = JointKind::Prismatic;
    description.joints[4].armature_kg_m2 = 0.01;
    description.couplings =
        vec![Coupling { follower: MoverId(3), leader: MoverId(7), multiplier: -0.5, offset_rad: 0.1 }];
    for base in [TreeBase::Fixed, TreeBase::Free] {
        let tree = Tree::new(&description, base).unwrap();
        let (state, n) = (moving(&tree), tree.freedoms());
        assert_eq!(n, tree.base_freedoms() + 21);
        let mut dynamics = TreeDynamics::new(&tree);
        let force: Vec<f64> = (0..n).map(|k| 0.1 * (k as f64).cos()).collect();
        let (mut v_dot, mut back) = (vec![0.0; n], vec![0.0; n]);
        dynamics.forward(&state, &force, &mut v_dot).unwrap();
        dynamics.inverse(&state, &v_dot, &mut back);
        assert_relative_eq!(DVector::from_vec(back), DVector::from_vec(force), epsilon = 1e-10);
        let mut matrix = DMatrix::zeros(n, n);
        dynamics.mass_matrix(&state, &mut matrix);
        let v = DVector::from_iterator(n, state.velocity(base));
        assert_relative_eq!(dynamics.energy(&state).kinetic_j, 0.5 * v.dot(&(&matrix * &v)), max_relative = 1e-12);
    }
}

#[test]
fn without_torques_a_step_keeps_the_energy() {
    // The whole of the equations of motion: E' = 0 along them, to second order of a central difference.
    let mut description = ers7();
    description.joints[2].kind = JointKind::Prismatic;
    description.joints[5].armature_kg_m2 = 0.02;
    description.couplings =
        vec![Coupling { follower: MoverId(3), leader: MoverId(7), multiplier: 2.0, offset_rad: 0.1 }];
    let tree = Tree::new(&description, TreeBase::Free).unwrap();
    let (state, n) = (moving(&tree), tree.freedoms());
    let mut dynamics = TreeDynamics::new(&tree);
    let mut v_dot = vec![0.0; n];
    dynamics.forward(&state, &vec![0.0; n], &mut v_dot).unwrap();
    let mut at = |h: f64| {
        let mut moved = state.clone();
        moved.base_position_m += state.base_velocity_m_s * h;
        moved.base_orientation *= UnitQuaternion::from_scaled_axis(state.base_rate_rad_s * h);
        moved.base_velocity_m_s += Vector3::from_column_slice(&v_dot[..3]) * h;
        moved.base_rate_rad_s += Vector3::from_column_slice(&v_dot[3..6]) * h;
        for k in 0..n - 6 {
            moved.position[k] += h * state.rate[k];
            moved.rate[k] += h * v_dot[6 + k];
        }
        let energy = dynamics.energy(&moved);
        energy.kinetic_j + energy.potential_j
    };
    let (h, power) = (1e-5, dynamics_power(&state));
    assert!(((at(h) - at(-h)) / (2.0 * h)).abs() < 1e-6 * power, "{}", (at(h) - at(-h)) / (2.0 * h));
}

/// What the gravity of the whole robot does in a second at the state's speed \[W\]: a scale.
fn dynamics_power(state: &TreeState) -> f64 {
    9.81 * state.base_velocity_m_s.norm()
}
