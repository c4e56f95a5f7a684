//! Energy, momentum and centre of mass.

use super::Dynamics;
use crate::robot::State;
use nalgebra::Vector3;

/// Energies of the whole robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    /// `v^T M v / 2` \[J\].
    pub kinetic_j: f64,
    /// `-sum m g . c`, zero at the world's origin \[J\].
    pub potential_j: f64,
}

impl Energy {
    /// Kinetic and potential energy \[J\].
    pub fn total_j(&self) -> f64 {
        self.kinetic_j + self.potential_j
    }
}

/// Momentum of the whole robot, with its centre of mass; world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum {
    /// Mass of everything \[kg\].
    pub mass_kg: f64,
    /// Centre of mass \[m\].
    pub centre_m: Vector3<f64>,
    /// Its velocity \[m/s\].
    pub velocity_m_s: Vector3<f64>,
    /// Linear momentum \[kg m/s\].
    pub linear_kg_m_s: Vector3<f64>,
    /// Angular momentum about the centre of mass \[kg m^2/s\].
    pub angular_kg_m2_s: Vector3<f64>,
}

impl Dynamics<'_> {
    /// Kinetic and potential energy, body by body.
    ///
    /// # Panics
    /// Where the state has not the model's number of joints.
    pub fn energy(&mut self, state: &State) -> Energy {
        self.check_state(state);
        self.motions.update(self.model, state);
        let mut energy = Energy { kinetic_j: 0.0, potential_j: 0.0 };
        for (matter, motion) in self.model.bodies().iter().zip(&self.motions.bodies) {
            let velocity = motion.point_velocity_m_s(&matter.centre_of_mass_m);
            let rate = motion.rotation.tr_mul(&motion.rate_rad_s);
            let spin = rate.dot(&(matter.inertia_kg_m2 * rate));
            energy.kinetic_j += 0.5 * (matter.mass_kg * velocity.norm_squared() + spin);
            let weight = self.model.gravity_m_s2() * matter.mass_kg;
            energy.potential_j -= weight.dot(&motion.point_m(&matter.centre_of_mass_m));
        }
        for (armature, rate) in self.model.armature_kg_m2().iter().zip(&state.rate_rad_s) {
            energy.kinetic_j += 0.5 * armature * rate * rate;
        }
        energy
    }

    /// Momentum and centre of mass.
    ///
    /// # Panics
    /// Where the state has not the model's number of joints.
    pub fn momentum(&mut self, state: &State) -> Momentum {
        self.check_state(state);
        self.motions.update(self.model, state);
        let (mut mass_kg, mut moment, mut linear) = (0.0, Vector3::zeros(), Vector3::zeros());
        let mut angular = Vector3::zeros();
        for (matter, motion) in self.model.bodies().iter().zip(&self.motions.bodies) {
            let from_base = motion.from_base_m + motion.rotation * matter.centre_of_mass_m;
            let own = motion.point_velocity_m_s(&matter.centre_of_mass_m) * matter.mass_kg;
            let rate = motion.rotation.tr_mul(&motion.rate_rad_s);
            mass_kg += matter.mass_kg;
            moment += from_base * matter.mass_kg;
            linear += own;
            angular += from_base.cross(&own) + motion.rotation * (matter.inertia_kg_m2 * rate);
        }
        let centre = moment / mass_kg;
        Momentum {
            mass_kg,
            centre_m: state.base_position_m + centre,
            velocity_m_s: linear / mass_kg,
            linear_kg_m_s: linear,
            angular_kg_m2_s: angular - centre.cross(&linear),
        }
    }
}
