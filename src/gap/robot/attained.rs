//! What a hypothesis leaves with the uncertain numbers really adapted: the robot is simulated with them.
//!
//! To first order many a motion can be imitated by numbers that are off; in a drop, which amplifies them, no robot with
//! such numbers does it.

use super::bench::Bench;
use super::refine::Hypothesis;
use super::scatter::Scatter;

/// Simulations for one hypothesis.
const STEPS: usize = 4;

/// The weighed sum of squares that a hypothesis attains on a clamped robot, the price of its numbers included: the
/// least of a few Gauss-Newton steps. On the floor, where the numbers are drawn, what is known to first order.
pub(super) fn attained(bench: &Bench<'_>, hypothesis: &Hypothesis) -> f64 {
    if !bench.case.is_clamped() {
        return hypothesis.loss;
    }
    let (changes, given, noise) = (hypothesis.changes(bench), bench.residual(), &bench.noise);
    let count = bench.numbers.len();
    let mut sizes = noise.sizes(&hypothesis.residual);
    let mut least = f64::INFINITY;
    for _ in 0..STEPS {
        let mut scatter = Scatter::none(bench.case.model());
        bench.numbers.iter().zip(&sizes).for_each(|(number, size)| scatter.put(*number, *size));
        let Some(difference) = bench.difference(&scatter, &changes) else { break };
        let left: Vec<f64> = given.iter().zip(&difference).map(|(given, difference)| given - difference).collect();
        // The sensor's common offset is linear.
        let mut offset = sizes.clone();
        offset[..count].fill(0.0);
        let read = noise.less(left.clone(), &offset);
        let squares: f64 = noise.weight.iter().zip(&read).map(|(weight, left)| weight * left.powi(2)).sum();
        least = least.min(squares + sizes.iter().map(|size| size.powi(2)).sum::<f64>());
        // The next step starts from what the numbers would leave as the study has them.
        let undone: Vec<f64> = sizes.iter().enumerate().map(|(k, size)| if k < count { -size } else { 0.0 }).collect();
        sizes = noise.sizes(&noise.less(left, &undone));
    }
    least
}
