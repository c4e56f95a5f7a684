//! Coefficients of the formulas by order, as Hindmarsh's `cfode` makes them.

use super::Family;

/// By order: how much of a correction goes to each of the `z_j`, and what tests its error.
#[derive(Clone, Debug)]
pub(super) struct Coefficients {
    corrector: Vec<Vec<f64>>,
    test: Vec<[f64; 3]>,
}

impl Coefficients {
    pub(super) fn of(family: Family) -> Self {
        match family {
            Family::Adams => adams(family.highest()),
            Family::Bdf => backward(family.highest()),
        }
    }

    /// `l_j` of an order.
    pub(super) fn corrector(&self, order: usize, j: usize) -> f64 {
        self.corrector[order][j]
    }

    /// Divides a size to give the error one order below (0), at the order (1), one above (2).
    pub(super) fn test(&self, order: usize, which: usize) -> f64 {
        self.test[order][which]
    }
}

/// Multiplies a polynomial by `(x + root)`, lowest power first; it has room for one more.
fn times(polynomial: &mut [f64], root: f64) {
    for i in (1..polynomial.len()).rev() {
        polynomial[i] = polynomial[i - 1] + root * polynomial[i];
    }
    polynomial[0] *= root;
}

fn adams(highest: usize) -> Coefficients {
    let mut corrector = vec![Vec::new(), vec![1.0, 1.0]];
    let mut test = vec![[0.0; 3]; highest + 2];
    (test[1][0], test[1][1], test[2][0]) = (0.0, 2.0, 1.0);
    let mut polynomial = vec![1.0];
    let mut factorial = 1.0;
    for order in 2..=highest {
        let previous = factorial;
        factorial /= order as f64;
        polynomial.push(0.0);
        times(&mut polynomial, (order - 1) as f64);
        let (mut integral, mut moment, mut sign) = (0.0, 0.0, 1.0);
        for (i, p) in polynomial.iter().enumerate() {
            integral += sign * p / (i + 1) as f64;
            moment += sign * p / (i + 2) as f64;
            sign = -sign;
        }
        let mut row = vec![integral * previous, 1.0];
        row.extend(polynomial.iter().enumerate().skip(1).map(|(i, p)| previous * p / (i + 1) as f64));
        corrector.push(row);
        let size = 1.0 / (factorial * moment);
        test[order][1] = size;
        test[order + 1][0] = size * factorial / (order + 1) as f64;
        test[order - 1][2] = size;
    }
    Coefficients { corrector, test }
}

fn backward(highest: usize) -> Coefficients {
    let mut corrector = vec![Vec::new()];
    let mut test = vec![[0.0; 3]];
    let mut polynomial = vec![1.0];
    let mut factorial = 1.0;
    for order in 1..=highest {
        let n = order as f64;
        polynomial.push(0.0);
        times(&mut polynomial, n);
        let row: Vec<f64> = polynomial.iter().map(|p| p / polynomial[1]).collect();
        test.push([factorial, (n + 1.0) / row[0], (n + 2.0) / row[0]]);
        corrector.push(row);
        factorial /= n;
    }
    Coefficients { corrector, test }
}
