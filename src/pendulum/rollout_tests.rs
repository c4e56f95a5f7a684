use super::*;
use crate::joint::{Contact, Dual, EffectForm, EffectId, Friction, FrictionTerm, Link, Motor, Stribeck};
use crate::log::Hold;
use crate::log::MotorSpec;
use approx::assert_relative_eq;
use proptest::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const G: f64 = 9.81;

fn chain(inertia: f64, moment: f64, coulomb: f64, viscous: f64) -> Chain<f64> {
    Chain::new(Link::new(inertia, moment, 0.0, G), Friction::coulomb_viscous(coulomb, viscous), None)
}

fn times(n: usize, period_s: f64) -> Vec<f64> {
    (0..n).map(|k| k as f64 * period_s).collect()
}

fn angles<T: Real>(chain: &Chain<T>, input: Input<'_>, t_s: &[f64], start: Start<T>, refinement: f64) -> Vec<T> {
    let mut q = Vec::with_capacity(t_s.len());
    rollout_refined(chain, input, t_s, start, refinement, |_, s| q.push(s.angle_rad)).expect("does not diverge");
    q
}

fn free(angle_rad: f64) -> Start<f64> {
    Start { angle_rad, rate_rad_s: 0.0, release_s: None }
}

fn motor() -> MotorSpec {
    MotorSpec::pd(5.0, 0.05)
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn coulomb_oscillator_loses_its_amplitude_in_equal_parts() {
    // A small swing with Coulomb friction loses 2 mu_c / (g M*) of amplitude per half swing, exactly in the limit.
    let (inertia, moment, mu_c) = (0.01, 0.05, 1e-4);
    let t = times(4000, 0.001);
    let q = angles(&chain(inertia, moment, mu_c, 0.0), Input::Off, &t, free(0.02), 1.0);
    let band = mu_c / (G * moment);
    let half_swing = std::f64::consts::PI * (inertia / (G * moment)).sqrt();
    for half in 1..=6 {
        let k = (half as f64 * half_swing / 0.001).round() as usize;
        let expected = 0.02 - 2.0 * band * half as f64;
        assert_relative_eq!(q[k].abs(), expected, max_relative = 2e-4);
    }
}

/// Masses of 1e200 kg made an event at no instant, and the motion never came to its end.
#[test]
fn torques_beyond_all_numbers_diverge_and_do_not_hang() {
    let mut c = chain(0.01, 0.05, 1e-3, 1e-3);
    c.motor = Some(Motor::new(MotorSpec { kp_nm_rad: 1e308, ..motor() }));
    // From less than friction to infinity within what halving can tell.
    let setpoint_rad = [0.0, 1e19, 2e19, 3e19];
    let input = Input::Position { setpoint_rad: &setpoint_rad, hold: Hold::Linear, on: None };
    let diverged = rollout(&c, input, &times(4, 0.01), free(0.0), |_, _| ()).expect_err("no number holds this");
    assert!(diverged.at_s.is_finite(), "{diverged}");
}

#[test]
fn a_joint_sticks_below_breakaway_and_never_creeps() {
    let c = chain(1e-4, 0.00162, 0.020, 0.010);
    let q = angles(&c, Input::Off, &times(5000, 0.008), free(1.0), 1.0);
    assert!(q.iter().all(|&x| x == 1.0), "the thesis's bare lower leg does not move");
    let swings = angles(&chain(1e-4, 0.00162, 0.010, 0.010), Input::Off, &times(5000, 0.008), free(1.0), 1.0);
    assert!(swings[4999] < 0.9, "with Table 3.4's 0.010 N m it would");
}

#[test]
fn a_release_between_two_samples_is_exact() {
    let c = chain(0.01, 0.05, 1e-3, 1e-3);
    let t = times(200, 0.008);
    let held = Start { angle_rad: 0.8, rate_rad_s: 0.0, release_s: Some(0.1037) };
    let q = angles(&c, Input::Off, &t, held, 1.0);
    assert!(q[..=12].iter().all(|&x| x == 0.8));
    let shifted: Vec<f64> = std::iter::once(0.0).chain(t[13..].iter().map(|x| x - 0.1037)).collect();
    let direct = angles(&c, Input::Off, &shifted, free(0.8), 1.0);
    assert!(largest_difference(&q[13..], &direct[1..]) < 1e-7);
}

#[test]
fn halving_the_step_changes_less_than_a_tenth_of_a_sensor_step() {
    // Joints from the thesis's legs to a geared servo; the encoder of each, and its sampling.
    let cases = [
        (chain(0.0127, 0.0748, 0.001, 0.017), 0.008, 0.006),
        (chain(5e-4, 0.0063, 0.001, 0.017), 0.008, 0.006),
        (chain(8e-3, 0.0547, 0.020, 0.010), 0.008, 0.006),
        (chain(0.0065, 0.049, 0.007, 0.0105), 0.0035, 0.001534),
        (chain(0.0173, 0.1356, 0.20, 0.035), 0.0152, 0.001534),
        (chain(0.174, 0.39, 0.16, 0.001), 0.002, 0.00038),
    ];
    for (i, (c, period_s, step_rad)) in cases.iter().enumerate() {
        let t = times((6.0 / period_s) as usize, *period_s);
        let start = Start { angle_rad: 1.5, rate_rad_s: -0.1, release_s: None };
        let coarse = angles(c, Input::Off, &t, start, 1.0);
        let fine = angles(c, Input::Off, &t, start, 2.0);
        let worst = largest_difference(&coarse, &fine);
        assert!(worst < 0.1 * step_rad, "case {i}: {worst}");
    }
}

#[test]
fn halving_the_step_changes_little_with_stribeck_and_a_driven_joint() {
    let mut c = chain(0.0173, 0.1356, 0.10, 0.035);
    c.friction.stribeck = Some(Stribeck { static_nm: 0.2, speed_rad_s: 0.1, curve: Default::default() });
    c.motor = Some(Motor::new(MotorSpec { kp_nm_rad: 67.0, kd_nm_s_rad: 2.3, ..motor() }));
    let t = times(300, 0.0206);
    let setpoint: Vec<f64> = t.iter().map(|t| (3.0 * t * t).sin() * 0.8).collect();
    let start = Start { angle_rad: 0.0, rate_rad_s: 0.0, release_s: None };
    for hold in [Hold::Step, Hold::Linear] {
        let input = Input::Position { setpoint_rad: &setpoint, hold, on: None };
        let worst = largest_difference(&angles(&c, input, &t, start, 1.0), &angles(&c, input, &t, start, 2.0));
        assert!(worst < 0.1 * 0.001534, "{hold:?}: {worst}");
    }
}

#[test]
fn messages_act_at_their_own_stamps_and_not_at_those_of_the_readings() {
    let mut c = chain(0.0173, 0.1356, 0.02, 0.035);
    c.motor = Some(Motor::new(MotorSpec { kp_nm_rad: 12.0, kd_nm_s_rad: 0.6, ..motor() }));
    // Readings every 20 ms and setpoints every 7 ms, against the same joint read every millisecond.
    let at_s: Vec<f64> = (0..400).map(|k| 0.001 * f64::from(7 * k)).collect();
    let setpoint_rad: Vec<f64> = at_s.iter().map(|t| 0.6 * (4.0 * t).sin()).collect();
    for (hold, delay_s, from) in
        [(Hold::Step, None, 0), (Hold::Step, Some(0.013), 0), (Hold::Linear, None, 0), (Hold::Step, None, 1005)]
    {
        c.setpoint.delay_s = delay_s;
        let t: Vec<f64> = (0..60).map(|k| 0.001 * f64::from(from + 20 * k)).collect();
        let fine: Vec<f64> = (0..1181).map(|k| 0.001 * f64::from(from + k)).collect();
        let asked = |t: &f64| {
            let k = at_s.partition_point(|at| at <= t) - 1;
            let share = if hold == Hold::Linear { (t - at_s[k]) / 0.007 } else { 0.0 };
            setpoint_rad[k] + share * (setpoint_rad[k + 1] - setpoint_rad[k])
        };
        let finely: Vec<f64> = fine.iter().map(asked).collect();
        let messages = Input::Messages { at_s: &at_s, setpoint_rad: &setpoint_rad, hold, on: None };
        let coarse = angles(&c, messages, &t, free(0.0), 1.0);
        let whole = angles(&c, Input::Position { setpoint_rad: &finely, hold, on: None }, &fine, free(0.0), 1.0);
        let picked: Vec<f64> = whole.into_iter().step_by(20).collect();
        let worst = largest_difference(&coarse, &picked);
        assert!(worst < 1e-4, "{hold:?} {delay_s:?} {from}: {worst}");
    }
}

#[test]
fn a_stuck_joint_breaks_away_when_the_setpoint_has_moved_far_enough() {
    let mut c = chain(0.01, 0.0, 0.5, 0.0);
    c.motor = Some(Motor::new(motor()));
    let t = times(100, 0.01);
    let setpoint: Vec<f64> = t.iter().map(|t| 0.5 * t).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Linear, on: None };
    let q = angles(&c, input, &t, free(0.0), 1.0);
    // kp times the error reaches mu_c when the setpoint stands at 0.1 rad, at t = 0.2 s.
    assert!(q[..=20].iter().all(|&x| x == 0.0) && q[22] > 0.0);
}

/// A setpoint that turns back a joint that still creeps is followed at once, however little it creeps.
#[test]
fn a_joint_that_barely_moves_is_there_when_it_is_turned_back() {
    let t = times(200, 0.02);
    let mut c = chain(5e-6, 0.0, 0.0, 0.89);
    (c.motor, c.armature_kg_m2) = (Some(Motor::new(MotorSpec::pd(17.8, 0.0))), 0.0077);
    for turned in 20..150 {
        // Until then it creeps to none, by a factor of e in 50 ms.
        let setpoint: Vec<f64> = (0..t.len()).map(|k| 2e-3 * k.saturating_sub(turned) as f64).collect();
        let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Linear, on: None };
        let [coarse, fine] = [0.4, 4.0].map(|refinement| angles(&c, input, &t, free(0.3), refinement));
        let apart = largest_difference(&coarse[20..], &fine[20..]);
        assert!(apart < 1e-4, "turned back after {turned} samples: {apart} rad");
    }
}

/// With the steps that logs of a joint are fitted in which its controller never lets go of.
#[test]
fn coarse_steps_of_a_held_joint_lose_far_less_than_an_encoder_shows() {
    let t = times(400, 0.02);
    // It swings at 28 rad/s and loses a third of that in each swing.
    let mut c = chain(0.01, 0.3, 0.0, 0.035);
    c.motor = Some(Motor::new(MotorSpec::pd(8.0, 0.0)));
    let setpoint: Vec<f64> = (0..t.len()).map(|k| if k / 50 % 2 == 0 { 0.0 } else { 0.5 }).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None };
    let [coarse, fine] = [0.4, 8.0].map(|refinement| angles(&c, input, &t, free(0.0), refinement));
    let apart = largest_difference(&coarse, &fine);
    assert!(apart > 0.0 && apart < 2e-4, "{apart} rad");
}

#[test]
fn an_integral_term_alone_breaks_a_joint_away() {
    let mut c = chain(0.01, 0.0, 0.5, 0.01);
    c.motor = Some(Motor::new(MotorSpec { kp_nm_rad: 1.0, ki_nm_rad_s: 2.0, ..motor() }));
    let t = times(400, 0.01);
    let setpoint = vec![0.1; 400];
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None };
    let q = angles(&c, input, &t, free(0.0), 1.0);
    // 1 * 0.1 + 2 * 0.1 t = 0.5 at t = 2 s.
    assert!(q[..=200].iter().all(|&x| x == 0.0) && q[203] > 0.0);
}

#[test]
fn a_sampled_law_tends_to_the_continuous_one() {
    let mut c = chain(0.01, 0.05, 0.01, 0.02);
    let t = times(200, 0.008);
    let setpoint: Vec<f64> = t.iter().map(|t| 0.6 * (4.0 * t).sin()).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None };
    let mut run = |sample_period_s| {
        c.motor = Some(Motor::new(MotorSpec { sample_period_s, ..motor() }));
        angles(&c, input, &t, free(0.0), 1.0)
    };
    let continuous = run(None);
    let fine = largest_difference(&continuous, &run(Some(1e-4)));
    let coarse = largest_difference(&continuous, &run(Some(8e-3)));
    assert!(fine < 1e-3 && coarse > 3.0 * fine, "{fine} {coarse}");
}

/// Inertia, moment, Coulomb, viscous, angle, release: as dual numbers and as finite differences.
fn sensitivities<T: Real>(p: [T; 6], motor: Option<MotorSpec>, setpoint: &[f64], t: &[f64]) -> Vec<T> {
    let friction = Friction {
        stribeck: Some(Stribeck { static_nm: p[2] * 1.3, speed_rad_s: T::constant(0.3), curve: Default::default() }),
        ..Friction::coulomb_viscous(p[2], p[3])
    };
    let c = Chain::new(Link::new(p[0], p[1], T::constant(0.05), G), friction, motor.map(Motor::new));
    let start = Start { angle_rad: p[4], rate_rad_s: T::nought(), release_s: Some(p[5]) };
    let input = match motor {
        None => Input::Off,
        Some(m) => Input::Position { setpoint_rad: setpoint, hold: m.hold, on: None },
    };
    angles(&c, input, t, start, 1.0)
}

#[test]
fn dual_numbers_agree_with_central_differences_through_events() {
    let t = times(250, 0.008);
    let setpoint: Vec<f64> = t.iter().map(|t| 0.4 * (5.0 * t).sin()).collect();
    let p = [0.011, 0.05, 0.02, 0.004, 0.9, 0.0213];
    let linear = MotorSpec { hold: Hold::Linear, kp_nm_rad: 1.0, ..motor() };
    for motor in [None, Some(motor()), Some(linear), Some(MotorSpec { ki_nm_rad_s: 0.5, ..linear })] {
        let duals: [Dual<6>; 6] = std::array::from_fn(|i| Dual::variable(p[i], i));
        let exact = sensitivities(duals, motor, &setpoint, &t);
        let plain = sensitivities(p, motor, &setpoint, &t);
        for i in 0..6 {
            let h = 1e-5 * p[i];
            let (mut up, mut down) = (p, p);
            up[i] += h;
            down[i] -= h;
            let (up, down) = (sensitivities(up, motor, &setpoint, &t), sensitivities(down, motor, &setpoint, &t));
            let scale = exact.iter().map(|x| x.eps[i].abs()).fold(0.0, f64::max).max(1e-3);
            for k in 0..t.len() {
                assert!((exact[k].re - plain[k]).abs() < 1e-11, "the real part takes the same path");
                let difference = (up[k] - down[k]) / (2.0 * h);
                let error = (exact[k].eps[i] - difference).abs() / scale;
                assert!(error < 2e-4, "{motor:?} parameter {i} sample {k}: {error}");
            }
        }
    }
}

/// A joint that rests on one edge of breaking loose and is driven over the other within one sample.
#[test]
fn a_breakaway_the_other_way_has_the_derivative_of_its_instant() {
    let (coulomb, kp) = (0.05, 18.0);
    let t = times(6, 0.02);
    // It rests where friction just holds it from above, and is torn down with a torque that falls by twice that and a little.
    let setpoint: Vec<f64> = (0..t.len()).map(|k| (coulomb - 0.101 * k as f64) / kp).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Linear, on: None };
    fn at_end<T: Real>(friction_nm: T, input: Input<'_>, t: &[f64], kp: f64) -> T {
        let link = Link::new(T::constant(0.01), T::nought(), T::nought(), G);
        let friction = Friction::coulomb_viscous(friction_nm, T::constant(0.9));
        let c = Chain::new(link, friction, Some(Motor::new(MotorSpec::pd(kp, 0.0))));
        let start = Start { angle_rad: T::nought(), rate_rad_s: T::nought(), release_s: None };
        angles(&c, input, t, start, 0.4)[1]
    }
    let holds_nm = coulomb + 1e-5;
    let slope = at_end(Dual::<1>::variable(holds_nm, 0), input, &t, kp).eps[0];
    let [less, more] = [-1e-6, 1e-6].map(|by| at_end(holds_nm + by, input, &t, kp));
    assert_relative_eq!(slope, (more - less) / 2e-6, max_relative = 2e-3);
}

/// A hold counts from the beginning of the log: what it read before the part is no motion of the part.
#[test]
fn a_part_with_a_hold_begins_when_it_begins() {
    let mut c = chain(0.01, 0.0, 1e-3, 0.01);
    c.motor = Some(Motor::new(motor()));
    let t: Vec<f64> = (0..100).map(|k| 8.08 + 0.02 * k as f64).collect();
    let setpoint = vec![0.4; t.len()];
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None };
    let start = Start { rate_rad_s: 1.0, ..free(0.1) };
    let without = angles(&c, input, &t, start, 1.0);
    c.setpoint.hold_s = Some(0.1);
    assert!(largest_difference(&without, &angles(&c, input, &t, start, 1.0)) < 1e-7);
}

/// Grease that stiffens thirtyfold along a log damps faster than a step that knew the cold joint only could follow.
#[test]
fn friction_that_grows_is_followed_to_the_end() {
    let mut c = chain(0.001, 0.0, 1e-4, 0.01);
    c.motor = Some(Motor::new(MotorSpec::pd(0.05, 0.0)));
    EffectForm::from(EffectId::FrictionDrift).apply(&[2.0], c.link.inertia_kg_m2, &mut c);
    let t = times(150, 0.1);
    let setpoint: Vec<f64> = t.iter().map(|t| (0.8 * t).sin()).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Linear, on: None };
    let refined = angles(&c, input, &t, free(0.0), 10.0);
    assert!(largest_difference(&angles(&c, input, &t, free(0.0), 1.0), &refined) < 1e-5);
}

#[test]
fn a_release_on_a_sample_keeps_its_derivative() {
    // A log with a `drive` column starts its search there: without the derivative the release could never leave.
    let t = times(250, 0.008);
    for (release, side) in [(t[0], 1.0), (t[1], 1.0), (t[1], -1.0), (t[3], -1.0)] {
        let p = [0.011, 0.05, 0.02, 0.004, 0.9, release];
        let exact = sensitivities(std::array::from_fn(|i| Dual::<6>::variable(p[i], i)), None, &[], &t);
        let (mut moved, h) = (p, 1e-7);
        moved[5] += side * h;
        let (here, there) = (sensitivities(p, None, &[], &t), sensitivities(moved, None, &[], &t));
        let scale = exact.iter().map(|x| x.eps[5].abs()).fold(0.0, f64::max);
        assert!(scale > 1.0, "release at {release} s: {scale} rad/s");
        for k in 0..t.len() {
            let error = (exact[k].eps[5] - side * (there[k] - here[k]) / h).abs() / scale;
            assert!(error < 1e-3, "release at {release} s, sample {k}: {error}");
        }
    }
}

#[test]
fn impossible_joints_are_rejected_and_do_not_hang() {
    let t = times(100, 0.008);
    let c = chain(1e-12, 0.05, 0.0, 10.0);
    let result = rollout(&c, Input::Off, &t, free(1.0), |_, _| {});
    assert!(result.is_err());
}

proptest! {
    #[test]
    fn energy_never_grows_without_drive(
        inertia in 1e-4..0.1f64,
        frequency in 2.0..12.0f64,
        mu_c in 0.0..0.3f64,
        damping in 0.0..2.0f64,
        angle in -3.0..3.0f64,
        rate in -5.0..5.0f64,
    ) {
        let moment = inertia * frequency * frequency / G;
        let c = chain(inertia, moment, mu_c * G * moment, damping * inertia * frequency);
        let mut last = f64::INFINITY;
        let scale = 0.5 * inertia * rate * rate + 2.0 * G * moment;
        let start = Start { angle_rad: angle, rate_rad_s: rate, release_s: None };
        rollout(&c, Input::Off, &times(400, 0.008), start, |_, s| {
            let energy = 0.5 * inertia * s.rate_rad_s * s.rate_rad_s + c.link.potential_j(s.angle_rad);
            assert!(energy <= last + 1e-6 * scale, "{energy} after {last}");
            last = energy;
        }).expect("does not diverge");
    }
}

/// Asks how often friction is asked for.
struct Asked(Arc<AtomicUsize>);

impl FrictionTerm<f64> for Asked {
    fn resistance_nm(&self, _: &Contact<f64>) -> f64 {
        self.0.fetch_add(1, Ordering::Relaxed);
        0.0
    }

    fn slope_nm_s_rad(&self, _: f64, _: f64) -> f64 {
        0.0
    }
}

/// A sine that a servo follows, and how often friction is asked for on the way.
fn followed(mut c: Chain<f64>, kp_nm_rad: f64, refinement: f64) -> (Vec<f64>, usize) {
    let t = times(400, 0.02);
    let setpoint: Vec<f64> = t.iter().map(|t| 0.4 * (5.0 * t).sin() + if *t > 4.0 { 0.2 } else { 0.0 }).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None };
    let asked = Arc::new(AtomicUsize::new(0));
    c.friction.terms.push(Box::new(Asked(Arc::clone(&asked))));
    c.motor = Some(Motor::new(MotorSpec::pd(kp_nm_rad, 0.0)));
    let q = angles(&c, input, &t, free(0.1), refinement);
    (q, asked.load(Ordering::Relaxed))
}

/// What stiffens a joint costs no steps, and is followed as steps do that are sixteen times shorter than the rule asks for.
#[test]
fn leaps_of_a_held_joint_cost_little_and_lose_nothing() {
    let mut curved = chain(0.004, 0.1, 0.02, 0.15);
    curved.friction.stribeck = Some(Stribeck { static_nm: 0.03, speed_rad_s: 0.5, curve: Default::default() });
    // Thick friction on next to no inertia; a servo that swings; friction that bends; a heavy load.
    let joints = [(chain(1.2e-3, 0.02, 0.02, 0.6), 18.0), (chain(0.01, 0.05, 0.05, 0.06), 12.0), (curved, 15.0)];
    for (c, kp_nm_rad) in joints.into_iter().chain([(chain(0.02, 0.4, 0.1, 0.3), 18.0)]) {
        let inertia = c.inertia_kg_m2();
        let copy = |c: &Chain<f64>| {
            let friction = Friction {
                terms: Vec::new(),
                ..Friction::coulomb_viscous(c.friction.coulomb_nm, c.friction.viscous_nm_s_rad)
            };
            Chain::new(c.link, Friction { stribeck: c.friction.stribeck, ..friction }, None)
        };
        let [(leaps, few), (_, more), (fine, _)] = [0.4, 1.0, 16.0].map(|by| followed(copy(&c), kp_nm_rad, by));
        let apart = largest_difference(&leaps, &fine);
        assert!(apart < 2e-5, "{inertia} kg m^2: {apart} rad");
        // Four for a leap, the looks at where the joint turns back, and leaps that bend too much.
        assert!(few < 400 * 14 && more > 3 * few, "{inertia} kg m^2: {few} of {more}");
    }
}

/// Thick friction on little inertia follows a ramp at once: its speed falls to nothing and is there again within a sample.
#[test]
fn a_joint_that_stops_within_a_leap_and_goes_on_is_seen_to_stop() {
    let t = times(400, 0.02);
    let mut c = chain(1.2e-3, 0.0, 0.02, 0.6);
    c.motor = Some(Motor::new(MotorSpec::pd(18.0, 0.0)));
    let rates = [0.0, 1.0, -0.4, 2.0, 0.3, -1.5, 0.05];
    let setpoint: Vec<f64> = (0..t.len())
        .scan(0.0, |at, k| {
            *at += 0.02 * rates[k / 3 % rates.len()] + if k % 7 == 0 { -0.01 } else { 0.0 };
            Some(*at)
        })
        .collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Linear, on: None };
    let [leaps, fine] = [0.4, 16.0].map(|refinement| angles(&c, input, &t, free(0.05), refinement));
    let apart = largest_difference(&leaps, &fine);
    assert!(apart < 2e-5, "{apart} rad");
}
