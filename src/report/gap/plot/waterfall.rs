//! From as given to the floor: one bar for each step.

use plotters::style::Color;

use super::bars::{Bar, Bars, draw};
use crate::gap::Diagnosis;
use crate::report::ReportError;
use crate::report::gap::waterfall::{Kind, Step, heading, steps};
use crate::report::gap::words;
use crate::report::number::significant;
use crate::report::plot::axis::drawable;
use crate::report::plot::canvas::{AFTER, BAND, BEFORE, CALIBRATED, Sign};

/// Draws the RMS over the held-out logs after each step; what a step closes is drawn faint behind its bar's end.
pub(super) fn waterfall(diagnosis: &Diagnosis) -> Result<String, ReportError> {
    let steps = steps(diagnosis);
    let above = |k: usize| Some(1e3 * steps[k.checked_sub(1)?].rms_rad).filter(|_| steps[k].kind != Kind::Floor);
    let bars = steps.iter().enumerate().map(|(k, step)| bar(step, above(k))).collect();
    draw(&Bars {
        title: &format!("{}: {}", diagnosis.joint, heading(diagnosis).to_lowercase()),
        legend: vec![
            (Sign::Box, CALIBRATED.mix(0.3), "closed by recalibrating".to_owned()),
            (Sign::Box, AFTER.mix(0.3), "closed by a cause".to_owned()),
            (Sign::Line, BAND.to_rgba(), "the sensor's own noise".to_owned()),
        ],
        label: "RMS of the angle error, held-out logs [mrad]",
        columns: &["RMS [mrad]", "closes", "alone", "last"],
        bars,
        mark: Some(1e3 * diagnosis.gap.floor).filter(|floor| drawable(*floor)),
    })
}

fn bar(step: &Step<'_>, down_from: Option<f64>) -> Bar {
    let colour = match step.kind {
        Kind::Given => BEFORE,
        Kind::Recalibrated => CALIBRATED,
        Kind::Cause | Kind::Law => AFTER,
        Kind::Floor => BAND,
    };
    let part = |share: Option<f64>| share.map_or_else(String::new, words::part);
    Bar {
        name: step.label(),
        value: 1e3 * step.rms_rad,
        down_from,
        colour,
        bold: matches!(step.kind, Kind::Cause | Kind::Law),
        words: vec![significant(1e3 * step.rms_rad, 3), part(step.closes), part(step.alone()), part(step.last())],
    }
}
