//! Torques that an angle alone brings about, beside gravity: a parallel spring, a stop.

use super::Real;

/// A spring in parallel to the joint: `k (q_s - q)`.
#[derive(Clone, Copy, Debug)]
pub struct Spring<T> {
    /// `k` \[N m/rad\]
    pub stiffness_nm_rad: T,
    /// `q_s`, where it is slack \[rad\].
    pub slack_rad: T,
}

impl<T: Real> Spring<T> {
    /// Torque on the joint \[N m\].
    #[inline]
    pub fn torque_nm(&self, angle_rad: T) -> T {
        self.stiffness_nm_rad * (self.slack_rad - angle_rad)
    }
}

/// A one-sided spring and damper beyond an angle; it pushes and never pulls.
#[derive(Clone, Copy, Debug)]
pub struct EndStop<T> {
    /// Where it begins \[rad\].
    pub angle_rad: T,
    /// +1: at the upper end of the range; -1: at the lower.
    pub side: f64,
    /// \[N m/rad\]
    pub stiffness_nm_rad: T,
    /// \[N m s/rad\]
    pub damping_nm_s_rad: T,
}

impl<T: Real> EndStop<T> {
    /// Torque on the joint \[N m\].
    #[inline]
    pub fn torque_nm(&self, angle_rad: T, rate_rad_s: T) -> T {
        let depth_rad = (angle_rad - self.angle_rad) * self.side;
        if depth_rad.re() <= 0.0 {
            return T::nought();
        }
        let push_nm = depth_rad * self.stiffness_nm_rad + rate_rad_s * self.damping_nm_s_rad * self.side;
        if push_nm.re() <= 0.0 { T::nought() } else { push_nm * -self.side }
    }

    /// How far it is away \[rad\]; negative in contact.
    pub(crate) fn distance_rad(&self, angle_rad: f64) -> f64 {
        (self.angle_rad.re() - angle_rad) * self.side
    }

    /// A step that follows the contact of a joint with this inertia \[s\].
    pub(crate) fn longest_step_s(&self, inertia_kg_m2: f64) -> f64 {
        let oscillation = (self.stiffness_nm_rad.re().abs() / inertia_kg_m2).sqrt();
        1.0 / (8.0 * oscillation).max(3.0 * self.damping_nm_s_rad.re().abs() / inertia_kg_m2).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_spring_pulls_towards_its_slack_angle() {
        let spring = Spring { stiffness_nm_rad: 0.02, slack_rad: 0.3 };
        assert_relative_eq!(spring.torque_nm(0.8), -0.01, epsilon = 1e-15);
    }

    #[test]
    fn a_stop_pushes_back_and_never_pulls() {
        let stop = EndStop { angle_rad: -0.5, side: -1.0, stiffness_nm_rad: 10.0, damping_nm_s_rad: 0.1 };
        assert_eq!(stop.torque_nm(-0.4, -3.0), 0.0);
        assert_relative_eq!(stop.torque_nm(-0.52, -1.0), 0.2 + 0.1, epsilon = 1e-15);
        assert_eq!(stop.torque_nm(-0.52, 3.0), 0.0);
        assert!(stop.distance_rad(-0.4) > 0.0 && stop.distance_rad(-0.6) < 0.0);
    }
}
