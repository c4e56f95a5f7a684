//! A sensor test for a terminal and as a page.

use super::{SensorReport, sensor_figures};
use crate::report::ReportError;
use crate::report::html::{both, figure_views, render};
use crate::report::number::significant;
use crate::report::text::{finish, number, table, wrap};
use crate::robot::simulate::Swept;
use comfy_table::Cell;
use minijinja::context;

const WIDTH: usize = 100;

fn cells(sweep: &Swept) -> [String; 6] {
    let milli = |value: f64| significant(1e3 * value, 3);
    let [low, high] = sweep.sensor_range_rad;
    [
        milli(sweep.rms_rad),
        milli(sweep.sensor_rms_rad),
        format!("{} to {}", milli(low), milli(high)),
        milli(sweep.droop_rms_rad),
        milli(sweep.droop_worst_rad),
        format!("{:.1} %", 100.0 * sweep.not_below),
    ]
}

fn name(sweep: &Swept) -> String {
    let [first, last] = sweep.range_rad.map(|angle_rad| (1e4 * angle_rad).round() / 1e4);
    format!("{first} to {last} rad, {} measurements", sweep.measurements)
}

/// The report as text.
pub fn sensor_text(report: &SensorReport) -> String {
    let numbers = [
        "RMS\n[mrad]",
        "sensor RMS\n[mrad]",
        "sensor\n[mrad]",
        "droop RMS\n[mrad]",
        "droop worst\n[mrad]",
        "not below",
    ];
    let mut rows = table(WIDTH, &["sweep"], &numbers);
    for sweep in &report.sweeps {
        let first = std::iter::once(Cell::new(name(sweep)));
        rows.add_row(first.chain(cells(sweep).into_iter().map(number)));
    }
    format!("{}\n\n{}\n", wrap(WIDTH, &report.sentence, "", ""), finish(&mut rows))
}

/// The report as one page that loads nothing.
///
/// # Errors
/// [`ReportError::Draw`] or [`ReportError::Font`] from the figures, [`ReportError::Page`] from the template.
pub fn sensor_html(report: &SensorReport) -> Result<String, ReportError> {
    let row = |sweep: &Swept| context! { name => name(sweep), cells => cells(sweep).to_vec() };
    let values = context! {
        joint => report.joint.as_str(),
        sentence => report.sentence.as_str(),
        rows => report.sweeps.iter().map(row).collect::<Vec<_>>(),
        figures => figure_views(both(|| sensor_figures(report))?.each_ref()),
        version => report.provenance.version.as_str(),
        command => report.provenance.command.as_str(),
    };
    render("sensor.html", include_str!("../templates/sensor.html"), values)
}
