//! From as given to the floor: one bar for each step.

use plotters::style::Color;

use super::bars::{Bar, Bars, draw};
use crate::gap::Diagnosis;
use crate::report::ReportError;
use crate::report::gap::waterfall::{Kind, Step, heading, steps};
use crate::report::gap::words;
use crate::report::measure::Measure;
use crate::report::plot::axis::drawable;
use crate::report::plot::canvas::{AFTER, BAND, BEFORE, CALIBRATED, Sign};

/// Draws the RMS over the held-out logs after each step; what a step closes is drawn faint behind its bar's end.
pub(super) fn waterfall(diagnosis: &Diagnosis) -> Result<String, ReportError> {
    let (steps, measure) = (steps(diagnosis), Measure::of(diagnosis.gap.unit));
    let above = |k: usize| Some(measure.scale * steps[k.checked_sub(1)?].rms).filter(|_| steps[k].kind != Kind::Floor);
    let bars = steps.iter().enumerate().map(|(k, step)| bar(step, measure, above(k))).collect();
    draw(&Bars {
        title: &format!("{}: {}", diagnosis.joint, heading(diagnosis).to_lowercase()),
        legend: vec![
            (Sign::Box, CALIBRATED.mix(0.3), "closed by recalibrating".to_owned()),
            (Sign::Box, AFTER.mix(0.3), "closed by a cause".to_owned()),
            (Sign::Line, BAND.to_rgba(), "the sensor's own noise".to_owned()),
        ],
        label: &format!("RMS of the {}, {} [{}]", measure.what, words::logs_of(&diagnosis.gap), measure.unit),
        columns: &[&*format!("RMS [{}]", measure.unit), "closes", "alone", "last"],
        bars,
        mark: Some(measure.scale * diagnosis.gap.floor).filter(|floor| drawable(*floor)),
        are_errors: true,
    })
}

fn bar(step: &Step<'_>, measure: Measure, down_from: Option<f64>) -> Bar {
    let colour = match step.kind {
        Kind::Given => BEFORE,
        Kind::Recalibrated => CALIBRATED,
        Kind::Cause | Kind::Law => AFTER,
        Kind::Floor => BAND,
    };
    let part = |share: Option<f64>| share.map_or_else(String::new, words::part);
    Bar {
        name: step.label(),
        value: measure.scale * step.rms,
        down_from,
        colour,
        bold: matches!(step.kind, Kind::Cause | Kind::Law),
        words: vec![measure.number(step.rms), part(step.closes), part(step.alone()), part(step.last())],
    }
}
