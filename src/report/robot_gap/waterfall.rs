//! From as given down to the sensor's noise, step by step: the same in text and figure.

use super::words;
use crate::gap::robot::{RobotDiagnosis, RobotGap};
use crate::report::ReportError;
use crate::report::gap::plot::rungs::{Rung, draw_rungs, rungs};
use crate::report::gap::text::{WIDTH, characters, paragraph};
use crate::report::measure::ANGLE;
use crate::report::number::share;
use crate::report::text::{finish, number, table};
use comfy_table::Cell;

/// What stands above the steps.
pub(super) const HEADING: &str = "From as given to the floor";
/// What they are.
pub(super) const EXPLANATION: &str = "RMS of the angle error over all joints and held-out samples. Recalibrated: masses, friction and floor moved \
    within what is uncertain anyway, nothing added. Closes: share of the whole gap above the floor, which is the sensor's own \
    noise.";

/// As given, recalibrated, with what was found, the noise.
pub(super) fn steps(diagnosis: &RobotDiagnosis) -> Vec<Rung> {
    let RobotDiagnosis { answer, gap, .. } = diagnosis;
    let RobotGap { before, calibrated, after_first, after, floor, .. } = *gap;
    let mut steps = vec![("as given".to_owned(), before), ("recalibrated".to_owned(), calibrated)];
    if let (Some(first), Some(_)) = (&answer.first, &answer.second) {
        steps.push((format!("with {}", words::found(first)), after_first));
    }
    steps.extend(words::answer(answer).map(|answer| (answer, after)));
    rungs(steps, floor)
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

/// The steps as bars.
pub(super) fn figure(diagnosis: &RobotDiagnosis) -> Result<String, ReportError> {
    let title = format!("{}: {}", diagnosis.robot, HEADING.to_lowercase());
    let label = "RMS of the angle error over all joints, held-out samples [mrad]";
    draw_rungs(&title, label, ANGLE, &steps(diagnosis))
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;
    use crate::report::gap::waterfall::HARDLY;

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
