//! `aibo-fit drop` on a study that states numbers: they weigh in as far as they are believed, and what the logs leave to
//! them is said.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use support::swing::{swing, swings};
use support::*;

/// What swings: I [kg m^2], M [kg m], Coulomb [N m] and viscous friction [N m s/rad].
const INERTIA: f64 = 9.0e-4;
const MOMENT: f64 = 5.0e-3;
const FRICTION: [f64; 2] = [0.001, 0.0004];

/// Two swings of the joint, with an inertia in the study that is a fifth too large.
fn bench() -> tempfile::TempDir {
    let log = |from: f64| ("fit", swing(from, 400, FRICTION));
    swings(&[log(0.9), log(-0.6)], ["1.08e-3", "5.0e-3", "0.001", "0.0004"])
}

fn fitted(folder: &Path, words: &[&str]) -> (Value, String) {
    let all = [&["drop", "--study", "study.toml", "--out", "fit"], words].concat();
    let text = expect_code(folder, &all, 0);
    (json(&folder.join("fit/fit.json")), text)
}

fn value(fit: &Value, name: &str) -> f64 {
    fit["joint"][name]["value"].as_f64().unwrap_or_else(|| panic!("{name} in {fit}"))
}

#[test]
fn logs_give_the_ratio_and_beliefs_the_scale() {
    let dir = bench();
    let (fit, text) = fitted(dir.path(), &[]);
    let (inertia, moment) = (value(&fit, "inertia"), value(&fit, "moment"));
    assert!((moment / inertia / (MOMENT / INERTIA) - 1.0).abs() < 0.01, "{moment} to {inertia}");
    // Twice as sure of the moment as of the inertia: it gives way by a fifth of what they disagree.
    assert!((moment / MOMENT - 1.04).abs() < 0.015, "{moment}");
    let (_, interval, _) = quantity(&fit["joint"]["moment"]);
    let half_width = interval.map(|[low, high]| 0.5 * (high - low) / moment).unwrap();
    assert!((0.06..0.12).contains(&half_width), "that of the beliefs, 1.96 times 4.5 %: {half_width}");
    let belief = &fit["beliefs"]["inertia"];
    assert!((belief["sd"].as_f64().unwrap() / 1.08e-4 - 1.0).abs() < 1e-6, "{belief}");
    assert!((belief["moved_sd"].as_f64().unwrap() + 1.5).abs() < 0.3, "{belief}");
    let said = fit["undetermined"][0].as_str().unwrap();
    assert!(said.contains("inertia and moment apart") && said.contains("ratios of torques"), "{said}");
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(said) && text.contains("believed") && text.contains("0.00500 ± 0.00025 kg m"), "{text}");
    let page = fs::read_to_string(dir.path().join("fit/report.html")).unwrap();
    assert!(page.contains("What was believed"), "the page has the table, too");
}

#[test]
fn who_is_sure_of_a_number_gets_it_back_and_who_is_not_gets_what_the_others_say() {
    let dir = bench();
    let (fit, _) = fitted(dir.path(), &["--fix", "moment"]);
    assert!(fit["beliefs"].get("moment").is_none() && value(&fit, "moment") == MOMENT, "{}", fit["joint"]);
    assert!((value(&fit, "inertia") / INERTIA - 1.0).abs() < 0.01, "{}", fit["joint"]);
    let (fit, _) = fitted(dir.path(), &["--free", "moment"]);
    assert!(fit["beliefs"].get("moment").is_none() && fit["beliefs"].get("inertia").is_some(), "{}", fit["beliefs"]);
    assert!((value(&fit, "inertia") / 1.08e-3 - 1.0).abs() < 0.02, "{}", fit["joint"]);
    let path = dir.path().join("study.toml");
    let study = fs::read_to_string(&path).unwrap();
    fs::write(&path, study.replace("[sensor]", "[uncertain]\nmoment = 0\n[sensor]")).unwrap();
    let (fit, _) = fitted(dir.path(), &[]);
    assert_eq!(value(&fit, "moment"), MOMENT);
}

#[test]
fn without_stated_numbers_nothing_is_believed() {
    let dir = bench();
    let fit = drop_json(dir.path(), &["0.csv"]);
    assert!(fit.get("beliefs").is_none() && fit.get("undetermined").is_none(), "{fit}");
    assert_eq!(fit["joint"]["inertia"]["identifiable"], false);
}
