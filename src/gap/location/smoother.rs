//! A fixed-interval smoother for a joint with an unknown torque, linear about a path.
//!
//! State: angle, speed, the acceleration that the unknown torque gives, and its slope. The last two are an integrated
//! random walk (a cubic smoothing spline in time). Forward a Kalman filter, backward the disturbance smoother of
//! de Jong (1989), which needs no inverse and so bears a joint whose speed is known to be zero.

use crate::number::math;

fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
}

/// Angle \[rad\], speed \[rad/s\], lacking acceleration \[rad/s^2\] and its slope \[rad/s^3\].
pub(in crate::gap) type State = [f64; 4];
type Matrix = [[f64; 4]; 4];

/// What may happen to the unknown acceleration between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gap) enum Change {
    /// It goes on smoothly.
    Smooth,
    /// It may jump: the joint reverses.
    Jump,
    /// It is forgotten: the joint rests, and the readings say nothing about it.
    Forgotten,
}

/// From one sample to the next: `x' = (upper x + offset, smooth unknown)`.
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Step {
    /// Derivatives of angle and speed by the state before.
    pub upper: [[f64; 4]; 2],
    /// Angle and speed for a state of zeros.
    pub offset: [f64; 2],
    /// \[s\]
    pub dt_s: f64,
    /// What may happen to the unknown acceleration.
    pub change: Change,
    /// How lively the joint is here, as a share of the liveliest part: scales what the unknown may do.
    pub lively: f64,
    /// Variance that angle \[rad^2\] and speed \[rad^2/s^2\] gain.
    pub loose: [f64; 2],
}

/// How much the unknown acceleration may vary.
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Prior {
    /// Its standard deviation after a time `span_s` \[rad/s^2\].
    pub size_rad_s2: f64,
    /// \[s\]
    pub span_s: f64,
}

impl Prior {
    /// Variance of the unknown acceleration where nothing is known of it.
    fn level(&self) -> f64 {
        self.size_rad_s2 * self.size_rad_s2
    }

    /// Variance of its slope there.
    fn slope(&self) -> f64 {
        self.level() / (self.span_s * self.span_s)
    }
}

/// A reading: its value \[rad\] and variance \[rad^2\].
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Reading {
    pub value_rad: f64,
    pub variance_rad2: f64,
}

/// What is known of angle and speed before the first reading.
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Begin {
    pub mean: [f64; 2],
    pub variance: [f64; 2],
}

/// The filter at one sample, before its reading is seen.
#[derive(Clone, Copy, Debug)]
struct Predicted {
    mean: State,
    covariance: Matrix,
}

/// Running state of the filter.
pub(in crate::gap) struct Filter {
    mean: State,
    covariance: Matrix,
    prior: Prior,
}

/// How a reading compares with what was expected of it.
#[derive(Clone, Copy, Debug)]
struct Surprise {
    innovation: f64,
    variance: f64,
}

impl Filter {
    fn new(begin: &Begin, prior: Prior) -> Self {
        let mut covariance = [[0.0; 4]; 4];
        covariance[0][0] = begin.variance[0];
        covariance[1][1] = begin.variance[1];
        covariance[2][2] = FIRST * FIRST * prior.level();
        covariance[3][3] = FIRST * FIRST * prior.slope();
        Self { mean: [begin.mean[0], begin.mean[1], 0.0, 0.0], covariance, prior }
    }

    fn see(&mut self, reading: &Reading) -> Surprise {
        let p = &mut self.covariance;
        let row = p[0];
        let variance = row[0] + reading.variance_rad2;
        let innovation = reading.value_rad - self.mean[0];
        for i in 0..4 {
            let gain = row[i] / variance;
            self.mean[i] += gain * innovation;
            for j in 0..4 {
                p[i][j] -= gain * row[j];
            }
        }
        Surprise { innovation, variance }
    }

    fn go(&mut self, step: &Step) {
        let m = &self.mean;
        let [u, w] = &step.upper;
        let h = step.dt_s;
        let first = [dot(u, m) + step.offset[0], dot(w, m) + step.offset[1]];
        let p = &self.covariance;
        let lively = step.lively * step.lively;
        let (level, slope) = (self.prior.level() * lively, self.prior.slope() * lively);
        if step.change == Change::Forgotten {
            let times =
                |row: &[f64; 4]| std::array::from_fn::<f64, 4, _>(|j| dot(row, &[p[0][j], p[1][j], p[2][j], p[3][j]]));
            let (pu, pw) = (times(u), times(w));
            let cross = dot(&pu, w);
            self.mean = [first[0], first[1], 0.0, 0.0];
            self.covariance = [
                [dot(&pu, u) + step.loose[0], cross, 0.0, 0.0],
                [cross, dot(&pw, w) + step.loose[1], 0.0, 0.0],
                [0.0, 0.0, FIRST * FIRST * level, 0.0],
                [0.0, 0.0, 0.0, FIRST * FIRST * slope],
            ];
            return;
        }
        self.mean = [first[0], first[1], m[2] + h * m[3], m[3]];
        // Rows of the product of the transition with the covariance, which is symmetric.
        let mut rows = [[0.0; 4]; 4];
        for j in 0..4 {
            rows[0][j] = u[0] * p[0][j] + u[1] * p[1][j] + u[2] * p[2][j] + u[3] * p[3][j];
            rows[1][j] = w[0] * p[0][j] + w[1] * p[1][j] + w[2] * p[2][j] + w[3] * p[3][j];
            rows[2][j] = p[2][j] + h * p[3][j];
            rows[3][j] = p[3][j];
        }
        let across = |row: &[f64; 4]| [dot(row, u), dot(row, w), row[2] + h * row[3], row[3]];
        let mut q = [across(&rows[0]), across(&rows[1]), across(&rows[2]), across(&rows[3])];
        // The variance reaches the square of the size after the span.
        let drive = 3.0 * slope / self.prior.span_s;
        q[0][0] += step.loose[0];
        q[1][1] += step.loose[1];
        q[2][2] += drive * h * h * h / 3.0;
        q[2][2] += ROUGH * level * h / self.prior.span_s;
        q[2][3] += drive * h * h / 2.0;
        q[3][2] = q[2][3];
        q[3][3] += drive * h;
        if step.change == Change::Jump {
            q[2][2] += JUMP * JUMP * level;
            q[3][3] += JUMP * JUMP * slope;
        }
        self.covariance = q;
    }
}

/// Standard deviation of the unknown before anything is seen, in units of the prior's size.
const FIRST: f64 = 3.0;
/// Standard deviation of a jump, in the same units.
const JUMP: f64 = 0.3;
/// Variance of a random walk over the span, in units of the square of the size: friction has kinks.
const ROUGH: f64 = 0.03;

/// Fit of a prior to the readings.
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Likelihood {
    /// Logarithm of the likelihood, at the best common scale of all variances that is not below one.
    pub log: f64,
    /// That scale: above one where the readings scatter more than they should.
    pub scale: f64,
}

/// How likely the readings are under a prior.
pub(in crate::gap) fn likelihood(begin: &Begin, steps: &[Step], readings: &[Reading], prior: Prior) -> Likelihood {
    let mut filter = Filter::new(begin, prior);
    let (mut logs, mut squares) = (0.0, 0.0);
    // Logarithms of products: one logarithm for eight variances.
    let mut product = 1.0;
    for (k, reading) in readings.iter().enumerate() {
        let s = filter.see(reading);
        product *= s.variance / reading.variance_rad2;
        squares += s.innovation * s.innovation / s.variance;
        if k % 8 == 7 {
            logs += math::ln(product);
            product = 1.0;
        }
        if let Some(step) = steps.get(k) {
            filter.go(step);
        }
    }
    logs += math::ln(product);
    let n = readings.len().max(1) as f64;
    let scale = (squares / n).max(1.0);
    Likelihood { log: -0.5 * (logs + n * math::ln(scale) + squares / scale), scale }
}

/// A smoothed sample.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::gap) struct Smoothed {
    pub mean: State,
    /// Variances of angle, speed and lacking acceleration.
    pub variance: [f64; 3],
}

/// Smooths readings over steps that are asked for as the filter goes along, with its state at hand.
pub(in crate::gap) fn smooth(
    begin: &Begin,
    readings: &[Reading],
    prior: Prior,
    mut step: impl FnMut(usize, &State) -> Step,
) -> Vec<Smoothed> {
    let n = readings.len();
    let mut filter = Filter::new(begin, prior);
    let mut forward: Vec<(Predicted, Surprise, Option<Step>)> = Vec::with_capacity(n);
    for (k, reading) in readings.iter().enumerate() {
        let predicted = Predicted { mean: filter.mean, covariance: filter.covariance };
        let surprise = filter.see(reading);
        let next = (k + 1 < n).then(|| step(k, &filter.mean));
        if let Some(next) = &next {
            filter.go(next);
        }
        forward.push((predicted, surprise, next));
    }
    backward(&forward)
}

fn backward(forward: &[(Predicted, Surprise, Option<Step>)]) -> Vec<Smoothed> {
    let mut smoothed = vec![Smoothed::default(); forward.len()];
    let mut r = [0.0; 4];
    let mut n: Matrix = [[0.0; 4]; 4];
    for (k, (predicted, surprise, step)) in forward.iter().enumerate().rev() {
        if let Some(step) = step {
            (r, n) = through(step, &r, &n);
        }
        // Through the update: (I - K H)' r and (I - K H)' n (I - K H), where H picks the angle.
        let p = &predicted.covariance;
        let gain: [f64; 4] = std::array::from_fn(|i| p[0][i] / surprise.variance);
        let nk: [f64; 4] = std::array::from_fn(|i| (0..4).map(|j| n[i][j] * gain[j]).sum());
        let knk: f64 = (0..4).map(|i| gain[i] * nk[i]).sum();
        let kr: f64 = (0..4).map(|i| gain[i] * r[i]).sum();
        r[0] += surprise.innovation / surprise.variance - kr;
        for i in 1..4 {
            n[0][i] -= nk[i];
            n[i][0] -= nk[i];
        }
        n[0][0] += 1.0 / surprise.variance + knk - 2.0 * nk[0];
        smoothed[k] = Smoothed {
            mean: std::array::from_fn(|i| predicted.mean[i] + dot(&p[i], &r)),
            variance: std::array::from_fn(|i| {
                let row = &p[i];
                let taken: f64 = (0..4).map(|j| row[j] * dot(&n[j], row)).sum();
                (row[i] - taken).max(0.0)
            }),
        };
    }
    smoothed
}

/// `r` and `n` carried back through a transition.
fn through(step: &Step, r: &[f64; 4], n: &Matrix) -> ([f64; 4], Matrix) {
    let [u, w] = &step.upper;
    let (keep, h) = match step.change {
        Change::Forgotten => (0.0, 0.0),
        _ => (1.0, step.dt_s),
    };
    let down = |x: &[f64; 4]| {
        [
            u[0] * x[0] + w[0] * x[1],
            u[1] * x[0] + w[1] * x[1],
            u[2] * x[0] + w[2] * x[1] + keep * x[2],
            u[3] * x[0] + w[3] * x[1] + h * x[2] + keep * x[3],
        ]
    };
    let rows: Matrix = std::array::from_fn(|i| down(&n[i]));
    let mut back = [[0.0; 4]; 4];
    for j in 0..4 {
        let column = down(&[rows[0][j], rows[1][j], rows[2][j], rows[3][j]]);
        for i in 0..4 {
            back[i][j] = column[i];
        }
    }
    (down(r), back)
}

#[cfg(test)]
#[path = "smoother_tests.rs"]
mod tests;
