//! `aibo-fit export`: an MJCF with what was found moves in MuJoCo as the program predicted.

mod support;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use support::arm::{Truth, study};
use support::{run_in, stderr, stdout};

/// Runs a described robot under a log's setpoints, from a predicted log's start; prints the RMS of the difference of each
/// joint to the predicted log [rad].
const MUJOCO: &str = r#"
import csv, sys
import mujoco, numpy as np
model = mujoco.MjModel.from_xml_path(sys.argv[1])
def table(path):
    rows = list(csv.reader(open(path)))
    values = np.array([[float(x) for x in row] for row in rows[1:]])
    return {name: values[:, k] for k, name in enumerate(rows[0])}
log, predicted = table(sys.argv[2]), table(sys.argv[3])
data = mujoco.MjData(model)
names = [n[:-2] for n in predicted if n.endswith('.q')]
joint = {n: mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, n) for n in names}
motor = {n: next(a for a in range(model.nu) if model.actuator_trnid[a, 0] == joint[n]) for n in names}
t = predicted['t']
for n in names:
    data.qpos[joint[n]] = predicted[n + '.q'][0]
    data.qvel[joint[n]] = (predicted[n + '.q'][1] - predicted[n + '.q'][0]) / (t[1] - t[0])
square = {n: 0.0 for n in names}
at = 0
for k in range(len(t)):
    for n in names:
        square[n] += (data.qpos[joint[n]] - predicted[n + '.q'][k]) ** 2
        data.ctrl[motor[n]] = log[n + '.q_ref'][k]
    if k + 1 < len(t):
        for _ in range(round((t[k + 1] - t[k]) / model.opt.timestep)):
            mujoco.mj_step(model, data)
print(' '.join(str(np.sqrt(square[n] / len(t))) for n in names))
"#;

/// A Python with MuJoCo in it.
fn python() -> Option<PathBuf> {
    let named = std::env::var_os("AIBO_FIT_PYTHON").map(PathBuf::from);
    let candidates = named.into_iter().chain(["python3".into(), "python".into()]);
    let has_it = |python: &PathBuf| {
        Command::new(python).args(["-c", "import mujoco, numpy"]).output().is_ok_and(|run| run.status.success())
    };
    candidates.into_iter().find(has_it)
}

fn diagnosed(folder: &Path) -> Value {
    study(folder, &Truth { payload_kg: 0.2, ..Truth::default() }, 5.0);
    let run = run_in(folder, &["gap", "study.toml", "--quiet", "--json", "gap.json", "--out", "out"]);
    assert!(run.status.success(), "{}", stderr(&run));
    serde_json::from_str(&std::fs::read_to_string(folder.join("gap.json")).unwrap()).unwrap()
}

#[test]
#[ignore = "slow"]
fn slow_an_exported_robot_moves_in_mujoco_as_predicted() {
    let folder = tempfile::tempdir().unwrap();
    let found = diagnosed(folder.path());
    // One payload is named on one body, and the whole robot at once is near the logs with it.
    assert_eq!(found["effects"][0]["id"], "payload", "{}", found["sentence"]);
    let whole = &found["gap"]["whole"];
    let [before, after] = ["before", "after"].map(|key| whole[key].as_f64().unwrap());
    assert!(after < 0.25 * before, "{whole}");

    let run = run_in(folder.path(), &["export", "gap.json", "--to", "mjcf", "--out", "exported"]);
    assert!(run.status.success(), "{}", stderr(&run));
    let said = stdout(&run);
    assert!(said.contains("arm/elbow: frictionloss") && said.contains("lower: payload"), "{said}");
    let text = std::fs::read_to_string(folder.path().join("exported/robot.xml")).unwrap();
    assert!(text.contains("<!-- aibo-fit: arm/elbow: frictionloss") && text.contains("<position "), "{text}");

    let Some(python) = python() else {
        eprintln!("skipped: no Python with MuJoCo (AIBO_FIT_PYTHON names one)");
        return;
    };
    let files = ["exported/robot.xml", "log2.csv", "out/predicted-00.csv"];
    let run = Command::new(python).current_dir(folder.path()).args(["-c", MUJOCO]).args(files).output().unwrap();
    assert!(run.status.success(), "{}", stderr(&run));
    for rms_rad in stdout(&run).split_whitespace().map(|word| word.parse::<f64>().unwrap()) {
        // MuJoCo's friction loss creeps where ours sticks, and effects of sensors have no word in it.
        assert!(rms_rad < 0.25 * before, "{}", stdout(&run));
    }
}

/// What `gap --json` writes of a robot that walks was once told that its `joint` has no friction.
#[test]
fn a_walking_robots_diagnosis_is_refused_with_where_its_robot_is() {
    let folder = tempfile::tempdir().unwrap();
    let found = serde_json::json!({ "schema": 1, "name": "ers7", "scenario": "air", "joint": {}, "effects": [],
        "repaired": { "file": "repaired.toml", "rms": 0.01 } });
    std::fs::write(folder.path().join("gap.json"), found.to_string()).unwrap();
    for format in ["mjcf", "table", "json"] {
        let run = run_in(folder.path(), &["export", "gap.json", "--to", format, "--out", "exported"]);
        assert_eq!(run.status.code(), Some(3), "{format}");
        let said = stderr(&run);
        assert!(said.contains("walking robot cannot be exported") && said.contains("`repaired.toml`"), "{said}");
        assert!(!folder.path().join("exported").exists());
    }
}

/// What `gap --json` writes of a joint has its fit without the gains of which that is a share.
#[test]
fn a_joints_diagnosis_is_refused_with_where_its_fit_is() {
    let folder = tempfile::tempdir().unwrap();
    let found = serde_json::json!({ "schema": 1, "name": "elbow", "verdict": "calibration", "effects": [],
        "joint": { "coulomb": { "value": 0.1, "unit": "N m" }, "gain": { "value": 0.7, "unit": "" } } });
    std::fs::write(folder.path().join("gap.json"), found.to_string()).unwrap();
    let run = run_in(folder.path(), &["export", "gap.json", "--to", "isaac", "--out", "exported"]);
    assert_eq!(run.status.code(), Some(3));
    assert!(stderr(&run).contains("its fit is in `fit.json`"), "{}", stderr(&run));
    assert!(!folder.path().join("exported").exists());
}

#[test]
fn what_urdf_cannot_say_is_listed_and_what_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let number = |name: &str, key: &str, value: f64| {
        serde_json::json!({ "name": name, "key": key, "was": 0.1, "value": value, "interval": [0.9 * value, 1.1 * value],
            "unit": "N m" })
    };
    std::fs::write(folder.path().join("arm.urdf"), support::arm::ARM).unwrap();
    let write = |numbers: Vec<Value>| {
        let found = serde_json::json!({ "schema": 1, "model": "arm.urdf", "found": numbers, "cannot_say": ["a law"] });
        std::fs::write(folder.path().join("gap.json"), found.to_string()).unwrap();
    };
    write(vec![number("arm/elbow", "frictionloss", 0.2), number("arm/elbow", "kp", 12.0)]);
    let run = run_in(folder.path(), &["export", "gap.json", "--to", "urdf", "--out", "exported"]);
    assert!(run.status.success(), "{}", stderr(&run));
    let text = std::fs::read_to_string(folder.path().join("exported/robot.urdf")).unwrap();
    assert!(text.contains("friction=\"0.2\"") && text.contains("[0.180, 0.220] N m"), "{text}");
    let said = stdout(&run);
    assert!(
        said.contains("Not in this format") && said.contains("arm/elbow: kp 12") && said.contains("a law"),
        "{said}"
    );
    // What was written is read as the same robot.
    let back = aibo_fit::robot::description::Description::read(&folder.path().join("exported/robot.urdf")).unwrap();
    assert_eq!(back.joints.len(), 2);

    write(vec![number("wrist", "frictionloss", 0.2)]);
    let run = run_in(folder.path(), &["export", "gap.json", "--to", "mjcf", "--out", "exported"]);
    assert_eq!(run.status.code(), Some(3));
    assert!(stderr(&run).contains("no joint `wrist`"), "{}", stderr(&run));
}
