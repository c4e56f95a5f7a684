//! Inertia at points of bodies: what an implicit step makes of dampers between a body and the world.
//!
//! A damper `f = -C v` at a point, taken along over a step h, resists the point's acceleration with `h C`. Seen from the
//! body that is a spatial inertia `W (h C) W^T`, with the wrenches W of unit forces at the point.

use super::Dynamics;
use super::slot::Spatial;
use crate::robot::spatial::{Articulated, Pair, add};
use crate::robot::{BodyId, State};
use nalgebra::{Matrix3, Vector3};

/// A resistance to the acceleration of a point of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointInertia {
    /// The body.
    pub body: BodyId,
    /// The point, in the world \[m\].
    pub at_m: Vector3<f64>,
    /// Force per acceleration, world axes, symmetric and not negative \[kg\]: `h C` of a damper C \[N s/m\].
    pub matrix_kg: Matrix3<f64>,
}

impl Dynamics<'_> {
    /// Adds points' inertia to the slots, whose turns, rigid inertias and biases have to be known, and to the base.
    ///
    /// Gravity is an acceleration of the base in these passes, and the points must not resist it: a bias takes that back.
    pub(super) fn place_points(
        &mut self,
        state: &State,
        points: &[PointInertia],
        (base_inertia, base_bias): (&mut Articulated, &mut Spatial),
    ) {
        let gravity = self.model.gravity_m_s2();
        let back = state.base_orientation.inverse().to_rotation_matrix();
        for point in points {
            let arm = point.at_m - state.base_position_m;
            let unit = |k: usize| {
                let mut force = Vector3::zeros();
                force[k] = 1.0;
                let (moment, force) = (back * arm.cross(&force), back * force);
                (<[f64; 3]>::from(moment), <[f64; 3]>::from(force))
            };
            let units = [0, 1, 2].map(unit);
            // Each pair of axes once; a diagonal entry is counted half, because both orders are added.
            let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
            let weight = |i: usize, j: usize| point.matrix_kg[(i, j)] * if i == j { 0.5 } else { 1.0 };
            let share = point.matrix_kg * gravity;
            match point.body.joint() {
                None => {
                    let both = units.map(|(moment, force)| (moment.map(Pair::splat), force.map(Pair::splat)));
                    for (i, j) in pairs {
                        base_inertia.add_outer(both[i], both[j], Pair::new(weight(i, j), 0.0));
                    }
                    for (k, (moment, force)) in both.iter().enumerate() {
                        let share = Pair::new(share[k], 0.0);
                        base_bias.0 = add(base_bias.0, moment.map(|x| x * share));
                        base_bias.1 = add(base_bias.1, force.map(|x| x * share));
                    }
                }
                Some(joint) => {
                    let (index, lane) = self.model.plan().placed[joint.index()];
                    let wrenches = [0, 1, 2].map(|k| self.wrench_at(index, &units[k]));
                    let mask = self.model.plan().groups[index].mask_of(lane);
                    for (i, j) in pairs {
                        let k = Pair::splat(weight(i, j)) * mask;
                        self.slots[index].inertia.add_outer(wrenches[i], wrenches[j], k);
                    }
                    let bias = &mut self.slots[index].bias;
                    for (k, (moment, force)) in wrenches.iter().enumerate() {
                        let share = Pair::splat(share[k]) * mask;
                        bias.0 = add(bias.0, moment.map(|x| x * share));
                        bias.1 = add(bias.1, force.map(|x| x * share));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Force, Input, Model};

    /// `(M + h J^T C J) a = F` is the same as `M a = F - h J^T C J a`: the point's own acceleration as a force.
    #[test]
    fn a_point_inertia_is_the_force_that_its_acceleration_makes() {
        let robot = Model::ers7();
        let mut dynamics = Dynamics::new(robot);
        let mut state = State::at_rest(robot);
        for (k, q) in state.angle_rad.iter_mut().enumerate() {
            *q = 0.3 * (k as f64).sin();
        }
        state.base_position_m = Vector3::new(0.3, 0.2, -0.1);
        let matrix_kg = Matrix3::new(0.3, 0.05, 0.0, 0.05, 0.2, 0.02, 0.0, 0.02, 0.7);
        for name in ["rf_lower", "head", "trunk"] {
            let body = robot.body(name).unwrap();
            let at_m = dynamics.motions(&state)[body.index()].point_m(&Vector3::new(0.01, -0.03, 0.02));
            let mut with = [0.0; 28];
            let point = PointInertia { body, at_m, matrix_kg };
            dynamics.forward_with(&state, &Input::torques(&[0.01; 22]), &[point], &mut with);
            // The point's acceleration, the robot being at rest, by the velocities that `with` would be.
            let mut moving = state.clone();
            moving.base_velocity_m_s = Vector3::new(with[0], with[1], with[2]);
            moving.base_rate_rad_s = Vector3::new(with[3], with[4], with[5]);
            moving.rate_rad_s.copy_from_slice(&with[6..]);
            let motion = dynamics.motions(&moving)[body.index()];
            let acceleration = motion.velocity_m_s + motion.rate_rad_s.cross(&(at_m - motion.position_m));
            let force = [Force::at(body, at_m, -(matrix_kg * acceleration))];
            let mut without = [0.0; 28];
            let input = Input { torque_nm: &[0.01; 22], diagonal_kg_m2: &[], forces: &force };
            dynamics.forward(&state, &input, &mut without);
            for (a, b) in with.iter().zip(&without) {
                assert!((a - b).abs() < 1e-8 * a.abs().max(1.0), "{name}: {a} {b}");
            }
        }
    }
}
