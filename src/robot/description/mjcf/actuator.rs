//! `<actuator>`: motors and servos on joints.

use super::Reader;
use super::compiler::Compiler;
use super::defaults::ACTUATORS;
use super::joint::{polynomial, range};
use crate::robot::description::error::DescriptionError;
use crate::robot::description::parts::{Actuator, ActuatorKind, MoverId};
use crate::robot::description::xml::Element;

/// What an actuator may act on besides a joint.
const ELSEWHERE: &[&str] = &["tendon", "site", "refsite", "body", "cranksite", "slidersite"];

impl Reader<'_> {
    /// Reads all actuators; those that are left out are said.
    pub fn actuators(&mut self, root: &Element, suffixes: &[String]) -> Result<(), DescriptionError> {
        for element in root.all("actuator").flat_map(|section| &section.children) {
            if element.tag == "plugin" {
                return Err(element.unsupported("an actuator plugin", "use motor, position, velocity or general"));
            }
            if !ACTUATORS.contains(&element.tag.as_str()) {
                return Err(
                    element.unsupported(format!("the actuator <{}>", element.tag), "MuJoCo has no such actuator")
                );
            }
            let merged = self.classes.apply(element, None)?;
            self.add_rotor(element, &merged, suffixes)?;
            if merged.number("delay")?.is_some_and(|delay_s| delay_s != 0.0) {
                self.into.warnings.push(element.say("its delay is not read: `gap` finds one from logs"));
            }
            let kind = match element.tag.as_str() {
                "motor" => ActuatorKind::Motor,
                "position" => ActuatorKind::Position,
                "velocity" => ActuatorKind::Velocity,
                "general" => ActuatorKind::General,
                other => {
                    self.into.left_out.push(element.say(format!("an actuator of kind {other} is left out")));
                    continue;
                }
            };
            let Some(joint) = merged.text("joint").or_else(|| merged.text("jointinparent")) else {
                let on = ELSEWHERE.iter().find(|on| merged.text(on).is_some());
                let on = on.ok_or_else(|| element.wrong("it acts on nothing: an attribute `joint` is missing"))?;
                self.into.left_out.push(element.say(format!("an actuator on a {on} is left out")));
                continue;
            };
            for id in self.targets(element, joint, suffixes)? {
                let mut actuator = read(&merged, kind, id, &self.compiler)?;
                self.inherit_range(&merged, &mut actuator)?;
                self.into.actuators.push(actuator);
            }
        }
        Ok(())
    }

    /// `armature` and `damping` of an actuator: the joint feels its rotor through the gear, whatever drives it.
    fn add_rotor(&mut self, element: &Element, merged: &Element, suffixes: &[String]) -> Result<(), DescriptionError> {
        let armature = merged.not_negative("armature")?.unwrap_or(0.0);
        let damping = polynomial(merged, "damping")?;
        let named = [("armature", armature > 0.0), ("damping", damping != [0.0; 3])];
        let named: Vec<&str> = named.into_iter().filter(|(_, acts)| *acts).map(|(name, _)| name).collect();
        let Some(what) = named.first() else { return Ok(()) };
        let joint = merged.text("joint").or_else(|| merged.text("jointinparent"));
        let joints = joint.map_or_else(|| Ok(Vec::new()), |joint| self.targets(element, joint, suffixes))?;
        if joints.is_empty() {
            let hint = format!("write it as the {what} of joints");
            return Err(element.unsupported(format!("the {what} of an actuator on anything but a joint"), hint));
        }
        let gear = merged.numbers("gear")?.and_then(|gear| gear.first().copied()).unwrap_or(1.0);
        for id in joints {
            let joint = &mut self.into.joints[id.0];
            joint.armature_kg_m2 += gear * gear * armature;
            joint.damping.iter_mut().zip(damping).for_each(|(of_joint, own)| *of_joint += gear * gear * own);
        }
        let what = named.join(" and ");
        self.into.warnings.push(element.say(format!("its {what}, behind its gear, counts as the joint's")));
        Ok(())
    }

    /// The joint of a name; all copies of it where it was replicated; none where it is the free one.
    fn targets(&self, of: &Element, name: &str, suffixes: &[String]) -> Result<Vec<MoverId>, DescriptionError> {
        if let Some(joint) = self.into.joint(name) {
            return Ok(vec![joint]);
        }
        let copies: Vec<MoverId> =
            suffixes.iter().filter_map(|suffix| self.into.joint(&format!("{name}{suffix}"))).collect();
        let is_free = self.into.free_joint.as_ref().is_some_and(|free| free.name == name);
        if copies.is_empty() && !is_free {
            return Err(of.bad("joint", "the name of a joint"));
        }
        Ok(copies)
    }

    /// `inheritrange`: the control range is the joint's range, scaled about its middle.
    fn inherit_range(&self, of: &Element, actuator: &mut Actuator) -> Result<(), DescriptionError> {
        let Some(scale) = of.not_negative("inheritrange")?.filter(|scale| *scale > 0.0) else { return Ok(()) };
        let joint = &self.into.joints[actuator.joint.0];
        let Some([low, high]) = joint.limit_rad else {
            return Err(of.bad("inheritrange", format!("a range of joint \"{}\" to inherit", joint.name)));
        };
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) * scale);
        actuator.control_range = Some([middle - half, middle + half]);
        Ok(())
    }
}

fn read(of: &Element, kind: ActuatorKind, joint: MoverId, compiler: &Compiler) -> Result<Actuator, DescriptionError> {
    let list = |name: &str| -> Result<[f64; 3], DescriptionError> {
        let given = of.numbers(name)?.unwrap_or_default();
        let mut first = [0.0; 3];
        first.iter_mut().zip(given).for_each(|(to, from)| *to = from);
        Ok(first)
    };
    let first = |name: &str| of.numbers(name).map(|all| all.and_then(|all| all.first().copied()));
    let (gain, bias) = (first("gainprm")?.unwrap_or(1.0), list("biasprm")?);
    let (gain, bias) = match kind {
        ActuatorKind::Motor => (1.0, [0.0; 3]),
        ActuatorKind::Position => {
            let kp = of.not_negative("kp")?.unwrap_or(gain);
            let damping = of.not_negative("kv")?.map_or(bias[2], |kv| -kv);
            (kp, [0.0, -kp, damping])
        }
        ActuatorKind::Velocity => {
            let kv = of.not_negative("kv")?.unwrap_or(gain);
            (kv, [0.0, 0.0, -kv])
        }
        ActuatorKind::General => match of.text("biastype").unwrap_or("none").trim() {
            "affine" => (gain, bias),
            _ => (gain, [0.0; 3]),
        },
    };
    Ok(Actuator {
        name: of.text("name").unwrap_or_default().to_owned(),
        kind,
        joint,
        gear: first("gear")?.unwrap_or(1.0),
        gain,
        bias,
        damping_ratio: of.not_negative("dampratio")?.filter(|_| kind == ActuatorKind::Position),
        control_range: range(of, "ctrlrange", "ctrllimited", compiler)?,
        force_range_nm: range(of, "forcerange", "forcelimited", compiler)?,
        activation: activation(of, kind),
    })
}

/// What lies between control and force, if anything does, or what force a general actuator has besides gain and bias.
fn activation(of: &Element, kind: ActuatorKind) -> Option<String> {
    let named = |name: &str, harmless: &[&str]| {
        of.text(name).filter(|word| !harmless.contains(word)).map(|word| format!("{name}=\"{word}\""))
    };
    match kind {
        ActuatorKind::Position => of.text("timeconst").map(|time| format!("timeconst=\"{time}\"")),
        ActuatorKind::General => named("dyntype", &["none"])
            .or_else(|| named("gaintype", &["fixed"]))
            .or_else(|| named("biastype", &["none", "affine"])),
        _ => None,
    }
}
