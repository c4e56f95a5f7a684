//! A walk as one page.

use super::WalkReport;
use super::plot::walk_figures;
use super::text::cost;
use crate::report::ReportError;
use crate::report::html::{both, figure_views, render};
use crate::report::number::significant;
use minijinja::context;

/// Puts a walk into one HTML page that loads nothing.
///
/// # Errors
/// [`ReportError::Draw`] or [`ReportError::Font`] from the figures, [`ReportError::Page`] from the template; none depends
/// on the data.
pub fn walk_html(report: &WalkReport) -> Result<String, ReportError> {
    let row = |row: &super::FollowRow| {
        context! {
            joint => row.joint.as_str(),
            amplitude => format!("{:.4}", row.amplitude_rad),
            ratio => format!("{:.4}", row.amplitude_ratio),
            delay => format!("{:.2}", 1e3 * row.delay_s),
            rms => significant(1e3 * row.rms_rad, 3),
            worst => significant(1e3 * row.worst_rad, 3),
            peak => significant(row.peak_rad_s, 3),
        }
    };
    let values = context! {
        robot => report.robot.as_str(),
        title => report.title(),
        film => !report.legs.is_empty(),
        sentence => report.sentence.as_str(),
        notes => report.notes.clone(),
        cost => cost(report),
        rows => report.joints.iter().map(row).collect::<Vec<_>>(),
        figures => figure_views(both(|| walk_figures(report))?.each_ref()),
        version => report.provenance.version.as_str(),
        command => report.provenance.command.as_str(),
        inputs => report.provenance.inputs.clone(),
    };
    render("walk.html", include_str!("../templates/walk.html"), values)
}
