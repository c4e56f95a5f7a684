//! A parallel elastic torque `k (q_s - q)`, with `q_s` within the travel.
//!
//! Forms, with `x = q_s - q`: `k x` (linear), `k x (1 + (x/q_c)^2)` (stiffening), and `k x` only where the joint is
//! beyond `q_s` on one side (one_sided).
//!
//! A cable, a hose or a skin that bends with the joint. It changes the frequency of the swing and the resting angle, and
//! does so whatever mass is hung on. A far `q_s` with a small `k` would be a constant torque, which is asymmetric friction.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, Real, Spring, SpringCurve};

#[derive(Clone, Copy)]
pub(super) enum Term {
    Linear,
    Stiffening,
    OneSided,
}

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] =
        &[(Term::Linear, "linear"), (Term::Stiffening, "stiffening"), (Term::OneSided, "one_sided")];
    const NAMED: &'static [Named] = &[
        Named { name: "k", unit: "N m/rad", zero: 0.0, bounds: Bounds::NOT_NEGATIVE },
        Named { name: "q_s", unit: "rad", zero: 0.0, bounds: Bounds::ANGLE },
    ];

    fn named_parameters(self) -> &'static [Named] {
        match self {
            Term::Linear => Self::NAMED,
            Term::Stiffening => STIFFENING,
            Term::OneSided => ONE_SIDED,
        }
    }

    fn near_default(self, values: &[f64], reach: &Reach) -> Vec<f64> {
        let [low, high] = reach.angle_rad;
        match self {
            Term::Linear => values.to_vec(),
            Term::Stiffening => vec![values[0], values[1], 4.0 * (high - low)],
            // It pulls where most of the travel is.
            Term::OneSided => vec![values[0], values[1], if values[1] > 0.5 * (low + high) { -1.0 } else { 1.0 }],
        }
    }

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let mut parameters = vec![
            EffectParameter::linear("k", "N m/rad", [0.0, 10.0 * reach.torque_nm], 0.1 * reach.torque_nm),
            EffectParameter::linear("q_s", "rad", reach.angle_rad, 0.3),
        ];
        let span = reach.angle_rad[1] - reach.angle_rad[0];
        match self {
            Term::Linear => {}
            Term::Stiffening => {
                parameters.push(EffectParameter::logarithm("q_c", "rad", [0.15 * span, 20.0 * span]));
            }
            Term::OneSided => parameters.push(EffectParameter::held("side", "", [-1.0, 1.0])),
        }
        parameters
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let [low, high] = reach.angle_rad;
        let places = [0.15, 0.5, 0.85].map(|share| low + share * (high - low));
        let starts = pairs(&[0.03 * reach.torque_nm, 0.3 * reach.torque_nm], &places);
        let more: &[f64] = match self {
            Term::Linear => return starts,
            Term::Stiffening => &[0.5 * (high - low)],
            Term::OneSided => &[-1.0, 1.0],
        };
        starts.iter().flat_map(|start| more.iter().map(move |m| [start.as_slice(), &[*m]].concat())).collect()
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        let curve = match self {
            Term::Linear => SpringCurve::Linear,
            Term::Stiffening => SpringCurve::Stiffening(values[2]),
            Term::OneSided => SpringCurve::OneSided(values[2].re()),
        };
        chain.spring = Some(Spring { stiffness_nm_rad: values[0], slack_rad: values[1], curve });
    }
}

const STIFFENING: &[Named] = &[
    Term::NAMED[0],
    Term::NAMED[1],
    Named { name: "q_c", unit: "rad", zero: f64::INFINITY, bounds: Bounds::POSITIVE },
];
const ONE_SIDED: &[Named] =
    &[Term::NAMED[0], Term::NAMED[1], Named { name: "side", unit: "", zero: 0.0, bounds: Bounds::Either([-1.0, 1.0]) }];
