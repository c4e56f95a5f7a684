//! Where the bodies are and how they move.

use super::spatial::{Frame, Twist};
use super::{Moves, Tree, TreeBody, TreeState};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Frames and twists of the bodies at a state.
#[derive(Clone, Debug, Default)]
pub(super) struct Motions {
    /// In the parent's frame, or the world's.
    pub in_parent: Vec<Frame>,
    /// In the world.
    pub in_world: Vec<Frame>,
    /// In the body's axes.
    pub twist: Vec<Twist>,
}

impl Motions {
    /// Fills all of them.
    pub fn set(&mut self, tree: &Tree, state: &TreeState) {
        self.in_parent.clear();
        self.in_world.clear();
        self.twist.clear();
        for body in &tree.bodies {
            let frame = in_parent(tree, body, state);
            let (world, carried) = match body.parent {
                Some(parent) => (self.in_world[parent].times(&frame), frame.into_inner(&self.twist[parent])),
                None => (frame, Twist::default()),
            };
            let own = match body.moves {
                Moves::Freely => {
                    Twist { angular: state.base_rate_rad_s, linear: frame.rotation.tr_mul(&state.base_velocity_m_s) }
                }
                Moves::By { joint, .. } => body.axis() * tree.coordinates.rate(joint.0, &state.rate),
            };
            self.in_parent.push(frame);
            self.in_world.push(world);
            self.twist.push(carried + own);
        }
    }
}

impl TreeBody {
    /// The twist of the body against its parent where its joint's rate is 1; nothing for one that moves freely.
    pub(super) fn axis(&self) -> Twist {
        match self.moves {
            Moves::Freely => Twist::default(),
            Moves::By { turns: true, axis, .. } => Twist { angular: axis.into_inner(), linear: Vector3::zeros() },
            Moves::By { turns: false, axis, .. } => Twist { angular: Vector3::zeros(), linear: axis.into_inner() },
        }
    }
}

/// A body's frame in its parent's.
fn in_parent(tree: &Tree, body: &TreeBody, state: &TreeState) -> Frame {
    let drawn = &body.drawn;
    match body.moves {
        Moves::Freely => {
            Frame { rotation: *state.base_orientation.to_rotation_matrix().matrix(), origin: state.base_position_m }
        }
        Moves::By { joint, turns, axis, drawn: zero } => {
            let by = tree.coordinates.position(joint.0, &state.position) - zero;
            if turns {
                let turned: Matrix3<f64> = *Rotation3::from_axis_angle(&axis, by).matrix();
                Frame { rotation: drawn.rotation * turned, origin: drawn.origin }
            } else {
                Frame { rotation: drawn.rotation, origin: drawn.point(&(axis.into_inner() * by)) }
            }
        }
    }
}
