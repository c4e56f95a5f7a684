//! The tree made ready for the recursion: constants of two bodies at a time.

use super::frame::{Frame, frames};
use super::schedule::{Step, steps};
use super::{Body, BodyId};
use crate::geometry::Joint;
use crate::geometry::inertia::parallel_axis;
use crate::robot::spatial::{Articulated, Pair, Two, Vec3};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// What lies between a working frame and its parent's, apart from the turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::robot) enum Shape {
    /// Nothing: both origins coincide.
    Turn,
    /// A shift.
    Shifted,
    /// A shift and a fixed rotation.
    Rotated,
}

/// Where a pair of bodies hangs.
#[derive(Clone, Copy, Debug)]
pub(in crate::robot) enum Parent {
    /// Both on the base.
    Base,
    /// Each on the body of its own lane of an earlier group; or both lanes of a single body on those of another.
    Lanes(usize),
    /// Both on one body: `lane` of `group`. A sum goes to the lanes that `mask` has a 1 for.
    Shared { group: usize, lane: usize, mask: Two },
}

/// Two bodies with their joints, side by side; one body in both lanes where it has no partner.
#[derive(Clone, Debug)]
pub(in crate::robot) struct Group {
    /// Joints of the lanes; the same twice for a body on its own.
    pub joints: [usize; 2],
    /// The joint is on its own.
    pub is_single: bool,
    /// 1 for a lane that counts, 0 for one that repeats the other.
    pub counts: Two,
    /// Axis of the turn, 0, 1 or 2.
    pub axis: usize,
    pub shape: Shape,
    pub parent: Parent,
    /// Working angle: `sign q + phase`.
    pub sign: Two,
    /// See `sign` \[rad\].
    pub phase_rad: Two,
    /// From the parent's working origin \[m\].
    pub offset_m: Vec3<Two>,
    /// Fixed rotation into the parent's axes, by rows.
    pub fixed: [Vec3<Two>; 3],
    /// Centre of mass from the working origin \[m\].
    pub centre_m: Vec3<Two>,
    /// \[kg\]
    pub mass_kg: Two,
    /// About the centre of mass: xx, yy, zz, yz, zx, xy \[kg m^2\].
    pub inertia_kg_m2: [Two; 6],
    /// Spatial inertia about the working origin.
    pub rigid: Articulated<Two>,
}

impl Group {
    /// A number of each of the joints.
    #[inline(always)]
    pub fn of_joints(&self, values: &[f64]) -> Pair {
        Pair::new(values[self.joints[0]], values[self.joints[1]])
    }

    /// 1 in the lane of a body, 0 in the other's; both lanes of a single body are its own.
    pub fn lane_mask(&self, lane: usize) -> Pair {
        match (self.is_single, lane) {
            (true, _) => Pair::splat(1.0),
            (false, 0) => Pair::new(1.0, 0.0),
            (false, _) => Pair::new(0.0, 1.0),
        }
    }
}

/// Constants of the base; its working frame is its own.
#[derive(Clone, Debug)]
pub(in crate::robot) struct BasePlan {
    pub centre_m: Vector3<f64>,
    pub mass_kg: f64,
    pub inertia_kg_m2: Matrix3<f64>,
    /// Spatial inertia about the base's centre, in the first lane only.
    pub rigid: Articulated<Two>,
}

/// The whole tree.
#[derive(Clone, Debug)]
pub(in crate::robot) struct Plan {
    pub base: BasePlan,
    /// Parents before children.
    pub groups: Vec<Group>,
    /// Of the groups' rotors about their axes \[kg m^2\]; empty where no joint has one.
    pub armature_kg_m2: Vec<Two>,
    /// Group and lane of each joint.
    pub placed: Vec<(usize, usize)>,
}

impl Plan {
    pub(super) fn of(joints: &[Joint], carrier: &[BodyId], bodies: &[Body], armature_kg_m2: &[f64]) -> Self {
        let frames = frames(joints, carrier);
        let steps = steps(&frames, carrier);
        let mut placed: Vec<Option<(usize, usize)>> = vec![None; joints.len()];
        for (group, step) in steps.iter().enumerate() {
            placed[step.first] = Some((group, 0));
            if let Some(second) = step.second {
                placed[second] = Some((group, 1));
            }
        }
        let at = |joint: usize| placed[joint].expect("every joint has a step");
        let groups: Vec<Group> = steps.iter().map(|step| group(step, &frames, carrier, bodies, &steps, &at)).collect();
        let rotors = groups.iter().map(|group| Two(group.joints.map(|joint| armature_kg_m2[joint])));
        let has_rotors = armature_kg_m2.iter().any(|armature| *armature != 0.0);
        let base = &bodies[BodyId::BASE.index()];
        Self {
            base: BasePlan {
                centre_m: base.centre_of_mass_m,
                mass_kg: base.mass_kg,
                inertia_kg_m2: base.inertia_kg_m2,
                rigid: rigid(&[&Working::of(base, &Rotation3::identity(), &Vector3::zeros()), &Working::nothing()]),
            },
            armature_kg_m2: if has_rotors { rotors.collect() } else { Vec::new() },
            groups,
            placed: (0..joints.len()).map(at).collect(),
        }
    }
}

fn group(
    step: &Step,
    frames: &[Frame],
    carrier: &[BodyId],
    bodies: &[Body],
    steps: &[Step],
    at: &dyn Fn(usize) -> (usize, usize),
) -> Group {
    let joints = [step.first, step.second.unwrap_or(step.first)];
    let lanes = joints.map(|joint| &frames[joint]);
    let workings = joints.map(|joint| {
        let frame = &frames[joint];
        Working::of(&bodies[joint + 1], &frame.in_part, &frame.origin_m)
    });
    let shape = if lanes.iter().any(|frame| frame.fixed.is_some()) {
        Shape::Rotated
    } else if lanes.iter().any(|frame| frame.offset_m != Vector3::zeros()) {
        Shape::Shifted
    } else {
        Shape::Turn
    };
    let parent = match joints.map(|joint| carrier[joint].joint().map(|above| at(above.index()))) {
        [Some((group, 0)), Some((_, 1))] => Parent::Lanes(group),
        [Some((group, _)), _] if step.second.is_none() && steps[group].second.is_none() => Parent::Lanes(group),
        [Some((group, lane)), _] => {
            let alone = steps[group].second.is_none();
            let mask = if alone { [1.0, 1.0] } else { [f64::from(lane == 0), f64::from(lane == 1)] };
            Parent::Shared { group, lane, mask: Two(mask) }
        }
        [None, _] => Parent::Base,
    };
    let rotations = lanes.map(|frame| frame.fixed.unwrap_or_else(Rotation3::identity));
    Group {
        joints,
        is_single: step.second.is_none(),
        counts: Two([1.0, f64::from(step.second.is_some())]),
        axis: lanes[0].axis,
        shape,
        parent,
        sign: Two(lanes.map(|frame| frame.sign)),
        phase_rad: Two(lanes.map(|frame| frame.phase_rad)),
        offset_m: vector(lanes.map(|frame| frame.offset_m)),
        fixed: [0, 1, 2].map(|i| [0, 1, 2].map(|j| Two(rotations.map(|r| r[(i, j)])))),
        centre_m: vector([workings[0].centre_m, workings[1].centre_m]),
        mass_kg: Two([workings[0].mass_kg, workings[1].mass_kg]),
        inertia_kg_m2: symmetric([&workings[0].inertia_kg_m2, &workings[1].inertia_kg_m2]),
        rigid: rigid(&[&workings[0], &workings[1]]),
    }
}

/// A body in its working frame.
struct Working {
    mass_kg: f64,
    centre_m: Vector3<f64>,
    inertia_kg_m2: Matrix3<f64>,
}

impl Working {
    fn of(body: &Body, in_part: &Rotation3<f64>, origin_m: &Vector3<f64>) -> Self {
        let back = in_part.inverse();
        Self {
            mass_kg: body.mass_kg,
            centre_m: back * (body.centre_of_mass_m - origin_m),
            inertia_kg_m2: back * body.inertia_kg_m2 * *in_part,
        }
    }

    fn nothing() -> Self {
        Self { mass_kg: 0.0, centre_m: Vector3::zeros(), inertia_kg_m2: Matrix3::zeros() }
    }
}

/// Spatial inertias about the working origins: `A = I + m (c^2 1 - c c^T)`, `B = m c x`, `C = m 1`.
fn rigid(lanes: &[&Working; 2]) -> Articulated<Two> {
    let a = lanes.map(|body| parallel_axis(&body.inertia_kg_m2, body.mass_kg, &body.centre_m));
    let b = lanes.map(|body| body.centre_m.cross_matrix() * body.mass_kg);
    let c = lanes.map(|body| Matrix3::identity() * body.mass_kg);
    Articulated {
        a: symmetric([&a[0], &a[1]]),
        b: [0, 1, 2].map(|i| [0, 1, 2].map(|j| Two([b[0][(i, j)], b[1][(i, j)]]))),
        c: symmetric([&c[0], &c[1]]),
    }
}

fn vector(lanes: [Vector3<f64>; 2]) -> Vec3<Two> {
    [0, 1, 2].map(|k| Two([lanes[0][k], lanes[1][k]]))
}

fn symmetric(lanes: [&Matrix3<f64>; 2]) -> [Two; 6] {
    [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)].map(|(i, j)| Two([lanes[0][(i, j)], lanes[1][(i, j)]]))
}
