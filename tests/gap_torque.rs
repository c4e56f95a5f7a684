//! `aibo-fit gap` where torques along the measured motion are predicted: what is other than described is named with its
//! joint or body, and nothing else is.

mod support;

use serde_json::Value;
use std::path::Path;
use support::arm::{JOINTS, Truth, study};
use support::{run_in, stderr};

fn gap(folder: &Path) -> Value {
    let run = run_in(folder, &["gap", "study.toml", "--quiet", "--json", "gap.json", "--out", "out"]);
    assert!(run.status.success(), "{}", stderr(&run));
    for page in ["out/report.html", "out/arm_shoulder/report.html", "out/arm_elbow/report.html"] {
        assert!(folder.join(page).is_file(), "{page}");
    }
    serde_json::from_str(&std::fs::read_to_string(folder.join("gap.json")).unwrap()).unwrap()
}

fn of(truth: &Truth) -> Value {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path(), &Truth { by_torque: true, period_s: 0.004, ..*truth }, 12.0);
    gap(folder.path())
}

fn value(number: &Value) -> f64 {
    number["value"].as_f64().unwrap_or(f64::NAN)
}

#[test]
fn an_arm_as_described_lacks_nothing() {
    let found = of(&Truth::default());
    assert_eq!((&found["verdict"], &found["gap"]["unit"]), (&"none".into(), &"N m".into()), "{}", found["sentence"]);
    assert!(found["effects"].as_array().unwrap().is_empty(), "{:#?}", found["effects"]);
    for joint in JOINTS {
        let health = &found["joints"][joint]["health"];
        assert!(health.as_array().unwrap().len() > 1, "{health:#?}");
        // Stamps are sums; their differences round.
        assert!((health[0]["period_s"].as_f64().unwrap() - 0.004).abs() < 1e-9, "{health:#?}");
    }
}

#[test]
fn drag_of_the_elbow_is_found_on_the_elbow() {
    let found = of(&Truth { drag: 0.1, ..Truth::default() });
    let effects = found["effects"].as_array().unwrap();
    assert_eq!((effects.len(), &effects[0]["id"]), (1, &"quadratic_drag".into()), "{effects:#?}");
    assert_eq!(effects[0]["joints"][0], JOINTS[1]);
    assert!((value(&effects[0]["parameters"]["c2"]) - 0.1).abs() < 0.01, "{effects:#?}");
    assert!(found["gap"]["after"].as_f64().unwrap() < found["gap"]["calibrated"].as_f64().unwrap());
}

/// Both joints carry it, so it is one number of both and not two wrong moments.
#[test]
fn a_payload_is_one_cause_of_both_joints() {
    let found = of(&Truth { payload_kg: 0.2, ..Truth::default() });
    let cause = &found["effects"][0];
    assert_eq!((&cause["id"], &cause["body"]), (&"payload".into(), &"lower".into()), "{}", found["sentence"]);
    assert_eq!(cause["joints"].as_array().unwrap().len(), 2);
    assert!((value(&cause["parameters"]["mass"]) - 0.2).abs() < 0.03, "{cause:#}");
    assert!((value(&cause["parameters"]["z"]) + 0.25).abs() < 0.03, "{cause:#}");
    assert_eq!((&found["verdict"], &found["effect"]), (&"effect".into(), &"payload".into()));
    assert_eq!(found["effects"].as_array().unwrap().len(), 1, "{:#?}", found["effects"]);
}

#[test]
fn dry_friction_that_is_twice_the_described_is_a_wrong_number() {
    let found = of(&Truth { friction: 2.5, ..Truth::default() });
    assert_eq!(found["verdict"], "calibration", "{}", found["sentence"]);
    for (joint, believed) in JOINTS.iter().zip([0.06, 0.04]) {
        let own = &found["joints"][joint];
        let coulomb = value(&own["joint"]["coulomb"]);
        assert!((coulomb / believed - 2.5).abs() < 0.25, "{joint}: {coulomb}");
    }
}

#[test]
fn torques_are_asked_for_where_there_are_none() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path(), &Truth { by_torque: true, ..Truth::default() }, 1.0);
    for log in ["log0.csv", "log1.csv", "log2.csv"] {
        let path = folder.path().join(log);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace(".tau", ".felt")).unwrap();
    }
    let run = run_in(folder.path(), &["gap", "study.toml"]);
    assert_eq!(run.status.code(), Some(3));
    assert!(stderr(&run).contains("<joint>.tau"), "{}", stderr(&run));
}
