//! Legs, their joints, a held pose, and where everything then is in trunk axes.

use std::fmt;
use std::str::FromStr;

use nalgebra::{Rotation3, Unit, Vector3};

use super::error::GeometryError;
use super::tables::Ers7Tables;

/// One of the four legs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Leg {
    /// Left front, `lf`.
    LF,
    /// Right front, `rf`: the leg of the reference swings.
    RF,
    /// Left rear, `lr`.
    LR,
    /// Right rear, `rr`.
    RR,
}

impl Leg {
    /// All legs, in joint order.
    pub const ALL: [Leg; 4] = [Leg::LF, Leg::RF, Leg::LR, Leg::RR];
}

impl fmt::Display for Leg {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Leg::LF => "lf",
            Leg::RF => "rf",
            Leg::LR => "lr",
            Leg::RR => "rr",
        })
    }
}

impl FromStr for Leg {
    type Err = GeometryError;

    /// `lf`, `rf`, `lr`, `rr`, in either case.
    fn from_str(text: &str) -> Result<Self, GeometryError> {
        let found = Leg::ALL.into_iter().find(|leg| leg.to_string().eq_ignore_ascii_case(text));
        found.ok_or_else(|| GeometryError::NotALeg { text: text.to_owned() })
    }
}

/// One of a leg's three joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LegJoint {
    /// Shoulder, fore and aft.
    Q1,
    /// Shoulder, sideways.
    Q2,
    /// Knee.
    Q3,
}

impl LegJoint {
    /// All joints, from the trunk to the foot.
    pub const ALL: [LegJoint; 3] = [LegJoint::Q1, LegJoint::Q2, LegJoint::Q3];

    /// 0, 1, 2 for q1, q2, q3: the place in the arrays of [`super::LegFriction`].
    pub fn index(self) -> usize {
        match self {
            LegJoint::Q1 => 0,
            LegJoint::Q2 => 1,
            LegJoint::Q3 => 2,
        }
    }
}

impl fmt::Display for LegJoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            LegJoint::Q1 => "q1",
            LegJoint::Q2 => "q2",
            LegJoint::Q3 => "q3",
        })
    }
}

impl FromStr for LegJoint {
    type Err = GeometryError;

    /// `q1`, `q2`, `q3`, in either case.
    fn from_str(text: &str) -> Result<Self, GeometryError> {
        let found = LegJoint::ALL.into_iter().find(|joint| joint.to_string().eq_ignore_ascii_case(text));
        found.ok_or_else(|| GeometryError::NotALegJoint { text: text.to_owned() })
    }
}

/// Name of a leg's joint in the tables and in logs: `rf1`.
pub fn joint_name(leg: Leg, joint: LegJoint) -> String {
    format!("{leg}{}", joint.index() + 1)
}

/// Gravity in trunk axes with the trunk level: `(0, -g, 0)` \[m/s^2\]. The default where a log says nothing of the
/// trunk.
pub fn level_gravity(gravity_m_s2: f64) -> Vector3<f64> {
    Vector3::new(0.0, -gravity_m_s2, 0.0)
}

/// Encoder angles of a leg's joints \[rad\], OPEN-R sense and zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegPose {
    /// Positive: foot away from the trunk's middle (front leg: forward).
    pub q1_rad: f64,
    /// Positive: outward.
    pub q2_rad: f64,
    /// Positive: bends more; the leg is straight at -30 degrees.
    pub q3_rad: f64,
}

impl LegPose {
    /// The leg straight: q1 = q2 = 0 and the knee at its hardware stop, -30 degrees, which undoes phi of Table A.1.
    pub const STRAIGHT: LegPose = LegPose { q1_rad: 0.0, q2_rad: 0.0, q3_rad: -std::f64::consts::FRAC_PI_6 };

    /// The angle of one joint \[rad\].
    pub fn angle(&self, joint: LegJoint) -> f64 {
        match joint {
            LegJoint::Q1 => self.q1_rad,
            LegJoint::Q2 => self.q2_rad,
            LegJoint::Q3 => self.q3_rad,
        }
    }

    /// The same pose with one joint at `angle_rad`.
    #[must_use]
    pub fn with(mut self, joint: LegJoint, angle_rad: f64) -> Self {
        match joint {
            LegJoint::Q1 => self.q1_rad = angle_rad,
            LegJoint::Q2 => self.q2_rad = angle_rad,
            LegJoint::Q3 => self.q3_rad = angle_rad,
        }
        self
    }
}

impl Default for LegPose {
    /// [`LegPose::STRAIGHT`]: what is assumed where no pose is known.
    fn default() -> Self {
        Self::STRAIGHT
    }
}

/// One moving part of a leg and the joint it hangs on, in trunk axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// A point on the joint axis.
    pub joint_m: Vector3<f64>,
    /// Joint axis with the OPEN-R sign.
    pub axis: Unit<Vector3<f64>>,
    /// The part's centre.
    pub centre_m: Vector3<f64>,
    /// From the part's axes to trunk axes.
    pub rotation: Rotation3<f64>,
}

/// Shoulder, upper leg and lower leg at a pose, from Table A.1.
pub(super) fn segments(robot: &Ers7Tables, leg: Leg, pose: &LegPose) -> Result<[Segment; 3], GeometryError> {
    let mut centre_m = Vector3::zeros();
    let mut rotation = Rotation3::identity();
    let mut place = |joint: LegJoint| -> Result<Segment, GeometryError> {
        let row = robot.joint(&joint_name(leg, joint))?;
        let joint_m = centre_m + rotation * row.in_parent_m;
        let axis = rotation * row.zero_rotation() * row.signed_axis();
        rotation *= row.rotation(pose.angle(joint));
        centre_m = joint_m - rotation * row.in_child_m;
        Ok(Segment { joint_m, axis, centre_m, rotation })
    };
    Ok([place(LegJoint::Q1)?, place(LegJoint::Q2)?, place(LegJoint::Q3)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn names_round_trip() {
        for leg in Leg::ALL {
            assert_eq!(leg.to_string().to_uppercase().parse::<Leg>().unwrap(), leg);
            for joint in LegJoint::ALL {
                assert_eq!(joint.to_string().parse::<LegJoint>().unwrap(), joint);
                assert!(Ers7Tables::embedded().joint(&joint_name(leg, joint)).is_ok());
            }
        }
        assert_eq!(joint_name(Leg::RF, LegJoint::Q1), "rf1");
        assert_eq!("xf".parse::<Leg>().unwrap_err().to_string(), "\"xf\" is not a leg; use lf, rf, lr or rr");
        assert!("q4".parse::<LegJoint>().is_err());
    }

    #[test]
    fn straight_leg_hangs_straight_down() {
        let robot = Ers7Tables::embedded();
        for leg in Leg::ALL {
            let [_, upper, lower] = segments(robot, leg, &LegPose::STRAIGHT).unwrap();
            assert_relative_eq!(lower.rotation.matrix(), upper.rotation.matrix(), epsilon = 1e-15);
            assert_relative_eq!(lower.centre_m.y, -0.115, epsilon = 1e-15); // 35 + 35 + 45 mm under the shoulder
        }
    }

    #[test]
    fn zero_pose_centres_agree_with_another_engine() {
        let robot = Ers7Tables::embedded();
        // Body positions of the MuJoCo model of the same tables, trunk frame, right front leg.
        let [shoulder, upper, lower] = segments(robot, Leg::RF, &LegPose::STRAIGHT.with(LegJoint::Q3, 0.0)).unwrap();
        assert_relative_eq!(shoulder.centre_m, Vector3::new(0.05, 0.0, -0.065), epsilon = 1e-15);
        assert_relative_eq!(upper.centre_m, Vector3::new(0.0625, -0.035, -0.065), epsilon = 1e-15);
        let expected = upper.centre_m + Vector3::new(0.0047, -0.073_971_143_170_3, -0.0315);
        assert_relative_eq!(lower.centre_m, expected, epsilon = 1e-14);
    }
}
