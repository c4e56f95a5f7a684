//! What a log is like before anything is fitted: sampling, quantisation, noise, held phase, rest.

use super::plausible::{median, median_step};
use super::release::{self, Start};
use super::types::{DriveMode, Log, SensorSpec};

/// A joint is at rest at the end if it stays still for at least this long \[s\] and [`REST_SAMPLES`].
const REST_S: f64 = 0.25;
const REST_SAMPLES: usize = 5;
/// Levels closer than this are one \[rad\]: rounding of the log's decimals.
const SAME_LEVEL: f64 = 1e-9;
/// A step as fine as this is the log's decimals, not the encoder \[rad\].
const FINEST_STEP: f64 = 2e-6;

/// What a log is like.
#[derive(Clone, Debug, PartialEq)]
pub struct Health {
    /// Number of samples.
    pub samples: usize,
    /// Last time less first \[s\].
    pub duration_s: f64,
    /// Median sampling step \[s\].
    pub period_s: f64,
    /// Robust standard deviation of the sampling step (1.4826 times the median deviation) \[s\].
    pub jitter_s: f64,
    /// Samples that are missing, by gaps of a multiple of the median step.
    pub lost_samples: usize,
    /// Quantisation step as the readings show it \[rad\]; `None` if they are continuous or too few.
    pub step_rad: Option<f64>,
    /// Standard deviation of the reading where the joint moves least \[rad\]; at least what the step alone causes.
    pub noise_rad: f64,
    /// How the log begins.
    pub start: Start,
    /// Mean reading while held \[rad\].
    pub held_mean_rad: Option<f64>,
    /// Standard deviation of the reading while held \[rad\].
    pub held_std_rad: Option<f64>,
    /// From here to the end the joint moves no more than 1.5 steps (or the noise) \[s\]; `None` if it does not rest.
    pub rest_from_s: Option<f64>,
    /// Whether the joint, once free or driven, moved by more than 3 steps and 3 standard deviations.
    pub moved: bool,
    /// Largest distance of a reading from the median reading \[rad\].
    pub span_rad: f64,
    /// Longest run of identical readings, in samples.
    pub longest_run: usize,
}

/// Looks at a log. `sensor` gives the quantisation step where the study states it, `mode` what `drive = 1` means.
///
/// ```
/// use aibo_fit::log::{DriveMode, SensorSpec, health, read_log};
/// let log = read_log("data/thesis-robot/q1.csv".as_ref())?;
/// let health = health(&log, &SensorSpec::default(), DriveMode::Off);
/// assert!((health.step_rad.unwrap() - 0.006).abs() < 1e-6);
/// assert_eq!(health.start.held().unwrap().release_s, 0.4);
/// # Ok::<(), aibo_fit::log::LogError>(())
/// ```
pub fn health(log: &Log, sensor: &SensorSpec, mode: DriveMode) -> Health {
    let (t, q) = (&log.t_s[..], &log.q_rad[..]);
    let period_s = median_step(t);
    let (jitter_s, lost_samples) = jitter(t, period_s);
    let step_rad = quantisation(q);
    let step = sensor.resolution_rad.or(step_rad).unwrap_or(0.0);
    let noise_rad = noise(q).max(step / 12.0_f64.sqrt());
    let start = release::start(log, mode, period_s, noise_rad, step);
    let held = match start {
        Start::Free => &q[..0],
        Start::Held(phase) => &q[..=phase.last_held],
        Start::AlwaysHeld => q,
    };
    let (mean, std) = mean_std(held);
    let there = !held.is_empty();
    let level = if there { mean } else { median(&mut q[..q.len().min(5)].to_vec()) };
    let middle = median(&mut q.to_vec());
    Health {
        samples: log.len(),
        duration_s: t.last().zip(t.first()).map_or(0.0, |(last, first)| last - first),
        period_s,
        jitter_s,
        lost_samples,
        step_rad,
        noise_rad,
        start,
        held_mean_rad: there.then_some(mean),
        held_std_rad: (held.len() > 1).then_some(std),
        rest_from_s: rest_from(t, q, (1.5 * step).max(4.0 * noise_rad)),
        moved: start != Start::AlwaysHeld && leaves(&q[held.len()..], level, 3.0 * step.max(noise_rad)),
        span_rad: q.iter().fold(0.0, |span, value| (value - middle).abs().max(span)),
        longest_run: longest_run(q),
    }
}

/// Robust spread of the steps, and how many samples are missing.
fn jitter(t: &[f64], period_s: f64) -> (f64, usize) {
    let (mut lost, mut deviations) = (0, Vec::with_capacity(t.len()));
    for pair in t.windows(2) {
        let step = pair[1] - pair[0];
        let periods = (step / period_s).round();
        // a step between multiples is another sampling rate, not a loss
        if periods >= 2.0 && (step / period_s - periods).abs() < 0.25 {
            lost += periods as usize - 1;
        } else {
            deviations.push((step - period_s).abs());
        }
    }
    (1.4826 * median(&mut deviations), lost)
}

/// The step between neighbouring levels of the reading.
///
/// The levels that occur are sorted; in a quantised signal the distances between neighbours are small multiples of one
/// step. Candidates are fractions of their median and of the smallest; the largest that nearly all are multiples of
/// wins, and is refined over the whole range.
fn quantisation(q: &[f64]) -> Option<f64> {
    let mut levels = q.to_vec();
    levels.sort_unstable_by(f64::total_cmp);
    levels.dedup_by(|a, b| (*a - *b).abs() <= SAME_LEVEL);
    let mut gaps: Vec<f64> = levels.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_unstable_by(f64::total_cmp);
    let crowded = levels.len() as f64 <= 0.8 * q.len() as f64;
    let enough = gaps.len() >= 8 || levels.len() * 4 <= q.len();
    if gaps.is_empty() || !crowded || !enough {
        return None;
    }
    let (middle, least) = (gaps[gaps.len() / 2], gaps[gaps.len() / 50]);
    let fractions = |gap: f64, parts: u32| (1..=parts).map(move |k| gap / f64::from(k));
    let mut candidates: Vec<f64> = fractions(middle, 8).chain(fractions(least, 3)).collect();
    candidates.sort_unstable_by(|a, b| b.total_cmp(a));
    let fits = |step: f64| {
        let near = gaps.iter().filter(|gap| {
            let steps = (*gap / step).round();
            steps >= 1.0 && (*gap / step - steps).abs() < 0.1
        });
        near.count() as f64 >= 0.97 * gaps.len() as f64
    };
    let rough = candidates.into_iter().find(|step| fits(*step))?;
    let (length, steps) =
        gaps.iter().fold((0.0, 0.0), |(length, steps), gap| (length + gap, steps + (gap / rough).round()));
    Some(length / steps).filter(|step| *step >= FINEST_STEP)
}

/// Standard deviation of the reading from second differences, in the calmest quarter of the log.
fn noise(q: &[f64]) -> f64 {
    let second: Vec<f64> = q.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).powi(2)).collect();
    let block = (second.len() / 8).clamp(1, 50);
    let mut means: Vec<f64> = second.chunks_exact(block).map(|c| c.iter().sum::<f64>() / block as f64).collect();
    if means.is_empty() {
        return 0.0;
    }
    let quarter = means.len() / 4;
    let (_, calm, _) = means.select_nth_unstable_by(quarter, f64::total_cmp);
    (*calm / 6.0).sqrt() // white noise: the weights 1, -2, 1
}

fn mean_std(q: &[f64]) -> (f64, f64) {
    let n = q.len() as f64;
    let mean = q.iter().sum::<f64>() / n.max(1.0);
    let squares: f64 = q.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0).max(1.0)).sqrt())
}

/// Whether a running median of five readings goes further than `threshold` from `level`.
fn leaves(q: &[f64], level: f64, threshold: f64) -> bool {
    // three steps exactly are not more than three steps, whatever the decimals do
    let far = |values: &[f64]| (median(&mut values.to_vec()) - level).abs() > threshold + SAME_LEVEL;
    if q.len() < 5 { !q.is_empty() && far(q) } else { q.windows(5).any(far) }
}

fn rest_from(t: &[f64], q: &[f64], tolerance: f64) -> Option<f64> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut from = q.len();
    for (i, &value) in q.iter().enumerate().rev() {
        (low, high) = (low.min(value), high.max(value));
        if high - low > tolerance + SAME_LEVEL {
            break;
        }
        from = i;
    }
    let (&first, &last) = (t.get(from)?, t.last()?);
    (last - first >= REST_S && q.len() - from >= REST_SAMPLES).then_some(first)
}

fn longest_run(q: &[f64]) -> usize {
    q.chunk_by(|a, b| a == b).map(<[f64]>::len).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
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
            drive: None,
            ignored_columns: vec![],
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
    fn noise_alone_is_not_motion() {
        let mut noise = noise_source();
        let t: Vec<f64> = (0..5000).map(|i| f64::from(i) * 0.002).collect();
        let health = look(&made(t.clone(), t.iter().map(|_| 0.3 + 0.01 * noise()).collect()));
        assert!(!health.moved);
        assert_relative_eq!(health.noise_rad, 0.01 / 12.0_f64.sqrt(), max_relative = 0.2);
        assert_eq!(health.rest_from_s, Some(0.0));
    }
}
