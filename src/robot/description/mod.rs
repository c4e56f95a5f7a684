//! A robot as somebody else described it: URDF, MJCF or our own TOML, read into one tree of links.
//!
//! - [`Description`]: links with full inertia tensors and centres of mass anywhere, joints that turn or slide about any
//!   axis, couplings, actuators, limits. What moves is [`Tree`](crate::robot::tree::Tree)'s to say.
//! - [`Description::read`] tells the formats apart by their content.
//!
//! Left out: meshes (no dynamics needs them but for a body whose inertia would come from one, which is refused), what
//! collides with anything but a floor, sensors, looks. What would change the dynamics and is not read is refused by name, with file, line and
//! element; what only a simulation would miss stands in [`Description::left_out`], likely mistakes in
//! [`Description::warnings`].

mod actuated;
mod change;
mod error;
mod format;
mod found;
mod inertia;
mod mjcf;
mod of_tables;
mod parts;
mod sanity;
mod shape;
mod to_isaac;
mod to_mjcf;
mod to_pace;
mod to_urdf;
mod urdf;
mod xml;

pub use change::BodyChange;
pub use error::{At, DescriptionError};
pub use format::Format;
pub use found::{FoundKey, FoundNumber, NoSuchPart};
pub use inertia::RigidInertia;
pub use parts::{Actuator, ActuatorKind, Collider, Coupling, FreeJoint, JointKind, Link, LinkId, Mover, MoverId};
pub use shape::Shape;
pub use to_isaac::to_isaac;
pub use to_mjcf::to_mjcf;
pub use to_pace::to_pace;
pub use to_urdf::to_urdf;

use nalgebra::Vector3;
use std::path::{Path, PathBuf};

/// Links beyond which a file is refused.
const MOST_LINKS: usize = 4000;
/// Joints beyond which a file is refused: a mass matrix takes memory with their square, its factors time with the cube.
const MOST_JOINTS: usize = 1000;

/// A robot as its file describes it, in SI units, in the file's own axes.
#[derive(Clone, Debug)]
pub struct Description {
    /// The robot's name.
    pub name: String,
    /// What it was read from.
    pub format: Format,
    /// The file, then those that it includes.
    pub files: Vec<PathBuf>,
    /// \[m/s^2\]; a URDF does not say and gets (0, 0, -9.81).
    pub gravity_m_s2: Vector3<f64>,
    /// Parents before children.
    pub links: Vec<Link>,
    /// In the file's order.
    pub joints: Vec<Mover>,
    /// The free joint of an MJCF file; a URDF does not say whether its base is free.
    pub free_joint: Option<FreeJoint>,
    /// Joints that follow others: `mimic`.
    pub couplings: Vec<Coupling>,
    /// Joints that forces hold to others, with what is said of each in `left_out`: an MJCF's joint equalities. They are
    /// freedoms unless [`Description::with_equalities`] makes followers of them.
    pub equalities: Vec<(Coupling, String)>,
    /// Motors on joints.
    pub actuators: Vec<Actuator>,
    /// What looks like a mistake, with file and line.
    pub warnings: Vec<String>,
    /// What is in the file and neither in the mass matrix nor in the bias, with file and line: closed loops, tendons.
    pub left_out: Vec<String>,
    /// The first link that stands on the world and of which no one knows what it weighs; its base cannot be set free.
    pub unweighed: Option<String>,
}

impl Description {
    /// Reads a file, whatever it is called: URDF, MJCF with what it includes, or TOML as `data/ers7.toml`.
    ///
    /// # Errors
    /// [`DescriptionError`] with file, line and element; a wrong TOML says so with line and key.
    pub fn read(file: &Path) -> Result<Self, DescriptionError> {
        format::read(file)
    }

    /// The same with joint equalities held rigidly: such a joint follows the other and is no freedom.
    #[must_use]
    pub fn with_equalities(&self) -> Self {
        let mut held = self.clone();
        for (coupling, said) in held.equalities.drain(..) {
            held.couplings.push(coupling);
            held.left_out.retain(|other| *other != said);
        }
        held
    }

    /// The joint of a name.
    pub fn joint(&self, name: &str) -> Option<MoverId> {
        self.joints.iter().position(|joint| joint.name == name).map(MoverId)
    }

    /// The link of a name.
    pub fn link(&self, name: &str) -> Option<LinkId> {
        self.links.iter().position(|link| link.name == name).map(LinkId)
    }

    /// Mass of all links, fixed ones included \[kg\].
    pub fn total_mass_kg(&self) -> f64 {
        self.links.iter().map(|link| link.inertia.mass_kg).sum()
    }
}
