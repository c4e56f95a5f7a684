//! Which joints go side by side.

use super::frame::Frame;
use super::{BodyId, JointId};

/// One or two joints that are worked on at once, and their lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    /// First lane.
    pub first: usize,
    /// Second lane; `None`: the first once more, for nothing.
    pub second: Option<usize>,
}

/// Steps in an order in which parents come before children.
///
/// Two joints go together that are equally deep, turn about the same axis and hang on one body or on the two bodies of
/// one earlier step; those whose whole limbs look alike are tried first, so that limbs stay together to their ends.
pub(super) fn steps(frames: &[Frame], carrier: &[BodyId]) -> Vec<Step> {
    let n = frames.len();
    let above = |j: usize| carrier[j].joint().map(|JointId(above)| above);
    let mut depth = vec![0_usize; n];
    for j in 0..n {
        depth[j] = above(j).map_or(0, |above| depth[above] + 1);
    }
    let looks: Vec<String> = (0..n).map(|j| looks(j, frames, carrier)).collect();
    let mut step_of: Vec<usize> = vec![usize::MAX; n];
    let mut steps: Vec<Step> = Vec::new();
    for level in 0..=depth.iter().copied().max().unwrap_or(0) {
        for j in (0..n).filter(|&j| depth[j] == level) {
            if step_of[j] != usize::MAX {
                continue;
            }
            let goes_with = |k: &usize| {
                let same_place = above(j) == above(*k);
                let side_by_side = match (above(j), above(*k)) {
                    (Some(a), Some(b)) => a != b && step_of[a] == step_of[b],
                    _ => false,
                };
                depth[*k] == level
                    && step_of[*k] == usize::MAX
                    && frames[*k].axis == frames[j].axis
                    && frames[*k].fixed.is_some() == frames[j].fixed.is_some()
                    && (same_place || side_by_side)
            };
            let others: Vec<usize> = (j + 1..n).filter(goes_with).collect();
            // A joint is kept for its like where there is one further on.
            let alike = others.iter().copied().find(|&k| looks[k] == looks[j]);
            let unlike = || {
                let has_like = |k: usize| (0..n).any(|m| m != k && others.contains(&m) && looks[m] == looks[k]);
                others.iter().copied().find(|&k| !has_like(k))
            };
            let second = alike.or_else(unlike);
            let swapped = match (second.and_then(above), above(j)) {
                // Lanes follow the parents' lanes.
                (Some(b), Some(a)) => a != b && steps[step_of[a]].first == b,
                _ => false,
            };
            for k in std::iter::once(j).chain(second) {
                step_of[k] = steps.len();
            }
            steps.push(match second {
                Some(k) if swapped => Step { first: k, second: Some(j) },
                _ => Step { first: j, second },
            });
        }
    }
    steps
}

/// A limb in letters: its axes, with what hangs on each in brackets.
fn looks(j: usize, frames: &[Frame], carrier: &[BodyId]) -> String {
    let hanging = (0..frames.len()).filter(|&k| carrier[k].joint() == Some(JointId(j)));
    let below: Vec<String> = hanging.map(|k| looks(k, frames, carrier)).collect();
    let fixed = if frames[j].fixed.is_some() { "!" } else { "" };
    format!("{}{fixed}({})", frames[j].axis, below.join(" "))
}
