use super::*;
use crate::joint::{LawActs, LawVariable};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

const KNOTS: usize = 31;

/// A formula with noise of three per cent of its span at every knot.
fn said(variable: LawVariable, acts: LawActs, [from, to]: [f64; 2], f: impl Fn(f64) -> f64) -> Vec<String> {
    let x: Vec<f64> = (0..KNOTS).map(|k| from + (to - from) * k as f64 / (KNOTS - 1) as f64).collect();
    let clean: Vec<f64> = x.iter().map(|x| f(*x)).collect();
    let span =
        clean.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b)) - clean.iter().fold(f64::INFINITY, |a, b| a.min(*b));
    let sd = 0.03 * if span > 0.0 { span } else { clean[0].abs() };
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let seen = |_| {
        let y = clean.iter().map(|y| y + sd * (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>()).collect();
        LawTable::new(variable, acts, x.clone(), y)
    };
    let tables: Vec<LawTable> = (0..5).map(seen).collect();
    let with_sd = looks_like(&tables[0], Some(&vec![sd; KNOTS]));
    tables.iter().map(|table| looks_like(table, None)).chain([with_sd]).collect()
}

fn torque(variable: LawVariable, range: [f64; 2], f: impl Fn(f64) -> f64) -> Vec<String> {
    said(variable, LawActs::Torque, range, f)
}

/// Every answer begins and goes on so, and states these numbers first, to within a tenth.
fn all(said: &[String], begin: &str, part: &str, numbers: &[f64]) {
    for words in said {
        assert!(words.starts_with(begin) && words.contains(part), "{words}");
        let plain = words.replace('\u{2212}', "-");
        let is_part = |c: char| c.is_ascii_digit() || c == '-' || c == '.';
        let stated: Vec<f64> = plain.split(|c| !is_part(c)).filter_map(|word| word.parse().ok()).collect();
        for (is, expected) in stated.iter().zip(numbers) {
            assert!((is - expected).abs() < 0.1 * expected.abs() + 0.02 * numbers[0].abs(), "{words}: {numbers:?}");
        }
        assert!(stated.len() >= numbers.len(), "{words}: {numbers:?}");
    }
}

const BOTH: [f64; 2] = [-1.2, 1.0];

#[test]
fn levels_and_lines_are_the_terms_that_they_are() {
    all(&said(LawVariable::Speed, LawActs::Friction, [0.0, 6.0], |_| 0.02), "constant, ", "N m", &[0.02]);
    let spring = torque(LawVariable::Angle, BOTH, |q| 0.12 * (0.3 - q));
    all(&spring, "like a spring of ", "N m/rad, slack at", &[0.12, 0.3]);
    let unstable = torque(LawVariable::Angle, BOTH, |q| 0.12 * q);
    all(&unstable, "pushes away like a spring of ", " N m/rad", &[-0.12]);
    all(&torque(LawVariable::Speed, [-4.0, 5.0], |w| -0.01 * w), "like viscous friction of ", " N m s/rad", &[0.01]);
    let thick = said(LawVariable::Speed, LawActs::Friction, [0.0, 5.0], |w| 0.01 * w + 0.03);
    all(&thick, "like viscous friction of ", ", beside ", &[0.01, 0.03]);
    let heavy = torque(LawVariable::Load, [-0.5, 0.5], |load| 0.06 * load);
    all(&heavy, "proportional to the load, like a moment", " % off", &[6.0]);
    let loaded = said(LawVariable::Load, LawActs::Friction, [0.0, 0.5], |load| 0.06 * load);
    all(&loaded, "like load friction of ", "", &[0.06]);
    let weak = torque(LawVariable::MotorTorque, [-2.0, 2.0], |m| -0.2 * m);
    all(&weak, "proportional to the motor's torque, like a gain", " % off", &[-20.0]);
    all(&torque(LawVariable::Time, [0.0, 30.0], |t| 1e-3 * t), "drifts by ", " N m/s", &[1e-3]);
    let creeps = said(LawVariable::Time, LawActs::Reading, [0.0, 30.0], |t| 2e-3 * t);
    all(&creeps, "drifts by ", " rad/s", &[2e-3]);
    let sags = said(LawVariable::Time, LawActs::Gain, [0.0, 30.0], |t| -0.01 * t);
    all(&sags, "drifts by ", " %/s", &[-1.0]);
    let faster = said(LawVariable::Speed, LawActs::Gain, [-3.0, 3.0], |w| 0.02 * w);
    all(&faster, "proportional to the speed, ", " % s/rad", &[2.0]);
    let stretched = said(LawVariable::Angle, LawActs::Reading, BOTH, |q| 0.02 * q);
    all(&stretched, "like a sensor gain that is ", " % off", &[2.0]);
    let ahead = torque(LawVariable::SetpointRate, [-3.0, 3.0], |rate| 0.1 * rate);
    all(&ahead, "proportional to the setpoint's rate, ", " N m s/rad", &[0.1]);
}

#[test]
fn waves_have_their_period_and_amplitude() {
    let fine = |f: &dyn Fn(f64) -> f64| torque(LawVariable::Angle, BOTH, f);
    let plain = fine(&|q| 0.03 * (TAU * q / 0.4 + 1.0).sin());
    all(&plain, "repeats every ", "rad, amplitude", &[0.4, 0.03]);
    assert!(plain.iter().all(|words| words.ends_with("(cogging, or teeth)")), "{plain:?}");
    let tilted = fine(&|q| 0.03 * (TAU * q / 0.4).sin() - 0.1 * q);
    all(&tilted, "repeats every ", ", on a line of", &[0.4, 0.03, -0.1]);
    let wavy = said(LawVariable::Angle, LawActs::Reading, [0.0, 12.6], |q| 0.01 * q.sin());
    all(&wavy, "repeats every ", "amplitude", &[TAU, 0.01]);
}

#[test]
fn kinks_steps_and_bumps_are_where_they_are() {
    let dry = torque(LawVariable::Speed, [-4.0, 4.0], |w| -0.01 * (w / 0.1).tanh());
    all(&dry, "a step at zero, from", "like dry friction of", &[0.01, -0.01, 0.01]);
    all(
        &torque(LawVariable::Angle, BOTH, |q| if q > 0.4 { 0.02 } else { -0.01 }),
        "a step at ",
        "from",
        &[0.4, -0.01, 0.02],
    );
    let soft = torque(LawVariable::MotorTorque, [-2.0, 2.0], |m| 0.1 * (m / 0.6).tanh());
    all(&soft, "saturates on both sides: from", "", &[-0.1, 0.1]);
    let dead = torque(LawVariable::MotorTorque, [-2.0, 2.0], |m| -0.3 * (m - m.clamp(-0.5, 0.5)));
    all(&dead, "nothing within ", "dead band", &[0.5, -0.3]);
    let rope = torque(LawVariable::Angle, BOTH, |q| -2.0 * (q - 0.4).max(0.0));
    all(&rope, "only above ", ", like a stop or a rope", &[0.4, -2.0]);
    all(&torque(LawVariable::Angle, BOTH, |q| -2.0 * (q + 0.5).min(0.0)), "only below ", "N m/rad", &[-0.5, -2.0]);
    let hump = |q: f64| 0.05 * (-((q - 0.2) / 0.2f64).powi(2)).exp();
    all(&torque(LawVariable::Angle, BOTH, hump), "a bump of ", "wide", &[0.05, 0.2, 0.4]);
    all(&torque(LawVariable::Angle, BOTH, |q| -hump(q)), "a dip of ", "wide", &[0.05, 0.2, 0.4]);
    let uneven = torque(LawVariable::Speed, [-4.0, 4.0], |w| -0.01 * w.max(0.0) - 0.03 * w.min(0.0));
    all(&uneven, "asymmetric: ", "below zero and", &[-0.03]);
}

#[test]
fn squares_and_what_settles() {
    let drag = said(LawVariable::Speed, LawActs::Friction, [0.0, 6.0], |w| 0.001 * w * w);
    all(&drag, "grows with the square of the speed: ", " at ", &[0.036, 6.0]);
    let signed = torque(LawVariable::Speed, [-5.0, 5.0], |w| -0.001 * w * w.abs());
    all(&signed, "grows with the square of the speed and its sign: ", "like drag", &[-0.025, 5.0]);
    let stribeck = |w: f64| 0.01 + 0.02 * (-(w / 0.5f64).powi(2)).exp();
    let falls = said(LawVariable::Speed, LawActs::Friction, [0.0, 5.0], stribeck);
    all(&falls, "falls from ", "Stribeck", &[0.03, 0.01]);
    let warm = torque(LawVariable::Time, [0.0, 60.0], |t| 0.02 * (1.0 - (-t / 10.0f64).exp()));
    all(&warm, "saturates: from", "within", &[]);
}

#[test]
fn other_curves_have_no_simple_shape() {
    let odd = |q: f64| (9.0 * q * q).sin() + 0.7 * (5.0 * q + 1.0).cos() + if q > 0.3 { 1.2 } else { 0.0 };
    all(&torque(LawVariable::Angle, BOTH, odd), "no simple shape; between", "N m", &[]);
    let noise =
        LawTable::new(LawVariable::Angle, LawActs::Torque, vec![0.0, 1.0, 2.0, 3.0], vec![0.1, -0.2, 0.1, 0.05]);
    assert!(looks_like(&noise, Some(&[0.2; 4])).starts_with("nothing that stands out"));
    let few = LawTable::new(LawVariable::Angle, LawActs::Torque, vec![0.0, 1.0], vec![0.1, -0.2]);
    assert!(!looks_like(&few, None).is_empty());
    let none = LawTable { variables: Vec::new(), ..few };
    assert_eq!(looks_like(&none, None), "no simple shape");
}
