//! What a setpoint passes through before it reaches the controller.

use super::Real;

/// When and how often setpoints reach the controller; perfect by default.
#[derive(Clone, Copy, Debug)]
pub struct SetpointPath<T> {
    /// Setpoints and commanded torques act this much later \[s\].
    pub delay_s: Option<T>,
    /// The setpoint is taken over only at multiples of this time from the start of the log, and held in between \[s\].
    pub hold_s: Option<T>,
}

impl<T: Real> Default for SetpointPath<T> {
    fn default() -> Self {
        Self { delay_s: None, hold_s: None }
    }
}

/// Free play between motor side and link, with stiff inelastic flanks.
#[derive(Clone, Copy, Debug)]
pub struct Play<T> {
    /// Total width \[rad\].
    pub width_rad: T,
    /// Inertia on the motor side of the play \[kg m^2\].
    pub motor_side_kg_m2: T,
}
