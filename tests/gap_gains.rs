//! Gains of a control law that are not as stated, told by name: of logs that no formula of the program has made.

mod support;

use std::fs;
use support::swing::{swing, swing_under, swings};
use support::*;

const KP: f64 = 0.2;
const KD: f64 = 4.0e-3;
const FREE: [&str; 4] = ["9e-4", "5e-3", "2e-3", "4e-4"];

/// Two driven logs, a held-out one and a free swing of the joint of [`swings`], with the derivative gain stated by a
/// factor too small, and what is believed of the gains.
fn study(too_small: f64, uncertain: &str) -> tempfile::TempDir {
    let friction = [2.0e-3, 4.0e-4];
    let to = |setpoint: f64, from: f64| {
        let motor = move |q: f64, w: f64| KP * (setpoint - q) - KD * w;
        let text = swing_under(&motor, from, 250, friction);
        text.replace("t,q\n", "t,q,q_ref\n").replace('\n', &format!(",{setpoint}\n")).replacen(
            &format!(",{setpoint}"),
            "",
            1,
        )
    };
    let logs = [
        ("fit", to(0.6, -0.5)),
        ("fit", to(-0.4, 0.7)),
        ("validate", to(0.3, -0.8)),
        ("fit", swing(0.9, 300, friction)),
    ];
    let dir = swings(&logs, FREE);
    let path = dir.path().join("study.toml");
    let text = fs::read_to_string(&path).unwrap();
    let driven = text.replacen("\"off\"", "\"position\"", 3);
    let motor = format!("{uncertain}[motor]\nkp = {KP}\nkd = {}\n[[log]]", KD / too_small);
    fs::write(path, driven.replacen("[[log]]", &motor, 1)).unwrap();
    dir
}

#[test]
fn a_derivative_gain_that_is_off_is_the_finding() {
    let dir = study(1.6, "");
    expect_code(dir.path(), &["gap", "study.toml", "--out", "out", "--json", "gap.json"], 0);
    let found = json(&dir.path().join("gap.json"));
    assert_eq!((&found["verdict"], &found["effect"]), (&"calibration".into(), &"kd".into()), "{found}");
    let kd = found["beliefs"]["kd"]["found"].as_f64().unwrap();
    assert!((kd - 1.6).abs() < 0.05, "{kd}");
    assert!((found["beliefs"]["gain"]["found"].as_f64().unwrap() - 1.0).abs() < 0.03, "{found}");
    // What was found is what is simulated.
    let words = ["simulate", "study.toml", "--fit", "out/fit.json", "--out", "run"];
    let text = expect_code(dir.path(), &words, 0);
    let fit = json(&dir.path().join("out/fit.json"));
    assert_eq!(fit["joint"]["kd"]["value"].as_f64(), Some(kd), "{text}");
}

/// Two driven logs and a held-out one of a drive without derivative gain whose proportional gain is stated a third too
/// high, with the torque that arrived.
fn with_torque(motor: &str) -> tempfile::TempDir {
    let to = |setpoint: f64, from: f64| {
        let text = swing_under(&|q, _| KP * (setpoint - q), from, 250, [4.0e-3, 3.0e-3]);
        let rows = text.lines().skip(1).map(|row| {
            let q: f64 = row.split(',').nth(1).unwrap().parse().unwrap();
            format!("{row},{setpoint},{:.5}\n", KP * (setpoint - q))
        });
        format!("t,q,q_ref,tau\n{}", rows.collect::<String>())
    };
    let logs = [("fit", to(0.6, -0.5)), ("fit", to(-0.4, 0.7)), ("validate", to(0.3, -0.8))];
    let dir = swings(&logs, ["9e-4", "5e-3", "4e-3", "3e-3"]);
    let path = dir.path().join("study.toml");
    let driven = fs::read_to_string(&path).unwrap().replace("\"off\"", "\"position\"");
    let motor = format!("[motor]\nkp = {}\nkd = 0.0\n{motor}[[log]]", KP * 4.0 / 3.0);
    fs::write(path, driven.replacen("[[log]]", &motor, 1)).unwrap();
    dir
}

#[test]
fn a_logged_torque_says_what_the_drive_gives() {
    let diagnosed = |motor: &str| {
        let dir = with_torque(motor);
        expect_code(dir.path(), &["gap", "study.toml", "--out", "out", "--json", "gap.json"], 0);
        json(&dir.path().join("gap.json"))
    };
    let says = |found: &serde_json::Value, words: &str| found["undetermined"].to_string().contains(words);
    let with = diagnosed("tau_is = \"applied\"\n");
    assert_eq!((&with["verdict"], &with["effect"]), (&"effect".into(), &"motor_gain".into()), "{with}");
    let gain = with["beliefs"]["gain"]["found"].as_f64().unwrap();
    assert!((gain - 0.75).abs() < 0.04, "{gain}");
    assert!(!says(&with, "log the current"), "{}", with["undetermined"]);
    assert!(with["notes"].to_string().contains("0.75"), "{}", with["notes"]);
    // What was found is what is simulated, with the gain once.
    let dir = with_torque("tau_is = \"applied\"\n");
    expect_code(dir.path(), &["gap", "study.toml", "--out", "out"], 0);
    let text = expect_code(dir.path(), &["simulate", "study.toml", "--fit", "out/fit.json", "--out", "run"], 0);
    let rows = text.lines().filter(|row| row.contains(".csv"));
    let rms_mrad: Vec<f64> = rows.map(|row| row.split_whitespace().last().unwrap().parse().unwrap()).collect();
    assert!(rms_mrad.len() == 3 && rms_mrad.iter().all(|rms| *rms < 1.0), "{text}");
    // A current is the same once it is a torque; and a column of which nothing is said is no evidence.
    let current = diagnosed("tau_is = \"current\"\nkt = 0.5\ngear = 2.0\n");
    assert_eq!(with["beliefs"], current["beliefs"]);
    assert!(says(&diagnosed(""), "log the current"));
}

#[test]
fn gains_that_are_known_stay() {
    let dir = study(1.6, "[uncertain]\ngain = { kd = 0.0 }\n");
    expect_code(dir.path(), &["gap", "study.toml", "--out", "out", "--json", "gap.json"], 0);
    let found = json(&dir.path().join("gap.json"));
    assert!(found["beliefs"].get("kd").is_none() && found["beliefs"].get("gain").is_some(), "{found}");
    assert_ne!(found["effect"], "kd");
}
