//! What a robot study says of a robot that somebody else described.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use super::raw::{RawFriction, RawRobot};
use crate::log::clamped_study::{JointBeliefs, JointTables, RawBeliefs, joint_tables};
use crate::log::document::{Document, Range64, range};
use crate::log::error::LogError;

/// What files of robots that others describe end in.
const ENDINGS: [&str; 3] = ["urdf", "xml", "mjcf"];

const RADIUS: Range64 =
    range(|x| x > 0.0 && x <= 1.0, "a radius above 0, at most 1 m; a larger one looks like millimetres");

/// What a study says beyond the description of a robot that walks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DescribedBeliefs {
    /// Links that are feet, balls about their frames' origins, with their radii \[m\]; none: what collides at the ends of chains.
    pub feet_m: BTreeMap<String, f64>,
    /// What is believed of all joints.
    pub all: JointBeliefs,
    /// What is believed of single joints, by name.
    pub by_joint: BTreeMap<String, JointBeliefs>,
}

impl DescribedBeliefs {
    /// What the study says of a joint.
    pub fn of_joint(&self, name: &str) -> JointBeliefs {
        self.all.of_joint(name, &self.by_joint)
    }
}

/// Whether a model is one that somebody else described, by its file's ending.
pub(super) fn is_described(model: &str) -> bool {
    let ending = Path::new(model).extension();
    ending.is_some_and(|ending| ENDINGS.iter().any(|of| ending.eq_ignore_ascii_case(of)))
}

/// Checks what a study says of such a robot; `None` for one of our own.
pub(super) fn described(
    document: &Document<'_>,
    robot: &RawRobot,
    joints: &BTreeMap<String, RawBeliefs>,
    friction: Option<&RawFriction>,
) -> Result<Option<DescribedBeliefs>, LogError> {
    if !robot.model.as_ref().is_some_and(|model| is_described(model.get_ref())) {
        let expected = "it beside a URDF or MJCF; \"ers7\" and robot files of our own have [friction], [control] gains and \
                        contact_mm for that";
        // A table has no place of its own.
        let begin = document.text().find("[joints").unwrap_or(0);
        let of_joint = joints.keys().next().map(|name| (format!("[joints.{name}]"), begin..begin + 1));
        let of_foot = || robot.feet.iter().next().map(|(link, radius)| (format!("[robot] feet.{link}"), radius.span()));
        return match of_joint.or_else(of_foot) {
            Some((key, span)) => Err(document.wrong(&key, span, "it beside a robot of our own", expected)),
            None => Ok(None),
        };
    }
    if let Some(stated) = friction.and_then(|friction| friction.coulomb.as_ref().or(friction.viscous.as_ref())) {
        let expected = "coulomb and viscous in [joints.default] or [joints.NAME]: it has no joints q1, q2, q3";
        return Err(document.wrong("[friction]", stated.span(), "it beside a robot that others describe", expected));
    }
    for (name, raw) in joints {
        if let Some((key, span)) = of_clamped_alone(raw) {
            let expected = "coulomb, viscous, armature, kp, kd and torque_limit; the rest is for scenario = \"fixed\", an \
                            integral part for [control] gains.NAME = [P, I, D]";
            return Err(document.wrong(&format!("[joints.{name}] {key}"), span, "a key of clamped robots", expected));
        }
    }
    let mut feet_m = BTreeMap::new();
    for (link, radius) in &robot.feet {
        let key = format!("[robot] feet.{link}");
        feet_m.insert(link.clone(), document.within(&key, radius.span(), *radius.get_ref(), RADIUS)?);
    }
    let JointTables { all, by_joint, .. } = joint_tables(document, joints)?;
    Ok(Some(DescribedBeliefs { feet_m, all, by_joint }))
}

/// A key that only robots with a clamped base have.
fn of_clamped_alone(raw: &RawBeliefs) -> Option<(&'static str, Range<usize>)> {
    let numbers = [
        ("ki", &raw.ki),
        ("speed_limit", &raw.speed_limit),
        ("kt", &raw.kt),
        ("resistance", &raw.resistance),
        ("supply", &raw.supply),
        ("duty_limit", &raw.duty_limit),
        ("gear", &raw.gear),
    ];
    let words = [("model", &raw.model), ("encoder", &raw.encoder), ("tau_is", &raw.tau_is)];
    let of_words = || words.into_iter().find_map(|(key, word)| Some((key, word.as_ref()?.span())));
    numbers.into_iter().find_map(|(key, number)| Some((key, number.as_ref()?.span()))).or_else(of_words)
}
