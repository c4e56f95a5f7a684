//! The dynamics of any tree of rigid bodies: joints that turn or slide about any axis, full inertia tensors, couplings, a
//! base that is fixed or free.
//!
//! - [`Tree`]: what moves of a [`Description`], links that cannot move against each other lumped.
//! - [`TreeState`]: where it is and how it moves.
//! - [`TreeDynamics`]: mass matrix by composite bodies, bias by recursive Newton-Euler, accelerations by factorising the
//!   mass matrix, places, energies (Featherstone 2008, chapters 5 and 6).
//!
//! Generalised velocities are `v = [velocity of the base frame's origin, world axes (3); angular velocity of the base, base
//! axes (3); rates of the free joints]`, the first six only where the base is free, and `M dv/dt + bias = [0; tau]` with
//! gravity in the bias. Of what the description has, the armature is in M; springs, friction and limits are in neither.
//!
//! A joint that follows another ([`Coupling`](super::description::Coupling)) is no freedom: with `G = dq_all/dq`, `M = G^T
//! M_all G`, and bias and torques likewise.
//!
//! [`Dynamics`](super::Dynamics) does the same for the ERS-7's kind of tree (revolute, two legs at a time, nothing
//! allocated), several times as fast; a test holds the two against each other.

mod build;
mod composite;
mod coordinates;
mod evaluate;
mod factor;
mod jointed;
mod motion;
mod newton_euler;
mod servo;
mod spatial;
#[cfg(test)]
mod tests;

pub use build::TreeError;
pub use coordinates::TreeState;
pub use evaluate::{NoAcceleration, TreeDynamics, TreeEnergy, TreeMomentum};
pub(super) use jointed::Jointed;

use super::description::{Description, LinkId, MoverId, RigidInertia};
use coordinates::Coordinates;
use nalgebra::{Isometry3, Unit, Vector3};
use spatial::Frame;

/// How the base of a robot is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TreeBase {
    /// The root link does not move.
    Fixed,
    /// The root link, or the one that the file sets free, moves freely.
    Free,
}

/// What moves of a robot.
#[derive(Clone, Debug)]
pub struct Tree {
    gravity_m_s2: Vector3<f64>,
    /// Parents before children.
    bodies: Vec<TreeBody>,
    /// Where each link is: the body that it is a part of (`None`: the world) and its frame there.
    links: Vec<(Option<usize>, Isometry3<f64>)>,
    /// What cannot move, in the world's frame.
    still: RigidInertia,
    base: Option<FreeBase>,
    coordinates: Coordinates,
    /// Of each joint \[kg m^2\].
    armature: Vec<f64>,
    names: Vec<String>,
    /// What each joint moves.
    moved: Vec<LinkId>,
    link_names: Vec<String>,
}

/// The body that moves freely.
#[derive(Clone, Copy, Debug)]
struct FreeBase {
    body: usize,
    link: LinkId,
    armature: f64,
    /// As drawn.
    pose: Isometry3<f64>,
}

/// A body behind one joint; its frame lies on the joint.
#[derive(Clone, Copy, Debug)]
struct TreeBody {
    parent: Option<usize>,
    /// Its frame in the parent's (or the world's) where the joint is as drawn.
    drawn: Frame,
    moves: Moves,
    inertia: RigidInertia,
}

/// How a body moves against its parent.
#[derive(Clone, Copy, Debug)]
enum Moves {
    /// In all six ways.
    Freely,
    /// By a joint, along or about an axis in the body's frame; `drawn` is the joint's position in the pose as drawn.
    By { joint: MoverId, turns: bool, axis: Unit<Vector3<f64>>, drawn: f64 },
}

impl Tree {
    /// The tree of a description, coupled joints reduced to those that lead them.
    ///
    /// # Errors
    /// [`TreeError`] where the base cannot be held so.
    pub fn new(description: &Description, base: TreeBase) -> Result<Self, TreeError> {
        build::build(description, base)
    }

    /// How a file says that its base is held; a URDF does not, which means fixed.
    pub fn base_of(description: &Description) -> TreeBase {
        if description.free_joint.is_some() { TreeBase::Free } else { TreeBase::Fixed }
    }

    /// Whether its base is free.
    pub fn base(&self) -> TreeBase {
        if self.base.is_some() { TreeBase::Free } else { TreeBase::Fixed }
    }

    /// The link that moves freely.
    pub fn base_link(&self) -> Option<LinkId> {
        self.base.map(|base| base.link)
    }

    /// Where the file draws it, in the world.
    pub fn base_pose(&self) -> Option<Isometry3<f64>> {
        self.base.map(|base| base.pose)
    }

    /// Entries of the base in generalised velocities: 6 or 0.
    pub fn base_freedoms(&self) -> usize {
        if self.base.is_some() { 6 } else { 0 }
    }

    /// Length of generalised velocities.
    pub fn freedoms(&self) -> usize {
        self.base_freedoms() + self.coordinates.independent.len()
    }

    /// The joints that are freedoms, in the description's order.
    pub fn joints(&self) -> &[MoverId] {
        &self.coordinates.independent
    }

    /// Names of [`Tree::joints`].
    pub fn joint_names(&self) -> impl Iterator<Item = &str> {
        self.joints().iter().map(|joint| self.names[joint.0].as_str())
    }

    /// Gravity in world axes \[m/s^2\].
    pub fn gravity_m_s2(&self) -> Vector3<f64> {
        self.gravity_m_s2
    }

    /// The same robot under another gravity.
    #[must_use]
    pub fn with_gravity(&self, gravity_m_s2: Vector3<f64>) -> Self {
        Self { gravity_m_s2, ..self.clone() }
    }

    /// Position of a joint for positions of [`Tree::joints`] \[rad or m\].
    pub fn position_of(&self, joint: MoverId, position: &[f64]) -> f64 {
        self.coordinates.position(joint.0, position)
    }

    /// Rate of a joint for rates of [`Tree::joints`] \[rad/s or m/s\].
    pub fn rate_of(&self, joint: MoverId, rate: &[f64]) -> f64 {
        self.coordinates.rate(joint.0, rate)
    }
}
