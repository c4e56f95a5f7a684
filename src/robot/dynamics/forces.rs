//! Forces on bodies.

use super::Dynamics;
use super::layout::{Layout, Pairwise};
use super::slot::Spatial;
use crate::robot::model::{Group, Parent, Shape};
use crate::robot::spatial::{Pair, cross, rotate_back, sub};
use crate::robot::{BodyId, State};
use nalgebra::Vector3;

/// A wrench (2.1) on a body: a force at a point, and a moment besides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Force {
    /// The body.
    pub body: BodyId,
    /// Where the force acts, in the world \[m\].
    pub at_m: Vector3<f64>,
    /// World axes \[N\].
    pub force_n: Vector3<f64>,
    /// World axes \[N m\].
    pub moment_nm: Vector3<f64>,
}

impl Force {
    /// A force at a point.
    pub fn at(body: BodyId, at_m: Vector3<f64>, force_n: Vector3<f64>) -> Self {
        Self { body, at_m, force_n, moment_nm: Vector3::zeros() }
    }

    /// Moment about a point \[N m\].
    pub(super) fn about(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        self.moment_nm + (self.at_m - point_m).cross(&self.force_n)
    }
}

impl Dynamics<'_> {
    /// Puts forces on the slots, in working frames; those on the base are taken from its bias. The turns of all joints
    /// have to be known.
    pub(super) fn place_forces(&mut self, state: &State, forces: &[Force], base_bias: &mut Spatial) {
        for slot in &mut self.slots {
            slot.external = ([Pair::zero(); 3], [Pair::zero(); 3]);
        }
        let back = state.base_orientation.inverse().to_rotation_matrix();
        for force in forces {
            let moment = back * force.about(&state.base_position_m);
            let linear = back * force.force_n;
            let at_base = (moment.into(), linear.into());
            let Some(joint) = force.body.joint() else {
                let first = |v: [f64; 3]| v.map(|x| Pair::new(x, 0.0));
                base_bias.0 = sub(base_bias.0, first(at_base.0));
                base_bias.1 = sub(base_bias.1, first(at_base.1));
                continue;
            };
            let (index, lane) = self.model.plan().placed[joint.index()];
            let (moment, linear) = self.wrench_at(index, &at_base);
            let mask = self.model.plan().groups[index].lane_mask(lane);
            let external = &mut self.slots[index].external;
            for k in 0..3 {
                external.0[k] += moment[k] * mask;
                external.1[k] += linear[k] * mask;
            }
        }
    }

    /// A wrench about the base's centre in base axes, in the working frames of a group: from parent to child along the
    /// way there.
    pub(super) fn wrench_at(&self, index: usize, at_base: &([f64; 3], [f64; 3])) -> Spatial {
        let group = &self.model.plan().groups[index];
        let (mut moment, mut force) = match group.parent {
            Parent::Base => (at_base.0.map(Pair::splat), at_base.1.map(Pair::splat)),
            Parent::Lanes(above) => self.wrench_at(above, at_base),
            Parent::Shared { group, lane, .. } => {
                let (moment, force) = self.wrench_at(group, at_base);
                let one = |x: Pair| Pair::splat(x.lanes()[lane]);
                (moment.map(one), force.map(one))
            }
        };
        if group.shape != Shape::Turn {
            moment = sub(moment, cross(Pairwise::vector(&group.offset_m, 0), force));
        }
        if group.shape == Shape::Rotated {
            let fixed = Pairwise::matrix(&group.fixed, 0);
            (moment, force) = (rotate_back(&fixed, moment), rotate_back(&fixed, force));
        }
        (self.turned(index, group, moment), self.turned(index, group, force))
    }

    /// A vector of the parents in the working axes of a group.
    pub(super) fn turned(&self, index: usize, group: &Group, v: [Pair; 3]) -> [Pair; 3] {
        let turn = self.slots[index].turn();
        match group.axis {
            0 => turn.into_child::<0>(v),
            1 => turn.into_child::<1>(v),
            _ => turn.into_child::<2>(v),
        }
    }
}
