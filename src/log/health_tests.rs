use super::*;
use crate::log::{read_log, read_sidecar_for};
use approx::assert_relative_eq;
use std::path::{Path, PathBuf};

fn swings(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(folder);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "csv"));
    files.sort();
    files
}

fn look(log: &Log) -> Health {
    health(log, &SensorSpec::default(), DriveMode::Off)
}

fn made(t_s: Vec<f64>, q_rad: Vec<f64>) -> Log {
    Log {
        file: "made.csv".into(),
        t_s,
        q_rad,
        dq_rad_s: None,
        tau_nm: None,
        q_ref_rad: None,
        setpoints: None,
        drive: None,
        ignored_columns: vec![],
        notes: vec![],
    }
}

/// Uniform noise in -0.5..0.5, without a crate: a linear congruential generator.
fn noise_source() -> impl FnMut() -> f64 {
    let mut state = 12345_u64;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

#[test]
fn release_is_found_with_the_drive_column() {
    for file in swings("thesis-robot").iter().chain(&swings("sealed-robot")) {
        let log = read_log(file).unwrap();
        let release = read_sidecar_for(file).unwrap().unwrap().release.unwrap();
        let health = look(&log);
        let held = health.start.held().unwrap();
        assert_relative_eq!(held.release_s, release.time_s.unwrap(), epsilon = 1e-9);
        assert_relative_eq!(health.held_mean_rad.unwrap(), release.angle_rad.unwrap(), epsilon = 1e-3);
        assert_relative_eq!(health.step_rad.unwrap(), 0.006, epsilon = 1e-6);
        assert_eq!(health.moved, !file.to_string_lossy().contains("q3-bare"), "{}", file.display());
        // with the extra mass some still swing after six seconds
        assert!(health.rest_from_s.is_some() || !file.to_string_lossy().contains("bare"), "{}", file.display());
    }
}

#[test]
fn release_is_found_within_two_samples_without_the_drive_column() {
    for file in swings("thesis-robot").iter().chain(&swings("sealed-robot")) {
        let mut log = read_log(file).unwrap();
        log.drive = None;
        let truth = read_sidecar_for(file).unwrap().unwrap().release.unwrap().time_s.unwrap();
        let health = look(&log);
        let Some(held) = health.start.held() else {
            assert!(!health.moved, "{}: held phase not seen", file.display());
            continue;
        };
        let off = (held.release_s - truth) / 0.008;
        assert!(off.abs() <= 2.01, "{}: {off:.2} samples off", file.display());
        assert!(held.window_s[0] <= truth && truth <= held.window_s[1], "{}: {held:?}", file.display());
        assert!(held.first_free - held.last_held < 16, "{}: {held:?}", file.display());
    }
}

#[test]
fn release_between_two_samples_is_bracketed_by_a_fine_encoder() {
    let mut noise = noise_source();
    for (truth, rate, damping) in [(0.359048, 7.0, 0.4), (0.209817, 4.0, 0.2), (0.520562, 9.0, 3.0)] {
        let t: Vec<f64> = (0..2000).map(|i| f64::from(i) * 0.002).collect();
        // released from rest: q' = 0 at s = 0
        let angle = |t: f64| {
            let s = (t - truth).max(0.0);
            0.1 + 0.9 * (-damping * s).exp() * ((rate * s).cos() + damping / rate * (rate * s).sin())
        };
        let q = t.iter().map(|t| ((angle(*t) / 0.0004) + noise()).round() * 0.0004).collect();
        let held = *look(&made(t, q)).start.held().unwrap();
        assert!(held.window_s[0] <= truth && truth <= held.window_s[1], "{truth}: {held:?}");
        assert!((held.release_s - truth).abs() < 2.0 * 0.002, "{truth}: {held:?}");
    }
}

#[test]
fn a_joint_that_is_carried_to_where_it_is_let_go_is_held_there() {
    let t_s: Vec<f64> = (0..400).map(|k| 0.005 * k as f64).collect();
    let q_rad = t_s.iter().map(|&t| match t {
        t if t < 1.0 => -1.2 * t,
        t if t < 1.5 => -1.2,
        t => -1.2 * (8.0 * (t - 1.5)).cos(),
    });
    let drive = Some(t_s.iter().map(|t| *t < 1.5).collect());
    let log = Log { drive, ..made(t_s.clone(), q_rad.collect()) };
    let found = look(&log);
    assert!(found.moved);
    approx::assert_abs_diff_eq!(found.held_mean_rad.unwrap(), -1.2, epsilon = 0.02);
}

#[test]
fn a_log_that_starts_free_is_not_called_held() {
    for file in swings("thesis-robot").iter().chain(&swings("sealed-robot")) {
        let whole = read_log(file).unwrap();
        let release = whole.drive.as_ref().unwrap().iter().position(|held| !held).unwrap();
        // from the release itself, and from half-way down
        for cut in [release, release + 12, release + 25] {
            let log = made(whole.t_s[cut..].to_vec(), whole.q_rad[cut..].to_vec());
            assert_eq!(look(&log).start, Start::Free, "{} from {cut}", file.display());
        }
    }
}

#[test]
fn drive_all_ones_is_an_answer_and_driven_logs_are_not_held() {
    let mut log = made((0..50).map(|i| f64::from(i) * 0.01).collect(), vec![0.3; 50]);
    log.drive = Some(vec![true; 50]);
    let held = look(&log);
    assert_eq!((held.start, held.moved, held.longest_run), (Start::AlwaysHeld, false, 50));
    assert_eq!(held.rest_from_s, Some(0.0));
    assert_eq!(health(&log, &SensorSpec::default(), DriveMode::Position).start, Start::Free);
}

#[test]
fn lost_samples_and_jitter() {
    let mut t: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.005).collect();
    t.drain(50..53);
    t.remove(100);
    let health = look(&made(t.clone(), t.iter().map(|t| t.sin()).collect()));
    assert_eq!((health.samples, health.lost_samples), (196, 4));
    assert_relative_eq!(health.period_s, 0.005, epsilon = 1e-12);
    assert!(health.jitter_s < 1e-9);
}

#[test]
fn quantisation_is_found_or_denied() {
    let mut noise = noise_source();
    let t: Vec<f64> = (0..1500).map(|i| f64::from(i) * 0.005).collect();
    let swing: Vec<f64> = t.iter().map(|t| 1.2 * (-0.4 * t).exp() * (7.0 * t).cos()).collect();
    for step in [0.0003815, 0.001534, 0.006, 0.0174533] {
        // read noise of a step, then rounded, then printed with six decimals
        let q: Vec<f64> = swing.iter().map(|q| ((q / step + noise()).round() * step * 1e6).round() / 1e6).collect();
        assert_relative_eq!(look(&made(t.clone(), q)).step_rad.unwrap(), step, max_relative = 1e-3);
    }
    let continuous: Vec<f64> = swing.iter().map(|q| q + 0.004 * noise()).collect();
    assert_eq!(look(&made(t.clone(), continuous.clone())).step_rad, None);
    let printed: Vec<f64> = continuous.iter().map(|q| (q * 1e6).round() / 1e6).collect();
    assert_eq!(look(&made(t, printed)).step_rad, None);
}

#[test]
fn the_floor_is_rounding_and_read_noise_together() {
    let mut noise = noise_source();
    let t: Vec<f64> = (0..2000).map(|i| f64::from(i) * 0.005).collect();
    let swing = |t: f64| 1.2 * (-0.4 * t).exp() * (7.0 * t).cos();
    for (step, read) in [(0.006, 0.0), (0.006, 0.006), (0.0015, 0.004)] {
        let q = t.iter().map(|t| ((swing(*t) + 2.0 * read * noise()) / step).round() * step).collect();
        let (log, sensor) = (made(t.clone(), q), SensorSpec { resolution_rad: Some(step), period_s: None });
        let health = health(&log, &sensor, DriveMode::Off);
        let truth = (step * step / 12.0 + read * read / 3.0).sqrt();
        let floor = health.read_noise_rad.hypot(step / 12.0_f64.sqrt());
        assert!((floor / truth - 1.0).abs() < 0.12, "step {step}, noise {read}: {floor} {truth}");
        assert!(health.doubts().is_empty(), "{:?}", health.doubts());
    }
}

#[test]
fn the_shipped_logs_have_no_doubts_and_know_when_they_stand_still() {
    for file in swings("thesis-robot").iter().chain(&swings("sealed-robot")) {
        let health = look(&read_log(file).unwrap());
        assert!(health.doubts().is_empty(), "{}: {:?}", file.display(), health.doubts());
        let held = health.start.held().map_or(0.0, |held| held.release_s / health.duration_s);
        assert!(health.still_share >= 0.9 * held && health.still_share <= 1.0, "{}", file.display());
    }
}

#[test]
fn noise_alone_is_not_motion() {
    let mut noise = noise_source();
    let t: Vec<f64> = (0..5000).map(|i| f64::from(i) * 0.002).collect();
    let health = look(&made(t.clone(), t.iter().map(|_| 0.3 + 0.01 * noise()).collect()));
    assert!(!health.moved);
    assert_relative_eq!(health.noise_rad, 0.01 / 12.0_f64.sqrt(), max_relative = 0.2);
    assert_eq!(health.rest_from_s, Some(0.0));
}
