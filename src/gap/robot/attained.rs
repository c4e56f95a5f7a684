//! What a hypothesis leaves with the uncertain numbers adapted; clamped, the robot is simulated with them.
//!
//! To first order many a motion can be imitated by numbers that are off; in a drop, which amplifies them, no robot with
//! such numbers does it.

use super::bench::Bench;
use super::decide::MATERIAL;
use super::place::Place;
use super::scatter::Number;

/// What a hypothesis leaves with its numbers.
#[derive(Clone, Debug)]
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
