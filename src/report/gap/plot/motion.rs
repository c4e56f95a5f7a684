//! The motion of the next experiment.

use crate::report::ReportError;
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{SETPOINT, chart, line, sketch, stroke, thinned};

const HEIGHT: f64 = 280.0;

/// Draws a setpoint against time.
pub(super) fn motion(joint: &str, t_s: &[f64], q_ref_rad: &[f64]) -> Result<String, ReportError> {
    let time = Axis::over(t_s.iter().copied(), 0.01);
    let setpoint = Axis::over(q_ref_rad.iter().copied(), 0.08);
    sketch(&format!("{joint}: motion of the next experiment"), HEIGHT, |root| {
        let mut chart = chart(root, (36.0, HEIGHT - 4.0), (&time, &setpoint), ("time [s]", "setpoint [rad]"))?;
        line(&mut chart, &thinned(t_s, q_ref_rad), stroke(SETPOINT, 1.5))
    })
}
