//! From everything that was tried to one answer.

use super::attained::Attained;
use super::bench::Bench;
use super::cause::Cause;
use super::comes_back::may_be_noise;
use super::noise::MATERIAL;
use super::place::Place;
use super::refine::Hypothesis;
use super::tried::Attribution;
use super::unseen::Unseen;
use crate::gap::Verdict;

/// What the thresholds are where the trunk is clamped, and where the robot walks: there, where and when feet happen to
/// land is told from a cause by size only. Set on studies of the program's own making.
struct Limits {
    /// A first cause gains more than this ...
    first: f64,
    /// ... a second more than this, and more than this share of the first's gain.
    second: f64,
    second_share: f64,
    /// ... and the first leaves more than this of a noise variance per sample.
    second_excess: f64,
    /// Explained: no more than this is left of a noise variance per sample.
    explained: f64,
    /// Explained, too: so much of what is left by the robot as given is gone, on fitted and on held-out samples.
    closes: f64,
    /// Causes stand equally well that are no farther apart.
    equal: f64,
}

const CLAMPED: Limits = Limits {
    first: 40.0,
    second: 60.0,
    second_share: 0.01,
    second_excess: 0.0,
    explained: 0.15,
    closes: 0.98,
    equal: 9.0,
};
const ON_THE_FLOOR: Limits = Limits {
    first: 250.0,
    second: 400.0,
    second_share: 0.01,
    second_excess: 0.2,
    explained: 0.3,
    closes: 0.8,
    equal: 120.0,
};
/// The same of free play: when a joint hits which flank is not told to the millisecond by any two simulations.
const HUNTING_CLOSES: f64 = 0.8;

/// A cause with fewer values stands as well if it is behind by no more than this share of the gain.
const SIMPLER: f64 = 0.005;
/// Share of what the uncertain numbers take out to first order that their second order may leave.
const SECOND_ORDER: f64 = 0.01;

/// Share of what the uncertain numbers take out that may be left of a robot with which nothing is the matter.
const LEFT_OVER: f64 = 0.005;
/// And no more than this of a noise variance per sample: what is far above the sensor's noise is not explained.
const LEFT_AT_MOST: f64 = 4.0;

/// Gain below which a cause on a place is no more than a matter of how one simulates.
fn material(bench: &Bench<'_>, place: &Place) -> f64 {
    let is_its = |joint: &usize| place.joints.is_empty() || place.joints.contains(joint);
    let rows = bench.layout.joints().filter(|(joint, _)| is_its(joint));
    let samples = rows.flat_map(|(_, row)| row.range.clone()).filter(|k| bench.noise.weight[*k] > 0.0).count();
    MATERIAL * samples as f64
}

/// An answer before it is put in words.
pub(super) struct Decision<'a> {
    pub verdict: Verdict,
    /// What the answer adds to the robot; as given where nothing is named and nothing comes near.
    pub answer: &'a Hypothesis,
    /// Its leading cause alone.
    pub first: &'a Hypothesis,
    /// Which part of the answer is named first, where there are two.
    pub leading: usize,
    pub equivalent: Vec<Cause>,
    pub places: Vec<Place>,
    /// What is left per sample, above a noise variance.
    pub excess: f64,
    /// How much the answer gains on the robot as given.
    pub gain: f64,
    /// How far the next cause is behind.
    pub margin: f64,
}

impl Decision<'_> {
    pub fn is_explained(&self, bench: &Bench<'_>) -> bool {
        self.excess < limits(bench).explained
    }
}

/// Whether what a hypothesis leaves is the noise's.
pub(super) fn is_explained(bench: &Bench<'_>, hypothesis: &Hypothesis) -> bool {
    excess(bench, &Unseen::of(bench), hypothesis) < limits(bench).explained
}

/// Whether a first cause leaves so much that a second is looked for.
pub(super) fn leaves_enough(bench: &Bench<'_>, first: &Hypothesis) -> bool {
    excess(bench, &Unseen::of(bench), first) > limits(bench).second_excess
}

/// Whether beside a clamped trunk two causes leave more than two honest simulations of one robot differ by.
pub(super) fn leaves_much(bench: &Bench<'_>, pair: &Hypothesis) -> bool {
    bench.case.is_clamped() && fitted_excess(bench, &pair.attained) > MATERIAL
}

/// What a hypothesis leaves per sample, above a noise variance. A robot that walks lands once, and how it stands then decays
/// for seconds and differs between any two honest simulations: on the floor only what comes back in cycles that no fit saw
/// is there.
fn excess(bench: &Bench<'_>, unseen: &Unseen<'_>, hypothesis: &Hypothesis) -> f64 {
    let unseen = if bench.case.is_clamped() { None } else { unseen.excess(&hypothesis.attained) };
    unseen.unwrap_or_else(|| fitted_excess(bench, &hypothesis.attained))
}

/// The same of the samples that fits see, the price of the numbers included.
fn fitted_excess(bench: &Bench<'_>, attained: &Attained) -> f64 {
    attained.price / bench.noise.count().max(1) as f64 - 1.0
}

fn limits(bench: &Bench<'_>) -> &'static Limits {
    if bench.case.is_clamped() { &CLAMPED } else { &ON_THE_FLOOR }
}

/// How far two causes must be apart to be told from each other.
pub(super) fn told_apart(bench: &Bench<'_>) -> f64 {
    limits(bench).equal
}

/// Gain from which on a first cause is named. On the floor what the uncertain numbers take out is known to first order
/// only: the more they take, the more a cause must gain.
pub(super) fn needed(bench: &Bench<'_>, given: &Hypothesis) -> f64 {
    limits(bench).first + second_order(bench) * taken_out(bench, given)
}

/// How much of what uncertain numbers take out their second order may leave.
pub(super) fn second_order(bench: &Bench<'_>) -> f64 {
    if bench.case.is_clamped() { 0.0 } else { SECOND_ORDER }
}

/// What the uncertain numbers take out of the weighed sum of squares.
fn taken_out(bench: &Bench<'_>, given: &Hypothesis) -> f64 {
    let squares = given.residual.iter().zip(&bench.noise.weight).map(|(left, weight)| weight * left.powi(2));
    f64::max(squares.sum::<f64>() - given.loss(), 0.0)
}

/// Weighs what was tried.
pub(super) fn decide<'a>(bench: &Bench<'_>, a: &'a Attribution) -> Decision<'a> {
    let limits = limits(bench);
    let unseen = Unseen::of(bench);
    let is_seen = |first: &&Hypothesis| {
        let gained = a.given.loss() - first.loss();
        let least = needed(bench, &a.given).max(material(bench, &first.parts[0].place));
        gained > least && unseen.shows(&first.attained, &a.given.attained)
    };
    // It is one of those that stand equally well that has to be seen: which of them is best is chance.
    let as_good =
        |lead: &Hypothesis| a.firsts.iter().take_while(|h| h.loss() - lead.loss() < limits.equal).any(|h| is_seen(&h));
    let Some(best) = a.firsts.first().filter(|lead| as_good(lead)) else { return nothing_found(bench, &unseen, a) };
    // Of those that stand equally well the one with the fewest values, then joints, and a number that is off before an effect.
    let gain = a.given.loss() - best.loss();
    let is_equal = |other: &&Hypothesis| {
        let behind = other.loss() - best.loss();
        // What is contained in the best, or hardly worse with fewer values, is preferred.
        behind < limits.equal || other.free() < best.free() && behind < SIMPLER * gain
    };
    let equal: Vec<&Hypothesis> = a.firsts.iter().filter(is_equal).collect();
    let plainness = |h: &&&Hypothesis| {
        let part = &h.parts[0];
        (h.free(), part.place.joints.len(), !part.cause.is_calibration())
    };
    let first = *equal.iter().min_by_key(plainness).unwrap_or(&best);
    let needed = limits.second.max(limits.second_share * gain);
    let is_needed = |pair: &&Hypothesis| {
        excess(bench, &unseen, best) > limits.second_excess
            && best.loss() - pair.loss() > needed
            && unseen.shows(&pair.attained, &best.attained)
    };
    let second = a.seconds.first().filter(is_needed);
    let answer = second.unwrap_or(first);
    let leading = match answer.parts.as_slice() {
        // A number that is off beside an effect: the effect is the answer.
        [a, b] if a.cause.is_calibration() && !b.cause.is_calibration() => 1,
        _ => 0,
    };
    let named = &answer.parts[leading];
    // The leading cause alone, and not the one beside which it was found.
    let is_leading = |h: &&Hypothesis| h.parts[0].is_where(named.cause, &named.place);
    let first = if second.is_some() { a.firsts.iter().find(is_leading).unwrap_or(first) } else { first };
    let (equivalent, places) = match second {
        Some(_) => (vec![named.cause], vec![named.place.clone()]),
        None => equals(&equal, first),
    };
    let rivals = if second.is_some() { &a.seconds } else { &a.firsts };
    let is_rival = |h: &&Hypothesis| h.parts.iter().zip(&answer.parts).any(|(a, b)| !a.is_where(b.cause, &b.place));
    let margin = rivals.iter().find(is_rival).map_or(f64::INFINITY, |rival| rival.loss() - answer.loss());
    let excess = excess(bench, &unseen, answer);
    let verdict = verdict(bench, &unseen, &a.given.attained, answer, excess);
    Decision { verdict, answer, first, leading, equivalent, places, excess, gain, margin }
}

/// The answer where no cause is seen.
fn nothing_found<'a>(bench: &Bench<'_>, unseen: &Unseen<'_>, a: &'a Attribution) -> Decision<'a> {
    let samples = bench.noise.count().max(1) as f64;
    let excess = excess(bench, unseen, &a.given);
    let allowed = limits(bench).explained + (LEFT_OVER * taken_out(bench, &a.given) / samples).min(LEFT_AT_MOST);
    let explained = excess < allowed || may_be_noise(bench, &a.given.attained.residual);
    let verdict = match (explained, a.given.attained.is_believed(bench)) {
        (true, true) => Verdict::None,
        (true, false) => Verdict::Calibration,
        (false, _) => Verdict::Unexplained,
    };
    Decision {
        verdict,
        answer: &a.given,
        first: &a.given,
        leading: 0,
        equivalent: Vec::new(),
        places: Vec::new(),
        excess,
        gain: 0.0,
        margin: f64::INFINITY,
    }
}

/// Causes that stand as well as the first, which is one of them and leads them, and places on which that stands as well.
fn equals(equal: &[&Hypothesis], first: &Hypothesis) -> (Vec<Cause>, Vec<Place>) {
    let (mut causes, mut places) = (Vec::new(), Vec::new());
    let mut equal = equal.to_vec();
    equal.sort_by_key(|h| !std::ptr::eq(*h, first));
    for other in equal {
        let part = &other.parts[0];
        if !causes.contains(&part.cause) {
            causes.push(part.cause);
        }
        if part.cause == first.parts[0].cause && !places.contains(&part.place) {
            places.push(part.place.clone());
        }
    }
    (causes, places)
}

/// The kind of an answer that leaves so much, where the robot as given attains so much.
fn verdict(bench: &Bench<'_>, unseen: &Unseen<'_>, given: &Attained, answer: &Hypothesis, excess: f64) -> Verdict {
    let (limits, taken) = (limits(bench), &answer.attained);
    let hunts = answer.parts.iter().any(|part| part.cause.is_play());
    let share = if hunts { HUNTING_CLOSES } else { limits.closes };
    let closes = |given: f64, left: f64| given > 0.0 && left < (1.0 - share) * given;
    let explained = excess < limits.explained
        || closes(fitted_excess(bench, given), fitted_excess(bench, taken))
            && unseen.excess(given).zip(unseen.excess(taken)).is_none_or(|(given, left)| closes(given, left));
    let calibration = answer.parts.iter().all(|part| part.cause.is_calibration());
    // On the floor, where numbers are not recalibrated one by one, this is where they are.
    let within = !bench.case.is_clamped() && answer.parts.iter().all(|part| part.is_believed(bench));
    match (explained, calibration) {
        (false, _) => Verdict::Unexplained,
        (true, true) if within => Verdict::None,
        (true, true) => Verdict::Calibration,
        (true, false) => Verdict::Effect,
    }
}
