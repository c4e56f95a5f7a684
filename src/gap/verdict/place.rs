//! Where the gap lies: the torque that the recalibrated joint lacks along every log, and the stage it points to.

use super::decide::Decision;
use super::law_found::law_hinted;
use crate::gap::diagnosis::{LawFound, ResidualTorque, Verdict, Where};
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::trial::Trial;
use crate::gap::location::localise::{localise, place_by_law};
use crate::gap::location::log_part::LogPart;
use crate::gap::location::residual_torque::residual_torque;
use crate::gap::search::attribute::Attribution;
use crate::identify::{Experiment, JointModel};
use crate::joint::Stage;
use rayon::prelude::*;

/// The place of the gap, and the residual torque of each fitted, then of each held-out log.
///
/// An effect that explains the gap, or that is known so far, names the stage; otherwise the residual torque's signature
/// does.
pub(in crate::gap) fn place(
    evidence: &Evidence,
    a: &Attribution,
    decision: &Decision<'_>,
    found: Option<&LawFound>,
) -> (Where, Vec<ResidualTorque>) {
    let t = &a.calibrated;
    let fit = evidence.fit.iter().zip(&t.found.starts).zip(&t.fit);
    let held = evidence.held.iter().zip(&t.held_starts).zip(&t.held);
    let logs: Vec<(&Experiment, [f64; 2], &Vec<f64>)> = fit.chain(held).map(|((e, s), r)| (e, *s, r)).collect();
    let parts: Vec<LogPart> = logs
        .into_par_iter()
        .map(|(e, [first, second], residual)| {
            let chain = t.model.chain(&t.found.values, e);
            let torque = residual_torque(&chain, e, e.start_from(first, second), a.noise_rad);
            LogPart::new(&chain, e, residual.clone(), torque, a.noise_rad)
        })
        .collect();
    let mut place = localise(&parts);
    let by_law = |place: &mut Where, law: &Trial, stage: Option<Stage>| {
        if let Some(shape) = law.model.law() {
            place.stage = stage;
            let strongest = shape.strongest(&law.found.values[law.model.law_place()]);
            place_by_law(place, &parts, (shape.acts, shape.variable.into()), strongest);
        }
    };
    match (decision.verdict, decision.effect()) {
        (Verdict::Effect, Some(effect)) => place.stage = Some(effect.stage()),
        // Inertia, moment and friction are the link's.
        (Verdict::Calibration, _) => place.stage = Some(Stage::Link),
        (Verdict::None, _) => place.stage = None,
        // A measured law is better evidence than a signature.
        (Verdict::Unexplained, _) if decision.answer.model.law().is_some() => {
            by_law(&mut place, decision.answer, found.and_then(|found| found.table.stage()));
        }
        (Verdict::Unexplained, Some(effect)) => place.stage = Some(effect.stage()),
        (Verdict::Unexplained, None) => {
            if let Some(hint) = a.hint() {
                by_law(&mut place, hint, law_hinted(hint).and_then(|table| table.stage()));
            }
        }
        _ => {}
    }
    (place, parts.into_iter().map(|p| p.torque).collect())
}
