//! Servos whose damping is given as a share of the critical one.

use super::{Tree, TreeDynamics, TreeState};
use crate::robot::description::{Actuator, Description};
use nalgebra::DMatrix;

impl Tree {
    /// The description's actuators with their damping ratios resolved: `kv = 2 ratio sqrt(kp m)`, m being the inertia about
    /// the joint as drawn (armature included) divided by the square of the gear.
    pub fn servos(&self, description: &Description) -> Vec<Actuator> {
        let mut servos = description.actuators.clone();
        if servos.iter().all(|servo| servo.damping_ratio.is_none()) {
            return servos;
        }
        let mut matrix = DMatrix::zeros(self.freedoms(), self.freedoms());
        TreeDynamics::new(self).mass_matrix(&TreeState::drawn(self), &mut matrix);
        for servo in &mut servos {
            let Some(ratio) = servo.damping_ratio.take() else { continue };
            let at = self.base_freedoms() + self.coordinates.follows[servo.joint.0].freedom;
            let inertia = matrix[(at, at)] / (servo.gear * servo.gear);
            servo.bias[2] = -2.0 * ratio * (servo.gain * inertia).sqrt();
        }
        servos
    }
}
