//! Residuals, weighed by what the sensor and numbers that are never quite right make of them.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::Range;

/// A cause moves its joints by so much of a noise variance per sample at least. Two honest simulations of one robot, one of
/// them with friction made smooth, differ by less; with many joints the mere gain would show it.
pub(super) const MATERIAL: f64 = 0.05;

/// The covariance `C = D + U U'` of what is left where nothing is the matter: each sample's own variance, and what is
/// uncertain everywhere, to first order.
pub(super) struct Noise {
    /// `1 / variance`; 0 where a sample does not count.
    pub weight: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// By column, blocks of samples that count in which it is not 0: most numbers change one limb only.
    blocks: Vec<Vec<usize>>,
    inner: Cholesky<f64, Dyn>,
}

/// Samples of a block.
const BLOCK: usize = 64;

/// Sums over a change that is 0 but for pieces: along a residual, of its squares, along the columns of `U`.
#[derive(Clone)]
pub(super) struct Pieces {
    along: f64,
    squares: f64,
    columns: DVector<f64>,
}

impl Pieces {
    /// Its weighed sum of squares, with what uncertain numbers could take out of it.
    pub fn squares(&self) -> f64 {
        self.squares
    }

    /// Adds twice the product of two changes of the same samples, of which each was added.
    pub fn add_shared(&mut self, twice: f64) {
        self.squares += twice;
    }
}

impl std::ops::AddAssign for Pieces {
    /// Of changes of different samples; see [`Pieces::add_shared`].
    fn add_assign(&mut self, other: Self) {
        self.along += other.along;
        self.squares += other.squares;
        self.columns += other.columns;
    }
}

/// A vector over all samples, with what [`Noise::dot`] needs of it.
pub(super) struct Weighed {
    pub column: Vec<f64>,
    /// `U' D^-1 a`, solved by the lower factor of the inner matrix.
    low: DVector<f64>,
}

impl Noise {
    /// Of each sample's weight and the columns of `U`; `None` where their products are not finite.
    pub fn new(weight: Vec<f64>, columns: Vec<Vec<f64>>) -> Option<Self> {
        let n = columns.len();
        let blocks: Vec<Vec<usize>> = columns.iter().map(|column| blocks(&weight, column)).collect();
        let mut inner = DMatrix::identity(n, n);
        for a in 0..n {
            for b in 0..=a {
                let both = blocks[a].iter().filter(|block| blocks[b].binary_search(block).is_ok());
                let dot = weighted_in(both, &weight, &columns[a], &columns[b]);
                inner[(a, b)] += dot;
                if a != b {
                    inner[(b, a)] += dot;
                }
            }
        }
        Some(Self { weight, columns, blocks, inner: root(inner)? })
    }

    /// The same where fewer samples count.
    pub fn only(&self, counts: impl Fn(usize) -> bool) -> Self {
        let weight = self.weight.iter().enumerate().map(|(k, w)| if counts(k) { *w } else { 0.0 }).collect();
        Self::new(weight, self.columns.clone()).expect("fewer samples of finite columns are finite")
    }

    /// The same where uncertain numbers vary so many times less.
    pub fn stiffer(&self, times: f64) -> Self {
        let share = times.sqrt().recip();
        let columns = self.columns.iter().map(|column| column.iter().map(|change| share * change).collect());
        Self::new(self.weight.clone(), columns.collect()).expect("smaller columns that are finite are finite")
    }

    /// How many times its variance is left per sample that counts, at least once.
    pub fn temper(&self, left: &[f64]) -> f64 {
        self.temper_of(left, 0..left.len())
    }

    /// The same over some samples.
    pub fn temper_of(&self, left: &[f64], samples: impl Iterator<Item = usize>) -> f64 {
        let counted = samples.map(|k| (self.weight[k], left[k])).filter(|(weight, _)| *weight > 0.0);
        let sum = |(squares, count), (weight, left): (f64, f64)| (squares + weight * left.powi(2), count + 1.0);
        let (squares, count) = counted.fold((0.0, 0.0), sum);
        f64::max(squares / f64::max(count, 1.0), 1.0)
    }

    /// What is uncertain everywhere, per standard deviation.
    pub fn columns(&self) -> &[Vec<f64>] {
        &self.columns
    }

    fn along(&self, column: &[f64]) -> DVector<f64> {
        let of = |(u, blocks): (&Vec<f64>, &Vec<usize>)| weighted_in(blocks.iter(), &self.weight, u, column);
        DVector::from_iterator(self.columns.len(), self.columns.iter().zip(&self.blocks).map(of))
    }

    pub fn weigh(&self, column: Vec<f64>) -> Weighed {
        let along = self.along(&column);
        let low =
            self.inner.l_dirty().solve_lower_triangular(&along).expect("no zero on the diagonal of a Cholesky factor");
        Weighed { column, low }
    }

    /// `a' C^-1 b`
    pub fn dot(&self, a: &Weighed, b: &Weighed) -> f64 {
        weighted(&self.weight, &a.column, &b.column) - a.low.dot(&b.low)
    }

    /// A change of no sample.
    pub fn nothing(&self) -> Pieces {
        Pieces { along: 0.0, squares: 0.0, columns: DVector::zeros(self.columns.len()) }
    }

    /// Columns that are not 0 in all of some samples.
    pub fn columns_of(&self, samples: Range<usize>) -> Vec<usize> {
        let is_there = |k: &usize| self.columns[*k][samples.clone()].iter().any(|change| *change != 0.0);
        (0..self.columns.len()).filter(is_there).collect()
    }

    /// Adds a piece of a change, the samples from one on in which these columns are not 0, to what was summed of it.
    pub fn add(&self, sums: &mut Pieces, residual: &Weighed, (from, columns): (usize, &[usize]), piece: &[f64]) {
        let range = from..from + piece.len();
        let weight = &self.weight[range.clone()];
        sums.along += weighted(weight, &residual.column[range.clone()], piece);
        sums.squares += weighted(weight, piece, piece);
        for k in columns {
            sums.columns[*k] += weighted(weight, &self.columns[*k][range.clone()], piece);
        }
    }

    /// `a' D^-1 b` of two changes of the samples from one on.
    pub fn product(&self, from: usize, a: &[f64], b: &[f64]) -> f64 {
        weighted(&self.weight[from..from + a.len()], a, b)
    }

    /// `r' C^-1 c` and `c' C^-1 c` of a residual and a change.
    pub fn along_and_size(&self, change: &Pieces, residual: &Weighed) -> (f64, f64) {
        let low = self.inner.l_dirty().solve_lower_triangular(&change.columns);
        let low = low.expect("no zero on the diagonal of a Cholesky factor");
        (change.along - residual.low.dot(&low), change.squares - low.norm_squared())
    }

    /// How much less a change leaves of a residual: `r' C^-1 r - (r - c)' C^-1 (r - c)`.
    pub fn gain(&self, change: &Pieces, residual: &Weighed) -> f64 {
        let (along, size) = self.along_and_size(change, residual);
        2.0 * along - size
    }

    /// Samples that count.
    pub fn count(&self) -> usize {
        self.weight.iter().filter(|w| **w > 0.0).count()
    }

    /// How far the uncertain numbers are off, in their standard deviations, as the samples that count tell.
    pub fn sizes(&self, residual: &[f64]) -> Vec<f64> {
        self.inner.solve(&self.along(residual)).iter().copied().collect()
    }

    /// Standard deviation of such a number where the samples that count tell of it; 1 where they do not.
    pub fn spread(&self, number: usize) -> f64 {
        self.covariance(number..number + 1)[(0, 0)].max(0.0).sqrt()
    }

    /// Covariance of some such numbers, in their variances, where the samples that count tell of them.
    pub fn covariance(&self, numbers: Range<usize>) -> DMatrix<f64> {
        let units = DMatrix::from_fn(self.columns.len(), numbers.len(), |row, k| f64::from(row == numbers.start + k));
        self.inner.solve(&units).rows(numbers.start, numbers.len()).into_owned()
    }

    /// A residual less what numbers make of it that are so far off, to first order.
    pub fn less(&self, mut residual: Vec<f64>, sizes: &[f64]) -> Vec<f64> {
        for (u, size) in self.columns.iter().zip(sizes) {
            for (left, u) in residual.iter_mut().zip(u) {
                *left -= size * u;
            }
        }
        residual
    }

    /// A residual less what the uncertain numbers make of it, as the samples that count tell.
    pub fn adapted(&self, residual: &[f64]) -> Vec<f64> {
        self.less(residual.to_vec(), &self.sizes(residual))
    }
}

/// The Cholesky factor of `I + U' D^-1 U`, whose eigenvalues are 1 or more.
///
/// Where columns are so large and so alike that rounding swallows the 1, the diagonal grows by as much as rounding may
/// have taken. `None` where the matrix is not finite.
fn root(mut inner: DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    if inner.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let mut ridge = f64::EPSILON * inner.nrows() as f64 * inner.diagonal().max().max(1.0);
    loop {
        if let Some(root) = Cholesky::new(inner.clone()) {
            return Some(root);
        }
        for k in 0..inner.nrows() {
            inner[(k, k)] += ridge;
        }
        ridge *= 10.0;
        if !ridge.is_finite() {
            return None;
        }
    }
}

/// Blocks with a sample that counts in which a column is not 0.
fn blocks(weight: &[f64], column: &[f64]) -> Vec<usize> {
    let pairs = weight.chunks(BLOCK).zip(column.chunks(BLOCK)).enumerate();
    let is_there =
        |(weight, column): (&[f64], &[f64])| weight.iter().zip(column).any(|(w, change)| *w * *change != 0.0);
    pairs.filter(|(_, pair)| is_there(*pair)).map(|(block, _)| block).collect()
}

/// [`weighted`] over some blocks.
fn weighted_in<'b>(blocks: impl Iterator<Item = &'b usize>, weight: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let of = |block: &usize| {
        let range = block * BLOCK..((block + 1) * BLOCK).min(weight.len());
        weighted(&weight[range.clone()], &a[range.clone()], &b[range])
    };
    blocks.map(of).sum()
}

/// Several sums at a time: one alone waits for each of its additions.
fn weighted(weight: &[f64], a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (w8, a8, b8) = (weight.chunks_exact(LANES), a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = w8.remainder().iter().zip(a8.remainder()).zip(b8.remainder());
    let rest: f64 = rest.map(|((w, a), b)| w * a * b).sum();
    for ((w, a), b) in w8.zip(a8).zip(b8) {
        for k in 0..LANES {
            sums[k] += w[k] * a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_metric_is_the_inverse_of_the_covariance() {
        let (weight, u) = (vec![4.0, 1.0, 0.25], vec![vec![1.0, 0.5, -0.5], vec![0.0, 2.0, 1.0]]);
        let mut covariance = DMatrix::from_diagonal(&DVector::from_iterator(3, weight.iter().map(|w| 1.0 / w)));
        for column in &u {
            let column = DVector::from_column_slice(column);
            covariance += &column * column.transpose();
        }
        let inverse = covariance.try_inverse().unwrap();
        let noise = Noise::new(weight, u).unwrap();
        let (a, b) = (vec![1.0, -2.0, 0.3], vec![0.2, 0.1, 4.0]);
        let expected = (DVector::from_column_slice(&a).transpose() * inverse * DVector::from_column_slice(&b))[0];
        assert_relative_eq!(noise.dot(&noise.weigh(a), &noise.weigh(b)), expected, max_relative = 1e-12);
    }

    #[test]
    fn a_change_in_pieces_gains_what_the_whole_does() {
        let noise = Noise::new(vec![4.0, 1.0, 0.25], vec![vec![1.0, 0.5, -0.5], vec![0.0, 2.0, 1.0]]).unwrap();
        let (residual, change) = ([1.0, -2.0, 0.3], [0.2, -1.0, 0.1]);
        let whole = noise.weigh(residual.to_vec());
        let (mut sums, mut more) = (noise.nothing(), noise.nothing());
        noise.add(&mut sums, &whole, (0, &noise.columns_of(0..1)), &change[..1]);
        noise.add(&mut more, &whole, (1, &noise.columns_of(1..3)), &change[1..]);
        sums += more;
        let left = noise.weigh(residual.iter().zip(&change).map(|(r, c)| r - c).collect());
        let expected = noise.dot(&whole, &whole) - noise.dot(&left, &left);
        assert_relative_eq!(noise.gain(&sums, &whole), expected, max_relative = 1e-12);
    }

    #[test]
    fn what_is_uncertain_is_taken_out_as_far_as_the_samples_that_count_tell() {
        let noise = Noise::new(vec![1e6, 1e6, 0.0], vec![vec![1.0, 1.0, 1.0]]).unwrap();
        let left = noise.adapted(&[0.5, 0.5, 0.7]);
        assert!(left[0].abs() < 1e-5 && (left[2] - 0.2).abs() < 1e-5, "{left:?}");
    }

    #[test]
    fn columns_that_are_huge_and_alike_are_still_taken_out() {
        let column = vec![1e9, 1e9, -1e9];
        let noise = Noise::new(vec![1e6; 3], vec![column.clone(), column.clone(), column]).unwrap();
        let residual = noise.weigh(vec![0.5, 0.5, -0.5]);
        // 1e6 (3 0.5^2) without the columns.
        assert!(noise.dot(&residual, &residual).abs() < 1.0, "{}", noise.dot(&residual, &residual));
        assert!(noise.adapted(&[0.5, 0.5, -0.5]).iter().all(|left| left.abs() < 1e-6));
    }

    #[test]
    fn columns_that_are_not_finite_are_no_noise() {
        assert!(Noise::new(vec![1.0], vec![vec![f64::NAN]]).is_none());
        assert!(Noise::new(vec![1.0], vec![vec![1e200]]).is_none());
    }
}
