//! What a fitted hypothesis can take up by itself: residuals off all columns that it can move.
//!
//! Residuals come log by log; where something is believed of the numbers, its rows stand last.

use crate::fit::Block;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// What a trial can take up by itself, to first order.
pub(in crate::gap) struct Projector {
    /// For each log: an orthonormal basis of its start's columns, and the shared columns without their part in it.
    logs: Vec<(DMatrix<f64>, DMatrix<f64>)>,
    gram: Option<Cholesky<f64, Dyn>>,
}

impl Projector {
    pub(in crate::gap) fn of(blocks: &[Block], shared: usize) -> Self {
        let mut gram = DMatrix::zeros(shared, shared);
        let logs: Vec<_> = blocks
            .iter()
            .map(|b| {
                let (rows, width) = (b.residual.len(), b.columns.len());
                if b.columns.iter().all(|c| *c < shared) {
                    // Beliefs: rows about shared columns alone.
                    let mut columns = DMatrix::zeros(rows, shared);
                    for (row, cells) in b.jacobian.chunks_exact(width.max(1)).enumerate() {
                        for (cell, column) in cells.iter().zip(&b.columns) {
                            columns[(row, *column)] = *cell;
                        }
                    }
                    gram += columns.transpose() * &columns;
                    return (DMatrix::zeros(rows, 0), columns);
                }
                let whole = DMatrix::from_row_slice(rows, width, &b.jacobian);
                let starts = whole.columns(shared, width - shared).into_owned();
                let basis = orthonormal(starts);
                let columns = whole.columns(0, shared).into_owned();
                let columns = &columns - &basis * (basis.transpose() * &columns);
                gram += columns.transpose() * &columns;
                (basis, columns)
            })
            .collect();
        // A little of each diagonal keeps directions that the logs leave open from being used.
        for i in 0..shared {
            gram[(i, i)] += 1e-6 * gram[(i, i)] + 1e-300;
        }
        Self { logs, gram: gram.cholesky() }
    }

    /// Residuals of every log without what the trial's own columns can take up.
    pub(in crate::gap) fn project(&self, residuals: &[DVector<f64>]) -> Option<Vec<DVector<f64>>> {
        let gram = self.gram.as_ref()?;
        let mut product = DVector::zeros(gram.l_dirty().nrows());
        let mut left: Vec<DVector<f64>> = Vec::with_capacity(residuals.len());
        for (k, (basis, columns)) in self.logs.iter().enumerate() {
            // Where nothing is said of the beliefs, they stand where they are.
            let mut rest = residuals.get(k).cloned().unwrap_or_else(|| DVector::zeros(columns.nrows()));
            product.gemv_tr(1.0, columns, &rest, 1.0);
            if basis.ncols() > 0 {
                let along = basis.tr_mul(&rest);
                rest.gemv(-1.0, basis, &along, 1.0);
            }
            left.push(rest);
        }
        let taken = gram.solve(&product);
        for ((_, columns), rest) in self.logs.iter().zip(&mut left) {
            rest.gemv(-1.0, columns, &taken, 1.0);
        }
        Some(left)
    }

    /// How far the shared coordinates move to take up what they can of residuals, everything else refitted.
    pub(in crate::gap) fn taken_up(&self, residuals: &[DVector<f64>]) -> Option<DVector<f64>> {
        self.taken_up_by_each(residuals).map(|each| each.into_iter().sum())
    }

    /// The same for each log's residuals alone.
    pub(in crate::gap) fn taken_up_by_each(&self, residuals: &[DVector<f64>]) -> Option<Vec<DVector<f64>>> {
        let gram = self.gram.as_ref()?;
        Some(self.logs.iter().zip(residuals).map(|((_, columns), rest)| gram.solve(&columns.tr_mul(rest))).collect())
    }

    /// Square sum of residuals after the trial's own columns have taken up what they can.
    pub(in crate::gap) fn left(&self, residuals: &[DVector<f64>]) -> f64 {
        self.seen(residuals, 0..residuals.len()).map_or(f64::INFINITY, |seen| seen.left())
    }

    /// The share of some logs' residuals in what is left, for many trials of what others leave.
    pub(in crate::gap) fn seen(
        &self,
        residuals: &[DVector<f64>],
        logs: impl Iterator<Item = usize>,
    ) -> Option<Seen<'_>> {
        let gram = self.gram.as_ref()?;
        let mut seen = Seen { projector: self, gram, squares: 0.0, product: DVector::zeros(gram.l_dirty().nrows()) };
        for k in logs {
            seen.add(k, &residuals[k]);
        }
        Some(seen)
    }
}

/// What residuals of some logs leave and ask of the shared columns.
#[derive(Clone)]
pub(in crate::gap) struct Seen<'a> {
    projector: &'a Projector,
    gram: &'a Cholesky<f64, Dyn>,
    squares: f64,
    product: DVector<f64>,
}

impl Seen<'_> {
    /// Adds another log's residuals.
    pub(in crate::gap) fn add(&mut self, log: usize, residuals: &DVector<f64>) {
        let (basis, columns) = &self.projector.logs[log];
        self.product.gemv_tr(1.0, columns, residuals, 1.0);
        self.squares += residuals.norm_squared();
        if basis.ncols() > 0 {
            self.squares -= basis.tr_mul(residuals).norm_squared();
        }
    }

    /// Square sum of what was added after the trial's own columns have taken up what they can.
    pub(in crate::gap) fn left(&self) -> f64 {
        self.squares - self.product.dot(&self.gram.solve(&self.product))
    }
}

/// Columns made orthonormal (Gram-Schmidt); columns of nothing are left out.
fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for column in columns.column_iter() {
        let mut rest = column.into_owned();
        let size = rest.norm();
        for known in &basis {
            let along = known.dot(&rest);
            rest.axpy(-along, known, 1.0);
        }
        if rest.norm() > 1e-9 * size && size > 0.0 {
            basis.push(rest.normalize());
        }
    }
    if basis.is_empty() { DMatrix::zeros(columns.nrows(), 0) } else { DMatrix::from_columns(&basis) }
}
