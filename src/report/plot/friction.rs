//! Friction torque against speed.

use plotters::style::Color;

use super::axis::Axis;
use super::canvas::{
    BAND_OPACITY, EXTENSIVE, INK, Sign, band, band_name, chart, filled, legend, line, notice, sketch, stroke,
};
use crate::report::{FrictionPoint, ReportError};

const HEIGHT: f64 = 440.0;

/// Draws the friction torque of the extensive model against speed, with its 95 % band.
///
/// Points are drawn in the order given; a value that is not finite leaves a gap, and so does standing still between two
/// points of opposite directions, where friction takes any value up to breaking loose.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn friction_curve(joint: &str, points: &[FrictionPoint]) -> Result<String, ReportError> {
    let speed = Axis::over(points.iter().map(|point| point.rate_rad_s), 0.02);
    let torques = points.iter().flat_map(|point| [point.torque_nm, point.low_nm, point.high_nm]);
    let torque = Axis::over(torques.chain([0.0]), 0.06);

    let limits: Vec<_> = points.iter().map(|point| (point.rate_rad_s, point.low_nm, point.high_nm)).collect();
    let band_words = band_name(&limits, &torque, HEIGHT - 120.0, "N m");
    sketch(&format!("{joint} friction against speed"), HEIGHT, |root| {
        let names = [
            (Sign::Line, EXTENSIVE.to_rgba(), "extensive model".to_owned()),
            (Sign::Box, EXTENSIVE.mix(BAND_OPACITY), band_words),
        ];
        let top = legend(root, &names)?;
        let labels = ("speed [rad/s]", "friction torque [N m]");
        let mut chart = chart(root, (top, HEIGHT - 4.0), (&speed, &torque), labels)?;
        line(&mut chart, &[(speed.low(), 0.0), (speed.high(), 0.0)], stroke(INK, 0.5))?;
        for piece in points.chunk_by(|a, b| a.rate_rad_s * b.rate_rad_s >= 0.0) {
            let limits: Vec<_> = piece.iter().map(|point| (point.rate_rad_s, point.low_nm, point.high_nm)).collect();
            let curve: Vec<_> = piece.iter().map(|point| (point.rate_rad_s, point.torque_nm)).collect();
            band(&mut chart, &limits, filled(EXTENSIVE, BAND_OPACITY))?;
            line(&mut chart, &curve, stroke(EXTENSIVE, 1.75))?;
        }
        if points.is_empty() {
            notice(root, "these logs do not determine the scale of the friction torque")?;
        }
        Ok(())
    })
}
