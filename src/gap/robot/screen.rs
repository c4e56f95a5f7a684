//! Which cause, on which joints, looks most like what is left? Every cause is simulated on every joint that may have it,
//! and what it changes is held against the residual in the metric of [`Noise`](super::noise::Noise).

use super::bench::Bench;
use super::cause::{Cause, Change};
use super::hold_scan::hold_scan;
use super::layout::compared_from_s;
use super::noise::Noise;
use super::part::{Part, change};
use super::place::{Place, places};
use super::start::{Grid, Start};
use super::suspects::Suspects;
use crate::joint::EffectId;
use rayon::prelude::*;

/// What a cause changes on a place.
pub(super) struct Column {
    pub cause: Cause,
    pub place: Place,
    /// Which start of the cause.
    number: usize,
    start: Start,
    change: Vec<f64>,
}

/// A candidate by its first-order gain.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub cause: Cause,
    pub place: Place,
    /// Values as they are searched.
    pub values: Vec<f64>,
    /// By how much it would lower the weighed sum of squares.
    pub gain: f64,
}

impl Candidate {
    /// Whether it is the same cause on the same place.
    pub fn is_where(&self, other: &Self) -> bool {
        self.cause == other.cause && self.place == other.place
    }
}

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
    let mut by_group: Vec<Vec<Try>> = Vec::new();
    for group in &bench.groups {
        let mut tries = Vec::new();
        for cause in joint_causes(considered) {
            for joint in group {
                if cause.is_play() && !suspects.play.contains(joint) {
                    continue;
                }
                let starts = starts(cause, *joint).into_iter().enumerate();
                tries.extend(starts.map(|(number, start)| (cause, *joint, number, start)));
            }
        }
        by_group.push(tries);
    }
    let column = |(cause, joint, number, start): Try, change: Vec<f64>| Column {
        cause,
        place: Place::joint(joint),
        number,
        start,
        change,
    };
    let all_at_once = |k: usize| -> Vec<Column> {
        let tries: Vec<(&Vec<usize>, &Try)> =
            bench.groups.iter().zip(&by_group).filter_map(|(group, tries)| Some((group, tries.get(k)?))).collect();
        let changes: Vec<Change> = tries
            .iter()
            .map(|(_, (cause, joint, _, start))| change(bench, *cause, &Place::joint(*joint), &start.values))
            .collect();
        if let Some(all) = bench.glance(&changes, None) {
            let of = |(group, of): &(&Vec<usize>, &Try)| column((*of).clone(), bench.restricted(all.clone(), group));
            return tries.iter().map(of).collect();
        }
        // One of them runs away: each on its own.
        let alone = |((group, of), change): (&(&Vec<usize>, &Try), &Change)| {
            let changes = std::slice::from_ref(change);
            let difference = bench.glance(changes, None)?;
            Some(column((*of).clone(), bench.restricted(difference, group)))
        };
        tries.iter().zip(&changes).filter_map(alone).collect()
    };
    let longest = by_group.iter().map(Vec::len).max().unwrap_or(0);
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
        Some(Column { cause, place, number, start, change })
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
        Some(Column { cause: named.cause, place, number: 0, start: Start::fixed(&named.values), change })
    };
    places.into_par_iter().filter_map(column).collect()
}

/// Whether no robot has it in all its joints.
fn is_of_one_joint(cause: Cause) -> bool {
    use EffectId::{Backlash, EndStop, PositionFriction};
    [Backlash, EndStop, PositionFriction].into_iter().any(|effect| cause == Cause::Effect(effect))
}

/// Whether it shows late, if at all.
fn grows(cause: Cause) -> bool {
    cause == Cause::Effect(EffectId::FrictionDrift)
}

/// Until when the screening simulates \[s\].
pub(super) fn window_s(bench: &Bench<'_>) -> f64 {
    bench.case.logs.iter().map(|log| compared_from_s(bench.case, log) + WINDOW_S).fold(0.0, f64::max)
}

/// Candidates by gain, best first. A set of joints that was not tried as such is the sum of its joints.
pub(super) fn rank(bench: &Bench<'_>, columns: &[Column], residual: &[f64]) -> Vec<Candidate> {
    let windowed = (!bench.case.is_clamped()).then(|| {
        let window = window_s(bench);
        let mut seen = vec![false; bench.layout.len];
        for row in &bench.layout.rows {
            let t_s = &bench.case.logs[row.log].log.t_s;
            for (k, t) in row.range.clone().zip(t_s) {
                seen[k] = *t <= window + 1e-9;
            }
        }
        bench.noise.only(|k| seen[k])
    });
    // A cause is not to stand behind numbers that would have to be far off.
    let stiffer = |noise: &Noise| noise.stiffer(noise.temper(residual));
    let noise = stiffer(&bench.noise);
    let whole = noise.weigh(residual.to_vec());
    let early = windowed.as_ref().map(stiffer).map(|noise| (noise.weigh(residual.to_vec()), noise));
    let judge = |members: &[&Column], place: &Place| {
        let in_full = (&noise, &whole);
        let (noise, residual) = match &early {
            Some((residual, noise)) if !grows(members.first()?.cause) => (noise, residual),
            _ => in_full,
        };
        let mut change = members.first()?.change.clone();
        for member in &members[1..] {
            for (sum, other) in change.iter_mut().zip(&member.change) {
                *sum += other;
            }
        }
        let change = noise.weigh(change);
        let (along, size) = (noise.dot(residual, &change), noise.dot(&change, &change));
        if !(size > 1e-9) {
            return None;
        }
        let start = &members[0].start;
        let amplitude = (along / size).clamp(start.amplitude[0], start.amplitude[1]);
        let gain = amplitude * (2.0 * along - amplitude * size);
        Some(Candidate { cause: members[0].cause, place: place.clone(), values: start.at(amplitude), gain })
    };
    let places = places(bench.case.model(), &bench.layout.moving());
    let mut kinds: Vec<(Cause, usize)> = columns.iter().map(|column| (column.cause, column.number)).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let of_kind = |(cause, number): (Cause, usize)| -> Vec<Candidate> {
        let those: Vec<&Column> =
            columns.iter().filter(|column| (column.cause, column.number) == (cause, number)).collect();
        let on = |place: &Place| {
            if let Some(whole) = those.iter().find(|column| column.place == *place) {
                return judge(&[whole], place);
            }
            let is_member =
                |column: &&Column| column.place.joints.len() == 1 && place.joints.contains(&column.place.joints[0]);
            let members: Vec<&Column> = those.iter().copied().filter(is_member).collect();
            (members.len() == place.joints.len()).then(|| judge(&members, place)).flatten()
        };
        let everywhere = std::iter::once(Place::robot()).filter(|_| cause.is_of_robot());
        everywhere
            .chain(places.iter().filter(|_| !cause.is_of_robot()).cloned())
            .filter_map(|place| on(&place))
            .collect()
    };
    let mut candidates: Vec<Candidate> = kinds.into_par_iter().flat_map(of_kind).collect();
    candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    candidates
}

/// The smallest size of a cause that would have been named, on the joint where it shows best: value and name of its
/// first parameter. Proportional causes are scaled; of the others the least one that was tried and shows is taken.
pub(super) fn detectable(bench: &Bench<'_>, columns: &[Column], cause: Cause, threshold: f64) -> Option<f64> {
    let sizes =
        columns.iter().filter(|column| column.cause == cause && column.place.joints.len() <= 1).filter_map(|column| {
            let weighed = bench.noise.weigh(column.change.clone());
            let seen = bench.noise.dot(&weighed, &weighed);
            let amplitude = (threshold / seen.max(1e-12)).sqrt();
            let is_proportional = column.start.amplitude != [1.0, 1.0];
            let within = amplitude <= column.start.amplitude[1].abs().max(1.0);
            if !(within && (is_proportional || amplitude <= 1.0)) {
                return None;
            }
            let values = column.start.at(if is_proportional { amplitude } else { 1.0 });
            let named = change(bench, cause, &column.place, &values).values[0];
            // How far from nothing the matter: the smaller, the harder to see.
            Some((column.strength(seen, threshold), named))
        });
    sizes.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, named)| named)
}

impl Column {
    /// What is to be smallest: the amplitude of a proportional cause, else how much more than needed is seen.
    fn strength(&self, seen: f64, threshold: f64) -> f64 {
        if self.start.amplitude == [1.0, 1.0] { seen / threshold } else { (threshold / seen).sqrt() }
    }
}
