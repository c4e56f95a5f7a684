//! Local quadratics through readings: angle, speed and acceleration good enough to start from, never to fit.
//!
//! Second differences of 0.006 rad steps at 8 ms have a standard deviation of 66 rad/s^2; a quadratic over a tenth of a
//! second has 1.2.

/// Half the width of the window \[s\], where it holds at least [`FEWEST`] samples either way.
const HALF_WINDOW_S: f64 = 0.05;
const FEWEST: usize = 3;

/// Angle, speed and acceleration of a quadratic fitted to samples, at `at_s`.
fn quadratic(t_s: &[f64], q_rad: &[f64], at_s: f64) -> Option<[f64; 3]> {
    fitted(t_s, q_rad, at_s).map(|(motion, _)| motion)
}

/// The same with what a sample at `at_s` weighs in its angle.
fn fitted(t_s: &[f64], q_rad: &[f64], at_s: f64) -> Option<([f64; 3], f64)> {
    let span = t_s.last()? - t_s.first()?;
    if t_s.len() < 3 || span <= 0.0 {
        return None;
    }
    // Powers of the time in units of the span keep the three normal equations well conditioned.
    let mut a = nalgebra::Matrix3::zeros();
    let mut b = nalgebra::Vector3::zeros();
    for (t, q) in t_s.iter().zip(q_rad) {
        let u = (t - at_s) / span;
        let row = nalgebra::Vector3::new(1.0, u, u * u);
        a += row * row.transpose();
        b += row * *q;
    }
    let inverse = a.try_inverse()?;
    let c = inverse * b;
    Some(([c[0], c[1] / span, 2.0 * c[2] / (span * span)], inverse[(0, 0)]))
}

/// Smoothed motion at one sample.
pub(super) struct Moment {
    pub index: usize,
    pub angle_rad: f64,
    pub rate_rad_s: f64,
    pub acceleration_rad_s2: f64,
}

/// Smoothed motion at every `stride`-th sample that has a full window on both sides.
pub(super) fn motion(t_s: &[f64], q_rad: &[f64], from: usize, stride: usize) -> Vec<Moment> {
    let n = t_s.len();
    let mut moments = Vec::new();
    let (mut low, mut high) = (from, from);
    for index in (from + FEWEST..n.saturating_sub(FEWEST)).step_by(stride.max(1)) {
        let t = t_s[index];
        while t_s[low] < t - HALF_WINDOW_S {
            low += 1;
        }
        while high + 1 < n && t_s[high + 1] <= t + HALF_WINDOW_S {
            high += 1;
        }
        let (low, high) = (low.min(index - FEWEST), high.max(index + FEWEST));
        if let Some([angle_rad, rate_rad_s, acceleration_rad_s2]) = quadratic(&t_s[low..=high], &q_rad[low..=high], t) {
            moments.push(Moment { index, angle_rad, rate_rad_s, acceleration_rad_s2 });
        }
    }
    moments
}

/// Half the width of the window along which a motion is followed \[s\]: narrower, so that turns are not cut.
const HALF_FOLLOWED_S: f64 = 0.02;
/// Times that it may be wider, each twice as wide as the one before, and samples that are left out to choose.
const WIDER: i32 = 5;
const LEFT_OUT: usize = 500;
/// Of fast logs neighbouring samples are put together until a window has no more than this.
const MOST: usize = 64;

/// Half the width of the window that predicts samples best which are left out \[s\], and the mean square by which it misses
/// them. Accelerations would bear a wider one.
pub(crate) fn best_window(t_s: &[f64], q_rad: &[f64]) -> (f64, f64) {
    let stride = t_s.len().div_ceil(LEFT_OUT).max(1);
    let missed = |half_s: f64| {
        let inner = (FEWEST..t_s.len().saturating_sub(FEWEST)).step_by(stride);
        let squares: Vec<f64> = inner
            .filter_map(|k| {
                let from = t_s.partition_point(|t| *t < t_s[k] - half_s).min(k - FEWEST);
                let to = t_s.partition_point(|t| *t <= t_s[k] + half_s).max(k + FEWEST + 1);
                let ([angle, ..], weight) = fitted(&t_s[from..to], &q_rad[from..to], t_s[k])?;
                Some(((q_rad[k] - angle) / (1.0 - weight)).powi(2))
            })
            .collect();
        squares.iter().sum::<f64>() / squares.len().max(1) as f64
    };
    let windows = (0..WIDER).map(|k| HALF_FOLLOWED_S * 2f64.powi(k));
    let tried = windows.map(|half_s| (half_s, missed(half_s)));
    tried.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((HALF_FOLLOWED_S, f64::INFINITY))
}

/// Smoothed angle, rate and acceleration at every sample \[rad, rad/s, rad/s^2\]; windows are cut short at either end.
pub(crate) fn along(t_s: &[f64], q_rad: &[f64]) -> Vec<[f64; 3]> {
    along_at(t_s, q_rad, t_s, HALF_FOLLOWED_S)
}

/// The same at other instants, which rise, along windows of this half width \[s\].
pub(crate) fn along_at(t_s: &[f64], q_rad: &[f64], at_s: &[f64], half_s: f64) -> Vec<[f64; 3]> {
    let span_s = t_s.last().zip(t_s.first()).map_or(0.0, |(last, first)| last - first);
    let in_window = 2.0 * half_s / span_s * t_s.len() as f64;
    if span_s > 0.0 && in_window >= 2.0 * MOST as f64 {
        let together = (in_window / MOST as f64) as usize;
        let means = |of: &[f64]| -> Vec<f64> {
            of.chunks(together).map(|some| some.iter().sum::<f64>() / some.len() as f64).collect()
        };
        return along_at(&means(t_s), &means(q_rad), at_s, half_s);
    }
    let n = t_s.len();
    let (mut near, mut low, mut high) = (0, 0, 0);
    at_s.iter()
        .map(|at| {
            while near + 1 < n && (t_s[near + 1] - at).abs() <= (t_s[near] - at).abs() {
                near += 1;
            }
            while t_s[low] < t_s[near] - half_s {
                low += 1;
            }
            while high + 1 < n && t_s[high + 1] <= t_s[near] + half_s {
                high += 1;
            }
            let (from, to) = (low.min(near.saturating_sub(FEWEST)), high.max((near + FEWEST).min(n - 1)));
            quadratic(&t_s[from..=to], &q_rad[from..=to], *at).unwrap_or([q_rad[near], 0.0, 0.0])
        })
        .collect()
}

/// Angle and speed at the first sample.
pub(super) fn at_start(t_s: &[f64], q_rad: &[f64]) -> (f64, f64) {
    let inside = t_s.iter().take_while(|t| **t <= t_s[0] + 2.0 * HALF_WINDOW_S).count();
    let count = inside.max(2 * FEWEST + 1).min(t_s.len());
    match quadratic(&t_s[..count], &q_rad[..count], t_s[0]) {
        Some([angle, rate, _]) => (angle, rate),
        None => (q_rad[0], 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Noise alone is best told by the widest window, and what turns fast by the narrowest; of fast logs samples are put
    /// together.
    #[test]
    fn the_window_is_as_wide_as_the_motion_bears() {
        let t: Vec<f64> = (0..2000).map(|i| f64::from(i) * 1e-3).collect();
        let noise = |i: usize| 1e-3 * ((i * 7919 % 1009) as f64 / 1009.0 - 0.5);
        let of = |q: &dyn Fn(f64) -> f64| -> Vec<f64> { t.iter().enumerate().map(|(i, t)| q(*t) + noise(i)).collect() };
        let (still, quick) = (of(&|t| 0.2 * t), of(&|t| (40.0 * t).sin()));
        let wide_s = HALF_FOLLOWED_S * 2f64.powi(WIDER - 1);
        assert_eq!(best_window(&t, &still).0, wide_s);
        assert!(best_window(&t, &quick).0 <= 2.0 * HALF_FOLLOWED_S);
        for [angle, rate, acceleration] in along_at(&t, &still, &[0.9, 1.1], wide_s) {
            assert!((rate - 0.2).abs() < 1e-3 && acceleration.abs() < 0.02, "{angle} {rate} {acceleration}");
        }
        assert_eq!(best_window(&[0.0, 0.1], &[0.0, 0.0]).0, HALF_FOLLOWED_S);
    }

    #[test]
    fn a_parabola_on_uneven_samples_is_reproduced() {
        let t: Vec<f64> = (0..60).map(|i| i as f64 * 0.004 + 1e-3 * ((i * i) % 3) as f64).collect();
        let q: Vec<f64> = t.iter().map(|t| 0.3 + 2.0 * t - 4.0 * t * t).collect();
        let (angle, rate) = at_start(&t, &q);
        assert_relative_eq!(angle, 0.3, epsilon = 1e-9);
        assert_relative_eq!(rate, 2.0, epsilon = 1e-7);
        let moments = motion(&t, &q, 0, 2);
        assert!(moments.len() > 15);
        for m in moments {
            assert_relative_eq!(m.angle_rad, q[m.index], epsilon = 1e-9);
            assert_relative_eq!(m.rate_rad_s, 2.0 - 8.0 * t[m.index], epsilon = 1e-6);
            assert_relative_eq!(m.acceleration_rad_s2, -8.0, epsilon = 1e-4);
        }
    }
}
