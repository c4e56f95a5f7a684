//! Places and velocities of all bodies (2.2), in world axes.

use super::Dynamics;
use crate::geometry::robot_file::Base;
use crate::robot::model::BASE_FREEDOMS;
use crate::robot::spatial::{Pair, sin_cos};
use crate::robot::{BodyId, JointId, Model, State};
use nalgebra::{Matrix3, Vector3};

/// Where a body is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion {
    /// Its frame's origin (the part's centre) in the world \[m\].
    pub position_m: Vector3<f64>,
    /// The same from the base's centre, world axes \[m\].
    pub from_base_m: Vector3<f64>,
    /// Rotation from the body's axes to the world's.
    pub rotation: Matrix3<f64>,
    /// Velocity of its frame's origin, world axes \[m/s\].
    pub velocity_m_s: Vector3<f64>,
    /// Angular velocity, world axes \[rad/s\].
    pub rate_rad_s: Vector3<f64>,
}

impl BodyMotion {
    /// A point of the body, given in its frame, in the world \[m\].
    pub fn point_m(&self, in_body_m: &Vector3<f64>) -> Vector3<f64> {
        self.position_m + self.rotation * in_body_m
    }

    /// Velocity of a point of the body, given in its frame, in world axes \[m/s\].
    pub fn point_velocity_m_s(&self, in_body_m: &Vector3<f64>) -> Vector3<f64> {
        self.velocity_m_s + self.rate_rad_s.cross(&(self.rotation * in_body_m))
    }

    fn nowhere() -> Self {
        let zero = Vector3::zeros();
        Self {
            position_m: zero,
            from_base_m: zero,
            rotation: Matrix3::identity(),
            velocity_m_s: zero,
            rate_rad_s: zero,
        }
    }
}

/// Motion of all bodies, and of the joints' axes.
#[derive(Clone, Debug)]
pub(super) struct Motions {
    pub bodies: Vec<BodyMotion>,
    /// Joint axes with their sign, world axes.
    pub axes: Vec<Vector3<f64>>,
    /// Points of the joints from the base's centre, world axes \[m\].
    pub points_m: Vec<Vector3<f64>>,
}

impl Motions {
    pub fn new(bodies: usize) -> Self {
        let joints = bodies - 1;
        Self {
            bodies: vec![BodyMotion::nowhere(); bodies],
            axes: vec![Vector3::zeros(); joints],
            points_m: vec![Vector3::zeros(); joints],
        }
    }

    /// Follows the tree outwards.
    pub fn update(&mut self, model: &Model, state: &State) {
        self.follow(model, state, 0..model.joints().len());
    }

    /// Follows some joints outwards, given in the model's order with all that carry them; what the others had stays.
    pub fn follow(&mut self, model: &Model, state: &State, joints: impl Iterator<Item = usize>) {
        let rotation = *state.base_orientation.to_rotation_matrix().matrix();
        let (velocity_m_s, rate_rad_s) = match model.base() {
            Base::Floating => (state.base_velocity_m_s, rotation * state.base_rate_rad_s),
            Base::Clamped => (Vector3::zeros(), Vector3::zeros()),
        };
        let position_m = state.base_position_m;
        self.bodies[0] = BodyMotion { position_m, from_base_m: Vector3::zeros(), rotation, velocity_m_s, rate_rad_s };
        let last = self.axes.len().max(1) - 1;
        let mut known = (usize::MAX, 0.0, 1.0);
        for j in joints {
            let joint = &model.joints()[j];
            // Sines and cosines come in twos.
            let (sin, cos) = if known.0 == j {
                (known.1, known.2)
            } else {
                let next = (j + 1).min(last);
                let (sines, cosines) = sin_cos(Pair::new(state.angle_rad[j], state.angle_rad[next]));
                let ([s0, s1], [c0, c1]) = (sines.lanes(), cosines.lanes());
                known = (next, s1, c1);
                (s0, c0)
            };
            let above = self.bodies[model.carrier(JointId::of(j)).index()];
            let rotation = above.rotation * model.turning()[j].at(sin, cos);
            let axis = rotation * joint.signed_axis().into_inner();
            let to_joint = above.rotation * joint.in_parent_m;
            let from_joint = -(rotation * joint.in_child_m);
            let rate_rad_s = above.rate_rad_s + axis * state.rate_rad_s[j];
            let from_base_m = above.from_base_m + to_joint + from_joint;
            self.axes[j] = axis;
            self.points_m[j] = above.from_base_m + to_joint;
            self.bodies[j + 1] = BodyMotion {
                position_m: state.base_position_m + from_base_m,
                from_base_m,
                rotation,
                velocity_m_s: above.velocity_m_s + above.rate_rad_s.cross(&to_joint) + rate_rad_s.cross(&from_joint),
                rate_rad_s,
            };
        }
    }
}

impl Dynamics<'_> {
    /// Place and velocity of every body, in body order.
    ///
    /// # Panics
    /// Where the state has not the model's number of joints.
    pub fn motions(&mut self, state: &State) -> &[BodyMotion] {
        self.check_state(state);
        self.motions.update(self.model, state);
        &self.motions.bodies
    }

    /// As [`Dynamics::motions`], but only the bodies of some joints and the base move; the joints are given in the
    /// model's order, with all that carry them. The others stay where an earlier call left them.
    ///
    /// # Panics
    /// Where the state has not the model's number of joints, or there is no such joint.
    pub(in crate::robot) fn motions_of(&mut self, state: &State, joints: &[usize]) -> &[BodyMotion] {
        self.check_state(state);
        self.motions.follow(self.model, state, joints.iter().copied());
        &self.motions.bodies
    }

    /// Velocity of a body's point and the body's angular velocity, world axes, that generalised velocities give at the
    /// places that the latest [`Dynamics::motions`] found: `J v`. Also `J dv/dt` of accelerations.
    ///
    /// # Panics
    /// Where `velocity` has not the model's length.
    pub fn point_velocity(&self, body: BodyId, at_m: &Vector3<f64>, velocity: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        self.check("velocities", velocity.len(), self.freedoms());
        let base = &self.motions.bodies[0];
        let from_base_m = at_m - base.position_m;
        let (mut linear, mut angular) = match self.model.base() {
            Base::Floating => {
                let angular = base.rotation * Vector3::from_column_slice(&velocity[3..BASE_FREEDOMS]);
                (Vector3::from_column_slice(&velocity[..3]) + angular.cross(&from_base_m), angular)
            }
            Base::Clamped => (Vector3::zeros(), Vector3::zeros()),
        };
        let mut next = body.joint();
        while let Some(joint) = next {
            let j = joint.index();
            let turning = self.motions.axes[j] * velocity[BASE_FREEDOMS + j];
            angular += turning;
            linear += turning.cross(&(from_base_m - self.motions.points_m[j]));
            next = self.model.carrier(joint).joint();
        }
        (linear, angular)
    }
}
