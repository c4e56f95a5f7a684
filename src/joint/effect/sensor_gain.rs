//! The measured angle is `(1 + e) q`, and the controller sees the measured angle.
//!
//! Forms: `(1 + e) q` (constant), and `q + e sin(q - phi)` of a disc that is off its centre, once per turn (eccentric);
//! that is searched as `e cos(phi)` and `e sin(phi)`.
//!
//! A wrong number of counts per turn, a belt, a bent potentiometer. Small swings show nothing, because only the ratio of
//! gravity to inertia enters; beyond 1 rad the period depends on the true amplitude. Where the joint hangs is a reading: what the form adds there is taken out.

use super::{Bounds, Effect, EffectParameter, Named, Reach, pairs};
use crate::joint::{Chain, Eccentric, Real};
use crate::number::math;

#[derive(Clone, Copy)]
pub(super) enum Term {
    Constant,
    Eccentric,
}

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term::Constant, "constant"), (Term::Eccentric, "eccentric")];
    const NAMED: &'static [Named] = &[Named { name: "e", unit: "", zero: 0.0, bounds: Bounds::Within([-0.99, 100.0]) }];

    fn named_parameters(self) -> &'static [Named] {
        match self {
            Term::Constant => Self::NAMED,
            Term::Eccentric => ECCENTRIC,
        }
    }

    fn near_default(self, values: &[f64], _reach: &Reach) -> Vec<f64> {
        match self {
            Term::Constant => values.to_vec(),
            // The same gain about an angle of nought.
            Term::Eccentric => vec![values[0], 0.0],
        }
    }

    fn parameters(self, _reach: &Reach) -> Vec<EffectParameter> {
        match self {
            Term::Constant => vec![EffectParameter::linear("e", "", [-0.5, 1.0], 0.05)],
            Term::Eccentric => ["e_cos_phi", "e_sin_phi"]
                .map(|name| EffectParameter::linear(name, "rad", [-MOST_RAD, MOST_RAD], 0.02))
                .to_vec(),
        }
    }

    fn starts(self, _reach: &Reach) -> Vec<Vec<f64>> {
        match self {
            Term::Constant => vec![vec![-0.1], vec![-0.02], vec![0.02], vec![0.1]],
            Term::Eccentric => pairs(&[-0.04, 0.04], &[-0.04, 0.04]),
        }
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        match self {
            Term::Constant => chain.sensor_gain = values[0] + 1.0,
            Term::Eccentric => chain.eccentric = Some(Eccentric { cosine_rad: values[0], sine_rad: values[1] }),
        }
        if chain.link.peak_gravity_nm() > 0.0 {
            let hanging_rad = chain.link.hanging_rad();
            let [true_rad, _] = chain.read_back(T::nought(), hanging_rad, T::nought());
            chain.link = chain.link.turned(hanging_rad - true_rad);
        }
    }

    fn named(self, values: &[f64], _coulomb_nm: f64) -> Vec<f64> {
        match self {
            Term::Constant => values.to_vec(),
            Term::Eccentric => vec![math::hypot(values[0], values[1]), math::atan2(values[1], values[0])],
        }
    }

    fn searched(self, named: &[f64], _coulomb_nm: f64) -> Vec<f64> {
        match self {
            Term::Constant => named.to_vec(),
            Term::Eccentric => vec![named[0] * math::cos(named[1]), named[0] * math::sin(named[1])],
        }
    }
}

/// An encoder that is further off cannot be read back everywhere \[rad\].
const MOST_RAD: f64 = 0.3;

const ECCENTRIC: &[Named] = &[
    Named { name: "e", unit: "rad", zero: 0.0, bounds: Bounds::Within([0.0, 0.9]) },
    Named { name: "phi", unit: "rad", zero: 0.0, bounds: Bounds::ANGLE },
];
