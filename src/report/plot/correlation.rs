//! Which fitted parameters move together.

use plotters::prelude::Rectangle;
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use super::canvas::{
    Area, Drawn, EXTENSIVE, INK, LEFT, Look, POSITIVE, RIGHT, SHADE, WIDTH, filled, notice, px, sketch, stroke, text,
};
use crate::report::{Correlation, ReportError};

/// Room for names left of the cells and under them \[px\].
const NAME_ROOM: f64 = 150.0;
const TOP: f64 = 52.0;

/// Draws the correlation matrix of the extensive model's fitted parameters, -1 blue, 0 white, 1 vermillion.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn correlation_matrix(joint: &str, correlation: &Correlation) -> Result<String, ReportError> {
    let names = &correlation.names;
    let count = names.len();
    let left = LEFT + NAME_ROOM;
    let cell = ((WIDTH - left - RIGHT - 90.0) / count.max(1) as f64).clamp(4.0, 62.0);
    let side = cell * count as f64;
    let size = (cell * 0.28).clamp(3.0, 13.0);
    let look = Look { size: size.max(5.0), ..Look::default() };
    let longest = names.iter().map(|name| look.width(name)).fold(0.0, f64::max).min(NAME_ROOM - 16.0);
    let height = TOP + side.max(120.0) + longest + 24.0;

    sketch(&format!("{joint} correlation of the fitted parameters, extensive model"), height, |root| {
        if names.is_empty() {
            return notice(root, "no fitted parameters, so nothing to correlate");
        }
        for (row, name) in names.iter().enumerate() {
            let middle = (row as f64 + 0.5) * cell;
            let right = Look { anchor: HPos::Right, ..look };
            text(root, (left - 8.0, TOP + middle), &right.fit(name, left - 20.0), right)?;
            let upward = Look { anchor: HPos::Right, upward: true, ..look };
            text(root, (left + middle, TOP + side + 8.0), &upward.fit(name, NAME_ROOM - 16.0), upward)?;
            for column in 0..count {
                let value = correlation.matrix.get(row).and_then(|row| row.get(column)).copied();
                let corner = (left + column as f64 * cell, TOP + row as f64 * cell);
                draw_cell(root, corner, cell, value.filter(|value| value.is_finite()), size)?;
            }
        }
        scale(root, left + side + 30.0, side.max(120.0))
    })
}

fn draw_cell(root: &Area<'_>, (x, y): (f64, f64), cell: f64, value: Option<f64>, size: f64) -> Drawn {
    let ground = value.map_or(RGBColor(235, 235, 235), colour);
    let corners = [(px(x + 0.5), px(y + 0.5)), (px(x + cell - 0.5), px(y + cell - 0.5))];
    root.draw(&Rectangle::new(corners, filled(ground, 1.0)))?;
    let words = value.map_or("–".to_owned(), |value| format!("{value:+.2}").replace('-', "\u{2212}"));
    let ink = if value.is_some_and(|value| value.abs() > 0.75) { RGBColor(255, 255, 255) } else { INK };
    let look = Look { size, colour: ink, anchor: HPos::Center, ..Look::default() };
    text(root, (x + cell / 2.0, y + cell / 2.0), &words, look)
}

/// The colour scale with its ends and middle.
fn scale(root: &Area<'_>, x: f64, height: f64) -> Drawn {
    const STEPS: usize = 40;
    let step = height / STEPS as f64;
    for i in 0..STEPS {
        let value = 1.0 - 2.0 * (i as f64 + 0.5) / STEPS as f64;
        let corners = [(px(x), px(TOP + i as f64 * step)), (px(x + 14.0), px(TOP + (i + 1) as f64 * step))];
        root.draw(&Rectangle::new(corners, filled(colour(value), 1.0)))?;
    }
    let frame = [(px(x), px(TOP)), (px(x + 14.0), px(TOP + height))];
    root.draw(&Rectangle::new(frame, stroke(SHADE, 0.5)))?;
    for (share, words) in [(0.0, "+1"), (0.5, "0"), (1.0, "\u{2212}1")] {
        text(root, (x + 20.0, TOP + share * height), words, Look { size: 11.0, ..Look::default() })?;
    }
    Ok(())
}

/// White at 0, full colour at -1 and 1.
fn colour(value: f64) -> RGBColor {
    let RGBColor(red, green, blue) = if value < 0.0 { EXTENSIVE } else { POSITIVE };
    let share = value.abs().min(1.0);
    let mix = |full: u8| (255.0 + share * (f64::from(full) - 255.0)).round() as u8;
    RGBColor(mix(red), mix(green), mix(blue))
}
