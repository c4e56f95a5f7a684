//! What gravity alone asks of each joint.

use super::Dynamics;
use crate::robot::{JointId, State};
use nalgebra::Vector3;

impl Dynamics<'_> {
    /// Gravity torque of everything beyond each joint, about its axis \[N m\]: the load of its bearing (effect
    /// `load_friction`).
    ///
    /// # Panics
    /// Where the state or the slice has not the model's number of joints.
    pub fn gravity_nm(&mut self, state: &State, out: &mut [f64]) {
        self.check_state(state);
        self.check("torques", out.len(), self.model.joints().len());
        self.motions.update(self.model, state);
        let gravity = self.model.gravity_m_s2();
        // Mass and first moment about the base's centre, summed from the ends inwards.
        for (load, (body, motion)) in self.loads.iter_mut().zip(self.model.bodies().iter().zip(&self.motions.bodies)) {
            let centre = motion.from_base_m + motion.rotation * body.centre_of_mass_m;
            (load.force_n, load.moment_nm) = (gravity * body.mass_kg, (centre * body.mass_kg).cross(&gravity));
        }
        for (j, torque_nm) in out.iter_mut().enumerate().rev() {
            let (force, moment): (Vector3<f64>, Vector3<f64>) =
                (self.loads[j + 1].force_n, self.loads[j + 1].moment_nm);
            *torque_nm = self.motions.axes[j].dot(&(moment - self.motions.points_m[j].cross(&force)));
            let above = self.model.carrier(JointId::of(j)).index();
            self.loads[above].force_n += force;
            self.loads[above].moment_nm += moment;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::robot::{Dynamics, Model, State};

    #[test]
    fn gravity_is_minus_the_bias_at_rest() {
        let robot = Model::ers7();
        let mut dynamics = Dynamics::new(robot);
        let mut state = State::at_rest(robot);
        for (k, q) in state.angle_rad.iter_mut().enumerate() {
            *q = 0.4 * (2.0 * k as f64).cos();
        }
        let (mut bias, mut gravity) = (vec![0.0; 28], vec![0.0; 22]);
        dynamics.bias(&state, &mut bias);
        dynamics.gravity_nm(&state, &mut gravity);
        for (b, g) in bias[6..].iter().zip(&gravity) {
            assert!((b + g).abs() < 1e-14, "{b} {g}");
        }
    }
}
