//! Numbers of a description that logs put elsewhere, as plain data: what `export` writes, and what a whole robot is
//! simulated with.

use super::{Actuator, ActuatorKind, BodyChange, Description, MoverId};
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
    /// The same robot with numbers as found.
    ///
    /// # Errors
    /// [`NoSuchPart`] where a joint or link is not its.
    pub fn with_found(&self, found: &[FoundNumber]) -> Result<Self, NoSuchPart> {
        let mut changed = self.clone();
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

    /// The servo of a joint, behind no gear; where the file has another or none, one of its own.
    fn servo(&mut self, at: MoverId) -> &mut Actuator {
        let is_its = |servo: &Actuator| servo.joint == at && servo.kind == ActuatorKind::Position;
        let place = self.actuators.iter().position(is_its);
        let place = place.unwrap_or_else(|| {
            self.actuators.retain(|other| other.joint != at);
            self.actuators.push(Actuator {
                name: self.joints[at.0].name.clone(),
                kind: ActuatorKind::Position,
                joint: at,
                gear: 1.0,
                gain: 0.0,
                bias: [0.0; 3],
                damping_ratio: None,
                control_range: None,
                force_range_nm: None,
                activation: None,
            });
            self.actuators.len() - 1
        });
        let servo = &mut self.actuators[place];
        // Numbers of studies are those of the joint.
        let square = servo.gear * servo.gear;
        if square != 1.0 {
            servo.gain *= square;
            servo.bias.iter_mut().skip(1).for_each(|bias| *bias *= square);
            servo.force_range_nm = servo.force_range_nm.map(|range| range.map(|end| end * servo.gear.abs()));
            servo.gear = 1.0;
        }
        servo
    }
}
