//! Bodies that MuJoCo does not fuse to what carries them, as other elements name them.

use crate::robot::description::xml::Element;
use std::collections::HashSet;

/// Names of bodies, and of sites in bodies, that other elements have.
#[derive(Debug, Default)]
pub(super) struct NamedBodies {
    bodies: HashSet<String>,
    sites: HashSet<String>,
}

impl NamedBodies {
    /// Those of a file.
    pub fn of(root: &Element) -> Self {
        let mut named = Self::default();
        named.look(root);
        named
    }

    fn look(&mut self, element: &Element) {
        let is_body = |kind: &str| element.text(kind).is_some_and(|kind| matches!(kind.trim(), "body" | "xbody"));
        let of_sensor = [("objtype", "objname"), ("reftype", "refname")].into_iter().filter(|(kind, _)| is_body(kind));
        let always = ["body", "body1", "body2", "target"];
        let names = always.into_iter().chain(of_sensor.map(|(_, name)| name)).filter_map(|name| element.text(name));
        self.bodies.extend(names.map(str::to_owned));
        if matches!(element.tag.as_str(), "force" | "torque") {
            self.sites.extend(element.text("site").map(str::to_owned));
        }
        element.children.iter().for_each(|child| self.look(child));
    }

    /// Whether a body of this name stays a body of its own without joints.
    pub fn keep_apart(&self, body: &Element, name: &str) -> bool {
        let says = |attribute: &str, word: &str| body.text(attribute).is_some_and(|own| own.trim() == word);
        says("mocap", "true") || says("fuse", "false") || self.bodies.contains(name) || self.has_site(body)
    }

    /// Whether a named site is in a body itself.
    fn has_site(&self, within: &Element) -> bool {
        within.children.iter().any(|child| match child.tag.as_str() {
            "site" => child.text("name").is_some_and(|name| self.sites.contains(name)),
            "frame" | "replicate" => self.has_site(child),
            _ => false,
        })
    }
}
