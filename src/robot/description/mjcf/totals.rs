//! What the compiler does to masses and tensors.

use super::Reader;
use crate::robot::description::inertia::RigidInertia;
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

impl Reader<'_> {
    /// `boundmass`, `boundinertia`: nothing lighter; `balanceinertia`: a tensor that no body has becomes its mean.
    ///
    /// A body that nothing says anything of is lifted too; MuJoCo takes its `pos` for its centre of mass then, and so it is
    /// here (`unsaid_m`).
    pub(super) fn bounded(&self, inertia: Option<RigidInertia>, unsaid_m: Vector3<f64>) -> RigidInertia {
        let settings = &self.compiler;
        let centre_m = inertia.map_or(unsaid_m, |inertia| inertia.centre_m());
        let inertia = inertia.unwrap_or_default();
        let mass_kg = inertia.mass_kg.max(settings.least_mass_kg);
        let Some((given, axes)) = inertia.principal() else { return inertia };
        let mut moments = given.map(|moment| moment.max(settings.least_moment_kg_m2));
        if settings.is_balancing && 2.0 * moments.max() > moments.sum() {
            moments.fill(moments.mean());
        }
        if mass_kg == inertia.mass_kg && moments == given {
            return inertia;
        }
        let tensor = axes * Matrix3::from_diagonal(&moments) * axes.transpose();
        let centre = Isometry3::from_parts(Translation3::from(centre_m), UnitQuaternion::identity());
        RigidInertia::about_centre(mass_kg, &tensor, &centre)
    }

    /// `fusestatic`: what stands on the world becomes world and weighs nothing; `settotalmass`: all scaled to a sum.
    pub(super) fn totals(&mut self) {
        let free = self.into.free_joint.as_ref().map(|free| free.link.0);
        if self.compiler.is_fusing {
            let mut is_still: Vec<bool> = Vec::with_capacity(self.into.links.len());
            for (index, link) in self.into.links.iter_mut().enumerate() {
                let stands = link.parent.is_none_or(|parent| is_still[parent.0]);
                is_still.push(stands && link.joints.is_empty() && free != Some(index));
                if is_still[index] {
                    link.inertia = RigidInertia::default();
                }
            }
        }
        let sum = self.into.total_mass_kg();
        if let Some(total) = self.compiler.total_mass_kg.filter(|_| sum > 0.0) {
            for link in &mut self.into.links {
                link.inertia = link.inertia.scaled(total / sum);
            }
        }
    }
}
