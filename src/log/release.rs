//! When a held joint was let go.
//!
//! Without a `drive` column the release has to come from the angle. A joint let go from rest leaves as
//! `q = c + a s^2/2 + j s^3/6` with `s = t - t_r`; before `t_r` it stays at `c`. For a given `t_r` this is linear, so
//! `t_r` is scanned. A log that starts free follows `c + v s + a s^2/2 + j s^3/6` from its first sample instead; the
//! two have the same number of parameters and are compared by what they leave.

use super::types::{DriveMode, Log};

/// Samples before the joint leaves its initial level that the scan looks at.
const BEFORE: usize = 80;
/// Fewest samples after it.
const AFTER: usize = 6;
/// Steps of the scan per sampling period.
const FINENESS: f64 = 4.0;
/// Rise of the sum of squares, in variances of the reading, that bounds the release: three standard deviations.
const RISE: f64 = 9.0;

/// A joint that was held at the start of a log and then let go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldPhase {
    /// Index of the last sample that was certainly held.
    pub last_held: usize,
    /// Index of the first sample that was certainly free.
    pub first_free: usize,
    /// Best estimate of the instant of release \[s\], in the log's time.
    pub release_s: f64,
    /// The release was between these instants, the times of the two samples \[s\].
    pub window_s: [f64; 2],
}

/// How a log begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// The joint is free or driven from the first sample, or nothing shows that it was held.
    Free,
    /// The joint is held and then let go.
    Held(HeldPhase),
    /// Column `drive` is 1 throughout a log with `drive = "off"`: it was never let go.
    AlwaysHeld,
}

impl Start {
    /// The held phase, if the log begins with one that ends.
    pub fn held(&self) -> Option<&HeldPhase> {
        match self {
            Self::Held(phase) => Some(phase),
            Self::Free | Self::AlwaysHeld => None,
        }
    }
}

/// How the log begins: from column `drive` where there is one, otherwise from the angle.
pub(super) fn start(log: &Log, mode: DriveMode, period_s: f64, sigma_rad: f64, step_rad: f64) -> Start {
    if mode != DriveMode::Off {
        return Start::Free;
    }
    let Some(drive) = &log.drive else {
        return from_angle(&log.t_s, &log.q_rad, period_s, sigma_rad, step_rad).map_or(Start::Free, Start::Held);
    };
    match drive.iter().position(|held| !held) {
        None => Start::AlwaysHeld,
        Some(0) => Start::Free,
        Some(first_free) => {
            let window_s = [log.t_s[first_free - 1], log.t_s[first_free]];
            Start::Held(HeldPhase { last_held: first_free - 1, first_free, release_s: window_s[1], window_s })
        }
    }
}

fn from_angle(t: &[f64], q: &[f64], period_s: f64, sigma: f64, step: f64) -> Option<HeldPhase> {
    let leaves = leaves_level(q, (1.5 * step).max(4.0 * sigma))?;
    let from = leaves.saturating_sub(BEFORE);
    let to = first_part(q, leaves, from);
    let (t, q) = (&t[from..to], &q[from..to]);
    let leaves = leaves - from;

    let free = residual(t, q, None)?;
    let earliest = if from == 0 { t[0] + 2.0 * period_s } else { t[0] };
    let steps = ((t[leaves] - earliest) / period_s * FINENESS).ceil();
    if steps < 1.0 {
        return None;
    }
    let scan: Vec<(f64, f64)> = (0..=steps.min(4.0 * FINENESS * BEFORE as f64) as usize)
        .map(|i| (t[leaves] - i as f64 * period_s / FINENESS).max(earliest))
        .filter_map(|release| Some((release, residual(t, q, Some(release))?)))
        .collect();
    let &(best_s, least) = scan.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    // at the earliest instant the two models are almost the same: a better fit there is chance
    if best_s <= earliest + 0.5 * period_s && from == 0 || least >= 0.9 * free {
        return None;
    }
    let variance = (least / (q.len().saturating_sub(4).max(1)) as f64).max(step * step / 12.0).max(sigma * sigma);
    let within = |rise: f64| {
        let near = scan.iter().filter(move |(_, sum)| *sum <= least + rise * variance).map(|(release, _)| *release);
        near.fold((best_s, best_s), |(low, high), x| (low.min(x), high.max(x)))
    };
    let (low, high) = within(RISE);
    // a strongly damped joint soon turns from the cubic, which puts the release up to two samples early; the other
    // swings hardly change by going half-way to the latest release that is as good
    let release_s = 0.5 * (best_s + within(1.0).1);
    // the cubic is not the joint: fine encoders show that by a sample or two
    let last_held = t.iter().rposition(|&x| x <= low - 1.5 * period_s)?;
    let first_free = t.iter().position(|&x| x >= high + period_s)?;
    let window_s = [t[last_held], t[first_free]];
    Some(HeldPhase { last_held: from + last_held, first_free: from + first_free, release_s, window_s })
}

/// First of two samples in a row that are off the initial level by more than `tolerance`.
fn leaves_level(q: &[f64], tolerance: f64) -> Option<usize> {
    let (mut sum, mut count) = (0.0, 0.0);
    for (i, &value) in q.iter().enumerate() {
        if count > 0.0 && (value - sum / count).abs() > tolerance {
            let level = sum / count;
            if q.get(i + 1).is_none_or(|next| (next - level).abs() > tolerance) {
                return Some(i);
            }
            continue; // an outlier
        }
        sum += value;
        count += 1.0;
    }
    None
}

/// End of the part of the motion that a cubic describes: a third of the way to the first turning point.
fn first_part(q: &[f64], leaves: usize, from: usize) -> usize {
    let level = q[from];
    let sign = (q[leaves] - level).signum();
    let mut farthest = 0.0_f64;
    for &value in &q[leaves..] {
        let excursion = sign * (value - level);
        if excursion < 0.8 * farthest {
            break;
        }
        farthest = farthest.max(excursion);
    }
    let end = q[leaves..].iter().position(|value| sign * (value - level) > 0.3 * farthest);
    end.map_or(q.len(), |i| leaves + i.max(AFTER)).min(q.len())
}

/// Sum of squares that the best cubic leaves: released from rest at `release`, or free from the first sample.
fn residual(t: &[f64], q: &[f64], release: Option<f64>) -> Option<f64> {
    let (origin, first_power) = release.map_or((t[0], 1), |release| (release, 2));
    let scale = (t[t.len() - 1] - origin).max(f64::MIN_POSITIVE);
    let terms = |x: f64| {
        let s = ((x - origin) / scale).max(0.0);
        if first_power == 1 { [1.0, s, s * s, s * s * s] } else { [1.0, s * s, s * s * s, 0.0] }
    };
    let unknowns = if first_power == 1 { 4 } else { 3 };
    let mut normal = nalgebra::DMatrix::<f64>::zeros(unknowns, unknowns);
    let mut right = nalgebra::DVector::<f64>::zeros(unknowns);
    let level = q[0];
    for (&x, &y) in t.iter().zip(q) {
        let row = terms(x);
        for i in 0..unknowns {
            right[i] += row[i] * (y - level);
            for j in 0..unknowns {
                normal[(i, j)] += row[i] * row[j];
            }
        }
    }
    for i in 0..unknowns {
        normal[(i, i)] += 1e-12 * t.len() as f64; // two samples after the release leave the cubic open
    }
    let solution = normal.cholesky()?.solve(&right);
    // at rest the acceleration is largest or nearly so: one that is mostly still to come is a release too early
    if release.is_some() && solution[2] * solution[1].signum() > 0.5 * solution[1].abs() {
        return None;
    }
    let left = t.iter().zip(q).map(|(&x, &y)| {
        let fit: f64 = terms(x).iter().zip(solution.iter()).map(|(a, b)| a * b).sum();
        (y - level - fit).powi(2)
    });
    Some(left.sum())
}
