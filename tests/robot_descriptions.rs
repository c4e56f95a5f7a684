//! Descriptions of robots in use and traps, against the numbers of two engines: `aibo-fit dynamics REFERENCE --robot FILE`.

mod support;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use support::{expect_code, json, root, run_in, shared, stderr};

/// Two engines agree among themselves to 1e-12 mostly; a wrong convention shows at 1e-3.
const AGREES: f64 = 1e-9;

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap_or_else(|| panic!("{other} is no number"))],
    }
}

fn words(value: &Value) -> Vec<&str> {
    value.as_array().into_iter().flatten().map(|word| word.as_str().unwrap()).collect()
}

/// Largest difference, each in units of its row, over the largest entry.
fn apart(found: &[f64], expected: &[f64], unit: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let scaled = |numbers: &mut dyn Iterator<Item = f64>| {
        numbers.zip(unit).fold(0.0, |most: f64, (number, unit)| most.max((number / unit).abs()))
    };
    let largest = scaled(&mut expected.iter().copied());
    let apart = scaled(&mut found.iter().zip(expected).map(|(found, expected)| found - expected));
    // Where nothing acts there is nothing to be relative to.
    if largest < 1e-9 { apart } else { apart / largest }
}

/// An answer's vectors in the order of a reference.
struct Order(Vec<usize>);

impl Order {
    fn of(answer: &Value, reference: &Value) -> Self {
        let base = if reference["base"] == "free" { 6 } else { 0 };
        let ours = words(&answer["conventions"]["joint_order"]);
        let place =
            |name: &&str| base + ours.iter().position(|other| other == name).unwrap_or_else(|| panic!("no {name}"));
        assert_eq!(ours.len(), words(&reference["joint_order"]).len());
        Self((0..base).chain(words(&reference["joint_order"]).iter().map(place)).collect())
    }

    fn vector(&self, value: &Value) -> Vec<f64> {
        self.0.iter().map(|place| value[*place].as_f64().unwrap()).collect()
    }
}

fn compare_state(what: &str, order: &Order, condition: f64, found: &Value, expected: &Value) {
    let matrix: Vec<Vec<f64>> = order.0.iter().map(|row| order.vector(&found["M"][*row])).collect();
    let unit: Vec<f64> = (0..matrix.len()).map(|k| matrix[k][k].sqrt()).collect();
    let inverse: Vec<f64> = unit.iter().map(|unit| 1.0 / unit).collect();
    let check = |key: &str, apart: f64| assert!(apart < AGREES, "{what}: {key} is {apart:e} apart");
    if let Some(rows) = expected["M"].as_array() {
        for ((row, expected), unit_row) in matrix.iter().zip(rows).zip(&unit) {
            let worst = row.iter().zip(numbers(expected)).zip(&unit);
            check("M", worst.fold(0.0, |most: f64, ((a, b), unit)| most.max((a - b).abs() / (unit * unit_row))));
        }
    }
    let product = |k: usize| matrix[k].iter().enumerate().map(|(j, m)| m * ((j + 1) as f64).cos()).sum();
    let products: Vec<f64> = (0..matrix.len()).map(product).collect();
    check("M_times_w", apart(&products, &numbers(&expected["M_times_w"]), &unit));
    for key in ["bias", "gravity"] {
        let (found, expected) = (order.vector(&found[key]), numbers(&expected[key]));
        check(key, apart(&found, &expected, &unit));
    }
    let squared: Vec<f64> = unit.iter().map(|unit| unit * unit).collect();
    check("M_diag", apart(&order.vector(&found["M_diag"]), &numbers(&expected["M_diag"]), &squared));
    let qacc = apart(&order.vector(&found["qacc"]), &numbers(&expected["qacc"]), &inverse);
    assert!(qacc < AGREES * condition.max(1.0), "{what}: qacc is {qacc:e} apart");
    if let Some(rigid) = expected.get("rigid") {
        let qacc = apart(&order.vector(&found["rigid"]["qacc"]), &numbers(&rigid["qacc"]), &inverse);
        assert!(qacc < AGREES * condition.max(1.0), "{what}: rigid qacc is {qacc:e} apart");
        check("rigid M_trace", apart(&numbers(&found["rigid"]["M_trace"]), &numbers(&rigid["M_trace"]), &[1.0]));
    }
    for key in ["com", "com_vel", "com_moving", "kinetic_energy", "potential_energy", "M_logdet"] {
        let (found, expected) = (numbers(&found[key]), numbers(&expected[key]));
        check(key, apart(&found, &expected, &vec![1.0; expected.len()]));
    }
    for (link, place) in expected["body_pos"].as_object().unwrap() {
        let (found, expected) = (numbers(&found["body_pos"][link]), numbers(place));
        let apart = found.iter().zip(expected).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        check(&format!("place of {link}"), apart);
    }
}

/// Joints by name, as a reference has them.
fn compare_joints(what: &str, found: &Value, expected: &Value) {
    for joint in expected.as_array().unwrap() {
        let name = joint["name"].as_str().unwrap();
        let ours = found.as_array().unwrap().iter().find(|ours| ours["name"] == name);
        let ours = ours.unwrap_or_else(|| panic!("{what}: no joint {name}"));
        for (key, value) in joint.as_object().unwrap() {
            let what = format!("{what}: joint {name}: {key} = {}, expected {value}", ours[key]);
            match value {
                Value::Number(_) | Value::Array(_) => {
                    let (ours, mut value) = (numbers(&ours[key]), numbers(value));
                    if key == "axis" {
                        let length = value.iter().map(|x| x * x).sum::<f64>().sqrt();
                        value.iter_mut().for_each(|x| *x /= length);
                    }
                    assert!(ours.len() == value.len(), "{what}");
                    assert!(ours.iter().zip(value).all(|(a, b)| (a - b).abs() < AGREES), "{what}");
                }
                _ => assert_eq!(ours[key], *value, "{what}"),
            }
        }
        assert_eq!(ours.get("limit").is_some(), joint.get("limit").is_some(), "{what}: limit of {name}");
    }
}

/// Asks for one reference; false where its description is not among the shared files.
fn compare(robots: &Path, file: &Path) -> bool {
    let reference = json(file);
    let what = file.file_name().unwrap().to_string_lossy().into_owned();
    let name = |key: &str| reference[key].as_str().unwrap();
    let robot = robots.join("descriptions").join(name("robot")).join(name("file"));
    if !robot.is_file() {
        println!("skipped: {what}: its description is not among the shared files");
        return false;
    }
    let out = tempfile::tempdir().unwrap();
    let answer = out.path().join("answer.json");
    let words_of = |path: &Path| path.to_string_lossy().into_owned();
    let (asked, robot) = (words_of(file), words_of(&robot));
    let output = run_in(out.path(), &["dynamics", &asked, "--robot", &robot, "--json", &words_of(&answer), "--quiet"]);
    let said = stderr(&output);
    assert!(!said.contains("panicked"), "{what}: {said}");
    let may_refuse = words(&reference["may_refuse"]);
    if output.status.code() == Some(3) && !may_refuse.is_empty() {
        assert!(may_refuse.iter().any(|word| said.contains(word)), "{what}: {said}");
        println!("{what}: refused: {said}");
        return true;
    }
    assert_eq!(output.status.code(), Some(0), "{what}: {said}");
    let answer = json(&answer);
    let order = Order::of(&answer, &reference);
    let condition = reference["condition_scaled_M"].as_f64().unwrap();
    let states = answer["states"].as_array().unwrap().iter().zip(reference["states"].as_array().unwrap());
    for (index, (found, expected)) in states.enumerate() {
        compare_state(&format!("{what}: state {index}"), &order, condition, &found["out"], &expected["out"]);
    }
    for key in ["total_mass", "moving_mass"] {
        let (found, expected) = (numbers(&answer[key]), numbers(&reference[key]));
        assert!(apart(&found, &expected, &[1.0]) < AGREES, "{what}: {key} {found:?}, expected {expected:?}");
    }
    compare_joints(&what, &answer["joints"], &reference["joints"]);
    true
}

#[test]
fn every_shared_description_moves_as_in_two_engines() {
    let Some(robots) = shared("robots") else { return };
    let mut files: Vec<PathBuf> =
        fs::read_dir(robots.join("reference")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let compared = files.iter().filter(|file| compare(&robots, file)).count();
    println!("{compared} of {} references compared", files.len());
    assert!(compared > 35, "{compared} references were compared");
}

/// Writes a robot and a state of it, and asks; the exit code has to be as expected.
fn ask(robot: &str, state: &str, more: &[&str], code: i32) -> (Option<Value>, String) {
    let out = tempfile::tempdir().unwrap();
    fs::write(out.path().join("robot.xml"), robot).unwrap();
    fs::write(out.path().join("q.json"), state).unwrap();
    let all = [&["dynamics", "q.json", "--robot", "robot.xml", "--json", "a.json", "--quiet"], more].concat();
    let output = run_in(out.path(), &all);
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    let answer = out.path().join("a.json");
    (answer.is_file().then(|| json(&answer)), stderr(&output))
}

const PENDULUM: &str = r#"<robot name="p"><link name="base"/>
  <link name="rod"><inertial><origin xyz="0 0 -.5"/><mass value="2"/><inertia ixx=".1" iyy=".1" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"#;

#[test]
fn a_pendulum_falls_as_it_does_on_paper() {
    // M = 0.1 + 2 * 0.5^2 = 0.6; m g l sin q = 2 * 9.81 * 0.5 sin 0.3.
    let (answer, said) = ask(PENDULUM, r#"[{"q": {"j": 0.3}, "dq": {"j": 0}, "tau": {"j": 0.5}}]"#, &[], 0);
    let answer = answer.unwrap();
    let out = &answer["states"][0]["out"];
    let pull = 2.0 * 9.81 * 0.5 * 0.3_f64.sin();
    assert!((out["M"][0][0].as_f64().unwrap() - 0.6).abs() < 1e-15);
    assert!((out["bias"][0].as_f64().unwrap() - pull).abs() < 1e-14);
    assert!((out["qacc"][0].as_f64().unwrap() - (0.5 - pull) / 0.6).abs() < 1e-14);
    assert_eq!(said, "");
    // Free, it takes the base along; gravity is the states' where they say so.
    let state = r#"{"base": "free", "gravity": [0, 0, 0], "states": [{"base_pos": [0, 0, 0], "base_quat_wxyz": [1, 0, 0, 0],
        "base_vel_world": [1, 0, 0], "base_omega_body": [0, 0, 0], "q": [0.3], "dq": [0], "tau": [0]}]}"#;
    let (answer, _) = ask(PENDULUM, state, &[], 0);
    let out = &answer.unwrap()["states"][0]["out"];
    assert_eq!((out["M"].as_array().unwrap().len(), out["M"][0][0].as_f64()), (7, Some(2.0)));
    assert!(numbers(&out["bias"]).iter().all(|force| *force == 0.0));
    ask(PENDULUM, state, &["--base", "fixed"], 3);
}

#[test]
fn answers_can_be_asked_again() {
    let state = r#"[{"q": {"j": 0.3}, "dq": {"j": -2}, "tau": {"j": 0.5}}]"#;
    let (first, _) = ask(PENDULUM, state, &[], 0);
    let first = first.unwrap();
    let (second, _) = ask(PENDULUM, &first.to_string(), &[], 0);
    assert_eq!(first["states"], second.unwrap()["states"]);
}

#[test]
fn wrong_states_are_named_by_key_and_joint() {
    let cases: [(&str, &[&str], &str); 7] = [
        (r#"[{"q": {"k": 0}, "dq": {"j": 0}, "tau": {"j": 0}}]"#, &[], "states[0].q: no joint \"k\" in p; it has j"),
        (r#"[{"q": {}, "dq": {"j": 0}, "tau": {"j": 0}}]"#, &[], "states[0].q: joint \"j\" is missing"),
        (r#"[{"q": [1, 2], "dq": [0], "tau": [0]}]"#, &[], "states[0].q: found 2 numbers, expected 1"),
        (
            r#"[{"q": {"j": "x"}, "dq": [0], "tau": [0]}]"#,
            &[],
            "states[0].q.j: found the text \"x\", expected a number",
        ),
        (r#"{"base": 3, "states": []}"#, &[], "base: found 3, expected \"fixed\" or \"free\""),
        (r#"[{"q": [0], "dq": [0], "tau": [0]}]"#, &["--base", "free"], "states[0].base_pos is missing"),
        (r#"[{"base_pos": [0, 0, 0], "q": [0], "dq": [0], "tau": [0]}]"#, &[], "the base of p is fixed"),
    ];
    for (state, more, expected) in cases {
        let (_, said) = ask(PENDULUM, state, more, 3);
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn a_chain_that_ends_without_mass_is_named_and_has_no_accelerations() {
    let robot = PENDULUM
        .replace("<mass value=\"2\"/>", "<mass value=\"0\"/>")
        .replace("\".1\"", "\"0\"")
        .replace("\".01\"", "\"0\"");
    let (answer, said) = ask(&robot, r#"[{"q": [0], "dq": [0], "tau": [0]}]"#, &[], 0);
    assert!(said.contains("states[0]: no qacc: link rod has no inertia about joint j"), "{said}");
    let out = answer.unwrap()["states"][0]["out"].clone();
    assert_eq!((out.get("qacc"), out["M"][0][0].as_f64(), out["bias"][0].as_f64()), (None, Some(0.0), Some(0.0)));
}

#[test]
fn the_example_in_the_help_runs() {
    let words = ["dynamics", "data/examples/robots/arm-states.json", "--robot", "data/examples/robots/arm.urdf"];
    let said = expect_code(root(), &words, 0);
    assert!(said.starts_with("arm: 4 links, 2 joints\n"), "{said}");
}

const SERVO: &str = r#"<mujoco model="servo"><worldbody><body name="arm" pos="0 0 1"><joint name="j" axis="0 1 0" armature=".1" damping=".5"/>
  <inertial pos=".5 0 0" mass="1" diaginertia=".001 .001 .001"/></body></worldbody>
  <actuator><position joint="j" kp="20" kv="4"/></actuator></mujoco>"#;

#[test]
fn a_described_arm_hangs_where_its_servo_balances_gravity() {
    let out = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(out.path().join(name), text).unwrap();
    write("servo.xml", SERVO);
    write("s.csv", "t,j\n0,0.3\n8,0.3\n");
    let words = ["walk", "--air", "--robot", "servo.xml", "--setpoints", "s.csv", "--out", "o", "--quiet"];
    expect_code(out.path(), &words, 0);
    let log = fs::read_to_string(out.path().join("o/log.csv")).unwrap();
    let column = log.lines().next().unwrap().split(',').position(|name| name == "j.q").unwrap();
    let last: f64 = log.lines().last().unwrap().split(',').nth(column).unwrap().parse().unwrap();
    // 20 (0.3 - q) + 9.81 * 0.5 cos q = 0, by bisection.
    let (mut low, mut high) = (0.0_f64, 1.5_f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 20.0 * (0.3 - middle) + 9.81 * 0.5 * middle.cos() > 0.0 { low = middle } else { high = middle }
    }
    assert!((last - low).abs() < 1e-4, "{last}, expected {low}");
}

#[test]
fn what_walk_cannot_move_is_named() {
    let out = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(out.path().join(name), text).unwrap();
    write("servo.xml", SERVO);
    write("slide.xml", &SERVO.replace("axis=\"0 1 0\"", "type=\"slide\""));
    write("arm.urdf", PENDULUM);
    write("s.csv", "t,j\n0,0.3\n1,0.3\n");
    let cases = [
        (&["walk", "--robot", "servo.xml"][..], 3, "hold its base, by walk --air"),
        (&["walk", "--air", "--robot", "slide.xml"], 3, "joint j slides (prismatic)"),
        (&["walk", "--air", "--robot", "arm.urdf"], 3, "no joint has a position servo"),
        (
            &["walk", "--air", "--robot", "servo.xml", "--gait", "trot", "--setpoints", "s.csv"],
            2,
            "say what this robot does by --gait FILE.toml",
        ),
    ];
    write(
        "study.toml",
        "schema = 1\n[robot]\nmodel = \"servo.xml\"\nscenario = \"air\"\n[[log]]\nfile = \"l.csv\"\nrole = \"fit\"\n",
    );
    write("l.csv", "t,j.q,j.q_ref\n0,0,0\n0.008,0,0\n0.016,0,0\n");
    let of_study = (&["gap", "study.toml"][..], 3, "scenario = \"fixed\"");
    for (words, code, expected) in cases.into_iter().chain([of_study]) {
        let output = run_in(out.path(), words);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn our_own_format_is_held_as_asked() {
    let out = tempfile::tempdir().unwrap();
    let file = out.path().join("a.json");
    let words = ["dynamics", "data/examples/states.json", "--base", "fixed", "--quiet", "--json"];
    let output = run_in(root(), &[&words[..], &[&file.to_string_lossy()]].concat());
    // The example's states move the base.
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("the base of ers7 is clamped"));
}
