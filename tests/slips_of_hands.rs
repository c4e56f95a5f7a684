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
