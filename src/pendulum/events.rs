//! Instants inside a step at which something changes sign.

/// The instant inside a step at which a speed that falls and rises again may have dipped below zero.
///
/// `speed` holds the speeds at both ends. The slope at the end costs a rate, so it is asked for only where the deepest
/// dip that the first slope allows would reach zero.
pub(super) fn dip(speed: [f64; 2], slope_before: f64, slope_after: impl Fn() -> f64, step_s: f64) -> Option<f64> {
    let [before, after] = speed;
    let lowest = |dt: f64| before.min(after) + 0.5 * slope_before * dt;
    if before <= 0.0 || !(slope_before < 0.0 && lowest(step_s) < 0.0) {
        return None;
    }
    let slope_after = slope_after();
    if !(slope_after > 0.0) {
        return None;
    }
    // Minimum of the parabola with these end slopes; a step is short against the curvature's change.
    let dt = step_s * slope_before / (slope_before - slope_after);
    (lowest(dt) < 0.0).then_some(dt)
}

/// The interval about the instant in `(0, whole]` at which a function, not above zero at 0 and above it at `whole`, rises
/// through zero, by so many halvings.
///
/// Each look costs a simulation or all torques on the joint. So the instant is first sought by a faster method (Illinois),
/// and the halving looks only where that leaves it open.
pub(super) fn halved(f: impl Fn(f64) -> f64, [at_start, at_end]: [f64; 2], whole: f64, halvings: i32) -> [f64; 2] {
    let precise = (0.1 * 0.5_f64.powi(halvings)).max(1e-14) * whole;
    let (mut below, mut above) = (0.0, whole);
    if at_start < 0.0 {
        let (mut f_below, mut f_above) = (at_start, at_end);
        let (mut last_side, mut last) = (0, 0.0);
        for _ in 0..8 {
            let between = (below * f_above - above * f_below) / (f_above - f_below);
            if !(between > below && between < above) {
                break;
            }
            let there = f(between);
            if there > 0.0 {
                (above, f_above) = (between, there);
                f_below *= if last_side == 1 { 0.5 } else { 1.0 };
                last_side = 1;
            } else {
                (below, f_below) = (between, there);
                f_above *= if last_side == -1 { 0.5 } else { 1.0 };
                last_side = -1;
            }
            let moved: f64 = between - last;
            if moved.abs() < precise || f_below == 0.0 {
                break;
            }
            last = between;
        }
        // The far end of what is known comes near.
        for near in [1e3 * precise, precise] {
            let beside = if last_side == 1 { above - near } else { below + near };
            if beside > below && beside < above {
                if f(beside) > 0.0 { above = beside } else { below = beside }
            }
        }
    }
    let (mut low, mut high) = (0.0, whole);
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        if !(middle > low && middle < high) {
            break;
        }
        let is_above = middle >= above || (middle > below && f(middle) > 0.0);
        if is_above { high = middle } else { low = middle }
    }
    [low, high]
}

/// The instant in `(0, bracket]` at which `speed`, positive just after 0, falls through zero (Illinois method).
pub(super) fn zero_of(speed: impl Fn(f64) -> f64, at_start: f64, bracket: f64) -> Option<f64> {
    let (mut low, mut f_low) = (0.0, at_start);
    let (mut high, mut f_high) = (bracket, speed(bracket));
    if f_low <= 0.0 {
        // The motion begins at rest: find an instant at which it is under way.
        low = bracket;
        for _ in 0..12 {
            low *= 0.5;
            f_low = speed(low);
            if f_low > 0.0 {
                break;
            }
            (high, f_high) = (low, f_low);
        }
        if f_low <= 0.0 {
            return None;
        }
    }
    let mut last_side = 0;
    for _ in 0..60 {
        if f_high == 0.0 || high - low <= 1e-15 * bracket.max(1e-9) {
            break;
        }
        let between = (low * f_high - high * f_low) / (f_high - f_low);
        let dt = if between.is_finite() { between.clamp(low, high) } else { 0.5 * (low + high) };
        let f = speed(dt);
        if f.abs() < 1e-13 {
            return Some(dt);
        }
        if f > 0.0 {
            (low, f_low) = (dt, f);
            if last_side == 1 {
                f_high *= 0.5;
            }
            last_side = 1;
        } else {
            (high, f_high) = (dt, f);
            if last_side == -1 {
                f_low *= 0.5;
            }
            last_side = -1;
        }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn halving_ends_where_it_would_if_it_looked_everywhere() {
        let curves: [fn(f64) -> f64; 5] = [
            |x| x - 0.3,
            |x| x * x - 0.05,
            |x| (8.0 * (x - 0.61)).sinh(),
            |x| x - 1.0,
            |x| if x < 0.37 { -1e-9 } else { 5.0 },
        ];
        for (k, curve) in curves.into_iter().enumerate() {
            for (whole, halvings) in [(1.01, 60), (1.01, 16), (2.5, 16)] {
                let (mut low, mut high) = (0.0, whole);
                for _ in 0..halvings {
                    let middle = 0.5 * (low + high);
                    if curve(middle) > 0.0 { high = middle } else { low = middle }
                }
                let looks = Cell::new(0);
                let look = |x: f64| {
                    looks.set(looks.get() + 1);
                    curve(x)
                };
                let found = halved(look, [curve(0.0), curve(whole)], whole, halvings);
                assert_eq!(found, [low, high], "curve {k}");
                // What is nearly straight is found at once; what is not costs a few looks more at the worst.
                let most = if [0, 1, 3].contains(&k) { halvings - 1 } else { halvings + 10 };
                assert!(looks.get() <= most, "curve {k}: {} looks", looks.get());
            }
        }
    }
}
