//! A smooth curve through knots.

use super::BadLaw;
use crate::joint::Real;
use std::sync::Arc;

/// A cubic between each two knots, with the slope at a knot taken from it and its neighbours; constant beyond the ends.
///
/// Hermite's form with three-point slopes: the curve and its slope are continuous, each value acts on four pieces at the
/// most, and values on a line or a parabola come back as that.
#[derive(Debug)]
pub struct Curve<T> {
    at: Arc<[f64]>,
    /// Polynomials in the distance from the knot at which each piece begins.
    pieces: Vec<[T; 4]>,
    last: T,
    /// The least and the greatest slope of each piece.
    slopes: Vec<[f64; 2]>,
}

impl<T: Real> Curve<T> {
    /// Through `values` at the increasing knots `at`.
    ///
    /// # Errors
    /// [`BadLaw`] where there are no two knots, not as many values, or knots that do not increase.
    pub fn new(at: Arc<[f64]>, values: &[T]) -> Result<Self, BadLaw> {
        if at.len() != values.len() {
            return Err(BadLaw::Lengths { x: at.len(), y: values.len() });
        }
        let Some(&last) = values.last().filter(|_| at.len() > 1) else {
            return Err(BadLaw::TooFew { found: at.len() });
        };
        if let Some(index) = at.iter().position(|x| !x.is_finite()) {
            return Err(BadLaw::NotFinite { column: "x", index, value: at[index] });
        }
        if let Some(index) = values.iter().position(|y| !y.re().is_finite()) {
            return Err(BadLaw::NotFinite { column: "y", index, value: values[index].re() });
        }
        if let Some(k) = at.windows(2).position(|pair| !(pair[1] > pair[0])) {
            return Err(BadLaw::NotIncreasing { index: k + 1, before: at[k], after: at[k + 1] });
        }
        let slopes = three_point_slopes(&at, values);
        let pieces: Vec<[T; 4]> = (0..at.len() - 1)
            .map(|k| {
                let h = at[k + 1] - at[k];
                let rise = (values[k + 1] - values[k]) / h;
                let bend = (rise * 3.0 - slopes[k] * 2.0 - slopes[k + 1]) / h;
                let twist = (slopes[k] + slopes[k + 1] - rise * 2.0) / (h * h);
                [values[k], slopes[k], bend, twist]
            })
            .collect();
        let slopes = at.windows(2).zip(&pieces).map(|(pair, piece)| slopes_of(piece, pair[1] - pair[0])).collect();
        Ok(Self { at, pieces, last, slopes })
    }

    /// Its value.
    #[inline]
    pub fn value(&self, x: T) -> T {
        match self.place(x.re()) {
            Place::Before => self.pieces[0][0],
            Place::Behind => self.last,
            Place::On(k) => {
                let [c0, c1, c2, c3] = self.pieces[k];
                let d = x - self.at[k];
                c0 + d * (c1 + d * (c2 + d * c3))
            }
        }
    }

    /// Its value and its slope.
    #[inline]
    pub fn value_and_slope(&self, x: T) -> [T; 2] {
        let slope = match self.place(x.re()) {
            Place::On(k) => {
                let [_, c1, c2, c3] = self.pieces[k];
                let d = x - self.at[k];
                c1 + d * (c2 * 2.0 + d * c3 * 3.0)
            }
            Place::Before | Place::Behind => T::nought(),
        };
        [self.value(x), slope]
    }

    /// A bound on the size of its slope between two places.
    pub fn steepest(&self, from: f64, to: f64) -> f64 {
        let pieces = self.at.windows(2).zip(&self.slopes);
        let there = pieces.filter(|(ends, _)| ends[0] <= to && ends[1] >= from);
        there.map(|(_, [least, greatest])| least.abs().max(greatest.abs())).fold(0.0, f64::max)
    }

    /// The largest size of its values at the knots.
    pub fn largest(&self) -> f64 {
        let first = self.pieces.iter().map(|piece| piece[0].re().abs());
        first.fold(self.last.re().abs(), f64::max)
    }

    /// Its least slope, between its ends.
    pub fn least_slope(&self) -> f64 {
        self.slopes.iter().map(|[least, _]| *least).fold(f64::INFINITY, f64::min)
    }

    /// The same curve for another kind of number, without derivatives.
    pub fn held<U: Real>(&self) -> Curve<U> {
        Curve {
            at: self.at.clone(),
            pieces: self.pieces.iter().map(|piece| piece.map(|c| U::constant(c.re()))).collect(),
            last: U::constant(self.last.re()),
            slopes: self.slopes.clone(),
        }
    }

    /// The least distance between two knots.
    pub fn finest(&self) -> f64 {
        self.at.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min)
    }

    #[inline]
    fn place(&self, x: f64) -> Place {
        match self.at.partition_point(|knot| *knot <= x) {
            0 => Place::Before,
            k if k == self.at.len() => Place::Behind,
            k => Place::On(k - 1),
        }
    }
}

/// Where a place lies along the knots.
enum Place {
    Before,
    On(usize),
    Behind,
}

/// The slope at each knot of the parabola through it and its neighbours; at an end, of that through the first three.
fn three_point_slopes<T: Real>(at: &[f64], values: &[T]) -> Vec<T> {
    let n = at.len();
    let width = |k: usize| at[k + 1] - at[k];
    let rise = |k: usize| (values[k + 1] - values[k]) / width(k);
    // `near` is the piece at the knot, `far` the one behind it.
    let at_end = |near: usize, far: usize| {
        let (h, g) = (width(near), width(far));
        (rise(near) * (2.0 * h + g) - rise(far) * h) / (h + g)
    };
    (0..n)
        .map(|k| match k {
            _ if n == 2 => rise(0),
            0 => at_end(0, 1),
            k if k == n - 1 => at_end(n - 2, n - 3),
            k => (rise(k - 1) * width(k) + rise(k) * width(k - 1)) / (width(k - 1) + width(k)),
        })
        .collect()
}

/// The least and the greatest slope of a cubic over a width.
fn slopes_of<T: Real>(piece: &[T; 4], width: f64) -> [f64; 2] {
    let [_, c1, c2, c3] = piece.map(|c| c.re());
    let slope = |d: f64| c1 + d * (2.0 * c2 + d * 3.0 * c3);
    let turn = -c2 / (3.0 * c3);
    let inside = if turn > 0.0 && turn < width { slope(turn) } else { slope(0.0) };
    let [first, last] = [slope(0.0), slope(width)];
    [first.min(last).min(inside), first.max(last).max(inside)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::Dual;
    use approx::assert_relative_eq;

    fn curve(at: &[f64], f: impl Fn(f64) -> f64) -> Curve<f64> {
        Curve::new(at.into(), &at.iter().map(|x| f(*x)).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn lines_and_parabolas_come_back_whatever_the_knots_and_the_ends_hold() {
        let knots = [-1.0, -0.7, 0.1, 0.15, 0.9];
        let [line, parabola] = [|x: f64| 0.3 - 2.0 * x, |x: f64| 1.0 + x - 3.0 * x * x];
        for k in 0..=60 {
            let x = -1.0 + 1.9 * f64::from(k) / 60.0;
            assert_relative_eq!(curve(&knots, line).value(x), line(x), epsilon = 1e-14);
            assert_relative_eq!(curve(&knots, parabola).value(x), parabola(x), epsilon = 1e-14);
        }
        let c = curve(&knots, line);
        assert_eq!([c.value(-5.0), c.value(5.0)], [2.3, 0.3 - 1.8]);
        assert_eq!(c.value_and_slope(5.0)[1], 0.0);
        assert_relative_eq!(curve(&[0.0, 2.0], line).value(0.5), -0.7, epsilon = 1e-15);
    }

    #[test]
    fn curve_and_slope_are_continuous_and_the_bound_holds() {
        let knots: Vec<f64> = (0..14).map(|k| 0.3 * f64::from(k) + 0.1 * f64::from(k % 3)).collect();
        let c = curve(&knots, |x| (3.0 * x).sin());
        for x in &knots[1..13] {
            let [before, after] = [c.value_and_slope(x - 1e-9), c.value_and_slope(x + 1e-9)];
            assert_relative_eq!(before[0], after[0], epsilon = 1e-7);
            assert_relative_eq!(before[1], after[1], epsilon = 1e-6);
        }
        let within = |x: f64| knots[0] < x && x < knots[13];
        for k in 0..400 {
            let x = f64::from(k) * 0.01;
            let h = 1e-6;
            let slope = (c.value(x + h) - c.value(x - h)) / (2.0 * h);
            if within(x - h) && within(x + h) {
                assert_relative_eq!(slope, c.value_and_slope(x)[1], epsilon = 1e-5);
                assert!(slope.abs() <= c.steepest(x, x) + 1e-5, "{x}");
            }
        }
        assert_relative_eq!(c.finest(), 0.1, epsilon = 1e-12);
        assert!(c.steepest(100.0, 200.0) == 0.0);
    }

    #[test]
    fn derivatives_are_those_by_values_and_by_the_variable() {
        let at: Arc<[f64]> = [0.0, 0.4, 1.0, 1.3].into();
        let values = [0.2, -0.1, 0.5, 0.3];
        for x in [-0.2, 0.1, 0.4, 0.77, 1.2, 1.6] {
            let seeded: Vec<_> = values.iter().enumerate().map(|(k, v)| Dual::<5>::variable(*v, k)).collect();
            let slopes = Curve::new(at.clone(), &seeded).unwrap().value(Dual::variable(x, 4)).eps;
            let by = |x: f64, values: &[f64]| Curve::new(at.clone(), values).unwrap().value(x);
            let h = 1e-6;
            for (k, exact) in slopes[..4].iter().enumerate() {
                let moved =
                    |h: f64| by(x, &std::array::from_fn::<_, 4, _>(|i| values[i] + if i == k { h } else { 0.0 }));
                assert_relative_eq!(*exact, (moved(h) - moved(-h)) / (2.0 * h), epsilon = 1e-8);
            }
            assert_relative_eq!(slopes[4], (by(x + h, &values) - by(x - h, &values)) / (2.0 * h), epsilon = 1e-5);
        }
    }

    #[test]
    fn bad_knots_and_values_are_named() {
        let bad = |at: &[f64], values: &[f64]| Curve::new(at.into(), values).unwrap_err().to_string();
        assert!(bad(&[0.0, 1.0], &[0.0]).contains("2 values in x and 1 in y"));
        assert!(bad(&[0.0], &[0.0]).contains("1 knot"));
        assert!(bad(&[0.0, 1.0, 1.0], &[0.0; 3]).contains("x[2] = 1 does not follow x[1] = 1"));
        assert!(bad(&[0.0, f64::NAN], &[0.0; 2]).contains("x[1] = NaN"));
        assert!(bad(&[0.0, 1.0], &[f64::INFINITY, 0.0]).contains("y[0] = inf"));
    }
}
