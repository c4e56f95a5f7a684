//! DFP and BFGS, the thesis's kind of search (Davidon-Fletcher-Powell, 3.3.1), on argmin's solvers.
//!
//! Two things make them dependable here. The inverse Hessian starts as `(J'J + mu I)^-1` rather than the identity,
//! whose first step would throw the parameters to infinity; and a search that ends early is started again from the
//! best point with a fresh one. Whatever argmin answers, the best point is kept.

use super::bounds::{inside, outside};
use super::line_search::StrongWolfe;
use super::lm::CONVERGED_VARIANCES;
use super::{Budget, Method, Normal, Residuals, Solution, Stop};
use argmin::core::{
    CostFunction, Error, Executor, Gradient, IterState, KV, Problem, Solver, TerminationReason, TerminationStatus,
};
use argmin::solver::quasinewton::{BFGS, DFP};
use argmin_math::{ArgminAdd, ArgminDot, ArgminEye, ArgminMul, ArgminSub, ArgminTranspose};
use nalgebra::{DMatrix, DVector};
use std::cell::RefCell;

type Vector = DVector<f64>;
type Search = IterState<Vector, Vector, (), InverseHessian, (), f64>;

/// The inverse Hessian as a type of its own: argmin's nalgebra back end has no outer product of two vectors.
#[derive(Clone, Debug)]
struct InverseHessian(DMatrix<f64>);

impl ArgminDot<Vector, InverseHessian> for Vector {
    fn dot(&self, other: &Vector) -> InverseHessian {
        InverseHessian(self * other.transpose())
    }
}
impl ArgminDot<Vector, Vector> for InverseHessian {
    fn dot(&self, other: &Vector) -> Vector {
        &self.0 * other
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
    best_u: Vector,
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

    fn keep(&self, u: &Vector, criterion: f64) {
        let mut record = self.record.borrow_mut();
        if criterion < record.best {
            record.best = criterion;
            record.best_u = u.clone();
        }
    }

    fn normal(&self, u: &Vector) -> Option<(Normal, Vec<f64>)> {
        let (x, slopes) = self.bounded(u);
        let blocks = self.problem.linearise(&x).ok()?;
        Some((Normal::of(&blocks, x.len()), slopes))
    }
}

impl CostFunction for Scaled<'_> {
    type Param = Vector;
    type Output = f64;

    fn cost(&self, u: &Vector) -> Result<f64, Error> {
        self.count()?;
        let Ok(criterion) = self.problem.criterion(&self.bounded(u).0) else { return Ok(f64::INFINITY) };
        self.keep(u, criterion);
        Ok(criterion / self.unit)
    }
}

impl Gradient for Scaled<'_> {
    type Param = Vector;
    type Gradient = Vector;

    fn gradient(&self, u: &Vector) -> Result<Vector, Error> {
        self.count()?;
        let Some((normal, slopes)) = self.normal(u) else { return Ok(Vector::zeros(u.len())) };
        self.keep(u, normal.criterion);
        Ok(Vector::from_fn(u.len(), |i, _| 2.0 * normal.jtr[i] * slopes[i] / self.unit))
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

/// Rounds of search, each with a fresh inverse Hessian.
const ROUNDS: usize = 12;
/// Iterations per round.
const ITERATIONS: u64 = 80;

/// Minimises the criterion from `start` by DFP or BFGS.
pub(super) fn quasi_newton(problem: &dyn Residuals, start: &[f64], method: Method, budget: Budget) -> Solution {
    let coordinates = problem.coordinates();
    let u0 = Vector::from_iterator(start.len(), coordinates.iter().zip(start).map(|(c, &x)| outside(c, x)));
    let record = RefCell::new(Record { best_u: u0.clone(), best: f64::INFINITY, trace: Vec::new(), evaluations: 0 });
    let mut stop = Stop::NoFurtherDecrease;
    let mut last_best = f64::INFINITY;
    for round in 0..ROUNDS {
        let u = record.borrow().best_u.clone();
        let scaled = Scaled { problem, unit: 1.0, budget, record: &record };
        let Some((normal, slopes)) = scaled.normal(&u) else { return Solution::rejected(start.to_vec()) };
        if round == 0 {
            let mut record = record.borrow_mut();
            record.best = normal.criterion;
            record.trace.push(normal.criterion);
        }
        let x = scaled.bounded(&u).0;
        if near_optimum(&normal, &x, problem) {
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
        let inverse = inverse_hessian(&normal, &slopes, unit);
        let problem = Scaled { unit, ..scaled };
        let longest = coordinates.iter().map(|c| c.scale).fold(f64::INFINITY, f64::min).min(1.0);
        let configure = |state: Search| state.param(u.clone()).inv_hessian(inverse.clone()).max_iters(ITERATIONS);
        // An error here is the end of a round, not of the fit: the record holds the best point.
        let _ended = match method {
            Method::Bfgs => {
                let inner = BFGS::new(StrongWolfe::new(0.9, longest)).with_tolerance_grad(0.0);
                inner
                    .and_then(|inner| inner.with_tolerance_cost(0.0))
                    .and_then(|inner| run(problem, UntilFlat { inner, idle: 0, unit, record: &record }, configure))
            }
            _ => DFP::new(StrongWolfe::new(0.1, longest))
                .with_tolerance_grad(0.0)
                .and_then(|inner| run(problem, UntilFlat { inner, idle: 0, unit, record: &record }, configure)),
        };
    }
    let Record { best_u, best, trace, evaluations } = record.into_inner();
    let x = coordinates.iter().zip(best_u.iter()).map(|(c, &u)| inside(c, u).0).collect();
    Solution { x, criterion: best, trace, stop, evaluations }
}

fn run<'a, S: Solver<Scaled<'a>, Search>>(
    problem: Scaled<'a>,
    solver: S,
    configure: impl FnOnce(Search) -> Search,
) -> Result<(), Error> {
    Executor::new(problem, solver).configure(configure).timer(false).run().map(|_| ())
}

/// Converged, with a coordinate that is within a thousandth of its scale of a bound counted as on it.
fn near_optimum(normal: &Normal, x: &[f64], problem: &dyn Residuals) -> bool {
    let coordinates = problem.coordinates();
    let snapped: Vec<f64> = x
        .iter()
        .zip(coordinates)
        .map(|(&x, c)| {
            if x - c.lower < 1e-3 * c.scale {
                c.lower
            } else if c.upper - x < 1e-3 * c.scale {
                c.upper
            } else {
                x
            }
        })
        .collect();
    normal.distance_in_variances(&normal.unblocked(&snapped, coordinates), coordinates) < CONVERGED_VARIANCES
}

/// `(J'J + mu I)^-1` in the unbounded coordinates, halved because the criterion is a sum of squares without a half.
fn inverse_hessian(normal: &Normal, slopes: &[f64], unit: f64) -> InverseHessian {
    let n = slopes.len();
    let mut a = DMatrix::from_fn(n, n, |i, k| 2.0 * normal.jtj[(i, k)] * slopes[i] * slopes[k] / unit);
    let ridge = 1e-6 * (0..n).map(|i| a[(i, i)]).fold(f64::MIN_POSITIVE, f64::max);
    for i in 0..n {
        a[(i, i)] = a[(i, i)] * (1.0 + 1e-8) + ridge * 1e-3;
    }
    InverseHessian(a.clone().cholesky().map_or_else(|| DMatrix::identity(n, n) / ridge, |c| c.inverse()))
}
