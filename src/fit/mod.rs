//! Layer 5: fitting. The criterion (3.7), DFP and BFGS as the thesis used them, Levenberg-Marquardt, uncertainty.
//!
//! Nothing here knows a pendulum: a problem is anything that gives weighted residuals in blocks and their derivatives
//! ([`Residuals`]). Whatever happens on the way, a solve returns the best point it saw and says why it stopped.

mod bounds;
mod line_search;
mod lm;
mod problem;
mod quasi_newton;
mod uncertainty;

pub use problem::{Block, Coordinate, Normal, Rejected, Residuals, Rounding};
pub use uncertainty::{Uncertainty, Undetermined, correlation_length, uncertainty};

use serde::Serialize;

/// How to search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Levenberg-Marquardt.
    #[default]
    Lm,
    /// Broyden-Fletcher-Goldfarb-Shanno.
    Bfgs,
    /// Davidon-Fletcher-Powell, the thesis's method.
    Dfp,
}

impl Method {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Method::Lm => "lm",
            Method::Bfgs => "bfgs",
            Method::Dfp => "dfp",
        }
    }
}

/// How much work a solve may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Evaluations of the criterion or of the residuals with their derivatives.
    pub evaluations: usize,
}

impl Default for Budget {
    fn default() -> Self {
        Self { evaluations: 1500 }
    }
}

/// Why a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// Within a ten-thousandth of a standard deviation of the optimum, by the local quadratic model.
    Converged,
    /// No step makes the criterion smaller, though the quadratic model says so: a kink, where the model sticks.
    NoFurtherDecrease,
    /// The budget of evaluations, or of time, is spent.
    BudgetSpent,
    /// The model has no answer at the start.
    StartRejected,
}

impl Stop {
    /// A few words for tables and reports.
    pub fn words(self) -> &'static str {
        match self {
            Stop::Converged => "converged",
            Stop::NoFurtherDecrease => "no further decrease",
            Stop::BudgetSpent => "budget of evaluations spent",
            Stop::StartRejected => "no answer at the start",
        }
    }
}

/// Where a solve ended: the best point it saw.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solution {
    /// The best point, in the problem's coordinates.
    pub x: Vec<f64>,
    /// The criterion (3.7) at `x` \[rad^2 s\]; infinite where the start was rejected.
    pub criterion: f64,
    /// The criterion after each iteration.
    pub trace: Vec<f64>,
    /// Why the solve ended.
    pub stop: Stop,
    /// Evaluations of the criterion or of the residuals with their derivatives.
    pub evaluations: usize,
}

impl Solution {
    fn rejected(x: Vec<f64>) -> Self {
        Self { x, criterion: f64::INFINITY, trace: Vec::new(), stop: Stop::StartRejected, evaluations: 1 }
    }
}

/// Minimises the criterion from `start`.
pub fn solve(problem: &dyn Residuals, start: &[f64], method: Method, budget: Budget) -> Solution {
    match method {
        Method::Lm => lm::levenberg_marquardt(problem, start, budget, lm::CONVERGED_VARIANCES),
        Method::Bfgs | Method::Dfp => quasi_newton::quasi_newton(problem, start, method, budget),
    }
}

/// Minimises the criterion by Levenberg-Marquardt until it lies within `close` variances of the residuals above its
/// minimum, by the local quadratic model: hypotheses can be told apart long before a fit has converged.
pub fn approach(problem: &dyn Residuals, start: &[f64], budget: Budget, close: f64) -> Solution {
    lm::levenberg_marquardt(problem, start, budget, close)
}
