//! Signs, energies, derivatives, and four feet that bear the weight.

use super::*;
use crate::robot::{Dynamics, Force, Input, Model, RobotError, State};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::path::Path;

fn vector(range: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-range..range, -range..range, -range..range].prop_map(Vector3::from)
}

/// Any floor that is one.
fn any_floor() -> impl Strategy<Value = FloorParameters> {
    let law = (1e3..1e5_f64, 0.0..1e6_f64, 1.0..2.0_f64, 0.0..0.02_f64);
    let friction = (0.0..1.5_f64, 0.0..1.5_f64, 0.0..2.0_f64, 10.0..1e3_f64, 0.0..0.2_f64);
    (law, friction, -0.5..0.5_f64, -0.5..0.5_f64).prop_map(|(law, friction, forward, right)| {
        let floor = FloorParameters {
            stiffness_n_m: law.0,
            damping_n_s_m2: law.1,
            exponent: law.2,
            torsion_radius_m: law.3,
            static_friction: friction.0,
            coulomb: friction.1,
            viscous_s_m: friction.2,
            steepness_s_m: friction.3,
            stribeck_speed_m_s: friction.4,
            ..FloorParameters::default()
        };
        floor.sloped(forward, right)
    })
}

/// Derivative of the force by a column of what moves it, by differences in the middle.
fn slopes(force: impl Fn(Vector3<f64>) -> Vector3<f64>, h: f64) -> Matrix3<f64> {
    let column = |k| (force(Vector3::ith(k, h)) - force(Vector3::ith(k, -h))) / (2.0 * h);
    Matrix3::from_columns(&[column(0), column(1), column(2)])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn friction_only_takes_energy_and_the_floor_never_pulls(
        floor in any_floor(), depth in -1e-3..1e-2_f64, velocity in vector(1.0), rate in vector(20.0), held in any::<bool>(),
    ) {
        let normal = floor.normal.normalize();
        let Some(contact) = floor.contact_of(depth, &normal, &velocity, &rate, held) else {
            prop_assert!(depth <= 0.0);
            return Ok(());
        };
        prop_assert!(contact.normal_n >= 0.0);
        let rounding = 1e-9 + 1e-12 * contact.force_n.norm();
        approx::assert_relative_eq!(contact.force_n.dot(&normal), contact.normal_n, epsilon = rounding);
        let friction = contact.force_n - normal * contact.normal_n;
        prop_assert!(friction.dot(&velocity) <= 1e-9 * contact.normal_n);
        prop_assert!(contact.moment_nm.dot(&rate) <= 1e-12 * contact.normal_n);
        for implicit in [contact.implicit_damping_n_s_m, contact.implicit_stiffness_n_m, contact.spin_damping_nm_s_rad] {
            prop_assert!((implicit - implicit.transpose()).amax() <= 1e-12 * implicit.amax());
            prop_assert!(implicit.symmetric_eigenvalues().min() >= -1e-12 * implicit.amax());
        }
    }

    #[test]
    fn derivatives_are_those_of_differences(
        floor in any_floor(), depth in 1e-4..5e-3_f64, velocity in vector(0.3), rate in vector(5.0),
    ) {
        let normal = floor.normal.normalize();
        let at = |shift: Vector3<f64>, kick: Vector3<f64>| {
            let depth = depth - shift.dot(&normal);
            floor.contact(depth, &normal, &(velocity + kick), &rate).unwrap()
        };
        let (zero, here) = (Vector3::zeros(), at(Vector3::zeros(), Vector3::zeros()));
        // No derivative across the edge where the floor lets go.
        let margin = floor.stiffness_n_m - floor.damping_n_s_m2 * velocity.dot(&normal);
        prop_assume!(margin.abs() > 1e-4 * floor.stiffness_n_m);
        let damping = -slopes(|kick| at(zero, kick).force_n, 1e-8);
        let stiffness = -slopes(|shift| at(shift, zero).force_n, 1e-9);
        let tolerance = |m: &Matrix3<f64>| 2e-4 * m.amax() + 1e-4 * here.normal_n.max(1.0);
        prop_assert!((damping - here.damping_n_s_m).amax() < tolerance(&damping), "{damping} {}", here.damping_n_s_m);
        prop_assert!((stiffness - here.stiffness_n_m).amax() < tolerance(&stiffness), "{stiffness} {}", here.stiffness_n_m);
    }
}

#[test]
fn friction_has_its_four_parts() {
    let floor = FloorParameters { viscous_s_m: 0.1, ..FloorParameters::default() };
    let mu = |v| floor.friction_coefficient(v);
    assert_eq!(mu(0.0), 0.0);
    approx::assert_relative_eq!(mu(1e-7), 1e-7 * (0.7 * 300.0 + 0.1), max_relative = 1e-5);
    // Nearly static at low speed, Coulomb and viscous far beyond the Stribeck speed.
    assert!(mu(0.012) > 0.685 && mu(0.012) < 0.705, "{}", mu(0.012));
    approx::assert_relative_eq!(mu(1.0), 0.6 + 0.1, max_relative = 1e-12);
    for absent in
        [FloorParameters { stribeck_speed_m_s: 0.0, ..floor }, FloorParameters { static_friction: 0.0, ..floor }]
    {
        approx::assert_relative_eq!(absent.friction_coefficient(0.01), 0.6 * 3.0_f64.tanh() + 0.001);
    }
}

#[test]
fn a_wrong_parameter_is_named() {
    let good = FloorParameters::default();
    let wrong = [
        (FloorParameters { stiffness_n_m: -1.0, ..good }, "floor: stiffness = -1, allowed: a number above 0 N/m"),
        (FloorParameters { exponent: 0.5, ..good }, "floor: exponent = 0.5, allowed: a number from 1 to 5"),
        (FloorParameters { coulomb: f64::NAN, ..good }, "floor: coulomb = NaN, allowed: a number not below 0"),
        (
            FloorParameters { torsion_radius_m: -0.01, ..good },
            "floor: torsion_radius = -0.01, allowed: a number not below 0",
        ),
        (FloorParameters { normal: -Vector3::y(), ..good }, "floor: slope = 3.14"),
    ];
    for (parameters, message) in wrong {
        let error = Floor::new(parameters, Model::ers7(), Touching::Marked).unwrap_err();
        assert!(matches!(error, RobotError::Floor { .. }));
        assert!(error.to_string().starts_with(message), "{error}");
    }
}

fn ball() -> Model {
    let text = "schema = 1\nname = \"ball\"\nroot = \"ball\"\npart = [{ name = \"ball\", diameter_m = [0.1, 0.1, 0.1], \
                mass_kg = 0.4, contact_mm = [0.0, 0.0, 0.0] }]";
    Model::from_toml(Path::new("ball.toml"), text).unwrap()
}

/// Moves by a step that takes the contacts implicitly.
fn step(dynamics: &mut Dynamics<'_>, floor: &Floor, state: &mut State, step_s: f64) -> Vec<Force> {
    let (mut forces, mut damping) = (Vec::new(), Vec::new());
    floor.forces(dynamics.motions(state), &Resting::none(), &mut forces, &mut damping);
    let input = Input { torque_nm: &[], diagonal_kg_m2: &[], forces: &forces };
    let mut acceleration = [0.0; 6];
    dynamics.forward_implicit(state, &input, step_s, &damping, &mut acceleration);
    state.base_velocity_m_s += Vector3::from_column_slice(&acceleration[..3]) * step_s;
    state.base_rate_rad_s += Vector3::from_column_slice(&acceleration[3..]) * step_s;
    state.base_position_m += state.base_velocity_m_s * step_s;
    state.base_orientation *= UnitQuaternion::from_scaled_axis(state.base_rate_rad_s * step_s);
    forces
}

#[test]
fn a_ball_that_falls_spinning_bounces_lower_slides_and_rolls() {
    let model = ball();
    let floor =
        Floor::new(FloorParameters { damping_n_s_m2: 1e4, ..FloorParameters::default() }, &model, Touching::Marked)
            .unwrap();
    let mut dynamics = Dynamics::new(&model);
    let mut state = State::at_rest(&model);
    state.base_position_m.y = 0.05 + 0.02;
    state.base_velocity_m_s.z = -0.5;
    state.base_rate_rad_s.y = 5.0;
    let start = dynamics.energy(&state).total_j();
    let (mut highest, mut was_rising, mut energy) = (vec![], false, start);
    for k in 0..20_000 {
        let forces = step(&mut dynamics, &floor, &mut state, 1e-4);
        assert!(forces.iter().all(|force| force.force_n.y >= 0.0));
        let rising = state.base_velocity_m_s.y > 0.0;
        if was_rising && !rising {
            highest.push(state.base_position_m.y - 0.05);
        }
        was_rising = rising;
        if k % 2000 == 1999 && forces.is_empty() {
            let now = dynamics.energy(&state).total_j();
            assert!(now <= energy + 1e-9, "{now} {energy}");
            energy = now;
        }
    }
    assert!(highest[0] > 0.002 && highest[0] < 0.02, "{highest:?}");
    assert!(highest.windows(2).take(3).all(|pair| pair[1] < pair[0]), "{highest:?}");
    // A homogeneous ball rolls on with 5/7 of its speed; no torsion here, so it keeps its spin.
    approx::assert_relative_eq!(state.base_velocity_m_s.z, -0.5 * 5.0 / 7.0, max_relative = 0.02);
    let rate = state.base_orientation * state.base_rate_rad_s;
    approx::assert_relative_eq!(rate.x * 0.05, state.base_velocity_m_s.z, max_relative = 0.02);
    approx::assert_relative_eq!(rate.y, 5.0, max_relative = 1e-3);
}

#[test]
fn torsion_stops_a_spinning_ball_and_a_slope_makes_it_go_down() {
    let model = ball();
    let parameters = FloorParameters { torsion_radius_m: 0.01, ..FloorParameters::default() };
    let floor = Floor::new(parameters, &model, Touching::Marked).unwrap();
    let mut dynamics = Dynamics::new(&model);
    let mut state = State::at_rest(&model);
    state.base_position_m.y = 0.05;
    state.base_rate_rad_s.y = 5.0;
    (0..20_000).for_each(|_| drop(step(&mut dynamics, &floor, &mut state, 1e-4)));
    assert!(state.base_rate_rad_s.y.abs() < 1e-3, "{}", state.base_rate_rad_s.y);

    let floor = Floor::new(FloorParameters::default().sloped(0.1, 0.0), &model, Touching::Marked).unwrap();
    let mut state = State::at_rest(&model);
    state.base_position_m.y = floor.height_on_m(&mut dynamics, &state);
    (0..10_000).for_each(|_| drop(step(&mut dynamics, &floor, &mut state, 1e-4)));
    // Rolls backwards (+z): 5/7 g sin(slope) for 1 s, along the slope.
    let expected = 5.0 / 7.0 * 9.81 * 0.1_f64.sin();
    approx::assert_relative_eq!(state.base_velocity_m_s.norm(), expected, max_relative = 0.02);
    assert!(state.base_velocity_m_s.z > 0.0 && state.base_velocity_m_s.y < 0.0);
}

#[test]
fn four_feet_at_rest_bear_the_weight() {
    let model = Model::ers7();
    let floor = Floor::new(FloorParameters::default(), model, Touching::Marked).unwrap();
    assert_eq!(floor.parts(), 4);
    let mut dynamics = Dynamics::new(model);
    let stand = |height_m: f64, pitch_rad: f64| {
        let mut state = State::at_rest(model);
        // q1 -0.30, q2 0.10, q3 0.10 on all legs: the reference walk's stand.
        for leg in 0..4 {
            state.angle_rad[3 * leg..3 * leg + 3].copy_from_slice(&[-0.3, 0.1, 0.1]);
        }
        state.base_position_m.y = height_m;
        state.base_orientation = UnitQuaternion::from_scaled_axis(Vector3::x() * pitch_rad);
        state
    };
    let touch_m = floor.height_on_m(&mut dynamics, &stand(0.2, 0.0));
    let weight_n = model.total_mass_kg() * 9.81;
    // Excess of upward force, and of its moment about the centre of mass.
    let mut excess = |height_m: f64, pitch_rad: f64| {
        let state = stand(height_m, pitch_rad);
        let centre = dynamics.momentum(&state).centre_m;
        let (mut forces, mut damping) = (Vec::new(), Vec::new());
        floor.forces(dynamics.motions(&state), &Resting::none(), &mut forces, &mut damping);
        let up: f64 = forces.iter().map(|force| force.force_n.y).sum();
        let turning: f64 = forces.iter().map(|force| (force.at_m - centre).cross(&force.force_n).x).sum();
        (nalgebra::Vector2::new(up - weight_n, turning), forces)
    };
    let mut at = nalgebra::Vector2::new(touch_m - 3e-3, 0.0);
    for _ in 0..50 {
        let here = excess(at.x, at.y).0;
        let h = 1e-7;
        let columns = [excess(at.x + h, at.y).0 - here, excess(at.x, at.y + h).0 - here].map(|column| column / h);
        let step = nalgebra::Matrix2::from_columns(&columns).try_inverse().unwrap() * here;
        at -= step * (1e-3 / step.norm()).min(1.0);
    }
    let (rest, forces) = excess(at.x, at.y);
    assert!(rest.norm() < 1e-9, "{rest}");
    assert_eq!(forces.len(), 4);
    // The head makes the front heavier; sinking is below 1 mm.
    assert!(forces.iter().all(|force| force.force_n.y > 0.05 * weight_n), "{forces:?}");
    assert!(forces[0].force_n.y > forces[2].force_n.y, "{forces:?}");
    assert!(forces.iter().all(|force| floor.depth_m(&force.at_m) < 1e-3));
    let names: Vec<&str> = forces.iter().map(|force| model.bodies()[force.body.index()].name.as_str()).collect();
    assert_eq!(names, ["lf_lower", "rf_lower", "lr_lower", "rr_lower"]);
}

#[test]
fn the_whole_robot_may_lie_on_the_floor() {
    let model = Model::ers7();
    let all = Floor::new(FloorParameters::default(), model, Touching::All).unwrap();
    assert_eq!(all.parts(), 19); // without the four ghosts
    let mut dynamics = Dynamics::new(model);
    let mut state = State::at_rest(model);
    state.base_orientation = UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::PI);
    state.base_position_m.y = all.height_on_m(&mut dynamics, &state) - 1e-4;
    let (mut forces, mut damping) = (Vec::new(), Vec::new());
    all.forces(dynamics.motions(&state), &Resting::none(), &mut forces, &mut damping);
    assert!(!forces.is_empty() && forces.len() == damping.len());
    let names: Vec<&str> = forces.iter().map(|force| model.bodies()[force.body.index()].name.as_str()).collect();
    assert!(names.iter().all(|name| !name.contains("lower")), "{names:?}");
}
