//! A step of a joint whose controller takes up every difference of speed within a fraction of a sample.
//!
//! A Rosenbrock-W method of two stages (ROS2, Verwer et al. 1999, g = 1 + 1/sqrt 2), as the whole robot is simulated with:
//! of order 2 whatever is put in for the Jacobian, and what decays fast is gone at its end. Here the Jacobian is that of
//! angle and rate; the integral of the error is slow.

use crate::joint::Real;
use std::f64::consts::FRAC_1_SQRT_2;

/// Of both values that damp what is stiff completely the one whose second stage has the speed's own sign.
const GAMMA: f64 = 1.0 + FRAC_1_SQRT_2;
/// Differences over which slopes are taken \[rad, rad/s\].
const ANGLE_STEP: f64 = 1e-6;
const SPEED_STEP: f64 = 1e-5;
/// A step in which what decays changes by more than this share is too long.
const CHANGES: f64 = 0.5;

/// Slopes of the acceleration by angle \[1/s^2\] and rate \[1/s\]; only what holds the joint back counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    by_angle: f64,
    by_rate: f64,
}

impl Slopes {
    /// Of an acceleration at a state.
    pub fn of<T: Real>(acceleration: impl Fn(&[T; 3]) -> T, [angle, rate, integral]: &[T; 3], direction: f64) -> Self {
        let speed_step = SPEED_STEP * direction;
        let here = acceleration(&[*angle, *rate, *integral]).re();
        let by_angle = (acceleration(&[*angle + ANGLE_STEP, *rate, *integral]).re() - here) / ANGLE_STEP;
        let by_rate = (acceleration(&[*angle, *rate + speed_step, *integral]).re() - here) / speed_step;
        // `min` takes the zero where there is no number.
        Self { by_angle: by_angle.min(0.0), by_rate: by_rate.min(0.0) }
    }

    /// Whether the joint decays alike at both ends of a step \[s\].
    pub fn are_near(&self, end: &Self, step_s: f64) -> bool {
        let (apart, most) = ((self.by_rate - end.by_rate).abs(), -self.by_rate.min(end.by_rate));
        apart <= CHANGES * most || apart * step_s < CHANGES
    }
}

/// The state after `dt`, of which the rate at the beginning is known.
pub(super) fn step<T: Real>(
    rate: impl Fn(T, &[T; 3]) -> [T; 3],
    t_s: T,
    y: &[T; 3],
    first: &[T; 3],
    slopes: &Slopes,
    dt: T,
) -> [T; 3] {
    let gh = dt * GAMMA;
    let pull = gh * slopes.by_angle;
    let damped = (T::constant(1.0) - gh * slopes.by_rate - gh * pull).recip();
    // The stage k with (1 - g h J) k = r.
    let stage = |r: [T; 3]| -> [T; 3] {
        let of_rate = (r[1] + pull * r[0]) * damped;
        [r[0] + gh * of_rate, of_rate, r[2]]
    };
    let k1 = stage(*first);
    let there: [T; 3] = std::array::from_fn(|i| y[i] + dt * k1[i]);
    let second = rate(t_s + dt, &there);
    let k2 = stage(std::array::from_fn(|i| second[i] - k1[i] * 2.0));
    std::array::from_fn(|i| y[i] + dt * (k1[i] * 1.5 + k2[i] * 0.5))
}
