//! Figures 4.5, 4.6 and C.2: where the trunk goes, setpoints and what the joints make of them.

use super::{LegCurves, TrunkCurves, WalkReport};
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    EXTENSIVE, LEGEND_END, SETPOINT, Sign, chart, legend, line, sketch, stroke, thinned,
};
use crate::report::{Figure, ReportError};
use plotters::style::Color;

const PANEL: f64 = 150.0;
const TIME_AXIS: f64 = 42.0;
/// Where the title ends.
const TITLE: f64 = 36.0;

/// The trunk's displacement where there is a floor; then one figure for each leg, a panel for each of its joints.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn walk_figures(report: &WalkReport) -> Result<Vec<Figure>, ReportError> {
    let (name, place) =
        if report.trunk.is_some() { ("Figure 4.6", "on the floor") } else { ("Figure C.2", "in the air") };
    let figure = |leg: &LegCurves| {
        Ok(Figure {
            file_name: format!("walk-{}.svg", leg.name.replace(' ', "-")),
            title: format!("{name}, {} leg", leg.name),
            caption: format!(
                "{name}. Setpoint and simulated reading. Where only one line is seen the joint follows without delay \
                 and at full amplitude."
            ),
            svg: draw(leg, place)?,
        })
    };
    let trunk = |trunk: &TrunkCurves| {
        Ok(Figure {
            file_name: "walk-trunk.svg".to_owned(),
            title: "Figure 4.5, displacement of the trunk".to_owned(),
            caption: "Figure 4.5. Where the trunk's centre is: forward and to the right from where it was dropped, and its height \
                      over the floor. The robot falls, settles, and walks."
                .to_owned(),
            svg: draw_trunk(trunk)?,
        })
    };
    report.trunk.iter().map(trunk).chain(report.legs.iter().map(figure)).collect()
}

fn draw(leg: &LegCurves, place: &str) -> Result<String, ReportError> {
    let time = Axis::over(leg.t_s.iter().copied(), 0.01);
    let height = LEGEND_END + PANEL * leg.joints.len() as f64 + TIME_AXIS;
    sketch(&format!("walk {place}, {} leg", leg.name), height, |root| {
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

fn draw_trunk(trunk: &TrunkCurves) -> Result<String, ReportError> {
    let time = Axis::over(trunk.t_s.iter().copied(), 0.01);
    let panels = [("forward [m]", &trunk.forward_m), ("right [m]", &trunk.right_m), ("height [m]", &trunk.height_m)];
    let height = TITLE + PANEL * panels.len() as f64 + TIME_AXIS;
    sketch("walk on the floor, displacement of the trunk", height, |root| {
        let (mut top, mut bottom) = (TITLE, TITLE);
        for (k, (name, values)) in panels.into_iter().enumerate() {
            let is_last = k + 1 == panels.len();
            bottom += PANEL + if is_last { TIME_AXIS - 4.0 } else { 0.0 };
            let axis = Axis::over(values.iter().copied(), 0.06);
            let mut panel = chart(root, (top, bottom), (&time, &axis), (if is_last { "time [s]" } else { "" }, name))?;
            line(&mut panel, &thinned(&trunk.t_s, values), stroke(EXTENSIVE, 1.5))?;
            top = bottom;
        }
        Ok(())
    })
}
