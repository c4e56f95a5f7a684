//! One interface to all methods.

use super::dormand_prince::DormandPrince;
use super::fixed::Fixed;
use super::multistep::{Family, Multistep};

/// A system of differential equations `dy/dt = f(t, y)`.
pub trait Ode {
    /// Length of the state.
    fn len(&self) -> usize;

    /// The state's rate at a time; `rate` has the state's length. It may keep working memory, never a state of its own.
    fn rate(&mut self, t_s: f64, y: &[f64], rate: &mut [f64]);

    /// True for a system without a state.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// How accurate a step has to be: its error stays below `absolute + relative |y|`, as a root mean square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Share of a number's size.
    pub relative: f64,
    /// In the state's own units (rad, rad/s, m, m/s).
    pub absolute: f64,
}

impl Tolerance {
    /// The same number for both.
    pub fn of(both: f64) -> Self {
        Self { relative: both, absolute: both }
    }
}

/// How to integrate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The midpoint rule.
    Rk2 {
        /// Longest step \[s\].
        step_s: f64,
    },
    /// The classical fourth-order Runge-Kutta method.
    Rk4 {
        /// Longest step \[s\].
        step_s: f64,
    },
    /// Dormand and Prince's pair of orders 5 and 4.
    DormandPrince(Tolerance),
    /// Adams formulas of order 1 to 12, by functional iteration: for systems that are not stiff.
    Adams(Tolerance),
    /// Backward differentiation of order 1 to 5, by Newton's method: for stiff systems.
    Bdf(Tolerance),
}

/// What an integration cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Evaluations of the rate, those for Jacobians included.
    pub evaluations: u64,
    /// Steps that count.
    pub steps: u64,
    /// Steps that were tried and thrown away.
    pub rejected: u64,
    /// Jacobians, each of as many evaluations as the state is long.
    pub jacobians: u64,
}

/// An integration cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the integration stalled at t = {at_s} s: {why}")]
pub struct Stalled {
    /// When \[s\].
    pub at_s: f64,
    /// What happened.
    pub why: &'static str,
}

/// Working memory of a method; no step allocates.
///
/// ```
/// use aibo_fit::integrate::{Method, Ode, Solver, Tolerance};
/// struct Decay;
/// impl Ode for Decay {
///     fn len(&self) -> usize { 1 }
///     fn rate(&mut self, _t_s: f64, y: &[f64], rate: &mut [f64]) { rate[0] = -y[0]; }
/// }
/// let (mut t_s, mut y) = (0.0, [1.0]);
/// let mut solver = Solver::new(Method::Bdf(Tolerance::of(1e-8)), 1);
/// solver.advance(&mut Decay, &mut t_s, &mut y, 1.0)?;
/// assert!((y[0] - (-1.0f64).exp()).abs() < 1e-6);
/// # Ok::<(), aibo_fit::integrate::Stalled>(())
/// ```
#[derive(Clone, Debug)]
pub struct Solver {
    work: Work,
    counts: Counts,
}

#[derive(Clone, Debug)]
enum Work {
    Fixed(Fixed),
    DormandPrince(DormandPrince),
    Multistep(Box<Multistep>),
}

impl Solver {
    /// Memory for states of a length.
    pub fn new(method: Method, length: usize) -> Self {
        let work = match method {
            Method::Rk2 { step_s } => Work::Fixed(Fixed::new(step_s, false, length)),
            Method::Rk4 { step_s } => Work::Fixed(Fixed::new(step_s, true, length)),
            Method::DormandPrince(tolerance) => Work::DormandPrince(DormandPrince::new(tolerance, length)),
            Method::Adams(tolerance) => Work::Multistep(Box::new(Multistep::new(Family::Adams, tolerance, length))),
            Method::Bdf(tolerance) => Work::Multistep(Box::new(Multistep::new(Family::Bdf, tolerance, length))),
        };
        Self { work, counts: Counts::default() }
    }

    /// Carries a state from `t_s` to `until_s`, exactly.
    ///
    /// A method with a memory of earlier steps goes on from it where the state is the one it left.
    ///
    /// # Errors
    /// [`Stalled`] where the state is no longer finite, or the step would have to be too short; time and state are then
    /// those of the last good step.
    pub fn advance(&mut self, ode: &mut impl Ode, t_s: &mut f64, y: &mut [f64], until_s: f64) -> Result<(), Stalled> {
        match &mut self.work {
            Work::Fixed(work) => work.advance(ode, t_s, y, until_s, &mut self.counts),
            Work::DormandPrince(work) => work.advance(ode, t_s, y, until_s, &mut self.counts),
            Work::Multistep(work) => work.advance(ode, t_s, y, until_s, &mut self.counts),
        }
    }

    /// Forgets earlier steps: the system or the state has changed by a leap.
    pub fn restart(&mut self) {
        match &mut self.work {
            Work::Fixed(_) | Work::DormandPrince(_) => {}
            Work::Multistep(work) => work.restart(),
        }
    }

    /// What it has cost so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }
}

/// Root mean square of an error in units of what is allowed.
pub(super) fn weighted(error: &[f64], y: &[f64], tolerance: Tolerance) -> f64 {
    let sum: f64 =
        error.iter().zip(y).map(|(e, y)| (e / (tolerance.absolute + tolerance.relative * y.abs())).powi(2)).sum();
    (sum / y.len().max(1) as f64).sqrt()
}

/// A step shorter than this share of the time that has passed is none.
pub(super) fn shortest_s(t_s: f64) -> f64 {
    1e-13 * t_s.abs().max(1.0)
}

pub(super) fn finite(y: &[f64]) -> bool {
    y.iter().all(|x| x.is_finite())
}
