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
