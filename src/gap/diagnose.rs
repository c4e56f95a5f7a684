//! A diagnosis from beginning to end.

use super::diagnosis::{
    Answer, Candidate, Detectable, Diagnosis, Gap, GapOptions, LogGap, LogTraces, Next, Number, ResidualTorque, Verdict,
};
use super::hypothesis::demands::resolved;
use super::hypothesis::evidence::{Evidence, WholeLeft};
use super::hypothesis::held_out::{HeldOut, closed};
use super::hypothesis::model::{GAIN, INERTIA};
use super::hypothesis::trial::Trial;
use super::search::attribute::Attribution;
use super::search::differs::{Differs, differing};
use super::search::refuted::soundly_believed;
use super::search::together::all_together;
use super::verdict::as_given::AsGiven;
use super::verdict::decide::{Decision, EXPLAINED, HARDLY_A_GAP, decide};
use super::verdict::detect::detectable;
use super::verdict::doubts::{Simulated, asking};
use super::verdict::law_found::law_found;
use super::verdict::next::next;
use super::verdict::notes::notes;
use super::verdict::numbers::{UNNAMED, numbers, numbers_beside};
use super::verdict::place::place;
use super::verdict::rates::{probability_of, share_out, standing};
use super::verdict::sentence::{armature_words, far, followed, link_instead, sentence};
use super::verdict::told::{AtBest, tell};
use super::verdict::twins::{Measured, measure};
use super::verdict::waterfall::causes;
use crate::deadline::NO_PROBABILITY;
use crate::identify::{BeliefFound, Case, DirectiveError, Estimate, Experiment, JointModel, Signal};
use crate::joint::EffectId;
use crate::log::Role;
use crate::progress::{Cancelled, Progress, Step};
use std::sync::Arc;

/// Why no diagnosis can be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GapError {
    /// The study has no nominal model.
    #[error(
        "the study has no nominal model: [joint] needs inertia, moment, coulomb and viscous, what the engineer believes today"
    )]
    NoNominal,
    /// Nothing moves in any log.
    #[error("the joint never moved in any log")]
    NeverMoved,
    /// The joint as given has no motion that stays finite.
    #[error(
        "the joint {joint} as given runs away on the logs; check the units and sizes of its numbers, those of its motor among them"
    )]
    Diverged {
        /// Its name.
        joint: String,
    },
    /// The diagnosis was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A demand on a number or on a parameter of an effect cannot be met.
    #[error(transparent)]
    Demand(#[from] DirectiveError),
}

/// What is left out where the smallest sizes that would have shown are.
const DETECTABLE: &str = "what these logs could have shown";

/// Diagnoses the gap of a joint study. `progress` is told what is being tried, and asked whether that is still wanted.
///
/// # Errors
/// [`GapError`] where there is nothing to diagnose.
pub fn diagnose(case: &Case, options: &GapOptions, progress: &dyn Progress) -> Result<Diagnosis, GapError> {
    let mut diagnosis = diagnose_from(case, options, Beside::default(), progress)?;
    diagnosis.answer.sentence = options.told_in(&diagnosis.answer.sentence, &diagnosis.joint);
    Ok(diagnosis)
}

/// What the robot says beside a joint's own logs.
#[derive(Default)]
pub(super) struct Beside<'a> {
    /// What the joint is as given where that is not what its case makes of it: that of the robot as described.
    pub described: Option<&'a AsGiven>,
    /// Whether it carries bodies which are other than described.
    pub has_bodies: bool,
    /// What the whole robot leaves of it.
    pub whole: Option<WholeLeft>,
    /// Its causes as the whole robot has them, where that explains all joints.
    pub at_best: &'a [AtBest],
    /// Whether the whole robot may need no causes of joints, so that none are looked for: a joint of which more than noise is
    /// left then is looked at again, and only its numbers are told.
    pub needs_no_cause: bool,
}

/// The same of a joint of a robot.
pub(super) fn diagnose_from(
    case: &Case,
    options: &GapOptions,
    beside: Beside<'_>,
    progress: &dyn Progress,
) -> Result<Diagnosis, GapError> {
    let stage = |stage| progress.go_on(Step::stage(stage));
    let Beside { described, has_bodies, whole, at_best, needs_no_cause } = beside;
    let mut evidence = evidence_of(case, options, whole)?;
    evidence.numbers_alone = needs_no_cause;
    let demands = Arc::clone(&evidence.demands);
    let effects = considered(&evidence, options);
    let candidates = if needs_no_cause { &[][..] } else { &effects };
    let (evidence, attribution) = attributed(evidence, candidates, progress)?;
    if !attribution.calibrated.criterion().is_finite() {
        return Err(GapError::Diverged { joint: case.joint.name.clone() });
    }
    stage(if options.deadline.leaves_aside(DETECTABLE) { "weighing what was found in time" } else { "weighing" })?;
    let held = HeldOut::of(&evidence);
    let decision = decide(&evidence, &held, &attribution, &effects);
    let mut gap = gap(&evidence, &held, &attribution, &decision);
    if let Some(described) = described {
        described.begin(&mut gap);
    }
    let is_brief = needs_no_cause && decision.verdict == Verdict::Unexplained;
    let weighed =
        Weighed { options, evidence: &evidence, a: &attribution, decision: &decision, effects: &effects, is_brief };
    stage(DETECTABLE)?;
    let detectable = weighed.detectable();
    let (parameters, effect_parameters) = weighed.numbers(at_best);
    let law = law_found(&case.joint.name, &evidence, &held, &attribution, &decision);
    let differs = weighed.differs();
    let causes = causes(&evidence, &held, &attribution, &decision, &effect_parameters);
    let (beliefs, undetermined) = (weighed.around().beliefs(), weighed.around().undetermined(&evidence));
    let moved = weighed.moved().and_then(|name| parameters.iter().find(|number| number.name == name));
    let parts = (&effect_parameters[..], &causes[..]);
    let mut sentence = sentence(&case.joint.name, &decision, &gap, moved, parts, law.as_ref(), has_bodies);
    if let [(EffectId::MotorGain, numbers)] = &effect_parameters[..]
        && evidence.shows_ratios_alone()
    {
        sentence.extend(numbers.first().map(|gain| link_instead(gain.value)));
    }
    sentence += &weighed.further(&gap, &beliefs, &differs);
    let mut ranking = ranking(&evidence, &held, &attribution, &decision, &gap);
    if let [(effect, numbers)] = &effect_parameters[..] {
        let own = ranking.iter_mut().filter(|candidate| candidate.effect == *effect);
        own.for_each(|candidate| candidate.parameters.clone_from(numbers));
    }
    stage("what would tell more")?;
    let next = weighed.next_experiment();
    let standing = standing(&decision);
    let twins = weighed.twins(progress)?;
    let (probability, mut probability_source) = probability_of(&standing, twins.as_ref());
    stage("where the gap lies")?;
    let (location, torques) = place(&evidence, &attribution, &decision, law.as_ref());
    let mut traces = traces(&evidence, &attribution, &decision, torques);
    if let Some(described) = described {
        described.show(&mut traces);
    }
    let mut notes = notes(&evidence, &attribution, &decision, &differs);
    let mut doubts = case.doubts();
    if !is_brief && !options.deadline.leaves_aside("slips in the study that simulations show") {
        let (given_rad, floor_rad, deadline) = (gap.before, gap.floor, &options.deadline);
        let simulated = Simulated { causes: &causes, beliefs: &beliefs, given_rad, floor_rad, deadline };
        doubts.extend(simulated.doubts(case));
    }
    sentence = asking(&sentence, &doubts, weighed.is_named());
    let budget = options.deadline.spent();
    let is_finished = budget.as_ref().is_none_or(|spent| spent.finished);
    if let Some(spent) = &budget {
        sentence = spent.before(&sentence);
        notes.insert(0, spent.words());
    }
    if is_finished {
        share_out(&mut ranking, &decision, probability);
    } else {
        probability_source = NO_PROBABILITY.to_owned();
    }
    let probability = is_finished.then_some(probability);
    Ok(Diagnosis {
        joint: case.joint.name.clone(),
        answer: weighed.answer(standing, sentence, (probability, probability_source)),
        location,
        gap,
        ranking,
        detectable,
        parameters,
        causes,
        beliefs,
        law,
        undetermined,
        effect_parameters,
        next,
        confusion: twins.map(|t| t.confusion),
        traces,
        doubts,
        notes,
        differs,
        withheld: EffectId::ALL.iter().copied().filter(|e| !effects.contains(e)).collect(),
        demands: Arc::unwrap_or_clone(demands),
        budget,
    })
}

/// What there is to argue from; `whole` is what the whole robot leaves of the joint.
fn evidence_of(case: &Case, options: &GapOptions, whole: Option<WholeLeft>) -> Result<Evidence, GapError> {
    let nominal = case.joint.nominal.ok_or(GapError::NoNominal)?;
    let mut evidence = Evidence::of(case, nominal).ok_or(GapError::NeverMoved)?;
    evidence.whole = whole;
    evidence.deadline = options.deadline.clone();
    evidence.demands = Arc::new(resolved(&options.demands, &evidence)?);
    Ok(evidence)
}

/// Effects that may be named.
fn considered(evidence: &Evidence, options: &GapOptions) -> Vec<EffectId> {
    // Who holds the drive's gain knows what arrives of a torque.
    let gain_is_known = evidence.baseline().is_held_by_demand(GAIN);
    let considered = |e: &EffectId| options.considers(*e) && !(gain_is_known && *e == EffectId::MotorGain);
    EffectId::ALL.iter().copied().filter(considered).collect()
}

/// What was decided, and from what.
struct Weighed<'a> {
    options: &'a GapOptions,
    evidence: &'a Evidence,
    a: &'a Attribution,
    decision: &'a Decision<'a>,
    /// Effects that may be named.
    effects: &'a [EffectId],
    /// Whether nothing is told but numbers.
    is_brief: bool,
}

impl<'a> Weighed<'a> {
    /// What numbers are told with: the answer where that has causes or a law, else the recalibrated joint.
    fn around(&self) -> &'a Trial {
        let answer = self.decision.answer;
        let found = !answer.effects().is_empty() || answer.model.law().is_some();
        if found { answer } else { &self.a.calibrated }
    }

    /// The smallest size of each effect that these logs would have shown.
    fn detectable(&self) -> Vec<Detectable> {
        if self.is_brief || self.options.deadline.leaves_aside(DETECTABLE) {
            return Vec::new();
        }
        let around = self.around();
        // Effects are added to what has a name.
        let named = if around.model.law().is_none() {
            around
        } else if around.effects().is_empty() {
            &self.a.calibrated
        } else {
            &self.a.best
        };
        detectable(self.evidence, (self.a.noise_rad, self.a.correlation), named, self.effects)
    }

    /// Numbers of the joint, and of the effects of the answer.
    fn numbers(&self, at_best: &[AtBest]) -> (Vec<Estimate>, Vec<(EffectId, Vec<Number>)>) {
        let around = self.around();
        let is_brief = self.is_brief || self.options.deadline.leaves_aside(UNNAMED);
        let beside: &[EffectId] = if is_brief { &[] } else { self.effects };
        let (parameters, mut effect_parameters) = numbers_beside(self.evidence, around, beside);
        tell(at_best, around, &mut effect_parameters);
        let has_gain = |effects: &[EffectId]| effects.contains(&EffectId::MotorGain);
        if has_gain(&self.decision.effects) && !has_gain(around.effects()) {
            effect_parameters.push((EffectId::MotorGain, vec![gain_as_effect(&parameters)]));
        }
        (parameters, effect_parameters)
    }

    /// Whether nothing is left that the model does not explain.
    fn is_explained(&self) -> bool {
        self.decision.excess < EXPLAINED
    }

    /// Numbers that are not the same in all logs.
    fn differs(&self) -> Vec<Differs> {
        // Causes that hold in some logs only may stand for a number that differs.
        let restricted = self.a.best.model.only().iter().any(Option::is_some);
        let may_differ = !self.is_brief && (!self.is_explained() || restricted);
        match may_differ && !self.options.deadline.leaves_out("numbers that differ between logs") {
            true => differing(self.evidence, self.a),
            false => Vec::new(),
        }
    }

    /// The number that was moved by most of its standard deviations.
    fn moved(&self) -> Option<&'a str> {
        let parameters = self.decision.answer.model.parameters();
        self.decision.finding.map(|i| parameters[i].name.as_str())
    }

    /// What is said behind the answer's first sentences: of the whole robot, and of numbers that are far from what was
    /// believed of them or that differ between logs.
    fn further(&self, gap: &Gap, beliefs: &[BeliefFound], differs: &[Differs]) -> String {
        let (decision, evidence) = (self.decision, self.evidence);
        let mut further = String::new();
        further.extend(followed(decision.verdict, gap, evidence.whole));
        let broken = broken(beliefs, decision);
        further.extend(far(&broken));
        let inertia = &decision.answer.model.parameters()[INERTIA].name;
        if broken.iter().any(|belief| belief.name == *inertia) {
            further.extend(armature_words(evidence, decision.answer));
        }
        further.extend(differs.first().and_then(Differs::instead_of_causes));
        further
    }

    /// The experiment that would tell apart what stands equally well.
    fn next_experiment(&self) -> Option<Next> {
        let rivals = rivals(self.a, self.decision);
        let is_asked = !self.is_brief && !rivals.is_empty();
        match !is_asked || self.options.deadline.leaves_aside("the next experiment") {
            true => None,
            false => next(self.evidence, self.a, self.decision.answer, &rivals),
        }
    }

    /// Whether the answer is an effect.
    fn is_named(&self) -> bool {
        self.decision.verdict == Verdict::Effect
    }

    /// What twins of the study say, where any are asked for.
    fn twins(&self, progress: &dyn Progress) -> Result<Option<Measured>, Cancelled> {
        if self.options.twins == 0 {
            return Ok(None);
        }
        let answer = (self.decision.verdict, self.decision.effect().filter(|_| self.is_named()));
        let drawn = (self.options.twins, self.options.seed);
        measure(self.evidence, self.a, self.effects, answer, drawn, progress).map(Some)
    }

    /// The answer in short.
    fn answer(
        &self,
        standing: String,
        sentence: String,
        (probability, probability_source): (Option<f64>, String),
    ) -> Answer {
        let (decision, is_named) = (self.decision, self.is_named());
        let parameter = self.moved().filter(|_| decision.verdict == Verdict::Calibration);
        Answer {
            verdict: decision.verdict,
            effect: if is_named { decision.effect().map(EffectId::id) } else { parameter }.map(str::to_owned),
            second: decision.second().filter(|_| is_named),
            equivalent: if is_named { decision.equivalent.clone() } else { Vec::new() },
            probability,
            probability_source,
            standing,
            sentence,
            partial: decision.effect().filter(|_| decision.verdict == Verdict::Unexplained),
            intervals_trusted: self.is_explained(),
        }
    }
}

/// Numbers that moved further than belief allows, beside what an answer names already.
fn broken<'a>(beliefs: &'a [BeliefFound], decision: &Decision<'_>) -> Vec<&'a BeliefFound> {
    if decision.verdict == Verdict::None {
        return Vec::new();
    }
    let gain = decision.answer.model.parameters()[GAIN].name.clone();
    let is_named = |name: &str| decision.effects.contains(&EffectId::MotorGain) && name == gain;
    beliefs.iter().filter(|belief| belief.is_finding() && !is_named(&belief.name)).collect()
}

/// The drive's gain, a number that is believed to be 1, as the effect that it is once it is not.
fn gain_as_effect(parameters: &[Estimate]) -> Number {
    let gain = &parameters[GAIN];
    Number {
        name: EffectId::MotorGain.named_parameters()[0].name.to_owned(),
        value: gain.value,
        unit: gain.unit.clone(),
        interval: gain.interval,
        interval_naive: gain.interval_naive,
    }
}

/// All hypotheses fitted: to the logs that the study says, or to all where only the held-out ones show what is missing.
fn attributed(
    mut evidence: Evidence,
    effects: &[EffectId],
    progress: &dyn Progress,
) -> Result<(Evidence, Attribution), Cancelled> {
    progress.go_on(Step::stage("numbers within their beliefs"))?;
    let mut attribution = Attribution::of(&evidence, effects, progress)?;
    if let Some(normal) = soundly_believed(&evidence, &attribution.best) {
        progress.go_on(Step::stage("numbers held to their beliefs"))?;
        let held_back = Attribution::of(&normal, effects, progress)?;
        // What is found with other beliefs may be other causes, that predict no better.
        if held_back.best.held_loss(&normal) < attribution.best.held_loss(&evidence) {
            (evidence, attribution) = (normal, held_back);
        }
    }
    let shows_more = attribution.held_out_shows_more(&evidence);
    if !shows_more || evidence.deadline.leaves_out("a search on all logs together, for the held-out ones show more") {
        return all_together(evidence, attribution, effects, progress);
    }
    progress.go_on(Step::stage("all logs: the held-out ones show more"))?;
    let pooled = evidence.pooled();
    let attribution = Attribution::of(&pooled, effects, progress)?;
    Ok((pooled, attribution))
}

/// How far the gap closes on logs that were not fitted.
fn gap(evidence: &Evidence, held: &HeldOut, a: &Attribution, decision: &Decision<'_>) -> Gap {
    let of = |t: &Trial| held.residuals(evidence, t);
    let (given, calibrated, answer) = (of(&a.given), of(&a.calibrated), of(decision.answer));
    let first = decision.first.map_or_else(|| answer.clone(), of);
    let floor = a.noise_rad;
    let (before, after) = (held.rms_rad(&given), held.rms_rad(&answer));
    Gap {
        unit: "rad",
        before,
        calibrated: held.rms_rad(&calibrated),
        after_first: held.rms_rad(&first),
        after,
        floor,
        closed: closed(before, after, floor),
        closed_interval: closed(before, after, floor).and_then(|_| held.closed_interval(&given, &answer, floor)),
        outer: held.is_outer()
            && !(a.held_out_chose(evidence) || decision.drops_law(a) || !decision.dropped(a).is_empty()),
        held_out: held.how.to_owned(),
        per_log: per_log(held, [&given, &calibrated, &answer], floor),
    }
}

/// One line for each held-out log.
fn per_log(held: &HeldOut, residuals: [&Vec<Vec<f64>>; 3], floor: f64) -> Vec<LogGap> {
    let [given, calibrated, answer] = residuals.map(|residuals| held.rms_by_file(residuals));
    let logs = given.into_iter().zip(calibrated).zip(answer);
    logs.map(|(((file, before), (_, calibrated)), (_, after))| LogGap { file, before, calibrated, after, floor })
        .collect()
}

/// Hypotheses that stand as well as the answer; where nothing explains the gap, the one that comes nearest to what is
/// known so far.
fn rivals<'a>(a: &'a Attribution, decision: &Decision<'_>) -> Vec<&'a Trial> {
    let other = |t: &&Trial| t.effects() != decision.answer.effects();
    let equivalent = |t: &&Trial| decision.equivalent.iter().any(|e| t.effects().contains(e));
    let of_first = a.rivals.first().into_iter().flatten().filter(other);
    match decision.verdict {
        // A simpler effect that does as well may have been named instead of the best.
        Verdict::Effect => std::iter::once(&a.best).filter(other).chain(of_first).filter(equivalent).collect(),
        Verdict::Unexplained => of_first.chain(a.firsts.iter().filter(other)).take(1).collect(),
        Verdict::None | Verdict::Calibration => Vec::new(),
    }
}

/// Deviance by which the fit of an effect in the answer's place is better than that of the effect looked for alone.
const FITS_BETTER: f64 = 1.0;

/// Single effects, the likeliest first; the answer's, where that is one alone, in the form and with the numbers of the answer,
/// and those that stand as well with the fit that does: the search for one alone may have ended elsewhere.
fn ranking(evidence: &Evidence, held: &HeldOut, a: &Attribution, decision: &Decision<'_>, gap: &Gap) -> Vec<Candidate> {
    let answer = decision.answer;
    let score = |t: &Trial| a.score(evidence, t);
    let in_its_place = || a.rivals.first().into_iter().flatten().chain([&a.best]).filter(|t| t.effects().len() == 1);
    let better = |t: &Trial| {
        let same = in_its_place().filter(|other| other.effects() == t.effects());
        let stands = same.filter(|other| decision.equivalent.contains(&other.effects()[0]));
        let best = stands.min_by(|a, b| score(a).total_cmp(&score(b)));
        best.filter(|best| score(best) < score(t) - FITS_BETTER)
    };
    let is_answer = |t: &Trial| t.effects() == answer.effects();
    let mut firsts: Vec<&Trial> = Vec::new();
    let mut is_in_order = true;
    for t in &a.firsts {
        let better = if is_answer(t) { None } else { better(t) };
        is_in_order &= better.is_none();
        firsts.push(if is_answer(t) { answer } else { better.unwrap_or(t) });
    }
    if !is_in_order {
        // An answer that leads still does.
        let leads = firsts.first().is_some_and(|t| is_answer(t));
        let place = |t: &Trial| if leads && is_answer(t) { f64::NEG_INFINITY } else { score(t) };
        firsts.sort_by(|a, b| place(a).total_cmp(&place(b)));
    }
    let best = firsts.first();
    firsts
        .iter()
        .map(|&t| {
            let effect = t.effects()[0];
            let after = held.rms_rad(&held.residuals(evidence, t));
            let (_, mut effects) = numbers(evidence, t);
            Candidate {
                effect,
                probability: 0.0,
                after,
                // A share of hardly any gap would be a number without meaning.
                closed: closed(gap.before, after, gap.floor).filter(|_| gap.before > HARDLY_A_GAP * gap.floor),
                behind_sd: best.map_or(0.0, |best| a.behind(evidence, t, best).max(0.0)),
                parameters: effects.pop().map(|(_, numbers)| numbers).unwrap_or_default(),
                refitted: true,
            }
        })
        .collect()
}

/// Curves of every log that moves.
fn traces(
    evidence: &Evidence,
    a: &Attribution,
    decision: &Decision<'_>,
    torques: Vec<ResidualTorque>,
) -> Vec<LogTraces> {
    let of = |(e, role, k): (&Experiment, Role, usize), residual_torque: ResidualTorque| {
        let readings = &e.measured_rad[e.uncompared..];
        let model = |t: &Trial| -> Vec<f64> {
            let residual = if role == Role::Fit { t.fit.get(k) } else { t.held.get(k) };
            residual.map(|r| r.iter().zip(readings).map(|(r, q)| r + q).collect()).unwrap_or_default()
        };
        LogTraces {
            file: e.file.clone(),
            role: if role == Role::Fit && evidence.pooled_from.is_none_or(|from| k < from) {
                "fit"
            } else {
                "validate"
            }
            .to_owned(),
            t_s: e.t_s[e.uncompared..].to_vec(),
            measured_rad: readings.to_vec(),
            setpoint_rad: match &e.signal {
                Signal::Position { setpoint_rad, .. } => Some(setpoint_rad[e.uncompared..].to_vec()),
                _ => None,
            },
            before_rad: model(&a.given),
            calibrated_rad: model(&a.calibrated),
            after_rad: model(decision.answer),
            residual_torque,
        }
    };
    let fit = evidence.fit.iter().enumerate().map(|(k, e)| (e, Role::Fit, k));
    let held = evidence.held.iter().enumerate().map(|(k, e)| (e, Role::Validate, k));
    fit.chain(held).zip(torques).map(|(log, torque)| of(log, torque)).collect()
}
