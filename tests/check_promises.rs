//! What `aibo-fit check` promises, as the whole program: the health of any log, and of a study what its logs can tell.

mod support;

use serde_json::Value;
use std::fs;
use support::*;

fn checked(path: &str) -> (String, Value) {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("check.json");
    let said = expect_code(root(), &["check", path, "--json", &file.to_string_lossy()], 0);
    (said, json(&file))
}

#[test]
fn a_study_is_told_what_its_logs_cannot_determine_and_what_they_would_show() {
    let (said, json) = checked("data/examples/delay/study.toml");
    for part in ["chirp-0.csv", "period", "What these logs cannot determine", "weigh the link", "Smallest size"] {
        assert!(said.contains(part), "`{part}` is missing in\n{said}");
    }
    assert_eq!((&json["schema"], &json["health"][0]["samples"]), (&1.into(), &1250.into()));
    let sentences = json["undetermined"].as_array().unwrap();
    // Setpoints alone: a heavier link under a stronger drive moves the same.
    assert!(sentences.iter().any(|s| s.as_str().unwrap().contains("gain")), "{sentences:?}");
    // The logs were made with a delay of 16 ms, and the answer is a delay: they have to be able to show one.
    let shown = json["detectable"]["delay"]["value"].as_f64().unwrap();
    assert!(shown > 0.0 && shown < 0.016, "{shown} s");
    let gap = ["before", "calibrated", "floor"].map(|key| json["gap"][key].as_f64().unwrap());
    assert!(gap.is_sorted_by(|a, b| a > b), "{gap:?}");
    let (moved, unit) = (&json["beliefs"]["inertia"]["moved_sd"], &json["beliefs"]["inertia"]["unit"]);
    assert!(moved.is_number() && unit == "kg m^2");
}

#[test]
fn of_a_log_alone_the_health_is_told_and_that_a_study_is_needed_for_the_rest() {
    let (said, json) = checked("data/q1.csv");
    assert!(said.contains("data/q1.csv") && said.contains("give a study"), "{said}");
    assert!(!said.contains("Smallest size") && json.get("detectable").is_none());
    let step_rad = json["health"][0]["resolution_rad"].as_f64().unwrap();
    assert!((step_rad - 0.006).abs() < 1e-5, "{step_rad}");
}

#[test]
fn nothing_to_check_is_said_with_the_exit_codes_of_every_command() {
    let dir = tempfile::tempdir().unwrap();
    expect_code(dir.path(), &["check", "nowhere.toml"], 5);
    expect_code(dir.path(), &["check"], 2);
    let still: String = (0..200).map(|k| format!("{:.3},0.1\n", 0.008 * f64::from(k))).collect();
    fs::write(dir.path().join("still.csv"), format!("t,q\n{still}")).unwrap();
    assert!(expect_code(dir.path(), &["check", "still.csv"], 1).contains("nothing to check"));
    fs::write(dir.path().join("dog.toml"), "schema = 1\n[robot]\nmodel = \"ers7\"\n").unwrap();
    expect_code(dir.path(), &["check", "dog.toml"], 2);
}
