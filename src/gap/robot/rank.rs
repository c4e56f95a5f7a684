//! Which cause, on which joints, looks most like what is left? What it changes is held against the residual in the metric of
//! [`Noise`].

use super::bench::Bench;
use super::cause::Cause;
use super::column::Column;
use super::decide::second_order;
use super::noise::{Noise, Pieces, Weighed};
use super::part::change;
use super::place::{Place, places};
use super::screen::{grows, window_s};
use rayon::prelude::*;

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

/// A residual with the noise by which changes are held against it.
struct Scale<'b> {
    bench: &'b Bench<'b>,
    noise: &'b Noise,
    residual: Weighed,
    /// By row of the layout, columns of the noise that are not 0 there.
    uncertain: Vec<Vec<usize>>,
}

impl<'b> Scale<'b> {
    fn new(bench: &'b Bench<'b>, noise: &'b Noise, residual: &[f64]) -> Self {
        let uncertain = bench.layout.rows.iter().map(|row| noise.columns_of(row.range.clone())).collect();
        let residual = noise.weigh(residual.to_vec());
        Self { bench, noise, residual, uncertain }
    }

    fn pieces(&self, column: &Column) -> Pieces {
        let mut sums = self.noise.nothing();
        for (row, change) in &column.rows {
            let from = self.bench.layout.rows[*row].range.start;
            self.noise.add(&mut sums, &self.residual, (from, &self.uncertain[*row]), change);
        }
        sums
    }

    /// Twice what two changes have in common on samples of both.
    fn shared(&self, a: &Column, b: &Column) -> f64 {
        let in_both = a.rows.iter().filter_map(|(row, of_a)| {
            let (_, of_b) = b.rows.iter().find(|(other, _)| other == row)?;
            Some(self.noise.product(self.bench.layout.rows[*row].range.start, of_a, of_b))
        });
        2.0 * in_both.sum::<f64>()
    }

    /// Of changes together, each once: what they have along the residual, and their size.
    fn together(&self, members: &[(&Column, &Pieces)]) -> (f64, f64) {
        let mut sums = self.noise.nothing();
        for (k, (column, pieces)) in members.iter().enumerate() {
            sums += (*pieces).clone();
            sums.add_shared(members[..k].iter().map(|(other, _)| self.shared(column, other)).sum());
        }
        self.noise.along_and_size(&sums, &self.residual)
    }
}

/// Candidates by gain, best first. A set of joints that was not tried as such is the sum of its joints.
pub(super) fn rank(bench: &Bench<'_>, columns: &[Column], residual: &[f64]) -> Vec<Candidate> {
    // A cause is not to stand behind numbers that would have to be far off.
    let stiffer = |noise: &Noise| noise.stiffer(noise.temper(residual));
    let (in_full, early) = (stiffer(&bench.noise), early_noise(bench).as_ref().map(stiffer));
    let scale = |noise| Scale::new(bench, noise, residual);
    let (in_full, early) = (scale(&in_full), early.as_ref().map(scale));
    let scale_of = |cause: Cause| early.as_ref().filter(|_| !grows(cause)).unwrap_or(&in_full);
    let pieces: Vec<Pieces> = columns.par_iter().map(|column| scale_of(column.cause).pieces(column)).collect();
    let judge = |members: &[usize], place: &Place| {
        let of: Vec<(&Column, &Pieces)> = members.iter().map(|k| (&columns[*k], &pieces[*k])).collect();
        let (first, _) = *of.first()?;
        let (along, size) = scale_of(first.cause).together(&of);
        if !(size > 1e-9) {
            return None;
        }
        let start = &first.start;
        let amplitude = (along / size).clamp(start.amplitude[0], start.amplitude[1]);
        let gain = amplitude * (2.0 * along - amplitude * size);
        Some(Candidate { cause: first.cause, place: place.clone(), values: start.at(amplitude), gain })
    };
    let places = places(bench.case.model(), &bench.layout.moving());
    let mut kinds: Vec<(Cause, usize)> = columns.iter().map(|column| (column.cause, column.number)).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let of_kind = |(cause, number): (Cause, usize)| -> Vec<Candidate> {
        let is_kind = |k: &usize| (columns[*k].cause, columns[*k].number) == (cause, number);
        let those: Vec<usize> = (0..columns.len()).filter(is_kind).collect();
        let on = |place: &Place| {
            if let Some(whole) = those.iter().find(|k| columns[**k].place == *place) {
                return judge(&[*whole], place);
            }
            let is_member = |k: &usize| {
                let joints = &columns[*k].place.joints;
                joints.len() == 1 && place.joints.contains(&joints[0])
            };
            let members: Vec<usize> = those.iter().copied().filter(is_member).collect();
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

/// With the trunk free: the noise of the samples that every column has.
fn early_noise(bench: &Bench<'_>) -> Option<Noise> {
    if bench.case.is_clamped() {
        return None;
    }
    let window = window_s(bench);
    let mut seen = vec![false; bench.layout.len];
    for row in &bench.layout.rows {
        let t_s = &bench.case.logs[row.log].log.t_s;
        for (k, t) in row.range.clone().zip(t_s) {
            seen[k] = *t <= window + 1e-9;
        }
    }
    Some(bench.noise.only(|k| seen[k]))
}

/// The smallest size of each cause that would have been named, on the joint where it shows best: value and name of its
/// first parameter. Proportional causes are scaled; of the others the least one that was tried and shows is taken.
pub(super) fn detectable<'c>(
    bench: &'c Bench<'_>,
    columns: &'c [Column],
    threshold: f64,
) -> impl Fn(Cause) -> Option<f64> + 'c {
    let scale = Scale::new(bench, &bench.noise, &vec![0.0; bench.layout.len]);
    move |cause| {
        let single = columns.iter().filter(|column| column.cause == cause && column.place.joints.len() <= 1);
        let sizes = single.filter_map(|column| {
            let pieces = scale.pieces(column);
            let (_, seen) = scale.noise.along_and_size(&pieces, &scale.residual);
            // The larger it is, the more uncertain numbers take out of it, and the more has to be left.
            let seen = seen - second_order(bench) * (pieces.squares() - seen);
            let amplitude = (threshold / seen.max(1e-12)).sqrt();
            let is_proportional = column.start.is_proportional();
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
}
