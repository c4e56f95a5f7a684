//! Readings and time stamps that cannot be right: stale readings, stamps in bursts, stamps that the motion contradicts; and
//! how setpoints are stamped against readings.

use super::plausible::median;
use std::ops::Range;

/// A reading is expected to move if the motion about it covers this many steps, or standard deviations, per sample.
const SURELY: f64 = 3.0;
/// Samples either way over which the motion about a reading is taken.
const ABOUT: usize = 4;
/// A step shorter than this share of the mean one is within a burst.
const SHORT: f64 = 0.35;
/// Stamps are contradicted if even ones explain the motion with less than this share of the squares that they leave.
const CONTRADICTED: f64 = 0.25;
/// Uneven stamps are looked at if their steps vary by more than this share of the mean one.
const UNEVEN: f64 = 0.1;
/// Fewest moving samples from which anything is said.
const FEWEST: usize = 20;

/// Share of the readings of a moving joint that repeat the one before them, where they should have moved.
pub(super) fn stale_share(t_s: &[f64], q_rad: &[f64], step_rad: f64, noise_rad: f64) -> f64 {
    let surely_rad = SURELY * step_rad.max(noise_rad);
    let (mut moving, mut stale) = (0, 0);
    for k in ABOUT + 1..q_rad.len().saturating_sub(ABOUT) {
        let step_s = t_s[k] - t_s[k - 1];
        let per_step = |from: usize, to: usize| (q_rad[to] - q_rad[from]) / (t_s[to] - t_s[from]) * step_s;
        // On both sides, and one way: a joint that sets off from rest, or arrives there, repeats its readings rightly.
        let (before, after) = (per_step(k - 1 - ABOUT, k - 1), per_step(k, k + ABOUT));
        if before.abs().min(after.abs()) > surely_rad && (before > 0.0) == (after > 0.0) {
            moving += 1;
            stale += usize::from(q_rad[k] == q_rad[k - 1]);
        }
    }
    if moving < FEWEST { 0.0 } else { stale as f64 / moving as f64 }
}

/// Share of the time steps that are far shorter than the mean one: stamps that come in bursts.
pub(super) fn burst_share(t_s: &[f64]) -> f64 {
    let steps = steps(t_s);
    let Some(mean_s) = mean_without_gaps(&steps) else { return 0.0 };
    steps.iter().filter(|step| **step < SHORT * mean_s).count() as f64 / steps.len() as f64
}

/// Whether the motion shows that samples were taken evenly although their stamps are uneven.
///
/// Over a few samples a joint moves by its speed times the time between them: if the readings advance evenly, uneven
/// stamps are those of the writing, not of the reading.
pub(super) fn stamps_contradicted(t_s: &[f64], q_rad: &[f64], noise_rad: f64) -> bool {
    let all = steps(t_s);
    let Some(mean_s) = mean_without_gaps(&all) else { return false };
    let (mut by_stamps, mut by_count, mut moving) = (0.0, 0.0, 0);
    for k in ABOUT + 1..q_rad.len().saturating_sub(ABOUT) {
        let window = &all[k - 1 - ABOUT..k + ABOUT];
        let local_s = window.iter().sum::<f64>() / window.len() as f64;
        // A gap is a loss, not a wrong stamp.
        let uneven_s = (all[k - 1] - local_s).abs();
        let gap = window.iter().any(|step| *step > 3.0 * mean_s);
        let advance = (q_rad[k + ABOUT] - q_rad[k - 1 - ABOUT]) / window.len() as f64;
        if gap || uneven_s < UNEVEN * local_s || (advance * uneven_s / local_s).abs() < SURELY * noise_rad {
            continue;
        }
        moving += 1;
        let moved = q_rad[k] - q_rad[k - 1];
        by_stamps += (moved - advance * all[k - 1] / local_s).powi(2);
        by_count += (moved - advance).powi(2);
    }
    moving >= FEWEST && by_count < CONTRADICTED * by_stamps
}

fn steps(t_s: &[f64]) -> Vec<f64> {
    t_s.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Mean step, without steps far beyond the typical one, where samples were lost.
fn mean_without_gaps(steps: &[f64]) -> Option<f64> {
    // Within bursts the median may be short: gaps are measured against the upper quartile.
    let mut sorted = steps.to_vec();
    let upper = sorted.len() * 3 / 4;
    if upper >= sorted.len() {
        return None;
    }
    let typical_s = *sorted.select_nth_unstable_by(upper, f64::total_cmp).1;
    let usual: Vec<f64> = steps.iter().copied().filter(|step| *step <= 2.5 * typical_s).collect();
    (!usual.is_empty()).then(|| usual.iter().sum::<f64>() / usual.len() as f64)
}

/// Where readings stay within a band for at least `shortest_s`.
pub(super) fn still_stretches(t_s: &[f64], q_rad: &[f64], band_rad: f64, shortest_s: f64) -> Vec<Range<usize>> {
    let (mut stretches, mut from) = (Vec::new(), 0);
    while from < q_rad.len() {
        let (mut low, mut high) = (q_rad[from], q_rad[from]);
        let inside = |q: &&f64| {
            (low, high) = (low.min(**q), high.max(**q));
            high - low <= band_rad
        };
        let len = q_rad[from..].iter().take_while(inside).count().max(1);
        if t_s[from + len - 1] - t_s[from] >= shortest_s {
            stretches.push(from..from + len);
            from += len;
        } else {
            from += 1;
        }
    }
    stretches
}

/// Share of the time that stretches take.
pub(super) fn share_of_time(t_s: &[f64], stretches: &[Range<usize>]) -> f64 {
    let duration_s = t_s.last().zip(t_s.first()).map_or(0.0, |(last, first)| last - first);
    let still_s = stretches.iter().fold(0.0, |sum, stretch| sum + t_s[stretch.end - 1] - t_s[stretch.start]);
    if duration_s > 0.0 { still_s / duration_s } else { 0.0 }
}

/// Setpoints that have stamps of their own, against the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetpointStamps {
    /// Median step between them \[s\].
    pub period_s: f64,
    /// Median time from a setpoint to the next reading \[s\].
    pub before_reading_s: f64,
    /// Median departure of that time from its own median \[s\]: near a quarter of a period, the two run freely.
    pub spread_s: f64,
}

/// How setpoints with stamps of their own lie to the readings; `None` of fewer than two.
pub(super) fn setpoint_stamps(asked_s: &[f64], read_s: &[f64]) -> Option<SetpointStamps> {
    let mut steps = steps(asked_s);
    let mut until: Vec<f64> = Vec::with_capacity(asked_s.len());
    let mut next = 0;
    for asked in asked_s {
        while read_s.get(next).is_some_and(|read| read < asked) {
            next += 1;
        }
        until.extend(read_s.get(next).map(|read| read - asked));
    }
    if steps.is_empty() || until.is_empty() {
        return None;
    }
    let before_reading_s = median(&mut until);
    let mut apart: Vec<f64> = until.iter().map(|until| (until - before_reading_s).abs()).collect();
    Some(SetpointStamps { period_s: median(&mut steps), before_reading_s, spread_s: median(&mut apart) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swing(t: f64) -> f64 {
        1.2 * (-0.3 * t).exp() * (6.0 * t).cos()
    }

    fn rounded(angles: impl Iterator<Item = f64>, step: f64) -> Vec<f64> {
        angles.map(|q| (q / step).round() * step).collect()
    }

    fn even(n: usize) -> Vec<f64> {
        (0..n).map(|k| k as f64 * 0.008).collect()
    }

    #[test]
    fn a_sound_log_has_nothing_to_show() {
        let t = even(700);
        let q = rounded(t.iter().map(|t| swing(*t)), 0.006);
        assert_eq!(stale_share(&t, &q, 0.006, 0.0017), 0.0);
        assert_eq!(burst_share(&t), 0.0);
        assert!(!stamps_contradicted(&t, &q, 0.0017));
        // Jitter and losses that the stamps tell truly.
        let jittered: Vec<f64> =
            (0..900).filter(|k| k % 37 != 0).map(|k| 0.008 * k as f64 + 0.002 * ((k * 7) % 5) as f64 / 5.0).collect();
        let q = rounded(jittered.iter().map(|t| swing(*t)), 0.0004);
        assert_eq!(burst_share(&jittered), 0.0);
        assert!(!stamps_contradicted(&jittered, &q, 0.0002));
    }

    #[test]
    fn readings_that_come_twice_are_stale() {
        let t = even(700);
        let q = rounded(t.iter().map(|t| swing((t / 0.016).floor() * 0.016)), 0.0015);
        let share = stale_share(&t, &q, 0.0015, 0.0005);
        assert!((0.45..0.55).contains(&share), "{share}");
    }

    #[test]
    fn a_joint_that_jumps_from_rest_to_rest_is_not_stale() {
        let t: Vec<f64> = (0..1000).map(|k| 0.02 * k as f64).collect();
        let jump = |t: f64| 0.3 * ((t / 0.4).floor() + (12.0 * (t % 0.4)).min(1.0));
        let q = rounded(t.iter().map(|t| jump(*t)), 0.0015);
        assert_eq!(stale_share(&t, &q, 0.0015, 0.0005), 0.0);
    }

    #[test]
    fn stamps_in_bursts_are_seen_and_contradicted_by_an_even_motion() {
        // Two samples taken 8 ms apart are written together.
        let truly = even(700);
        let written: Vec<f64> = (0..700).map(|k| 0.016 * (k / 2) as f64 + 0.001 * (k % 2) as f64).collect();
        let q = rounded(truly.iter().map(|t| swing(*t)), 0.0015);
        assert!((burst_share(&written) - 0.5).abs() < 0.01);
        assert!(stamps_contradicted(&written, &q, 0.0005));
        // The same stamps may be right: a logger that takes two quick samples.
        let q = rounded(written.iter().map(|t| swing(*t)), 0.0015);
        assert!(!stamps_contradicted(&written, &q, 0.0005));
    }

    #[test]
    fn held_and_stuck_time_counts_as_still() {
        let t = even(1000);
        let q = rounded(t.iter().map(|t| swing((t - 1.0).clamp(0.0, 4.0))), 0.006);
        let share = share_of_time(&t, &still_stretches(&t, &q, 0.009, 0.25));
        assert!((share - 4.0 / 8.0).abs() < 0.03, "{share}");
    }

    #[test]
    fn setpoints_are_stamped_at_a_fixed_time_before_the_readings_or_freely() {
        let read = even(500);
        let asked: Vec<f64> = read.iter().map(|t| t - 0.003).collect();
        let found = setpoint_stamps(&asked, &read).unwrap();
        assert!((found.period_s - 0.008).abs() < 1e-9 && (found.before_reading_s - 0.003).abs() < 1e-9, "{found:?}");
        assert!(found.spread_s < 1e-9);
        let freely: Vec<f64> = (0..300).map(|k| 0.0107 * f64::from(k)).collect();
        let found = setpoint_stamps(&freely, &read).unwrap();
        assert!((found.spread_s - 0.002).abs() < 3e-4, "{found:?}");
        assert_eq!(setpoint_stamps(&[0.1], &read), None);
    }
}
