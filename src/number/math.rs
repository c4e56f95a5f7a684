//! Elementary functions whose bits do not depend on the processor.
//!
//! The standard library hands these to the C library, which picks a variant by what the processor can do (fused
//! multiplication, AVX2) and changes them between its releases: the last bit differs from machine to machine, and a search
//! makes more of it. These are the crate `libm`'s, plain Rust, one variant for all; `clippy.toml` refuses the others.
//! Roots, rounding and remainders are exact by IEEE 754 and stay the standard library's.

pub(crate) use super::sincos::sin_cos;
pub(crate) use libm::{asin, atan2, cosh, exp, hypot, log as ln, log1p as ln_1p, log10, pow as powf, sinh, tan, tanh};

/// Sine \[-\] of an angle \[rad\].
#[inline(always)]
pub(crate) fn sin(angle_rad: f64) -> f64 {
    sin_cos(angle_rad).0
}

/// Cosine \[-\] of an angle \[rad\].
#[inline(always)]
pub(crate) fn cos(angle_rad: f64) -> f64 {
    sin_cos(angle_rad).1
}
