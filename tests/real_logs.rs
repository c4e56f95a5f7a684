//! Real machines' logs: read where `AIBO_FIT_SHARED` says, as they are not redistributed; skipped where it is not set.

mod support;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use support::*;

/// Study, and RMS of `benches/scipy_fit.py` over its fit logs \[rad\].
const FLOORS: [(&str, f64); 6] = [
    ("xl330-bam/free", 0.00555),
    ("mx-bam", 0.00072),
    ("sts3250-bam/free", 0.00846),
    ("rotary-pendulum", 0.00959),
    ("ak80-simple-pendulum", 0.01046),
    ("ak80-double-pendulum/design-C1-locked", 0.00371),
];
/// Share by which an RMS may lie above the floor; the floors have three digits.
const ABOVE: f64 = 1.02;

/// The baseline believes nothing that a study states.
const UNBELIEVED: [&str; 8] = ["--free", "inertia", "--free", "moment", "--free", "coulomb", "--free", "viscous"];
/// Beliefs keep numbers within so many of their standard deviations, whatever a joint has that the model lacks.
const FURTHEST_SD: f64 = 6.0;
/// Of this one number is taken to be simply wrong, not all of them by a little: the double pendulum's torques are not what
/// its drive was told.
const ONE_IS_WRONG: [&str; 1] = ["ak80-double-pendulum/design-C1-locked"];

fn drop_study(study: &Path, out: &Path, more: &[&str]) -> Value {
    let words = ["drop", "--quiet", "--study", study.to_str().unwrap(), "--out", out.to_str().unwrap()];
    expect_code(root(), &[&words, more].concat(), 0);
    json(&out.join("fit.json"))
}

#[test]
fn real_logs_are_followed_as_closely_as_by_the_independent_baseline() {
    let Some(real) = shared("real") else { return };
    for (name, floor) in FLOORS {
        let study = real.join(name).join("study.toml");
        let dir = tempfile::tempdir().unwrap();
        let believed = drop_study(&study, dir.path(), &[]);
        let mut far = 0;
        for (number, belief) in believed["beliefs"].as_object().unwrap() {
            let moved_sd = belief["moved_sd"].as_f64().unwrap();
            println!("{name}: {number} moved by {moved_sd:.1} sd");
            far += usize::from(moved_sd.abs() >= FURTHEST_SD);
        }
        assert_eq!(far, usize::from(ONE_IS_WRONG.contains(&name)), "{name}: {}", believed["beliefs"]);
        let fit = drop_study(&study, dir.path(), &UNBELIEVED);
        let rms = fit["models"]["extensive"]["rms"].as_f64().unwrap();
        println!("{name}: RMS {rms:.5} rad, floor {floor:.5} ({:.3})", rms / floor);
        assert!(rms <= ABOVE * floor, "{name}: RMS {rms} rad, baseline {floor}");
        is_sane(name, &fit);
        the_simulation_reproduces(name, &study, dir.path(), &fit);
    }
}

fn is_sane(name: &str, fit: &Value) {
    for key in ["inertia", "moment", "coulomb", "viscous"] {
        let (value, interval, identifiable) = quantity(&fit["joint"][key]);
        let value = value.unwrap_or_else(|| panic!("{name}: {key} has no value"));
        assert!(value.is_finite() && value >= 0.0, "{name}: {key} = {value}");
        assert!(value > 0.0 || key == "viscous", "{name}: {key} = {value}");
        assert_eq!(identifiable, interval.is_some(), "{name}: {key}");
        if let Some([low, high]) = interval {
            assert!(low <= value && value <= high && low < high, "{name}: {key} {value} [{low}, {high}]");
        }
    }
}

/// `simulate --fit` finds each log's start anew and leaves the same residual.
fn the_simulation_reproduces(name: &str, study: &Path, fitted: &Path, fit: &Value) {
    let dir = tempfile::tempdir().unwrap();
    let (fit_file, out, found) = (fitted.join("fit.json"), dir.path().join("out"), dir.path().join("found.json"));
    let [fit_word, out_word, found_word] = [&fit_file, &out, &found].map(|p| p.to_str().unwrap());
    let study = study.to_str().unwrap();
    let words = ["simulate", study, "--fit", fit_word, "--out", out_word, "--json", found_word, "--quiet"];
    expect_code(root(), &words, 0);
    let predicted = json(&found);
    let logs = fit["logs"].as_array().unwrap();
    assert_eq!(predicted["logs"].as_array().unwrap().len(), logs.len());
    for (was, is) in logs.iter().zip(predicted["logs"].as_array().unwrap()) {
        let (was_rms, is_rms) = (was["rms"].as_f64().unwrap(), is["rms"].as_f64().unwrap());
        assert_eq!(was["file"], is["file"]);
        assert!((is_rms / was_rms - 1.0).abs() < 1e-3, "{name}, {}: {was_rms} fitted, {is_rms} simulated", was["file"]);
    }
}

#[test]
fn one_drop_of_the_xl330_predicts_the_other() {
    let Some(real) = shared("real") else { return };
    let folder = real.join("xl330-bam/free");
    let text = fs::read_to_string(folder.join("study.toml")).unwrap();
    for held_back in ["drop-kp100.csv", "drop-kp400.csv"] {
        let dir = tempfile::tempdir().unwrap();
        let mut study: toml::Table = toml::from_str(&text).unwrap();
        for log in study["log"].as_array_mut().unwrap() {
            let file = log["file"].as_str().unwrap().to_owned();
            fs::copy(folder.join(&file), dir.path().join(&file)).unwrap();
            log["role"] = if file == held_back { "validate" } else { "fit" }.into();
        }
        let path = dir.path().join("study.toml");
        fs::write(&path, toml::to_string(&study).unwrap()).unwrap();
        let fit = drop_study(&path, &dir.path().join("out"), &[]);
        let rms = |role: &str| {
            let logs = fit["logs"].as_array().unwrap();
            logs.iter().find(|log| log["role"] == role).and_then(|log| log["rms"].as_f64()).unwrap()
        };
        let (fitted, predicted) = (rms("fit"), rms("validate"));
        println!("{held_back} held back: {predicted:.5} rad, the fitted one {fitted:.5} rad");
        // Two drops of one joint: its friction differs from drop to drop, the joint does not. They swing over 0.5 and 1.1 rad.
        assert!(predicted < 0.03, "{held_back}: {predicted} rad, fitted {fitted} rad");
    }
}

#[test]
fn every_sample_study_is_fitted() {
    let Some(folder) = shared("samples") else { return };
    let mut studies: Vec<PathBuf> =
        fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path().join("study.toml")).collect();
    studies.retain(|study| study.is_file());
    studies.sort();
    assert!(!studies.is_empty());
    for study in studies {
        let dir = tempfile::tempdir().unwrap();
        let fit = drop_study(&study, dir.path(), &[]);
        let rms = fit["models"]["extensive"]["rms"].as_f64().unwrap();
        println!("{}: RMS {rms:.5} rad", study.display());
        assert!(rms < 0.1, "{}: RMS {rms}", study.display());
    }
}

/// With the motor off a limit of its torque shows nothing: two hypotheses would be told apart by their masses only.
#[test]
#[ignore = "slow"]
fn slow_limits_of_a_motor_are_told_apart_by_a_motion_of_the_motor() {
    let Some(real) = shared("real") else { return };
    let study = real.join("sts3250-bam/driven/study.toml");
    let dir = tempfile::tempdir().unwrap();
    let study = study.to_str().unwrap();
    expect_code(dir.path(), &["gap", study, "--out", "out", "--json", "gap.json", "--quiet"], 0);
    let found = json(&dir.path().join("gap.json"));
    let [effects, next] = ["effects", "next"].map(|key| &found[key]);
    assert_eq!(effects[0]["id"], "speed_limit", "{effects}");
    let what = next["what"].as_str().unwrap();
    assert!(what.starts_with("Drive it") && what.contains("torque_limit"), "{what}");
    assert!(dir.path().join("out/next.csv").exists());
}
