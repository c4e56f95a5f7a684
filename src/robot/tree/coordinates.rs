//! Which joints are freedoms, and what the others do along with them.

use super::{Tree, TreeBase};
use crate::robot::description::{Description, MoverId};
use nalgebra::{UnitQuaternion, Vector3};

/// Joints and freedoms: `q_all = G q + offset` with one entry in every row of G.
#[derive(Clone, Debug)]
pub(super) struct Coordinates {
    /// The joints that are freedoms.
    pub independent: Vec<MoverId>,
    /// For each joint: the freedom that it follows, how fast, and from where.
    pub follows: Vec<Follows>,
}

/// A row of `q_all = G q + offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follows {
    pub freedom: usize,
    pub multiplier: f64,
    pub offset: f64,
}

impl Coordinates {
    /// Of a description; a chain of followers ends at a joint that follows none, which the readers see to.
    pub fn of(description: &Description) -> Self {
        let joints = description.joints.len();
        let mut coupling = vec![None; joints];
        for one in &description.couplings {
            coupling[one.follower.0] = Some(*one);
        }
        let independent: Vec<MoverId> = (0..joints).filter(|joint| coupling[*joint].is_none()).map(MoverId).collect();
        let mut freedom = vec![0; joints];
        for (place, joint) in independent.iter().enumerate() {
            freedom[joint.0] = place;
        }
        let follows = |joint: usize| {
            let (mut at, mut multiplier, mut offset) = (joint, 1.0, 0.0);
            while let Some(one) = coupling[at] {
                (offset, multiplier, at) =
                    (offset + multiplier * one.offset_rad, multiplier * one.multiplier, one.leader.0);
            }
            Follows { freedom: freedom[at], multiplier, offset }
        };
        Self { follows: (0..joints).map(follows).collect(), independent }
    }

    /// Position of a joint.
    pub fn position(&self, joint: usize, position: &[f64]) -> f64 {
        let Follows { freedom, multiplier, offset } = self.follows[joint];
        multiplier * position[freedom] + offset
    }

    /// Rate of a joint, or acceleration.
    pub fn rate(&self, joint: usize, rate: &[f64]) -> f64 {
        let Follows { freedom, multiplier, .. } = self.follows[joint];
        multiplier * rate[freedom]
    }
}

/// Configuration and velocity of a [`Tree`]; positions and rates are those of [`Tree::joints`].
#[derive(Clone, Debug, PartialEq)]
pub struct TreeState {
    /// Place of the free base's frame in the world \[m\].
    pub base_position_m: Vector3<f64>,
    /// Orientation of the free base, body to world.
    pub base_orientation: UnitQuaternion<f64>,
    /// Velocity of the base frame's origin, world axes \[m/s\].
    pub base_velocity_m_s: Vector3<f64>,
    /// Angular velocity of the base, **body** axes \[rad/s\].
    pub base_rate_rad_s: Vector3<f64>,
    /// Joint positions \[rad or m\].
    pub position: Vec<f64>,
    /// Joint rates \[rad/s or m/s\].
    pub rate: Vec<f64>,
}

impl TreeState {
    /// At rest as drawn.
    pub fn drawn(tree: &Tree) -> Self {
        let mut position = vec![0.0; tree.joints().len()];
        for body in &tree.bodies {
            if let super::Moves::By { joint, drawn, .. } = body.moves {
                let follows = tree.coordinates.follows[joint.0];
                if tree.coordinates.independent[follows.freedom] == joint {
                    position[follows.freedom] = drawn;
                }
            }
        }
        let pose = tree.base.map(|base| base.pose).unwrap_or_default();
        Self {
            base_position_m: pose.translation.vector,
            base_orientation: pose.rotation,
            base_velocity_m_s: Vector3::zeros(),
            base_rate_rad_s: Vector3::zeros(),
            rate: vec![0.0; position.len()],
            position,
        }
    }

    /// The generalised velocity, as long as [`Tree::freedoms`].
    pub fn velocity(&self, base: TreeBase) -> impl Iterator<Item = f64> + '_ {
        let of_base = if base == TreeBase::Free { 3 } else { 0 };
        let base = self.base_velocity_m_s.iter().take(of_base).chain(self.base_rate_rad_s.iter().take(of_base));
        base.chain(&self.rate).copied()
    }
}
