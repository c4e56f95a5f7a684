//! What all figures share: font, colours, axes, legend, thinning.
//!
//! Figures are drawn four times larger than shown, because the SVG backend rounds to whole units; `viewBox` scales them
//! back. Sizes in this module and its users are CSS pixels, [`px`] turns them into drawing units.

use std::io;
use std::ops::Range;
use std::sync::OnceLock;

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::{
    Cartesian2d, ChartBuilder, Circle, DrawingArea, IntoDrawingArea, PathElement, Polygon, RGBAColor, RGBColor,
    Rectangle, SVGBackend, ShapeStyle,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, TextStyle, register_font};

use crate::report::ReportError;
use crate::report::rows::shorten;

/// Drawing units in a CSS pixel.
const SCALE: f64 = 4.0;
/// Font of all figures; also the `font-family` of the SVG, so the fallbacks stand in the name.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";
/// plotters writes a font of size `s` as `s / 1.24` pixels.
const FONT_SIZE_IN_SVG: f64 = 1.24;
pub(crate) const FONT_REGULAR: &[u8] = include_bytes!("../../../assets/dejavu-sans.ttf");
pub(crate) const FONT_BOLD: &[u8] = include_bytes!("../../../assets/dejavu-sans-bold.ttf");

/// Okabe and Ito's colour-blind-safe palette (2008), the part in use.
pub(super) const SIMPLE: RGBColor = RGBColor(230, 159, 0);
pub(super) const EXTENSIVE: RGBColor = RGBColor(0, 114, 178);
pub(super) const SETPOINT: RGBColor = RGBColor(0, 158, 115);
pub(super) const POSITIVE: RGBColor = RGBColor(213, 94, 0);
pub(super) const MEASURED: RGBColor = RGBColor(90, 90, 90);
pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
pub(super) const BAND: RGBColor = RGBColor(204, 121, 167);
pub(super) const SHADE: RGBColor = RGBColor(150, 150, 150);
const GRID: RGBColor = RGBColor(224, 224, 224);

/// Models in the order of the report: simple, extensive.
pub(super) const MODEL_COLOURS: [RGBColor; 2] = [SIMPLE, EXTENSIVE];

/// Width of every figure \[px\].
pub(super) const WIDTH: f64 = 920.0;
/// Left and right margins that every chart keeps \[px\].
pub(super) const LEFT: f64 = 84.0;
pub(super) const RIGHT: f64 = 24.0;
/// Where a legend of two rows ends \[px\].
pub(super) const LEGEND_END: f64 = 79.0;
/// Points that one series of a figure may have.
pub(super) const MOST_POINTS: usize = 2000;

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type DrawError = DrawingAreaErrorKind<io::Error>;
pub(super) type Drawn = Result<(), DrawError>;
pub(super) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// CSS pixels in drawing units.
pub(super) fn px(pixels: f64) -> i32 {
    (pixels * SCALE).round() as i32
}

/// Draws one figure: white ground, title, then whatever `draw` adds below it.
pub(super) fn sketch(title: &str, height: f64, draw: impl FnOnce(&Area<'_>) -> Drawn) -> Result<String, ReportError> {
    register_fonts()?;
    let failed = |cause: DrawError| ReportError::Draw { figure: title.to_owned(), cause: cause.to_string() };
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (px(WIDTH) as u32, px(height) as u32)).into_drawing_area();
        root.fill(&RGBColor(255, 255, 255)).map_err(failed)?;
        text(&root, (LEFT, 20.0), title, Look { size: 15.0, bold: true, ..Look::default() }).map_err(failed)?;
        draw(&root).map_err(failed)?;
        root.present().map_err(failed)?;
    }
    Ok(shrunk(&svg, height))
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

/// Sets the shown size and leaves out attributes that say what is so anyway.
///
/// Quotes in texts are escaped by the backend, so nothing but attributes can match.
fn shrunk(svg: &str, height: f64) -> String {
    let size = format!("width=\"{}\" height=\"{}\"", px(WIDTH), px(height));
    svg.replacen(&size, &format!("role=\"img\" width=\"{WIDTH}\" height=\"{height}\""), 1)
        .replace(" opacity=\"1\"", "")
        .replace(" stroke=\"none\"", "")
        .replace(" fill=\"#000000\"", "")
}

/// How a text looks and which of its points is placed.
#[derive(Clone, Copy)]
pub(super) struct Look {
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
    pub(super) fn width(self, words: &str) -> f64 {
        let upright = Self { upward: false, ..self };
        upright.style().font.box_size(words).map_or(0.0, |(width, _)| f64::from(width) / SCALE)
    }

    /// Shortens a text in the middle until it fits.
    pub(super) fn fit(self, words: &str, room: f64) -> String {
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
pub(super) fn text(area: &Area<'_>, (x, y): (f64, f64), words: &str, look: Look) -> Drawn {
    let forbidden = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    let clean: String = words.chars().map(|c| if forbidden(c) { '\u{fffd}' } else { c }).collect();
    let room = if look.upward { f64::INFINITY } else { WIDTH - RIGHT - LEFT.min(x) };
    area.draw_text(&look.fit(&clean, room), &look.style(), (px(x), px(y)))
}

/// Words in the middle of an area that has nothing to draw.
pub(super) fn notice(area: &Area<'_>, words: &str) -> Drawn {
    let (width, height) = area.dim_in_pixel();
    let middle = (f64::from(width) / SCALE / 2.0, f64::from(height) / SCALE / 2.0);
    let look = Look { colour: MEASURED, anchor: HPos::Center, ..Look::default() };
    area.draw_text(words, &look.style(), (px(middle.0), px(middle.1)))
}

pub(super) fn stroke(colour: impl Color, width: f64) -> ShapeStyle {
    ShapeStyle { color: colour.to_rgba(), filled: false, stroke_width: px(width) as u32 }
}

pub(super) fn filled(colour: impl Color, opacity: f64) -> ShapeStyle {
    colour.mix(opacity).filled()
}

/// Range of an axis, its ticks and their labels.
#[derive(Clone)]
pub(super) struct Axis {
    low: f64,
    high: f64,
    ticks: Vec<(f64, String)>,
}

impl Axis {
    /// An axis over all drawable values, widened by a share of its span on both sides.
    ///
    /// No value at all gives 0 to 1, a single value a little room on both sides.
    pub(super) fn over(values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.into_iter().filter(|value| drawable(*value)) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            return Self::between(0.0, 1.0);
        }
        let magnitude = low.abs().max(high.abs());
        if high - low <= 1e-9 * magnitude || high - low < 1e-250 {
            let room = if magnitude < 1e-200 { 1e-3 } else { 0.1 * magnitude };
            return Self::between(low - room, high + room);
        }
        let room = margin * (high - low);
        Self::between(low - room, high + room)
    }

    /// An axis between two limits, `low < high`, with ticks at multiples of 1, 2 or 5.
    pub(super) fn between(low: f64, high: f64) -> Self {
        let rough = (high - low) / 8.0;
        let power = rough.log10().floor();
        let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * 10f64.powf(power)).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(rough);
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
        let decimals = (-step.log10() - 1e-9).ceil().max(0.0) as usize;
        let plain = decimals <= 6 && low.abs().max(high.abs()) < 1e6;
        let label = |tick: f64| if plain { format!("{tick:.decimals$}") } else { short_exponent(tick, step) };
        let ticks = (first..=last).map(|k| k as f64 * step).map(|tick| (tick, label(tick).replace('-', "\u{2212}")));
        Self { low, high, ticks: ticks.collect() }
    }

    /// A logarithmic axis; its coordinates are the decimal logarithms.
    pub(super) fn decades(low: i32, high: i32) -> Self {
        let stride = ((high - low) / 7 + 1).max(1) as usize;
        let label = |exponent: i32| format!("10{}", superscript(exponent));
        let ticks = (low..=high).step_by(stride).map(|exponent| (f64::from(exponent), label(exponent))).collect();
        Self { low: f64::from(low), high: f64::from(high), ticks }
    }

    /// An axis that counts from `low` to `high`, with ticks at whole numbers.
    pub(super) fn counting(low: usize, high: usize) -> Self {
        let mut axis = Self::between(low as f64 - 0.5, high.max(low) as f64 + 0.5);
        axis.ticks.retain(|(tick, _)| tick.fract() == 0.0);
        for (tick, label) in &mut axis.ticks {
            *label = format!("{tick:.0}").replace('-', "\u{2212}");
        }
        axis
    }

    pub(super) fn low(&self) -> f64 {
        self.low
    }

    pub(super) fn high(&self) -> f64 {
        self.high
    }

    fn label(&self, at: f64) -> String {
        self.ticks.iter().find(|(tick, _)| *tick == at).map(|(_, label)| label.clone()).unwrap_or_default()
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        // What lies absurdly far outside stays far outside, but must not overflow.
        let share = ((value - self.low) / (self.high - self.low)).clamp(-1e3, 1e3);
        limit.0 + (f64::from(limit.1 - limit.0) * share).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let ticks = if hint.weight().allow_light_points() { &[][..] } else { &self.ticks };
        ticks.iter().map(|(tick, _)| *tick).collect()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

/// Whether a value has a place on a figure at all.
pub(super) fn drawable(value: f64) -> bool {
    value.is_finite() && value.abs() < 1e100
}

/// `tick` with an exponent and no more digits than multiples of `step` need.
fn short_exponent(tick: f64, step: f64) -> String {
    if tick == 0.0 {
        return "0".to_owned();
    }
    let digits = (tick.abs().log10().floor() - step.log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{tick:.digits$e}")
}

fn superscript(number: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => digit.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(digit),
    };
    number.to_string().chars().map(raised).collect()
}

/// Axes of a chart in the given box \[px\]: top, bottom; without an `x_label` the x ticks stay unnamed.
pub(super) fn chart<'a, 'b>(
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
        .margin_left(px(12.0))
        .margin_right(px(RIGHT))
        .y_label_area_size(px(LEFT - 12.0))
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
    Ok(chart)
}

/// A line through the points; what cannot be drawn leaves a gap.
pub(super) fn line(chart: &mut Chart<'_, '_>, points: &[(f64, f64)], style: ShapeStyle) -> Drawn {
    let pieces = points.split(|(x, y)| !drawable(*x) || !drawable(*y)).filter(|piece| piece.len() > 1);
    chart.draw_series(pieces.map(|piece| PathElement::new(piece, style)))?;
    Ok(())
}

/// Filled dots; what cannot be drawn is left out.
pub(super) fn dots(chart: &mut Chart<'_, '_>, points: &[(f64, f64)], radius: f64, style: ShapeStyle) -> Drawn {
    let seen = points.iter().filter(|(x, y)| drawable(*x) && drawable(*y));
    chart.draw_series(seen.map(|point| Circle::new(*point, px(radius), style)))?;
    Ok(())
}

/// The area between two curves over `x`, given as `(x, low, high)`.
pub(super) fn band(chart: &mut Chart<'_, '_>, points: &[(f64, f64, f64)], style: ShapeStyle) -> Drawn {
    let hole = |(x, low, high): &(f64, f64, f64)| !drawable(*x) || !drawable(*low) || !drawable(*high);
    for piece in points.split(hole).filter(|piece| piece.len() > 1) {
        let there = piece.iter().map(|(x, low, _)| (*x, *low));
        let back = piece.iter().rev().map(|(x, _, high)| (*x, *high));
        chart.draw_series([Polygon::new(there.chain(back).collect::<Vec<_>>(), style)])?;
    }
    Ok(())
}

/// A rectangle in the chart's coordinates, given by two opposite corners.
pub(super) fn block(chart: &mut Chart<'_, '_>, corners: [(f64, f64); 2], style: ShapeStyle) -> Drawn {
    chart.draw_series([Rectangle::new(corners, style)])?;
    Ok(())
}

/// Sign of a legend entry.
#[derive(Clone, Copy)]
pub(super) enum Sign {
    Dot,
    Line,
    Box,
    Diamond,
}

/// The mark of a nominal value around a point \[px\].
pub(super) fn diamond((x, y): (f64, f64), style: ShapeStyle) -> Polygon<(i32, i32)> {
    let corners = [(x - 5.0, y), (x, y - 7.0), (x + 5.0, y), (x, y + 7.0)];
    Polygon::new(corners.map(|(x, y)| (px(x), px(y))), style)
}

/// Legend in rows under the title, with `names` as `(sign, colour, words)`; returns where it ends \[px\].
pub(super) fn legend(root: &Area<'_>, names: &[(Sign, RGBAColor, String)]) -> Result<f64, DrawError> {
    let look = Look::default();
    let (mut x, mut y) = (LEFT, 44.0);
    for (sign, colour, words) in names {
        let words = look.fit(words, WIDTH - LEFT - RIGHT - 26.0);
        let width = 26.0 + look.width(&words);
        if x > LEFT && x + width > WIDTH - RIGHT {
            (x, y) = (LEFT, y + 19.0);
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
        text(root, (x + 26.0, y), &words, look)?;
        x += width + 22.0;
    }
    Ok(y + 16.0)
}

/// Which samples of a column to draw so that no peak is lost: of each bucket the lowest and the highest, one that is not
/// a number where there is one, so that gaps stay gaps, and a few evenly spaced ones, because extremes alone would draw
/// noise as two curves. In order, at most `limit`.
fn thin(column: &[f64], limit: usize) -> Vec<usize> {
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

/// A thinned curve over `x`.
pub(super) fn thinned(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    let length = x.len().min(y.len());
    thin(&y[..length], MOST_POINTS).into_iter().map(|i| (x[i], y[i])).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_numbers_with_equal_decimals() {
        assert_eq!(labels(&Axis::between(-0.42, 0.41)), ["−0.4", "−0.2", "0.0", "0.2", "0.4"]);
        assert_eq!(labels(&Axis::between(0.0, 6.0)), ["0", "1", "2", "3", "4", "5", "6"]);
        assert_eq!(labels(&Axis::between(0.0, 2.5e-8)), ["0", "5e−9", "1.0e−8", "1.5e−8", "2.0e−8", "2.5e−8"]);
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten() {
        assert_eq!(labels(&Axis::decades(-12, 2)), ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰"]);
    }

    #[test]
    fn degenerate_ranges_get_room() {
        for values in [vec![], vec![f64::NAN], vec![0.0; 3], vec![7.5], vec![1.0, 1.0 + 1e-15], vec![-1e99, 1e99]] {
            let axis = Axis::over(values.iter().copied(), 0.05);
            assert!(axis.low < axis.high, "{values:?}");
            assert!((2..12).contains(&axis.ticks.len()), "{values:?}: {:?}", labels(&axis));
        }
    }

    #[test]
    fn thinning_keeps_peaks_and_gaps() {
        let mut column: Vec<f64> = (0..10_000).map(|i| f64::from(i).sin()).collect();
        column[4321] = 9.0;
        column[7000] = f64::NAN;
        let kept = thin(&column, MOST_POINTS);
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
        fn axes_hold_for_any_values(values in prop::collection::vec(prop::num::f64::ANY, 0..20)) {
            let axis = Axis::over(values, 0.05);
            prop_assert!(axis.low < axis.high && axis.low.is_finite() && axis.high.is_finite());
            prop_assert!(axis.ticks.len() < 20);
        }

        #[test]
        fn thinning_is_in_order_and_within_its_limit(values in prop::collection::vec(prop::num::f64::ANY, 0..300)) {
            let kept = thin(&values, 50);
            prop_assert!(kept.len() <= 50 && kept.is_sorted());
        }
    }
}
