//! What the logs say about each parameter, and what they do not.
//!
//! A fit is run with everything free that may be; a parameter, or a combination, that the logs leave open is then held
//! at what is known of it and named, and the fit is run again. Nothing undetermined is reported as a number.

use super::parameter::{Parameter, Search, free_of};
use super::run::{Found, Prediction, prediction, refine, search};
use super::{Belief, Experiment, JointModel, Named, Problem, unit_rad2_s};
use crate::fit::{Budget, Method, Rejected, Residuals, Solution, Stop, Uncertainty, Undetermined, uncertainty};
use crate::number::quantity;
use nalgebra::DVector;
use serde::Serialize;

/// What may be said about a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The logs determine it.
    Determined,
    /// Held at a given value, as the user or the study says.
    Held,
    /// The logs do not determine it; it was held at what is known of it.
    NotDetermined,
}

/// A parameter after the fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The name in `fit.json` and on the command line.
    pub name: String,
    /// The letter in the equations.
    pub symbol: String,
    /// Its unit.
    pub unit: String,
    /// What may be said of it.
    pub status: Status,
    /// The estimate, or the value at which it was held.
    pub value: f64,
    /// 95 % interval that allows for correlated residuals.
    pub interval: Option<[f64; 2]>,
    /// 95 % interval as if residuals were white.
    pub interval_naive: Option<[f64; 2]>,
    /// What the engineer believed, where known.
    pub nominal: Option<f64>,
}

impl Estimate {
    /// `0.92 [0.90, 0.94] N m instead of 0.155 N m`; `None` where its interval does not leave out what was believed.
    pub(crate) fn instead(&self) -> Option<String> {
        let (interval, believed) = (self.interval?, self.nominal?);
        let leaves_out = !(interval[0]..=interval[1]).contains(&believed);
        let [found, believed] = [(self.value, Some(interval)), (believed, None)]
            .map(|(value, interval)| quantity(value, interval, &self.unit));
        leaves_out.then(|| format!("{found} instead of {believed}"))
    }
}

/// A model fitted to logs. Written down it has its estimates, not the model and the covariances behind them.
#[derive(Clone, Debug, Serialize)]
#[serde(bound = "")]
pub struct Fitted<M> {
    /// The model with what was held marked as fixed.
    #[serde(skip)]
    pub model: M,
    /// One for each parameter of the model, in its order.
    pub estimates: Vec<Estimate>,
    /// Where the search ended.
    pub found: Found,
    /// One for each experiment that was fitted.
    pub predictions: Vec<Prediction>,
    /// Free parameters, in the order of the covariance.
    pub free: Vec<usize>,
    /// Covariances at the solution: the free parameters first, then the starts.
    #[serde(skip)]
    pub uncertainty: Uncertainty,
    /// How it was searched.
    pub method: Method,
}

/// Half-width of the logarithm of a quantity beyond which it counts as undetermined: a factor of three.
const OPEN_FACTOR: f64 = 1.1;
/// The same for the moment, which sets the scale of everything else and is usually known better.
const OPEN_MOMENT: f64 = 0.4;
/// Half-width of a friction or an angle, in typical sizes, beyond which it counts as undetermined.
const OPEN_LINEAR: f64 = 0.5;

/// A search carried on under beliefs: from where it stands, and from where beliefs without heavy tails would have it.
/// Under heavy ones several numbers far off may each hold the others there, where one alone would cost less.
fn settled<M: JointModel + Clone>(
    model: &M,
    experiments: &[Experiment],
    found: &Found,
    method: Method,
    budget: Budget,
) -> Found {
    let mut normal = model.clone();
    for p in normal.parameters_mut() {
        p.belief = p.belief.map(Belief::normal);
    }
    let here = refine(model, experiments, found, method, budget);
    let near = refine(&normal, experiments, found, method, budget);
    // The way there is no part of the search's record: its criterion is another one.
    let solution = Solution { evaluations: near.solution.evaluations, ..found.solution.clone() };
    let there = refine(model, experiments, &Found { solution, ..near }, method, budget);
    if there.solution.criterion < here.solution.criterion { there } else { here }
}

/// Fits a model and says what the logs determine.
///
/// # Errors
/// [`Rejected`] where no motion can be computed.
pub fn conclude<M: JointModel + Clone>(
    model: &M,
    experiments: &[Experiment],
    method: Method,
    budget: Budget,
) -> Result<Fitted<M>, Rejected> {
    let mut model = model.clone();
    let mut open = vec![false; model.parameters().len()];
    let is_believed = model.parameters().iter().any(|p| p.belief.is_some() && !p.fixed);
    if is_believed {
        // Enough for what no log shows to stay where it is believed to be; what beliefs weigh is settled below.
        let silent: Vec<Vec<f64>> = experiments.iter().map(|e| vec![0.0; e.compared()]).collect();
        model.weigh_beliefs(unit_rad2_s(experiments, &silent));
    }
    let mut found = search(&model, experiments, method, budget)?;
    for _ in 0..if is_believed { SETTLES } else { 0 } {
        model.weigh_beliefs(unit_rad2_s(experiments, &residuals(&model, experiments, &found)));
        found = settled(&model, experiments, &found, method, budget);
    }
    loop {
        let problem = Problem::new(&model, experiments);
        let blocks = problem.linearise(&found.solution.x)?;
        let free: Vec<usize> = (0..open.len()).filter(|&i| !model.parameters()[i].fixed).collect();
        let verdict = uncertainty(&problem, &blocks);
        let worst = match &verdict {
            Ok(u) => most_open(&model, &free, u),
            Err(undetermined) => Some(scapegoat(&model, &free, &undetermined.direction)),
        };
        let (Some(k), false) = (worst, free.is_empty()) else {
            let Ok(uncertainty) = verdict else {
                return Err(Rejected { why: "the logs have too few samples for the starts alone".into() });
            };
            let predictions = (0..experiments.len())
                .map(|k| prediction(&problem, &found.solution.x, k))
                .collect::<Result<_, _>>()
                .map_err(|diverged| Rejected { why: diverged.to_string() })?;
            let estimates = estimates(model.parameters(), &found.values, &found.solution.x, &open, Some(&uncertainty));
            return Ok(Fitted { model, estimates, found, predictions, free, uncertainty, method });
        };
        let held = free[k];
        open[held] = true;
        let (named, nominal) = (model.parameters()[held].named(), model.parameters()[held].nominal);
        // Without any nominal value everything is counted per unit of inertia.
        let scale = match named {
            Some(Named::Inertia) if nominal.is_none() => Some(1.0),
            Some(Named::Moment) => nominal,
            _ => None,
        };
        let at_nominal = scale.or(nominal).map(|value| {
            hold(&mut model, held, value);
            let mut at_nominal = refine(&model, experiments, &found, method, budget);
            if at_nominal.solution.criterion > CONTRADICTED * found.solution.criterion
                && let Ok(again) = search(&model, experiments, method, budget)
                && again.solution.criterion < at_nominal.solution.criterion
            {
                at_nominal = again;
            }
            at_nominal
        });
        found = match at_nominal {
            Some(at) if scale.is_some() || at.solution.criterion <= CONTRADICTED * found.solution.criterion => at,
            _ => {
                // Nothing that is known fits: the best point stays, and what goes with the parameter is as open as it.
                for other in companions(k, free.len(), &verdict) {
                    open[free[other]] = true;
                }
                hold(&mut model, held, found.values[held]);
                refine(&model, experiments, &found, method, budget)
            }
        };
    }
}

/// A nominal value that makes the criterion this many times larger is contradicted by the logs.
const CONTRADICTED: f64 = 1.02;

/// Beliefs weigh as much as the residuals that are left say; so often is enough to come to rest.
const SETTLES: usize = 2;

/// Model less reading of each experiment's compared samples \[rad\].
fn residuals<M: JointModel>(model: &M, experiments: &[Experiment], found: &Found) -> Vec<Vec<f64>> {
    let problem = Problem::new(model, experiments);
    let of = |k: usize| {
        let (e, mut residual) = (&experiments[k], Vec::with_capacity(experiments[k].compared()));
        let motion = problem.motion(&found.solution.x, k, |i, s| {
            if i >= e.uncompared {
                residual.push(s.angle_rad - e.measured_rad[i]);
            }
        });
        if motion.is_ok() { residual } else { Vec::new() }
    };
    (0..experiments.len()).map(of).collect()
}

fn hold<M: JointModel>(model: &mut M, parameter: usize, value: f64) {
    let parameter = &mut model.parameters_mut()[parameter];
    parameter.fixed = true;
    parameter.start = value;
}

/// Correlation beyond which two parameters are open together.
const TOGETHER: f64 = 0.95;

/// Free parameters that are open together with the `k`-th.
fn companions(k: usize, free: usize, verdict: &Result<Uncertainty, Undetermined>) -> Vec<usize> {
    let together = |other: usize| match verdict {
        Ok(u) => {
            let c = &u.robust;
            !((c[(k, other)] / (c[(k, k)] * c[(other, other)]).sqrt()).abs() < TOGETHER)
        }
        Err(undetermined) => undetermined.direction[other].abs() > 0.05,
    };
    (0..free).filter(|&other| other != k && together(other)).collect()
}

/// The free parameter whose interval says least, where one says too little.
fn most_open<M: JointModel>(model: &M, free: &[usize], u: &Uncertainty) -> Option<usize> {
    let openness = |k: usize| {
        let p = &model.parameters()[free[k]];
        let half_width = u.half_width_robust(k).max(p.known_to);
        match p.search {
            Search::Logarithm if p.named() == Some(Named::Moment) && p.nominal.is_some() => half_width / OPEN_MOMENT,
            Search::Logarithm => half_width / OPEN_FACTOR,
            Search::Linear { scale } => half_width / (OPEN_LINEAR * scale),
        }
    };
    let scale_first = |k: usize| if model.parameters()[free[k]].named() == Some(Named::Moment) { 1e6 } else { 1.0 };
    (0..free.len())
        .filter(|&k| !(openness(k) <= 1.0))
        .max_by(|&a, &b| (openness(a) * scale_first(a)).total_cmp(&(openness(b) * scale_first(b))))
}

/// Which parameter to hold where a direction is undetermined: the one that is usually known beforehand.
fn scapegoat<M: JointModel>(model: &M, free: &[usize], direction: &DVector<f64>) -> usize {
    let parameters = model.parameters();
    let known = parameters.iter().any(|p| p.named() == Some(Named::Moment) && p.nominal.is_some());
    let rank = |k: usize| match parameters[free[k]].named() {
        Some(Named::Moment) if known => 0,
        Some(Named::Inertia) if !known => 1,
        Some(Named::Mass(_)) => 2,
        Some(Named::Ml2 | Named::Inertia) => 3,
        Some(Named::StribeckSpeed) => 4,
        Some(Named::StaticExcess) => 5,
        _ => 6,
    };
    let takes_part = |k: &usize| direction[*k].abs() > 0.05;
    (0..free.len()).filter(takes_part).min_by_key(|&k| rank(k)).unwrap_or_else(|| {
        (0..free.len()).max_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs())).unwrap_or(0)
    })
}

/// What may be said of each parameter: the free ones stand first among the coordinates `x`, and in the covariance, which is
/// `None` where there is none. Those that are open have no interval.
pub(crate) fn estimates(
    parameters: &[Parameter],
    values: &[f64],
    x: &[f64],
    open: &[bool],
    u: Option<&Uncertainty>,
) -> Vec<Estimate> {
    let free = free_of(parameters);
    let of = |(i, p): (usize, &Parameter)| {
        let k = free.iter().position(|&f| f == i);
        let known = k.filter(|_| !open[i]).zip(u);
        let interval = |half_width: &dyn Fn(&Uncertainty, usize) -> f64| {
            known.map(|(k, u)| {
                let (c, x) = (p.coordinate(), x[k]);
                let on_bound = x <= c.lower || x >= c.upper;
                let middle = if on_bound { x + u.unbounded_step[k] } else { x };
                let half_width = half_width(u, k);
                [middle - half_width, middle + half_width].map(|edge| p.from_coordinate(edge.max(c.lower).min(c.upper)))
            })
        };
        Estimate {
            name: p.name.clone(),
            symbol: p.symbol.clone(),
            unit: p.unit.clone(),
            status: match k {
                _ if open[i] => Status::NotDetermined,
                Some(_) => Status::Determined,
                None => Status::Held,
            },
            value: values[i],
            interval: interval(&Uncertainty::half_width_robust),
            interval_naive: interval(&Uncertainty::half_width_naive),
            nominal: p.nominal,
        }
    };
    parameters.iter().enumerate().map(of).collect()
}

impl Estimate {
    /// Which of the pendulum models' parameters it is; `None` for one of another model.
    pub fn named(&self) -> Option<Named> {
        Named::of(&self.name)
    }
}

impl<M: JointModel> Fitted<M> {
    /// The estimate of a parameter; `None` where the model has no such parameter.
    pub fn estimate(&self, named: Named) -> Option<&Estimate> {
        self.estimates.iter().find(|e| e.named() == Some(named))
    }

    /// RMS over all compared samples of the fitted experiments \[rad\].
    pub fn rms_rad(&self, experiments: &[Experiment]) -> f64 {
        let samples: usize = experiments.iter().map(Experiment::compared).sum();
        let squares: f64 =
            self.predictions.iter().zip(experiments).map(|(p, e)| p.rms_rad.powi(2) * e.compared() as f64).sum();
        (squares / samples.max(1) as f64).sqrt()
    }

    /// Why the search stopped.
    pub fn stop(&self) -> Stop {
        self.found.solution.stop
    }

    /// Correlation matrix of the free parameters, robust.
    pub fn correlation(&self) -> Vec<Vec<f64>> {
        let c = &self.uncertainty.robust;
        (0..self.free.len())
            .map(|i| (0..self.free.len()).map(|k| c[(i, k)] / (c[(i, i)] * c[(k, k)]).sqrt()).collect())
            .collect()
    }

    /// A function of the parameter values with its 95 % intervals, robust and naive, by the delta method.
    pub fn derived(&self, function: impl Fn(&[f64]) -> f64) -> (f64, [f64; 2], [f64; 2]) {
        let parameters = self.model.parameters();
        let value = function(&self.found.values);
        let slopes: Vec<f64> = self
            .free
            .iter()
            .enumerate()
            .map(|(k, &i)| {
                // The covariance is in coordinates, so the slope is too.
                let x = self.found.solution.x[k];
                let step = 1e-5 * x.abs().max(1e-3);
                let at = |x: f64| {
                    let mut values = self.found.values.clone();
                    values[i] = parameters[i].from_coordinate(x);
                    function(&values)
                };
                (at(x + step) - at(x - step)) / (2.0 * step)
            })
            .collect();
        let spread = |covariance: &nalgebra::DMatrix<f64>| {
            let mut variance = 0.0;
            for (i, a) in slopes.iter().enumerate() {
                for (k, b) in slopes.iter().enumerate() {
                    variance += a * b * covariance[(i, k)];
                }
            }
            variance.max(0.0).sqrt()
        };
        let robust = self.uncertainty.quantile_robust() * spread(&self.uncertainty.robust);
        let naive = self.uncertainty.quantile_naive() * spread(&self.uncertainty.naive);
        (value, [value - robust, value + robust], [value - naive, value + naive])
    }
}
