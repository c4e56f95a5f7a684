//! The ERS-7 as data: parts (Table A.2), joints (Tables A.1, A.3), leg friction (Tables 3.3 and 3.4).
//!
//! The numbers live in `data/ers7.toml`, as printed, with a comment beside every misprint that had to be decided;
//! [`robot_file`](super::robot_file) reads them once, checks them and turns mm and degrees into m and rad. Frames: x
//! right, y up, z to the rear, at each part's centre. Joint order and names are those of the logs: `lf1..3`, `rf1..3`,
//! `lr1..3`, `rr1..3`, `neck_tilt1`, ...

use std::path::Path;
use std::sync::OnceLock;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use super::error::GeometryError;
use super::inertia::ellipsoid_inertia_from_diameters;
use super::leg::LegJoint;
use super::robot_file::{FrictionSet, RobotTables};
use crate::log::LogError;

/// One body part: an ellipsoid with its centre of mass at its centre (Table A.2).
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// `rf_lower` for instance.
    pub name: String,
    /// Diameters along x, y, z \[m\].
    pub diameters_m: Vector3<f64>,
    /// \[kg\]; 0 for the ghosts that make two-axis joints.
    pub mass_kg: f64,
    /// Moments of inertia about the centre, along x, y, z \[kg m^2\]: as the file states them (for the ERS-7 the
    /// printed three digits), or (3.1) where it does not.
    pub stated_inertia_kg_m2: Vector3<f64>,
    /// The printed floor-contact point in the part's frame \[m\]; only parts that touch the floor have one.
    pub contact_m: Option<Vector3<f64>>,
}

impl Part {
    /// Inertia tensor about the centre from mass and size (eq. 3.1) \[kg m^2\].
    ///
    /// The printed inertia is this, rounded to three digits (0 for ghosts in both). Lumping uses this one, because it
    /// scales with a fitted mass.
    pub fn inertia_kg_m2(&self) -> Matrix3<f64> {
        ellipsoid_inertia_from_diameters(self.mass_kg, &self.diameters_m)
    }

    /// Inertia tensor per kilogram (eq. 3.1) \[m^2\].
    pub fn inertia_per_kg_m2(&self) -> Matrix3<f64> {
        ellipsoid_inertia_from_diameters(1.0, &self.diameters_m)
    }
}

/// One joint with its two sides (Table A.1).
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// `rf1` for instance.
    pub name: String,
    /// What joints that share friction and gains have in common, `q1` for instance; the name where nothing is shared.
    pub kind: String,
    /// Name of the part nearer to the trunk.
    pub parent: String,
    /// Name of the part it moves.
    pub child: String,
    /// Axis of rotation, the same in the turned parent's and in the child's frame.
    pub axis: Unit<Vector3<f64>>,
    /// +1 or -1: a positive angle turns about `sign * axis` (OPEN-R sense).
    pub sign: f64,
    /// The joint in the parent's frame \[m\].
    pub in_parent_m: Vector3<f64>,
    /// The joint in the child's frame \[m\].
    pub in_child_m: Vector3<f64>,
    /// Orientation of the child at angle 0, the phi columns \[rad\] about x, y, z.
    pub phi_rad: Vector3<f64>,
    /// Mechanical limits, least and greatest \[rad\] (Table A.3).
    pub hardware_rad: Option<[f64; 2]>,
    /// Limits of the robot's own software, within the hardware's \[rad\] (Table A.3).
    pub software_rad: Option<[f64; 2]>,
    /// Speed limit \[rad/s\] (Table A.3).
    pub speed_rad_s: Option<f64>,
    /// A spring that holds a joint without a controller.
    pub spring: Option<JointSpring>,
}

/// A spring and a damper about a joint: `tau = -k (q - q_s) - d q'`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSpring {
    /// Stiffness \[N m/rad\].
    pub stiffness_nm_rad: f64,
    /// Damping \[N m s/rad\].
    pub damping_nm_s_rad: f64,
    /// Angle at which it is slack \[rad\].
    pub rest_rad: f64,
}

impl Joint {
    /// Where the joint is at rest \[rad\]: as near to zero as its setpoints may go. The mouth cannot go there.
    pub fn resting_rad(&self) -> f64 {
        self.software_rad.map_or(0.0, |[low, high]| 0.0_f64.clamp(low, high))
    }

    /// `R(phi)`: the child's orientation in the parent's frame at angle 0 (Rz Ry Rx; every printed phi is about x
    /// alone).
    pub fn zero_rotation(&self) -> Rotation3<f64> {
        Rotation3::from_euler_angles(self.phi_rad.x, self.phi_rad.y, self.phi_rad.z)
    }

    /// Axis with the OPEN-R sign, in the child's frame (and in the parent's after [`Joint::zero_rotation`]).
    pub fn signed_axis(&self) -> Unit<Vector3<f64>> {
        Unit::new_unchecked(self.axis.into_inner() * self.sign)
    }

    /// The child's orientation in the parent's frame at angle `q_rad`: `R(phi) Rot(sign * axis, q)`.
    pub fn rotation(&self, q_rad: f64) -> Rotation3<f64> {
        self.zero_rotation() * Rotation3::from_axis_angle(&self.signed_axis(), q_rad)
    }
}

/// Friction of the three leg joints (eqs 3.11, 3.14), indexed by joint 1, 2, 3. The text's "m" means N m, because
/// `F_n = 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct LegFriction {
    /// Coulomb friction `mu_c` \[N m\].
    pub coulomb_nm: [f64; 3],
    /// Viscous friction `mu_v` \[N m s/rad\].
    pub viscous_nm_s_rad: [f64; 3],
    /// Static friction `mu_st` \[N m\]; 0: term absent.
    pub static_nm: [f64; 3],
    /// Stribeck speed `v_st` \[rad/s\]; 0: term absent.
    pub stribeck_rad_s: [f64; 3],
    /// Steepness `s` of the regularised sign \[s/rad\]; 0: term absent.
    pub steepness_s_rad: [f64; 3],
}

impl LegFriction {
    /// Friction of the kinds q1, q2 and q3; `None` where the set lacks one.
    fn of_set(set: &FrictionSet) -> Option<Self> {
        let row = |kind: &LegJoint| set.by_joint.iter().find(|(name, _)| *name == kind.to_string()).map(|(_, row)| row);
        let [Some(q1), Some(q2), Some(q3)] = LegJoint::ALL.each_ref().map(row) else { return None };
        let rows = [q1, q2, q3];
        Some(Self {
            coulomb_nm: rows.map(|row| row.coulomb_nm),
            viscous_nm_s_rad: rows.map(|row| row.viscous_nm_s_rad),
            static_nm: rows.map(|row| row.static_nm),
            stribeck_rad_s: rows.map(|row| row.stribeck_rad_s),
            steepness_s_rad: rows.map(|row| row.steepness_s_rad),
        })
    }

    /// Coulomb \[N m\] and viscous \[N m s/rad\] friction of one joint.
    pub fn of(&self, joint: LegJoint) -> (f64, f64) {
        (self.coulomb_nm[joint.index()], self.viscous_nm_s_rad[joint.index()])
    }
}

/// The two friction tables, which disagree about q3 (0.020 and 0.010 N m).
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionTables {
    /// Table 3.3: estimated from swings; the reference swings were made with it.
    pub estimated: LegFriction,
    /// Table 3.4: chosen for the walking model.
    pub chosen: LegFriction,
}

/// A robot in the format of `data/ers7.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct Ers7Tables {
    /// `ers7`, or the name in a user's file.
    pub name: String,
    /// The part that is on no joint: `trunk`.
    pub root: String,
    /// Table A.2, in file order.
    pub parts: Vec<Part>,
    /// Table A.1, in joint order; a joint's parent always hangs on an earlier joint.
    pub joints: Vec<Joint>,
    /// Tables 3.3 and 3.4.
    pub friction: FrictionTables,
}

impl Ers7Tables {
    /// The thesis's robot, parsed from the embedded `data/ers7.toml` on first use.
    ///
    /// ```
    /// let robot = aibo_fit::geometry::Ers7Tables::embedded();
    /// assert!((robot.total_mass_kg() - 1.6913).abs() < 1e-12); // as printed under Table A.2
    /// ```
    pub fn embedded() -> &'static Ers7Tables {
        static TABLES: OnceLock<Ers7Tables> = OnceLock::new();
        TABLES.get_or_init(|| {
            Self::from_toml(super::robot_file::ERS7_TOML).expect("data/ers7.toml is compiled in and tested")
        })
    }

    /// Reads a robot file in the format of `data/ers7.toml` that has friction sets `estimated` and `chosen`.
    ///
    /// # Errors
    /// [`LogError`] with line and key.
    pub fn from_toml(text: &str) -> Result<Self, LogError> {
        let file = Path::new("data/ers7.toml");
        let tables = RobotTables::from_toml(file, text)?;
        let legs = |name: &str| {
            let set = tables.friction_set(name);
            set.and_then(LegFriction::of_set).ok_or_else(|| LogError::MissingKey {
                file: file.to_path_buf(),
                key: format!("[friction.{name}]"),
                expected: "friction of q1, q2 and q3".to_owned(),
            })
        };
        let friction = FrictionTables { estimated: legs("estimated")?, chosen: legs("chosen")? };
        Ok(Ers7Tables { name: tables.name, root: tables.root, parts: tables.parts, joints: tables.joints, friction })
    }

    /// A part by name.
    ///
    /// # Errors
    /// [`GeometryError::UnknownPart`].
    pub fn part(&self, name: &str) -> Result<&Part, GeometryError> {
        let found = self.parts.iter().find(|p| p.name == name);
        found.ok_or_else(|| GeometryError::UnknownPart { name: name.to_owned() })
    }

    /// A joint by name.
    ///
    /// # Errors
    /// [`GeometryError::UnknownJoint`].
    pub fn joint(&self, name: &str) -> Result<&Joint, GeometryError> {
        let found = self.joints.iter().find(|j| j.name == name);
        found.ok_or_else(|| GeometryError::UnknownJoint { name: name.to_owned() })
    }

    /// Mass of all parts \[kg\]; Table A.2 prints 1.6913.
    pub fn total_mass_kg(&self) -> f64 {
        self.parts.iter().map(|p| p.mass_kg).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn table_a_1_joint_order_and_tree() {
        let names: Vec<&str> = Ers7Tables::embedded().joints.iter().map(|j| j.name.as_str()).collect();
        let order = "lf1 lf2 lf3 rf1 rf2 rf3 lr1 lr2 lr3 rr1 rr2 rr3 neck_tilt1 neck_pan neck_tilt2 mouth \
                     ear_l_tilt ear_l_pan ear_r_tilt ear_r_pan tail_tilt tail_pan";
        assert_eq!(names, order.split_whitespace().collect::<Vec<_>>());
        assert_eq!(Ers7Tables::embedded().parts.len(), names.len() + 1);
    }

    #[test]
    fn table_a_1_legs_mirror_each_other() {
        let robot = Ers7Tables::embedded();
        for (left, right) in [("lf", "rf"), ("lr", "rr")] {
            for n in 1..=3 {
                let (l, r) =
                    (robot.joint(&format!("{left}{n}")).unwrap(), robot.joint(&format!("{right}{n}")).unwrap());
                let flip = |v: &Vector3<f64>| Vector3::new(-v.x, v.y, v.z);
                assert_eq!(flip(&l.in_parent_m), r.in_parent_m);
                assert_eq!(flip(&l.in_child_m), r.in_child_m);
                assert_eq!(l.phi_rad, r.phi_rad);
            }
        }
    }

    #[test]
    fn table_a_2_printed_inertias_follow_3_1_within_printed_digits() {
        for part in &Ers7Tables::embedded().parts {
            for k in 0..3 {
                let (ours, printed) = (part.inertia_kg_m2()[(k, k)], part.stated_inertia_kg_m2[k]);
                let half_digit = if printed == 0.0 { 0.0 } else { 0.5 * 10f64.powf(printed.log10().floor() - 2.0) };
                assert!(
                    (ours - printed).abs() <= half_digit * 1.000_001,
                    "{} axis {k}: (3.1) {ours:e}, printed {printed:e}",
                    part.name
                );
            }
        }
    }

    #[test]
    fn table_a_2_total_mass_and_19_parts() {
        let robot = Ers7Tables::embedded();
        assert_relative_eq!(robot.total_mass_kg(), 1.6913, epsilon = 1e-12);
        assert_eq!(robot.parts.iter().filter(|p| p.mass_kg > 0.0).count(), 19);
    }

    #[test]
    fn tables_3_2_to_3_4_as_printed() {
        let robot = Ers7Tables::embedded();
        for (part, mass) in [("rf_shoulder", 0.04), ("rf_upper", 0.052), ("rf_lower", 0.036)] {
            assert_eq!(robot.part(part).unwrap().mass_kg, mass);
        }
        let f = &robot.friction;
        assert_eq!(f.estimated.of(LegJoint::Q1), (0.001, 0.017));
        assert_eq!(f.estimated.of(LegJoint::Q2), (0.007, 0.019));
        assert_eq!((f.estimated.of(LegJoint::Q3), f.chosen.of(LegJoint::Q3)), ((0.020, 0.010), (0.010, 0.010)));
        assert_eq!(f.estimated.static_nm, [0.0; 3]);
    }

    #[test]
    fn bare_lower_leg_sticks_at_0_020_and_would_swing_at_0_010() {
        let robot = Ers7Tables::embedded();
        // M g D of the lower leg held level about the knee: 0.036 * 9.81 * 0.045.
        let torque = robot.part("rf_lower").unwrap().mass_kg * 9.81 * robot.joint("rf3").unwrap().in_child_m.y;
        assert_relative_eq!(torque, 0.0159, epsilon = 0.5e-4);
        assert!(torque < robot.friction.estimated.of(LegJoint::Q3).0);
        assert!(torque > robot.friction.chosen.of(LegJoint::Q3).0);
    }
}
