//! Unbounded coordinates for optimisers that know no bounds (the transformations of MINUIT, James and Roos 1975).
//!
//! A coordinate can reach its bound and come back: the mapping is smooth there with slope zero, unlike a logarithm,
//! which would run away to minus infinity.

use super::Coordinate;
use crate::number::math;

/// Share of a coordinate's scale over which a one-sided bound is rounded off.
///
/// Beyond it the mapping is nearly the identity, so that a small friction is not seen through a strongly bent one.
const ROUNDED: f64 = 0.05;

/// The bounded value of an unbounded one, and its derivative.
pub(super) fn inside(c: &Coordinate, u: f64) -> (f64, f64) {
    let s = ROUNDED * c.scale;
    match (c.lower.is_finite(), c.upper.is_finite()) {
        (false, false) => (u, 1.0),
        (true, false) => {
            let root = (1.0 + (u / s).powi(2)).sqrt();
            (c.lower + s * (root - 1.0), (u / s) / root)
        }
        (false, true) => {
            let root = (1.0 + (u / s).powi(2)).sqrt();
            (c.upper - s * (root - 1.0), -(u / s) / root)
        }
        (true, true) => {
            let half = 0.5 * (c.upper - c.lower);
            (c.lower + half * (math::sin(u / half) + 1.0), math::cos(u / half))
        }
    }
}

/// An unbounded value of a bounded one; a value on its bound is moved off it by a thousandth of the scale, because
/// the slope there is zero and an optimiser could not leave.
pub(super) fn outside(c: &Coordinate, x: f64) -> f64 {
    let s = ROUNDED * c.scale;
    match (c.lower.is_finite(), c.upper.is_finite()) {
        (false, false) => x,
        (true, false) => s * ((1.0 + (x - c.lower).max(1e-3 * s) / s).powi(2) - 1.0).sqrt(),
        (false, true) => s * ((1.0 + (c.upper - x).max(1e-3 * s) / s).powi(2) - 1.0).sqrt(),
        (true, true) => {
            let half = 0.5 * (c.upper - c.lower);
            half * math::asin(((x - c.lower) / half - 1.0).clamp(-0.999, 0.999))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn there_and_back(x in 0.02..0.98f64, scale in 0.01..3.0f64, kind in 0..4u8) {
            let c = Coordinate {
                name: String::new(),
                lower: if kind & 1 == 0 { f64::NEG_INFINITY } else { 0.0 },
                upper: if kind & 2 == 0 { f64::INFINITY } else { 1.0 },
                scale,
            };
            let u = outside(&c, x);
            let (back, slope) = inside(&c, u);
            let tolerance = if kind == 0 || kind == 3 { 1e-9 } else { 1.1e-3 * scale };
            prop_assert!((back - x).abs() < tolerance, "{back} {x}");
            let h = 1e-6;
            let difference = (inside(&c, u + h).0 - inside(&c, u - h).0) / (2.0 * h);
            prop_assert!((slope - difference).abs() < 1e-4);
        }
    }
}
