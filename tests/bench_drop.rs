//! The whole robot, given the truth, repeats every swing that another engine made of it, to the sensor's noise.

mod support;

use aibo_fit::Case;
use aibo_fit::log::{Role, read_sidecar_for};
use aibo_fit::robot::Model;
use aibo_fit::robot::bench::{BenchDrop, Held, bench_drop};
use aibo_fit::robot::simulate::Method;
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

#[test]
fn the_gap_is_split_at_a_zero_that_has_not_taken_in_the_droop() {
    let found = support::drop_json(root(), &["data/q1.csv"]);
    let row = &found["whole_robot"][0];
    let rms = |held: &str| row[held]["rms"].as_f64().expect("a number");
    // The zero is the best for joints that give, and so no longer for rigid ones.
    assert!(rms("controlled_apart") < rms("controlled") && rms("rigid_apart") > rms("rigid"), "{row}");
    let zero_rad = row["zero_apart"].as_f64().expect("a number");
    assert!((-0.004..-5e-4).contains(&zero_rad), "{zero_rad}");
}
