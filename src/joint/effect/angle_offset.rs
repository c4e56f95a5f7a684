//! Gravity torque `g M* sin(q + d)`: the encoder's zero or the direction of the centre of mass is off by `d`.
//!
//! In these logs the two are the same thing. The resting angle shifts by `-d`, and the torque that is missing grows with
//! the mass: it is proportional to `g M* cos q`.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Real};

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[Named { name: "d", unit: "rad", zero: 0.0, bounds: Bounds::ANGLE }];

    fn parameters(self, _reach: &Reach) -> Vec<EffectParameter> {
        vec![EffectParameter::linear("d", "rad", [-1.0, 1.0], 0.05)]
    }

    fn starts(self, _reach: &Reach) -> Vec<Vec<f64>> {
        vec![vec![-0.15], vec![-0.03], vec![0.03], vec![0.15]]
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.link = chain.link.turned(values[0]);
    }
}
