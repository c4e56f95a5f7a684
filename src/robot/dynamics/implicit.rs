//! Contacts that a step takes implicitly.
//!
//! A foot on a floor is stiff: its tangential friction alone has a slope of hundreds of N s/m on 36 g. A step of length
//! h that linearises the contact force at the point, `F(x + h u', u') = F - h K u - h (D + h K) J dv/dt` with the
//! point's velocity u and `u' = u + h J dv/dt`, needs
//!
//! ```text
//! (M + h J^T (D + h K) J) dv/dt = tau + J^T (F - h K u) - bias
//! ```
//!
//! A body's share of `h J^T W J` is `P^T (h W) P` with `P` from its spatial acceleration to that of the point: it adds
//! to the articulated inertia before the inward pass, which stays as it is. What the spatial acceleration has besides
//! `J dv/dt` (velocity products, gravity) is taken off again in the bias force.

use super::Dynamics;
use super::layout::{Layout, Pairwise};
use super::slot::Spatial;
use crate::robot::model::{Parent, Shape};
use crate::robot::spatial::{Articulated, Pair, Vec3, add, at, cross, rotate_back, sub};
use crate::robot::{BodyId, State};
use nalgebra::{Matrix3, Vector3};

/// How a contact force changes with the motion of its point, for an implicit step.
///
/// The matrices have to be symmetric, so that the articulated inertia stays so, and should not have negative
/// eigenvalues, so that it stays positive: a step is consistent with any of them (it is a W-method), and stable with
/// those.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactDamping {
    /// The body.
    pub body: BodyId,
    /// The point, in the world \[m\].
    pub at_m: Vector3<f64>,
    /// Velocity of the body's point there, world axes \[m/s\].
    pub velocity_m_s: Vector3<f64>,
    /// `-dF/du`, world axes, symmetric \[N s/m\].
    pub damping_n_s_m: Matrix3<f64>,
    /// `-dF/dx`, world axes, symmetric \[N/m\].
    pub stiffness_n_m: Matrix3<f64>,
    /// Minus the derivative of the contact's moment by the angular velocity, world axes, symmetric \[N m s/rad\].
    pub spin_damping_nm_s_rad: Matrix3<f64>,
}

impl ContactDamping {
    /// `D + h K` \[N s/m\]: what stands between `J^T` and `J`, without the step in front.
    pub fn over_a_step_n_s_m(&self, step_s: f64) -> Matrix3<f64> {
        self.damping_n_s_m + self.stiffness_n_m * step_s
    }
}

/// A contact as a body sees it: its point, the world's axes, and the acceleration the body would have with
/// `dv/dt = 0`, gravity included.
struct Seen {
    point_m: Vec3,
    axes: [Vec3; 3],
    acceleration: Spatial,
}

impl Seen {
    fn map(self, f: impl Fn(Vec3) -> Vec3) -> Self {
        let (angular, linear) = self.acceleration;
        Self { point_m: f(self.point_m), axes: self.axes.map(&f), acceleration: (f(angular), f(linear)) }
    }

    /// A world vector.
    fn vector(&self, v: &Vector3<f64>) -> Vec3 {
        [0, 1, 2].map(|i| self.axes[0][i] * splat(v.x) + self.axes[1][i] * splat(v.y) + self.axes[2][i] * splat(v.z))
    }

    /// A symmetric world matrix, packed.
    fn matrix(&self, m: &Matrix3<f64>) -> [Pair; 6] {
        let rows = [0, 1, 2].map(|k| self.vector(&m.row(k).transpose()));
        let mut out = [Pair::zero(); 6];
        for i in 0..3 {
            for j in i..3 {
                out[at(i, j)] =
                    self.axes[0][i] * rows[0][j] + self.axes[1][i] * rows[1][j] + self.axes[2][i] * rows[2][j];
            }
        }
        out
    }

    /// Inertia and bias force that the contact adds to its body.
    fn share(&self, contact: &ContactDamping, step_s: f64) -> (Articulated, Spatial) {
        let linear = self.matrix(&(contact.over_a_step_n_s_m(step_s) * step_s));
        let angular = self.matrix(&(contact.spin_damping_nm_s_rad * step_s));
        let inertia = Articulated { c: linear, ..Articulated::zero() }.shifted(self.point_m);
        let sinking = self.vector(&(contact.stiffness_n_m * contact.velocity_m_s * step_s));
        let (alpha, a) = self.acceleration;
        let force = sub(sinking, times(&linear, add(a, cross(alpha, self.point_m))));
        let moment = sub(cross(self.point_m, force), times(&angular, alpha));
        let a = [0, 1, 2, 3, 4, 5].map(|k| inertia.a[k] + angular[k]);
        (Articulated { a, ..inertia }, (moment, force))
    }
}

fn splat(x: f64) -> Pair {
    Pair::splat(x)
}

fn both(v: &Vector3<f64>) -> Vec3 {
    [splat(v.x), splat(v.y), splat(v.z)]
}

/// A packed symmetric matrix times a vector.
fn times(m: &[Pair; 6], v: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| m[at(i, 0)] * v[0] + m[at(i, 1)] * v[1] + m[at(i, 2)] * v[2])
}

/// Adds a share to inertia and bias, in the lanes of the mask.
fn put(inertia: &mut Articulated, bias: &mut Spatial, (extra, wrench): &(Articulated, Spatial), mask: Pair) {
    inertia.zip(extra, |x, y| x + y * mask);
    bias.0 = add(bias.0, wrench.0.map(|x| x * mask));
    bias.1 = add(bias.1, wrench.1.map(|x| x * mask));
}

impl Dynamics<'_> {
    /// Puts contacts on the bodies, between the outward and the inward pass. `resting` is the base's spatial
    /// acceleration with `dv/dt = 0`, base axes.
    pub(super) fn place_contacts(
        &mut self,
        state: &State,
        resting: &Vector3<f64>,
        step_s: f64,
        contacts: &[ContactDamping],
        base: (&mut Articulated, &mut Spatial),
    ) {
        let rotation = state.base_orientation.to_rotation_matrix();
        for contact in contacts {
            let point = rotation.inverse() * (contact.at_m - state.base_position_m);
            let at_base = || Seen {
                point_m: both(&point),
                axes: [0, 1, 2].map(|k| [0, 1, 2].map(|i| splat(rotation[(k, i)]))),
                acceleration: ([Pair::zero(); 3], both(resting)),
            };
            let Some(joint) = contact.body.joint() else {
                put(base.0, base.1, &at_base().share(contact, step_s), Pair::new(1.0, 0.0));
                continue;
            };
            let (index, lane) = self.model.plan().placed[joint.index()];
            let share = self.seen_at(index, &at_base).share(contact, step_s);
            let mask = self.model.plan().groups[index].lane_mask(lane);
            let slot = &mut self.slots[index];
            put(&mut slot.inertia, &mut slot.bias, &share, mask);
        }
    }

    /// What the base sees, as the bodies of a group see it.
    fn seen_at(&self, index: usize, at_base: &impl Fn() -> Seen) -> Seen {
        let (group, slot) = (&self.model.plan().groups[index], &self.slots[index]);
        let mut seen = match group.parent {
            Parent::Base => at_base(),
            Parent::Lanes(above) => self.seen_at(above, at_base),
            Parent::Shared { group, lane, .. } => {
                self.seen_at(group, at_base).map(|v| v.map(|x| splat(x.lanes()[lane])))
            }
        };
        if group.shape != Shape::Turn {
            let (angular, linear) = seen.acceleration;
            let offset = Pairwise::vector(&group.offset_m, 0);
            seen.point_m = sub(seen.point_m, offset);
            seen.acceleration = (angular, add(linear, cross(angular, offset)));
        }
        if group.shape == Shape::Rotated {
            seen = seen.map(|v| rotate_back(&Pairwise::matrix(&group.fixed, 0), v));
        }
        let mut seen = seen.map(|v| self.turned(index, group, v));
        seen.acceleration = (add(seen.acceleration.0, slot.product.0), add(seen.acceleration.1, slot.product.1));
        seen
    }
}
