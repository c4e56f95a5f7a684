//! The whole robot with some causes, fitted.

use super::problem::{Problem, held};
use super::{Cause, Swings, at_rest_rad};
use crate::fit::{Budget, Rejected, Residuals, Solution, approach, uncertainty};
use crate::gap::hypothesis::score::Measure;
use crate::gap::hypothesis::trial::{CLOSE, losses};
use crate::gap::search::grow::LOOK;
use crate::identify::{Estimate, Experiment, counts, estimates, free_of, ranked};
use crate::robot::simulate::SimulateError;
use rayon::prelude::*;

/// Evaluations that end a search, whatever it still gains.
const BUDGET: Budget = Budget { evaluations: 60 };

/// The whole robot with some causes, fitted.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    /// What was let in; viscous friction was searched, too.
    pub causes: Vec<Cause>,
    /// What was searched, with 95 % intervals; without one where the swings leave it open.
    pub found: Vec<Estimate>,
    /// RMS over all logs, each sample by how much it counts \[rad\].
    pub rms_rad: f64,
    /// Model less measurement at rest, by log \[rad\].
    pub rest_rad: Vec<f64>,
    /// Values of all parameters.
    pub(super) values: Vec<f64>,
    /// Model less reading of the compared samples of each log \[rad\].
    pub(super) left_rad: Vec<Vec<f64>>,
    /// Counted squares of that \[rad^2\].
    loss_rad2: f64,
}

impl Hypothesis {
    /// The best from values of all parameters: a few steps from each, and from the best to the end.
    ///
    /// # Errors
    /// [`Rejected`] where no drop can be computed.
    pub(super) fn fitted(swings: &Swings<'_>, causes: &[Cause], starts: &[Vec<f64>]) -> Result<Self, Rejected> {
        let problem = Problem::new(swings, causes);
        let search = |x: &Vec<f64>, budget| approach(&problem, x, budget, CLOSE);
        let points = ranked(&problem, starts.iter().map(|values| problem.coordinates_of(values)));
        let looked: Vec<Solution> = points.par_iter().map(|x| search(x, LOOK)).collect();
        let best = looked.into_iter().min_by(|a, b| a.criterion.total_cmp(&b.criterion));
        let best = best.map(|looked| search(&looked.x, BUDGET));
        let Solution { x, .. } =
            best.ok_or_else(|| Rejected { why: "no start gives a motion that stays finite".into() })?;
        let left_rad = problem.residuals_rad(&x)?;
        let loss_rad2 = losses(&swings.fit, &left_rad);
        let samples: f64 = swings.fit.iter().flat_map(counts).sum();
        let rests = swings.fit.iter().zip(&left_rad).map(|(e, left)| at_rest_rad(e, left));
        let values = problem.values(&x);
        let spread = uncertainty(&problem, &problem.linearise(&x)?).ok();
        let mut open = vec![true; values.len()];
        let free = free_of(&problem.parameters);
        for (k, &i) in free.iter().enumerate() {
            open[i] = !spread.as_ref().is_some_and(|u| u.half_width_robust(k).is_finite());
        }
        let all = estimates(&problem.parameters, &values, &x, &open, spread.as_ref());
        Ok(Self {
            causes: causes.to_vec(),
            found: free.into_iter().map(|i| all[i].clone()).collect(),
            rms_rad: (loss_rad2 / samples).sqrt(),
            rest_rad: rests.collect(),
            values,
            left_rad,
            loss_rad2,
        })
    }

    /// What was found of the parameter that a cause sets free.
    pub fn of(&self, cause: Cause) -> Option<&Estimate> {
        self.found.iter().find(|estimate| cause.frees(&estimate.name))
    }

    /// RMS of the distances at rest \[rad\].
    pub fn rest_rms_rad(&self) -> f64 {
        (self.rest_rad.iter().map(|d| d * d).sum::<f64>() / self.rest_rad.len().max(1) as f64).sqrt()
    }

    /// Deviance and charge: less is better.
    pub(super) fn score(&self, measure: Measure) -> f64 {
        measure.deviance_of(self.loss_rad2) + measure.charge_of(self.found.len(), self.causes.len())
    }

    /// What the encoder would read along a log of the case with what was found \[rad\].
    ///
    /// # Errors
    /// As [`bench_drop`](crate::robot::bench::bench_drop).
    pub fn readings(&self, swings: &Swings<'_>, e: &Experiment) -> Result<Vec<f64>, SimulateError> {
        swings.readings(e, held(&self.causes), &self.values)
    }
}
