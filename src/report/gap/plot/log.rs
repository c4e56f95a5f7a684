//! One log: measured against the model before and after, what is left over, and the torque that is missing.

use crate::gap::{Diagnosis, LogTraces, Phase};
use crate::number::chance::HALF_95;
use crate::report::ReportError;
use crate::report::gap::words;
use crate::report::plot::canvas::{AFTER, BEFORE, CALIBRATED};
use crate::report::plot::overlay::{Curve, Overlay, TorqueCurve, overlay};

/// Draws one log; `half_step_rad` is 0 where its quantisation is unknown.
pub(super) fn log(diagnosis: &Diagnosis, log: &LogTraces, half_step_rad: f64) -> Result<String, ReportError> {
    let curve = |name: &str, colour, angle_rad| Curve { name: name.to_owned(), colour, angle_rad, first: 0 };
    let mut models =
        vec![curve("as given", BEFORE, &log.before_rad), curve("recalibrated", CALIBRATED, &log.calibrated_rad)];
    if let Some(answer) = words::answer(diagnosis) {
        models.push(curve(&answer, AFTER, &log.after_rad));
    }
    let missing = &log.residual_torque;
    overlay(&Overlay {
        title: &format!("{}, {} ({})", diagnosis.joint, log.file, log.role),
        t_s: &log.t_s,
        measured_rad: &log.measured_rad,
        setpoint_rad: log.setpoint_rad.as_deref().unwrap_or(&[]),
        models,
        half_step_rad,
        shades: resting(&missing.t_s, &missing.phase),
        shaded: "at rest: friction takes up any torque",
        torque: (!missing.t_s.is_empty()).then(|| TorqueCurve {
            name: "torque that the recalibrated model lacks, with its 95 % band",
            t_s: &missing.t_s,
            torque_nm: &missing.torque_nm,
            half_width_nm: missing.sigma_nm.iter().map(|sigma| HALF_95 * sigma).collect(),
        }),
    })
}

/// Spans of time in which the joint sticks or is held \[s\].
fn resting(t_s: &[f64], phases: &[Phase]) -> Vec<[f64; 2]> {
    let samples: Vec<(f64, bool)> =
        t_s.iter().zip(phases).map(|(t, phase)| (*t, matches!(phase, Phase::Stick | Phase::Hold))).collect();
    let spans = samples.chunk_by(|a, b| a.1 == b.1).filter(|span| span[0].1 && span.len() > 1);
    spans.map(|span| [span[0].0, span[span.len() - 1].0]).filter(|ends| ends.iter().all(|t| t.is_finite())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resting_spans_are_those_of_sticking_and_holding() {
        use Phase::{Hold, Run, Stick};
        let phases = [Hold, Hold, Run, Stick, Run, Stick, Stick, Stick];
        let t_s: Vec<f64> = (0..8).map(f64::from).collect();
        assert_eq!(resting(&t_s, &phases), [[0.0, 1.0], [5.0, 7.0]]);
        assert!(resting(&[], &phases).is_empty());
    }
}
