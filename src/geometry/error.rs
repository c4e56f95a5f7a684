//! What can be wrong with a question about a leg.

/// Errors of the geometry layer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A part that the tables do not have.
    #[error("no part {name} in the robot's tables")]
    UnknownPart {
        /// The name that was looked for.
        name: String,
    },
    /// A joint that the tables do not have.
    #[error("no joint {name} in the robot's tables")]
    UnknownJoint {
        /// The name that was looked for.
        name: String,
    },
    /// Text that names no leg.
    #[error("{text:?} is not a leg; use lf, rf, lr or rr")]
    NotALeg {
        /// The text.
        text: String,
    },
    /// Text that names no leg joint.
    #[error("{text:?} is not a leg joint; use q1, q2 or q3")]
    NotALegJoint {
        /// The text.
        text: String,
    },
    /// Gravity has no part across the joint axis: no rest angle exists and the joint is no pendulum.
    #[error(
        "joint {joint}: gravity across the axis is {across_m_s2} m/s^2 of {gravity_m_s2} m/s^2; \
         the joint has no rest angle"
    )]
    GravityAlongAxis {
        /// The joint, `rf1` for instance.
        joint: String,
        /// `|g - (g.a) a|`.
        across_m_s2: f64,
        /// `|g|`.
        gravity_m_s2: f64,
    },
    /// No point of the lower leg's line, from the knee downwards, lies at the given distance from the joint axis.
    #[error(
        "joint {joint}: no point on the line of the lower leg is {distance_m} m from the axis at this pose \
         (the knee is {knee_m} m, the nearest point {nearest_m} m from it)"
    )]
    DistanceOutOfReach {
        /// The joint.
        joint: String,
        /// The distance asked for.
        distance_m: f64,
        /// Distance of the knee from the axis.
        knee_m: f64,
        /// Smallest distance on the line.
        nearest_m: f64,
    },
    /// The knee lies at the lower leg's centre, so the leg has no line.
    #[error("leg {leg}: the knee lies at the centre of the lower leg, which leaves the line of the leg undefined")]
    NoLowerLegLine {
        /// The leg.
        leg: String,
    },
}
