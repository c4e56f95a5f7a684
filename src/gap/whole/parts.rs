//! Parts of a log between its holes: nobody knows what was asked of the joints in one, so that each begins anew.

use crate::identify::ends_of_holes;
use crate::log::{JointColumns, RobotLog};
use std::borrow::Cow;
use std::ops::Range;

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
    begins.iter().zip(ends).map(|(&from, to)| Cow::Owned(part(log, from..to))).collect()
}

/// Some of a log's samples; setpoints at stamps of their own stay, the last one before the part is in force at its beginning.
fn part(log: &RobotLog, samples: Range<usize>) -> RobotLog {
    let of = |column: &Vec<f64>| column[samples.clone()].to_vec();
    let joint = |joint: &JointColumns| JointColumns {
        name: joint.name.clone(),
        q_rad: of(&joint.q_rad),
        q_ref_rad: joint.q_ref_rad.as_ref().map(of),
        setpoints: joint.setpoints.clone(),
        tau_nm: joint.tau_nm.as_ref().map(of),
        drive: joint.drive.as_ref().map(|on| on[samples.clone()].to_vec()),
    };
    RobotLog {
        file: log.file.clone(),
        t_s: of(&log.t_s),
        joints: log.joints.iter().map(joint).collect(),
        // A base that is clamped stands still.
        base: None,
        acceleration_m_s2: None,
        ignored_columns: Vec::new(),
        notes: Vec::new(),
    }
}

/// Columns of a part behind those of the parts before it.
pub(super) fn append<T>(all: &mut Vec<Vec<T>>, part: Vec<Vec<T>>) {
    if all.is_empty() {
        *all = part;
    } else {
        all.iter_mut().zip(part).for_each(|(column, part)| column.extend(part));
    }
}
