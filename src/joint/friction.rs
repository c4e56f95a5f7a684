//! Friction of a turning joint: which torque resists, and which one it takes to break away.
//!
//! Equations (3.11) and (3.14). Sticking itself is not here: the integrator asks [`Friction::breakaway_nm`] and keeps
//! the joint still while the net torque stays below it.

use super::Real;
use crate::number::math;

/// Where the joint is when friction is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Contact<T> {
    /// Time from the start of the log \[s\].
    pub t_s: T,
    /// Joint angle \[rad\].
    pub angle_rad: T,
    /// Speed without its sign \[rad/s\].
    pub speed_rad_s: T,
    /// Direction of motion, or of impending motion while at rest: +1 or -1.
    pub direction: f64,
    /// Gravity torque of link and extra mass \[N m\].
    pub gravity_nm: T,
    /// Torque that the motor delivers \[N m\].
    pub motor_nm: T,
}

/// One further contribution to the friction torque, beside Coulomb, Stribeck and viscous parts.
///
/// This is where an unmodelled friction effect plugs in; it sees the joint and touches no other stage.
pub trait FrictionTerm<T: Real>: Send + Sync {
    /// What the term adds to the resisting torque \[N m\]; it may be negative, the sum is cut off at zero.
    fn resistance_nm(&self, at: &Contact<T>) -> T;

    /// A bound on its slope against speed \[N m s/rad\] near `speed_rad_s` at an instant, for the choice of the step.
    fn slope_nm_s_rad(&self, speed_rad_s: f64, t_s: f64) -> f64;

    /// Whether it changes while the joint rests and nothing else changes.
    fn changes_with_time(&self) -> bool {
        false
    }
}

/// Friction of a turning joint, Coulomb, Stribeck and viscous parts (3.11).
///
/// `tau(w) = -sgn(w) (mu_c + (mu_st - mu_c) exp(-(|w|/v_st)^2) + mu_v |w|)`, with `w` in rad/s and the result in N m.
/// The text prints the exponent without absolute value or square; this is the form of Armstrong-Helouvry (1994).
/// The text's `|tanh(s w)|` smooths the law so that an integrator need not know about sticking; here the joint sticks
/// truly, which is the limit of a steep `s`. `v_st = 0` or `mu_st = 0` in Table 3.3 means that the Stribeck part is
/// absent, and (3.14) remains.
pub struct Friction<T: Real> {
    /// `mu_c` \[N m\]
    pub coulomb_nm: T,
    /// `mu_v` \[N m s/rad\]
    pub viscous_nm_s_rad: T,
    /// `mu_st` and `v_st`, where the joint has a Stribeck part.
    pub stribeck: Option<Stribeck<T>>,
    /// Contributions of effects.
    pub terms: Vec<Box<dyn FrictionTerm<T>>>,
}

/// The low-speed part of (3.11).
#[derive(Clone, Copy, Debug)]
pub struct Stribeck<T> {
    /// Static friction `mu_st` \[N m\].
    pub static_nm: T,
    /// Stribeck speed `v_st` \[rad/s\], above zero.
    pub speed_rad_s: T,
    /// How it falls.
    pub curve: StribeckCurve,
}

/// The share of static friction's excess that is left at `u = |w|/v_st`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StribeckCurve {
    /// `exp(-u^2)`, Armstrong-Helouvry's form.
    #[default]
    Gaussian,
    /// `exp(-u)`, Bo and Pavelescu's form.
    Exponential,
    /// `1/(1 + u^2)`, Hess and Soom's form.
    Rational,
}

impl StribeckCurve {
    #[inline]
    fn share<T: Real>(self, ratio: T) -> T {
        match self {
            StribeckCurve::Gaussian => (-(ratio * ratio)).exp(),
            // A step may look a little beyond the turning point.
            StribeckCurve::Exponential if ratio.re() < 0.0 => T::constant(1.0),
            StribeckCurve::Exponential => (-ratio).exp(),
            StribeckCurve::Rational => (ratio * ratio + 1.0).recip(),
        }
    }

    /// A bound on its slope from `ratio` on.
    fn slope(self, ratio: f64) -> f64 {
        match self {
            // The steepest slope of exp(-u^2) is sqrt(2/e), at u = 1/sqrt(2); beyond u = 4 it is nothing.
            StribeckCurve::Gaussian => {
                if ratio < 4.0 {
                    0.858
                } else {
                    0.0
                }
            }
            StribeckCurve::Exponential => math::exp(-ratio),
            // 3 sqrt(3)/8 at u = 1/sqrt(3).
            StribeckCurve::Rational => {
                if ratio < 1.0 {
                    0.65
                } else {
                    2.0 * ratio / (ratio * ratio + 1.0).powi(2)
                }
            }
        }
    }
}

impl<T: Real> Friction<T> {
    /// Coulomb and viscous friction only (3.14).
    pub fn coulomb_viscous(coulomb_nm: T, viscous_nm_s_rad: T) -> Self {
        Self { coulomb_nm, viscous_nm_s_rad, stribeck: None, terms: Vec::new() }
    }

    /// Torque that resists motion \[N m\], zero or above, at the speed of `at`.
    #[inline(always)]
    pub fn resistance_nm(&self, at: &Contact<T>) -> T {
        let mut sum = self.coulomb_nm + self.viscous_nm_s_rad * at.speed_rad_s;
        if let Some(s) = &self.stribeck {
            let ratio = at.speed_rad_s / s.speed_rad_s;
            sum += (s.static_nm - self.coulomb_nm) * s.curve.share(ratio);
        }
        for term in &self.terms {
            sum += term.resistance_nm(at);
        }
        if sum.re() < 0.0 { T::nought() } else { sum }
    }

    /// Torque up to which a joint at rest sticks \[N m\]: the resistance at zero speed.
    pub fn breakaway_nm(&self, at: &Contact<T>) -> T {
        debug_assert!(at.speed_rad_s.re() == 0.0, "breakaway is asked for at rest");
        self.resistance_nm(at)
    }

    /// Whether a joint at rest may break away though nothing pushes harder.
    pub(crate) fn changes_with_time(&self) -> bool {
        self.terms.iter().any(|term| term.changes_with_time())
    }

    /// A bound on the slope of the law near `speed_rad_s` at an instant \[N m s/rad\], for the choice of the step.
    pub(crate) fn slope_nm_s_rad(&self, speed_rad_s: f64, t_s: f64) -> f64 {
        let mut slope = self.viscous_nm_s_rad.re();
        if let Some(s) = &self.stribeck {
            let v_st = s.speed_rad_s.re();
            let excess_nm = (s.static_nm.re() - self.coulomb_nm.re()).abs();
            slope += s.curve.slope(speed_rad_s / v_st) * excess_nm / v_st;
        }
        // A term may take away no more than there is.
        (slope + self.terms.iter().map(|term| term.slope_nm_s_rad(speed_rad_s, t_s)).sum::<f64>()).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn at(speed_rad_s: f64) -> Contact<f64> {
        Contact { t_s: 0.0, angle_rad: 0.0, speed_rad_s, direction: 1.0, gravity_nm: 0.0, motor_nm: 0.0 }
    }

    #[test]
    fn table_3_3_q2_at_two_rad_per_second() {
        let q2 = Friction::coulomb_viscous(0.007, 0.019);
        assert_relative_eq!(q2.resistance_nm(&at(2.0)), 0.045, epsilon = 1e-15);
        assert_eq!(q2.breakaway_nm(&at(0.0)), 0.007);
    }

    #[test]
    fn stribeck_falls_from_static_to_coulomb() {
        let f = Friction {
            stribeck: Some(Stribeck { static_nm: 0.03, speed_rad_s: 0.5, curve: StribeckCurve::Gaussian }),
            ..Friction::coulomb_viscous(0.02, 0.0)
        };
        assert_eq!(f.breakaway_nm(&at(0.0)), 0.03);
        assert_relative_eq!(f.resistance_nm(&at(0.5)), 0.02 + 0.01 * (-1.0f64).exp(), epsilon = 1e-15);
        assert_relative_eq!(f.resistance_nm(&at(5.0)), 0.02, epsilon = 1e-12);
        assert!(f.slope_nm_s_rad(0.3, 0.0) >= 0.0171 && f.slope_nm_s_rad(3.0, 0.0) == 0.0);
    }

    /// An effect is one term: it sees the joint and adds to the resistance.
    struct Drag;
    impl FrictionTerm<f64> for Drag {
        fn resistance_nm(&self, at: &Contact<f64>) -> f64 {
            0.5 * at.speed_rad_s * at.speed_rad_s
        }
        fn slope_nm_s_rad(&self, speed_rad_s: f64, _t_s: f64) -> f64 {
            speed_rad_s
        }
    }

    #[test]
    fn a_term_adds_to_the_law_and_to_its_slope() {
        let f = Friction { terms: vec![Box::new(Drag)], ..Friction::coulomb_viscous(0.1, 0.2) };
        assert_relative_eq!(f.resistance_nm(&at(2.0)), 0.1 + 0.4 + 2.0, epsilon = 1e-15);
        assert_relative_eq!(f.slope_nm_s_rad(2.0, 0.0), 2.2, epsilon = 1e-15);
    }
}
