//! What the recursion remembers of two bodies between its passes.

use crate::robot::spatial::{Articulated, Pair, Turn, Vec3};

/// Moment and force, or angular and linear motion, of two bodies.
pub(super) type Spatial = (Vec3, Vec3);

/// Working memory of one group; the names are those of Featherstone 2008, table 7.1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    /// Sine of the working angle.
    pub sin: Pair,
    /// Its cosine.
    pub cos: Pair,
    /// Velocity v, angular and linear, at the working origin in working axes.
    pub velocity: Spatial,
    /// Velocity product c; zero along the joint's axis.
    pub product: Spatial,
    /// Articulated inertia I^A.
    pub inertia: Articulated,
    /// Bias force p^A, moment and force.
    pub bias: Spatial,
    /// External moment and force at the working origin.
    pub external: Spatial,
    /// U / D.
    pub gain: Spatial,
    /// u / D.
    pub drive: Pair,
    /// Acceleration a.
    pub acceleration: Spatial,
}

const fn spatial(zero: Pair) -> Spatial {
    ([zero; 3], [zero; 3])
}

impl Slot {
    pub fn new() -> Self {
        let zero = Pair::zero();
        Self {
            sin: zero,
            cos: zero,
            velocity: spatial(zero),
            product: spatial(zero),
            inertia: Articulated::zero(),
            bias: spatial(zero),
            external: spatial(zero),
            gain: spatial(zero),
            drive: zero,
            acceleration: spatial(zero),
        }
    }

    /// The turn of the joint.
    #[inline(always)]
    pub fn turn(&self) -> Turn {
        Turn { sin: self.sin, cos: self.cos }
    }
}
