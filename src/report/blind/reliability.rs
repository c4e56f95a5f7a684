//! Stated probabilities against what came true.

use plotters::style::Color;
use plotters::style::text_anchor::HPos;

use crate::blind::Bin;
use crate::report::ReportError;
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    EXTENSIVE, Look, RIGHT, SHADE, Sign, block, chart, dots, filled, left, legend, line, notice, sketch, stroke, text,
    width,
};

const HEIGHT: f64 = 460.0;
const BAR_OPACITY: f64 = 0.25;
/// Half the width of an interval's bar, as a probability.
const HALF_BAR: f64 = 0.006;
/// From a dot to its words \[px\].
const BESIDE: f64 = 9.0;

/// Draws the share of right answers against the stated probability, with 95 % intervals and the number of answers.
pub(super) fn reliability(title: &str, bins: &[Bin]) -> Result<String, ReportError> {
    let (stated, right) = (Axis::between(0.0, 1.0), Axis::between(0.0, 1.0));
    sketch(title, HEIGHT, |root| {
        let names = [
            (Sign::Dot, EXTENSIVE.to_rgba(), "answers of one range of stated probability".to_owned()),
            (Sign::Box, EXTENSIVE.mix(BAR_OPACITY), "95 % interval".to_owned()),
            (Sign::Line, SHADE.to_rgba(), "as often right as stated".to_owned()),
        ];
        let top = legend(root, &names)?;
        let bottom = HEIGHT - 4.0;
        let mut chart =
            chart(root, (top, bottom), (&stated, &right), ("stated probability", "share of right answers"))?;
        line(&mut chart, &[(0.0, 0.0), (1.0, 1.0)], stroke(SHADE, 1.0))?;
        let seen = || bins.iter().filter_map(|bin| Some((bin.stated?, bin.right.share?, bin)));
        for (stated, share, bin) in seen() {
            let [low, high] = bin.right.interval;
            let (from, to) = ((stated - HALF_BAR).max(0.0), (stated + HALF_BAR).min(1.0));
            block(&mut chart, [(from, low), (to, high)], filled(EXTENSIVE, BAR_OPACITY))?;
            dots(&mut chart, &[(stated, share)], 4.0, filled(EXTENSIVE, 1.0))?;
        }
        for (stated, share, bin) in seen() {
            // The box of the chart: the y labels' room left, the x labels' below.
            let x = left() + stated * (width() - left() - RIGHT);
            let y = top + (1.0 - share) * (bottom - 42.0 - top);
            let words = format!("{} of {}", bin.right.hits, bin.right.of);
            // Beside its dot, on the side that has room, and off the axes.
            let look = Look { size: 11.0, ..Look::default() };
            let (x, anchor) = match x + BESIDE + look.width(&words) < width() - RIGHT {
                true => (x + BESIDE, HPos::Left),
                false => (x - BESIDE, HPos::Right),
            };
            text(root, (x, y.clamp(top + 8.0, bottom - 52.0)), &words, Look { anchor, ..look })?;
        }
        if seen().next().is_none() {
            notice(root, "no answer stated a probability")?;
        }
        Ok(())
    })
}
