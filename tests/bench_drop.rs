//! The whole robot, given the truth, repeats every swing that another engine made of it, to the sensor's noise.

mod support;

use aibo_fit::gap::neighbours::{Cause, Compared, Swings};
use aibo_fit::geometry::LinkBody;
use aibo_fit::log::{Role, read_sidecar_for};
use aibo_fit::robot::Model;
use aibo_fit::robot::bench::{BenchDrop, Held, bench_drop};
use aibo_fit::robot::simulate::Method;
use aibo_fit::{Case, Named};
use support::root;

/// Of the reference swings' sensor: uniform noise of half a step, then rounding to 0.006 rad (their README).
const FLOOR_RAD: f64 = 0.00245;

#[test]
fn every_swing_of_the_thesis_robot_lies_within_1_2_times_the_noise_floor() {
    let folder = root().join("data/thesis-robot");
    let mut logs: Vec<_> = std::fs::read_dir(&folder)
        .expect("the reference swings")
        .filter_map(|entry| Some(entry.ok()?.path()).filter(|path| path.extension().is_some_and(|e| e == "csv")))
        .collect();
    logs.sort();
    assert!(logs.len() >= 35);
    let (mut worst, mut sum) = (0.0f64, 0.0);
    for log in &logs {
        let name = log.file_name().expect("a name").to_string_lossy().into_owned();
        let sidecar = read_sidecar_for(log).expect("a sidecar").expect("present");
        let case = Case::of_logs(std::slice::from_ref(log), None).expect("a case");
        let leg = case.leg.as_ref().expect("an ERS-7 leg");
        let item = &case.items[0];
        assert_eq!(item.entry.role, Role::Fit);
        let release = sidecar.release.expect("a bench log");
        // Table 3.3.
        let (coulomb_nm, viscous_nm_s_rad) = match leg.joint.to_string().as_str() {
            "q1" => (0.001, 0.017),
            "q2" => (0.007, 0.019),
            _ => (0.020, 0.010),
        };
        let drop = BenchDrop {
            leg,
            extra: item.entry.extra,
            masses_kg: Vec::new(),
            coulomb_nm,
            viscous_nm_s_rad,
            stribeck: None,
            effects: Vec::new(),
            others: Vec::new(),
            zero_rad: 0.0,
            angle_rad: release.setpoint_rad.expect("stated"),
            rate_rad_s: 0.0,
            release_s: release.time_s.expect("stated"),
            held: Held::Rigid,
        };
        let dropped = bench_drop(Model::ers7(), &drop, &item.log.t_s, Method::default()).expect("a drop");
        assert!(dropped.diverged.is_none());
        let squares = item.log.q_rad.iter().zip(&dropped.reading_rad).map(|(q, model)| (q - model).powi(2));
        let ratio = (squares.sum::<f64>() / item.log.len() as f64).sqrt() / FLOOR_RAD;
        println!("{name:<16} {ratio:.3} of the noise floor");
        assert!(ratio < 1.2, "{name}: {ratio}");
        worst = worst.max(ratio);
        sum += ratio;
    }
    println!("{} swings: mean {:.3}, worst {worst:.3} of the noise floor", logs.len(), sum / logs.len() as f64);
}

/// Two logs with each extra mass about q3.
fn compared_about_q3(folder: &str) -> Compared {
    let log = |load: &str, k: usize| root().join(format!("data/{folder}/q3-{load}-{k}.csv"));
    let logs = ["220g", "402g"].map(|load| [log(load, 0), log(load, 1)]).concat();
    let case = Case::of_logs(&logs, None).expect("a case");
    let swings = Swings::of(&case, 2).expect("an ERS-7 leg").expect("free swings that begin held");
    Compared::of(&swings, false).expect("fits")
}

#[test]
fn refitted_drops_say_whether_the_held_joints_gave() {
    // Their README: held by the PID of Table B.2 there, rigidly here, with Table 3.3's friction.
    let sealed = compared_about_q3("sealed-robot");
    assert_eq!(sealed.held(), Some(Held::ByController), "{}", sealed.gives_by);
    assert!(sealed.controlled.rms_rad < 0.5 * sealed.rigid.rms_rad, "{:?}", sealed.controlled.found);
    let thesis = compared_about_q3("thesis-robot");
    assert_eq!(thesis.held(), Some(Held::Rigid), "{}", thesis.gives_by);
    assert!(!thesis.lacks_something(), "{} rad", thesis.rigid.rms_rad);
    let mass = thesis.rigid.of(Cause::Number(Named::Mass(LinkBody::LowerLeg))).expect("searched");
    let [low, high] = mass.interval.expect("determined");
    assert!(low < 0.036 && 0.036 < high && high - low < 0.3 * mass.value, "[{low}, {high}] kg"); // Table 3.2.
}
