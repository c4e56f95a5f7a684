//! The base: how it moves, and its own six equations.

use super::articulated::BaseWork;
use super::layout::{Layout, MOST_ROBOTS};
use super::slot::Spatial;
use crate::geometry::robot_file::Base;
use crate::number::Lanes;
use crate::robot::model::BASE_FREEDOMS;
use crate::robot::spatial::{Articulated, Number, Vec3, add, cross, rotate, rotate_back, six, three};
use crate::robot::{Model, State};
use nalgebra::Vector3;

/// How the bases of some robots lie and move, in their own axes.
pub(super) struct Carried<S> {
    /// Into the world's axes, by rows.
    rotation: [Vec3<S>; 3],
    /// \[m/s\]
    pub velocity_m_s: Vec3<S>,
    /// \[rad/s\]
    pub rate_rad_s: Vec3<S>,
    /// \[m/s^2\]
    pub gravity_m_s2: Vec3<S>,
}

impl<S: Number> Carried<S> {
    /// Of the robots' states; a clamped base does not move.
    #[inline(always)]
    pub fn of<'a>(model: &Model, state: impl Fn(usize) -> &'a State) -> Self {
        let zero = [S::zero(); 3];
        let mut turns = [[[0.0; 3]; 3]; MOST_ROBOTS];
        for (robot, turn) in turns.iter_mut().enumerate().take(S::LANES) {
            let rotation = state(robot).base_orientation.to_rotation_matrix();
            for (i, row) in turn.iter_mut().enumerate() {
                *row = [rotation[(i, 0)], rotation[(i, 1)], rotation[(i, 2)]];
            }
        }
        let mut rotation = [zero; 3];
        for (i, row) in rotation.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = S::of(|robot| turns[robot][i][j]);
            }
        }
        let gravity = model.gravity_m_s2();
        let (velocity_m_s, rate_rad_s) = match model.base() {
            Base::Floating => (
                rotate_back(&rotation, vector(|robot| &state(robot).base_velocity_m_s)),
                vector(|robot| &state(robot).base_rate_rad_s),
            ),
            Base::Clamped => (zero, zero),
        };
        let gravity_m_s2 = rotate_back(&rotation, [S::splat(gravity.x), S::splat(gravity.y), S::splat(gravity.z)]);
        Self { rotation, velocity_m_s, rate_rad_s, gravity_m_s2 }
    }

    /// What the base's centre would do with `dv/dt = 0`, gravity taken off \[m/s^2\].
    pub fn falling(&self) -> Vec3<S> {
        add(self.gravity_m_s2, cross(self.rate_rad_s, self.velocity_m_s))
    }

    /// From the spatial acceleration with gravity in it to that of the base's centre, in world axes; with the angular one
    /// into the robots' generalised accelerations, which stand one after another.
    #[inline(always)]
    pub fn write(&self, base: Base, (angular, linear): (Vec3<S>, Vec3<S>), out: &mut [f64], freedoms: usize) {
        let classical = match base {
            Base::Floating => {
                let linear = add(add(linear, self.gravity_m_s2), cross(self.rate_rad_s, self.velocity_m_s));
                rotate(&self.rotation, linear)
            }
            Base::Clamped => [S::zero(); 3],
        };
        for (k, number) in classical.into_iter().chain(angular).enumerate() {
            for (out, number) in out.chunks_exact_mut(freedoms).zip(number.each().as_ref()) {
                out[..BASE_FREEDOMS][k] = *number;
            }
        }
    }
}

/// A vector of each robot.
#[inline(always)]
fn vector<'a, S: Number>(of: impl Fn(usize) -> &'a Vector3<f64>) -> Vec3<S> {
    [S::of(|robot| of(robot).x), S::of(|robot| of(robot).y), S::of(|robot| of(robot).z)]
}

/// Solves `I^A a = -p^A` for the base, by L D L^T; answers angular and linear acceleration.
///
/// The linear block comes first: it is nearly diagonal, and the angular block then holds what the mass does not.
#[inline(always)]
pub(super) fn solve_base<L: Layout>(base: &BaseWork<L>) -> (Vec3<L::Single>, Vec3<L::Single>) {
    let [first, second] = &base.inertia;
    let sum = |of: &dyn Fn(&Articulated<L::Number>) -> L::Number| L::total([of(first), of(second)]);
    let total = |of: &dyn Fn(&Spatial<L::Number>) -> L::Number| L::total([of(&base.bias[0]), of(&base.bias[1])]);
    let a = six(|k| sum(&|inertia| inertia.a[k]));
    let c = six(|k| sum(&|inertia| inertia.c[k]));
    let b = three(|i| three(|j| sum(&|inertia| inertia.b[i][j])));
    let zero = L::Single::zero();
    // Lower triangle, linear rows first; B couples moment rows with force columns.
    let mut m = [[zero; 6]; 6];
    m[0][0] = c[0];
    m[1] = [c[5], c[1], zero, zero, zero, zero];
    m[2] = [c[4], c[3], c[2], zero, zero, zero];
    m[3] = [b[0][0], b[0][1], b[0][2], a[0], zero, zero];
    m[4] = [b[1][0], b[1][1], b[1][2], a[5], a[1], zero];
    m[5] = [b[2][0], b[2][1], b[2][2], a[4], a[3], a[2]];
    let minus = L::Single::splat(-1.0);
    let force = three(|k| total(&|bias| bias.1[k]) * minus);
    let moment = three(|k| total(&|bias| bias.0[k]) * minus);
    let mut x = [force[0], force[1], force[2], moment[0], moment[1], moment[2]];
    let mut inverse = [zero; 6];
    for k in 0..6 {
        inverse[k] = m[k][k].inverse();
        let column = six(|i| m[i][k]);
        for i in k + 1..6 {
            let factor = column[i] * inverse[k];
            for (entry, other) in m[i][k + 1..=i].iter_mut().zip(&column[k + 1..]) {
                *entry = *entry - factor * *other;
            }
            x[i] = x[i] - factor * x[k];
        }
    }
    for k in (0..6).rev() {
        let above = (k + 1..6).map(|i| m[i][k] * x[i]).fold(L::Single::splat(-0.0), |sum, term| sum + term);
        x[k] = (x[k] - above) * inverse[k];
    }
    ([x[3], x[4], x[5]], [x[0], x[1], x[2]])
}
