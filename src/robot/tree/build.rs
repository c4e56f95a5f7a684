//! From links and joints to bodies with one joint each.

use super::coordinates::Coordinates;
use super::spatial::Frame;
use super::{FreeBase, Moves, Tree, TreeBase, TreeBody};
use crate::robot::description::{Description, JointKind, LinkId, RigidInertia};
use nalgebra::{Isometry3, Translation3};

/// Why a description cannot be a tree with this base.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TreeError {
    /// No single link can be set free.
    #[error("{robot}: its base cannot be set free: {what}; leave out --base free")]
    NoFreeBase {
        /// The robot.
        robot: String,
        /// Why.
        what: String,
    },
}

/// The tree of a description.
pub(super) fn build(description: &Description, base: TreeBase) -> Result<Tree, TreeError> {
    let free = match base {
        TreeBase::Fixed => None,
        TreeBase::Free => Some(free_link(description)?),
    };
    let mut tree = Tree {
        gravity_m_s2: description.gravity_m_s2,
        bodies: Vec::with_capacity(description.joints.len() + 1),
        links: Vec::with_capacity(description.links.len()),
        still: RigidInertia::default(),
        base: None,
        coordinates: Coordinates::of(description),
        armature: description.joints.iter().map(|joint| joint.armature_kg_m2).collect(),
        names: description.joints.iter().map(|joint| joint.name.clone()).collect(),
        moved: description.joints.iter().map(|joint| joint.link).collect(),
        link_names: description.links.iter().map(|link| link.name.clone()).collect(),
    };
    for (index, link) in description.links.iter().enumerate() {
        let (mut body, mut pose) = link.parent.map_or((None, Isometry3::identity()), |parent| tree.links[parent.0]);
        pose *= link.pose;
        if free == Some(LinkId(index)) {
            let armature = description.free_joint.as_ref().map_or(0.0, |free| free.armature);
            let drawn = frame_of(&pose);
            tree.base = Some(FreeBase { body: tree.bodies.len(), link: LinkId(index), armature, pose });
            tree.bodies.push(TreeBody { parent: None, drawn, moves: Moves::Freely, inertia: RigidInertia::default() });
            (body, pose) = (tree.base.map(|base| base.body), Isometry3::identity());
        }
        for id in &link.joints {
            let joint = &description.joints[id.0];
            pose *= Translation3::from(joint.place_m);
            let moves = Moves::By {
                joint: *id,
                turns: joint.kind != JointKind::Prismatic,
                axis: joint.axis,
                drawn: joint.drawn_rad,
            };
            let (parent, drawn) = (body, frame_of(&pose));
            body = Some(tree.bodies.len());
            tree.bodies.push(TreeBody { parent, drawn, moves, inertia: RigidInertia::default() });
            pose = Isometry3::from(Translation3::from(-joint.place_m));
        }
        let inertia = link.inertia.placed(&pose);
        match body {
            Some(body) => tree.bodies[body].inertia += inertia,
            None => tree.still += inertia,
        }
        tree.links.push((body, pose));
    }
    Ok(tree)
}

/// The link that a free base sets free: that of the file's free joint, else the only one on the world.
fn free_link(description: &Description) -> Result<LinkId, TreeError> {
    if let Some(free) = &description.free_joint {
        return Ok(free.link);
    }
    let no = |what: String| TreeError::NoFreeBase { robot: description.name.clone(), what };
    if let Some(unweighed) = &description.unweighed {
        return Err(no(unweighed.clone()));
    }
    let mut roots = (0..description.links.len()).filter(|link| description.links[*link].parent.is_none());
    let root = roots.next().ok_or_else(|| no("it has no link".to_owned()))?;
    if let Some(second) = roots.next() {
        let names = [root, second].map(|link| description.links[link].name.as_str());
        return Err(no(format!("several links stand on the world ({} and {})", names[0], names[1])));
    }
    if let Some(joint) = description.links[root].joints.first() {
        let name = &description.joints[joint.0].name;
        return Err(no(format!("its root {} moves against the world by joint {name}", description.links[root].name)));
    }
    Ok(LinkId(root))
}

fn frame_of(pose: &Isometry3<f64>) -> Frame {
    Frame { rotation: *pose.rotation.to_rotation_matrix().matrix(), origin: pose.translation.vector }
}
