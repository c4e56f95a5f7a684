//! What all figures share: font, colours, axes, legend, thinning.
//!
//! Figures are drawn four times larger than shown, because the SVG backend rounds to whole units; `viewBox` scales them
//! back. Sizes in this module and its users are CSS pixels, [`px`] turns them into drawing units.

use std::io;
use std::sync::OnceLock;

use plotters::chart::ChartContext;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::{
    Cartesian2d, ChartBuilder, Circle, IntoDrawingArea, PathElement, Polygon, RGBAColor, RGBColor, Rectangle,
    SVGBackend, ShapeStyle,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, TextStyle, register_font};

use super::axis::{Axis, drawable};
use super::layout::{heading_left, is_narrow};
pub(in crate::report) use super::layout::{left, width};
pub(in crate::report) use super::readout::Area;
use super::shrink::shrunk;
use crate::report::ReportError;
use crate::report::number::significant;
use crate::report::rows::shorten;

/// Room outside of a chart's labels \[px\].
const EDGE: f64 = 12.0;
/// Drawing units in a CSS pixel.
const SCALE: f64 = 4.0;
/// Font of all figures; also the `font-family` of the SVG, so the fallbacks stand in the name.
pub(super) const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";
/// plotters writes a font of size `s` as `s / 1.24` pixels.
const FONT_SIZE_IN_SVG: f64 = 1.24;
pub(crate) const FONT_REGULAR: &[u8] = include_bytes!("../../../assets/dejavu-sans.ttf");
pub(crate) const FONT_BOLD: &[u8] = include_bytes!("../../../assets/dejavu-sans-bold.ttf");

/// Okabe and Ito's colour-blind-safe palette (2008), the part in use.
pub(in crate::report) const SIMPLE: RGBColor = RGBColor(230, 159, 0);
pub(in crate::report) const EXTENSIVE: RGBColor = RGBColor(0, 114, 178);
/// What is asked; [`DASHED`], so that it hides nothing of what is done.
pub(in crate::report) const SETPOINT: RGBColor = RGBColor(0, 0, 0);
pub(in crate::report) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(in crate::report) const POSITIVE: RGBColor = RGBColor(213, 94, 0);
pub(in crate::report) const MEASURED: RGBColor = RGBColor(90, 90, 90);
pub(in crate::report) const INK: RGBColor = RGBColor(34, 34, 34);
pub(in crate::report) const BAND: RGBColor = RGBColor(204, 121, 167);
pub(in crate::report) const SHADE: RGBColor = RGBColor(150, 150, 150);
pub(in crate::report) const GRID: RGBColor = RGBColor(224, 224, 224);
/// Opacity of a 95 % band under its curve.
pub(in crate::report) const BAND_OPACITY: f64 = 0.22;

/// A gap as given, recalibrated, with the answer's effects.
pub(in crate::report) const BEFORE: RGBColor = SIMPLE;
pub(in crate::report) const CALIBRATED: RGBColor = RGBColor(86, 180, 233);
pub(in crate::report) const AFTER: RGBColor = EXTENSIVE;

/// Lines of these colours are dashed: what lies under them is seen.
pub(super) const DASHED: [RGBColor; 2] = [SETPOINT, GREEN];

/// Models in the order of the report: simple, extensive.
pub(in crate::report) const MODEL_COLOURS: [RGBColor; 2] = [SIMPLE, EXTENSIVE];

/// Right margin that every chart keeps \[px\].
pub(in crate::report) const RIGHT: f64 = 24.0;
/// Where a legend of two rows ends \[px\].
pub(in crate::report) const LEGEND_END: f64 = 79.0;
/// Middle of a legend's first row, and the height of a row \[px\].
const LEGEND_TOP: f64 = 44.0;
const LEGEND_ROW: f64 = 19.0;
/// Points that one series of a figure may have.
pub(in crate::report) const MOST_POINTS: usize = 2000;

pub(in crate::report) type DrawError = DrawingAreaErrorKind<io::Error>;
pub(in crate::report) type Drawn = Result<(), DrawError>;
pub(in crate::report) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// CSS pixels in drawing units.
pub(in crate::report) fn px(pixels: f64) -> i32 {
    (pixels * SCALE).round() as i32
}

/// Draws one figure: white ground, title, then whatever `draw` adds below it.
pub(in crate::report) fn sketch(
    title: &str,
    height: f64,
    draw: impl FnOnce(&Area<'_>) -> Drawn,
) -> Result<String, ReportError> {
    register_fonts()?;
    let failed = |cause: DrawError| ReportError::Draw { figure: title.to_owned(), cause: cause.to_string() };
    let mut svg = String::new();
    let told = {
        let ground = SVGBackend::with_string(&mut svg, (px(width()) as u32, px(height) as u32)).into_drawing_area();
        let root = Area::new(ground);
        root.fill(&RGBColor(255, 255, 255)).map_err(failed)?;
        let size = if is_narrow() { 13.0 } else { 15.0 };
        text(&root, (heading_left(), 20.0), title, Look { size, bold: true, ..Look::default() }).map_err(failed)?;
        draw(&root).map_err(failed)?;
        root.present().map_err(failed)?;
        root.told()
    };
    Ok(shrunk(&svg, (title, height), told))
}

fn register_fonts() -> Result<(), ReportError> {
    static FONTS: OnceLock<Result<(), &'static str>> = OnceLock::new();
    let register = |style, bytes, name| register_font(FAMILY, style, bytes).map_err(|_| name);
    FONTS
        .get_or_init(|| {
            register(FontStyle::Normal, FONT_REGULAR, "dejavu-sans.ttf")?;
            register(FontStyle::Bold, FONT_BOLD, "dejavu-sans-bold.ttf")
        })
        .map_err(|name| ReportError::Font { name })
}

/// How a text looks and which of its points is placed.
#[derive(Clone, Copy)]
pub(in crate::report) struct Look {
    pub size: f64,
    pub colour: RGBColor,
    pub bold: bool,
    pub anchor: HPos,
    /// Reads from bottom to top.
    pub upward: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self { size: 12.0, colour: INK, bold: false, anchor: HPos::Left, upward: false }
    }
}

impl Look {
    fn style(self) -> TextStyle<'static> {
        let weight = if self.bold { FontStyle::Bold } else { FontStyle::Normal };
        let font = FontDesc::new(FontFamily::Name(FAMILY), self.size * SCALE * FONT_SIZE_IN_SVG, weight);
        let font = if self.upward { font.transform(FontTransform::Rotate270) } else { font };
        TextStyle { font, color: self.colour.to_backend_color(), pos: Pos::new(self.anchor, VPos::Center) }
    }

    /// Width of a text \[px\]; 0 where the font cannot tell.
    pub(in crate::report) fn width(self, words: &str) -> f64 {
        // A figure may want to know before it is begun; a damaged font shows when it is drawn.
        let _ = register_fonts();
        if register_fonts().is_err() {
            return 0.0;
        }
        let upright = Self { upward: false, ..self };
        upright.style().font.box_size(words).map_or(0.0, |(width, _)| f64::from(width) / SCALE)
    }

    /// Shortens a text in the middle until it fits.
    pub(in crate::report) fn fit(self, words: &str, room: f64) -> String {
        let mut most = words.chars().count();
        let mut fitted = words.to_owned();
        while most > 1 && self.width(&fitted) > room {
            most = (most * 19 / 20).min(most - 1);
            fitted = shorten(words, most);
        }
        fitted
    }
}

/// Writes a text at a point \[px\], vertically centred; characters that XML forbids are replaced.
pub(in crate::report) fn text(area: &Area<'_>, (x, y): (f64, f64), words: &str, look: Look) -> Drawn {
    let forbidden = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    let clean: String = words.chars().map(|c| if forbidden(c) { '\u{fffd}' } else { c }).collect();
    let room = match look.anchor {
        _ if look.upward => f64::INFINITY,
        HPos::Left => width() - x - 2.0,
        HPos::Center => 2.0 * x.min(width() - x) - 4.0,
        HPos::Right => x - 2.0,
    };
    area.draw_text(&look.fit(&clean, room), &look.style(), (px(x), px(y)))
}

/// Says what the script tells of a box given by its upper left corner and its size \[px\].
pub(in crate::report) fn spot(area: &Area<'_>, [x, y]: [f64; 2], [across, down]: [f64; 2], words: &str) {
    area.has_spot([px(x), px(y), px(x + across), px(y + down)], words);
}

/// Words in the middle of an area that has nothing to draw.
pub(in crate::report) fn notice(area: &Area<'_>, words: &str) -> Drawn {
    let (width, height) = area.dim_in_pixel();
    let middle = (f64::from(width) / SCALE / 2.0, f64::from(height) / SCALE / 2.0);
    let look = Look { colour: MEASURED, anchor: HPos::Center, ..Look::default() };
    area.draw_text(words, &look.style(), (px(middle.0), px(middle.1)))
}

pub(in crate::report) fn stroke(colour: impl Color, width: f64) -> ShapeStyle {
    ShapeStyle { color: colour.to_rgba(), filled: false, stroke_width: px(width) as u32 }
}

pub(in crate::report) fn filled(colour: impl Color, opacity: f64) -> ShapeStyle {
    colour.mix(opacity).filled()
}

/// Axes of a chart in the given box \[px\]: top, bottom; without an `x_label` the x ticks stay unnamed.
pub(in crate::report) fn chart<'a, 'b>(
    root: &'a Area<'b>,
    (top, bottom): (f64, f64),
    (x, y): (&Axis, &Axis),
    (x_label, y_label): (&str, &str),
) -> Result<Chart<'a, 'b>, DrawError> {
    let mut builder = ChartBuilder::on(root);
    let (_, height) = root.dim_in_pixel();
    let bottom_room = if x_label.is_empty() { 6.0 } else { 42.0 };
    builder
        .margin_top(px(top))
        .margin_bottom(height as i32 - px(bottom))
        .margin_left(px(EDGE))
        .margin_right(px(RIGHT))
        .y_label_area_size(px(left() - EDGE))
        .x_label_area_size(px(bottom_room));
    let mut chart = builder.build_cartesian_2d(x.clone(), y.clone())?;
    let named = !x_label.is_empty();
    chart
        .configure_mesh()
        .light_line_style(RGBColor(255, 255, 255).mix(0.0))
        .bold_line_style(stroke(GRID, 0.5))
        .axis_style(stroke(INK, 0.75))
        .set_all_tick_mark_size(px(3.0))
        .label_style(Look { size: 11.0, ..Look::default() }.style())
        .axis_desc_style(Look::default().style())
        .x_label_formatter(&|at| if named { x.label(*at) } else { String::new() })
        .x_desc(x_label)
        .y_desc(y_label)
        .draw()?;
    let (across, down) = chart.plotting_area().get_pixel_range();
    root.has_panel([across.start, down.start, across.end, down.end], (x, y), (x_label, y_label));
    Ok(chart)
}

/// A line through the points; what cannot be drawn leaves a gap.
pub(in crate::report) fn line(chart: &mut Chart<'_, '_>, points: &[(f64, f64)], style: ShapeStyle) -> Drawn {
    let pieces = points.split(|(x, y)| !drawable(*x) || !drawable(*y)).filter(|piece| piece.len() > 1);
    chart.draw_series(pieces.map(|piece| PathElement::new(piece, style)))?;
    Ok(())
}

/// A dashed level line.
pub(in crate::report) fn dashed(
    chart: &mut Chart<'_, '_>,
    (from, to): (f64, f64),
    level: f64,
    style: ShapeStyle,
) -> Drawn {
    const DASHES: usize = 60;
    for k in (0..DASHES).step_by(2) {
        let at = |k: usize| from + (to - from) * k as f64 / DASHES as f64;
        line(chart, &[(at(k), level), (at(k + 1), level)], style)?;
    }
    Ok(())
}

/// Filled dots; what cannot be drawn is left out.
pub(in crate::report) fn dots(
    chart: &mut Chart<'_, '_>,
    points: &[(f64, f64)],
    radius: f64,
    style: ShapeStyle,
) -> Drawn {
    let seen = points.iter().filter(|(x, y)| drawable(*x) && drawable(*y));
    chart.draw_series(seen.map(|point| Circle::new(*point, px(radius), style)))?;
    Ok(())
}

/// The area between two curves over `x`, given as `(x, low, high)`.
pub(in crate::report) fn band(chart: &mut Chart<'_, '_>, points: &[(f64, f64, f64)], style: ShapeStyle) -> Drawn {
    let hole = |(x, low, high): &(f64, f64, f64)| !drawable(*x) || !drawable(*low) || !drawable(*high);
    for piece in points.split(hole).filter(|piece| piece.len() > 1) {
        let there = piece.iter().map(|(x, low, _)| (*x, *low));
        let back = piece.iter().rev().map(|(x, _, high)| (*x, *high));
        chart.draw_series([Polygon::new(there.chain(back).collect::<Vec<_>>(), style)])?;
    }
    Ok(())
}

/// Name of a 95 % band in a legend: one that is hidden by its line is told in numbers.
pub(in crate::report) fn band_name(points: &[(f64, f64, f64)], axis: &Axis, height: f64, unit: &str) -> String {
    let mut halves: Vec<f64> =
        points.iter().map(|(_, low, high)| 0.5 * (high - low)).filter(|h| drawable(*h)).collect();
    halves.sort_by(f64::total_cmp);
    let Some(middle) = halves.get(halves.len() / 2) else { return BAND_NAME.to_owned() };
    if 2.0 * middle / (axis.high() - axis.low()) * height > SEEN {
        return BAND_NAME.to_owned();
    }
    format!("{BAND_NAME}: ±{} {unit}, hidden by the line", significant(*middle, 2))
}

const BAND_NAME: &str = "95 % band";
/// Width from which on a band is seen beside its line \[px\].
const SEEN: f64 = 4.0;

/// A rectangle in the chart's coordinates, given by two opposite corners.
pub(in crate::report) fn block(chart: &mut Chart<'_, '_>, corners: [(f64, f64); 2], style: ShapeStyle) -> Drawn {
    chart.draw_series([Rectangle::new(corners, style)])?;
    Ok(())
}

/// Sign of a legend entry.
#[derive(Clone, Copy)]
pub(in crate::report) enum Sign {
    Dot,
    Line,
    Box,
    Diamond,
}

/// The mark of a nominal value around a point \[px\].
pub(in crate::report) fn diamond((x, y): (f64, f64), style: ShapeStyle) -> Polygon<(i32, i32)> {
    let corners = [(x - 5.0, y), (x, y - 7.0), (x + 5.0, y), (x, y + 7.0)];
    Polygon::new(corners.map(|(x, y)| (px(x), px(y))), style)
}

/// One entry of a legend: sign, colour, words.
pub(in crate::report) type LegendEntry = (Sign, RGBAColor, String);

/// Places of a legend's entries \[px\], with their words as they fit.
fn legend_places(names: &[LegendEntry]) -> Vec<([f64; 2], String)> {
    let look = Look::default();
    let begin = heading_left();
    let (mut x, mut y) = (begin, LEGEND_TOP);
    let mut places = Vec::with_capacity(names.len());
    for (_, _, words) in names {
        let words = look.fit(words, width() - begin - RIGHT - 26.0);
        let room = 26.0 + look.width(&words);
        if x > begin && x + room > width() - RIGHT {
            (x, y) = (begin, y + LEGEND_ROW);
        }
        places.push(([x, y], words));
        x += room + 22.0;
    }
    places
}

/// Where a legend will end \[px\].
pub(in crate::report) fn legend_end(names: &[LegendEntry]) -> f64 {
    legend_places(names).last().map_or(LEGEND_TOP, |([_, y], _)| *y) + 16.0
}

/// Legend in rows under the title; returns where it ends \[px\].
pub(in crate::report) fn legend(root: &Area<'_>, names: &[LegendEntry]) -> Result<f64, DrawError> {
    for ((sign, colour, name), ([x, y], words)) in names.iter().zip(legend_places(names)) {
        if matches!(sign, Sign::Dot | Sign::Line) {
            root.has_name(*colour, name);
        }
        match sign {
            Sign::Dot => root.draw(&Circle::new((px(x + 10.0), px(y)), px(2.5), colour.filled()))?,
            Sign::Line => {
                let ends = [(px(x), px(y)), (px(x + 20.0), px(y))];
                root.draw(&PathElement::new(ends, stroke(*colour, 2.0)))?;
            }
            Sign::Diamond => root.draw(&diamond((x + 10.0, y), colour.filled()))?,
            Sign::Box => {
                let corners = [(px(x), px(y - 5.0)), (px(x + 20.0), px(y + 5.0))];
                root.draw(&Rectangle::new(corners, colour.filled()))?;
            }
        }
        text(root, (x + 26.0, y), &words, Look::default())?;
    }
    Ok(legend_end(names))
}

/// Which samples of a column to draw so that no peak is lost: of each bucket the lowest and the highest, one that is not
/// a number where there is one, so that gaps stay gaps, and a few evenly spaced ones, because extremes alone would draw
/// noise as two curves. In order, at most `limit`.
fn thin_to(column: &[f64], limit: usize) -> Vec<usize> {
    const EVEN: usize = 5;
    let (length, buckets) = (column.len(), limit / (EVEN + 3));
    if length <= limit || buckets == 0 {
        return (0..length.min(limit)).collect();
    }
    let mut kept = Vec::with_capacity(limit);
    for bucket in 0..buckets {
        let samples = bucket * length / buckets..(bucket + 1) * length / buckets;
        let finite = || samples.clone().filter(|i| drawable(column[*i]));
        kept.extend(samples.clone().find(|i| !drawable(column[*i])));
        kept.extend(finite().min_by(|a, b| column[*a].total_cmp(&column[*b])));
        kept.extend(finite().max_by(|a, b| column[*a].total_cmp(&column[*b])));
        kept.extend((0..EVEN).map(|k| samples.start + k * samples.len() / EVEN));
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// Which samples of a column to draw, at most [`MOST_POINTS`].
pub(in crate::report) fn thin(column: &[f64]) -> Vec<usize> {
    thin_to(column, MOST_POINTS)
}

/// A thinned curve over `x`.
pub(in crate::report) fn thinned(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    let length = x.len().min(y.len());
    thin(&y[..length]).into_iter().map(|i| (x[i], y[i])).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn thinning_keeps_peaks_and_gaps() {
        let mut column: Vec<f64> = (0..10_000).map(|i| f64::from(i).sin()).collect();
        column[4321] = 9.0;
        column[7000] = f64::NAN;
        let kept = thin(&column);
        assert!(kept.len() <= MOST_POINTS && kept.contains(&4321) && kept.contains(&7000));
    }

    #[test]
    fn long_titles_fit_the_figure() {
        register_fonts().expect("the bundled font is sound");
        let look = Look { size: 15.0, bold: true, ..Look::default() };
        let fitted = look.fit(&"a-long-name-".repeat(40), 500.0);
        assert!(look.width(&fitted) <= 500.0 && look.width(&fitted) > 400.0, "{fitted}");
    }

    proptest! {
        #[test]
        fn thinning_is_in_order_and_within_its_limit(values in prop::collection::vec(prop::num::f64::ANY, 0..300)) {
            let kept = thin_to(&values, 50);
            prop_assert!(kept.len() <= 50 && kept.is_sorted());
        }
    }
}
