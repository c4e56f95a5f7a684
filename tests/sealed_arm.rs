//! An arm of `blind --robot` with a payload and a cause of one joint, which explains more than the payload does:
//! `cargo test --release --test sealed_arm -- --ignored`, a minute and a half.

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

#[test]
#[ignore = "a minute and a half"]
fn a_payload_is_found_beside_what_explains_more() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(
        folder,
        &["blind", "--robot", "--scenario", "arm", "--trials", "2", "--seed", SEED, "-q", "--make-only", "made"],
    );
    run(&folder.join("made/studies/001"), &["gap", "study.toml", "-q", "--json", "gap.json", "--out", "out"]);
    let truth = read(&folder.join("made/truth/001.json"));
    let found = read(&folder.join("made/studies/001/gap.json"));
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
    let [low, high] = [0, 1].map(|side| payload["parameters"]["mass"]["interval"][side].as_f64().unwrap());
    let was_kg = of(&truth["faults"], "payload")["parameters"][0]["value"].as_f64().unwrap();
    assert!((low..=high).contains(&was_kg), "{payload}");
}
