//! What held-out logs say of a cause counts, as the whole program.

mod support;

use std::path::Path;
use support::*;

/// A servo that sticks: inertia 0.0074 kg m^2, kp 4, Coulomb friction 0.03 N m and 0.06 N m more at rest, which fades as
/// `exp(-speed / 0.1 rad/s)`; the study believes each number 10 % off and no static friction. Simulated in Python by Euler's
/// semi-implicit steps of 0.1 ms, read every 10 ms by an encoder of 4096 steps with noise of 0.5 mrad.
const STUDY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/logs/sticking_servo/study.toml");

#[test]
fn a_cause_that_held_out_logs_bear_out_stays_though_parts_of_fitted_ones_do_not() {
    let dir = tempfile::tempdir().unwrap();
    expect_code(dir.path(), &["gap", STUDY, "--out", "out", "--json", "gap.json", "--quiet"], 0);
    let found = json(&dir.path().join("gap.json"));
    assert_eq!((&found["verdict"], &found["effect"]), (&"effect".into(), &"stribeck".into()), "{}", found["sentence"]);
    let rms = |name: &str| found["gap"][name].as_f64().unwrap();
    assert!(rms("after") < 1.5e-3 && rms("after") < 0.5 * rms("calibrated"), "{}", found["gap"]);
    // The log that is held out chose it, and no figure of it is called unseen.
    assert_eq!(found["gap"]["outer"], false);
}

#[test]
fn of_one_recording_a_part_is_held_out() {
    let dir = tempfile::tempdir().unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/examples/delay");
    let study = std::fs::read_to_string(example.join("study.toml")).unwrap();
    let beliefs = &study[..study.find("[[log]]").unwrap()];
    let file = example.join("chirp-0.csv");
    let entry = |keys: &str| format!("[[log]]\nfile = {file:?}\ndrive = \"position\"\n{keys}\n");
    let parts = entry("role = \"fit\"\nto = 6") + &entry("role = \"validate\"\nfrom = 6");
    std::fs::write(dir.path().join("study.toml"), beliefs.to_owned() + &parts).unwrap();
    expect_code(dir.path(), &["gap", "study.toml", "--out", "out", "--json", "gap.json", "--quiet"], 0);
    let found = json(&dir.path().join("gap.json"));
    assert_eq!(found["effect"], "delay", "{}", found["sentence"]);
    let logs: Vec<&str> =
        found["gap"]["per_log"].as_array().unwrap().iter().map(|l| l["file"].as_str().unwrap()).collect();
    assert!(logs.len() == 1 && logs[0].ends_with("chirp-0.csv (from 6 s)"), "{logs:?}");
}
