//! What the recursion remembers of bodies between its passes.

use crate::robot::spatial::{Articulated, Number, Pair, Turn, Vec3};

/// Moment and force, or angular and linear motion, of several bodies.
pub(super) type Spatial<N = Pair> = (Vec3<N>, Vec3<N>);

/// Working memory of the bodies of one register; the names are those of Featherstone 2008, table 7.1. What is no
/// longer needed gives its place to what comes next, so that four robots' slots fit into the nearest cache.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot<N = Pair> {
    /// Sine of the working angle.
    pub sin: N,
    /// Its cosine.
    pub cos: N,
    /// Velocity v, angular and linear, at the working origin in working axes; acceleration a after the third pass.
    pub motion: Spatial<N>,
    /// Velocity product c; zero along the joint's axis.
    pub product: Spatial<N>,
    /// Articulated inertia I^A.
    pub inertia: Articulated<N>,
    /// Bias force p^A, moment and force; U / D after the second pass.
    pub bias: Spatial<N>,
    /// External moment and force at the working origin.
    pub external: Spatial<N>,
    /// u / D.
    pub drive: N,
}

fn spatial<N: Number>() -> Spatial<N> {
    ([N::zero(); 3], [N::zero(); 3])
}

impl<N: Number> Slot<N> {
    pub fn new() -> Self {
        let zero = N::zero();
        Self {
            sin: zero,
            cos: zero,
            motion: spatial(),
            product: spatial(),
            inertia: Articulated::zero(),
            bias: spatial(),
            external: spatial(),
            drive: zero,
        }
    }

    /// The turn of the joint.
    #[inline(always)]
    pub fn turn(&self) -> Turn<N> {
        Turn { sin: self.sin, cos: self.cos }
    }
}
