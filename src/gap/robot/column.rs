//! What a cause changes on a place.

use super::bench::Bench;
use super::cause::Cause;
use super::layout::Channel;
use super::place::Place;
use super::start::Start;

/// What a cause changes on a place.
pub(super) struct Column {
    pub cause: Cause,
    pub place: Place,
    /// Which start of the cause.
    pub number: usize,
    pub start: Start,
    /// Of rows of the layout, by their number there; what is not here it does not change, or no fit sees it.
    pub rows: Vec<(usize, Vec<f64>)>,
}

impl Column {
    /// What is to be smallest: the amplitude of a proportional cause, else how much more than needed is seen.
    pub fn strength(&self, seen: f64, threshold: f64) -> f64 {
        if self.start.is_proportional() { (threshold / seen).sqrt() } else { seen / threshold }
    }
}

/// The rows of a change that fits see: those of some joints, or all.
pub(super) fn rows(bench: &Bench<'_>, joints: Option<&[usize]>, change: &[f64]) -> Vec<(usize, Vec<f64>)> {
    let is_its = |channel: Channel| match (channel, joints) {
        (Channel::Joint(joint), Some(joints)) => joints.contains(&joint),
        (_, joints) => joints.is_none(),
    };
    let seen = bench.layout.rows.iter().enumerate().filter(|(_, row)| is_its(row.channel) && bench.fits_see(row));
    seen.map(|(k, row)| (k, change[row.range.clone()].to_vec())).collect()
}
