//! Figures of a diagnosis as SVG.

mod along;
pub(in crate::report) mod bars;
mod cells;
mod close_up;
pub(in crate::report) mod how_far;
mod law;
mod log;
mod motion;
mod ruled;
pub(in crate::report) mod rungs;
#[cfg(test)]
mod tests;
mod torque;
mod waterfall;

pub use law::law_figure;

use super::rows::{effect_rows, joint_rows};
use super::{GapReport, NEXT_FILE};
use crate::gap::Verdict;
use crate::gap::inverse::TorqueTraces;
use crate::joint::Stage;
use crate::report::gap::words;
use crate::report::plot::intervals::{Group, interval_bars};
use crate::report::plot::plain;
use crate::report::{Figure, ReportError};

/// Figures by their place in the report; what would be empty is left out.
pub(super) struct GapFigures {
    pub steps: Vec<Figure>,
    pub laws: Vec<Figure>,
    pub close_up: Vec<Figure>,
    pub place: Vec<Figure>,
    pub which: Vec<Figure>,
    pub twins: Vec<Figure>,
    pub how_far: Vec<Figure>,
    pub logs: Vec<Figure>,
    pub parameters: Vec<Figure>,
    pub next: Vec<Figure>,
}

/// Draws every figure of a diagnosis, in the order in which the page shows them.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn gap_figures(report: &GapReport) -> Result<Vec<Figure>, ReportError> {
    let GapFigures { steps, next, close_up, laws, place, which, twins, how_far, logs, parameters } =
        GapFigures::of(report)?;
    Ok([steps, next, close_up, laws, place, which, twins, how_far, logs, parameters].into_iter().flatten().collect())
}

/// A figure with its file's name.
pub(in crate::report) fn figure(name: &str, title: &str, caption: &str, svg: String) -> Figure {
    Figure { file_name: format!("{name}.svg"), title: title.to_owned(), caption: caption.to_owned(), svg }
}

impl GapFigures {
    pub fn of(report: &GapReport) -> Result<Self, ReportError> {
        let diagnosis = &report.diagnosis;
        let mut steps = Vec::new();
        if !diagnosis.gap.per_log.is_empty() {
            let caption = super::waterfall::explanation(diagnosis);
            let title = super::waterfall::heading(diagnosis);
            steps.push(figure("waterfall", title, &caption, waterfall::waterfall(diagnosis)?));
        }
        let mut laws = Vec::new();
        if let Some(law) = &diagnosis.law {
            laws.push(law_figure(&diagnosis.joint, &law.table, law.sd.as_deref())?);
        }
        let mut which = Vec::new();
        if !diagnosis.ranking.is_empty() {
            let of = if diagnosis.gap.is_held_out() {
                "the error is that of logs that the fit has not seen"
            } else {
                "the error is that of logs that were fitted as well"
            };
            let caption = format!(
                "Recalibrated: inertia, moment and friction refitted, nothing added. Each effect is added to the joint and \
                 everything is refitted; {of}. Closes alone: share of what recalibration leaves."
            );
            which.push(figure("ranking", "Effects that were considered", &caption, bars::ranking(diagnosis)?));
        }
        let mut twins = Vec::new();
        if let Some(table) = &diagnosis.confusion {
            let caption = "Twins are this study with a known cause in it. A row is a true cause, a column an answer; \
                           what stands beside the diagonal was answered wrongly.";
            let svg = cells::confusion(&diagnosis.joint, table)?;
            twins.push(figure("twins", "Answers on twins", caption, svg));
        }
        let mut how_far = Vec::new();
        if !diagnosis.gap.per_log.is_empty() {
            let caption = "Dots that reach the diamond leave nothing but the sensor's own noise.";
            how_far.push(figure("how-far", "How far the gap closes", caption, how_far::how_far(diagnosis)?));
        }
        let mut next = Vec::new();
        if let Some((t_s, q_ref_rad)) = diagnosis.next.as_ref().and_then(|next| next.motion.as_ref()) {
            let caption = format!("The setpoint to follow, in {NEXT_FILE}.");
            next.push(figure("next", "Next motion", &caption, motion::motion(&diagnosis.joint, t_s, q_ref_rad)?));
        }
        Ok(Self {
            steps,
            laws,
            close_up: close_up(report)?,
            place: place(report)?,
            which,
            twins,
            how_far,
            logs: if report.torques.is_empty() { logs(report)? } else { torques(report)? },
            parameters: parameters(report)?,
            next,
        })
    }
}

/// The moment at which the answer matters most.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub(in crate::report) fn close_up(report: &GapReport) -> Result<Vec<Figure>, ReportError> {
    let diagnosis = &report.diagnosis;
    if let Some((torques, at_s)) = close_up::torques(diagnosis, &report.torques) {
        let caption = "The stretch at which the answer matters most. Above: the drive's torque, and what models ask for along \
                       the measured motion. Below: what is left over.";
        let title = format!("{}, close-up of {} at {at_s:.2} s", diagnosis.joint, torques.file);
        return Ok(vec![figure("close-up", "Close-up", caption, along::torques(diagnosis, &torques, &title)?)]);
    }
    let Some(moment) = close_up::moment(diagnosis) else { return Ok(Vec::new()) };
    let caption = "The turn of the motion at which the answer matters most. Dots are readings, dashes what was asked; below, \
                   measured minus model.";
    let svg = close_up::close_up(diagnosis, &moment, half_step_rad(report, &moment.log.file))?;
    Ok(vec![figure("close-up", "Close-up", caption, svg)])
}

/// Half a step of a log's readings \[rad\]; 0 where it is unknown.
fn half_step_rad(report: &GapReport, file: &str) -> f64 {
    report.health.iter().find(|row| row.file == file).map_or(0.0, |row| 0.5 * row.resolution_rad)
}

/// Where no variable explains this share of the missing torque there is nothing to draw.
const LEAST_SHARE: f64 = 0.005;

/// Where the gap lies.
fn place(report: &GapReport) -> Result<Vec<Figure>, ReportError> {
    let diagnosis = &report.diagnosis;
    let location = &diagnosis.location;
    let mut figures = Vec::new();
    if words::is_mapped(&location.cells) {
        let caption = "Share of the whole gap by log and by what the joint is doing. Framed: more than noise alone \
                       would give; grey: no more than that.";
        figures.push(figure("map", "Where the gap lies", caption, cells::map(diagnosis)?));
    }
    // A setpoint that acts late or otherwise is no torque: what one depends on would lead astray.
    let is_torque = !matches!(location.stage, Some(Stage::Setpoint | Stage::Delay));
    let explains = location.variables.iter().any(|(_, share)| *share > LEAST_SHARE);
    if is_torque && explains {
        let caption = "Variables hang together, so the shares do not add up to 100 %.";
        figures.push(figure("variables", "What the gap depends on", caption, bars::variables(diagnosis)?));
    }
    if let Some(variable) = location.by().filter(|_| is_torque && !location.profile.is_empty()) {
        let caption = "The torque that the recalibrated model lacks, averaged in bins. A constant or smooth curve away \
                       from zero is missing physics; a band around zero is none. For variables of friction it counts \
                       against the motion.";
        figures.push(figure("profile", "Missing torque", caption, torque::profile(diagnosis, variable)?));
    }
    if diagnosis.answer.verdict == Verdict::Unexplained && !diagnosis.traces.is_empty() {
        let caption = "The torque that the recalibrated model lacks at every sample, for you to look at: what depends \
                       on speed alone is a line on the left, what depends on angle alone a line on the right, a loop \
                       has memory.";
        figures.push(figure("shape", "Shape of what is unexplained", caption, torque::shape(diagnosis)?));
    }
    Ok(figures)
}

fn logs(report: &GapReport) -> Result<Vec<Figure>, ReportError> {
    let diagnosis = &report.diagnosis;
    let fitted = if diagnosis.gap.is_held_out() {
        "all logs with role fit; their errors on held-out logs stand above"
    } else {
        "all logs"
    };
    let caption = format!(
        "Above: readings and models, fitted to {fitted}. Middle: measured minus model; what explains the log stays in the band. \
         Below: the torque that is missing. Mind the scales where a model has a panel of its own."
    );
    let draw = |(i, log): (usize, &crate::gap::LogTraces)| {
        let name = format!("log-{:02}-{}", i + 1, plain(&log.file));
        let title = format!("Log {} ({})", log.file, log.role);
        Ok(figure(&name, &title, &caption, log::log(diagnosis, log, half_step_rad(report, &log.file))?))
    };
    diagnosis.traces.iter().enumerate().map(draw).collect()
}

fn torques(report: &GapReport) -> Result<Vec<Figure>, ReportError> {
    let caption =
        "Above: the drive's torque, and what models ask for along the measured motion. Below: what is left over.";
    let of_log = |log: &TorqueTraces| format!("{}, {} ({})", report.diagnosis.joint, log.file, log.role);
    let draw = |(i, log): (usize, &TorqueTraces)| {
        let name = format!("log-{:02}-{}", i + 1, plain(&log.file));
        let title = format!("Log {} ({})", log.file, log.role);
        Ok(figure(&name, &title, caption, along::torques(&report.diagnosis, log, &of_log(log))?))
    };
    report.torques.iter().enumerate().map(draw).collect()
}

fn parameters(report: &GapReport) -> Result<Vec<Figure>, ReportError> {
    let diagnosis = &report.diagnosis;
    let (joint, effects) = (joint_rows(diagnosis), effect_rows(diagnosis));
    let group = |name, rows| Group { name, rows, beliefs: &diagnosis.beliefs };
    let mut groups = vec![group("joint", &joint[..]), group("effects", &effects[..])];
    groups.retain(|group| !group.rows.is_empty());
    if groups.is_empty() {
        return Ok(Vec::new());
    }
    let caption = "The 95 % interval allows for residuals that hang together in time, the naive one does not. Numbers of which \
                 something was believed are drawn from that, in its standard deviations: an interval that fills the band says no \
                 more than was believed, a short one beside it is a finding. An arrow is an end beyond the ruler.";
    let svg = interval_bars(&format!("{} parameters with 95 % intervals", diagnosis.joint), &groups)?;
    Ok(vec![figure("intervals", "Parameters and their intervals", caption, svg)])
}
