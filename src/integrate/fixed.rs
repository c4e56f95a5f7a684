//! Runge-Kutta 2 and 4 with a fixed step.

use super::solver::{Counts, Ode, Stalled, finite};

#[derive(Clone, Debug)]
pub(super) struct Fixed {
    step_s: f64,
    is_fourth: bool,
    at: Vec<f64>,
    sum: Vec<f64>,
    k: Vec<f64>,
}

impl Fixed {
    pub(super) fn new(step_s: f64, is_fourth: bool, length: usize) -> Self {
        let zeros = vec![0.0; length];
        Self { step_s, is_fourth, at: zeros.clone(), sum: zeros.clone(), k: zeros }
    }

    pub(super) fn advance(
        &mut self,
        ode: &mut impl Ode,
        t_s: &mut f64,
        y: &mut [f64],
        until_s: f64,
        counts: &mut Counts,
    ) -> Result<(), Stalled> {
        let from_s = *t_s;
        let parts = ((until_s - from_s) / self.step_s * (1.0 - 1e-12)).ceil().max(1.0);
        let h = (until_s - from_s) / parts;
        for part in 0..parts as u64 {
            let t = from_s + part as f64 * h;
            if self.is_fourth {
                self.fourth(ode, t, y, h)
            } else {
                self.second(ode, t, y, h)
            }
            counts.evaluations += if self.is_fourth { 4 } else { 2 };
            if !finite(&self.at) {
                return Err(Stalled { at_s: t, why: "the state is no longer finite; take a shorter step" });
            }
            y.copy_from_slice(&self.at);
            counts.steps += 1;
            *t_s = t + h;
        }
        *t_s = until_s;
        Ok(())
    }

    /// `at = y + h k`.
    fn shift(&mut self, y: &[f64], h: f64) {
        for ((at, y), k) in self.at.iter_mut().zip(y).zip(&self.k) {
            *at = y + h * k;
        }
    }

    fn add(&mut self, weight: f64) {
        for (sum, k) in self.sum.iter_mut().zip(&self.k) {
            *sum += weight * k;
        }
    }

    fn second(&mut self, ode: &mut impl Ode, t: f64, y: &[f64], h: f64) {
        ode.rate(t, y, &mut self.k);
        self.shift(y, 0.5 * h);
        ode.rate(t + 0.5 * h, &self.at, &mut self.k);
        self.shift(y, h);
    }

    fn fourth(&mut self, ode: &mut impl Ode, t: f64, y: &[f64], h: f64) {
        self.sum.fill(0.0);
        ode.rate(t, y, &mut self.k);
        for (weight, share) in [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0)] {
            self.add(weight);
            self.shift(y, share * h);
            ode.rate(t + share * h, &self.at, &mut self.k);
        }
        self.add(1.0);
        std::mem::swap(&mut self.k, &mut self.sum);
        self.shift(y, h / 6.0);
    }
}
