//! Tendons, equalities and other sections: what of them moves joints is said or refused.

use super::Reader;
use crate::robot::description::error::DescriptionError;
use crate::robot::description::xml::Element;
use crate::robot::description::{Coupling, Description, MoverId};

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

    /// Equalities hold by forces that are in neither mass matrix nor bias; those that are straight lines between two joints
    /// can be held rigidly.
    pub fn equalities(&mut self, root: &Element) -> Result<(), DescriptionError> {
        for one in root.all("equality").flat_map(|section| &section.children) {
            let what = match one.tag.as_str() {
                "connect" | "weld" => format!("an equality {} closes a loop", one.tag),
                tag => format!("an equality {tag} couples what moves"),
            };
            let said = one.say(format!("{what}; it is left out, the joints move freely"));
            if one.tag == "joint" {
                if one.word("active", &[("true", true), ("false", false)])? == Some(false) {
                    continue;
                }
                if let Some(coupling) = self.joint_equality(one)? {
                    self.into.equalities.push((coupling, said.clone()));
                }
            }
            self.into.left_out.push(said);
        }
        Ok(())
    }

    /// `joint1 - ref1 = a0 + a1 (joint2 - ref2)`; `None` for curves, for a joint that is held alone, and for one that follows
    /// already or leads back to itself.
    fn joint_equality(&self, one: &Element) -> Result<Option<Coupling>, DescriptionError> {
        let named = |attribute: &str| -> Result<Option<MoverId>, DescriptionError> {
            let Some(name) = one.text(attribute) else { return Ok(None) };
            let known = self.into.joint(name);
            known.map(Some).ok_or_else(|| one.bad(attribute, "the name of a joint"))
        };
        let (follower, leader) = (named("joint1")?, named("joint2")?);
        let line = one.numbers("polycoef")?.unwrap_or_else(|| vec![0.0, 1.0]);
        let (Some(follower), Some(leader)) = (follower, leader) else { return Ok(None) };
        let at = |k: usize| line.get(k).copied().unwrap_or(0.0);
        let leader_of = |joint: MoverId| {
            let own = self.into.equalities.iter().find(|(known, _)| known.follower == joint);
            own.map(|(known, _)| known.leader)
        };
        let mut above = Some(leader);
        while let Some(joint) = above.filter(|joint| *joint != follower) {
            above = leader_of(joint);
        }
        if above == Some(follower) || leader_of(follower).is_some() || (2..5).any(|k| at(k) != 0.0) || at(1) == 0.0 {
            return Ok(None);
        }
        let drawn = |joint: MoverId| self.into.joints[joint.0].drawn_rad;
        let offset_rad = drawn(follower) + at(0) - at(1) * drawn(leader);
        Ok(Some(Coupling { follower, leader, multiplier: at(1), offset_rad }))
    }
}
