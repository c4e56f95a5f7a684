use super::*;
use crate::joint::{Friction, Link, Motor, gradient, variable};
use crate::log::{Hold, MotorSpec};
use crate::pendulum::{Input, Start, State, rollout_refined};
use num_dual::DualSVec64;

fn reach() -> Reach {
    Reach {
        torque_nm: 0.5,
        coulomb_nm: 0.02,
        inertia_kg_m2: 0.011,
        speed_rad_s: 6.0,
        angle_rad: [-0.8, 0.9],
        duration_s: 4.0,
        resolution_rad: 0.0015,
        driven: Some(DrivenReach { command_nm: 3.0, speed_rad_s: 5.0, period_s: 0.005, by_setpoint: true }),
    }
}

/// The angles of a driven and of a free motion, with one effect at the values as searched.
fn angles(effect: Option<(EffectId, &[f64])>, driven: bool) -> Vec<f64> {
    match effect {
        Some((effect, values)) => motion(effect, values, driven, 1.0),
        None => motion(EffectId::AngleOffset, &[0.0], driven, 1.0),
    }
}

/// The readings with an effect at the values as searched.
fn motion<T: Real>(effect: EffectId, values: &[T], driven: bool, refinement: f64) -> Vec<T> {
    let t: Vec<f64> = (0..600).map(|k| f64::from(k) * 0.005).collect();
    let constant = T::constant;
    let setpoint: Vec<f64> = t.iter().map(|t| 0.5 * (4.0 * t).sin() + if *t > 1.5 { 0.3 } else { 0.0 }).collect();
    let motor = driven.then(|| Motor::new(MotorSpec::pd(5.0, 0.1)));
    let link = Link::new(constant(0.011), constant(0.05), constant(0.0), 9.81);
    let mut chain = Chain::new(link, Friction::coulomb_viscous(constant(0.02), constant(0.004)), motor);
    effect.apply(values, constant(0.011), &mut chain);
    let input =
        if driven { Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None } } else { Input::Off };
    let angle_rad = constant(if driven { 0.0 } else { 0.9 }) / chain.sensor_gain;
    let start = Start { angle_rad, rate_rad_s: constant(0.0), release_s: None };
    let mut q = Vec::new();
    let read = |_: usize, s: &State<T>| q.push(s.angle_rad * chain.sensor_gain);
    rollout_refined(&chain, input, &t, start, refinement, read).expect("does not diverge");
    q
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Values as searched at which each effect is absent.
fn absent(effect: EffectId) -> Vec<f64> {
    match effect {
        EffectId::Stribeck => vec![0.0, 0.3],
        EffectId::Backlash => vec![1e-9, 0.3],
        EffectId::JointSpring => vec![0.0, 0.3],
        EffectId::EndStop => vec![5.0, 1.0, 30.0, 0.1],
        EffectId::SpeedLimit => vec![1e4, 1e4],
        EffectId::TorqueLimit => vec![1e4],
        EffectId::MotorGain => vec![1.0],
        EffectId::PositionFriction => vec![0.0, 0.0],
        // A hold of one sampling period lets every setpoint through.
        EffectId::SetpointHold => vec![0.005],
        _ => vec![0.0],
    }
}

#[test]
fn at_its_zero_an_effect_is_absent_and_at_a_start_it_is_not() {
    let baseline = [angles(None, false), angles(None, true)];
    for &effect in EffectId::ALL {
        let zero = absent(effect);
        for driven in [false, true] {
            let off = largest_difference(&baseline[usize::from(driven)], &angles(Some((effect, &zero)), driven));
            assert!(off < 1e-5, "{effect}, driven {driven}: {off}");
        }
        let shows = effect.starts(&reach()).iter().any(|start| {
            [false, true].iter().any(|&driven| {
                largest_difference(&baseline[usize::from(driven)], &angles(Some((effect, start)), driven)) > 1e-3
            })
        });
        assert!(shows, "{effect} changes nothing at any of its starts");
    }
}

#[test]
fn starts_lie_inside_the_bounds_and_names_go_there_and_back() {
    for &effect in EffectId::ALL {
        let parameters = effect.parameters(&reach());
        for start in effect.starts(&reach()) {
            assert_eq!(start.len(), parameters.len(), "{effect}");
            for (value, p) in start.iter().zip(&parameters) {
                assert!(p.lower <= *value && *value <= p.upper, "{effect} {}: {value}", p.name);
            }
            let named = effect.named(&start, 0.02);
            assert_eq!(named.len(), effect.named_parameters().len(), "{effect}");
            assert!(largest_difference(&effect.searched(&named, 0.02), &start) < 1e-12, "{effect}");
        }
    }
}

#[test]
fn only_driven_logs_show_effects_of_the_drive() {
    let undriven = Reach { driven: None, ..reach() };
    for &effect in EffectId::ALL {
        assert_eq!(effect.starts(&undriven).is_empty(), effect.is_driven_only(), "{effect}");
    }
}

#[test]
fn a_delay_shifts_a_driven_motion_and_a_hold_makes_it_wait() {
    let now = angles(None, true);
    let late = angles(Some((EffectId::Delay, &[0.02])), true);
    // Four samples of 5 ms later, but for the start, where the setpoint stands still.
    assert!(largest_difference(&now[..596], &late[4..]) < 2e-3);
    let held = angles(Some((EffectId::SetpointHold, &[0.1])), true);
    assert!(largest_difference(&now, &held) > 0.02);
}

#[test]
fn the_step_is_short_enough_for_every_effect() {
    for &effect in EffectId::ALL {
        let start = &effect.starts(&reach())[0];
        for driven in [false, true] {
            let (coarse, fine) = (motion::<f64>(effect, start, driven, 1.0), motion::<f64>(effect, start, driven, 3.0));
            let worst = largest_difference(&coarse, &fine);
            assert!(worst < 1e-4, "{effect}, driven {driven}: {worst}");
        }
    }
}

/// Sensitivities through sticking, limits, play and stops: as dual numbers and as central differences.
#[test]
fn dual_numbers_agree_with_central_differences_for_every_effect() {
    for &effect in EffectId::ALL {
        let start = effect.starts(&reach()).swap_remove(1);
        let parameters = effect.parameters(&reach());
        for (k, p) in parameters.iter().enumerate() {
            // Which setpoints get through changes by leaps with the hold: only its instants are differentiated.
            if p.scan == Scan::Held || effect == EffectId::SetpointHold {
                continue;
            }
            for driven in [false, true] {
                let values: Vec<DualSVec64<1>> = start
                    .iter()
                    .enumerate()
                    .map(|(i, &v)| if i == k { variable(v, 0) } else { DualSVec64::from_re(v) })
                    .collect();
                let exact: Vec<f64> =
                    motion(effect, &values, driven, 1.0).iter().map(|q: &DualSVec64<1>| gradient(q)[0]).collect();
                let h = 1e-5 * start[k].abs().max(1e-3);
                let at = |v: f64| {
                    let mut other = start.clone();
                    other[k] = v;
                    motion::<f64>(effect, &other, driven, 1.0)
                };
                let (up, down) = (at(start[k] + h), at(start[k] - h));
                let size = exact.iter().fold(1e-6, |a: f64, b| a.max(b.abs()));
                let differ = |i: &usize| ((up[*i] - down[*i]) / (2.0 * h) - exact[*i]).abs() > 0.02 * size;
                let off = (0..exact.len()).filter(differ).count();
                assert!(off * 20 < exact.len(), "{effect} {} driven {driven}: {off} of {}", p.name, exact.len());
            }
        }
    }
}
