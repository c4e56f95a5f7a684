//! Small files, by hand.

use crate::robot::description::{Description, JointKind};
use std::fs;

fn read(inside: &str) -> Description {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("r.xml");
    fs::write(&file, format!("<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">{inside}</robot>"))
        .unwrap();
    Description::read(&file).unwrap()
}

const LINKS: &str = r#"<link name="b"/><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>"#;

/// One joint between two links.
fn joint(kind: &str, inside: &str) -> Description {
    read(&format!("<joint name=\"j\" type=\"{kind}\"><parent link=\"b\"/><child link=\"a\"/>{inside}</joint>{LINKS}"))
}

#[test]
fn rpy_turns_about_fixed_axes_roll_first_and_turns_the_tensor() {
    let made = joint("revolute", r#"<origin xyz="1 2 3" rpy="1.5707963267948966 0 1.5707963267948966"/>"#);
    let pose = made.links[1].pose;
    // Rz Ry Rx: y goes to z by the roll and stays there; z goes to -y, then by the yaw to x.
    assert!((pose.rotation * nalgebra::Vector3::z() - nalgebra::Vector3::x()).norm() < 1e-15);
    assert_eq!(pose.translation.vector, nalgebra::Vector3::new(1.0, 2.0, 3.0));
    let turned =
        LINKS.replace("<mass", "<origin rpy=\"0 0 1.5707963267948966\"/><mass").replace("ixx=\"1\"", "ixx=\"3\"");
    let made =
        read(&format!("{turned}<joint name=\"j\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint>"));
    assert!((made.links[1].inertia.tensor_kg_m2[(1, 1)] - 3.0).abs() < 1e-15);
    assert!(made.joints.is_empty());
}

#[test]
fn a_quaternion_stands_for_rpy() {
    let made = joint("continuous", r#"<origin quat_xyzw="0 0 2 2"/>"#);
    assert!((made.links[1].pose.rotation * nalgebra::Vector3::x() - nalgebra::Vector3::y()).norm() < 1e-15);
}

#[test]
fn limits_and_friction_are_those_of_the_kind() {
    let made = joint("revolute", r#"<limit upper="+1" effort="1.e1"/><dynamics damping=".5" friction="2"/>"#);
    let of = &made.joints[0];
    assert_eq!((of.limit_rad, of.effort_nm, of.rate_limit_rad_s), (Some([0.0, 1.0]), Some(10.0), None));
    assert_eq!((of.damping, of.friction_nm, of.axis), ([0.5, 0.0, 0.0], 2.0, nalgebra::Vector3::x_axis()));
    let made = joint("continuous", r#"<limit lower="-1" upper="1" effort="1" velocity="1"/><axis xyz="0 -3 4"/>"#);
    assert_eq!((made.joints[0].kind, made.joints[0].limit_rad), (JointKind::Continuous, None));
    assert!((made.joints[0].axis.into_inner() - nalgebra::Vector3::new(0.0, -0.6, 0.8)).norm() < 1e-15);
    assert!(joint("prismatic", "").warnings[0].contains("no <limit>"));
    assert!(joint("prismatic", r#"<limit lower="0" upper="0"/>"#).warnings[0].contains("it cannot move"));
    let turned = joint("revolute", r#"<limit lower="3" upper="-3" effort="-4"/><dynamics damping="-1"/>"#);
    assert_eq!(turned.joints[0].limit_rad, None);
    for what in ["an effort below 0", "taken as without limits", "damping or friction below 0"] {
        assert!(turned.warnings.iter().any(|warning| warning.contains(what)), "{what}: {:?}", turned.warnings);
    }
}

#[test]
fn an_infinite_limit_is_none() {
    let limits = r#"<limit lower="-inf" upper="inf" effort="inf" velocity="Infinity"/>"#;
    let made = joint("revolute", limits);
    let own = &made.joints[0];
    assert_eq!((own.limit_rad, own.effort_nm, own.rate_limit_rad_s), (None, None, None));
    let one_sided = joint("revolute", r#"<limit lower="-1" upper="inf" effort="5" velocity="2"/>"#);
    assert_eq!(one_sided.joints[0].limit_rad, Some([-1.0, 1e9]));
    // What does not count may be left empty.
    assert_eq!(
        joint("continuous", r#"<limit lower="" upper="" effort="5" velocity="2"/>"#).joints[0].effort_nm,
        Some(5.0)
    );
}

#[test]
fn what_is_written_twice_or_misspelt_is_said_and_the_first_counts() {
    let made =
        joint("continuous", r#"<axis xyz="0 1 0"/><axis xyz="1 0 0"/><origin xyz="1 0 0"/><origin xyz="2 0 0"/>"#);
    assert_eq!(made.joints[0].axis, nalgebra::Vector3::y_axis());
    assert_eq!(made.links[1].pose.translation.vector.x, 1.0);
    assert_eq!(made.warnings.iter().filter(|warning| warning.contains("the first counts")).count(), 2);
    let made = joint("revolute", r#"<limit lower="-1" uper="1" upper="2"/>"#);
    assert!(made.warnings[0].contains("unknown attribute `uper`"));
}

#[test]
fn a_world_that_is_no_link_is_taken_as_the_world() {
    let made = read(&format!(
        r#"<joint name="w" type="fixed"><parent link="world"/><child link="b"/></joint>
        <joint name="j" type="revolute"><parent link="b"/><child link="a"/></joint>{LINKS}"#
    ));
    assert_eq!((made.links[0].name.as_str(), made.links.len()), ("world", 3));
    assert!(made.warnings.iter().any(|warning| warning.contains("taken as the world")));
}

#[test]
fn what_is_not_the_robots_may_hold_anything() {
    let made = read(&format!(
        r#"{LINKS}<joint name="j" type="revolute"><parent link="b"/><child link="a"/><limit lower="-1" upper="1"/>
        <safety_controller k_velocity="$(arg x)"/><calibration rising="${{y}}"/></joint>
        <gazebo><xacro:macro/><plugin filename="$(find z)"/></gazebo><transmission name="t"><joint name="j"/></transmission>
        <drake:joint/><!-- ${{z}} -- --><link name="c"><visual><geometry><mesh filename="$(find m)/a.stl"/></geometry></visual></link>
        <joint name="f" type="fixed"><parent link="a"/><child link="c"/></joint>"#
    ));
    assert_eq!((made.links.len(), made.joints.len()), (3, 1));
    assert_eq!(made.warnings.len(), 1);
    assert!(made.warnings[0].contains("<link name=\"c\">: it has a shape and no <inertial>"));
}

#[test]
fn what_closes_a_loop_beside_the_tree_is_said_once() {
    let made = read(&format!(
        "{LINKS}<joint name=\"j\" type=\"continuous\"><parent link=\"b\"/><child link=\"a\"/></joint>\
         <loop_joint name=\"l\"/><loop_joint name=\"m\"/><gazebo/>"
    ));
    let unknown = made.warnings.iter().filter(|warning| warning.contains("unknown element in")).count();
    assert_eq!(unknown, 1, "{:?}", made.warnings);
}
