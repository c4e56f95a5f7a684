//! `M = L D L^T` without square roots, so that a tensor that no body has (they are in use) may make M indefinite.

use crate::number::math;
use nalgebra::DMatrix;

/// Share of a diagonal entry below which what is left of it is rounding: the freedom has no inertia of its own.
const ROUNDING: f64 = 1e-13;

/// The factors of a symmetric matrix; the matrix's lower triangle holds L, its diagonal D.
#[derive(Clone, Debug)]
pub(super) struct Factors(DMatrix<f64>);

impl Factors {
    /// Memory for matrices of a size.
    pub fn new(size: usize) -> Self {
        Self(DMatrix::zeros(size, size))
    }

    /// Factorises; `Err` names the first freedom that nothing resists when those before it are held.
    pub fn set(&mut self, matrix: &DMatrix<f64>) -> Result<(), usize> {
        let (n, l) = (matrix.nrows(), &mut self.0);
        l.copy_from(matrix);
        for j in 0..n {
            for k in 0..j {
                let scaled = l[(j, k)] * l[(k, k)];
                for i in j..n {
                    let product = l[(i, k)] * scaled;
                    l[(i, j)] -= product;
                }
            }
            let pivot = l[(j, j)];
            if !(pivot.abs() > ROUNDING * matrix[(j, j)].abs()) {
                return Err(j);
            }
            for i in j + 1..n {
                l[(i, j)] /= pivot;
            }
        }
        Ok(())
    }

    /// Solves `M x = b` in place.
    pub fn solve(&self, x: &mut [f64]) {
        let (n, l) = (x.len(), &self.0);
        for i in 0..n {
            for k in 0..i {
                x[i] -= l[(i, k)] * x[k];
            }
        }
        for i in 0..n {
            x[i] /= l[(i, i)];
        }
        for i in (0..n).rev() {
            for k in i + 1..n {
                x[i] -= l[(k, i)] * x[k];
            }
        }
    }

    /// Logarithm of the determinant's size.
    pub fn log_determinant(&self) -> f64 {
        self.0.diagonal().iter().map(|pivot| math::ln(pivot.abs())).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indefinite_matrices_are_solved_and_singular_ones_named() {
        let matrix = DMatrix::from_row_slice(3, 3, &[4.0, 2.0, 1.0, 2.0, -3.0, 0.5, 1.0, 0.5, 2.0]);
        let mut factors = Factors::new(3);
        factors.set(&matrix).unwrap();
        let mut x = [1.0, -2.0, 0.5];
        factors.solve(&mut x);
        let back = &matrix * nalgebra::DVector::from_row_slice(&x);
        assert!((back - nalgebra::DVector::from_row_slice(&[1.0, -2.0, 0.5])).amax() < 1e-14);
        assert!((factors.log_determinant() - matrix.determinant().abs().ln()).abs() < 1e-13);
        assert_eq!(
            factors.set(&DMatrix::from_row_slice(3, 3, &[1.0, 0.1, 0.3, 0.1, 0.01, 0.03, 0.3, 0.03, 1.0])),
            Err(1)
        );
        assert_eq!(factors.set(&DMatrix::zeros(3, 3)), Err(0));
    }
}
