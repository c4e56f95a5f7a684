use super::*;
use crate::joint::{Friction, Link, Motor};
use crate::log::{Hold, MotorSpec};
use crate::pendulum::{Start, rollout};

fn chain(motor: Option<MotorSpec>) -> Chain<f64> {
    Chain::new(Link::new(0.011, 0.05, 0.1, 9.81), Friction::coulomb_viscous(0.02, 0.004), motor.map(Motor::new))
}

/// Motors off, stiff, with an integral, with a sampled law.
fn motors() -> [Option<MotorSpec>; 5] {
    let pd = MotorSpec::pd(5.0, 0.05);
    [
        None,
        Some(pd),
        Some(MotorSpec { ki_nm_rad_s: 3.0, ..pd }),
        Some(MotorSpec { hold: Hold::Linear, ..pd }),
        Some(MotorSpec { sample_period_s: Some(0.003), ..pd }),
    ]
}

#[test]
fn passages_in_a_row_are_the_rollout() {
    let t: Vec<f64> = (0..60).map(|k| 0.008 * k as f64 + 1e-3 * (k % 3) as f64).collect();
    let setpoint: Vec<f64> = t.iter().map(|t| 0.9 - 1.2 * t).collect();
    for motor in motors() {
        let chain = chain(motor);
        let hold = motor.map_or(Hold::Step, |m| m.hold);
        let input = match motor {
            None => Input::Off,
            Some(_) => Input::Position { setpoint_rad: &setpoint, hold, on: None },
        };
        let mut path = Vec::new();
        let start = Start { angle_rad: 0.9, rate_rad_s: -0.5, release_s: None };
        rollout(&chain, input, &t, start, |_, s| path.push([s.angle_rad, s.rate_rad_s])).unwrap();
        let along = Along::new(&chain, input, &t);
        let (mut memory, mut y) = (Memory::default(), path[0]);
        let mut turns = 0;
        for k in 0..t.len() - 1 {
            let direction = if path[k][1] < 0.0 { -1.0 } else { 1.0 };
            let p = along.pass(k, t[k], &[y[0], y[1], 0.0, 0.0], direction, true, &mut memory);
            turns += usize::from(p.turned);
            y = p.end;
            let error = (y[0] - path[k + 1][0]).abs();
            assert!(error < 3e-5, "{motor:?}, sample {k}: {error}");
        }
        assert!(motor.is_some() || turns == 1, "{turns}");
    }
}

#[test]
fn derivatives_of_a_passage_are_its_differences() {
    let t = [0.0, 0.008];
    let setpoint = [0.3, 0.31];
    for motor in motors().into_iter().filter(|m| m.is_none_or(|m| m.sample_period_s.is_none())) {
        let chain = chain(motor);
        let hold = motor.map_or(Hold::Step, |m| m.hold);
        let input = match motor {
            None => Input::Off,
            Some(_) => Input::Position { setpoint_rad: &setpoint, hold, on: None },
        };
        let along = Along::new(&chain, input, &t);
        // Passing through without a turn, and one that turns after a third of the way.
        for (rate, direction) in [(-2.0, -1.0), (0.08, 1.0)] {
            let state = [0.6, rate, 1.0, 20.0];
            let pass = |x: &State| along.pass(0, 0.0, x, direction, true, &mut Memory::default());
            let here = pass(&state);
            for j in 0..4 {
                let h = [1e-4, 1e-3, 1e-2, 1.0][j];
                let (mut up, mut down) = (state, state);
                up[j] += h;
                down[j] -= h;
                let (up, down) = (pass(&up).end, pass(&down).end);
                for i in 0..2 {
                    let difference = (up[i] - down[i]) / (2.0 * h);
                    let error = (here.upper[i][j] - difference).abs();
                    let size = [1.0, 0.008, 3e-5, 1e-7][j] * [1.0, 125.0][i];
                    assert!(error < 0.03 * size, "{motor:?} {rate} [{i}][{j}]: {} {difference}", here.upper[i][j]);
                }
            }
        }
    }
}
