//! Free play of total width `b` between motor side and link side.
//!
//! The share `rotor` of the bare inertia and most of the friction lie on the motor side; encoder and controller on the link
//! side or where the study has them (link), or on the motor side (motor); the flanks are stiff and inelastic, and the joint
//! starts on the flank that gravity loads. After each reversal the link moves freely through the play, and at rest it can
//! rock in it.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, Play, Real};
use crate::log::EncoderSide;

#[derive(Clone, Copy)]
pub(super) enum Term {
    Link,
    Motor,
}

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term::Link, "link"), (Term::Motor, "motor")];
    const NAMED: &'static [Named] = &[
        Named { name: "b", unit: "rad", zero: 0.0, bounds: Bounds::POSITIVE },
        Named { name: "rotor", unit: "", zero: 0.0, bounds: Bounds::Within([0.001, 0.999]) },
    ];

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        vec![
            EffectParameter::logarithm("b", "rad", [0.05 * reach.resolution_rad.max(1e-5), 0.4]),
            EffectParameter::linear("rotor", "", [0.02, 0.9], 0.2),
        ]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let finest = (0.5 * reach.resolution_rad).max(1e-4);
        let widths: Vec<f64> =
            [0.001, 0.003, 0.008, 0.02, 0.05, 0.1].into_iter().filter(|width| *width >= finest).collect();
        pairs(&widths, &[0.12, 0.35])
    }

    fn apply<T: Real>(self, values: &[T], bare_kg_m2: T, chain: &mut Chain<T>) {
        if let Term::Motor = self {
            chain.encoder = EncoderSide::Motor;
        }
        chain.play = Some(Play { width_rad: values[0], motor_side_kg_m2: bare_kg_m2 * values[1] });
    }
}
