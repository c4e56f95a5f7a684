//! The delivered torque is `c` times the commanded torque, before any limit.
//!
//! A torque constant or a supply voltage that is not what the data sheet says. Driven logs only; with driven logs alone it
//! is a calibration of everything else.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Real};

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[Named { name: "c", unit: "", zero: 1.0, bounds: Bounds::NOT_NEGATIVE }];

    fn parameters(self, _reach: &Reach) -> Vec<EffectParameter> {
        vec![EffectParameter::logarithm("c", "", [0.15, 5.0])]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        if reach.driven.is_some() { vec![vec![0.8], vec![0.95], vec![1.05], vec![1.25]] } else { Vec::new() }
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        if let Some(motor) = &mut chain.motor {
            motor.gain *= values[0];
        }
    }
}
