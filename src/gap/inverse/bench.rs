//! All joints of a robot as one linear problem along their measured motion: what they share, as a body's mass, is one column
//! for all of them.

use super::case::TorqueCase;
use super::search::{Choice, Found};
use super::signals::Motion;
use super::system::{Block, System, Unknown};
use crate::gap::clamped::{ClampedCaseError, ClampedSetup};
use crate::robot::description::Description;
use crate::robot::tree::{Tree, TreeBase};

/// What every hypothesis is tried on.
pub(super) struct Bench<'a> {
    pub setup: &'a ClampedSetup,
    pub case: &'a TorqueCase,
    pub founds: &'a [Found],
    motions: Vec<Motion>,
    /// Standard deviation of a sample of each joint, recalibrated \[N m\].
    sd_nm: Vec<f64>,
    /// Places of the case's joints among the tree's.
    places: Vec<usize>,
    /// Where friction holds a joint, by joint, log and sample: nothing is told there.
    masks: Vec<Vec<Vec<bool>>>,
}

/// Columns by unknown, log and joint.
pub(super) type Shared = Vec<Vec<Vec<Vec<f64>>>>;

impl<'a> Bench<'a> {
    pub fn new(setup: &'a ClampedSetup, case: &'a TorqueCase, founds: &'a [Found]) -> Result<Self, ClampedCaseError> {
        let tree = bare_tree(setup, &setup.description)?;
        let names: Vec<&str> = tree.joint_names().collect();
        let place = |name: &str| names.iter().position(|own| *own == name);
        let sd = |found: &Found| {
            let solved = found.fit(&Choice::default());
            let fitted = found.system.blocks.iter().filter(|block| block.is_fit);
            let (squares, samples) = fitted
                .fold((0.0, 0), |(sum, n), block| (sum + block.unit * block.squares(&solved.x), n + block.samples));
            (squares / samples.max(1) as f64).sqrt().max(f64::MIN_POSITIVE)
        };
        Ok(Self {
            setup,
            case,
            founds,
            motions: case.motions(setup, &tree),
            sd_nm: founds.iter().map(sd).collect(),
            masks: founds.iter().map(|found| found.design.is_held.clone()).collect(),
            places: case.joints.iter().filter_map(|joint| place(&joint.name)).collect(),
        })
    }

    /// All joints as one problem, each with columns of its own, and shared ones behind them.
    pub fn system(&self, own: &dyn Fn(usize) -> Vec<usize>, shared: &Shared, unknowns: &[Unknown]) -> System {
        let own: Vec<Vec<usize>> = (0..self.founds.len()).map(own).collect();
        let count: usize = own.iter().map(Vec::len).sum();
        let (mut all, mut blocks, mut offset) = (Vec::new(), Vec::<Block>::new(), 0);
        for (joint, found) in self.founds.iter().enumerate() {
            let others = |i: usize, log: usize| {
                let unknown = i.checked_sub(count)?;
                shared.get(unknown)?[log].get(joint).map(Vec::as_slice).filter(|column| !column.is_empty())
            };
            let place = (&*own[joint], offset, count + unknowns.len());
            blocks.extend(found.design.blocks(&self.case.logs, place, &others, self.sd_nm[joint]));
            all.extend(own[joint].iter().map(|k| found.design.loosened(*k)));
            offset += own[joint].len();
        }
        all.extend(unknowns);
        System { unknowns: all, blocks }
    }

    /// Torques of the joints along the logs with a changed description.
    pub fn torques(&self, description: &Description) -> Result<Vec<Vec<Vec<f64>>>, ClampedCaseError> {
        let tree = bare_tree(self.setup, description)?;
        let of_log = |(log, motion): (usize, &Motion)| {
            let needed = motion.needed(&tree);
            let joint = |(joint, place): (usize, &usize)| {
                let mask = self.masks[joint].get(log).map_or(&[][..], Vec::as_slice);
                let raw = needed[*place].iter().enumerate();
                let torque: Vec<f64> =
                    raw.map(|(k, torque)| if mask.get(k) == Some(&true) { 0.0 } else { *torque }).collect();
                motion.grid.passed(&torque)
            };
            self.places.iter().enumerate().map(joint).collect()
        };
        Ok(self.motions.iter().enumerate().map(of_log).collect())
    }
}

/// Differences by log and joint, per step.
pub(super) fn differences(there: &[Vec<Vec<f64>>], here: &[Vec<Vec<f64>>], step: f64) -> Vec<Vec<Vec<f64>>> {
    let column = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (a - b) / step).collect();
    there.iter().zip(here).map(|(there, here)| there.iter().zip(here).map(column).collect()).collect()
}

fn bare_tree(setup: &ClampedSetup, description: &Description) -> Result<Tree, ClampedCaseError> {
    let bare = super::signals::without_armature(description);
    let of_tree = |source| ClampedCaseError::Tree { file: setup.study.model_path.clone(), source };
    Ok(Tree::new(&bare, TreeBase::Fixed).map_err(of_tree)?.with_gravity(setup.tree.gravity_m_s2()))
}
