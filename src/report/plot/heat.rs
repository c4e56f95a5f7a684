//! Coloured cells in rows and columns, with their scale.

use plotters::prelude::{PathElement, Rectangle};
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use super::canvas::{
    Area, Drawn, INK, Look, RIGHT, SHADE, filled, left, notice, px, sketch, spot, stroke, text, width as figure_width,
};
use super::layout::is_narrow;
use crate::report::ReportError;

/// Where the cells begin, without names above them [px].
const TOP: f64 = 52.0;
/// Longest scale [px].
const SCALE_HEIGHT: f64 = 300.0;
/// Smallest text that can be read [px].
const LEAST_TEXT: f64 = 10.0;
/// Ground of a cell without a value.
pub(in crate::report) const NO_VALUE: RGBColor = RGBColor(240, 240, 240);
/// Ground of an answer that was never given, light enough for the others to stand out.
pub(in crate::report) const UNUSED: RGBColor = RGBColor(247, 247, 247);

/// Rows and columns of a map, and how its cells look.
pub(in crate::report) struct Heat<'a> {
    pub title: &'a str,
    pub rows: &'a [String],
    pub columns: &'a [String],
    /// Room for the names of the rows [px].
    pub name_room: f64,
    /// Width and height of a cell at the most [px].
    pub cell: [f64; 2],
    /// Names of the columns stand upright above the cells, not turned below them.
    pub names_above: bool,
    /// What rows and columns are; both empty where their names say it.
    pub axes: [&'a str; 2],
    /// Colour of a value, for the scale.
    pub colour: fn(f64) -> RGBColor,
    /// Values of the scale from top to bottom, with their words.
    pub scale: &'a [(f64, &'a str)],
    /// Said where there are no cells.
    pub nothing: &'a str,
}

/// What stands in a cell.
pub(in crate::report) struct HeatCell {
    pub ground: RGBColor,
    pub words: String,
    /// Set off by a frame and bold words.
    pub framed: bool,
}

/// Draws a map whose cells are given by row and column.
pub(in crate::report) fn heat(
    map: &Heat<'_>,
    cell_at: impl Fn(usize, usize) -> HeatCell,
) -> Result<String, ReportError> {
    let (rows, columns) = (map.rows.len(), map.columns.len());
    let look = Look { size: 13.0, ..Look::default() };
    let longest_row = map.rows.iter().map(|name| look.width(name)).fold(0.0, f64::max);
    // A narrow figure has no room for a scale beside the cells, which say their numbers.
    let (left, scale_room) = match is_narrow() {
        true => ((longest_row + 26.0).min((figure_width() - RIGHT - 36.0 * columns as f64).clamp(130.0, 230.0)), 0.0),
        false => (left() + map.name_room, 90.0),
    };
    let width = ((figure_width() - left - RIGHT - scale_room) / columns.max(1) as f64).clamp(4.0, map.cell[0]);
    let height = if map.names_above { map.cell[1] } else { width.min(map.cell[1]) };
    let small = Look { size: LEAST_TEXT, ..look };
    // Names that a narrow figure has no room for above its cells stand upright below them.
    let names_above =
        map.names_above && !(is_narrow() && map.columns.iter().any(|name| small.width(name) > width - 4.0));
    let (across, down) = (width * columns as f64, height * rows as f64);
    let size = (width.min(2.2 * height) * 0.28).clamp(LEAST_TEXT, 13.0);
    let look =
        Look { size: (0.45 * width.min(height)).clamp(if height < 12.0 { 4.0 } else { LEAST_TEXT }, 13.0), ..look };
    let top = TOP + if names_above { 22.0 } else { 0.0 } + if map.axes[0].is_empty() { 0.0 } else { 20.0 };
    let fits = |name: &String| look.width(name) <= width - 4.0;
    let heads = if names_above && !map.columns.iter().all(fits) { small } else { look };
    let longest = map.columns.iter().map(|name| look.width(name)).fold(0.0, f64::max).min(map.name_room - 16.0);
    let below = if names_above { 12.0 } else { longest + 24.0 };
    let scale_height = if is_narrow() { 0.0 } else { down.clamp(120.0, SCALE_HEIGHT) };

    sketch(map.title, top + down.max(scale_height) + below, |root| {
        if rows == 0 || columns == 0 {
            return notice(root, map.nothing);
        }
        let axis = Look { colour: SHADE_INK, ..Look::default() };
        if !map.axes[0].is_empty() {
            let right = Look { anchor: HPos::Right, ..axis };
            text(root, (left - 8.0, top - 12.0), map.axes[0], right)?;
            text(root, (left, top - 12.0), map.axes[1], axis)?;
        }
        for (column, name) in map.columns.iter().enumerate() {
            let middle = left + (column as f64 + 0.5) * width;
            if names_above {
                let centred = Look { anchor: HPos::Center, ..heads };
                text(root, (middle, top - 12.0), &centred.fit(name, width - 4.0), centred)?;
            } else {
                let upward = Look { anchor: HPos::Right, upward: true, ..look };
                text(root, (middle, top + down + 8.0), &upward.fit(name, map.name_room - 16.0), upward)?;
            }
        }
        for (row, name) in map.rows.iter().enumerate() {
            let right = Look { anchor: HPos::Right, ..look };
            text(root, (left - 8.0, top + (row as f64 + 0.5) * height), &right.fit(name, left - 20.0), right)?;
            for column in 0..columns {
                let corner = [left + column as f64 * width, top + row as f64 * height];
                let cell = cell_at(row, column);
                draw_cell(root, corner, [width, height], &cell, size)?;
                if !cell.words.is_empty() {
                    let said = format!("{name}, {}: {}", map.columns[column], cell.words);
                    spot(root, corner, [width, height], &said);
                }
            }
        }
        match is_narrow() {
            true => Ok(()),
            false => scale(root, map, [left + across + 30.0, top], scale_height),
        }
    })
}

const SHADE_INK: RGBColor = RGBColor(90, 90, 90);

/// Draws one cell from its upper left corner; `size` is that of its words.
pub(in crate::report) fn draw_cell(
    root: &Area<'_>,
    [x, y]: [f64; 2],
    [width, height]: [f64; 2],
    cell: &HeatCell,
    size: f64,
) -> Drawn {
    let corners = |inset: f64| [(px(x + inset), px(y + inset)), (px(x + width - inset), px(y + height - inset))];
    root.draw(&Rectangle::new(corners(0.5), filled(cell.ground, 1.0)))?;
    if cell.framed {
        let [(left, top), (right, bottom)] = corners(1.5);
        // A rectangle's edge would be a hair line whatever its style says.
        let edge = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top), (right, top)];
        root.draw(&PathElement::new(edge, stroke(INK, 2.0)))?;
    }
    if cell.words.is_empty() {
        return Ok(());
    }
    let look = Look { size, bold: cell.framed, ..Look::default() };
    if look.width(&cell.words) > width - 2.0 || size > height {
        return Ok(());
    }
    let colour = if is_dark(cell.ground) { RGBColor(255, 255, 255) } else { INK };
    let look = Look { colour, anchor: HPos::Center, ..look };
    text(root, (x + width / 2.0, y + height / 2.0), &cell.words, look)
}

/// Whether white words are easier to read on a colour than black ones.
fn is_dark(RGBColor(red, green, blue): RGBColor) -> bool {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue) < 140.0
}

/// The colour scale with the words of its values.
fn scale(root: &Area<'_>, map: &Heat<'_>, [x, top]: [f64; 2], height: f64) -> Drawn {
    const STEPS: usize = 40;
    let (Some(&(high, _)), Some(&(low, _))) = (map.scale.first(), map.scale.last()) else { return Ok(()) };
    let step = height / STEPS as f64;
    for i in 0..STEPS {
        let value = high - (high - low) * (i as f64 + 0.5) / STEPS as f64;
        let corners = [(px(x), px(top + i as f64 * step)), (px(x + 14.0), px(top + (i + 1) as f64 * step))];
        root.draw(&Rectangle::new(corners, filled((map.colour)(value), 1.0)))?;
    }
    let frame = [(px(x), px(top)), (px(x + 14.0), px(top + height))];
    root.draw(&Rectangle::new(frame, stroke(SHADE, 0.5)))?;
    for (value, words) in map.scale {
        let at = top + (high - value) / (high - low) * height;
        text(root, (x + 20.0, at), words, Look { size: 11.0, ..Look::default() })?;
    }
    Ok(())
}

/// A colour that is white at a share of 0 and full at 1.
pub(in crate::report) fn tint(RGBColor(red, green, blue): RGBColor, share: f64) -> RGBColor {
    let mix = |full: u8| (255.0 + share.clamp(0.0, 1.0) * (f64::from(full) - 255.0)).round() as u8;
    RGBColor(mix(red), mix(green), mix(blue))
}
