//! Motors fed by voltage, inertia before the gears, encoders on either side of them.

use super::{Input, Start, State, readings, rollout};
use crate::joint::{Carriage, Carried, Chain, Friction, Link, Motor, Play};
use crate::log::{EncoderSide, Hold, MotorModel, MotorSpec, VoltageMotor};

fn times(n: usize, period_s: f64) -> Vec<f64> {
    (0..n).map(|k| k as f64 * period_s).collect()
}

fn free(angle_rad: f64) -> Start<f64> {
    Start { angle_rad, rate_rad_s: 0.0, release_s: None }
}

fn states(chain: &Chain<f64>, input: Input<'_>, t_s: &[f64], start: Start<f64>) -> Vec<State<f64>> {
    let mut path = Vec::new();
    rollout(chain, input, t_s, start, |_, s| path.push(*s)).expect("does not diverge");
    path
}

fn read(chain: &Chain<f64>, input: Input<'_>, t_s: &[f64], start: Start<f64>) -> Vec<f64> {
    let mut q = Vec::new();
    readings(chain, input, t_s, start, 1.0, |_, s| q.push(s.angle_rad)).expect("does not diverge");
    q
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Full duty runs up to the speed at which the back-EMF is the supply's, with the time constant `I R / kt^2`; with the
/// motor off the circuit is open, and nothing brakes.
#[test]
fn a_motor_fed_by_voltage_runs_up_and_coasts() {
    let (inertia, kt, resistance, supply, duty) = (0.05, 1.2, 4.0, 10.0, 0.8);
    let model = MotorModel::Voltage(VoltageMotor {
        kt_nm_a: kt,
        resistance_ohm: resistance,
        supply_v: supply,
        duty_limit: duty,
    });
    for sample_period_s in [None, Some(0.01)] {
        let spec = MotorSpec { model, sample_period_s, ..MotorSpec::pd(1.0, 0.0) };
        let link = Link::new(inertia, 0.0, 0.0, 9.81);
        let c = Chain::new(link, Friction::coulomb_viscous(0.0, 0.0), Some(Motor::new(spec)));
        let t = times(300, 0.005);
        // A setpoint so far away that the duty is at its limit.
        let setpoint = vec![1e3; t.len()];
        let on: Vec<bool> = t.iter().map(|t| *t < 0.9995).collect();
        let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: Some(&on) };
        let path = states(&c, input, &t, free(0.0));
        let (final_rad_s, tau_s) = (duty * supply / kt, inertia * resistance / (kt * kt));
        for (t, s) in t.iter().zip(&path).take(201) {
            let rate = final_rad_s * (1.0 - (-t / tau_s).exp());
            let angle = final_rad_s * t - tau_s * rate;
            assert!((s.rate_rad_s - rate).abs() < 1e-5, "{sample_period_s:?} {t}: {} {rate}", s.rate_rad_s);
            assert!((s.angle_rad - angle).abs() < 1e-5, "{sample_period_s:?} {t}: {} {angle}", s.angle_rad);
        }
        assert!((path[299].rate_rad_s - path[200].rate_rad_s).abs() < 1e-12, "an open circuit does not brake");
    }
}

#[test]
fn a_sampled_law_sees_the_setpoint_of_its_tick_wherever_the_clock_begins() {
    let spec = MotorSpec { sample_period_s: Some(0.008), ..MotorSpec::pd(5.0, 0.1) };
    let joint =
        Chain::new(Link::new(0.02, 0.05, 0.0, 9.81), Friction::coulomb_viscous(0.01, 0.02), Some(Motor::new(spec)));
    let t = times(250, 0.008);
    let setpoint: Vec<f64> = t.iter().map(|t| 0.5 * (6.0 * t).sin()).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None };
    let angles = |from_s: f64| -> Vec<f64> {
        let t_s: Vec<f64> = t.iter().map(|t| from_s + t).collect();
        states(&joint, input, &t_s, free(0.0)).iter().map(|s| s.angle_rad).collect()
    };
    let plain = angles(0.0);
    for from_s in [5.0, 12.34, 0.176] {
        assert!(largest_difference(&plain, &angles(from_s)) < 1e-6, "{from_s}");
    }
}

/// Whatever the rounding of their quotient, a tick that has come is over.
#[test]
fn samples_a_nanosecond_before_their_ticks_do_not_hold_up_the_clock() {
    for period_s in [0.003, 0.0053, 0.008] {
        let spec = MotorSpec { sample_period_s: Some(period_s), ..MotorSpec::pd(5.0, 0.1) };
        let friction = Friction::coulomb_viscous(0.01, 0.02);
        let joint = Chain::new(Link::new(0.02, 0.05, 0.0, 9.81), friction, Some(Motor::new(spec)));
        let t_s: Vec<f64> = (0..500).map(|k| if k > 0 { k as f64 * period_s - 1e-9 } else { 0.0 }).collect();
        let setpoint = vec![0.3; t_s.len()];
        let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None };
        assert_eq!(states(&joint, input, &t_s, free(0.0)).len(), t_s.len());
    }
}

#[test]
fn a_sampled_law_adds_nothing_to_its_integral_while_the_motor_is_off() {
    let spec = MotorSpec { sample_period_s: Some(0.008), ki_nm_rad_s: 2.0, ..MotorSpec::pd(1.0, 0.1) };
    let joint =
        Chain::new(Link::new(0.02, 0.0, 0.0, 9.81), Friction::coulomb_viscous(0.05, 0.1), Some(Motor::new(spec)));
    let t = times(400, 0.008);
    let setpoint = vec![0.3; t.len()];
    let on: Vec<bool> = (0..t.len()).map(|k| k > 370).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: Some(&on) };
    let path = states(&joint, input, &t, free(0.0));
    // At once 0.3 N m, as of the proportional share alone; with 3 s of the error in its integral it would be 2 N m.
    assert!(path.iter().all(|s| s.rate_rad_s < 2.0), "{}", path[375].rate_rad_s);
    assert!(path[385].angle_rad > 0.0);
}

#[test]
fn the_armature_turns_with_the_joint_whether_the_motor_is_on_or_off() {
    let t = times(400, 0.005);
    let setpoint: Vec<f64> = t.iter().map(|t| 0.4 * (5.0 * t).sin()).collect();
    for on in [false, true] {
        let spec = MotorSpec { armature_kg_m2: 0.004, ..MotorSpec::pd(3.0, 0.05) };
        let input = match on {
            false => Input::Off,
            true => Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None },
        };
        let joint = |inertia: f64| {
            let friction = Friction::coulomb_viscous(0.01, 0.004);
            Chain::new(Link::new(inertia, 0.05, 0.0, 9.81), friction, on.then(|| Motor::new(spec)))
        };
        let angles = |c: &Chain<f64>| read(c, input, &t, free(0.5));
        let geared = angles(&joint(0.011).geared(Some(&spec)));
        assert!(largest_difference(&geared, &angles(&joint(0.015))) < 1e-12);
        assert!(largest_difference(&geared, &angles(&joint(0.011))) > 1e-2);
    }
}

#[test]
fn behind_play_the_armature_is_on_the_motor_side() {
    let t = times(400, 0.005);
    let path = |armature: f64, rotor: f64| {
        let mut c =
            Chain::new(Link::new(0.015 - armature, 0.05, 0.0, 9.81), Friction::coulomb_viscous(0.01, 0.004), None);
        c.armature_kg_m2 = armature;
        c.play = Some(Play { width_rad: 0.05, motor_side_kg_m2: rotor });
        read(&c, Input::Off, &t, free(0.5))
    };
    assert!(largest_difference(&path(0.004, 0.002), &path(0.0, 0.006)) < 1e-12);
    assert!(largest_difference(&path(0.004, 0.002), &path(0.0, 0.002)) > 1e-4);
}

/// Folded, a joint carries less than its rotor has of what it carries in the mean: the link is left with some of that.
#[test]
fn play_of_no_width_is_no_play_while_other_joints_fold() {
    let t = times(400, 0.01);
    let folding = |t: &f64| Carried { inertia: 0.6 + 0.45 * (2.0 * t).cos(), ..Carried::NOMINAL };
    let setpoint: Vec<f64> = t.iter().map(|t| 0.4 * (5.0 * t).sin()).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Linear, on: None };
    let motor = Some(Motor::new(MotorSpec::pd(3.0, 0.05)));
    let mut c = Chain::new(Link::new(0.02, 0.05, 0.3, 9.81), Friction::coulomb_viscous(0.01, 0.02), motor);
    c.armature_kg_m2 = 0.001;
    c.carriage = Carriage::new(&t, &t.iter().map(folding).collect::<Vec<_>>());
    let stiff = read(&c, input, &t, free(0.0));
    let loose = |width_rad: f64, c: &mut Chain<f64>| {
        c.play = Some(Play { width_rad, motor_side_kg_m2: 0.007 });
        read(c, input, &t, free(0.0))
    };
    assert!(largest_difference(&stiff, &loose(1e-5, &mut c)) < 1e-4);
    assert!(largest_difference(&stiff, &loose(0.1, &mut c)) > 1e-2);
}

#[test]
fn an_encoder_on_the_motor_reads_another_flank() {
    let t = times(600, 0.005);
    let setpoint: Vec<f64> = t.iter().map(|t| 0.4 * (5.0 * t).sin()).collect();
    let input = Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None };
    let spec = MotorSpec::pd(3.0, 0.05);
    let joint = |encoder: EncoderSide, width_rad: f64| {
        let link = Link::new(0.011, 0.05, 0.3, 9.81);
        let motor = Some(Motor::new(spec));
        let mut c = Chain::new(link, Friction::coulomb_viscous(0.01, 0.004), motor)
            .geared(Some(&MotorSpec { encoder, ..spec }));
        if width_rad > 0.0 {
            c.play = Some(Play { width_rad, motor_side_kg_m2: 0.004 });
        }
        c
    };
    let plain = |encoder| read(&joint(encoder, 0.0), input, &t, free(0.0));
    assert_eq!(plain(EncoderSide::Link), plain(EncoderSide::Motor), "without play there is one angle");
    let width = 0.06;
    let c = joint(EncoderSide::Motor, width);
    let q = read(&c, input, &t, free(0.0));
    let link: Vec<f64> = states(&c, input, &t, free(0.0)).iter().map(|s| s.angle_rad).collect();
    let apart: Vec<f64> = link.iter().zip(&q).map(|(link, q)| link - q).collect();
    assert!(apart.iter().all(|d| d.abs() < 0.5 * width + 1e-9));
    assert!(apart.iter().any(|d| *d > 0.45 * width) && apart.iter().any(|d| *d < -0.45 * width));
    // The controller holds what it sees: the motor side follows as it would with the encoder there, and not the link.
    let on_link = read(&joint(EncoderSide::Link, width), input, &t, free(0.0));
    assert!(largest_difference(&q, &on_link) > 0.3 * width);
}
