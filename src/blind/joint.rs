//! Joints and sensors to draw from: small leg joints, hobby servos, quasi-direct drives, and anything between.

use super::dice::{Dice, significant};
use super::sensor::Sensor;
use crate::number::STANDARD_GRAVITY_M_S2;
use serde::Serialize;

/// What kind of joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// A leg joint of a small walking robot.
    Leg,
    /// A hobby servo with a swing arm.
    Servo,
    /// A quasi-direct drive.
    DirectDrive,
    /// Anything between.
    Between,
}

impl Family {
    /// The word in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Family::Leg => "leg",
            Family::Servo => "servo",
            Family::DirectDrive => "direct_drive",
            Family::Between => "between",
        }
    }
}

/// A joint as it truly is, before anything is the matter with it.
#[derive(Clone, Debug)]
pub(super) struct Joint {
    pub family: Family,
    /// `I*` \[kg m^2\]
    pub inertia_kg_m2: f64,
    /// `M*` \[kg m\]
    pub moment_kg_m: f64,
    /// \[N m\]
    pub coulomb_nm: f64,
    /// \[N m s/rad\]
    pub viscous_nm_s_rad: f64,
    pub sensor: Sensor,
    /// \[N m/rad\]
    pub kp: f64,
    /// \[N m s/rad\]
    pub kd: f64,
    /// Setpoints change at most every so many samples.
    pub setpoint_every: usize,
    /// Logs of driven motions have a column `tau`.
    pub tau_column: bool,
}

/// Steps of encoders \[rad\].
const FINEST_RAD: f64 = 3e-4;
const COARSEST_RAD: f64 = 6e-3;

/// Digits of the numbers that an engineer writes into a study.
pub(super) const DIGITS: i32 = 4;

impl Joint {
    /// Largest gravity torque of the bare link \[N m\].
    pub(super) fn peak_gravity_nm(&self) -> f64 {
        STANDARD_GRAVITY_M_S2 * self.moment_kg_m
    }

    /// Draws a joint.
    pub(super) fn draw(dice: &mut Dice) -> Self {
        let family = match dice.uniform(0.0, 1.0) {
            x if x < 0.35 => Family::Leg,
            x if x < 0.70 => Family::Servo,
            x if x < 0.88 => Family::DirectDrive,
            _ => Family::Between,
        };
        // inertia, moment, step and period of each family
        let (inertia, moment, step, periods): ([f64; 2], [f64; 2], f64, &[f64]) = match family {
            Family::Leg => ([6e-4, 1.5e-3], [4e-3, 8e-3], 0.006, &[0.008]),
            Family::Servo => ([0.012, 0.02], [0.07, 0.12], 0.0015, &[0.005]),
            Family::DirectDrive => ([0.08, 0.2], [0.2, 0.5], 0.0004, &[0.002, 0.004]),
            Family::Between => {
                ([1e-3, 0.1], [4e-3, 0.5], dice.log_uniform(0.0004, 0.006), &[0.004, 0.005, 0.008, 0.01])
            }
        };
        let i = dice.log_uniform(inertia[0], inertia[1]);
        // the joint swings at 4.5 to 9 rad/s whatever its size
        let m = loop {
            let m = if family == Family::Between {
                i * dice.uniform(22.0, 75.0) / STANDARD_GRAVITY_M_S2
            } else {
                dice.log_uniform(moment[0], moment[1])
            };
            let w = (STANDARD_GRAVITY_M_S2 * m / i).sqrt();
            if (3.5..10.0).contains(&w) {
                break m;
            }
        };
        // half of the encoders are their family's, the others anything that is built
        let step = if dice.chance(0.5) { step } else { dice.log_uniform(FINEST_RAD, COARSEST_RAD) };
        let peak_nm = STANDARD_GRAVITY_M_S2 * m;
        let kp = peak_nm * dice.uniform(3.0, 12.0);
        let viscous = 2.0 * dice.log_uniform(0.02, 0.5) * (i * peak_nm).sqrt();
        let round = |value| significant(value, DIGITS);
        let period_s = dice.pick(periods);
        Self {
            family,
            inertia_kg_m2: round(i),
            moment_kg_m: round(m),
            coulomb_nm: round(peak_nm * dice.log_uniform(0.02, 0.25)),
            viscous_nm_s_rad: round(viscous),
            sensor: Sensor::draw(round(step), period_s, dice),
            kp: round(kp),
            kd: round(2.0 * dice.uniform(0.2, 1.0) * (kp * i).sqrt()),
            setpoint_every: dice.pick(&[1, 1, 2, 4]),
            tau_column: dice.chance(0.7),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_plausible() {
        let mut dice = Dice::new(7, 0);
        for _ in 0..500 {
            let joint = Joint::draw(&mut dice);
            let peak = joint.peak_gravity_nm();
            assert!((0.0199..0.2501).contains(&(joint.coulomb_nm / peak)), "{joint:?}");
            let zeta = joint.viscous_nm_s_rad / (2.0 * (joint.inertia_kg_m2 * peak).sqrt());
            assert!((0.0199..0.501).contains(&zeta), "{joint:?}");
            assert!((2.99..12.01).contains(&(joint.kp / peak)));
            let sensor = &joint.sensor;
            assert!(sensor.noise_rad() > sensor.resolution_rad / 4.0 && sensor.jitter_s <= 0.2 * sensor.period_s);
            assert!((0.999 * FINEST_RAD..1.001 * COARSEST_RAD).contains(&sensor.resolution_rad));
        }
    }
}
