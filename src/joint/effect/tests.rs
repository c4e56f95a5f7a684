use super::*;
use crate::joint::{Dual, Friction, Link, Motor};
use crate::log::{Hold, MotorSpec};
use crate::pendulum::{Input, Start, State, readings, rollout};
use proptest::prelude::*;

fn reach() -> Reach {
    Reach {
        torque_nm: 0.5,
        coulomb_nm: 0.02,
        inertia_kg_m2: 0.011,
        speed_rad_s: 6.0,
        angle_rad: [-0.8, 0.9],
        duration_s: 4.0,
        resolution_rad: 0.0015,
        driven: Some(DrivenReach {
            command_nm: 3.0,
            speed_rad_s: 5.0,
            period_s: 0.005,
            by_setpoint: true,
            by_derivative: false,
            by_integral: false,
        }),
    }
}

/// The angles of a driven and of a free motion, with one effect at the values as searched.
fn angles(effect: Option<(EffectForm, &[f64])>, driven: bool) -> Vec<f64> {
    match effect {
        Some((effect, values)) => motion(effect, values, driven, 1.0),
        None => motion(EffectId::AngleOffset, &[0.0], driven, 1.0),
    }
}

/// The readings with an effect at the values as searched.
fn motion<T: Real>(effect: impl Into<EffectForm>, values: &[T], driven: bool, refinement: f64) -> Vec<T> {
    let t: Vec<f64> = (0..600).map(|k| f64::from(k) * 0.005).collect();
    let constant = T::constant;
    let setpoint: Vec<f64> = t.iter().map(|t| 0.5 * (4.0 * t).sin() + if *t > 1.5 { 0.3 } else { 0.0 }).collect();
    let motor = driven.then(|| Motor::new(MotorSpec::pd(5.0, 0.1)));
    let link = Link::new(constant(0.011), constant(0.05), constant(0.0), 9.81);
    let mut chain = Chain::new(link, Friction::coulomb_viscous(constant(0.02), constant(0.004)), motor);
    let effect = effect.into();
    effect.apply(values, constant(0.011), &mut chain);
    let input =
        if driven { Input::Position { setpoint_rad: &setpoint, hold: Hold::Step, on: None } } else { Input::Off };
    let angle_rad = constant(if driven { 0.0 } else { 0.9 });
    let start = Start { angle_rad, rate_rad_s: constant(0.0), release_s: None };
    let mut q = Vec::new();
    let read = |_: usize, s: &State<T>| q.push(s.angle_rad);
    readings(&chain, input, &t, start, refinement, read).unwrap_or_else(|e| panic!("{effect}, driven {driven}: {e}"));
    q
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Values as searched at which each effect is absent.
fn absent(effect: EffectForm) -> Vec<f64> {
    match (effect.id, effect.name()) {
        (EffectId::Stribeck, _) => vec![0.0, 0.3],
        (EffectId::GearFriction, "falling" | "progressive") => vec![0.0, 0.3],
        (EffectId::GearFriction, "rising") => vec![0.0, 0.3, 0.3],
        (EffectId::Backlash, _) => vec![1e-9, 0.3],
        (EffectId::JointSpring, "stiffening") => vec![0.0, 0.3, 1.0],
        (EffectId::JointSpring, "one_sided") => vec![0.0, 0.3, 1.0],
        (EffectId::JointSpring, _) => vec![0.0, 0.3],
        (EffectId::EndStop, _) => vec![5.0, 1.0, 30.0, 0.1],
        (EffectId::SpeedLimit, "voltage") => vec![1e10, 1e4],
        (EffectId::SpeedLimit, _) => vec![1e4, 1e4],
        (EffectId::TorqueLimit, _) => vec![1e4],
        (EffectId::QuadraticDrag, "power") => vec![0.0, 1.7],
        (EffectId::FrictionDrift, "saturating") => vec![0.0, 1.0],
        (EffectId::SensorGain, "eccentric") => vec![0.0, 0.0],
        (EffectId::Compliance, _) => vec![1e9, 0.0],
        (EffectId::SetpointProfile, _) => vec![1e6, 1e12],
        (EffectId::MotorGain, _) => vec![1.0],
        (EffectId::PositionFriction, _) => vec![0.0, 0.0],
        // A hold of one sampling period lets every setpoint through.
        (EffectId::SetpointHold, _) => vec![0.005],
        _ => vec![0.0],
    }
}

#[test]
fn at_its_zero_an_effect_is_absent_and_at_a_start_it_is_not() {
    let baseline = [angles(None, false), angles(None, true)];
    for effect in EffectId::ALL.iter().flat_map(|id| id.forms()) {
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
    for effect in EffectId::ALL.iter().flat_map(|id| id.forms()) {
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
    for effect in EffectId::ALL.iter().flat_map(|id| id.forms()) {
        assert_eq!(effect.starts(&undriven).is_empty(), effect.id.is_driven_only(), "{effect}");
    }
}

#[test]
fn a_delay_shifts_a_driven_motion_and_a_hold_makes_it_wait() {
    let now = angles(None, true);
    let late = angles(Some((EffectId::Delay.into(), &[0.02])), true);
    // Four samples of 5 ms later, but for the start, where the setpoint stands still.
    assert!(largest_difference(&now[..596], &late[4..]) < 2e-3);
    let held = angles(Some((EffectId::SetpointHold.into(), &[0.1])), true);
    assert!(largest_difference(&now, &held) > 0.02);
}

#[test]
fn the_step_is_short_enough_for_every_effect() {
    for effect in EffectId::ALL.iter().flat_map(|id| id.forms()) {
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
    for effect in EffectId::ALL.iter().flat_map(|id| id.forms()) {
        let start = effect.starts(&reach()).swap_remove(1);
        let parameters = effect.parameters(&reach());
        for (k, p) in parameters.iter().enumerate() {
            // Which setpoints get through changes by leaps with the hold: only its instants are differentiated.
            if p.scan == Scan::Held || effect.id == EffectId::SetpointHold {
                continue;
            }
            for driven in [false, true] {
                let values: Vec<Dual<1>> = start
                    .iter()
                    .enumerate()
                    .map(|(i, &v)| if i == k { Dual::variable(v, 0) } else { Dual::constant(v) })
                    .collect();
                let exact: Vec<f64> = motion(effect, &values, driven, 1.0).iter().map(|q: &Dual<1>| q.eps[0]).collect();
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

#[test]
fn forms_have_names_that_lead_back_to_them() {
    for &id in EffectId::ALL {
        let forms: Vec<EffectForm> = id.forms().collect();
        assert_eq!(forms[0], EffectForm::from(id));
        for &form in &forms {
            assert_eq!(form.to_string().parse(), Ok(form));
            assert_eq!(form.name().is_empty(), forms.len() == 1, "{form}");
        }
        assert_eq!(id.id().parse(), Ok(forms[0]));
    }
    let error = "stribeck:tanh".parse::<EffectForm>().unwrap_err().to_string();
    assert!(error.contains("`stribeck:tanh`") && error.contains("stribeck:exponential"), "{error}");
}

#[test]
fn a_form_starts_within_its_bounds_and_near_what_the_default_form_does() {
    for &id in EffectId::ALL {
        for form in id.forms() {
            for start in id.starts(&reach()) {
                let own = form.from_other(&start, &reach());
                let parameters = form.parameters(&reach());
                assert_eq!(own.len(), parameters.len(), "{form}");
                for (value, p) in own.iter().zip(&parameters) {
                    assert!(p.lower <= *value && *value <= p.upper, "{form} {}: {value}", p.name);
                }
            }
        }
    }
    let same = [("quadratic_drag:power", 1e-6), ("friction_drift:saturating", 0.1), ("joint_spring:stiffening", 0.1)];
    for (form, within) in same {
        let form: EffectForm = form.parse().unwrap();
        let start = form.id.starts(&reach()).swap_remove(0);
        let default = motion::<f64>(form.id, &start, false, 1.0);
        let own = motion::<f64>(form, &form.from_other(&start, &reach()), false, 1.0);
        let moved = largest_difference(&default, &angles(None, false));
        assert!(largest_difference(&default, &own) <= within * moved.max(1e-3) + 1e-9, "{form}");
    }
}

/// What the springs and weights of a joint hold between two angles \[J\], by Simpson's rule; stops at rest. Its parts are
/// short enough for the kink where a stiff stop begins, which a joint may pass in one sample at a thousand rad/s.
fn stored_j(chain: &Chain<f64>, from_rad: f64, to_rad: f64) -> f64 {
    const SHORT_RAD: f64 = 0.01;
    let parts = ((to_rad - from_rad).abs() / SHORT_RAD).ceil().max(16.0) as usize;
    let width = (to_rad - from_rad) / parts as f64;
    let torque_nm = |k: f64| chain.passive_nm(from_rad + k * width, 0.0);
    let part = |k: usize| torque_nm(k as f64) + 4.0 * torque_nm(k as f64 + 0.5) + torque_nm(k as f64 + 1.0);
    -(0..parts).map(part).sum::<f64>() * width / 6.0
}

proptest! {
    /// A joint that nothing drives never gains energy, whatever is wrong with it and however much of that.
    #[test]
    fn energy_never_grows_without_drive_with_any_effect(
        (angle_rad, rate_rad_s) in (-1.5..1.5f64, -5.0..5.0f64),
        at in prop::collection::vec(0.0..1.0f64, 6),
        coulomb_nm in 0.0..0.05f64,
        viscous_nm_s_rad in 0.0..0.01f64,
    ) {
        let t: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.005).collect();
        for effect in EffectId::ALL.iter().flat_map(|id| id.forms()) {
            let starts = effect.starts(&reach());
            let start = &starts[(at[5] * starts.len() as f64) as usize];
            let value = |((p, at), start): ((&EffectParameter, &f64), &f64)| match p.scan {
                Scan::Logarithm => p.lower * (p.upper / p.lower).powf(*at),
                Scan::Linear(_) => p.lower + at * (p.upper - p.lower),
                Scan::Held => *start,
            };
            let values: Vec<f64> = effect.parameters(&reach()).iter().zip(&at).zip(start).map(value).collect();
            let friction = Friction::coulomb_viscous(coulomb_nm, viscous_nm_s_rad);
            let mut chain = Chain::new(Link::new(0.011, 0.05, 0.0, 9.81), friction, None);
            effect.apply(&values, 0.011, &mut chain);
            // Where something gives between motor and link, only the link is seen: it may get back what the other side took,
            // and what the spring between them held under gravity.
            let sides = chain.two_sides();
            let spring = sides.and_then(|sides| sides.compliance).map_or(0.0, |spring| {
                chain.link.peak_gravity_nm().powi(2) / spring.stiffness_nm_rad
            });
            let seen_kg_m2 = chain.inertia_kg_m2() - sides.map_or(0.0, |sides| sides.motor_side_kg_m2);
            let mut allowed_j = 0.5 * chain.inertia_kg_m2() * rate_rad_s * rate_rad_s + spring;
            let unit_j = allowed_j + 2.0 * chain.link.peak_gravity_nm() + stored_j(&chain, 0.0, angle_rad).abs();
            let start = Start { angle_rad, rate_rad_s, release_s: None };
            let (mut held_j, mut before_rad, mut grown) = (0.0, None, None);
            let followed = rollout(&chain, Input::Off, &t, start, |k, s| {
                held_j += stored_j(&chain, before_rad.unwrap_or(s.angle_rad), s.angle_rad);
                before_rad = Some(s.angle_rad);
                let energy_j = held_j + 0.5 * seen_kg_m2 * s.rate_rad_s * s.rate_rad_s;
                if energy_j > allowed_j + 1e-4 * unit_j {
                    grown.get_or_insert((k, energy_j, allowed_j));
                }
                if sides.is_none() {
                    allowed_j = allowed_j.min(energy_j);
                }
            });
            // What starts deep in a stop that gives way slowly takes more steps than any log needs, and is refused.
            prop_assert!(followed.is_ok() || chain.stop.is_some(), "{effect} {values:?}: {followed:?}");
            prop_assert!(grown.is_none(), "{effect} {values:?}: {grown:?} of {unit_j} J");
        }
    }
}
