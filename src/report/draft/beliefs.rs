//! What a robot's study asks to be believed of its joints beyond the description.

use super::listed;
use crate::log::toml_key;
use crate::robot::description::{Actuator, Description, JointKind, Mover};
use std::fmt::Write as _;

/// What all joints have.
const OF_ALL: &str = "\n\
    [joints.default]   # what you believe beyond the description; by name as in [joints.elbow]\n\
    # coulomb = 0.0    # N m, dry friction of the joint and its gears; the description's where absent\n\
    # viscous = 0.0    # N m s/rad; the description's where absent\n\
    # armature = 0.0   # kg m^2, rotor inertia x gear ratio^2; the description's where absent\n";
/// The same of joints that follow setpoints.
const OF_DRIVES: &str = "\
    # kp = 0.0         # N m/rad: tau = kp (q_ref - q) - kd q'; the description's position actuator where absent\n\
    # kd = 0.0         # N m s/rad\n\
    # torque_limit = 0.0   # N m\n";
/// Keys of a joint, and their units where it turns and where it slides.
static KEYS: [(&str, [&str; 2]); 6] = [
    ("coulomb", ["N m", "N"]),
    ("viscous", ["N m s/rad", "N s/m"]),
    ("armature", ["kg m^2", "kg"]),
    ("kp", ["N m/rad", "N/m"]),
    ("kd", ["N m s/rad", "N s/m"]),
    ("torque_limit", ["N m", "N"]),
];
/// How many of them a joint has that follows no setpoints.
const UNDRIVEN: usize = 3;

/// Keys that a description leaves open, and the joints that it does so of.
struct Open<'a> {
    keys: &'static [&'static str],
    silent: Vec<&'a Mover>,
    /// Whether it says them of no joint at all.
    is_of_all: bool,
}

impl Open<'_> {
    /// Of whom.
    fn whom(&self) -> String {
        let names: Vec<&str> = self.silent.iter().map(|joint| joint.name.as_str()).collect();
        listed(&names)
    }

    /// What the description has.
    fn none(&self) -> String {
        if self.is_of_all { "none".to_owned() } else { format!("none of {}", self.whom()) }
    }

    /// The table to state them under.
    fn table(&self) -> &'static str {
        if self.is_of_all {
            "[joints.default]"
        } else {
            "[joints.NAME] of each ([joints.default] would stand over what it has of the others)"
        }
    }
}

/// The tables `[joints]`; what of them has to be filled in is added.
pub(super) fn tables(
    robot: &Description,
    moving: &[&Mover],
    is_driven: bool,
    untold: &mut Vec<String>,
    to_fill: &mut Vec<&'static str>,
) -> String {
    let open = open(robot, moving, is_driven);
    if is_driven && !open.iter().any(is_of_gains) {
        untold.push(
            "whether the description's gains are those of the drives: a log shows setpoints, not gains".to_owned(),
        );
    }
    for own in &open {
        to_fill.extend(own.keys);
        untold.push(question(own));
    }
    let of_drives = if is_driven { OF_DRIVES } else { "" };
    format!("{OF_ALL}{of_drives}{}", own_tables(moving, &open, is_driven))
}

/// What a description does not say of joints: gains of any of them, friction and rotor inertia of most.
fn open<'a>(robot: &Description, moving: &[&'a Mover], is_driven: bool) -> Vec<Open<'a>> {
    let servos: Vec<Actuator> = robot.actuators.iter().filter_map(Actuator::as_servo).collect();
    let has_servo = |joint: &Mover| servos.iter().any(|servo| robot.joints[servo.joint.0].name == joint.name);
    let has_friction = |joint: &Mover| joint.friction_nm != 0.0 || joint.damping.iter().any(|part| *part != 0.0);
    let has_rotor = |joint: &Mover| joint.armature_kg_m2 != 0.0;
    let of = |keys: &'static [&'static str], is_said: &dyn Fn(&Mover) -> bool| {
        let silent: Vec<&Mover> = moving.iter().copied().filter(|joint| !is_said(joint)).collect();
        Open { keys, is_of_all: silent.len() == moving.len(), silent }
    };
    let gains = of(&["kp", "kd"], &has_servo);
    let others = [of(&["coulomb", "viscous"], &has_friction), of(&["armature"], &has_rotor)];
    let is_of_most = |open: &Open<'_>| 2 * open.silent.len() > moving.len();
    let gains = Some(gains).filter(|gains| is_driven && !gains.silent.is_empty());
    gains.into_iter().chain(others.into_iter().filter(is_of_most)).collect()
}

fn is_of_gains(open: &Open<'_>) -> bool {
    open.keys.contains(&"kp")
}

/// What to ask of keys that are open.
fn question(open: &Open<'_>) -> String {
    let (none, table) = (open.none(), open.table());
    match open.keys {
        ["armature"] => format!(
            "rotor inertia: the description has {none}; state armature, rotor inertia times gear ratio squared, under \
             {table}"
        ),
        ["coulomb", ..] => {
            format!("friction: the description has {none}; state coulomb and viscous under {table}")
        }
        _ => {
            let whose = if open.is_of_all { "joints".to_owned() } else { open.whom() };
            format!(
                "the gains of {whose} without a position actuator in the description: state kp and kd under {table}; kp is a \
                 known torque by the angle that the joint gives under it"
            )
        }
    }
}

/// Tables of single joints: of those that slide, whose units are others, and of those that the description says less of than
/// of others.
fn own_tables(moving: &[&Mover], open: &[Open<'_>], is_driven: bool) -> String {
    let mut text = String::new();
    let keys = if is_driven { &KEYS[..] } else { &KEYS[..UNDRIVEN] };
    for joint in moving {
        let slides = joint.kind == JointKind::Prismatic;
        let is_open = |key: &str| {
            let own = open.iter().filter(|own| !own.is_of_all && own.keys.contains(&key));
            own.flat_map(|own| &own.silent).any(|silent| silent.name == joint.name)
        };
        let mut lines = keys.iter().filter(|(key, _)| slides || is_open(key)).peekable();
        if lines.peek().is_some() {
            let why = if slides { "it slides: forces in N, ways in m" } else { "the description does not have these" };
            let _ = writeln!(text, "\n[joints.{}]   # {why}", toml_key(&joint.name));
        }
        for (key, units) in lines {
            let assignment = format!("# {key} = 0.0");
            let _ = writeln!(text, "{assignment:<22} # {}", units[usize::from(slides)]);
        }
    }
    text
}
