//! The equations of motion with what the surroundings add.

use super::{External, JointDrive, Scenario};
use crate::robot::{Dynamics, Force, Resting, State};

/// What is around the robot at one state.
pub(super) struct Around {
    pub external: External,
    /// Gravity's load on each joint \[N m\], where a friction effect asks for it.
    pub gravity_nm: Vec<f64>,
}

impl Around {
    pub(super) fn new(scenario: &Scenario<'_>) -> Self {
        Self { external: External::default(), gravity_nm: vec![0.0; scenario.model.joints().len()] }
    }
}

/// Working memory for one scenario.
pub(super) struct World<'a> {
    scenario: Scenario<'a>,
    pub dynamics: Dynamics<'a>,
    needs_gravity: bool,
    resting: Resting,
    /// Joints whose bodies the surroundings look at, with all that carry them.
    followed: Vec<usize>,
}

impl<'a> World<'a> {
    pub(super) fn new(scenario: &Scenario<'a>) -> Self {
        Self {
            scenario: *scenario,
            dynamics: Dynamics::new(scenario.model),
            resting: Resting::of(scenario.surroundings.map_or(0, |surroundings| surroundings.points())),
            followed: followed(scenario),
            needs_gravity: scenario.joints.drives().iter().any(JointDrive::has_friction_terms),
        }
    }

    /// Forces, contacts and loads at a state.
    pub(super) fn surround(&mut self, t_s: f64, body: &State, around: &mut Around) {
        self.gather(t_s, body, around, false);
    }

    /// The same; at the begin of a step it takes notice of what rests.
    pub(super) fn gather(&mut self, t_s: f64, body: &State, around: &mut Around, is_first: bool) {
        around.external.clear();
        if self.needs_gravity {
            self.dynamics.gravity_nm(body, &mut around.gravity_nm);
        }
        let Some(surroundings) = self.scenario.surroundings else { return };
        let motions = self.dynamics.motions_of(body, &self.followed);
        if is_first {
            surroundings.notice(t_s, motions, &mut self.resting);
        }
        surroundings.act_resting(t_s, motions, &self.resting, &mut around.external);
    }

    /// Makes the contacts at the second stage's state, which the latest call has surrounded, those of its right-hand
    /// side; `first` is `k_v1`.
    ///
    /// Forward dynamics subtracts `g h K u` with the velocity u that a contact has; the stage wants
    /// `g h K (v + h k_v1 - 2 k_q1)`, which is `u = 2 (1 - g) h J k_v1 - J (v + h k_v1)`. And what the contact's inertia
    /// `D = g h (C + g h K)` does with the first acceleration is added twice.
    pub(super) fn second_stage(&self, h: f64, gh: f64, first: &[f64], around: &mut Around) {
        let External { forces, contacts } = &mut around.external;
        for contact in contacts {
            let (speed, turning) = self.dynamics.point_velocity(contact.body, &contact.at_m, first);
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

/// Joints that move what the surroundings look at.
fn followed(scenario: &Scenario<'_>) -> Vec<usize> {
    let model = scenario.model;
    let joints = 0..model.joints().len();
    let Some(bodies) = scenario.surroundings.map(|surroundings| surroundings.looks_at()) else { return Vec::new() };
    let Some(bodies) = bodies else { return joints.collect() };
    let mut moves = vec![false; model.joints().len()];
    for body in bodies {
        let mut next = body.joint();
        while let Some(joint) = next {
            moves[joint.index()] = true;
            next = model.carrier(joint).joint();
        }
    }
    joints.filter(|joint| moves[*joint]).collect()
}
