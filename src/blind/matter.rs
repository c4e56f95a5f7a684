//! Puts a cause into a joint, of a size that shows as it should.

use super::cause::{Cause, needs_motor, simulable};
use super::dice::{Dice, significant};
use super::joint::DIGITS;
use super::make::Draft;
use super::mechanism::{self, Mechanism, Scene, Typical};
use super::plan::{GRAVITY_M_S2, LogPlan};
use super::sim::{Machine, Trace};
use super::size::{Yardstick, coarse, rms_rad};
use super::truth::{FourNumbers, Nearest, TrueMechanism};
use crate::joint::{EffectId, Stage};

/// What every effect of the catalogue leaves of a mechanism outside it, over the noise: else the effect is the answer.
const LEAST_BEYOND: f64 = 1.5;

/// What is the matter, and how much it shows.
pub(super) struct Matter {
    pub machine: Machine,
    pub mechanisms: Vec<TrueMechanism>,
    pub nominal: FourNumbers,
    /// For wrong numbers: the one that accounts for most.
    pub number: Option<&'static str>,
    pub ratio: f64,
    pub left: f64,
    pub nearest: Option<Nearest>,
}

/// How much a cause is to show, as multiples of the noise.
struct Limits {
    /// Sizes that are sought.
    wanted: [f64; 2],
    /// Natural sizes that are taken.
    allowed: [f64; 2],
    /// Least that is left after recalibration.
    left: f64,
}

impl Limits {
    fn of(cause: Cause) -> Self {
        match cause {
            Cause::Outside(_) => Self { wanted: [5.0, 60.0], allowed: [4.0, 300.0], left: 2.0 },
            Cause::Two(..) => Self { wanted: [3.0, 40.0], allowed: [2.0, 300.0], left: 1.0 },
            _ => Self { wanted: [1.5, 40.0], allowed: [1.3, 300.0], left: 0.4 },
        }
    }
}

impl Draft {
    pub(super) fn matter(&self, cause: Cause, plain: Vec<Trace>, forced: bool, dice: &mut Dice) -> Option<Matter> {
        let noise_rad = self.joint.sensor.noise_rad();
        if let Cause::Nothing = cause {
            let (machine, nominal) = (self.plain.clone(), self.numbers());
            return Some(Matter {
                machine,
                mechanisms: vec![],
                nominal,
                number: None,
                ratio: 0.0,
                left: 0.0,
                nearest: None,
            });
        }
        if let Cause::Calibration = cause {
            return self.calibration(&plain, forced, dice);
        }
        let scene = Scene {
            joint: &self.joint,
            plans: &self.plans,
            typical: Typical::of(&self.plans, &plain),
            textbook: self.textbook,
        };
        let effect = |id: EffectId, dice: &mut Dice| (id.id(), id.stage(), mechanism::effect(id, &scene, dice));
        let parts: Vec<(&'static str, Stage, Mechanism)> = match cause {
            Cause::One(id) => vec![effect(id, dice)],
            Cause::Two(first, second) => vec![effect(first, dice), effect(second, dice)],
            Cause::Outside(id) => vec![(id.id(), id.stage(), mechanism::outside(id, &scene, dice))],
            Cause::Nothing | Cause::Calibration => vec![],
        };
        let limits = Limits::of(cause);
        let yard = Yardstick::new(&self.plain, &self.plans, noise_rad);
        let mut sizes = Vec::with_capacity(parts.len());
        for (_, _, part) in &parts {
            let size = yard.size(part, &self.plain, limits.wanted, limits.allowed, dice);
            sizes.push(size.or(forced.then_some((part.range[0] * part.range[1]).sqrt()))?);
        }
        let with = |skip: Option<usize>| {
            let mut machine = self.plain.clone();
            let numbers: Vec<_> = parts
                .iter()
                .zip(&sizes)
                .enumerate()
                .filter(|(i, _)| Some(*i) != skip)
                .map(|(_, ((.., part), size))| part.install(*size, &mut machine))
                .collect();
            (machine, numbers)
        };
        let (machine, numbers) = with(None);
        let whole = coarse(&machine, &self.plans);
        let (ratio, left) = (yard.ratio(&whole, &yard.plain), yard.left(&whole, &yard.plain));
        let mut mechanisms = Vec::with_capacity(parts.len());
        for (i, ((id, stage, _), parameters)) in parts.iter().zip(numbers).enumerate() {
            let (ratio, left) = if parts.len() == 1 {
                (ratio, left)
            } else {
                let without = coarse(&with(Some(i)).0, &self.plans);
                (yard.ratio(&whole, &without), yard.left(&whole, &without))
            };
            let shows = ratio >= limits.allowed[0] && left >= limits.left;
            if !shows && !forced {
                return None;
            }
            mechanisms.push(TrueMechanism { id, stage: *stage, parameters, ratio, left });
        }
        let nearest = match cause {
            Cause::Outside(_) => Some(self.nearest(&scene, &yard, &whole, dice)),
            _ => None,
        };
        if nearest.is_some_and(|nearest| nearest.left < LEAST_BEYOND) && !forced {
            return None;
        }
        Some(Matter { machine, mechanisms, nominal: self.believed(dice), number: None, ratio, left, nearest })
    }

    /// The effect of the catalogue that comes nearest to a motion: any mixture of two of its shapes at two sizes each.
    fn nearest(&self, scene: &Scene<'_>, yard: &Yardstick<'_>, whole: &[Trace], dice: &mut Dice) -> Nearest {
        let can_show = |effect: &EffectId| !needs_motor(*effect) || self.plans.iter().any(LogPlan::is_driven);
        let mut nearest = Nearest { effect: EffectId::Stribeck, left: f64::INFINITY };
        let scene = &Scene { textbook: true, ..*scene };
        for effect in simulable().into_iter().filter(can_show) {
            let mut shapes = Vec::with_capacity(4);
            for _ in 0..2 {
                shapes.extend(yard.shapes(&mechanism::effect(effect, scene, dice), &self.plain));
            }
            let left = yard.left_beside(whole, &yard.plain, &shapes);
            if left < nearest.left {
                nearest = Nearest { effect, left };
            }
        }
        nearest
    }

    /// One to four numbers are off by 8 to 40 %.
    fn calibration(&self, plain: &[Trace], forced: bool, dice: &mut Dice) -> Option<Matter> {
        let count = dice.whole(1, 4);
        let mut believed = self.numbers().list();
        let wrong = dice.some_of(count, 4);
        for &k in &wrong {
            believed[k] = significant(believed[k] * (1.0 + dice.sign() * dice.uniform(0.08, 0.4)), DIGITS);
        }
        let nominal = FourNumbers::of(believed);
        let rms = |numbers: FourNumbers| {
            let mut machine = self.plain.clone();
            machine.inertia_kg_m2 = numbers.inertia;
            machine.peak_gravity_nm = GRAVITY_M_S2 * numbers.moment;
            machine.friction.coulomb_nm = numbers.coulomb;
            machine.friction.viscous_nm_s_rad = numbers.viscous;
            rms_rad(&coarse(&machine, &self.plans), plain, &self.plans) / self.joint.sensor.noise_rad()
        };
        let ratio = rms(nominal);
        if !(ratio >= 2.0) && !forced {
            return None;
        }
        let alone = |k: usize| {
            let mut list = self.numbers().list();
            list[k] = believed[k];
            rms(FourNumbers::of(list))
        };
        let most = wrong.iter().map(|k| (*k, alone(*k))).max_by(|a, b| a.1.total_cmp(&b.1))?;
        let number = Some(FourNumbers::NAMES[most.0]);
        Some(Matter {
            machine: self.plain.clone(),
            mechanisms: vec![],
            nominal,
            number,
            ratio,
            left: 0.0,
            nearest: None,
        })
    }
}
