//! Where the robot is and how it moves.

use super::Model;
use nalgebra::{UnitQuaternion, Vector3};

/// Configuration and velocity: everything that an integrator carries along.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Place of the base's centre in the world \[m\].
    pub base_position_m: Vector3<f64>,
    /// Orientation of the base, body to world.
    pub base_orientation: UnitQuaternion<f64>,
    /// Velocity of the base's centre, world axes \[m/s\]; zero where the base is clamped.
    pub base_velocity_m_s: Vector3<f64>,
    /// Angular velocity of the base, **body** axes \[rad/s\]; zero where the base is clamped.
    pub base_rate_rad_s: Vector3<f64>,
    /// Joint angles \[rad\].
    pub angle_rad: Vec<f64>,
    /// Joint rates \[rad/s\].
    pub rate_rad_s: Vec<f64>,
}

impl State {
    /// At rest at the world's origin, every joint at angle 0.
    pub fn at_rest(model: &Model) -> Self {
        let n = model.joints().len();
        Self {
            base_position_m: Vector3::zeros(),
            base_orientation: UnitQuaternion::identity(),
            base_velocity_m_s: Vector3::zeros(),
            base_rate_rad_s: Vector3::zeros(),
            angle_rad: vec![0.0; n],
            rate_rad_s: vec![0.0; n],
        }
    }

    /// The generalised velocity `v`, 6 + n numbers.
    pub fn velocity(&self) -> impl Iterator<Item = f64> + '_ {
        let base = self.base_velocity_m_s.iter().chain(self.base_rate_rad_s.iter());
        base.chain(&self.rate_rad_s).copied()
    }
}
