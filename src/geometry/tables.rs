//! The ERS-7 as data: parts (Table A.2), joints (Table A.1), leg friction (Tables 3.3 and 3.4).
//!
//! The numbers live in `data/ers7.toml`, as printed, with a comment beside every misprint that had to be decided; this
//! module reads them once, checks them and turns mm and degrees into m and rad. Frames: x right, y up, z to the rear,
//! at each part's centre. Joint order and names are those of the logs: `lf1..3`, `rf1..3`, `lr1..3`, `rr1..3`,
//! `neck_tilt1`, ...

use std::collections::BTreeSet;
use std::sync::OnceLock;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use serde::Deserialize;

use super::error::GeometryError;
use super::inertia::ellipsoid_inertia_from_diameters;
use super::leg::LegJoint;

/// The `schema` this code reads.
const SCHEMA: u32 = 1;

/// A coordinate axis of a part's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// To the right.
    X,
    /// Upwards.
    Y,
    /// To the rear.
    Z,
}

impl Axis {
    /// The unit vector.
    pub fn unit(self) -> Unit<Vector3<f64>> {
        match self {
            Axis::X => Vector3::x_axis(),
            Axis::Y => Vector3::y_axis(),
            Axis::Z => Vector3::z_axis(),
        }
    }
}

/// One body part: an ellipsoid with its centre of mass at its centre (Table A.2).
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// `rf_lower` for instance.
    pub name: String,
    /// Diameters along x, y, z \[m\].
    pub diameters_m: Vector3<f64>,
    /// \[kg\]; 0 for the ghosts that make two-axis joints.
    pub mass_kg: f64,
    /// Principal inertias as printed, three digits \[kg m^2\].
    pub printed_inertia_kg_m2: Vector3<f64>,
    /// The printed floor-contact point in the part's frame \[m\]; lower legs only.
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
    /// Name of the part nearer to the trunk.
    pub parent: String,
    /// Name of the part it moves.
    pub child: String,
    /// Axis of rotation, the same in the turned parent's and in the child's frame.
    pub axis: Axis,
    /// +1 or -1: a positive angle turns about `sign * axis` (OPEN-R sense).
    pub sign: f64,
    /// The joint in the parent's frame \[m\].
    pub in_parent_m: Vector3<f64>,
    /// The joint in the child's frame \[m\].
    pub in_child_m: Vector3<f64>,
    /// Orientation of the child at angle 0, the phi columns \[rad\] about x, y, z.
    pub phi_rad: Vector3<f64>,
}

impl Joint {
    /// `R(phi)`: the child's orientation in the parent's frame at angle 0 (Rz Ry Rx; every printed phi is about x
    /// alone).
    pub fn zero_rotation(&self) -> Rotation3<f64> {
        Rotation3::from_euler_angles(self.phi_rad.x, self.phi_rad.y, self.phi_rad.z)
    }

    /// Axis with the OPEN-R sign, in the child's frame (and in the parent's after [`Joint::zero_rotation`]).
    pub fn signed_axis(&self) -> Unit<Vector3<f64>> {
        Unit::new_unchecked(self.axis.unit().into_inner() * self.sign)
    }

    /// The child's orientation in the parent's frame at angle `q_rad`: `R(phi) Rot(sign * axis, q)`.
    pub fn rotation(&self, q_rad: f64) -> Rotation3<f64> {
        self.zero_rotation() * Rotation3::from_axis_angle(&self.signed_axis(), q_rad)
    }
}

/// Friction of the three leg joints (eqs 3.11, 3.14), indexed by joint 1, 2, 3. The text's "m" means N m, because
/// `F_n = 1`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LegFriction {
    /// Coulomb friction `mu_c` \[N m\].
    pub coulomb_nm: [f64; 3],
    /// Viscous friction `mu_v` \[N m s/rad\].
    pub viscous_nm_s_rad: [f64; 3],
    /// Static friction `mu_st` \[N m\]; 0: term absent.
    #[serde(default)]
    pub static_nm: [f64; 3],
    /// Stribeck speed `v_st` \[rad/s\]; 0: term absent.
    #[serde(default)]
    pub stribeck_rad_s: [f64; 3],
    /// Steepness `s` of the regularised sign \[s/rad\]; 0: term absent.
    #[serde(default)]
    pub steepness_s_rad: [f64; 3],
}

impl LegFriction {
    /// Coulomb \[N m\] and viscous \[N m s/rad\] friction of one joint.
    pub fn of(&self, joint: LegJoint) -> (f64, f64) {
        (self.coulomb_nm[joint.index()], self.viscous_nm_s_rad[joint.index()])
    }
}

/// The two friction tables, which disagree about q3 (0.020 and 0.010 N m).
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
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
            Self::from_toml(include_str!("../../data/ers7.toml")).expect("data/ers7.toml is compiled in and tested")
        })
    }

    /// Reads a robot file in the format of `data/ers7.toml`.
    ///
    /// # Errors
    /// [`GeometryError::Toml`] with line and column, [`GeometryError::Schema`], [`GeometryError::Value`],
    /// [`GeometryError::Twice`], [`GeometryError::UnknownPart`], [`GeometryError::Tree`].
    pub fn from_toml(text: &str) -> Result<Self, GeometryError> {
        let raw: RawRobot = toml::from_str(text)?;
        if raw.schema != SCHEMA {
            return Err(GeometryError::Schema { found: raw.schema, supported: SCHEMA });
        }
        let robot = Ers7Tables {
            name: raw.name,
            root: raw.root,
            parts: raw.part.into_iter().map(RawPart::check).collect::<Result<_, _>>()?,
            joints: raw.joint.into_iter().map(RawJoint::check).collect::<Result<_, _>>()?,
            friction: raw.friction,
        };
        robot.check_tree()?;
        check_friction("friction.estimated", &robot.friction.estimated)?;
        check_friction("friction.chosen", &robot.friction.chosen)?;
        Ok(robot)
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

    fn check_tree(&self) -> Result<(), GeometryError> {
        let mut parts = BTreeSet::new();
        for part in &self.parts {
            if !parts.insert(part.name.as_str()) {
                return Err(GeometryError::Twice { name: part.name.clone(), what: "part" });
            }
        }
        self.part(&self.root)?;
        let mut names = BTreeSet::new();
        let mut hung = BTreeSet::from([self.root.as_str()]);
        for joint in &self.joints {
            self.part(&joint.parent)?;
            self.part(&joint.child)?;
            if !names.insert(joint.name.as_str()) {
                return Err(GeometryError::Twice { name: joint.name.clone(), what: "joint" });
            }
            if !hung.contains(joint.parent.as_str()) {
                return Err(GeometryError::Tree { joint: joint.name.clone(), parent: joint.parent.clone() });
            }
            if !hung.insert(joint.child.as_str()) {
                return Err(GeometryError::Twice { name: joint.child.clone(), what: "child" });
            }
        }
        Ok(())
    }
}

/// The file as written, before units are converted.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRobot {
    schema: u32,
    name: String,
    root: String,
    part: Vec<RawPart>,
    joint: Vec<RawJoint>,
    friction: FrictionTables,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPart {
    name: String,
    diameter_m: [f64; 3],
    mass_kg: f64,
    printed_inertia_kg_m2: [f64; 3],
    contact_mm: Option<[f64; 3]>,
}

impl RawPart {
    fn check(self) -> Result<Part, GeometryError> {
        for d in self.diameter_m {
            require(d.is_finite() && d > 0.0, &self.name, "diameter_m", d, "above 0 m")?;
        }
        let m = self.mass_kg;
        require(m.is_finite() && m >= 0.0, &self.name, "mass_kg", m, "0 kg or above")?;
        for i in self.printed_inertia_kg_m2 {
            require(i.is_finite() && i >= 0.0, &self.name, "printed_inertia_kg_m2", i, "0 kg m^2 or above")?;
        }
        let contact_m = match self.contact_mm {
            Some(c) => Some(metres(&self.name, "contact_mm", c)?),
            None => None,
        };
        Ok(Part {
            diameters_m: Vector3::from(self.diameter_m),
            mass_kg: m,
            printed_inertia_kg_m2: Vector3::from(self.printed_inertia_kg_m2),
            contact_m,
            name: self.name,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawJoint {
    name: String,
    parent: String,
    child: String,
    axis: Axis,
    sign: i8,
    parent_mm: [f64; 3],
    child_mm: [f64; 3],
    phi_deg: [f64; 3],
}

impl RawJoint {
    fn check(self) -> Result<Joint, GeometryError> {
        let sign = f64::from(self.sign);
        require(sign.abs() == 1.0, &self.name, "sign", sign, "1 or -1")?;
        for p in self.phi_deg {
            require(p.is_finite() && p.abs() <= 360.0, &self.name, "phi_deg", p, "-360 to 360 degrees")?;
        }
        Ok(Joint {
            axis: self.axis,
            sign,
            in_parent_m: metres(&self.name, "parent_mm", self.parent_mm)?,
            in_child_m: metres(&self.name, "child_mm", self.child_mm)?,
            phi_rad: Vector3::from(self.phi_deg).map(f64::to_radians),
            name: self.name,
            parent: self.parent,
            child: self.child,
        })
    }
}

fn metres(item: &str, key: &'static str, mm: [f64; 3]) -> Result<Vector3<f64>, GeometryError> {
    for v in mm {
        require(v.is_finite(), item, key, v, "a finite number of mm")?;
    }
    // Division, not multiplication by 1e-3: 12.5 mm becomes the double nearest to 0.0125.
    Ok(Vector3::from(mm).map(|v| v / 1000.0))
}

fn check_friction(item: &str, f: &LegFriction) -> Result<(), GeometryError> {
    let columns = [
        ("coulomb_nm", f.coulomb_nm),
        ("viscous_nm_s_rad", f.viscous_nm_s_rad),
        ("static_nm", f.static_nm),
        ("stribeck_rad_s", f.stribeck_rad_s),
        ("steepness_s_rad", f.steepness_s_rad),
    ];
    for (key, values) in columns {
        for v in values {
            require(v.is_finite() && v >= 0.0, item, key, v, "0 or above")?;
        }
    }
    Ok(())
}

fn require(ok: bool, item: &str, key: &'static str, value: f64, allowed: &'static str) -> Result<(), GeometryError> {
    if ok { Ok(()) } else { Err(GeometryError::Value { item: item.to_owned(), key, value, allowed }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const TEXT: &str = include_str!("../../data/ers7.toml");

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
                let (ours, printed) = (part.inertia_kg_m2()[(k, k)], part.printed_inertia_kg_m2[k]);
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

    #[test]
    fn bad_robot_files_name_the_item_and_the_key() {
        let err = |from: &str, to: &str| {
            assert!(TEXT.contains(from));
            Ers7Tables::from_toml(&TEXT.replacen(from, to, 1)).unwrap_err()
        };
        assert_eq!(err("schema = 1", "schema = 2"), GeometryError::Schema { found: 2, supported: 1 });
        let e = err("mass_kg = 0.9132", "mass_kg = -1.0").to_string();
        assert_eq!(e, "robot file: trunk: mass_kg = -1, allowed: 0 kg or above");
        assert!(err("axis = \"x\"", "axis = \"w\"").to_string().contains("line"));
        assert!(err("mass_kg = 0.9132", "mass_kg = 0.9132\ncolour = 1").to_string().contains("colour"));
        assert!(matches!(err("sign = 1", "sign = 0"), GeometryError::Value { key: "sign", .. }));
        assert!(matches!(err("name = \"lf2\"", "name = \"lf1\""), GeometryError::Twice { what: "joint", .. }));
        assert!(matches!(err("parent = \"lf_shoulder\"", "parent = \"head\""), GeometryError::Tree { .. }));
        assert!(matches!(err("parent = \"head\"", "parent = \"hat\""), GeometryError::UnknownPart { .. }));
    }
}
