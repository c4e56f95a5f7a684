//! Logs of more samples than a search looks at: stretches of them are fitted, with what was asked before each, and the answer
//! is that of the whole.

mod support;

use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use support::{expect_code, json};

/// Setpoints act so late \[s\].
const DELAY_S: f64 = 0.012;
const STUDY: &str = "schema = 1\n[joint]\nname = \"elbow\"\ninertia = 0.01\nmoment = 0.05\ncoulomb = 0.02\nviscous = 0.01\n\
                     gravity = 9.81\nrest = 0.0\n[sensor]\nresolution = 0.001\nperiod = 0.001\n[motor]\nkp = 4.0\nkd = 0.2\n\
                     [[log]]\nfile = \"long.csv\"\nrole = \"fit\"\ndrive = \"position\"\n";

/// What is asked of the joint \[rad\]: it never rests, and swells from time to time.
fn asked_rad(t_s: f64) -> f64 {
    let swell = 1.0 + 0.5 * (0.16 * t_s).sin();
    swell * (0.35 * (3.1 * t_s).sin() + 0.15 * (8.3 * t_s).sin())
}

/// A study of a servo that is asked at 1 kHz, by symplectic steps of 0.1 ms.
fn study(folder: &Path, samples: usize) -> PathBuf {
    const STEPS: usize = 10;
    let (mut q, mut v) = (0.0_f64, 0.0_f64);
    let mut table = String::from("t,q,q_ref\n");
    for k in 0..samples {
        let t_s = k as f64 * 1e-3;
        let reading = (q / 1e-3).round() * 1e-3;
        writeln!(table, "{t_s:.3},{reading:.3},{:.6}", asked_rad(t_s)).unwrap();
        for step in 0..STEPS {
            let late_ms = (k * STEPS + step) as f64 / STEPS as f64 - 1e3 * DELAY_S;
            // Held from each millisecond to the next.
            let asked = asked_rad(1e-3 * (late_ms + 1e-6).floor().max(0.0));
            let torque = 4.0 * (asked - q) - 0.2 * v - 0.05 * 9.81 * q.sin() - 0.02 * (v / 1e-3).tanh() - 0.01 * v;
            v += 1e-4 * torque / 0.01;
            q += 1e-4 * v;
        }
    }
    fs::write(folder.join("long.csv"), table).unwrap();
    let path = folder.join("study.toml");
    fs::write(&path, STUDY).unwrap();
    path
}

fn answered(folder: &Path, study: &Path) -> (String, Value) {
    let document = folder.join("gap.json");
    let out = folder.join("out");
    let mut words = vec!["gap", study.to_str().unwrap(), "--only", "delay,torque_limit,stribeck"];
    words.extend(["--out", out.to_str().unwrap(), "--json", document.to_str().unwrap()]);
    (expect_code(folder, &words, 0), json(&document))
}

fn is_the_delay(text: &str, answer: &Value) {
    assert_eq!(answer["effect"], "delay", "{text}");
    let found = answer["effects"][0]["parameters"]["T"]["value"].as_f64().unwrap();
    assert!((found - DELAY_S).abs() < 1e-3, "{found}");
    let [after, floor] = ["after", "floor"].map(|key| answer["gap"][key].as_f64().unwrap());
    assert!(after < 1.25 * floor, "{after} of {floor}\n{text}");
}

#[test]
#[ignore = "slow"]
fn slow_a_driven_log_of_two_minutes_at_1_khz_is_answered_by_stretches_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path(), 120_000);
    let (text, answer) = answered(folder.path(), &study);
    is_the_delay(&text, &answer);
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("12 stretches from all along it, each with a start of its own"), "{text}");
    assert!(text.contains("48000 of its samples are fitted"), "{text}");
}

/// The most memory that a process had so far \[MB\]; `None` where it is gone.
fn peak_mb(process: u32) -> Option<f64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.split_whitespace().next()?.parse::<f64>().ok()? / 1e3)
}

#[test]
#[ignore = "an hour at 1 kHz, half a minute: cargo test --release --test long_logs -- --ignored"]
fn an_hour_at_1_khz_takes_less_than_200_mb() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path(), 3_600_000);
    let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_aibo-fit"))
        .args(["gap", "study.toml", "--out", "out", "--json", "gap.json", "--quiet"])
        .current_dir(study.parent().unwrap())
        .spawn()
        .unwrap();
    let mut peak = 0.0_f64;
    while run.try_wait().unwrap().is_none() {
        peak = peak.max(peak_mb(run.id()).unwrap_or(0.0));
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    println!("{peak:.0} MB at the most");
    is_the_delay("", &json(&folder.path().join("gap.json")));
    assert!((50.0..200.0).contains(&peak), "{peak} MB");
}
