//! A robot's servos as Isaac Lab configures actuators.

use super::Description;
use super::actuated::{Actuated, actuated};
use super::found::{FoundKey, FoundNumber};
use std::fmt::Write as _;

/// A Python module with one actuator group for each joint: `ImplicitActuatorCfg`, or `DelayedPDActuatorCfg` where setpoints
/// are late. Numbers of `found` are marked on their lines.
///
/// # Errors
/// Why there are no actuators, in words.
pub fn to_isaac(description: &Description, found: &[FoundNumber]) -> Result<String, String> {
    let joints = actuated(description, found)?;
    let mut text = format!(
        "\"\"\"Actuators of {} for Isaac Lab, written by aibo-fit.\n\n\
         ArticulationCfg(..., actuators=ACTUATORS). SI units; friction is an effort, as in Isaac Sim 5 and later.\n\
         Masses and inertias are the asset's: export --to urdf or mjcf writes those.\n\"\"\"\n\n\
         from isaaclab.actuators import DelayedPDActuatorCfg, ImplicitActuatorCfg\n\n\
         # Step of the physics [s]: delays are counted in it.\nPHYSICS_DT = 0.005\n\nACTUATORS = {{\n",
        description.name.replace(['\\', '"'], "_")
    );
    for joint in &joints {
        group(&mut text, joint);
    }
    Ok(text + "}\n")
}

fn group(text: &mut String, joint: &Actuated<'_>) {
    use FoundKey::{Armature, Damping, Delay, Frictionloss, Kd, Kp, StaticFriction, TorqueLimit};
    let is_late = joint.delay_s > 0.0;
    let class = if is_late { "DelayedPDActuatorCfg" } else { "ImplicitActuatorCfg" };
    let quoted = joint.name.replace('\\', "\\\\").replace('"', "\\\"");
    let _ = writeln!(text, "    \"{quoted}\": {class}(");
    let _ = writeln!(text, "        joint_names_expr=[\"{}\"],", pattern(joint.name));
    let mut line = |name: &str, value: f64, keys: &[FoundKey]| {
        let _ = writeln!(text, "        {name}={value:?},{}", joint.mark(keys));
    };
    line("stiffness", joint.kp, &[Kp]);
    line("damping", joint.kd, &[Kd]);
    if let Some(effort) = joint.effort {
        if is_late {
            line("effort_limit", effort, &[TorqueLimit]);
        }
        line("effort_limit_sim", effort, &[TorqueLimit]);
    }
    if let Some(velocity) = joint.velocity {
        line("velocity_limit_sim", velocity, &[]);
    }
    line("armature", joint.armature, &[Armature]);
    line("friction", joint.static_friction, &[StaticFriction, Frictionloss]);
    line("dynamic_friction", joint.coulomb, &[Frictionloss]);
    line("viscous_friction", joint.viscous, &[Damping]);
    if is_late {
        for name in ["min_delay", "max_delay"] {
            let mark = joint.mark(&[Delay]);
            let _ = writeln!(text, "        {name}=round({:?} / PHYSICS_DT),{mark}", joint.delay_s);
        }
    }
    *text += "    ),\n";
}

/// A joint's name as the pattern that fits it alone, within a Python string.
fn pattern(name: &str) -> String {
    let special = |c: char| matches!(c, '.' | '+' | '*' | '?' | '(' | ')' | '[' | ']' | '{' | '}' | '^' | '$' | '|');
    name.chars().fold(String::new(), |mut text, c| {
        match c {
            '\\' => text += "\\\\\\\\",
            '"' => text += "\\\"",
            c if special(c) => {
                text += "\\\\";
                text.push(c);
            }
            c => text.push(c),
        }
        text
    })
}
