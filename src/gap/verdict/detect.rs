//! The smallest size of each effect that these logs would have shown.

use super::numbers::none_of;
use crate::fit::{Budget, Residuals};
use crate::gap::diagnosis::Detectable;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::model::COULOMB;
use crate::gap::hypothesis::trial::Trial;
use crate::gap::search::projector::Projector;
use crate::gap::search::sight::weighted;
use crate::identify::{Found, Problem};
use crate::joint::EffectId;
use crate::number::math;
use nalgebra::DVector;
use rayon::prelude::*;

/// Deviance at which an effect counts as shown: five standard deviations.
const SHOWN: f64 = 25.0;
/// An effect's size may be extrapolated from its mildest starting point by this factor, either way.
const REACH: f64 = 30.0;

/// Evaluations of what is not fitted again.
const AS_IT_IS: Budget = Budget { evaluations: 1 };

/// One entry for each effect, in their order; the joint is taken as `around` describes it, for an effect that this has as
/// if it were not there. The readings' noise has this standard deviation \[rad\], so many successive values of which
/// count as one.
pub(in crate::gap) fn detectable(
    evidence: &Evidence,
    noise: (f64, f64),
    around: &Trial,
    effects: &[EffectId],
) -> Vec<Detectable> {
    let found = |effect: &EffectId| around.effects().iter().position(|own| own == effect);
    let further: Vec<EffectId> = effects.iter().copied().filter(|effect| found(effect).is_none()).collect();
    let mut all = beside(evidence, noise, around, &further);
    for (effect, k) in effects.iter().filter_map(|effect| Some((*effect, found(effect)?))) {
        all.extend(beside(evidence, noise, &around.without(evidence, k, AS_IT_IS), &[effect]));
    }
    all.sort_by_key(|own| effects.iter().position(|effect| *effect == own.effect));
    all
}

/// The same of effects beside what `around` has.
fn beside(
    evidence: &Evidence,
    (noise_rad, correlation): (f64, f64),
    around: &Trial,
    effects: &[EffectId],
) -> Vec<Detectable> {
    let coarse = evidence.coarse();
    let found = around.begun_in(evidence, &coarse);
    let problem = Problem::new(&around.model, &coarse.fit);
    let Ok(blocks) = problem.linearise(&problem.coordinates_from(&found)) else { return Vec::new() };
    let projector = Projector::of(&blocks, around.model.free());
    let logs = &blocks[..coarse.fit.len()];
    let here: Vec<DVector<f64>> = logs.iter().map(|b| DVector::from_column_slice(&b.residual)).collect();
    // Weights are times: a sample of the full logs counts for its period.
    let samples: f64 = evidence.fit.iter().map(|e| e.weights_s.iter().sum::<f64>()).sum::<f64>();
    let count: f64 = evidence.fit.iter().map(|e| crate::gap::hypothesis::evidence::counts(e).sum::<f64>()).sum();
    let unit = noise_rad.powi(2) * correlation * samples / count;
    effects
        .par_iter()
        .map(|&effect| {
            let named = effect.named_parameters()[0];
            let none = none_of(effect, around.found.values[COULOMB]);
            let model = around.model.with(effect, &evidence.reach);
            let mut shown: Vec<(f64, f64)> = effect
                .starts(&evidence.reach)
                .into_iter()
                .filter_map(|start| {
                    let size = effect.named(&start, around.found.values[COULOMB])[0];
                    let values: Vec<f64> = around.found.values.iter().copied().chain(start).collect();
                    let model = model.clone().at(&values);
                    let with = Problem::new(&model, &coarse.fit);
                    let x = with.coordinates_from(&Found { values, ..found.clone() });
                    let mut moved = Vec::with_capacity(here.len());
                    for (k, here) in here.iter().enumerate() {
                        moved.push(weighted(&with, &x, k)? - here);
                    }
                    Some((size, projector.left(&moved) / unit))
                })
                .filter(|(_, deviance)| deviance.is_finite() && *deviance > 0.0)
                .collect();
            // Distance from the zero orders sizes; a limit's zero is infinity, where the largest is the mildest.
            let strength = |size: f64| if none.is_finite() { (size - none).abs() } else { 1.0 / size.abs() };
            shown.sort_by(|a, b| strength(a.0).total_cmp(&strength(b.0)));
            let value = if none.is_finite() && effect != EffectId::SetpointHold {
                // Near its zero an effect acts in proportion to its size.
                let nearest =
                    shown.iter().min_by(|a, b| math::ln(a.1 / SHOWN).abs().total_cmp(&math::ln(b.1 / SHOWN).abs()));
                nearest.and_then(|(size, deviance)| {
                    let factor = (SHOWN / deviance).sqrt();
                    (factor < REACH).then(|| none + (size - none).abs() * factor)
                })
            } else {
                shown.iter().find(|(_, deviance)| *deviance > SHOWN).map(|(size, _)| *size)
            };
            Detectable { effect, value, name: named.name, unit: named.unit }
        })
        .collect()
}
