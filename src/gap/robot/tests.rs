//! Promises about the parts of a robot's diagnosis, on logs of its own making.

use super::attained::Attained;
use super::beliefs::believed;
use super::bench::Bench;
use super::case::RobotCase;
use super::cause::Cause;
use super::diagnosis::GaitPhase;
use super::layout::period_s;
use super::phases::phases;
use super::place::Place;
use super::refine::{Part, refine};
use super::scatter::{Number, Scatter};
use crate::joint::EffectId;
use crate::synth::{Spec, make};
use std::path::Path;

/// A walk in the air whose left front knee hears its setpoints 18 ms late.
const LATE: &str = r#"
schema = 1
seed = 3
[robot]
model = "ers7"
scenario = "air"
[sensor]
resolution = 0.006
period = 0.008
noise = 0.002
[truth]
step = 5e-4
[[effect]]
id = "delay"
joints = ["lf3"]
T = 0.018
[[log]]
file = "trot.csv"
duration = 5.0
"#;

/// A leg that is let go.
const DROPPED: &str = r#"
schema = 1
[robot]
model = "ers7"
scenario = "drop"
[sensor]
period = 0.008
noise = 0.001
[truth]
step = 1e-3
[[log]]
file = "drop.csv"
duration = 2.0
released = "lf1"
release_time = 0.4
angles = { lf1 = 1.2 }
"#;

fn case(folder: &Path) -> RobotCase {
    case_of(folder, LATE)
}

fn case_of(folder: &Path, spec: &str) -> RobotCase {
    let made = make(&Spec::from_toml(Path::new("spec.toml"), spec).unwrap(), None).unwrap();
    for (name, text) in made.logs.into_iter().chain([("study.toml".to_owned(), made.study_toml)]) {
        std::fs::write(folder.join(name), text).unwrap();
    }
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
    let bench = Bench::new(&case).unwrap();
    let (_, row) = bench.layout.joints().next().unwrap();
    let held = row.range.clone().filter(|k| bench.layout.held[*k]).count();
    assert!((held as f64 * 0.008 - 1.0).abs() < 0.03, "{held} samples");

    let joint = case.names.iter().position(|name| name == "lf3").unwrap();
    let cause = Cause::Effect(EffectId::Delay);
    let part = Part { cause, place: Place::joint(joint), values: vec![0.010] };
    let late = refine(&bench, vec![part]).expect("it does not run away");
    let (found, sd) = (late.parts[0].values[0], late.sd(0, 0).expect("determined"));
    assert!((found - 0.018).abs() < 5.0 * (0.01 * sd).max(1e-5), "{found} +- {sd} hundredths");
    let per_sample = late.loss / bench.noise.count() as f64;
    assert!((0.8..1.2).contains(&per_sample), "{per_sample} noise variances are left");
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
    let bench = Bench::new(&case).unwrap();
    let knee = case.names.iter().position(|name| name == "lf3").unwrap();
    let moved = |number: &Number| if *number == Number::Coulomb(knee) { 4.0 } else { 0.0 };
    let with = |residual: Vec<f64>| Attained { price: 0.0, residual, sizes: bench.numbers.iter().map(moved).collect() };
    assert!(with(bench.gap()).is_believed(&bench));
    assert!(!with(vec![0.0; bench.gap().len()]).is_believed(&bench));
    // Half of a standard deviation more is friction within its belief, five are not.
    let part = |times: f64| {
        let number = Number::Coulomb(knee);
        let values = vec![believed(&bench, number) + times * bench.spreads.sd(number)];
        Part { cause: Cause::Coulomb, place: Place::joint(knee), values }
    };
    assert!(part(0.5).is_believed(&bench) && !part(5.0).is_believed(&bench));
}

#[test]
fn a_joint_that_is_let_go_feels_as_much_torque_as_gravity_has() {
    let folder = tempfile::tempdir().unwrap();
    let case = case_of(folder.path(), DROPPED);
    let bench = Bench::new(&case).unwrap();
    let hip = case.names.iter().position(|name| name == "lf1").unwrap();
    // 128 g of leg, some 7 cm below its axis, at up to a right angle.
    let torque_nm = bench.reach[hip].torque_nm;
    assert!((0.03..0.15).contains(&torque_nm), "{torque_nm} N m");
}

#[test]
fn a_robot_is_drawn_from_its_number_alone() {
    let model = crate::robot::Model::ers7();
    let friction = vec![[0.01; 2]; model.joints().len()];
    let drawn = |number| Scatter::drawn(model, &friction, number);
    assert_eq!(drawn(4), drawn(4));
    assert_ne!(drawn(4), drawn(5));
}
