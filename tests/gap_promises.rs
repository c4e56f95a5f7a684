//! What `aibo-fit gap` promises, as the whole program: an answer with every key, the same bytes on any number of
//! threads, and a clear word where there is nothing to diagnose.

mod support;

use aibo_fit::blind::Cause;
use aibo_fit::joint::EffectId;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};
use support::swing::{swing, swing_against, swing_under, swings};
use support::*;

/// No study of a few logs may take longer, whatever its numbers.
const LONGEST: Duration = Duration::from_secs(60);

const RIGHT: [&str; 4] = ["9.0e-4", "5.0e-3", "0.001", "0.0004"];
const FRICTION: [f64; 2] = [0.001, 0.0004];

fn three_swings(nominal: [&str; 4]) -> tempfile::TempDir {
    let log = |from: f64| swing(from, 400, FRICTION);
    swings(&[("fit", log(0.9)), ("fit", log(-0.6)), ("validate", log(0.75))], nominal)
}

fn diagnosed(folder: &Path, words: &[&str]) -> Value {
    let all: Vec<&str> =
        ["gap", "study.toml", "--out", "out", "--json", "gap.json"].iter().chain(words).copied().collect();
    let began = Instant::now();
    expect_code(folder, &all, 0);
    assert!(began.elapsed() < LONGEST, "{words:?}: {:?}", began.elapsed());
    json(&folder.join("gap.json"))
}

/// Ids of an answer's causes.
fn named(found: &Value) -> Vec<&str> {
    found["effects"].as_array().unwrap().iter().map(|e| e["id"].as_str().unwrap()).collect()
}

#[test]
fn an_answer_has_every_key_of_the_contract_and_its_report_is_the_same_on_any_number_of_threads() {
    let dir = tempfile::tempdir().unwrap();
    write_made(dir.path(), 10, Cause::Effects(vec![EffectId::AngleOffset]));
    let with = |threads: &str| {
        let found = diagnosed(dir.path(), &["--threads", threads, "--quiet"]);
        let out = dir.path().join("out");
        let files: Vec<_> =
            everything_in(&out).into_iter().map(|file| (file.clone(), fs::read(file).unwrap())).collect();
        fs::remove_dir_all(out).unwrap();
        (found, files)
    };
    let ((mut one, one_files), (mut two, two_files)) = (with("1"), with("2"));
    for key in [
        "schema",
        "verdict",
        "effect",
        "second",
        "equivalent",
        "probability",
        "sentence",
        "where",
        "gap",
        "ranking",
        "detectable",
        "joint",
        "next",
    ] {
        assert!(one.get(key).is_some(), "`{key}` is missing");
    }
    for key in ["joints", "stage", "variable", "range", "phase", "logs", "share"] {
        assert!(one["where"].get(key).is_some(), "`where.{key}` is missing");
    }
    for key in ["unit", "before", "calibrated", "after_first", "after", "floor", "closed", "closed_interval", "per_log"]
    {
        assert!(one["gap"].get(key).is_some(), "`gap.{key}` is missing");
    }
    for key in ["inertia", "moment", "coulomb", "viscous"] {
        assert!(one["joint"][key]["value"].is_number(), "`joint.{key}` has no value");
    }
    assert_eq!(one["detectable"].as_object().unwrap().len(), EffectId::ALL.len());
    // The command line, with its number of threads, is part of the provenance.
    for found in [&mut one, &mut two] {
        found["command"].take();
    }
    assert_eq!(one, two);
    let names =
        |files: &[(std::path::PathBuf, Vec<u8>)]| files.iter().map(|(path, _)| path.clone()).collect::<Vec<_>>();
    assert_eq!(names(&one_files), names(&two_files));
    for ((path, a), (_, b)) in one_files.iter().zip(&two_files) {
        // The list of files has digests of all, also of the two that quote the command line.
        let is_list = path.ends_with(".aibo-fit.toml");
        let plain = |bytes: &[u8]| -> String {
            let text = String::from_utf8_lossy(bytes).replace("--threads 2", "--threads 1");
            let quotes = |line: &&str| is_list && (line.contains("report.html\" =") || line.contains("fit.json\" ="));
            text.lines().filter(|line| !quotes(line)).collect::<Vec<_>>().join("\n")
        };
        assert!(plain(a) == plain(b), "{} differs", path.display());
    }
    assert!(names(&one_files).iter().any(|path| path.ends_with("fit.json")));
    assert!(names(&one_files).iter().any(|path| path.ends_with("report.html")));
}

#[test]
#[ignore = "slow"]
fn slow_what_is_withheld_is_not_the_answer_and_only_keeps_to_its_list() {
    let dir = tempfile::tempdir().unwrap();
    write_made(dir.path(), 26, Cause::Effects(vec![EffectId::JointSpring]));
    let found = diagnosed(dir.path(), &[]);
    assert_eq!(
        (&found["verdict"], &found["effect"]),
        (&"effect".into(), &"joint_spring".into()),
        "{}",
        found["sentence"]
    );
    let found = diagnosed(dir.path(), &["--without", "joint_spring"]);
    assert_ne!(found["effect"], "joint_spring");
    assert_eq!(found["withheld"], serde_json::json!(["joint_spring"]));
    assert!(found["ranking"].as_array().unwrap().iter().all(|c| c["effect"] != "joint_spring"));
    let found = diagnosed(dir.path(), &["--only", "delay, joint_spring"]);
    let ranked: Vec<&str> = found["ranking"].as_array().unwrap().iter().filter_map(|c| c["effect"].as_str()).collect();
    assert!(ranked.iter().all(|effect| ["delay", "joint_spring"].contains(effect)), "{ranked:?}");
    assert_eq!(found["withheld"].as_array().unwrap().len(), EffectId::ALL.len() - 2);
    assert_eq!(found["only"], serde_json::json!(["delay", "joint_spring"]));
}

#[test]
fn right_numbers_are_none_and_wrong_numbers_are_calibration() {
    let right = three_swings(RIGHT);
    let found = diagnosed(right.path(), &[]);
    assert_eq!((&found["verdict"], &found["effect"]), (&"none".into(), &Value::Null), "{}", found["sentence"]);
    let wrong = three_swings(["9.0e-4", "5.0e-3", "0.0018", "0.0004"]);
    let found = diagnosed(wrong.path(), &[]);
    let said = (&found["verdict"], &found["effect"]);
    assert_eq!(said, (&"calibration".into(), &"coulomb".into()), "{}", found["sentence"]);
    let coulomb = found["joint"]["coulomb"]["value"].as_f64().unwrap();
    assert!((coulomb / 0.001 - 1.0).abs() < 0.1, "{coulomb}");
}

#[test]
fn one_log_or_no_validate_log_is_held_out_in_parts_and_said_so() {
    let log = |from: f64| swing(from, 400, FRICTION);
    for (logs, files, part) in [
        (vec![("fit", log(0.9))], 1, "part of the only log"),
        (vec![("fit", log(0.9)), ("fit", log(-0.7))], 2, "each log predicted"),
    ] {
        let dir = swings(&logs, RIGHT);
        let found = diagnosed(dir.path(), &[]);
        assert_eq!(found["verdict"], "none", "{}", found["sentence"]);
        assert_eq!(found["gap"]["per_log"].as_array().unwrap().len(), files);
        assert!(found["gap"]["held_out"].as_str().unwrap().contains(part), "{}", found["gap"]["held_out"]);
    }
}

#[test]
fn a_stop_that_only_a_held_out_log_reaches_is_named_and_said_so() {
    let log = |from: f64| swing_against(0.45, from, 400, FRICTION);
    let dir = swings(&[("fit", log(0.4)), ("fit", log(-0.35)), ("validate", log(-0.9))], RIGHT);
    let found = diagnosed(dir.path(), &[]);
    let said = (&found["verdict"], &found["effect"]);
    assert_eq!(said, (&"effect".into(), &"end_stop".into()), "{}", found["sentence"]);
    let stop = &found["ranking"][0]["parameters"];
    assert_eq!(stop["side"]["value"], 1.0);
    assert!((stop["q_e"]["value"].as_f64().unwrap() - 0.45).abs() < 0.01, "{stop}");
    let files: Vec<&str> =
        found["gap"]["per_log"].as_array().unwrap().iter().filter_map(|log| log["file"].as_str()).collect();
    assert_eq!(files, ["2.csv"]);
    assert!(found["gap"]["held_out"].as_str().unwrap().contains("do not show"), "{}", found["gap"]["held_out"]);
}

#[test]
fn a_joint_that_never_moves_is_an_answer() {
    let still = log_of("t,q", 300, 0.008, |t| format!("{t:.3},0.01"));
    let dir = swings(&[("fit", still)], RIGHT);
    let said = expect_code(dir.path(), &["gap", "study.toml", "--out", "out", "--json", "gap.json"], 1);
    assert!(said.contains("no diagnosis"), "{said}");
    assert_eq!(json(&dir.path().join("gap.json"))["moved"], false);
    assert!(!dir.path().join("out").exists());
}

#[test]
fn a_log_of_a_few_samples_ends_in_a_word_and_not_in_a_panic() {
    for samples in 1..10 {
        let dir = swings(&[("fit", swing(0.9, samples, FRICTION))], RIGHT);
        ends_in_a_word(dir.path(), &format!("{samples} samples"));
        let two = [("fit", swing(0.9, 200, FRICTION)), ("validate", swing(0.9, samples, FRICTION))];
        ends_in_a_word(swings(&two, RIGHT).path(), &format!("a validate log of {samples} samples"));
    }
}

/// A clear answer or a clear error, in time.
fn ends_in_a_word(folder: &Path, what: &str) {
    let began = Instant::now();
    let output = run_in(folder, &["gap", "study.toml", "--out", "out", "--json", "gap.json"]);
    let (code, said) = (output.status.code(), stderr(&output));
    assert!(!said.contains("panicked") && matches!(code, Some(0 | 1 | 3 | 4)), "{what}: {code:?} {said}");
    // Doubts about the study's numbers come before the error.
    let has_error = said.lines().any(|line| line.starts_with("error"));
    assert!(code == Some(0) || code == Some(1) || has_error, "{what}: {said}");
    assert!(began.elapsed() < LONGEST, "{what}: {:?}", began.elapsed());
}

#[test]
#[ignore = "slow"]
fn slow_zeros_and_absurd_numbers_end_in_a_word() {
    for nominal in [
        ["9.0e-4", "5.0e-3", "0", "0"],
        ["9.0e-4", "0", "0.001", "0.0004"],
        ["1e6", "5.0e-3", "0.001", "0.0004"],
        ["1e-12", "5.0e-3", "0.001", "0.0004"],
        ["9.0e3", "5.0e-3", "0.001", "0.0004"],
        ["9.0e-4", "50.0", "0.001", "0.0004"],
        ["9.0e-4", "5.0e-3", "100.0", "0.0004"],
        ["9.0e-4", "5.0e-3", "0.001", "1.0"],
    ] {
        ends_in_a_word(three_swings(nominal).path(), &format!("{nominal:?}"));
    }
}

#[test]
fn careless_command_lines_are_refused_in_words() {
    let dir = three_swings(RIGHT);
    for (words, part) in [
        (&["gap"][..], "<STUDY>"),
        (&["gap", "study.toml", "--without", "friction"], "`friction` is not an effect"),
        (&["gap", "study.toml", "--only", ""], "is not an effect"),
        (&["gap", "study.toml", "--only", "delay", "--without", "delay"], "stands in --without and in --only"),
        (&["gap", "study.toml", "--twins=-1"], "--twins"),
        (&["gap", "study.toml", "--seed", "x"], "--seed"),
        (&["gap", "study.toml", "--threads", "0"], "--threads"),
        (&["gap", "study.toml", "another.toml"], "unexpected argument"),
    ] {
        let output = run_in(dir.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(part), "{words:?}: {}", stderr(&output));
    }
    let output = run_in(dir.path(), &["gap", "study.toml", "--json", "study.toml", "--out", "out", "--only", "delay"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("written over this input"), "{}", stderr(&output));
    assert!(!dir.path().join("out").exists());
}

/// A cable that pulls on one side and stiffens, and drag of a power of the speed: in the default formulas of both a third
/// cause would be needed, and much would be left.
#[test]
fn two_causes_in_other_formulas_than_the_default_ones_are_named_and_no_third() {
    let cable = |q: f64| if q > 0.1 { -0.012 * ((q - 0.1) + (q - 0.1).powi(3)) } else { 0.0 };
    let pulled = |q: f64, w: f64| cable(q) - 0.0006 * w.signum() * w.abs().powf(1.8);
    let swung = |from: f64| swing_under(&pulled, from, 500, FRICTION);
    let dir = swings(&[("fit", swung(1.2)), ("fit", swung(-0.9)), ("validate", swung(0.7))], RIGHT);
    let found = diagnosed(dir.path(), &[]);
    let mut causes = named(&found);
    causes.sort_unstable();
    assert_eq!(causes, ["joint_spring", "quadratic_drag"], "{found}");
    assert!(found["gap"]["after"].as_f64().unwrap() < 1e-3, "{found}");
}

/// A torque limit of which a spring between motor and link takes the share that would show it: the one hides the other, and a set
/// that grows by one cause at a time ends with the first. The study is one of the sealed trial's, made by its own integrator.
#[test]
#[ignore = "slow"]
fn slow_a_cause_that_hides_another_does_not_end_the_search() {
    let dir = tempfile::tempdir().unwrap();
    write_drawn(dir.path(), 2027, 28);
    let found = diagnosed(dir.path(), &[]);
    assert_eq!((&found["verdict"], named(&found)), (&"effect".into(), vec!["torque_limit", "compliance"]), "{found}");
    let gap = |key: &str| found["gap"][key].as_f64().unwrap();
    assert!(gap("calibrated") > 0.02 && gap("after") < 1.5 * gap("floor"), "{found}");
}

/// Causes that held-out logs refute one by one, because a set that lacks a cause predicts them by chance: all logs
/// together ask for three, which leave their noise. With the whole catalogue the answer is the same, and takes five times
/// as long.
#[test]
#[ignore = "slow"]
fn slow_a_cause_that_held_out_logs_refute_for_want_of_another_is_found_with_it() {
    let dir = tempfile::tempdir().unwrap();
    let mut true_ones = write_drawn(dir.path(), 2027, 267).effects();
    let found = diagnosed(dir.path(), &["--only", &true_ones.join(",")]);
    let mut causes = named(&found);
    causes.sort_unstable();
    true_ones.sort_unstable();
    assert_eq!((&found["verdict"], causes), (&"effect".into(), true_ones), "{found}");
    let gap = |key: &str| found["gap"][key].as_f64().unwrap();
    assert!(gap("calibrated") > 10.0 * gap("floor") && gap("after") < 1.3 * gap("floor"), "{found}");
    assert_eq!(found["gap"]["outer"], false);
}
