//! What was measured against what models say, above, and what is left over, below.

use plotters::style::{Color, RGBColor};

use super::axis::{Axis, drawable};
use super::canvas::{
    BAND, Chart, Drawn, INK, LEGEND_END, LegendEntry, MEASURED, SETPOINT, SHADE, Sign, band, block, chart, dots,
    filled, legend, legend_end, line, sketch, stroke, thin, thinned,
};
use crate::report::ReportError;
use crate::report::number::significant;

/// Heights of the upper panel, of a panel below it, and of the time axis \[px\].
const ANGLE_PANEL: f64 = 270.0;
const LOWER_PANEL: f64 = 130.0;
const TIME_AXIS: f64 = 42.0;
const SHADE_OPACITY: f64 = 0.18;
const BAND_OPACITY: f64 = 0.28;
/// Residuals of so few samples are drawn as larger dots.
const FEW: usize = 300;
/// Where one model's residuals are so many times larger than another's, each of the two gets a panel of its own.
const TOO_UNEQUAL: f64 = 8.0;

/// A log with the curves of models.
pub(in crate::report) struct Overlay<'a> {
    pub title: &'a str,
    pub t_s: &'a [f64],
    pub measured_rad: &'a [f64],
    /// Empty where there is none.
    pub setpoint_rad: &'a [f64],
    pub models: Vec<Curve<'a>>,
    /// Half a quantisation step; 0 where it is unknown.
    pub half_step_rad: f64,
    /// Spans of time that are set off, and what they are.
    pub shades: Vec<[f64; 2]>,
    pub shaded: &'a str,
    /// A panel of its own at the bottom.
    pub torque: Option<TorqueCurve<'a>>,
}

/// One model's prediction.
pub(in crate::report) struct Curve<'a> {
    pub name: String,
    pub colour: RGBColor,
    pub angle_rad: &'a [f64],
    /// Residuals begin with this sample.
    pub first: usize,
}

/// A torque with its uncertainty; a value that is not finite leaves a gap.
pub(in crate::report) struct TorqueCurve<'a> {
    pub name: &'a str,
    pub t_s: &'a [f64],
    pub torque_nm: &'a [f64],
    /// Half-width of its 95 % band.
    pub half_width_nm: Vec<f64>,
}

/// Name of a curve with the RMS of its residual, where there is one.
pub(in crate::report) fn with_rms(name: &str, rms_rad: f64) -> String {
    match rms_rad.is_finite() {
        true => format!("{name}, RMS {} mrad", significant(1e3 * rms_rad, 3)),
        false => name.to_owned(),
    }
}

/// Draws readings as dots and models as lines, below them the residuals (measured minus model) with the band of half a
/// quantisation step, at the bottom a torque.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub(in crate::report) fn overlay(log: &Overlay<'_>) -> Result<String, ReportError> {
    let residuals: Vec<Vec<f64>> = log.models.iter().map(|model| residual_mrad(log, model)).collect();
    let panels = residual_panels(&residuals);
    let time = Axis::over(log.t_s.iter().copied(), 0.01);
    let drawn = log.models.iter().map(|model| model.angle_rad).chain([log.measured_rad, log.setpoint_rad]);
    let angle = Axis::over(drawn.flatten().copied(), 0.06);
    let names = names(log);
    let legend_end = legend_end(&names).max(LEGEND_END);
    let lower = panels.len() + usize::from(log.torque.is_some());
    let height = legend_end + ANGLE_PANEL + LOWER_PANEL * lower as f64 + TIME_AXIS;

    sketch(log.title, height, |root| {
        let top = legend(root, &names)?;
        let mut bottom = legend_end + ANGLE_PANEL;
        let mut upper = chart(root, (top, bottom), (&time, &angle), ("", "angle [rad]"))?;
        shade(&mut upper, log, &angle)?;
        dots(&mut upper, &thinned(log.t_s, log.measured_rad), 2.25, filled(MEASURED, 0.45))?;
        for model in &log.models {
            line(&mut upper, &thinned(log.t_s, model.angle_rad), stroke(model.colour, 1.25))?;
        }
        line(&mut upper, &thinned(log.t_s, log.setpoint_rad), stroke(SETPOINT, 1.25))?;

        for i in 0..lower {
            let is_last = i + 1 == lower;
            let end = bottom + LOWER_PANEL + if is_last { TIME_AXIS - 4.0 } else { 0.0 };
            let time_label = if is_last { "time [s]" } else { "" };
            let place = |axis: &Axis, label: &str| chart(root, (bottom, end), (&time, axis), (time_label, label));
            match (panels.get(i), &log.torque) {
                (Some(panel), _) => {
                    let axis = residual_axis(log, &residuals, panel);
                    residual_panel(&mut place(&axis, "residual [mrad]")?, log, (&time, &axis), &residuals, panel)?;
                }
                (None, Some(torque)) => {
                    let axis = torque_axis(torque);
                    torque_panel(&mut place(&axis, "torque [N m]")?, log, (&time, &axis), torque)?;
                }
                (None, None) => {}
            }
            bottom = end;
        }
        Ok(())
    })
}

fn shade(chart: &mut Chart<'_, '_>, log: &Overlay<'_>, axis: &Axis) -> Drawn {
    for [from, to] in &log.shades {
        block(chart, [(*from, axis.low()), (*to, axis.high())], filled(SHADE, SHADE_OPACITY))?;
    }
    Ok(())
}

fn half_step_mrad(log: &Overlay<'_>) -> f64 {
    if log.half_step_rad.is_finite() { 1e3 * log.half_step_rad.abs() } else { 0.0 }
}

fn residual_axis(log: &Overlay<'_>, residuals: &[Vec<f64>], panel: &[usize]) -> Axis {
    let half_step = half_step_mrad(log);
    let spread = panel.iter().flat_map(|model| residuals[*model].iter().copied());
    Axis::over(spread.chain([-1.2 * half_step, 1.2 * half_step]), 0.06)
}

fn residual_panel(
    chart: &mut Chart<'_, '_>,
    log: &Overlay<'_>,
    (time, axis): (&Axis, &Axis),
    residuals: &[Vec<f64>],
    panel: &[usize],
) -> Drawn {
    let half_step = half_step_mrad(log);
    shade(chart, log, axis)?;
    if half_step > 0.0 {
        block(chart, [(time.low(), -half_step), (time.high(), half_step)], filled(BAND, BAND_OPACITY))?;
    }
    line(chart, &[(time.low(), 0.0), (time.high(), 0.0)], stroke(INK, 0.5))?;
    for model in panel {
        let colour = log.models[*model].colour;
        let radius = if log.t_s.len() < FEW { 2.0 } else { 1.0 };
        dots(chart, &thinned(log.t_s, &residuals[*model]), radius, filled(colour, 0.85))?;
    }
    Ok(())
}

/// From the torque itself; its band may reach out by as much again where little is known, and is cut there.
fn torque_axis(torque: &TorqueCurve<'_>) -> Axis {
    let middle = Axis::over(torque.torque_nm.iter().copied().chain([0.0]), 0.5);
    let ends = torque.torque_nm.iter().zip(&torque.half_width_nm).flat_map(|(at, half)| [at - half, at + half]);
    let within = ends.filter(|end| drawable(*end)).map(|end| end.clamp(middle.low(), middle.high()));
    Axis::over(within.chain(torque.torque_nm.iter().copied()).chain([0.0]), 0.06)
}

fn torque_panel(
    chart: &mut Chart<'_, '_>,
    log: &Overlay<'_>,
    (time, axis): (&Axis, &Axis),
    torque: &TorqueCurve<'_>,
) -> Drawn {
    shade(chart, log, axis)?;
    let length = torque.t_s.len().min(torque.torque_nm.len()).min(torque.half_width_nm.len());
    let kept = thin(&torque.torque_nm[..length]);
    let cut = |value: f64| if value.is_nan() { value } else { value.clamp(axis.low(), axis.high()) };
    let limits = |i: &usize| {
        let (at, half) = (torque.torque_nm[*i], torque.half_width_nm[*i]);
        (torque.t_s[*i], cut(at - half), cut(at + half))
    };
    band(chart, &kept.iter().map(limits).collect::<Vec<_>>(), filled(TORQUE, BAND_OPACITY))?;
    line(chart, &[(time.low(), 0.0), (time.high(), 0.0)], stroke(INK, 0.5))?;
    let middle: Vec<_> = kept.iter().map(|i| (torque.t_s[*i], torque.torque_nm[*i])).collect();
    line(chart, &middle, stroke(TORQUE, 1.25))
}

const TORQUE: RGBColor = super::canvas::POSITIVE;

/// Which models share a residual panel: those before whose residuals the largest does not flatten the smallest.
fn residual_panels(residuals: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let reach = |residual: &[f64]| residual.iter().filter(|r| drawable(**r)).fold(0.0f64, |most, r| most.max(r.abs()));
    let reaches: Vec<f64> = residuals.iter().map(|residual| reach(residual)).collect();
    let mut panels: Vec<Vec<usize>> = Vec::new();
    for (model, reach) in reaches.iter().enumerate() {
        let fits = |panel: &Vec<usize>| {
            let all = panel.iter().map(|other| reaches[*other]).chain([*reach]).filter(|reach| *reach > 0.0);
            let (low, high) = all.fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(r), high.max(r)));
            high <= TOO_UNEQUAL * low
        };
        match panels.iter_mut().find(|panel| fits(panel)) {
            Some(panel) => panel.push(model),
            None => panels.push(vec![model]),
        }
    }
    panels
}

fn names(log: &Overlay<'_>) -> Vec<LegendEntry> {
    let mut names = vec![(Sign::Dot, MEASURED.to_rgba(), "measured".to_owned())];
    names.extend(log.models.iter().map(|model| (Sign::Line, model.colour.to_rgba(), model.name.clone())));
    if !log.setpoint_rad.is_empty() {
        names.push((Sign::Line, SETPOINT.to_rgba(), "setpoint".to_owned()));
    }
    let half_step = half_step_mrad(log);
    if half_step > 0.0 {
        let words = format!("± half a quantisation step ({} mrad)", significant(half_step, 2));
        names.push((Sign::Box, BAND.mix(BAND_OPACITY), words));
    }
    if let Some(torque) = &log.torque {
        names.push((Sign::Line, TORQUE.to_rgba(), torque.name.to_owned()));
    }
    if !log.shades.is_empty() {
        names.push((Sign::Box, SHADE.mix(2.0 * SHADE_OPACITY), log.shaded.to_owned()));
    }
    names
}

/// Measured minus model, NaN before the model's first sample.
fn residual_mrad(log: &Overlay<'_>, model: &Curve<'_>) -> Vec<f64> {
    let difference = |(i, (measured, angle)): (usize, (&f64, &f64))| match i < model.first {
        true => f64::NAN,
        false => 1e3 * (measured - angle),
    };
    log.measured_rad.iter().zip(model.angle_rad).take(log.t_s.len()).enumerate().map(difference).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_of_unlike_size_do_not_share_a_panel() {
        let of = |size: f64| vec![size, -size, f64::NAN];
        assert_eq!(residual_panels(&[of(1.0), of(7.0)]), [[0, 1]]);
        assert_eq!(residual_panels(&[of(1.0), of(9.0)]), [[0], [1]]);
        assert_eq!(residual_panels(&[of(30.0), of(20.0), of(2.0)]), [vec![0, 1], vec![2]]);
        assert_eq!(residual_panels(&[of(30.0), of(f64::NAN), of(0.0)]), [[0, 1, 2]]);
    }
}
