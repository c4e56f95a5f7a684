//! Slips of the hand that once went through: two results in one file, a study written over, options that did nothing.

mod support;

use std::fs;
use std::path::Path;
use support::*;

/// Runs a command that has to fail with an exit code, and to leave everything as it was.
fn refused(dir: &Path, words: &[&str], code: i32, parts: &[&str]) {
    let before = everything_in(dir);
    let output = run_in(dir, words);
    let (out, err) = (stdout(&output), stderr(&output));
    let told = format!("aibo-fit {}\n{out}\n{err}", words.join(" "));
    assert_eq!(output.status.code(), Some(code), "{told}");
    assert!(err.starts_with("error: ") && out.is_empty(), "{told}");
    for part in parts {
        assert!(err.contains(part), "`{part}` not in {told}");
    }
    assert_eq!(everything_in(dir), before, "{told}");
}

fn bench() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("good.csv"), good_log()).unwrap();
    fs::write(dir.path().join("study.toml"), STUDY).unwrap();
    fs::write(dir.path().join("arm.urdf"), arm::ARM).unwrap();
    dir
}

#[test]
fn two_results_in_one_file_are_refused_however_it_is_named() {
    let dir = bench();
    for json in ["o/fit.json", "./o/../o/report.html"] {
        refused(dir.path(), &["drop", "good.csv", "--out", "o", "--json", json], 2, &["two results"]);
    }
    let words = ["simulate", "study.toml", "--out", ".", "--json", "good.predicted.csv"];
    refused(dir.path(), &words, 2, &["good.predicted.csv", "two results"]);
    refused(dir.path(), &["drop", "good.csv", "--json", "-"], 2, &["--json", "name of a file"]);
}

/// It was said only after the walk.
#[test]
fn a_walk_whose_results_would_share_a_file_is_refused_before_it_is_simulated() {
    let dir = bench();
    let began = std::time::Instant::now();
    let long = ["walk", "--duration", "1800", "--out", "o"];
    let parts = ["two results would be written to this file"];
    refused(dir.path(), &[&long[..], &["--json", "o/log.csv"]].concat(), 2, &parts);
    refused(dir.path(), &[&long[..], &["--json", "a.mot", "--export-motion", "./a.mot"]].concat(), 2, &parts);
    refused(dir.path(), &["walk", "--frames", "--out", "o", "--json", "o/report.html"], 2, &parts);
    let onto_table = [&long[..], &["--setpoints", "good.csv", "--json", "good.csv"]].concat();
    refused(dir.path(), &onto_table, 2, &["good.csv", "over this input"]);
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
}

#[test]
fn synth_leaves_a_study_of_another_hand_and_repeats_its_own() {
    let dir = bench();
    let made = ["synth", "--robot", "arm.urdf", "--servo", "20,1", "--logs", "2", "--seconds", "2", "-q", "--out"];
    let into = |out: &'static str| [&made[..], &[out]].concat();
    fs::create_dir(dir.path().join("usr")).unwrap();
    fs::write(dir.path().join("usr/study.toml"), STUDY).unwrap();
    refused(dir.path(), &into("usr"), 2, &["usr/study.toml", "already"]);
    assert_eq!(fs::read_to_string(dir.path().join("usr/study.toml")).unwrap(), STUDY);
    expect_code(dir.path(), &into("made"), 0);
    expect_code(dir.path(), &into("made"), 0);
    let onto_log = [&into("made")[..], &["--truth", "made/log-00.csv"]].concat();
    refused(dir.path(), &onto_log, 2, &["made/log-00.csv", "two results"]);
    let study = dir.path().join("made/study.toml");
    fs::write(&study, fs::read_to_string(&study).unwrap() + "# mine\n").unwrap();
    refused(dir.path(), &into("made"), 2, &["made/study.toml", "already"]);
}

#[test]
fn options_that_would_do_nothing_are_refused() {
    let dir = bench();
    let cases: &[(&[&str], &[&str])] = &[
        (&["synth", "spec.toml", "--logs", "3"], &["--logs", "cannot be used with"]),
        (&["synth", "spec.toml", "--seconds", "3"], &["--seconds", "cannot be used with"]),
        (&["synth", "spec.toml", "--servo", "3"], &["--servo", "cannot be used with"]),
        (&["synth", "spec.toml", "--effect", "a.delay=1"], &["--effect", "cannot be used with"]),
        (&["synth", "--robot", "arm.urdf", "--servo", "10,0.2,3"], &["--servo 10,0.2,3", "KP,KD"]),
        (&["walk", "--air", "--slope", "0.1"], &["--slope", "cannot be used with"]),
        (&["walk", "--air", "--floor", "static=1"], &["--floor", "cannot be used with"]),
        (&["walk", "--air", "--touch", "all"], &["--touch", "cannot be used with"]),
        (&["walk", "--method", "bdf", "--step", "1e-3"], &["--step", "--tolerance"]),
        (&["walk", "--slope", "10"], &["--slope is 10 rad", "0.175 rad"]),
        (&["drop", "good.csv", "--start", "viscous=0.1", "--fix", "viscous=0.2"], &["`viscous`", "--fix and --start"]),
    ];
    for (words, parts) in cases {
        refused(dir.path(), words, 2, parts);
    }
}

/// One of another joint was taken for that of the study's; one of another robot was said to be wrong with the description.
#[test]
fn a_fit_of_another_joint_or_robot_is_refused() {
    let dir = bench();
    let put = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
    let knee = FIT.replacen("\"schema\": 1,", "\"schema\": 1, \"name\": \"knee\",", 1);
    put("knee.json", &knee);
    let words = |fit: &'static str| ["simulate", "study.toml", "--fit", fit, "--out", "o"];
    let parts = ["knee.json: the fit of joint `knee`", "`j`, which study.toml is of", "`name`"];
    refused(dir.path(), &words("knee.json"), 3, &parts);
    // A fit of logs without a study has their name.
    let of_log = |file: &str| {
        let log = format!("\"logs\": [{{\"file\": \"{file}\", \"role\": \"fit\", \"rms\": 0.1}}]");
        put("log.json", &knee.replacen("\"logs\": []", &log, 1));
    };
    of_log("knee-1.csv");
    refused(dir.path(), &words("log.json"), 3, &["log.json: the fit of joint `knee`"]);
    of_log("knee.csv");
    expect_code(dir.path(), &words("log.json"), 0);
    fs::remove_dir_all(dir.path().join("o")).unwrap();
    put("gap.json", "{ \"schema\": 1, \"name\": \"j\", \"verdict\": \"none\", \"effects\": [] }");
    refused(dir.path(), &words("gap.json"), 3, &["gap.json: this is what `gap --json` wrote", "fit.json beside"]);
    let number = "{ \"name\": \"arm/knee\", \"key\": \"frictionloss\", \"was\": 0.1, \"value\": 0.2, \"interval\": null, \
                  \"unit\": \"N m\" }";
    put("robot.json", &format!("{{ \"schema\": 1, \"found\": [{number}], \"joints\": {{}} }}"));
    refused(dir.path(), &words("robot.json"), 3, &["robot.json: ", "of a whole robot", "one joint"]);
    let arm = root().join("data/examples/arm/study.toml");
    let words = |fit: &'static str| ["simulate", arm.to_str().unwrap(), "--fit", fit, "--out", "o"];
    let parts = ["robot.json: found on another robot", "no joint `arm/knee`, but arm/shoulder, arm/elbow"];
    refused(dir.path(), &words("robot.json"), 3, &parts);
    refused(
        dir.path(),
        &words("knee.json"),
        3,
        &["knee.json: this is what was found on the joint `knee` alone", "robot's"],
    );
}

/// It hung limp in the simulation, without a word.
#[test]
fn a_joint_without_a_gain_is_not_simulated_under_setpoints() {
    let dir = tempfile::tempdir().unwrap();
    let example = root().join("data/examples/arm");
    for name in ["arm.urdf", "log0.csv", "log1.csv", "log2.csv"] {
        fs::copy(example.join(name), dir.path().join(name)).unwrap();
    }
    let study = fs::read_to_string(example.join("study.toml")).unwrap();
    let limp = study.replacen("kp = 12.0\nkd = 0.2\n", "coulomb = 0.05\n", 1);
    assert_ne!(study, limp);
    fs::write(dir.path().join("study.toml"), limp).unwrap();
    let parts = ["study.toml: joint arm/elbow is driven by position", "states kp [N m/rad]"];
    for command in ["simulate", "check", "gap"] {
        refused(dir.path(), &[command, "study.toml", "--out", "o"], 3, &parts);
    }
}

#[test]
fn an_export_finds_the_description_beside_the_diagnosis() {
    let dir = bench();
    let write = |model: &str| {
        let number = serde_json::json!({ "name": "arm/elbow", "key": "frictionloss", "was": 0.1, "value": 0.2,
            "interval": [0.1, 0.3], "unit": "N m" });
        let found = serde_json::json!({ "schema": 1, "model": model, "found": [number], "cannot_say": [] });
        fs::write(dir.path().join("rs/gap.json"), found.to_string()).unwrap();
    };
    fs::create_dir(dir.path().join("rs")).unwrap();
    fs::rename(dir.path().join("arm.urdf"), dir.path().join("rs/arm.urdf")).unwrap();
    write("arm.urdf");
    expect_code(dir.path(), &["export", "rs/gap.json", "--to", "urdf", "--out", "exported"], 0);
    write("gone.urdf");
    let words = ["export", "rs/gap.json", "--to", "urdf", "--out", "other"];
    refused(dir.path(), &words, 5, &["neither gone.urdf nor", "rs/gone.urdf", "--model"]);
}

#[test]
fn a_mass_that_the_search_moved_is_not_called_the_tables() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["q1.csv", "q1.toml"] {
        fs::copy(root().join("data").join(name), dir.path().join(name)).unwrap();
    }
    let notes = drop_json(dir.path(), &["q1.csv"])["notes"].to_string();
    assert!(!notes.contains("Table A.2's 0.05") && notes.contains("(Table A.2: 0.04 kg)"), "{notes}");
}

#[test]
fn a_quiet_walk_that_runs_away_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let output = run_in(dir.path(), &["walk", "--air", "--control-period", "0.008", "--quiet", "--out", "o"]);
    assert_eq!(output.status.code(), Some(4));
    let err = stderr(&output);
    assert!(err.starts_with("error: ") && err.contains("diverged at t =") && stdout(&output).is_empty(), "{err}");
    assert!(dir.path().join("o/log.csv").is_file());
}
