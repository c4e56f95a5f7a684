//! The number type that the joint's equations are written over.

use num_dual::{Derivative, DualNumCopy, DualSVec64};

/// A real number that may carry derivatives: `f64`, or a dual number for exact sensitivities.
///
/// Branches (stick or slip, saturated or not) are taken on the real part alone, so that a dual run takes the same path
/// as the plain one.
pub trait Real: DualNumCopy<f64> + 'static {
    /// A constant.
    #[inline]
    fn constant(value: f64) -> Self {
        Self::from(value)
    }

    /// Zero.
    #[inline]
    fn nought() -> Self {
        Self::from(0.0)
    }
}

impl Real for f64 {}
impl<const N: usize> Real for DualSVec64<N> {}

/// The `index`-th of `N` variables, at `value`.
pub(crate) fn variable<const N: usize>(value: f64, index: usize) -> DualSVec64<N> {
    DualSVec64::from_re(value).derivative(index)
}

/// Gradient of a dual number; zeros where it depends on nothing.
pub(crate) fn gradient<const N: usize>(x: &DualSVec64<N>) -> [f64; N] {
    let eps: Derivative<f64, f64, nalgebra::Const<N>, nalgebra::U1> = x.eps;
    let v = eps.unwrap_generic(nalgebra::Const::<N>, nalgebra::U1);
    std::array::from_fn(|i| v[i])
}
