//! Friction under motor load: it gains `mu_g |motor torque|`.
//!
//! Forms: the same whether the motor drives or brakes (both_ways); half as much where it brakes (driving); half as much
//! again where the teeth hardly slide, `1 + exp(-w/v_g)/2` times (falling); more than in proportion, `1 + |motor
//! torque|/tau_g` times (progressive); both of these (rising); with what the link's gravity presses on the teeth as well,
//! `|mu_g motor torque - mu_l gravity torque|` (directional); and with all of it, `|mu_g motor torque - mu_l gravity
//! torque| (1 + r exp(-w/v_g)) + mu_g (motor torque)^2/tau_g` (servo). The last two are those of Duclusaud, Passault, Padois
//! and Ly, "Extended Friction Models for the Physics Simulation of Servo Actuators" (2024).
//!
//! Teeth that transmit a torque rub in proportion to it, and the more the less their oil carries. Only a motor that is on
//! shows it: as friction that rises with the drive, and as a motor that pushes less than it brakes.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Contact, FrictionTerm, Real};
use crate::number::math;

#[derive(Clone, Copy)]
pub(super) enum Term {
    BothWays,
    Driving,
    Falling,
    Progressive,
    Rising,
    Directional,
    Servo,
}

const MU: Named = Named { name: "mu_g", unit: "", zero: 0.0, bounds: Bounds::NOT_NEGATIVE };
const MU_L: Named = Named { name: "mu_l", unit: "", zero: 0.0, bounds: Bounds::NOT_NEGATIVE };
const RISE: Named = Named { name: "r", unit: "", zero: 0.0, bounds: Bounds::NOT_NEGATIVE };
const SPEED: Named = Named { name: "v_g", unit: "rad/s", zero: 0.0, bounds: Bounds::POSITIVE };
const TORQUE: Named = Named { name: "tau_g", unit: "N m", zero: f64::INFINITY, bounds: Bounds::POSITIVE };

impl Term {
    fn falls(self) -> bool {
        matches!(self, Term::Falling | Term::Rising | Term::Servo)
    }

    fn is_progressive(self) -> bool {
        matches!(self, Term::Progressive | Term::Rising | Term::Servo)
    }

    fn feels_the_link(self) -> bool {
        matches!(self, Term::Directional | Term::Servo)
    }

    /// Speed and torque at which it changes, for a joint that reaches so far.
    fn typical(reach: &Reach) -> [f64; 2] {
        let torque_nm = reach.driven.map_or(reach.torque_nm, |driven| driven.command_nm);
        [SLOW * reach.speed_rad_s, torque_nm]
    }
}

/// Share of a joint's largest speed below which teeth hardly slide.
const SLOW: f64 = 0.1;
/// Relative standard deviation of what is believed of a speed or torque at which friction changes.
const ROUGHLY: f64 = 1.0;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[
        (Term::BothWays, "both_ways"),
        (Term::Driving, "driving"),
        (Term::Falling, "falling"),
        (Term::Progressive, "progressive"),
        (Term::Rising, "rising"),
        (Term::Directional, "directional"),
        (Term::Servo, "servo"),
    ];
    const NAMED: &'static [Named] = &[MU];

    fn named_parameters(self) -> &'static [Named] {
        match self {
            Term::BothWays | Term::Driving => Self::NAMED,
            Term::Falling => &[MU, SPEED],
            Term::Progressive => &[MU, TORQUE],
            Term::Rising => &[MU, SPEED, TORQUE],
            Term::Directional => &[MU, MU_L],
            Term::Servo => &[MU, MU_L, RISE, SPEED, TORQUE],
        }
    }

    fn near_default(self, values: &[f64], reach: &Reach) -> Vec<f64> {
        let [speed_rad_s, torque_nm] = Self::typical(reach);
        let less = if self.is_progressive() || self.feels_the_link() { LESS } else { 1.0 };
        let mut near = vec![less * values[0]];
        near.extend(self.feels_the_link().then_some((1.0 - LESS) * values[0]));
        near.extend(matches!(self, Term::Servo).then_some(WHEN_SLOW));
        near.extend(self.falls().then_some(speed_rad_s));
        near.extend(self.is_progressive().then_some(torque_nm));
        near
    }

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let [speed_rad_s, torque_nm] = Self::typical(reach);
        let mut all = vec![EffectParameter::linear("mu_g", "", [0.0, 0.9], 0.1)];
        if self.feels_the_link() {
            all.push(EffectParameter::linear("mu_l", "", [0.0, 0.9], 0.1));
        }
        if matches!(self, Term::Servo) {
            all.push(EffectParameter::linear("r", "", [0.0, 5.0], 0.5).likely(WHEN_SLOW, WHEN_SLOW));
        }
        if self.falls() {
            let range = [0.02 * speed_rad_s, 4.0 * speed_rad_s];
            all.push(EffectParameter::logarithm("v_g", "rad/s", range).likely(speed_rad_s, ROUGHLY));
        }
        if self.is_progressive() {
            let range = [0.1 * torque_nm, 30.0 * torque_nm];
            all.push(EffectParameter::logarithm("tau_g", "N m", range).likely(2.0 * torque_nm, ROUGHLY));
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
        let mut rest = values[1..].iter().copied();
        let mut next_if = |there: bool| if there { rest.next() } else { None };
        let of_link = next_if(self.feels_the_link());
        let rise = next_if(matches!(self, Term::Servo));
        let slow_rad_s = next_if(self.falls());
        let more_nm = next_if(self.is_progressive());
        chain.friction.terms.push(Box::new(GearTerm {
            mu_g: values[0],
            of_link,
            slow: slow_rad_s.map(|slow| (rise.unwrap_or(T::constant(WHEN_SLOW)), slow)),
            more_nm,
            form: self,
            holding_nm: chain.link.peak_gravity_nm(),
        }));
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
    /// `mu_l`, where the link presses on the teeth too.
    of_link: Option<T>,
    /// What is added where the teeth hardly slide, and the speed up to which they do \[rad/s\].
    slow: Option<(T, T)>,
    more_nm: Option<T>,
    form: Term,
    /// A torque that the motor has to hold \[N m\].
    holding_nm: f64,
}

impl<T: Real> FrictionTerm<T> for GearTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        let size = |x: T| if x.re() < 0.0 { -x } else { x };
        let load_nm = size(at.motor_nm);
        let driving = at.motor_nm.re() * at.direction > 0.0;
        let mut share = T::constant(if matches!(self.form, Term::Driving) && !driving { WHEN_DRIVEN } else { 1.0 });
        if let Some((rise, slow_rad_s)) = self.slow {
            // A step may look a little beyond the turning point.
            let speed_rad_s = if at.speed_rad_s.re() < 0.0 { T::nought() } else { at.speed_rad_s };
            share += (-(speed_rad_s / slow_rad_s)).exp() * rise;
        }
        if let Some(mu_l) = self.of_link {
            let pressed_nm = size(self.mu_g * at.motor_nm - mu_l * at.gravity_nm) * share;
            return self.more_nm.map_or(pressed_nm, |more_nm| pressed_nm + self.mu_g * load_nm * load_nm / more_nm);
        }
        if let Some(more_nm) = self.more_nm {
            share *= load_nm / more_nm + 1.0;
        }
        self.mu_g * load_nm * share
    }

    fn slope_nm_s_rad(&self, speed_rad_s: f64, _t_s: f64) -> f64 {
        let Some((rise, slow_rad_s)) = self.slow.map(|(rise, slow)| (rise.re(), slow.re())) else { return 0.0 };
        let mu = self.mu_g.re() + self.of_link.map_or(0.0, |mu_l| mu_l.re());
        mu * self.holding_nm * rise / slow_rad_s * math::exp(-0.5 * speed_rad_s / slow_rad_s)
    }
}
