//! A one-sided stiff spring and damper, which does not pull, beyond `q_e` inside the swing range.
//!
//! Forms: `k x + d x'` of the depth `x` (linear), or `(k + d x') x^1.5` (power; Hunt and Crossley 1975).
//!
//! A leg that touches its stop turns back early and loses energy there. Its cost is flat until the stop lies inside the
//! range, so it is scanned from both ends of it.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, EndStop, Push, Real};
use crate::number::math;

#[derive(Clone, Copy)]
pub(super) struct Term(Push);

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term(Push::Linear), "linear"), (Term(Push::Power), "power")];
    const NAMED: &'static [Named] = &[
        Named { name: "q_e", unit: "rad", zero: f64::INFINITY, bounds: Bounds::ANGLE },
        Named { name: "side", unit: "", zero: 0.0, bounds: Bounds::Either([-1.0, 1.0]) },
        Named { name: "stiffness", unit: "N m/rad", zero: 0.0, bounds: Bounds::POSITIVE },
        Named { name: "damping", unit: "N m s/rad", zero: 0.0, bounds: Bounds::NOT_NEGATIVE },
    ];

    fn named_parameters(self) -> &'static [Named] {
        match self.0 {
            Push::Linear => Self::NAMED,
            Push::Power => POWER,
        }
    }

    /// The same torque in a contact as deep as it takes to turn the joint back.
    fn near_default(self, values: &[f64], reach: &Reach) -> Vec<f64> {
        let [stiffer, denser] = self.per_linear((reach.torque_nm / values[2]).clamp(1e-3, 0.2));
        vec![values[0], values[1], values[2] * stiffer, values[3] * denser]
    }

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let [low, high] = reach.angle_rad;
        let per_rad = reach.torque_nm;
        let damping = (per_rad * reach.inertia_kg_m2).sqrt();
        let held = EffectParameter::held("side", "", [-1.0, 1.0]);
        let unit = |linear, power| if self.0 == Push::Linear { linear } else { power };
        let [stiffer, denser] = self.per_linear(DEPTH_RAD);
        vec![
            EffectParameter::linear("q_e", "rad", [low, high], 0.05 * (high - low)),
            held,
            EffectParameter::logarithm(
                "stiffness",
                unit("N m/rad", "N m/rad^1.5"),
                [2.0, 3e4].map(|times| times * per_rad * stiffer),
            ),
            EffectParameter::linear(
                "damping",
                unit("N m s/rad", "N m s/rad^2.5"),
                [0.0, 200.0 * damping * denser],
                damping * denser,
            ),
        ]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let [low, high] = reach.angle_rad;
        // A stop that is hit hard is where the range ends; a soft one is well inside it.
        let shares = [0.0005, 0.004, 0.012, 0.03, 0.06, 0.1, 0.16, 0.24, 0.34];
        let upper = shares.iter().map(|share| (high - share * (high - low), 1.0));
        let lower = shares.iter().map(|share| (low + share * (high - low), -1.0));
        let places: Vec<(f64, f64)> = upper.chain(lower).collect();
        [50.0, 1500.0]
            .into_iter()
            .flat_map(|stiffness| {
                let stiffness = stiffness * reach.torque_nm;
                let damping = 0.3 * (stiffness * reach.inertia_kg_m2).sqrt();
                let [stiffer, denser] = self.per_linear(DEPTH_RAD);
                places.iter().map(move |&(angle, side)| vec![angle, side, stiffness * stiffer, damping * denser])
            })
            .collect()
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.stop = Some(EndStop {
            angle_rad: values[0],
            side: values[1].re(),
            stiffness_nm_rad: values[2],
            damping_nm_s_rad: values[3],
            push: self.0,
        });
    }
}

/// How deep a contact is thought to be \[rad\] where bounds are drawn.
const DEPTH_RAD: f64 = 0.03;

const POWER: &[Named] = &[
    Term::NAMED[0],
    Term::NAMED[1],
    Named { unit: "N m/rad^1.5", ..Term::NAMED[2] },
    Named { unit: "N m s/rad^2.5", ..Term::NAMED[3] },
];

impl Term {
    /// Stiffness and damping per those of a linear stop that pushes alike at a depth.
    fn per_linear(self, depth_rad: f64) -> [f64; 2] {
        match self.0 {
            Push::Linear => [1.0, 1.0],
            Push::Power => [math::powf(depth_rad, -0.5), math::powf(depth_rad, -1.5)],
        }
    }
}
