//! Curves in panels above each other over one axis.

use crate::report::ReportError;
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{LegendEntry, chart, legend, legend_end, line, sketch, stroke, thinned};
use plotters::style::RGBColor;

const PANEL: f64 = 150.0;
const TIME_AXIS: f64 = 42.0;
/// Where the title ends.
const TITLE: f64 = 36.0;

/// One curve.
pub(super) struct Curve<'a> {
    pub x: &'a [f64],
    pub y: &'a [f64],
    pub colour: RGBColor,
    /// \[px\]
    pub width: f64,
}

/// What one panel shows, with the name and unit of its axis.
pub(super) struct Panel<'a> {
    pub label: String,
    pub curves: Vec<Curve<'a>>,
}

/// Draws panels from top to bottom.
pub(super) fn stacked(
    title: &str,
    names: &[LegendEntry],
    x_label: &str,
    panels: &[Panel<'_>],
) -> Result<String, ReportError> {
    let curves = || panels.iter().flat_map(|panel| &panel.curves);
    let x = Axis::over(curves().flat_map(|curve| curve.x.iter().copied()), 0.01);
    let begin = if names.is_empty() { TITLE } else { legend_end(names) };
    let height = begin + PANEL * panels.len() as f64 + TIME_AXIS;
    sketch(title, height, |root| {
        if !names.is_empty() {
            legend(root, names)?;
        }
        let (mut top, mut bottom) = (begin, begin);
        for (k, panel) in panels.iter().enumerate() {
            let is_last = k + 1 == panels.len();
            bottom += PANEL + if is_last { TIME_AXIS - 4.0 } else { 0.0 };
            let y = Axis::over(panel.curves.iter().flat_map(|curve| curve.y.iter().copied()), 0.06);
            let label = if is_last { x_label } else { "" };
            let mut plane = chart(root, (top, bottom), (&x, &y), (label, &panel.label))?;
            for curve in &panel.curves {
                line(&mut plane, &thinned(curve.x, curve.y), stroke(curve.colour, curve.width))?;
            }
            top = bottom;
        }
        Ok(())
    })
}
