//! Friction at high speed: it gains `c2 q'^2`.
//!
//! Forms: `c2 q'^2` (square), and `c |q'|^p` with any exponent from 1.2 to 3 (power).
//!
//! Air, grease that is churned, and eddies resist with the square of the speed. Large swings lose more than small ones,
//! and more than viscous friction explains.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, Contact, FrictionTerm, Real};
use crate::number::math;

#[derive(Clone, Copy)]
pub(super) enum Term {
    Square,
    Power,
}

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term::Square, "square"), (Term::Power, "power")];
    const NAMED: &'static [Named] =
        &[Named { name: "c2", unit: "N m s^2/rad^2", zero: 0.0, bounds: Bounds::NOT_NEGATIVE }];

    fn named_parameters(self) -> &'static [Named] {
        match self {
            Term::Square => Self::NAMED,
            Term::Power => POWER,
        }
    }

    fn near_default(self, values: &[f64], _reach: &Reach) -> Vec<f64> {
        vec![values[0], 2.0]
    }

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let unit = reach.torque_nm / reach.speed_rad_s.powi(2);
        match self {
            Term::Square => vec![EffectParameter::linear("c2", "N m s^2/rad^2", [0.0, 20.0 * unit], 0.1 * unit)],
            Term::Power => {
                // The same torque at the largest speed, whatever the exponent; bounds for the least of them.
                let most = 20.0 * unit * math::powf(reach.speed_rad_s, 2.0 - LEAST).max(1.0);
                vec![
                    EffectParameter::linear("c", "N m s^p/rad^p", [0.0, most], 0.1 * unit),
                    EffectParameter::linear("p", "", [LEAST, 3.0], 0.3),
                ]
            }
        }
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let unit = reach.torque_nm / reach.speed_rad_s.powi(2);
        match self {
            Term::Square => vec![vec![0.03 * unit], vec![0.2 * unit]],
            Term::Power => pairs(&[0.03 * unit, 0.2 * unit], &[1.5, 2.5]),
        }
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.friction.terms.push(Box::new(DragTerm { c: values[0], power: values.get(1).copied() }));
    }
}

struct DragTerm<T> {
    c: T,
    /// The exponent, where it is not 2.
    power: Option<T>,
}

impl<T: Real> FrictionTerm<T> for DragTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        match self.power {
            None => self.c * at.speed_rad_s * at.speed_rad_s,
            // A power of nought has no derivative by its exponent.
            Some(_) if at.speed_rad_s.re() <= STILL_RAD_S => T::nought(),
            Some(power) => self.c * at.speed_rad_s.powd(power),
        }
    }

    fn slope_nm_s_rad(&self, speed_rad_s: f64, _t_s: f64) -> f64 {
        let power = self.power.map_or(2.0, |power| power.re());
        power * self.c.re() * math::powf(speed_rad_s, power - 1.0)
    }
}

/// The least exponent; 1 is viscous friction.
const LEAST: f64 = 1.2;
/// Below this speed a joint stands still \[rad/s\].
const STILL_RAD_S: f64 = 1e-9;

const POWER: &[Named] = &[
    Named { name: "c", unit: "N m s^p/rad^p", zero: 0.0, bounds: Bounds::NOT_NEGATIVE },
    Named { name: "p", unit: "", zero: 2.0, bounds: Bounds::Within([1.0, 4.0]) },
];
