//! From as given down to the sensors' noise over all joints: recalibrated, with what is other about bodies, then with what
//! was found on each joint.

use super::{ClampedGapReport, logs_of};
use crate::gap::Diagnosis;
use crate::report::ReportError;
use crate::report::gap::plot::rungs::{Rung, draw_rungs, rungs};
use crate::report::measure::Measure;

/// What stands above the steps.
pub(super) const HEADING: &str = "From as given to the floor";

/// Joints that have a step of their own.
const OWN: usize = 6;

/// What the steps are.
pub(super) fn explanation(report: &ClampedGapReport) -> String {
    format!(
        "RMS of the {} over all joints, each as much as the others, on {}. Recalibrated: numbers refitted within \
         their beliefs, nothing added; joints that lack nothing are as given. Then what was found joint by joint, what closes \
         most first. Closes: share of the whole gap above the floor, which is the sensors' own noise.",
        Measure::of(report.diagnosis.gap.unit).what,
        logs_of(&report.diagnosis)
    )
}

/// The steps; what all joints leave together is the root of their mean square.
pub(super) fn steps(report: &ClampedGapReport) -> Vec<Rung> {
    let gap = &report.diagnosis.gap;
    let joints: Vec<&Diagnosis> = report.joints.iter().map(|(_, joint)| &joint.diagnosis).collect();
    let root = |squares: f64| (squares.max(0.0) / joints.len().max(1) as f64).sqrt();
    let mut squares: f64 = joints.iter().map(|own| own.gap.calibrated.powi(2)).sum();
    let mut steps = vec![("as given".to_owned(), gap.before), ("recalibrated".to_owned(), gap.calibrated)];
    if let Some(words) = bodies(report) {
        steps.push((words, root(squares)));
    }
    let closes = |own: &&Diagnosis| own.gap.calibrated.powi(2) - own.gap.after.powi(2);
    let has_changed = joints.iter().copied().filter(|own| closes(own) != 0.0);
    let (mut found, sound): (Vec<&Diagnosis>, Vec<&Diagnosis>) = has_changed.partition(|own| is_accused(own));
    if !sound.is_empty() {
        squares -= sound.iter().map(closes).sum::<f64>();
        steps.push(("joints that lack nothing".to_owned(), root(squares)));
    }
    found.sort_by(|a, b| closes(b).total_cmp(&closes(a)));
    let (own, others) = found.split_at(found.len().min(if found.len() > OWN + 1 { OWN } else { OWN + 1 }));
    for joint in own {
        squares -= closes(joint);
        steps.push((on_joint(joint), root(squares)));
    }
    if !others.is_empty() {
        squares -= others.iter().map(closes).sum::<f64>();
        steps.push((format!("what was found on {} more", others.len()), root(squares)));
    }
    rungs(steps, gap.floor)
}

/// Whether anything is said to be missing of a joint.
fn is_accused(own: &Diagnosis) -> bool {
    !own.causes.is_empty() || own.law.is_some()
}

/// `payload on gripper`
fn bodies(report: &ClampedGapReport) -> Option<String> {
    let of: Vec<String> =
        report.diagnosis.bodies.iter().map(|body| format!("{} on {}", body.kind.id(), body.body)).collect();
    (!of.is_empty()).then(|| of.join(" and "))
}

/// `delay on elbow`
fn on_joint(own: &Diagnosis) -> String {
    let law = own.law.as_ref().map(|_| "a law");
    let causes: Vec<&str> = own.causes.iter().map(|cause| cause.effect.id()).chain(law).collect();
    let what = match &causes[..] {
        [one] => (*one).to_owned(),
        [one, two] => format!("{one} and {two}"),
        more => format!("{} causes", more.len()),
    };
    format!("{what} on {}", own.joint)
}

/// The steps as bars.
pub(super) fn figure(report: &ClampedGapReport) -> Result<String, ReportError> {
    let measure = Measure::of(report.diagnosis.gap.unit);
    let logs = logs_of(&report.diagnosis);
    let label = format!("RMS of the {} over all joints, {logs} [{}]", measure.what, measure.unit);
    let title = format!("{}: {}", report.diagnosis.robot, HEADING.to_lowercase());
    draw_rungs(&title, &label, measure, &steps(report))
}
