//! Coulomb friction that differs with the direction: `mu_c + delta` for `q' > 0`, `mu_c - delta` for `q' < 0`.
//!
//! Worm gears, cables and preloaded seals resist one direction more. While the joint moves it is a constant torque; the
//! resting angles shift to one side, whatever mass is hung on.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Contact, FrictionTerm, Real};

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[Named { name: "delta", unit: "N m", zero: 0.0, bounds: Bounds::ANY }];

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let most = 0.5 * reach.torque_nm;
        vec![EffectParameter::linear("delta", "N m", [-most, most], 0.02 * reach.torque_nm)]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let unit = reach.coulomb_nm.max(0.02 * reach.torque_nm);
        [-0.4, -0.1, 0.1, 0.4].map(|share| vec![share * unit]).to_vec()
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.friction.terms.push(Box::new(DirectionTerm { delta_nm: values[0] }));
    }
}

struct DirectionTerm<T> {
    delta_nm: T,
}

impl<T: Real> FrictionTerm<T> for DirectionTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        self.delta_nm * at.direction
    }

    fn slope_nm_s_rad(&self, _speed_rad_s: f64, _t_s: f64) -> f64 {
        0.0
    }
}
