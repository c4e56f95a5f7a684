//! Kinds of what may be other than described about a robot's bodies.

use serde::{Serialize, Serializer};

/// What of a body is other than described.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyKind {
    /// Something hangs on it: mass \[kg\], and its place in the link's frame \[m\].
    Payload,
    /// Its mass \[kg\], its shape as described.
    BodyMass,
    /// Its centre of mass in the link's frame \[m\].
    BodyCom,
}

impl BodyKind {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::Payload, Self::BodyMass, Self::BodyCom];

    /// The word in reports and JSON.
    pub fn id(self) -> &'static str {
        match self {
            Self::Payload => "payload",
            Self::BodyMass => "body_mass",
            Self::BodyCom => "body_com",
        }
    }
}

impl Serialize for BodyKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}
