//! An arm with a payload that its description does not have, simulated by MuJoCo, as the whole program.

mod support;

use support::*;

/// Two links with 1.07 and 0.71 kg in their description, masses of which are off by 2 % and friction by 10 %, and 0.3 kg at
/// (0.012, 0, 0.330) m on the second. MuJoCo's steps of 0.05 ms, read every 20 ms by encoders of 4096 steps with noise of
/// 0.4 mrad.
const STUDY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/logs/loaded_arm/study.toml");

/// Another friction and half the gain on both joints leave a tenth of what is off as well.
#[test]
fn a_payload_of_another_engines_arm_is_found_with_its_mass_and_place_and_nothing_beside_it() {
    let dir = tempfile::tempdir().unwrap();
    expect_code(dir.path(), &["gap", STUDY, "--out", "out", "--json", "gap.json", "--quiet"], 0);
    let found = json(&dir.path().join("gap.json"));
    let (sentence, effects) = (&found["sentence"], found["effects"].as_array().unwrap());
    assert_eq!((&found["verdict"], effects.len()), (&"effect".into(), 1), "{sentence}");
    assert_eq!((&effects[0]["id"], &effects[0]["body"]), (&"payload".into(), &"link1".into()), "{sentence}");
    for (name, truth) in [("mass", 0.3), ("x", 0.012), ("z", 0.32996)] {
        let interval = &effects[0]["parameters"][name]["interval"];
        let [low, high] = [0, 1].map(|end| interval[end].as_f64().unwrap());
        assert!(low < truth && truth < high && high - low < 0.2 * truth, "{name} {low} {high}: {sentence}");
    }
    for joint in ["j0", "j1"] {
        assert_eq!(found["joints"][joint]["effects"], serde_json::json!([]), "{sentence}");
    }
    // From 160 mrad, with all joints at once, to what the encoders leave.
    assert!(found["gap"]["whole"]["after"].as_f64().unwrap() < 1e-3, "{}", found["gap"]["whole"]);
}
