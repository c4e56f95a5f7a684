//! A small dense linear system, solved in place.

/// `L U` factors with rows exchanged, row by row.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    n: usize,
    /// Row by row.
    pub entries: Vec<f64>,
    rows: Vec<usize>,
    scratch: Vec<f64>,
}

impl Factors {
    pub(super) fn new(n: usize) -> Self {
        Self { n, entries: vec![0.0; n * n], rows: (0..n).collect(), scratch: vec![0.0; n] }
    }

    /// Factors the entries; false where the matrix is singular.
    pub(super) fn factor(&mut self) -> bool {
        let n = self.n;
        for (i, row) in self.rows.iter_mut().enumerate() {
            *row = i;
        }
        for k in 0..n {
            let pivot = (k..n)
                .max_by(|a, b| self.entries[a * n + k].abs().total_cmp(&self.entries[b * n + k].abs()))
                .unwrap_or(k);
            if !(self.entries[pivot * n + k].abs() > 0.0) {
                return false;
            }
            if pivot != k {
                self.rows.swap(k, pivot);
                let (above, below) = self.entries.split_at_mut(pivot * n);
                above[k * n..k * n + n].swap_with_slice(&mut below[..n]);
            }
            let (above, below) = self.entries.split_at_mut((k + 1) * n);
            let pivot_row = &above[k * n..];
            let inverse = 1.0 / pivot_row[k];
            for row in below.chunks_exact_mut(n) {
                let factor = row[k] * inverse;
                row[k] = factor;
                if factor != 0.0 {
                    for (entry, other) in row[k + 1..].iter_mut().zip(&pivot_row[k + 1..n]) {
                        *entry -= factor * other;
                    }
                }
            }
        }
        true
    }

    /// Solves for a right-hand side, in place.
    pub(super) fn solve(&mut self, x: &mut [f64]) {
        let n = self.n;
        for (to, from) in self.scratch.iter_mut().zip(&self.rows) {
            *to = x[*from];
        }
        for i in 0..n {
            let row = &self.entries[i * n..i * n + i];
            let sum: f64 = row.iter().zip(&self.scratch).map(|(a, b)| a * b).sum();
            self.scratch[i] -= sum;
        }
        for i in (0..n).rev() {
            let row = &self.entries[i * n..(i + 1) * n];
            let sum: f64 = row[i + 1..].iter().zip(&self.scratch[i + 1..]).map(|(a, b)| a * b).sum();
            self.scratch[i] = (self.scratch[i] - sum) / row[i];
        }
        x.copy_from_slice(&self.scratch);
    }
}
