//! What a hypothesis leaves with the uncertain numbers really adapted: the robot is simulated with them.
//!
//! To first order many a motion can be imitated by numbers that are off; in a drop, which amplifies them, no robot with
//! such numbers does it.

use super::bench::Bench;
use super::decide::MATERIAL;
use super::place::Place;
use super::recalibrate::{price, scattered};
use super::refine::Hypothesis;
use super::scatter::Number;
use super::unseen::Unseen;

/// Steps for one hypothesis, and halvings of one that explains less.
const STEPS: usize = 4;
const HALVINGS: i32 = 3;

/// What a hypothesis leaves with its numbers.
#[derive(Clone)]
pub(super) struct Attained {
    /// The weighed sum of squares over the samples that fits see, the price of the numbers included.
    pub price: f64,
    /// Measured less simulated, what the sensors have in common taken out \[rad\].
    pub residual: Vec<f64>,
    /// How far the uncertain numbers are off, in their standard deviations.
    pub sizes: Vec<f64>,
}

/// A number that had to move by more of its standard deviations is not as the study believes.
pub(super) const BELIEVED_SD: f64 = 3.0;

/// A joint whose gap is so many times what its numbers leave of it shows that they are off, if one of them moved by so many
/// of its standard deviations.
const SHOWS: f64 = 1.25;
const MOVED_SD: f64 = 1.5;

impl Attained {
    /// Whether every number is as the study believes, and none is seen to be another.
    pub fn is_believed(&self, bench: &Bench<'_>) -> bool {
        let rms = |residual: &[f64], joint: usize| {
            let rows = bench.layout.joints().filter(|(of, _)| *of == joint);
            let samples = rows.flat_map(|(_, row)| row.range.clone()).filter(|k| bench.layout.compared[*k]);
            samples.map(|k| residual[k].powi(2)).sum::<f64>().sqrt()
        };
        let gap = bench.gap();
        let shows = |number: &Number| match number {
            Number::Mass(_) => false,
            Number::Coulomb(joint) | Number::Viscous(joint) => rms(&gap, *joint) > SHOWS * rms(&self.residual, *joint),
        };
        bench.numbers.iter().zip(&self.sizes).all(|(number, size)| {
            size.abs() <= MOVED_SD
                || size.abs() <= BELIEVED_SD && !shows(number)
                || size.abs() > BELIEVED_SD && !self.closes(bench, *number, &gap)
        })
    }

    /// Whether, where a number acts, recalibration closes more of the held-out samples than two honest simulations of one
    /// robot differ by: numbers that move far and close nothing are how one simulates.
    fn closes(&self, bench: &Bench<'_>, number: Number, gap: &[f64]) -> bool {
        let place = match number {
            Number::Coulomb(joint) | Number::Viscous(joint) => Place::joint(joint),
            Number::Mass(body) => bench.limb_of(body),
        };
        let rows = bench.layout.joints().filter(|(joint, _)| place.joints.contains(joint));
        let weight = &bench.noise_of_all.weight;
        let held = rows.flat_map(|(_, row)| row.range.clone()).filter(|k| bench.layout.held[*k] && weight[*k] > 0.0);
        let (closed, count) = held.fold((0.0, 0.0), |(sum, count), k| {
            (sum + weight[k] * (gap[k].powi(2) - self.residual[k].powi(2)), count + 1.0)
        });
        // Where nothing is held out the fit alone has to be believed.
        count == 0.0 || closed > MATERIAL * count
    }
}

/// From how many of its standard deviations on a number counts as another than believed, where the farthest one moved so
/// many: beside a number that is not as believed those that may be are not told.
pub(super) fn counts_from_sd(farthest_sd: f64) -> f64 {
    if farthest_sd.abs() > BELIEVED_SD { BELIEVED_SD } else { MOVED_SD }
}

/// What a hypothesis attains on a clamped robot: the least of a few Gauss-Newton steps, each halved until it explains more.
/// On the floor, where the numbers are drawn, what is known to first order; so where the robot runs away.
pub(super) fn attained(bench: &Bench<'_>, hypothesis: &Hypothesis) -> Attained {
    let noise = &bench.noise;
    let first_order =
        || Attained { price: hypothesis.loss, residual: Unseen::of(bench).adapted(hypothesis), sizes: Vec::new() };
    if !bench.case.is_clamped() {
        return first_order();
    }
    let (changes, left, count) = (hypothesis.changes(bench), bench.left(), bench.numbers.len());
    let simulated = |sizes: &[f64], offset: &[f64]| -> Option<(Attained, Vec<f64>)> {
        let difference = bench.difference(&scattered(bench, sizes), &changes)?;
        let left: Vec<f64> = left.iter().zip(&difference).map(|(left, difference)| left - difference).collect();
        let price = price(noise, &left, sizes, offset);
        let common: Vec<f64> = sizes.iter().map(|_| 0.0).chain(offset.iter().copied()).collect();
        let residual = noise.less(left.clone(), &common);
        // The next step starts from what the numbers would leave as the study has them.
        let undone: Vec<f64> = sizes.iter().map(|size| -size).chain(offset.iter().map(|_| 0.0)).collect();
        let wanted = noise.sizes(&noise.less(left, &undone));
        Some((Attained { price, residual, sizes: sizes.to_vec() }, wanted))
    };
    let mut wanted = noise.sizes(&hypothesis.residual);
    let mut best: Option<Attained> = simulated(&vec![0.0; count], &wanted[count..]).map(|(stated, _)| stated);
    for _ in 0..STEPS {
        let from = best.as_ref().map_or_else(|| vec![0.0; count], |best| best.sizes.clone());
        let (sizes, offset) = wanted.split_at(count);
        let better = (0..=HALVINGS).find_map(|halving| {
            let share = 0.5_f64.powi(halving);
            let there: Vec<f64> = from.iter().zip(sizes).map(|(from, to)| from + share * (to - from)).collect();
            let found = simulated(&there, offset)?;
            best.as_ref().is_none_or(|best| found.0.price < best.price).then_some(found)
        });
        let Some((there, next)) = better else { break };
        (best, wanted) = (Some(there), next);
    }
    let best = best.unwrap_or_else(first_order);
    match &bench.recalibrated {
        Some(recalibrated) if hypothesis.parts.is_empty() && recalibrated.price < best.price => recalibrated.clone(),
        _ => best,
    }
}
