//! Friction that changes along a log: `mu_c` and `mu_v` scale as `1 + r t`, `t` from the start of the log.
//!
//! Grease warms up and friction falls, or a seal swells and it rises. It shows as friction that depends on the time and
//! not on the amplitude.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Contact, FrictionTerm, Real};

pub(super) struct Term;

impl Effect for Term {
    const NAMED: &'static [Named] = &[Named { name: "r", unit: "1/s", zero: 0.0, bounds: Bounds::Within([-1e3, 1e3]) }];

    fn parameters(reach: &Reach) -> Vec<EffectParameter> {
        let unit = 1.0 / reach.duration_s;
        vec![EffectParameter::linear("r", "1/s", [-0.98 * unit, 20.0 * unit], 0.2 * unit)]
    }

    fn starts(reach: &Reach) -> Vec<Vec<f64>> {
        [-0.6, -0.2, 0.3, 1.5].map(|share| vec![share / reach.duration_s]).to_vec()
    }

    fn apply<T: Real>(values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        let (coulomb_nm, viscous_nm_s_rad) = (chain.friction.coulomb_nm, chain.friction.viscous_nm_s_rad);
        chain.friction.terms.push(Box::new(DriftTerm { coulomb_nm, viscous_nm_s_rad, rate_1_s: values[0] }));
    }
}

struct DriftTerm<T> {
    coulomb_nm: T,
    viscous_nm_s_rad: T,
    rate_1_s: T,
}

impl<T: Real> FrictionTerm<T> for DriftTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        (self.coulomb_nm + self.viscous_nm_s_rad * at.speed_rad_s) * self.rate_1_s * at.t_s
    }

    fn slope_nm_s_rad(&self, _speed_rad_s: f64) -> f64 {
        0.0
    }

    fn changes_with_time(&self) -> bool {
        true
    }
}
