//! Vectors, rotations about a coordinate axis, and articulated-body inertias, of several bodies side by side.
//!
//! A spatial inertia is three 3x3 blocks (Featherstone 2008, eq. 2.63): `[n; f] = [A B; B^T C] [omega; v]`, A and C
//! symmetric. `K` is the axis of a rotation; (K, I, J) is right-handed.

use super::{Number, Pair};

/// Three components of several vectors.
pub(in crate::robot) type Vec3<N = Pair> = [N; 3];

/// Three of something; always in place, where an array's `map` may become a call.
#[inline(always)]
pub(in crate::robot) fn three<T>(of: impl Fn(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

/// Six of something.
#[inline(always)]
pub(in crate::robot) fn six<T>(of: impl Fn(usize) -> T) -> [T; 6] {
    [of(0), of(1), of(2), of(3), of(4), of(5)]
}

/// Sine and cosine of turns about axis `K`.
#[derive(Clone, Copy)]
pub(in crate::robot) struct Turn<N = Pair> {
    /// Sines.
    pub sin: N,
    /// Cosines.
    pub cos: N,
}

impl<N: Number> Turn<N> {
    /// A vector of the parent in the child's axes.
    #[inline(always)]
    pub fn into_child<const K: usize>(self, v: Vec3<N>) -> Vec3<N> {
        let (i, j) = ((K + 1) % 3, (K + 2) % 3);
        let mut out = v;
        out[i] = self.cos * v[i] + self.sin * v[j];
        out[j] = self.cos * v[j] - self.sin * v[i];
        out
    }

    /// A vector of the child in the parent's axes.
    #[inline(always)]
    pub fn into_parent<const K: usize>(self, v: Vec3<N>) -> Vec3<N> {
        let (i, j) = ((K + 1) % 3, (K + 2) % 3);
        let mut out = v;
        out[i] = self.cos * v[i] - self.sin * v[j];
        out[j] = self.cos * v[j] + self.sin * v[i];
        out
    }
}

/// `a x b`.
#[inline(always)]
pub(in crate::robot) fn cross<N: Number>(a: Vec3<N>, b: Vec3<N>) -> Vec3<N> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + b`.
#[inline(always)]
pub(in crate::robot) fn add<N: Number>(a: Vec3<N>, b: Vec3<N>) -> Vec3<N> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`.
#[inline(always)]
pub(in crate::robot) fn sub<N: Number>(a: Vec3<N>, b: Vec3<N>) -> Vec3<N> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `R v`, R by rows.
#[inline(always)]
pub(in crate::robot) fn rotate<N: Number>(r: &[Vec3<N>; 3], v: Vec3<N>) -> Vec3<N> {
    [0, 1, 2].map(|i| r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2])
}

/// `R^T v`, R by rows.
#[inline(always)]
pub(in crate::robot) fn rotate_back<N: Number>(r: &[Vec3<N>; 3], v: Vec3<N>) -> Vec3<N> {
    [0, 1, 2].map(|i| r[0][i] * v[0] + r[1][i] * v[1] + r[2][i] * v[2])
}

/// Spatial inertias of several bodies.
#[derive(Clone, Copy, Debug)]
pub(in crate::robot) struct Articulated<N = Pair> {
    /// A: xx, yy, zz, yz, zx, xy.
    pub a: [N; 6],
    /// B by rows.
    pub b: [Vec3<N>; 3],
    /// C, as A.
    pub c: [N; 6],
}

/// Place of entry (i, j) of a symmetric block.
#[inline(always)]
pub(in crate::robot) const fn at(i: usize, j: usize) -> usize {
    if i == j { i } else { 6 - i - j }
}

impl<N: Number> Articulated<N> {
    /// Nothing.
    pub fn zero() -> Self {
        Self { a: [N::zero(); 6], b: [[N::zero(); 3]; 3], c: [N::zero(); 6] }
    }

    /// The column of a joint axis: `I S` with `S = [e_K; 0]`, as moment and force.
    #[inline(always)]
    pub fn column<const K: usize>(&self) -> (Vec3<N>, Vec3<N>) {
        ([0, 1, 2].map(|i| self.a[at(i, K)]), self.b[K])
    }

    /// `I - u w^T` with `w` parallel to `u`, so that the result is symmetric.
    #[inline(always)]
    pub fn minus_outer(&self, u: (Vec3<N>, Vec3<N>), w: (Vec3<N>, Vec3<N>)) -> Self {
        let mut out = *self;
        for i in 0..3 {
            for j in i..3 {
                out.a[at(i, j)] = self.a[at(i, j)] - u.0[i] * w.0[j];
                out.c[at(i, j)] = self.c[at(i, j)] - u.1[i] * w.1[j];
            }
            for j in 0..3 {
                out.b[i][j] = self.b[i][j] - u.0[i] * w.1[j];
            }
        }
        out
    }

    /// The inertia times a motion without components along axis `K`: moment and force.
    #[inline(always)]
    pub fn times_across<const K: usize>(&self, m: (Vec3<N>, Vec3<N>)) -> (Vec3<N>, Vec3<N>) {
        let (i, j) = ((K + 1) % 3, (K + 2) % 3);
        let row = |r: usize| {
            let n =
                self.a[at(r, i)] * m.0[i] + self.a[at(r, j)] * m.0[j] + self.b[r][i] * m.1[i] + self.b[r][j] * m.1[j];
            let f =
                self.b[i][r] * m.0[i] + self.b[j][r] * m.0[j] + self.c[at(r, i)] * m.1[i] + self.c[at(r, j)] * m.1[j];
            (n, f)
        };
        let rows = [row(0), row(1), row(2)];
        (rows.map(|row| row.0), rows.map(|row| row.1))
    }

    /// From the child's axes into the parent's, for a turn about axis `K`.
    #[inline(always)]
    pub fn seen_from_parent<const K: usize>(&self, turn: &Turn<N>) -> Self {
        let (cc, ss, sc) = (turn.cos * turn.cos, turn.sin * turn.sin, turn.sin * turn.cos);
        Self {
            a: turned_symmetric::<N, K>(&self.a, turn, cc, ss, sc),
            b: turned::<N, K>(&self.b, turn),
            c: turned_symmetric::<N, K>(&self.c, turn, cc, ss, sc),
        }
    }

    /// From the axes that a fixed rotation leads to (R by rows, into the outer axes) into the outer ones.
    #[inline(always)]
    pub fn rotated(&self, r: &[Vec3<N>; 3]) -> Self {
        let full = |s: &[N; 6]| [0, 1, 2].map(|i| [0, 1, 2].map(|j| s[at(i, j)]));
        let packed = |m: [Vec3<N>; 3]| [m[0][0], m[1][1], m[2][2], m[1][2], m[2][0], m[0][1]];
        // R M R^T: R times the columns' transposes, twice.
        let both = |m: [Vec3<N>; 3]| {
            let half = m.map(|row| rotate(r, row));
            let columns = [0, 1, 2].map(|j| rotate(r, [half[0][j], half[1][j], half[2][j]]));
            [0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i]])
        };
        Self { a: packed(both(full(&self.a))), b: both(self.b), c: packed(both(full(&self.c))) }
    }

    /// About another point: `r` leads from there to the point the inertia is about.
    ///
    /// `B' = B + r x C`, `A' = A - B r x + r x B'^T`.
    #[inline(always)]
    pub fn shifted(&self, r: Vec3<N>) -> Self {
        let c = |i: usize, j: usize| self.c[at(i, j)];
        let column = |j: usize| cross(r, [c(0, j), c(1, j), c(2, j)]);
        let (c0, c1, c2) = (column(0), column(1), column(2));
        let b: [Vec3<N>; 3] = [0, 1, 2].map(|i| [self.b[i][0] + c0[i], self.b[i][1] + c1[i], self.b[i][2] + c2[i]]);
        // (B r x) by rows: row x r; (r x B'^T) by columns: r x row of B'.
        let old: [Vec3<N>; 3] = self.b.map(|row| cross(row, r));
        let new: [Vec3<N>; 3] = b.map(|row| cross(r, row));
        let mut a = self.a;
        for i in 0..3 {
            for j in i..3 {
                a[at(i, j)] = self.a[at(i, j)] - old[i][j] + new[j][i];
            }
        }
        Self { a, b, c: self.c }
    }

    /// Replaces every entry by a function of it and the other's.
    #[inline(always)]
    pub fn zip(&mut self, other: &Self, f: impl Fn(N, N) -> N) {
        for k in 0..6 {
            self.a[k] = f(self.a[k], other.a[k]);
            self.c[k] = f(self.c[k], other.c[k]);
        }
        for i in 0..3 {
            for j in 0..3 {
                self.b[i][j] = f(self.b[i][j], other.b[i][j]);
            }
        }
    }
}

/// `R S R^T` of a symmetric block.
#[inline(always)]
fn turned_symmetric<N: Number, const K: usize>(s: &[N; 6], turn: &Turn<N>, cc: N, ss: N, sc: N) -> [N; 6] {
    let (i, j) = ((K + 1) % 3, (K + 2) % 3);
    let (ii, jj, ij) = (s[i], s[j], s[at(i, j)]);
    let mut out = *s;
    let twice = sc * (ij + ij);
    out[i] = cc * ii + ss * jj - twice;
    out[j] = ss * ii + cc * jj + twice;
    out[at(i, j)] = sc * (ii - jj) + (cc - ss) * ij;
    out[at(K, i)] = turn.cos * s[at(K, i)] - turn.sin * s[at(K, j)];
    out[at(K, j)] = turn.sin * s[at(K, i)] + turn.cos * s[at(K, j)];
    out
}

/// `R B R^T` of the general block.
#[inline(always)]
fn turned<N: Number, const K: usize>(b: &[Vec3<N>; 3], turn: &Turn<N>) -> [Vec3<N>; 3] {
    let (i, j) = ((K + 1) % 3, (K + 2) % 3);
    // Rows, then columns.
    let rows = b.map(|row| turn.into_parent::<K>(row));
    let mut out = rows;
    for k in 0..3 {
        out[i][k] = turn.cos * rows[i][k] - turn.sin * rows[j][k];
        out[j][k] = turn.sin * rows[i][k] + turn.cos * rows[j][k];
    }
    out
}
