//! How far the gap closes, over the samples that no fit saw.

use super::bench::{Bench, followed_s};
use super::decide::Decision;
use super::diagnosis::{Displacement, JointGap, RobotDiagnosis, RobotGap};
use super::forward::predict;
use super::layout::{Channel, displacement_m};
use super::refine::Hypothesis;
use super::scatter::Scatter;
use crate::gap::hypothesis::held_out::{closed, closed_interval};
use crate::gap::{LogGap, Verdict};

/// Blocks of samples that are drawn together: longer than any transient of a joint.
const BLOCK: usize = 64;

/// What models leave.
struct Left {
    before: Vec<f64>,
    calibrated: Vec<f64>,
    first: Vec<f64>,
    after: Vec<f64>,
}

/// RMS over the held-out samples of some rows.
fn rms(bench: &Bench<'_>, left: &[f64], counts: impl Fn(usize, usize) -> bool) -> f64 {
    let (mut sum, mut count) = (0.0, 0_usize);
    for (_, row) in bench.layout.joints().filter(|(joint, row)| counts(*joint, row.log)) {
        for k in row.range.clone().filter(|k| bench.layout.held[*k] && bench.layout.compared[*k]) {
            sum += left[k].powi(2);
            count += 1;
        }
    }
    (sum / count.max(1) as f64).sqrt()
}

/// RMS of a hypothesis over all held-out samples, with what is uncertain adapted \[rad\]: as in [`gap`], so that what
/// an answer leaves and what the ranking says of it are one number.
pub(super) fn held_out_rms_rad(bench: &Bench<'_>, hypothesis: &Hypothesis) -> f64 {
    rms(bench, predicted(bench, hypothesis), |_, _| true)
}

/// What a hypothesis leaves, with what is uncertain adapted. On the floor, where that is known to first order only, with the
/// numbers as stated where these predict the held-out samples better.
fn predicted<'h>(bench: &Bench<'_>, hypothesis: &'h Hypothesis) -> &'h [f64] {
    let (adapted, stated) = (&hypothesis.attained.residual, &hypothesis.residual);
    let all = |left: &[f64]| rms(bench, left, |_, _| true);
    if !bench.case.is_clamped() && all(stated) < all(adapted) { stated } else { adapted }
}

impl RobotDiagnosis {
    /// What the changes of the answer alone leave over the held-out samples, masses and friction as the study has them
    /// \[rad RMS\]; `None` where nothing was held out.
    pub fn repaired_rms_rad(&self) -> Option<f64> {
        let squares = self.traces.iter().flat_map(|trace| {
            let both = trace.measured_rad.iter().zip(&trace.after_rad).zip(&trace.held);
            both.filter(|(_, held)| **held).map(|((measured, after), _)| (measured - after).powi(2))
        });
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
        (count > 0.0).then(|| f64::sqrt(sum / count)).filter(|rms| rms.is_finite())
    }
}

/// The numbers of a decision.
pub(super) fn gap(bench: &Bench<'_>, given: &Hypothesis, decision: &Decision<'_>) -> RobotGap {
    let with = |hypothesis: &Hypothesis| predicted(bench, hypothesis).to_vec();
    // With nothing missing, what the answer moves are numbers within their beliefs.
    let recalibrated = if decision.verdict == Verdict::None { decision.answer } else { given };
    let left = Left {
        before: bench.gap(),
        calibrated: with(recalibrated),
        first: with(decision.first),
        after: with(decision.answer),
    };
    let all = |left: &[f64]| rms(bench, left, |_, _| true);
    let floor = bench.sigma_rad;
    let (before, after) = (all(&left.before), all(&left.after));
    let per_log = bench
        .case
        .logs
        .iter()
        .enumerate()
        .filter(|(index, _)| bench.layout.joints().any(|(_, row)| row.log == *index))
        .map(|(index, log)| {
            let of = |left: &[f64]| rms(bench, left, |_, of| of == index);
            let (before, calibrated, after) = (of(&left.before), of(&left.calibrated), of(&left.after));
            LogGap { file: log.file.clone(), before, calibrated, after, floor }
        });
    let per_joint = bench.layout.moving().into_iter().map(|joint| {
        let of = |left: &[f64]| rms(bench, left, |of, _| of == joint);
        JointGap {
            joint: bench.case.names[joint].clone(),
            before: of(&left.before),
            calibrated: of(&left.calibrated),
            after_first: of(&left.first),
            after: of(&left.after),
        }
    });
    let has_validate = bench.case.logs.iter().any(|log| log.is_validate);
    RobotGap {
        unit: "rad",
        before,
        calibrated: all(&left.calibrated),
        after_first: all(&left.first),
        after,
        floor,
        closed: closed(before, after, floor),
        closed_interval: interval(bench, &left),
        held_out: if has_validate {
            "predicted by a fit to the other logs, as the study says".to_owned()
        } else {
            let which = if bench.case.is_clamped() { "middle" } else { "last" };
            format!(
                "of three gait cycles (or parts of the motion) the {which} one: simulated through, not seen by any fit"
            )
        },
        per_log: per_log.collect(),
        per_joint: per_joint.collect(),
        displacement: displacement(bench, decision),
    }
}

/// 95 % of the share that closes, by drawing blocks of held-out samples.
fn interval(bench: &Bench<'_>, left: &Left) -> Option<[f64; 2]> {
    let mut blocks: Vec<(f64, f64, f64)> = Vec::new();
    for (_, row) in bench.layout.joints() {
        let held: Vec<usize> =
            row.range.clone().filter(|k| bench.layout.held[*k] && bench.layout.compared[*k]).collect();
        for block in held.chunks(BLOCK) {
            let sum = |left: &[f64]| block.iter().map(|k| left[*k].powi(2)).sum::<f64>();
            blocks.push((sum(&left.before), sum(&left.after), block.len() as f64));
        }
    }
    closed_interval(&blocks, bench.sigma_rad)
}

fn displacement(bench: &Bench<'_>, decision: &Decision<'_>) -> Vec<Displacement> {
    let (changes, none) = (decision.answer.changes(bench), Scatter::none(bench.case.model()));
    let has_forward =
        |index: usize| bench.layout.rows.iter().any(|row| row.log == index && row.channel == Channel::Forward);
    let of = |(index, log): (usize, &super::case::CaseLog)| {
        let step_s = followed_s(bench.steps.fine, &changes);
        let after = predict(bench.case, log, None, (&none, &changes), step_s, f64::INFINITY).ok().flatten()?;
        Some(Displacement {
            file: log.file.clone(),
            measured: log.forward?.distance_m,
            before: displacement_m(log, &bench.given_logs[index])?,
            after: displacement_m(log, &after)?,
        })
    };
    bench.case.logs.iter().enumerate().filter(|(index, _)| has_forward(*index)).filter_map(of).collect()
}
