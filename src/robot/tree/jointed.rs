//! The tree as bodies whose frames have the base's axes where all joints are at 0: what the recursion for revolute trees
//! is made from. No rotation is left between frames then, and none has to be written as angles.

use super::{Moves, Tree};
use crate::robot::description::{MoverId, RigidInertia};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

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

impl Jointed {
    /// The same in other axes, of itself and of what carries it.
    pub fn turned(self, turn: &Rotation3<f64>) -> Self {
        let inertia = self.inertia.moved(turn.matrix(), &Vector3::zeros());
        Self { at_m: turn * self.at_m, axis: Unit::new_normalize(turn * self.axis.into_inner()), inertia, ..self }
    }
}

impl Tree {
    /// Whether a joint moves its link against the world itself.
    pub(in crate::robot) fn stands_on_the_world(&self, joint: MoverId) -> bool {
        let is_it = |body: &&super::TreeBody| matches!(body.moves, Moves::By { joint: of, .. } if of == joint);
        self.bodies.iter().find(is_it).is_some_and(|body| body.parent.is_none())
    }

    /// Of every link the body that carries it, 0 for a free base, else one more than a place among the jointed ones, and its
    /// frame in that body's; no body carries what stands on the world.
    pub(in crate::robot) fn carried(&self) -> Vec<(Option<usize>, Isometry3<f64>)> {
        let known = self.straightened();
        let place = |(body, pose): &(Option<usize>, Isometry3<f64>)| {
            let (carrier, around) = body.map(|body| known[body]).unzip();
            let turned = around.map_or_else(UnitQuaternion::identity, |around| UnitQuaternion::from_matrix(&around));
            (carrier, Isometry3::from_parts(Translation3::identity(), turned) * pose)
        };
        self.links.iter().map(place).collect()
    }

    /// Of every body its place among the jointed ones, as above, and the rotation from its own axes to those that it has there.
    fn straightened(&self) -> Vec<(usize, Matrix3<f64>)> {
        let mut known: Vec<(usize, Matrix3<f64>)> = Vec::with_capacity(self.bodies.len());
        let mut jointed = 0;
        for body in &self.bodies {
            known.push(match body.moves {
                Moves::Freely => (0, Matrix3::identity()),
                Moves::By { turns, axis, drawn, .. } => {
                    let around = body.parent.map_or(Matrix3::identity(), |parent| known[parent].1);
                    let back = if turns { Rotation3::from_axis_angle(&axis, -drawn) } else { Rotation3::identity() };
                    jointed += 1;
                    (jointed, around * body.drawn.rotation * back.matrix())
                }
            });
        }
        known
    }

    /// What the base carries in its frame (with a fixed base the world's), and the bodies behind joints, parents first.
    pub(in crate::robot) fn jointed(&self) -> (RigidInertia, Vec<Jointed>) {
        let mut base = if self.base.is_some() { RigidInertia::default() } else { self.still };
        let mut all = Vec::with_capacity(self.bodies.len());
        let known = self.straightened();
        for (body, (_, turned)) in self.bodies.iter().zip(&known) {
            let (carrier, around) = body.parent.map_or((0, Matrix3::identity()), |parent| known[parent]);
            match body.moves {
                Moves::Freely => base += body.inertia,
                Moves::By { joint, axis, .. } => all.push(Jointed {
                    joint,
                    carrier,
                    at_m: around * body.drawn.origin,
                    axis: Unit::new_normalize(turned * axis.into_inner()),
                    inertia: body.inertia.moved(turned, &Vector3::zeros()),
                }),
            }
        }
        (base, all)
    }
}
