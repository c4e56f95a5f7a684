//! The tree as bodies whose frames have the base's axes where all joints are at 0: what the recursion for revolute trees
//! is made from. No rotation is left between frames then, and none has to be written as angles.

use super::{Moves, Tree};
use crate::robot::description::{MoverId, RigidInertia};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// A body behind its joint; its frame's origin lies on the axis.
#[derive(Clone, Copy, Debug)]
pub(in crate::robot) struct Jointed {
    /// The joint.
    pub joint: MoverId,
    /// What carries it: 0 for the base, else one more than a place in the list.
    pub carrier: usize,
    /// In the carrier's frame \[m\].
    pub at_m: Vector3<f64>,
    /// In either frame.
    pub axis: Unit<Vector3<f64>>,
    /// In its own frame.
    pub inertia: RigidInertia,
}

impl Tree {
    /// Whether a joint moves its link against the world itself.
    pub(in crate::robot) fn stands_on_the_world(&self, joint: MoverId) -> bool {
        let is_it = |body: &&super::TreeBody| matches!(body.moves, Moves::By { joint: of, .. } if of == joint);
        self.bodies.iter().find(is_it).is_some_and(|body| body.parent.is_none())
    }

    /// What the base carries in its frame (with a fixed base the world's), and the bodies behind joints, parents first.
    pub(in crate::robot) fn jointed(&self) -> (RigidInertia, Vec<Jointed>) {
        let mut base = if self.base.is_some() { RigidInertia::default() } else { self.still };
        let mut all = Vec::with_capacity(self.bodies.len());
        // Place in the list and axes at 0 of every body.
        let mut known: Vec<(usize, Matrix3<f64>)> = Vec::with_capacity(self.bodies.len());
        for body in &self.bodies {
            let (carrier, around) = body.parent.map_or((0, Matrix3::identity()), |parent| known[parent]);
            match body.moves {
                Moves::Freely => {
                    base += body.inertia;
                    known.push((0, Matrix3::identity()));
                }
                Moves::By { joint, turns, axis, drawn } => {
                    let back = if turns { Rotation3::from_axis_angle(&axis, -drawn) } else { Rotation3::identity() };
                    let turned = around * body.drawn.rotation * back.matrix();
                    all.push(Jointed {
                        joint,
                        carrier,
                        at_m: around * body.drawn.origin,
                        axis: Unit::new_normalize(turned * axis.into_inner()),
                        inertia: body.inertia.moved(&turned, &Vector3::zeros()),
                    });
                    known.push((all.len(), turned));
                }
            }
        }
        (base, all)
    }
}
