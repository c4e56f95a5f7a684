//! The setpoint reaches the controller only every `T_h`, and is held in between.
//!
//! The thesis's motion files have a frame every 128 ms. Driven logs only. Which setpoints get through changes by leaps with
//! `T_h`, so it is scanned finely.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Real};
use crate::number::math;

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[Named { name: "T_h", unit: "s", zero: 0.0, bounds: Bounds::NOT_NEGATIVE }];

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let finest = reach.driven.map_or(0.001, |driven| driven.period_s);
        vec![EffectParameter::linear("T_h", "s", [finest, 0.5], 0.1 * finest)]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let Some(driven) = reach.driven.filter(|driven| driven.by_setpoint) else { return Vec::new() };
        let multiples = (2..=24).map(|n| f64::from(n) * driven.period_s);
        let between =
            (0..FINE).map(|n| 1.7 * driven.period_s * math::powf(FINE_TO / 1.7_f64, f64::from(n) / f64::from(FINE)));
        multiples.chain(between).map(|hold| vec![hold]).collect()
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.setpoint.hold_s = Some(values[0]);
    }
}

/// Points of the scan between the multiples of the period, up to so many periods.
const FINE: u32 = 40;
const FINE_TO: f64 = 30.0;
