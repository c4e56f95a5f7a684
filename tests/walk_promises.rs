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
    assert_eq!(found["steps"], 8, "{found}");
    assert!(number("tilt_rad") < 0.1, "{found}");
    assert!(number("drift_m").abs() < 0.03 && number("bob_m") < 0.004 && number("realtime_factor") > 0.0, "{found}");
    for file in ["report.html", "animation.html", "walk-trunk.svg", "walk-left-front.svg", "walk-cycle.svg"] {
        assert!(std::fs::read_to_string(out.join(file)).expect("written").contains("</"), "{file}");
    }
    let page = std::fs::read_to_string(out.join("report.html")).expect("written");
    for figure in ["4.1", "4.2", "4.4", "4.5", "4.6"] {
        assert!(page.contains(&format!("<figcaption>Figure {figure}")), "Figure {figure}");
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

/// Runs a study and answers with its JSON.
fn study(words: &[&str]) -> (serde_json::Value, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let json = folder.path().join("study.json");
    on_the_floor(words)
        .args(["--quiet", "--json", json.to_str().expect("UTF-8"), "--out", folder.path().to_str().expect("UTF-8")])
        .assert()
        .success();
    let text = std::fs::read_to_string(&json).expect("written");
    (serde_json::from_str(&text).expect("JSON"), folder)
}

#[test]
fn two_hertz_with_128_ms_setpoints_goes_less_far() {
    let (found, folder) = study(&["--frames", "--duration", "6", "--step", "1e-3"]);
    let went = |k: usize| found["rows"][k]["displacement_m"].as_f64().expect("a number");
    assert!(went(2) < went(0) && went(3) < went(2), "{found}");
    assert!(std::fs::read_to_string(folder.path().join("figure-c-3.svg")).expect("written").contains("</svg>"));
}

#[test]
fn a_gait_that_topples_falls_at_a_time_that_tells() {
    let (found, folder) = study(&["--falls", "--duration", "4", "--step", "5e-4"]);
    let rows = found["rows"].as_array().expect("a list");
    assert_eq!(rows.len(), 14);
    assert!(
        rows.iter().all(|row| row["more_s"].is_null() || row["more_s"].as_f64().expect("a number") > 0.3),
        "{found}"
    );
    let sentence = found["sentence"].as_str().expect("words");
    assert!(sentence.starts_with("topple falls 0.9") && sentence.contains("sharpest"), "{sentence}");
    assert!(std::fs::read_to_string(folder.path().join("falls.svg")).expect("written").contains("</svg>"));
    // A gait that does not fall is the answer "no".
    on_the_floor(&["--falls", "--gait", "trot", "--duration", "2.5", "--step", "2e-3", "--quiet", "--out"])
        .arg(folder.path())
        .assert()
        .code(1);
}

/// The table itself takes a minute; its first hundredth shows the rows and their judgement.
#[test]
fn every_row_of_table_4_1_is_there_and_judged() {
    let (found, folder) = study(&["--integrators", "--duration", "0.1"]);
    let rows = found["rows"].as_array().expect("a list");
    assert_eq!(rows.iter().filter(|row| !row["printed"].is_null()).count(), 10);
    let verdict = |k: usize| rows[k]["verdict"].as_str().expect("words");
    assert!((0..10).all(|k| ["reproduced", "different", "left out"].contains(&verdict(k))), "{found}");
    assert!((13..16).all(|k| verdict(k) == "diverged"), "{found}");
    for file in ["integrators.svg", "figure-c-4.svg", "figure-c-5.svg", "report.html"] {
        assert!(std::fs::read_to_string(folder.path().join(file)).expect("written").contains("</"), "{file}");
    }
    on_the_floor(&["--integrators", "--air"]).assert().code(2);
}

#[test]
fn a_gait_with_a_gap_a_jump_or_an_unknown_joint_gives_one_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("gait.toml");
    let wave = |joint: &str, keys: &str, amplitude: f64| {
        format!(
            "schema = 1\nname = \"g\"\nstand_s = 1.0\nwalk_s = 2.0\nperiod_s = 1.0\nramp_s = 0.0\n[[wave]]\n\
             joints = [\"{joint}\"]\nstand_rad = 0.1\nshape = \"linear\"\nkeys = {keys}\namplitude_rad = {amplitude}\n"
        )
    };
    for (text, expected) in [
        (wave("lf1", "[[0.2, 0.0], [0.6, 1.0]]", 0.1), "phases from 0"),
        (wave("lf1", "[[0.0, 0.0]]", 0.1), "a gap"),
        (wave("lf1", "[[0.0, 0.0], [0.01, 1.0]]", 0.5), "a jump at"),
        (wave("knee", "[[0.0, 0.0], [0.5, 1.0]]", 0.1), "a joint of ers7"),
        (wave("lf1", "[[0.0, 0.0], [0.5, 1.0]]", 5.0), "Table A.3"),
    ] {
        std::fs::write(&file, text).expect("written");
        let assert = on_the_floor(&["--gait", file.to_str().expect("UTF-8")]).assert().code(3);
        let error = String::from_utf8(assert.get_output().stderr.clone()).expect("UTF-8");
        assert!(error.contains(expected) && error.matches("error").count() == 1, "{error}");
    }
}
