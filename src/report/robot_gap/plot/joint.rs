//! One joint in one log over two cycles of the gait: measured, as given, with the answer, and the torque it lacks.

use std::ops::Range;

use crate::gap::robot::{JointTrace, RobotDiagnosis};
use crate::log::RobotScenario;
use crate::report::ReportError;
use crate::report::plot::canvas::{AFTER, BEFORE};
use crate::report::plot::overlay::{Curve, Overlay, TorqueCurve, overlay};
use crate::report::robot_gap::{RobotGapReport, words};

/// Joints that are shown where no cause is on a joint, and figures at the most.
const WORST: usize = 2;
const MOST: usize = 8;

/// The traces that are drawn: of the joints to blame, else of those with the largest error; at most two logs of each,
/// those with the largest share of the gap first.
pub(super) fn chosen(diagnosis: &RobotDiagnosis) -> Vec<&JointTrace> {
    let mut joints: Vec<&str> = diagnosis.location.joints.iter().map(String::as_str).collect();
    if joints.is_empty() || joints.len() > MOST {
        let mut all: Vec<_> = diagnosis.gap.per_joint.iter().collect();
        all.retain(|joint| joints.is_empty() || joints.contains(&joint.joint.as_str()));
        all.sort_by(|a, b| b.before.total_cmp(&a.before));
        joints =
            all.iter().take(if joints.is_empty() { WORST } else { MOST / 2 }).map(|of| of.joint.as_str()).collect();
    }
    let of_joint = |joint: &str| {
        let mut traces: Vec<_> = diagnosis.traces.iter().filter(|trace| trace.joint == joint).collect();
        traces.sort_by_key(|trace| !diagnosis.location.logs.contains(&trace.file));
        traces.truncate(if joints.len() > MOST / 2 { 1 } else { 2 });
        traces
    };
    let mut chosen: Vec<_> = joints.iter().flat_map(|joint| of_joint(joint)).collect();
    chosen.truncate(MOST);
    chosen
}

/// Draws one joint in one log.
pub(super) fn joint(report: &RobotGapReport, trace: &JointTrace) -> Result<String, ReportError> {
    let diagnosis = &report.diagnosis;
    let shown = match diagnosis.scenario {
        RobotScenario::Drop => 0..trace.t_s.len(),
        RobotScenario::Air | RobotScenario::Floor => two_cycles(&trace.held),
    };
    let cut = |values: &[f64]| values.get(shown.clone()).unwrap_or(&[]).to_vec();
    let (t_s, measured_rad) = (cut(&trace.t_s), cut(&trace.measured_rad));
    let (setpoint_rad, before_rad) = (cut(&trace.setpoint_rad), cut(&trace.before_rad));
    let (after_rad, torque_nm) = (cut(&trace.after_rad), cut(&trace.residual_torque_nm));
    let curve = |name: &str, colour, angle_rad| Curve { name: name.to_owned(), colour, angle_rad, first: 0 };
    let mut models = vec![curve("as given", BEFORE, &before_rad)];
    if let Some(answer) = words::answer(&diagnosis.answer) {
        models.push(curve(&answer, AFTER, &after_rad));
    }
    let held = trace.held.get(shown.clone()).unwrap_or(&[]);
    overlay(&Overlay {
        title: &format!("{}, {} in {}", diagnosis.robot, trace.joint, trace.file),
        t_s: &t_s,
        measured_rad: &measured_rad,
        setpoint_rad: &setpoint_rad,
        models,
        half_step_rad: report.half_step_rad,
        shades: if held.iter().all(|held| *held) { Vec::new() } else { spans(&t_s, held) },
        shaded: "held out: no fit saw it",
        torque: (!torque_nm.is_empty()).then(|| TorqueCurve {
            name: "torque that the joint as given lacks",
            t_s: &t_s,
            torque_nm: &torque_nm,
            half_width_nm: vec![0.0; torque_nm.len()],
        }),
    })
}

/// The first held-out cycle that has half a cycle before and behind it; all where there is none.
fn two_cycles(held: &[bool]) -> Range<usize> {
    let mut begin = 0;
    for run in held.chunk_by(|a, b| a == b) {
        let end = begin + run.len();
        let half = run.len() / 2;
        if run[0] && begin >= half && end + half <= held.len() {
            return begin - half..end + half;
        }
        begin = end;
    }
    0..held.len()
}

/// Spans of time of the held-out samples \[s\].
fn spans(t_s: &[f64], held: &[bool]) -> Vec<[f64; 2]> {
    let samples: Vec<(f64, bool)> = t_s.iter().copied().zip(held.iter().copied()).collect();
    let runs = samples.chunk_by(|a, b| a.1 == b.1).filter(|run| run[0].1);
    runs.map(|run| [run[0].0, run[run.len() - 1].0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_cycles_have_the_held_out_one_in_the_middle() {
        let held: Vec<bool> = (0..40).map(|k| (10..20).contains(&k) || (30..40).contains(&k)).collect();
        assert_eq!(two_cycles(&held), 5..25);
        assert_eq!(two_cycles(&[true; 7]), 0..7);
        let t_s: Vec<f64> = (0..40).map(f64::from).collect();
        assert_eq!(spans(&t_s, &held), [[10.0, 19.0], [30.0, 39.0]]);
    }
}
