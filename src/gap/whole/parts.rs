//! Parts of a log between its holes: nobody knows what was asked of the joints in one, so that each begins anew.

use crate::identify::ends_of_holes;
use crate::log::RobotLog;
use std::borrow::Cow;

/// Fewest samples of a part that is simulated: a single one between two holes stays with those before it.
const FEWEST: usize = 2;

/// The log's parts in their order; all of it where it has no holes.
pub(super) fn parts(log: &RobotLog) -> Vec<Cow<'_, RobotLog>> {
    let mut begins = vec![0];
    for end_s in ends_of_holes(&log.t_s) {
        let k = log.t_s.partition_point(|t| *t < end_s);
        if k - begins[begins.len() - 1] >= FEWEST && log.len() - k >= FEWEST {
            begins.push(k);
        }
    }
    if begins.len() == 1 {
        return vec![Cow::Borrowed(log)];
    }
    let ends = begins.iter().skip(1).copied().chain([log.len()]);
    begins.iter().zip(ends).map(|(&from, to)| Cow::Owned(log.part(from..to))).collect()
}

/// Columns of a part behind those of the parts before it.
pub(super) fn append<T>(all: &mut Vec<Vec<T>>, part: Vec<Vec<T>>) {
    if all.is_empty() {
        *all = part;
    } else {
        all.iter_mut().zip(part).for_each(|(column, part)| column.extend(part));
    }
}
