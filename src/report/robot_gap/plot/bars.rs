//! Bars: which causes were fitted, how far the trunk went.

use plotters::style::Color;

use crate::gap::robot::RobotDiagnosis;
use crate::report::ReportError;
use crate::report::gap::plot::bars::{Bar, Bars, draw};
use crate::report::gap::waterfall::closes_alone;
use crate::report::number::{share, significant};
use crate::report::plot::axis::drawable;
use crate::report::plot::canvas::{AFTER, BAND, BEFORE, CALIBRATED, LegendEntry, MEASURED, SHADE, Sign};
use crate::report::robot_gap::words;

/// Draws the RMS over the held-out samples as given, recalibrated, with each candidate, and the sensor's noise.
pub(super) fn ranking(diagnosis: &RobotDiagnosis) -> Result<String, ReportError> {
    let (gap, answer) = (&diagnosis.gap, &diagnosis.answer);
    let dash = || "–".to_owned();
    let bar = |name: String, rms_rad: f64, colour, closes: Option<f64>| Bar {
        name,
        value: 1e3 * rms_rad,
        down_from: None,
        colour,
        bold: false,
        words: vec![significant(1e3 * rms_rad, 3), closes.map_or_else(dash, share), String::new()],
    };
    let closes = |rms_rad: f64| closes_alone([gap.calibrated, gap.floor], rms_rad);
    let mut bars = vec![
        bar("as given".to_owned(), gap.before, BEFORE, None),
        bar("recalibrated".to_owned(), gap.calibrated, CALIBRATED, None),
    ];
    if let (Some(_), Some(both)) = (&answer.second, words::answer(answer)) {
        bars.push(Bar { bold: true, ..bar(both, gap.after, AFTER, closes(gap.after)) });
    }
    for (candidate, chance) in diagnosis.ranking.iter().zip(words::chances(diagnosis).candidates) {
        let named = words::is_named(answer, candidate);
        let colour = if named { AFTER } else { SHADE };
        let mut bar = Bar {
            bold: named,
            ..bar(words::found(&candidate.found), candidate.after, colour, closes(candidate.after))
        };
        bar.words[2] = chance;
        bars.push(bar);
    }
    bars.push(bar("sensor's noise".to_owned(), gap.floor, BAND, None));
    let mut legend: Vec<LegendEntry> =
        words::mark(answer).map(|mark| (Sign::Box, AFTER.to_rgba(), mark.to_owned())).into_iter().collect();
    if bars.iter().any(|bar| bar.colour == SHADE) {
        let words = if legend.is_empty() { "causes" } else { "other causes" };
        legend.push((Sign::Box, SHADE.to_rgba(), words.to_owned()));
    }
    legend.push((Sign::Line, BAND.to_rgba(), "the sensor's own noise".to_owned()));
    draw(&Bars {
        title: &format!("{}: error on held-out samples with each cause", diagnosis.robot),
        legend,
        label: "RMS of the angle error over all joints, held-out samples [mrad]",
        columns: &["RMS [mrad]", "closes alone", "probability"],
        bars,
        mark: Some(1e3 * gap.floor).filter(|floor| drawable(*floor)),
        are_errors: true,
    })
}

/// Draws how far the trunk went: as measured, as given, with the answer.
pub(super) fn displacement(diagnosis: &RobotDiagnosis) -> Result<String, ReportError> {
    let after = words::answer(&diagnosis.answer);
    let bar = |name: String, metres: f64, colour| Bar {
        name,
        value: 100.0 * metres,
        down_from: None,
        colour,
        bold: colour == MEASURED,
        words: vec![format!("{:.1} cm", 100.0 * metres)],
    };
    let mut bars = Vec::new();
    for log in &diagnosis.gap.displacement {
        bars.push(bar(format!("{}: measured", log.file), log.measured, MEASURED));
        bars.push(bar("as given".to_owned(), log.before, BEFORE));
        bars.extend(after.iter().map(|words| bar(words.clone(), log.after, AFTER)));
    }
    draw(&Bars {
        title: &format!("{}: displacement of the trunk", diagnosis.robot),
        legend: Vec::new(),
        label: "displacement forward [cm]",
        columns: &[""],
        bars,
        mark: None,
        are_errors: false,
    })
}
