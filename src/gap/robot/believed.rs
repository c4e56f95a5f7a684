//! Whether a robot's numbers are as its study believes: those that moved far and close nothing are how one simulates.

use super::attained::{Attained, BELIEVED_SD, MOVED_SD};
use super::bench::Bench;
use super::noise::MATERIAL;
use super::place::Place;
use super::scatter::Number;

/// A joint whose gap is so many times what its numbers leave of it shows that they are off.
const SHOWS: f64 = 1.25;

impl Attained {
    /// Whether every number is as the study believes, and none is seen to be another.
    pub fn is_believed(&self, bench: &Bench<'_>) -> bool {
        let gap = bench.gap();
        let shows = |number: &Number| match number {
            Number::Mass(_) => false,
            Number::Coulomb(joint) | Number::Viscous(joint) => {
                bench.rms_rad(*joint, &gap) > SHOWS * bench.rms_rad(*joint, &self.residual)
            }
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
