//! One log: what was measured, what the models say, and what is left over.

use super::canvas::MODEL_COLOURS;
use super::overlay::{Curve, Overlay, overlay, with_rms};
use crate::report::{LogCurves, ReportError};

/// Draws one log: readings as dots, models as lines, below them the residuals with the band of half a quantisation step.
///
/// The time before the release is shaded. Residuals are measured minus model.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn swing(joint: &str, log: &LogCurves) -> Result<String, ReportError> {
    let models =
        [("simple", &log.simple_rad, log.simple_rms_rad), ("extensive", &log.extensive_rad, log.extensive_rms_rad)];
    overlay(&Overlay {
        title: &format!("{joint} swing, {} ({})", log.file, log.role),
        t_s: &log.t_s,
        measured_rad: &log.measured_rad,
        setpoint_rad: log.setpoint_rad.as_deref().unwrap_or(&[]),
        models: models
            .into_iter()
            .zip(MODEL_COLOURS)
            .map(|((name, angle_rad, rms_rad), colour)| Curve {
                name: with_rms(name, rms_rad),
                colour,
                angle_rad,
                first: log.first_fitted,
            })
            .collect(),
        half_step_rad: log.half_step_rad,
        shades: held_phase(log).into_iter().collect(),
        shaded: "held, not fitted",
        torque: None,
    })
}

/// From the first sample to the first fitted one; `None` where nothing was held.
fn held_phase(log: &LogCurves) -> Option<[f64; 2]> {
    let end = log.first_fitted.min(log.t_s.len().checked_sub(1)?);
    let phase = [log.t_s[0], log.t_s[end]];
    (phase[0] < phase[1] && phase.iter().all(|t| t.is_finite())).then_some(phase)
}
