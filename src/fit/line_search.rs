//! A strong-Wolfe line search for argmin's quasi-Newton methods (Nocedal and Wright 2006, algorithms 3.5 and 3.6).
//!
//! It differs from argmin's own in what it does when things go wrong: a point at which the motion diverges is "too
//! far", not an error; the best point seen is returned; the number of trials is bounded.

use argmin::core::{
    CostFunction, Error, Gradient, IterState, KV, Problem, Solver, State, TerminationReason, TerminationStatus,
};
use argmin::solver::linesearch::LineSearch;
use argmin_math::{ArgminDot, ArgminScaledAdd};

type Vector = Vec<f64>;
type LineState = IterState<Vector, Vector, (), (), (), f64>;

/// Strong-Wolfe search along a direction.
#[derive(Clone)]
pub(super) struct StrongWolfe {
    direction: Vector,
    /// Curvature condition: 0.9 for BFGS, 0.1 for DFP, which needs an accurate search.
    curvature: f64,
    /// Largest change of each coordinate in the first step.
    longest: Vector,
}

/// Sufficient decrease.
const DECREASE: f64 = 1e-4;
const TRIALS: usize = 30;

/// A point on the line.
#[derive(Clone)]
struct Point {
    step: f64,
    cost: f64,
    slope: f64,
}

impl StrongWolfe {
    pub(super) fn new(curvature: f64, longest: Vector) -> Self {
        Self { direction: Vector::new(), curvature, longest }
    }
}

impl LineSearch<Vector, f64> for StrongWolfe {
    fn search_direction(&mut self, direction: Vector) {
        self.direction = direction;
    }

    fn initial_step_length(&mut self, _step: f64) -> Result<(), Error> {
        Ok(())
    }
}

impl<O> Solver<O, LineState> for StrongWolfe
where
    O: CostFunction<Param = Vector, Output = f64> + Gradient<Param = Vector, Gradient = Vector>,
{
    fn name(&self) -> &str {
        "strong Wolfe"
    }

    fn next_iter(&mut self, problem: &mut Problem<O>, mut state: LineState) -> Result<(LineState, Option<KV>), Error> {
        let x0 = state.take_param().ok_or_else(|| Error::msg("line search without a start"))?;
        let g0 = state.take_gradient().ok_or_else(|| Error::msg("line search without a gradient"))?;
        let start = Point { step: 0.0, cost: state.get_cost(), slope: g0.dot(&self.direction) };
        if !(start.slope < 0.0) {
            return Err(Error::msg("not a descent direction"));
        }
        let at = |step: f64, problem: &mut Problem<O>| -> Result<Point, Error> {
            let x = x0.scaled_add(&step, &self.direction);
            let cost = problem.cost(&x)?;
            if !cost.is_finite() || cost > start.cost + DECREASE * step * start.slope {
                return Ok(Point { step, cost, slope: f64::NAN });
            }
            let slope = problem.gradient(&x)?.dot(&self.direction);
            Ok(Point { step, cost, slope })
        };
        let flat = |p: &Point| p.slope.abs() <= -self.curvature * start.slope;
        let share = |(d, longest): (&f64, &f64)| longest / d.abs().max(f64::MIN_POSITIVE);
        let first = self.direction.iter().zip(&self.longest).map(share).fold(1.0, f64::min);
        let best = search(start.clone(), first, flat, |s| at(s, problem))?;
        if best.step == 0.0 {
            return Err(Error::msg("line search stalled"));
        }
        let x = x0.scaled_add(&best.step, &self.direction);
        Ok((state.param(x).cost(best.cost), None))
    }

    fn terminate(&mut self, state: &LineState) -> TerminationStatus {
        if state.get_iter() >= 1 {
            TerminationStatus::Terminated(TerminationReason::SolverConverged)
        } else {
            TerminationStatus::NotTerminated
        }
    }
}

/// The search proper: `at` evaluates a point; one that fails sufficient decrease has a slope of NaN.
fn search(
    start: Point,
    first: f64,
    flat: impl Fn(&Point) -> bool,
    mut at: impl FnMut(f64) -> Result<Point, Error>,
) -> Result<Point, Error> {
    let mut low = start;
    let mut high: Option<Point> = None;
    let mut step = first;
    for _ in 0..TRIALS {
        let p = at(step)?;
        if p.slope.is_nan() || p.cost >= low.cost && low.step > 0.0 {
            high = Some(p);
        } else if flat(&p) {
            return Ok(p);
        } else if p.slope * (high.as_ref().map_or(1.0, |h| h.step - low.step)) >= 0.0 {
            high = Some(std::mem::replace(&mut low, p));
        } else {
            low = p;
        }
        step = match &high {
            None => 2.5 * low.step,
            Some(h) => {
                let width = h.step - low.step;
                if width.abs() <= 1e-12 * low.step.max(1e-12) {
                    break;
                }
                // Minimum of the parabola through low (with its slope) and high; kept off both ends.
                let bend = h.cost - low.cost - low.slope * width;
                let share = if bend > 0.0 && h.cost.is_finite() { -0.5 * low.slope * width / bend } else { 0.25 };
                low.step + width * share.clamp(0.1, 0.6)
            }
        };
    }
    Ok(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(f: impl Fn(f64) -> (f64, f64), first: f64, curvature: f64) -> Point {
        let (cost, slope) = f(0.0);
        let start = Point { step: 0.0, cost, slope };
        search(
            start,
            first,
            |p| p.slope.abs() <= -curvature * slope,
            |step| {
                let (c, s) = f(step);
                let armijo = c <= cost + DECREASE * step * slope;
                Ok(Point { step, cost: c, slope: if armijo { s } else { f64::NAN } })
            },
        )
        .expect("never errs")
    }

    #[test]
    fn finds_the_minimum_of_a_parabola_from_too_short_and_too_long_steps() {
        for first in [1e-3, 0.3, 4.0, 500.0] {
            let p = on(|s| ((s - 2.0).powi(2), 2.0 * (s - 2.0)), first, 0.1);
            assert!((p.step - 2.0).abs() < 0.21, "{first}: {}", p.step);
        }
    }

    #[test]
    fn a_diverged_point_is_too_far_and_not_an_error() {
        let p = on(|s| if s > 1.0 { (f64::INFINITY, 0.0) } else { (-s, -1.0) }, 8.0, 0.1);
        assert!(p.step > 0.4 && p.step <= 1.0, "{}", p.step);
    }
}
