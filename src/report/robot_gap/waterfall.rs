//! From as given down to the sensor's noise, step by step: the same in text and figure.

use comfy_table::Cell;
use plotters::style::Color;

use super::words;
use crate::gap::robot::{RobotDiagnosis, RobotGap};
use crate::report::ReportError;
use crate::report::gap::plot::bars::{Bar, Bars, draw};
use crate::report::gap::text::{WIDTH, characters, paragraph};
use crate::report::measure::ANGLE;
use crate::report::number::share;
use crate::report::plot::axis::drawable;
use crate::report::plot::canvas::{AFTER, BAND, BEFORE, CALIBRATED, Sign};
use crate::report::text::{finish, number, table};

/// A gap that exceeds the floor by less than this factor is hardly one: shares of it would be numbers without meaning.
const HARDLY: f64 = 1.1;

/// What stands above the steps.
pub(super) const HEADING: &str = "From as given to the floor";
/// What they are.
pub(super) const EXPLANATION: &str = "RMS of the angle error over all joints and held-out samples. Recalibrated: masses, friction and floor moved \
    within what is uncertain anyway, nothing added. Closes: share of the whole gap above the floor, which is the sensor's own \
    noise.";

/// One step.
pub(super) struct Step {
    pub name: String,
    /// \[rad\]
    pub rms: f64,
    /// Share of the whole gap that it closes.
    pub closes: Option<f64>,
}

/// As given, recalibrated, with what was found, the noise.
pub(super) fn steps(diagnosis: &RobotDiagnosis) -> Vec<Step> {
    let RobotDiagnosis { answer, gap, .. } = diagnosis;
    let RobotGap { before, calibrated, after_first, after, floor, .. } = *gap;
    let mut steps = vec![("as given".to_owned(), before), ("recalibrated".to_owned(), calibrated)];
    if let (Some(first), Some(_)) = (&answer.first, &answer.second) {
        steps.push((format!("with {}", words::found(first)), after_first));
    }
    steps.extend(words::answer(answer).map(|answer| (answer, after)));
    let whole = before - floor;
    let mut above = None;
    let step = |(name, rms): (String, f64)| {
        let closes = above.filter(|_| before > HARDLY * floor).map(|above: f64| (above - rms) / whole);
        above = Some(rms);
        Step { name, rms, closes: closes.filter(|share| share.is_finite()) }
    };
    let mut steps: Vec<Step> = steps.into_iter().map(step).collect();
    steps.push(Step { name: "floor".to_owned(), rms: floor, closes: None });
    steps
}

/// The steps for a terminal, each with a bar.
pub(super) fn text(diagnosis: &RobotDiagnosis) -> String {
    let steps = steps(diagnosis);
    let longest = steps.iter().map(|step| step.rms).filter(|rms| rms.is_finite()).fold(0.0, f64::max);
    let mut table = table(WIDTH, &["step", ""], &[&*ANGLE.over("RMS"), "closes"]);
    for step in &steps {
        table.add_row([
            Cell::new(&step.name),
            Cell::new(characters(step.rms, longest)),
            number(ANGLE.number(step.rms)),
            number(step.closes.map_or_else(String::new, share)),
        ]);
    }
    format!("{HEADING}:\n{}\n{}", finish(&mut table), paragraph(EXPLANATION))
}

/// The steps as bars; what a step closes is drawn faint behind its bar's end.
pub(super) fn figure(diagnosis: &RobotDiagnosis) -> Result<String, ReportError> {
    let steps = steps(diagnosis);
    let last = steps.len() - 1;
    let bar = |(k, step): (usize, &Step)| Bar {
        name: step.name.clone(),
        value: 1e3 * step.rms,
        down_from: k.checked_sub(1).filter(|_| k < last).map(|above| 1e3 * steps[above].rms),
        colour: match k {
            0 => BEFORE,
            1 => CALIBRATED,
            _ if k == last => BAND,
            _ => AFTER,
        },
        bold: k > 1 && k < last,
        words: vec![ANGLE.number(step.rms), step.closes.map_or_else(String::new, share)],
    };
    draw(&Bars {
        title: &format!("{}: {}", diagnosis.robot, HEADING.to_lowercase()),
        legend: vec![
            (Sign::Box, CALIBRATED.mix(0.3), "closed by recalibrating".to_owned()),
            (Sign::Box, AFTER.mix(0.3), "closed by a cause".to_owned()),
            (Sign::Line, BAND.to_rgba(), "the sensor's own noise".to_owned()),
        ],
        label: "RMS of the angle error over all joints, held-out samples [mrad]",
        columns: &["RMS [mrad]", "closes"],
        bars: steps.iter().enumerate().map(bar).collect(),
        mark: Some(1e3 * diagnosis.gap.floor).filter(|floor| drawable(*floor)),
        are_errors: true,
    })
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn shares_of_all_steps_are_what_the_answer_closes() {
        for (name, report) in sample::all() {
            let gap = &report.diagnosis.gap;
            let steps = steps(&report.diagnosis);
            let closes: f64 = steps.iter().filter_map(|step| step.closes).sum();
            let lowest = &steps[steps.len() - 2];
            if gap.before > HARDLY * gap.floor {
                let whole = (gap.before - lowest.rms) / (gap.before - gap.floor);
                assert!((closes - whole).abs() < 1e-9, "{name}: {closes} of {whole}");
            }
            assert_eq!((&*steps[0].name, &*steps[steps.len() - 1].name), ("as given", "floor"));
        }
    }
}
