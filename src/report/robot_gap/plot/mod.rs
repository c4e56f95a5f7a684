//! Figures of a robot's diagnosis as SVG.

mod bars;
mod joint;
mod map;
mod sketch;

pub use sketch::Sketch;

use super::RobotGapReport;
use super::{waterfall, words};
use crate::gap::LogGap;
use crate::gap::robot::JointTrace;
use crate::report::gap::plot::figure;
use crate::report::gap::plot::how_far::errors;
use crate::report::measure::ANGLE;
use crate::report::plot::layout::is_narrow;
use crate::report::plot::plain;
use crate::report::{Figure, ReportError};

/// Figures by their place in the report; what would be empty is left out.
pub(super) struct RobotGapFigures {
    pub steps: Vec<Figure>,
    pub place: Vec<Figure>,
    pub which: Vec<Figure>,
    pub how_far: Vec<Figure>,
    pub joints: Vec<Figure>,
}

/// Draws every figure of a robot's diagnosis, in the order in which the page shows them.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn robot_gap_figures(report: &RobotGapReport) -> Result<Vec<Figure>, ReportError> {
    let RobotGapFigures { steps, place, which, how_far, joints } = RobotGapFigures::of(report)?;
    Ok([steps, place, which, how_far, joints].into_iter().flatten().collect())
}

impl RobotGapFigures {
    pub fn of(report: &RobotGapReport) -> Result<Self, ReportError> {
        let diagnosis = &report.diagnosis;
        let mut place = Vec::new();
        if !diagnosis.location.cells.is_empty() {
            let caption = "Each joint has a cell for what its leg was doing, touch-down being the first moments of a stance; \
                           the number is the RMS of the gap above the sensor's noise in mrad. Framed: more than chance gives, \
                           also when all cells are looked at. Where there is room, the robot is seen from above, its legs \
                           spread out for the picture.";
            // On a narrow screen the robot has no room between its cells.
            let svg = if is_narrow() { map::table(diagnosis)? } else { map::on_robot(diagnosis, &report.sketch)? };
            place.push(figure("map", "Where the gap lies", caption, svg));
        }
        let mut which = Vec::new();
        if !diagnosis.ranking.is_empty() {
            let caption = "Recalibrated: masses and friction adapted within what is uncertain anyway, nothing added. Each \
                           cause is added where it stands and fitted; the error is that of samples that the fit has not \
                           seen.";
            which.push(figure("ranking", "Causes that were fitted", caption, bars::ranking(diagnosis)?));
        }
        let mut how_far = Vec::new();
        if !diagnosis.gap.per_joint.is_empty() {
            let caption = "Held-out samples. Dots that reach the diamond leave nothing but the sensor's own noise.";
            how_far.push(figure("how-far", "How far the gap closes, joint by joint", caption, per_joint(report)?));
        }
        if !diagnosis.gap.displacement.is_empty() {
            let caption = "How far the trunk went between the times that the study states.";
            how_far.push(figure("displacement", "Displacement of the trunk", caption, bars::displacement(diagnosis)?));
        }
        let svg = waterfall::figure(diagnosis)?;
        let steps = vec![figure("waterfall", waterfall::HEADING, waterfall::EXPLANATION, svg)];
        Ok(Self { steps, place, which, how_far, joints: joints(report)? })
    }
}

/// Errors of all joints, and in all.
fn per_joint(report: &RobotGapReport) -> Result<String, ReportError> {
    let gap = &report.diagnosis.gap;
    let row = |file: &str, before, calibrated, after| LogGap {
        file: file.to_owned(),
        before,
        calibrated,
        after,
        floor: gap.floor,
    };
    let mut rows: Vec<LogGap> =
        gap.per_joint.iter().map(|of| row(&of.joint, of.before, of.calibrated, of.after)).collect();
    rows.push(row("all of them", gap.before, gap.calibrated, gap.after));
    let title = format!("{}: error of each joint", report.diagnosis.robot);
    errors(&title, &rows.iter().collect::<Vec<_>>(), ANGLE, words::answer(&report.diagnosis.answer))
}

/// Curves of the joints that matter, in the logs that matter.
fn joints(report: &RobotGapReport) -> Result<Vec<Figure>, ReportError> {
    let caption = "Above: readings, setpoint and models. Middle: measured minus model; what explains the log stays in the \
                   band. Below, where the trunk is clamped: the torque that the joint as given lacks, by inverse dynamics \
                   of the measured motion. Mind the scales where a model has a panel of its own.";
    let draw = |(i, trace): (usize, &JointTrace)| {
        let name = format!("joint-{:02}-{}-{}", i + 1, plain(&trace.joint), plain(&trace.file));
        let title = format!("{} in {}", trace.joint, trace.file);
        Ok(figure(&name, &title, caption, joint::joint(report, trace)?))
    };
    joint::chosen(&report.diagnosis).into_iter().enumerate().map(draw).collect()
}
