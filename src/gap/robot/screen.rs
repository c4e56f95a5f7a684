//! What every cause changes on every joint that may have it: each is simulated.

use super::bench::Bench;
use super::cause::{Cause, Change};
use super::column::{Column, rows};
use super::hold_scan::hold_scan;
use super::layout::compared_from_s;
use super::part::{Part, change};
use super::place::{Place, places};
use super::start::{Grid, Start};
use super::suspects::Suspects;
use crate::joint::EffectId;
use rayon::prelude::*;

/// How long a walk is simulated to screen a cause: from where it is compared on \[s\].
const WINDOW_S: f64 = 1.3;
/// Where every try costs a walk: joints that are tried alone, joints of which pairs are tried as such (other pairs are
/// sums of their joints), and joints of which three in four must be in a larger set.
const ALONE: usize = 4;
const IN_PAIRS: usize = 3;
const IN_SETS: usize = 6;

const HOLD: Cause = Cause::Effect(EffectId::SetpointHold);

/// Columns of all causes that are considered.
pub(super) fn columns(bench: &Bench<'_>, considered: &(dyn Fn(Cause) -> bool + Sync), residual: &[f64]) -> Vec<Column> {
    let suspects = Suspects::of(bench, residual);
    if bench.case.is_clamped() {
        clamped(bench, considered, &suspects, residual)
    } else {
        free(bench, considered, &suspects)
    }
}

fn joint_causes(considered: &dyn Fn(Cause) -> bool) -> Vec<Cause> {
    Cause::all().filter(|cause| !cause.is_of_robot() && considered(*cause)).collect()
}

fn starts(bench: &Bench<'_>, cause: Cause, joint: usize, grid: Grid) -> Vec<Start> {
    let model = bench.case.model();
    let friction = model.joint_ids().nth(joint).map_or([0.0; 2], |id| {
        let law = &bench.case.nominal.joints.drive(id).chain.friction;
        [law.coulomb_nm, law.viscous_nm_s_rad]
    });
    cause.starts(&bench.reach[joint], friction, &bench.body, grid)
}

/// Puts holds of the setpoint that explain most of another residual in place of those among the columns.
pub(super) fn rescan_holds(
    bench: &Bench<'_>,
    columns: &mut Vec<Column>,
    considered: &(dyn Fn(Cause) -> bool + Sync),
    residual: &[f64],
) {
    if bench.case.is_clamped() && considered(HOLD) {
        columns.retain(|column| column.cause != HOLD);
        columns.extend(clamped(bench, &|cause| cause == HOLD, &Suspects::of(bench, residual), residual));
    }
}

/// Legs of a clamped robot do not feel each other: the same number of start is tried on all of them at once.
fn clamped(
    bench: &Bench<'_>,
    considered: &dyn Fn(Cause) -> bool,
    suspects: &Suspects,
    residual: &[f64],
) -> Vec<Column> {
    type Try = (Cause, usize, usize, Start);
    let holds_s = if considered(HOLD) { hold_scan(bench, residual) } else { Vec::new() };
    let starts = |cause: Cause, joint: usize| match cause == HOLD && !holds_s.is_empty() {
        true => holds_s.iter().map(|hold_s| Start::fixed(&[*hold_s])).collect(),
        false => starts(bench, cause, joint, Grid::Fine),
    };
    let mut by_limb: Vec<Vec<Try>> = Vec::new();
    for limb in bench.limbs.joints() {
        let mut tries = Vec::new();
        for cause in joint_causes(considered) {
            for joint in limb {
                if cause.is_play() && !suspects.play.contains(joint) {
                    continue;
                }
                let starts = starts(cause, *joint).into_iter().enumerate();
                tries.extend(starts.map(|(number, start)| (cause, *joint, number, start)));
            }
        }
        by_limb.push(tries);
    }
    let column = |(cause, joint, number, start): Try, limb: &[usize], change: &[f64]| Column {
        cause,
        place: Place::joint(joint),
        number,
        start,
        rows: rows(bench, Some(limb), change),
    };
    let all_at_once = |k: usize| -> Vec<Column> {
        let tries: Vec<(&Vec<usize>, &Try)> =
            bench.limbs.joints().iter().zip(&by_limb).filter_map(|(limb, tries)| Some((limb, tries.get(k)?))).collect();
        let changes: Vec<Change> = tries
            .iter()
            .map(|(_, (cause, joint, _, start))| change(bench, *cause, &Place::joint(*joint), &start.values))
            .collect();
        if let Some(all) = bench.glance(&changes, None) {
            let of = |(limb, of): &(&Vec<usize>, &Try)| column((*of).clone(), limb, &all);
            return tries.iter().map(of).collect();
        }
        // One of them runs away: each on its own.
        let alone = |((limb, of), change): (&(&Vec<usize>, &Try), &Change)| {
            let changes = std::slice::from_ref(change);
            let difference = bench.glance(changes, None)?;
            Some(column((*of).clone(), limb, &difference))
        };
        tries.iter().zip(&changes).filter_map(alone).collect()
    };
    let longest = by_limb.iter().map(Vec::len).max().unwrap_or(0);
    (0..longest).into_par_iter().flat_map(all_at_once).collect()
}

/// With the trunk free every try is a walk: on the joints that have most left, on sets of them, and on the whole robot.
fn free(bench: &Bench<'_>, considered: &dyn Fn(Cause) -> bool, suspects: &Suspects) -> Vec<Column> {
    let among = |place: &Place, first: usize| {
        place.joints.iter().filter(|joint| suspects.joints.iter().take(first).any(|suspect| suspect == *joint)).count()
    };
    let moving = bench.layout.moving();
    let is_near = |place: &Place| match place.joints.len() {
        1 => among(place, ALONE) == 1,
        2 => among(place, IN_PAIRS) == 2,
        n => n == moving.len() || 4 * among(place, IN_SETS) >= 3 * n,
    };
    let mut tries: Vec<(Cause, Place, usize, Start)> = Vec::new();
    for place in places(bench.case.model(), &moving).into_iter().filter(is_near) {
        for cause in joint_causes(considered) {
            let most = place.joints.iter().filter(|joint| suspects.play.contains(joint)).count();
            if place.joints.len() > 4 && is_of_one_joint(cause) || cause.is_play() && 2 * most < place.joints.len() {
                continue;
            }
            // Of the set the joint that is asked for most.
            let most = |joint: &&usize| (bench.reach[**joint].torque_nm * 1e9) as u64;
            let Some(joint) = place.joints.iter().max_by_key(most) else { continue };
            let starts = starts(bench, cause, *joint, Grid::Coarse).into_iter().enumerate();
            tries.extend(starts.map(|(number, start)| (cause, place.clone(), number, start)));
        }
    }
    for cause in Cause::OF_ROBOT.into_iter().filter(|cause| considered(*cause)) {
        let starts = starts(bench, cause, 0, Grid::Coarse).into_iter().enumerate();
        tries.extend(starts.map(|(number, start)| (cause, Place::robot(), number, start)));
    }
    let window = window_s(bench);
    let one = |(cause, place, number, start): (Cause, Place, usize, Start)| {
        let changes = [change(bench, cause, &place, &start.values)];
        let change = bench.glance(&changes, (!grows(cause)).then_some(window))?;
        Some(Column { cause, place, number, start, rows: rows(bench, None, &change) })
    };
    tries.into_par_iter().filter_map(one).collect()
}

/// The same cause on fewer of its joints, and on more.
pub(super) fn around(bench: &Bench<'_>, named: &Part) -> Vec<Column> {
    let contains = |a: &Place, b: &Place| b.joints.iter().all(|joint| a.joints.contains(joint));
    let is_near =
        |place: &Place| *place != named.place && (contains(place, &named.place) || contains(&named.place, place));
    let places = places(bench.case.model(), &bench.layout.moving()).into_iter().filter(is_near);
    let places: Vec<Place> = places.collect();
    let until_s = window_s(bench);
    let column = |place: Place| {
        let change = bench.glance(&[change(bench, named.cause, &place, &named.values)], Some(until_s))?;
        let start = Start::fixed(&named.values);
        Some(Column { cause: named.cause, place, number: 0, start, rows: rows(bench, None, &change) })
    };
    places.into_par_iter().filter_map(column).collect()
}

/// Whether no robot has it in all its joints.
fn is_of_one_joint(cause: Cause) -> bool {
    use EffectId::{Backlash, EndStop, PositionFriction};
    [Backlash, EndStop, PositionFriction].into_iter().any(|effect| cause == Cause::Effect(effect))
}

/// Whether it shows late, if at all.
pub(super) fn grows(cause: Cause) -> bool {
    cause == Cause::Effect(EffectId::FrictionDrift)
}

/// Until when the screening simulates \[s\].
pub(super) fn window_s(bench: &Bench<'_>) -> f64 {
    bench.case.logs.iter().map(|log| compared_from_s(bench.case, log) + WINDOW_S).fold(0.0, f64::max)
}
