//! What is other than described about a robot's bodies.

use crate::gap::{BodyKind, Number};
use crate::number::quantity;
use crate::robot::description::{BodyChange, LinkId};

/// A cause that all joints share which carry a body, fitted to the logs of all of them at once.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyCause {
    /// What is other than described.
    pub kind: BodyKind,
    /// The link's name.
    pub body: String,
    /// The link.
    pub link: LinkId,
    /// What it comes to.
    pub change: BodyChange,
    /// The joints that carry it, the nearest to the base first.
    pub joints: Vec<String>,
    /// Mass \[kg\], place \[m\]; without an interval where the logs do not tell.
    pub parameters: Vec<Number>,
    /// What it saves: squares of standard deviations of logs and beliefs.
    pub saved: f64,
    /// What these logs cannot tell from it, itself first.
    pub equivalent: Vec<String>,
}

impl BodyCause {
    /// `a payload on hand (mass = 0.21 [0.20, 0.22] kg)`
    pub fn words(&self) -> String {
        let told = self.parameters.iter().filter(|number| number.interval.is_some());
        let numbers: Vec<String> =
            told.map(|n| format!("{} = {}", n.name, quantity(n.value, n.interval, &n.unit))).collect();
        let what = match self.kind {
            BodyKind::Payload => "a payload on",
            BodyKind::BodyMass => "another mass of",
            BodyKind::BodyCom => "another centre of mass of",
        };
        let numbers = if numbers.is_empty() { String::new() } else { format!(" ({})", numbers.join(", ")) };
        format!("{what} {}{numbers}", self.body)
    }
}
