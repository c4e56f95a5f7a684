//! What a setpoint passes through before it reaches the controller.

use super::Real;

/// When and how often setpoints reach the controller; perfect by default.
#[derive(Clone, Copy, Debug)]
pub struct SetpointPath<T> {
    /// Setpoints and commanded torques act this much later \[s\].
    pub delay_s: Option<T>,
    /// The setpoint is taken over only at multiples of this time from the start of the log, and held in between \[s\].
    pub hold_s: Option<T>,
    /// The servo's own limits of the setpoint's motion.
    pub profile: Option<ProfileLimits<T>>,
}

/// How fast a servo lets its setpoint move.
#[derive(Clone, Copy, Debug)]
pub struct ProfileLimits<T> {
    /// \[rad/s\]
    pub speed_rad_s: T,
    /// \[rad/s^2\]
    pub acceleration_rad_s2: T,
}

impl<T: Real> Default for SetpointPath<T> {
    fn default() -> Self {
        Self { delay_s: None, hold_s: None, profile: None }
    }
}
