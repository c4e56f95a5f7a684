//! The mass matrix by composite bodies (Featherstone 2008, table 6.2).

use super::motion::Motions;
use super::spatial::{Frame, Twist, Wrench, times};
use super::{Moves, Tree};
use crate::robot::description::RigidInertia;
use nalgebra::{DMatrix, Vector3};

/// The mass matrix before joints are coupled (base, then every joint), without armature; `composite` is memory.
pub(super) fn mass_matrix(tree: &Tree, motions: &Motions, composite: &mut Vec<RigidInertia>, all: &mut DMatrix<f64>) {
    all.fill(0.0);
    composite.clear();
    composite.extend(tree.bodies.iter().map(|body| body.inertia));
    for (index, body) in tree.bodies.iter().enumerate().rev() {
        let frame = &motions.in_parent[index];
        if let Some(parent) = body.parent {
            let carried = composite[index].moved(&frame.rotation, &frame.origin);
            composite[parent] += carried;
        }
        match body.moves {
            Moves::Freely => base_block(&composite[index], frame, all),
            Moves::By { joint, .. } => {
                let column = tree.base_freedoms() + joint.0;
                let axis = body.axis();
                let wrench = times(&composite[index], &axis);
                all[(column, column)] = axis.dot(&wrench);
                up_the_tree(tree, motions, index, wrench, column, all);
            }
        }
    }
}

/// The entries of a joint's column for all that carries it.
fn up_the_tree(tree: &Tree, motions: &Motions, from: usize, wrench: Wrench, column: usize, all: &mut DMatrix<f64>) {
    let (mut at, mut wrench) = (from, wrench);
    while let Some(parent) = tree.bodies[at].parent {
        wrench = motions.in_parent[at].into_outer(&wrench);
        at = parent;
        match tree.bodies[at].moves {
            Moves::Freely => {
                let force = motions.in_parent[at].rotation * wrench.force;
                for k in 0..3 {
                    (all[(k, column)], all[(3 + k, column)]) = (force[k], wrench.moment[k]);
                    (all[(column, k)], all[(column, 3 + k)]) = (force[k], wrench.moment[k]);
                }
            }
            Moves::By { joint, .. } => {
                let row = tree.base_freedoms() + joint.0;
                let entry = tree.bodies[at].axis().dot(&wrench);
                (all[(row, column)], all[(column, row)]) = (entry, entry);
            }
        }
    }
}

/// The block of the free base: linear in world axes, angular in its own.
fn base_block(composite: &RigidInertia, frame: &Frame, all: &mut DMatrix<f64>) {
    for k in 0..6 {
        let unit = Vector3::ith(k % 3, 1.0);
        let twist = match k < 3 {
            true => Twist { angular: Vector3::zeros(), linear: frame.rotation.tr_mul(&unit) },
            false => Twist { angular: unit, linear: Vector3::zeros() },
        };
        let wrench = times(composite, &twist);
        let force = frame.rotation * wrench.force;
        for row in 0..3 {
            (all[(row, k)], all[(3 + row, k)]) = (force[row], wrench.moment[row]);
        }
    }
}
