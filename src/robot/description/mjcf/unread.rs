//! Tendons, equalities and other sections: what of them moves joints is said or refused.

use super::Reader;
use crate::robot::description::Description;
use crate::robot::description::error::DescriptionError;
use crate::robot::description::xml::Element;

/// A section that is neither read nor silent.
pub(super) fn section(section: &Element, into: &mut Description) -> Result<(), DescriptionError> {
    match section.tag.as_str() {
        "deformable" => match section.children.iter().find(|child| child.tag == "flex") {
            Some(flex) => Err(flex.unsupported("<flex>", "only rigid bodies are read")),
            None => Ok(()),
        },
        "extension" => {
            let say = |plugin: &Element| plugin.say("a plugin: what it does is left out");
            into.left_out.extend(section.all("plugin").map(say));
            Ok(())
        }
        "body" | "frame" | "joint" | "freejoint" | "geom" | "replicate" | "attach" => {
            Err(section.wrong("it stands outside of <worldbody>"))
        }
        tag => {
            into.warnings.push(section.say(format!("unknown section <{tag}>, ignored")));
            Ok(())
        }
    }
}

impl Reader<'_> {
    /// Tendons that only carry actuators are silent, as long as nobody simulates; others are said.
    pub fn tendons(&mut self, root: &Element) -> Result<(), DescriptionError> {
        for tendon in root.all("tendon").flat_map(|section| &section.children) {
            let merged = self.classes.apply(&Element { tag: "tendon".into(), ..tendon.clone() }, None)?;
            let acts = |name: &str| -> Result<bool, DescriptionError> {
                Ok(merged.numbers(name)?.is_some_and(|numbers| numbers.iter().any(|number| *number != 0.0)))
            };
            if acts("armature")? {
                let hint = "its inertia couples joints; model it by joint armature";
                return Err(tendon.unsupported(format!("a {} tendon with armature", tendon.tag), hint));
            }
            let mut forces = Vec::new();
            for name in ["stiffness", "damping", "frictionloss", "range", "actuatorfrcrange"] {
                if acts(name)? {
                    forces.push(name);
                }
            }
            if !forces.is_empty() || tendon.tag != "fixed" {
                let with = if forces.is_empty() { String::new() } else { format!(" with {}", forces.join(", ")) };
                self.into.left_out.push(tendon.say(format!("a {} tendon{with}: its forces are left out", tendon.tag)));
            }
        }
        Ok(())
    }

    /// Equalities hold by forces that are in neither mass matrix nor bias.
    pub fn equalities(&mut self, root: &Element) {
        for one in root.all("equality").flat_map(|section| &section.children) {
            let what = match one.tag.as_str() {
                "connect" | "weld" => format!("an equality {} closes a loop", one.tag),
                tag => format!("an equality {tag} couples what moves"),
            };
            self.into.left_out.push(one.say(format!("{what}; it is left out, the joints move freely")));
        }
    }
}
