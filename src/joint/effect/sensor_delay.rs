//! The reading is `T` old, in the log and for the controller.
//!
//! Filters of an encoder, a bus that is polled, stamps that are put on late. Driven logs only, for a free swing is the same
//! swing later. It shows as a setpoint that acts late and, because the controller damps by what it sees, as damping that
//! is too small: a stiff joint rings.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Real};

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[Named { name: "T", unit: "s", zero: 0.0, bounds: Bounds::NOT_NEGATIVE }];

    fn parameters(self, _reach: &Reach) -> Vec<EffectParameter> {
        vec![EffectParameter::linear("T", "s", [0.0, 0.2], 0.005)]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        if reach.driven.is_none() {
            return Vec::new();
        }
        [0.002, 0.005, 0.01, 0.02, 0.04].map(|delay| vec![delay]).to_vec()
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        // A free log tells its own time: it shows the same swing whenever it is read.
        chain.sensor_delay_s = chain.motor.as_ref().map(|_| values[0]);
    }
}
