//! What a reader has to know beside an answer.

use super::decide::Decision;
use super::law_found::law_hinted;
use super::sentence::law_words;
use crate::gap::Verdict;
use crate::gap::hypothesis::demands::in_words;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::trial::loss;
use crate::gap::search::attribute::Attribution;
use crate::gap::search::differs::Differs;
use crate::number::math;

/// What it means that held-out logs were asked before the answer stood; `what` is what they had a say in.
pub(in crate::gap) fn flattered(what: &str) -> String {
    format!("{what} The held-out logs had a say in that, so their figures flatter the answer a little.")
}

/// Remarks, most important first.
pub(in crate::gap) fn notes(
    evidence: &Evidence,
    a: &Attribution,
    decision: &Decision<'_>,
    differs: &[Differs],
) -> Vec<String> {
    let mut notes: Vec<String> = in_words(&evidence.demands).into_iter().collect();
    notes.extend(differs.iter().map(Differs::in_words));
    if evidence.normal_beliefs {
        notes.push(flattered(
            "The fitted logs move numbers far beyond their beliefs, and so the held-out logs are predicted clearly worse: \
             the numbers were held to their beliefs.",
        ));
    }
    let law = (a.law_refuted || decision.drops_law(a)).then_some("a law");
    let mut refuted: Vec<&str> = Vec::new();
    for name in a.refuted.iter().chain(decision.dropped(a)).map(|e| e.id()).chain(law) {
        if !refuted.contains(&name) {
            refuted.push(name);
        }
    }
    if !refuted.is_empty() {
        let what = format!(
            "The fitted logs ask for {} as well, but with that the held-out logs are predicted no better, or worse: it was \
             left out.",
            refuted.join(", ")
        );
        notes.push(flattered(&what));
    }
    let is_open = decision.verdict == Verdict::Unexplained && decision.answer.model.law().is_none();
    if let Some(hint) = a.hint().filter(|_| is_open).and_then(law_hinted) {
        notes.push(format!(
            "What is left is most like {}: with that, parts of logs are predicted better by the rest of them. Whole logs are \
             not, so it says where to look, not what is there.",
            law_words(&hint)
        ));
    }
    if a.set_refuted && !evidence.held.is_empty() {
        notes.push(flattered(
            "The fitted logs ask for another set of causes, but with that the held-out logs are predicted clearly worse: it \
             was not taken.",
        ));
    }
    if let Some(seen) = evidence.gain_seen {
        let (ratio, sd) = (math::exp(seen.at), math::exp(seen.at) * seen.sd);
        notes.push(format!(
            "Along the measured motion the logged torques are {ratio:.2} \u{b1} {sd:.2} times what the stated gains ask for: \
             the drive's gain was weighed with that."
        ));
    }
    if !evidence.scale_known {
        notes.push(
            "No log is driven and no known mass is hung on: the logs show ratios of torques only; how large all of them \
             are is what the study believes."
                .to_owned(),
        );
    }
    if evidence.pooled_from.is_some() {
        notes.push(
            "The logs to be fitted do not show by themselves what all logs do: all were fitted together, and nothing was held \
             out. A further log would tell whether the answer predicts."
                .to_owned(),
        );
    } else if evidence.held.is_empty() {
        notes.push("The study names no \"validate\" log: logs were held out in turn.".to_owned());
    }
    let spread = evidence.fit.iter().zip(&decision.answer.fit).map(|(e, r)| (loss(e, r), e));
    if let Some((_, worst)) = spread.max_by(|a, b| a.0.total_cmp(&b.0))
        && decision.verdict == Verdict::Unexplained
        && evidence.fit.iter().any(|e| e.file != worst.file)
    {
        notes.push(format!("Most of the error that is left is in {}.", worst.file));
    }
    notes
}
