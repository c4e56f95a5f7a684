//! Figures B.1 to B.3.

use super::SensorReport;
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    EXTENSIVE, LEGEND_END, MEASURED, SETPOINT, Sign, chart, dots, filled, legend, line, sketch, stroke,
};
use crate::report::{Figure, ReportError};
use crate::robot::simulate::Swept;
use plotters::style::Color;

const PANEL: f64 = 330.0;

/// Readings against setpoints of both sweeps, and what lies between them in the fine one.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn sensor_figures(report: &SensorReport) -> Result<Vec<Figure>, ReportError> {
    let mut figures = Vec::new();
    for (k, sweep) in report.sweeps.iter().enumerate() {
        let title = format!("Figure B.{}, {}", k + 1, report.joint);
        let columns = [("reading", &sweep.reading_rad), ("true angle", &sweep.angle_rad)];
        let svg = draw(&title, sweep, columns, true, "angle [rad]")?;
        let caption = "Readings of the position sensor and the true angle against the setpoint.";
        figures.push(figure(&format!("sensor-b{}", k + 1), title, caption, svg));
    }
    if let Some(fine) = report.sweeps.last() {
        let title = format!("Figure B.3, {}", report.joint);
        let less = |column: &[f64]| -> Vec<f64> {
            column.iter().zip(&fine.setpoint_rad).map(|(value, setpoint)| 1e3 * (value - setpoint)).collect()
        };
        let (reading, angle) = (less(&fine.reading_rad), less(&fine.angle_rad));
        let columns = [("reading less setpoint", &reading), ("true angle less setpoint", &angle)];
        let caption = "The dots' distance from the line is the sensor's; the line's from zero is the controller's.";
        let svg = draw(&title, fine, columns, false, "error [mrad]")?;
        figures.push(figure("sensor-b3", title, caption, svg));
    }
    Ok(figures)
}

fn figure(name: &str, title: String, caption: &str, svg: String) -> Figure {
    Figure { file_name: format!("{name}.svg"), title, caption: caption.to_owned(), svg }
}

fn draw(
    title: &str,
    sweep: &Swept,
    [dotted, lined]: [(&str, &Vec<f64>); 2],
    with_reference: bool,
    label: &str,
) -> Result<String, ReportError> {
    let x = Axis::over(sweep.setpoint_rad.iter().copied(), 0.02);
    let y = Axis::over(dotted.1.iter().chain(lined.1).copied().chain([0.0]), 0.06);
    sketch(title, LEGEND_END + PANEL, |root| {
        let mut names = vec![
            (Sign::Dot, MEASURED.to_rgba(), dotted.0.to_owned()),
            (Sign::Line, EXTENSIVE.to_rgba(), lined.0.to_owned()),
        ];
        if with_reference {
            names.push((Sign::Line, SETPOINT.to_rgba(), "setpoint".to_owned()));
        }
        let top = legend(root, &names)?;
        let mut panel = chart(root, (top, LEGEND_END + PANEL - 4.0), (&x, &y), ("setpoint [rad]", label))?;
        let pairs = |column: &[f64]| sweep.setpoint_rad.iter().copied().zip(column.iter().copied()).collect::<Vec<_>>();
        if with_reference {
            line(&mut panel, &pairs(&sweep.setpoint_rad), stroke(SETPOINT, 1.0))?;
        }
        line(&mut panel, &pairs(lined.1), stroke(EXTENSIVE, 1.25))?;
        dots(&mut panel, &pairs(dotted.1), 1.75, filled(MEASURED, 0.8))
    })
}
