//! `aibo-fit gap` on an arm that a URDF describes: a fault of one joint is found on that joint, not on its neighbour.
//!
//! The logs come from the whole arm, both joints at once, integrated here over forward dynamics with friction smoothed by
//! a tanh: the diagnosis knows neither.

use aibo_fit::robot::description::Description;
use aibo_fit::robot::tree::{Tree, TreeBase, TreeDynamics, TreeState};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

const ARM: &str = r#"<robot name="arm">
<link name="base"/>
<link name="upper"><inertial><origin xyz="0.01 0 -0.15"/><mass value="0.8"/>
  <inertia ixx="0.006" iyy="0.006" izz="0.0008" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0.01 -0.12"/><mass value="0.5"/>
  <inertia ixx="0.003" iyy="0.003" izz="0.0004" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="arm/shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
  <dynamics damping="0.08" friction="0.06"/><limit lower="-3" upper="3" effort="40" velocity="20"/></joint>
<joint name="arm/elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.3"/>
  <axis xyz="0 1 0"/><dynamics damping="0.05" friction="0.04"/><limit lower="-3" upper="3" effort="40" velocity="20"/></joint>
</robot>"#;

const JOINTS: [&str; 2] = ["arm/shoulder", "arm/elbow"];
const KP_NM_RAD: [f64; 2] = [25.0, 12.0];
const KD_NM_S_RAD: [f64; 2] = [0.5, 0.2];
const PERIOD_S: f64 = 0.01;
const RESOLUTION_RAD: f64 = 0.0005;
const STEP_S: f64 = 5e-5;

/// Setpoints of a log: sums of sines in steps of one sample, `seed` in their frequencies.
fn setpoint(joint: usize, seed: f64, t_s: f64) -> f64 {
    let t = (t_s / PERIOD_S).floor().max(0.0) * PERIOD_S;
    let [a, b] = [1.3 + 0.31 * seed + 0.2 * joint as f64, 3.7 - 0.23 * seed];
    0.2 + 0.35 * ((a * t).sin() + 0.4 * (b * t + joint as f64).sin() + 0.5 * (0.7 * b * t).sin().signum() * 0.4)
}

/// A log of the whole arm, the elbow's setpoints late by `late_s`.
fn log(tree: &Tree, seed: f64, late_s: f64, seconds: f64) -> String {
    let mut dynamics = TreeDynamics::new(tree);
    let mut state = TreeState::drawn(tree);
    for j in 0..2 {
        state.position[j] = setpoint(j, seed, 0.0);
    }
    let mut rate = |state: &TreeState, t_s: f64| {
        let torque = |j: usize| {
            let seen_s = if j == 1 { t_s - late_s } else { t_s };
            let dry = [0.06, 0.04][j] * (state.rate[j] / 3e-4).tanh() + [0.08, 0.05][j] * state.rate[j];
            KP_NM_RAD[j] * (setpoint(j, seed, seen_s) - state.position[j]) - KD_NM_S_RAD[j] * state.rate[j] - dry
        };
        let mut acceleration = [0.0; 2];
        dynamics.forward(state, &[torque(0), torque(1)], &mut acceleration).unwrap();
        acceleration
    };
    let mut text = format!("t,{0}.q,{0}.q_ref,{1}.q,{1}.q_ref\n", JOINTS[0], JOINTS[1]);
    let every = (PERIOD_S / STEP_S).round() as usize;
    for k in 0..=(seconds / STEP_S).round() as usize {
        let t_s = k as f64 * STEP_S;
        if k % every == 0 {
            let read = |j: usize| (state.position[j] / RESOLUTION_RAD).round() * RESOLUTION_RAD;
            let told = |j: usize| setpoint(j, seed, t_s + 1e-9);
            let _ = writeln!(text, "{t_s:.4},{:.7},{:.7},{:.7},{:.7}", read(0), told(0), read(1), told(1));
        }
        // Heun's method.
        let first = rate(&state, t_s);
        let mut ahead = state.clone();
        ahead.position.iter_mut().zip(&state.rate).for_each(|(q, v)| *q += STEP_S * v);
        ahead.rate.iter_mut().zip(first).for_each(|(v, a)| *v += STEP_S * a);
        let second = rate(&ahead, t_s + STEP_S);
        let mean = |a: f64, b: f64| 0.5 * STEP_S * (a + b);
        let rates = state.rate.iter().zip(&ahead.rate);
        state.position.iter_mut().zip(rates).for_each(|(q, (a, b))| *q += mean(*a, *b));
        state.rate.iter_mut().zip(first.iter().zip(second)).for_each(|(v, (a, b))| *v += mean(*a, b));
    }
    text
}

fn gap(folder: &Path) -> serde_json::Value {
    let json = folder.join("gap.json");
    let run = Command::new(env!("CARGO_BIN_EXE_aibo-fit"))
        .args(["gap", "study.toml", "--quiet", "--json", "gap.json", "--out", "out"])
        .current_dir(folder)
        .output()
        .expect("the program runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert!(folder.join("out/report.html").is_file() && folder.join("out/arm_elbow/report.html").is_file());
    serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap()
}

fn study(folder: &Path, late_s: f64) {
    std::fs::write(folder.join("arm.urdf"), ARM).unwrap();
    let description = Description::read(&folder.join("arm.urdf")).unwrap();
    let tree = Tree::new(&description, TreeBase::Fixed).unwrap();
    let mut text = String::from("schema = 1\n[robot]\nmodel = \"arm.urdf\"\nscenario = \"fixed\"\n");
    for (j, name) in JOINTS.iter().enumerate() {
        let _ = write!(text, "[joints.\"{name}\"]\nkp = {:?}\nkd = {:?}\n", KP_NM_RAD[j], KD_NM_S_RAD[j]);
    }
    let _ = write!(text, "[sensor]\nresolution = {RESOLUTION_RAD:?}\nperiod = {PERIOD_S:?}\n");
    for (k, role) in ["fit", "fit", "validate"].iter().enumerate() {
        std::fs::write(folder.join(format!("log{k}.csv")), log(&tree, k as f64, late_s, 5.0)).unwrap();
        let _ = write!(text, "[[log]]\nfile = \"log{k}.csv\"\nrole = \"{role}\"\ndrive = \"position\"\n");
    }
    std::fs::write(folder.join("study.toml"), text).unwrap();
}

#[test]
fn a_late_setpoint_of_the_elbow_is_found_on_the_elbow() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path(), 0.025);
    let found = gap(folder.path());
    let effects = found["effects"].as_array().unwrap();
    // What the shoulder's jolts leave may be given a name; it may not be taken for much.
    assert!(effects[1..].iter().all(|e| e["last"].as_f64().unwrap() < 0.03), "{effects:#?}");
    assert_eq!((&effects[0]["id"], &effects[0]["joints"][0]), (&"delay".into(), &JOINTS[1].into()), "{effects:#?}");
    let late_s = effects[0]["parameters"]["T"]["value"].as_f64().unwrap();
    assert!((late_s - 0.025).abs() < 0.003, "{late_s}");
    assert_eq!(found["effect"], "delay");
    assert_eq!(found["where"]["joints"][0], JOINTS[1]);
    // The elbow's jolts reach the shoulder through smoothed accelerations: a millirad of it stays, and nobody is blamed.
    let shoulder = &found["joints"][JOINTS[0]];
    assert!(shoulder["effects"].as_array().unwrap().is_empty(), "{}", shoulder["sentence"]);
    assert!(found["gap"]["after"].as_f64().unwrap() < 0.002, "{}", found["gap"]);
}

/// Writes `data/examples/arm` anew: `cargo test --release --test gap_arm -- --ignored`.
#[test]
#[ignore = "writes files of the repository"]
fn the_example_is_written() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/examples/arm");
    std::fs::create_dir_all(&folder).unwrap();
    study(&folder, 0.025);
}

/// Names that do not fit are one error that says what there is.
#[test]
fn a_joint_that_the_robot_does_not_have_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path(), 0.0);
    let path = folder.path().join("study.toml");
    for (from, to, expected) in [
        ("[joints.\"arm/elbow\"]", "[joints.wrist]", "no joint `wrist`; it has arm/shoulder, arm/elbow"),
        ("arm.urdf", "leg.urdf", "leg.urdf"),
        ("scenario = \"fixed\"", "scenario = \"fixed\"\ntip = \"hand\"", "no link `hand`"),
        ("kp = 12.0\n", "", "joint arm/elbow is driven by position"),
    ] {
        let good = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, good.replace(from, to)).unwrap();
        let run = Command::new(env!("CARGO_BIN_EXE_aibo-fit"))
            .args(["gap", "study.toml", "--out", "refused"])
            .current_dir(folder.path())
            .output()
            .expect("the program runs");
        std::fs::write(&path, good).unwrap();
        let message = String::from_utf8_lossy(&run.stderr).into_owned();
        assert!(!run.status.success() && message.contains(expected), "`{expected}` is not in\n{message}");
        assert!(!folder.path().join("refused").exists());
    }
}
