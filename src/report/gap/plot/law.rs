//! The curve of a law without a formula.

use crate::number::chance::HALF_95;
use plotters::style::Color;

use super::figure;
use crate::joint::{Curve, LawActs, LawTable, LawVariable};
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    AFTER, BAND_OPACITY, INK, MEASURED, Sign, band, band_name, chart, dashed, dots, filled, legend, line, notice,
    sketch, stroke,
};
use crate::report::rows::typeset_unit;
use crate::report::{Figure, ReportError};

const HEIGHT: f64 = 400.0;
/// Points of the curve.
const POINTS: usize = 400;
/// Height of the ticks under the knots, as a share of the axis.
const TICK: f64 = 0.05;
/// Share of the width that the curve is drawn beyond its ends, where it is constant.
const BEYOND: f64 = 0.04;

/// Draws a law against its variable, with its knots.
///
/// `sd` are standard deviations of the table's values and may be missing; a table that is no law gives a figure that says
/// so.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn law_figure(joint: &str, law: &LawTable, sd: Option<&[f64]>) -> Result<Figure, ReportError> {
    let what = what(law.acts);
    let by = law.variable().map_or("several variables", variable_words);
    let title = format!("{joint}: {what} against the {by}");
    let mut caption =
        "What no effect with a formula describes, as a curve through its knots; beyond them it is taken as \
                       constant."
            .to_owned();
    if !law.looks_like.is_empty() {
        caption += &format!(" Its shape: {}.", law.looks_like);
    }
    let svg = drawing(&title, law, sd)?;
    Ok(figure("law", &format!("The law: {what} against the {by}"), &caption, svg))
}

fn drawing(title: &str, law: &LawTable, sd: Option<&[f64]>) -> Result<String, ReportError> {
    let (Ok(variable), Ok(curve)) = (law.variable(), law.law()) else {
        return sketch(title, HEIGHT, |root| notice(root, "the table is no law"));
    };
    let (x, y) = (&law.table.x, &law.table.y);
    let [from, to] = [x[0], x[x.len() - 1]];
    let at = Axis::over([from, to], BEYOND);
    let on_curve = |k: usize| at.low() + (at.high() - at.low()) * k as f64 / (POINTS - 1) as f64;
    let points: Vec<(f64, f64)> = (0..POINTS).map(|k| (on_curve(k), curve.at(on_curve(k)))).collect();
    let knots: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    let sd = sd.and_then(|sd| Curve::new(x[..].into(), sd).ok());
    let width = |sd: &Curve<f64>, place: f64| HALF_95 * sd.value(place).max(0.0);
    let limits: Vec<(f64, f64, f64)> = sd
        .iter()
        .flat_map(|sd| points.iter().filter(|(x, _)| (from..=to).contains(x)).map(move |point| (sd, point)))
        .map(|(sd, (x, y))| (*x, y - width(sd, *x), y + width(sd, *x)))
        .collect();
    let ends = limits.iter().flat_map(|(_, low, high)| [*low, *high]);
    let value = Axis::over(points.iter().map(|(_, y)| *y).chain(ends).chain([0.0]), 0.08);

    let band_words = band_name(&limits, &value, HEIGHT - 120.0, &typeset_unit(unit(law.acts)));
    sketch(title, HEIGHT, |root| {
        let mut names =
            vec![(Sign::Line, AFTER.to_rgba(), "law".to_owned()), (Sign::Dot, AFTER.to_rgba(), "its knots".to_owned())];
        if !limits.is_empty() {
            names.push((Sign::Box, AFTER.mix(BAND_OPACITY), band_words));
        }
        let top = legend(root, &names)?;
        let x_label = format!("{} [{}]", axis_words(law.acts, variable), typeset_unit(variable.unit()));
        let y_label = format!("{} [{}]", what(law.acts), typeset_unit(unit(law.acts)));
        let mut chart = chart(root, (top, HEIGHT - 4.0), (&at, &value), (&x_label, &y_label))?;
        let foot = |share: f64| value.low() + share * (value.high() - value.low());
        for (place, _) in &knots {
            line(&mut chart, &[(*place, foot(0.0)), (*place, foot(TICK))], stroke(MEASURED, 1.25))?;
        }
        dashed(&mut chart, (at.low(), at.high()), 0.0, stroke(INK, 0.75))?;
        band(&mut chart, &limits, filled(AFTER, BAND_OPACITY))?;
        line(&mut chart, &points, stroke(AFTER, 1.75))?;
        dots(&mut chart, &knots, 2.75, filled(AFTER, 1.0))
    })
}

fn what(acts: LawActs) -> &'static str {
    match acts {
        LawActs::Torque => "added torque",
        LawActs::Friction => "added friction",
        LawActs::Reading => "shift of the reading",
        LawActs::Gain => "added share of the motor's torque",
    }
}

fn unit(acts: LawActs) -> &'static str {
    if acts.unit().is_empty() { "-" } else { acts.unit() }
}

fn variable_words(variable: LawVariable) -> &'static str {
    match variable {
        LawVariable::Load => "gravity torque",
        LawVariable::MotorTorque => "motor torque",
        LawVariable::SetpointRate => "rate of the setpoint",
        LawVariable::Time => "time since the log began",
        other => other.name(),
    }
}

/// The same, for the axis: friction knows the size of most variables alone.
fn axis_words(acts: LawActs, variable: LawVariable) -> String {
    let words = variable_words(variable);
    match (acts, variable) {
        (LawActs::Friction, LawVariable::Load | LawVariable::MotorTorque) => format!("size of the {words}"),
        _ => words.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::plot::tests::texts;

    fn cogging() -> LawTable {
        let x: Vec<f64> = (0..=40).map(|k| f64::from(k) * 0.05 - 1.0).collect();
        let y = x.iter().map(|q| 0.03 * (std::f64::consts::TAU * q / 0.4).sin() - 0.02 * q).collect();
        LawTable::new(LawVariable::Angle, LawActs::Torque, x, y)
    }

    #[test]
    fn a_law_is_drawn_with_its_axes_its_band_and_its_knots() {
        let law = LawTable { looks_like: "repeats every 0.40 rad".into(), ..cogging() };
        let drawn = law_figure("knee", &law, Some(&[0.004; 41])).unwrap();
        assert_eq!(drawn.file_name, "law.svg");
        assert!(drawn.caption.ends_with("Its shape: repeats every 0.40 rad."), "{}", drawn.caption);
        let texts_of = texts(&drawn.svg);
        let labels = ["knee: added torque against the angle", "angle [rad]", "added torque [N m]", "95 % band"];
        for label in labels.iter().chain(&["law", "its knots"]) {
            assert!(texts_of.iter().any(|text| text == label), "{label}: {texts_of:?}");
        }
        let bare = law_figure("knee", &cogging(), None).unwrap();
        assert!(!texts(&bare.svg).iter().any(|text| text.contains("band")));
    }

    #[test]
    fn any_table_gives_a_sound_figure() {
        for variable in LawVariable::ALL {
            for acts in LawActs::ALL {
                for y in [vec![0.0; 3], vec![-0.3, 0.1, 0.2], vec![1e30, -1e30, 0.0]] {
                    let law = LawTable::new(variable, acts, vec![0.0, 1.0, 5.0], y);
                    let drawn = law_figure("<joint>", &law, Some(&[f64::NAN, 0.1, 1e200])).unwrap();
                    assert!(!texts(&drawn.svg).is_empty());
                }
            }
        }
        let none = LawTable { variables: Vec::new(), ..cogging() };
        let drawn = law_figure("knee", &none, None).unwrap();
        assert!(texts(&drawn.svg).iter().any(|text| text == "the table is no law"));
    }
}
