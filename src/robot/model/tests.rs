//! The model as data: what the tables say, and what may be changed.

use super::*;
use crate::geometry::Ers7Tables;

#[test]
fn table_b_2_gains_follow_2_7() {
    let robot = Model::ers7();
    let value = |set: &str, name: &str| {
        let gains = robot.gains(set, robot.joint(name).unwrap())?;
        Some([gains.kp_nm_rad, gains.ki_nm_rad_s, gains.kd_nm_s_rad])
    };
    assert_eq!(value("printed", "lf1"), Some([5.0, 2f64.powi(-12), 0.5])); // printed 2.44E-04
    assert_eq!(value("printed", "rr2"), Some([7.0, 2f64.powi(-11), 0.5])); // 4.88E-04
    assert_eq!(value("swapped", "rr2"), Some([5.0, 2f64.powi(-12), 0.5]));
    assert_eq!(value("printed", "neck_pan"), Some([2.0, 2f64.powi(-13), 2.0])); // 1.22E-04
    assert_eq!(value("printed", "mouth"), Some([2.0, 0.0, 2.0]));
    assert_eq!(value("printed", "ear_l_tilt"), None);
    assert_eq!(robot.joint_ids().filter(|&joint| robot.gains("printed", joint).is_some()).count(), 18);
}

#[test]
fn tables_3_3_and_3_4_reach_the_joints() {
    let robot = Model::ers7();
    let coulomb = |set: &str, name: &str| robot.friction(set, robot.joint(name).unwrap()).map(|f| f.coulomb_nm);
    assert_eq!((coulomb("estimated", "lr3"), coulomb("chosen", "lr3")), (Some(0.020), Some(0.010)));
    assert_eq!((coulomb("chosen", "mouth"), coulomb("guessed", "mouth")), (Some(0.0), None));
}

#[test]
fn masses_and_payloads_make_another_robot() {
    let robot = Model::ers7();
    let shank = robot.body("lf_lower").unwrap();
    let heavier = robot.with_mass(shank, 0.072).unwrap();
    let (old, new) = (&robot.bodies()[shank.index()], &heavier.bodies()[shank.index()]);
    assert_eq!(new.inertia_kg_m2, old.inertia_kg_m2 * 2.0);
    approx::assert_relative_eq!(heavier.total_mass_kg(), 1.6913 + 0.036, epsilon = 1e-12);
    let at = Vector3::new(0.0, -0.045, 0.0);
    let loaded = heavier.with_point_mass(shank, 0.072, at).unwrap();
    let body = &loaded.bodies()[shank.index()];
    assert_eq!((body.mass_kg, body.centre_of_mass_m), (0.144, at / 2.0));
    // Two equal masses 0.045 m apart: m d^2 / 2 more.
    approx::assert_relative_eq!(body.inertia_kg_m2[(0, 0)] - new.inertia_kg_m2[(0, 0)], 0.072 * 0.045 * 0.045 / 2.0);
    // The mass of the part can still be changed; what was fixed to it stays.
    let again = loaded.with_mass(shank, 0.0).unwrap();
    assert_eq!(again.bodies()[shank.index()].mass_kg, 0.072);
}

#[test]
fn what_no_body_has_is_refused() {
    let robot = Model::ers7();
    let mouth = robot.body("mouth").unwrap();
    let error = robot.with_mass(mouth, -1.0).unwrap_err().to_string();
    assert_eq!(error, "body mouth: mass_kg = -1, allowed: 0 kg or above");
    assert!(robot.with_mass(mouth, f64::NAN).is_err());
    let error = robot.with_mass(mouth, 0.0).unwrap_err().to_string();
    assert!(error.contains("joint mouth: what it moves has no inertia"), "{error}");
    assert!(robot.with_point_mass(mouth, 0.1, Vector3::new(f64::INFINITY, 0.0, 0.0)).is_err());
    let error = robot.body("wing").unwrap_err().to_string();
    assert!(error.starts_with("ers7 has no body wing; it has trunk, "), "{error}");
    assert!(robot.joint("lf4").unwrap_err().to_string().contains("no joint lf4; it has lf1, "));
}

#[test]
fn lowest_point_of_an_ellipsoid() {
    let robot = Model::ers7();
    let shank = &robot.bodies()[robot.body("lf_lower").unwrap().index()];
    assert!(shank.touches_floor());
    let touch = shank.touches[0];
    assert_eq!(touch.lowest_m(&Vector3::y()), Vector3::new(0.0, -0.045, 0.0));
    // Any other point of the surface is higher.
    let up = Vector3::new(0.3, 0.8, -0.5).normalize();
    let low = touch.lowest_m(&up);
    approx::assert_relative_eq!(low.component_div(&shank.radii_m).norm(), 1.0, epsilon = 1e-14);
    for aside in [Vector3::x(), Vector3::y(), Vector3::z()] {
        for turn in [-0.01, 0.01] {
            let unit = low.component_div(&shank.radii_m) + aside * turn;
            assert!(unit.normalize().component_mul(&shank.radii_m).dot(&up) >= low.dot(&up) - 1e-15);
        }
    }
}

/// Which joints go side by side, and where a frame may slide so that nothing is shifted.
#[test]
fn limbs_of_the_ers_7_go_in_pairs() {
    let robot = Model::ers7();
    let name = |joint: usize| robot.joints()[joint].name.as_str();
    let groups = &robot.plan().groups;
    let found: Vec<String> = groups
        .iter()
        .map(|group| {
            let letter = ["x", "y", "z"][group.axis];
            let shape = match group.shape {
                Shape::Turn => "",
                Shape::Shifted => "+",
                Shape::Rotated => "!",
            };
            let second = if group.is_single { "" } else { name(group.joints[1]) };
            format!("{letter}{shape} {} {second}", name(group.joints[0])).trim_end().to_owned()
        })
        .collect();
    let expected = [
        "x+ lf1 rf1",
        "x+ lr1 rr1",
        "x+ neck_tilt1 tail_tilt",
        "z lf2 rf2",
        "z lr2 rr2",
        "y neck_pan tail_pan",
        "x+ lf3 rf3",
        "x+ lr3 rr3",
        "x+ neck_tilt2",
        "x+ mouth",
        "z+ ear_l_tilt ear_r_tilt",
        "y ear_l_pan ear_r_pan",
    ];
    assert_eq!(found, expected);
}

#[test]
fn one_reader_serves_the_leg_and_the_robot() {
    let (robot, tables) = (Model::ers7(), Ers7Tables::embedded());
    assert_eq!(robot.joints(), tables.joints);
    approx::assert_relative_eq!(robot.total_mass_kg(), tables.total_mass_kg(), epsilon = 1e-15);
}
