//! What holds in some logs only: causes of one session or of one log, and numbers that differ between sessions.

mod support;

use aibo_fit::gap::{GapError, GapOptions, diagnose};
use aibo_fit::identify::Case;
use aibo_fit::progress::{Progress, Silent, Step};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::sync::Mutex;
use support::swing::{swing, swing_against, swings};
use support::*;

const RIGHT: [&str; 4] = ["9.0e-4", "5.0e-3", "0.001", "0.0004"];
const FRICTION: [f64; 2] = [0.001, 0.0004];
/// Inside the range of motion \[rad\].
const STOP_RAD: f64 = 0.35;

/// A study of swings, each in its session; without a name it stands alone.
fn in_sessions(logs: &[(&str, String)]) -> tempfile::TempDir {
    let all: Vec<(&str, String)> = logs.iter().map(|(_, text)| ("fit", text.clone())).collect();
    let dir = swings(&all, RIGHT);
    let path = dir.path().join("study.toml");
    let mut study = fs::read_to_string(&path).unwrap();
    for (i, (session, _)) in logs.iter().enumerate().filter(|(_, (session, _))| !session.is_empty()) {
        let file = format!("file = \"{i}.csv\"\n");
        study = study.replace(&file, &format!("{file}session = \"{session}\"\n"));
    }
    fs::write(&path, study).unwrap();
    dir
}

fn diagnosed(folder: &Path) -> (Value, String) {
    let text = expect_code(folder, &["gap", "study.toml", "--out", "out", "--json", "gap.json"], 0);
    (json(&folder.join("gap.json")), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Four swings, one of them against a stop.
fn one_against_a_stop(sessions: [&str; 2]) -> tempfile::TempDir {
    let [bench, lift] = sessions;
    let free = |from: f64| swing(from, 400, FRICTION);
    let stopped = swing_against(STOP_RAD, -0.8, 400, FRICTION);
    in_sessions(&[(bench, free(0.9)), (bench, free(-0.6)), (lift, stopped), (bench, free(0.75))])
}

fn ids(found: &Value) -> Vec<&str> {
    found["effects"].as_array().unwrap().iter().filter_map(|effect| effect["id"].as_str()).collect()
}

#[test]
#[ignore = "slow"]
fn slow_a_stop_in_one_session_is_found_there_and_nowhere_else() {
    let dir = one_against_a_stop(["bench", "lift"]);
    let (found, text) = diagnosed(dir.path());
    assert_eq!((&found["verdict"], ids(&found)), (&json!("effect"), vec!["end_stop"]), "{text}");
    assert_eq!(found["effects"][0]["logs"], json!(["2.csv"]));
    let at = found["effects"][0]["parameters"]["q_e"]["value"].as_f64().unwrap();
    assert!((at - STOP_RAD).abs() < 0.02, "{at}");
    assert!(text.contains("in session lift only"), "{text}");
    // Who predicts the logs with this fit has the stop there, and not in the others.
    let fit = json(&dir.path().join("out/fit.json"));
    assert_eq!(fit["effects"][0]["logs"], json!(["2.csv"]));
    let words = ["simulate", "study.toml", "--fit", "out/fit.json", "--out", "predicted", "--json", "simulated.json"];
    expect_code(dir.path(), &words, 0);
    let simulated = json(&dir.path().join("simulated.json"));
    for log in simulated["logs"].as_array().unwrap() {
        assert!(log["rms"].as_f64().unwrap() < 3e-3, "{simulated}");
    }
}

#[test]
fn without_sessions_a_log_of_its_own_is_found() {
    let dir = one_against_a_stop(["", ""]);
    let (found, text) = diagnosed(dir.path());
    assert_eq!((ids(&found), &found["effects"][0]["logs"]), (vec!["end_stop"], &json!(["2.csv"])), "{text}");
    assert!(text.contains("in 2.csv only"), "{text}");
}

#[test]
#[ignore = "slow"]
fn slow_a_stop_that_is_hit_often_is_found_with_its_stiffness() {
    let free = |from: f64| swing(from, 400, FRICTION);
    let stopped = swing_against(0.3, -0.8, 400, FRICTION);
    let dir = in_sessions(&[("", free(0.9)), ("", free(-0.6)), ("", stopped), ("", free(0.75))]);
    let (found, text) = diagnosed(dir.path());
    assert_eq!((&found["verdict"], ids(&found)), (&json!("effect"), vec!["end_stop"]), "{text}");
    let stiffness = found["effects"][0]["parameters"]["stiffness"]["value"].as_f64().unwrap();
    assert!((1.0..4.0).contains(&stiffness), "{stiffness} N m/rad for 2");
}

#[test]
fn what_holds_everywhere_is_not_restricted_and_nothing_is_made_up() {
    let stopped = |from: f64| swing_against(STOP_RAD, from, 400, FRICTION);
    let dir = in_sessions(&[("a", stopped(-0.9)), ("a", stopped(-0.6)), ("b", stopped(-0.8)), ("b", stopped(-0.75))]);
    let (found, text) = diagnosed(dir.path());
    assert_eq!((ids(&found), found["effects"][0].get("logs")), (vec!["end_stop"], None), "{text}");
    let free = |from: f64| swing(from, 400, FRICTION);
    let dir = in_sessions(&[("a", free(0.9)), ("a", free(-0.6)), ("b", free(0.8)), ("b", free(-0.75))]);
    let (found, text) = diagnosed(dir.path());
    assert_eq!((&found["verdict"], &found["differs"]), (&json!("none"), &json!([])), "{text}");
}

#[test]
fn friction_that_is_another_on_another_day_is_said() {
    let rubbing = |coulomb: f64, from: f64| swing(from, 400, [coulomb, FRICTION[1]]);
    let [cold, warm] = [0.002, 0.0007];
    let logs = [
        ("cold", rubbing(cold, 0.9)),
        ("cold", rubbing(cold, -0.6)),
        ("warm", rubbing(warm, 0.8)),
        ("warm", rubbing(warm, -0.75)),
    ];
    let dir = in_sessions(&logs);
    let (found, text) = diagnosed(dir.path());
    let differs = &found["differs"][0];
    assert_eq!((&differs["number"], &differs["by"]), (&json!("coulomb"), &json!("session")), "{text}");
    for (session, true_nm) in [("cold", cold), ("warm", warm)] {
        let value = differs["values"][session].as_f64().unwrap();
        assert!((value / true_nm - 1.0).abs() < 0.1, "{differs}");
    }
    assert!(text.contains("One coulomb does not serve all logs"), "{text}");
}

/// Hears every step, and no longer wants the answer after so many of them.
struct Patience {
    heard: Mutex<Vec<Step>>,
    at_most: usize,
}

impl Progress for Patience {
    fn step(&self, step: Step) {
        self.heard.lock().unwrap().push(step);
    }

    fn cancelled(&self) -> bool {
        self.heard.lock().unwrap().len() >= self.at_most
    }
}

#[test]
fn a_diagnosis_tells_its_steps_can_be_written_down_and_ends_where_it_is_no_longer_wanted() {
    let dir = swings(&[("fit", swing(0.9, 300, FRICTION)), ("fit", swing(-0.6, 300, FRICTION))], RIGHT);
    let case = Case::of_study(&dir.path().join("study.toml")).unwrap();
    let options = GapOptions { twins: 2, ..GapOptions::default() };
    let listener = Patience { heard: Mutex::default(), at_most: usize::MAX };
    let diagnosis = diagnose(&case, &options, &listener).unwrap();
    let heard = listener.heard.into_inner().unwrap();
    assert!(heard.contains(&Step { stage: "twins", done: 1, of: 2 }), "{heard:?}");
    assert!(heard.iter().any(|step| step.stage == "recalibrating"), "{heard:?}");
    let written = serde_json::to_value(&diagnosis).unwrap();
    assert_eq!((&written["answer"]["verdict"], &written["joint"]), (&json!("none"), &json!("j")));
    for at_most in [0, 1, 3, heard.len() - 1] {
        let listener = Patience { heard: Mutex::default(), at_most };
        let ended = diagnose(&case, &options, &listener);
        assert!(matches!(ended, Err(GapError::Cancelled(_))), "after {at_most} steps");
    }
    assert!(diagnose(&case, &GapOptions::default(), &Silent).is_ok());
}
