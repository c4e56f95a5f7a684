//! `<option>`: what it says of gravity is read, what else changes the motion is said.

use crate::number::STANDARD_GRAVITY_M_S2;
use crate::robot::description::error::DescriptionError;
use crate::robot::description::xml::Element;
use nalgebra::Vector3;

/// Flags without which MuJoCo leaves out what stands in a joint or an actuator.
const FLAGS: [&str; 6] = ["actuation", "damper", "spring", "frictionloss", "limit", "clampctrl"];
/// Numbers of the medium, which drags bodies where they are not 0.
const MEDIUM: [&str; 3] = ["density", "viscosity", "wind"];

/// `<option gravity>`, which `<flag gravity="disable"/>` switches off.
pub(super) fn gravity(root: &Element) -> Result<Vector3<f64>, DescriptionError> {
    let (mut gravity, mut is_on) = (Vector3::new(0.0, 0.0, -STANDARD_GRAVITY_M_S2), true);
    for option in root.all("option") {
        if let Some(written) = option.exactly::<3>("gravity")? {
            gravity = Vector3::from(written);
        }
        for flag in option.all("flag") {
            is_on = flag.word("gravity", &[("enable", true), ("disable", false)])?.unwrap_or(is_on);
        }
    }
    Ok(if is_on { gravity } else { Vector3::zeros() })
}

/// Warns of what changes the motion and is not read.
pub(super) fn unread(root: &Element, warnings: &mut Vec<String>) -> Result<(), DescriptionError> {
    for option in root.all("option") {
        for name in MEDIUM {
            if option.numbers(name)?.is_some_and(|numbers| numbers.iter().any(|number| *number != 0.0)) {
                warnings.push(option.say(format!("{name} is not read: nothing around the robot drags it")));
            }
        }
        if option.text("actuatorgroupdisable").is_some_and(|groups| !groups.trim().is_empty()) {
            warnings.push(option.say("actuatorgroupdisable is not read: all actuators act"));
        }
        for flag in option.all("flag") {
            let off = FLAGS.into_iter().filter(|name| flag.text(name).is_some_and(|word| word.trim() == "disable"));
            warnings.extend(off.map(|name| flag.say(format!("{name}=\"disable\" is not read: it stays on"))));
        }
    }
    Ok(())
}
