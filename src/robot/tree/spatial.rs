//! Twists and wrenches of rigid bodies in the bodies' own axes (Featherstone 2008, 2.1 to 2.13), on plain numbers.
//!
//! A twist has the velocity of the frame's origin, a wrench the moment about it.

use crate::robot::description::RigidInertia;
use nalgebra::{Matrix3, Vector3};
use std::ops::{Add, AddAssign, Mul};

/// Angular and linear velocity of a frame, or acceleration.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Twist {
    pub angular: Vector3<f64>,
    pub linear: Vector3<f64>,
}

/// Moment and force on a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wrench {
    pub moment: Vector3<f64>,
    pub force: Vector3<f64>,
}

/// A frame in another: `p_outer = rotation p_inner + origin`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub rotation: Matrix3<f64>,
    pub origin: Vector3<f64>,
}

impl Twist {
    /// How another twist that moves along changes: `self x other` (2.33).
    pub fn cross(&self, other: &Self) -> Self {
        Self {
            angular: self.angular.cross(&other.angular),
            linear: self.angular.cross(&other.linear) + self.linear.cross(&other.angular),
        }
    }

    /// How a wrench that moves along changes: `self x* wrench` (2.34).
    pub fn cross_wrench(&self, wrench: &Wrench) -> Wrench {
        Wrench {
            moment: self.angular.cross(&wrench.moment) + self.linear.cross(&wrench.force),
            force: self.angular.cross(&wrench.force),
        }
    }

    /// Power of a wrench.
    pub fn dot(&self, wrench: &Wrench) -> f64 {
        self.angular.dot(&wrench.moment) + self.linear.dot(&wrench.force)
    }
}

impl Add for Twist {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { angular: self.angular + other.angular, linear: self.linear + other.linear }
    }
}

impl Mul<f64> for Twist {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { angular: self.angular * factor, linear: self.linear * factor }
    }
}

impl AddAssign for Wrench {
    fn add_assign(&mut self, other: Self) {
        self.moment += other.moment;
        self.force += other.force;
    }
}

impl Frame {
    /// A frame that is given in this one, in the outer one.
    pub fn times(&self, inner: &Self) -> Self {
        Self { rotation: self.rotation * inner.rotation, origin: self.point(&inner.origin) }
    }

    /// A point of this frame in the outer one.
    pub fn point(&self, inner: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * inner + self.origin
    }

    /// A twist of the outer frame as this one has it (2.22).
    pub fn into_inner(self, twist: &Twist) -> Twist {
        let at = twist.linear + twist.angular.cross(&self.origin);
        Twist { angular: self.rotation.tr_mul(&twist.angular), linear: self.rotation.tr_mul(&at) }
    }

    /// A wrench on this frame as the outer one has it (2.25).
    pub fn into_outer(self, wrench: &Wrench) -> Wrench {
        let force = self.rotation * wrench.force;
        Wrench { moment: self.rotation * wrench.moment + self.origin.cross(&force), force }
    }
}

/// The wrench that gives an inertia a twist as acceleration, or its momentum (2.63).
pub(super) fn times(inertia: &RigidInertia, twist: &Twist) -> Wrench {
    let h = &inertia.first_moment_kg_m;
    Wrench {
        moment: inertia.tensor_kg_m2 * twist.angular + h.cross(&twist.linear),
        force: twist.linear * inertia.mass_kg + twist.angular.cross(h),
    }
}
