//! What the compiler does to masses and tensors.

use super::Reader;
use crate::robot::description::inertia::RigidInertia;
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion};

impl Reader<'_> {
    /// `boundmass`, `boundinertia`: nothing lighter; `balanceinertia`: a tensor that no body has becomes its mean.
    pub(super) fn bounded(&self, inertia: RigidInertia) -> RigidInertia {
        let settings = &self.compiler;
        let mass_kg = inertia.mass_kg.max(settings.least_mass_kg);
        let central = inertia.central_kg_m2();
        let principal = central.symmetric_eigen();
        let mut moments = principal.eigenvalues.map(|moment| moment.max(settings.least_moment_kg_m2));
        if settings.is_balancing && 2.0 * moments.max() > moments.sum() {
            moments.fill(moments.mean());
        }
        if mass_kg == inertia.mass_kg && moments == principal.eigenvalues {
            return inertia;
        }
        let axes = principal.eigenvectors;
        let tensor = axes * Matrix3::from_diagonal(&moments) * axes.transpose();
        let centre = Isometry3::from_parts(Translation3::from(inertia.centre_m()), UnitQuaternion::identity());
        RigidInertia::about_centre(mass_kg, &tensor, &centre)
    }

    /// `fusestatic`: what stands on the world becomes world and weighs nothing; `settotalmass`: all scaled to a sum.
    pub(super) fn totals(&mut self) {
        let free = self.into.free_joint.map(|free| free.link.0);
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
