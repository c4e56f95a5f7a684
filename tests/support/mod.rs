//! What the tests of the program share: running it in a folder of its own, and looking at what it left.
#![allow(dead_code, reason = "every test file uses a part")]

pub mod arm;
pub mod console;
pub mod real;
pub mod signature;
pub mod swing;

use aibo_fit::blind::{self, Cause, Made, Truth, make_with};
use aibo_fit::synth::{Spec, make};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

/// The repository's root, where `data/` lies.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs the program in a folder.
pub fn run_in(folder: &Path, words: &[&str]) -> Output {
    assert_cmd::Command::new(env!("CARGO_BIN_EXE_aibo-fit"))
        .current_dir(folder)
        .args(words)
        .output()
        .expect("the program can be started")
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs the program and expects an exit code; answers with what it printed.
pub fn expect_code(folder: &Path, words: &[&str], code: i32) -> String {
    let output = run_in(folder, words);
    let (out, err) = (stdout(&output), stderr(&output));
    assert_eq!(output.status.code(), Some(code), "aibo-fit {}\n{out}\n{err}", words.join(" "));
    assert!(!err.contains("panicked"), "{err}");
    out
}

/// Makes the study of a spec in a folder.
pub fn make_study(folder: &Path, spec: &str) {
    let spec = Spec::from_toml(Path::new("spec.toml"), spec).expect("a spec");
    let made = make(&spec, None).expect("logs");
    made.files().for_each(|(name, text)| fs::write(folder.join(name), text).expect("written"));
}

/// Fits a drop and answers with its fit.json.
pub fn drop_json(folder: &Path, words: &[&str]) -> serde_json::Value {
    let out = tempfile::tempdir().unwrap();
    let out_word = out.path().to_string_lossy().into_owned();
    let all: Vec<&str> = ["drop", "--quiet", "--out", &out_word].into_iter().chain(words.iter().copied()).collect();
    expect_code(folder, &all, 0);
    json(&out.path().join("fit.json"))
}

pub fn json(path: &Path) -> serde_json::Value {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Every file and folder below one, sorted.
pub fn everything_in(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut left = vec![folder.to_path_buf()];
    while let Some(folder) = left.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                left.push(path.clone());
            }
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Value, interval and whether the logs determine it, of a quantity in a fit.json.
pub fn quantity(of: &serde_json::Value) -> (Option<f64>, Option<[f64; 2]>, bool) {
    let end = |i: usize| of["interval"][i].as_f64();
    (of["value"].as_f64(), end(0).zip(end(1)).map(|(a, b)| [a, b]), of["identifiable"] == true)
}

/// A log of `n` samples with its own row for each time.
pub fn log_of(header: &str, n: u32, period_s: f64, row: impl Fn(f64) -> String) -> String {
    let rows: Vec<String> = (0..n).map(|i| row(f64::from(i) * period_s)).collect();
    format!("{header}\n{}\n", rows.join("\n"))
}

/// A decaying swing \[rad\]: no model's, only something that moves.
pub fn decaying(t_s: f64) -> f64 {
    0.5 * (-t_s).exp() * (7.0 * t_s).cos()
}

/// A good log of 500 samples.
pub fn good_log() -> String {
    log_of("t,q", 500, 0.008, |t| format!("{t:.3},{:.5}", decaying(t)))
}

/// A study of `good.csv`.
pub const STUDY: &str = r#"schema = 1
[joint]
name = "j"
inertia = 9.0e-4
moment = 5.0e-3
coulomb = 0.001
viscous = 0.001
[[log]]
file = "good.csv"
role = "fit"
drive = "off"
"#;

/// A fit.json that `simulate` can use.
pub const FIT: &str = r#"{ "schema": 1, "joint": {
  "inertia": {"value": 9e-4}, "moment": {"value": 5e-3}, "coulomb": {"value": 0.0}, "viscous": {"value": 0.0018},
  "rest": {"value": 0.0} }, "effects": [], "models": {}, "logs": [] }
"#;

/// Runs of a real swing: q'' = -40 sin q - 0.05 q' - 0.03 sign q', coarse on purpose; rounded to 1.5 mrad.
pub fn long_swing(rows: u32, period_s: f64) -> String {
    use std::fmt::Write as _;
    const PARTS: u32 = 4;
    let (mut q, mut w, mut stuck) = (0.8_f64, 0.0_f64, false);
    let mut text = String::from("t,q\n");
    let h = period_s / f64::from(PARTS);
    for i in 0..rows {
        let _ = writeln!(text, "{:.4},{:.5}", f64::from(i) * period_s, (q / 0.0015).round() * 0.0015);
        for _ in 0..PARTS {
            if stuck {
                break;
            }
            let direction = if w == 0.0 { -q.signum() } else { w.signum() };
            let next = w + h * (-40.0 * q.sin() - 0.05 * w - 0.03 * direction);
            stuck = w * next < 0.0 && 40.0 * q.sin().abs() <= 0.03;
            if !stuck {
                w = next;
                q += h * w;
            }
        }
    }
    text
}

/// The folder of shared data that is not part of the repository; where it is absent the test says so.
pub fn shared(what: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("AIBO_FIT_SHARED").map(|shared| Path::new(&shared).join(what));
    let found = folder.filter(|folder| folder.is_dir());
    if found.is_none() {
        println!("skipped: AIBO_FIT_SHARED names no folder that holds {what}");
    }
    found
}

/// Writes a made study with a given cause into a folder, and answers with what is true of it.
pub fn write_made(folder: &Path, seed: u64, cause: Cause) -> Truth {
    written(folder, make_with(seed, 0, cause))
}

/// Writes a study of the blind trial itself, as it is drawn; what the truth is.
pub fn write_drawn(folder: &Path, seed: u64, trial: u64) -> Truth {
    written(folder, blind::make(seed, trial))
}

fn written(folder: &Path, made: Made) -> Truth {
    for (name, content) in &made.study {
        fs::write(folder.join(name), content).unwrap();
    }
    made.truth
}
