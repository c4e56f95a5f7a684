//! The law of an answer as a table: its curve with its uncertainty, what it closes, and what it looks like.

use super::decide::Decision;
use super::numbers::spread_of;
use crate::gap::diagnosis::LawFound;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::held_out::HeldOut;
use crate::gap::hypothesis::trial::Trial;
use crate::gap::location::looks_like::{NOTHING, look};
use crate::gap::search::attribute::Attribution;
use crate::joint::LawTable;

/// The law of the answer; `None` where it has none.
pub(in crate::gap) fn law_found(
    joint: &str,
    evidence: &Evidence,
    held: &HeldOut,
    a: &Attribution,
    decision: &Decision<'_>,
) -> Option<LawFound> {
    let answer = decision.answer;
    let law = answer.model.law()?;
    let place = answer.model.law_place();
    let curve = |values: &[f64]| law.values(&values[place.clone()]);
    let sd = spread_of(evidence, answer, law.at.len(), &curve);
    let mut table = table_of(answer)?;
    table.joints = vec![joint.to_owned()];
    let rms = |t: &Trial| held.rms_rad(&held.residuals(evidence, t));
    let (calibrated, before, after) = (rms(&a.calibrated), rms(&a.best), rms(answer));
    let left = calibrated.max(before) - a.noise_rad;
    table.closed = (left > 0.0).then(|| ((before - after) / left).min(1.0));
    // It predicts other logs, so that it is there, even where each of its values by itself is uncertain.
    let seen = look(&table, sd.as_deref());
    let seen = if seen.words == NOTHING { look(&table, None) } else { seen };
    seen.told(&mut table);
    Some(LawFound { table, sd, after })
}

/// The law of a hypothesis that parts of logs show and whole logs do not bear out, and what it looks like.
pub(in crate::gap) fn law_hinted(hint: &Trial) -> Option<LawTable> {
    let mut table = table_of(hint)?;
    look(&table, None).told(&mut table);
    Some(table)
}

/// The curve of a hypothesis with a law.
fn table_of(trial: &Trial) -> Option<LawTable> {
    let law = trial.model.law()?;
    let values = law.values(&trial.found.values[trial.model.law_place()]);
    Some(LawTable::new(law.variable, law.acts, law.at.to_vec(), values))
}
