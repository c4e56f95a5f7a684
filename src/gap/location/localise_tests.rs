use super::*;
use crate::gap::Variable;
use crate::gap::location::made::{Extra, Joint, LEG, SERVO, Swing, as_given, recalibrated};
use crate::joint::Stage;

/// Coarse, and fine with noise: step, noise \[rad\] and period \[s\].
const SENSORS: [[f64; 3]; 2] = [[0.006, 0.0, 0.008], [0.0015, 0.0015, 0.005]];

fn with(sensor: [f64; 3], swings: &[Swing]) -> Vec<Swing> {
    let [step, noise, period] = sensor;
    swings.iter().enumerate().map(|(i, s)| Swing { step, noise, period, seed: 100 + i as u64, ..*s }).collect()
}

fn free() -> Vec<Swing> {
    [1.2, -0.9, 1.6, -1.4, 0.6, 1.0].map(Swing::from).to_vec()
}

fn loaded() -> Vec<Swing> {
    let masses = [None, Some((0.05, 0.1)), Some((0.1, 0.1)), Some((0.05, 0.1)), Some((0.1, 0.1)), None];
    free().iter().zip(masses).map(|(s, mass)| Swing { mass, ..*s }).collect()
}

fn driven() -> Vec<Swing> {
    let motions: [fn(f64) -> f64; 3] =
        [|t| 0.6 * (5.0 * t).sin(), |t| 0.8 * (2.0 * t + 0.6 * t * t).sin(), |t| 0.4 * (7.0 * t).sin() + 0.3];
    motions.map(Swing::along).to_vec()
}

fn mixed() -> Vec<Swing> {
    [driven(), free()[..3].to_vec()].concat()
}

fn leg(extra: Extra) -> Joint {
    Joint { extra, ..LEG }
}

fn servo(extra: Extra) -> Joint {
    Joint { extra, ..SERVO }
}

/// Sign of the speed; friction of a joint at rest is the maker's business.
fn sign(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

fn name(w: &Where) -> String {
    format!("{:?} {:?} at {:?} share {:.2} of {:?}", w.stage, w.variable, w.range, w.share, w.variables)
}

#[test]
fn where_nothing_is_missing_nothing_is_named() {
    for sensor in SENSORS {
        for (joint, swings) in [(LEG, free()), (LEG, loaded()), (SERVO, driven()), (SERVO, mixed())] {
            let w = localise(&recalibrated(&joint, &with(sensor, &swings)));
            assert!(w.stage.is_none() && w.variable.is_none() && w.phase.is_none(), "{sensor:?}: {}", name(&w));
            assert!(w.logs.is_empty() && w.share == 0.0 && w.profile.is_empty());
            assert!(w.cells.iter().all(|c| c.share == 0.0) && !w.cells.is_empty());
            let alarms = w.cells.iter().filter(|c| c.significant).count();
            assert!(alarms == 0, "{sensor:?}: {alarms} of {} cells", w.cells.len());
        }
    }
}

#[test]
fn wrong_numbers_are_found_where_they_act_before_they_are_refitted() {
    // Viscous friction that the model has at half its size.
    let w = localise(&as_given(&leg(|at| -0.0012 * at.v), &with(SENSORS[0], &free())));
    assert_eq!((w.variable, w.stage), (Some(Variable::Speed), Some(Stage::Link)), "{}", name(&w));
    // And the refit closes it.
    let w = localise(&recalibrated(&leg(|at| -0.0012 * at.v), &with(SENSORS[0], &free())));
    assert_eq!(w.variable, None, "{}", name(&w));
}

#[test]
fn the_variable_of_a_refitted_model_is_the_one_that_the_missing_torque_depends_on() {
    let cases: [(&str, Joint, Vec<Swing>, Variable, Stage); 9] = [
        ("drag", leg(|at| -1e-4 * at.v * at.v.abs()), free(), Variable::Speed, Stage::Link),
        ("offset", leg(|at| -0.06 * ((at.q + 0.06).sin() - at.q.sin())), free(), Variable::Angle, Stage::Link),
        ("constant", leg(|at| -0.0007 * sign(at.v).abs()), free(), Variable::Direction, Stage::Link),
        ("load friction", leg(|at| -0.1 * at.gravity.abs() * sign(at.v)), loaded(), Variable::Load, Stage::Link),
        (
            "stribeck",
            leg(|at| -0.004 * (-(at.v / 0.6).powi(2)).exp() * sign(at.v)),
            free(),
            Variable::Speed,
            Stage::Link,
        ),
        ("position friction", leg(|at| -0.001 * (at.q - 0.7).cos() * sign(at.v)), free(), Variable::Angle, Stage::Link),
        (
            "drift",
            leg(|at| -0.4 * at.t * (0.0015 + 0.0012 * at.v.abs()) * sign(at.v)),
            free(),
            Variable::Time,
            Stage::Link,
        ),
        ("delay", Joint { delay: 0.012, ..SERVO }, mixed(), Variable::SetpointRate, Stage::Delay),
        ("gear friction", servo(|at| -0.15 * at.motor.abs() * sign(at.v)), mixed(), Variable::Torque, Stage::Gearing),
    ];
    // One sensor each: a refit is what takes the time.
    for (i, (effect, joint, swings, variable, stage)) in cases.into_iter().enumerate() {
        let sensor = SENSORS[i % 2];
        let w = localise(&recalibrated(&joint, &with(sensor, &swings)));
        assert_eq!((w.variable, w.stage), (Some(variable), Some(stage)), "{effect}, {sensor:?}: {}", name(&w));
        let shares: f64 = w.cells.iter().map(|c| c.share).sum();
        assert!((shares - 1.0).abs() < 1e-9 && w.share > 0.2 && w.share <= 1.0, "{effect}: {shares}");
        assert!(w.cells.iter().any(|c| c.significant), "{effect}, {sensor:?}");
    }
}

#[test]
fn the_range_is_where_the_torque_is() {
    let at = |extra: Extra, swings: Vec<Swing>| localise(&as_given(&leg(extra), &with(SENSORS[1], &swings)));
    let top = |w: &Where| w.profile.last().map_or(0.0, |b| b.at);

    let drag = at(|at| -2e-4 * at.v * at.v.abs(), free());
    let [low, high] = drag.range.unwrap();
    assert_eq!(drag.variable, Some(Variable::Speed), "{}", name(&drag));
    assert!(low > 0.4 * high && high > top(&drag) && drag.share > 0.6, "{}", name(&drag));

    let stribeck = at(|at| -0.004 * (-(at.v / 0.6).powi(2)).exp() * sign(at.v), free());
    let [low, high] = stribeck.range.unwrap();
    assert!(stribeck.variable == Some(Variable::Speed) && low < 0.2 && high < 1.0, "{}", name(&stribeck));

    let spring = at(|at| if at.q > 0.3 { -0.02 * (at.q - 0.3) } else { 0.0 }, free());
    let [low, high] = spring.range.unwrap();
    assert!(spring.variable == Some(Variable::Angle) && low > 0.3 && high > 0.9, "{}", name(&spring));
}

#[test]
fn the_profile_follows_the_missing_torque_with_bands_that_hold_it() {
    // Friction of 0.1 times the load that the model does not have, against the motion.
    let w = localise(&as_given(&leg(|at| -0.1 * at.gravity.abs() * sign(at.v)), &with(SENSORS[0], &loaded())));
    assert_eq!(w.variable, Some(Variable::Load), "{}", name(&w));
    let inside = |b: &crate::gap::ProfileBin| b.band_nm[0] <= 0.1 * b.at && 0.1 * b.at <= b.band_nm[1];
    let held = w.profile.iter().filter(|b| inside(b)).count();
    assert!(w.profile.len() == 10 && held >= 8, "{held} of {:?}", w.profile);
    let last = w.profile.last().unwrap();
    assert!((last.torque_nm / (0.1 * last.at) - 1.0).abs() < 0.2, "{last:?}");
}

#[test]
fn a_late_setpoint_shows_in_driven_logs_alone() {
    let swings = with(SENSORS[1], &mixed());
    let parts = as_given(&Joint { delay: 0.012, ..SERVO }, &swings);
    let w = localise(&parts);
    let driven: Vec<&str> = parts.iter().filter(|p| p.driven).map(|p| p.file.as_str()).collect();
    assert!(!w.logs.is_empty() && w.logs.iter().all(|f| driven.contains(&f.as_str())), "{:?}", w.logs);
    let spared: f64 = w.cells.iter().filter(|c| !driven.contains(&c.file.as_str())).map(|c| c.share).sum();
    assert!(spared < 0.02, "free logs have {spared} of it");
    assert_eq!(localise(&parts).stage, Some(Stage::Delay));
}

#[test]
fn a_weak_motor_and_a_clipped_one_are_the_motor() {
    let gain = as_given(&servo(|at| -0.2 * at.motor), &with(SENSORS[1], &mixed()));
    let w = localise(&gain);
    assert_eq!((w.variable, w.stage), (Some(Variable::Torque), Some(Stage::Motor)), "{}", name(&w));

    let wide: [fn(f64) -> f64; 3] =
        [|t| 1.2 * (3.0 * t).sin(), |t| 1.0 * (4.0 * t).sin(), |t| 0.9 * (3.5 * t).sin() + 0.4];
    let clipped = servo(|at| at.motor.clamp(-0.8, 0.8) - at.motor);
    let w = localise(&as_given(&clipped, &with(SENSORS[1], &wide.map(Swing::along))));
    assert_eq!((w.stage, w.phase), (Some(Stage::Motor), Some(Phase::Saturation)), "{}", name(&w));
}

#[test]
fn same_parts_same_answer_and_nothing_from_nothing() {
    let parts = as_given(&leg(|at| -2e-4 * at.v * at.v.abs()), &with(SENSORS[0], &free()));
    assert_eq!(localise(&parts), localise(&parts));
    let nothing = localise(&[]);
    assert!(nothing.cells.is_empty() && nothing.stage.is_none());
}

/// The profile was once that of the variable which the torque shows, drawn against that of the law.
#[test]
fn what_a_law_places_has_a_profile_along_the_laws_variable() {
    let parts = recalibrated(&leg(|at| -0.06 * ((at.q + 0.06).sin() - at.q.sin())), &with(SENSORS[0], &free()));
    let mut w = localise(&parts);
    assert!(w.variable == Some(Variable::Angle) && w.profile[0].at < 0.0, "{}", name(&w));
    place_by_law(&mut w, &parts, (LawActs::Torque, Variable::Time), [0.0, 1.0]);
    let last_s = parts.iter().flat_map(|p| &p.torque.t_s).copied().fold(0.0, f64::max);
    assert!(w.variable == Some(Variable::Time) && w.range == Some([0.0, 1.0]), "{}", name(&w));
    assert!(w.profile.len() > 3 && w.profile.iter().all(|bin| (0.0..=last_s).contains(&bin.at)));
    // Bins know the size of some variables alone.
    assert_eq!(in_bins(Variable::Torque, [-2.0, -1.0]), [1.0, 2.0]);
    assert_eq!(in_bins(Variable::Torque, [-2.0, 1.0]), [0.0, 2.0]);
    assert_eq!(in_bins(Variable::Angle, [-2.0, 1.0]), [-2.0, 1.0]);
}
