//! Laws without a formula against the terms with one that they can imitate, and their derivatives.

use super::{Input, Start, readings, rollout_refined};
use crate::joint::{
    Chain, Compliance, Dual, EffectForm, EffectId, Friction, Law, LawActs, LawVariable, Link, Motor, Play, Real,
    Spring, SpringCurve,
};
use crate::log::{Derivative, Hold, MotorSpec};

const G: f64 = 9.81;
const COULOMB_NM: f64 = 0.004;
const VISCOUS_NM_S_RAD: f64 = 0.003;

fn joint() -> Chain<f64> {
    Chain::new(Link::new(0.01, 0.05, 0.0, G), Friction::coulomb_viscous(COULOMB_NM, VISCOUS_NM_S_RAD), None)
}

fn driven(spec: MotorSpec) -> Chain<f64> {
    Chain { motor: Some(Motor::new(spec)), ..joint() }
}

fn law(variable: LawVariable, acts: LawActs, at: &[f64], f: impl Fn(f64) -> f64) -> Law<f64> {
    Law::new(variable, acts, at.into(), &at.iter().map(|x| f(*x)).collect::<Vec<_>>()).unwrap()
}

fn with(mut chain: Chain<f64>, law: Law<f64>) -> Chain<f64> {
    chain.add_law(law);
    chain
}

fn times(n: usize) -> Vec<f64> {
    (0..n).map(|k| k as f64 * 0.008).collect()
}

fn free(angle_rad: f64) -> Start<f64> {
    Start { angle_rad, rate_rad_s: 0.0, release_s: None }
}

fn refined<T: Real>(chain: &Chain<T>, input: Input<'_>, t_s: &[f64], start: Start<T>, refinement: f64) -> Vec<T> {
    let mut q = Vec::with_capacity(t_s.len());
    rollout_refined(chain, input, t_s, start, refinement, |_, s| q.push(s.angle_rad)).expect("does not diverge");
    q
}

fn swing(chain: &Chain<f64>) -> Vec<f64> {
    refined(chain, Input::Off, &times(500), free(1.1), 1.0)
}

/// A wave that stands still now and then, held or drawn through.
fn wave(t_s: &[f64]) -> Vec<f64> {
    t_s.iter().map(|t| 0.6 * (3.0 * t).sin().clamp(-0.8, 0.8)).collect()
}

fn follow(chain: &Chain<f64>, hold: Hold) -> Vec<f64> {
    let t_s = times(500);
    refined(chain, Input::Position { setpoint_rad: &wave(&t_s), hold, on: None }, &t_s, free(0.0), 1.0)
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Imitations and what they imitate move alike; without either the joint moves otherwise.
fn same(like: &[f64], as_formula: &[f64], without: &[f64]) {
    assert!(apart(like, as_formula) < 1e-6, "{}", apart(like, as_formula));
    assert!(apart(as_formula, without) > 1e-2, "{}", apart(as_formula, without));
}

const WIDE_RAD: [f64; 6] = [-4.0, -1.0, -0.2, 0.3, 1.2, 4.0];

#[test]
fn a_line_of_angle_is_a_spring_on_one_body_and_on_two() {
    let spring = Spring { stiffness_nm_rad: 0.2, slack_rad: 0.3, curve: SpringCurve::Linear };
    let pull = law(LawVariable::Angle, LawActs::Torque, &WIDE_RAD, |q| 0.2 * (0.3 - q));
    let play = Some(Play { width_rad: 0.05, motor_side_kg_m2: 0.002 });
    let soft = Compliance { stiffness_nm_rad: 40.0, damping_nm_s_rad: 0.01, motor_side_kg_m2: 0.002 };
    for (play, compliance) in [(None, None), (play, None), (None, Some(soft))] {
        let of = || Chain { play, compliance, ..joint() };
        same(&swing(&with(of(), pull.clone())), &swing(&Chain { spring: Some(spring), ..of() }), &swing(&of()));
    }
}

#[test]
fn friction_that_is_constant_is_coulombs_and_a_line_of_speed_is_viscous() {
    let drier = Chain { friction: Friction::coulomb_viscous(0.01, VISCOUS_NM_S_RAD), ..joint() };
    for (variable, at) in
        [(LawVariable::Speed, [0.0, 9.0]), (LawVariable::Angle, [-0.1, 0.1]), (LawVariable::Time, [0.0, 1.0])]
    {
        let constant = law(variable, LawActs::Friction, &at, |_| 0.006);
        same(&swing(&with(joint(), constant)), &swing(&drier), &swing(&joint()));
    }
    let thicker = Chain { friction: Friction::coulomb_viscous(COULOMB_NM, 0.008), ..joint() };
    let by_speed = law(LawVariable::Speed, LawActs::Friction, &[0.0, 0.5, 2.0, 40.0], |w| 0.005 * w);
    same(&swing(&with(joint(), by_speed)), &swing(&thicker), &swing(&joint()));
    // The same as a torque, which knows the direction.
    let braking = law(LawVariable::Speed, LawActs::Torque, &[-40.0, 0.0, 40.0], |w| -0.005 * w);
    same(&swing(&with(joint(), braking)), &swing(&thicker), &swing(&joint()));
    // Friction never drives.
    let none = Chain { friction: Friction::coulomb_viscous(0.0, 0.0), ..joint() };
    let less = law(LawVariable::Speed, LawActs::Friction, &[0.0, 40.0], |_| -1.0);
    assert_eq!(apart(&swing(&with(joint(), less)), &swing(&none)), 0.0);
}

#[test]
fn a_line_of_load_is_load_friction() {
    let mut loaded = joint();
    let form = EffectForm::from(EffectId::LoadFriction);
    form.apply(&[0.05], loaded.link.inertia_kg_m2, &mut loaded);
    let by_load = law(LawVariable::Load, LawActs::Friction, &[0.0, 0.1, 0.3, 0.6], |load| 0.05 * load);
    same(&swing(&with(joint(), by_load)), &swing(&loaded), &swing(&joint()));
    // As a torque with its sign it is another moment.
    let heavier = Chain { link: Link::new(0.01, 0.055, 0.0, G), ..joint() };
    let pull = law(LawVariable::Load, LawActs::Torque, &[-0.6, 0.6], |load| 0.1 * load);
    same(&swing(&with(joint(), pull)), &swing(&heavier), &swing(&joint()));
}

#[test]
fn a_line_of_motor_torque_is_a_gain_of_the_motor_and_of_its_size_gear_friction() {
    for sample_period_s in [None, Some(0.016)] {
        let spec = MotorSpec { sample_period_s, ..MotorSpec::pd(2.0, 0.05) };
        let mut stronger = driven(spec);
        stronger.motor.as_mut().unwrap().gain = 1.2;
        let more = law(LawVariable::MotorTorque, LawActs::Torque, &[-9.0, 0.0, 9.0], |m| 0.2 * m);
        let bare = follow(&driven(spec), Hold::Step);
        same(&follow(&with(driven(spec), more), Hold::Step), &follow(&stronger, Hold::Step), &bare);
        let mut geared = driven(spec);
        EffectForm::from(EffectId::GearFriction).apply(&[0.1], 0.01, &mut geared);
        let by_torque = law(LawVariable::MotorTorque, LawActs::Friction, &[0.0, 1.0, 9.0], |m| 0.1 * m);
        same(&follow(&with(driven(spec), by_torque), Hold::Step), &follow(&geared, Hold::Step), &bare);
    }
}

#[test]
fn a_share_of_the_motors_torque_is_its_gain_where_and_when_it_holds() {
    let spec = MotorSpec::pd(2.0, 0.05);
    let mut stronger = driven(spec);
    stronger.motor.as_mut().unwrap().gain = 1.2;
    let bare = follow(&driven(spec), Hold::Step);
    for variable in [LawVariable::Angle, LawVariable::Speed, LawVariable::Time] {
        let more = law(variable, LawActs::Gain, &[-9.0, 9.0], |_| 0.2);
        same(&follow(&with(driven(spec), more), Hold::Step), &follow(&stronger, Hold::Step), &bare);
    }
    // A supply that sags: what is commanded in a late second does what a weaker motor does then.
    let sags = with(driven(spec), law(LawVariable::Time, LawActs::Gain, &[0.0, 10.0], |t| -0.03 * t));
    let sagged = follow(&sags, Hold::Step);
    let early = sagged.iter().zip(&bare).take(10).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(early < 0.05 * apart(&sagged, &bare), "{early}");
    // Nothing is commanded of a joint that swings freely.
    let free = swing(&with(joint(), law(LawVariable::Angle, LawActs::Gain, &WIDE_RAD, |q| q)));
    assert_eq!(free, swing(&joint()));
}

#[test]
fn a_line_of_setpoint_rate_is_a_derivative_on_the_error() {
    for sample_period_s in [None, Some(0.016)] {
        let spec = MotorSpec { hold: Hold::Linear, sample_period_s, ..MotorSpec::pd(2.0, 0.15) };
        let ahead = law(LawVariable::SetpointRate, LawActs::Torque, &[-9.0, 9.0], |rate| 0.15 * rate);
        let on_error = MotorSpec { derivative: Derivative::Error, ..spec };
        let bare = follow(&driven(spec), Hold::Linear);
        same(
            &follow(&with(driven(spec), ahead.clone()), Hold::Linear),
            &follow(&driven(on_error), Hold::Linear),
            &bare,
        );
        // A step that is held has no rate.
        let held = follow(&driven(spec), Hold::Step);
        assert!(apart(&follow(&with(driven(spec), ahead), Hold::Step), &held) < 1e-12);
    }
}

#[test]
fn a_torque_of_time_moves_a_resting_joint_when_it_is_strong_enough() {
    // 0.005 N m/s against 0.004 N m: it moves at 0.8 s.
    let ramp = law(LawVariable::Time, LawActs::Torque, &[0.0, 10.0], |t| 0.005 * t);
    let t_s = times(150);
    let q = refined(&with(joint(), ramp), Input::Off, &t_s, free(0.0), 1.0);
    let moves_s = t_s[q.iter().position(|q| *q != 0.0).unwrap()];
    assert!((0.8..0.8161).contains(&moves_s), "{moves_s}");
    let held: Vec<f64> = t_s.iter().map(|_| 0.02).collect();
    let pushed = refined(&joint(), Input::Torque { torque_nm: &held, on: None }, &t_s, free(0.0), 1.0);
    let constant = with(joint(), law(LawVariable::Time, LawActs::Torque, &[0.0, 1.0], |_| 0.02));
    same(&refined(&constant, Input::Off, &t_s, free(0.0), 1.0), &pushed, &vec![0.0; t_s.len()]);
    // With play the link leaves its flank at once, with its small share of the friction.
    let back = law(LawVariable::Time, LawActs::Torque, &[0.0, 10.0], |t| -0.005 * t);
    let loose = Chain { play: Some(Play { width_rad: 0.05, motor_side_kg_m2: 0.002 }), ..joint() };
    let q = refined(&with(loose, back), Input::Off, &t_s, free(0.0), 1.0);
    let early = q.iter().position(|q| *q != 0.0).map(|k| t_s[k]);
    assert!(early.is_some_and(|t| t < 0.1), "{early:?}");
}

#[test]
fn a_constant_shift_of_the_reading_is_an_angle_offset_that_the_controller_sees() {
    let shift = law(LawVariable::Angle, LawActs::Reading, &[-0.1, 0.2], |_| 0.07);
    let t_s = times(500);
    let setpoint_rad = wave(&t_s);
    for (of, drive) in [
        (joint as fn() -> Chain<f64>, Input::Off),
        (
            || driven(MotorSpec::pd(2.0, 0.05)),
            Input::Position { setpoint_rad: &setpoint_rad, hold: Hold::Step, on: None },
        ),
    ] {
        let read = |chain: &Chain<f64>| {
            let mut q = Vec::new();
            readings(chain, drive, &t_s, free(0.9), 1.0, |_, s| q.push(s.angle_rad)).expect("does not diverge");
            q
        };
        let offset = Chain { link: of().link.turned(-0.07), ..of() };
        same(&read(&with(of(), shift.clone())), &read(&offset), &read(&of()));
    }
    assert!(!with(joint(), shift).reads_true());
}

#[test]
fn a_wavy_reading_is_found_back() {
    let wavy = with(joint(), law(LawVariable::Angle, LawActs::Reading, &WIDE_RAD, |q| 0.05 * (4.0 * q).sin()));
    for q in [-5.0, -0.9, 0.0, 0.31, 1.1, 3.9] {
        let [reading, rate] = wavy.reading(0.0, q, 2.0);
        let [back, rate_back] = wavy.read_back(0.0, reading, rate);
        assert!((back - q).abs() < 1e-12 && (rate_back - 2.0).abs() < 1e-10, "{q}: {back} {rate_back}");
        assert_eq!(wavy.reading_rad(0.0, q), reading);
    }
}

#[test]
fn a_reading_that_creeps_leaves_a_free_joint_alone_and_moves_a_driven_one() {
    const CREEP_RAD_S: f64 = 0.02;
    let creep = law(LawVariable::Time, LawActs::Reading, &[0.0, 2.0, 4.0], |t| CREEP_RAD_S * t);
    let t_s = times(500);
    // The encoder of a joint at rest shows the creep's rate.
    let start = |rate_rad_s| Start { angle_rad: 0.9, rate_rad_s, release_s: None };
    let read = |chain: &Chain<f64>, drive, start| {
        let mut q = Vec::new();
        readings(chain, drive, &t_s, start, 1.0, |_, s| q.push(s.angle_rad)).expect("does not diverge");
        q
    };
    let free = read(&joint(), Input::Off, start(0.0));
    let crept: Vec<f64> = free.iter().zip(&t_s).map(|(q, t)| q + CREEP_RAD_S * t).collect();
    let creeping = with(joint(), creep.clone());
    assert!(apart(&read(&creeping, Input::Off, start(CREEP_RAD_S)), &crept) < 1e-9);
    // What a stiff servo reads stays at its setpoint, so that the link goes the other way.
    let setpoint_rad = vec![0.9; t_s.len()];
    let held = Input::Position { setpoint_rad: &setpoint_rad, hold: Hold::Step, on: None };
    let servo = with(driven(MotorSpec::pd(50.0, 1.0)), creep);
    let link = refined(&servo, held, &t_s, start(0.0), 1.0);
    let gone_rad = link[link.len() - 1] - link[0];
    assert!((gone_rad + CREEP_RAD_S * t_s[t_s.len() - 1]).abs() < 0.02, "{gone_rad}");
    let [reading, rate] = creeping.reading(1.5, 0.3, 2.0);
    let [back, rate_back] = creeping.read_back(1.5, reading, rate);
    assert!((back - 0.3).abs() < 1e-12 && (rate_back - 2.0).abs() < 1e-12, "{back} {rate_back}");
}

/// Cogging, Stribeck's friction, a motor that saturates softly and an encoder that is wavy and creeps, all as curves.
fn many<T: Real>(values: &[T]) -> Chain<T> {
    let c = T::constant;
    let friction = Friction::coulomb_viscous(c(COULOMB_NM), c(VISCOUS_NM_S_RAD));
    let motor = Motor::new(MotorSpec { hold: Hold::Linear, ..MotorSpec::pd(2.0, 0.05) });
    let mut chain = Chain::new(Link::new(c(0.01), c(0.05), c(0.0), G), friction, Some(motor));
    let knots: Vec<f64> = (0..21).map(|k| f64::from(k) * 0.1 - 1.0).collect();
    let of = |f: &dyn Fn(f64) -> T, at: &[f64]| at.iter().map(|x| f(*x)).collect::<Vec<T>>();
    let mut add = |variable, acts, at: &[f64], f: &dyn Fn(f64) -> T| {
        chain.add_law(Law::new(variable, acts, at.into(), &of(f, at)).unwrap());
    };
    add(LawVariable::Angle, LawActs::Torque, &knots, &|q| values[0] * (12.0 * q).sin());
    add(LawVariable::Speed, LawActs::Friction, &[0.0, 0.2, 0.6, 1.5, 6.0], &|w| values[1] * (-w / 0.3).exp());
    add(LawVariable::MotorTorque, LawActs::Torque, &[-2.0, -1.0, 0.0, 1.0, 2.0], &|m| values[2] * (m * m.abs()));
    add(LawVariable::Angle, LawActs::Reading, &[-1.0, -0.5, 0.0, 0.5, 1.0], &|q| values[3] * (3.0 * q).cos());
    add(LawVariable::SetpointRate, LawActs::Torque, &[-2.0, 0.0, 2.0], &|rate| values[4] * rate);
    add(LawVariable::Time, LawActs::Torque, &[0.0, 1.0, 2.0], &|t| values[5] * t);
    add(LawVariable::Angle, LawActs::Gain, &knots, &|q| values[6] * (9.0 * q).cos());
    add(LawVariable::Time, LawActs::Reading, &[0.0, 1.0, 2.0], &|t| values[7] * t);
    chain
}

const SIZES: [f64; 8] = [0.03, 0.01, -0.04, 0.02, 0.05, 0.01, 0.15, 0.02];

#[test]
fn derivatives_by_the_values_agree_with_differences_through_events() {
    let t_s = times(250);
    let setpoint_rad = wave(&t_s);
    let input = Input::Position { setpoint_rad: &setpoint_rad, hold: Hold::Linear, on: None };
    fn read<T: Real>(values: &[T], input: Input<'_>, t_s: &[f64]) -> Vec<T> {
        let start = Start { angle_rad: T::constant(0.4), rate_rad_s: T::nought(), release_s: None };
        let mut q = Vec::new();
        readings(&many(values), input, t_s, start, 1.0, |_, s| q.push(s.angle_rad)).expect("does not diverge");
        q
    }
    let duals: [Dual<8>; 8] = std::array::from_fn(|i| Dual::variable(SIZES[i], i));
    let exact = read(&duals, input, &t_s);
    for (i, size) in SIZES.iter().enumerate() {
        let h = 1e-5 * size.abs();
        let moved =
            |h: f64| read(&std::array::from_fn::<_, 8, _>(|k| SIZES[k] + if k == i { h } else { 0.0 }), input, &t_s);
        let (up, down) = (moved(h), moved(-h));
        let scale = exact.iter().map(|x| x.eps[i].abs()).fold(0.0, f64::max);
        assert!(scale > 0.05, "value {i} acts: {scale}");
        for k in 0..t_s.len() {
            let error = (exact[k].eps[i] - (up[k] - down[k]) / (2.0 * h)).abs() / scale;
            assert!(error < 1e-3, "value {i} sample {k}: {error}");
        }
    }
}

#[test]
fn steps_are_short_enough_for_laws() {
    let t_s = times(250);
    let setpoint_rad = wave(&t_s);
    let input = Input::Position { setpoint_rad: &setpoint_rad, hold: Hold::Linear, on: None };
    let chain = many(&SIZES);
    let [coarse, fine] = [1.0, 8.0].map(|refinement| refined(&chain, input, &t_s, free(0.4), refinement));
    // Far below the step of the ERS-7's encoder.
    assert!(apart(&coarse, &fine) < 2e-5, "{}", apart(&coarse, &fine));
    let cogging = law(LawVariable::Angle, LawActs::Torque, &knots_rad(), |q| 0.05 * (24.0 * q).sin());
    let swinging = with(joint(), cogging);
    let [coarse, fine] = [1.0, 8.0].map(|refinement| refined(&swinging, Input::Off, &t_s, free(1.1), refinement));
    assert!(apart(&coarse, &fine) < 1e-4, "{}", apart(&coarse, &fine));
}

fn knots_rad() -> Vec<f64> {
    (0..=60).map(|k| f64::from(k) * 0.04 - 1.2).collect()
}
