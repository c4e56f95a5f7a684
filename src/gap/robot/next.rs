//! The motion that would tell apart what these logs cannot.

use super::bench::{Bench, followed_s};
use super::case::CaseLog;
use super::decide::{Decision, told_apart};
use super::forward::predict;
use super::refine::Hypothesis;
use super::scatter::Scatter;
use super::tried::Attribution;
use crate::gap::{Next, Verdict};
use crate::number::chance::normal_tail;

/// Motions that are proposed: so many times as wide, and in words.
const WIDER: [(f64, &str); 4] = [
    (1.5, "The same motion with amplitudes 1.5 times as wide"),
    (2.0, "The same motion with amplitudes twice as wide"),
    (0.5, "The same motion with amplitudes half as wide"),
    (3.0, "The same motion with amplitudes three times as wide"),
];

/// The proposal that separates the answer from all that stand equally well best; `None` where nothing is to separate, or
/// no proposal does.
///
/// What a proposal would show is the difference of both hypotheses as they are, in units of the noise.
pub(super) fn next(bench: &Bench<'_>, tried: &Attribution, decision: &Decision<'_>) -> Option<Next> {
    if decision.verdict != Verdict::Effect || decision.equivalent.len() + decision.places.len() < 3 {
        return None;
    }
    let answer = &decision.answer;
    let is_rival = |h: &&Hypothesis| {
        let part = &h.parts[0];
        !part.is_where(answer.parts[0].cause, &answer.parts[0].place) && decision.equivalent.contains(&part.cause)
    };
    let rivals: Vec<&Hypothesis> = tried.firsts.iter().filter(is_rival).collect();
    let proposals = WIDER.iter().filter_map(|(factor, what)| {
        let weakest = rivals.iter().map(|rival| power(bench, answer, rival, *factor));
        let power = weakest.fold(None, |least: Option<f64>, power| {
            let power = power?;
            Some(least.map_or(power, |least| least.min(power)))
        })?;
        Some(Next { what: (*what).to_owned(), power, motion: None })
    });
    proposals.max_by(|a, b| a.power.total_cmp(&b.power))
}

/// Probability that a motion with wider amplitudes tells two hypotheses apart.
fn power(bench: &Bench<'_>, answer: &Hypothesis, rival: &Hypothesis, factor: f64) -> Option<f64> {
    let wide: Vec<CaseLog> = bench.case.logs.iter().map(|log| log.widened(factor)).collect();
    let none = Scatter::none(bench.case.model());
    let readings = |h: &Hypothesis| {
        let changes = h.changes(bench);
        let step_s = followed_s(bench.steps.coarse, &changes);
        let one = |log| predict(bench.case, log, None, (&none, &changes), step_s, f64::INFINITY).ok().flatten();
        Some(bench.layout.predicted(bench.case, &wide.iter().map(one).collect::<Option<Vec<_>>>()?))
    };
    let (a, b) = (readings(answer)?, readings(rival)?);
    // What the uncertain numbers could imitate counts for nothing, as in the decision.
    let between = bench.noise_of_all.weigh(a.iter().zip(&b).map(|(a, b)| a - b).collect());
    let apart = bench.noise_of_all.dot(&between, &between);
    // The statistic has the mean `apart` and four times that as variance.
    let deviates = (told_apart(bench) - apart) / (2.0 * apart.sqrt().max(1e-9));
    deviates.is_finite().then(|| normal_tail(deviates))
}
