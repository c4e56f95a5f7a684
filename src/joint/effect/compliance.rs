//! A spring `k` and a damper `d` between motor side and link.
//!
//! Harmonic drives, belts and long shafts give. The motor side has the armature that the study gives, else 0.3 of the bare
//! inertia, which is held; most of the friction lies there too. Encoder and controller are where the study has them. It
//! shows as ringing after jolts, and as a link that hangs behind in proportion to the torque.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Compliance, Real};

/// Share of the bare inertia on the motor side where the study knows no armature.
const MOTOR_SHARE: f64 = 0.3;

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[
        Named { name: "k", unit: "N m/rad", zero: f64::INFINITY, bounds: Bounds::POSITIVE },
        Named { name: "d", unit: "N m s/rad", zero: 0.0, bounds: Bounds::NOT_NEGATIVE },
    ];

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let damping = (reach.torque_nm * reach.inertia_kg_m2).sqrt();
        vec![
            EffectParameter::logarithm("k", "N m/rad", [reach.torque_nm, 300.0 * reach.torque_nm]),
            EffectParameter::linear("d", "N m s/rad", [0.0, 20.0 * damping], 0.3 * damping),
        ]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let start = |share: f64| {
            let stiffness = share * reach.torque_nm;
            vec![stiffness, 0.1 * (stiffness * MOTOR_SHARE * reach.inertia_kg_m2).sqrt()]
        };
        [40.0, 12.0].map(start).to_vec()
    }

    fn apply<T: Real>(self, values: &[T], bare_kg_m2: T, chain: &mut Chain<T>) {
        let share = if chain.armature_kg_m2.re() > 0.0 { 0.0 } else { MOTOR_SHARE };
        chain.compliance = Some(Compliance {
            stiffness_nm_rad: values[0],
            damping_nm_s_rad: values[1],
            motor_side_kg_m2: bare_kg_m2 * share,
        });
    }
}
