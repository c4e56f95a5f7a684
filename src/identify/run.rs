//! One fit from beginning to end: starts, search, prediction.

use super::equation_error::equation_error_values;
use super::{Experiment, JointModel, Problem};
use crate::fit::{Budget, Method, Rejected, Residuals, Solution, solve};
use crate::pendulum::Diverged;

/// A search that has ended.
#[derive(Clone, Debug)]
pub struct Found {
    /// Values of all parameters.
    pub values: Vec<f64>,
    /// Where the optimiser ended, in coordinates.
    pub solution: Solution,
}

/// Full searches that are started, from the best of the candidates.
const SEARCHES: usize = 2;

/// Fits the free parameters of a model to experiments.
///
/// The search starts from the two best of: the parameters' own starts, the values that explain the smoothed
/// accelerations, and both with friction or inertia changed by a factor. It ends in the better of the two.
///
/// # Errors
/// [`Rejected`] where no candidate gives a motion at all.
pub fn search<M: JointModel>(
    model: &M,
    experiments: &[Experiment],
    method: Method,
    budget: Budget,
) -> Result<Found, Rejected> {
    let problem = Problem::new(model, experiments);
    let mut candidates: Vec<(f64, Vec<f64>)> = candidates(model, experiments)
        .into_iter()
        .map(|values| problem.coordinates_of(&values))
        .filter_map(|x| problem.criterion(&x).ok().map(|criterion| (criterion, x)))
        .collect();
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    candidates.dedup_by(|a, b| a.1 == b.1);
    let mut best: Option<Solution> = None;
    let mut evaluations = candidates.len();
    for (_, x) in candidates.iter().take(SEARCHES) {
        let solution = solve(&problem, x, method, budget);
        evaluations += solution.evaluations;
        if best.as_ref().is_none_or(|b| solution.criterion < b.criterion) {
            best = Some(solution);
        }
    }
    let mut solution = best
        .filter(|s| s.criterion.is_finite())
        .ok_or_else(|| Rejected { why: "no start gives a motion that stays finite".into() })?;
    solution.evaluations = evaluations;
    Ok(Found { values: problem.values(&solution.x), solution })
}

/// Values from which a search may start.
fn candidates<M: JointModel>(model: &M, experiments: &[Experiment]) -> Vec<Vec<f64>> {
    let parameters = model.parameters();
    let given: Vec<f64> = parameters.iter().map(|p| p.start).collect();
    let explained = equation_error_values(model, experiments, &given);
    let mut all = vec![given];
    all.extend(explained);
    for base in all.clone() {
        for name in ["inertia", "coulomb", "viscous", "b_over_ml2", "g_over_l"] {
            let Some(i) = parameters.iter().position(|p| p.name == name && !p.fixed) else { continue };
            for factor in [0.5, 2.0] {
                let mut changed = base.clone();
                changed[i] *= factor;
                all.push(changed);
            }
        }
    }
    for values in &mut all {
        for (value, p) in values.iter_mut().zip(parameters) {
            let c = p.coordinate();
            *value = p.from_coordinate(p.to_coordinate(*value).clamp(c.lower, c.upper));
        }
    }
    all
}

/// How a model moves along one experiment.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// At every sample of the experiment \[rad\].
    pub angle_rad: Vec<f64>,
    /// \[rad/s\]
    pub rate_rad_s: Vec<f64>,
    /// Start: angle, then release instant or rate.
    pub start: [f64; 2],
    /// Root of the mean squared residual over the compared samples \[rad\].
    pub rms_rad: f64,
    /// The criterion (3.7) \[rad^2 s\].
    pub criterion_rad2_s: f64,
}

/// Predicts each experiment with all parameters at `values`; each experiment's own start is found first.
///
/// # Errors
/// [`Diverged`] where a motion runs away.
pub fn predict<M: JointModel>(
    model: &M,
    experiments: &[Experiment],
    values: &[f64],
) -> Result<Vec<Prediction>, Diverged> {
    experiments
        .iter()
        .map(|e| {
            let problem = Problem::of_starts(model, std::slice::from_ref(e), values);
            let solution = solve(&problem, &problem.coordinates_of(values), Method::Lm, Budget { evaluations: 100 });
            prediction(&problem, &solution.x, 0)
        })
        .collect()
}

/// The motion of one experiment of a problem at a point.
///
/// # Errors
/// [`Diverged`] where the motion runs away.
pub fn prediction<M: JointModel>(problem: &Problem<'_, M>, x: &[f64], k: usize) -> Result<Prediction, Diverged> {
    let e = &problem.experiments[k];
    let (mut angle_rad, mut rate_rad_s) = (Vec::with_capacity(e.t_s.len()), Vec::with_capacity(e.t_s.len()));
    problem.motion(x, k, |_, s| {
        angle_rad.push(s.angle_rad);
        rate_rad_s.push(s.rate_rad_s);
    })?;
    let errors = angle_rad[e.uncompared..].iter().zip(&e.measured_rad[e.uncompared..]).map(|(a, b)| a - b);
    let squares: Vec<f64> = errors.map(|e| e * e).collect();
    Ok(Prediction {
        start: problem.start(x, k),
        rms_rad: (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt(),
        criterion_rad2_s: squares.iter().zip(&e.weights_s).map(|(s, w)| s * w).sum(),
        angle_rad,
        rate_rad_s,
    })
}
