//! Servos whose damping is given as a share of the critical one.

use super::factor::Factors;
use super::{Tree, TreeDynamics, TreeState};
use crate::robot::description::{Actuator, Description};
use nalgebra::DMatrix;

impl Tree {
    /// The description's actuators with their damping ratios resolved: `kv = 2 ratio sqrt(kp m)`, m being what resists the
    /// joint as drawn where all others give way, `1/(M^-1)_ii` with armature, divided by the square of the gear: so does
    /// MuJoCo 4.0.0. (Its documentation and earlier releases have `M_ii`.) Without a mass matrix that can be inverted
    /// ratios stay as they are.
    pub fn servos(&self, description: &Description) -> Vec<Actuator> {
        let mut servos = description.actuators.clone();
        if servos.iter().all(|servo| servo.damping_ratio.is_none()) {
            return servos;
        }
        let n = self.freedoms();
        let (mut matrix, mut factors, mut column) = (DMatrix::zeros(n, n), Factors::new(n), vec![0.0; n]);
        TreeDynamics::new(self).mass_matrix(&TreeState::drawn(self), &mut matrix);
        if factors.set(&matrix).is_err() {
            return servos;
        }
        for servo in &mut servos {
            let Some(ratio) = servo.damping_ratio.take() else { continue };
            let at = self.base_freedoms() + self.coordinates.follows[servo.joint.0].freedom;
            column.fill(0.0);
            column[at] = 1.0;
            factors.solve(&mut column);
            let inertia = 1.0 / (column[at] * servo.gear * servo.gear);
            servo.bias[2] = -2.0 * ratio * (servo.gain * inertia).sqrt();
        }
        servos
    }
}
