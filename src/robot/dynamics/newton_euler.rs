//! Inverse dynamics by recursive Newton-Euler (Featherstone 2008, section 5.3; Luh, Walker and Paul 1980), in world
//! axes about the base's centre.
//!
//! A body's `F = m (a_c - g)` and `N = I alpha + w x I w + c x F` are summed from the ends of the tree inwards; the
//! torque of a joint is what of the sum acts about its axis, `tau = a . (N - p x F)`.

use super::Dynamics;
use super::forces::Force;
use crate::geometry::robot_file::Base;
use crate::robot::model::BASE_FREEDOMS;
use crate::robot::{JointId, State};
use nalgebra::Vector3;

/// What a body and everything beyond it needs, and the acceleration it has.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Load {
    /// World axes \[N\].
    pub force_n: Vector3<f64>,
    /// About the base's centre, world axes \[N m\].
    pub moment_nm: Vector3<f64>,
    /// Of the frame's origin \[m/s^2\].
    acceleration_m_s2: Vector3<f64>,
    /// \[rad/s^2\]
    angular_rad_s2: Vector3<f64>,
}

impl Dynamics<'_> {
    /// Inverse dynamics: the base wrench and joint torques that give an acceleration, `M dv/dt + bias - J^T f`.
    ///
    /// The first six are force (world axes) and moment (body axes, about its centre) on the base: zero for a motion
    /// that a floating base can make, what holds it for a clamped one. A clamped base's accelerations are ignored.
    ///
    /// # Panics
    /// Where a slice has not the model's length.
    pub fn inverse(&mut self, state: &State, acceleration: &[f64], forces: &[Force], out: &mut [f64]) {
        self.check("accelerations", acceleration.len(), self.freedoms());
        self.inverse_of(state, |k| acceleration[k], forces, out);
    }

    /// The bias: Coriolis, centrifugal and gravity forces, what no acceleration needs.
    ///
    /// # Panics
    /// As [`Dynamics::inverse`].
    pub fn bias(&mut self, state: &State, out: &mut [f64]) {
        self.inverse_of(state, |_| 0.0, &[], out);
    }

    fn inverse_of(&mut self, state: &State, acceleration: impl Fn(usize) -> f64, forces: &[Force], out: &mut [f64]) {
        self.check_state(state);
        self.check("torques", out.len(), self.freedoms());
        self.motions.update(self.model, state);
        let triple = |k: usize| Vector3::new(acceleration(k), acceleration(k + 1), acceleration(k + 2));
        let rotation = self.motions.bodies[0].rotation;
        let base = match self.model.base() {
            Base::Floating => {
                Load { acceleration_m_s2: triple(0), angular_rad_s2: rotation * triple(3), ..Load::default() }
            }
            Base::Clamped => Load::default(),
        };
        self.loads[0] = base;
        self.need(0);
        for (j, joint) in self.model.joints().iter().enumerate() {
            let above = self.model.carrier(JointId::of(j)).index();
            let (carrier, motion, load) = (self.motions.bodies[above], self.motions.bodies[j + 1], self.loads[above]);
            let to_joint = carrier.rotation * joint.in_parent_m;
            let from_joint = -(motion.rotation * joint.in_child_m);
            let axis = self.motions.axes[j];
            let angular_rad_s2 = load.angular_rad_s2
                + axis * acceleration(BASE_FREEDOMS + j)
                + carrier.rate_rad_s.cross(&axis) * state.rate_rad_s[j];
            let acceleration_m_s2 = load.acceleration_m_s2
                + turning(&load.angular_rad_s2, &carrier.rate_rad_s, &to_joint)
                + turning(&angular_rad_s2, &motion.rate_rad_s, &from_joint);
            self.loads[j + 1] = Load { acceleration_m_s2, angular_rad_s2, ..Load::default() };
            self.need(j + 1);
        }
        for force in forces {
            let load = &mut self.loads[force.body.index()];
            load.force_n -= force.force_n;
            load.moment_nm -= force.about(&state.base_position_m);
        }
        for j in (0..self.model.joints().len()).rev() {
            let Load { force_n, moment_nm, .. } = self.loads[j + 1];
            let about = moment_nm - self.motions.points_m[j].cross(&force_n);
            let of_rotor = self.model.armature_kg_m2()[j] * acceleration(BASE_FREEDOMS + j);
            out[BASE_FREEDOMS + j] = self.motions.axes[j].dot(&about) + of_rotor;
            let above = &mut self.loads[self.model.carrier(JointId::of(j)).index()];
            above.force_n += force_n;
            above.moment_nm += moment_nm;
        }
        out[..3].copy_from_slice(self.loads[0].force_n.as_slice());
        out[3..BASE_FREEDOMS].copy_from_slice((rotation.transpose() * self.loads[0].moment_nm).as_slice());
    }

    /// Force and moment that a body's own acceleration needs.
    fn need(&mut self, body: usize) {
        let (matter, motion) = (&self.model.bodies()[body], &self.motions.bodies[body]);
        let load = &mut self.loads[body];
        let to_centre = motion.rotation * matter.centre_of_mass_m;
        let acceleration = load.acceleration_m_s2 + turning(&load.angular_rad_s2, &motion.rate_rad_s, &to_centre);
        load.force_n = (acceleration - self.model.gravity_m_s2()) * matter.mass_kg;
        let times = |v: &Vector3<f64>| motion.rotation * (matter.inertia_kg_m2 * motion.rotation.tr_mul(v));
        let spin = times(&load.angular_rad_s2) + motion.rate_rad_s.cross(&times(&motion.rate_rad_s));
        load.moment_nm = spin + (motion.from_base_m + to_centre).cross(&load.force_n);
    }
}

/// What turning adds to the acceleration of a point at `r`: `alpha x r + w x (w x r)`.
fn turning(alpha: &Vector3<f64>, omega: &Vector3<f64>, r: &Vector3<f64>) -> Vector3<f64> {
    alpha.cross(r) + omega.cross(&omega.cross(r))
}
