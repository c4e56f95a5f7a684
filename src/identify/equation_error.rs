//! Where to start: parameters that explain the smoothed accelerations of the logs.
//!
//! The equation error needs no integration, has no local minima to speak of, and does not care how wrong the first
//! guess was. It is biased, because accelerations taken from quantised angles are; it only starts the real fit.

use super::parameter::{free_of, values_in};
use super::smooth::{Moment, motion};
use super::{Experiment, JointModel, Signal};
use crate::fit::{Block, Budget, Coordinate, Method, Rejected, Residuals, Rounding, solve};
use crate::joint::{Chain, Dual, Real, Setpoint};
use crate::log::Hold;

/// Smoothed accelerations per experiment, at the most.
const MOMENTS: usize = 400;
/// A joint slower than this share of its top speed may be sticking.
const SLOW: f64 = 0.05;

struct EquationError<'a, M: JointModel> {
    model: &'a M,
    experiments: &'a [Experiment],
    moments: Vec<Vec<Moment>>,
    coordinates: Vec<Coordinate>,
    free: Vec<usize>,
    base: Vec<f64>,
    weights: Vec<f64>,
}

/// Motor torque of an experiment at one sample \[N m\].
fn motor_nm<T: Real>(chain: &Chain<T>, e: &Experiment, at: &Moment) -> T {
    let is_on = |on: &Option<Vec<bool>>| on.as_ref().is_none_or(|on| on[at.index]);
    match &e.signal {
        Signal::Torque { torque_nm, on } if is_on(on) => T::constant(torque_nm[at.index]),
        Signal::Position { setpoint_rad, hold, on, .. } if is_on(on) => {
            let Some(motor) = &chain.motor else { return T::nought() };
            let rate = match hold {
                Hold::Linear if at.index > 0 => {
                    (setpoint_rad[at.index] - setpoint_rad[at.index - 1]) / (e.t_s[at.index] - e.t_s[at.index - 1])
                }
                _ => 0.0,
            };
            let setpoint = Setpoint { angle_rad: T::constant(setpoint_rad[at.index]), rate_rad_s: T::constant(rate) };
            motor.torque_nm(setpoint, T::constant(at.angle_rad), T::constant(at.rate_rad_s), T::nought())
        }
        _ => T::nought(),
    }
}

impl<M: JointModel> EquationError<'_, M> {
    fn values<T: Real>(&self, x: &[f64], seed: impl Fn(f64, usize) -> T) -> Vec<T> {
        values_in(self.model.parameters(), &self.base, &self.free, x, seed)
    }

    fn errors<T: Real>(&self, values: &[T], experiment: usize, mut visit: impl FnMut(T)) {
        let e = &self.experiments[experiment];
        let chain = self.model.chain(values, e);
        for m in &self.moments[experiment] {
            let motor_nm = motor_nm(&chain, e, m);
            let (t, q, w) = (T::constant(e.t_s[m.index]), T::constant(m.angle_rad), T::constant(m.rate_rad_s));
            visit(chain.slip_rate_rad_s2(t, q, w, m.rate_rad_s.signum(), motor_nm) - m.acceleration_rad_s2);
        }
    }
}

impl<M: JointModel> Residuals for EquationError<'_, M> {
    fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    fn criterion(&self, x: &[f64]) -> Result<f64, Rejected> {
        let values = self.values(x, |v, _| v);
        let mut sum = 0.0;
        for k in 0..self.experiments.len() {
            self.errors(&values, k, |e| sum += e * e);
        }
        if sum.is_finite() { Ok(sum) } else { Err(Rejected { why: "no finite acceleration".into() }) }
    }

    fn linearise(&self, x: &[f64]) -> Result<Vec<Block>, Rejected> {
        const N: usize = 12;
        let p = self.free.len().min(N);
        let values = self.values(x, |v, k| if k < N { Dual::<N>::variable(v, k) } else { Dual::constant(v) });
        let mut blocks = Vec::with_capacity(self.experiments.len());
        for k in 0..self.experiments.len() {
            let mut block = Block { columns: (0..p).collect(), residual: Vec::new(), jacobian: Vec::new() };
            self.errors(&values, k, |e| {
                block.residual.push(e.re);
                block.jacobian.extend_from_slice(&e.eps[..p]);
            });
            blocks.push(block);
        }
        Ok(blocks)
    }

    fn rounding(&self, _block: usize) -> Rounding {
        Rounding::default()
    }

    fn weights(&self, _block: usize) -> &[f64] {
        &self.weights
    }
}

/// Parameter values that explain the smoothed accelerations best, from `from`; `None` where nothing moves.
pub(super) fn equation_error_values<M: JointModel>(
    model: &M,
    experiments: &[Experiment],
    from: &[f64],
) -> Option<Vec<f64>> {
    let parameters = model.parameters();
    let free = free_of(parameters);
    if free.is_empty() {
        return None;
    }
    let moments: Vec<Vec<Moment>> = experiments
        .iter()
        .map(|e| {
            let stride = (e.t_s.len() / MOMENTS).max(1);
            let mut moments = motion(&e.t_s, &e.measured_rad, e.uncompared, stride);
            let fastest = moments.iter().map(|m| m.rate_rad_s.abs()).fold(0.0, f64::max);
            moments.retain(|m| m.rate_rad_s.abs() > SLOW * fastest);
            moments
        })
        .collect();
    if moments.iter().map(Vec::len).sum::<usize>() < free.len() + 3 {
        return None;
    }
    let coordinates = free.iter().map(|&i| parameters[i].coordinate()).collect();
    let x: Vec<f64> = free.iter().map(|&i| parameters[i].to_coordinate(from[i])).collect();
    let problem =
        EquationError { model, experiments, moments, coordinates, free, base: from.to_vec(), weights: Vec::new() };
    let solution = solve(&problem, &x, Method::Lm, Budget { evaluations: 60 });
    solution.criterion.is_finite().then(|| problem.values(&solution.x, |v, _| v))
}
