//! What the recursion calculates with: one number, or several side by side.

use crate::number::{Lanes, in_quadrant};
use std::fmt::Debug;
use std::ops::{AddAssign, Neg};

/// Several numbers, one operation on all; what is in a lane depends on that lane only.
pub(in crate::robot) trait Number: Lanes + AddAssign + Neg<Output = Self> + Debug {
    /// The numbers apart.
    type Each: AsRef<[f64]>;
    /// How many there are.
    const LANES: usize;

    /// The number of each lane.
    fn of(lane: impl FnMut(usize) -> f64) -> Self;

    /// All numbers.
    fn each(self) -> Self::Each;

    /// One divided by each.
    fn inverse(self) -> Self;

    /// Sines and cosines of angles from those of what is left beyond quarter turns, whose numbers stand in the low bits of
    /// `quarters`.
    #[inline(always)]
    fn in_quadrant(sine: Self, cosine: Self, quarters: Self) -> (Self, Self) {
        let (sine, cosine, quarters) = (sine.each(), cosine.each(), quarters.each());
        let one = |k: usize| in_quadrant(sine.as_ref()[k], cosine.as_ref()[k], quarters.as_ref()[k].to_bits());
        (Self::of(|k| one(k).0), Self::of(|k| one(k).1))
    }

    /// Zeros.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
}

impl Number for f64 {
    type Each = [f64; 1];
    const LANES: usize = 1;

    #[inline(always)]
    fn of(mut lane: impl FnMut(usize) -> f64) -> Self {
        lane(0)
    }

    #[inline(always)]
    fn each(self) -> [f64; 1] {
        [self]
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        1.0 / self
    }
}
