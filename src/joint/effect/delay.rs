//! The setpoint acts `T` late.
//!
//! Buses, queues and control cycles. Driven logs only; it shows in proportion to the setpoint's rate of change, and hides
//! as viscous friction and inertia that are too large.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Real};

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[Named { name: "T", unit: "s", zero: 0.0, bounds: Bounds::NOT_NEGATIVE }];

    fn parameters(self, _reach: &Reach) -> Vec<EffectParameter> {
        vec![EffectParameter::linear("T", "s", [0.0, 0.4], 0.01)]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        if reach.driven.is_none() {
            return Vec::new();
        }
        [0.002, 0.005, 0.01, 0.018, 0.03, 0.05, 0.09].map(|delay| vec![delay]).to_vec()
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.setpoint.delay_s = Some(values[0]);
    }
}
