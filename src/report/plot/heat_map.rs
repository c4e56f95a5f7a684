//! What was there against what was answered.

use plotters::prelude::Rectangle;
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use super::canvas::{
    Area, Drawn, EXTENSIVE, INK, LEFT, Look, MEASURED, POSITIVE, RIGHT, WIDTH, filled, notice, px, sketch, stroke, text,
};
use crate::report::ReportError;

/// Room for names left of the cells and under them \[px\].
const NAME_ROOM: f64 = 150.0;
const TOP: f64 = 78.0;

/// Draws a table of counts; a cell's colour is its share of its row: right answers blue, wrong ones vermillion.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn heat_map(
    title: &str,
    (rows, columns): (&[&str], &[&str]),
    counts: &[Vec<u32>],
    is_right: impl Fn(&str, &str) -> bool,
) -> Result<String, ReportError> {
    let left = LEFT + NAME_ROOM;
    let cell = ((WIDTH - left - RIGHT - 60.0) / columns.len().max(1) as f64).clamp(8.0, 46.0);
    let size = (cell * 0.36).clamp(5.0, 13.0);
    let look = Look { size: size.clamp(9.0, 12.0), ..Look::default() };
    // by the mean width of a letter: no font is at hand before the figure is begun
    let letters = columns.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    let longest = (0.62 * look.size * letters as f64).min(NAME_ROOM);
    let height = TOP + cell * rows.len().max(2) as f64 + longest + 30.0;

    sketch(title, height, |root| {
        if rows.is_empty() || columns.is_empty() {
            return notice(root, "nothing was answered");
        }
        let heading = Look { size: 11.0, colour: MEASURED, ..Look::default() };
        text(root, (left, TOP - 28.0), "columns: what was answered; colour: share of the row", heading)?;
        text(root, (left, TOP - 12.0), "rows: what was there, with the number of studies on the right", heading)?;
        for (column, name) in columns.iter().enumerate() {
            let at = (left + (column as f64 + 0.5) * cell, TOP + rows.len() as f64 * cell + 8.0);
            let upward = Look { anchor: HPos::Right, upward: true, ..look };
            text(root, at, &upward.fit(name, NAME_ROOM), upward)?;
        }
        for (row, (name, counts)) in rows.iter().zip(counts).enumerate() {
            let y = TOP + row as f64 * cell;
            let right = Look { anchor: HPos::Right, ..look };
            text(root, (left - 8.0, y + cell / 2.0), &right.fit(name, left - 20.0), right)?;
            let total: u32 = counts.iter().sum();
            for (column, (answer, count)) in columns.iter().zip(counts).enumerate() {
                let share = f64::from(*count) / f64::from(total.max(1));
                let is_right = is_right(name, answer);
                let corner = (left + column as f64 * cell, y);
                draw_cell(root, corner, cell, Cell { count: *count, share, is_right, size })?;
            }
            let beside = Look { colour: MEASURED, ..look };
            text(root, (left + columns.len() as f64 * cell + 8.0, y + cell / 2.0), &total.to_string(), beside)?;
        }
        Ok(())
    })
}

struct Cell {
    count: u32,
    share: f64,
    is_right: bool,
    size: f64,
}

fn draw_cell(root: &Area<'_>, (x, y): (f64, f64), side: f64, cell: Cell) -> Drawn {
    let corners = [(px(x + 0.5), px(y + 0.5)), (px(x + side - 0.5), px(y + side - 0.5))];
    root.draw(&Rectangle::new(corners, filled(colour(cell.share, cell.is_right), 1.0)))?;
    if cell.is_right {
        root.draw(&Rectangle::new(corners, stroke(EXTENSIVE, 1.0)))?;
    }
    if cell.count == 0 {
        return Ok(());
    }
    let ink = if cell.share > 0.6 { RGBColor(255, 255, 255) } else { INK };
    let look = Look { size: cell.size, colour: ink, anchor: HPos::Center, ..Look::default() };
    text(root, (x + side / 2.0, y + side / 2.0), &cell.count.to_string(), look)
}

/// Nearly white for none of a row, full colour for all of it; a little is seen already.
fn colour(share: f64, is_right: bool) -> RGBColor {
    if share == 0.0 {
        return RGBColor(245, 245, 245);
    }
    let RGBColor(red, green, blue) = if is_right { EXTENSIVE } else { POSITIVE };
    let strength = 0.15 + 0.85 * share.min(1.0);
    let mix = |full: u8| (255.0 + strength * (f64::from(full) - 255.0)).round() as u8;
    RGBColor(mix(red), mix(green), mix(blue))
}
