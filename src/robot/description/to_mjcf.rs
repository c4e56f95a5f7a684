//! A description as MJCF: what moves and what drives it, no looks and no contacts.

use super::found::FoundNumber;
use super::xml::escaped;
use super::{Actuator, ActuatorKind, Description, JointKind, LinkId, Mover, RigidInertia};
use nalgebra::{Isometry3, Vector3};
use std::fmt::Write as _;

/// MuJoCo wants every moving body to have some mass \[kg\] and inertia \[kg m^2\].
const LEAST_KG: f64 = 1e-9;
const LEAST_KG_M2: f64 = 1e-12;

/// The description as MJCF, each number of `found` marked above the element that has it.
pub fn to_mjcf(description: &Description, found: &[FoundNumber]) -> String {
    let mut writer = Writer { description, found, text: String::new() };
    writer.write();
    writer.text
}

struct Writer<'a> {
    description: &'a Description,
    found: &'a [FoundNumber],
    text: String,
}

impl Writer<'_> {
    fn write(&mut self) {
        let g = self.description.gravity_m_s2;
        let name = escaped(&self.description.name);
        let _ = writeln!(self.text, "<mujoco model=\"{name}\">");
        self.text += "  <compiler angle=\"radian\" autolimits=\"true\"/>\n";
        let _ = writeln!(
            self.text,
            "  <option timestep=\"0.0005\" integrator=\"implicitfast\" gravity=\"{}\"/>",
            vector(&g)
        );
        self.text += "  <worldbody>\n";
        for k in 0..self.description.links.len() {
            if self.description.links[k].parent.is_none() {
                self.link(LinkId(k), 2);
            }
        }
        self.text += "  </worldbody>\n";
        self.equalities();
        self.actuators();
        self.text += "</mujoco>\n";
    }

    fn line(&mut self, depth: usize, line: &str) {
        let _ = writeln!(self.text, "{:1$}{line}", "", 2 * depth);
    }

    /// What was found of a joint or link, as comments.
    fn marks(&mut self, depth: usize, name: &str, is_meant: impl Fn(&FoundNumber) -> bool) {
        for number in self.found.iter().filter(|number| number.name == name && is_meant(number)) {
            // Two hyphens end no comment.
            let words = format!("{}: {}", number.name, number.words()).replace("--", "- -");
            self.line(depth, &format!("<!-- aibo-fit: {words} -->"));
        }
    }

    fn link(&mut self, at: LinkId, depth: usize) {
        let description = self.description;
        let link = &description.links[at.0];
        let is_free = description.free_joint.as_ref().is_some_and(|free| free.link == at);
        // MuJoCo's world is a body of this name already.
        if link.name == "world" && link.parent.is_none() && link.joints.is_empty() && !is_free {
            return self.children(at, depth);
        }
        self.line(depth, &format!("<body name=\"{}\"{}>", escaped(&link.name), pose(&link.pose)));
        self.marks(depth + 1, &link.name, |number| !number.key.is_of_joint());
        let moves = is_free || !link.joints.is_empty();
        if link.inertia.mass_kg > 0.0 || moves {
            self.line(depth + 1, &inertial(&link.inertia));
        }
        if is_free {
            self.line(depth + 1, "<freejoint/>");
        }
        for joint in &link.joints {
            let mover = &description.joints[joint.0];
            let is_servo = |key: super::FoundKey| {
                use super::FoundKey::{Kd, Kp, TorqueLimit};
                matches!(key, Kp | Kd | TorqueLimit)
            };
            self.marks(depth + 1, &mover.name, |number| number.key.is_of_joint() && !is_servo(number.key));
            self.line(depth + 1, &joint_element(mover));
        }
        self.children(at, depth + 1);
        self.line(depth, "</body>");
    }

    fn children(&mut self, at: LinkId, depth: usize) {
        for k in 0..self.description.links.len() {
            if self.description.links[k].parent == Some(at) {
                self.link(LinkId(k), depth);
            }
        }
    }

    fn equalities(&mut self) {
        let held = self.description.with_equalities();
        if held.couplings.is_empty() {
            return;
        }
        self.line(1, "<equality>");
        for coupling in &held.couplings {
            let drawn = |joint: super::MoverId| held.joints[joint.0].drawn_rad;
            let offset_rad =
                coupling.offset_rad - drawn(coupling.follower) + coupling.multiplier * drawn(coupling.leader);
            let name = |joint: super::MoverId| escaped(&self.description.joints[joint.0].name);
            let (follower, leader) = (name(coupling.follower), name(coupling.leader));
            let line = format!(
                "<joint joint1=\"{follower}\" joint2=\"{leader}\" polycoef=\"{} {} 0 0 0\"/>",
                offset_rad, coupling.multiplier
            );
            self.line(2, &line);
        }
        self.line(1, "</equality>");
    }

    fn actuators(&mut self) {
        if self.description.actuators.is_empty() {
            return;
        }
        self.line(1, "<actuator>");
        for actuator in &self.description.actuators {
            let joint = self.description.joints[actuator.joint.0].name.clone();
            self.marks(2, &joint, |number| {
                use super::FoundKey::{Kd, Kp, TorqueLimit};
                matches!(number.key, Kp | Kd | TorqueLimit)
            });
            let line = actuator_element(actuator, &joint);
            self.line(2, &line);
        }
        self.line(1, "</actuator>");
    }
}

fn vector(v: &Vector3<f64>) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

fn pose(pose: &Isometry3<f64>) -> String {
    let q = pose.rotation;
    let mut text = String::new();
    if pose.translation.vector != Vector3::zeros() {
        let _ = write!(text, " pos=\"{}\"", vector(&pose.translation.vector));
    }
    if q.angle() != 0.0 {
        let _ = write!(text, " quat=\"{} {} {} {}\"", q.w, q.i, q.j, q.k);
    }
    text
}

fn inertial(inertia: &RigidInertia) -> String {
    let mass = inertia.mass_kg.max(LEAST_KG);
    let mut tensor = inertia.central_kg_m2();
    for k in 0..3 {
        tensor[(k, k)] = tensor[(k, k)].max(LEAST_KG_M2);
    }
    format!(
        "<inertial pos=\"{}\" mass=\"{mass}\" fullinertia=\"{} {} {} {} {} {}\"/>",
        vector(&inertia.centre_m()),
        tensor[(0, 0)],
        tensor[(1, 1)],
        tensor[(2, 2)],
        tensor[(0, 1)],
        tensor[(0, 2)],
        tensor[(1, 2)]
    )
}

fn joint_element(mover: &Mover) -> String {
    let kind = if mover.kind == JointKind::Prismatic { "slide" } else { "hinge" };
    let mut text = format!(
        "<joint name=\"{}\" type=\"{kind}\" axis=\"{}\"",
        escaped(&mover.name),
        vector(&mover.axis.into_inner())
    );
    let mut add = |name: &str, value: String| {
        let _ = write!(text, " {name}=\"{value}\"");
    };
    if mover.place_m != Vector3::zeros() {
        add("pos", vector(&mover.place_m));
    }
    for (name, value) in [
        ("ref", mover.drawn_rad),
        ("damping", mover.damping[0]),
        ("frictionloss", mover.friction_nm),
        ("armature", mover.armature_kg_m2),
        ("stiffness", mover.stiffness[0]),
    ] {
        if value != 0.0 {
            add(name, value.to_string());
        }
    }
    if mover.stiffness[0] != 0.0 {
        add("springref", mover.spring_rest_rad.to_string());
    }
    if let (Some([low, high]), true) = (mover.limit_rad, mover.kind != JointKind::Continuous) {
        add("range", format!("{low} {high}"));
    }
    if let Some([low, high]) = mover.actuator_range_nm {
        add("actuatorfrcrange", format!("{low} {high}"));
    }
    text + "/>"
}

fn actuator_element(actuator: &Actuator, joint: &str) -> String {
    let name = if actuator.name.is_empty() { joint } else { &actuator.name };
    let mut text = format!("name=\"{}\" joint=\"{}\"", escaped(name), escaped(joint));
    let mut add = |name: &str, value: String| {
        let _ = write!(text, " {name}=\"{value}\"");
    };
    if actuator.gear != 1.0 {
        add("gear", actuator.gear.to_string());
    }
    if let Some([low, high]) = actuator.control_range {
        add("ctrlrange", format!("{low} {high}"));
    }
    if let Some([low, high]) = actuator.force_range_nm {
        add("forcerange", format!("{low} {high}"));
    }
    match actuator.kind {
        ActuatorKind::Motor => format!("<motor {text}/>"),
        ActuatorKind::Position => {
            add("kp", actuator.gain.to_string());
            match actuator.damping_ratio {
                Some(ratio) => add("dampratio", ratio.to_string()),
                None => add("kv", (0.0 - actuator.bias[2]).to_string()),
            }
            format!("<position {text}/>")
        }
        ActuatorKind::Velocity => {
            add("kv", actuator.gain.to_string());
            format!("<velocity {text}/>")
        }
        ActuatorKind::General => {
            let [b0, b1, b2] = actuator.bias;
            add("gainprm", actuator.gain.to_string());
            add("biastype", "affine".to_owned());
            add("biasprm", format!("{b0} {b1} {b2}"));
            format!("<general {text}/>")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::FoundKey;
    use super::*;
    use crate::robot::tree::{Tree, TreeBase, TreeDynamics, TreeState};
    use approx::assert_relative_eq;
    use nalgebra::DMatrix;

    const ARM: &str = r#"<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.02 0 -0.2" rpy="0.1 0 0.3"/><mass value="1.2"/>
  <inertia ixx="0.01" iyy="0.011" izz="0.002" ixy="0.0003" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0.01 -0.15"/><mass value="0.6"/>
  <inertia ixx="0.004" iyy="0.0041" izz="0.0005" ixy="0" ixz="0.0001" iyz="0"/></inertial></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.4" rpy="0 0 0.4"/>
  <axis xyz="0.3 1 0.1"/><limit lower="-3" upper="3" effort="10" velocity="10"/></joint></robot>"#;

    #[test]
    fn what_is_written_is_the_same_robot_with_what_was_found() {
        let dir = tempfile::tempdir().unwrap();
        let (urdf, mjcf) = (dir.path().join("arm.urdf"), dir.path().join("arm.xml"));
        std::fs::write(&urdf, ARM).unwrap();
        let number = |name: &str, key, value| FoundNumber {
            name: name.to_owned(),
            key,
            was: Some(0.0),
            value,
            interval: Some([0.9 * value, 1.1 * value]),
            unit: "N m".to_owned(),
            place_m: (key == FoundKey::Payload).then_some([0.0, 0.0, -0.3]),
        };
        let found = [
            number("elbow", FoundKey::Frictionloss, 0.19),
            number("elbow", FoundKey::Kp, 16.0),
            number("elbow", FoundKey::Kd, 0.4),
            number("shoulder", FoundKey::Armature, 0.02),
            number("lower", FoundKey::Payload, 0.25),
            number("upper", FoundKey::Mass, 1.5),
        ];
        let described = Description::read(&urdf).unwrap();
        let changed = described.with_found(&found).unwrap();
        assert_eq!(changed.links[changed.link("lower").unwrap().0].inertia.mass_kg, 0.85);
        let text = to_mjcf(&changed, &found);
        assert!(text.contains("<!-- aibo-fit: elbow: frictionloss 0.190 [0.171, 0.209] N m, was 0 -->"), "{text}");
        assert_eq!(text.matches("<!-- aibo-fit").count(), found.len());
        std::fs::write(&mjcf, &text).unwrap();
        let back = Description::read(&mjcf).unwrap();
        assert!(back.warnings.is_empty(), "{:?}", back.warnings);
        let elbow = &back.joints[back.joint("elbow").unwrap().0];
        assert_eq!((elbow.friction_nm, elbow.limit_rad), (0.19, Some([-3.0, 3.0])));
        assert_eq!(
            (back.actuators.len(), back.actuators[0].gain, back.actuators[0].bias),
            (1, 16.0, [0.0, -16.0, -0.4])
        );
        let matrix = |description: &Description| {
            let tree = Tree::new(description, TreeBase::Fixed).unwrap();
            let mut state = TreeState::drawn(&tree);
            state.position.copy_from_slice(&[0.4, -0.9]);
            state.rate.copy_from_slice(&[1.0, 2.0]);
            let (mut matrix, mut bias) = (DMatrix::zeros(2, 2), [0.0; 2]);
            let mut dynamics = TreeDynamics::new(&tree);
            dynamics.mass_matrix(&state, &mut matrix);
            dynamics.bias(&state, &mut bias);
            (matrix, bias)
        };
        let ((ours, level), (theirs, other)) = (matrix(&changed), matrix(&back));
        assert_relative_eq!(ours, theirs, epsilon = 1e-12);
        assert_relative_eq!(level[..], other[..], epsilon = 1e-12);
        let error = described.with_found(&[number("wrist", FoundKey::Kp, 1.0)]).unwrap_err();
        assert_eq!(error.to_string(), "the description has no joint `wrist`");
    }

    #[test]
    fn a_link_named_world_is_the_world_and_no_second_body_of_that_name() {
        let dir = tempfile::tempdir().unwrap();
        let urdf = dir.path().join("arm.urdf");
        std::fs::write(&urdf, ARM.replace("\"base\"", "\"world\"")).unwrap();
        let text = to_mjcf(&Description::read(&urdf).unwrap(), &[]);
        assert!(!text.contains("<body name=\"world\"") && text.contains("    <body name=\"upper\""), "{text}");
    }
}
