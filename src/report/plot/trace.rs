//! How the optimiser got to its answer.

use plotters::style::Color;

use super::axis::{Axis, drawable};
use super::canvas::{MODEL_COLOURS, Sign, chart, dots, filled, legend, line, notice, sketch, stroke};
use crate::report::{ModelSummary, ReportError};

const HEIGHT: f64 = 400.0;
/// Differences below this share of the criterion are rounding, not progress.
const ROUNDING: f64 = 1e-12;

/// Draws the criterion of each model above its own minimum, logarithmically, against the iteration.
///
/// Iterations at the minimum have no logarithm; they stand on the lower edge.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn optimiser_trace(joint: &str, models: &[ModelSummary]) -> Result<String, ReportError> {
    let traces: Vec<_> = models.iter().map(|model| above_minimum(&model.trace_rad2_s)).collect();
    let longest = models.iter().map(|model| model.trace_rad2_s.len()).max().unwrap_or(0);
    let logs = || traces.iter().flatten().filter_map(|(_, above)| above.map(f64::log10));
    let (low, high) = logs().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let nothing = low > high;
    let floor = if nothing { -3 } else { low.floor() as i32 - 1 };
    let ceiling = if nothing { 0 } else { (high.ceil() as i32).max(floor + 2) };
    let value = Axis::decades(floor, ceiling);
    let iteration = Axis::counting(0, longest.saturating_sub(1));

    sketch(&format!("{joint} optimiser"), HEIGHT, |root| {
        let names = models.iter().zip(MODEL_COLOURS).map(|(m, colour)| (Sign::Line, colour.to_rgba(), name(m)));
        let top = legend(root, &names.collect::<Vec<_>>())?;
        let labels = ("iteration (on the lower edge: at the minimum)", "J above its minimum [rad² s]");
        let mut chart = chart(root, (top, HEIGHT - 4.0), (&iteration, &value), labels)?;
        for (trace, colour) in traces.iter().zip(MODEL_COLOURS) {
            let place = |(i, above): &(usize, Option<f64>)| (*i as f64, above.map_or(f64::from(floor), f64::log10));
            let points: Vec<_> = trace.iter().map(place).collect();
            line(&mut chart, &points, stroke(colour, 1.25))?;
            dots(&mut chart, &points, 3.0, filled(colour, 1.0))?;
        }
        if nothing {
            notice(root, "no iteration lies above the minimum")?;
        }
        Ok(())
    })
}

fn name(model: &ModelSummary) -> String {
    format!("{}: {}, {}, {} evaluations", model.name, model.method, model.stop, model.evaluations)
}

/// Iterations from 0, the start, and how far each lies above the lowest; `None` for those that do not.
fn above_minimum(trace: &[f64]) -> Vec<(usize, Option<f64>)> {
    let finite = || trace.iter().enumerate().filter(|(_, value)| drawable(**value));
    let least = finite().map(|(_, value)| *value).fold(f64::INFINITY, f64::min);
    let above = |value: f64| Some(value - least).filter(|above| *above > ROUNDING * least.abs() && *above > 1e-280);
    finite().map(|(i, value)| (i, above(*value))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn iterations_at_the_minimum_or_lost_in_rounding_have_no_height() {
        let trace = above_minimum(&[3.0, f64::NAN, 1.0 + 1e-15, 1.0]);
        assert_eq!(trace, [(0, Some(2.0)), (2, None), (3, None)]);
        assert!(above_minimum(&[]).is_empty());
    }
}
