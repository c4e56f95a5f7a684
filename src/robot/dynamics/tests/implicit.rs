//! Contacts taken implicitly, against a dense solve.

use super::*;
use nalgebra::Matrix3;

/// Velocity of a point of a body for each unit of generalised velocity, and its angular velocity: two 3 x (6 + n).
fn jacobians(model: &Model, state: &State, body: BodyId, at_m: &Vector3<f64>) -> [DMatrix<f64>; 2] {
    let n = model.joints().len();
    let (mut linear, mut angular) = (DMatrix::zeros(3, n + 6), DMatrix::zeros(3, n + 6));
    let mut dynamics = Dynamics::new(model);
    for k in 0..n + 6 {
        let unit = |i: usize| if i == k { 1.0 } else { 0.0 };
        let moving = State {
            base_velocity_m_s: Vector3::from_fn(|i, _| unit(i)),
            base_rate_rad_s: Vector3::from_fn(|i, _| unit(3 + i)),
            rate_rad_s: (0..n).map(|i| unit(6 + i)).collect(),
            ..state.clone()
        };
        let motion = dynamics.motions(&moving)[body.index()];
        let velocity = motion.velocity_m_s + motion.rate_rad_s.cross(&(at_m - motion.position_m));
        linear.set_column(k, &velocity);
        angular.set_column(k, &motion.rate_rad_s);
    }
    [linear, angular]
}

fn symmetric(dice: &mut Dice, scale: f64) -> Matrix3<f64> {
    let half = Matrix3::from_columns(&[dice.vector(1.0), dice.vector(1.0), dice.vector(1.0)]);
    half * half.transpose() * scale
}

fn contacts(dice: &mut Dice, model: &Model) -> Vec<ContactDamping> {
    let touching = model.body_ids().filter(|body| body.index() % 3 != 1);
    let one = |body| ContactDamping {
        body,
        at_m: dice.vector(2.0),
        velocity_m_s: dice.vector(1.0),
        damping_n_s_m: symmetric(dice, 800.0),
        stiffness_n_m: symmetric(dice, 2e4),
        spin_damping_nm_s_rad: symmetric(dice, 0.1),
    };
    touching.map(one).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]
    #[test]
    fn implicit_contacts_solve_the_dense_equations(seed in any::<u64>(), which in 0_usize..12) {
        let mut dice = Dice(seed);
        let model = &robots().get(which).cloned().unwrap_or_else(|| random_tree(&mut dice));
        let n = model.joints().len();
        let state = dice.state(model);
        let (torque, forces) = (dice.many(n, 0.5), dice.forces(model));
        let diagonal: Vec<f64> = dice.many(n, 1e-3).iter().map(|x| x.abs()).collect();
        let (contacts, h) = (contacts(&mut dice, model), 1e-4);
        let input = Input { torque_nm: &torque, diagonal_kg_m2: &diagonal, forces: &forces };
        let mut dynamics = Dynamics::new(model);
        let mut found = vec![f64::NAN; n + 6];
        dynamics.forward_implicit(&state, &input, h, &contacts, &mut found);
        let mut matrix = DMatrix::zeros(n + 6, n + 6);
        dynamics.mass_matrix(&state, &mut matrix);
        let mut bias = vec![0.0; n + 6];
        dynamics.inverse(&state, &vec![0.0; n + 6], &forces, &mut bias);
        for k in 0..n {
            matrix[(6 + k, 6 + k)] += diagonal[k];
        }
        let mut right = DVector::from_fn(n + 6, |k, _| if k < 6 { 0.0 } else { torque[k - 6] } - bias[k]);
        for contact in &contacts {
            let [linear, angular] = jacobians(model, &state, contact.body, &contact.at_m);
            let weight = contact.damping_n_s_m + contact.stiffness_n_m * h;
            matrix += linear.transpose() * (weight * h) * &linear;
            matrix += angular.transpose() * (contact.spin_damping_nm_s_rad * h) * &angular;
            right -= linear.transpose() * (contact.stiffness_n_m * contact.velocity_m_s * h);
        }
        let first = if model.base() == Base::Clamped { 6 } else { 0 };
        let size = n + 6 - first;
        let left = matrix.view((first, first), (size, size)).into_owned();
        let expected = left.cholesky().expect("positive definite").solve(&right.rows(first, size));
        let error = apart(&found[first..], expected.as_slice());
        prop_assert!(error < 1e-8, "{error}");
        prop_assert!(found[..first].iter().all(|x| *x == 0.0));
    }
}

#[test]
fn no_contact_changes_nothing_bit_for_bit() {
    let model = Model::ers7();
    let mut dice = Dice(5);
    let (state, torque) = (dice.state(model), dice.many(22, 0.5));
    let plain = solve(model, &state, &Input::torques(&torque));
    let mut found = vec![0.0; 28];
    Dynamics::new(model).forward_implicit(&state, &Input::torques(&torque), 1e-4, &[], &mut found);
    assert_eq!(found, plain);
}
