//! Friction under motor load: it gains `mu_g |motor torque|`.
//!
//! Forms: the same whether the motor drives or brakes (both_ways); half as much where it brakes (driving); half as much
//! again where the teeth hardly slide, `1 + exp(-w/v_g)/2` times (falling); more than in proportion, `1 + |motor
//! torque|/tau_g` times (progressive); and both of these (rising).
//!
//! Teeth that transmit a torque rub in proportion to it, and the more the less their oil carries. Only a motor that is on
//! shows it: as friction that rises with the drive, and as a motor that pushes less than it brakes.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Contact, FrictionTerm, Real};

#[derive(Clone, Copy)]
pub(super) enum Term {
    BothWays,
    Driving,
    Falling,
    Progressive,
    Rising,
}

const MU: Named = Named { name: "mu_g", unit: "", zero: 0.0, bounds: Bounds::NOT_NEGATIVE };
const SPEED: Named = Named { name: "v_g", unit: "rad/s", zero: 0.0, bounds: Bounds::POSITIVE };
const TORQUE: Named = Named { name: "tau_g", unit: "N m", zero: f64::INFINITY, bounds: Bounds::POSITIVE };

impl Term {
    fn falls(self) -> bool {
        matches!(self, Term::Falling | Term::Rising)
    }

    fn is_progressive(self) -> bool {
        matches!(self, Term::Progressive | Term::Rising)
    }

    /// Speed and torque at which it changes, for a joint that reaches so far.
    fn typical(reach: &Reach) -> [f64; 2] {
        let torque_nm = reach.driven.map_or(reach.torque_nm, |driven| driven.command_nm);
        [SLOW * reach.speed_rad_s, torque_nm]
    }
}

/// Share of a joint's largest speed below which teeth hardly slide.
const SLOW: f64 = 0.02;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[
        (Term::BothWays, "both_ways"),
        (Term::Driving, "driving"),
        (Term::Falling, "falling"),
        (Term::Progressive, "progressive"),
        (Term::Rising, "rising"),
    ];
    const NAMED: &'static [Named] = &[MU];

    fn named_parameters(self) -> &'static [Named] {
        match self {
            Term::BothWays | Term::Driving => Self::NAMED,
            Term::Falling => &[MU, SPEED],
            Term::Progressive => &[MU, TORQUE],
            Term::Rising => &[MU, SPEED, TORQUE],
        }
    }

    fn near_default(self, values: &[f64], reach: &Reach) -> Vec<f64> {
        let [speed_rad_s, torque_nm] = Self::typical(reach);
        let mut near = vec![if self.is_progressive() { LESS * values[0] } else { values[0] }];
        near.extend(self.falls().then_some(speed_rad_s));
        near.extend(self.is_progressive().then_some(torque_nm));
        near
    }

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let [speed_rad_s, torque_nm] = Self::typical(reach);
        let mut all = vec![EffectParameter::linear("mu_g", "", [0.0, 0.9], 0.1)];
        if self.falls() {
            all.push(EffectParameter::logarithm("v_g", "rad/s", [0.05 * speed_rad_s, 20.0 * speed_rad_s]));
        }
        if self.is_progressive() {
            all.push(EffectParameter::logarithm("tau_g", "N m", [0.1 * torque_nm, 30.0 * torque_nm]));
        }
        all
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        if reach.driven.is_none() {
            return Vec::new();
        }
        [0.03, 0.1, 0.3].map(|mu_g| self.near_default(&[mu_g], reach)).to_vec()
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        let slow_rad_s = if self.falls() { values.get(1).copied() } else { None };
        let more_nm = if self.is_progressive() { values.last().copied() } else { None };
        let is_driving = matches!(self, Term::Driving);
        let holding_nm = chain.link.peak_gravity_nm();
        let term = GearTerm { mu_g: values[0], is_driving, slow_rad_s, more_nm, holding_nm };
        chain.friction.terms.push(Box::new(term));
    }
}

/// Share of the friction that is left where the link drives the motor.
const WHEN_DRIVEN: f64 = 0.5;
/// What is added to it where the teeth hardly slide.
const WHEN_SLOW: f64 = 0.5;
/// Share of a friction in proportion that is left of one that grows by more.
const LESS: f64 = 0.7;

struct GearTerm<T> {
    mu_g: T,
    is_driving: bool,
    slow_rad_s: Option<T>,
    more_nm: Option<T>,
    /// A torque that the motor has to hold \[N m\].
    holding_nm: f64,
}

impl<T: Real> FrictionTerm<T> for GearTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        let load_nm = if at.motor_nm.re() < 0.0 { -at.motor_nm } else { at.motor_nm };
        let driving = at.motor_nm.re() * at.direction > 0.0;
        let mut share = T::constant(if self.is_driving && !driving { WHEN_DRIVEN } else { 1.0 });
        if let Some(slow_rad_s) = self.slow_rad_s {
            // A step may look a little beyond the turning point.
            let speed_rad_s = if at.speed_rad_s.re() < 0.0 { T::nought() } else { at.speed_rad_s };
            share *= (-(speed_rad_s / slow_rad_s)).exp() * WHEN_SLOW + 1.0;
        }
        if let Some(more_nm) = self.more_nm {
            share *= load_nm / more_nm + 1.0;
        }
        self.mu_g * load_nm * share
    }

    fn slope_nm_s_rad(&self, speed_rad_s: f64) -> f64 {
        let Some(slow_rad_s) = self.slow_rad_s.map(|slow| slow.re()) else { return 0.0 };
        let steepest = self.mu_g.re() * self.holding_nm * WHEN_SLOW / slow_rad_s;
        steepest * (-0.5 * speed_rad_s / slow_rad_s).exp()
    }
}
