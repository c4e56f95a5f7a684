//! Multistep formulas of variable order and step in Nordsieck's form, after Hindmarsh's LSODE (1983).
//!
//! The state is `z_j = h^j y^(j) / j!`. A step predicts by Pascal's triangle and corrects with `z_j += l_j e`, where `e`
//! solves `h f(y_0 + l_0 e) = z_1 + e`: by functional iteration for Adams, by Newton's method with a Jacobian of
//! differences, kept as long as it serves, for backward differentiation. Steps end on `until`, in equal parts.

mod coefficients;

use super::dense::Factors;
use super::solver::{Counts, Ode, Stalled, Tolerance, finite, shortest_s, weighted};
use crate::number::math;
use coefficients::Coefficients;

/// The two families of formulas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// Adams and Moulton's.
    Adams,
    /// Backward differentiation.
    Bdf,
}

impl Family {
    fn highest(self) -> usize {
        match self {
            Family::Adams => 12,
            Family::Bdf => 5,
        }
    }
}

/// Corrections of one step before its prediction is given up.
const CORRECTIONS: usize = 3;
/// Steps after which a Jacobian is renewed.
const JACOBIAN_STEPS: u64 = 20;
/// Change of `h l_0` beyond which the matrix is factored again.
const MATRIX_CHANGE: f64 = 0.3;
const TOO_SHORT: &str = "the step became too short";

#[derive(Clone, Debug)]
pub(super) struct Multistep {
    family: Family,
    tolerance: Tolerance,
    coefficients: Coefficients,
    order: usize,
    /// Of the next step \[s\]; 0 before the first.
    h: f64,
    /// Of the last step that was taken \[s\].
    taken: f64,
    z: Vec<Vec<f64>>,
    backup: Vec<Vec<f64>>,
    /// Steps until the order is looked at again.
    wait: usize,
    /// Most that the next change of step may grow it.
    most: f64,
    correction: Vec<f64>,
    /// The correction one step before the order is looked at.
    earlier: Vec<f64>,
    scale: Vec<f64>,
    at: Vec<f64>,
    f: Vec<f64>,
    work: Vec<f64>,
    newton: Option<Newton>,
}

#[derive(Clone, Debug)]
struct Newton {
    jacobian: Vec<f64>,
    factors: Factors,
    /// `h l_0` of the factors; `None`: there are none.
    factored: Option<f64>,
    /// Step at which the Jacobian was made.
    made: Option<u64>,
    is_fresh: bool,
}

impl Multistep {
    pub(super) fn new(family: Family, tolerance: Tolerance, length: usize) -> Self {
        let zeros = vec![0.0; length];
        let newton = (family == Family::Bdf).then(|| Newton {
            jacobian: vec![0.0; length * length],
            factors: Factors::new(length),
            factored: None,
            made: None,
            is_fresh: false,
        });
        Self {
            family,
            tolerance,
            coefficients: Coefficients::of(family),
            order: 1,
            h: 0.0,
            taken: 0.0,
            z: vec![zeros.clone(); family.highest() + 1],
            backup: vec![zeros.clone(); family.highest() + 1],
            wait: 2,
            most: 1e4,
            correction: zeros.clone(),
            earlier: zeros.clone(),
            scale: zeros.clone(),
            at: zeros.clone(),
            f: zeros.clone(),
            work: zeros,
            newton,
        }
    }

    pub(super) fn restart(&mut self) {
        self.h = 0.0;
        if let Some(newton) = &mut self.newton {
            (newton.factored, newton.made) = (None, None);
        }
    }

    pub(super) fn advance(
        &mut self,
        ode: &mut impl Ode,
        t_s: &mut f64,
        y: &mut [f64],
        until_s: f64,
        counts: &mut Counts,
    ) -> Result<(), Stalled> {
        while *t_s < until_s {
            if self.h == 0.0 || self.z[0] != y {
                self.start(ode, *t_s, y, until_s, counts);
            }
            let left_s = until_s - *t_s;
            let parts = (left_s / self.h * (1.0 - 1e-9)).ceil().max(1.0);
            self.rescale(left_s / parts / self.h);
            let before = self.h;
            self.step(ode, *t_s, counts)?;
            let whole = parts == 1.0 && self.taken == before;
            *t_s = if whole { until_s } else { *t_s + self.taken };
            y.copy_from_slice(&self.z[0]);
        }
        Ok(())
    }

    /// Order 1 from a state, with a step that changes it by a tenth of what is allowed.
    fn start(&mut self, ode: &mut impl Ode, t_s: f64, y: &[f64], until_s: f64, counts: &mut Counts) {
        ode.rate(t_s, y, &mut self.f);
        counts.evaluations += 1;
        let fast = weighted(&self.f, y, self.tolerance).max(1e-6);
        self.h = (0.1 / fast).min(until_s - t_s);
        (self.order, self.wait, self.most) = (1, 2, 1e4);
        self.z[0].copy_from_slice(y);
        for (z, f) in self.z[1].iter_mut().zip(&self.f) {
            *z = self.h * f;
        }
        if let Some(newton) = &mut self.newton {
            (newton.factored, newton.made) = (None, None);
        }
    }

    /// The same polynomial for a step `ratio` times as long.
    fn rescale(&mut self, ratio: f64) {
        self.h *= ratio;
        let mut power = 1.0;
        for z in &mut self.z[1..=self.order] {
            power *= ratio;
            z.iter_mut().for_each(|z| *z *= power);
        }
    }

    /// One step that holds, with as many tries as it takes; `h` and the order are then those of the next.
    fn step(&mut self, ode: &mut impl Ode, t_s: f64, counts: &mut Counts) -> Result<(), Stalled> {
        let mut failures = 0;
        loop {
            if self.h < shortest_s(t_s) {
                return Err(Stalled { at_s: t_s, why: TOO_SHORT });
            }
            let order = self.order;
            for (backup, z) in self.backup[..=order].iter_mut().zip(&self.z) {
                backup.copy_from_slice(z);
            }
            for (scale, y) in self.scale.iter_mut().zip(&self.z[0]) {
                *scale = *y;
            }
            self.predict();
            if !self.correct(ode, t_s + self.h, counts) {
                counts.rejected += 1;
                self.take_back();
                let can_renew = self.newton.as_ref().is_some_and(|newton| !newton.is_fresh);
                if can_renew {
                    self.forget_jacobian();
                } else {
                    self.most = 2.0;
                    self.rescale(0.25);
                }
                continue;
            }
            let error = weighted(&self.correction, &self.scale, self.tolerance) / self.coefficients.test(order, 1);
            if !(error <= 1.0) {
                counts.rejected += 1;
                failures += 1;
                self.take_back();
                self.most = 2.0;
                if failures >= 3 {
                    self.begin_again(ode, t_s, counts);
                } else {
                    self.after_failure(error, failures);
                }
                continue;
            }
            counts.steps += 1;
            self.taken = self.h;
            for (j, z) in self.z[..=order].iter_mut().enumerate() {
                let l = self.coefficients.corrector(order, j);
                for (z, e) in z.iter_mut().zip(&self.correction) {
                    *z += l * e;
                }
            }
            self.choose(error);
            self.most = 10.0;
            return Ok(());
        }
    }

    fn predict(&mut self) {
        for k in 1..=self.order {
            for j in (k..=self.order).rev() {
                let (lower, upper) = self.z.split_at_mut(j);
                for (below, z) in lower[j - 1].iter_mut().zip(&upper[0]) {
                    *below += z;
                }
            }
        }
    }

    fn take_back(&mut self) {
        for (z, backup) in self.z[..=self.order].iter_mut().zip(&self.backup) {
            z.copy_from_slice(backup);
        }
    }

    fn forget_jacobian(&mut self) {
        if let Some(newton) = &mut self.newton {
            (newton.factored, newton.made) = (None, None);
        }
    }

    /// Finds the correction; false where it does not settle.
    fn correct(&mut self, ode: &mut impl Ode, t_s: f64, counts: &mut Counts) -> bool {
        let l0 = self.coefficients.corrector(self.order, 0);
        self.correction.fill(0.0);
        self.at.copy_from_slice(&self.z[0]);
        if !self.prepare(ode, t_s, l0, counts) {
            return false;
        }
        let allowed = self.coefficients.test(self.order, 1) * 0.5 / (self.order + 2) as f64;
        let (mut rate, mut last) = (0.7f64, f64::INFINITY);
        for round in 0..CORRECTIONS {
            ode.rate(t_s, &self.at, &mut self.f);
            counts.evaluations += 1;
            for (i, work) in self.work.iter_mut().enumerate() {
                *work = self.h * self.f[i] - self.z[1][i] - self.correction[i];
            }
            if let Some(newton) = &mut self.newton {
                newton.factors.solve(&mut self.work);
            }
            let change = weighted(&self.work, &self.scale, self.tolerance);
            if !change.is_finite() {
                return false;
            }
            for (i, at) in self.at.iter_mut().enumerate() {
                self.correction[i] += self.work[i];
                *at = self.z[0][i] + l0 * self.correction[i];
            }
            if round > 0 {
                rate = (0.2 * rate).max(change / last);
            }
            if change * (1.5 * rate).min(1.0) <= allowed {
                return finite(&self.at);
            }
            if round > 0 && change > 2.0 * last {
                return false;
            }
            last = change;
        }
        false
    }

    /// Jacobian and factors, where the family needs them and the old ones do not serve.
    fn prepare(&mut self, ode: &mut impl Ode, t_s: f64, l0: f64, counts: &mut Counts) -> bool {
        let Some(newton) = &mut self.newton else { return true };
        let n = self.at.len();
        let gain = self.h * l0;
        newton.is_fresh = false;
        let old = newton.made.is_none_or(|made| counts.steps - made >= JACOBIAN_STEPS);
        if old {
            ode.rate(t_s, &self.at, &mut self.f);
            for column in 0..n {
                let value = self.at[column];
                let nudge = f64::EPSILON.sqrt() * value.abs().max(1e-3);
                self.at[column] = value + nudge;
                ode.rate(t_s, &self.at, &mut self.work);
                self.at[column] = value;
                for row in 0..n {
                    newton.jacobian[row * n + column] = (self.work[row] - self.f[row]) / nudge;
                }
            }
            counts.evaluations += n as u64 + 1;
            counts.jacobians += 1;
            (newton.made, newton.factored, newton.is_fresh) = (Some(counts.steps), None, true);
        }
        let serves = newton.factored.is_some_and(|factored| (gain / factored - 1.0).abs() <= MATRIX_CHANGE);
        if !serves {
            for (entry, slope) in newton.factors.entries.iter_mut().zip(&newton.jacobian) {
                *entry = -gain * slope;
            }
            for k in 0..n {
                newton.factors.entries[k * n + k] += 1.0;
            }
            if !newton.factors.factor() {
                return false;
            }
            newton.factored = Some(gain);
        }
        true
    }

    /// After an error that was too large: a shorter step, perhaps a lower order.
    fn after_failure(&mut self, error: f64, failures: u32) {
        let same = self.factor_same(error);
        let lower = self.factor_lower();
        let mut ratio = same;
        if self.order > 1 && lower > same {
            self.order -= 1;
            ratio = lower;
        }
        ratio = ratio.min(if failures >= 2 { 0.2 } else { 0.9 }).max(0.1);
        self.wait = self.order + 1;
        self.rescale(if ratio.is_finite() { ratio } else { 0.1 });
    }

    /// After several failures the polynomial is not to be trusted.
    fn begin_again(&mut self, ode: &mut impl Ode, t_s: f64, counts: &mut Counts) {
        self.h *= 0.1;
        (self.order, self.wait) = (1, 5);
        ode.rate(t_s, &self.z[0], &mut self.f);
        counts.evaluations += 1;
        for (z, f) in self.z[1].iter_mut().zip(&self.f) {
            *z = self.h * f;
        }
    }

    fn factor_same(&self, error: f64) -> f64 {
        1.0 / (1.2 * math::powf(error, 1.0 / (self.order + 1) as f64) + 1.2e-6)
    }

    fn factor_lower(&self) -> f64 {
        if self.order == 1 {
            return 0.0;
        }
        let test = self.coefficients.test(self.order, 0);
        let error = weighted(&self.z[self.order], &self.scale, self.tolerance) / test;
        1.0 / (1.3 * math::powf(error, 1.0 / self.order as f64) + 1.3e-6)
    }

    /// Looks at the order below and above once in a while, and chooses order and step.
    fn choose(&mut self, error: f64) {
        let highest = self.family.highest();
        self.wait = self.wait.saturating_sub(1);
        if self.wait == 1 && self.order < highest {
            self.earlier.copy_from_slice(&self.correction);
        }
        if self.wait > 0 {
            return;
        }
        let order = self.order;
        let (same, lower) = (self.factor_same(error), self.factor_lower());
        let higher = if order < highest {
            for (work, (now, earlier)) in self.work.iter_mut().zip(self.correction.iter().zip(&self.earlier)) {
                *work = now - earlier;
            }
            let change = weighted(&self.work, &self.scale, self.tolerance) / self.coefficients.test(order, 2);
            1.0 / (1.4 * math::powf(change, 1.0 / (order + 2) as f64) + 1.4e-6)
        } else {
            0.0
        };
        let best = same.max(lower).max(higher);
        if best < 1.1 {
            self.wait = 3;
            return;
        }
        if best == higher && higher > same {
            let l = self.coefficients.corrector(order, order) / (order + 1) as f64;
            for (z, e) in self.z[order + 1].iter_mut().zip(&self.correction) {
                *z = l * e;
            }
            self.order += 1;
        } else if best == lower && lower > same {
            self.order -= 1;
        }
        self.rescale(best.min(self.most));
        self.wait = self.order + 1;
    }
}
