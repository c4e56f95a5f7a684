//! The motor's torque is at most `tau_stall (1 - |q'|/w_max)` when it drives.
//!
//! Forms: when it brakes at most `tau_stall`, as a limited current would have it (capped), or `tau_stall (1 + |q'|/w_max)`,
//! for the back voltage then adds to the supply's (line). This voltage brakes within a dead band too, which is of the
//! supply's share. Or what is asked for is a duty, of `tau_stall` at the most, from which the back voltage takes
//! `tau_stall q'/w_max` at any torque (voltage): beside a `kd` that does not have this braking in it.
//!
//! The back voltage of a motor on a fixed supply: a linear torque-speed curve. Driven logs only; the fast parts fall
//! behind. With `w_max` far above any speed seen it would be a torque limit, so `w_max` is kept near those speeds.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Braking, Chain, Real, SpeedLine};

#[derive(Clone, Copy)]
pub(super) struct Term(Braking);

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] =
        &[(Term(Braking::Capped), "capped"), (Term(Braking::Line), "line"), (Term(Braking::Voltage), "voltage")];
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
            let [no_load_rad_s, stall_nm] = [values[0], values[1]];
            motor.speed_line = Some(SpeedLine { no_load_rad_s, stall_nm, braking: self.0 });
        }
    }
}
