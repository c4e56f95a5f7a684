//! What `aibo-fit tables` promises: printed numbers recovered, named where they cannot be, the same bytes every time.

mod support;

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;
use support::root;

fn run(out: &Path, json: &Path, threads: &str) {
    let mut command = Command::cargo_bin("aibo-fit").expect("built");
    command
        .current_dir(root())
        .args(["tables", "--quiet", "--threads", threads, "--out"])
        .arg(out)
        .arg("--json")
        .arg(json);
    command.assert().success();
}

/// An end of a row's interval.
fn number_at(row: &Value, end: usize) -> f64 {
    row["interval"][end].as_f64().unwrap_or(f64::NAN)
}

fn rows(tables: &Value, key: &str) -> Vec<Value> {
    tables[key].as_array().unwrap_or_else(|| panic!("{key} has rows")).clone()
}

#[test]
#[ignore = "slow"]
fn slow_the_thesis_robot_is_recovered_and_what_cannot_be_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = |name: &str| folder.path().join(name);
    run(&out("one"), &out("one.json"), "1");
    run(&out("two"), &out("two.json"), "2");
    for name in ["tables.csv", "robot.toml", "puzzle-q3.svg"] {
        let read = |run: &str| std::fs::read(out(run).join(name)).expect("written");
        assert_eq!(read("one"), read("two"), "{name} depends on the number of threads");
    }

    let text = std::fs::read_to_string(out("one.json")).expect("written");
    let tables: Value = serde_json::from_str(&text).expect("JSON");
    let number = |row: &Value, key: &str| row[key].as_f64().unwrap_or(f64::NAN);
    let half = |row: &Value| 0.5 * (number_at(row, 1) - number_at(row, 0));
    for row in rows(&tables, "table_3_2") {
        assert_eq!(row["inside"], Value::Bool(true), "{row}");
        let shoulder = row["body"] == "shoulder";
        assert_eq!(row["identifiable"], Value::Bool(!shoulder), "{row}");
        assert!(shoulder || half(&row) < 0.15 * number(&row, "ours"), "{row}");
    }
    for row in rows(&tables, "table_3_3") {
        assert_eq!(row["inside"], Value::Bool(true), "{row}");
        assert!(half(&row) < 0.002, "{row}");
    }
    let arithmetic = rows(&tables, "table_3_1_arithmetic");
    let outside: Vec<&Value> = arithmetic.iter().filter(|row| row["inside"] == Value::Bool(false)).collect();
    assert_eq!(outside.len(), 1, "only the mass of q1 does not follow from its own ratios");
    assert_eq!((&outside[0]["joint"], &outside[0]["quantity"]), (&"q1".into(), &"mass".into()));
    assert_eq!(rows(&tables, "table_3_4").len(), 6);

    let robot = out("one").join("robot.toml");
    aibo_fit::robot::Model::read(&robot).expect("the simulator loads the robot");
}
