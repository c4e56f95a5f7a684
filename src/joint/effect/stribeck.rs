//! Friction at low speed: `mu_c + (mu_st - mu_c) exp(-(|q'|/v_st)^2) + mu_v |q'|` with `mu_st > mu_c`.
//!
//! Forms: `exp(-u^2)` (gaussian), `exp(-u)` (exponential) and `1/(1 + u^2)` (rational) of `u = |q'|/v_st`.
//!
//! A joint at rest and just above it is held by more than Coulomb friction; lubrication carries it at speed (Stribeck 1902,
//! this form by Armstrong-Helouvry 1994; equation 3.11). It shows where the joint turns back and where it comes to rest,
//! and lets a joint that has stopped stay where Coulomb friction alone would let it go.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, Real, Stribeck, StribeckCurve};

#[derive(Clone, Copy)]
pub(super) struct Term(StribeckCurve);

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[
        (Term(StribeckCurve::Gaussian), "gaussian"),
        (Term(StribeckCurve::Exponential), "exponential"),
        (Term(StribeckCurve::Rational), "rational"),
    ];
    const NAMED: &'static [Named] = &[
        Named { name: "mu_st", unit: "N m", zero: 0.0, bounds: Bounds::NOT_NEGATIVE },
        Named { name: "v_st", unit: "rad/s", zero: 0.0, bounds: Bounds::POSITIVE },
    ];

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let scale = reach.coulomb_nm.max(0.02 * reach.torque_nm);
        vec![
            EffectParameter::linear("static_excess", "N m", [0.0, reach.torque_nm], scale),
            EffectParameter::logarithm("v_st", "rad/s", [1e-3 * reach.speed_rad_s, reach.speed_rad_s]),
        ]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let scale = reach.coulomb_nm.max(0.02 * reach.torque_nm);
        let speeds = [0.01, 0.03, 0.08, 0.2, 0.5].map(|share| share * reach.speed_rad_s);
        pairs(&[0.3 * scale, 1.5 * scale], &speeds)
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        let static_nm = chain.friction.coulomb_nm + values[0];
        chain.friction.stribeck = Some(Stribeck { static_nm, speed_rad_s: values[1], curve: self.0 });
    }

    fn named(self, values: &[f64], coulomb_nm: f64) -> Vec<f64> {
        vec![coulomb_nm + values[0], values[1]]
    }

    fn searched(self, named: &[f64], coulomb_nm: f64) -> Vec<f64> {
        vec![named[0] - coulomb_nm, named[1]]
    }
}
