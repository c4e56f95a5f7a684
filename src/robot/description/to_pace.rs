//! A robot's joints as the parameters that PACE identifies and applies.

use super::Description;
use super::actuated::{Actuated, actuated};
use super::found::{FoundKey, FoundNumber};
use std::fmt::Write as _;

/// Step of PACE's simulations \[s\]; delays are counted in it.
const STEP_S: f64 = 0.0025;

/// Armature, damping (viscous friction), friction and encoder bias by joint and one delay, under PACE's names as YAML, and as
/// the vector `mean` in its order. Numbers of `found` are marked on their lines.
///
/// # Errors
/// Why there are no actuators, in words.
pub fn to_pace(description: &Description, found: &[FoundNumber]) -> Result<String, String> {
    let joints = actuated(description, found)?;
    let name = |joint: &Actuated<'_>| format!("{:?}", joint.name);
    let order: Vec<String> = joints.iter().map(name).collect();
    let mut text = format!(
        "# Joints of {} as PACE has them, written by aibo-fit. SI units.\njoint_order: [{}]\n",
        description.name.replace(char::is_control, " "),
        order.join(", ")
    );
    type Row<'r> = (&'r str, &'r str, &'r [FoundKey], fn(&Actuated<'_>) -> f64);
    let rows: [Row<'_>; 6] = [
        ("armature", "kg m^2", &[FoundKey::Armature], |joint| joint.armature),
        ("damping", "viscous friction, N m s/rad", &[FoundKey::Damping], |joint| joint.viscous),
        ("friction", "N m", &[FoundKey::Frictionloss], |joint| joint.coulomb),
        ("bias", "rad, angle less reading", &[FoundKey::EncoderZero], |joint| joint.zero_rad),
        ("stiffness", "gain of the servo, N m/rad; not PACE's to find", &[FoundKey::Kp], |joint| joint.kp),
        ("derivative", "of the servo, N m s/rad; not PACE's to find", &[FoundKey::Kd], |joint| joint.kd),
    ];
    for (key, unit, keys, value) in &rows {
        let _ = writeln!(text, "{key}:  # {unit}");
        for joint in &joints {
            let _ = writeln!(text, "  {}: {:?}{}", name(joint), value(joint), joint.mark(keys));
        }
    }
    let longest = joints.iter().max_by(|a, b| a.delay_s.total_cmp(&b.delay_s));
    let late_s = longest.map_or(0.0, |joint| joint.delay_s);
    let steps = (late_s / STEP_S).round();
    let mark = longest.map(|joint| joint.mark(&[FoundKey::Delay])).unwrap_or_default();
    let of = longest.filter(|_| late_s > 0.0).map_or_else(String::new, |joint| format!(", {}'s", joint.name));
    let _ = writeln!(
        text,
        "dt: {STEP_S:?}  # s\ndelay: {steps}  # steps of dt, one for all joints{of}{}",
        mark.replace("  # aibo-fit:", ";")
    );
    let vector = rows[..4].iter().flat_map(|(_, _, _, value)| joints.iter().map(value));
    let vector: Vec<String> = vector.chain([steps]).map(|number| format!("{number:?}")).collect();
    let _ = writeln!(text, "mean: [{}]  # armature, damping, friction, bias by joint_order, delay", vector.join(", "));
    Ok(text)
}
