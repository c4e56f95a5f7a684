//! The motor's torque saturates at `+-tau_max`.
//!
//! Forms: cut off there (hard), or `tau_max tanh(tau/tau_max)` (soft).
//!
//! A current limit, or a supply that gives no more. Driven logs only; peaks of the motion are clipped. Above the largest
//! torque that the logs ask for it does nothing, so it is scanned downwards from there. It takes the place of a limit that
//! the study states, lower or higher.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Knee, Real, TorqueLimit};

#[derive(Clone, Copy)]
pub(super) struct Term(Knee);

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term(Knee::Hard), "hard"), (Term(Knee::Soft), "soft")];
    const NAMED: &'static [Named] =
        &[Named { name: "tau_max", unit: "N m", zero: f64::INFINITY, bounds: Bounds::POSITIVE }];

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let most = reach.driven.map_or(reach.torque_nm, |driven| driven.command_nm);
        vec![EffectParameter::logarithm("tau_max", "N m", [0.01 * most, 1.5 * most])]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let Some(driven) = reach.driven else { return Vec::new() };
        [0.95, 0.85, 0.75, 0.65, 0.55, 0.45, 0.36, 0.28, 0.2, 0.13, 0.08]
            .map(|share| vec![share * driven.command_nm])
            .to_vec()
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        if let Some(motor) = &mut chain.motor {
            motor.limit_to(TorqueLimit { most_nm: values[0], knee: self.0 });
        }
    }
}
