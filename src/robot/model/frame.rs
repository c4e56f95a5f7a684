//! Where the working frames of the recursion lie.
//!
//! The recursion is cheap where a joint turns about an axis of its body's frame, through the frame's origin. So every
//! body gets a working frame with its origin on its joint's axis, along the part's own axes where the joint's axis is
//! one of them (else turned so that it is). The origin may slide along the axis: where two neighbouring axes meet,
//! both frames go to the meeting point, and nothing has to be shifted between them.

use crate::geometry::Joint;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use super::{BodyId, JointId};

/// Axes meet that pass within this distance of each other \[m\].
const MEET_M: f64 = 1e-12;
/// Lengths below this are rounding errors of tables in mm \[m\].
const NOTHING_M: f64 = 1e-15;
/// Axes at a smaller angle than this sine would meet too far away.
const FLAT: f64 = 0.1;

/// The child's orientation in the parent's frame: `R(q) = P0 + sin(q) P1 + cos(q) P2`, with `R(phi) Rot(a, q)` sorted
/// by its terms (Rodrigues).
#[derive(Clone, Debug)]
pub(in crate::robot) struct Turning {
    parts: [Matrix3<f64>; 3],
}

impl Turning {
    /// Of a joint.
    pub fn of(joint: &Joint) -> Self {
        let (axis, zero) = (joint.signed_axis(), joint.zero_rotation());
        let along = axis.into_inner() * axis.transpose();
        let parts = [along, axis.cross_matrix(), Matrix3::identity() - along];
        Self { parts: parts.map(|part| zero * part) }
    }

    /// Rotation from the child's axes to the parent's.
    pub fn at(&self, sin: f64, cos: f64) -> Matrix3<f64> {
        self.parts[0] + self.parts[1] * sin + self.parts[2] * cos
    }
}

/// A body's working frame and its joint, as the recursion has them.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// Axis of the turn in the working frame: 0, 1, 2.
    pub axis: usize,
    /// The working angle is `sign q + phase_rad`.
    pub sign: f64,
    /// See `sign` \[rad\].
    pub phase_rad: f64,
    /// Where the working frame's axes lie in the part's.
    pub in_part: Rotation3<f64>,
    /// Origin of the working frame in the part's frame \[m\].
    pub origin_m: Vector3<f64>,
    /// From the parent's working origin to this one, parent's working axes \[m\]; exactly zero where they coincide.
    pub offset_m: Vector3<f64>,
    /// What the turn about the axis does not cover: from this frame at working angle 0 to the parent's working axes.
    pub fixed: Option<Rotation3<f64>>,
}

/// Working frames of all joints' children, in joint order; the base's is its own.
pub(super) fn frames(joints: &[Joint], carrier: &[BodyId]) -> Vec<Frame> {
    let slides = slides(joints, carrier);
    let mut frames: Vec<Frame> = Vec::with_capacity(joints.len());
    for ((joint, above), slide_m) in joints.iter().zip(carrier).zip(slides) {
        let (axis, flip, in_part) = working_axis(&joint.axis);
        let sign = joint.sign * flip;
        let above = above.joint().map(|JointId(above)| &frames[above]);
        let above_in_part = above.map_or_else(Rotation3::identity, |above| above.in_part);
        let between = above_in_part.inverse() * joint.zero_rotation() * in_part;
        let is_plain = above_in_part == Rotation3::identity() && in_part == Rotation3::identity();
        let across = (0..3).all(|k| k == axis || joint.phi_rad[k] == 0.0);
        let (phase_rad, fixed) = if is_plain && across { (joint.phi_rad[axis], None) } else { (0.0, Some(between)) };
        let at_parent = in_parent(joint, slide_m) - above.map_or_else(Vector3::zeros, |above| above.origin_m);
        let offset_m = above_in_part.inverse() * at_parent;
        frames.push(Frame {
            axis,
            sign,
            phase_rad,
            in_part,
            origin_m: joint.in_child_m + joint.axis.into_inner() * slide_m,
            offset_m: if offset_m.amax() < NOTHING_M { Vector3::zeros() } else { offset_m },
            fixed,
        });
    }
    frames
}

/// The coordinate axis that a joint's axis is, with its sense and the frame in which it is that.
fn working_axis(axis: &Unit<Vector3<f64>>) -> (usize, f64, Rotation3<f64>) {
    let aligned = (0..3).find(|&k| axis[k].abs() == 1.0);
    match aligned {
        Some(k) => (k, axis[k], Rotation3::identity()),
        None => {
            let aside = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
            let columns = [aside, axis.cross(&aside), axis.into_inner()];
            (2, 1.0, Rotation3::from_matrix_unchecked(Matrix3::from_columns(&columns)))
        }
    }
}

/// The point of a joint's axis at `slide_m`, in the parent's frame.
fn in_parent(joint: &Joint, slide_m: f64) -> Vector3<f64> {
    joint.in_parent_m + joint.zero_rotation() * joint.axis.into_inner() * slide_m
}

/// How far each working origin slides along its joint's axis \[m\].
fn slides(joints: &[Joint], carrier: &[BodyId]) -> Vec<f64> {
    let mut slides: Vec<Option<f64>> = vec![None; joints.len()];
    for j in 0..joints.len() {
        if slides[j].is_some() {
            continue;
        }
        let joint = &joints[j];
        let next = (0..joints.len()).filter(|&k| carrier[k].joint() == Some(JointId(j)));
        let meeting = next.filter_map(|k| meeting(joint, &joints[k]).map(|at| (k, at))).next();
        if let Some((k, (here, there))) = meeting {
            slides[j] = Some(here);
            slides[k] = Some(there);
            continue;
        }
        // The point of the axis that is nearest to the parent's origin.
        let above = carrier[j].joint().map_or_else(Vector3::zeros, |JointId(above)| {
            joints[above].in_child_m + joints[above].axis.into_inner() * slides[above].unwrap_or(0.0)
        });
        let along = joint.zero_rotation() * joint.axis.into_inner();
        slides[j] = Some((above - joint.in_parent_m).dot(&along));
    }
    slides.into_iter().map(|slide| slide.unwrap_or(0.0)).collect()
}

/// Where the axes of a joint and of one that it carries meet, along either \[m\]; `None` where they do not.
fn meeting(joint: &Joint, next: &Joint) -> Option<(f64, f64)> {
    let (a, b) = (joint.axis.into_inner(), next.zero_rotation() * next.axis.into_inner());
    let normal = a.cross(&b);
    let between = next.in_parent_m - joint.in_child_m;
    if normal.norm() < FLAT || between.dot(&normal).abs() > MEET_M * normal.norm() {
        return None;
    }
    let squared = normal.norm_squared();
    Some((between.cross(&b).dot(&normal) / squared, between.cross(&a).dot(&normal) / squared))
}
