//! What `aibo-fit walk` promises: 0.51 m on the floor, joints that follow as in Figure C.2 in the air, files that say
//! so, errors with a reason.

mod support;

use assert_cmd::Command;
use support::root;

fn walk(words: &[&str]) -> Command {
    let mut command = Command::cargo_bin("aibo-fit").expect("built");
    command.current_dir(root()).args(["walk", "--air"]).args(words);
    command
}

#[test]
fn every_leg_joint_follows_without_visible_delay_or_loss_of_amplitude() {
    let folder = tempfile::tempdir().expect("a folder");
    let json = folder.path().join("walk.json");
    let out = folder.path().join("out");
    walk(&["--out", out.to_str().expect("UTF-8"), "--json", json.to_str().expect("UTF-8")]).assert().success();
    let found: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&json).expect("written")).expect("JSON");
    let joints = found["joints"].as_array().expect("a list");
    assert_eq!(joints.len(), 12);
    for joint in joints {
        let number = |key: &str| joint[key].as_f64().expect("a number");
        // Half a frame of 8 ms, two percent of amplitude: nothing that the figure would show.
        assert!((number("amplitude_ratio") - 1.0).abs() < 0.02 && number("delay_s").abs() < 0.004, "{joint}");
    }
    let log = std::fs::read_to_string(out.join("log.csv")).expect("written");
    assert!(log.starts_with("t,lf1.q,lf1.q_ref,lf1.tau") && log.lines().count() == 1252);
    for file in ["report.html", "walk-left-front.svg"] {
        assert!(std::fs::read_to_string(out.join(file)).expect("written").contains("</"));
    }
}

#[test]
fn the_log_of_a_walk_is_one_that_the_program_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    walk(&["--sensor", "b1", "--quiet", "--out", folder.path().to_str().expect("UTF-8")]).assert().success();
    let log = aibo_fit::log::read_joint_log(&folder.path().join("log.csv"), Some("rf2")).expect("a log");
    assert_eq!(log.len(), 1251);
    assert!(log.q_ref_rad.is_some() && log.tau_nm.is_some());
    // Section B.1: steps of 0.006 rad, never below the angle.
    assert!(log.q_rad.iter().all(|q| (q / 0.006 - (q / 0.006).round()).abs() < 1e-3));
}

#[test]
fn a_motion_that_runs_away_is_kept_and_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let assert = walk(&["--control-period", "0.008", "--out", folder.path().to_str().expect("UTF-8")]).assert();
    let output = assert.code(4).get_output().stdout.clone();
    let text = String::from_utf8(output).expect("UTF-8");
    assert!(text.contains("diverged at t =") && text.contains("frames"), "{text}");
    assert!(folder.path().join("log.csv").is_file());
    // A floor so hard that no explicit step of this length follows it.
    let words = ["--method", "rk2", "--step", "0.008", "--floor", "stiffness=1e8", "--out"];
    let assert = on_the_floor(&words).arg(folder.path()).assert();
    let output = assert.code(4).get_output().stdout.clone();
    let text = String::from_utf8(output).expect("UTF-8");
    assert!(text.contains("diverged at t =") && text.contains("shorter"), "{text}");
    assert!(folder.path().join("log.csv").is_file());
}

#[test]
fn bad_input_gives_one_error_with_its_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("setpoints.csv");
    let file = table.to_str().expect("UTF-8");
    for (content, expected) in [
        ("", "empty"),
        ("t,lf1\n0,0\n0.008\n", "line 3: 1 cells, expected 2"),
        ("t,lf1\n0,0\n0.008,x\n", "line 3, column lf1"),
        ("t,lf1\n0,0\n0,0\n", "line 3: t does not rise"),
        ("t,lf1\n0,0\n0.008,90\n", "looks like degrees"),
        ("t,knee\n0,0\n0.008,1\n", "no column is a joint"),
    ] {
        std::fs::write(&table, content).expect("written");
        let assert = walk(&["--setpoints", file]).assert().code(3);
        let error = String::from_utf8(assert.get_output().stderr.clone()).expect("UTF-8");
        assert!(error.contains(expected) && error.lines().count() == 1, "{error}");
    }
    walk(&["--step", "-1"]).assert().code(2);
    walk(&["--friction", "nosuch"]).assert().code(2);
    walk(&["--control-period", "0"]).assert().code(2);
    walk(&["--frequency", "0"]).assert().code(2);
    walk(&["--setpoints", "nowhere.csv"]).assert().code(5);
}

fn on_the_floor(words: &[&str]) -> Command {
    let mut command = Command::cargo_bin("aibo-fit").expect("built");
    command.current_dir(root()).arg("walk").args(words);
    command
}

#[test]
fn the_reference_walk_goes_as_far_as_the_thesis_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let (json, motion) = (folder.path().join("walk.json"), folder.path().join("trot.mot"));
    let out = folder.path().join("out");
    let words = ["--out", out.to_str().expect("UTF-8"), "--json", json.to_str().expect("UTF-8")];
    on_the_floor(&words).args(["--export-motion", motion.to_str().expect("UTF-8")]).assert().success();
    let found: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&json).expect("written")).expect("JSON");
    let number = |key: &str| found[key].as_f64().expect("a number");
    // Table 4.1: 0.51 m; another engine: 0.511 m converged.
    assert!((number("displacement_m") - 0.511).abs() < 0.005, "{found}");
    assert!(number("drift_m").abs() < 0.03 && number("bob_m") < 0.004 && number("realtime_factor") > 0.0, "{found}");
    for file in ["report.html", "animation.html", "walk-trunk.svg", "walk-left-front.svg"] {
        assert!(std::fs::read_to_string(out.join(file)).expect("written").contains("</"), "{file}");
    }
    assert!(std::fs::read(out.join("walk.gif")).expect("written").starts_with(b"GIF89a"));
    assert!(std::fs::read_to_string(&motion).expect("written").starts_with("#MSq"));
}

#[test]
fn what_no_floor_or_gait_is_gives_one_error_with_its_reason() {
    for (words, expected) in [
        (["--gait", "gallop"], "there are trot"),
        (["--floor", "static"], "expected KEY=VALUE"),
        (["--floor", "stiffness=-1"], "stiffness"),
        (["--slope", "1.5"], "slope"),
        (["--duration", "0"], "duration"),
    ] {
        let assert = on_the_floor(&words).assert().code(2);
        let error = String::from_utf8(assert.get_output().stderr.clone()).expect("UTF-8");
        assert!(error.contains(expected) && error.lines().count() == 1, "{error}");
    }
}
