//! `<worldbody>`: bodies within bodies, with the frames and replicas between them.

use super::geom;
use super::inertial::Support;
use super::naming::Names;
use super::orientation::pose;
use super::{Reader, joint};
use crate::robot::description::MOST_LINKS;
use crate::robot::description::error::DescriptionError;
use crate::robot::description::parts::{Collider, FreeJoint, Link, LinkId, MoverId};
use crate::robot::description::xml::Element;
use nalgebra::{Isometry3, Translation3};

/// Elements that replicas may multiply to.
const MOST_ELEMENTS: usize = 200_000;

/// What stands around an element.
#[derive(Clone, Debug)]
pub(super) struct Scope<'e> {
    /// Of the frames and replicas between the body and the element.
    pub pose: Isometry3<f64>,
    /// The class of elements without one.
    pub childclass: Option<&'e str>,
    /// What replicas add to names.
    pub suffix: String,
}

/// What a body has in it, its frames resolved.
#[derive(Default)]
pub(super) struct Content<'e> {
    joints: Vec<(&'e Element, Scope<'e>)>,
    pub geoms: Vec<(&'e Element, Scope<'e>)>,
    pub inertials: Vec<(&'e Element, Scope<'e>)>,
    bodies: Vec<(&'e Element, Scope<'e>)>,
}

impl Reader<'_> {
    /// Reads all bodies, parents first, depth first. The answer is the suffixes that replicas gave to names.
    pub fn bodies(&mut self, root: &Element) -> Result<Vec<String>, DescriptionError> {
        let (mut names, mut left) = (Names::of(root), MOST_ELEMENTS);
        let mut open: Vec<(&Element, Scope<'_>, Option<LinkId>)> = Vec::new();
        for world in root.all("worldbody") {
            let mut content = Content::default();
            let scope =
                Scope { pose: Isometry3::identity(), childclass: world.text("childclass"), suffix: String::new() };
            self.gather(world, &scope, &mut content, &mut left, &mut names)?;
            if let Some((joint, _)) = content.joints.first() {
                return Err(joint.wrong("the world does not move; put the joint into a body"));
            }
            open.extend(content.bodies.into_iter().map(|(body, scope)| (body, scope, None)));
        }
        open.reverse();
        while let Some((body, scope, parent)) = open.pop() {
            let mut content = Content::default();
            let childclass = body.text("childclass").or(scope.childclass);
            self.classes.check(body, "childclass")?;
            let inside = Scope { pose: Isometry3::identity(), childclass, suffix: scope.suffix.clone() };
            self.gather(body, &inside, &mut content, &mut left, &mut names)?;
            let id = self.body(body, &scope, parent, &content, &mut names)?;
            open.extend(content.bodies.into_iter().rev().map(|(body, scope)| (body, scope, Some(id))));
        }
        if self.into.links.is_empty() {
            return Err(
                root.wrong("no <body> in a <worldbody>, expected a robot; give the file that includes this one")
            );
        }
        self.into.warnings.extend(names.warning());
        Ok(names.suffixes)
    }

    /// Sorts what is in a body, a frame or a replica; looks through frames and replicas.
    fn gather<'e>(
        &self,
        element: &'e Element,
        scope: &Scope<'e>,
        content: &mut Content<'e>,
        left: &mut usize,
        names: &mut Names,
    ) -> Result<(), DescriptionError> {
        for child in &element.children {
            *left = left
                .checked_sub(1)
                .ok_or_else(|| child.wrong(format!("replicas make more than {MOST_ELEMENTS} elements of the file")))?;
            match child.tag.as_str() {
                "body" => content.bodies.push((child, scope.clone())),
                "joint" | "freejoint" => content.joints.push((child, scope.clone())),
                "geom" => content.geoms.push((child, scope.clone())),
                "inertial" => content.inertials.push((child, scope.clone())),
                "site" | "camera" | "light" => {}
                "frame" => {
                    self.classes.check(child, "childclass")?;
                    let inner = Scope {
                        pose: scope.pose * pose(child, &self.compiler)?,
                        childclass: child.text("childclass").or(scope.childclass),
                        suffix: scope.suffix.clone(),
                    };
                    self.gather(child, &inner, content, left, names)?;
                }
                "replicate" => self.replicate(child, scope, content, left, names)?,
                "composite" | "flexcomp" | "attach" | "plugin" => {
                    let hint = "write out what it stands for: MuJoCo can save the compiled model as MJCF";
                    return Err(child.unsupported(format!("<{}>", child.tag), hint));
                }
                tag => {
                    let hint =
                        "a body may hold body, joint, freejoint, geom, inertial, site, camera, light, frame, replicate";
                    return Err(child.unsupported(format!("<{tag}> in <{}>", element.tag), hint));
                }
            }
        }
        Ok(())
    }

    /// So many copies, each moved on from the last and turned by as much more; names get the copy's number.
    fn replicate<'e>(
        &self,
        replicate: &'e Element,
        scope: &Scope<'e>,
        content: &mut Content<'e>,
        left: &mut usize,
        names: &mut Names,
    ) -> Result<(), DescriptionError> {
        let count = replicate.number("count")?.unwrap_or(-1.0);
        if !(count >= 0.0 && count <= MOST_ELEMENTS as f64 && count.fract() == 0.0) {
            return Err(replicate.bad("count", format!("a whole number from 0 to {MOST_ELEMENTS}")));
        }
        self.classes.check(replicate, "childclass")?;
        let offset = Translation3::from(replicate.exactly::<3>("offset")?.unwrap_or_default());
        let euler = replicate.exactly::<3>("euler")?.unwrap_or_default().map(|angle| self.compiler.angle(angle));
        let digits = (count as usize).to_string().len();
        let mut place = Translation3::identity();
        // Of nothing there are no copies to go through.
        let copies = if replicate.children.is_empty() { 0 } else { count as usize };
        for copy in 0..copies {
            let turned = self.compiler.sequence.rotation(euler.map(|angle| angle * copy as f64));
            let suffix = format!("{}{copy:0digits$}{}", replicate.text("sep").unwrap_or_default(), scope.suffix);
            names.suffixes.push(suffix.clone());
            let inner = Scope {
                pose: scope.pose * Isometry3::from_parts(place, turned),
                childclass: replicate.text("childclass").or(scope.childclass),
                suffix,
            };
            self.gather(replicate, &inner, content, left, names)?;
            place.vector += turned * offset.vector;
        }
        Ok(())
    }

    /// Adds a body with its joints; where it is on the world, a free joint may be among them.
    fn body(
        &mut self,
        body: &Element,
        scope: &Scope<'_>,
        parent: Option<LinkId>,
        content: &Content<'_>,
        names: &mut Names,
    ) -> Result<LinkId, DescriptionError> {
        let id = LinkId(self.into.links.len());
        if id.0 >= MOST_LINKS {
            return Err(body.wrong(format!("more than {MOST_LINKS} bodies")));
        }
        let (name, is_named) = names.of_body(body, &scope.suffix)?;
        if let Some(share) = body.number("gravcomp")?.filter(|share| *share != 0.0) {
            self.into.left_out.push(body.say(format!("gravcomp=\"{share}\" is left out: its weight counts in full")));
        }
        let mut joints = Vec::new();
        for (element, scope) in &content.joints {
            let merged = match element.tag.as_str() {
                "freejoint" => (*element).clone(),
                _ => self.classes.apply(element, scope.childclass)?,
            };
            if joint::is_free(&merged) {
                self.free(&merged, id, parent, content)?;
                continue;
            }
            let joint_name = names.of_joint(element, &scope.suffix, &name)?;
            let mover = joint::read(&merged, joint_name, id, &scope.pose, &self.compiler, &mut self.into.warnings)?;
            joints.push(MoverId(self.into.joints.len()));
            self.into.joints.push(mover);
        }
        let support = match parent {
            _ if !content.joints.is_empty() => Support::Moves,
            Some(parent) if !self.stands(parent) => Support::Part(parent),
            _ => Support::Stands,
        };
        let inertia = self.inertia(body, content, support)?;
        if self.named.keep_apart(body, &name) {
            self.unfused.push(id);
        }
        let colliders = self.colliders(content)?;
        let pose = scope.pose * pose(body, &self.compiler)?;
        self.into.links.push(Link { name, is_named, parent, pose, joints, inertia, colliders });
        Ok(id)
    }

    /// What of a body collides.
    fn colliders(&self, content: &Content<'_>) -> Result<Vec<Collider>, DescriptionError> {
        let mut all = Vec::new();
        for (element, scope) in &content.geoms {
            let read = geom::collider(&self.classes.apply(element, scope.childclass)?, &self.compiler);
            all.extend(read.map(|read| Collider { pose: scope.pose * read.pose, ..read }));
        }
        Ok(all)
    }

    /// Whether a link and all that carry it have no joint.
    fn stands(&self, link: LinkId) -> bool {
        let own = &self.into.links[link.0];
        let is_free = self.into.free_joint.as_ref().is_some_and(|free| free.link == link);
        own.joints.is_empty() && !is_free && own.parent.is_none_or(|parent| self.stands(parent))
    }

    fn free(
        &mut self,
        joint: &Element,
        link: LinkId,
        parent: Option<LinkId>,
        content: &Content<'_>,
    ) -> Result<(), DescriptionError> {
        let hint = "one robot has one free base";
        if parent.is_some() {
            return Err(joint.unsupported("a free joint of a body within another body (nested)", hint));
        }
        if content.joints.len() > 1 {
            return Err(joint.wrong("a free joint has to be the only joint of its body"));
        }
        if self.into.free_joint.is_some() {
            return Err(joint.unsupported("a second free body (a second free joint)", hint));
        }
        let is_aligned =
            joint.word("align", &[("true", true), ("false", false), ("auto", self.compiler.is_aligning)])?;
        // Fusing may leave it without others.
        let is_alone = content.bodies.is_empty() || self.compiler.is_fusing;
        if is_aligned.unwrap_or(self.compiler.is_aligning) && is_alone {
            let hint = "it turns the body's frame; set align=\"false\"";
            return Err(joint.unsupported("alignfree on a body without others in it", hint));
        }
        // A <freejoint> takes no defaults, and has no armature of its own.
        let armature = if joint.tag == "freejoint" { None } else { joint.not_negative("armature")? };
        let name = joint.text("name").unwrap_or_default().to_owned();
        self.into.free_joint = Some(FreeJoint { name, link, armature: armature.unwrap_or(0.0) });
        Ok(())
    }
}
