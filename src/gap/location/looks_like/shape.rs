//! Shapes with few parameters, fitted to a curve.

use crate::number::math;
use nalgebra::{DMatrix, DVector};

/// A shape with its numbers, in the units of the curve.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    Constant {
        value: f64,
    },
    Line {
        offset: f64,
        slope: f64,
    },
    /// A sine on a line.
    Periodic {
        period: f64,
        amplitude: f64,
        slope: f64,
    },
    /// `offset + factor x^2`, or `x |x|` where it is odd.
    Square {
        offset: f64,
        factor: f64,
        is_odd: bool,
    },
    /// From one level to another, by a hyperbolic tangent of this width.
    Step {
        at: f64,
        before: f64,
        behind: f64,
        width: f64,
    },
    /// From a level at zero to another one far away.
    Settling {
        at_zero: f64,
        far: f64,
        width: f64,
    },
    /// Zero within a band about zero, then a line.
    DeadBand {
        band: f64,
        slope: f64,
    },
    /// A level, and a line beyond a place; side +1: above it.
    Beyond {
        from: f64,
        side: f64,
        slope: f64,
        level: f64,
    },
    Bump {
        at: f64,
        height: f64,
        width: f64,
        level: f64,
    },
    /// Lines of other slopes on the two sides of zero.
    TwoSlopes {
        offset: f64,
        below: f64,
        above: f64,
    },
}

/// A shape as well as it can be fitted.
pub(super) struct Fit {
    pub shape: Shape,
    pub parameters: usize,
    /// Mean square of what it leaves.
    pub left: f64,
}

/// A curve at many places.
pub(super) struct Samples {
    at: Vec<f64>,
    value: Vec<f64>,
    /// Of mean 1.
    weight: Vec<f64>,
    /// Variance of the values, weighted as they are; 0 where it is unknown.
    pub noise: f64,
    knots: usize,
}

impl Samples {
    pub fn new(at: Vec<f64>, value: Vec<f64>, sd: Option<&[f64]>, knots: usize) -> Self {
        let n = at.len() as f64;
        let (weight, noise) = match sd {
            None => (vec![1.0; at.len()], 0.0),
            Some(sd) => {
                let precision: Vec<f64> = sd.iter().map(|sd| sd.powi(-2)).collect();
                let mean = precision.iter().sum::<f64>() / n;
                (precision.iter().map(|p| p / mean).collect(), 1.0 / mean)
            }
        };
        Self { at, value, weight, noise, knots }
    }

    fn weighted(&self, f: impl Fn(f64) -> f64) -> f64 {
        let sum: f64 = self.value.iter().zip(&self.weight).map(|(y, w)| w * f(*y)).sum();
        sum / self.at.len() as f64
    }

    pub fn mean(&self) -> f64 {
        self.weighted(|y| y)
    }

    pub fn mean_square(&self) -> f64 {
        self.weighted(|y| y * y)
    }

    /// Variance about the mean.
    pub fn variation(&self) -> f64 {
        let mean = self.mean();
        self.weighted(|y| (y - mean).powi(2))
    }

    pub fn extremes(&self) -> [f64; 2] {
        let [low, high] = [f64::INFINITY, f64::NEG_INFINITY];
        self.value.iter().fold([low, high], |[low, high], y| [low.min(*y), high.max(*y)])
    }

    pub fn span(&self) -> f64 {
        let [low, high] = self.extremes();
        high - low
    }

    fn range(&self) -> [f64; 2] {
        [self.at[0], self.at[self.at.len() - 1]]
    }

    fn width(&self) -> f64 {
        let [from, to] = self.range();
        to - from
    }

    /// The share of the range on the lesser side of zero.
    fn lesser_side(&self) -> f64 {
        let [from, to] = self.range();
        (-from).min(to).max(0.0) / (to - from)
    }

    /// Least squares by functions of the place: the factors, and the mean square of what is left.
    fn by<const N: usize>(&self, columns: [&dyn Fn(f64) -> f64; N]) -> Option<([f64; N], f64)> {
        let n = self.at.len();
        let root: Vec<f64> = self.weight.iter().map(|w| w.sqrt()).collect();
        let matrix = DMatrix::from_fn(n, N, |i, j| columns[j](self.at[i]) * root[i]);
        let right = DVector::from_fn(n, |i, _| self.value[i] * root[i]);
        let scale: Vec<f64> = (0..N).map(|j| matrix.column(j).norm()).collect();
        let scaled = DMatrix::from_fn(n, N, |i, j| if scale[j] > 0.0 { matrix[(i, j)] / scale[j] } else { 0.0 });
        let normal = scaled.transpose() * &scaled;
        let factors = normal.cholesky()?.solve(&(scaled.transpose() * &right));
        let left = (right - scaled * &factors).norm_squared() / n as f64;
        let factors: [f64; N] = std::array::from_fn(|j| factors[j] / scale[j]);
        factors.iter().all(|f| f.is_finite()).then_some((factors, left))
    }
}

/// Whole sides of zero count as such from this share of the range on.
const BOTH_SIDES: f64 = 0.15;
/// Up to this share of the range a curve begins at zero.
const AT_ZERO: f64 = 0.1;
/// Widths of steps, bumps and the like, as shares of the range.
const WIDTHS: [f64; 8] = [0.02, 0.03, 0.045, 0.07, 0.1, 0.14, 0.19, 0.25];
/// Places of steps, kinks and bumps, as shares of the range.
const SHARES: usize = 33;
/// A wave is one from so many periods in the range on, and with so many knots in a period.
const LEAST_PERIODS: f64 = 1.9;
const KNOTS_PER_PERIOD: f64 = 3.5;
/// Steps of the frequency, as shares of one period in the range.
const PERIOD_STEP: f64 = 0.02;
/// A wave must be this share of what its line leaves.
const MOSTLY_WAVE: f64 = 0.6;

/// Every shape, as well as it fits.
pub(super) fn shapes(s: &Samples) -> Vec<Fit> {
    let [from, to] = s.range();
    let mut fits = lines(s);
    fits.extend(wave(s));
    let begins_at_zero = from.abs() < AT_ZERO * s.width();
    if begins_at_zero {
        fits.extend(settling(s));
    }
    if s.lesser_side() >= BOTH_SIDES {
        fits.extend(about_zero(s));
    }
    let places: Vec<f64> = (1..SHARES).map(|k| from + (to - from) * k as f64 / SHARES as f64).collect();
    let steps = places.iter().flat_map(|at| WIDTHS.map(|width| (*at, width * s.width())));
    fits.extend(least(steps.filter_map(|(at, width)| step(s, at, width, 4))));
    // What lies only near a beginning at zero settles.
    let sides: &[f64] = if begins_at_zero { &[1.0] } else { &[-1.0, 1.0] };
    let kinks = places.iter().flat_map(|at| sides.iter().map(|side| (*at, *side)));
    fits.extend(least(kinks.filter_map(|(at, side)| {
        let beyond = |x: f64| ((x - at) * side).max(0.0) * side;
        let ([level, slope], left) = s.by([&|_| 1.0, &beyond])?;
        Some(Fit { shape: Shape::Beyond { from: at, side, slope, level }, parameters: 3, left })
    })));
    let inside = places.iter().filter(|at| (from + 0.15 * s.width()..to - 0.15 * s.width()).contains(*at));
    fits.extend(least(inside.flat_map(|at| WIDTHS.map(|width| (*at, width * s.width()))).filter_map(|(at, width)| {
        let hump = |x: f64| math::exp(-((x - at) / width).powi(2));
        let ([level, height], left) = s.by([&|_| 1.0, &hump])?;
        Some(Fit { shape: Shape::Bump { at, height, width, level }, parameters: 4, left })
    })));
    fits
}

fn least(fits: impl Iterator<Item = Fit>) -> Option<Fit> {
    fits.min_by(|a, b| a.left.total_cmp(&b.left))
}

/// Lines and squares.
fn lines(s: &Samples) -> Vec<Fit> {
    let mut fits = Vec::new();
    if let Some(([offset, slope], left)) = s.by([&|_| 1.0, &|x| x]) {
        fits.push(Fit { shape: Shape::Line { offset, slope }, parameters: 2, left });
    }
    for is_odd in [false, true] {
        let square = |x: f64| if is_odd { x * x.abs() } else { x * x };
        if let Some(([offset, factor], left)) = s.by([&|_| 1.0, &square]) {
            fits.push(Fit { shape: Shape::Square { offset, factor, is_odd }, parameters: 2, left });
        }
    }
    fits
}

/// The best sine on a line, over a dense grid of frequencies.
fn wave(s: &Samples) -> Option<Fit> {
    let (_, of_line) = s.by([&|_| 1.0, &|x| x])?;
    let most = s.knots as f64 / KNOTS_PER_PERIOD;
    let steps = ((most - LEAST_PERIODS) / PERIOD_STEP).max(0.0) as usize;
    let periods = (0..=steps).map(|k| LEAST_PERIODS + k as f64 * PERIOD_STEP).filter(|periods| *periods <= most);
    let fits = periods.filter_map(|periods| {
        let period = s.width() / periods;
        let phase = |x: f64| std::f64::consts::TAU * x / period;
        let ([_, slope, sin, cos], left) =
            s.by([&|_| 1.0, &|x| x, &|x| math::sin(phase(x)), &|x| math::cos(phase(x))])?;
        Some(Fit { shape: Shape::Periodic { period, amplitude: math::hypot(sin, cos), slope }, parameters: 6, left })
    });
    least(fits).filter(|fit| fit.left < (1.0 - MOSTLY_WAVE) * of_line)
}

/// From a level at zero to one far away, by an exponential or a Gaussian.
fn settling(s: &Samples) -> Option<Fit> {
    let widths = (0..20).map(|k| s.width() * 0.03 * 1.15f64.powi(k));
    least(widths.flat_map(|width| [1, 2].map(|power| (width, power))).filter_map(|(width, power)| {
        let share = |x: f64| math::exp(-(x / width).abs().powi(power));
        let ([far, rise], left) = s.by([&|_| 1.0, &share])?;
        Some(Fit { shape: Shape::Settling { at_zero: far + rise, far, width }, parameters: 3, left })
    }))
}

fn step(s: &Samples, at: f64, width: f64, parameters: usize) -> Option<Fit> {
    let ([middle, half], left) = s.by([&|_| 1.0, &|x| math::tanh((x - at) / width)])?;
    Some(Fit { shape: Shape::Step { at, before: middle - half, behind: middle + half, width }, parameters, left })
}

/// What has zero as a special place.
fn about_zero(s: &Samples) -> Vec<Fit> {
    let [from, to] = s.range();
    let mut fits: Vec<Fit> =
        least(WIDTHS.iter().filter_map(|width| step(s, 0.0, width * s.width(), 3))).into_iter().collect();
    let bands = (1..SHARES).map(|k| 0.8 * from.abs().min(to) * k as f64 / SHARES as f64);
    fits.extend(least(bands.filter_map(|band| {
        let beyond = |x: f64| x - x.clamp(-band, band);
        let ([slope], left) = s.by([&beyond])?;
        Some(Fit { shape: Shape::DeadBand { band, slope }, parameters: 2, left })
    })));
    if let Some(([offset, below, above], left)) = s.by([&|_| 1.0, &|x| x.min(0.0), &|x| x.max(0.0)]) {
        fits.push(Fit { shape: Shape::TwoSlopes { offset, below, above }, parameters: 3, left });
    }
    fits
}
