//! Figures as SVG, one function each; the drawing library stays in here.

pub(super) mod axis;
pub(super) mod canvas;
mod correlation;
mod friction;
pub(super) mod heat;
pub(super) mod intervals;
pub(super) mod layout;
pub(super) mod overlay;
mod phase;
mod readout;
mod shrink;
mod swing;
#[cfg(test)]
pub(super) mod tests;
mod trace;

pub(super) use canvas::{FONT_BOLD, FONT_REGULAR};
pub use correlation::correlation_matrix;
pub use friction::friction_curve;
pub use intervals::parameter_intervals;
pub use phase::phase_portrait;
pub use swing::swing;
pub use trace::optimiser_trace;

use self::intervals::{Group, interval_bars};
use super::full::full_figures;
use super::{DropReport, LogCurves, ReportError};
use crate::number::extent;

/// One figure of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// Name for its file, unique in its report, without characters that a file system minds.
    pub file_name: String,
    /// What it shows, in a few words.
    pub title: String,
    /// How to read it, in a sentence.
    pub caption: String,
    /// The drawing, a whole SVG document.
    pub svg: String,
}

/// Draws every figure of a report, in the order in which the page shows them.
///
/// A figure that would be empty is left out: friction where its scale is not determined, the correlation of fewer than
/// two parameters, everything about models where there are none.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn figures(report: &DropReport) -> Result<Vec<Figure>, ReportError> {
    let mut figures = log_figures(report)?;
    if let Some(full) = &report.full {
        figures.extend(full_figures(&report.joint, full)?);
    }
    figures.extend(model_figures(report)?);
    Ok(figures)
}

/// One figure per log, in their order.
pub(super) fn log_figures(report: &DropReport) -> Result<Vec<Figure>, ReportError> {
    let figure = |(i, log): (usize, &LogCurves)| {
        Ok(Figure {
            file_name: format!("swing-{:02}-{}.svg", i + 1, plain(&log.file)),
            title: format!("Swing {} ({})", log.file, log.role),
            caption: "Above: readings and models. Below: measured minus model; a model that explains the log leaves \
                      little outside the band, and no pattern. Mind the scales where each model has a panel of its own."
                .to_owned(),
            svg: swing(&report.joint, log)?,
        })
    };
    report.logs.iter().enumerate().map(figure).collect()
}

/// The figures about the models, after those of the logs.
pub(super) fn model_figures(report: &DropReport) -> Result<Vec<Figure>, ReportError> {
    let joint = &report.joint;
    let mut figures = Vec::new();
    let mut add = |name: &str, title: &str, caption: &str, svg: String| {
        let [file_name, title, caption] = [format!("{name}.svg"), title.to_owned(), caption.to_owned()];
        figures.push(Figure { file_name, title, caption, svg });
    };
    if let Some(log) = widest_swing(&report.logs) {
        let caption = "The log that swings widest. Where the dots leave the line, the model has the wrong speed.";
        add("phase-portrait", "Phase portrait", caption, phase_portrait(joint, log)?);
    }
    if !report.friction.is_empty() {
        let caption = "Friction torque of the extensive model; the band is its 95 % interval.";
        add("friction", "Friction against speed", caption, friction_curve(joint, &report.friction)?);
    }
    if !report.models.is_empty() {
        let caption = "The 95 % interval allows for residuals that hang together in time, the naive one does not. Numbers of which \
                 something was believed are drawn from that, in its standard deviations: an interval that fills the band says no \
                 more than was believed, a short one beside it is a finding. An arrow is an end beyond the ruler.";
        let groups = report.models.iter();
        let groups: Vec<_> =
            groups.map(|m| Group { name: &m.name, rows: &m.parameters, beliefs: &report.beliefs }).collect();
        let svg = interval_bars(&format!("{joint} parameters with 95 % intervals"), &groups)?;
        add("intervals", "Parameters and their intervals", caption, svg);
    }
    if report.correlation.names.len() > 1 {
        let caption = "Near +1 or \u{2212}1 the logs fix a combination of two parameters better than either alone.";
        let svg = correlation_matrix(joint, &report.correlation)?;
        add("correlation", "Correlation of the fitted parameters", caption, svg);
    }
    if !report.models.is_empty() {
        let caption = "How far the best criterion found so far lies above where it ends, from the start until less than a millionth is \
             left: a steep end is a clean convergence, a long flat one means that the criterion hardly changes there.";
        add("optimiser", "Optimiser", caption, optimiser_trace(joint, &report.models)?);
    }
    Ok(figures)
}

/// The log whose fitted readings span the widest angle; the first of equals.
fn widest_swing(logs: &[LogCurves]) -> Option<&LogCurves> {
    let span = |log: &LogCurves| {
        let fitted = log.measured_rad.iter().skip(log.first_fitted).filter(|angle| angle.is_finite());
        let [low, high] = extent(fitted.copied());
        (high - low).max(0.0)
    };
    logs.iter().rev().max_by(|a, b| span(a).total_cmp(&span(b)))
}

/// A log's name without folder and ending, and with the part of it that is meant: `2/log.csv (part 2)` is `log part 2`.
pub(super) fn bare(log: &str) -> String {
    let (file, part) = log.strip_suffix(')').and_then(|log| log.rsplit_once(" (")).unwrap_or((log, ""));
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let stem = name.rsplit_once('.').map(|(stem, _)| stem).filter(|stem| !stem.is_empty()).unwrap_or(name);
    if part.is_empty() { stem.to_owned() } else { format!("{stem} {part}") }
}

/// The same, reduced to letters, digits and dashes.
pub(super) fn plain(log: &str) -> String {
    let bare = bare(log);
    bare.chars().take(40).map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect()
}
