//! Figures of studies: rows against printed ones, how far a result moves, joints and trunk of single runs.

use super::COLOURS;
use super::panels::{Curve, Panel, stacked};
use super::plot::draw_trunk;
use crate::report::number::significant;
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    Area, Drawn, EXTENSIVE, GRID, INK, LegendEntry, Look, MEASURED, POSITIVE, RIGHT, Sign, diamond, filled, legend, px,
    sketch, spot, stroke, text, width,
};
use crate::report::plot::layout::is_narrow;
use crate::report::{Figure, ReportError};
use crate::robot::simulate::TrunkCurves;
use plotters::prelude::{Circle, PathElement, Rectangle};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor};

const ROW: f64 = 24.0;
/// Where the names end and the plane begins \[px\].
fn names_end() -> f64 {
    if is_narrow() { 150.0 } else { 290.0 }
}

/// A row of a comparison.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// What it is.
    pub name: String,
    /// In the thesis.
    pub printed: Option<f64>,
    /// Here.
    pub ours: Option<f64>,
}

/// Columns over one time, of one joint.
#[derive(Clone, Debug)]
pub struct PairedCurves {
    /// Name and unit of the axis.
    pub label: String,
    /// \[s\]
    pub t_s: Vec<f64>,
    /// One for each entry of the legend.
    pub columns: Vec<Vec<f64>>,
}

/// Printed numbers as diamonds, ours as dots, a row each.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn comparison_figure(title: &str, x_label: &str, rows: &[Comparison]) -> Result<String, ReportError> {
    compared(title, x_label, ["thesis", "here"], rows)
}

/// The same of a gap before (diamonds) and after (dots).
///
/// # Errors
/// As [`comparison_figure`].
pub fn before_and_after_figure(title: &str, x_label: &str, rows: &[Comparison]) -> Result<String, ReportError> {
    compared(title, x_label, ["before", "after"], rows)
}

fn compared(title: &str, x_label: &str, of: [&str; 2], rows: &[Comparison]) -> Result<String, ReportError> {
    let axis = Axis::over(rows.iter().flat_map(|row| [row.printed, row.ours]).flatten(), 0.06);
    let names =
        [(Sign::Diamond, MEASURED.to_rgba(), of[0].to_owned()), (Sign::Dot, EXTENSIVE.to_rgba(), of[1].to_owned())];
    let labels: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
    plane(title, x_label, &names, &axis, &labels, |root, k, y| {
        let said = |value: Option<f64>| value.map_or("–".to_owned(), |value| significant(value, 3));
        let words = format!(
            "{}: {} {}, {} {}; {x_label}",
            rows[k].name,
            of[0],
            said(rows[k].printed),
            of[1],
            said(rows[k].ours)
        );
        spot(root, [0.0, y - 0.5 * ROW], [width(), ROW], &words);
        if let Some(value) = rows[k].printed {
            root.draw(&diamond((at(&axis, value), y), filled(MEASURED, 0.8)))?;
        }
        match rows[k].ours {
            Some(value) => root.draw(&Circle::new((px(at(&axis, value)), px(y)), px(4.0), filled(EXTENSIVE, 1.0))),
            None => {
                let look = Look { colour: MEASURED, size: 11.0, anchor: HPos::Right, ..Look::default() };
                text(root, (width() - RIGHT, y), "not run here", look)
            }
        }
    })
}

/// How far a result moves for less and for more of each parameter; `None`: it does not happen any more.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn sensitivity_figure(
    title: &str,
    x_label: &str,
    less_and_more: [&str; 2],
    rows: &[(String, [Option<f64>; 2])],
) -> Result<String, ReportError> {
    let axis = Axis::over(rows.iter().flat_map(|row| row.1).flatten().chain([0.0]), 0.06);
    let colours = [POSITIVE, EXTENSIVE];
    let entry = |k: usize| (Sign::Box, colours[k].to_rgba(), less_and_more[k].to_owned());
    let labels: Vec<&str> = rows.iter().map(|row| row.0.as_str()).collect();
    plane(title, x_label, &[entry(0), entry(1)], &axis, &labels, |root, k, y| {
        let said = |value: Option<f64>| value.map_or("does not fall".to_owned(), |value| significant(value, 3));
        let [less, more] = rows[k].1.map(said);
        let words = format!("{}: {} {less}, {} {more}; {x_label}", rows[k].0, less_and_more[0], less_and_more[1]);
        spot(root, [0.0, y - 0.5 * ROW], [width(), ROW], &words);
        for (side, value) in rows[k].1.iter().enumerate() {
            let top = y - 8.0 + 8.0 * side as f64;
            let (from, colour) = (at(&axis, 0.0), colours[side]);
            match value {
                Some(value) => {
                    let corners = [(px(from), px(top)), (px(at(&axis, *value)), px(top + 7.0))];
                    root.draw(&Rectangle::new(corners, filled(colour, 0.9)))?;
                }
                None => {
                    let look = Look { colour, size: 10.0, ..Look::default() };
                    text(root, (from + 6.0, top + 3.5), "does not fall", look)?;
                }
            }
        }
        Ok(())
    })
}

pub(super) fn at(axis: &Axis, value: f64) -> f64 {
    names_end() + axis.share(value) * (width() - RIGHT - names_end())
}

/// Names at the left, an axis below, whatever `row` draws in each row at its height.
pub(super) fn plane(
    title: &str,
    x_label: &str,
    names: &[LegendEntry],
    axis: &Axis,
    labels: &[&str],
    row: impl Fn(&Area<'_>, usize, f64) -> Drawn,
) -> Result<String, ReportError> {
    let begin = if names.is_empty() { 40.0 } else { 66.0 };
    let bottom = begin + ROW * labels.len() as f64 + 6.0;
    sketch(title, bottom + 50.0, |root| {
        if !names.is_empty() {
            legend(root, names)?;
        }
        let rule = |x: f64, style| root.draw(&PathElement::new([(px(x), px(begin)), (px(x), px(bottom))], style));
        let centred = Look { size: 11.0, anchor: HPos::Center, ..Look::default() };
        for (tick, label) in axis.ticks() {
            rule(at(axis, *tick), stroke(if *tick == 0.0 { INK } else { GRID }, 0.75))?;
            text(root, (at(axis, *tick), bottom + 12.0), label, centred)?;
        }
        let middle = (names_end() + width() - RIGHT) / 2.0;
        text(root, (middle, bottom + 34.0), x_label, Look { size: 12.0, ..centred })?;
        for (k, label) in labels.iter().enumerate() {
            let y = begin + ROW * (k as f64 + 0.5) + 3.0;
            text(root, (names_end() - 10.0, y), label, Look { size: 11.0, anchor: HPos::Right, ..Look::default() })?;
            row(root, k, y)?;
        }
        Ok(())
    })
}

/// Joints over time, a panel each; `names` are the curves'.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn joints_figure(title: &str, names: &[&str], joints: &[PairedCurves]) -> Result<String, ReportError> {
    let entries: Vec<LegendEntry> =
        names.iter().zip(COLOURS).map(|(name, colour)| (Sign::Line, colour.to_rgba(), (*name).to_owned())).collect();
    let panel = |joint: &'_ PairedCurves| -> Vec<(usize, RGBColor)> { (0..joint.columns.len()).zip(COLOURS).collect() };
    let panels: Vec<Panel<'_>> = joints
        .iter()
        .map(|joint| Panel {
            label: joint.label.clone(),
            curves: panel(joint)
                .into_iter()
                .map(|(k, colour)| Curve { x: &joint.t_s, y: &joint.columns[k], colour, width: 1.5 })
                .collect(),
        })
        .collect();
    stacked(title, &entries, "time [s]", &panels)
}

/// A trunk's displacement under the name of one of the thesis's figures.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn trunk_figure(file: &str, name: &str, caption: String, trunk: &TrunkCurves) -> Result<Figure, ReportError> {
    Ok(Figure { file_name: format!("{file}.svg"), title: name.to_owned(), caption, svg: draw_trunk(trunk)? })
}
