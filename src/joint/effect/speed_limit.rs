//! The motor's torque is at most `tau_stall (1 - |q'|/w_max)` when it drives, and `tau_stall` when it brakes.
//!
//! The back voltage of a motor on a fixed supply: a linear torque-speed curve. Driven logs only; the fast parts fall
//! behind. With `w_max` far above any speed seen it would be a torque limit, so `w_max` is kept near those speeds.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, Real, SpeedLine};

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[
        Named { name: "w_max", unit: "rad/s", zero: f64::INFINITY, bounds: Bounds::POSITIVE },
        Named { name: "tau_stall", unit: "N m", zero: f64::INFINITY, bounds: Bounds::POSITIVE },
    ];

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let (speed, most) =
            reach.driven.map_or((reach.speed_rad_s, reach.torque_nm), |driven| (driven.speed_rad_s, driven.command_nm));
        vec![
            EffectParameter::logarithm("w_max", "rad/s", [0.6 * speed, 5.0 * speed]),
            EffectParameter::logarithm("tau_stall", "N m", [0.02 * most, 5.0 * most]),
        ]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let Some(driven) = reach.driven else { return Vec::new() };
        let speeds = [1.05, 1.3, 1.8, 3.0].map(|share| share * driven.speed_rad_s);
        pairs(&speeds, &[1.5, 0.8, 0.45, 0.25].map(|share| share * driven.command_nm))
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        if let Some(motor) = &mut chain.motor {
            motor.speed_line = Some(SpeedLine { no_load_rad_s: values[0], stall_nm: values[1] });
        }
    }
}
