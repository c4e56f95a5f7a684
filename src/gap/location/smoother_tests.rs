use super::*;
use approx::assert_relative_eq;
use nalgebra::{DMatrix, DVector};

/// A few steps of an oscillator: smooth, over a jump, over a rest in which the unknown is forgotten.
fn steps() -> Vec<Step> {
    let moving = Step {
        upper: [[0.98, 0.0079, 3.1e-5, 8e-8], [-0.4, 0.95, 0.0078, 3.1e-5]],
        offset: [1e-3, -0.02],
        dt_s: 0.008,
        change: Change::Smooth,
        lively: 0.7,
        loose: [0.0; 2],
    };
    let jump = Step { change: Change::Jump, loose: [1e-6, 1e-3], ..moving };
    let rest = Step {
        upper: [[1.0, 0.004, 0.0, 0.0], [0.0; 4]],
        offset: [0.0; 2],
        change: Change::Forgotten,
        loose: [1e-7, 1e-9],
        ..moving
    };
    vec![moving, jump, moving, rest, moving, moving]
}

fn begin() -> Begin {
    Begin { mean: [0.5, -1.0], variance: [1e-5, 0.3] }
}

fn prior() -> Prior {
    Prior { size_rad_s2: 8.0, span_s: 0.4 }
}

fn readings() -> Vec<Reading> {
    [0.498, 0.492, 0.489, 0.47, 0.468, 0.467, 0.46].map(|value_rad| Reading { value_rad, variance_rad2: 3e-6 }).to_vec()
}

/// Mean and covariance of all states at once, without a recursion through the readings.
fn all_states(steps: &[Step]) -> (DVector<f64>, DMatrix<f64>) {
    let n = 4 * (steps.len() + 1);
    let (b, p) = (begin(), prior());
    let level = p.size_rad_s2.powi(2);
    let slope = level / p.span_s.powi(2);
    let mut mean = DVector::zeros(n);
    let mut covariance = DMatrix::zeros(n, n);
    mean.rows_mut(0, 2).copy_from_slice(&b.mean);
    for (i, v) in [b.variance[0], b.variance[1], FIRST.powi(2) * level, FIRST.powi(2) * slope].into_iter().enumerate() {
        covariance[(i, i)] = v;
    }
    for (k, s) in steps.iter().enumerate() {
        let (h, lively) = (s.dt_s, s.lively.powi(2));
        let mut a = DMatrix::zeros(4, 4);
        let mut q = DMatrix::zeros(4, 4);
        for j in 0..4 {
            (a[(0, j)], a[(1, j)]) = (s.upper[0][j], s.upper[1][j]);
        }
        (q[(0, 0)], q[(1, 1)]) = (s.loose[0], s.loose[1]);
        if s.change == Change::Forgotten {
            (q[(2, 2)], q[(3, 3)]) = (FIRST.powi(2) * level * lively, FIRST.powi(2) * slope * lively);
        } else {
            (a[(2, 2)], a[(2, 3)], a[(3, 3)]) = (1.0, h, 1.0);
            let drive = 3.0 * lively * slope / p.span_s;
            let jump = if s.change == Change::Jump { JUMP.powi(2) } else { 0.0 };
            q[(2, 2)] = drive * h.powi(3) / 3.0 + lively * level * (ROUGH * h / p.span_s + jump);
            q[(3, 3)] = drive * h + lively * slope * jump;
            (q[(2, 3)], q[(3, 2)]) = (drive * h * h / 2.0, drive * h * h / 2.0);
        }
        let (from, to) = (4 * k, 4 * k + 4);
        let next = &a * mean.rows(from, 4) + DVector::from_vec(vec![s.offset[0], s.offset[1], 0.0, 0.0]);
        mean.rows_mut(to, 4).copy_from(&next);
        let across = &a * covariance.view((from, 0), (4, to));
        covariance.view_mut((to, 0), (4, to)).copy_from(&across);
        covariance.view_mut((0, to), (to, 4)).copy_from(&across.transpose());
        let own = &a * covariance.view((from, from), (4, 4)) * a.transpose() + q;
        covariance.view_mut((to, to), (4, 4)).copy_from(&own);
    }
    (mean, covariance)
}

#[test]
fn smoother_and_likelihood_are_those_of_the_joint_normal_distribution() {
    let (steps, readings) = (steps(), readings());
    let (mean, covariance) = all_states(&steps);
    let n = readings.len();
    let seen = DMatrix::from_fn(n, 4 * n, |i, j| if j == 4 * i { 1.0 } else { 0.0 });
    let noise = DMatrix::from_diagonal_element(n, n, 3e-6);
    let spread = &seen * &covariance * seen.transpose() + noise;
    let surprise = DVector::from_iterator(n, readings.iter().map(|r| r.value_rad)) - &seen * &mean;
    let inverse = spread.clone().try_inverse().unwrap();
    let gain = &covariance * seen.transpose() * &inverse;
    let posterior = &mean + &gain * &surprise;
    let left = &covariance - &gain * &seen * &covariance;

    let smoothed = smooth(&begin(), &readings, prior(), |k, _| steps[k]);
    for (k, s) in smoothed.iter().enumerate() {
        for i in 0..4 {
            let sd = left[(4 * k + i, 4 * k + i)].abs().sqrt();
            assert!((s.mean[i] - posterior[4 * k + i]).abs() < 1e-6 * (sd + 1e-3), "state {i} at {k}");
        }
        for i in 0..3 {
            let exact = left[(4 * k + i, 4 * k + i)];
            assert_relative_eq!(s.variance[i], exact, max_relative = 1e-5, epsilon = 1e-12);
        }
    }

    let squares = (surprise.transpose() * inverse * &surprise)[0];
    let scale = (squares / n as f64).max(1.0);
    let logs = spread.determinant().ln() - n as f64 * 3e-6f64.ln();
    let found = likelihood(&begin(), &steps, &readings, prior());
    assert_relative_eq!(found.scale, scale, max_relative = 1e-9);
    assert_relative_eq!(found.log, -0.5 * (logs + n as f64 * scale.ln() + squares / scale), max_relative = 1e-9);
}
