//! Horizontal bars with words beside them: which effects were considered, which variables explain most.

use plotters::prelude::Rectangle;
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor};

use super::ruled::{RULER, Ruled, row_height};
use crate::gap::{Diagnosis, Variable};
use crate::number::math;
use crate::report::ReportError;
use crate::report::gap::waterfall::closes_alone;
use crate::report::gap::words;
use crate::report::measure::Measure;
use crate::report::number;
use crate::report::plot::axis::{Axis, drawable};
use crate::report::plot::canvas::{
    AFTER, Area, BAND, BEFORE, CALIBRATED, Drawn, LegendEntry, Look, RIGHT, SHADE, Sign, filled, legend, legend_end,
    px, sketch, text, width,
};
use crate::report::plot::layout::is_narrow;

/// Width of a column of words \[px\]; in a narrow figure what they need and so much.
const COLUMN: f64 = 92.0;
const BETWEEN: f64 = 14.0;
/// Where a bar is so many times longer than the next one, the ruler is logarithmic.
const TOO_LONG: f64 = 3.0;
/// A logarithmic ruler begins at this share of its shortest bar.
const BEGINS: f64 = 0.6;

/// A bar with its name to the left and words to the right.
pub(in crate::report) struct Bar {
    pub name: String,
    pub value: f64,
    /// Where the bar above it ends, if what lies between is to be seen.
    pub down_from: Option<f64>,
    pub colour: RGBColor,
    pub bold: bool,
    /// One for each column.
    pub words: Vec<String>,
}

/// Bars under each other, over a ruler that begins at 0, or a logarithmic one that says so.
pub(in crate::report) struct Bars<'a> {
    pub title: &'a str,
    pub legend: Vec<LegendEntry>,
    pub label: &'a str,
    pub columns: &'a [&'a str],
    pub bars: Vec<Bar>,
    /// A value that is marked through all rows.
    pub mark: Option<f64>,
    /// Lengths are errors, of which ratios count: the ruler may be logarithmic.
    pub are_errors: bool,
}

/// Draws bars; where one is much longer than the others the ruler is logarithmic.
pub(in crate::report) fn draw(picture: &Bars<'_>) -> Result<String, ReportError> {
    let values = || picture.bars.iter().map(|bar| bar.value).filter(|value| drawable(*value));
    let is_log = picture.are_errors && is_uneven(values().filter(|value| *value > 0.0));
    let axis = match is_log {
        true => logarithmic(values().chain(picture.mark)),
        false => {
            Axis::between(0.0, Some(1.05 * values().fold(0.0, f64::max)).filter(|most| *most > 0.0).unwrap_or(1.0))
        }
    };
    let along = |value: f64| if is_log { math::log10(value.max(f64::MIN_POSITIVE)) } else { value };
    let label = if is_log { format!("{}, logarithmic", picture.label) } else { picture.label.to_owned() };
    let top = if picture.legend.is_empty() { 34.0 } else { legend_end(&picture.legend) };
    let header_room = if picture.columns.iter().all(|words| words.is_empty()) { 4.0 } else { 20.0 };
    let height = top + header_room + row_height() * picture.bars.len() as f64 + RULER;
    let columns = columns(picture);
    sketch(picture.title, height, |root| {
        legend(root, &picture.legend)?;
        let right = width() - RIGHT - columns.iter().sum::<f64>();
        let rows = Ruled { axis: &axis, label: &label, right, top: top + header_room, rows: picture.bars.len() };
        let column = |i: usize| right + columns[..=i].iter().sum::<f64>();
        for (i, words) in picture.columns.iter().enumerate() {
            text(root, (column(i), top + 8.0), words, HEADER)?;
        }
        rows.draw(root)?;
        for (row, bar) in picture.bars.iter().enumerate() {
            rows.name(root, row, &bar.name, bar.bold)?;
            draw_bar(root, &rows, row, bar, &along)?;
            for (i, words) in bar.words.iter().enumerate() {
                let look = Look { anchor: HPos::Right, bold: bar.bold, ..Look::default() };
                text(root, (column(i), rows.y(row)), words, look)?;
            }
            let said = picture.columns.iter().zip(&bar.words).filter(|(_, words)| !words.is_empty());
            let said: Vec<String> = said.map(|(name, words)| format!("{name} {words}").trim().to_owned()).collect();
            rows.says(root, row, &format!("{}: {}", bar.name, said.join(", ")));
        }
        match picture.mark {
            Some(mark) => rows.mark(root, along(mark), BAND),
            None => Ok(()),
        }
    })
}

/// What stands over a column.
const HEADER: Look = Look { size: 11.0, colour: RGBColor(90, 90, 90), bold: false, anchor: HPos::Right, upward: false };

/// Widths of the columns of words \[px\].
fn columns(picture: &Bars<'_>) -> Vec<f64> {
    let needs = |(i, header): (usize, &&str)| {
        let words = picture
            .bars
            .iter()
            .filter_map(|bar| Some(Look { bold: bar.bold, ..Look::default() }.width(bar.words.get(i)?)));
        words.fold(HEADER.width(header), f64::max) + BETWEEN
    };
    let all = picture.columns.iter().enumerate();
    if is_narrow() { all.map(needs).collect() } else { all.map(|_| COLUMN).collect() }
}

/// Whether one bar would leave the others no room.
fn is_uneven(values: impl Iterator<Item = f64>) -> bool {
    let mut lengths: Vec<f64> = values.collect();
    lengths.sort_by(f64::total_cmp);
    matches!(lengths[..], [.., _, second, longest] if longest > TOO_LONG * second)
}

/// An axis of decimal logarithms that begins below the shortest bar.
fn logarithmic(values: impl Iterator<Item = f64>) -> Axis {
    let above: Vec<f64> = values.filter(|value| *value > 0.0).collect();
    let (least, most) = above.iter().fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(*x), h.max(*x)));
    Axis::logarithmic([BEGINS * least, most])
}

fn draw_bar(root: &Area<'_>, rows: &Ruled<'_>, row: usize, bar: &Bar, along: &dyn Fn(f64) -> f64) -> Drawn {
    if !drawable(bar.value) || bar.value <= 0.0 {
        return Ok(());
    }
    let (y, end) = (rows.y(row), rows.x(along(bar.value)));
    if let Some(above) = bar.down_from.filter(|above| drawable(*above) && *above > bar.value) {
        let closed = [(px(end), px(y - 8.0)), (px(rows.x(along(above))), px(y + 8.0))];
        root.draw(&Rectangle::new(closed, filled(bar.colour, 0.3)))?;
    }
    let corners = [(px(Ruled::left()), px(y - 8.0)), (px(end), px(y + 8.0))];
    root.draw(&Rectangle::new(corners, filled(bar.colour, 0.9)))
}

/// Draws the RMS over the held-out logs as given, recalibrated, with each candidate, and the sensor's noise.
pub(super) fn ranking(diagnosis: &Diagnosis) -> Result<String, ReportError> {
    let (gap, answer) = (&diagnosis.gap, &diagnosis.answer);
    let measure = Measure::of(gap.unit);
    let bar = |name: &str, rms: f64, colour| Bar {
        name: name.to_owned(),
        value: measure.scale * rms,
        down_from: None,
        colour,
        bold: false,
        words: vec![measure.number(rms), String::new(), String::new()],
    };
    let mut bars = vec![bar("as given", gap.before, BEFORE), bar("recalibrated", gap.calibrated, CALIBRATED)];
    if let (Some(_), Some(both)) = (answer.second, words::answer(diagnosis)) {
        bars.push(Bar { bold: true, ..bar(&both, gap.after, AFTER) });
    }
    let chances = words::chances(diagnosis);
    for (candidate, chance) in
        diagnosis.ranking.iter().zip(chances.candidates).filter(|(candidate, _)| candidate.refitted)
    {
        let named = words::is_named(answer, candidate.effect);
        let colour = if named { AFTER } else { SHADE };
        let mut bar = Bar { bold: named, ..bar(candidate.effect.id(), candidate.after, colour) };
        bar.words[1] =
            closes_alone([gap.calibrated, gap.floor], candidate.after).map_or_else(|| "–".to_owned(), number::share);
        bar.words[2] = chance;
        bars.push(bar);
    }
    bars.push(bar("sensor's noise", gap.floor, BAND));
    let mut legend: Vec<LegendEntry> =
        words::mark(answer).map(|mark| (Sign::Box, AFTER.to_rgba(), mark.to_owned())).into_iter().collect();
    if bars.iter().any(|bar| bar.colour == SHADE) {
        legend.push((
            Sign::Box,
            SHADE.to_rgba(),
            if legend.is_empty() { "effects" } else { "other effects" }.to_owned(),
        ));
    }
    legend.push((Sign::Line, BAND.to_rgba(), "the sensor's own noise".to_owned()));
    let rms = format!("RMS [{}]", measure.unit);
    let columns = [&*rms, "closes alone", "probability"];
    if !chances.is_shared_out {
        bars.iter_mut().for_each(|bar| bar.words.truncate(2));
    }
    draw(&Bars {
        title: &format!("{}: error on {} with each effect", diagnosis.joint, words::logs_of(gap)),
        legend,
        label: &format!("RMS of the {}, {} [{}]", measure.what, words::logs_of(gap), measure.unit),
        columns: if chances.is_shared_out { &columns } else { &columns[..2] },
        bars,
        mark: Some(measure.scale * gap.floor).filter(|floor| drawable(*floor)),
        are_errors: true,
    })
}

/// Draws which variables explain most of the residual torque's variance; the one by which the gap is placed stands out.
pub(super) fn variables(diagnosis: &Diagnosis) -> Result<String, ReportError> {
    let location = &diagnosis.location;
    let bar = |(variable, share): &(Variable, f64)| {
        let is_placed_by = location.by() == Some(*variable);
        Bar {
            name: words::variable(*variable).to_owned(),
            value: 100.0 * share,
            down_from: None,
            colour: if is_placed_by { AFTER } else { SHADE },
            bold: is_placed_by,
            words: vec![number::share(*share)],
        }
    };
    let bars = location.variables.iter().map(bar);
    draw(&Bars {
        title: &format!("{}: what the missing torque depends on", diagnosis.joint),
        legend: Vec::new(),
        label: "share of its variance that each variable alone explains [%]",
        columns: &[""],
        bars: bars.collect(),
        mark: None,
        are_errors: false,
    })
}
