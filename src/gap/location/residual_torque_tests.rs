use super::*;
use crate::gap::location::made::{At, Extra, Joint, LEG, Made, SERVO, Swing, made};

/// How a reconstruction compares with the truth, over the samples with an answer.
struct Score {
    /// Correlation, about zero.
    correlation: f64,
    /// Shares of the samples at which two standard deviations reach the truth, and zero.
    covers: f64,
    covers_zero: f64,
    samples: usize,
}

fn score(joint: &Joint, swings: &[Swing]) -> Score {
    let (mut tt, mut te, mut ee) = (0.0, 0.0, 0.0);
    let (mut covers, mut zero, mut samples) = (0, 0, 0);
    for swing in swings {
        let m = made(joint, swing);
        let r = residual_torque(&m.chain, &m.experiment, m.start, m.noise_rad);
        assert_eq!(r.t_s.len(), m.experiment.compared());
        for (k, &truth) in m.extra_nm.iter().enumerate() {
            let (torque, band) = (r.torque_nm[k], 2.0 * r.sigma_nm[k]);
            if torque.is_nan() || matches!(r.phase[k], Phase::Stick | Phase::Hold) {
                continue;
            }
            samples += 1;
            covers += usize::from((torque - truth).abs() <= band);
            zero += usize::from(torque.abs() <= band);
            tt += torque * torque;
            te += torque * truth;
            ee += truth * truth;
        }
    }
    let share = |n: usize| n as f64 / samples as f64;
    Score { correlation: te / (tt * ee).sqrt(), covers: share(covers), covers_zero: share(zero), samples }
}

/// Six free swings with a sensor: its step \[rad\], noise \[rad\] and period \[s\].
fn swings([step, noise, period]: [f64; 3]) -> Vec<Swing> {
    [1.2, -0.9, 1.6, -1.4, 0.6, 1.0].map(|angle| Swing { step, noise, period, ..Swing::from(angle) }).to_vec()
}

/// Coarse, and fine.
const SENSORS: [[f64; 3]; 2] = [[0.006, 0.0, 0.008], [0.0004, 0.0, 0.002]];
/// With a read noise of a step either way, and between the two.
const OTHER_SENSORS: [[f64; 3]; 2] = [[0.006, 0.006, 0.008], [0.0015, 0.0, 0.005]];

#[test]
fn where_nothing_is_missing_the_band_reaches_zero() {
    for sensor in SENSORS.into_iter().chain(OTHER_SENSORS) {
        let mut many = swings(sensor);
        many.extend([0.5, -0.7, 0.8, -1.1, 1.3, -1.5].map(|angle| Swing { angle, seed: 7, ..many[0] }));
        let s = score(&LEG, &many);
        assert!(s.covers_zero > 0.93 && s.samples > 3000, "{sensor:?}: {} of {}", s.covers_zero, s.samples);
    }
}

#[test]
fn a_known_missing_torque_comes_back_with_a_band_that_holds_it() {
    let missing: [(&str, Extra); 5] = [
        ("weak drag", |at| -4e-5 * at.v * at.v.abs()),
        ("strong drag", |at| -4e-4 * at.v * at.v.abs()),
        ("spring", |at| -6e-3 * (at.q - 0.3)),
        ("constant", |_| 0.002),
        ("load friction", |at| if at.v == 0.0 { 0.0 } else { -0.05 * at.gravity.abs() * at.v.signum() }),
    ];
    for sensor in SENSORS.into_iter().chain(OTHER_SENSORS) {
        for (name, extra) in missing {
            let s = score(&Joint { extra, ..LEG }, &swings(sensor));
            // A kink as sharp as that of |sin q| is lost in a read noise of 5 mrad.
            let [correlation, covers] = if sensor[1] > 0.0 { [0.85, 0.6] } else { [0.94, 0.92] };
            let [ok, within] = [s.correlation > correlation, s.covers > covers];
            assert!(ok && within, "{name}, {sensor:?}: correlation {:.3}, covers {:.3}", s.correlation, s.covers);
            assert!(s.covers_zero < 0.75, "{name}, {sensor:?}: seen in only {:.2}", 1.0 - s.covers_zero);
        }
    }
}

#[test]
fn a_stiff_driven_joint_shows_what_its_model_lacks() {
    let motions: [fn(f64) -> f64; 3] =
        [|t| 0.6 * (5.0 * t).sin(), |t| 0.8 * (2.0 * t + 0.6 * t * t).sin(), |t| 0.4 * (7.0 * t).sin() + 0.3];
    let swings = motions.map(Swing::along);
    let nothing = score(&SERVO, &swings);
    assert!(nothing.covers_zero > 0.94, "{}", nothing.covers_zero);
    let drag = score(&Joint { extra: |at| -0.02 * at.v * at.v.abs(), ..SERVO }, &swings);
    assert!(drag.correlation > 0.97 && drag.covers > 0.92, "drag: {} {}", drag.correlation, drag.covers);
    let gain = score(&Joint { extra: |at| -0.15 * at.motor, ..SERVO }, &swings);
    assert!(gain.correlation > 0.9 && gain.covers > 0.85, "gain: {} {}", gain.correlation, gain.covers);
    let late = score(&Joint { delay: 0.015, ..SERVO }, &swings);
    assert!(late.correlation > 0.9, "delay: {}", late.correlation);
}

fn reconstructed(joint: &Joint, swing: &Swing) -> (Made, ResidualTorque) {
    let m = made(joint, swing);
    let r = residual_torque(&m.chain, &m.experiment, m.start, m.noise_rad);
    (m, r)
}

#[test]
fn speed_and_angle_are_the_true_ones_to_a_fraction_of_the_noise() {
    let (m, r) = reconstructed(&LEG, &Swing::from(1.2));
    let rms = |d: &mut dyn Iterator<Item = f64>| {
        let d: Vec<f64> = d.collect();
        (d.iter().map(|x| x * x).sum::<f64>() / d.len() as f64).sqrt()
    };
    let rate = rms(&mut r.rate_rad_s.iter().zip(&m.rate_rad_s).map(|(a, b)| a - b));
    assert!(rate < 0.05, "{rate} rad/s");
    let readings = &m.experiment.measured_rad[m.experiment.uncompared..];
    let angle = rms(&mut r.angle_rad.iter().zip(readings).map(|(a, b)| a - b));
    assert!((0.5..1.3).contains(&(angle / m.noise_rad)), "{angle} rad from the readings");
}

#[test]
fn a_stuck_joint_has_no_answer_and_a_held_one_is_not_asked() {
    let (_, r) = reconstructed(&LEG, &Swing { lasts: 5.0, ..Swing::from(1.2) });
    let stuck = r.phase.iter().zip(&r.torque_nm).filter(|(p, _)| **p == Phase::Stick);
    let (count, answers) = stuck.fold((0, 0), |(n, a), (_, torque)| (n + 1, a + usize::from(torque.is_finite())));
    assert!(count > 100 && answers == 0, "{count} {answers}");
    let moving = r.phase.iter().zip(&r.torque_nm).filter(|(p, _)| matches!(p, Phase::Run | Phase::Reversal));
    assert!(moving.clone().count() > 200 && moving.clone().all(|(_, torque)| torque.is_finite()));
    // A joint that is never let go.
    let m = made(&LEG, &Swing::from(1.2));
    let r = residual_torque(&m.chain, &m.experiment, Start { release_s: Some(1e3), ..m.start }, m.noise_rad);
    assert!(r.phase.iter().all(|p| *p == Phase::Hold) && r.torque_nm.iter().all(|t| t.is_nan()));
}

#[test]
fn a_joint_that_rests_where_the_model_would_move_shows_the_torque_that_holds_it() {
    // Friction of 0.006 N m at rest, 0.0015 N m in motion: the swing ends where the model would go on.
    let stribeck = |at: &At| {
        if at.v != 0.0 {
            return -0.0045 * (-(at.v / 0.3).powi(2)).exp() * at.v.signum();
        }
        // At rest the model's breakaway is in the joint already; the rest of it takes what is left of the torque.
        -at.gravity.signum() * (at.gravity.abs() - 0.0015).clamp(0.0, 0.0045)
    };
    let (m, r) = reconstructed(&Joint { extra: stribeck, ..LEG }, &Swing { lasts: 5.0, ..Swing::from(1.4) });
    let at = r.t_s.len() - 50;
    let lacks_nm = m.chain.link.gravity_nm(r.angle_rad[at]).abs() - 0.0015;
    assert!(lacks_nm > 0.001, "it came to rest within the model's breakaway: choose another start");
    assert_eq!(r.phase[at], Phase::Stick);
    assert!((r.torque_nm[at].abs() - lacks_nm).abs() < 2.0 * r.sigma_nm[at], "{} {lacks_nm}", r.torque_nm[at]);
    assert!(r.torque_nm[at] * m.chain.link.gravity_nm(r.angle_rad[at]) < 0.0, "it holds against gravity");
}

#[test]
fn phases_of_a_swing_of_a_clipped_motor_and_of_a_stop() {
    let (_, r) = reconstructed(&LEG, &Swing::from(1.6));
    let of = |r: &ResidualTorque, phase: Phase| r.phase.iter().filter(|p| **p == phase).count();
    assert!(of(&r, Phase::Reversal) > 50 && of(&r, Phase::Run) > 50);
    assert_eq!(of(&r, Phase::Saturation) + of(&r, Phase::Stop), 0);

    let clipped = Joint { extra: |at| at.motor.clamp(-0.9, 0.9) - at.motor, ..SERVO };
    let (m, r) = reconstructed(&clipped, &Swing::along(|t| 1.2 * (3.0 * t).sin()));
    let truly: Vec<bool> = m.extra_nm.iter().map(|x| x.abs() > 0.15).collect();
    let found = |k: usize| r.phase[k] == Phase::Saturation;
    let hits = (0..truly.len()).filter(|k| truly[*k] && found(*k)).count() as f64;
    let recall = hits / truly.iter().filter(|x| **x).count() as f64;
    let precision = hits / of(&r, Phase::Saturation) as f64;
    assert!(recall > 0.7 && precision > 0.7, "{recall} {precision}");

    let stop = Joint { extra: |at| if at.q > 0.5 { (-4.0 * (at.q - 0.5) - 0.01 * at.v).min(0.0) } else { 0.0 }, ..LEG };
    let (m, r) = reconstructed(&stop, &Swing::from(-1.3));
    let at_stop: Vec<usize> = (0..r.t_s.len()).filter(|k| r.phase[*k] == Phase::Stop).collect();
    assert!(!at_stop.is_empty(), "no stop seen");
    assert!(at_stop.iter().all(|k| r.angle_rad[*k] > 0.2), "stops only at that end");
    assert!(m.extra_nm.iter().any(|x| *x < -0.1));
}

#[test]
fn a_chain_with_effects_is_followed_and_then_nothing_is_missing() {
    // A late setpoint, and an encoder that reads too much: the chain that has them lacks nothing.
    let share_of_zero = |m: &Made| {
        let r = residual_torque(&m.chain, &m.experiment, m.start, m.noise_rad);
        let known: Vec<bool> = (0..r.t_s.len())
            .filter(|k| r.torque_nm[*k].is_finite())
            .map(|k| r.torque_nm[k].abs() <= 2.0 * r.sigma_nm[k])
            .collect();
        known.iter().filter(|inside| **inside).count() as f64 / known.len() as f64
    };
    let mut late = made(&Joint { delay: 0.012, ..SERVO }, &Swing::along(|t| 0.6 * (5.0 * t).sin()));
    assert!(share_of_zero(&late) < 0.5);
    late.chain.setpoint.delay_s = Some(0.012);
    assert!(share_of_zero(&late) > 0.9, "{}", share_of_zero(&late));

    let mut scaled = made(&LEG, &Swing { step: 0.0004, period: 0.002, ..Swing::from(1.4) });
    scaled.experiment.measured_rad.iter_mut().for_each(|q| *q *= 1.06);
    scaled.experiment.resolution_rad *= 1.06;
    scaled.noise_rad *= 1.06;
    assert!(share_of_zero(&scaled) < 0.5);
    scaled.chain.sensor_gain = 1.06;
    assert!(share_of_zero(&scaled) > 0.9, "{}", share_of_zero(&scaled));
}

#[test]
fn readings_without_a_motion_or_sense_give_no_panic() {
    let m = made(&LEG, &Swing::from(1.2));
    for measured in [vec![0.0; m.experiment.t_s.len()], vec![f64::NAN; m.experiment.t_s.len()]] {
        let e = Experiment { measured_rad: measured, ..m.experiment.clone() };
        let r = residual_torque(&m.chain, &e, m.start, 0.0);
        assert_eq!(r.torque_nm.len(), e.compared());
    }
}
