//! DFP and BFGS, the thesis's kind of search (Davidon-Fletcher-Powell, 3.3.1), on argmin's solvers.
//!
//! Two things make them dependable here. The inverse Hessian starts as `(J'J + mu I)^-1` rather than the identity,
//! whose first step would throw the parameters to infinity; and a search that ends early is started again from the
//! best point with a fresh one. Whatever argmin answers, the best point is kept.

use super::bounds::{inside, outside};
use super::line_search::StrongWolfe;
use super::lm::{CONVERGED_VARIANCES, clamped};
use super::{Budget, Method, Normal, Residuals, Solution, Stop};
use argmin::core::{
    CostFunction, Error, Executor, Gradient, IterState, KV, Problem, Solver, TerminationReason, TerminationStatus,
};
use argmin::solver::quasinewton::{BFGS, DFP};
use argmin_math::{ArgminAdd, ArgminDot, ArgminEye, ArgminMul, ArgminSub, ArgminTranspose};
use nalgebra::{DMatrix, DVectorView};
use std::cell::RefCell;

type Vector = Vec<f64>;
type Search = IterState<Vector, Vector, (), InverseHessian, (), f64>;

/// The inverse Hessian as a type of its own: argmin's nalgebra back end has no outer product of two vectors, and asks for
/// matrix products whose bits depend on the processor.
#[derive(Clone, Debug)]
struct InverseHessian(DMatrix<f64>);

impl ArgminDot<Vector, InverseHessian> for Vector {
    fn dot(&self, other: &Vector) -> InverseHessian {
        InverseHessian(DMatrix::from_fn(self.len(), other.len(), |i, k| self[i] * other[k]))
    }
}
impl ArgminDot<Vector, Vector> for InverseHessian {
    fn dot(&self, other: &Vector) -> Vector {
        (&self.0 * DVectorView::from_slice(other, other.len())).data.into()
    }
}
impl ArgminDot<InverseHessian, InverseHessian> for InverseHessian {
    fn dot(&self, other: &InverseHessian) -> InverseHessian {
        InverseHessian(&self.0 * &other.0)
    }
}
impl ArgminSub<InverseHessian, InverseHessian> for InverseHessian {
    fn sub(&self, other: &InverseHessian) -> InverseHessian {
        InverseHessian(&self.0 - &other.0)
    }
}
impl ArgminAdd<InverseHessian, InverseHessian> for InverseHessian {
    fn add(&self, other: &InverseHessian) -> InverseHessian {
        InverseHessian(&self.0 + &other.0)
    }
}
impl ArgminMul<f64, InverseHessian> for InverseHessian {
    fn mul(&self, factor: &f64) -> InverseHessian {
        InverseHessian(&self.0 * *factor)
    }
}
impl ArgminTranspose<InverseHessian> for InverseHessian {
    fn t(self) -> InverseHessian {
        InverseHessian(self.0.transpose())
    }
}
impl ArgminEye for InverseHessian {
    fn eye(n: usize) -> Self {
        InverseHessian(DMatrix::identity(n, n))
    }
    fn eye_like(&self) -> Self {
        Self::eye(self.0.nrows())
    }
}

/// What outlives argmin's solver: the best point, the trace, and the count.
struct Record {
    best_x: Vec<f64>,
    best: f64,
    trace: Vec<f64>,
    evaluations: usize,
}

/// The criterion in unbounded coordinates, divided by its value at the start.
struct Scaled<'a> {
    problem: &'a dyn Residuals,
    unit: f64,
    budget: Budget,
    record: &'a RefCell<Record>,
}

impl Scaled<'_> {
    fn bounded(&self, u: &Vector) -> (Vec<f64>, Vec<f64>) {
        self.problem.coordinates().iter().zip(u.iter()).map(|(c, &u)| inside(c, u)).unzip()
    }

    fn count(&self) -> Result<(), Error> {
        let mut record = self.record.borrow_mut();
        record.evaluations += 1;
        if record.evaluations > self.budget.evaluations { Err(Error::msg("budget spent")) } else { Ok(()) }
    }

    fn keep(&self, x: &[f64], criterion: f64) {
        let mut record = self.record.borrow_mut();
        if criterion < record.best {
            record.best = criterion;
            record.best_x = x.to_vec();
        }
    }

    fn normal(&self, x: &[f64]) -> Option<Normal> {
        self.record.borrow_mut().evaluations += 1;
        let blocks = self.problem.linearise(x).ok()?;
        Some(Normal::of(&blocks, x.len()))
    }

    /// The point with every coordinate that is pushed against a bound near by put on it, where that costs nothing.
    ///
    /// The unbounded coordinates only approach a bound: the optimum there is reached by this step, and only from a
    /// point that lies on the bound may a coordinate be called blocked.
    fn on_its_bounds(&self, x: Vec<f64>, normal: Normal) -> (Vec<f64>, Normal) {
        let coordinates = self.problem.coordinates();
        let put: Vec<f64> = (0..x.len())
            .map(|i| {
                let (c, x, slope) = (&coordinates[i], x[i], normal.jtr[i]);
                if slope > 0.0 && x - c.lower < NEAR * c.scale {
                    c.lower
                } else if slope < 0.0 && c.upper - x < NEAR * c.scale {
                    c.upper
                } else {
                    x
                }
            })
            .collect();
        if put == x {
            return (x, normal);
        }
        match self.normal(&put) {
            Some(there) if there.criterion <= normal.criterion => {
                self.keep(&put, there.criterion);
                (put, there)
            }
            _ => (x, normal),
        }
    }
}

impl CostFunction for Scaled<'_> {
    type Param = Vector;
    type Output = f64;

    fn cost(&self, u: &Vector) -> Result<f64, Error> {
        self.count()?;
        let x = self.bounded(u).0;
        let Ok(criterion) = self.problem.criterion(&x) else { return Ok(f64::INFINITY) };
        self.keep(&x, criterion);
        Ok(criterion / self.unit)
    }
}

impl Gradient for Scaled<'_> {
    type Param = Vector;
    type Gradient = Vector;

    fn gradient(&self, u: &Vector) -> Result<Vector, Error> {
        if self.record.borrow().evaluations >= self.budget.evaluations {
            return Err(Error::msg("budget spent"));
        }
        let (x, slopes) = self.bounded(u);
        let Some(normal) = self.normal(&x) else { return Ok(vec![0.0; u.len()]) };
        self.keep(&x, normal.criterion);
        Ok((0..u.len()).map(|i| 2.0 * normal.jtr[i] * slopes[i] / self.unit).collect())
    }
}

/// Stops a solver whose cost has not fallen, by parts in a billion, for three iterations; keeps the trace.
struct UntilFlat<'a, S> {
    inner: S,
    idle: usize,
    unit: f64,
    record: &'a RefCell<Record>,
}

impl<O, S: Solver<O, Search>> Solver<O, Search> for UntilFlat<'_, S> {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn init(&mut self, problem: &mut Problem<O>, state: Search) -> Result<(Search, Option<KV>), Error> {
        self.inner.init(problem, state)
    }

    fn next_iter(&mut self, problem: &mut Problem<O>, state: Search) -> Result<(Search, Option<KV>), Error> {
        let before = state.get_cost();
        let (state, kv) = self.inner.next_iter(problem, state)?;
        self.idle = if before - state.get_cost() < 1e-9 * before { self.idle + 1 } else { 0 };
        self.record.borrow_mut().trace.push(state.get_cost() * self.unit);
        Ok((state, kv))
    }

    fn terminate(&mut self, _state: &Search) -> TerminationStatus {
        if self.idle >= 3 {
            TerminationStatus::Terminated(TerminationReason::SolverConverged)
        } else {
            TerminationStatus::NotTerminated
        }
    }
}

/// A coordinate within this share of its scale of a bound that it is pushed against may be put on it.
const NEAR: f64 = 1e-3;
/// Rounds of search, each with a fresh inverse Hessian.
const ROUNDS: usize = 12;
/// Iterations per round.
const ITERATIONS: u64 = 80;

/// Minimises the criterion from `start` by DFP or BFGS.
pub(super) fn quasi_newton(problem: &dyn Residuals, start: &[f64], method: Method, budget: Budget) -> Solution {
    let coordinates = problem.coordinates();
    let start = clamped(start, coordinates.iter().map(|c| (c.lower, c.upper)));
    let record = RefCell::new(Record { best_x: start.clone(), best: f64::INFINITY, trace: Vec::new(), evaluations: 0 });
    let scaled = |unit: f64| Scaled { problem, unit, budget, record: &record };
    let mut stop = Stop::NoFurtherDecrease;
    let mut last_best = f64::INFINITY;
    for round in 0..ROUNDS {
        let x = record.borrow().best_x.clone();
        let Some(normal) = scaled(1.0).normal(&x) else { return Solution::rejected(start) };
        if round == 0 {
            let mut record = record.borrow_mut();
            record.best = normal.criterion;
            record.trace.push(normal.criterion);
        }
        let (x, normal) = scaled(1.0).on_its_bounds(x, normal);
        if normal.distance_in_variances(&normal.unblocked(&x, coordinates), coordinates) < CONVERGED_VARIANCES {
            stop = Stop::Converged;
            break;
        }
        if record.borrow().evaluations >= budget.evaluations {
            stop = Stop::BudgetSpent;
            break;
        }
        if round > 0 && !(normal.criterion < last_best * (1.0 - 1e-12)) {
            break;
        }
        last_best = normal.criterion;
        let unit = normal.criterion.max(f64::MIN_POSITIVE);
        let u: Vector = coordinates.iter().zip(&x).map(|(c, &x)| outside(c, x)).collect();
        let slopes = scaled(unit).bounded(&u).1;
        let inverse = inverse_hessian(&normal, &slopes, unit);
        let problem = scaled(unit);
        // Each coordinate has its own limit: one that is short, like a release, must not hold the others back.
        let longest: Vector = coordinates.iter().map(|c| c.scale).collect();
        let configure = |state: Search| state.param(u.clone()).inv_hessian(inverse.clone()).max_iters(ITERATIONS);
        // An error here is the end of a round, not of the fit: the record holds the best point.
        let _ended = match method {
            Method::Bfgs => {
                let inner = BFGS::new(StrongWolfe::new(0.9, longest.clone())).with_tolerance_grad(0.0);
                inner
                    .and_then(|inner| inner.with_tolerance_cost(0.0))
                    .and_then(|inner| run(problem, UntilFlat { inner, idle: 0, unit, record: &record }, configure))
            }
            _ => DFP::new(StrongWolfe::new(0.1, longest.clone()))
                .with_tolerance_grad(0.0)
                .and_then(|inner| run(problem, UntilFlat { inner, idle: 0, unit, record: &record }, configure)),
        };
    }
    let Record { best_x, best, trace, evaluations } = record.into_inner();
    Solution { x: best_x, criterion: best, trace, stop, evaluations }
}

fn run<'a, S: Solver<Scaled<'a>, Search>>(
    problem: Scaled<'a>,
    solver: S,
    configure: impl FnOnce(Search) -> Search,
) -> Result<(), Error> {
    Executor::new(problem, solver).configure(configure).timer(false).run().map(|_| ())
}

/// `(J'J + mu I)^-1` in the unbounded coordinates, halved because the criterion is a sum of squares without a half;
/// where that is not positive definite, the textbook start, a multiple of the identity. Only the way depends on it, not
/// the minimum.
fn inverse_hessian(normal: &Normal, slopes: &[f64], unit: f64) -> InverseHessian {
    let n = slopes.len();
    let mut a = DMatrix::from_fn(n, n, |i, k| 2.0 * normal.jtj[(i, k)] * slopes[i] * slopes[k] / unit);
    let ridge = 1e-6 * (0..n).map(|i| a[(i, i)]).fold(f64::MIN_POSITIVE, f64::max);
    for i in 0..n {
        a[(i, i)] = a[(i, i)] * (1.0 + 1e-8) + ridge * 1e-3;
    }
    InverseHessian(a.clone().cholesky().map_or_else(|| DMatrix::identity(n, n) / ridge, |c| c.inverse()))
}

#[cfg(test)]
mod tests {
    use crate::fit::{Block, Budget, Coordinate, Method, Rejected, Residuals, Rounding, Stop, solve};

    /// Straight lines through a few numbers, with the slope's best value a little below its bound at zero.
    struct Lines(Vec<Coordinate>);

    impl Residuals for Lines {
        fn coordinates(&self) -> &[Coordinate] {
            &self.0
        }
        fn criterion(&self, x: &[f64]) -> Result<f64, Rejected> {
            Ok(self.linearise(x)?[0].residual.iter().map(|r| r * r).sum())
        }
        fn linearise(&self, x: &[f64]) -> Result<Vec<Block>, Rejected> {
            let times = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
            let noise = [1e-5, -2e-5, 1e-5, 1e-5, -2e-5, 1e-5];
            let residual = times.iter().zip(noise).map(|(t, e)| (x[0] + 2e-4) * t + x[1] - 3.0 + e).collect();
            let jacobian = times.iter().flat_map(|&t| [t, 1.0]).collect();
            Ok(vec![Block { columns: vec![0, 1], residual, jacobian }])
        }
        fn rounding(&self, _block: usize) -> Rounding {
            Rounding::default()
        }
        fn weights(&self, _block: usize) -> &[f64] {
            &[1.0; 6]
        }
    }

    #[test]
    fn every_method_ends_on_the_bound_and_not_merely_near_it() {
        let coordinate = |lower| Coordinate { name: "x".into(), lower, upper: f64::INFINITY, scale: 1.0 };
        let problem = Lines(vec![coordinate(0.0), coordinate(f64::NEG_INFINITY)]);
        for start in [[0.0, 0.0], [0.7, 5.0], [3.0, -4.0]] {
            for method in [Method::Lm, Method::Bfgs, Method::Dfp] {
                let solution = solve(&problem, &start, method, Budget::default());
                assert_eq!(solution.stop, Stop::Converged, "{method:?} from {start:?}");
                assert_eq!(solution.x[0], 0.0, "{method:?} from {start:?}");
                assert!((solution.x[1] - 2.9995).abs() < 2e-6, "{method:?} from {start:?}: {}", solution.x[1]);
            }
        }
    }

    #[test]
    fn a_spent_budget_is_kept_and_the_best_point_is_answered() {
        let coordinate = |lower| Coordinate { name: "x".into(), lower, upper: f64::INFINITY, scale: 0.01 };
        let problem = Lines(vec![coordinate(0.0), coordinate(f64::NEG_INFINITY)]);
        for method in [Method::Lm, Method::Bfgs, Method::Dfp] {
            let solution = solve(&problem, &[3.0, -40.0], method, Budget { evaluations: 7 });
            assert_eq!(solution.stop, Stop::BudgetSpent, "{method:?}");
            assert!(solution.evaluations <= 9, "{method:?}: {}", solution.evaluations);
            let there = problem.criterion(&solution.x).expect("linear");
            assert!((there - solution.criterion).abs() < 1e-9 * there && there < 1e4, "{method:?}");
        }
    }
}
