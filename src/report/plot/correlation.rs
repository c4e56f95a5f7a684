//! Which fitted parameters move together.

use plotters::style::RGBColor;

use super::canvas::{EXTENSIVE, POSITIVE};
use super::heat::{Heat, HeatCell, NO_VALUE, heat, tint};
use crate::report::{Correlation, ReportError};

/// Draws the correlation matrix of the extensive model's fitted parameters, -1 blue, 0 white, 1 vermillion.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn correlation_matrix(joint: &str, correlation: &Correlation) -> Result<String, ReportError> {
    let map = Heat {
        title: &format!("{joint} correlation of the fitted parameters, extensive model"),
        rows: &correlation.names,
        columns: &correlation.names,
        name_room: 150.0,
        cell: [62.0, 62.0],
        names_above: false,
        axes: ["", ""],
        colour,
        scale: &[(1.0, "+1"), (0.0, "0"), (-1.0, "\u{2212}1")],
        nothing: "no fitted parameters, so nothing to correlate",
    };
    heat(&map, |row, column| {
        let value = correlation.matrix.get(row).and_then(|row| row.get(column)).copied().filter(|v| v.is_finite());
        let words = value.map_or("–".to_owned(), signed);
        HeatCell { ground: value.map_or(NO_VALUE, colour), words, framed: false }
    })
}

/// With its sign, where it is not next to nothing.
fn signed(value: f64) -> String {
    if value.abs() < 0.005 { "0".to_owned() } else { format!("{value:+.2}").replace('-', "\u{2212}") }
}

/// White at 0, full colour at -1 and 1.
fn colour(value: f64) -> RGBColor {
    tint(if value < 0.0 { EXTENSIVE } else { POSITIVE }, value.abs())
}
