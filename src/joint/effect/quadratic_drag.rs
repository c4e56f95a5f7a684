//! Friction at high speed: it gains `c2 q'^2`.
//!
//! Air, grease that is churned, and eddies resist with the square of the speed. Large swings lose more than small ones,
//! and more than viscous friction explains.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Contact, FrictionTerm, Real};

pub(super) struct Term;

impl Effect for Term {
    const NAMED: &'static [Named] =
        &[Named { name: "c2", unit: "N m s^2/rad^2", zero: 0.0, bounds: Bounds::NOT_NEGATIVE }];

    fn parameters(reach: &Reach) -> Vec<EffectParameter> {
        let unit = reach.torque_nm / reach.speed_rad_s.powi(2);
        vec![EffectParameter::linear("c2", "N m s^2/rad^2", [0.0, 20.0 * unit], 0.1 * unit)]
    }

    fn starts(reach: &Reach) -> Vec<Vec<f64>> {
        let unit = reach.torque_nm / reach.speed_rad_s.powi(2);
        vec![vec![0.03 * unit], vec![0.2 * unit]]
    }

    fn apply<T: Real>(values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.friction.terms.push(Box::new(DragTerm { c2: values[0] }));
    }
}

struct DragTerm<T> {
    c2: T,
}

impl<T: Real> FrictionTerm<T> for DragTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        self.c2 * at.speed_rad_s * at.speed_rad_s
    }

    fn slope_nm_s_rad(&self, speed_rad_s: f64) -> f64 {
        2.0 * self.c2.re() * speed_rad_s
    }
}
