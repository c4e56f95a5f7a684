//! One log's torques along its measured motion: what the drive gave against what models ask for.

use super::super::words;
use crate::gap::Diagnosis;
use crate::gap::inverse::TorqueTraces;
use crate::report::ReportError;
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    AFTER, BEFORE, CALIBRATED, INK, MEASURED, Sign, chart, dashed, legend, legend_end, line, sketch, stroke, thinned,
};
use plotters::style::{Color, RGBColor};

/// Heights of the panels \[px\].
const ABOVE: f64 = 250.0;
const BELOW: f64 = 190.0;

/// Draws one log, or a stretch of one.
pub(super) fn torques(diagnosis: &Diagnosis, log: &TorqueTraces, title: &str) -> Result<String, ReportError> {
    let mut models: Vec<(String, RGBColor, &[f64])> =
        vec![("as given".into(), BEFORE, &log.given_nm), ("recalibrated".into(), CALIBRATED, &log.calibrated_nm)];
    let causes: Vec<&str> = diagnosis.causes.iter().map(|cause| cause.effect.id()).collect();
    let law = diagnosis.law.as_ref().map(|_| "law");
    if !causes.is_empty() || law.is_some() {
        let named = words::answer(diagnosis);
        let words = named.unwrap_or_else(|| causes.iter().copied().chain(law).collect::<Vec<_>>().join(" + "));
        models.push((words, AFTER, &log.after_nm));
    }
    let left = |model: &[f64]| -> Vec<f64> { log.measured_nm.iter().zip(model).map(|(a, b)| a - b).collect() };
    let mut names = vec![(Sign::Line, MEASURED.to_rgba(), "drive".to_owned())];
    names.extend(models.iter().map(|(name, colour, _)| (Sign::Line, colour.to_rgba(), name.clone())));
    let time = Axis::over(log.t_s.iter().copied(), 0.0);
    let all = models.iter().flat_map(|(_, _, model)| model.iter().copied());
    let torque = Axis::over(all.chain(log.measured_nm.iter().copied()), 0.06);
    let leavings = models.iter().flat_map(|(_, _, model)| left(model));
    let error = Axis::over(leavings.chain([0.0]), 0.06);
    let top = legend_end(&names);
    let (middle, bottom) = (top + ABOVE, top + ABOVE + BELOW);
    sketch(title, bottom, |root| {
        legend(root, &names)?;
        let mut above = chart(root, (top, middle), (&time, &torque), ("", "torque [N m]"))?;
        line(&mut above, &thinned(&log.t_s, &log.measured_nm), stroke(MEASURED, 1.75))?;
        for (_, colour, model) in &models {
            line(&mut above, &thinned(&log.t_s, model), stroke(*colour, 1.25))?;
        }
        let mut below = chart(root, (middle + 6.0, bottom), (&time, &error), ("time [s]", "left over [N m]"))?;
        dashed(&mut below, (time.low(), time.high()), 0.0, stroke(INK, 0.75))?;
        for (_, colour, model) in &models {
            line(&mut below, &thinned(&log.t_s, &left(model)), stroke(*colour, 1.25))?;
        }
        Ok(())
    })
}
