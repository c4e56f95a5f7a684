//! What a log's motion offers: how fast, how often it turns.

use std::f64::consts::TAU;

/// Speeds are taken over at least this long \[s\], so that noise at a high sampling rate is not speed.
const SPEED_BASE_S: f64 = 0.02;
/// One in so many speeds may be above the top one: what is left of the noise.
const ABOVE: usize = 100;
/// A jump that is so near to a turn is one \[rad\], between samples that are no more than so many periods apart.
const NEAR_A_TURN_RAD: f64 = 0.6;
const AT_ONCE: f64 = 2.5;
/// A reading that jumps and comes back is so many times as far off as noise would have it, and what lies before it, behind it and
/// on both sides of it differs by no more than this share of that.
const BEYOND_NOISE: f64 = 20.0;
const AROUND: f64 = 0.2;

/// The speed that one reading in a hundred exceeds \[rad/s\]; 0 of fewer than three readings.
pub(super) fn top_speed_rad_s(t_s: &[f64], q_rad: &[f64], period_s: f64) -> f64 {
    let stride = (SPEED_BASE_S / period_s).ceil().clamp(1.0, 1000.0) as usize;
    let ends = t_s.iter().zip(q_rad).skip(stride);
    let mut speeds: Vec<f64> =
        t_s.iter().zip(q_rad).zip(ends).map(|((t0, q0), (t1, q1))| ((q1 - q0) / (t1 - t0)).abs()).collect();
    let at = speeds.len().saturating_sub(1 + speeds.len() / ABOVE);
    if speeds.is_empty() { 0.0 } else { *speeds.select_nth_unstable_by(at, f64::total_cmp).1 }
}

/// When the reading first jumps by a turn between two samples that follow one another \[s\].
pub(super) fn wraps_at_s(t_s: &[f64], q_rad: &[f64], period_s: f64) -> Option<f64> {
    let jumps = |q: &[f64]| ((q[1] - q[0]).abs() - TAU).abs() < NEAR_A_TURN_RAD;
    let follow = |t: &[f64]| t[1] - t[0] < AT_ONCE * period_s;
    let mut pairs = t_s.windows(2).zip(q_rad.windows(2));
    pairs.find(|(t, q)| follow(t) && jumps(q)).map(|(t, _)| t[1])
}

/// Single readings that stand far off both of their neighbours: no joint jumps and is back by the next sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spikes {
    /// How many.
    pub count: usize,
    /// When the first one is read \[s\].
    pub first_s: f64,
    /// How far that stands off \[rad\].
    pub off_rad: f64,
}

impl Spikes {
    /// Of readings whose noise is known.
    pub(super) fn of(t_s: &[f64], q_rad: &[f64], floor_rad: f64) -> Option<Self> {
        let off = |(t_s, q): (&f64, &[f64])| {
            let (there, back) = (q[2] - q[1], q[2] - q[3]);
            let off_rad = there.abs().min(back.abs());
            let around = [q[1] - q[0], q[3] - q[1], q[4] - q[3]];
            let is_calm = around.iter().all(|step| step.abs() < AROUND * off_rad);
            (there * back > 0.0 && is_calm && off_rad > BEYOND_NOISE * floor_rad).then_some((*t_s, off_rad))
        };
        let mut spikes = t_s.iter().skip(2).zip(q_rad.windows(5)).filter_map(off);
        let (first_s, off_rad) = spikes.next()?;
        Some(Self { count: 1 + spikes.count(), first_s, off_rad })
    }

    /// `1 reading jumps and is back at the next sample, by 3.000 rad at 4.120 s: ...`
    pub(super) fn words(&self) -> String {
        let Self { count, first_s, off_rad } = self;
        let (first, jump) =
            if *count == 1 { ("", "reading jumps and is") } else { ("the first ", "readings jump and are") };
        format!(
            "{count} {jump} back at the next sample, {first}by {off_rad:.3} rad at {first_s:.3} s: no joint does; leave \
             those rows out"
        )
    }
}

/// How often the motion turns back by more than a band.
pub(super) fn reversals(q_rad: &[f64], band_rad: f64) -> usize {
    let Some(first) = q_rad.first() else { return 0 };
    let (mut low, mut high, mut rises, mut turns) = (*first, *first, None, 0);
    for q in q_rad {
        (low, high) = (low.min(*q), high.max(*q));
        let is_up = *q > low + band_rad && rises != Some(true);
        let is_down = *q < high - band_rad && rises != Some(false);
        if is_up || is_down {
            turns += usize::from(rises.is_some());
            rises = Some(is_up);
            (low, high) = (*q, *q);
        }
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_that_is_wrapped_jumps_by_a_turn() {
        let t: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let free: Vec<f64> = t.iter().map(|t| 3.0 * t).collect();
        let wrapped: Vec<f64> = free.iter().map(|q| if *q > 3.0 { q - TAU } else { *q }).collect();
        assert_eq!(wraps_at_s(&t, &free, 0.01), None);
        assert!((wraps_at_s(&t, &wrapped, 0.01).unwrap() - 1.01).abs() < 1e-9);
        // Beyond a hole a joint may be anywhere.
        let [apart, away] = [[0.0, 0.5], [0.0, 6.3]];
        assert_eq!(wraps_at_s(&apart, &away, 0.01), None);
    }

    #[test]
    fn a_swing_turns_twice_a_period_and_noise_does_not_turn_it() {
        let t: Vec<f64> = (0..1000).map(|k| 0.005 * f64::from(k)).collect();
        let q: Vec<f64> = t.iter().enumerate().map(|(k, t)| (4.0 * t).sin() + 0.002 * (k % 2) as f64).collect();
        // 20 rad of phase: peaks at pi/2, 3 pi/2 ... 11 pi/2 and 13 pi/2 beyond.
        assert_eq!(reversals(&q, 0.01), 6);
        let speed = top_speed_rad_s(&t, &q, 0.005);
        assert!((3.9..4.2).contains(&speed), "{speed}");
        assert_eq!((reversals(&[], 0.1), top_speed_rad_s(&[0.0], &[1.0], 0.01)), (0, 0.0));
    }

    #[test]
    fn a_reading_that_jumps_and_comes_back_is_told_from_motion_and_noise() {
        let t_s: Vec<f64> = (0..400).map(|k| 0.02 * k as f64).collect();
        let noise = |k: usize| 5e-4 * (0.1 * (k * k % 97) as f64).sin();
        let mut q_rad: Vec<f64> = t_s.iter().enumerate().map(|(k, t)| (3.0 * t).sin() + noise(k)).collect();
        let spikes = |q: &[f64]| Spikes::of(&t_s, q, 4e-4);
        assert_eq!(spikes(&q_rad), None);
        q_rad[200] += 3.0;
        q_rad[300] -= 2.0;
        let found = spikes(&q_rad).unwrap();
        assert_eq!((found.count, found.first_s), (2, 4.0));
        assert!((found.off_rad - 3.0).abs() < 0.1, "{found:?}");
        assert!(found.words().contains("2 readings jump and are back"), "{}", found.words());
        // What steps from place to place, or swings faster than it is sampled, does not jump.
        let steps: Vec<f64> = (0..400).map(|k| if k / 50 % 2 == 0 { 0.0 } else { 1.0 }).collect();
        let fast: Vec<f64> = (0..400).map(|k| (2.9 * k as f64).sin()).collect();
        assert_eq!([spikes(&steps), spikes(&fast)], [None; 2]);
    }
}
