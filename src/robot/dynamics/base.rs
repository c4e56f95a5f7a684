//! The base's own six equations.

use super::slot::Spatial;
use crate::robot::spatial::Articulated;
use nalgebra::Vector3;

/// Solves `I^A a = -p^A` for the base, by L D L^T; answers angular and linear acceleration.
///
/// The linear block comes first: it is nearly diagonal, and the angular block then holds what the mass does not.
pub(super) fn solve_base(inertia: &Articulated, bias: &Spatial) -> (Vector3<f64>, Vector3<f64>) {
    let (a, b, c) = (inertia.a.map(|x| x.sum()), inertia.b.map(|row| row.map(|x| x.sum())), inertia.c.map(|x| x.sum()));
    // Lower triangle, linear rows first; B couples moment rows with force columns.
    let mut m = [[0.0; 6]; 6];
    m[0][0] = c[0];
    m[1] = [c[5], c[1], 0.0, 0.0, 0.0, 0.0];
    m[2] = [c[4], c[3], c[2], 0.0, 0.0, 0.0];
    m[3] = [b[0][0], b[0][1], b[0][2], a[0], 0.0, 0.0];
    m[4] = [b[1][0], b[1][1], b[1][2], a[5], a[1], 0.0];
    m[5] = [b[2][0], b[2][1], b[2][2], a[4], a[3], a[2]];
    let (moment, force) = (bias.0.map(|x| x.sum()), bias.1.map(|x| x.sum()));
    let mut x = [-force[0], -force[1], -force[2], -moment[0], -moment[1], -moment[2]];
    let mut inverse = [0.0; 6];
    for k in 0..6 {
        inverse[k] = 1.0 / m[k][k];
        let column = m.map(|row| row[k]);
        for i in k + 1..6 {
            let factor = column[i] * inverse[k];
            for (entry, other) in m[i][k + 1..=i].iter_mut().zip(&column[k + 1..]) {
                *entry -= factor * other;
            }
            x[i] -= factor * x[k];
        }
    }
    for k in (0..6).rev() {
        let above: f64 = (k + 1..6).map(|i| m[i][k] * x[i]).sum();
        x[k] = (x[k] - above) * inverse[k];
    }
    (Vector3::new(x[3], x[4], x[5]), Vector3::new(x[0], x[1], x[2]))
}
