//! Names of bodies and joints: those of the file, with what replicas add, or invented.

use crate::robot::description::error::DescriptionError;
use crate::robot::description::xml::Element;
use std::collections::HashSet;

/// The names so far.
#[derive(Debug, Default)]
pub(super) struct Names {
    bodies: HashSet<String>,
    joints: HashSet<String>,
    /// What the file has somewhere, replicas aside: nothing is invented that comes later.
    reserved: HashSet<String>,
    invented: [usize; 2],
    made: usize,
    /// What replicas added to names, in the order in which they came.
    pub suffixes: Vec<String>,
}

impl Names {
    /// Of a file whose names are given before any is invented.
    pub fn of(root: &Element) -> Self {
        let mut names = Self::default();
        names.reserve(root);
        names
    }

    fn reserve(&mut self, element: &Element) {
        if matches!(element.tag.as_str(), "body" | "joint") {
            self.reserved.extend(given(element, ""));
        }
        element.children.iter().for_each(|child| self.reserve(child));
    }

    /// The name of a body, and whether the file gives it.
    pub fn of_body(&mut self, body: &Element, suffix: &str) -> Result<(String, bool), DescriptionError> {
        self.made += 1;
        if let Some(name) = given(body, suffix) {
            return match self.bodies.insert(name.clone()) {
                true => Ok((name, true)),
                false => Err(body.wrong("a second body of this name")),
            };
        }
        self.invented[0] += 1;
        Ok((fresh(&mut self.bodies, &self.reserved, format!("body_{}", self.made)), false))
    }

    /// The name of a joint of a body.
    pub fn of_joint(&mut self, joint: &Element, suffix: &str, body: &str) -> Result<String, DescriptionError> {
        if let Some(name) = given(joint, suffix) {
            return match self.joints.insert(name.clone()) {
                true => Ok(name),
                false => Err(joint.wrong("a second joint of this name")),
            };
        }
        self.invented[1] += 1;
        Ok(fresh(&mut self.joints, &self.reserved, format!("{body}_joint")))
    }

    /// That names were invented.
    pub fn warning(&self) -> Option<String> {
        let [bodies, joints] = self.invented;
        (bodies + joints > 0).then(|| {
            format!("{bodies} bodies and {joints} joints have no name and were given one (body_N, BODY_joint)")
        })
    }
}

fn given(element: &Element, suffix: &str) -> Option<String> {
    element.text("name").filter(|name| !name.is_empty()).map(|name| format!("{name}{suffix}"))
}

/// A name that is not taken, nor will be.
fn fresh(taken: &mut HashSet<String>, reserved: &HashSet<String>, name: String) -> String {
    let mut found = name.clone();
    let mut number = 2;
    while reserved.contains(&found) || !taken.insert(found.clone()) {
        found = format!("{name}_{number}");
        number += 1;
    }
    found
}
