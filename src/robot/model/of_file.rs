//! What a robot's file says beyond bodies and joints: effects of the catalogue, and the floor that goes with it.

use super::{JointId, Model};
use crate::joint::{EffectId, UnknownEffect};
use crate::log::FloorSpec;
use crate::robot::RobotError;

impl Model {
    /// Effects of the robot's file, in its order: which, on which joint, its values in the catalogue's order.
    ///
    /// # Errors
    /// [`RobotError::Effect`] for an id or a parameter that the catalogue does not have, or one that is missing.
    pub fn effects(&self) -> Result<Vec<(EffectId, JointId, Vec<f64>)>, RobotError> {
        let mut effects = Vec::new();
        for (k, of) in self.tables.effects.iter().enumerate() {
            let refuse = |what: String| RobotError::Effect { robot: self.name().to_owned(), place: k + 1, what };
            let effect: EffectId = of.id.parse().map_err(|error: UnknownEffect| refuse(error.to_string()))?;
            let named = effect.named_parameters();
            let names: Vec<&str> = named.iter().map(|parameter| parameter.name).collect();
            if let Some((other, _)) = of.parameters.iter().find(|(name, _)| !names.contains(&name.as_str())) {
                return Err(refuse(format!("parameters.{other}: {effect} has {}", names.join(", "))));
            }
            let value = |name: &&str| {
                let given = of.parameters.iter().find(|(other, _)| other == name).map(|(_, value)| *value);
                given.ok_or_else(|| refuse(format!("parameters.{name} is missing: {effect} has {}", names.join(", "))))
            };
            let values: Vec<f64> = names.iter().map(value).collect::<Result<_, _>>()?;
            for (id, joint) in self.joint_ids().zip(self.joints()) {
                if of.joints.iter().any(|name| *name == joint.name || *name == joint.kind) {
                    effects.push((effect, id, values.clone()));
                }
            }
        }
        Ok(effects)
    }

    /// The floor of the robot's file, and how it rises towards the front and the right \[rad\].
    pub fn floor(&self) -> (Option<&FloorSpec>, [f64; 2]) {
        (self.tables.floor.as_ref(), self.tables.floor_slope_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::robot_file::ERS7_TOML;
    use crate::robot::simulate::Joints;
    use crate::robot::study::floor_on;
    use std::path::Path;

    const MORE: &str = r#"
[[effect]]
id = "delay"
joints = ["q3"]
parameters = { T = 0.02 }
[[attached]]
part = "trunk"
mass_kg = 0.3
at_m = [0.0, 0.02, -0.05]
[floor]
coulomb = 0.4
[gains.printed.si]
lf1 = [6.0, 0.0, 0.4]
"#;

    fn with(more: &str) -> Result<Model, RobotError> {
        let sloped = ERS7_TOML.replacen("root = ", "floor_slope_rad = [0.1, 0.0]\nroot = ", 1);
        Model::from_toml(Path::new("mine.toml"), &(sloped + more))
    }

    #[test]
    fn effects_masses_floor_and_gains_of_a_file_are_the_robot_s() {
        let (robot, ers7) = (with(MORE).unwrap(), Model::ers7());
        assert!((robot.total_mass_kg() - ers7.total_mass_kg() - 0.3).abs() < 1e-12);
        let id = |name: &str| robot.joint(name).unwrap();
        let effects = robot.effects().unwrap();
        assert_eq!(effects.len(), 4);
        assert!(effects.contains(&(EffectId::Delay, id("rr3"), vec![0.02])));
        assert_eq!(robot.gains("printed", id("lf1")).unwrap().kp_nm_rad, 6.0);
        assert_eq!(robot.gains("printed", id("rf1")), ers7.gains("printed", id("rf1")));
        let floor = floor_on(&robot, &FloorSpec::default());
        assert_eq!((floor.coulomb, floor.static_friction), (0.4, 0.7));
        assert!((floor.normal.z - 0.1_f64.tan()).abs() < 1e-12);
        // What a study states comes first.
        assert_eq!(floor_on(&robot, &FloorSpec { coulomb: Some(0.5), ..FloorSpec::default() }).coulomb, 0.5);
        assert!(Joints::of_thesis(&robot).is_ok());
    }

    #[test]
    fn an_effect_that_cannot_be_is_named() {
        let said = |from: &str, to: &str| with(&MORE.replace(from, to)).unwrap_err().to_string();
        assert!(said("delay", "gremlin").contains("[[effect]] 1: `gremlin` is not an effect"));
        assert!(said("T =", "tau =").contains("parameters.tau: delay has T"));
        assert!(said("{ T = 0.02 }", "{}").contains("parameters.T is missing"));
    }
}
