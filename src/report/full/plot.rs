//! Figure 3.6 again: measurement, pendulum, whole robot.

use super::{FullCurves, FullDrop, causes_figure};
use crate::report::plot::canvas::{EXTENSIVE, GREEN, POSITIVE};
use crate::report::plot::overlay::{Curve, Overlay, overlay};
use crate::report::plot::plain;
use crate::report::{Figure, ReportError};

/// One figure for each log.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub(in crate::report) fn full_figures(joint: &str, full: &FullDrop) -> Result<Vec<Figure>, ReportError> {
    let figure = |(k, curves): (usize, &FullCurves)| {
        Ok(Figure {
            file_name: format!("full-{:02}-{}.svg", k + 1, plain(&curves.file)),
            title: format!("Figure 3.6, {}", curves.file),
            caption:
                "The measured drop, the fitted pendulum, and the whole robot refitted with rigid neighbours and with \
                      neighbours held by their PID; below, measured minus model."
                    .to_owned(),
            svg: draw(joint, curves)?,
        })
    };
    let mut figures: Vec<Figure> = full.curves.iter().enumerate().map(figure).collect::<Result<_, ReportError>>()?;
    if let Some(refit) = full.refit.as_ref().filter(|refit| refit.ranked()) {
        figures.insert(
            0,
            Figure {
                file_name: "full-causes.svg".into(),
                title: format!("{joint}: what the angle of rest needs"),
                caption: "Model less measurement at rest [mrad] by log, 0 where it is met: the nominal robot, each explanation alone, \
                          all but one, everything."
                    .into(),
                svg: causes_figure(joint, refit)?,
            },
        );
    }
    Ok(figures)
}

fn draw(joint: &str, curves: &FullCurves) -> Result<String, ReportError> {
    let models = [
        ("extensive pendulum", EXTENSIVE, &curves.pendulum_rad),
        ("robot refitted, others rigid", GREEN, &curves.rigid_rad),
        ("robot refitted, others by PID", POSITIVE, &curves.controlled_rad),
    ];
    let curve = |(name, colour, angle_rad): (&str, _, &'_ Vec<f64>)| (name.to_owned(), colour, angle_rad.clone());
    let owned = models.map(curve);
    overlay(&Overlay {
        title: &format!("{joint} drop, {}", curves.file),
        t_s: &curves.t_s,
        measured_rad: &curves.measured_rad,
        setpoint_rad: &[],
        models: owned
            .iter()
            .map(|(name, colour, angle_rad)| Curve {
                name: name.clone(),
                colour: *colour,
                angle_rad,
                first: curves.first,
            })
            .collect(),
        half_step_rad: curves.half_step_rad,
        shades: Vec::new(),
        shaded: "",
        torque: None,
    })
}
