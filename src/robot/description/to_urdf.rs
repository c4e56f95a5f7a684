//! A description as URDF: links with their inertias, joints with limits, damping and friction; no looks and no contacts.

use super::found::FoundNumber;
use super::urdf::UNLIMITED;
use super::xml::escaped;
use super::{Description, JointKind, Link, Mover, MoverId};
use nalgebra::{Isometry3, Vector3};
use std::fmt::Write as _;

/// The description as URDF, each number of `found` marked above the element that has it.
///
/// # Errors
/// What URDF cannot say of this robot's build: joints off their links' origins, several in one link, a pose as drawn that
/// is not at 0, a free base with something on the world beside it.
pub fn to_urdf(description: &Description, found: &[FoundNumber]) -> Result<String, String> {
    let mut text = format!("<robot name=\"{}\">\n", escaped(&description.name));
    let world = world_of(description)?;
    if let Some(world) = &world {
        let _ = writeln!(text, "  <link name=\"{}\"/>", escaped(world));
    }
    for link in &description.links {
        marks(&mut text, found, &link.name, false);
        write_link(&mut text, link);
        let parent = link.parent.map_or(world.as_ref(), |parent| Some(&description.links[parent.0].name));
        if let Some(parent) = parent {
            write_joint(&mut text, description, link, parent, found)?;
        }
    }
    let held = description.equalities.iter().map(|(coupling, _)| coupling);
    for coupling in description.couplings.iter().chain(held) {
        let leader = escaped(&description.joints[coupling.leader.0].name);
        let follower = &description.joints[coupling.follower.0].name;
        let mimic = format!(
            "    <mimic joint=\"{leader}\" multiplier=\"{}\" offset=\"{}\"/>\n",
            coupling.multiplier, coupling.offset_rad
        );
        let head = format!("  <joint name=\"{}\"", escaped(follower));
        if let Some(end) = text.find(&head).and_then(|at| Some(at + text[at..].find("  </joint>")?)) {
            text.insert_str(end, &mimic);
        }
    }
    Ok(text + "</robot>\n")
}

/// The link to add as the world where there is more than one base, or one that moves or does not stand in the world's frame.
fn world_of(description: &Description) -> Result<Option<String>, String> {
    let bases: Vec<&Link> = description.links.iter().filter(|link| link.parent.is_none()).collect();
    let is_plain = |base: &Link| base.joints.is_empty() && base.pose == Isometry3::identity();
    match (&bases[..], &description.free_joint) {
        ([_], Some(_)) => return Ok(None),
        ([base], None) if is_plain(base) => return Ok(None),
        (_, Some(free)) => {
            let name = &description.links[free.link.0].name;
            return Err(format!("link {name} is free, and others stand on the world beside it"));
        }
        _ => {}
    }
    let mut name = "world".to_owned();
    while description.link(&name).is_some() {
        name.push('_');
    }
    Ok(Some(name))
}

fn marks(text: &mut String, found: &[FoundNumber], name: &str, is_of_joint: bool) {
    for number in found.iter().filter(|number| number.name == name && number.key.is_of_joint() == is_of_joint) {
        // Two hyphens end no comment.
        let words = format!("{}: {}", number.name, number.words()).replace("--", "- -");
        let _ = writeln!(text, "  <!-- aibo-fit: {words} -->");
    }
}

fn vector(v: &Vector3<f64>) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

fn origin(pose: &Isometry3<f64>) -> String {
    let (roll, pitch, yaw) = pose.rotation.euler_angles();
    format!("<origin xyz=\"{}\" rpy=\"{roll} {pitch} {yaw}\"/>", vector(&pose.translation.vector))
}

fn write_link(text: &mut String, link: &Link) {
    let name = escaped(&link.name);
    if link.inertia.mass_kg == 0.0 {
        let _ = writeln!(text, "  <link name=\"{name}\"/>");
        return;
    }
    let tensor = link.inertia.central_kg_m2();
    let at = |i: usize, j: usize| tensor[(i, j)];
    let _ = writeln!(
        text,
        "  <link name=\"{name}\">\n    <inertial>\n      <origin xyz=\"{}\"/>\n      <mass value=\"{}\"/>\n      \
         <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n    </inertial>\n  </link>",
        vector(&link.inertia.centre_m()),
        link.inertia.mass_kg,
        at(0, 0),
        at(0, 1),
        at(0, 2),
        at(1, 1),
        at(1, 2),
        at(2, 2)
    );
}

fn write_joint(
    text: &mut String,
    description: &Description,
    link: &Link,
    parent: &str,
    found: &[FoundNumber],
) -> Result<(), String> {
    let (child, parent) = (escaped(&link.name), escaped(parent));
    let places = format!("<parent link=\"{parent}\"/>\n    <child link=\"{child}\"/>\n    {}", origin(&link.pose));
    let [joint] = link.joints[..] else {
        if link.joints.len() > 1 {
            return Err(format!("link {} has several joints", link.name));
        }
        let _ = writeln!(text, "  <joint name=\"{child}_fixed\" type=\"fixed\">\n    {places}\n  </joint>");
        return Ok(());
    };
    let mover = &description.joints[joint.0];
    if mover.place_m != Vector3::zeros() {
        return Err(format!("the axis of joint {} does not pass through its link's origin", mover.name));
    }
    if mover.drawn_rad != 0.0 {
        return Err(format!("joint {} is drawn at {}", mover.name, mover.drawn_rad));
    }
    marks(text, found, &mover.name, true);
    let _ = writeln!(
        text,
        "  <joint name=\"{}\" type=\"{}\">\n    {places}\n    <axis xyz=\"{}\"/>\n    <dynamics damping=\"{}\" friction=\"{}\"/>",
        escaped(&mover.name),
        kind(mover).word(),
        vector(&mover.axis.into_inner()),
        mover.damping[0],
        mover.friction_nm
    );
    *text += &limit(description, joint, mover);
    *text += "  </joint>\n";
    Ok(())
}

/// A revolute joint has to have limits, so one without turns without end.
fn kind(mover: &Mover) -> JointKind {
    match mover.kind {
        JointKind::Revolute if mover.limit_rad.is_none() => JointKind::Continuous,
        kind => kind,
    }
}

/// What limits a joint; where URDF has to have a number and there is none, one that nothing reaches: 0 would lock it.
fn limit(description: &Description, joint: MoverId, mover: &Mover) -> String {
    let servo = description.actuators.iter().find(|actuator| actuator.joint == joint);
    let of_servo = servo.and_then(super::Actuator::torque_range_nm).map(|[_, high]| high);
    let effort = of_servo.or(mover.actuator_range_nm.map(|[_, high]| high)).or(mover.effort_nm);
    let velocity = mover.rate_limit_rad_s;
    let ends = match (kind(mover), mover.limit_rad) {
        (JointKind::Continuous, _) if effort.is_none() && velocity.is_none() => return String::new(),
        (JointKind::Continuous, _) => String::new(),
        (_, limit) => {
            let [low, high] = limit.unwrap_or([-UNLIMITED, UNLIMITED]);
            format!(" lower=\"{low}\" upper=\"{high}\"")
        }
    };
    let [effort, velocity] = [effort, velocity].map(|most| most.unwrap_or(UNLIMITED));
    format!("    <limit{ends} effort=\"{effort}\" velocity=\"{velocity}\"/>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An MJCF as URDF, and that read back.
    fn through_urdf(world: &str) -> Result<(String, Description), String> {
        let dir = tempfile::tempdir().unwrap();
        let (mjcf, urdf) = (dir.path().join("robot.xml"), dir.path().join("robot.urdf"));
        let compiler = r#"<compiler angle="radian"/>"#;
        std::fs::write(&mjcf, format!("<mujoco>{compiler}<worldbody>{world}</worldbody></mujoco>")).unwrap();
        let text = to_urdf(&Description::read(&mjcf).unwrap(), &[])?;
        std::fs::write(&urdf, &text).unwrap();
        let back = Description::read(&urdf).unwrap();
        assert!(back.warnings.is_empty(), "{:?}", back.warnings);
        Ok((text, back))
    }

    #[test]
    fn a_joint_without_limits_is_free_in_urdf_and_read_back_without_them() {
        let (text, back) = through_urdf(
            r#"<body name="base"><geom size=".1"/>
            <body name="a"><joint name="turns"/><geom size=".1"/>
            <body name="b"><joint name="ends" range="-1 2"/><geom size=".1"/>
            <body name="c"><joint name="strong" actuatorfrcrange="-4 4"/><geom size=".1"/>
            <body name="d"><joint name="slides" type="slide"/><geom size=".1"/></body></body></body></body></body>"#,
        )
        .unwrap();
        assert!(!text.contains("velocity=\"0\"") && !text.contains("effort=\"0\""), "{text}");
        let of = |name: &str| {
            let mover = &back.joints[back.joint(name).unwrap().0];
            (mover.kind, mover.limit_rad, mover.effort_nm, mover.rate_limit_rad_s)
        };
        assert_eq!(of("turns"), (JointKind::Continuous, None, None, None));
        assert_eq!(of("ends"), (JointKind::Revolute, Some([-1.0, 2.0]), None, None));
        assert_eq!(of("strong"), (JointKind::Continuous, None, Some(4.0), None));
        assert_eq!(of("slides"), (JointKind::Prismatic, None, None, None));
    }

    #[test]
    fn a_base_that_moves_or_stands_apart_is_joined_to_a_world() {
        let moves =
            r#"<body name="b" pos="0 0 1" quat="0 1 0 0"><joint name="j" frictionloss=".2"/><geom size=".1"/></body>"#;
        let (_, back) = through_urdf(moves).unwrap();
        let link = &back.links[back.link("b").unwrap().0];
        assert_eq!((back.links[0].name.as_str(), link.parent.map(|parent| parent.0)), ("world", Some(0)));
        assert_eq!(back.joints[back.joint("j").unwrap().0].friction_nm, 0.2);
        assert!((link.pose.rotation.angle() - std::f64::consts::PI).abs() < 1e-12 && link.pose.translation.z == 1.0);
        let two = r#"<body name="a"><geom size=".1"/></body><body name="b"><geom size=".1"/></body>"#;
        assert_eq!(through_urdf(two).unwrap().1.links.len(), 3);
        let free =
            r#"<body name="a" pos="0 0 1"><freejoint/><geom size=".1"/><body name="b"><geom size=".1"/></body></body>"#;
        assert_eq!(through_urdf(free).unwrap().1.links.len(), 2);
        let beside = format!(r#"{free}<body name="table"><geom size=".1"/></body>"#);
        assert!(through_urdf(&beside).unwrap_err().contains("link a is free"));
    }
}
