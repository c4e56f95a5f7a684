//! The equations of motion with what the surroundings add.

use super::{External, JointDrive, Scenario};
use crate::geometry::robot_file::Base;
use crate::robot::{Dynamics, Force, PointInertia, State};
use nalgebra::Vector3;

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
}

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
        let Some(k) = first.filter(|_| !self.points.is_empty()) else { return };
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
}
