//! Puts a cause into a joint, of a size that shows as it should.

use super::belief::{Belief, Errors, WRONG_SD};
use super::cause::{Cause, OutsideId, needs_motor};
use super::dice::Dice;
use super::make::Draft;
use super::mechanism::servo::{self, Part};
use super::mechanism::{self, Scene, Typical};
use super::plan::LogPlan;
use super::sim::{Machine, Trace};
use super::size::{Yardstick, coarse, rms_rad};
use super::together::{Limits, Together};
use super::truth::{FourNumbers, Gains, Nearest, TrueMechanism, TrueWhere};
use crate::gap::Verdict;
use crate::joint::EffectId;
use crate::number::STANDARD_GRAVITY_M_S2;

/// What every effect of the catalogue leaves of a mechanism outside it, over the noise: else the effect is the answer.
const LEAST_BEYOND: f64 = 1.5;
/// Wrong numbers change the logs by so many times the noise.
const LEAST_WRONG: f64 = 2.0;
/// A servo has at least so many parts that show.
const LEAST_PARTS: usize = 2;

/// What is the matter, and how much it shows.
pub(super) struct Matter {
    pub verdict: Verdict,
    pub machine: Machine,
    pub mechanisms: Vec<TrueMechanism>,
    pub causes: Vec<EffectId>,
    pub belief: Belief,
    /// Wrong numbers; without effects the one that accounts for most first.
    pub numbers: Vec<&'static str>,
    pub within: bool,
    pub ratio: f64,
    pub left: f64,
    pub nearest: Option<Nearest>,
    pub location: Option<TrueWhere>,
}

impl Draft {
    /// What is the matter in a study of this cause; `None` where it would not show, unless it is `forced`.
    pub(super) fn matter(
        &self,
        cause: &Cause,
        plain: Vec<Trace>,
        noise_rad: f64,
        forced: bool,
        dice: &mut Dice,
    ) -> Option<Matter> {
        let errors = match cause {
            Cause::Nothing => return self.numbers_only(Errors::Within, &plain, noise_rad, dice),
            Cause::Calibration => {
                let matter = self.numbers_only(Errors::Wrong, &plain, noise_rad, dice)?;
                return (matter.verdict == Verdict::Calibration || forced).then_some(matter);
            }
            Cause::Effects(_) | Cause::Servo | Cause::Outside(_) => Errors::Mixed,
        };
        let scene = Scene {
            joint: &self.joint,
            plans: &self.plans,
            typical: Typical::of(&self.plans, &plain),
            textbook: self.textbook,
        };
        let parts: Vec<Part> = match cause {
            Cause::Nothing | Cause::Calibration => vec![],
            Cause::Effects(effects) => effects.iter().map(|id| Part::of(*id, &scene, dice)).collect(),
            Cause::Servo => servo::parts(&scene, self.back_emf_nm_s_rad, dice),
            Cause::Outside(id) => {
                let mechanism = mechanism::outside(*id, &scene, dice);
                vec![Part { id: id.id(), effect: None, stage: id.stage(), mechanism }]
            }
        };
        let yard = Yardstick::new(&self.plain, &self.plans, noise_rad);
        let together = Together::new(&parts, Limits::of(cause), &yard, &self.plain, forced, dice)?;
        let shown: Vec<&TrueMechanism> = together.mechanisms.iter().filter(|m| m.counts).collect();
        let enough = if *cause == Cause::Servo { LEAST_PARTS } else { parts.len() };
        if shown.len() < enough && !forced {
            return None;
        }
        let shows = |part: &&Part| shown.iter().any(|mechanism| mechanism.id == part.id);
        let causes: Vec<EffectId> = parts.iter().filter(shows).filter_map(|part| part.effect).collect();
        let (mut nearest, mut location) = (None, None);
        if let Cause::Outside(id) = cause {
            let found = self.nearest(&scene, &yard, &together.whole, dice);
            if found.left < LEAST_BEYOND && !forced {
                return None;
            }
            nearest = Some(found);
            location = Some(located(*id, &parts));
        }
        let belief = self.belief(cause, errors, dice);
        let off = belief.off_sd(&self.numbers(), self.gains());
        Some(Matter {
            verdict: if nearest.is_some() { Verdict::Unexplained } else { Verdict::Effect },
            ratio: yard.ratio(&together.whole, &yard.plain),
            left: yard.left(&together.whole, &yard.plain),
            machine: together.machine,
            mechanisms: together.mechanisms,
            causes,
            belief,
            numbers: off.iter().filter(|(_, sd)| *sd > WRONG_SD).map(|(name, _)| *name).collect(),
            within: false,
            nearest,
            location,
        })
    }

    fn belief(&self, cause: &Cause, errors: Errors, dice: &mut Dice) -> Belief {
        let driven = self.plans.iter().any(LogPlan::is_driven);
        let mut known = self.gains();
        // who reads the firmware knows the gain that the motor's voltage does not add to
        if *cause == Cause::Servo && dice.chance(0.5) {
            known.kd = self.joint.kd;
        }
        Belief::draw(&self.numbers(), known, driven, errors, dice)
    }

    /// The effect of the catalogue that comes nearest to a motion: any mixture of two of its shapes at two sizes each.
    fn nearest(&self, scene: &Scene<'_>, yard: &Yardstick<'_>, whole: &[Trace], dice: &mut Dice) -> Nearest {
        let can_show = |effect: &EffectId| !needs_motor(*effect) || self.plans.iter().any(LogPlan::is_driven);
        let mut nearest = Nearest { effect: EffectId::Stribeck, left: f64::INFINITY };
        let scene = &Scene { textbook: true, ..*scene };
        for effect in EffectId::ALL.iter().copied().filter(can_show) {
            let mut shapes = Vec::with_capacity(4);
            for _ in 0..2 {
                shapes.extend(yard.shapes(&mechanism::effect(effect, scene, dice), &self.plain));
            }
            let left = yard.left_beside(whole, &yard.plain, &shapes);
            if left < nearest.left {
                nearest = Nearest { effect, left };
            }
            // nobody asks which of those that imitate it does so best
            if nearest.left < LEAST_BEYOND {
                break;
            }
        }
        nearest
    }

    /// Nothing but numbers that are off; whether that is wrong depends on how sure the study is, and whether it shows.
    fn numbers_only(&self, errors: Errors, plain: &[Trace], noise_rad: f64, dice: &mut Dice) -> Option<Matter> {
        let belief = self.belief(&Cause::Nothing, errors, dice);
        let (numbers, gains) = (self.numbers(), self.gains());
        let rms = |numbers: FourNumbers, gains: Gains| {
            let mut machine = self.plain.clone();
            machine.inertia_kg_m2 = numbers.inertia;
            machine.peak_gravity_nm = STANDARD_GRAVITY_M_S2 * numbers.moment;
            machine.friction.coulomb_nm = numbers.coulomb;
            machine.friction.viscous_nm_s_rad = numbers.viscous;
            (machine.drive.kp, machine.drive.kd) = (gains.kp, gains.kd);
            rms_rad(&coarse(&machine, &self.plans), plain, &self.plans) / noise_rad
        };
        let alone = |name: &str| {
            let (mut list, mut pair) = (numbers.list(), gains.list());
            if let Some(k) = FourNumbers::NAMES.iter().position(|known| *known == name) {
                list[k] = belief.nominal.list()[k];
            } else if let Some(k) = Gains::NAMES.iter().position(|known| *known == name) {
                pair[k] = belief.gains.list()[k];
            }
            rms(FourNumbers::of(list), Gains { kp: pair[0], kd: pair[1] })
        };
        let off = belief.off_sd(&numbers, gains);
        let mut wrong: Vec<(&'static str, f64)> =
            off.iter().filter(|(_, sd)| *sd > WRONG_SD).map(|(name, _)| (*name, alone(name))).collect();
        wrong.sort_by(|a, b| b.1.total_cmp(&a.1));
        let ratio = if off.is_empty() { 0.0 } else { rms(belief.nominal, belief.gains) };
        let shows = ratio >= LEAST_WRONG && wrong.first().is_some_and(|(_, alone)| *alone >= LEAST_WRONG);
        Some(Matter {
            verdict: if shows { Verdict::Calibration } else { Verdict::None },
            machine: self.plain.clone(),
            mechanisms: vec![],
            causes: vec![],
            numbers: if shows { wrong.into_iter().map(|(name, _)| name).collect() } else { vec![] },
            within: !shows && !off.is_empty(),
            belief,
            ratio: if ratio.is_finite() { ratio } else { return None },
            left: 0.0,
            nearest: None,
            location: None,
        })
    }
}

fn located(id: OutsideId, parts: &[Part]) -> TrueWhere {
    let range = parts.first().and_then(|part| part.mechanism.place);
    TrueWhere { stage: id.stage(), variables: id.variables(), range }
}
