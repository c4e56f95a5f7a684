//! The whole robot with some causes, fitted.

use super::logs::{BenchLog, END_SAMPLES};
use super::measure::{counted, information, mean, squares};
use super::problem::Problem;
use super::search::search;
use super::values::{Searched, Values};
use super::{BenchLogs, Cause};
use crate::fit::{Block, Normal, Rejected, Residuals, uncertainty};
use crate::identify::Experiment;
use crate::log::ExtraMass;
use crate::robot::bench::Held;
use crate::robot::simulate::SimulateError;

/// The whole robot with some causes, fitted.
#[derive(Clone, Debug)]
pub struct Refit {
    /// What was let in; viscous friction was searched, too.
    pub causes: Vec<Cause>,
    /// Value and 95 % interval of every cause with a number; no interval where the swings leave it open.
    pub found: Vec<(Cause, f64, Option<[f64; 2]>)>,
    /// Viscous friction \[N m s/rad\].
    pub viscous: (f64, Option<[f64; 2]>),
    /// RMS over all logs \[rad\].
    pub rms_rad: f64,
    /// Model less measurement at rest, by log \[rad\].
    pub rest_rad: Vec<f64>,
    values: Values,
    /// The criterion about `values`, to second order.
    normal: Normal,
    residuals: Vec<Vec<f64>>,
}

impl Refit {
    /// With some causes, from a start that knows nothing.
    ///
    /// # Errors
    /// [`Rejected`] where no drop can be computed.
    pub(super) fn of(logs: &BenchLogs<'_>, causes: &[Cause]) -> Result<Self, Rejected> {
        let problem = Problem::new(logs, causes);
        let start = problem.start();
        Self::from(&problem, causes, &start)
    }

    /// With all causes but one with a number, from where these values would go without it, to first order.
    ///
    /// # Errors
    /// As [`Refit::of`].
    pub(super) fn without(&self, logs: &BenchLogs<'_>, cause: Cause) -> Result<Self, Rejected> {
        let causes: Vec<Cause> = self.causes.iter().copied().filter(|other| *other != cause).collect();
        let (with, problem) = (Problem::new(logs, &self.causes), Problem::new(logs, &causes));
        let plain = problem.coordinates_of(&self.values);
        let near = with.place(Searched::Of(cause)).and_then(|place| {
            let mut x = with.coordinates_of(&self.values);
            let mut nominal = logs.nominal;
            let change = *nominal.at(Searched::Of(cause)) - x[place];
            let normal =
                Normal { jtr: &self.normal.jtr + self.normal.jtj.column(place) * change, ..self.normal.clone() };
            let free: Vec<usize> = (0..x.len()).filter(|i| *i != place).collect();
            let step = normal.step(&free, with.coordinates(), LEAST_DAMPING)?;
            for ((x, step), c) in x.iter_mut().zip(step.iter()).zip(with.coordinates()) {
                *x = (*x + step).clamp(c.lower, c.upper);
            }
            x.remove(place);
            Some(x)
        });
        let left = |x: &Vec<f64>| problem.criterion(x).unwrap_or(f64::INFINITY);
        let start = match near {
            Some(near) if left(&near) < left(&plain) => near,
            _ => plain,
        };
        Self::from(&problem, &causes, &start)
    }

    fn from(problem: &Problem<'_>, causes: &[Cause], start: &[f64]) -> Result<Self, Rejected> {
        let x = search(problem, start).x;
        let blocks: Vec<Block> = problem.linearise(&x)?;
        let spread = uncertainty(problem, &blocks).ok();
        let normal = Normal::of(&blocks, x.len());
        let values = problem.values(&x);
        let estimate = |searched: Searched| {
            let i = problem.place(searched)?;
            let half = spread.as_ref().map(|u| u.half_width_robust(i)).filter(|half| half.is_finite());
            Some((x[i], half.map(|half| [x[i] - half, x[i] + half])))
        };
        let found =
            causes.iter().filter_map(|cause| estimate(Searched::Of(*cause)).map(|(v, i)| (*cause, v, i))).collect();
        let viscous = estimate(Searched::Viscous).unwrap_or((values.viscous_nm_s_rad, None));
        let residuals: Vec<Vec<f64>> = blocks.into_iter().map(|block| block.residual).collect();
        Ok(Self {
            causes: causes.to_vec(),
            found,
            viscous,
            rms_rad: (squares(&residuals) / problem.samples().max(1) as f64).sqrt(),
            rest_rad: residuals.iter().map(|r| mean(&r[r.len().saturating_sub(END_SAMPLES)..])).collect(),
            values,
            normal,
            residuals,
        })
    }

    /// RMS of the distances at rest \[rad\].
    pub fn rest_rms_rad(&self) -> f64 {
        (self.rest_rad.iter().map(|d| d * d).sum::<f64>() / self.rest_rad.len().max(1) as f64).sqrt()
    }

    /// How the other joints are held.
    pub fn held(&self) -> Held {
        if self.causes.contains(&Cause::HeldJoints) { Held::ByController } else { Held::Rigid }
    }

    /// Residuals by log \[rad\].
    pub(super) fn residuals(&self) -> &[Vec<f64>] {
        &self.residuals
    }

    /// Schwarz's criterion, with so many residuals that count.
    pub(super) fn information(&self, counted: f64) -> f64 {
        information(&self.residuals, 1 + self.found.len(), counted)
    }

    /// Residuals that count, correlated ones together.
    pub(super) fn counted(&self) -> f64 {
        counted(&self.residuals)
    }

    /// The drop of any experiment of the case with what was found.
    ///
    /// # Errors
    /// As [`bench_drop`](crate::robot::bench::bench_drop).
    pub fn readings(
        &self,
        logs: &BenchLogs<'_>,
        e: &Experiment,
        extra: Option<ExtraMass>,
    ) -> Result<Vec<f64>, SimulateError> {
        let release_s = e.release_window_s.map_or(0.0, |[_, to]| to);
        logs.readings(&BenchLog { e, extra, samples: e.t_s.len(), release_s }, self.held(), &self.values)
    }
}

/// Keeps what the swings leave open where it is.
const LEAST_DAMPING: f64 = 1e-6;
