//! One effect that all joints have with one size: late setpoints of one bus, servos or encoders of one make.
//!
//! Alone along the motion of the others each joint shows little of it, or something else; the whole robot shows it on all. Every
//! effect that joints propose is put on all of them, and those that explain most beyond numbers to first order are fitted.

use super::bench::{Beginnings, Bench, Point, Slopes};
use super::noise::mean_square;
use super::numbers::found_robot;
use super::robot::{PlacedCause, placed_causes};
use super::settled::{Settled, each, settled_alike};
use crate::deadline::Deadline;
use crate::gap::clamped::{ClampedDiagnosis, ClampedSetup, Common};
use crate::gap::verdict::decide::leaves_something;
use crate::gap::{Diagnosis, Number};
use crate::joint::{EffectForm, EffectId, Named};
use crate::number::chance::HALF_95;
use crate::robot::description::FoundNumber;
use rayon::prelude::*;

/// To first order an effect has to close this share of what numbers leave beyond noise, and that has to be this share of noise.
const PROMISES: f64 = 0.5;
const WORTH_A_LOOK: f64 = 0.02;
/// What a cause of one joint closes has to be this share for one of all to be looked for beside it; of so many effects.
const BESIDE: f64 = 0.2;
const TRIED_BESIDE: usize = 2;
/// A robot that does not leave only noise of every joint has to leave this share of what joints' own answers do, in squares.
const MUCH_BETTER: f64 = 0.5;
/// So many effects are fitted, and of each are so many of the joints' sizes looked at.
const FITTED: usize = 2;
const OF_AN_EFFECT: usize = 4;
/// So many joints have to show it: without it on them the robot leaves this many times as much, in squares of noise.
const SHOWN_BY: usize = 2;
const SHOWS: f64 = 1.05;
/// Two sizes are one that differ by less than this share.
const SAME: f64 = 0.1;
/// A size may be off by this share of it.
const SPREAD: f64 = 0.5;

/// What is left out where this is not looked for.
const IN_COMMON: &str = "one cause on all joints";

impl Common {
    /// The last of a robot's causes, which all joints have.
    fn of(form: EffectForm, whole: &Settled) -> Option<Self> {
        let last = whole.causes.last()?;
        let values = last.values.iter().zip(&last.spreads).zip(form.named_parameters());
        let parameters = values.map(|((value, sd), named)| {
            let interval = Some(named.bounds.clip([-HALF_95, HALF_95].map(|side| value + side * sd)));
            let (name, unit) = (named.name.to_owned(), named.unit.to_owned());
            Number { name, value: *value, unit, interval, interval_naive: interval }
        });
        Some(Self { form, parameters: parameters.collect() })
    }
}

/// The effect with which on all joints, alone or beside one cause of one joint, the whole robot leaves only noise of every
/// one and least of all, if there is one, and that robot.
pub(super) fn in_common(
    setup: &ClampedSetup,
    diagnosis: &ClampedDiagnosis,
    allows: &dyn Fn(EffectId) -> bool,
    deadline: &Deadline,
) -> Option<(Common, Settled)> {
    let found: Vec<&Diagnosis> = diagnosis.found().collect();
    if found.len() < 2 || deadline.leaves_out(IN_COMMON) {
        return None;
    }
    let stated = found_robot(setup, None).ok()?.numbers;
    let alone = Look::of(setup, &found, &stated, Vec::new())?;
    let of_all = alone.best(diagnosis, &found, allows, deadline);
    if of_all.as_ref().is_some_and(|(_, whole)| explains(whole, diagnosis)) {
        return of_all;
    }
    let own = placed_causes(diagnosis).into_par_iter().filter(|cause| !cause.form.id.parts_two_bodies());
    let closing = |cause: PlacedCause| {
        let closes = (!deadline.leaves_out(IN_COMMON)).then(|| alone.closes(std::slice::from_ref(&cause)));
        Some((closes??.1, cause))
    };
    let mut seen: Vec<(f64, PlacedCause)> = own.filter_map(closing).filter(|(closes, _)| *closes > BESIDE).collect();
    seen.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut tried: Vec<EffectId> = Vec::new();
    let beside = seen.into_iter().find_map(|(_, cause)| {
        let effect = cause.form.id;
        if tried.len() == TRIED_BESIDE || tried.contains(&effect) || deadline.leaves_out(IN_COMMON) {
            return None;
        }
        tried.push(effect);
        let both = Look::of(setup, &found, &stated, vec![cause])?.best(diagnosis, &found, allows, deadline);
        both.filter(|(_, whole)| explains(whole, diagnosis))
    });
    beside.or(of_all)
}

/// Whether a robot leaves only noise of every joint.
pub(super) fn explains(whole: &Settled, diagnosis: &ClampedDiagnosis) -> bool {
    let is_noise =
        |own: &Diagnosis| whole.left_rad(&own.joint).is_none_or(|left_rad| !leaves_something(left_rad, own.gap.floor));
    diagnosis.found().all(|own| !whole.is_seen_elsewhere(&own.joint) && is_noise(own))
}

/// What a robot leaves of its joints, in squares of their noise.
pub(super) fn misfit(whole: &Settled, found: &[&Diagnosis]) -> f64 {
    found.iter().map(|own| share_of(whole, own)).sum()
}

/// The same of what joints' own answers leave.
fn misfit_alone(found: &[&Diagnosis]) -> f64 {
    found.iter().map(|own| (own.gap.after / own.gap.floor).powi(2)).sum()
}

/// What a robot leaves of a joint, in squares of its noise.
fn share_of(whole: &Settled, own: &Diagnosis) -> f64 {
    whole.left_rad(&own.joint).map_or(0.0, |left_rad| (left_rad / own.gap.floor).powi(2))
}

/// The robot as stated, with what one of its joints has, made linear.
struct Look<'a> {
    setup: &'a ClampedSetup,
    stated: &'a [FoundNumber],
    beside: Vec<PlacedCause>,
    here: Point,
    slopes: Slopes,
    /// The noise of each row \[rad^2\].
    noise_rad2: Vec<f64>,
    /// What numbers leave beyond it.
    excess: f64,
}

impl<'a> Look<'a> {
    /// `None` where the robot cannot be simulated, or numbers leave hardly more than noise.
    fn of(
        setup: &'a ClampedSetup,
        found: &[&Diagnosis],
        stated: &'a [FoundNumber],
        beside: Vec<PlacedCause>,
    ) -> Option<Self> {
        let bench = Bench::new(setup, stated, &beside, each(beside.len()))?;
        let here = bench.stated(None)?;
        let slopes = bench.slopes(&here, bench.sides(&here))?;
        let joints = bench.logs.iter().flat_map(|log| &log.joints).zip(&here.left);
        // A joint that never moves says nothing.
        let noise_rad2: Vec<f64> = joints
            .map(|(joint, left)| {
                let own = found.iter().find(|own| own.joint == joint.name);
                own.map_or(f64::INFINITY, |own| own.gap.floor.powi(2)).min(mean_square(left)).max(f64::MIN_POSITIVE)
            })
            .collect();
        let rows = here.left.iter().zip(&slopes.weights).zip(&noise_rad2);
        let noise: f64 = rows.map(|((left, weight), noise)| weight * left.len() as f64 * noise).sum();
        let excess = slopes.left(&here) - noise;
        (excess > WORTH_A_LOOK * noise).then_some(Self { setup, stated, beside, here, slopes, noise_rad2, excess })
    }

    /// How many times as large causes are best, to first order, and the share of what numbers leave beyond noise that they close.
    fn closes(&self, causes: &[PlacedCause]) -> Option<(f64, f64)> {
        let all = [&self.beside[..], causes].concat();
        let there = Bench::new(self.setup, self.stated, &all, Vec::new())?.stated(Some(&self.here.from))?;
        let rows = self.here.left.iter().zip(&there.left);
        let change: Vec<Vec<f64>> = rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect()).collect();
        let (times, saved) = self.slopes.saved(&self.here, &change);
        Some((times, saved / self.excess))
    }

    /// The effect with which on all joints the robot leaves only noise of every one and least of all, with that robot.
    fn best(
        &self,
        diagnosis: &ClampedDiagnosis,
        found: &[&Diagnosis],
        allows: &dyn Fn(EffectId) -> bool,
        deadline: &Deadline,
    ) -> Option<(Common, Settled)> {
        let joints: Vec<&str> = found.iter().map(|own| own.joint.as_str()).collect();
        let is_other = |effect: EffectId| allows(effect) && self.beside.iter().all(|cause| cause.form.id != effect);
        let look = |(form, mut values): (EffectForm, Vec<f64>)| {
            if deadline.leaves_out(IN_COMMON) {
                return None;
            }
            let (times, closes) = self.closes(&placed(&joints, form, &values))?;
            // What has one size has it to first order; of limits the larger is the lesser.
            if let ([size], [named @ Named { zero: 0.0, .. }]) = (&mut values[..], form.named_parameters()) {
                *size = Some(times * *size).filter(|size| named.bounds.admit(*size)).unwrap_or(*size);
            }
            (closes > PROMISES).then(|| (closes, placed(&joints, form, &values)))
        };
        let mut promising: Vec<(f64, Vec<PlacedCause>)> =
            proposals(found, &is_other).into_par_iter().filter_map(look).collect();
        promising.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut fitted: Vec<(EffectForm, Settled)> = Vec::new();
        for (_, causes) in promising {
            let form = causes[0].form;
            let is_new = !fitted.iter().any(|(other, _)| *other == form);
            if fitted.len() < FITTED && is_new && !deadline.leaves_out(IN_COMMON) {
                let whole = self.settled(self.stated, &self.beside, causes, deadline);
                fitted.extend(whole.map(|whole| (form, whole)));
            }
        }
        let misfit_of = |(_, whole): &(EffectForm, Settled)| misfit(whole, found);
        let (form, mut whole) = fitted.into_iter().min_by(|a, b| misfit_of(a).total_cmp(&misfit_of(b)))?;
        if self.beside.is_empty() && !explains(&whole, diagnosis) {
            let with_own = self.with_own(&whole, found, placed_causes(diagnosis), deadline);
            whole = with_own.filter(|better| explains(better, diagnosis)).unwrap_or(whole);
        }
        // What is left where joints stick is for their own reports, as long as it is little.
        if !explains(&whole, diagnosis) && misfit(&whole, found) > MUCH_BETTER * misfit_alone(found) {
            return None;
        }
        (self.shown_by(&whole, form, &joints) >= SHOWN_BY).then_some((Common::of(form, &whole)?, whole))
    }

    /// How many joints show the effect: without it on them the robot is worse. A limit does nothing where it is never reached.
    fn shown_by(&self, whole: &Settled, form: EffectForm, joints: &[&str]) -> usize {
        let with = |causes: &[PlacedCause], from: Option<&Beginnings>| {
            Bench::new(self.setup, &whole.numbers, causes, Vec::new())?.with(&whole.numbers, from)
        };
        let in_noise = |point: Point| -> f64 {
            let rows = self.noise_rad2.iter().zip(&point.left);
            rows.map(|(noise, left)| mean_square(left) / noise).sum()
        };
        let Some(all) = with(&whole.causes, None) else { return 0 };
        let (from, with_all) = (all.from.clone(), in_noise(all));
        let shows = |joint: &&&str| {
            let others = whole.causes.iter().filter(|cause| cause.form != form || cause.joint != **joint);
            let without = with(&others.cloned().collect::<Vec<_>>(), Some(&from));
            without.is_none_or(|without| in_noise(without) > SHOWS * with_all)
        };
        joints.par_iter().filter(shows).count()
    }

    /// The robot at its best with causes of single joints and others that have one size.
    fn settled(
        &self,
        numbers: &[FoundNumber],
        own: &[PlacedCause],
        common: Vec<PlacedCause>,
        deadline: &Deadline,
    ) -> Option<Settled> {
        let mut alike = each(own.len());
        alike.push((own.len()..own.len() + common.len()).collect());
        settled_alike(self.setup, numbers, &[own, &common].concat(), alike, deadline)
    }

    /// The robot at its best with one of the causes that were found on the joint of which most is left, in squares of its noise.
    fn with_own(
        &self,
        whole: &Settled,
        found: &[&Diagnosis],
        causes: Vec<PlacedCause>,
        deadline: &Deadline,
    ) -> Option<Settled> {
        let worst = found.iter().max_by(|a, b| share_of(whole, a).total_cmp(&share_of(whole, b)))?;
        let is_own = |cause: &PlacedCause| cause.joint == worst.joint && cause.form.id != whole.causes[0].form.id;
        let tried = causes.into_iter().filter(is_own).filter_map(|cause| {
            let spreads = whole.causes[0].values.iter().map(|value| SPREAD * value.abs());
            let spreads: Vec<f64> = spreads.collect();
            let common = whole.causes.iter().map(|cause| PlacedCause { spreads: spreads.clone(), ..cause.clone() });
            self.settled(&whole.numbers, &[cause], common.collect(), deadline)
        });
        tried.min_by(|a, b| misfit(a, found).total_cmp(&misfit(b, found)))
    }
}

/// Effects that any joint's logs speak for, with the sizes that these ask for.
fn proposals(found: &[&Diagnosis], allows: &dyn Fn(EffectId) -> bool) -> Vec<(EffectForm, Vec<f64>)> {
    // Stops and springs have their place on each joint, free play hunts, and a gain is a number.
    let may_be_common = |effect: EffectId| {
        let is_of_one = matches!(effect, EffectId::EndStop | EffectId::JointSpring | EffectId::MotorGain);
        !is_of_one && effect.is_known_to_robots() && !effect.parts_two_bodies() && allows(effect)
    };
    let causes = found.iter().flat_map(|own| &own.causes).filter(|cause| cause.only.is_none()).map(|cause| {
        let form = EffectForm::named_so(cause.effect, Some(cause.form).filter(|form| !form.is_empty()));
        (form.unwrap_or(cause.effect.into()), &cause.parameters)
    });
    let singles = found.iter().flat_map(|own| &own.ranking).map(|one| (EffectForm::from(one.effect), &one.parameters));
    let mut all: Vec<(EffectForm, Vec<f64>)> = Vec::new();
    let both = causes.chain(singles).flat_map(|(form, parameters)| {
        let values: Vec<f64> = parameters.iter().map(|number| number.value).collect();
        // Beside numbers that were bent a size may be found on the wrong side of none.
        let mirrored = values.iter().enumerate().map(|(k, value)| if k == 0 { -value } else { *value }).collect();
        [(form, values), (form, mirrored)]
    });
    for (form, values) in both {
        let named = form.named_parameters();
        let is_whole =
            values.len() == named.len() && named.iter().zip(&values).all(|(n, value)| n.bounds.admit(*value));
        let alike =
            |other: &[f64]| other.iter().zip(&values).all(|(a, b)| (a - b).abs() <= SAME * a.abs().max(b.abs()));
        let known = all.iter().filter(|(other, _)| *other == form);
        let is_new = known.clone().count() < OF_AN_EFFECT && !known.into_iter().any(|(_, other)| alike(other));
        if is_whole && is_new && may_be_common(form.id) {
            all.push((form, values));
        }
    }
    all
}

/// A cause on joints.
fn placed(joints: &[&str], form: EffectForm, values: &[f64]) -> Vec<PlacedCause> {
    let spreads: Vec<f64> = values.iter().map(|value| SPREAD * value.abs()).collect();
    let on = |joint: &&str| PlacedCause {
        joint: (*joint).to_owned(),
        form,
        values: values.to_vec(),
        spreads: spreads.clone(),
    };
    joints.iter().map(on).collect()
}
