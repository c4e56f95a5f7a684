//! Evaluations: forward and inverse dynamics, mass matrix, motion of the bodies, energies.

mod articulated;
mod base;
mod composite;
mod energy;
mod forces;
mod gravity;
mod implicit;
mod lanes;
mod layout;
mod motion;
mod newton_euler;
mod slot;
#[cfg(test)]
mod tests;

pub use energy::{Energy, Momentum};
pub use forces::Force;
pub use implicit::ContactDamping;
pub use lanes::LanesDynamics;
pub use motion::BodyMotion;

use super::model::BASE_FREEDOMS;
use super::{Model, State};
use motion::Motions;
use slot::Slot;

/// What acts on the robot, besides gravity.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Torques on the joints \[N m\], one for each.
    pub torque_nm: &'a [f64],
    /// Added to the inertia about each joint's axis \[kg m^2\]: the rotor of a geared motor, or `h B` of a stiff
    /// damper that an implicit step of length h takes along, `(M + h B) dv/dt`. Empty: nothing.
    pub diagonal_kg_m2: &'a [f64],
    /// Forces on bodies.
    pub forces: &'a [Force],
}

impl<'a> Input<'a> {
    /// Torques only.
    pub fn torques(torque_nm: &'a [f64]) -> Self {
        Self { torque_nm, diagonal_kg_m2: &[], forces: &[] }
    }
}

/// Working memory for evaluations of one model; no evaluation allocates.
///
/// ```
/// use aibo_fit::robot::{Dynamics, Input, Model, State};
/// let robot = Model::ers7();
/// let state = State::at_rest(robot);
/// let mut acceleration = [0.0; 28];
/// Dynamics::new(robot).forward(&state, &Input::torques(&[0.0; 22]), &mut acceleration);
/// assert!((acceleration[1] + 9.81).abs() < 1e-12); // free fall
/// ```
#[derive(Clone, Debug)]
pub struct Dynamics<'m> {
    model: &'m Model,
    /// One for each group: two bodies of one robot.
    slots: Vec<Slot>,
    motions: Motions,
    composites: Vec<composite::Composite>,
    loads: Vec<newton_euler::Load>,
}

impl<'m> Dynamics<'m> {
    /// Memory for a model.
    pub fn new(model: &'m Model) -> Self {
        let bodies = model.bodies().len();
        Self {
            model,
            slots: vec![Slot::new(); model.plan().groups.len()],
            motions: Motions::new(bodies),
            composites: vec![composite::Composite::default(); bodies],
            loads: vec![newton_euler::Load::default(); bodies],
        }
    }

    /// The model.
    pub fn model(&self) -> &'m Model {
        self.model
    }

    /// Length of generalised velocities and accelerations: 6 + joints.
    pub fn freedoms(&self) -> usize {
        BASE_FREEDOMS + self.model.joints().len()
    }

    /// A slice of the caller's has to have the right length.
    fn check(&self, what: &str, found: usize, expected: usize) {
        assert!(found == expected, "{what}: {found} numbers for {}, expected {expected}", self.model.name());
    }

    fn check_state(&self, state: &State) {
        let joints = self.model.joints().len();
        self.check("angles", state.angle_rad.len(), joints);
        self.check("rates", state.rate_rad_s.len(), joints);
    }

    fn check_input(&self, input: &Input<'_>) {
        let joints = self.model.joints().len();
        self.check("torques", input.torque_nm.len(), joints);
        if !input.diagonal_kg_m2.is_empty() {
            self.check("diagonal terms", input.diagonal_kg_m2.len(), joints);
        }
    }
}
