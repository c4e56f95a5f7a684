//! A parallel elastic torque `k (q_s - q)`, with `q_s` within the travel.
//!
//! A cable, a hose or a skin that bends with the joint. It changes the frequency of the swing and the resting angle, and
//! does so whatever mass is hung on. A far `q_s` with a small `k` would be a constant torque, which is asymmetric friction.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, Real, Spring};

pub(super) struct Term;

impl Effect for Term {
    const NAMED: &'static [Named] = &[
        Named { name: "k", unit: "N m/rad", zero: 0.0, bounds: Bounds::NOT_NEGATIVE },
        Named { name: "q_s", unit: "rad", zero: 0.0, bounds: Bounds::ANGLE },
    ];

    fn parameters(reach: &Reach) -> Vec<EffectParameter> {
        vec![
            EffectParameter::linear("k", "N m/rad", [0.0, 10.0 * reach.torque_nm], 0.1 * reach.torque_nm),
            EffectParameter::linear("q_s", "rad", reach.angle_rad, 0.3),
        ]
    }

    fn starts(reach: &Reach) -> Vec<Vec<f64>> {
        let [low, high] = reach.angle_rad;
        let places = [0.15, 0.5, 0.85].map(|share| low + share * (high - low));
        pairs(&[0.03 * reach.torque_nm, 0.3 * reach.torque_nm], &places)
    }

    fn apply<T: Real>(values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.spring = Some(Spring { stiffness_nm_rad: values[0], slack_rad: values[1] });
    }
}
