//! Masses that give every joint the moment that was found on it: a description has masses, not moments.

use crate::gap::clamped::ClampedSetup;
use crate::gap::{Diagnosis, Verdict};
use crate::number::math;
use crate::robot::description::{BodyChange, Description, LinkId};
use crate::robot::tree::{Tree, TreeBase, TreeDynamics, TreeState};
use nalgebra::{DMatrix, DVector};

/// Poses of all logs that are looked at.
const POSES: usize = 400;
/// Pull of masses to what is described, against moments.
const RIDGE: f64 = 1e-3;
/// Half a 95 % interval from which on a moment weighs less, as a share of what is described, and the weight of one without.
const TOLD: f64 = 0.1;
const UNTOLD: f64 = 1e-3;
/// A moment that is so near to what it was asks for nothing.
const NEAR: f64 = 0.01;
/// A moment that masses cannot give to this share is said.
const MISSED: f64 = 0.1;

/// A body's mass.
pub(super) struct Mass {
    pub link: LinkId,
    pub factor: f64,
    /// Half of its 95 % interval, as a share of what is described.
    pub half: Option<f64>,
}

/// Masses by body, and the joints whose moments they miss. Empty where all moments are as described.
pub(super) fn masses(
    setup: &ClampedSetup,
    description: &Description,
    found: &[&Diagnosis],
) -> (Vec<Mass>, Vec<String>) {
    let Ok(tree) = Tree::new(description, TreeBase::Fixed) else { return (Vec::new(), Vec::new()) };
    let tree = tree.with_gravity(setup.tree.gravity_m_s2());
    let names: Vec<&str> = tree.joint_names().collect();
    let share = |name: &str| {
        let own = found.iter().find(|d| d.joint == name)?;
        let moment = own.parameters.iter().find(|p| p.name == "moment")?;
        let nominal = moment.nominal.filter(|nominal| *nominal > 0.0)?;
        let half = moment.interval.map(|[low, high]| 0.5 * (high - low) / nominal);
        // A joint that lacks nothing keeps its moment.
        Some((if own.answer.verdict == Verdict::None { 1.0 } else { moment.value / nominal }, half))
    };
    let shares: Vec<Option<(f64, Option<f64>)>> = names.iter().map(|name| share(name)).collect();
    if shares.iter().flatten().all(|(share, _)| (share - 1.0).abs() < NEAR) {
        return (Vec::new(), Vec::new());
    }
    let poses = poses(setup, &tree);
    let all = gravity(&tree, &poses);
    // The heaviest link that each joint moves.
    let links: Vec<LinkId> = tree
        .joints()
        .iter()
        .map(|joint| {
            let moved = (0..description.links.len()).filter(|k| description.carriers(LinkId(*k)).last() == Some(joint));
            let heaviest = moved.max_by(|a, b| {
                let mass = |k: &usize| description.links[*k].inertia.mass_kg;
                mass(a).total_cmp(&mass(b))
            });
            heaviest.map_or(description.joints[joint.0].link, LinkId)
        })
        .collect();
    let without = |link: &LinkId| {
        let bare = description.with_change(*link, &BodyChange::Mass { factor: 0.0 });
        let tree = Tree::new(&bare, TreeBase::Fixed).ok()?.with_gravity(tree.gravity_m_s2());
        Some(gravity(&tree, &poses))
    };
    let Some(without) = links.iter().map(without).collect::<Option<Vec<_>>>() else { return (Vec::new(), Vec::new()) };
    let (rows, n) = (names.len() * poses.len(), links.len());
    let scale: Vec<f64> = all.iter().map(|own| own.iter().fold(1e-9_f64, |most, g| most.max(g.abs()))).collect();
    // A moment that the logs tell badly asks for little.
    let weight = |half: Option<f64>| half.map_or(UNTOLD, |half| TOLD / math::hypot(TOLD, half));
    let weights: Vec<f64> = shares.iter().map(|share| share.map_or(0.0, |(_, half)| weight(half))).collect();
    let at = |row: usize| (row / poses.len(), row % poses.len());
    let columns = DMatrix::from_fn(rows, n, |row, b| {
        let (j, k) = at(row);
        weights[j] * (all[j][k] - without[b][j][k]) / scale[j]
    });
    let target = DVector::from_fn(rows, |row, _| {
        let (j, k) = at(row);
        shares[j].map_or(0.0, |(share, _)| weights[j] * (share - 1.0) * all[j][k] / scale[j])
    });
    let mut normal = columns.tr_mul(&columns);
    for b in 0..n {
        normal[(b, b)] += RIDGE * poses.len() as f64;
    }
    let Some(factors) = normal.cholesky() else { return (Vec::new(), Vec::new()) };
    let solved = factors.solve(&columns.tr_mul(&target));
    let left = &target - &columns * &solved;
    let size = |values: &DVector<f64>, j: usize| values.rows(j * poses.len(), poses.len()).norm();
    let missed = (0..names.len())
        .filter(|j| size(&left, *j) > MISSED * size(&target, *j).max(0.1 * (poses.len() as f64).sqrt()));
    let missed = missed.map(|j| names[j].to_owned()).collect();
    let mass = |(b, link): (usize, &LinkId)| Mass {
        link: *link,
        factor: (1.0 + solved[b]).max(0.05),
        half: shares[b].and_then(|(_, half)| half),
    };
    let masses = links.iter().enumerate().map(mass);
    let changed =
        masses.filter(|mass| description.links[mass.link.0].inertia.mass_kg > 0.0 && (mass.factor - 1.0).abs() > NEAR);
    (changed.collect(), missed)
}

/// Poses of the tree along the logs.
pub(super) fn poses(setup: &ClampedSetup, tree: &Tree) -> Vec<TreeState> {
    let samples: usize = setup.logs.iter().map(|log| log.len()).sum();
    let stride = (samples / POSES).max(1);
    let mut poses = Vec::new();
    for log in &setup.logs {
        for k in (0..log.len()).step_by(stride) {
            let mut state = TreeState::drawn(tree);
            for (j, name) in tree.joint_names().enumerate() {
                if let Some(joint) = log.joint(name) {
                    state.position[j] = joint.q_rad[k];
                }
            }
            poses.push(state);
        }
    }
    poses
}

/// Gravity's torques by joint and pose \[N m\].
fn gravity(tree: &Tree, poses: &[TreeState]) -> Vec<Vec<f64>> {
    let mut dynamics = TreeDynamics::new(tree);
    let n = tree.joints().len();
    let (mut bias, mut all) = (vec![0.0; n], vec![Vec::with_capacity(poses.len()); n]);
    for pose in poses {
        dynamics.bias(pose, &mut bias);
        all.iter_mut().zip(&bias).for_each(|(own, torque): (&mut Vec<f64>, _)| own.push(*torque));
    }
    all
}

/// `M_jj` of the links, means over poses \[kg m^2\].
pub(super) fn own_inertias(setup: &ClampedSetup, description: &Description) -> Vec<(String, f64)> {
    let Ok(tree) = Tree::new(description, TreeBase::Fixed) else { return Vec::new() };
    let poses = poses(setup, &tree);
    let n = tree.joints().len();
    let mut dynamics = TreeDynamics::new(&tree);
    let (mut matrix, mut sum) = (DMatrix::zeros(n, n), vec![0.0; n]);
    for pose in &poses {
        dynamics.rigid_mass_matrix(pose, &mut matrix);
        (0..n).for_each(|j| sum[j] += matrix[(j, j)]);
    }
    tree.joint_names().map(str::to_owned).zip(sum.into_iter().map(|sum| sum / poses.len() as f64)).collect()
}
