//! Friction under motor load: it gains `mu_g |motor torque|`.
//!
//! Forms: the same whether the motor drives or brakes (both_ways), or half as much where it brakes (driving).
//!
//! Teeth that transmit a torque rub in proportion to it. Only a motor that is on shows it: as friction that rises with the
//! drive, and as a motor that pushes less than it brakes.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Contact, FrictionTerm, Real};

#[derive(Clone, Copy)]
pub(super) enum Term {
    BothWays,
    Driving,
}

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term::BothWays, "both_ways"), (Term::Driving, "driving")];
    const NAMED: &'static [Named] = &[Named { name: "mu_g", unit: "", zero: 0.0, bounds: Bounds::NOT_NEGATIVE }];

    fn parameters(self, _reach: &Reach) -> Vec<EffectParameter> {
        vec![EffectParameter::linear("mu_g", "", [0.0, 0.9], 0.1)]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        if reach.driven.is_some() { vec![vec![0.03], vec![0.1], vec![0.3]] } else { Vec::new() }
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.friction.terms.push(Box::new(GearTerm { mu_g: values[0], driven: self }));
    }
}

/// Share of the friction that is left where the link drives the motor.
const WHEN_DRIVEN: f64 = 0.5;

struct GearTerm<T> {
    mu_g: T,
    driven: Term,
}

impl<T: Real> FrictionTerm<T> for GearTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        let load_nm = if at.motor_nm.re() < 0.0 { -at.motor_nm } else { at.motor_nm };
        let driving = at.motor_nm.re() * at.direction > 0.0;
        let share = if matches!(self.driven, Term::Driving) && !driving { WHEN_DRIVEN } else { 1.0 };
        self.mu_g * load_nm * share
    }

    fn slope_nm_s_rad(&self, _speed_rad_s: f64) -> f64 {
        0.0
    }
}
