//! What is other than described about a robot's bodies.

use crate::gap::{BodyKind, Number};
use crate::number::quantity;
use crate::robot::description::{BodyChange, LinkId};

/// A direction of which logs leave more than this share of what was believed open is not told.
pub(in crate::gap) const BODY_OPEN: f64 = 0.7;
/// Standard deviations within which a number of the robot is as believed: beyond them it is a cause.
pub(in crate::gap) const BELIEVED: f64 = 3.0;

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
    /// What it saves along the measured motion: squares of standard deviations of logs and beliefs.
    pub saved: f64,
    /// What these logs cannot tell from it, itself first.
    pub equivalent: Vec<BodyName>,
}

/// What may be other than described, without its size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyName {
    /// What of it.
    pub kind: BodyKind,
    /// The link's name.
    pub body: String,
}

impl BodyName {
    /// `payload on hand`
    pub fn id(&self) -> String {
        format!("{} on {}", self.kind.id(), self.body)
    }

    /// `a payload on hand`
    pub fn words(&self) -> String {
        let what = match self.kind {
            BodyKind::Payload => "a payload on",
            BodyKind::BodyMass => "another mass of",
            BodyKind::BodyCom => "another centre of mass of",
        };
        format!("{what} {}", self.body)
    }
}

impl BodyCause {
    /// What it is.
    pub fn name(&self) -> BodyName {
        BodyName { kind: self.kind, body: self.body.clone() }
    }

    /// What these logs cannot tell from it; `None` where nothing is as good.
    pub fn rivals_words(&self) -> Option<String> {
        let own = self.name();
        let others: Vec<String> = self.equivalent.iter().filter(|other| **other != own).map(BodyName::words).collect();
        (!others.is_empty()).then(|| others.join(", nor from "))
    }

    /// `a payload on hand (mass = 0.21 [0.20, 0.22] kg; in the link's frame x = 0.010 [0.008, 0.012] m)`
    pub fn words(&self) -> String {
        let told = self.parameters.iter().filter(|number| number.interval.is_some());
        let (mass, place): (Vec<&Number>, Vec<&Number>) = told.partition(|number| number.name == "mass");
        let list = |numbers: Vec<&Number>| {
            let each = numbers.iter().map(|n| format!("{} = {}", n.name, quantity(n.value, n.interval, &n.unit)));
            each.collect::<Vec<String>>().join(", ")
        };
        let [mass, place] = [mass, place].map(list);
        let place = if place.is_empty() { place } else { format!("in the link's frame {place}") };
        let all: Vec<String> = [mass, place].into_iter().filter(|part| !part.is_empty()).collect();
        let numbers = if all.is_empty() { String::new() } else { format!(" ({})", all.join("; ")) };
        format!("{}{numbers}", self.name().words())
    }
}
