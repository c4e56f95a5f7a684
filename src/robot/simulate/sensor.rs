//! What the robot's sensors make of its motion (Table B.1, section B.1).

use crate::joint::Encoder;
use crate::number::math;
use crate::robot::Model;
use nalgebra::Vector3;
use rand::Rng;

/// A joint's position sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PositionSensor {
    /// Reads the angle itself.
    Ideal,
    /// Uniform noise of half a step either way, then rounded: as the reference swings were read.
    Centred(Encoder),
    /// Normal noise, then rounded: what a study's `[sensor]` states.
    Normal {
        /// Step \[rad\]; 0: continuous.
        step_rad: f64,
        /// Standard deviation before rounding \[rad\].
        sigma_rad: f64,
    },
    /// Never below the angle, as section B.1 saw it: noise of up to one step upwards, then rounded up.
    Upward {
        /// Step \[rad\].
        step_rad: f64,
        /// Width within which all readings of one angle lie \[rad\].
        variation_rad: f64,
    },
}

impl PositionSensor {
    /// The sensor of a robot's file, read as section B.1 saw it; ideal where the file has none.
    pub fn of(model: &Model) -> Self {
        model.encoder().map_or(Self::Ideal, |encoder| Self::Upward {
            step_rad: encoder.resolution_rad,
            variation_rad: encoder.variation_rad,
        })
    }

    /// A reading \[rad\].
    pub fn read(&self, angle_rad: f64, rng: &mut impl Rng) -> f64 {
        match *self {
            Self::Ideal => angle_rad,
            Self::Centred(encoder) => encoder.read(angle_rad, rng),
            Self::Normal { step_rad, sigma_rad } => {
                let noisy = angle_rad + if sigma_rad > 0.0 { sigma_rad * standard_normal(rng) } else { 0.0 };
                if step_rad > 0.0 { (noisy / step_rad).round() * step_rad } else { noisy }
            }
            Self::Upward { step_rad, variation_rad } => {
                let noise = (variation_rad - step_rad).max(0.0) * rng.random::<f64>();
                if step_rad > 0.0 { ((angle_rad + noise) / step_rad).ceil() * step_rad } else { angle_rad + noise }
            }
        }
    }
}

/// A draw of the standard normal distribution (Box and Muller 1958).
pub(crate) fn standard_normal(rng: &mut impl Rng) -> f64 {
    let (u, v) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
    (-2.0 * math::ln(u)).sqrt() * math::cos(std::f64::consts::TAU * v)
}

/// The accelerometers: what the base feels, cut off at their range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerometer {
    /// Least and greatest reading \[m/s^2\].
    pub range_m_s2: [f64; 2],
}

impl Default for Accelerometer {
    /// Table B.1: 2 g either way.
    fn default() -> Self {
        Self { range_m_s2: [-19.6133, 19.6133] }
    }
}

impl Accelerometer {
    /// Readings along the base's axes x (right), y (up), z (rear) \[m/s^2\].
    pub fn read(&self, felt_m_s2: &Vector3<f64>) -> Vector3<f64> {
        let [low, high] = self.range_m_s2;
        felt_m_s2.map(|a| a.clamp(low, high))
    }
}
