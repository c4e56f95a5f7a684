//! The joints of a description as simulators of actuators want them: numbers by joint, with what was found of each.

use super::found::{FoundKey, FoundNumber};
use super::{Actuator, Description};
use crate::robot::tree::Tree;

/// A joint with its servo.
pub(super) struct Actuated<'a> {
    pub name: &'a str,
    /// \[N m/rad\]
    pub kp: f64,
    /// \[N m s/rad\]
    pub kd: f64,
    /// \[kg m^2\]
    pub armature: f64,
    /// \[N m\]
    pub coulomb: f64,
    /// \[N m\], not below Coulomb's.
    pub static_friction: f64,
    /// \[N m s/rad\]
    pub viscous: f64,
    /// \[N m\]
    pub effort: Option<f64>,
    /// \[rad/s\]
    pub velocity: Option<f64>,
    /// \[s\]
    pub delay_s: f64,
    /// The encoder reads so much less than the angle \[rad\].
    pub zero_rad: f64,
    found: Vec<&'a FoundNumber>,
}

impl Actuated<'_> {
    /// What was found of a number, as a comment with two blanks before it; empty where it is as described.
    pub fn mark(&self, keys: &[FoundKey]) -> String {
        let found = self.found.iter().filter(|number| keys.contains(&number.key));
        let words: Vec<String> = found.map(|number| number.words()).collect();
        if words.is_empty() { String::new() } else { format!("  # aibo-fit: {}", words.join("; ")) }
    }
}

/// The joints that a servo drives.
///
/// # Errors
/// Why there are none, or no tree, in words.
pub(super) fn actuated<'a>(
    description: &'a Description,
    found: &'a [FoundNumber],
) -> Result<Vec<Actuated<'a>>, String> {
    let tree = Tree::new(description, Tree::base_of(description)).map_err(|error| error.to_string())?;
    let servos = tree.servos(description);
    let servos: Vec<Actuator> = servos.iter().filter_map(Actuator::as_servo).collect();
    if servos.is_empty() {
        return Err("no joint has a position servo: neither the description nor the study states its gain".to_owned());
    }
    let of = |servo: &Actuator| {
        let mover = &description.joints[servo.joint.0];
        let found: Vec<&FoundNumber> =
            found.iter().filter(|number| number.key.is_of_joint() && number.name == mover.name).collect();
        let value = |key: FoundKey| found.iter().find(|number| number.key == key).map(|number| number.value);
        let of_servo = servo.force_range_nm.map(|[_, high]| high);
        Actuated {
            name: &mover.name,
            kp: servo.gain,
            kd: -servo.bias[2],
            armature: mover.armature_kg_m2,
            coulomb: mover.friction_nm,
            static_friction: value(FoundKey::StaticFriction).unwrap_or(0.0).max(mover.friction_nm),
            viscous: mover.damping[0],
            effort: of_servo.or(mover.actuator_range_nm.map(|[_, high]| high)).or(mover.effort_nm),
            velocity: mover.rate_limit_rad_s,
            delay_s: value(FoundKey::Delay).unwrap_or(0.0),
            zero_rad: value(FoundKey::EncoderZero).unwrap_or(0.0),
            found,
        }
    };
    Ok(servos.iter().map(of).collect())
}
