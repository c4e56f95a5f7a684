//! `aibo-fit dynamics`: answers in the format of the shared sample, and one clear error for every wrong file.

mod support;

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;
use support::{root, shared};

fn command() -> Command {
    let mut command = Command::cargo_bin("aibo-fit").expect("built");
    command.current_dir(root()).arg("dynamics");
    command
}

fn example() -> String {
    fs::read_to_string(root().join("data/examples/states.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

/// Largest difference in units of the largest number.
fn apart(found: &Value, expected: &Value) -> f64 {
    let (found, expected) = (numbers(found), numbers(expected));
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(1e-300, |most: f64, x| most.max(x.abs()));
    found.iter().zip(&expected).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / largest
}

#[test]
fn the_shared_sample_is_answered_in_its_own_format() {
    let Some(folder) = shared("ers7") else { return };
    let sample = folder.join("dynamics-sample.json");
    let out = tempfile::tempdir().unwrap();
    let json = out.path().join("answers.json");
    command().arg(&sample).arg("--json").arg(&json).args(["--repeat", "20"]).assert().success();
    let read = |file: &Path| -> Value { serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap() };
    let (found, expected) = (read(&json), read(&sample));
    assert_eq!(found["conventions"]["joint_order"], expected["conventions"]["joint_order"]);
    assert!(found["timing"]["median_us"].as_f64().unwrap() > 0.0);
    let (found, expected) = (found["states"].as_array().unwrap(), expected["states"].as_array().unwrap());
    assert_eq!(found.len(), expected.len());
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        for key in ["q", "dq", "tau", "base_pos", "base_vel_world", "base_omega_body"] {
            assert_eq!(found[key], expected[key]);
        }
        let (found, expected) = (&found["out"], expected["out"].as_object().unwrap());
        for (key, value) in expected {
            if key == "body_pos" {
                for (body, place) in value.as_object().unwrap() {
                    assert!(
                        apart(&found[key][body], place) < 1e-13 || apart(&found[key][body], place).is_nan(),
                        "{body}"
                    );
                }
                assert_eq!(found[key].as_object().unwrap().len(), value.as_object().unwrap().len());
                continue;
            }
            let allowed = if key == "qacc" { 1e-9 } else { 1e-12 };
            let error = apart(&found[key], value);
            let is_nothing = numbers(value).iter().all(|x| x.abs() < 1e-12);
            assert!(error < allowed || is_nothing, "state {index}: {key} is {error:e} apart");
        }
    }
}

#[test]
fn a_table_without_json_and_the_time_when_asked() {
    let output = command().args(["data/examples/states.json", "--repeat", "3"]).assert().success();
    let text = String::from_utf8_lossy(&output.get_output().stdout).into_owned();
    assert!(text.starts_with("ers7: 23 bodies, 22 joints\n"), "{text}");
    assert!(text.contains("forward dynamics: ") && text.contains(" us (median of 3 goes"), "{text}");
    command().args(["data/examples/states.json", "--quiet"]).assert().success().stdout("");
}

#[test]
fn answers_can_be_asked_again_and_are_the_same() {
    let out = tempfile::tempdir().unwrap();
    let [first, second] = ["first.json", "second.json"].map(|name| out.path().join(name));
    command().arg("data/examples/states.json").arg("--json").arg(&first).assert().success();
    command().arg(&first).arg("--json").arg(&second).assert().success();
    let states = |file: &Path| -> Value {
        serde_json::from_str::<Value>(&fs::read_to_string(file).unwrap()).unwrap()["states"].clone()
    };
    assert_eq!(states(&first), states(&second));
    // A result never takes the place of a file that was read.
    let before = fs::read(&first).unwrap();
    command().arg(&first).arg("--json").arg(&first).assert().code(2);
    assert_eq!(fs::read(&first).unwrap(), before);
}

#[test]
fn another_robot_from_a_file_of_its_own() {
    let out = tempfile::tempdir().unwrap();
    let (states, json) = (out.path().join("states.json"), out.path().join("answers.json"));
    fs::write(&states, r#"[{"q": [0.3, -0.5, 1.0], "dq": [1, 2, 3], "tau": [0.1, 0, 0]}]"#).unwrap();
    let robot = ["--robot", "data/examples/robots/three-link.toml"];
    command().arg(&states).args(robot).arg("--json").arg(&json).assert().success();
    let found: Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    let out = &found["states"][0]["out"];
    let (matrix, qacc, bias) = (&out["M"], numbers(&out["qacc"]), numbers(&out["bias"]));
    assert_eq!(qacc[..6], [0.0; 6]);
    for (row, tau) in [(6, 0.1), (7, 0.0), (8, 0.0)] {
        let product: f64 = numbers(&matrix[row]).iter().zip(&qacc).map(|(m, a)| m * a).sum();
        assert!((product + bias[row] - tau).abs() < 1e-12, "row {row}");
    }
    // Its base is clamped.
    fs::write(&states, r#"[{"base_vel_world": [1, 0, 0], "q": [0, 0, 0], "dq": [0, 0, 0], "tau": [0, 0, 0]}]"#)
        .unwrap();
    let output = command().arg(&states).args(robot).assert().code(3);
    let error = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
    assert!(error.contains("states[0].base_vel_world: found [1.0, 0.0, 0.0], expected zeros"), "{error}");
}

#[test]
fn a_wrong_state_file_names_file_key_and_index() {
    let out = tempfile::tempdir().unwrap();
    let file = out.path().join("mine.json");
    let text = example();
    let q = "\"q\": [0.0, 0.0,";
    assert!(text.contains(q));
    let cases: Vec<(String, u8, Vec<&str>)> = vec![
        (String::new(), 3, vec!["expected {\"states\": [...]}"]),
        ("[]".into(), 3, vec!["states: the list is empty"]),
        ("{\"state\": []}".into(), 3, vec!["key `states` is missing"]),
        ("{\"states\": 3}".into(), 3, vec!["states: found 3, expected a list"]),
        ("[7]".into(), 3, vec!["states[0]: found 7, expected an object"]),
        (text.replacen(q, "\"q\": [0.0,", 1), 3, vec!["states[0].q: found 21 numbers, expected 22 numbers [rad]"]),
        (
            text.replacen(q, "\"q\": [0.0, \"x\",", 1),
            3,
            vec!["states[0].q[1]: found the text \"x\", expected a number"],
        ),
        (text.replacen(q, "\"q\": [0.0, null,", 1), 3, vec!["states[0].q[1]: found null"]),
        (text.replacen(q, "\"q\": [0.0, NaN,", 1), 3, vec!["states[0].q[1]: ", "line 6", "expected a finite number"]),
        (text.replacen(q, "\"q\": [0.0, 1e999,", 1), 3, vec!["states[0].q[1]: ", "number out of range"]),
        (text.replacen("-0.0524", "-Infinity", 1), 3, vec!["states[1].q[15]: ", "expected a finite number"]),
        (text.replacen("\"tau\"", "\"torque\"", 1), 3, vec!["states[0].tau is missing, expected 22 numbers [N m]"]),
        (
            text.replacen("[1, 0, 0, 0]", "[1, 1, 0, 0]", 1),
            3,
            vec!["states[0].base_quat_wxyz: found one of length 1.414"],
        ),
        (
            text.replacen("[1, 0, 0, 0]", "[1, 0, 0]", 1),
            3,
            vec!["states[0].base_quat_wxyz: found 3 numbers, expected 4"],
        ),
        (text.replacen("[0.3, -0.2, 0.5]", "[1e300, 0, 0]", 1), 4, vec!["states[2]: the answer is not finite"]),
    ];
    for (content, code, says) in cases {
        fs::write(&file, &content).unwrap();
        let output = command().arg(&file).assert().code(i32::from(code));
        let error = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
        assert!(error.contains("mine.json: "), "{error}");
        assert!(says.iter().all(|part| error.contains(part)), "{says:?}: {error}");
        assert_eq!(error.matches("error: ").count(), 1, "{error}");
        assert!(output.get_output().stdout.is_empty());
    }
    command().arg(out.path().join("absent.json")).assert().code(5);
    command().args(["data/examples/states.json", "--repeat", "0"]).assert().code(2);
    command().args(["data/examples/states.json", "--robot", "data/q1.toml"]).assert().code(3);
    command().args(["data/examples/states.json", "--robot", "absent.toml"]).assert().code(5);
}
