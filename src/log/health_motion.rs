//! What a log's motion offers: how fast, how often it turns.

use std::f64::consts::TAU;

/// Speeds are taken over at least this long \[s\], so that noise at a high sampling rate is not speed.
const SPEED_BASE_S: f64 = 0.02;
/// One in so many speeds may be above the top one: what is left of the noise.
const ABOVE: usize = 100;
/// A jump that is so near to a turn is one \[rad\], between samples that are no more than so many periods apart.
const NEAR_A_TURN_RAD: f64 = 0.6;
const AT_ONCE: f64 = 2.5;
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
}
