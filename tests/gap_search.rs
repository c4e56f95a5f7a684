//! Causes that no slope leads to from the numbers as they are refitted without them: holds of whole periods, links that ring,
//! encoders off their centre. The joints are moved by an integrator of this file.

mod support;

use serde_json::{Value, json};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use support::*;

/// Steps of the integrator \[s\], and the encoder's \[rad\].
const STEP_S: f64 = 5e-5;
const TICK_RAD: f64 = 0.0015;
const PERIOD_S: f64 = 0.008;
const LASTS_S: f64 = 5.0;
/// A quarter of a turn before an encoder off its centre reads most too much \[rad\].
const FARTHEST_RAD: f64 = 1.2;

/// A servo's joint as it is, in SI units.
struct Joint {
    inertia: f64,
    moment: f64,
    coulomb: f64,
    viscous: f64,
    kp: f64,
    kd: f64,
    /// Setpoints get through so often \[s\].
    hold_s: f64,
    /// The encoder reads once a turn so much more and less.
    off_centre_rad: f64,
    limit_nm: f64,
    /// Stiffness and damping between the link and a motor of this inertia.
    spring: Option<[f64; 3]>,
}

const JOINT: Joint = Joint {
    inertia: 0.05,
    moment: 0.28,
    coulomb: 0.15,
    viscous: 0.05,
    kp: 25.0,
    kd: 1.2,
    hold_s: PERIOD_S,
    off_centre_rad: 0.0,
    limit_nm: f64::INFINITY,
    spring: None,
};

/// Asked angles \[rad\] over time \[s\].
type Asked = fn(f64) -> f64;

const ASKED: [(&str, Asked); 4] = [
    ("steps.csv", |t| [0.0, 0.5, -0.3, 0.7, 0.1, -0.6, 0.4, -0.1, 0.6][(t / 0.6) as usize]),
    ("sines.csv", |t| 0.5 * (3.0 * t).sin() + 0.2 * (8.0 * t).sin()),
    ("sweep.csv", |t| 0.5 * (2.0 * PI * (0.3 + 0.25 * t) * t).sin()),
    ("held-out.csv", |t| [0.0, -0.4, 0.6, -0.2, 0.3, -0.7, 0.2, 0.5][(t / 0.7) as usize]),
];

impl Joint {
    /// Its log, noise of less than a tick on it.
    fn log(&self, asked: Asked) -> String {
        let mut text = "t,q,q_ref\n".to_owned();
        let ([mut q, mut v], [mut motor_q, mut motor_v]) = ([0.0_f64; 2], [0.0_f64; 2]);
        let (mut seed, mut next) = (7_u64, 0_u32);
        for k in 0..(LASTS_S / STEP_S) as u32 {
            let t = f64::from(k) * STEP_S;
            // It reads nought where the link hangs.
            let read = q + self.off_centre_rad * ((q - FARTHEST_RAD).sin() + FARTHEST_RAD.sin());
            if t >= f64::from(next) * PERIOD_S - 1e-9 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let noise = 5e-4 * ((seed >> 40) as f64 / 8_388_608.0 - 1.0);
                let ticks = ((read + noise) / TICK_RAD).round() * TICK_RAD;
                text += &format!("{t:.4},{ticks:.5},{:.5}\n", asked(f64::from(next) * PERIOD_S));
                next += 1;
            }
            let held = asked((t / self.hold_s + 1e-9).floor() * self.hold_s);
            let drive = (self.kp * (held - read) - self.kd * v).clamp(-self.limit_nm, self.limit_nm);
            let gravity = 9.81 * self.moment * q.sin();
            let rub = |v: f64| self.coulomb * (v / 0.005).tanh() + self.viscous * v;
            match self.spring {
                None => v += STEP_S * (drive - gravity - rub(v)) / self.inertia,
                Some([stiffness, damping, of_motor]) => {
                    let passes = stiffness * (motor_q - q) + damping * (motor_v - v);
                    motor_v += STEP_S * (drive - passes - rub(motor_v)) / of_motor;
                    motor_q += STEP_S * motor_v;
                    v += STEP_S * (passes - gravity) / (self.inertia - of_motor);
                }
            }
            q += STEP_S * v;
        }
        text
    }

    /// What `gap` makes of it where all numbers are stated some percent off.
    fn diagnosed(&self, armature: f64) -> (Value, String) {
        let dir = tempfile::tempdir().unwrap();
        let mut study = format!(
            "schema = 1\n[joint]\nname = \"arm\"\ninertia = {}\nmoment = {}\ncoulomb = {}\nviscous = {}\n[sensor]\n\
             resolution = {TICK_RAD}\n[motor]\nkp = {}\nkd = {}\narmature = {armature}\n[uncertain]\ninertia = 0.12\nmoment = 0.08\n\
             friction = {{ coulomb = 0.3, viscous = 0.5 }}\ngain = 0.08\n",
            0.94 * (self.inertia - armature),
            0.95 * self.moment,
            1.1 * self.coulomb,
            0.8 * self.viscous,
            0.95 * self.kp,
            0.97 * self.kd
        );
        for (k, (name, asked)) in ASKED.iter().enumerate() {
            fs::write(dir.path().join(name), self.log(*asked)).unwrap();
            let role = if k + 1 < ASKED.len() { "fit" } else { "validate" };
            study += &format!("[[log]]\nfile = \"{name}\"\nrole = \"{role}\"\ndrive = \"position\"\n");
        }
        fs::write(dir.path().join("study.toml"), study).unwrap();
        diagnosed(dir.path())
    }
}

fn diagnosed(folder: &Path) -> (Value, String) {
    let text = expect_code(folder, &["gap", "study.toml", "--out", "out", "--json", "gap.json"], 0);
    (json(&folder.join("gap.json")), text)
}

fn ids(found: &Value) -> Vec<&str> {
    found["effects"].as_array().unwrap().iter().filter_map(|effect| effect["id"].as_str()).collect()
}

fn value(found: &Value, effect: &str, name: &str) -> f64 {
    let all = found["effects"].as_array().unwrap();
    let own = all.iter().find(|own| own["id"] == effect).unwrap_or_else(|| panic!("no {effect}: {found}"));
    own["parameters"][name]["value"].as_f64().unwrap()
}

#[test]
#[ignore = "slow"]
fn slow_setpoints_held_for_whole_periods_are_found_where_numbers_are_off() {
    let (found, text) = Joint { hold_s: 5.0 * PERIOD_S, ..JOINT }.diagnosed(0.0);
    assert_eq!((&found["verdict"], ids(&found)), (&json!("effect"), vec!["setpoint_hold"]), "{text}");
    let hold_s = value(&found, "setpoint_hold", "T_h");
    assert!((hold_s - 5.0 * PERIOD_S).abs() < 2e-4, "{hold_s}");
}

#[test]
#[ignore = "slow"]
fn slow_a_link_that_rings_on_its_spring_is_found() {
    let (stiff, of_motor) = (150.0, 0.01);
    let spring = Some([stiff, 0.28, of_motor]);
    let joint =
        Joint { inertia: 0.034, moment: 0.21, coulomb: 0.1, viscous: 0.045, kp: 37.0, kd: 0.9, spring, ..JOINT };
    let (found, text) = joint.diagnosed(of_motor);
    assert_eq!((&found["verdict"], ids(&found)), (&json!("effect"), vec!["compliance"]), "{text}");
    let stiffness = value(&found, "compliance", "k");
    assert!((stiffness / stiff - 1.0).abs() < 0.15, "{stiffness}");
}

#[test]
#[ignore = "slow"]
fn slow_an_encoder_off_its_centre_is_found_beside_a_limit() {
    let joint = Joint { off_centre_rad: 0.09, limit_nm: 3.3, kp: 35.0, kd: 1.0, coulomb: 0.11, ..JOINT };
    let (found, text) = joint.diagnosed(0.0);
    let ids = ids(&found);
    assert!(found["verdict"] == "effect" && ids.contains(&"torque_limit") && ids.contains(&"sensor_gain"), "{text}");
    assert!((value(&found, "sensor_gain", "e") / 0.09 - 1.0).abs() < 0.2, "{text}");
}
