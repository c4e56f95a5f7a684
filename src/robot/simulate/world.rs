//! The equations of motion with what the surroundings add.

use super::{External, JointDrive, Scenario};
use crate::geometry::robot_file::Base;
use crate::robot::{Dynamics, Force, PointInertia, State};
use nalgebra::{UnitQuaternion, Vector3};

/// Working memory for one scenario.
pub(super) struct World<'a> {
    scenario: Scenario<'a>,
    pub dynamics: Dynamics<'a>,
    pub external: External,
    /// Dampers of the surroundings over `g h`.
    pub points: Vec<PointInertia>,
    /// Gravity's load on each joint \[N m\], where a friction effect asks for it.
    pub gravity_nm: Vec<f64>,
    needs_gravity: bool,
    moving: State,
    /// Of each point: its place in the body, its velocity, `omega x v`.
    before: Vec<(Vector3<f64>, Vector3<f64>, Vector3<f64>)>,
}

/// Over which velocities are differenced \[s\].
const NUDGE_S: f64 = 1e-6;

impl<'a> World<'a> {
    pub(super) fn new(scenario: &Scenario<'a>) -> Self {
        Self {
            scenario: *scenario,
            dynamics: Dynamics::new(scenario.model),
            external: External::default(),
            points: Vec::new(),
            gravity_nm: vec![0.0; scenario.model.joints().len()],
            needs_gravity: scenario.joints.drives().iter().any(JointDrive::has_friction_terms),
            moving: scenario.start.clone(),
            before: Vec::new(),
        }
    }

    /// Forces and loads at a state. `gh_s` makes dampers inertia; in a second stage `first` is the acceleration of the
    /// first, and what the dampers' inertia does with it is added twice.
    pub(super) fn surround(&mut self, t_s: f64, body: &State, gh_s: f64, first: Option<&[f64]>) {
        self.external.clear();
        self.points.clear();
        if self.needs_gravity {
            self.dynamics.gravity_nm(body, &mut self.gravity_nm);
        }
        let Some(surroundings) = self.scenario.surroundings else { return };
        surroundings.act(t_s, self.dynamics.motions(body), &mut self.external);
        let inertia =
            |d: &super::PointDamper| PointInertia { body: d.body, at_m: d.at_m, matrix_kg: d.damping_n_s_m * gh_s };
        self.points.extend(self.external.dampers.iter().map(inertia));
        if self.points.is_empty() {
            return;
        }
        self.take_back_velocity_terms(body);
        let Some(k) = first else { return };
        // The points' accelerations, read as the velocities of a robot that moves so.
        let base = self.scenario.model.base() == Base::Floating;
        let triple = |i: usize| if base { Vector3::new(k[i], k[i + 1], k[i + 2]) } else { Vector3::zeros() };
        self.moving.clone_from(body);
        (self.moving.base_velocity_m_s, self.moving.base_rate_rad_s) = (triple(0), triple(3));
        self.moving.rate_rad_s.copy_from_slice(&k[6..]);
        let bodies = self.dynamics.motions(&self.moving);
        for point in &self.points {
            let motion = &bodies[point.body.index()];
            let speed = motion.velocity_m_s + motion.rate_rad_s.cross(&(point.at_m - motion.position_m));
            self.external.forces.push(Force::at(point.body, point.at_m, point.matrix_kg * speed * 2.0));
        }
    }

    /// The points' inertia is to resist what the joints' and the base's accelerations do to them, and not what they would
    /// do at constant rates (the velocity terms of their acceleration): forces that take that share back.
    fn take_back_velocity_terms(&mut self, body: &State) {
        self.moving.clone_from(body);
        let clamped = self.scenario.model.base() == Base::Clamped;
        if !clamped {
            self.moving.base_position_m += body.base_velocity_m_s * NUDGE_S;
            self.moving.base_orientation *= UnitQuaternion::from_scaled_axis(body.base_rate_rad_s * NUDGE_S);
        }
        for (angle, rate) in self.moving.angle_rad.iter_mut().zip(&body.rate_rad_s) {
            *angle += NUDGE_S * rate;
        }
        self.before.clear();
        let bodies = self.dynamics.motions(body);
        for point in &self.points {
            let motion = &bodies[point.body.index()];
            let in_body_m = motion.rotation.tr_mul(&(point.at_m - motion.position_m));
            let velocity = motion.point_velocity_m_s(&in_body_m);
            self.before.push((in_body_m, velocity, motion.rate_rad_s.cross(&velocity)));
        }
        let bodies = self.dynamics.motions(&self.moving);
        for (point, (in_body_m, velocity, across)) in self.points.iter().zip(&self.before) {
            let later = bodies[point.body.index()].point_velocity_m_s(in_body_m);
            let at_constant_rates = (later - velocity) / NUDGE_S;
            let force_n = point.matrix_kg * (at_constant_rates - across);
            self.external.forces.push(Force::at(point.body, point.at_m, force_n));
        }
    }
}
