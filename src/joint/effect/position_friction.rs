//! Coulomb friction that varies over a turn: `mu_c (1 + a cos(q - phi)) >= 0`.
//!
//! An eccentric gear or a cable that is bent more at some angles. Searched as `a cos(phi)` and `a sin(phi)`, in which the
//! friction is linear and the zero is a point.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, Contact, FrictionTerm, Real};
use crate::number::math;

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[
        Named { name: "a", unit: "", zero: 0.0, bounds: Bounds::ANY },
        Named { name: "phi", unit: "rad", zero: 0.0, bounds: Bounds::ANGLE },
    ];

    fn parameters(self, _reach: &Reach) -> Vec<EffectParameter> {
        vec![
            EffectParameter::linear("a_cos_phi", "", [-1.0, 1.0], 0.3),
            EffectParameter::linear("a_sin_phi", "", [-1.0, 1.0], 0.3),
        ]
    }

    fn starts(self, _reach: &Reach) -> Vec<Vec<f64>> {
        pairs(&[-0.4, 0.4], &[-0.4, 0.4])
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        let coulomb_nm = chain.friction.coulomb_nm;
        chain.friction.terms.push(Box::new(PositionTerm { coulomb_nm, cosine: values[0], sine: values[1] }));
    }

    fn named(self, values: &[f64], _coulomb_nm: f64) -> Vec<f64> {
        vec![math::hypot(values[0], values[1]), math::atan2(values[1], values[0])]
    }

    fn searched(self, named: &[f64], _coulomb_nm: f64) -> Vec<f64> {
        vec![named[0] * math::cos(named[1]), named[0] * math::sin(named[1])]
    }
}

struct PositionTerm<T> {
    coulomb_nm: T,
    cosine: T,
    sine: T,
}

impl<T: Real> FrictionTerm<T> for PositionTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        let (sin, cos) = at.angle_rad.sin_cos();
        let share = self.cosine * cos + self.sine * sin;
        // mu_c (1 + share) does not fall below zero.
        if share.re() < -1.0 { -self.coulomb_nm } else { self.coulomb_nm * share }
    }

    fn slope_nm_s_rad(&self, _speed_rad_s: f64, _t_s: f64) -> f64 {
        0.0
    }
}
