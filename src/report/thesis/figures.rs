//! Figures 3.2, 3.3, 3.5 and 3.6 redrawn, and one for each answer.

use plotters::style::{Color, RGBColor};

use super::ThesisReport;
use super::plane::{positive_mass, ratio_plane};
use crate::identify::{Experiment, Prediction};
use crate::report::ReportError;
use crate::report::number::percent;
use crate::report::plot::Figure;
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    EXTENSIVE, LEGEND_END, POSITIVE, SHADE, SIMPLE, Sign, chart, legend, line, sketch, stroke,
};
use crate::report::plot::heat::{Heat, HeatCell, heat, tint};
use crate::report::plot::overlay::{Curve, Overlay, overlay, with_rms};
use crate::thesis::{Drop, Knee, Shoulder};

/// Draws every figure, in the order of the page.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn thesis_figures(report: &ThesisReport) -> Result<Vec<Figure>, ReportError> {
    let tables = &report.tables;
    let mut figures = Vec::new();
    let mut add = |name: &str, title: &str, caption: &str, svg: String| {
        let [file_name, title, caption] = [format!("{name}.svg"), title.to_owned(), caption.to_owned()];
        figures.push(Figure { file_name, title, caption, svg });
    };
    if let (Some(swings), Some(ratios)) = (tables.swings.first(), tables.ratios.first())
        && let (Some(load), Some(fit)) = (swings.loaded().last(), ratios.fits.last())
        && let (Some(e), Some(prediction)) = (load.moving.first(), fit.predictions.first())
    {
        let title = "Figure 3.2: right front shoulder (q1) and the simple pendulum (3.2)";
        let caption = "The simple model swings on where Coulomb friction lets the leg rest.";
        add("figure-3-2", title, caption, swing(title, e, "simple", SIMPLE, prediction)?);
    }
    add(
        "figure-3-3",
        "Figure 3.3: equation 3.5",
        "Only the wedge between equal ratios and M_1/M_2 has a positive mass. Filled: printed; rings of colour: ours.",
        positive_mass(tables)?,
    );
    if let (Some(swings), Some(weighed)) = (tables.swings.first(), tables.weighed.first()) {
        let all = swings.moving();
        let loaded = swings.loaded().last().and_then(|load| load.moving.first());
        let at = loaded.and_then(|e| all.iter().position(|other| other.file == e.file));
        if let Some((e, prediction)) = at.and_then(|k| Some((&all[k], weighed.fit.predictions.get(k)?))) {
            let title = "Figure 3.5: the same swing and the extensive pendulum (3.13)";
            let caption = "One fit to all swings about q1, with Coulomb and viscous friction.";
            add("figure-3-5", title, caption, swing(title, e, "extensive", EXTENSIVE, prediction)?);
        }
    }
    if let Some(drop) = &tables.drop {
        let caption = "The whole robot with the values of Tables 3.2 and 3.4, from the angle at which it was held; nothing is \
                       fitted to this drop.";
        add("figure-3-6", "Figure 3.6: drop about q1 with the chosen values", caption, drop_figure(drop)?);
    }
    for joint in &tables.puzzle.joints {
        let title = format!("Table 3.1 about {}: what moves the ratios where", joint.joint);
        let caption = "Each line is one candidate alone over its range, from Table 3.3's friction. Below the dashed line \
                       (3.5) gives a negative mass.";
        add(&format!("puzzle-{}", joint.joint), &title, caption, ratio_plane(&title, joint)?);
    }
    if let Some(knee) = &tables.knee {
        let title = "The bare lower leg let go level";
        add(
            "bare-knee",
            title,
            "It stays with Table 3.3's Coulomb friction and falls with Table 3.4's.",
            knee_figure(title, knee)?,
        );
    }
    if let Some(shoulder) = &tables.shoulder {
        let title = "Share of the shoulder in the bare leg's inertia about q1";
        let caption = "Per cent; columns: q2 [rad], outward; rows: q3 [rad], within their software limits. A bench good to 1 % leaves the shoulder's \
                       mass open by 1 % over this share.";
        add("shoulder-share", title, caption, share_figure(title, shoulder)?);
    }
    Ok(figures)
}

/// One swing and one model, with the residuals below.
fn swing(
    title: &str,
    e: &Experiment,
    name: &str,
    colour: RGBColor,
    prediction: &Prediction,
) -> Result<String, ReportError> {
    overlay(&Overlay {
        title,
        t_s: &e.t_s,
        measured_rad: &e.measured_rad,
        setpoint_rad: &[],
        models: vec![Curve {
            name: with_rms(name, prediction.rms_rad),
            colour,
            angle_rad: &prediction.angle_rad,
            first: e.uncompared,
        }],
        half_step_rad: 0.5 * e.resolution_rad,
        shades: Vec::new(),
        shaded: "",
        torque: None,
    })
}

fn drop_figure(drop: &Drop) -> Result<String, ReportError> {
    overlay(&Overlay {
        title: "Figure 3.6: drop about q1, the whole robot with the chosen values",
        t_s: &drop.t_s,
        measured_rad: &drop.measured_rad,
        setpoint_rad: &[],
        models: [("others rigid", EXTENSIVE, &drop.rigid), ("others by PID", POSITIVE, &drop.controlled)]
            .into_iter()
            .map(|(name, colour, robot)| Curve {
                name: with_rms(name, robot.rms_rad),
                colour,
                angle_rad: &robot.model_rad,
                first: 1,
            })
            .collect(),
        half_step_rad: 0.0,
        shades: Vec::new(),
        shaded: "",
        torque: None,
    })
}

fn knee_figure(title: &str, knee: &Knee) -> Result<String, ReportError> {
    let time = Axis::over(knee.t_s.iter().copied(), 0.01);
    let angle = Axis::over(knee.angle_rad.iter().flatten().copied().chain([0.0]), 0.08);
    let name = |table: &str, k: usize| format!("Table {table}: {} N m", knee.coulomb_nm[k]);
    let names =
        vec![(Sign::Line, EXTENSIVE.to_rgba(), name("3.3", 0)), (Sign::Line, POSITIVE.to_rgba(), name("3.4", 1))];
    sketch(title, 380.0, |root| {
        let top = legend(root, &names)?;
        let labels = ("time [s]", "angle from hanging [rad]");
        let mut chart = chart(root, (top.max(LEGEND_END - 19.0), 376.0), (&time, &angle), labels)?;
        for (angles, colour) in knee.angle_rad.iter().zip([EXTENSIVE, POSITIVE]) {
            let points: Vec<(f64, f64)> = knee.t_s.iter().copied().zip(angles.iter().copied()).collect();
            line(&mut chart, &points, stroke(colour, 1.75))?;
        }
        line(&mut chart, &[(time.low(), 0.0), (time.high(), 0.0)], stroke(SHADE, 0.5))
    })
}

fn share_figure(title: &str, shoulder: &Shoulder) -> Result<String, ReportError> {
    let rounded = |angle: f64| format!("{angle:.2}");
    let mut columns: Vec<String> = Vec::new();
    let mut rows: Vec<String> = Vec::new();
    for (q2, q3, _) in &shoulder.poses {
        for (names, angle) in [(&mut columns, q2), (&mut rows, q3)] {
            if !names.contains(&rounded(*angle)) {
                names.push(rounded(*angle));
            }
        }
    }
    let shares: Vec<f64> = shoulder.poses.iter().map(|(_, _, share)| *share).collect();
    let most = shares.iter().copied().fold(1e-9, f64::max);
    let highest = percent(most);
    let count = rows.len();
    let map = Heat {
        title,
        rows: &rows,
        columns: &columns,
        axes: ["", ""],
        names_above: true,
        name_room: 60.0,
        cell: [48.0, 24.0],
        colour: |of_most| tint(EXTENSIVE, of_most),
        scale: &[(1.0, &highest), (0.0, "0 %")],
        nothing: "no poses",
    };
    heat(&map, |row, column| {
        let share = shares.get(column * count + row).copied().unwrap_or(f64::NAN);
        HeatCell {
            ground: tint(EXTENSIVE, share / most),
            words: format!("{:.0}", 100.0 * share),
            framed: share == most,
        }
    })
}
