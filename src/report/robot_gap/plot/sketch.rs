//! The robot seen from above, drawn from its own tables, for a map to lie on.

use crate::geometry::Joint;
use crate::number::math;
use crate::report::animation::{Recording, View, outline};
use crate::robot::{BodyId, Dynamics, Model, State};
use std::f64::consts::TAU;

/// How far legs are spread for the picture, so that knees do not lie under shoulders: joints 1 and 2 \[rad\].
const SPREAD_RAD: [(&str, f64); 2] = [("q1", 0.45), ("q2", 0.7)];
/// Corners of an outline.
const CORNERS: usize = 48;

/// A robot from above: right and forward \[m\].
#[derive(Clone, Debug, PartialEq)]
pub struct Sketch {
    /// Outlines of its parts, the lowest first.
    pub(super) parts: Vec<Vec<[f64; 2]>>,
    pub(super) joints: Vec<JointDot>,
}

/// A joint of a [`Sketch`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct JointDot {
    pub name: String,
    pub at_m: [f64; 2],
    /// The joint of its chain that is on the trunk, by its place in the robot's order.
    pub chain: usize,
}

impl Sketch {
    /// The picture of a robot.
    pub fn of(model: &Model) -> Self {
        let mut state = State::at_rest(model);
        state.base_position_m = nalgebra::Vector3::zeros();
        state.base_orientation = nalgebra::UnitQuaternion::identity();
        for (id, joint) in model.joint_ids().zip(model.joints()) {
            let spread = SPREAD_RAD.iter().find(|(kind, _)| *kind == joint.kind).map(|(_, angle)| *angle);
            let within = joint.software_rad.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            state.angle_rad[id.index()] =
                spread.map_or_else(|| joint.resting_rad(), |angle| angle.clamp(within[0], within[1]));
        }
        let mut dynamics = Dynamics::new(model);
        let motions = dynamics.motions(&state);
        let view = View::top();
        let dot = |(index, joint): (usize, &Joint)| {
            let id = model.joint_ids().nth(index)?;
            // Of the joint's axis the point closest to what it moves: that of a shoulder goes through the whole trunk.
            let carrier = &motions[model.carrier(id).index()];
            let point_m = carrier.point_m(&joint.in_parent_m);
            let axis = carrier.rotation * (joint.zero_rotation() * joint.axis.into_inner());
            let along_m = axis.dot(&(motions[id.child().index()].position_m - point_m));
            let at = view.picture * (point_m + axis * along_m);
            let mut chain = id;
            while let Some(above) = BodyId::joint(model.carrier(chain)) {
                chain = above;
            }
            Some(JointDot { name: joint.name.clone(), at_m: [at.x, at.y], chain: chain.index() })
        };
        let joints = model.joints().iter().enumerate().filter_map(dot).collect();
        let mut still = Recording::new(model);
        still.push(0.0, motions);
        let places = still.frames.first().map_or(&[][..], |frame| frame);
        let mut outlines: Vec<_> =
            still.shapes.iter().zip(places).map(|(shape, place)| outline(&view, shape, place)).collect();
        outlines.sort_by(|a, b| a.near_m.total_cmp(&b.near_m));
        let ring = |of: &crate::report::animation::Outline| {
            let root = of.form.cholesky()?.l();
            let corner = |k: usize| {
                let (sin, cos) = math::sin_cos(TAU * k as f64 / CORNERS as f64);
                let at = of.centre + root * nalgebra::Vector2::new(cos, sin);
                [at.x, at.y]
            };
            Some((0..CORNERS).map(corner).collect())
        };
        Self { parts: outlines.iter().filter_map(ring).collect(), joints }
    }

    /// Least and greatest right, least and greatest forward \[m\].
    pub(super) fn extent_m(&self) -> [f64; 4] {
        let points = self.parts.iter().flatten().chain(self.joints.iter().map(|joint| &joint.at_m));
        let none = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        points.fold(none, |[l, r, b, f], [x, y]| [l.min(*x), r.max(*x), b.min(*y), f.max(*y)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legs_stand_where_they_are_and_knees_beside_shoulders() {
        let sketch = Sketch::of(Model::ers7());
        let of = |name: &str| sketch.joints.iter().find(|joint| joint.name == name).expect("a joint of the ERS-7");
        let at = |name: &str| of(name).at_m;
        // Right is to the right, forward is up.
        assert!(at("lf1")[0] < 0.0 && at("rf1")[0] > 0.0 && at("lf1")[1] > 0.0 && at("lr1")[1] < 0.0);
        assert!(at("lf3")[0] < at("lf2")[0] - 0.03 && at("rr3")[0] > at("rr2")[0] + 0.03);
        assert_eq!(of("lf3").chain, of("lf1").chain);
        // 19 parts have mass.
        assert_eq!(sketch.parts.len(), 19);
    }
}
