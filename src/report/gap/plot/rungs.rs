//! From as given down to the floor for a whole robot: what is left after each step, as numbers and as bars.

use plotters::style::Color;

use super::bars::{Bar, Bars, draw};
use crate::report::ReportError;
use crate::report::gap::waterfall::HARDLY;
use crate::report::measure::Measure;
use crate::report::number::share;
use crate::report::plot::axis::drawable;
use crate::report::plot::canvas::{AFTER, BAND, BEFORE, CALIBRATED, Sign};

/// One step.
pub(in crate::report) struct Rung {
    pub name: String,
    /// What is left after it, in the gap's unit.
    pub rms: f64,
    /// Share of the whole gap above the floor that it closes; `None` where it closes none by its nature.
    pub closes: Option<f64>,
}

/// Steps from as given, recalibrated and on with what was found, each with what it leaves; the floor is added.
pub(in crate::report) fn rungs(steps: Vec<(String, f64)>, floor: f64) -> Vec<Rung> {
    let before = steps.first().map_or(f64::NAN, |(_, rms)| *rms);
    let mut above = None;
    let rung = |(name, rms): (String, f64)| {
        let closes = above.filter(|_| before > HARDLY * floor).map(|above: f64| (above - rms) / (before - floor));
        above = Some(rms);
        Rung { name, rms, closes: closes.filter(|share| share.is_finite()) }
    };
    let mut rungs: Vec<Rung> = steps.into_iter().map(rung).collect();
    rungs.push(Rung { name: "floor".to_owned(), rms: floor, closes: None });
    rungs
}

/// The steps as bars; what a step closes is drawn faint behind its bar's end.
pub(in crate::report) fn draw_rungs(
    title: &str,
    label: &str,
    measure: Measure,
    rungs: &[Rung],
) -> Result<String, ReportError> {
    let last = rungs.len().saturating_sub(1);
    let scaled = |rung: &Rung| measure.scale * rung.rms;
    let bar = |(k, rung): (usize, &Rung)| Bar {
        name: rung.name.clone(),
        value: scaled(rung),
        down_from: k.checked_sub(1).filter(|_| k < last).map(|above| scaled(&rungs[above])),
        colour: match k {
            0 => BEFORE,
            1 => CALIBRATED,
            _ if k == last => BAND,
            _ => AFTER,
        },
        bold: k > 1 && k < last,
        words: vec![measure.number(rung.rms), rung.closes.map_or_else(String::new, share)],
    };
    draw(&Bars {
        title,
        legend: vec![
            (Sign::Box, CALIBRATED.mix(0.3), "closed by recalibrating".to_owned()),
            (Sign::Box, AFTER.mix(0.3), "closed by a cause".to_owned()),
            (Sign::Line, BAND.to_rgba(), "the sensor's own noise".to_owned()),
        ],
        label,
        columns: &[&*format!("RMS [{}]", measure.unit), "closes"],
        bars: rungs.iter().enumerate().map(bar).collect(),
        mark: rungs.last().map(scaled).filter(|floor| drawable(*floor)),
        are_errors: true,
    })
}
