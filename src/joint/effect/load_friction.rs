//! Friction under load: it gains `mu_l |gravity torque of link and extra mass|`.
//!
//! A bearing resists in proportion to the force on it, and on a pendulum most of that force goes with the gravity torque.
//! It shows as friction that rises with the added mass and with the angle.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Contact, FrictionTerm, Real};

pub(super) struct Term;

impl Effect for Term {
    const NAMED: &'static [Named] = &[Named { name: "mu_l", unit: "", zero: 0.0, bounds: Bounds::NOT_NEGATIVE }];

    fn parameters(_reach: &Reach) -> Vec<EffectParameter> {
        vec![EffectParameter::linear("mu_l", "", [0.0, 0.9], 0.1)]
    }

    fn starts(_reach: &Reach) -> Vec<Vec<f64>> {
        vec![vec![0.03], vec![0.1], vec![0.3]]
    }

    fn apply<T: Real>(values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.friction.terms.push(Box::new(LoadTerm { mu_l: values[0] }));
    }
}

struct LoadTerm<T> {
    mu_l: T,
}

impl<T: Real> FrictionTerm<T> for LoadTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        let load_nm = if at.gravity_nm.re() < 0.0 { -at.gravity_nm } else { at.gravity_nm };
        self.mu_l * load_nm
    }

    fn slope_nm_s_rad(&self, _speed_rad_s: f64) -> f64 {
        0.0
    }
}
