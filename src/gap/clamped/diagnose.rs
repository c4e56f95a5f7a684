//! Every joint of a robot diagnosed, and what they have in common.

use super::answer::{JointAnswer, found_of};
use super::body::BodyCause;
use super::case::{ClampedCase, ClampedJoint};
use super::pooled::{PooledNumber, one_size, pooled};
use crate::deadline::{Deadline, Spent};
use crate::gap::diagnose::{Beside, diagnose_from};
use crate::gap::hypothesis::held_out::closed;
use crate::gap::verdict::as_given::AsGiven;
use crate::gap::verdict::notes::flattered;
use crate::gap::verdict::sentence::{REFITTED, number_words, words};
use crate::gap::{CauseShare, Diagnosis, Gap, GapError, GapOptions, Number, Verdict};
use crate::joint::EffectId;
use crate::number::{capital, mrad, newton_metres, quantity};
use crate::progress::{Progress, Step};
use crate::robot::description::{FoundKey, FoundNumber};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What was found on a robot.
#[derive(Clone, Debug, Serialize)]
pub struct ClampedDiagnosis {
    /// The robot's name.
    pub robot: String,
    /// In short.
    pub answer: ClampedAnswer,
    /// Over all joints that move.
    pub gap: ClampedGap,
    /// What is other than described about bodies, found over all joints that carry them.
    #[serde(skip)]
    pub bodies: Vec<BodyCause>,
    /// Numbers of the whole robot that all joints' motion asks for at once, within what is believed of them: masses, where that
    /// follows the logs better than masses as described, and all numbers of joints where they explain everything.
    pub weighed: Vec<FoundNumber>,
    /// Causes with all joints that have them, the one that closes most first.
    pub causes: Vec<SharedCause>,
    /// Numbers that groups of joints have elsewhere alike.
    pub pooled: Vec<PooledNumber>,
    /// In the description's order.
    pub joints: Vec<JointAnswer>,
    /// What the reader has to know beside it.
    pub notes: Vec<String>,
    /// What became of its time, where that was limited.
    pub budget: Option<Spent>,
}

/// The answer in short.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClampedAnswer {
    /// The gravest of the joints' verdicts: unexplained, effect, calibration, none.
    pub verdict: Verdict,
    /// The id of the cause that closes most; one of a body comes first.
    pub effect: Option<&'static str>,
    /// Of the one that closes most beside it.
    pub second: Option<&'static str>,
    /// Lowest measured rate at which answers like those of the joints were right; `None` where a search was not finished.
    pub probability: Option<f64>,
    /// What a colleague would say.
    pub sentence: String,
}

/// How far the gap closes: roots of the mean squares over all joints, each as much as the others, on held-out logs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClampedGap {
    /// `rad`, or `N m` where torques are predicted.
    pub unit: &'static str,
    /// As given.
    pub before: f64,
    /// With numbers refitted within their beliefs.
    pub calibrated: f64,
    /// With the causes that were found.
    pub after: f64,
    /// What the sensors leave.
    pub floor: f64,
    /// Share of the gap above the floor that is closed; `None` where there is none.
    pub closed: Option<f64>,
    /// Whether the figures come from logs on which no choice was made.
    pub outer: bool,
}

/// A cause with the joints that have it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SharedCause {
    /// Which family.
    pub effect: EffectId,
    /// Those that have it, in the description's order.
    pub joints: Vec<String>,
    /// The group of the study that they make up, or `all`.
    pub group: Option<String>,
    /// Its size on all of them as one number, where they agree.
    pub size: Option<Number>,
    /// Share of the robot's recalibrated squares that it closes where it is added.
    pub share: f64,
    /// Whether the whole robot tells it of all joints, with one size, and not each of them alone.
    pub common: bool,
}

/// Diagnoses a robot's joints, each along the measured motion of the others. `progress` is told what is being tried, and
/// how many joints are done.
///
/// # Errors
/// [`GapError`] where no joint can be diagnosed.
pub fn diagnose_clamped(
    case: &ClampedCase,
    options: &GapOptions,
    progress: &dyn Progress,
) -> Result<ClampedDiagnosis, GapError> {
    let joints = diagnose_joints(&case.joints.iter().collect::<Vec<_>>(), options, &[], progress)?;
    if joints.iter().all(|joint| joint.diagnosis.is_none()) {
        return Err(GapError::NeverMoved);
    }
    Ok(concluded_of(case, joints))
}

/// What the joints' answers come to where bodies are as described.
pub(in crate::gap) fn concluded_of(case: &ClampedCase, joints: Vec<JointAnswer>) -> ClampedDiagnosis {
    let mut notes = case.notes.clone();
    notes.push(
        "Each joint is simulated along the measured motion of the others: it answers for its own fault.".to_owned(),
    );
    concluded(&case.robot, &case.groups, joints, Vec::new(), None, notes)
}

/// Why a joint's own page has no effects.
const NEEDS_NO_CAUSE: &str = "The whole robot, simulated at once with numbers alone beside what was found of its bodies, leaves only \
                              noise of every joint: no cause was looked for on this one.";

/// Every one of some joints' own answer; those of `described` are what they were before a body was changed.
pub(in crate::gap) fn diagnose_joints(
    joints: &[&ClampedJoint],
    options: &GapOptions,
    described: &[JointAnswer],
    progress: &dyn Progress,
) -> Result<Vec<JointAnswer>, GapError> {
    let counted = Counted { progress, done: AtomicUsize::new(0), of: joints.len() };
    let begun = AtomicUsize::new(0);
    let of_joint = |joint: &&ClampedJoint| {
        let still = joints.len() - begun.fetch_add(1, Ordering::Relaxed);
        let own = GapOptions { deadline: options.deadline.part(still), ..options.clone() };
        let first = described.iter().find(|first| first.joint == joint.name);
        let first = first.and_then(|first| first.diagnosis.as_ref()).map(AsGiven::of);
        let first = first.or_else(|| joint.as_described.as_ref().and_then(AsGiven::simulated));
        let needs_no_cause = joint.needs_no_cause;
        let beside = Beside {
            described: first.as_ref(),
            has_bodies: joint.has_bodies,
            whole: joint.whole,
            at_best: &joint.at_best,
            needs_no_cause,
        };
        let found = match diagnose_from(&joint.case, &own, beside, &counted) {
            Ok(mut diagnosis) => {
                diagnosis.notes.extend(needs_no_cause.then(|| NEEDS_NO_CAUSE.to_owned()));
                Ok(Some(diagnosis))
            }
            Err(GapError::NeverMoved) => Ok(None),
            Err(other) => Err(other),
        };
        counted.done.fetch_add(1, Ordering::Relaxed);
        Ok(JointAnswer { joint: joint.name.clone(), diagnosis: found? })
    };
    joints.par_iter().map(of_joint).collect()
}

/// What the joints' answers come to; `first` are those before a body was changed, where one was.
pub(in crate::gap) fn concluded(
    robot: &str,
    groups: &BTreeMap<String, Vec<String>>,
    joints: Vec<JointAnswer>,
    bodies: Vec<BodyCause>,
    first: Option<&[JointAnswer]>,
    mut notes: Vec<String>,
) -> ClampedDiagnosis {
    // What recalibration closes is not the body's.
    let gap = ClampedGap { calibrated: self::gap(first.unwrap_or(&joints)).calibrated, ..self::gap(&joints) };
    let causes = shared(groups, &joints);
    let found = || found_of(&joints);
    let verdict = found().map(|d| d.answer.verdict).max_by_key(|verdict| severity(*verdict)).unwrap_or(Verdict::None);
    let verdict =
        if bodies.is_empty() || severity(verdict) > severity(Verdict::Effect) { verdict } else { Verdict::Effect };
    let of_bodies = bodies.iter().map(|body| body.kind.id());
    let mut ids = of_bodies.chain(causes.iter().map(|cause| cause.effect.id()));
    let pooled = pooled(groups, &joints);
    let answer = ClampedAnswer {
        verdict,
        effect: ids.next(),
        second: ids.next(),
        probability: found().map(|d| d.answer.probability).try_fold(1.0, |least, own| Some(f64::min(least, own?))),
        sentence: sentence(robot, &joints, &gap, &bodies, &causes, &pooled),
    };
    let those = |is_so: fn(&Gap) -> bool| {
        let own = joints.iter().filter(|joint| joint.diagnosis.as_ref().is_some_and(|d| is_so(&d.gap)));
        own.map(|joint| joint.joint.as_str()).collect::<Vec<&str>>()
    };
    let (fitted, in_turn) = (those(|gap| !gap.is_held_out()), those(Gap::is_in_turn));
    let chosen = those(|gap| !gap.outer && gap.is_held_out() && !gap.is_in_turn());
    if !fitted.is_empty() {
        notes.push(format!(
            "{}: these figures are from logs that were fitted with the others, as these do not show by themselves what all logs do: \
             nothing was held out.",
            fitted.join(", ")
        ));
    }
    if !in_turn.is_empty() {
        notes.push(format!(
            "{}: no log that is held out shows these move, so their figures are of the fitted ones, each predicted by a fit to \
             the others.",
            in_turn.join(", ")
        ));
    }
    if !chosen.is_empty() {
        notes
            .push(format!("{}: these figures are from logs that also helped to choose the answer.", chosen.join(", ")));
    }
    let robot = robot.to_owned();
    ClampedDiagnosis { robot, answer, gap, bodies, weighed: Vec::new(), causes, pooled, joints, notes, budget: None }
}

impl ClampedDiagnosis {
    /// Answers of the joints that move, in the description's order.
    pub fn found(&self) -> impl Iterator<Item = &Diagnosis> {
        found_of(&self.joints)
    }

    /// Joints of which something is left that no cause explains.
    pub(in crate::gap) fn unexplained(&self) -> impl Iterator<Item = &str> {
        self.found().filter(|own| own.answer.verdict == Verdict::Unexplained).map(|own| own.joint.as_str())
    }

    /// Joints that causes were found on, the one first where these close most.
    pub(in crate::gap) fn accused(&self) -> Vec<&str> {
        let mut accused: Vec<&Diagnosis> = self.found().filter(|own| !own.causes.is_empty()).collect();
        let closes = |own: &Diagnosis| own.gap.calibrated.powi(2) - own.gap.after.powi(2);
        accused.sort_by(|a, b| closes(b).total_cmp(&closes(a)));
        accused.into_iter().map(|own| own.joint.as_str()).collect()
    }

    /// The same without what was found on other joints than these.
    pub(in crate::gap) fn with_answers_of(&self, joints: &[&str]) -> Self {
        let mut less = self.clone();
        less.joints.iter_mut().filter(|own| !joints.contains(&own.joint.as_str())).for_each(|own| own.diagnosis = None);
        less
    }

    /// The same numbers without causes and laws.
    pub(in crate::gap) fn without_causes(&self) -> Self {
        let mut less = self.clone();
        for own in less.joints.iter_mut().filter_map(|joint| joint.diagnosis.as_mut()) {
            own.causes.clear();
            own.law = None;
        }
        less
    }

    /// The same of joints that push one another as bodies of these masses do, with numbers of their own where these are told.
    pub(in crate::gap) fn with_weighed(mut self, weighed: Vec<FoundNumber>) -> Self {
        let masses = weighed.iter().filter(|number| number.key == FoundKey::Mass && number.is_other());
        let end = |mass: &FoundNumber| if mass.interval.is_none() { " (the end of what is believed)" } else { "" };
        let told = masses.map(|mass| format!("{}: {}{}", mass.name, mass.words(), end(mass)));
        let told: Vec<String> = told.collect();
        if !told.is_empty() {
            self.notes.push(format!(
                "Joints push one another through the masses of bodies. All of them together ask for these, within what is \
                 believed: {}.",
                told.join("; ")
            ));
        }
        self.weighed = weighed;
        self
    }

    /// The same where held-out logs chose something of the whole robot, as `what` says: their figures are of no outer logs.
    pub(in crate::gap) fn chosen_by_held_out(mut self, what: &str) -> Self {
        let outer = self.joints.iter_mut().filter_map(|joint| joint.diagnosis.as_mut()).filter(|own| own.gap.outer);
        let outer: Vec<&mut Diagnosis> = outer.collect();
        if outer.is_empty() {
            return self;
        }
        for own in outer {
            own.gap.outer = false;
            own.notes.push(flattered(what));
        }
        self.gap.outer = false;
        self.notes.push(flattered(what));
        self
    }

    /// The same, whose sentences say what was looked for on demand.
    pub(in crate::gap) fn asked(mut self, options: &GapOptions) -> Self {
        self.answer.sentence = options.told_in(&self.answer.sentence, &self.robot);
        for own in self.joints.iter_mut().filter_map(|joint| joint.diagnosis.as_mut()) {
            own.answer.sentence = options.told_in(&own.answer.sentence, &own.joint);
        }
        self
    }

    /// The same, with what became of its time.
    pub(in crate::gap) fn within(mut self, deadline: &Deadline) -> Self {
        self.budget = deadline.spent();
        if let Some(spent) = &self.budget {
            self.answer.sentence = spent.before(&self.answer.sentence);
            self.notes.insert(0, spent.words());
            self.answer.probability = self.answer.probability.filter(|_| spent.finished);
        }
        self
    }
}

/// Tells another how many joints are done.
struct Counted<'a> {
    progress: &'a dyn Progress,
    done: AtomicUsize,
    of: usize,
}

impl Progress for Counted<'_> {
    fn step(&self, step: Step) {
        self.progress.step(Step { done: self.done.load(Ordering::Relaxed), of: self.of, ..step });
    }

    fn cancelled(&self) -> bool {
        self.progress.cancelled()
    }
}

/// What outweighs what.
pub(super) fn severity(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::None => 0,
        Verdict::Calibration => 1,
        Verdict::Effect => 2,
        Verdict::Unexplained => 3,
    }
}

pub(super) fn gap(joints: &[JointAnswer]) -> ClampedGap {
    let found: Vec<&Diagnosis> = found_of(joints).collect();
    let root = |of: fn(&Diagnosis) -> f64| {
        (found.iter().map(|d| of(d).powi(2)).sum::<f64>() / found.len().max(1) as f64).sqrt()
    };
    let (before, after, floor) = (root(|d| d.gap.before), root(|d| d.gap.after), root(|d| d.gap.floor));
    ClampedGap {
        unit: found.first().map_or("rad", |d| d.gap.unit),
        before,
        calibrated: root(|d| d.gap.calibrated),
        after,
        floor,
        closed: closed(before, after, floor),
        outer: found.iter().all(|d| d.gap.outer),
    }
}

/// Squares that each cause of a joint closes where it is added.
fn steps(diagnosis: &Diagnosis) -> impl Iterator<Item = (&CauseShare, f64)> {
    let before = std::iter::once(diagnosis.gap.calibrated).chain(diagnosis.causes.iter().map(|cause| cause.after));
    diagnosis.causes.iter().zip(before).map(|(cause, before)| (cause, before.powi(2) - cause.after.powi(2)))
}

/// The gain of a drive that an answer has as a number and not as a cause: recalibrated numbers have all that it closes.
fn gain_as_number(diagnosis: &Diagnosis) -> Option<&(EffectId, Vec<Number>)> {
    let is_cause = diagnosis.causes.iter().any(|cause| cause.effect == EffectId::MotorGain);
    let is_named = diagnosis.answer.verdict == Verdict::Effect && !is_cause;
    diagnosis.effect_parameters.iter().find(|(effect, _)| is_named && *effect == EffectId::MotorGain)
}

/// Causes with all joints that have them, the one that closes most first.
fn shared(groups: &BTreeMap<String, Vec<String>>, joints: &[JointAnswer]) -> Vec<SharedCause> {
    let found: Vec<(&str, &Diagnosis)> =
        joints.iter().filter_map(|joint| Some((joint.joint.as_str(), joint.diagnosis.as_ref()?))).collect();
    let all: f64 = found.iter().map(|(_, d)| d.gap.calibrated.powi(2)).sum();
    let mut causes: Vec<(f64, SharedCause)> = Vec::new();
    for (joint, diagnosis) in &found {
        let share = |squares: f64| if all > 0.0 { squares / all } else { 0.0 };
        let causes_of = steps(diagnosis).map(|(cause, squares)| (cause.effect, squares, share(squares)));
        let refitted = diagnosis.gap.before.powi(2) - diagnosis.gap.calibrated.powi(2);
        let gain = gain_as_number(diagnosis).map(|(effect, _)| (*effect, refitted, 0.0));
        for (effect, squares, share) in causes_of.chain(gain) {
            match causes.iter_mut().find(|(_, known)| known.effect == effect) {
                Some((closes, known)) => {
                    known.joints.push((*joint).to_owned());
                    known.share += share;
                    *closes += squares;
                }
                None => {
                    let joints = vec![(*joint).to_owned()];
                    let cause = SharedCause { effect, joints, group: None, size: None, share, common: false };
                    causes.push((squares, cause));
                }
            }
        }
    }
    causes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut causes: Vec<SharedCause> = causes.into_iter().map(|(_, cause)| cause).collect();
    let same = |a: &[String], b: &[String]| a.len() == b.len() && a.iter().all(|name| b.contains(name));
    for cause in &mut causes {
        let group = groups.iter().find(|(_, joints)| same(joints, &cause.joints)).map(|(name, _)| name.clone());
        let is_all = cause.joints.len() == found.len() && found.len() > 1;
        cause.group = is_all.then(|| "all".to_owned()).or(group);
        let own = |(_, d): &(&str, &Diagnosis)| {
            let found = d.causes.iter().find(|own| own.effect == cause.effect).map(|own| &own.parameters);
            let as_number = || Some(&gain_as_number(d).filter(|(effect, _)| *effect == cause.effect)?.1);
            found.or_else(as_number)?.first().cloned()
        };
        let sizes: Vec<Number> = found.iter().filter_map(own).collect();
        cause.size = match &sizes[..] {
            [only] => Some(only.clone()),
            _ => one_size(&sizes.iter().collect::<Vec<_>>()),
        };
    }
    causes
}

pub(super) fn sentence(
    robot: &str,
    joints: &[JointAnswer],
    gap: &ClampedGap,
    bodies: &[BodyCause],
    causes: &[SharedCause],
    pooled: &[PooledNumber],
) -> String {
    let found = || joints.iter().filter_map(|joint| Some((&joint.joint, joint.diagnosis.as_ref()?)));
    let size = if gap.unit == "rad" { mrad } else { newton_metres };
    let [given, calibrated, after] = [gap.before, gap.calibrated, gap.after].map(size);
    let what = if gap.unit == "rad" { "error" } else { "torque error" };
    let has_none = bodies.is_empty() && causes.is_empty() && found().all(|(_, d)| d.law.is_none());
    let is_number = |cause: &SharedCause| {
        found().all(|(_, d)| d.causes.iter().all(|own| own.effect != cause.effect))
            && cause.effect == EffectId::MotorGain
    };
    let only_numbers = bodies.is_empty() && causes.iter().all(is_number) && found().all(|(_, d)| d.law.is_none());
    let mut text = format!(
        "{robot}: {}the {what} is {given} as given, {}.",
        if found().count() > 1 { format!("over {} joints ", found().count()) } else { String::new() },
        match (has_none, only_numbers) {
            (true, _) => format!("and {calibrated} with {REFITTED}; no cause was found beside them"),
            (_, true) => format!("and {calibrated} with {REFITTED}, the drive's gain among them"),
            _ => format!("{calibrated} with {REFITTED} and {after} with the causes that were found"),
        }
    );
    for body in bodies {
        let rivals = body.rivals_words().map(|others| format!(": these logs cannot tell it from {others}"));
        text += &format!(" {}{}.", capital(&body.words()), rivals.unwrap_or_default());
    }
    for cause in causes.iter().filter(|cause| cause.share > NEGLIGIBLE || is_number(cause)).take(SAID) {
        let on = cause.group.clone().unwrap_or_else(|| cause.joints.join(", "));
        let size = cause.size.as_ref().map(|n| format!(" ({} = {})", n.name, quantity(n.value, n.interval, &n.unit)));
        text += &format!(" {} on {on}{}.", capital(words(cause.effect)), size.unwrap_or_default());
    }
    if bodies.is_empty() {
        let off = numbers_off(joints, pooled);
        text.extend((!off.is_empty()).then(|| format!(" {}.", capital(&off.join("; ")))));
    }
    for number in pooled.iter().take(SAID) {
        text += &format!(" {}.", capital(&number.words()));
    }
    let unexplained: Vec<&str> =
        found().filter(|(_, d)| d.answer.verdict == Verdict::Unexplained).map(|(joint, _)| joint.as_str()).collect();
    if unexplained.len() > 1 && unexplained.len() == found().count() {
        text += " The effects I know explain no joint to its noise.";
    } else if !unexplained.is_empty() {
        text += &format!(" The effects I know do not explain all of {}.", unexplained.join(", "));
    }
    text
}

/// Numbers without which joints are off, those first that close most, but for what is told of several joints at once:
/// `Coulomb friction of elbow is 0.92 [0.90, 0.94] N m instead of 0.155 N m`.
fn numbers_off(joints: &[JointAnswer], pooled: &[PooledNumber]) -> Vec<String> {
    let closes = |own: &Diagnosis| own.gap.before.powi(2) - own.gap.calibrated.powi(2);
    let all: f64 = found_of(joints).map(closes).sum();
    let of = |own: &&Diagnosis| own.answer.verdict == Verdict::Calibration && closes(own) > MUCH_OF_ALL * all;
    let mut those: Vec<&Diagnosis> = found_of(joints).filter(of).collect();
    those.sort_by(|a, b| closes(b).total_cmp(&closes(a)));
    let words = |own: &Diagnosis| {
        let number = own.parameters.iter().find(|number| own.answer.effect.as_ref() == Some(&number.name))?;
        let is_told = |one: &PooledNumber| one.number == number.name && one.joints.contains(&own.joint);
        let instead = number.instead().filter(|_| !pooled.iter().any(is_told))?;
        Some(format!("{} of {} is {instead}", number_words(&number.name), own.joint))
    };
    those.into_iter().filter_map(words).take(SAID).collect()
}

/// Causes and numbers that the sentence names, each.
const SAID: usize = 3;
/// What closes no more than this share of the recalibrated squares is left to the joints' own answers.
const NEGLIGIBLE: f64 = 0.01;
/// Numbers are named of joints that close this share of what all numbers do.
const MUCH_OF_ALL: f64 = 0.1;
