//! A leg as one pendulum about one of its joints (3.10), exactly, at any pose of the other joints.
//!
//! The thesis puts all bodies on one line and hangs it straight down. A real leg on the bench has its knee at the
//! software stop, parts beside the line, a trunk that may be rolled, and an encoder zero that is not the hanging
//! angle. Here every body beyond the joint keeps its place in space:
//!
//! - axis `a` (unit, trunk axes, OPEN-R sense: a positive angle turns about `+a`) through a point of the joint;
//! - gravity across the axis `g_perp = g - (g.a) a`, `e_d = g_perp / |g_perp|`, `e_n = a x e_d`;
//! - a body's lever at encoder angle 0, across the axis: `r0 = rho (cos(alpha0) e_d + sin(alpha0) e_n)`.
//!
//! The torque of gravity about `a` is `-|g_perp| M* sin(q + alpha0)`, with `M*` and `alpha0` of the summed `m r0`, so
//! the joint hangs at `q = -alpha0`: the **rest angle**. Inertia about the axis and the moment vector `sum(m r0)` are
//! linear in the masses; their coefficients per kilogram are kept per body, so that a fit may move masses without
//! coming back here.
//!
//! Inertias are (3.1) from mass and size, not Table A.2's three-digit print of the same: the two differ by at most
//! 1.5e-7 kg m^2 (half a printed digit of three bodies), against 9.1e-5 kg m^2 of the smallest link.

use std::fmt;

use nalgebra::{Matrix3, Unit, Vector3};

use super::error::GeometryError;
use super::inertia::{about_axis, hollow_cylinder_inertia, parallel_axis, rotate_inertia};
use super::leg::{Leg, LegJoint, LegPose, Segment, joint_name, segments};
use super::tables::Ers7Tables;
use crate::log::ExtraMass;
use crate::number::math;

/// Below this share of `|g|` gravity counts as parallel to the axis: the rest angle would be rounding noise.
const LEAST_ACROSS: f64 = 1e-9;

/// A body that can swing with a leg joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LinkBody {
    /// S in (3.8).
    Shoulder,
    /// U in (3.8).
    UpperLeg,
    /// L in (3.8).
    LowerLeg,
    /// E in (3.8).
    Extra,
}

impl fmt::Display for LinkBody {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            LinkBody::Shoulder => "shoulder",
            LinkBody::UpperLeg => "upper leg",
            LinkBody::LowerLeg => "lower leg",
            LinkBody::Extra => "extra mass",
        })
    }
}

/// An extra mass at a known place of the lower leg: a thin-walled hollow cylinder, its axis along the lower leg (Fig
/// 3.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounted {
    /// \[kg\]
    pub mass_kg: f64,
    /// \[m\]
    pub radius_m: f64,
    /// \[m\]
    pub length_m: f64,
    /// From the knee axis to its centre, along the line from the knee through the lower leg's centre \[m\].
    pub mount_m: f64,
}

impl Mounted {
    /// Places an extra mass of which only the distance from the released joint's axis is known (`distance` in a
    /// sidecar).
    ///
    /// Its centre is taken to lie on the line of the lower leg, beyond the knee. `held` is the pose at which the
    /// distance was taken (the released joint's own entry has no influence). Of two solutions the one further from the
    /// knee is taken.
    ///
    /// # Errors
    /// [`GeometryError::DistanceOutOfReach`] where no point of that line, from the knee downwards, has this distance;
    /// errors of the tables as in [`lump()`].
    pub fn at_distance(
        robot: &Ers7Tables,
        leg: Leg,
        joint: LegJoint,
        held: &LegPose,
        extra: &ExtraMass,
    ) -> Result<Mounted, GeometryError> {
        let legs = segments(robot, leg, &held.with(joint, 0.0))?;
        let (pivot, knee) = (&legs[joint.index()], legs[2].joint_m);
        let line = lower_leg_line(robot, leg, &legs[2])?;
        // |p + s u| = distance, with p the knee and u the line, both seen along the axis.
        let (p, u) = (across(&(knee - pivot.joint_m), &pivot.axis), across(&line, &pivot.axis));
        let (a, b, c) = (u.norm_squared(), p.dot(&u), p.norm_squared() - extra.distance_m * extra.distance_m);
        let discriminant = b * b - a * c;
        let mount_m = (-b + discriminant.sqrt()) / a;
        if !(a > 1e-12 && mount_m.is_finite() && mount_m >= 0.0) {
            let nearest = if a > 1e-12 { (p - u * (b / a).min(0.0)).norm() } else { p.norm() };
            return Err(GeometryError::DistanceOutOfReach {
                joint: joint_name(leg, joint),
                distance_m: extra.distance_m,
                knee_m: p.norm(),
                nearest_m: nearest,
            });
        }
        Ok(Mounted { mass_kg: extra.mass_kg, radius_m: extra.radius_m, length_m: extra.length_m, mount_m })
    }
}

/// What one body adds to the pendulum, per kilogram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyLump {
    /// Which body.
    pub body: LinkBody,
    /// Its mass \[kg\].
    pub mass_kg: f64,
    /// Inertia about the joint axis per kilogram, own inertia and parallel axis (3.8, 3.9) \[m^2\].
    pub inertia_per_kg_m2: f64,
    /// Lever of the centre of mass at encoder angle 0 along `e_d`, down gravity \[m\].
    pub lever_down_m: f64,
    /// Lever of the centre of mass at encoder angle 0 along `e_n = a x e_d` \[m\].
    pub lever_normal_m: f64,
}

impl BodyLump {
    /// Distance of the centre of mass from the joint axis, `D` in (3.9) \[m\].
    pub fn distance_m(&self) -> f64 {
        math::hypot(self.lever_down_m, self.lever_normal_m)
    }
}

/// A leg as one pendulum about one joint: `I* q'' = -g M* sin(q - rest)` plus friction (3.10, 3.12).
#[derive(Clone, Debug, PartialEq)]
pub struct LumpedLink {
    /// The leg.
    pub leg: Leg,
    /// The released joint.
    pub joint: LegJoint,
    /// Joint axis in trunk axes, OPEN-R sense.
    pub axis_trunk: Unit<Vector3<f64>>,
    /// Gravity that acts on the pendulum, `|g - (g.a) a|` \[m/s^2\].
    pub gravity_m_s2: f64,
    /// `I*` about the joint axis \[kg m^2\].
    pub inertia_kg_m2: f64,
    /// `M*`, length of `sum(m r0)` \[kg m\].
    pub moment_kg_m: f64,
    /// Encoder angle at which gravity exerts no torque, in (-pi, pi] \[rad\]; 0 where `M*` is 0.
    pub rest_rad: f64,
    /// The bodies beyond the joint, from the trunk to the foot, the extra mass last.
    pub bodies: Vec<BodyLump>,
}

impl LumpedLink {
    /// Sums the bodies (3.10).
    pub(super) fn assemble(
        leg: Leg,
        joint: LegJoint,
        axis_trunk: Unit<Vector3<f64>>,
        gravity_m_s2: f64,
        bodies: Vec<BodyLump>,
    ) -> Self {
        let zero = 0.0;
        let mut link = LumpedLink {
            leg,
            joint,
            axis_trunk,
            gravity_m_s2,
            inertia_kg_m2: zero,
            moment_kg_m: zero,
            rest_rad: zero,
            bodies,
        };
        link.sum();
        link
    }

    fn sum(&mut self) {
        let (mut inertia, mut down, mut normal) = (0.0, 0.0, 0.0);
        for b in &self.bodies {
            inertia += b.mass_kg * b.inertia_per_kg_m2;
            down += b.mass_kg * b.lever_down_m;
            normal += b.mass_kg * b.lever_normal_m;
        }
        self.inertia_kg_m2 = inertia;
        self.moment_kg_m = math::hypot(down, normal);
        // -alpha0, not atan2(-normal, down): that would give -pi for a link that points straight up.
        self.rest_rad = if normal == 0.0 && down < 0.0 { std::f64::consts::PI } else { math::atan2(-normal, down) };
    }

    /// The same link with one body's mass changed; `I*`, `M*` and the rest angle follow. A body that is not part of
    /// the link changes nothing.
    #[must_use]
    pub fn with_mass(mut self, body: LinkBody, mass_kg: f64) -> Self {
        for b in self.bodies.iter_mut().filter(|b| b.body == body) {
            b.mass_kg = mass_kg;
        }
        self.sum();
        self
    }

    /// One body's coefficients, if it swings with this joint.
    pub fn body(&self, body: LinkBody) -> Option<&BodyLump> {
        self.bodies.iter().find(|b| b.body == body)
    }

    /// Torque of gravity about the axis at an encoder angle, `-g M* sin(q - rest)` \[N m\].
    pub fn gravity_torque_nm(&self, q_rad: f64) -> f64 {
        -self.gravity_m_s2 * self.moment_kg_m * math::sin(q_rad - self.rest_rad)
    }

    /// `g M* / I*` \[1/s^2\], what the simple pendulum calls `g/L` (3.2).
    pub fn stiffness_per_s2(&self) -> f64 {
        self.gravity_m_s2 * self.moment_kg_m / self.inertia_kg_m2
    }
}

/// Lumps the bodies beyond a leg joint into one pendulum (3.8-3.10), exactly.
///
/// `held` gives the encoder angles of the leg's other joints (the released joint's own entry has no influence; joints
/// beyond and before it both count), `gravity_trunk_m_s2` the gravity vector in trunk axes. Where a log says nothing
/// of either, use [`LegPose::STRAIGHT`] and [`super::level_gravity`].
///
/// ```
/// use aibo_fit::geometry::{Ers7Tables, Leg, LegJoint, LegPose, level_gravity, lump};
/// let robot = Ers7Tables::embedded();
/// let knee = lump(robot, Leg::RF, LegJoint::Q3, &LegPose::STRAIGHT, level_gravity(9.81), None)?;
/// assert!((knee.moment_kg_m - 0.036 * 0.045).abs() < 1e-12);
/// assert!((knee.rest_rad + 30f64.to_radians()).abs() < 1e-12); // hangs straight
/// # Ok::<(), aibo_fit::geometry::GeometryError>(())
/// ```
///
/// # Errors
/// [`GeometryError::GravityAlongAxis`] where gravity has no part across the axis (or is zero);
/// [`GeometryError::UnknownPart`], [`GeometryError::UnknownJoint`], [`GeometryError::NoLowerLegLine`] for a robot file
/// without such a leg (never for the embedded one).
pub fn lump(
    robot: &Ers7Tables,
    leg: Leg,
    joint: LegJoint,
    held: &LegPose,
    gravity_trunk_m_s2: Vector3<f64>,
    extra: Option<Mounted>,
) -> Result<LumpedLink, GeometryError> {
    let legs = segments(robot, leg, &held.with(joint, 0.0))?;
    let (pivot, axis) = (legs[joint.index()].joint_m, legs[joint.index()].axis);
    let g_perp = across(&gravity_trunk_m_s2, &axis);
    let (g, g_across) = (gravity_trunk_m_s2.norm(), g_perp.norm());
    if g_across.is_nan() || g_across <= LEAST_ACROSS * g {
        let joint = joint_name(leg, joint);
        return Err(GeometryError::GravityAlongAxis { joint, across_m_s2: g_across, gravity_m_s2: g });
    }
    let e_d = g_perp / g_across;
    let e_n = axis.cross(&e_d);

    let lump_body = |body, mass_kg, per_kg: &Matrix3<f64>, centre_m: Vector3<f64>| {
        let lever = centre_m - pivot;
        BodyLump {
            body,
            mass_kg,
            inertia_per_kg_m2: about_axis(&parallel_axis(per_kg, 1.0, &lever), &axis),
            lever_down_m: lever.dot(&e_d),
            lever_normal_m: lever.dot(&e_n),
        }
    };
    let mut bodies = Vec::with_capacity(4);
    let kinds = [LinkBody::Shoulder, LinkBody::UpperLeg, LinkBody::LowerLeg];
    for (k, kind) in kinds.into_iter().enumerate().skip(joint.index()) {
        let part = robot.part(&robot.joint(&joint_name(leg, LegJoint::ALL[k]))?.child)?;
        let per_kg = rotate_inertia(&part.inertia_per_kg_m2(), &legs[k].rotation);
        bodies.push(lump_body(kind, part.mass_kg, &per_kg, legs[k].centre_m));
    }
    if let Some(e) = extra {
        let line = lower_leg_line(robot, leg, &legs[2])?;
        let per_kg = hollow_cylinder_inertia(1.0, e.radius_m, e.length_m, &line);
        bodies.push(lump_body(LinkBody::Extra, e.mass_kg, &per_kg, legs[2].joint_m + line.into_inner() * e.mount_m));
    }
    Ok(LumpedLink::assemble(leg, joint, axis, g_across, bodies))
}

/// Unit vector from the knee to the lower leg's centre, trunk axes.
fn lower_leg_line(robot: &Ers7Tables, leg: Leg, lower: &Segment) -> Result<Unit<Vector3<f64>>, GeometryError> {
    let knee_in_lower = robot.joint(&joint_name(leg, LegJoint::Q3))?.in_child_m;
    let line = Unit::try_new(lower.rotation * -knee_in_lower, 1e-9);
    line.ok_or_else(|| GeometryError::NoLowerLegLine { leg: leg.to_string() })
}

/// The part of a vector that is perpendicular to the axis.
fn across(v: &Vector3<f64>, axis: &Unit<Vector3<f64>>) -> Vector3<f64> {
    v - axis.into_inner() * v.dot(axis)
}
