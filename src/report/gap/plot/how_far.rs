//! How far the gap closes, log by log.

use plotters::prelude::{Circle, PathElement};
use plotters::style::{Color, RGBColor};

use super::ruled::{RULER, Ruled, row_height};
use crate::gap::{Diagnosis, LogGap};
use crate::number::{extent, math};
use crate::report::ReportError;
use crate::report::gap::words;
use crate::report::measure::Measure;
use crate::report::plot::axis::{Axis, drawable};
use crate::report::plot::canvas::{
    AFTER, BAND, BEFORE, CALIBRATED, RIGHT, SHADE, Sign, diamond, filled, legend, legend_end, px, sketch, stroke, width,
};

/// Draws each held-out log's RMS as given, recalibrated, with the answer and the sensor's noise, on a logarithmic axis.
pub(super) fn how_far(diagnosis: &Diagnosis) -> Result<String, ReportError> {
    let gap = &diagnosis.gap;
    let all = LogGap {
        file: "all of them".into(),
        before: gap.before,
        calibrated: gap.calibrated,
        after: gap.after,
        floor: gap.floor,
    };
    let files: Vec<&str> = gap.per_log.iter().map(|log| log.file.as_str()).collect();
    let bare = gap.per_log.iter().zip(words::names_without_folder(&files));
    let bare: Vec<LogGap> = bare.map(|(log, file)| LogGap { file, ..log.clone() }).collect();
    let logs: Vec<&LogGap> = bare.iter().chain([&all]).collect();
    let title = format!("{}: error of each {}", diagnosis.joint, words::log_of(gap));
    errors(&title, &logs, Measure::of(gap.unit), words::answer(diagnosis))
}

/// Draws errors of logs or joints, each under the name `file`; the last row is set off. `answer` is what was added for
/// the errors after; without it these are left out.
pub(in crate::report) fn errors(
    title: &str,
    logs: &[&LogGap],
    measure: Measure,
    answer: Option<String>,
) -> Result<String, ReportError> {
    let axis = Axis::logarithmic(logs.iter().flat_map(|log| values(log)).map(|(rms, _)| measure.scale * rms));
    let mut names = vec![
        (Sign::Dot, BEFORE.to_rgba(), "as given".to_owned()),
        (Sign::Dot, CALIBRATED.to_rgba(), "recalibrated".to_owned()),
    ];
    names.extend(answer.iter().map(|words| (Sign::Dot, AFTER.to_rgba(), words.clone())));
    names.push((Sign::Diamond, BAND.to_rgba(), "the sensor's own noise".to_owned()));
    let height = legend_end(&names) + 4.0 + row_height() * logs.len() as f64 + RULER;

    sketch(title, height, |root| {
        let top = legend(root, &names)?;
        let label = format!("RMS of the {} [{}], logarithmic", measure.what, measure.unit);
        let rows = Ruled { axis: &axis, label: &label, right: width() - RIGHT, top: top + 4.0, rows: logs.len() };
        rows.draw(root)?;
        for (row, log) in logs.iter().enumerate() {
            let is_last = row + 1 == logs.len();
            rows.name(root, row, &log.file, is_last)?;
            let places = values(log).map(|(rms, colour)| {
                let shown = drawable(rms) && rms > 0.0 && (colour != AFTER || answer.is_some());
                (shown.then(|| rows.x(math::log10(measure.scale * rms))), colour)
            });
            rows.says(root, row, &said(log, measure, answer.as_deref()));
            let [low, high] = extent(places.iter().filter_map(|(x, _)| *x));
            let y = rows.y(row);
            if low < high {
                root.draw(&PathElement::new([(px(low), px(y)), (px(high), px(y))], stroke(SHADE, 1.0)))?;
            }
            let [before, calibrated, after, floor] = places;
            if let (Some(x), colour) = floor {
                root.draw(&diamond((x, y), filled(colour, 1.0)))?;
            }
            // The smaller above the larger, so that none hides another.
            for ((x, colour), radius) in [before, calibrated, after].into_iter().zip([6.5, 5.0, 3.5]) {
                if let Some(x) = x {
                    root.draw(&Circle::new((px(x), px(y)), px(radius), filled(colour, 1.0)))?;
                }
            }
        }
        Ok(())
    })
}

/// All errors of a row in words.
fn said(log: &LogGap, measure: Measure, answer: Option<&str>) -> String {
    let of = |words: &str, rms: f64| format!("{words} {}", measure.quantity(rms));
    let after = answer.map(|words| of(words, log.after));
    let all = [of("as given", log.before), of("recalibrated", log.calibrated)].into_iter().chain(after);
    let all: Vec<String> = all.chain([of("noise", log.floor)]).collect();
    format!("{}: {}", log.file, all.join(", "))
}

/// RMS and colour: before, calibrated, after, floor.
fn values(log: &LogGap) -> [(f64, RGBColor); 4] {
    [(log.before, BEFORE), (log.calibrated, CALIBRATED), (log.after, AFTER), (log.floor, BAND)]
}
