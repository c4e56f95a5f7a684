//! `aibo-fit gap` with `--fix`, `--free`, `--bound` and `--start`: what is demanded holds, is stated, and what cannot be
//! is refused.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use support::*;

const USAGE: i32 = 2;

/// The study of the delay example, in a folder of its own.
fn delay() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    for file in ["study.toml", "chirp-0.csv"] {
        fs::copy(root().join("data/examples/delay").join(file), dir.path().join(file)).unwrap();
    }
    dir
}

fn diagnosed(folder: &Path, demands: &[&str]) -> (Value, String) {
    let words = [&["gap", "study.toml", "--out", "out", "--json", "gap.json"], demands].concat();
    let text = expect_code(folder, &words, 0);
    (json(&folder.join("gap.json")), text)
}

#[test]
fn held_numbers_stay_and_are_stated() {
    let dir = delay();
    let (found, text) =
        diagnosed(dir.path(), &["--fix", "moment", "--fix", "inertia=0.0101", "--fix", "delay.T=0.0161"]);
    assert_eq!(found["joint"]["moment"]["value"], 0.05);
    assert_eq!(found["joint"]["inertia"]["value"], 0.0101);
    assert!(found["beliefs"].get("inertia").is_none() && found["beliefs"].get("coulomb").is_some(), "{found}");
    assert_eq!(found["effects"][0]["id"], "delay");
    assert_eq!(found["effects"][0]["parameters"]["T"]["value"], 0.0161);
    assert_eq!(found["demands"]["fix"]["delay.T"], 0.0161);
    assert_eq!(found["demands"]["fix"]["moment"], Value::Null);
    assert!(text.contains("As demanded: moment held as given; inertia held at 0.0101"), "{text}");
}

#[test]
fn a_held_number_is_never_the_finding() {
    let dir = delay();
    let catalogue = ["--only", "end_stop"];
    let (free, _) = diagnosed(dir.path(), &catalogue);
    let moved = |found: &Value, name: &str| found["beliefs"][name]["moved_sd"].as_f64();
    assert!(moved(&free, "gain").is_some(), "{free}");
    let (held, _) = diagnosed(dir.path(), &[&catalogue[..], &["--fix", "gain"]].concat());
    assert_eq!((moved(&held, "gain"), &held["effect"] == "motor_gain"), (None, false), "{held}");
    let withheld = held["withheld"].as_array().unwrap();
    assert!(withheld.contains(&"motor_gain".into()), "who knows the gain has no wrong one: {withheld:?}");
}

/// Refitted it is a fiftieth of what is stated; nothing was said of that once.
#[test]
fn a_gain_in_another_unit_is_questioned() {
    let dir = delay();
    let study = dir.path().join("study.toml");
    fs::write(&study, fs::read_to_string(&study).unwrap().replace("kp = 8.0", "kp = 400.0")).unwrap();
    let (found, _) = diagnosed(dir.path(), &["--only", "end_stop"]);
    let doubts = found["doubts"].to_string();
    assert!(doubts.contains("in place of 400: is kp in N m/rad"), "{doubts}");
}

#[test]
fn freed_numbers_have_no_belief_and_bounds_hold() {
    let dir = delay();
    let (found, _) = diagnosed(dir.path(), &["--free", "rest", "--free", "moment", "--bound", "T_h=0.01:0.02"]);
    assert!(found["beliefs"].get("moment").is_none() && found["beliefs"].get("inertia").is_some(), "{found}");
    let (value, interval, identifiable) = quantity(&found["joint"]["rest"]);
    assert!(value != Some(0.0) && interval.is_some() && identifiable, "{}", found["joint"]);
    assert_eq!(
        (&found["demands"]["free"][1], &found["demands"]["bound"]["setpoint_hold.T_h"][1]),
        (&"moment".into(), &0.02.into())
    );
    let (found, _) =
        diagnosed(dir.path(), &["--only", "delay", "--bound", "delay.T=0,0.01", "--start", "inertia=0.02"]);
    let delay_s = found["effects"][0]["parameters"]["T"]["value"].as_f64().unwrap();
    assert!(delay_s <= 0.01, "{delay_s}");
    assert!((found["gap"]["before"].as_f64().unwrap() - 0.0753).abs() < 1e-3, "as given is not where a search begins");
}

#[test]
fn what_cannot_be_demanded_is_refused_with_what_can() {
    let dir = delay();
    let refused = |words: &[&str], parts: &[&str]| {
        let words = [&["gap", "study.toml"], words].concat();
        let output = run_in(dir.path(), &words);
        let err = stderr(&output);
        assert_eq!(output.status.code(), Some(USAGE), "{words:?}\n{err}");
        assert!(parts.iter().all(|part| err.contains(part)), "{words:?}\n{err}");
    };
    refused(&["--fix", "mumble=2"], &["`mumble`", "coulomb", "delay.T", "gain", "inertia", "viscous"]);
    refused(&["--fix", "T=0.01"], &["several effects", "delay.T or sensor_delay.T"]);
    refused(&["--fix", "delay.T"], &["`delay.T` has no nominal value", "--fix delay.T=VALUE"]);
    refused(&["--fix", "backlash.rotor=2"], &["`backlash.rotor` = 2 is impossible", "0.001 to 0.999"]);
    refused(&["--free", "end_stop.side"], &["`end_stop.side`", "-1 or 1"]);
    refused(&["--start", "inertia=-1"], &["`inertia` = -1 kg m^2", "above zero"]);
    refused(&["--start", "stribeck.mu_st=0.02"], &["`stribeck.mu_st` is worked out", "write stribeck.static_excess"]);
    refused(&["--fix", "phi=0.1"], &["write position_friction.a_cos_phi and position_friction.a_sin_phi"]);
    refused(&["--fix", "moment", "--free", "moment"], &["--fix and --free"]);
    fs::write(dir.path().join("chirp-0.csv"), good_log()).unwrap();
    let study = fs::read_to_string(dir.path().join("study.toml")).unwrap();
    fs::write(dir.path().join("study.toml"), study.replace("\"position\"", "\"off\"")).unwrap();
    refused(&["--free", "gain"], &["`gain`", "this fit has"]);
    fs::write(dir.path().join("study.toml"), "schema = 1\n[robot]\nmodel = \"ers7.toml\"\nscenario = \"air\"\n")
        .unwrap();
    refused(&["--fix", "inertia"], &["for the study of a joint"]);
}
