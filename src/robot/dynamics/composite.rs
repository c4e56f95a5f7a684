//! The mass matrix by composite rigid bodies (Featherstone 2008, section 6.2; Walker and Orin 1982), in world axes
//! about the base's centre.

use super::Dynamics;
use crate::geometry::inertia::parallel_axis;
use crate::robot::model::BASE_FREEDOMS;
use crate::robot::{JointId, State};
use nalgebra::{DMatrix, Matrix3, Vector3};

/// A body with everything beyond it as one rigid body, about the base's centre.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Composite {
    mass_kg: f64,
    /// Mass times place \[kg m\].
    moment_kg_m: Vector3<f64>,
    /// \[kg m^2\]
    inertia_kg_m2: Matrix3<f64>,
}

impl Composite {
    /// Linear and angular momentum of a motion: angular velocity, and velocity of the point at the base's centre.
    fn momentum(&self, angular: &Vector3<f64>, linear: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (
            linear * self.mass_kg + angular.cross(&self.moment_kg_m),
            self.inertia_kg_m2 * angular + self.moment_kg_m.cross(linear),
        )
    }
}

impl Dynamics<'_> {
    /// The mass matrix M of `v = [base linear, world; base angular, body; joint rates]`, whole also for a clamped base.
    ///
    /// # Panics
    /// Where the matrix is not (6 + joints) square.
    pub fn mass_matrix(&mut self, state: &State, out: &mut DMatrix<f64>) {
        self.check_state(state);
        self.check("rows", out.nrows(), self.freedoms());
        self.check("columns", out.ncols(), self.freedoms());
        self.motions.update(self.model, state);
        for (composite, (matter, motion)) in
            self.composites.iter_mut().zip(self.model.bodies().iter().zip(&self.motions.bodies))
        {
            let centre = motion.from_base_m + motion.rotation * matter.centre_of_mass_m;
            let own = motion.rotation * matter.inertia_kg_m2 * motion.rotation.transpose();
            *composite = Composite {
                mass_kg: matter.mass_kg,
                moment_kg_m: centre * matter.mass_kg,
                inertia_kg_m2: parallel_axis(&own, matter.mass_kg, &centre),
            };
        }
        for j in (0..self.model.joints().len()).rev() {
            let beyond = self.composites[j + 1];
            let above = &mut self.composites[self.model.carrier(JointId::of(j)).index()];
            above.mass_kg += beyond.mass_kg;
            above.moment_kg_m += beyond.moment_kg_m;
            above.inertia_kg_m2 += beyond.inertia_kg_m2;
        }
        let rotation = self.motions.bodies[0].rotation;
        let whole = self.composites[0];
        out.fill(0.0);
        for k in 0..3 {
            out[(k, k)] = whole.mass_kg;
            let (linear, angular) = whole.momentum(&rotation.column(k).into_owned(), &Vector3::zeros());
            let angular = rotation.tr_mul(&angular);
            for i in 0..3 {
                out[(i, 3 + k)] = linear[i];
                out[(3 + k, i)] = linear[i];
                out[(3 + i, 3 + k)] = angular[i];
            }
        }
        for j in 0..self.model.joints().len() {
            let (axis, point) = (self.motions.axes[j], self.motions.points_m[j]);
            let (linear, angular) = self.composites[j + 1].momentum(&axis, &point.cross(&axis));
            let column = BASE_FREEDOMS + j;
            let mut along = Some(JointId::of(j));
            while let Some(joint) = along {
                let k = joint.index();
                let value = self.motions.axes[k].dot(&(angular - self.motions.points_m[k].cross(&linear)));
                out[(BASE_FREEDOMS + k, column)] = value;
                out[(column, BASE_FREEDOMS + k)] = value;
                along = self.model.carrier(joint).joint();
            }
            out[(column, column)] += self.model.armature_kg_m2()[j];
            let turned = rotation.tr_mul(&angular);
            for i in 0..3 {
                for (row, value) in [(i, linear[i]), (3 + i, turned[i])] {
                    out[(row, column)] = value;
                    out[(column, row)] = value;
                }
            }
        }
    }
}
