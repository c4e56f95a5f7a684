//! A one-sided stiff spring and damper, which does not pull, beyond `q_e` inside the swing range.
//!
//! A leg that touches its stop turns back early and loses energy there. Its cost is flat until the stop lies inside the
//! range, so it is scanned from both ends of it.

use super::{Bounds, Effect, EffectParameter, Named, Reach, Scan};
use crate::joint::{Chain, EndStop, Real};

pub(super) struct Term;

impl Effect for Term {
    const NAMED: &'static [Named] = &[
        Named { name: "q_e", unit: "rad", zero: f64::INFINITY, bounds: Bounds::ANGLE },
        Named { name: "side", unit: "", zero: 0.0, bounds: Bounds::Either([-1.0, 1.0]) },
        Named { name: "stiffness", unit: "N m/rad", zero: 0.0, bounds: Bounds::POSITIVE },
        Named { name: "damping", unit: "N m s/rad", zero: 0.0, bounds: Bounds::NOT_NEGATIVE },
    ];

    fn parameters(reach: &Reach) -> Vec<EffectParameter> {
        let [low, high] = reach.angle_rad;
        let per_rad = reach.torque_nm;
        let damping = (per_rad * reach.inertia_kg_m2).sqrt();
        let held = EffectParameter { name: "side", unit: "", lower: -1.0, upper: 1.0, scan: Scan::Held };
        vec![
            EffectParameter::linear("q_e", "rad", [low, high], 0.05 * (high - low)),
            held,
            EffectParameter::logarithm("stiffness", "N m/rad", [2.0 * per_rad, 3e4 * per_rad]),
            EffectParameter::linear("damping", "N m s/rad", [0.0, 200.0 * damping], damping),
        ]
    }

    fn starts(reach: &Reach) -> Vec<Vec<f64>> {
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
                places.iter().map(move |&(angle, side)| vec![angle, side, stiffness, damping])
            })
            .collect()
    }

    fn apply<T: Real>(values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.stop = Some(EndStop {
            angle_rad: values[0],
            side: values[1].re(),
            stiffness_nm_rad: values[2],
            damping_nm_s_rad: values[3],
        });
    }
}
