//! How the optimiser got to its answer.

use plotters::style::Color;

use super::axis::{Axis, drawable};
use super::canvas::{MODEL_COLOURS, Sign, chart, dots, filled, legend, line, notice, sketch, stroke};
use crate::number::math;
use crate::report::{ModelSummary, ReportError};

const HEIGHT: f64 = 400.0;
/// Below this share of where it ends the criterion tells nothing: the lower edge of the figure.
const LEAST: f64 = 1e-6;
/// The figure reaches up to this share at least.
const MOST: f64 = 1e-2;

/// Draws how far the best criterion so far lies above where it ends, as a share of that, logarithmically, against the
/// iteration; what is below a millionth stands on the lower edge.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn optimiser_trace(joint: &str, models: &[ModelSummary]) -> Result<String, ReportError> {
    let traces: Vec<_> = models.iter().map(|model| above_end(&model.trace_rad2_s)).collect();
    let longest = traces.iter().map(Vec::len).max().unwrap_or(0);
    let high = traces.iter().flatten().map(|(_, above)| math::log10(*above)).fold(math::log10(MOST), f64::max);
    let floor = math::log10(LEAST);
    let nothing = traces.iter().flatten().all(|(_, above)| *above <= LEAST);
    let value = Axis::decades(floor as i32, (high.ceil() as i32).clamp(floor as i32 + 2, 300));
    let iteration = Axis::counting(0, longest.saturating_sub(1));

    sketch(&format!("{joint} optimiser"), HEIGHT, |root| {
        let names = models.iter().zip(MODEL_COLOURS).map(|(m, colour)| (Sign::Line, colour.to_rgba(), name(m)));
        let top = legend(root, &names.collect::<Vec<_>>())?;
        let labels = ("iteration", "best J so far above its end, share of it");
        let mut chart = chart(root, (top, HEIGHT - 4.0), (&iteration, &value), labels)?;
        for (trace, colour) in traces.iter().zip(MODEL_COLOURS) {
            let points: Vec<_> = trace.iter().map(|(i, above)| (*i as f64, math::log10(*above))).collect();
            line(&mut chart, &points, stroke(colour, 1.25))?;
            dots(&mut chart, &points, 3.0, filled(colour, 1.0))?;
        }
        if nothing {
            notice(root, "it began where it ended")?;
        }
        Ok(())
    })
}

fn name(model: &ModelSummary) -> String {
    format!("{}: {}, {}, {} evaluations", model.name, model.method, model.stop, model.evaluations)
}

/// Iterations from 0, the start, and how far the best one so far lies above the end as a share of it, no less than
/// [`LEAST`]; the first that is no more ends the trace.
fn above_end(trace: &[f64]) -> Vec<(usize, f64)> {
    let finite = || trace.iter().enumerate().filter(|(_, value)| drawable(**value));
    let end = finite().map(|(_, value)| *value).fold(f64::INFINITY, f64::min);
    let mut best = f64::INFINITY;
    let mut above = Vec::new();
    for (i, value) in finite() {
        best = best.min(*value);
        let share = (best - end) / end.abs().max(1e-280);
        above.push((i, share.clamp(LEAST, 1e100)));
        if share <= LEAST {
            break;
        }
    }
    above
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trace_never_rises_and_ends_where_nothing_is_gained_any_more() {
        let trace = above_end(&[3.0, f64::NAN, 1.5, 2.0, 1.0 + 1e-15, 1.0, 1.4]);
        assert_eq!(trace, [(0, 2.0), (2, 0.5), (3, 0.5), (4, LEAST)]);
        assert!(above_end(&[]).is_empty());
    }
}
