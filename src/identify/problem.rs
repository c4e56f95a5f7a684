//! A joint model against logs, as a least-squares problem: shared parameters, and a start of its own for each log.

use super::parameter::{free_of, starts_of, values_in};
use super::{Experiment, Found, JointModel, Parameter, Signal};
use crate::deadline::Deadline;
use crate::fit::{Block, Coordinate, Rejected, Residuals, Rounding};
use crate::joint::{Chain, Dual, Real};
use crate::pendulum::{Diverged, Start, State};
use rayon::prelude::*;

/// A model, the experiments it is held against, and the coordinates that are searched.
pub struct Problem<'a, M: JointModel> {
    /// What is fitted.
    pub model: &'a M,
    /// What it is held against.
    pub experiments: &'a [Experiment],
    /// Free parameters of the model first, then two start coordinates for each experiment.
    coordinates: Vec<Coordinate>,
    /// Indices of the free parameters.
    free: Vec<usize>,
    /// Values of all parameters; the free ones are overwritten.
    base: Vec<f64>,
    /// Until when it is searched.
    deadline: Option<&'a Deadline>,
}

/// How far a start angle may lie from its guess \[rad\], at least; and in quantisation steps.
const START_REACH_RAD: f64 = 0.1;
const START_REACH_STEPS: f64 = 10.0;

impl<'a, M: JointModel> Problem<'a, M> {
    /// The problem of fitting `model`'s free parameters to the experiments.
    pub fn new(model: &'a M, experiments: &'a [Experiment]) -> Self {
        let parameters = model.parameters();
        Self::with(model, experiments, free_of(parameters), starts_of(parameters))
    }

    /// The problem of finding where each experiment starts, with all parameters at `values`.
    pub fn of_starts(model: &'a M, experiments: &'a [Experiment], values: &[f64]) -> Self {
        Self::with(model, experiments, Vec::new(), values.to_vec())
    }

    fn with(model: &'a M, experiments: &'a [Experiment], free: Vec<usize>, base: Vec<f64>) -> Self {
        let parameters = model.parameters();
        let mut coordinates: Vec<Coordinate> = free.iter().map(|&i| parameters[i].coordinate()).collect();
        for (k, e) in experiments.iter().enumerate() {
            let reach = START_REACH_RAD.max(START_REACH_STEPS * e.resolution_rad);
            coordinates.push(Coordinate {
                name: format!("start angle of log {k}"),
                // What is guessed of where a log begins may miss what it reads there.
                lower: (e.start.angle_rad - reach).min(e.measured_rad[0] - 0.5 * reach),
                upper: (e.start.angle_rad + reach).max(e.measured_rad[0] + 0.5 * reach),
                scale: 0.5 * reach,
            });
            coordinates.push(match e.release_window_s {
                Some([lower, upper]) => {
                    Coordinate { name: format!("release of log {k}"), lower, upper, scale: upper - lower }
                }
                None => Coordinate {
                    name: format!("start rate of log {k}"),
                    lower: f64::NEG_INFINITY,
                    upper: f64::INFINITY,
                    scale: 1.0 + e.start.rate_rad_s.abs(),
                },
            });
        }
        Self { model, experiments, coordinates, free, base, deadline: None }
    }

    /// The same, searched no longer than a deadline allows.
    pub fn until(self, deadline: &'a Deadline) -> Self {
        Self { deadline: Some(deadline), ..self }
    }

    /// Free parameters of the model.
    pub fn free(&self) -> Vec<&Parameter> {
        self.free.iter().map(|&i| &self.model.parameters()[i]).collect()
    }

    /// Coordinates of a set of parameter values, with the experiments' guessed starts.
    pub fn coordinates_of(&self, values: &[f64]) -> Vec<f64> {
        let parameters = self.model.parameters();
        let shared = self.free.iter().map(|&i| parameters[i].to_coordinate(values[i]));
        shared.chain(self.experiments.iter().flat_map(|e| e.start_coordinates(&e.start))).collect()
    }

    /// Coordinates of a set of parameter values, with the starts of an earlier search.
    pub fn coordinates_from(&self, found: &Found) -> Vec<f64> {
        let parameters = self.model.parameters();
        let shared = self.free.iter().map(|&i| parameters[i].to_coordinate(found.values[i]));
        shared.chain(found.starts.iter().flatten().copied()).collect()
    }

    /// All parameter values at a point.
    pub fn values(&self, x: &[f64]) -> Vec<f64> {
        self.values_in(x, |value, _| value)
    }

    /// The start coordinates of an experiment at a point.
    pub fn start(&self, x: &[f64], experiment: usize) -> [f64; 2] {
        let at = self.free.len() + 2 * experiment;
        [x[at], x[at + 1]]
    }

    fn values_in<T: Real>(&self, x: &[f64], seed: impl Fn(f64, usize) -> T) -> Vec<T> {
        values_in(self.model.parameters(), &self.base, &self.free, x, seed)
    }

    /// The motion of an experiment at a point, sample by sample.
    ///
    /// # Errors
    /// [`Diverged`] where the motion runs away.
    pub fn motion(&self, x: &[f64], experiment: usize, visit: impl FnMut(usize, &State<f64>)) -> Result<(), Diverged> {
        let e = &self.experiments[experiment];
        let chain = self.model.chain(&self.values(x), e);
        let [first, second] = self.start(x, experiment);
        readings(&chain, e, e.start_from(first, second), visit)
    }

    /// Criterion of one experiment.
    fn criterion_of(&self, x: &[f64], experiment: usize) -> Result<f64, Diverged> {
        let e = &self.experiments[experiment];
        let mut sum = 0.0;
        self.motion(x, experiment, |k, s| {
            if k >= e.uncompared {
                sum += e.weights_s[k - e.uncompared] * (s.angle_rad - e.measured_rad[k]).powi(2);
            }
        })?;
        Ok(sum)
    }

    /// Residuals of one experiment with derivatives, in passes of as many variables as fit a dual number.
    fn block(&self, x: &[f64], experiment: usize) -> Result<Block, Diverged> {
        let shared = self.free.len();
        let columns: Vec<usize> = (0..shared).chain([shared + 2 * experiment, shared + 2 * experiment + 1]).collect();
        let rows = self.experiments[experiment].compared();
        let mut block =
            Block { residual: Vec::with_capacity(rows), jacobian: vec![0.0; rows * columns.len()], columns };
        let mut from = 0;
        while from < block.columns.len() {
            let left = block.columns.len() - from;
            from += match left {
                ..=2 => self.pass::<2>(x, experiment, from, &mut block)?,
                3..=4 => self.pass::<4>(x, experiment, from, &mut block)?,
                5..=8 => self.pass::<8>(x, experiment, from, &mut block)?,
                9..=10 => self.pass::<10>(x, experiment, from, &mut block)?,
                11..=12 => self.pass::<12>(x, experiment, from, &mut block)?,
                // What is wider than 128 bytes is copied by calls: two passes cost no more than one twice as wide.
                15..=22 => self.pass::<8>(x, experiment, from, &mut block)?,
                _ => self.pass::<14>(x, experiment, from, &mut block)?,
            };
        }
        Ok(block)
    }

    /// Fills the columns `from..from + N` of a block; answers how many variables it took.
    fn pass<const N: usize>(
        &self,
        x: &[f64],
        experiment: usize,
        from: usize,
        block: &mut Block,
    ) -> Result<usize, Diverged> {
        let e = &self.experiments[experiment];
        let width = block.columns.len();
        let taken = N.min(width - from);
        let seed = |value: f64, column: usize| -> Dual<N> {
            if (from..from + taken).contains(&column) {
                Dual::variable(value, column - from)
            } else {
                Dual::constant(value)
            }
        };
        let values = self.values_in(x, seed);
        let [first, second] = self.start(x, experiment);
        let start = e.start_from(seed(first, width - 2), seed(second, width - 1));
        let chain = self.model.chain(&values, e);
        let first_pass = from == 0;
        readings(&chain, e, start, |k, s| {
            if k < e.uncompared {
                return;
            }
            let row = k - e.uncompared;
            let root = e.weights_s[row].sqrt();
            if first_pass {
                block.residual.push(root * (s.angle_rad.re - e.measured_rad[k]));
            }
            let cells = &mut block.jacobian[row * width + from..][..taken];
            for (cell, d) in cells.iter_mut().zip(s.angle_rad.eps) {
                *cell = root * d;
            }
        })?;
        Ok(taken)
    }

    /// What is believed of the free parameters, and what is seen of them beside the motion, as one more block: a row for
    /// each, in the criterion's unit. `None` where there is nothing of that.
    pub fn beliefs(&self, x: &[f64]) -> Option<Block> {
        let root = self.model.unit_rad2_s().sqrt();
        let known = |k: usize| self.model.parameters()[self.free[k]].known_of();
        let columns: Vec<usize> = (0..self.free.len()).filter(|&k| known(k).next().is_some()).collect();
        if columns.is_empty() || !(root > 0.0) {
            return None;
        }
        let width = columns.len();
        let mut block = Block { columns, residual: Vec::new(), jacobian: Vec::new() };
        for (column, &k) in block.columns.iter().enumerate() {
            for belief in known(k) {
                let [strain, slope] = belief.strain(x[k]);
                block.residual.push(root * strain);
                block.jacobian.extend((0..width).map(|other| if other == column { root * slope } else { 0.0 }));
            }
        }
        Some(block)
    }

    /// Runs `f` over the experiments, on all threads where there are several; the results keep their order.
    fn each<R: Send>(&self, f: impl Fn(usize) -> Result<R, Diverged> + Sync) -> Result<Vec<R>, Rejected> {
        let n = self.experiments.len();
        let results: Result<Vec<R>, Diverged> =
            if n > 1 { (0..n).into_par_iter().map(&f).collect() } else { (0..n).map(&f).collect() };
        results.map_err(|diverged| Rejected { why: diverged.to_string() })
    }
}

/// Steps are so many times as fine as elsewhere where an oscillation does not last, or what acts is known as smoothed
/// readings tell: a quarter of a radian of the fastest one, of which Runge-Kutta's fourth order loses 1e-5 rad.
const COARSE: f64 = 0.4;

/// The motion of an experiment as its encoder reads it: start and states are readings, not true angles.
pub(crate) fn readings<T: Real>(
    chain: &Chain<T>,
    e: &Experiment,
    start: Start<T>,
    visit: impl FnMut(usize, &State<T>),
) -> Result<(), Diverged> {
    // A controller that never lets go brings its joint to rest; beside other joints of a robot finer steps would follow nothing.
    let is_held = matches!(e.signal, Signal::Position { on: None, .. });
    let refinement = if is_held || e.carriage.is_some() { COARSE } else { 1.0 };
    crate::pendulum::readings(chain, e.input(), &e.t_s, start, refinement, visit)
}

impl<M: JointModel> Residuals for Problem<'_, M> {
    fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    fn is_over(&self) -> bool {
        self.deadline.is_some_and(|deadline| deadline.cuts("fits to their end"))
    }

    fn criterion(&self, x: &[f64]) -> Result<f64, Rejected> {
        let readings: f64 = self.each(|k| self.criterion_of(x, k))?.into_iter().sum();
        Ok(readings + self.beliefs(x).iter().flat_map(|b| &b.residual).map(|r| r * r).sum::<f64>())
    }

    fn linearise(&self, x: &[f64]) -> Result<Vec<Block>, Rejected> {
        let mut blocks = self.each(|k| self.block(x, k))?;
        blocks.extend(self.beliefs(x));
        Ok(blocks)
    }

    fn rounding(&self, block: usize) -> Rounding {
        self.experiments.get(block).map_or_else(Rounding::default, Experiment::rounding)
    }

    fn weights(&self, block: usize) -> &[f64] {
        self.experiments.get(block).map_or(&[], |e| &e.weights_s)
    }

    fn belief_variance(&self, block: usize) -> Option<f64> {
        (block >= self.experiments.len()).then(|| self.model.unit_rad2_s())
    }
}
