//! What the compiler does to masses and tensors.

use super::Reader;
use super::inertial::WEIGHTLESS_KG;
use crate::robot::description::inertia::RigidInertia;
use crate::robot::description::parts::LinkId;
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

/// Relative error of moments that were moved and found again.
const ROUNDING: f64 = 1e-12;

impl Reader<'_> {
    /// `boundmass`, `boundinertia`: nothing lighter; `balanceinertia`: a tensor that no body has becomes its mean.
    ///
    /// A body that nothing says anything of is lifted too; MuJoCo takes its `pos` for its centre of mass then, of a weightless
    /// one what its `<inertial>` says, and so it is here (`unsaid_m`).
    pub(super) fn bounded(&self, inertia: Option<RigidInertia>, unsaid_m: Vector3<f64>) -> RigidInertia {
        let settings = &self.compiler;
        let inertia = inertia.unwrap_or_default();
        let centre_m = if inertia.mass_kg > 0.0 { inertia.centre_m() } else { unsaid_m };
        let mass_kg = inertia.mass_kg.max(settings.least_mass_kg);
        let Some((given, axes)) = inertia.principal() else { return inertia };
        let mut moments = given.map(|moment| moment.max(settings.least_moment_kg_m2));
        // A thin disc is a body: what moving its tensor rounds does not make it none.
        let rounding = ROUNDING * (moments.sum() + mass_kg * centre_m.norm_squared());
        if settings.is_balancing && 2.0 * moments.max() > moments.sum() + rounding {
            moments.fill(moments.mean());
        }
        if mass_kg == inertia.mass_kg && moments == given {
            return inertia;
        }
        let tensor = axes * Matrix3::from_diagonal(&moments) * axes.transpose();
        let centre = Isometry3::from_parts(Translation3::from(centre_m), UnitQuaternion::identity());
        RigidInertia::about_centre(mass_kg, &tensor, &centre)
    }

    /// `fusestatic`: what stands on the world becomes world and weighs nothing, and what is weightless on another body adds
    /// nothing to it, unless anything names it; `settotalmass`: all scaled to a sum.
    pub(super) fn totals(&mut self) {
        let free = self.into.free_joint.as_ref().map(|free| free.link.0);
        if self.compiler.is_fusing {
            let mut is_still: Vec<bool> = Vec::with_capacity(self.into.links.len());
            for (index, link) in self.into.links.iter_mut().enumerate() {
                let is_part = link.joints.is_empty() && free != Some(index) && !self.unfused.contains(&LinkId(index));
                is_still.push(is_part && link.parent.is_none_or(|parent| is_still[parent.0]));
                if is_still[index] || is_part && link.inertia.mass_kg < WEIGHTLESS_KG {
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
