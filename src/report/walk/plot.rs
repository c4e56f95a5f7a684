//! Figure C.2: setpoints and what the joints make of them.

use super::{LegCurves, WalkReport};
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    EXTENSIVE, LEGEND_END, SETPOINT, Sign, chart, legend, line, sketch, stroke, thinned,
};
use crate::report::{Figure, ReportError};
use plotters::style::Color;

const PANEL: f64 = 150.0;
const TIME_AXIS: f64 = 42.0;

/// One figure for each leg: a panel for each of its joints.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn walk_figures(report: &WalkReport) -> Result<Vec<Figure>, ReportError> {
    let figure = |leg: &LegCurves| {
        Ok(Figure {
            file_name: format!("walk-{}.svg", leg.name.replace(' ', "-")),
            title: format!("Figure C.2, {} leg", leg.name),
            caption: "Setpoint and simulated reading. Where only one line is seen the joint follows without delay and \
                      at full amplitude."
                .to_owned(),
            svg: draw(leg)?,
        })
    };
    report.legs.iter().map(figure).collect()
}

fn draw(leg: &LegCurves) -> Result<String, ReportError> {
    let time = Axis::over(leg.t_s.iter().copied(), 0.01);
    let height = LEGEND_END + PANEL * leg.joints.len() as f64 + TIME_AXIS;
    sketch(&format!("walk in the air, {} leg", leg.name), height, |root| {
        let names = [
            (Sign::Line, SETPOINT.to_rgba(), "setpoint".to_owned()),
            (Sign::Line, EXTENSIVE.to_rgba(), "simulated".to_owned()),
        ];
        let mut top = legend(root, &names)?;
        let mut bottom = LEGEND_END;
        for (k, joint) in leg.joints.iter().enumerate() {
            let is_last = k + 1 == leg.joints.len();
            bottom += PANEL + if is_last { TIME_AXIS - 4.0 } else { 0.0 };
            let angle = Axis::over(joint.setpoint_rad.iter().chain(&joint.reading_rad).copied(), 0.06);
            let labels = (if is_last { "time [s]" } else { "" }, format!("{} [rad]", joint.name));
            let mut panel = chart(root, (top, bottom), (&time, &angle), (labels.0, &labels.1))?;
            line(&mut panel, &thinned(&leg.t_s, &joint.setpoint_rad), stroke(SETPOINT, 4.0))?;
            line(&mut panel, &thinned(&leg.t_s, &joint.reading_rad), stroke(EXTENSIVE, 1.25))?;
            top = bottom;
        }
        Ok(())
    })
}
