//! Our own TOML as a description: ellipsoids become tensors, turned and displaced joints become poses.

use super::error::At;
use super::{Collider, Description, Format, FreeJoint, JointKind, Link, LinkId, Mover, MoverId, RigidInertia, Shape};
use crate::geometry::robot_file::Base;
use crate::geometry::{Joint, RobotTables};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion};
use std::path::Path;
use std::sync::Arc;

/// A file's name without what is behind its last dot.
pub(super) fn stem(file: &Path) -> String {
    file.file_stem().map_or_else(|| "robot".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

impl Description {
    /// A robot of checked tables; `file` is where they are from. Limits are those of the hardware.
    pub fn of_tables(tables: &RobotTables, file: &Path) -> Self {
        let file: Arc<Path> = Arc::from(file);
        let names: Vec<&String> =
            std::iter::once(&tables.root).chain(tables.joints.iter().map(|joint| &joint.child)).collect();
        let id = |name: &String| names.iter().position(|other| *other == name).map(LinkId);
        let joint_of = |index: usize| index.checked_sub(1).map(|joint| (MoverId(joint), &tables.joints[joint]));
        let link = |(index, name): (usize, &&String)| Link {
            name: (*name).clone(),
            is_named: true,
            parent: joint_of(index).and_then(|(_, joint)| id(&joint.parent)),
            pose: joint_of(index).map_or_else(Isometry3::identity, |(_, joint)| pose(joint)),
            joints: joint_of(index).map(|(joint, _)| joint).into_iter().collect(),
            inertia: inertia(tables, name),
            colliders: colliders(tables, name),
        };
        Self {
            name: tables.name.clone(),
            format: Format::Toml,
            files: vec![file.to_path_buf()],
            gravity_m_s2: tables.gravity_m_s2,
            links: names.iter().enumerate().map(link).collect(),
            joints: tables.joints.iter().enumerate().map(|(index, joint)| mover(index, joint, &file)).collect(),
            free_joint: (tables.base == Base::Floating).then_some(FreeJoint {
                name: String::new(),
                link: LinkId(0),
                armature: 0.0,
            }),
            couplings: Vec::new(),
            equalities: Vec::new(),
            actuators: Vec::new(),
            warnings: Vec::new(),
            left_out: Vec::new(),
            unweighed: None,
        }
    }
}

/// The child's frame in the parent's at angle 0: the joint's points coincide, the child is turned by phi.
fn pose(joint: &Joint) -> Isometry3<f64> {
    let zero: Rotation3<f64> = joint.zero_rotation();
    let turned =
        Isometry3::from_parts(Translation3::from(joint.in_parent_m), UnitQuaternion::from_rotation_matrix(&zero));
    turned * Translation3::from(-joint.in_child_m)
}

fn mover(index: usize, joint: &Joint, file: &Arc<Path>) -> Mover {
    let spring = joint.spring;
    Mover {
        name: joint.name.clone(),
        kind: JointKind::Revolute,
        link: LinkId(index + 1),
        axis: Unit::new_unchecked(joint.axis.into_inner() * joint.sign),
        place_m: joint.in_child_m,
        drawn_rad: 0.0,
        limit_rad: joint.hardware_rad,
        effort_nm: None,
        rate_limit_rad_s: joint.speed_rad_s,
        actuator_range_nm: None,
        armature_kg_m2: 0.0,
        damping: [spring.map_or(0.0, |spring| spring.damping_nm_s_rad), 0.0, 0.0],
        friction_nm: 0.0,
        stiffness: [spring.map_or(0.0, |spring| spring.stiffness_nm_rad), 0.0, 0.0],
        spring_rest_rad: spring.map_or(0.0, |spring| spring.rest_rad),
        at: At { file: file.clone(), line: 1 },
    }
}

/// A part that touches the floor does so with its ellipsoid.
fn colliders(tables: &RobotTables, name: &str) -> Vec<Collider> {
    let touching = tables.parts.iter().filter(|part| part.name == name && part.contact_m.is_some());
    let ellipsoid = |part: &crate::geometry::Part| Shape::Ellipsoid(part.diameters_m * 0.5);
    touching.map(|part| Collider { shape: ellipsoid(part), pose: Isometry3::identity(), friction: None }).collect()
}

/// A part with the point masses fixed to it.
fn inertia(tables: &RobotTables, name: &str) -> RigidInertia {
    let mut inertia = RigidInertia::default();
    for part in tables.parts.iter().filter(|part| part.name == name) {
        let tensor = Matrix3::from_diagonal(&part.stated_inertia_kg_m2);
        inertia += RigidInertia::about_centre(part.mass_kg, &tensor, &Isometry3::identity());
    }
    for extra in tables.attached.iter().filter(|extra| extra.part == name) {
        let at = Isometry3::from_parts(Translation3::from(extra.at_m), UnitQuaternion::identity());
        inertia += RigidInertia::about_centre(extra.mass_kg, &Matrix3::zeros(), &at);
    }
    inertia
}
