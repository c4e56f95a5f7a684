//! What `aibo-fit simulate` promises: a prediction per log, with given or with fitted parameters.

mod support;

use std::fs;
use std::path::Path;
use support::*;

const LOGS: [&str; 2] = ["q1-402g-0.csv", "q1-402g-1.csv"];

/// A study of two swings of the reference robot, the second held back, with its true friction or another.
fn bench(viscous: f64) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let mut text = format!(
        "schema = 1\n[joint]\nname = \"hip\"\ninertia = 5.974e-4\nmoment = 5.972e-3\ncoulomb = 0.001\nviscous = {viscous}\n\
         [sensor]\nresolution = 0.006\nperiod = 0.008\n"
    );
    for (log, role) in LOGS.iter().zip(["fit", "validate"]) {
        fs::copy(root().join("data/thesis-robot").join(log), dir.path().join(log)).unwrap();
        text += &format!(
            "[[log]]\nfile = \"{log}\"\nrole = \"{role}\"\ndrive = \"off\"\n\
             [log.extra]\nmass = 0.402\ndistance = 0.1705\nradius = 0.018\nlength = 0.038\n"
        );
    }
    fs::write(dir.path().join("study.toml"), text).unwrap();
    dir
}

fn rms_of(folder: &Path, words: &[&str]) -> Vec<(String, String, f64)> {
    let all: Vec<&str> =
        ["simulate", "study.toml", "--json", "found.json"].into_iter().chain(words.iter().copied()).collect();
    expect_code(folder, &all, 0);
    let found = json(&folder.join("found.json"));
    assert_eq!(found["schema"], 1);
    let text = |v: &serde_json::Value| v.as_str().unwrap().to_owned();
    let logs = found["logs"].as_array().unwrap();
    logs.iter().map(|log| (text(&log["file"]), text(&log["role"]), log["rms"].as_f64().unwrap())).collect()
}

#[test]
fn every_log_gets_its_prediction_and_its_rms() {
    let dir = bench(0.017);
    let found = rms_of(dir.path(), &["--out", "out"]);
    let files: Vec<(&str, &str)> = found.iter().map(|(file, role, _)| (file.as_str(), role.as_str())).collect();
    assert_eq!(files, [(LOGS[0], "fit"), (LOGS[1], "validate")]);
    for (file, _, rms) in &found {
        let csv = fs::read_to_string(dir.path().join("out").join(file.replace(".csv", ".predicted.csv"))).unwrap();
        assert!(csv.starts_with("t,q,dq,q_measured\n"));
        let errors: Vec<f64> = csv
            .lines()
            .skip(1)
            .map(|line| {
                let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
                cells[1] - cells[3]
            })
            .collect();
        let written = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        assert!((written - rms).abs() < 1e-6, "{file}: {written} in the file, {rms} reported");
        // The reference robot's own numbers, up to where the bare link hangs: near the sensor's noise of 2.45 mrad.
        assert!((0.002..0.004).contains(rms), "{file}: {rms}");
    }
}

#[test]
fn nominal_parameters_are_used_without_a_fit_and_fitted_ones_with_it() {
    let dir = bench(0.034);
    let nominal = rms_of(dir.path(), &["--out", "a"]);
    assert!(nominal.iter().all(|(_, _, rms)| *rms > 0.02), "twice the friction shows: {nominal:?}");
    expect_code(dir.path(), &["drop", "--study", "study.toml", "--out", "fit", "--quiet"], 0);
    let fitted = rms_of(dir.path(), &["--fit", "fit/fit.json", "--out", "b"]);
    // The second swing was not fitted.
    assert!(fitted.iter().all(|(_, _, rms)| *rms < 0.004), "{fitted:?}");
}

#[test]
fn another_log_is_predicted_as_the_study_says_of_its_first() {
    let dir = bench(0.017);
    fs::create_dir(dir.path().join("other")).unwrap();
    fs::copy(root().join("data/thesis-robot/q1-402g-3.csv"), dir.path().join("other/new.csv")).unwrap();
    let found = rms_of(dir.path(), &["--log", "other/new.csv", "--out", "out"]);
    assert_eq!((found.len(), found[0].0.as_str(), found[0].1.as_str()), (1, "other/new.csv", "validate"));
    assert!(found[0].2 < 0.004, "{found:?}");
    assert!(dir.path().join("out/new.predicted.csv").is_file());
}

#[test]
fn logs_of_one_name_do_not_overwrite_each_other() {
    let dir = bench(0.017);
    for (folder, log) in ["a", "b"].iter().zip(LOGS) {
        fs::create_dir(dir.path().join(folder)).unwrap();
        fs::rename(dir.path().join(log), dir.path().join(folder).join("swing.csv")).unwrap();
    }
    let text = fs::read_to_string(dir.path().join("study.toml")).unwrap();
    let text = text.replace(LOGS[0], "a/swing.csv").replace(LOGS[1], "b/swing.csv");
    fs::write(dir.path().join("study.toml"), text).unwrap();
    rms_of(dir.path(), &["--out", "out"]);
    let [first, second] =
        ["swing", "swing-2"].map(|n| fs::read(dir.path().join("out").join(format!("{n}.predicted.csv"))).unwrap());
    assert_ne!(first, second);
}

#[test]
fn quiet_says_nothing_and_the_table_names_the_parameters() {
    let dir = bench(0.017);
    let text = expect_code(dir.path(), &["simulate", "study.toml", "--out", "out"], 0);
    assert!(text.contains("parameters from study.toml, as given") && text.contains("RMS [mrad]"), "{text}");
    let text = expect_code(dir.path(), &["simulate", "study.toml", "--out", "out", "--quiet"], 0);
    assert!(text.is_empty(), "{text}");
}
