//! The motion that would tell apart what these logs cannot.

use super::attribute::Attribution;
use super::bench::{Bench, followed_s};
use super::decide::Decision;
use super::forward::predict;
use super::refine::Hypothesis;
use super::scatter::Scatter;
use crate::gap::{Next, Verdict};
use statrs::distribution::{ContinuousCDF, Normal};

/// Deviance by which two hypotheses must differ to be told apart.
const TOLD_APART: f64 = 40.0;
/// Motions that are proposed: so many times as wide, and in words.
const WIDER: [(f64, &str); 4] = [
    (1.5, "the same motion with amplitudes 1.5 times as wide"),
    (2.0, "the same motion with amplitudes twice as wide"),
    (0.5, "the same motion with amplitudes half as wide"),
    (3.0, "the same motion with amplitudes three times as wide"),
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
        let is_answer = (part.cause, &part.place) == (answer.parts[0].cause, &answer.parts[0].place);
        !is_answer && decision.equivalent.contains(&part.cause)
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
    let none = Scatter::none(bench.case.model());
    let mut apart = 0.0;
    for log in &bench.case.logs {
        let wide = log.widened(factor);
        let of = |h: &Hypothesis| {
            let changes = h.changes(bench);
            let step_s = followed_s(bench.steps.coarse, &changes);
            predict(bench.case, &wide, &none, &changes, step_s, f64::INFINITY).ok().flatten()
        };
        let (a, b) = (of(answer)?, of(rival)?);
        for joint in bench.layout.moving() {
            let pairs = a.reading_rad[joint].iter().zip(&b.reading_rad[joint]);
            apart += pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / bench.sigma_rad.powi(2);
        }
    }
    // The statistic has the mean `apart` and four times that as variance.
    let normal = Normal::new(apart, 2.0 * apart.sqrt().max(1e-9)).ok()?;
    Some(1.0 - normal.cdf(TOLD_APART))
}
