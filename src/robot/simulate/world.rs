//! The equations of motion with what the surroundings add.

use super::{External, JointDrive, Scenario};
use crate::geometry::robot_file::Base;
use crate::robot::{Dynamics, Force, State};
use nalgebra::Vector3;

/// Working memory for one scenario.
pub(super) struct World<'a> {
    scenario: Scenario<'a>,
    pub dynamics: Dynamics<'a>,
    pub external: External,
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
            gravity_nm: vec![0.0; scenario.model.joints().len()],
            needs_gravity: scenario.joints.drives().iter().any(JointDrive::has_friction_terms),
            moving: scenario.start.clone(),
        }
    }

    /// Forces, contacts and loads at a state.
    pub(super) fn surround(&mut self, t_s: f64, body: &State) {
        self.external.clear();
        if self.needs_gravity {
            self.dynamics.gravity_nm(body, &mut self.gravity_nm);
        }
        let Some(surroundings) = self.scenario.surroundings else { return };
        surroundings.act(t_s, self.dynamics.motions(body), &mut self.external);
    }

    /// Makes the contacts at the second stage's state those of its right-hand side, `first` being `k_v1`.
    ///
    /// Forward dynamics subtracts `g h K u` with the velocity u that a contact has; the stage wants
    /// `g h K (v + h k_v1 - 2 k_q1)`, which is `u = 2 (1 - g) h J k_v1 - J (v + h k_v1)`. And what the contact's inertia
    /// `D = g h (C + g h K)` does with the first acceleration is added twice.
    pub(super) fn second_stage(&mut self, body: &State, h: f64, gh: f64, first: &[f64]) {
        if self.external.contacts.is_empty() {
            return;
        }
        // The points' accelerations, read as the velocities of a robot that moves so.
        let base = self.scenario.model.base() == Base::Floating;
        let triple = |i: usize| if base { Vector3::from_column_slice(&first[i..i + 3]) } else { Vector3::zeros() };
        self.moving.clone_from(body);
        (self.moving.base_velocity_m_s, self.moving.base_rate_rad_s) = (triple(0), triple(3));
        self.moving.rate_rad_s.copy_from_slice(&first[6..]);
        let bodies = self.dynamics.motions(&self.moving);
        let External { forces, contacts } = &mut self.external;
        for contact in contacts {
            let motion = &bodies[contact.body.index()];
            let (turning, arm) = (motion.rate_rad_s, contact.at_m - motion.position_m);
            let speed = motion.velocity_m_s + turning.cross(&arm);
            contact.velocity_m_s = speed * (2.0 * (h - gh)) - contact.velocity_m_s;
            forces.push(Force {
                body: contact.body,
                at_m: contact.at_m,
                force_n: contact.over_a_step_n_s_m(gh) * speed * (2.0 * gh),
                moment_nm: contact.spin_damping_nm_s_rad * turning * (2.0 * gh),
            });
        }
    }
}
