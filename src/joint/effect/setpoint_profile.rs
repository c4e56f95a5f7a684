//! The servo limits speed `v_max` and acceleration `a_max` of its setpoint.
//!
//! Position servos run a profile towards the goal that they were given: they speed up by `a_max`, run at `v_max`, and
//! slow down to rest at the goal; a new goal is taken up from where the profile is. Logs driven by a setpoint only; fast
//! parts of a motion are rounded off and late, however strong the motor.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, ProfileLimits, Real};

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[
        Named { name: "v_max", unit: "rad/s", zero: f64::INFINITY, bounds: Bounds::POSITIVE },
        Named { name: "a_max", unit: "rad/s^2", zero: f64::INFINITY, bounds: Bounds::POSITIVE },
    ];

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let speed = reach.driven.map_or(reach.speed_rad_s, |driven| driven.speed_rad_s);
        vec![
            EffectParameter::logarithm("v_max", "rad/s", [0.05 * speed, 20.0 * speed]),
            EffectParameter::logarithm("a_max", "rad/s^2", [0.3 * speed, 3e3 * speed]),
        ]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let Some(driven) = reach.driven.filter(|driven| driven.by_setpoint) else { return Vec::new() };
        let speeds = [0.3, 0.7, 1.2, 4.0].map(|share| share * driven.speed_rad_s);
        pairs(&speeds, &[3.0, 10.0, 40.0].map(|per_s| per_s * driven.speed_rad_s))
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.setpoint.profile = Some(ProfileLimits { speed_rad_s: values[0], acceleration_rad_s2: values[1] });
    }
}
