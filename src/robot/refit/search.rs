//! A search that ends where going on would change no decision.

use super::problem::Problem;
use crate::fit::{Budget, Method, Solution, Stop, solve};

/// Evaluations that end a search, whatever it still gains.
const BUDGET: usize = 60;
/// Evaluations until the gain is looked at: the start, and two steps.
const ROUND: usize = 5;
/// The same after a round in which no step made anything smaller.
const PATIENT: usize = 12;
/// A step that gains less, in variances of a residual, is the last: [`DECIDED`](super::DECIDED) of these are needed to
/// prefer one of two explanations, and a parameter moves by less than a quarter of its standard deviation.
const ENOUGH: f64 = 0.05;
/// A step that gains more shows that the search is far from its end: the next round is twice as long.
const FAR: f64 = 10.0;

/// Minimises from `start`, in rounds: a solver that knows nothing of decisions would go on until nothing moves.
pub(super) fn search(problem: &Problem<'_>, start: &[f64]) -> Solution {
    let mut at = start.to_vec();
    let (mut spent, mut round) = (0, ROUND);
    loop {
        let found = solve(problem, &at, Method::Lm, Budget { evaluations: round });
        spent += found.evaluations;
        let gain = match found.trace.as_slice() {
            [.., before, after] => Some((before - after) / after * problem.samples() as f64),
            _ => None,
        };
        let is_idle = gain.map_or(round == PATIENT, |gain| gain < ENOUGH);
        if found.stop != Stop::BudgetSpent || is_idle || spent >= BUDGET {
            return found;
        }
        round = match gain {
            None => PATIENT,
            Some(gain) if gain > FAR => 2 * round,
            Some(_) => ROUND,
        };
        at = found.x;
    }
}
