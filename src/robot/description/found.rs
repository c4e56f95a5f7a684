//! Numbers of a description that logs put elsewhere, as plain data: what `export` writes, and what a whole robot is
//! simulated with.

use super::{Actuator, ActuatorKind, BodyChange, Description, MoverId};
use crate::robot::tree::Tree;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What a changed number is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FoundKey {
    /// Coulomb friction of a joint \[N m\].
    Frictionloss,
    /// Viscous friction of a joint \[N m s/rad\].
    Damping,
    /// Inertia that is added about a joint's axis \[kg m^2\].
    Armature,
    /// Gain of a joint's servo \[N m/rad\].
    Kp,
    /// Damping of a joint's servo \[N m s/rad\].
    Kd,
    /// What its motor's torque saturates at \[N m\].
    TorqueLimit,
    /// Stiffness of a joint's spring \[N m/rad\], and where it is slack \[rad\].
    Stiffness,
    /// See [`FoundKey::Stiffness`].
    Springref,
    /// Static friction of a joint \[N m\]; no word of a description.
    StaticFriction,
    /// Its setpoints are late \[s\]; no word of a description.
    Delay,
    /// Its encoder reads so much less than the angle \[rad\]; no word of a description.
    EncoderZero,
    /// Mass of a link \[kg\], its shape as described.
    Mass,
    /// Centre of mass in a link's frame \[m\].
    Centre,
    /// A small mass \[kg\] at a place in a link's frame \[m\].
    Payload,
}

impl FoundKey {
    /// The word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frictionloss => "frictionloss",
            Self::Damping => "damping",
            Self::Armature => "armature",
            Self::Kp => "kp",
            Self::Kd => "kd",
            Self::TorqueLimit => "torque_limit",
            Self::Stiffness => "stiffness",
            Self::Springref => "springref",
            Self::StaticFriction => "static_friction",
            Self::Delay => "delay",
            Self::EncoderZero => "encoder_zero",
            Self::Mass => "mass",
            Self::Centre => "centre",
            Self::Payload => "payload",
        }
    }

    /// Whether descriptions have a word for it: URDF and MJCF have none for some.
    pub fn is_described(self) -> bool {
        !matches!(self, Self::StaticFriction | Self::Delay | Self::EncoderZero)
    }

    /// Whether it is of a joint, not of a link.
    pub fn is_of_joint(self) -> bool {
        !matches!(self, Self::Mass | Self::Centre | Self::Payload)
    }
}

/// A number that logs put elsewhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoundNumber {
    /// The joint, or the link.
    pub name: String,
    /// What of it.
    pub key: FoundKey,
    /// What study or description had; `None`: nothing.
    pub was: Option<f64>,
    /// What was found, or what the study has beyond the description.
    pub value: f64,
    /// 95 %, where it was fitted.
    pub interval: Option<[f64; 2]>,
    /// Its unit.
    pub unit: String,
    /// Of a centre or payload \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place_m: Option<[f64; 3]>,
}

impl FoundNumber {
    /// Whether its interval leaves out what study or description had, or it has none.
    pub(crate) fn is_other(&self) -> bool {
        !self.interval.zip(self.was).is_some_and(|([low, high], was)| (low..=high).contains(&was))
    }

    /// `frictionloss 0.19 [0.17, 0.21] N m, was 0.052`
    pub fn words(&self) -> String {
        let place = self.place_m.map(|place| {
            let [x, y, z] = place.map(|metres| crate::number::significant(metres, 3));
            format!("({x}, {y}, {z}) m")
        });
        if let (FoundKey::Centre, Some(place)) = (self.key, &place) {
            return format!("{} at {place}", self.key.name());
        }
        let value = crate::number::quantity(self.value, self.interval, &self.unit);
        let value = place.map_or(value.clone(), |place| format!("{value} at {place}"));
        let was = self
            .was
            .map_or_else(|| ", not described".to_owned(), |was| format!(", was {}", crate::number::as_given(was)));
        format!("{} {value}{was}", self.key.name())
    }
}

/// A name that the description does not have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the description has no {what} `{name}`")]
pub struct NoSuchPart {
    /// `joint` or `link`.
    pub what: &'static str,
    /// As given.
    pub name: String,
}

impl Description {
    /// The same robot with numbers as found; servos whose damping is a share of the critical one keep what it comes to as
    /// described, whatever masses were found.
    ///
    /// # Errors
    /// [`NoSuchPart`] where a joint or link is not its.
    pub fn with_found(&self, found: &[FoundNumber]) -> Result<Self, NoSuchPart> {
        let mut changed = self.with_damped_servos();
        for number in found {
            if number.key.is_of_joint() {
                let none = || NoSuchPart { what: "joint", name: number.name.clone() };
                let at = changed.joint(&number.name).ok_or_else(none)?;
                changed.set_joint(at, number);
            } else {
                let none = || NoSuchPart { what: "link", name: number.name.clone() };
                let link = changed.link(&number.name).ok_or_else(none)?;
                let place_m = Vector3::from(number.place_m.unwrap_or_default());
                let inertia = &changed.links[link.0].inertia;
                let change = match number.key {
                    FoundKey::Payload => BodyChange::Payload { mass_kg: number.value, place_m },
                    FoundKey::Mass if inertia.mass_kg > 0.0 => {
                        BodyChange::Mass { factor: number.value / inertia.mass_kg }
                    }
                    _ => BodyChange::Centre { shift_m: place_m - inertia.centre_m() },
                };
                changed = changed.with_change(link, &change);
            }
        }
        Ok(changed)
    }

    fn set_joint(&mut self, at: MoverId, number: &FoundNumber) {
        let value = number.value;
        let joint = &mut self.joints[at.0];
        match number.key {
            FoundKey::Frictionloss => joint.friction_nm = value,
            FoundKey::Damping => joint.damping[0] = value,
            FoundKey::Armature => joint.armature_kg_m2 = value,
            FoundKey::Stiffness => joint.stiffness[0] = value,
            FoundKey::Springref => joint.spring_rest_rad = value,
            FoundKey::Kp => {
                let servo = self.servo(at);
                (servo.gain, servo.bias[1]) = (value, -value);
            }
            FoundKey::Kd => {
                let servo = self.servo(at);
                (servo.bias[2], servo.damping_ratio) = (-value, None);
            }
            FoundKey::TorqueLimit => self.servo(at).force_range_nm = Some([-value, value]),
            FoundKey::StaticFriction | FoundKey::Delay | FoundKey::EncoderZero => {}
            FoundKey::Mass | FoundKey::Centre | FoundKey::Payload => {}
        }
    }

    /// The same with damping ratios resolved where the masses allow it.
    fn with_damped_servos(&self) -> Self {
        let has_ratio = self.actuators.iter().any(|servo| servo.damping_ratio.is_some());
        let tree = has_ratio.then(|| Tree::new(self, Tree::base_of(self)).ok()).flatten();
        let actuators = tree.map_or_else(|| self.actuators.clone(), |tree| tree.servos(self));
        Self { actuators, ..self.clone() }
    }

    /// The servo of a joint, behind no gear as numbers of studies are; where the file has none, one of its own in the place of
    /// what drives the joint, and not stronger.
    fn servo(&mut self, at: MoverId) -> &mut Actuator {
        let its =
            |(place, driver): (usize, &Actuator)| Some((place, driver.as_servo().filter(|_| driver.joint == at)?));
        let place = match self.actuators.iter().enumerate().find_map(its) {
            Some((place, servo)) => {
                self.actuators[place] = servo;
                place
            }
            None => {
                let servo = self.new_servo(at);
                self.actuators.retain(|other| other.joint != at);
                self.actuators.push(servo);
                self.actuators.len() - 1
            }
        };
        &mut self.actuators[place]
    }

    fn new_servo(&self, at: MoverId) -> Actuator {
        let driver = self.actuators.iter().find(|driver| driver.joint == at);
        Actuator {
            name: driver.map_or_else(|| self.joints[at.0].name.clone(), |driver| driver.name.clone()),
            kind: ActuatorKind::Position,
            joint: at,
            gear: 1.0,
            gain: 0.0,
            bias: [0.0; 3],
            damping_ratio: None,
            control_range: None,
            force_range_nm: driver.and_then(Actuator::torque_range_nm),
            activation: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::to_mjcf;
    use super::*;

    fn described(actuators: &str) -> Description {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("arm.xml");
        let text = format!(
            r#"<mujoco><compiler angle="radian"/><worldbody><body name="a"><joint name="j" axis="0 1 0"/>
            <geom size=".1" pos="0 0 -.3" mass="1"/></body></worldbody><actuator>{actuators}</actuator></mujoco>"#
        );
        std::fs::write(&file, text).unwrap();
        Description::read(&file).unwrap()
    }

    fn number(name: &str, key: FoundKey, value: f64) -> FoundNumber {
        let (was, interval, unit) = (None, None, String::new());
        FoundNumber { name: name.to_owned(), key, was, value, interval, unit, place_m: Some([0.0, 0.0, -0.3]) }
    }

    fn exported(actuators: &str, found: &[FoundNumber]) -> String {
        let text = to_mjcf(&described(actuators).with_found(found).unwrap(), &[]);
        let from = text.find("<actuator>").unwrap();
        text[from + "<actuator>".len()..].lines().map(str::trim).find(|line| !line.is_empty()).unwrap().to_owned()
    }

    #[test]
    fn a_found_gain_keeps_damping_and_ranges_of_what_drives_the_joint() {
        let kp = [number("j", FoundKey::Kp, 20.0)];
        let general = r#"<general name="m" joint="j" biastype="affine" gainprm="16" biasprm="0 -16 -3" ctrlrange="-1 2" forcerange="-4 4"/>"#;
        let servo = |ranges: &str| format!(r#"<position name="m" joint="j" {ranges} kp="20" kv="3"/>"#);
        assert_eq!(exported(general, &kp), servo(r#"ctrlrange="-1 2" forcerange="-4 4""#));
        // Controls in other units become positions.
        let scaled = general.replace("gainprm=\"16\"", "gainprm=\"8\"").replace("biasprm=\"0", "biasprm=\"8");
        assert_eq!(exported(&scaled, &kp), servo(r#"ctrlrange="0 1.5" forcerange="-4 4""#));
        let geared = r#"<position name="m" joint="j" gear="-2" kp="1" kv=".75" ctrlrange="-1 2" forcerange="-4 5"/>"#;
        assert_eq!(exported(geared, &kp), servo(r#"ctrlrange="-1 0.5" forcerange="-10 8""#));
        let motor = r#"<motor name="m" joint="j" gear="2" ctrlrange="-3 3" forcerange="-4 2"/>"#;
        let bare = r#"<position name="m" joint="j" forcerange="-6 4" kp="20" kv="0"/>"#;
        assert_eq!(exported(motor, &kp), bare);
    }

    #[test]
    fn a_payload_does_not_change_the_damping_of_a_servo() {
        let ratio = r#"<position joint="j" kp="16" dampratio="1"/>"#;
        // 2 sqrt(kp m) of the ball as described: 0.094 kg m^2.
        let line = exported(ratio, &[number("a", FoundKey::Payload, 0.5)]);
        assert!(line.contains("kv=\"2.4527"), "{line}");
    }
}
