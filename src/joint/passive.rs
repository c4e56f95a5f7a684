//! Torques that an angle alone brings about, beside gravity: a parallel spring, a stop.

use super::Real;
use crate::number::math;

/// A spring in parallel to the joint: `k (q_s - q)`, or another curve of the same stiffness at `q_s`.
#[derive(Clone, Copy, Debug)]
pub struct Spring<T> {
    /// `k` \[N m/rad\]
    pub stiffness_nm_rad: T,
    /// `q_s`, where it is slack \[rad\].
    pub slack_rad: T,
    /// How it pulls.
    pub curve: SpringCurve<T>,
}

/// How a spring's torque grows with `x = q_s - q`.
#[derive(Clone, Copy, Debug)]
pub enum SpringCurve<T> {
    /// `k x`
    Linear,
    /// `k x (1 + (x/q_c)^2)`, with `q_c` \[rad\] in it.
    Stiffening(T),
    /// `k x` where the joint is beyond `q_s` on this side, +1 or -1, as a rope pulls.
    OneSided(f64),
}

impl<T: Real> Spring<T> {
    /// Torque on the joint \[N m\].
    #[inline]
    pub fn torque_nm(&self, angle_rad: T) -> T {
        let pull_rad = self.slack_rad - angle_rad;
        match self.curve {
            SpringCurve::Linear => self.stiffness_nm_rad * pull_rad,
            SpringCurve::Stiffening(scale_rad) => {
                let ratio = pull_rad / scale_rad;
                self.stiffness_nm_rad * pull_rad * (ratio * ratio + 1.0)
            }
            SpringCurve::OneSided(side) if pull_rad.re() * side < 0.0 => self.stiffness_nm_rad * pull_rad,
            SpringCurve::OneSided(_) => T::nought(),
        }
    }

    /// Its stiffness at an angle, for the choice of the step \[N m/rad\].
    pub(crate) fn slope_nm_rad(&self, angle_rad: f64) -> f64 {
        let stiffness = self.stiffness_nm_rad.re().abs();
        match self.curve {
            SpringCurve::Stiffening(scale_rad) => {
                let ratio = (angle_rad - self.slack_rad.re()) / scale_rad.re();
                stiffness * (1.0 + 3.0 * ratio * ratio)
            }
            _ => stiffness,
        }
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
    /// How it pushes.
    pub push: Push,
}

/// How the torque of a stop grows with the depth `x` of the contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Push {
    /// `k x + d x'`
    #[default]
    Linear,
    /// `(k + d x') x^1.5`, of round bodies that dent (Hunt and Crossley 1975); then `k` is in N m/rad^1.5 and `d` in
    /// N m s/rad^2.5.
    Power,
}

/// A joint is not expected deeper than this in a stop whose stiffness grows \[rad\].
const DEEP_RAD: f64 = 0.3;

impl<T: Real> EndStop<T> {
    /// Torque on the joint \[N m\].
    #[inline]
    pub fn torque_nm(&self, angle_rad: T, rate_rad_s: T) -> T {
        let depth_rad = (angle_rad - self.angle_rad) * self.side;
        if depth_rad.re() <= 0.0 {
            return T::nought();
        }
        let push_nm = match self.push {
            Push::Linear => depth_rad * self.stiffness_nm_rad + rate_rad_s * self.damping_nm_s_rad * self.side,
            Push::Power => {
                let hardness = self.stiffness_nm_rad + rate_rad_s * self.damping_nm_s_rad * self.side;
                hardness * depth_rad * depth_rad.sqrt()
            }
        };
        if push_nm.re() <= 0.0 { T::nought() } else { push_nm * -self.side }
    }

    /// How far it is away \[rad\]; negative in contact.
    pub(crate) fn distance_rad(&self, angle_rad: f64) -> f64 {
        (self.angle_rad.re() - angle_rad) * self.side
    }

    /// A step that follows the contact of a joint with this inertia \[s\].
    pub(crate) fn longest_step_s(&self, inertia_kg_m2: f64) -> f64 {
        let (stiffer, denser) = match self.push {
            Push::Linear => (1.0, 1.0),
            Push::Power => (1.5 * DEEP_RAD.sqrt(), math::powf(DEEP_RAD, 1.5)),
        };
        let oscillation = (stiffer * self.stiffness_nm_rad.re().abs() / inertia_kg_m2).sqrt();
        let decay_1_s = denser * self.damping_nm_s_rad.re().abs() / inertia_kg_m2;
        1.0 / (8.0 * oscillation).max(3.0 * decay_1_s).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_spring_pulls_towards_its_slack_angle() {
        let spring = Spring { stiffness_nm_rad: 0.02, slack_rad: 0.3, curve: SpringCurve::Linear };
        assert_relative_eq!(spring.torque_nm(0.8), -0.01, epsilon = 1e-15);
    }

    #[test]
    fn a_stop_pushes_back_and_never_pulls() {
        let stop =
            EndStop { angle_rad: -0.5, side: -1.0, stiffness_nm_rad: 10.0, damping_nm_s_rad: 0.1, push: Push::Linear };
        assert_eq!(stop.torque_nm(-0.4, -3.0), 0.0);
        assert_relative_eq!(stop.torque_nm(-0.52, -1.0), 0.2 + 0.1, epsilon = 1e-15);
        assert_eq!(stop.torque_nm(-0.52, 3.0), 0.0);
        assert!(stop.distance_rad(-0.4) > 0.0 && stop.distance_rad(-0.6) < 0.0);
    }
}
