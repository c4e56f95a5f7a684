//! Long steps of a joint that a stiff drive or thick friction holds.
//!
//! What pulls a servo's joint back and what brakes it are nearly linear, and Runge and Kutta's steps have to be short against
//! the fastest of both, however little of that is left to see. An exponential method takes the linear part exactly and is of
//! fourth order in the rest: Krogstad's (J. Comput. Phys. 203, 2005), which without a linear part is the classical one.

use crate::joint::Real;

/// The linear part of a joint's acceleration, about a state: `-k (q - q0) - c (w - w0)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linear {
    /// `k` \[1/s^2\]
    pub stiffness_1_s2: f64,
    /// `c` \[1/s\]
    pub decay_1_s: f64,
}

/// What the linear part makes of a unit rate, and the first three integrals of that over time, at an instant after it.
#[derive(Clone, Copy, Debug)]
struct Response {
    after_s: f64,
    integrals: [f64; 4],
}

/// A Taylor series of so many terms has all digits up to this product of time and rate.
const SHORT: f64 = 0.5;
const TERMS: usize = 12;

impl Linear {
    /// The fastest that it does anything \[1/s\].
    fn fastest_1_s(&self) -> f64 {
        self.decay_1_s.max(self.stiffness_1_s2.sqrt())
    }

    /// The responses at half of a time and at all of it.
    fn responses(&self, step_s: f64) -> [Response; 2] {
        let mut doublings = 1;
        let mut after_s = 0.5 * step_s;
        while after_s * self.fastest_1_s() > SHORT {
            after_s *= 0.5;
            doublings += 1;
        }
        let mut half = self.shortly_after(after_s);
        for _ in 1..doublings {
            half = self.doubled(&half);
        }
        [half, self.doubled(&half)]
    }

    /// By its series.
    fn shortly_after(&self, after_s: f64) -> Response {
        let [decay, stiffness] = [self.decay_1_s * after_s, self.stiffness_1_s2 * after_s * after_s];
        let (mut before, mut term) = (0.0, after_s);
        let mut sums = [0.0; 4];
        for m in 0..TERMS {
            let m = m as f64;
            let mut integral = term;
            for (j, sum) in sums.iter_mut().enumerate() {
                *sum += integral;
                integral *= after_s / (m + 2.0 + j as f64);
            }
            (before, term) = (term, -(decay * term + stiffness * before / (m + 1.0)) / (m + 2.0));
        }
        Response { after_s, integrals: sums }
    }

    /// After twice the time.
    fn doubled(&self, at: &Response) -> Response {
        let Response { after_s: t, integrals: [g0, g1, g2, g3] } = *at;
        let keeps_angle = 1.0 - self.stiffness_1_s2 * g1;
        let keeps_rate = keeps_angle - self.decay_1_s * g0;
        let integrals = [
            (keeps_angle + keeps_rate) * g0,
            g1 + keeps_angle * g1 + g0 * g0,
            g2 + t * g1 + keeps_angle * g2 + g0 * g1,
            g3 + t * (g2 + 0.5 * t * g1) + keeps_angle * g3 + g0 * g2,
        ];
        Response { after_s: 2.0 * t, integrals }
    }
}

/// One step of a joint.
pub(super) struct Leap<T> {
    /// Angle and rate at its end.
    pub end: [T; 2],
    /// How far the angle would be off if what is not linear were followed in the first order only \[rad\]: far more than the
    /// method is off where that is smooth, and about as much where it is not.
    pub bent_rad: f64,
    /// Acceleration near its end \[rad/s^2\].
    pub last_rad_s2: f64,
}

/// A step from a state with the given acceleration; `acceleration` gives it elsewhere, after a time \[s\].
#[inline]
pub(super) fn leap<T: Real>(
    linear: &Linear,
    [angle, rate]: [T; 2],
    first: T,
    step_s: f64,
    acceleration: impl Fn(f64, [T; 2]) -> T,
) -> Leap<T> {
    let [half, whole] = linear.responses(step_s);
    let Linear { stiffness_1_s2, decay_1_s } = *linear;
    // How far the state moves where the rest stays what it is.
    let moved = |at: &Response| {
        let [g0, g1, g2, _] = at.integrals;
        let angle = rate * (at.after_s - stiffness_1_s2 * g2) + first * g1;
        [angle, first * g0 - rate * (stiffness_1_s2 * g1)]
    };
    // What is not linear, where the state has moved.
    let rest = |after_s: f64, [by_rad, by_rad_s]: &[T; 2]| {
        let there = acceleration(after_s, [angle + *by_rad, rate + *by_rad_s]);
        there + *by_rad * stiffness_1_s2 + *by_rad_s * decay_1_s
    };
    let [by_half, by_whole] = [&half, &whole].map(moved);
    let with = |by: &[T; 2], more: T, [angle, rate]: [f64; 2]| [by[0] + more * angle, by[1] + more * rate];
    let second = rest(half.after_s, &by_half);
    let [_, h1, h2, _] = half.integrals;
    let third = rest(half.after_s, &with(&by_half, second - first, [h2, h1].map(|g| 4.0 / step_s * g)));
    let [_, g1, g2, g3] = whole.integrals;
    let by_fourth = with(&by_whole, third - first, [g2, g1].map(|g| 2.0 / step_s * g));
    let fourth = rest(step_s, &by_fourth);
    let last_rad_s2 = (fourth - by_fourth[0] * stiffness_1_s2 - by_fourth[1] * decay_1_s).re();
    let both = second + third;
    let straight = both * 2.0 - first * 3.0 - fourth;
    let bent = first - both + fourth;
    let end = with(&by_whole, straight, [g2, g1].map(|g| g / step_s));
    let [by_rad, by_rad_s] = with(&end, bent, [g3, g2].map(|g| 4.0 / step_s * (g / step_s)));
    let bent_rad = (bent.re().abs() + (third - second).re().abs()) * g1;
    Leap { end: [angle + by_rad, rate + by_rad_s], bent_rad, last_rad_s2 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn linear(stiffness_1_s2: f64, decay_1_s: f64) -> Linear {
        Linear { stiffness_1_s2, decay_1_s }
    }

    #[test]
    fn responses_are_those_of_closed_forms() {
        // Free, swinging, creeping, both: exp(-ct/2) sin(wt)/w and its integrals by the equation itself.
        let [_, free] = linear(0.0, 0.0).responses(0.3);
        for (g, expected) in free.integrals.iter().zip([0.3, 0.045, 0.0045, 0.000_337_5]) {
            assert_relative_eq!(*g, expected, max_relative = 1e-14);
        }
        for (k, c, t) in [(900.0, 20.0, 0.02), (900.0, 20.0, 0.5), (2e4, 3e3, 0.02), (2e4, 3e5, 0.02), (5.0, 1e-3, 2.0)]
        {
            let [half, whole] = linear(k, c).responses(t);
            for Response { after_s: t, integrals: [g0, g1, g2, g3] } in [half, whole] {
                let beyond = 0.25 * c * c - k;
                let root = f64::abs(beyond).sqrt();
                let exact = match beyond < 0.0 {
                    true => (-0.5 * c * t).exp() * (root * t).sin() / root,
                    // The slower of two rates is the product over the faster one.
                    false => ((-k / (0.5 * c + root) * t).exp() - (-(0.5 * c + root) * t).exp()) / (2.0 * root),
                };
                assert_relative_eq!(g0, exact, max_relative = 1e-10, epsilon = 1e-16);
                // The integrals of g0'' + c g0' + k g0 = 0.
                assert_relative_eq!(g0 + c * g1 + k * g2, t, max_relative = 1e-11);
                assert_relative_eq!(g1 + c * g2 + k * g3, 0.5 * t * t, max_relative = 1e-11);
            }
        }
    }

    /// A driven joint under gravity, of which a part of stiffness and decay is taken as linear.
    fn off(linear: &Linear, steps: usize) -> f64 {
        let acceleration = |t: f64, [q, w]: [f64; 2]| {
            -400.0 * (q - 0.3 * (5.0 * t).sin()) - 30.0 * w - 60.0 * q.sin() - 0.2 * w.powi(3)
        };
        let end = |linear: &Linear, steps: usize| {
            let h = 0.4 / steps as f64;
            (0..steps).fold([0.5, -1.0], |y, k| {
                let t = k as f64 * h;
                leap(linear, y, acceleration(t, y), h, |dt, y| acceleration(t + dt, y)).end
            })
        };
        let fine = end(&Linear { stiffness_1_s2: 0.0, decay_1_s: 0.0 }, 20_000);
        let coarse = end(linear, steps);
        (coarse[0] - fine[0]).abs() + 0.05 * (coarse[1] - fine[1]).abs()
    }

    #[test]
    fn the_rest_is_followed_in_the_fourth_order() {
        for linear in [linear(400.0, 30.0), linear(430.0, 30.0), linear(0.0, 0.0), linear(200.0, 60.0)] {
            let ratio = off(&linear, 40) / off(&linear, 80);
            assert!((12.0..21.0).contains(&ratio), "{linear:?}: halving the step divides the error by {ratio}");
        }
        // Where all of the acceleration is linear nothing is off, however long the step.
        let linear = linear(900.0, 12.0);
        let leap = leap(&linear, [0.2, 1.5], -900.0 * 0.2 - 12.0 * 1.5, 0.3, |_, [q, w]| -900.0 * q - 12.0 * w);
        let (decay, swing) = (f64::exp(-6.0 * 0.3), f64::sqrt(900.0 - 36.0));
        let exact = decay * (0.2 * (swing * 0.3).cos() + (1.5 + 6.0 * 0.2) / swing * (swing * 0.3).sin());
        assert_relative_eq!(leap.end[0], exact, epsilon = 1e-13);
        assert!(leap.bent_rad < 1e-13);
        assert_relative_eq!(leap.last_rad_s2, -900.0 * leap.end[0] - 12.0 * leap.end[1], epsilon = 1e-9);
    }

    #[test]
    fn a_step_says_how_far_it_bends() {
        let linear = linear(400.0, 30.0);
        let kinked = |limit: f64| move |_: f64, [q, w]: [f64; 2]| -(400.0 * q).clamp(-limit, limit) - 30.0 * w;
        let bent =
            |limit: f64| leap(&linear, [0.1, -2.0], kinked(limit)(0.0, [0.1, -2.0]), 0.02, kinked(limit)).bent_rad;
        assert!(bent(1e9) < 1e-15 && bent(35.0) > 1e-4, "{} {}", bent(1e9), bent(35.0));
    }
}
