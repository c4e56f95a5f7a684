//! One log: what was measured, what the models say, and what is left over.

use plotters::style::{Color, RGBAColor};

use super::canvas::{
    Axis, BAND, Chart, INK, LEGEND_END, MEASURED, MODEL_COLOURS, SETPOINT, SHADE, Sign, block, chart, dots, drawable,
    filled, legend, line, sketch, stroke, thinned,
};
use crate::report::number::significant;
use crate::report::{LogCurves, ReportError};

/// Heights of the upper panel, of a residual panel, and of the time axis \[px\].
const ANGLE_PANEL: f64 = 270.0;
const RESIDUAL_PANEL: f64 = 130.0;
const TIME_AXIS: f64 = 42.0;
const SHADE_OPACITY: f64 = 0.18;
const BAND_OPACITY: f64 = 0.28;
/// Where one model's residuals are so many times larger than the other's, each model gets a panel of its own.
const TOO_UNEQUAL: f64 = 8.0;

/// Draws one log: readings as dots, models as lines, below them the residuals with the band of half a quantisation step.
///
/// The time before the release is shaded. Residuals are measured minus model.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn swing(joint: &str, log: &LogCurves) -> Result<String, ReportError> {
    let title = format!("{joint} swing, {} ({})", log.file, log.role);
    let models = [&log.simple_rad, &log.extensive_rad];
    let setpoint = log.setpoint_rad.as_deref().unwrap_or(&[]);
    let residuals = models.map(|model| residual_mrad(log, model));
    let half_step_mrad = if log.half_step_rad.is_finite() { 1e3 * log.half_step_rad.abs() } else { 0.0 };
    let panels = residual_panels(&residuals);

    let time = Axis::over(log.t_s.iter().copied(), 0.01);
    let drawn = [&log.measured_rad[..], &log.simple_rad, &log.extensive_rad, setpoint];
    let angle = Axis::over(drawn.into_iter().flatten().copied(), 0.06);
    let held = held_phase(log);
    let shade = |chart: &mut Chart<'_, '_>, axis: &Axis| match held {
        Some([from, to]) => block(chart, [(from, axis.low()), (to, axis.high())], filled(SHADE, SHADE_OPACITY)),
        None => Ok(()),
    };
    let height = LEGEND_END + ANGLE_PANEL + RESIDUAL_PANEL * panels.len() as f64 + TIME_AXIS;

    sketch(&title, height, |root| {
        let top = legend(root, &names(log, half_step_mrad, held.is_some()))?;
        let mut bottom = LEGEND_END + ANGLE_PANEL;
        let mut upper = chart(root, (top, bottom), (&time, &angle), ("", "angle [rad]"))?;
        shade(&mut upper, &angle)?;
        dots(&mut upper, &thinned(&log.t_s, &log.measured_rad), 2.25, filled(MEASURED, 0.45))?;
        line(&mut upper, &thinned(&log.t_s, setpoint), stroke(SETPOINT, 1.25))?;
        for (model, colour) in models.into_iter().zip(MODEL_COLOURS) {
            line(&mut upper, &thinned(&log.t_s, model), stroke(colour, 1.25))?;
        }

        for (i, panel) in panels.iter().enumerate() {
            let is_last = i + 1 == panels.len();
            let end = bottom + RESIDUAL_PANEL + if is_last { TIME_AXIS - 4.0 } else { 0.0 };
            let spread = panel.iter().flat_map(|model| residuals[*model].iter().copied());
            let axis = Axis::over(spread.chain([-1.2 * half_step_mrad, 1.2 * half_step_mrad]), 0.06);
            let time_label = if is_last { "time [s]" } else { "" };
            let mut lower = chart(root, (bottom, end), (&time, &axis), (time_label, "residual [mrad]"))?;
            shade(&mut lower, &axis)?;
            if half_step_mrad > 0.0 {
                let corners = [(time.low(), -half_step_mrad), (time.high(), half_step_mrad)];
                block(&mut lower, corners, filled(BAND, BAND_OPACITY))?;
            }
            line(&mut lower, &[(time.low(), 0.0), (time.high(), 0.0)], stroke(INK, 0.5))?;
            for model in panel {
                let colour = MODEL_COLOURS[*model];
                dots(&mut lower, &thinned(&log.t_s, &residuals[*model]), 1.0, filled(colour, 0.85))?;
            }
            bottom = end;
        }
        Ok(())
    })
}

/// Which models share a residual panel: both, or each has its own where the larger would flatten the smaller.
fn residual_panels(residuals: &[Vec<f64>; 2]) -> Vec<Vec<usize>> {
    let reach = |residual: &[f64]| residual.iter().filter(|r| drawable(**r)).fold(0.0f64, |most, r| most.max(r.abs()));
    let [simple, extensive] = [reach(&residuals[0]), reach(&residuals[1])];
    match simple.min(extensive) > 0.0 && simple.max(extensive) > TOO_UNEQUAL * simple.min(extensive) {
        true => vec![vec![0], vec![1]],
        false => vec![vec![0, 1]],
    }
}

fn names(log: &LogCurves, half_step_mrad: f64, held: bool) -> Vec<(Sign, RGBAColor, String)> {
    let model = |name: &str, rms_rad: f64| match rms_rad.is_finite() {
        true => format!("{name}, RMS {} mrad", significant(1e3 * rms_rad, 3)),
        false => name.to_owned(),
    };
    let mut names = vec![
        (Sign::Dot, MEASURED.to_rgba(), "measured".to_owned()),
        (Sign::Line, MODEL_COLOURS[0].to_rgba(), model("simple", log.simple_rms_rad)),
        (Sign::Line, MODEL_COLOURS[1].to_rgba(), model("extensive", log.extensive_rms_rad)),
    ];
    if log.setpoint_rad.is_some() {
        names.push((Sign::Line, SETPOINT.to_rgba(), "setpoint".to_owned()));
    }
    if half_step_mrad > 0.0 {
        let words = format!("± half a quantisation step ({} mrad)", significant(half_step_mrad, 2));
        names.push((Sign::Box, BAND.mix(BAND_OPACITY), words));
    }
    if held {
        names.push((Sign::Box, SHADE.mix(2.0 * SHADE_OPACITY), "held, not fitted".to_owned()));
    }
    names
}

/// From the first sample to the first fitted one; `None` where nothing was held.
fn held_phase(log: &LogCurves) -> Option<[f64; 2]> {
    let end = log.first_fitted.min(log.t_s.len().checked_sub(1)?);
    let phase = [log.t_s[0], log.t_s[end]];
    (phase[0] < phase[1] && phase.iter().all(|t| t.is_finite())).then_some(phase)
}

/// Measured minus model on the fitted samples, NaN before them.
fn residual_mrad(log: &LogCurves, model: &[f64]) -> Vec<f64> {
    let difference = |(i, (measured, model)): (usize, (&f64, &f64))| match i < log.first_fitted {
        true => f64::NAN,
        false => 1e3 * (measured - model),
    };
    let length = log.t_s.len();
    log.measured_rad.iter().zip(model).take(length).enumerate().map(difference).collect()
}
