//! The link that a joint carries: inertia and gravity, with whatever is hung on it.

use super::Real;
use crate::number::math;
use std::ops::Mul;

/// Inertia and gravity torque of everything that turns with the joint (3.10, 3.12).
///
/// Gravity acts as `-g M* sin(q - rest)`. Parts add as vectors, because an extra mass need not hang in the direction
/// of the bare link's centre of mass: the sum has its own `M*` and its own rest angle.
#[derive(Clone, Copy, Debug)]
pub struct Link<T> {
    /// `I*` of all parts about the joint axis \[kg m^2\].
    pub inertia_kg_m2: T,
    /// `g M* cos(rest)` \[N m\]
    sine_nm: T,
    /// `g M* sin(rest)` \[N m\]
    cosine_nm: T,
}

impl<T: Real> Link<T> {
    /// A link of moment `M*` \[kg m\] that hangs at `rest` \[rad\] under `gravity` \[m/s^2\].
    pub fn new(inertia_kg_m2: T, moment_kg_m: T, rest_rad: T, gravity_m_s2: f64) -> Self {
        let (sin, cos) = rest_rad.sin_cos();
        let gm = moment_kg_m * gravity_m_s2;
        Self { inertia_kg_m2, sine_nm: gm * cos, cosine_nm: gm * sin }
    }

    /// Both parts on one joint.
    pub fn joined(self, other: Self) -> Self {
        Self {
            inertia_kg_m2: self.inertia_kg_m2 + other.inertia_kg_m2,
            sine_nm: self.sine_nm + other.sine_nm,
            cosine_nm: self.cosine_nm + other.cosine_nm,
        }
    }

    /// The link as it acts when every angle counts `offset` more: gravity is `-g M* sin(q + offset - rest)`.
    pub fn turned(self, offset_rad: T) -> Self {
        let (sin, cos) = offset_rad.sin_cos();
        Self {
            sine_nm: self.cosine_nm * sin + self.sine_nm * cos,
            cosine_nm: self.cosine_nm * cos - self.sine_nm * sin,
            ..self
        }
    }

    /// The link with its inertia times a factor, and its gravity as a vector times another: length and direction.
    #[inline(always)]
    pub(super) fn scaled<S>(self, inertia: S, [cos, sin]: [S; 2]) -> Self
    where
        T: Mul<S, Output = T>,
        S: Copy,
    {
        Self {
            inertia_kg_m2: self.inertia_kg_m2 * inertia,
            sine_nm: self.sine_nm * cos - self.cosine_nm * sin,
            cosine_nm: self.cosine_nm * cos + self.sine_nm * sin,
        }
    }

    /// Gravity torque at a joint angle \[N m\].
    #[inline(always)]
    pub fn gravity_nm(&self, angle_rad: T) -> T {
        let (sin, cos) = angle_rad.sin_cos();
        self.cosine_nm * cos - self.sine_nm * sin
    }

    /// Largest gravity torque `g M*` over a turn \[N m\].
    pub fn peak_gravity_nm(&self) -> f64 {
        math::hypot(self.sine_nm.re(), self.cosine_nm.re())
    }

    /// The part of the weight that pulls along the link, times its lever \[N m\]: `g M* cos(q - rest)`.
    #[inline]
    pub fn along_nm(&self, angle_rad: T) -> T {
        let (sin, cos) = angle_rad.sin_cos();
        self.sine_nm * cos + self.cosine_nm * sin
    }

    /// Largest gravity torque `g M*` over a turn, with its derivatives \[N m\].
    pub fn peak_nm(&self) -> T {
        if self.peak_gravity_nm() > 0.0 {
            (self.sine_nm * self.sine_nm + self.cosine_nm * self.cosine_nm).sqrt()
        } else {
            T::nought()
        }
    }

    /// Joint angle at which the link hangs \[rad\].
    pub fn hanging_rad(&self) -> T {
        self.cosine_nm.atan2(self.sine_nm)
    }

    /// Potential energy above the hanging position \[J\].
    pub fn potential_j(&self, angle_rad: f64) -> f64 {
        self.peak_gravity_nm() - self.sine_nm.re() * math::cos(angle_rad) - self.cosine_nm.re() * math::sin(angle_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn gravity_vanishes_at_the_rest_angle_and_parts_add_as_vectors() {
        let bare = Link::new(1e-3, 5e-3, 0.2, 9.81);
        assert_relative_eq!(bare.gravity_nm(0.2), 0.0, epsilon = 1e-17);
        assert_relative_eq!(bare.gravity_nm(0.2 + 0.5), -9.81 * 5e-3 * 0.5f64.sin(), epsilon = 1e-15);
        let extra = Link::new(2e-3, 1e-2, -0.1, 9.81);
        let both = bare.joined(extra);
        for q in [-2.0, -0.3, 0.0, 1.1] {
            assert_relative_eq!(both.gravity_nm(q), bare.gravity_nm(q) + extra.gravity_nm(q), epsilon = 1e-15);
        }
        assert!(both.peak_gravity_nm() < 9.81 * 1.5e-2);
    }

    #[test]
    fn gravity_is_minus_the_slope_of_the_potential() {
        let link = Link::new(1e-3, 5e-3, 0.2, 9.81);
        let h = 1e-5;
        let slope = (link.potential_j(0.9 + h) - link.potential_j(0.9 - h)) / (2.0 * h);
        assert_relative_eq!(link.gravity_nm(0.9), -slope, epsilon = 1e-10);
        assert_relative_eq!(link.potential_j(0.2), 0.0, epsilon = 1e-16);
    }
}
