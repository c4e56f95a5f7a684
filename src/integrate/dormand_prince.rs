//! Dormand and Prince's pair of orders 5 and 4 (1980), first same as last, with a step that follows its error.

use super::solver::{Counts, Ode, Stalled, Tolerance, finite, shortest_s, weighted};
use crate::number::math;

const STAGES: usize = 7;
const NODES: [f64; STAGES] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
/// Row by row; the last is the solution of order 5.
const WEIGHTS: [&[f64]; STAGES] = [
    &[],
    &[0.2],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Order 5 less order 4.
const ERROR: [f64; STAGES] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

#[derive(Clone, Debug)]
pub(super) struct DormandPrince {
    tolerance: Tolerance,
    /// Of the next step \[s\]; `None`: to be found.
    step_s: Option<f64>,
    k: Vec<Vec<f64>>,
    at: Vec<f64>,
    error: Vec<f64>,
}

impl DormandPrince {
    pub(super) fn new(tolerance: Tolerance, length: usize) -> Self {
        let zeros = vec![0.0; length];
        Self { tolerance, step_s: None, k: vec![zeros.clone(); STAGES], at: zeros.clone(), error: zeros }
    }

    /// The first stage is computed anew, for the system may have changed by a leap since the last call.
    pub(super) fn advance(
        &mut self,
        ode: &mut impl Ode,
        t_s: &mut f64,
        y: &mut [f64],
        until_s: f64,
        counts: &mut Counts,
    ) -> Result<(), Stalled> {
        ode.rate(*t_s, y, &mut self.k[0]);
        counts.evaluations += 1;
        while *t_s < until_s {
            let left_s = until_s - *t_s;
            // A first step that changes the state by a hundredth of its allowed error per unit, as a start.
            let wished_s = self.step_s.unwrap_or_else(|| 0.01 / weighted(&self.k[0], y, self.tolerance).max(1e-6));
            let (h, is_last) = if wished_s >= left_s * (1.0 - 1e-9) { (left_s, true) } else { (wished_s, false) };
            if h < shortest_s(*t_s) && !is_last {
                return Err(Stalled { at_s: *t_s, why: "the step became too short" });
            }
            self.stages(ode, *t_s, y, h);
            counts.evaluations += STAGES as u64 - 1;
            for (i, error) in self.error.iter_mut().enumerate() {
                *error = h * ERROR.iter().zip(&self.k).map(|(weight, k)| weight * k[i]).sum::<f64>();
            }
            let error = weighted(&self.error, &self.at, self.tolerance);
            if !(error <= 1.0) || !finite(&self.at) {
                counts.rejected += 1;
                let shrink = if error.is_finite() { (0.9 * math::powf(error, -0.2)).clamp(0.1, 0.9) } else { 0.1 };
                self.step_s = Some(h * shrink);
                if h * shrink < shortest_s(*t_s) {
                    return Err(Stalled { at_s: *t_s, why: "the step became too short" });
                }
                continue;
            }
            y.copy_from_slice(&self.at);
            counts.steps += 1;
            *t_s = if is_last { until_s } else { *t_s + h };
            let grow = if error > 0.0 { (0.9 * math::powf(error, -0.2)).clamp(0.2, 5.0) } else { 5.0 };
            // A step cut short by the end says little about the next one's length.
            self.step_s = Some((h * grow).max(if is_last { wished_s.min(h * 1e3) } else { 0.0 }));
            self.k.swap(0, STAGES - 1);
        }
        Ok(())
    }

    /// Fills `k[1..]`, and `at` with the solution of order 5.
    fn stages(&mut self, ode: &mut impl Ode, t_s: f64, y: &[f64], h: f64) {
        for stage in 1..STAGES {
            let (known, rest) = self.k.split_at_mut(stage);
            for (i, at) in self.at.iter_mut().enumerate() {
                *at = y[i] + h * WEIGHTS[stage].iter().zip(known.iter()).map(|(w, k)| w * k[i]).sum::<f64>();
            }
            ode.rate(t_s + NODES[stage] * h, &self.at, &mut rest[0]);
        }
    }
}
