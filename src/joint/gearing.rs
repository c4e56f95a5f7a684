//! What gives between motor side and link: free play, a spring.

use super::Real;

/// Free play between motor side and link, with stiff inelastic flanks.
#[derive(Clone, Copy, Debug)]
pub struct Play<T> {
    /// Total width \[rad\].
    pub width_rad: T,
    /// Inertia on the motor side of the play \[kg m^2\].
    pub motor_side_kg_m2: T,
}

/// A spring with a damper between motor side and link.
#[derive(Clone, Copy, Debug)]
pub struct Compliance<T> {
    /// `k` \[N m/rad\]
    pub stiffness_nm_rad: T,
    /// `d` \[N m s/rad\]
    pub damping_nm_s_rad: T,
    /// Inertia on the motor side beside the armature \[kg m^2\].
    pub motor_side_kg_m2: T,
}

impl<T: Real> Compliance<T> {
    /// Torque on the link \[N m\] when the motor side is ahead by an angle and gains on it; with play between them
    /// the spring begins at its flanks, and only pushes.
    #[inline]
    pub fn torque_nm(&self, ahead_rad: T, gains_rad_s: T, width_rad: Option<T>) -> T {
        let damping_nm = gains_rad_s * self.damping_nm_s_rad;
        let Some(width_rad) = width_rad else { return ahead_rad * self.stiffness_nm_rad + damping_nm };
        let flank = if ahead_rad.re() < 0.0 { -1.0 } else { 1.0 };
        let beyond_rad = ahead_rad - width_rad * (0.5 * flank);
        if beyond_rad.re() * flank <= 0.0 {
            return T::nought();
        }
        let push_nm = beyond_rad * self.stiffness_nm_rad + damping_nm;
        if push_nm.re() * flank > 0.0 { push_nm } else { T::nought() }
    }
}
