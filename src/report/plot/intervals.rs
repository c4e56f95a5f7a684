//! Every parameter with its intervals, each on its own scale.

use plotters::prelude::{Circle, PathElement, Polygon};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor};

use super::axis::drawable;
use super::canvas::{
    Area, Drawn, INK, LEFT, Look, MEASURED, MODEL_COLOURS, RIGHT, Sign, WIDTH, diamond, filled, legend, px, sketch,
    stroke, text,
};
use crate::report::number::significant;
use crate::report::rows::{ParameterCells, is_shown, typeset_unit};
use crate::report::{ModelSummary, ParameterRow, ReportError};

const ROW: f64 = 30.0;
/// Half-widths of the robust interval that fit left and right of the estimate.
const REACH: f64 = 4.0;
/// Columns \[px\]: names end, bars begin, bars end, numbers begin.
const BARS: [f64; 2] = [LEFT + 140.0, WIDTH - RIGHT - 336.0];
const NUMBERS: f64 = BARS[1] + 18.0;

/// Draws all parameters of all models, estimate at 0 and the robust 95 % interval from about -1 to 1.
///
/// The thin bar is the robust interval, the thick one the naive; a diamond marks the nominal value, an arrow one beyond
/// the edge. Held parameters and those that the logs do not determine are named in words.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn parameter_intervals(joint: &str, models: &[ModelSummary]) -> Result<String, ReportError> {
    let groups: Vec<_> = models.iter().map(|model| (model.name.as_str(), &model.parameters[..])).collect();
    interval_bars(&format!("{joint} parameters with 95 % intervals"), &groups)
}

/// The same of any groups of parameters, each with a name.
pub(in crate::report) fn interval_bars(title: &str, groups: &[(&str, &[ParameterRow])]) -> Result<String, ReportError> {
    let rows = groups.iter().map(|(_, parameters)| parameters.len() + 1).sum::<usize>();
    let height = 60.0 + ROW * rows as f64 + 66.0;
    sketch(title, height, |root| {
        let names = [
            (Sign::Dot, INK.to_rgba(), "estimate".to_owned()),
            (Sign::Line, INK.to_rgba(), "robust interval".to_owned()),
            (Sign::Box, INK.mix(0.35), "naive interval (white residuals)".to_owned()),
            (Sign::Diamond, NOMINAL.to_rgba(), "nominal value".to_owned()),
        ];
        let top = legend(root, &names)?;
        let bottom = top + ROW * rows as f64;
        ruler(root, top, bottom)?;
        let mut y = top + ROW / 2.0;
        for ((name, parameters), colour) in groups.iter().zip(MODEL_COLOURS.into_iter().cycle()) {
            text(root, (20.0, y), name, Look { bold: true, ..Look::default() })?;
            y += ROW;
            for row in *parameters {
                parameter(root, y, row, colour)?;
                y += ROW;
            }
        }
        Ok(())
    })
}

const NOMINAL: RGBColor = super::canvas::POSITIVE;

/// Place of `value` between the bars' ends \[px\], and whether it lies beyond them.
fn place(row: &ParameterRow, half_width: f64, value: f64) -> (f64, bool) {
    let along = (value - row.value) / half_width;
    let kept = along.clamp(-REACH, REACH);
    (BARS[0] + (kept + REACH) / (2.0 * REACH) * (BARS[1] - BARS[0]), kept != along)
}

fn ruler(root: &Area<'_>, top: f64, bottom: f64) -> Drawn {
    let look = Look { size: 11.0, anchor: HPos::Center, ..Look::default() };
    for tick in -4i32..=4 {
        let x = BARS[0] + (f64::from(tick) + REACH) / (2.0 * REACH) * (BARS[1] - BARS[0]);
        let style = if tick == 0 { stroke(MEASURED, 0.75) } else { stroke(RGBColor(224, 224, 224), 0.5) };
        root.draw(&PathElement::new([(px(x), px(top)), (px(x), px(bottom))], style))?;
        text(root, (x, bottom + 12.0), &tick.to_string().replace('-', "\u{2212}"), look)?;
    }
    let middle = 0.5 * (BARS[0] + BARS[1]);
    let words = "distance from the estimate [half-widths of its interval]";
    text(root, (middle, bottom + 34.0), words, Look { anchor: HPos::Center, ..Look::default() })
}

fn parameter(root: &Area<'_>, y: f64, row: &ParameterRow, colour: RGBColor) -> Drawn {
    let cells = ParameterCells::from(row);
    let label = Look { anchor: HPos::Right, ..Look::default() };
    text(root, (BARS[0] - 12.0, y), &label.fit(&cells.label, BARS[0] - 24.0), label)?;
    let words = Look { size: 11.0, colour: MEASURED, ..Look::default() };
    let unit = typeset_unit(&cells.unit);
    if !is_shown(row) {
        let said = match cells.estimate.as_str() {
            "not determined" => "these logs do not determine it".to_owned(),
            held => format!("{held} {unit}"),
        };
        return text(root, (NUMBERS, y), &words.fit(&said, WIDTH - RIGHT - NUMBERS), words);
    }
    let Some(half_width) = half_width(row.interval).or_else(|| half_width(row.interval_naive)) else {
        return text(root, (NUMBERS, y), &format!("{} {unit}, interval unknown", cells.estimate), words);
    };
    let at = |value| place(row, half_width, value);
    let nominal = row.nominal.filter(|nominal| drawable(*nominal)).map(|nominal| (at(nominal), nominal > row.value));
    let share = 100.0 * half_width / row.value.abs();
    let share = if share < 1000.0 { format!(" (±{} %)", significant(share, 2)) } else { String::new() };
    let beyond = nominal.filter(|((_, beyond), _)| *beyond).map(|_| format!(", nominal {}", cells.nominal));
    let said = format!("{} {unit}{share}{}", cells.estimate, beyond.unwrap_or_default());
    text(root, (NUMBERS, y), &words.fit(&said, WIDTH - RIGHT - NUMBERS), Look { colour: INK, ..words })?;

    for (interval, style) in [(row.interval_naive, stroke(colour.mix(0.45), 8.0)), (row.interval, stroke(colour, 1.75))]
    {
        if let Some([low, high]) = interval.filter(|interval| interval.iter().all(|end| !end.is_nan())) {
            root.draw(&PathElement::new([(px(at(low).0), px(y)), (px(at(high).0), px(y))], style))?;
        }
    }
    root.draw(&Circle::new((px(at(row.value).0), px(y)), px(4.0), filled(colour, 1.0)))?;
    match nominal {
        Some((place, to_right)) => nominal_mark(root, place, y, to_right),
        None => Ok(()),
    }
}

/// A diamond, or an arrow head where the value lies beyond the edge.
fn nominal_mark(root: &Area<'_>, (x, beyond): (f64, bool), y: f64, to_right: bool) -> Drawn {
    let style = filled(NOMINAL, 1.0);
    if !beyond {
        return root.draw(&diamond((x, y), style));
    }
    let ahead = if to_right { 6.0 } else { -6.0 };
    let corners = [(x - 0.6 * ahead, y - 6.0), (x + ahead, y), (x - 0.6 * ahead, y + 6.0)];
    root.draw(&Polygon::new(corners.map(|(x, y)| (px(x), px(y))), style))
}

fn half_width(interval: Option<[f64; 2]>) -> Option<f64> {
    interval.map(|[low, high]| 0.5 * (high - low)).filter(|width| drawable(*width) && *width > 0.0)
}
