//! Promises about the parts of a robot's diagnosis, on logs of its own making.

use super::attained::Attained;
use super::bench::{Bench, Logs};
use super::case::RobotCase;
use super::cause::Cause;
use super::diagnosis::GaitPhase;
use super::hold_scan::hold_scan;
use super::layout::period_s;
use super::part::{Part, changes, left};
use super::phases::phases;
use super::place::Place;
use super::refine::{Hypothesis, refine};
use super::scatter::{FLOOR, Number, Scatter};
use super::unseen::Unseen;
use crate::deadline::Deadline;
use crate::joint::EffectId;
use crate::synth::{Spec, make};
use std::path::Path;

/// A spec of the ERS-7: scenario, noise of its sensors \[rad\], step of the truth \[s\], and what more there is.
fn spec(scenario: &str, noise_rad: f64, step_s: f64, more: &str) -> String {
    format!(
        "schema = 1\nseed = 3\n[robot]\nmodel = \"ers7\"\nscenario = \"{scenario}\"\n[sensor]\nresolution = 0.006\n\
         period = 0.008\nnoise = {noise_rad}\n[truth]\nstep = {step_s}\n{more}"
    )
}

/// A walk in the air whose left front knee hears its setpoints 18 ms late.
fn late() -> String {
    let effect = "[[effect]]\nid = \"delay\"\njoints = [\"lf3\"]\nT = 0.018\n";
    spec("air", 0.002, 5e-4, &format!("{effect}[[log]]\nfile = \"trot.csv\"\nduration = 5.0\n"))
}

fn case(folder: &Path) -> RobotCase {
    case_of(folder, &late())
}

fn case_of(folder: &Path, spec: &str) -> RobotCase {
    let made = make(&Spec::from_toml(Path::new("spec.toml"), spec).unwrap(), None).unwrap();
    made.files().for_each(|(name, text)| std::fs::write(folder.join(name), text).unwrap());
    RobotCase::of_study(&folder.join("study.toml")).unwrap()
}

#[test]
fn a_delay_is_recovered_and_the_held_out_cycle_is_a_whole_one() {
    let folder = tempfile::tempdir().unwrap();
    let case = case(folder.path());
    let log = &case.logs[0];
    let begins_s = log.motion_begins_s();
    assert!((begins_s - 2.0).abs() < 0.05, "{begins_s}");
    let period_s = period_s(log, begins_s).expect("a trot repeats");
    assert!((period_s - 1.0).abs() < 0.02, "{period_s}");
    let bench = Bench::new(&case, &Deadline::default()).unwrap();
    let (_, row) = bench.layout.joints().next().unwrap();
    let held = row.range.clone().filter(|k| bench.layout.held[*k]).count();
    assert!((held as f64 * 0.008 - 1.0).abs() < 0.03, "{held} samples");

    let joint = case.names.iter().position(|name| name == "lf3").unwrap();
    let cause = Cause::Effect(EffectId::Delay);
    let part = Part { cause, place: Place::joint(joint), values: vec![0.010] };
    let given = Hypothesis::given(&bench).expect("it does not run away");
    let late = refine(&bench, &given, vec![part]).expect("it does not run away");
    let (found, sd) = (late.parts[0].values[0], late.sd(0, 0).expect("determined"));
    assert!((found - 0.018).abs() < 5.0 * (0.01 * sd).max(1e-5), "{found} +- {sd} hundredths");
    let per_sample = late.loss() / bench.noise.count() as f64;
    assert!((0.8..1.2).contains(&per_sample), "{per_sample} noise variances are left");
}

/// The search alone: readings are the simulation's own, at the fine step, where it searches with the coarse one.
#[test]
fn a_cause_and_numbers_that_are_off_are_found_together() {
    let folder = tempfile::tempdir().unwrap();
    let case = case_of(folder.path(), &spec("air", 0.002, 5e-4, "[[log]]\nfile = \"trot.csv\"\nduration = 5.0\n"));
    let mut bench = Bench::new(&case, &Deadline::default()).unwrap();
    let knee = case.names.iter().position(|name| name == "lf3").unwrap();
    let off = [(Number::Coulomb(knee), 2.5), (Number::Viscous(knee), -1.5)];
    let mut scatter = Scatter::none(case.model());
    off.iter().for_each(|(number, sds)| scatter.put(*number, sds * bench.spreads.sd(*number)));
    let cause = Cause::Effect(EffectId::Delay);
    let part = |late_s: f64| Part { cause, place: Place::joint(knee), values: vec![late_s] };
    let read = left(&bench, Logs::All, &scatter, &[part(0.018)]).expect("it does not run away");
    bench.measured.iter_mut().zip(read).for_each(|(measured, left)| *measured -= left);
    let given = Hypothesis::given(&bench).expect("it does not run away");
    let found = refine(&bench, &given, vec![part(0.010)]).expect("it does not run away");
    let late_s = found.parts[0].values[0];
    assert!((late_s - 0.018).abs() < 1e-4, "{late_s} s");
    // Readings have no noise: the robot that they are of costs what its numbers do, and the best no more.
    let truth = off.iter().map(|(_, sds)| sds * sds).sum::<f64>();
    assert!(found.loss() < truth, "{} and not {truth}", found.loss());
}

/// Only the limb of which something else is true is simulated: what it reads is what it reads beside all others, whose
/// reversals only cut its steps elsewhere.
#[test]
fn a_limb_alone_moves_as_beside_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let case = case_of(folder.path(), &spec("air", 0.002, 5e-4, "[[log]]\nfile = \"trot.csv\"\nduration = 3.0\n"));
    let bench = Bench::new(&case, &Deadline::default()).unwrap();
    let knee = case.names.iter().position(|name| name == "lf3").unwrap();
    let mut scatter = Scatter::none(case.model());
    scatter.put(Number::Viscous(knee), 2.0 * bench.spreads.sd(Number::Viscous(knee)));
    let cause = Cause::Effect(EffectId::Delay);
    let part = Part { cause, place: Place::joint(knee), values: vec![0.010] };
    let changes = changes(&bench, &[part]);
    assert_eq!(bench.limbs.touched(&scatter, &changes).len(), 1);
    let alone = bench.difference(Logs::All, &scatter, &changes).expect("it does not run away");
    let all = bench.difference_of(&bench.limbs.all(), Logs::All, (&scatter, &changes)).expect("it does not run away");
    let rms = |column: &[f64]| (column.iter().map(|change| change * change).sum::<f64>() / column.len() as f64).sqrt();
    let apart: Vec<f64> = alone.iter().zip(&all).map(|(alone, all)| alone - all).collect();
    assert!(rms(&all) > 1e-3, "{} rad", rms(&all));
    assert!(rms(&apart) < 5e-3 * rms(&all), "{} of {} rad", rms(&apart), rms(&all));
}

/// Errors of the long steps of a search cancel, and what jumps is followed by shorter ones.
#[test]
fn what_changes_make_is_the_same_at_steps_that_are_much_shorter() {
    let folder = tempfile::tempdir().unwrap();
    let log = "[[log]]\nfile = \"trot.csv\"\ngait = \"trot-2hz\"\nduration = 4.0\n";
    let case = case_of(folder.path(), &spec("air", 0.002, 5e-4, log));
    let bench = Bench::new(&case, &Deadline::default()).unwrap();
    let knee = case.names.iter().position(|name| name == "lf3").unwrap();
    let none = Scatter::none(case.model());
    let short = |changes: &[_]| bench.simulate(&none, changes, 1e-4, None).expect("it does not run away");
    for (effect, values) in [
        (EffectId::Delay, vec![0.014]),
        (EffectId::MotorGain, vec![0.5]),
        (EffectId::TorqueLimit, vec![0.05]),
        (EffectId::SpeedLimit, vec![3.0, 1.0]),
        (EffectId::DeadBand, vec![0.04]),
    ] {
        let part = Part { cause: Cause::Effect(effect), place: Place::joint(knee), values };
        let changes = changes(&bench, &[part]);
        let searched = bench.difference(Logs::All, &none, &changes).expect("it does not run away");
        let (there, here) = (short(&changes), short(&[]));
        let apart: Vec<f64> = searched.iter().zip(there.iter().zip(&here)).map(|(d, (a, b))| d - (a - b)).collect();
        let its: f64 = bench.rms_rad(knee, &apart);
        assert!(bench.rms_rad(knee, &searched) > 2e-3, "{effect:?}");
        assert!(its < 2e-4, "{effect:?}: {its} rad");
    }
}

#[test]
fn a_hold_of_any_time_is_scanned() {
    let folder = tempfile::tempdir().unwrap();
    let effect = "[[effect]]\nid = \"setpoint_hold\"\njoints = [\"lf3\"]\nT_h = 0.0437\n";
    let held = spec("air", 0.002, 5e-4, &format!("{effect}[[log]]\nfile = \"trot.csv\"\nduration = 5.0\n"));
    let case = case_of(folder.path(), &held);
    let bench = Bench::new(&case, &Deadline::default()).unwrap();
    let tried_s = hold_scan(&bench, &bench.gap());
    assert!(tried_s.iter().any(|hold_s| (hold_s / 0.0437 - 1.0).abs() < 2e-3), "{tried_s:?}");
}

#[test]
fn legs_hold_then_swing_about_half_of_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let case = case(folder.path());
    let phases = phases(&case, &case.logs[0]);
    for (joint, of) in phases.iter().enumerate().take(12) {
        let share = |phase: GaitPhase, from: usize| {
            of[from..].iter().filter(|of| **of == phase).count() as f64 / (of.len() - from) as f64
        };
        assert!(of[..240].iter().all(|phase| *phase == GaitPhase::Hold), "{}", case.names[joint]);
        let (swing, stance) = (share(GaitPhase::Swing, 260), share(GaitPhase::Stance, 260));
        assert!((0.35..0.65).contains(&swing) && stance > 0.2, "{}: {swing} {stance}", case.names[joint]);
    }
}

#[test]
fn numbers_that_move_far_and_close_nothing_are_as_believed() {
    let folder = tempfile::tempdir().unwrap();
    let case = case(folder.path());
    let bench = Bench::new(&case, &Deadline::default()).unwrap();
    let knee = case.names.iter().position(|name| name == "lf3").unwrap();
    let moved = |number: &Number| if *number == Number::Coulomb(knee) { 4.0 } else { 0.0 };
    let with = |residual: Vec<f64>| {
        let sizes = bench.numbers.iter().map(moved).collect();
        Attained { price: 0.0, residual, sizes, offset: 0.0 }
    };
    assert!(with(bench.gap()).is_believed(&bench));
    assert!(!with(vec![0.0; bench.gap().len()]).is_believed(&bench));
    // Half of a standard deviation more is friction within its belief, five are not.
    let part = |times: f64| {
        let number = Number::Coulomb(knee);
        let values = vec![bench.believed(number) + times * bench.spreads.sd(number)];
        Part { cause: Cause::Coulomb, place: Place::joint(knee), values }
    };
    assert!(part(0.5).is_believed(&bench) && !part(5.0).is_believed(&bench));
}

#[test]
fn a_joint_that_is_let_go_feels_as_much_torque_as_gravity_has() {
    let folder = tempfile::tempdir().unwrap();
    let log = "[[log]]\nfile = \"drop.csv\"\nduration = 2.0\nreleased = \"lf1\"\nrelease_time = 0.4\nangles = { lf1 = 1.2 }\n";
    let dropped = spec("drop", 0.001, 1e-3, log);
    let case = case_of(folder.path(), &dropped);
    let bench = Bench::new(&case, &Deadline::default()).unwrap();
    let hip = case.names.iter().position(|name| name == "lf1").unwrap();
    // 128 g of leg, some 7 cm below its axis, at up to a right angle.
    let torque_nm = bench.reach[hip].torque_nm;
    assert!((0.03..0.15).contains(&torque_nm), "{torque_nm} N m");
}

#[test]
fn a_landing_is_not_compared_and_numbers_that_only_imitate_what_was_fitted_stand_as_stated() {
    let folder = tempfile::tempdir().unwrap();
    let case = case_of(folder.path(), &spec("floor", 0.002, 5e-4, "[[log]]\nfile = \"trot.csv\"\nduration = 6.0\n"));
    let bench = Bench::new(&case, &Deadline::default()).unwrap();
    let t_s = &case.logs[0].log.t_s;
    for (_, row) in bench.layout.joints() {
        let first = row.range.clone().find(|k| bench.layout.compared[*k]).expect("some are") - row.range.start;
        let held = row.range.clone().find(|k| bench.layout.held[*k]).expect("some are") - row.range.start;
        assert!((t_s[first] - 3.0).abs() < 0.05 && (t_s[held] - 4.0).abs() < 0.05, "{} {}", t_s[first], t_s[held]);
    }
    let drawn =
        bench.difference(Logs::All, &Scatter::drawn(case.model(), &[[0.0; 2]; 64], FLOOR, 1), &[]).expect("it walks");
    let adapted_of = |sign_of_held: f64| {
        let sign = |k: usize| if bench.layout.held[k] { sign_of_held } else { 1.0 };
        let residual: Vec<f64> = drawn.iter().enumerate().map(|(k, change)| sign(k) * change).collect();
        let unseen = Unseen::of(&bench);
        (unseen.adapted(&residual), residual, unseen.squares(&drawn))
    };
    let (adapted, residual, squares) = adapted_of(1.0);
    assert!(Unseen::of(&bench).squares(&adapted) < 0.5 * squares, "a robot like one that was drawn is recognised");
    assert_ne!(adapted, residual);
    let (adapted, residual, _) = adapted_of(-1.0);
    assert_eq!(adapted, residual, "what the held-out cycle contradicts is not");
}

#[test]
fn a_robot_is_drawn_from_its_number_alone() {
    let model = crate::robot::Model::ers7();
    let friction = vec![[0.01; 2]; model.joints().len()];
    let drawn = |number| Scatter::drawn(model, &friction, FLOOR, number);
    assert_eq!(drawn(4), drawn(4));
    assert_ne!(drawn(4), drawn(5));
}
