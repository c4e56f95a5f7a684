//! Speed against angle.

use nalgebra::{Matrix3, Vector3};
use plotters::style::Color;

use super::axis::{Axis, drawable};
use super::canvas::{EXTENSIVE, MEASURED, MOST_POINTS, Sign, chart, dots, filled, legend, line, sketch, stroke};
use crate::report::{LogCurves, ReportError};

const HEIGHT: f64 = 520.0;
/// Half-width of the smoothing window \[s\]: a sixth of the period of the slowest reference swing, in which a 6 mrad
/// quantisation step at 8 ms leaves 0.02 rad/s of noise.
const WINDOW_S: f64 = 0.04;
/// Fewest samples on either side of the one whose speed is wanted.
const FEWEST: usize = 3;

/// Draws the phase portrait of one log: the extensive model as a line, the readings as dots.
///
/// The speed of the readings is the slope of a parabola fitted to the neighbouring samples, for the eye only; nothing is
/// fitted to it.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn phase_portrait(joint: &str, log: &LogCurves) -> Result<String, ReportError> {
    let first = log.first_fitted.min(log.t_s.len()).min(log.measured_rad.len());
    let length = log.t_s.len().min(log.measured_rad.len());
    let (t_s, angle_rad) = (&log.t_s[first..length], &log.measured_rad[first..length]);
    let measured: Vec<_> = evenly(t_s.len()).filter_map(|i| parabola(t_s, angle_rad, i)).collect();
    let predicted = log.extensive_rad.len().min(log.extensive_rate_rad_s.len());
    let model: Vec<_> = evenly(predicted).map(|i| (log.extensive_rad[i], log.extensive_rate_rad_s[i])).collect();
    let angle = Axis::over(measured.iter().chain(&model).map(|(angle, _)| *angle), 0.06);
    let rate = Axis::over(measured.iter().chain(&model).map(|(_, rate)| *rate), 0.06);

    sketch(&format!("{joint} phase portrait, {}", log.file), HEIGHT, |root| {
        let names = [
            (Sign::Dot, MEASURED.to_rgba(), "measured, speed from local parabolas".to_owned()),
            (Sign::Line, EXTENSIVE.to_rgba(), "extensive model".to_owned()),
        ];
        let top = legend(root, &names)?;
        let mut chart = chart(root, (top, HEIGHT - 4.0), (&angle, &rate), ("angle [rad]", "speed [rad/s]"))?;
        dots(&mut chart, &measured, 1.75, filled(MEASURED, 0.5))?;
        line(&mut chart, &model, stroke(EXTENSIVE, 1.5))
    })
}

/// Samples evenly spaced in number: unlike extremes, they keep a closed curve round.
fn evenly(length: usize) -> impl Iterator<Item = usize> {
    (0..length).step_by(length.div_ceil(MOST_POINTS).max(1))
}

/// Least-squares parabola around sample `i`: its value and slope there.
fn parabola(t_s: &[f64], angle_rad: &[f64], i: usize) -> Option<(f64, f64)> {
    let middle = t_s[i];
    let near = |j: &usize| (t_s[*j] - middle).abs() <= WINDOW_S || j.abs_diff(i) <= FEWEST;
    let before = (0..i).rev().take_while(near);
    let samples: Vec<usize> = before.chain((i..t_s.len()).take_while(near)).collect();
    let usable = || samples.iter().filter(|j| drawable(t_s[**j]) && drawable(angle_rad[**j]));
    let width = usable().map(|j| (t_s[*j] - middle).abs()).fold(0.0, f64::max);
    if usable().count() < FEWEST || width <= 0.0 {
        return None;
    }
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for j in usable() {
        let u = (t_s[*j] - middle) / width;
        let row = Vector3::new(1.0, u, u * u);
        normal += row * row.transpose();
        right += row * angle_rad[*j];
    }
    let fitted = normal.lu().solve(&right)?;
    Some((fitted[0], fitted[1] / width)).filter(|(angle, rate)| drawable(*angle) && drawable(*rate))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabola_finds_the_slope_of_a_quantised_sine() {
        // 0.3 sin(8 t) in 6 mrad steps: peak speed 2.4 rad/s; 2 % is lost to smoothing, 0.02 rad/s to quantisation
        let t_s: Vec<f64> = (0..400).map(|i| 0.008 * f64::from(i)).collect();
        let angle_rad: Vec<f64> = t_s.iter().map(|t| (0.3 * (8.0 * t).sin() / 0.006).round() * 0.006).collect();
        for (i, t) in t_s.iter().enumerate().take(380).skip(20) {
            let (_, rate) = parabola(&t_s, &angle_rad, i).expect("enough neighbours");
            approx::assert_abs_diff_eq!(rate, 2.4 * (8.0 * t).cos(), epsilon = 0.12);
        }
    }

    #[test]
    fn too_few_or_equal_times_give_no_slope() {
        assert_eq!(parabola(&[0.0, 1.0], &[0.0, 1.0], 0), None);
        assert_eq!(parabola(&[1.0; 5], &[0.0; 5], 2), None);
        assert_eq!(parabola(&[0.0, 1.0, 2.0, 3.0], &[f64::NAN; 4], 1), None);
    }
}
