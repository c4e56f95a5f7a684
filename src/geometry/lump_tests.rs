//! Lumping against printed values, against another engine, and its properties.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::{Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;
use serde::Deserialize;

use super::*;
use crate::log::ExtraMass;

/// `data/pose.toml`: the poses of the reference swings and the hanging angles the other engine's author computed.
#[derive(Deserialize)]
struct Poses {
    leg: String,
    q1: Pose,
    q2: Pose,
    q3: Pose,
}

#[derive(Deserialize)]
struct Pose {
    held: std::collections::BTreeMap<String, f64>,
    gravity: [f64; 3],
    mount: f64,
    hanging: std::collections::BTreeMap<String, f64>,
}

struct Case {
    leg: Leg,
    joint: LegJoint,
    held: LegPose,
    gravity: Vector3<f64>,
    mount_m: f64,
    hanging: std::collections::BTreeMap<String, f64>,
}

fn swing_cases() -> Vec<Case> {
    let poses: Poses = toml::from_str(include_str!("../../data/pose.toml")).unwrap();
    let leg: Leg = poses.leg.parse().unwrap();
    let pairs = LegJoint::ALL.into_iter().zip([poses.q1, poses.q2, poses.q3]);
    let case = |(joint, pose): (LegJoint, Pose)| {
        let angle = |j| pose.held.get(&joint_name(leg, j)).copied().unwrap_or(f64::NAN);
        // The released joint stays NaN: its entry must have no influence.
        let held = LegPose { q1_rad: angle(LegJoint::Q1), q2_rad: angle(LegJoint::Q2), q3_rad: angle(LegJoint::Q3) };
        Case { leg, joint, held, gravity: Vector3::from(pose.gravity), mount_m: pose.mount, hanging: pose.hanging }
    };
    pairs.map(case).collect()
}

impl Case {
    fn lump(&self, extra: Option<Mounted>) -> LumpedLink {
        lump(Ers7Tables::embedded(), self.leg, self.joint, &self.held, self.gravity, extra).unwrap()
    }

    /// The cylinders of the sidecars in `data/thesis-robot/`.
    fn mounted(&self, load: &str) -> Option<Mounted> {
        let (mass_kg, radius_m, length_m) = match load {
            "bare" => return None,
            "220g" => (0.220, 0.015, 0.030),
            "402g" => (0.402, 0.018, 0.038),
            other => panic!("load {other}"),
        };
        Some(Mounted { mass_kg, radius_m, length_m, mount_m: self.mount_m })
    }

    fn extra_at_its_distance(&self, load: &str) -> Option<ExtraMass> {
        let m = self.mounted(load)?;
        let distance_m = self.lump(Some(m)).body(LinkBody::Extra).unwrap().distance_m();
        Some(ExtraMass { mass_kg: m.mass_kg, distance_m, radius_m: m.radius_m, length_m: m.length_m })
    }
}

const LOADS: [&str; 3] = ["bare", "220g", "402g"];

#[test]
fn hanging_angles_of_the_reference_swings() {
    for case in swing_cases() {
        assert_eq!(case.hanging.len(), LOADS.len());
        for load in LOADS {
            let link = case.lump(case.mounted(load));
            // Printed to 4 digits; the gravity vector to 6.
            assert_relative_eq!(link.rest_rad, case.hanging[load], epsilon = 0.6e-4);
            assert_relative_eq!(link.gravity_torque_nm(link.rest_rad), 0.0);
        }
    }
}

#[test]
fn sidecar_distances_and_the_mount_that_gives_them() {
    let printed = [(LegJoint::Q1, 0.1705), (LegJoint::Q2, 0.1697), (LegJoint::Q3, 0.1320)];
    for (case, (joint, distance_m)) in swing_cases().iter().zip(printed) {
        assert_eq!(case.joint, joint);
        for load in ["220g", "402g"] {
            let m = case.mounted(load).unwrap();
            let extra = case.extra_at_its_distance(load).unwrap();
            assert_relative_eq!(extra.distance_m, distance_m, epsilon = 0.5e-4); // printed to 0.1 mm
            let robot = Ers7Tables::embedded();
            let back = Mounted::at_distance(robot, case.leg, joint, &case.held, &extra).unwrap();
            assert_relative_eq!(back.mount_m, m.mount_m, epsilon = 1e-12);
            let rounded = ExtraMass { distance_m, ..extra };
            let from_print = Mounted::at_distance(robot, case.leg, joint, &case.held, &rounded).unwrap();
            assert_relative_eq!(from_print.mount_m, m.mount_m, epsilon = 0.6e-4);
        }
    }
}

#[test]
fn table_3_1_g_over_l_of_the_loaded_leg() {
    // "the places at which 9.81 M*/I* is about 60 (q1, q2) and 75 (q3)": data/README.md. Here, with 0.220 and 0.402 kg:
    let here = [[60.62, 58.95], [61.11, 59.34], [75.84, 74.41]];
    for (case, here) in swing_cases().iter().zip(here) {
        let thesis = if case.joint == LegJoint::Q3 { 75.0 } else { 60.0 };
        for (load, here) in ["220g", "402g"].into_iter().zip(here) {
            let link = case.lump(case.mounted(load));
            let ratio = 9.81 * link.moment_kg_m / link.inertia_kg_m2;
            assert_relative_eq!(ratio, here, epsilon = 0.005);
            assert!((ratio - thesis).abs() < 0.02 * thesis, "{} {load}: {ratio}", case.joint);
        }
    }
}

#[test]
fn bare_lower_leg_has_0_0159_newton_metres() {
    let q3 = &swing_cases()[2];
    let link = q3.lump(None);
    let most = link.gravity_torque_nm(link.rest_rad - PI / 2.0);
    assert_relative_eq!(most, 0.0159, epsilon = 0.5e-4); // spec, 0.036 * 9.81 * 0.045
}

/// A resting state of the whole robot, trunk turned in space: mass-matrix diagonal and gravity bias of the twelve leg
/// joints, computed by Pinocchio 4.1.0 and MuJoCo 4.0.0 (which agree to 1e-13) from Tables A.1 and A.2 as printed.
#[test]
fn inertia_and_gravity_torque_agree_with_another_engine_on_every_leg() {
    let turn = Quaternion::new(-0.631822566864412, -0.3225621997236262, -0.703514948749578, 0.0426683512242957);
    let to_trunk = UnitQuaternion::new_unchecked(turn).inverse();
    let gravity = to_trunk * level_gravity(9.81);
    let q = [
        -0.113543, 0.689273, 0.993093, 2.336174, 1.232368, 1.181296, 2.045266, 0.144057, -0.084587, 0.369969,
        -0.178969, -0.425829,
    ];
    let diagonal = [
        0.0002925429427311941,
        0.0002765254689408265,
        9.109999999999999e-05,
        0.00016490606916455067,
        0.00023519212476081827,
        9.109999999999999e-05,
        0.0005714027744937007,
        0.0005392439058667568,
        9.2e-05,
        0.0005875079235020455,
        0.0005741081049673397,
        9.2e-05,
    ];
    let bias = [
        0.02811104070852328,
        0.011185814784159722,
        0.014598779930797771,
        -0.01381970137894605,
        -0.029446904194815486,
        -0.011079855167809322,
        0.05190679280178317,
        -0.02190093956609395,
        0.013921307649701016,
        -0.004443533903883431,
        0.015177788583689837,
        -0.0008973641198388614,
    ];
    for (l, leg) in Leg::ALL.into_iter().enumerate() {
        let pose = LegPose { q1_rad: q[3 * l], q2_rad: q[3 * l + 1], q3_rad: q[3 * l + 2] };
        for joint in LegJoint::ALL {
            let k = 3 * l + joint.index();
            let link = lump(Ers7Tables::embedded(), leg, joint, &pose, gravity, None).unwrap();
            // Inertias there are the printed ones: half a digit of three bodies.
            assert_relative_eq!(link.inertia_kg_m2, diagonal[k], epsilon = 1e-7);
            // bias is the torque that would hold the joint.
            assert_relative_eq!(link.gravity_torque_nm(q[k]), -bias[k], epsilon = 1e-12);
        }
    }
}

/// Section 3.3.2: "The mass of the shoulder has no or little effect on the estimation, since it is located at the
/// rotation axis."
#[test]
fn shoulder_mass_has_little_effect_on_q1() {
    let q1 = &swing_cases()[0];
    for (load, percent) in LOADS.into_iter().zip([3.23, 0.27, 0.16]) {
        let link = q1.lump(q1.mounted(load));
        let shoulder = link.body(LinkBody::Shoulder).unwrap();
        assert_relative_eq!(shoulder.distance_m(), 0.0);
        let share = shoulder.mass_kg * shoulder.inertia_per_kg_m2 / link.inertia_kg_m2;
        assert_relative_eq!(100.0 * share, percent, epsilon = 0.005);
    }
}

#[test]
fn straight_leg_by_hand() {
    let robot = Ers7Tables::embedded();
    let extra = ExtraMass { mass_kg: 0.402, distance_m: 0.1705, radius_m: 0.018, length_m: 0.038 };
    // (3.8) S 0.04/5 (2 * 0.03475^2) = 1.93210e-5, U 0.052/5 (0.035^2 + 0.0164^2) = 1.553718e-5, L 1.8225e-5, E
    // 1.13498e-4; (3.9) U + 0.052 * 0.035^2 = 6.37e-5, L + 0.036 * 0.115^2 = 4.761e-4, E + 0.402 * 0.1705^2 =
    // 1.1686240e-2.
    let q1 = straight_leg(robot, Leg::RF, LegJoint::Q1, 9.81, None).unwrap();
    assert_relative_eq!(q1.inertia_kg_m2, 5.928832e-4, max_relative = 1e-6);
    assert_relative_eq!(q1.moment_kg_m, 0.052 * 0.035 + 0.036 * 0.115, max_relative = 1e-12);
    let loaded = straight_leg(robot, Leg::RF, LegJoint::Q1, 9.81, Some(&extra)).unwrap();
    assert_relative_eq!(loaded.inertia_kg_m2, 5.928832e-4 + 1.134980e-4 + 1.1686240e-2, max_relative = 1e-6);
    assert_relative_eq!(loaded.moment_kg_m, 0.00596 + 0.402 * 0.1705, max_relative = 1e-12);
    let q2 = straight_leg(robot, Leg::RF, LegJoint::Q2, 9.81, None).unwrap();
    assert_relative_eq!(q1.inertia_kg_m2 - q2.inertia_kg_m2, 1.932100e-5, max_relative = 1e-6); // I_S, not shifted
    let q3 = straight_leg(robot, Leg::RF, LegJoint::Q3, 9.81, None).unwrap();
    assert_relative_eq!(q3.inertia_kg_m2, 9.1125e-5, max_relative = 1e-12);
    assert_eq!((q1.rest_rad, q2.rest_rad, q3.rest_rad), (0.0, 0.0, 0.0));
}

#[test]
fn straight_leg_is_this_far_from_the_exact_lump() {
    for case in swing_cases() {
        for load in LOADS {
            let exact = case.lump(case.mounted(load));
            let extra = case.extra_at_its_distance(load);
            let line = straight_leg(Ers7Tables::embedded(), case.leg, case.joint, 9.81, extra.as_ref()).unwrap();
            let (i, m) = (line.inertia_kg_m2 / exact.inertia_kg_m2 - 1.0, line.moment_kg_m / exact.moment_kg_m - 1.0);
            // The figures in the doc comment of `straight_leg`.
            let (most_i, most_m) = match (case.joint, load) {
                (LegJoint::Q1, "bare") => (0.00775, 0.00205),
                (LegJoint::Q1, _) => (0.0007, 0.00025),
                (LegJoint::Q2, _) => (0.0008, 0.00065),
                (LegJoint::Q3, _) => (1e-12, 1e-12),
            };
            assert!(i.abs() < most_i && m.abs() < most_m, "{} {load}: {i} {m}", case.joint);
        }
    }
}

#[test]
fn gravity_along_the_axis_is_refused() {
    let robot = Ers7Tables::embedded();
    for gravity in [Vector3::new(9.81, 0.0, 0.0), Vector3::zeros(), Vector3::new(f64::NAN, 0.0, 0.0)] {
        let e = lump(robot, Leg::RF, LegJoint::Q1, &LegPose::STRAIGHT, gravity, None).unwrap_err();
        assert!(matches!(e, GeometryError::GravityAlongAxis { ref joint, .. } if joint == "rf1"), "{e}");
    }
}

#[test]
fn a_distance_that_no_point_has_is_refused() {
    let robot = Ers7Tables::embedded();
    let extra = |distance_m| ExtraMass { mass_kg: 0.22, distance_m, radius_m: 0.015, length_m: 0.03 };
    let at = |d| Mounted::at_distance(robot, Leg::RF, LegJoint::Q1, &LegPose::STRAIGHT, &extra(d));
    let e = at(0.05).unwrap_err(); // the knee is already 0.0706 m below the shoulder
    assert!(matches!(e, GeometryError::DistanceOutOfReach { knee_m, .. } if (knee_m - 0.0706).abs() < 1e-4), "{e}");
    assert!(at(f64::NAN).is_err());
    assert!(at(0.08).is_ok());
}

#[test]
fn a_changed_mass_moves_inertia_moment_and_rest_angle() {
    let q1 = &swing_cases()[0];
    let loaded = q1.lump(q1.mounted("402g"));
    let bare = loaded.clone().with_mass(LinkBody::Extra, 0.0);
    let without = q1.lump(None);
    assert_relative_eq!(bare.inertia_kg_m2, without.inertia_kg_m2, max_relative = 1e-14);
    assert_relative_eq!(bare.rest_rad, without.rest_rad, max_relative = 1e-12);
    assert_eq!(without.clone().with_mass(LinkBody::Extra, 1.0), without);
}

fn joint_and_leg() -> impl Strategy<Value = (LegJoint, Leg)> {
    (0..3usize, 0..4usize).prop_map(|(j, l)| (LegJoint::ALL[j], Leg::ALL[l]))
}

/// Anywhere within the software limits of Table A.3 that all legs share.
fn pose() -> impl Strategy<Value = LegPose> {
    (-2.0..2.0, -0.17..1.53, -0.43..2.12).prop_map(|(q1_rad, q2_rad, q3_rad)| LegPose { q1_rad, q2_rad, q3_rad })
}

fn gravity() -> impl Strategy<Value = Vector3<f64>> {
    (-1.0..1.0, -3.0..3.0)
        .prop_map(|(pitch, roll)| Rotation3::from_euler_angles(pitch, 0.0, roll) * level_gravity(9.81))
}

fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

/// A link whose rest angle is well defined: enough gravity across the axis.
fn swings(joint: LegJoint, leg: Leg, pose: &LegPose, gravity: Vector3<f64>) -> Option<LumpedLink> {
    let mount = Mounted { mass_kg: 0.1, radius_m: 0.015, length_m: 0.03, mount_m: 0.1 };
    let link = lump(Ers7Tables::embedded(), leg, joint, pose, gravity, Some(mount)).ok()?;
    (link.gravity_m_s2 > 1.0 && link.moment_kg_m > 1e-3).then_some(link)
}

proptest! {
    /// I* and the moment vector are sums of mass times the body's own coefficients, whatever the masses.
    #[test]
    fn lump_is_linear_in_mass(
        (joint, leg) in joint_and_leg(), pose in pose(), gravity in gravity(), scale in 0.1..10.0f64,
        upper in 0.0..0.5f64, lower in 0.0..0.5f64,
    ) {
        let Some(link) = swings(joint, leg, &pose, gravity) else { return Ok(()) };
        let part = |b: LinkBody, m: f64| link.bodies.iter().fold(link.clone(), |l, x| {
            l.with_mass(x.body, if x.body == b { m } else { 0.0 })
        });
        let vector = |l: &LumpedLink| Vector3::new(l.moment_kg_m * l.rest_rad.cos(),
            l.moment_kg_m * l.rest_rad.sin(), l.inertia_kg_m2);
        let both = link.clone().with_mass(LinkBody::Shoulder, 0.0).with_mass(LinkBody::Extra, 0.0)
            .with_mass(LinkBody::UpperLeg, upper).with_mass(LinkBody::LowerLeg, lower);
        let sum = vector(&part(LinkBody::UpperLeg, upper)) + vector(&part(LinkBody::LowerLeg, lower));
        prop_assert!((vector(&both) - sum).norm() < 1e-15);
        let scaled = link.bodies.iter().fold(link.clone(), |l, b| l.with_mass(b.body, b.mass_kg * scale));
        prop_assert!((scaled.inertia_kg_m2 - link.inertia_kg_m2 * scale).abs() <= 1e-12 * scaled.inertia_kg_m2);
        prop_assert!(wrapped(scaled.rest_rad - link.rest_rad).abs() < 1e-12);
    }

    /// Changing the robot's masses and changing the coefficients' masses is the same thing.
    #[test]
    fn coefficients_agree_with_a_heavier_robot((joint, leg) in joint_and_leg(), pose in pose(), mass in 0.001..0.3) {
        let mut heavier = Ers7Tables::embedded().clone();
        for p in heavier.parts.iter_mut().filter(|p| p.name.ends_with("_lower")) {
            p.mass_kg = mass;
        }
        let Ok(link) = lump(Ers7Tables::embedded(), leg, joint, &pose, level_gravity(9.81),
        None) else { return Ok(()) };
        let again = lump(&heavier, leg, joint, &pose, level_gravity(9.81), None).unwrap();
        prop_assert_eq!(link.with_mass(LinkBody::LowerLeg, mass), again);
    }

    /// Inertia is positive and no less than the point masses' share.
    #[test]
    fn inertia_is_positive_and_above_the_point_masses(
        (joint, leg) in joint_and_leg(), pose in pose(), gravity in gravity(),
    ) {
        let Some(link) = swings(joint, leg, &pose, gravity) else { return Ok(()) };
        for b in &link.bodies {
            prop_assert!(b.inertia_per_kg_m2 > b.distance_m().powi(2));
        }
        let mass: f64 = link.bodies.iter().map(|b| b.mass_kg).sum();
        prop_assert!(link.inertia_kg_m2 * mass > link.moment_kg_m.powi(2));
    }

    /// A small change of pose is a small change of the rest angle.
    #[test]
    fn rest_angle_is_continuous_in_the_pose(
        (joint, leg) in joint_and_leg(), pose in pose(), gravity in gravity(), k in 0..3usize,
    ) {
        let Some(link) = swings(joint, leg, &pose, gravity) else { return Ok(()) };
        let moved = LegJoint::ALL[k];
        let nudged = pose.with(moved, pose.angle(moved) + 1e-6);
        let Some(next) = swings(joint, leg, &nudged, gravity) else { return Ok(()) };
        prop_assert!(wrapped(next.rest_rad - link.rest_rad).abs() < 1e-3, "{} -> {}", link.rest_rad, next.rest_rad);
    }

    /// Turning gravity about the axis turns the rest angle with it.
    #[test]
    fn turning_gravity_about_the_axis_turns_the_rest_angle(
        (joint, leg) in joint_and_leg(), pose in pose(), gravity in gravity(), delta in -3.0..3.0,
    ) {
        let Some(link) = swings(joint, leg, &pose, gravity) else { return Ok(()) };
        let axis = Unit::new_normalize(link.axis_trunk.into_inner());
        let turned = swings(joint, leg, &pose, Rotation3::from_axis_angle(&axis, delta) * gravity).unwrap();
        prop_assert!(wrapped(turned.rest_rad - link.rest_rad - delta).abs() < 1e-9);
        prop_assert!((turned.inertia_kg_m2 - link.inertia_kg_m2).abs() < 1e-15);
    }

    /// The mount found from a distance gives back that distance.
    #[test]
    fn mount_and_distance_are_inverse((joint, leg) in joint_and_leg(), pose in pose(), mount_m in 0.0..0.3) {
        let (robot, g) = (Ers7Tables::embedded(), Rotation3::from_euler_angles(0.4, 0.0, 0.4) * level_gravity(9.81));
        let m = Mounted { mass_kg: 0.22, radius_m: 0.015, length_m: 0.03, mount_m };
        let Ok(link) = lump(robot, leg, joint, &pose, g, Some(m)) else { return Ok(()) };
        let distance_m = link.body(LinkBody::Extra).unwrap().distance_m();
        let extra = ExtraMass { mass_kg: 0.22, distance_m, radius_m: 0.015, length_m: 0.03 };
        if let Ok(back) = Mounted::at_distance(robot, leg, joint, &pose, &extra) {
            let again = lump(robot, leg, joint, &pose, g, Some(back)).unwrap();
            prop_assert!((again.body(LinkBody::Extra).unwrap().distance_m() - distance_m).abs() < 1e-9);
        }
    }
}
