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

/// Height of a line of words \[px\].
const LINE: f64 = 13.0;

/// The height at which words from one x to another do not run into those that stand there already, which they join: at `y`,
/// or lines away from the nearer of the two edges.
fn beside_others(taken: &mut Vec<[f64; 3]>, [from, to]: [f64; 2], (top, bottom): (f64, f64), y: f64) -> f64 {
    let step = if y < 0.5 * (top + bottom) { LINE } else { -LINE };
    let mut y = y.clamp(top, bottom);
    while taken.iter().any(|other| from < other[1] && other[0] < to && (y - other[2]).abs() < LINE) {
        y += step;
    }
    taken.push([from, to, y]);
    y
}

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
        let mut taken: Vec<[f64; 3]> = Vec::new();
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
            let from = if matches!(anchor, HPos::Left) { x } else { x - look.width(&words) };
            let y = beside_others(&mut taken, [from, from + look.width(&words)], (top + 8.0, bottom - 52.0), y);
            text(root, (x, y), &words, Look { anchor, ..look })?;
        }
        if seen().next().is_none() {
            notice(root, "no answer stated a probability")?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_near_dots_stand_one_below_the_other() {
        let mut taken = Vec::new();
        let mut at = |x: f64, y: f64| beside_others(&mut taken, [x, x + 35.0], (50.0, 400.0), y);
        assert_eq!([at(100.0, 40.0), at(120.0, 40.0), at(200.0, 40.0), at(130.0, 55.0)], [50.0, 63.0, 50.0, 81.0]);
        assert_eq!([at(100.0, 500.0), at(110.0, 500.0)], [400.0, 387.0]);
    }
}
