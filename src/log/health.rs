//! What a log is like before anything is fitted: sampling, quantisation, noise, held phase, rest.

use super::health_correlation::{at_rest, correlation, lasts_s};
use super::health_motion::{reversals, top_speed_rad_s, wraps_at_s};
use super::health_noise::reading_floor_rad;
use super::health_saturation::{Stuck, stuck, torque_plateau};
use super::health_stamps::{
    SetpointStamps, burst_share, setpoint_stamps, share_of_time, stale_share, stamps_contradicted, still_stretches,
};
use super::plausible::{median, median_step};
use super::release::{self, Start};
use super::spikes::Spikes;
use super::types::{DriveMode, Log, SensorSpec};
use crate::number::{extent, math};

/// A joint is at rest at the end if it stays still for at least this long \[s\] and [`REST_SAMPLES`].
const REST_S: f64 = 0.25;
const REST_SAMPLES: usize = 5;
/// Readings whose levels are looked at.
const READINGS: usize = 200_000;
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
    /// Longest step between two stamps \[s\].
    pub longest_step_s: f64,
    /// Samples that are missing, by gaps of a multiple of the median step.
    pub lost_samples: usize,
    /// Quantisation step as the readings show it \[rad\]; `None` if they are continuous or too few.
    pub step_rad: Option<f64>,
    /// Standard deviation of the reading where the joint moves least \[rad\]; at least what the step alone causes.
    pub noise_rad: f64,
    /// Read noise beyond the rounding, by how rough the readings are all along the log \[rad\]; 0: none is seen.
    pub read_noise_rad: f64,
    /// Correlation of the noise with itself so many samples later, where the joint stands still, from 0 on; empty: it cannot
    /// be told.
    pub noise_correlation: Vec<f64>,
    /// How long the noise hangs together \[s\]; `None`: it cannot be told.
    pub noise_lasts_s: Option<f64>,
    /// Share of the readings of the moving joint that repeat the one before, where they should have moved \[0 to 1\].
    pub stale_share: f64,
    /// Share of the time steps that are far shorter than the mean one \[0 to 1\]: stamps that come in bursts.
    pub burst_share: f64,
    /// The motion shows that samples were taken evenly although their stamps are uneven.
    pub stamps_contradicted: bool,
    /// Share of the time in which the joint does not move: held, or stuck \[0 to 1\].
    pub still_share: f64,
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
    /// From the lowest to the highest reading \[rad\].
    pub travel_rad: f64,
    /// The speed that one reading in a hundred exceeds \[rad/s\].
    pub top_speed_rad_s: f64,
    /// How often the motion turns back.
    pub reversals: usize,
    /// Setpoints that have stamps of their own, against the readings.
    pub setpoint_stamps: Option<SetpointStamps>,
    /// The largest torque \[N m\] and the share of the samples that stand at it, where a position-driven log shows so.
    pub torque_plateau: Option<(f64, f64)>,
    /// The reading stands at its end while the setpoint goes on.
    pub stuck: Option<Stuck>,
    /// Single readings that jump and come back, which all else is told without.
    pub spikes: Option<Spikes>,
    /// When the reading first jumps by a turn from one sample to the next \[s\]; `None`: it does not.
    pub wraps_at_s: Option<f64>,
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
    let (t, mut q) = (&log.t_s[..], log.q_rad.clone());
    let spikes = Spikes::mended(t, &mut q);
    let q = &q[..];
    let period_s = median_step(t);
    let (jitter_s, lost_samples) = jitter(t, period_s);
    let step_rad = quantisation(q);
    let step = sensor.resolution_rad.or(step_rad).unwrap_or(0.0);
    let noise_rad = noise(q).max(step / 12.0_f64.sqrt());
    let read_noise_rad = (reading_floor_rad(q, step).powi(2) - step * step / 12.0).max(0.0).sqrt();
    let floor_rad = math::hypot(read_noise_rad, step / 12.0_f64.sqrt());
    let start = release::start(log, mode, period_s, noise_rad, step);
    let held = match start {
        Start::Free => &q[..0],
        Start::Held(phase) => &q[..=phase.last_held],
        Start::AlwaysHeld => q,
    };
    let held_samples = held.len();
    let held = match start {
        Start::Held(_) => at_last(held, (1.5 * step).max(4.0 * noise_rad).max(8.0 * read_noise_rad) + SAME_LEVEL),
        _ => held,
    };
    let (mean, std) = mean_std(held);
    let there = !held.is_empty();
    let level = if there { mean } else { median(&mut q[..q.len().min(5)].to_vec()) };
    let middle = median(&mut q.to_vec());
    let band_rad = (1.5 * step).max(4.0 * floor_rad) + SAME_LEVEL;
    let still = still_stretches(t, q, band_rad, REST_S);
    let rests = log.q_ref_rad.as_ref().map_or_else(Vec::new, |asked| at_rest(t, q, asked));
    let quiet = if rests.is_empty() { &still } else { &rests };
    // A motion below the step shows as readings that change slowly between two levels: that is no noise.
    let noise_correlation = correlation(t, q, quiet, (0.6 * step).max(SAME_LEVEL));
    // A torque that is the log's input is at its largest by design.
    let is_input = mode == DriveMode::Torque;
    let [low, high] = extent(q.iter().copied());
    Health {
        samples: log.len(),
        duration_s: t.last().zip(t.first()).map_or(0.0, |(last, first)| last - first),
        period_s,
        jitter_s,
        longest_step_s: t.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max),
        lost_samples,
        step_rad,
        noise_rad,
        read_noise_rad,
        noise_lasts_s: (!noise_correlation.is_empty()).then(|| lasts_s(&noise_correlation, period_s)),
        noise_correlation,
        stale_share: stale_share(t, q, step, floor_rad),
        burst_share: burst_share(t),
        stamps_contradicted: stamps_contradicted(t, q, floor_rad),
        still_share: share_of_time(t, &still),
        start,
        held_mean_rad: there.then_some(mean),
        held_std_rad: (held.len() > 1).then_some(std),
        rest_from_s: rest_from(t, q, (1.5 * step).max(4.0 * noise_rad)),
        moved: start != Start::AlwaysHeld && leaves(&q[held_samples..], level, 3.0 * step.max(noise_rad)),
        span_rad: q.iter().fold(0.0, |span, value| (value - middle).abs().max(span)),
        longest_run: longest_run(q),
        travel_rad: (high - low).max(0.0),
        top_speed_rad_s: top_speed_rad_s(t, q, period_s),
        reversals: reversals(q, 2.0 * band_rad),
        setpoint_stamps: log.setpoints.as_ref().and_then(|own| setpoint_stamps(&own.t_s, t)),
        torque_plateau: log.tau_nm.as_ref().filter(|_| !is_input).and_then(|tau| torque_plateau(tau)),
        stuck: log
            .q_ref_rad
            .as_ref()
            .filter(|_| !is_input)
            .and_then(|asked| stuck(t, q, asked, band_rad.max(0.01 * (high - low)))),
        spikes,
        wraps_at_s: wraps_at_s(t, q, period_s),
    }
}

/// Readings that repeat beyond this share, and bursts beyond this share of the steps, are worth a remark.
const WORTH_A_REMARK: f64 = 0.05;

impl Health {
    /// What is wrong with the readings or their times, in words; empty for a sound log.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = Vec::new();
        if let Some(at_s) = self.wraps_at_s {
            doubts.push(format!(
                "the reading jumps by a turn at {at_s:.3} s: the angle is wrapped; unwrap it (numpy.unwrap) before anything is fitted"
            ));
        }
        doubts.extend(self.spikes.map(|spikes| spikes.words()));
        if self.stale_share > WORTH_A_REMARK {
            let percent = 100.0 * self.stale_share;
            doubts.push(format!("{percent:.0} % of the readings in motion repeat the one before: they come late"));
        }
        if self.stamps_contradicted {
            doubts.push("time stamps are uneven, and the motion shows that the samples are not".to_owned());
        } else if self.burst_share > WORTH_A_REMARK {
            let percent = 100.0 * self.burst_share;
            doubts.push(format!("time stamps come in bursts: {percent:.0} % of the steps are far below the mean"));
        }
        if let Some((at_nm, share)) = self.torque_plateau {
            let percent = 100.0 * share;
            doubts.push(format!("the torque stands at its largest, {at_nm:.3} N m, for {percent:.0} % of the time: the drive is at its limit"));
        }
        doubts.extend(self.stuck.map(|stuck| stuck.words()));
        if let Some(lasts_s) = self.noise_lasts_s.filter(|lasts_s| *lasts_s > 2.0 * self.period_s) {
            doubts.push(format!(
                "the noise at rest hangs together over {:.1} ms: filtered readings, or a joint that trembles",
                1e3 * lasts_s
            ));
        }
        doubts
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
/// wins, and is refined over the whole range. Of a long log some of the readings show the levels.
pub(super) fn quantisation(q: &[f64]) -> Option<f64> {
    let mut levels: Vec<f64> = q.iter().step_by(q.len().div_ceil(READINGS).max(1)).copied().collect();
    let readings = levels.len();
    levels.sort_unstable_by(f64::total_cmp);
    levels.dedup_by(|a, b| (*a - *b).abs() <= SAME_LEVEL);
    let mut gaps: Vec<f64> = levels.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_unstable_by(f64::total_cmp);
    let crowded = levels.len() as f64 <= 0.8 * readings as f64;
    let enough = gaps.len() >= 8 || levels.len() * 4 <= readings;
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

/// The end of a held phase while the reading stays: before it a servo may have carried the joint there.
fn at_last(held_rad: &[f64], band_rad: f64) -> &[f64] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let stays = held_rad.iter().rev().take_while(|q| {
        (low, high) = (low.min(**q), high.max(**q));
        high - low <= band_rad
    });
    &held_rad[held_rad.len() - stays.count()..]
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
#[path = "health_tests.rs"]
mod tests;
