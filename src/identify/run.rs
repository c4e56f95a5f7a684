//! One fit from beginning to end: starts, search, prediction.

use super::equation_error::equation_error_values;
use super::parameter::{free_of, starts_of};
use super::{Experiment, JointModel, Named, Parameter, Problem, Search};
use crate::fit::{Budget, Method, Rejected, Residuals, Solution, solve};
use crate::number::math;
use crate::pendulum::Diverged;
use rayon::prelude::*;
use serde::Serialize;

/// A search that has ended.
#[derive(Clone, Debug, Serialize)]
pub struct Found {
    /// Values of all parameters.
    pub values: Vec<f64>,
    /// Start of each experiment: angle \[rad\], then release instant \[s\] or rate \[rad/s\].
    pub starts: Vec<[f64; 2]>,
    /// Where the optimiser ended, in coordinates.
    pub solution: Solution,
}

/// Searches that are carried to the end, from the best of the candidates.
const SEARCHES: usize = 2;
/// A fit whose RMS is this many times the encoder's rounding may be a local minimum: look further.
const SUSPICIOUS: f64 = 2.5;
/// Further starts that are tried then, and evaluations that each may cost before the best is carried on.
const FURTHER: usize = 24;
const FURTHER_EVALUATIONS: usize = 24;
/// Samples up to which a search may spend all it is given; with more of them it gets less, so that time is bounded.
const PLENTY_OF_SAMPLES: usize = 5000;
/// Evaluations that a search gets however long the logs are.
const FEWEST_EVALUATIONS: usize = 120;

/// A fit that leaves this many times what noise and rounding explain may sit between two kinks of sticking.
const STRUCTURED: f64 = 1.05;
/// Factors on the Coulomb friction that are tried then, evaluations for each, and how often.
const STOP_FACTORS: [f64; 10] = [0.4, 0.6, 0.8, 0.9, 0.97, 1.03, 1.1, 1.25, 1.6, 2.5];
const NEIGHBOUR_EVALUATIONS: usize = 16;
const NEIGHBOURHOODS: usize = 3;

/// Fits the free parameters of a model to experiments.
///
/// The search starts from the best of several candidates: the given values, those that explain the smoothed
/// accelerations or short parts of the logs, and variations of both. Where the fit it ends in leaves more than the
/// encoder explains, more starts are spread around the best point, and the best of those is carried to the end.
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
    let budget = affordable(budget, experiments);
    let at_most = |count: usize| ((affordable_share(experiments) * count as f64).ceil() as usize).max(1);
    let mut best = Best::default();
    let starts = candidates(model, experiments).into_iter().map(|values| problem.coordinates_of(&values));
    for x in ranked(&problem, starts).iter().take(SEARCHES) {
        best.keep(solve(&problem, x, method, budget));
    }
    let explained: f64 = experiments.iter().map(Experiment::rounding_rad2_s).sum();
    if best.criterion() > SUSPICIOUS.powi(2) * explained && !problem.free().is_empty() {
        let middle = best.solution.as_ref().map_or_else(|| starts_of(model.parameters()), |s| problem.values(&s.x));
        let short = Budget { evaluations: FURTHER_EVALUATIONS };
        let mut further: Vec<Solution> = spread_around(model, &middle, at_most(FURTHER))
            .par_iter()
            .map(|values| solve(&problem, &problem.coordinates_of(values), Method::Lm, short))
            .collect();
        further.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
        best.evaluations += further.iter().map(|s| s.evaluations).sum::<usize>();
        let promising = 2.0 * best.criterion();
        for solution in further.into_iter().take(SEARCHES).filter(|s| s.criterion < promising) {
            best.keep(solve(&problem, &solution.x, method, budget));
        }
    }
    for _ in 0..at_most(NEIGHBOURHOODS) {
        let Some(here) = best.solution.as_ref().map(|s| s.x.clone()) else { break };
        let before = best.criterion();
        if !leaves_structure(&problem, &here) {
            break;
        }
        let short = Budget { evaluations: NEIGHBOUR_EVALUATIONS };
        let mut neighbours: Vec<Solution> =
            other_stops(model, &problem, &here).par_iter().map(|x| solve(&problem, x, Method::Lm, short)).collect();
        neighbours.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
        best.evaluations += neighbours.iter().map(|s| s.evaluations).sum::<usize>();
        if let Some(neighbour) = neighbours.into_iter().next().filter(|n| n.criterion < before) {
            best.keep(solve(&problem, &neighbour.x, method, budget));
        }
        if !(best.criterion() < 0.999 * before) {
            break;
        }
    }
    let mut solution = best
        .solution
        .filter(|s| s.criterion.is_finite())
        .ok_or_else(|| Rejected { why: "no start gives a motion that stays finite".into() })?;
    solution.evaluations = best.evaluations;
    Ok(found(&problem, solution))
}

/// The share of the work on a short log that is affordable on these: all of it up to [`PLENTY_OF_SAMPLES`].
fn affordable_share(experiments: &[Experiment]) -> f64 {
    let samples: usize = experiments.iter().map(Experiment::compared).sum();
    (PLENTY_OF_SAMPLES as f64 / samples.max(1) as f64).min(1.0)
}

/// A budget that costs about as much time on long logs as on short ones.
fn affordable(budget: Budget, experiments: &[Experiment]) -> Budget {
    let share = (affordable_share(experiments) * budget.evaluations as f64) as usize;
    Budget { evaluations: share.max(FEWEST_EVALUATIONS).min(budget.evaluations) }
}

/// Carries an earlier search on, after a parameter has been held at a value.
pub(super) fn refine<M: JointModel>(
    model: &M,
    experiments: &[Experiment],
    earlier: &Found,
    method: Method,
    budget: Budget,
) -> Found {
    let problem = Problem::new(model, experiments);
    let values: Vec<f64> =
        model.parameters().iter().zip(&earlier.values).map(|(p, &v)| if p.fixed { p.start } else { v }).collect();
    let start = problem.coordinates_from(&Found { values, ..earlier.clone() });
    let mut solution = solve(&problem, &start, method, affordable(budget, experiments));
    solution.evaluations += earlier.solution.evaluations;
    solution.trace.splice(0..0, earlier.solution.trace.iter().copied());
    found(&problem, solution)
}

fn found<M: JointModel>(problem: &Problem<'_, M>, solution: Solution) -> Found {
    Found {
        values: problem.values(&solution.x),
        starts: (0..problem.experiments.len()).map(|k| problem.start(&solution.x, k)).collect(),
        solution,
    }
}

/// The best solution so far, and the evaluations that all of them cost.
#[derive(Default)]
struct Best {
    solution: Option<Solution>,
    evaluations: usize,
}

impl Best {
    fn criterion(&self) -> f64 {
        self.solution.as_ref().map_or(f64::INFINITY, |s| s.criterion)
    }

    fn keep(&mut self, solution: Solution) {
        self.evaluations += solution.evaluations;
        if self.solution.is_none() || solution.criterion < self.criterion() {
            self.solution = Some(solution);
        }
    }
}

/// Whether a fit leaves more than the noise of the readings, as their own roughness shows it, and their rounding.
fn leaves_structure<M: JointModel>(problem: &Problem<'_, M>, x: &[f64]) -> bool {
    let (mut left, mut explained) = (0.0, 0.0);
    for (k, e) in problem.experiments.iter().enumerate() {
        let mut residual = Vec::with_capacity(e.t_s.len());
        if problem.motion(x, k, |i, s| residual.push(s.angle_rad - e.measured_rad[i])).is_err() {
            return false;
        }
        let residual = &residual[e.uncompared..];
        // Second differences of white noise have six times its variance; a smooth misfit has hardly any.
        let rough: f64 = residual.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).powi(2)).sum();
        let white = rough / (6.0 * residual.len().saturating_sub(2).max(1) as f64);
        explained += e.weights_s.iter().sum::<f64>() * white.max(e.resolution_rad.powi(2) / 12.0);
        left += residual.iter().zip(&e.weights_s).map(|(r, w)| w * r * r).sum::<f64>();
    }
    left > STRUCTURED * explained
}

/// Points at which the joint stops in other half swings: the Coulomb friction changed by factors.
///
/// Where a joint sticks, the criterion has a kink for every stop that comes or goes, and between two kinks there may be
/// a minimum of its own.
fn other_stops<M: JointModel>(model: &M, problem: &Problem<'_, M>, x: &[f64]) -> Vec<Vec<f64>> {
    let free = free_of(model.parameters());
    let Some(at) = free.iter().position(|&i| model.parameters()[i].named() == Some(Named::Coulomb)) else {
        return Vec::new();
    };
    let c = &problem.coordinates()[at];
    STOP_FACTORS
        .iter()
        .map(|factor| {
            let mut other = x.to_vec();
            other[at] = ((x[at] + 1e-4 * c.scale) * factor).clamp(c.lower, c.upper);
            other
        })
        .collect()
}

/// Points of a problem in the order of their criterion; those without a motion are left out.
pub(crate) fn ranked(problem: &dyn Residuals, points: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    let mut ranked: Vec<(f64, Vec<f64>)> =
        points.filter_map(|x| problem.criterion(&x).ok().map(|criterion| (criterion, x))).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranked.dedup_by(|a, b| a.1 == b.1);
    ranked.into_iter().map(|(_, x)| x).collect()
}

/// Values from which a search may start: the parameters' own starts, the values that explain the smoothed
/// accelerations, those that explain short parts of the logs, and the first two with a parameter changed by a factor.
pub(crate) fn candidates<M: JointModel>(model: &M, experiments: &[Experiment]) -> Vec<Vec<f64>> {
    let parameters = model.parameters();
    let given = starts_of(parameters);
    let mut all = vec![given.clone()];
    all.extend(equation_error_values(model, experiments, &given));
    let parts: Vec<Experiment> = experiments.iter().flat_map(|e| e.parts(PART_S)).collect();
    let parts: Vec<Experiment> = parts.iter().step_by(parts.len().div_ceil(MOST_PARTS).max(1)).cloned().collect();
    if parts.len() > experiments.len() {
        let problem = Problem::new(model, &parts);
        if let Some(x) = ranked(&problem, all.iter().map(|values| problem.coordinates_of(values))).first() {
            all.push(problem.values(&solve(&problem, x, Method::Lm, Budget { evaluations: 40 }).x));
        }
    }
    for base in all.clone().iter().take(2) {
        for name in ["inertia", "coulomb", "viscous", "b_over_ml2", "g_over_l"] {
            let Some(i) = parameters.iter().position(|p| p.name == name && !p.fixed) else { continue };
            for factor in [0.5, 2.0] {
                let mut changed = base.clone();
                changed[i] *= factor;
                all.push(changed);
            }
        }
    }
    all.iter().map(|values| inside_bounds(model, values)).collect()
}

/// Parts at the most, spread evenly: each has two coordinates of its own, and work grows with the cube of their number.
const MOST_PARTS: usize = 60;
/// Length of the parts \[s\].
const PART_S: f64 = 0.6;

/// Quasi-random points about the best one: positive quantities within a factor, frictions from none to twice.
fn spread_around<M: JointModel>(model: &M, middle: &[f64], count: usize) -> Vec<Vec<f64>> {
    let parameters = model.parameters();
    // Halton's sequence: even coverage, no seed.
    let radical_inverse = |mut n: usize, base: usize| {
        let (mut inverse, mut digit) = (0.0, 1.0 / base as f64);
        while n > 0 {
            inverse += digit * (n % base) as f64;
            (n, digit) = (n / base, digit / base as f64);
        }
        inverse
    };
    const BASES: [usize; 10] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29];
    (1..=count)
        .map(|n| {
            let mut values = middle.to_vec();
            for (k, i) in free_of(parameters).into_iter().enumerate() {
                let u = 2.0 * radical_inverse(n, BASES[k % BASES.len()]) - 1.0;
                values[i] = match parameters[i].search {
                    Search::Logarithm => values[i] * math::exp(0.3 * u),
                    Search::Linear { scale } if parameters[i].lower == 0.0 => (values[i] + 0.05 * scale) * (1.0 + u),
                    Search::Linear { scale } => values[i] + 0.5 * scale * u,
                };
            }
            inside_bounds(model, &values)
        })
        .collect()
}

fn inside_bounds<M: JointModel>(model: &M, values: &[f64]) -> Vec<f64> {
    let clamp = |(&value, p): (&f64, &Parameter)| {
        if p.fixed {
            return value;
        }
        let c = p.coordinate();
        p.from_coordinate(p.to_coordinate(value).clamp(c.lower, c.upper))
    };
    values.iter().zip(model.parameters()).map(clamp).collect()
}

/// RMS of each experiment predicted from the others alone \[rad\]: fitted again without it, from `found`.
///
/// Empty for a single experiment. NaN where a prediction runs away.
pub(super) fn held_out_in_turn<M: JointModel>(
    model: &M,
    experiments: &[Experiment],
    found: &Found,
    method: Method,
    budget: Budget,
) -> Vec<f64> {
    if experiments.len() < 2 {
        return Vec::new();
    }
    let without = |k: usize| -> f64 {
        let keep = |i: &usize| *i != k;
        let others: Vec<Experiment> = (0..experiments.len()).filter(keep).map(|i| experiments[i].clone()).collect();
        let starts = (0..experiments.len()).filter(keep).map(|i| found.starts[i]).collect();
        let earlier = Found { starts, ..found.clone() };
        let values = refine(model, &others, &earlier, method, budget).values;
        let alone = predict(model, std::slice::from_ref(&experiments[k]), &values);
        alone.ok().and_then(|p| p.first().map(|p| p.rms_rad)).unwrap_or(f64::NAN)
    };
    (0..experiments.len()).into_par_iter().map(without).collect()
}

/// How a model moves along one experiment.
#[derive(Clone, Debug, Serialize)]
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
        .par_iter()
        .map(|e| {
            let problem = Problem::of_starts(model, std::slice::from_ref(e), values);
            let solve_from = |start: [f64; 2]| solve(&problem, &start, Method::Lm, Budget { evaluations: 60 });
            let best = possible_starts(e)
                .into_iter()
                .map(solve_from)
                .min_by(|a, b| a.criterion.total_cmp(&b.criterion))
                .map_or_else(|| e.start_coordinates(&e.start).to_vec(), |s| s.x);
            prediction(&problem, &best, 0)
        })
        .collect()
}

/// Starts from which the true one may be found: a joint near rest may stick, or be about to move either way.
fn possible_starts(e: &Experiment) -> Vec<[f64; 2]> {
    let [angle, second] = e.start_coordinates(&e.start);
    let seconds = match e.release_window_s {
        Some([low, high]) => vec![second, 0.5 * (low + high), low],
        None => vec![second, 0.0, 0.2, -0.2],
    };
    let first_reading = e.measured_rad[0];
    seconds.into_iter().flat_map(|second| [[angle, second], [first_reading, second]]).collect()
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
