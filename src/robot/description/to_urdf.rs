//! A description as URDF: links with their inertias, joints with limits, damping and friction; no looks and no contacts.

use super::found::FoundNumber;
use super::xml::escaped;
use super::{Description, JointKind, Link};
use nalgebra::{Isometry3, Vector3};
use std::fmt::Write as _;

/// The description as URDF, each number of `found` marked above the element that has it.
///
/// # Errors
/// What URDF cannot say of this robot's build: joints off their links' origins, several in one link, a pose as drawn that
/// is not at 0.
pub fn to_urdf(description: &Description, found: &[FoundNumber]) -> Result<String, String> {
    let mut text = format!("<robot name=\"{}\">\n", escaped(&description.name));
    for link in &description.links {
        marks(&mut text, found, &link.name, false);
        write_link(&mut text, link);
        if let Some(parent) = link.parent {
            write_joint(&mut text, description, link, &description.links[parent.0], found)?;
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
    parent: &Link,
    found: &[FoundNumber],
) -> Result<(), String> {
    let (child, parent) = (escaped(&link.name), escaped(&parent.name));
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
        mover.kind.word(),
        vector(&mover.axis.into_inner()),
        mover.damping[0],
        mover.friction_nm
    );
    let servo = description.actuators.iter().find(|actuator| actuator.joint == joint);
    let limit = servo.and_then(|servo| Some(servo.force_range_nm?[1] * servo.gear.abs()));
    let (effort, velocity) = (limit.or(mover.effort_nm), mover.rate_limit_rad_s);
    let [low, high] = mover.limit_rad.unwrap_or_default();
    if mover.kind != JointKind::Continuous {
        let (effort, velocity) = (effort.unwrap_or(0.0), velocity.unwrap_or(0.0));
        let _ =
            writeln!(text, "    <limit lower=\"{low}\" upper=\"{high}\" effort=\"{effort}\" velocity=\"{velocity}\"/>");
    } else if let (Some(effort), Some(velocity)) = (effort, velocity) {
        let _ = writeln!(text, "    <limit effort=\"{effort}\" velocity=\"{velocity}\"/>");
    }
    *text += "  </joint>\n";
    Ok(())
}
