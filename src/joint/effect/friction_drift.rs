//! Friction that changes along a log: `mu_c` and `mu_v` scale as `1 + r t`, `t` from the start of the log.
//!
//! Forms: `1 + r t` (linear), and `1 + r T_w (1 - exp(-t/T_w))` (saturating).
//!
//! Grease warms up and friction falls, or a seal swells and it rises. It shows as friction that depends on the time and
//! not on the amplitude.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, Contact, FrictionTerm, Real};

#[derive(Clone, Copy)]
pub(super) enum Term {
    Linear,
    Saturating,
}

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term::Linear, "linear"), (Term::Saturating, "saturating")];
    const NAMED: &'static [Named] = &[Named { name: "r", unit: "1/s", zero: 0.0, bounds: Bounds::Within([-1e3, 1e3]) }];

    fn named_parameters(self) -> &'static [Named] {
        match self {
            Term::Linear => Self::NAMED,
            Term::Saturating => SATURATING,
        }
    }

    fn near_default(self, values: &[f64], reach: &Reach) -> Vec<f64> {
        // The same change in the middle of a log: 1 - exp(-1/2) = 0.39 over its half.
        vec![1.27 * values[0], reach.duration_s]
    }

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let unit = 1.0 / reach.duration_s;
        match self {
            Term::Linear => vec![EffectParameter::linear("r", "1/s", [-0.98 * unit, 20.0 * unit], 0.2 * unit)],
            Term::Saturating => vec![
                EffectParameter::linear("r", "1/s", [-10.0 * unit, 100.0 * unit], 0.3 * unit),
                EffectParameter::logarithm("T_w", "s", [0.05 * reach.duration_s, 10.0 * reach.duration_s]),
            ],
        }
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let rates = [-0.6, -0.2, 0.3, 1.5].map(|share| share / reach.duration_s);
        match self {
            Term::Linear => rates.map(|rate| vec![rate]).to_vec(),
            Term::Saturating => pairs(&rates, &[0.15, 0.5].map(|share| share * reach.duration_s)),
        }
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        let (coulomb_nm, viscous_nm_s_rad) = (chain.friction.coulomb_nm, chain.friction.viscous_nm_s_rad);
        let (rate_1_s, warming_s) = (values[0], values.get(1).copied());
        chain.friction.terms.push(Box::new(DriftTerm { coulomb_nm, viscous_nm_s_rad, rate_1_s, warming_s }));
    }
}

struct DriftTerm<T> {
    coulomb_nm: T,
    viscous_nm_s_rad: T,
    rate_1_s: T,
    /// After which it settles, where it does \[s\].
    warming_s: Option<T>,
}

impl<T: Real> DriftTerm<T> {
    /// Share by which friction has grown at an instant.
    fn drifted(&self, t_s: T) -> T {
        let elapsed_s = match self.warming_s {
            None => t_s,
            Some(warming_s) => warming_s * (-(-t_s / warming_s).exp() + 1.0),
        };
        self.rate_1_s * elapsed_s
    }
}

impl<T: Real> FrictionTerm<T> for DriftTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        (self.coulomb_nm + self.viscous_nm_s_rad * at.speed_rad_s) * self.drifted(at.t_s)
    }

    fn slope_nm_s_rad(&self, _speed_rad_s: f64, t_s: f64) -> f64 {
        self.viscous_nm_s_rad.re() * self.drifted(T::constant(t_s)).re()
    }

    fn changes_with_time(&self) -> bool {
        true
    }
}

const SATURATING: &[Named] =
    &[Term::NAMED[0], Named { name: "T_w", unit: "s", zero: f64::INFINITY, bounds: Bounds::POSITIVE }];
