//! Horizontal bars with words beside them: which effects were considered, which variables explain most.

use plotters::prelude::{Polygon, Rectangle};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor};

use super::ruled::{ROW, RULER, Ruled};
use crate::gap::Diagnosis;
use crate::report::ReportError;
use crate::report::gap::waterfall::closes_alone;
use crate::report::gap::words;
use crate::report::measure::Measure;
use crate::report::number;
use crate::report::plot::axis::{Axis, drawable};
use crate::report::plot::canvas::{
    AFTER, Area, BAND, BEFORE, CALIBRATED, Drawn, LegendEntry, Look, RIGHT, SHADE, Sign, WIDTH, filled, legend,
    legend_end, px, sketch, text,
};

/// Width of a column of words \[px\].
const COLUMN: f64 = 92.0;
/// A bar that is so many times longer than the others is cut.
const TOO_LONG: f64 = 3.0;

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

/// Bars under each other, over a ruler that begins at 0.
pub(in crate::report) struct Bars<'a> {
    pub title: &'a str,
    pub legend: Vec<LegendEntry>,
    pub label: &'a str,
    pub columns: &'a [&'a str],
    pub bars: Vec<Bar>,
    /// A value that is marked through all rows.
    pub mark: Option<f64>,
}

/// Draws bars; one that is much longer than the others is cut.
pub(in crate::report) fn draw(picture: &Bars<'_>) -> Result<String, ReportError> {
    let longest = longest(&picture.bars);
    let axis = Axis::between(0.0, if longest > 0.0 { longest } else { 1.0 });
    let top = if picture.legend.is_empty() { 34.0 } else { legend_end(&picture.legend) };
    let header_room = if picture.columns.iter().all(|words| words.is_empty()) { 4.0 } else { 20.0 };
    let height = top + header_room + ROW * picture.bars.len() as f64 + RULER;
    sketch(picture.title, height, |root| {
        legend(root, &picture.legend)?;
        let right = WIDTH - RIGHT - COLUMN * picture.columns.len() as f64;
        let rows = Ruled { axis: &axis, label: picture.label, right, top: top + header_room, rows: picture.bars.len() };
        let column = |i: usize| right + COLUMN * (i as f64 + 1.0);
        let header = Look { size: 11.0, colour: RGBColor(90, 90, 90), anchor: HPos::Right, ..Look::default() };
        for (i, words) in picture.columns.iter().enumerate() {
            text(root, (column(i), top + 8.0), words, header)?;
        }
        rows.draw(root)?;
        for (row, bar) in picture.bars.iter().enumerate() {
            rows.name(root, row, &bar.name, bar.bold)?;
            draw_bar(root, &rows, row, bar)?;
            for (i, words) in bar.words.iter().enumerate() {
                let look = Look { anchor: HPos::Right, bold: bar.bold, ..Look::default() };
                text(root, (column(i), rows.y(row)), words, look)?;
            }
        }
        match picture.mark {
            Some(mark) => rows.upright(root, mark, BAND, 2.0),
            None => Ok(()),
        }
    })
}

/// The longest bar that is not cut, with a little room.
fn longest(bars: &[Bar]) -> f64 {
    let mut lengths: Vec<f64> = bars.iter().map(|bar| bar.value).filter(|value| drawable(*value)).collect();
    lengths.sort_by(f64::total_cmp);
    match lengths[..] {
        [.., second, longest] if longest > TOO_LONG * second && second > 0.0 => 1.5 * second,
        [.., longest] => 1.05 * longest,
        [] => 0.0,
    }
}

fn draw_bar(root: &Area<'_>, rows: &Ruled<'_>, row: usize, bar: &Bar) -> Drawn {
    if !drawable(bar.value) || bar.value <= 0.0 {
        return Ok(());
    }
    let (y, end) = (rows.y(row), rows.x(bar.value));
    if let Some(above) = bar.down_from.filter(|above| drawable(*above) && *above > bar.value) {
        let closed = [(px(end), px(y - 8.0)), (px(rows.x(above.min(rows.axis.high()))), px(y + 8.0))];
        root.draw(&Rectangle::new(closed, filled(bar.colour, 0.3)))?;
    }
    let corners = [(px(Ruled::LEFT), px(y - 8.0)), (px(end), px(y + 8.0))];
    root.draw(&Rectangle::new(corners, filled(bar.colour, 0.9)))?;
    if bar.value <= rows.axis.high() {
        return Ok(());
    }
    let tip = [(end - 7.0, y - 8.0), (end + 6.0, y), (end - 7.0, y + 8.0)];
    root.draw(&Polygon::new(tip.map(|(x, y)| (px(x), px(y))), filled(bar.colour, 1.0)))
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
    for candidate in diagnosis.ranking.iter().filter(|candidate| candidate.refitted) {
        let named = words::is_named(answer, candidate.effect);
        let chance = number::share(candidate.probability);
        let colour = if named { AFTER } else { SHADE };
        let mut bar = Bar { bold: named, ..bar(candidate.effect.id(), candidate.after, colour) };
        bar.words[1] = closes_alone(gap, candidate.after).map_or_else(|| "–".to_owned(), number::share);
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
    draw(&Bars {
        title: &format!("{}: error on held-out logs with each effect", diagnosis.joint),
        legend,
        label: &format!("RMS of the {}, held-out logs [{}]", measure.what, measure.unit),
        columns: &[&*format!("RMS [{}]", measure.unit), "closes alone", "probability"],
        bars,
        mark: Some(measure.scale * gap.floor).filter(|floor| drawable(*floor)),
    })
}

/// Draws which variables explain most of the residual torque's variance.
pub(super) fn variables(diagnosis: &Diagnosis) -> Result<String, ReportError> {
    let bars = diagnosis.location.variables.iter().enumerate().map(|(i, (variable, share))| Bar {
        name: words::variable(*variable).to_owned(),
        value: 100.0 * share,
        down_from: None,
        colour: if i == 0 { AFTER } else { SHADE },
        bold: i == 0,
        words: vec![number::share(*share)],
    });
    draw(&Bars {
        title: &format!("{}: what the missing torque depends on", diagnosis.joint),
        legend: Vec::new(),
        label: "share of its variance that each variable alone explains [%]",
        columns: &[""],
        bars: bars.collect(),
        mark: None,
    })
}
