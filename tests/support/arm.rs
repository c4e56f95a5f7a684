//! An arm that a URDF describes, integrated over forward dynamics with friction smoothed by a tanh: no diagnosis knows
//! either.

use aibo_fit::robot::description::{BodyChange, Description};
use aibo_fit::robot::tree::{Tree, TreeBase, TreeDynamics, TreeState};
use nalgebra::Vector3;
use std::fmt::Write as _;
use std::path::Path;

pub const ARM: &str = r#"<robot name="arm">
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

pub const JOINTS: [&str; 2] = ["arm/shoulder", "arm/elbow"];
pub const KP_NM_RAD: [f64; 2] = [25.0, 12.0];
pub const KD_NM_S_RAD: [f64; 2] = [0.5, 0.2];
const DRY_NM: [f64; 2] = [0.06, 0.04];
const VISCOUS: [f64; 2] = [0.08, 0.05];
pub const RESOLUTION_RAD: f64 = 0.0005;
const STEP_S: f64 = 5e-5;

/// What is other than the study believes.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// The elbow's setpoints are late \[s\].
    pub late_s: f64,
    /// Hangs on the lower link \[kg\], and its place there \[m\].
    pub payload_kg: f64,
    pub place_m: [f64; 3],
    /// Drag of the elbow \[N m s^2/rad^2\].
    pub drag: f64,
    /// Dry friction of both joints, times what is described.
    pub friction: f64,
    /// The logs have torques, held from sample to sample, in the place of setpoints.
    pub by_torque: bool,
    pub period_s: f64,
}

impl Default for Truth {
    fn default() -> Self {
        Self {
            late_s: 0.0,
            payload_kg: 0.0,
            place_m: [0.0, 0.0, -0.25],
            drag: 0.0,
            friction: 1.0,
            by_torque: false,
            period_s: 0.01,
        }
    }
}

/// Setpoints of a log: sums of sines in steps of one sample, `seed` in their frequencies.
fn setpoint(joint: usize, seed: f64, t_s: f64, truth: &Truth) -> f64 {
    let period_s = truth.period_s;
    let t = (t_s / period_s + 1e-9).floor().max(0.0) * period_s;
    let [a, b] = [1.3 + 0.31 * seed + 0.2 * joint as f64, 3.7 - 0.23 * seed];
    // Who logs torques to identify an arm moves it smoothly.
    let jump = if truth.by_torque { 0.0 } else { 0.5 * (0.7 * b * t).sin().signum() * 0.4 };
    0.2 + 0.35 * ((a * t).sin() + 0.4 * (b * t + joint as f64).sin() + jump)
}

/// A log of the whole arm.
fn log(described: &Description, truth: &Truth, seed: f64, seconds: f64) -> String {
    let lower = described.link("lower").expect("the arm has one");
    let payload = BodyChange::Payload { mass_kg: truth.payload_kg, place_m: Vector3::from(truth.place_m) };
    let real = described.with_change(lower, &payload);
    let tree = Tree::new(&real, TreeBase::Fixed).unwrap();
    let mut dynamics = TreeDynamics::new(&tree);
    let mut state = TreeState::drawn(&tree);
    let told = |j: usize, t_s: f64| setpoint(j, seed, t_s, truth);
    for j in 0..2 {
        state.position[j] = told(j, 0.0);
    }
    let servo = |state: &TreeState, j: usize, t_s: f64| {
        let seen_s = if j == 1 { t_s - truth.late_s } else { t_s };
        KP_NM_RAD[j] * (told(j, seen_s) - state.position[j]) - KD_NM_S_RAD[j] * state.rate[j]
    };
    let mut held = [0.0; 2];
    let mut rate = |state: &TreeState, t_s: f64, held: &[f64; 2]| {
        let torque = |j: usize| {
            let w = state.rate[j];
            let drag = if j == 1 { truth.drag * w * w.abs() } else { 0.0 };
            let dry = truth.friction * DRY_NM[j] * (w / 3e-4).tanh() + VISCOUS[j] * w + drag;
            if truth.by_torque { held[j] - dry } else { servo(state, j, t_s) - dry }
        };
        let mut acceleration = [0.0; 2];
        dynamics.forward(state, &[torque(0), torque(1)], &mut acceleration).unwrap();
        acceleration
    };
    let column = if truth.by_torque { "tau" } else { "q_ref" };
    let mut text = format!("t,{0}.q,{0}.{column},{1}.q,{1}.{column}\n", JOINTS[0], JOINTS[1]);
    let every = (truth.period_s / STEP_S).round() as usize;
    for k in 0..=(seconds / STEP_S).round() as usize {
        let t_s = k as f64 * STEP_S;
        if k % every == 0 {
            held = [0, 1].map(|j| servo(&state, j, t_s));
            let read = |j: usize| (state.position[j] / RESOLUTION_RAD).round() * RESOLUTION_RAD;
            let given = |j: usize| if truth.by_torque { held[j] } else { told(j, t_s) };
            let _ = writeln!(text, "{t_s:.4},{:.7},{:.7},{:.7},{:.7}", read(0), given(0), read(1), given(1));
        }
        // Heun's method.
        let first = rate(&state, t_s, &held);
        let mut ahead = state.clone();
        ahead.position.iter_mut().zip(&state.rate).for_each(|(q, v)| *q += STEP_S * v);
        ahead.rate.iter_mut().zip(first).for_each(|(v, a)| *v += STEP_S * a);
        let second = rate(&ahead, t_s + STEP_S, &held);
        let mean = |a: f64, b: f64| 0.5 * STEP_S * (a + b);
        let rates = state.rate.iter().zip(&ahead.rate);
        state.position.iter_mut().zip(rates).for_each(|(q, (a, b))| *q += mean(*a, *b));
        state.rate.iter_mut().zip(first.iter().zip(second)).for_each(|(v, (a, b))| *v += mean(*a, b));
    }
    text
}

/// Writes description, study and three logs into a folder.
pub fn study(folder: &Path, truth: &Truth, seconds: f64) {
    std::fs::write(folder.join("arm.urdf"), ARM).unwrap();
    let description = Description::read(&folder.join("arm.urdf")).unwrap();
    let mut text = String::from("schema = 1\n[robot]\nmodel = \"arm.urdf\"\nscenario = \"fixed\"\n");
    if !truth.by_torque {
        for (j, name) in JOINTS.iter().enumerate() {
            let _ = write!(text, "[joints.\"{name}\"]\nkp = {:?}\nkd = {:?}\n", KP_NM_RAD[j], KD_NM_S_RAD[j]);
        }
    }
    let _ = write!(text, "[sensor]\nresolution = {RESOLUTION_RAD:?}\nperiod = {:?}\n", truth.period_s);
    let drive = if truth.by_torque { "\"torque\"\npredict = \"torque\"" } else { "\"position\"" };
    for (k, role) in ["fit", "fit", "validate"].iter().enumerate() {
        std::fs::write(folder.join(format!("log{k}.csv")), log(&description, truth, k as f64, seconds)).unwrap();
        let _ = write!(text, "[[log]]\nfile = \"log{k}.csv\"\nrole = \"{role}\"\ndrive = {drive}\n");
    }
    std::fs::write(folder.join("study.toml"), text).unwrap();
}
