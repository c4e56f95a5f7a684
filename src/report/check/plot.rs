//! Figures of a log's health: what was read and asked, when it was stamped, how its noise hangs together.

use plotters::style::Color;

use super::LogSeries;
use crate::log::Day;
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    EXTENSIVE, INK, LEGEND_END, MEASURED, SETPOINT, Sign, chart, dashed, dots, filled, legend, line, sketch, stroke,
    thin, thinned,
};
use crate::report::plot::plain;
use crate::report::{Figure, LogHealthRow, ReportError};

/// Heights of the panels \[px\].
const ANGLES: f64 = 240.0;
const STEPS: f64 = 150.0;
const NOISE: f64 = 220.0;

/// Readings and setpoints of a joint's log `k` over time, and below them the step from stamp to stamp.
pub(super) fn series(joint: &str, k: usize, row: &LogHealthRow, series: &LogSeries) -> Result<Figure, ReportError> {
    let title = format!("{joint}: {} ({})", row.file, row.role);
    let (t0_s, time) = beginning(&series.t_s);
    let since = |stamps_s: &[f64]| stamps_s.iter().map(|t_s| t_s - t0_s).collect::<Vec<_>>();
    let (t_s, asked_s) = (since(&series.t_s), since(&series.asked_s));
    let t = Axis::over(t_s.iter().copied(), 0.01);
    let angle = Axis::over(series.q_rad.iter().chain(&series.asked_rad).copied(), 0.05);
    let steps_ms: Vec<f64> = series.t_s.windows(2).map(|pair| 1e3 * (pair[1] - pair[0])).collect();
    let step = Axis::over(steps_ms.iter().copied().chain([0.0]), 0.06);
    let middle = LEGEND_END + ANGLES;
    let svg = sketch(&title, middle + STEPS, |root| {
        let mut names = vec![(Sign::Dot, MEASURED.to_rgba(), "reading".to_owned())];
        if !series.asked_s.is_empty() {
            names.push((Sign::Line, SETPOINT.to_rgba(), "setpoint".to_owned()));
        }
        let top = legend(root, &names)?;
        let mut panel = chart(root, (top, middle), (&t, &angle), ("", "angle [rad]"))?;
        line(&mut panel, &held(&asked_s, &series.asked_rad), stroke(SETPOINT, 1.25))?;
        dots(&mut panel, &thinned(&t_s, &series.q_rad), 1.25, filled(MEASURED, 0.8))?;
        let mut panel = chart(root, (middle + 6.0, middle + STEPS - 4.0), (&t, &step), (time.as_str(), "step [ms]"))?;
        dots(&mut panel, &thinned(&t_s[1.min(t_s.len())..], &steps_ms), 1.25, filled(EXTENSIVE, 0.8))
    })?;
    let caption = "Above: what was read, and what was asked, each at its own stamps. Below: the time from each stamp to the \
                   next; a level line is a steady clock, what stands above it are lost samples and holes.";
    let file_name = format!("health-{}-{:02}-{}.svg", plain(joint), k + 1, plain(&row.file));
    Ok(Figure { file_name, title, caption: caption.to_owned(), svg })
}

/// The time from which a figure counts \[s\], and how it says so: from the first stamp where stamps count from 1970, whose
/// numbers are too long to be read off an axis.
fn beginning(t_s: &[f64]) -> (f64, String) {
    match t_s.first() {
        Some(first_s) if Day::of_epoch_s(*first_s).is_some() => (*first_s, format!("time since {first_s:.3} [s]")),
        _ => (0.0, "time [s]".to_owned()),
    }
}

/// A setpoint stays until the next one.
fn held(t_s: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let kept = thin(values);
    let mut points: Vec<(f64, f64)> = Vec::with_capacity(2 * kept.len());
    for k in kept {
        points.extend(points.last().map(|(_, before)| (t_s[k], *before)));
        points.push((t_s[k], values[k]));
    }
    points
}

/// The correlation of the noise at rest with itself; `None` where no log tells it.
pub(super) fn noise(joint: &str, rows: &[LogHealthRow]) -> Result<Option<Figure>, ReportError> {
    let told: Vec<&LogHealthRow> = rows.iter().filter(|row| !row.more.noise_correlation.is_empty()).collect();
    let Some(widest_s) = told.iter().map(|row| lag_s(row, row.more.noise_correlation.len() - 1)).reduce(f64::max)
    else {
        return Ok(None);
    };
    let title = format!("{joint}: noise at rest against itself");
    let lag = Axis::between(0.0, 1e3 * widest_s.max(1e-6));
    let of = Axis::between(-0.4, 1.05);
    let height = LEGEND_END + NOISE;
    let svg = sketch(&title, height, |root| {
        let top = legend(
            root,
            &[(Sign::Line, EXTENSIVE.to_rgba(), "each log that stands still for long enough".to_owned())],
        )?;
        let mut panel = chart(root, (top, height - 4.0), (&lag, &of), ("later by [ms]", "correlation"))?;
        dashed(&mut panel, (0.0, 1e3 * widest_s), 0.0, stroke(INK, 0.75))?;
        for row in &told {
            let points = row.more.noise_correlation.iter().enumerate().map(|(k, value)| (1e3 * lag_s(row, k), *value));
            line(&mut panel, &points.collect::<Vec<_>>(), stroke(EXTENSIVE, 1.0))?;
        }
        Ok(())
    })?;
    let caption = "Noise that falls to zero within one reading is white; noise that stays above it hangs together over that \
                   time, as filtered readings and trembling joints do.";
    Ok(Some(Figure { file_name: format!("noise-{}.svg", plain(joint)), title, caption: caption.to_owned(), svg }))
}

fn lag_s(row: &LogHealthRow, lag: usize) -> f64 {
    lag as f64 * row.period_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_of_one_name_have_figures_of_their_own_and_stamps_since_1970_count_from_the_first() {
        let row =
            |file: &str| LogHealthRow { file: file.to_owned(), ..crate::report::sample::single().health[0].clone() };
        let of = |from_s: f64| LogSeries {
            t_s: (0..50).map(|k| from_s + 0.01 * f64::from(k)).collect(),
            q_rad: (0..50).map(f64::from).collect(),
            asked_s: vec![from_s],
            asked_rad: vec![1.0],
        };
        let [a, b] =
            [("a/x y.csv", 0), ("a/x_y.csv", 1)].map(|(file, k)| series("q", k, &row(file), &of(0.0)).unwrap());
        assert_ne!(a.file_name, b.file_name);
        let [plain, late] =
            [0.0, 1_772_323_200.0].map(|from_s| series("q", 0, &row("a.csv"), &of(from_s)).unwrap().svg);
        assert!(plain.contains("time [s]") && late.contains("time since 1772323200.000 [s]"));
    }
}
