//! Quadrupeds of another size than the ERS-7, with its proportions.

use crate::blind::dice::{Dice, significant};
use crate::geometry::robot_file::{ERS7_TOML, GAIN_SET};
use crate::robot::Model;
use std::collections::BTreeMap;
use toml::Value;

/// File of the robot.
pub(super) const FILE: &str = "robot.toml";
/// Lengths and densities in units of the ERS-7's.
const LENGTH: [f64; 2] = [0.7, 1.6];
const DENSITY: [f64; 2] = [0.7, 1.5];

/// How large a quadruped is, in units of the ERS-7.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    length: f64,
    density: f64,
}

impl Size {
    pub fn draw(dice: &mut Dice) -> Self {
        let mut within = |[low, high]: [f64; 2]| significant(dice.log_uniform(low, high), 3);
        Self { length: within(LENGTH), density: within(DENSITY) }
    }

    pub fn mass(self) -> f64 {
        self.density * self.length.powi(3)
    }

    /// Torques of gravity, and with them friction and gains.
    pub fn torque(self) -> f64 {
        self.mass() * self.length
    }

    /// `quadruped of 1.35 times the ERS-7's length and 2.9 times its mass`
    pub fn words(self) -> String {
        format!("quadruped of {} times the ERS-7's length and {:.2} times its mass", self.length, self.mass())
    }

    /// The robot's file: the ERS-7's with every length, mass, inertia, spring and friction of another size.
    pub fn robot(self) -> String {
        let mut robot: toml::Table = toml::from_str(ERS7_TOML).expect("the embedded robot is TOML");
        robot.insert("name".to_owned(), "quadruped".into());
        for (key, value) in &mut robot {
            self.scale(key, value);
        }
        toml::to_string(&robot).expect("a table of TOML values is TOML")
    }

    /// Gains P, I and D of its joints, which no longer are integers.
    pub fn gains(self) -> BTreeMap<String, [f64; 3]> {
        let model = Model::ers7();
        let of = |(id, joint): (_, &crate::geometry::Joint)| {
            let gains = model.gains(GAIN_SET, id)?;
            let own = [gains.kp_nm_rad, gains.ki_nm_rad_s, gains.kd_nm_s_rad];
            Some((joint.name.clone(), own.map(|gain| significant(self.torque() * gain, 3))))
        };
        model.joint_ids().zip(model.joints()).filter_map(of).collect()
    }

    fn scale(self, key: &str, value: &mut Value) {
        let factor = match key {
            "diameter_m" | "parent_mm" | "child_mm" | "contact_mm" => Some(self.length),
            "mass_kg" => Some(self.mass()),
            "inertia_kg_m2" => Some(self.mass() * self.length * self.length),
            "stiffness_nm_rad" | "damping_nm_s_rad" | "coulomb_nm" | "viscous_nm_s_rad" | "static_nm" => {
                Some(self.torque())
            }
            _ => None,
        };
        match (factor, value) {
            (Some(factor), value) => times(factor, value),
            (None, Value::Table(table)) => table.iter_mut().for_each(|(key, value)| self.scale(key, value)),
            (None, Value::Array(list)) => list.iter_mut().for_each(|value| self.scale("", value)),
            _ => {}
        }
    }
}

fn times(factor: f64, value: &mut Value) {
    match value {
        Value::Float(number) => *number *= factor,
        Value::Integer(number) => *value = Value::Float(factor * *number as f64),
        Value::Array(list) => list.iter_mut().for_each(|value| times(factor, value)),
        Value::Table(table) => table.iter_mut().for_each(|(_, value)| times(factor, value)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn another_size_is_a_robot_of_that_mass_and_length() {
        let size = Size { length: 1.5, density: 0.8 };
        let (large, own) = (Model::from_toml(Path::new(FILE), &size.robot()).unwrap(), Model::ers7());
        let mass = |model: &Model| model.bodies().iter().map(|body| body.mass_kg).sum::<f64>();
        approx::assert_relative_eq!(mass(&large) / mass(own), 0.8 * 1.5_f64.powi(3), max_relative = 1e-9);
        let radius = |model: &Model| model.bodies()[0].radii_m.x;
        approx::assert_relative_eq!(radius(&large) / radius(own), 1.5, max_relative = 1e-9);
        assert_eq!(large.joints().len(), own.joints().len());
    }
}
