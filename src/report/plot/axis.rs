//! Axes of all figures: range, ticks, labels.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use super::layout::is_narrow;
use crate::number::{extent, math};
use crate::report::number::as_given;

/// Range of an axis, its ticks and their labels.
#[derive(Clone)]
pub(in crate::report) struct Axis {
    low: f64,
    high: f64,
    ticks: Vec<(f64, String)>,
    is_log: bool,
}

impl Axis {
    /// An axis over all drawable values, widened by a share of its span on both sides.
    ///
    /// No value at all gives 0 to 1, a single value a little room on both sides.
    pub(in crate::report) fn over(values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let [low, high] = extent(values.into_iter().filter(|value| drawable(*value)));
        if low > high {
            return Self::between(0.0, 1.0);
        }
        let magnitude = low.abs().max(high.abs());
        if high - low <= 1e-9 * magnitude || high - low < 1e-250 {
            let room = if magnitude < 1e-200 { 1e-3 } else { 0.1 * magnitude };
            return Self::between(low - room, high + room);
        }
        let room = margin * (high - low);
        Self::between(low - room, high + room)
    }

    /// An axis between two limits, `low < high`, with ticks at multiples of 1, 2 or 5.
    pub(in crate::report) fn between(low: f64, high: f64) -> Self {
        let rough = (high - low) / if is_narrow() { 5.0 } else { 8.0 };
        let power = math::log10(rough).floor();
        let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * math::powf(10f64, power)).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(rough);
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
        let decimals = (-math::log10(step) - 1e-9).ceil().max(0.0) as usize;
        let plain = decimals <= 6 && low.abs().max(high.abs()) < 1e6;
        let label = |tick: f64| if plain { format!("{tick:.decimals$}") } else { short_exponent(tick, step) };
        let ticks = (first..=last).map(|k| k as f64 * step).map(|tick| (tick, label(tick).replace('-', "\u{2212}")));
        Self { low, high, ticks: ticks.collect(), is_log: false }
    }

    /// A logarithmic axis; its coordinates are the decimal logarithms.
    pub(in crate::report) fn decades(low: i32, high: i32) -> Self {
        let stride = ((high - low) / 7 + 1).max(1) as usize;
        let label = |exponent: i32| format!("10{}", superscript(exponent));
        let ticks = (low..=high).step_by(stride).map(|exponent| (f64::from(exponent), label(exponent))).collect();
        Self { low: f64::from(low), high: f64::from(high), ticks, is_log: true }
    }

    /// A logarithmic axis over all values above zero, with ticks at 1, 2 and 5, or at powers of ten over a wide range;
    /// its coordinates are the decimal logarithms.
    pub(in crate::report) fn logarithmic(values: impl IntoIterator<Item = f64>) -> Self {
        let mut axis = Self::over(values.into_iter().filter(|value| *value > 1e-100).map(math::log10), 0.05);
        axis.is_log = true;
        if axis.high - axis.low < 0.5 {
            let middle = 0.5 * (axis.low + axis.high);
            (axis.low, axis.high) = (middle - 0.25, middle + 0.25);
        }
        if axis.high - axis.low > 4.0 {
            return Self::decades(axis.low.floor() as i32, axis.high.ceil() as i32);
        }
        let (first, last) = (axis.low.floor() as i32, axis.high.ceil() as i32);
        let steps = (first..=last).flat_map(|power| [1.0, 2.0, 5.0].map(|step| step * 10f64.powi(power)));
        let ticks = steps.map(|tick| (math::log10(tick), as_given(tick)));
        axis.ticks = ticks.filter(|(at, _)| (axis.low..=axis.high).contains(at)).collect();
        if axis.ticks.len() < 3 {
            let linear = Self::between(math::powf(10f64, axis.low), math::powf(10f64, axis.high)).ticks;
            axis.ticks = linear.into_iter().map(|(tick, label)| (math::log10(tick), label)).collect();
        }
        axis
    }

    /// An axis that counts from `low` to `high`, with ticks at whole numbers.
    pub(in crate::report) fn counting(low: usize, high: usize) -> Self {
        let mut axis = Self::between(low as f64 - 0.5, high.max(low) as f64 + 0.5);
        axis.ticks.retain(|(tick, _)| tick.fract() == 0.0);
        for (tick, label) in &mut axis.ticks {
            *label = format!("{tick:.0}").replace('-', "\u{2212}");
        }
        axis
    }

    pub(in crate::report) fn low(&self) -> f64 {
        self.low
    }

    pub(in crate::report) fn high(&self) -> f64 {
        self.high
    }

    /// Whether its coordinates are decimal logarithms.
    pub(in crate::report) fn is_log(&self) -> bool {
        self.is_log
    }

    /// Places of the ticks and their labels.
    pub(in crate::report) fn ticks(&self) -> &[(f64, String)] {
        &self.ticks
    }

    /// Place of a value between 0 and 1, kept on the axis.
    pub(in crate::report) fn share(&self, at: f64) -> f64 {
        ((at - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    pub(in crate::report) fn label(&self, at: f64) -> String {
        self.ticks.iter().find(|(tick, _)| *tick == at).map(|(_, label)| label.clone()).unwrap_or_default()
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        // What lies absurdly far outside stays far outside, but must not overflow.
        let share = ((value - self.low) / (self.high - self.low)).clamp(-1e3, 1e3);
        limit.0 + (f64::from(limit.1 - limit.0) * share).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let ticks = if hint.weight().allow_light_points() { &[][..] } else { &self.ticks };
        ticks.iter().map(|(tick, _)| *tick).collect()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

/// Whether a value has a place on a figure at all.
pub(in crate::report) fn drawable(value: f64) -> bool {
    value.is_finite() && value.abs() < 1e100
}

/// `tick` with an exponent and no more digits than multiples of `step` need.
fn short_exponent(tick: f64, step: f64) -> String {
    if tick == 0.0 {
        return "0".to_owned();
    }
    let digits = (math::log10(tick.abs()).floor() - math::log10(step).floor()).clamp(0.0, 12.0) as usize;
    format!("{tick:.digits$e}")
}

fn superscript(number: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => digit.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(digit),
    };
    number.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_numbers_with_equal_decimals() {
        assert_eq!(labels(&Axis::between(-0.42, 0.41)), ["−0.4", "−0.2", "0.0", "0.2", "0.4"]);
        assert_eq!(labels(&Axis::between(0.0, 6.0)), ["0", "1", "2", "3", "4", "5", "6"]);
        assert_eq!(labels(&Axis::between(0.0, 2.5e-8)), ["0", "5e−9", "1.0e−8", "1.5e−8", "2.0e−8", "2.5e−8"]);
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten() {
        assert_eq!(labels(&Axis::decades(-12, 2)), ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰"]);
    }

    #[test]
    fn degenerate_ranges_get_room() {
        for values in [vec![], vec![f64::NAN], vec![0.0; 3], vec![7.5], vec![1.0, 1.0 + 1e-15], vec![-1e99, 1e99]] {
            let axis = Axis::over(values.iter().copied(), 0.05);
            assert!(axis.low < axis.high, "{values:?}");
            assert!((2..12).contains(&axis.ticks.len()), "{values:?}: {:?}", labels(&axis));
        }
    }

    #[test]
    fn logarithmic_ticks_of_a_narrow_range_are_plain_numbers() {
        let axis = Axis::logarithmic([1.7, 31.0, -1.0, f64::NAN]);
        assert_eq!(labels(&axis), ["2", "5", "10", "20"]);
        assert!(axis.low < 1.7f64.log10() && 31f64.log10() < axis.high);
        assert_eq!(labels(&Axis::logarithmic([1.9, 2.0, 2.1])), ["1.5", "2.0", "2.5", "3.0", "3.5"]);
        assert_eq!(labels(&Axis::logarithmic([1e-4, 1e3]))[0], "10⁻⁵");
    }

    proptest! {
        #[test]
        fn axes_hold_for_any_values(values in prop::collection::vec(prop::num::f64::ANY, 0..20)) {
            let axis = Axis::over(values, 0.05);
            prop_assert!(axis.low < axis.high && axis.low.is_finite() && axis.high.is_finite());
            prop_assert!(axis.ticks.len() < 20);
        }

        #[test]
        fn logarithmic_axes_hold_for_any_values(values in prop::collection::vec(prop::num::f64::ANY, 0..20)) {
            let axis = Axis::logarithmic(values);
            prop_assert!(axis.low < axis.high && axis.low.is_finite() && axis.high.is_finite());
            prop_assert!(axis.ticks.len() < 20);
        }
    }
}
