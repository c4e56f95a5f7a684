//! Arms of `blind --robot` with a payload, beside a cause of one joint which explains more than it does, and alone where joint
//! by joint it looks like wrong zeros and gains of encoders: `cargo test --release --test sealed_arm -- --ignored`, some
//! minutes.

use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Its second study has a payload of 63 g and friction under the load of one joint.
const SEED: &str = "8101";

fn run(folder: &Path, arguments: &[&str]) {
    let run = Command::new(env!("CARGO_BIN_EXE_aibo-fit")).args(arguments).current_dir(folder).output();
    let run = run.expect("the program runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

fn read(file: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

/// Makes the first studies of an exam and diagnoses the last of them: what is there, and what was found.
fn diagnosed(folder: &Path, options: &[&str], trials: usize) -> [Value; 2] {
    let count = trials.to_string();
    let made = ["blind", "--robot", "--trials", &count, "-q", "--make-only", "made"];
    run(folder, &[&made, options].concat());
    let study = folder.join(format!("made/studies/{:03}", trials - 1));
    run(&study, &["gap", "study.toml", "-q", "--json", "gap.json", "--out", "out"]);
    [folder.join(format!("made/truth/{:03}.json", trials - 1)), study.join("gap.json")].map(|file| read(&file))
}

/// Whether the payload's interval holds its mass.
fn assert_mass(payload: &Value, fault: &Value) {
    let [low, high] = [0, 1].map(|side| payload["parameters"]["mass"]["interval"][side].as_f64().unwrap());
    let was_kg = fault["parameters"][0]["value"].as_f64().unwrap();
    assert!((low..=high).contains(&was_kg), "{payload}");
}

#[test]
#[ignore = "two minutes"]
fn a_payload_is_weighed_by_the_whole_arm() {
    let folder = tempfile::tempdir().unwrap();
    // Its twenty-ninth study is an arm of three joints with 131 g on its tip.
    let [truth, found] = diagnosed(folder.path(), &["--seed", "3001"], 29);
    let effects = found["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 1, "{}", found["sentence"]);
    assert_eq!(effects[0]["id"], "payload", "{}", found["sentence"]);
    assert_mass(&effects[0], &truth["faults"][0]);
}

#[test]
#[ignore = "two minutes; fails: 57 [51, 62.4] g are told of the payload's 63 g"]
fn a_payload_is_found_beside_what_explains_more() {
    let folder = tempfile::tempdir().unwrap();
    let [truth, found] = diagnosed(folder.path(), &["--scenario", "arm", "--seed", SEED], 2);
    let named = |effects: &Value, id: &str| -> Vec<String> {
        let mut all: Vec<String> =
            effects.as_array().unwrap().iter().map(|effect| effect[id].as_str().unwrap().to_owned()).collect();
        all.sort();
        all
    };
    assert_eq!(named(&found["effects"], "id"), named(&truth["faults"], "id"), "{}", found["sentence"]);
    let of =
        |effects: &Value, id: &str| effects.as_array().unwrap().iter().find(|own| own["id"] == id).cloned().unwrap();
    let (friction, payload) = (of(&found["effects"], "load_friction"), of(&found["effects"], "payload"));
    assert_eq!(friction["joints"], of(&truth["faults"], "load_friction")["joints"]);
    assert_mass(&payload, &of(&truth["faults"], "payload"));
}
