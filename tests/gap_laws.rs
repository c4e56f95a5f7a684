//! Causes without a name: a law is found where one is, says what it depends on, and predicts what it was not fitted to.

mod support;

use aibo_fit::blind::{Cause, OutsideId};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::path::Path;
use support::swing::{swing, swing_under, swings};
use support::*;

const RIGHT: [&str; 4] = ["9.0e-4", "5.0e-3", "0.001", "0.0004"];
const FRICTION: [f64; 2] = [0.001, 0.0004];
/// Ripple of the magnets \[N m\], and the angle after which it repeats \[rad\].
const RIPPLE_NM: f64 = 0.003;
const PERIOD_RAD: f64 = 0.2;

fn diagnosed(folder: &Path) -> (Value, String) {
    let text = expect_code(folder, &["gap", "study.toml", "--out", "out", "--json", "gap.json"], 0);
    (json(&folder.join("gap.json")), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Value of a table at a place, between its knots.
fn at(table: &Value, place: f64) -> f64 {
    let column = |name: &str| -> Vec<f64> {
        table[name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let (x, y) = (column("x"), column("y"));
    let k = x.iter().position(|knot| *knot >= place).unwrap().max(1);
    y[k - 1] + (y[k] - y[k - 1]) * (place - x[k - 1]) / (x[k] - x[k - 1])
}

#[test]
fn cogging_has_no_name_and_is_measured_as_a_law_of_the_angle() {
    let cogging = |q: f64, _: f64| RIPPLE_NM * (TAU * q / PERIOD_RAD).sin();
    let swung = |from: f64| swing_under(&cogging, from, 500, FRICTION);
    let dir = swings(&[("fit", swung(1.2)), ("fit", swung(-0.9)), ("validate", swung(0.7))], RIGHT);
    let (found, text) = diagnosed(dir.path());
    assert_eq!((&found["verdict"], &found["effects"]), (&json!("unexplained"), &json!([])), "{text}");
    let law = &found["law"];
    // What repeats so often within a turn is made by teeth or magnets.
    assert_eq!((&law["variables"], &law["stage"]), (&json!(["angle"]), &json!("gearing")), "{text}");
    assert_eq!((&found["where"]["variable"], &found["where"]["stage"]), (&json!("angle"), &json!("gearing")));
    assert!(law["closed"].as_f64().unwrap() > 0.7, "{text}");
    for place in [-0.35, -0.15, 0.05, 0.15, 0.25] {
        let (measured, true_nm) = (at(&law["table"], place), cogging(place, 0.0));
        assert!((measured - true_nm).abs() < 0.4 * RIPPLE_NM, "{measured} at {place}, {true_nm} expected");
    }
    // Who predicts with this fit has the law, and a step of the encoder is left.
    expect_code(
        dir.path(),
        &["simulate", "study.toml", "--fit", "out/fit.json", "--out", "predicted", "--json", "simulated.json"],
        0,
    );
    let simulated = json(&dir.path().join("simulated.json"));
    for log in simulated["logs"].as_array().unwrap() {
        assert!(log["rms"].as_f64().unwrap() < 5e-3, "{simulated}");
    }
    assert!(dir.path().join("out/law.svg").exists());
}

#[test]
fn where_nothing_is_missing_there_is_no_law() {
    let logs = [("fit", swing(1.2, 500, FRICTION)), ("fit", swing(-0.9, 500, FRICTION))];
    let (found, text) = diagnosed(swings(&logs, RIGHT).path());
    assert_eq!((&found["verdict"], &found["law"]), (&json!("none"), &Value::Null), "{text}");
}

/// Made by the blind trial's own simulator: `blind --cause encoder_drift --trials 1 --seed 11`.
#[test]
#[ignore = "ten seconds"]
fn slow_a_zero_that_creeps_is_a_law_of_the_reading_over_time() {
    let dir = tempfile::tempdir().unwrap();
    write_made(dir.path(), 11, Cause::Outside(OutsideId::EncoderDrift));
    let (found, text) = diagnosed(dir.path());
    let law = &found["law"];
    assert_eq!((&law["acts"], &law["variables"]), (&json!("reading"), &json!(["time"])), "{text}");
    assert_eq!((&found["where"]["variable"], &found["where"]["stage"]), (&json!("time"), &json!("sensor")), "{text}");
    let gap = |key: &str| found["gap"][key].as_f64().unwrap();
    assert!(gap("after") < 0.5 * gap("after_first"), "{text}");
}
