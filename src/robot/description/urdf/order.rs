//! Links and joints in the order of the tree, whatever the file's is; what is no tree is refused.

use super::joint::RawJoint;
use super::link::RawLink;
use crate::robot::description::error::DescriptionError;
use crate::robot::description::inertia::RigidInertia;
use crate::robot::description::parts::{Coupling, Link, LinkId, Mover, MoverId};
use crate::robot::description::xml::Element;
use crate::robot::description::{Description, MOST_LINKS};
use nalgebra::{Isometry3, Vector3};
use std::collections::HashMap;

/// The world as Drake names it without declaring it.
const WORLD: &str = "world";

/// Puts links and joints into the description.
pub(super) fn assemble<'a>(
    into: &mut Description,
    root: &Element,
    mut links: Vec<RawLink<'a>>,
    joints: Vec<RawJoint<'a>>,
) -> Result<(), DescriptionError> {
    let mut by_name = HashMap::new();
    for (index, link) in links.iter().enumerate() {
        if by_name.insert(link.name, index).is_some() {
            return Err(link.element.wrong("a second link of this name"));
        }
    }
    if let Some(joint) = joints.iter().find(|joint| joint.parent == WORLD && !by_name.contains_key(WORLD)) {
        into.warnings.push(joint.element.say("the parent `world` is no link of the file; taken as the world"));
        by_name.insert(WORLD, links.len());
        links.push(RawLink {
            name: WORLD,
            inertia: RigidInertia::default(),
            colliders: Vec::new(),
            element: joint.element,
        });
    }
    if links.len() > MOST_LINKS {
        return Err(root.wrong(format!("{} links, expected at most {MOST_LINKS}", links.len())));
    }
    let place = |joint: &RawJoint<'_>, end: &str, name: &str| {
        let missing = || joint.element.wrong(format!("the {end} link \"{name}\" is not in the file"));
        by_name.get(name).copied().ok_or_else(missing)
    };
    // The joint above each link, and the joints below.
    let mut above: Vec<Option<usize>> = vec![None; links.len()];
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
    let mut ends = Vec::with_capacity(joints.len());
    for (index, joint) in joints.iter().enumerate() {
        let (parent, child) = (place(joint, "parent", joint.parent)?, place(joint, "child", joint.child)?);
        if let Some(first) = above[child].replace(index) {
            let other = joints[first].element.label();
            return Err(joint.element.wrong(format!("link \"{}\" has two parents; {other} moves it too", joint.child)));
        }
        below[parent].push(index);
        ends.push((parent, child));
    }
    let roots: Vec<usize> = (0..links.len()).filter(|link| above[*link].is_none()).collect();
    let [start] = roots[..] else {
        let names: Vec<&str> = roots.iter().take(8).map(|root| links[*root].name).collect();
        let what = match roots.len() {
            0 if links.is_empty() => "no <link>, expected at least one".to_owned(),
            0 => "every link has a parent: the joints go round in a circle, expected one root".to_owned(),
            count => format!("{count} links have no parent ({}), expected one root", names.join(", ")),
        };
        return Err(root.wrong(what));
    };
    let mut id_of_link = vec![None; links.len()];
    let mut mover_of_joint: Vec<Option<MoverId>> = vec![None; joints.len()];
    let moving = joints.iter().enumerate().filter(|(_, joint)| joint.moves.is_some());
    for (mover, (index, joint)) in moving.enumerate() {
        mover_of_joint[index] = Some(MoverId(mover));
        if joints[..index].iter().any(|other| other.name == joint.name) {
            return Err(joint.element.wrong("a second joint of this name"));
        }
    }
    let mut open = vec![start];
    while let Some(link) = open.pop() {
        let id = LinkId(into.links.len());
        id_of_link[link] = Some(id);
        let joint = above[link].map(|joint| (joint, ends[joint].0));
        into.links.push(Link {
            name: links[link].name.to_owned(),
            is_named: true,
            parent: joint.and_then(|(_, parent)| id_of_link[parent]),
            pose: joint.map_or_else(Isometry3::identity, |(joint, _)| joints[joint].pose),
            joints: joint.and_then(|(joint, _)| mover_of_joint[joint]).into_iter().collect(),
            inertia: links[link].inertia,
            colliders: std::mem::take(&mut links[link].colliders),
        });
        open.extend(below[link].iter().rev().map(|joint| ends[*joint].1));
    }
    if let Some(left) = (0..links.len()).find(|link| id_of_link[*link].is_none()) {
        return Err(links[left].element.wrong("no joint leads here from the root: the joints go round in a circle"));
    }
    for (joint, (_, child)) in joints.iter().zip(&ends) {
        let (Some(moves), Some(link)) = (&joint.moves, id_of_link[*child]) else { continue };
        into.joints.push(Mover {
            name: joint.name.to_owned(),
            kind: moves.kind,
            link,
            axis: moves.axis,
            place_m: Vector3::zeros(),
            drawn_rad: 0.0,
            limit_rad: moves.limit_rad,
            effort_nm: moves.effort_nm,
            rate_limit_rad_s: moves.rate_limit_rad_s,
            actuator_range_nm: None,
            armature_kg_m2: 0.0,
            damping: [moves.damping_nm_s_rad, 0.0, 0.0],
            friction_nm: moves.friction_nm,
            stiffness: [0.0; 3],
            spring_rest_rad: 0.0,
            at: joint.element.at.clone(),
        });
    }
    couple(into, &joints, &mover_of_joint)
}

/// Joints that follow others, each at last one that follows none.
fn couple(into: &mut Description, joints: &[RawJoint<'_>], movers: &[Option<MoverId>]) -> Result<(), DescriptionError> {
    for (index, joint) in joints.iter().enumerate() {
        let (Some((leader, multiplier, offset_rad)), Some(follower)) = (joint.mimic, movers[index]) else { continue };
        let Some(found) = joints.iter().position(|other| other.name == leader) else {
            return Err(joint.element.wrong(format!("<mimic>: the joint \"{leader}\" is not in the file")));
        };
        let Some(leader) = movers[found] else {
            return Err(joint.element.wrong(format!("<mimic>: the joint \"{leader}\" is fixed and leads nothing")));
        };
        into.couplings.push(Coupling { follower, leader, multiplier, offset_rad });
    }
    let leader_of: HashMap<MoverId, MoverId> = into.couplings.iter().map(|c| (c.follower, c.leader)).collect();
    for coupling in &into.couplings {
        let (mut at, mut steps) = (coupling.follower, 0);
        while let Some(leader) = leader_of.get(&at) {
            (at, steps) = (*leader, steps + 1);
            if steps > into.couplings.len() {
                let Mover { name, at, .. } = &into.joints[coupling.follower.0];
                let element = format!("<joint name=\"{name}\">");
                let what = "<mimic> goes round in a circle: no joint leads".to_owned();
                return Err(DescriptionError::Wrong { at: at.clone(), element, what });
            }
        }
    }
    Ok(())
}
