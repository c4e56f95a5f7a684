//! The measured angle is `(1 + e) q`, and the controller sees the measured angle.
//!
//! A wrong number of counts per turn, a belt, a bent potentiometer. Small swings show nothing, because only the ratio of
//! gravity to inertia enters; beyond 1 rad the period depends on the true amplitude. Where the joint hangs is a reading.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Real};

pub(super) struct Term;

impl Effect for Term {
    const NAMED: &'static [Named] = &[Named { name: "e", unit: "", zero: 0.0, bounds: Bounds::Within([-0.99, 100.0]) }];

    fn parameters(_reach: &Reach) -> Vec<EffectParameter> {
        vec![EffectParameter::linear("e", "", [-0.5, 1.0], 0.05)]
    }

    fn starts(_reach: &Reach) -> Vec<Vec<f64>> {
        vec![vec![-0.1], vec![-0.02], vec![0.02], vec![0.1]]
    }

    fn apply<T: Real>(values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        let gain = values[0] + 1.0;
        if chain.link.peak_gravity_nm() > 0.0 {
            let hanging_rad = chain.link.hanging_rad();
            chain.link = chain.link.turned(hanging_rad - hanging_rad / gain);
        }
        chain.sensor_gain = gain;
    }
}
