//! The integrator against closed forms, and every part of it against its own absence.

use super::*;
use crate::blind::plan::Extra;
use approx::assert_relative_eq;

const FINE_S: f64 = 2.5e-5;

fn free(start_rad: f64, until_s: f64) -> LogPlan {
    LogPlan {
        times_s: (0..=(until_s / 0.005).round() as usize).map(|k| k as f64 * 0.005).collect(),
        start_rad,
        start_rad_s: 0.0,
        start_share: 0.0,
        release_s: 0.0,
        drive_column: false,
        validate: false,
        load: None,
        changes: None,
    }
}

fn driven(until_s: f64) -> LogPlan {
    let changes = vec![(0.0, 0.0), (0.2, 0.5), (1.0, -0.3)];
    LogPlan { start_rad: 0.0, changes: Some(changes), ..free(0.0, until_s) }
}

/// Moment such that the joint swings at 7 rad/s.
fn swing(coulomb_nm: f64, viscous: f64) -> Machine {
    Machine::plain(0.01, 0.49, coulomb_nm, viscous)
}

#[test]
fn energy_is_kept_without_friction() {
    let machine = swing(0.0, 0.0);
    let trace = simulate(&machine, &free(2.0, 10.0), 0, FINE_S);
    // a turning point is as high as the start, after ten seconds of swinging
    let late = trace.q_rad[1500..].iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    assert_relative_eq!(late, 2.0, epsilon = 2e-4);
}

#[test]
fn small_swings_have_the_period_and_the_decay_of_the_textbook() {
    let (i, peak, viscous) = (0.01, 0.49, 0.02);
    let trace = simulate(&swing(0.0, viscous), &free(0.01, 3.0), 0, FINE_S);
    let decay = viscous / (2.0 * i);
    let w = (peak / i - decay * decay).sqrt();
    for (k, q) in trace.q_rad.iter().enumerate() {
        let t = k as f64 * 0.005;
        let exact = 0.01 * (-decay * t).exp() * ((w * t).cos() + decay / w * (w * t).sin());
        assert_relative_eq!(*q, exact, epsilon = 1e-6);
    }
}

#[test]
fn dry_friction_takes_the_same_angle_from_every_half_swing_and_then_holds() {
    let coulomb = 0.01;
    let trace = simulate(&swing(coulomb, 0.0), &free(0.2, 6.0), 0, FINE_S);
    // the first half swing ends where g M* (cos q1 - cos q0) = mu_c (q0 + q1): the height lost went into friction
    let turn = -trace.q_rad.iter().copied().fold(f64::INFINITY, f64::min);
    let (lost, rubbed) = (0.49 * (turn.cos() - 0.2_f64.cos()), coulomb * (0.2 + turn));
    assert_relative_eq!(lost, rubbed, max_relative = 1e-3);
    let end = &trace.q_rad[trace.q_rad.len() - 100..];
    assert!(end.iter().all(|q| *q == end[0]), "it sticks: {end:?}");
    assert!(0.49 * end[0].sin().abs() <= coulomb);
}

#[test]
fn finer_steps_change_nothing_that_a_sensor_sees() {
    let mut machine = swing(0.02, 0.01);
    machine.drive = Drive { kp: 3.0, kd: 0.1, ..Drive::default() };
    machine.friction.stribeck = Some(Stribeck { excess_nm: 0.02, speed_rad_s: 0.3, curve: Curve::Gaussian });
    for plan in [free(1.5, 4.0), driven(4.0)] {
        let traces = [FINE_S, 5e-6].map(|step| simulate(&machine, &plan, 0, step));
        for (a, b) in traces[0].q_rad.iter().zip(&traces[1].q_rad) {
            assert_relative_eq!(a, b, epsilon = 4e-5);
        }
    }
}

#[test]
fn held_joint_waits_and_an_extra_mass_slows_the_swing() {
    let mut plan = free(1.0, 2.0);
    plan.release_s = 0.4012;
    let trace = simulate(&swing(0.0, 0.0), &plan, 0, FINE_S);
    assert!(trace.q_rad[..=80].iter().all(|q| *q == 1.0) && trace.q_rad[90] < 1.0);
    let extra = Extra { mass_kg: 0.3, distance_m: 0.15, radius_m: 0.02, length_m: 0.03 };
    // M (R^2/2 + L^2/12) + M D^2
    assert_relative_eq!(extra.load().inertia_kg_m2, 0.3 * (2e-4 + 7.5e-5) + 0.3 * 0.0225, epsilon = 1e-15);
    assert_relative_eq!(extra.load().peak_gravity_nm, 9.81 * 0.045, epsilon = 1e-12);
}

#[test]
fn driven_joint_starts_at_rest_and_goes_where_it_is_sent() {
    let mut machine = swing(0.001, 0.01);
    machine.drive = Drive { kp: 5.0, kd: 0.2, ..Drive::default() };
    let trace = simulate(&machine, &driven(3.0), 0, FINE_S);
    assert!(trace.q_rad[..=40].iter().all(|q| q.abs() < 1e-4));
    let (end, sag) = (trace.q_rad[trace.q_rad.len() - 1], 0.49 * 0.29_f64.sin() / 5.0);
    assert_relative_eq!(end, -0.3 + sag, epsilon = 2e-3);
    // the command of a sample already sees the sample's setpoint
    assert_relative_eq!(trace.tau_nm[40], 5.0 * 0.5, epsilon = 1e-3);
}

#[test]
fn two_bodies_without_play_or_with_a_stiff_spring_move_as_one() {
    for stiffness in [f64::INFINITY, 0.2 * 0.01 * 500.0_f64.powi(2)] {
        for plan in [free(1.2, 3.0), driven(3.0)] {
            let mut one = swing(0.02, 0.01);
            one.drive = Drive { kp: 3.0, kd: 0.1, ..Drive::default() };
            let mut two = one.clone();
            two.coupling = Some(Coupling {
                rotor: 0.3,
                friction: 1.0,
                play_rad: 0.0,
                stiffness,
                damping: 1e-3 * stiffness.min(1e6),
                spring: stiffness.is_finite(),
            });
            let (a, b) = (simulate(&one, &plan, 0, FINE_S), simulate(&two, &plan, 0, FINE_S));
            for (a, b) in a.q_rad.iter().zip(&b.q_rad) {
                assert_relative_eq!(a, b, epsilon = 1.5e-3);
            }
        }
    }
}

#[test]
fn link_in_a_play_falls_freely_until_it_meets_a_flank() {
    let mut machine = swing(0.05, 0.0);
    let coupling =
        Coupling { rotor: 0.3, friction: 1.0, play_rad: 0.1, stiffness: f64::INFINITY, damping: 0.0, spring: false };
    machine.coupling = Some(coupling);
    let trace = simulate(&machine, &free(1.0, 8.0), 0, FINE_S);
    // the motor side rests where friction holds it; the link hangs within the play, at the bottom or on a flank
    let end = trace.q_rad[trace.q_rad.len() - 1];
    assert!(end.abs() < (0.05_f64 / 0.49).asin() + 0.1, "{end}");
    let rigid = simulate(&swing(0.05, 0.0), &free(1.0, 8.0), 0, FINE_S);
    let most = trace.q_rad.iter().zip(&rigid.q_rad).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most > 0.02, "{most}");
}
