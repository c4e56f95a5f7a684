//! Where the gap lies: in which logs and phases, at which values of which variable, and on which stage of the chain.
//!
//! The angle residual says how much of the gap each log and phase holds; the residual torque says what it depends on.
//! Nothing here looks at a catalogue of effects, so it answers also where none of them fits.

use super::log_part::{LogPart, NOTICEABLE, exceeds};
use super::map::map;
use super::stage::stage_of;
use super::variables::{Form, best, explained_by, explained_by_each, shares};
use crate::gap::diagnosis::{MapCell, Phase, Variable, Where};
use crate::joint::LawActs;

/// Up to this share it must show in the residual torque too, in one cell of the map at least.
const OBVIOUS: f64 = 1.0;
/// A log has more than its share of the gap if it exceeds it by this factor.
const MORE: f64 = 1.2;

/// Where the gap of a recalibrated model lies, over all logs together.
///
/// The stage is what the signature suggests; an effect that explains the gap knows better:
/// - The motor, where the torque that is lacking sits where the motor saturates.
/// - Where one variable explains it: the delay if that is the setpoint's slope, the motor if it is a torque along the
///   motor's, the gearing if it is a friction that goes with the motor's torque.
/// - The gearing, where nothing else explains it and the joint moves more freely about its reversals than elsewhere.
/// - The motor, where free logs do not have it; the sensor, where a friction that goes with the amplitude explains it;
///   the delay, where all logs are driven and nothing explains it.
/// - Else the link.
///
/// Where the residuals do not exceed their noise, nothing is named and the map's shares are zero.
pub fn localise(parts: &[LogPart]) -> Where {
    let cells = map(parts);
    let shown = if cells.iter().any(|c| c.significant) { NOTICEABLE } else { OBVIOUS };
    if !exceeds(parts, shown) {
        let cells = cells.into_iter().map(|cell| MapCell { share: 0.0, ..cell }).collect();
        return Where { cells, ..nowhere() };
    }
    let explained = explained_by_each(parts);
    let best = best(&explained);
    Where {
        stage: Some(stage_of(parts, best)),
        variable: best.map(|e| e.variable),
        range: best.and_then(|e| e.binned.range()),
        share: best.map_or(0.0, |e| e.binned.energy_in_range()),
        phase: largest(&cells),
        logs: with_more_than_their_share(parts, &cells),
        variables: shares(&explained),
        profile: best.map(|e| e.binned.profile()).unwrap_or_default(),
        cells,
    }
}

/// The place by a law: its variable, and the range in which it is strongest, with what the torque that is lacking does along that
/// variable.
pub(in crate::gap) fn place_by_law(
    place: &mut Where,
    parts: &[LogPart],
    (acts, variable): (LawActs, Variable),
    range: [f64; 2],
) {
    let form = match (acts, variable) {
        (LawActs::Friction, _) | (_, Variable::Speed) => Form::AgainstMotion,
        (_, Variable::Load | Variable::Torque | Variable::SetpointRate) => Form::Along,
        _ => Form::Plain,
    };
    let binned = explained_by(parts, &[(variable, form)]).pop().map(|explained| explained.binned);
    place.variable = Some(variable);
    place.range = Some(range);
    place.share = binned.as_ref().map_or(0.0, |binned| binned.energy_within(in_bins(variable, range)));
    place.profile = binned.map(|binned| binned.profile()).unwrap_or_default();
}

/// A range of a law's variable as bins have it: these know the size of some variables alone.
fn in_bins(variable: Variable, [low, high]: [f64; 2]) -> [f64; 2] {
    let is_size = matches!(variable, Variable::Speed | Variable::Load | Variable::Torque | Variable::SetpointRate);
    if !is_size || low >= 0.0 {
        return [low, high];
    }
    let least = if high < 0.0 { -high } else { 0.0 };
    [least, (-low).max(high)]
}

fn nowhere() -> Where {
    Where {
        stage: None,
        variable: None,
        range: None,
        phase: None,
        logs: Vec::new(),
        share: 0.0,
        cells: Vec::new(),
        variables: Vec::new(),
        profile: Vec::new(),
    }
}

/// The phase with the largest share.
fn largest(cells: &[MapCell]) -> Option<Phase> {
    let share = |phase: Phase| cells.iter().filter(|c| c.phase == phase).map(|c| c.share).sum::<f64>();
    Phase::ALL
        .into_iter()
        .map(|p| (share(p), p))
        .filter(|(s, _)| *s > 0.0)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|x| x.1)
}

fn with_more_than_their_share(parts: &[LogPart], cells: &[MapCell]) -> Vec<String> {
    let time_s: f64 = parts.iter().flat_map(|p| &p.weights_s).sum();
    let mut logs: Vec<(f64, &str)> = parts
        .iter()
        .filter_map(|p| {
            let share: f64 = cells.iter().filter(|c| c.file == p.file).map(|c| c.share).sum();
            let fair = p.weights_s.iter().sum::<f64>() / time_s;
            (share > MORE * fair).then_some((share, p.file.as_str()))
        })
        .collect();
    logs.sort_by(|a, b| b.0.total_cmp(&a.0));
    logs.into_iter().map(|(_, file)| file.to_owned()).collect()
}

#[cfg(test)]
#[path = "localise_tests.rs"]
mod tests;
