//! Numbers: for people, with as many digits as the uncertainty allows and never more; and functions and distributions that
//! are the same bits everywhere.

pub(crate) mod chance;
pub(crate) mod math;
mod said;
mod sincos;

pub(crate) use said::{between, capital, quantity, share, share_percents, shares, spoken, stands_out, whole_percents};
pub(crate) use sincos::{LARGEST_RAD, Lanes, in_quadrant, of_rest, sin_cos};

/// Gravity where nothing states it \[m/s^2\].
pub(crate) const STANDARD_GRAVITY_M_S2: f64 = 9.81;

/// Shown where there is no number to show.
pub(crate) const UNKNOWN: &str = "unknown";

/// Most digits that any number is shown with, however narrow its interval.
const MOST_DIGITS: i32 = 12;

/// An estimate and its interval, all three rounded at the same digit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WithUncertainty {
    /// The estimate.
    pub value: String,
    /// Lower end of the interval.
    pub low: String,
    /// Upper end of the interval.
    pub high: String,
}

/// Writes an estimate and its interval with two significant digits of the interval's half-width.
///
/// Of an asymmetric interval the narrower side counts, so that both ends stay apart from the estimate, but no more
/// than three digits finer than the wider side asks for. Plain decimals are used from 1e-4 to 1e5, for zero, and
/// where six decimals are enough; an exponent shared by all three numbers elsewhere. Without a usable width the estimate
/// gets four digits; what is not a number reads `unknown`.
///
/// ```
/// let shown = aibo_fit::report::format_with_uncertainty(9.1234e-4, [8.9e-4, 9.4e-4]);
/// assert_eq!((shown.value.as_str(), shown.low.as_str(), shown.high.as_str()), ("0.000912", "0.000890", "0.000940"));
/// ```
pub fn format_with_uncertainty(value: f64, interval: [f64; 2]) -> WithUncertainty {
    let [low, high] = interval;
    let width = narrow_width(value, low, high);
    let magnitude = if value.is_finite() { value.abs().max(width.unwrap_or(0.0)) } else { width.unwrap_or(0.0) };
    let last = match width {
        Some(width) => exponent(width, 2) - 1,
        None => exponent(magnitude, 4) - 3,
    };
    let digits = Digits::new(magnitude, last);
    WithUncertainty { value: digits.write(value), low: digits.write(low), high: digits.write(high) }
}

/// The lowest and the highest of values; NaN is passed over, and of no values it is infinity and minus infinity.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(none, |[low, high], value| [low.min(value), high.max(value)])
}

/// Writes a number with the given count of significant digits, in plain decimals from 1e-4 to 1e5.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    let magnitude = value.abs();
    Digits::new(magnitude, exponent(magnitude, digits) - digits + 1).write(value)
}

/// An angle in milliradians.
pub(crate) fn mrad(rad: f64) -> String {
    format!("{} mrad", significant(1e3 * rad, 3))
}

/// A torque in newton metres.
pub(crate) fn newton_metres(nm: f64) -> String {
    format!("{} N m", significant(nm, 3))
}

/// A share as a whole percentage; from 99 to 100 % with a decimal, because the rest is what matters there.
pub(crate) fn percent(share: f64) -> String {
    if !share.is_finite() {
        return UNKNOWN.to_owned();
    }
    let decimals = usize::from((0.99..0.9995).contains(&share));
    let text = format!("{:.decimals$} %", 100.0 * share);
    if text == "-0 %" { "0 %".to_owned() } else { text }
}

/// Like [`significant`], without zeros at the end: for numbers that somebody typed.
pub(crate) fn as_given(value: f64) -> String {
    let text = significant(value, 6);
    let (mantissa, tail) = match text.find('e') {
        Some(at) => text.split_at(at),
        None => (text.as_str(), ""),
    };
    if !mantissa.contains('.') {
        return text;
    }
    format!("{}{tail}", mantissa.trim_end_matches('0').trim_end_matches('.'))
}

/// The width that decides the digits; `None` where the interval has none.
fn narrow_width(value: f64, low: f64, high: f64) -> Option<f64> {
    let usable = |width: &f64| width.is_finite() && *width > 0.0;
    let sides = [value - low, high - value];
    if sides.iter().any(|side| *side < 0.0) {
        return Some(0.5 * (high - low)).filter(usable);
    }
    let wide = sides.iter().copied().filter(usable).fold(0.0, f64::max);
    let narrow = sides.iter().copied().filter(usable).fold(f64::INFINITY, f64::min);
    Some(narrow.max(1e-3 * wide)).filter(usable)
}

/// Decimal exponent of a number once it is rounded to so many significant digits; 0 for zero.
fn exponent(magnitude: f64, digits: i32) -> i32 {
    if magnitude == 0.0 || !magnitude.is_finite() {
        return 0;
    }
    let text = format!("{magnitude:.*e}", usize::try_from(digits - 1).unwrap_or(0));
    text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

/// How numbers that belong together are written.
struct Digits {
    /// Exponent of the last digit shown.
    last: i32,
    /// Shared exponent, or plain decimals.
    shared: Option<i32>,
}

impl Digits {
    fn new(magnitude: f64, last: i32) -> Self {
        let small = magnitude < 1e-4 && last >= -6;
        let plain = magnitude == 0.0 || small || (1e-4..1e5).contains(&magnitude) || !magnitude.is_finite();
        let last = last.max(exponent(magnitude, 1) - MOST_DIGITS + 1);
        Self { last, shared: (!plain).then(|| exponent(magnitude, 2)) }
    }

    fn write(&self, number: f64) -> String {
        if number.is_nan() {
            return UNKNOWN.to_owned();
        }
        if number.is_infinite() {
            return if number > 0.0 { "inf" } else { "-inf" }.to_owned();
        }
        let shift = self.shared.unwrap_or(0);
        let mantissa = scaled(number, -shift);
        let last = self.last - shift;
        let text = if last > 0 {
            format!("{:.0}", scaled(scaled(mantissa, -last).round(), last))
        } else {
            format!("{mantissa:.*}", usize::try_from(-last).unwrap_or(0))
        };
        let is_zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
        let text = if is_zero { text.trim_start_matches('-') } else { &text };
        match self.shared {
            Some(shared) => format!("{text}e{shared}"),
            None => text.to_owned(),
        }
    }
}

/// `number * 10^power`, in two steps so that the power itself neither overflows nor vanishes.
fn scaled(number: f64, power: i32) -> f64 {
    let half = power / 2;
    if power < 0 {
        number / 10f64.powi(-half) / 10f64.powi(half - power)
    } else {
        number * 10f64.powi(half) * 10f64.powi(power - half)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn shown(value: f64, low: f64, high: f64) -> String {
        let text = format_with_uncertainty(value, [low, high]);
        format!("{} [{}, {}]", text.value, text.low, text.high)
    }

    #[test]
    fn digits_follow_the_half_width() {
        assert_eq!(shown(9.1234e-4, 8.9e-4, 9.4e-4), "0.000912 [0.000890, 0.000940]");
        assert_eq!(shown(0.0171234, 0.0170, 0.0172), "0.017123 [0.017000, 0.017200]");
        assert_eq!(shown(12.3456, 11.1, 13.6), "12.3 [11.1, 13.6]");
        assert_eq!(shown(54321.0, 51821.0, 56821.0), "54300 [51800, 56800]");
    }

    #[test]
    fn carry_in_the_half_width_keeps_two_digits() {
        assert_eq!(shown(1.0, 1.0 - 0.0996, 1.0 + 0.0996), "1.00 [0.90, 1.10]");
    }

    #[test]
    fn asymmetric_intervals_keep_both_ends_apart_from_the_estimate() {
        assert_eq!(shown(1.0, 0.01, 100.0), "1.00 [0.01, 100.00]");
        assert_eq!(shown(0.001, 0.001 - 1e-9, 0.002), "0.0010000 [0.0010000, 0.0020000]");
        // the estimate outside its own interval: half of the whole width counts
        assert_eq!(shown(3.0, 0.0, 2.0), "3.0 [0.0, 2.0]");
    }

    #[test]
    fn zeros_and_one_sided_intervals() {
        assert_eq!(shown(0.0, 0.0, 0.0), "0.000 [0.000, 0.000]");
        assert_eq!(shown(0.0, 0.0, 0.0123), "0.000 [0.000, 0.012]");
        assert_eq!(shown(-1e-9, -0.3, 0.3), "0.00 [-0.30, 0.30]");
        assert_eq!(shown(2.5, 2.5, 2.5), "2.500 [2.500, 2.500]");
    }

    #[test]
    fn tiny_and_huge_numbers_share_an_exponent() {
        assert_eq!(shown(1.234e-9, 1.10e-9, 1.37e-9), "1.23e-9 [1.10e-9, 1.37e-9]");
        assert_eq!(shown(2.5e7, 2.4e7, 2.6e7), "2.50e7 [2.40e7, 2.60e7]");
        assert_eq!(shown(1e-310, 0.0, 2e-310), "1.0e-310 [0.0e-310, 2.0e-310]");
    }

    #[test]
    fn what_is_not_a_number_is_said_in_words() {
        assert_eq!(shown(f64::NAN, f64::NAN, f64::NAN), "unknown [unknown, unknown]");
        assert_eq!(shown(1.5, f64::NEG_INFINITY, f64::INFINITY), "1.500 [-inf, inf]");
        assert_eq!(shown(1.5, 1.0, f64::INFINITY), "1.50 [1.00, inf]");
    }

    #[test]
    fn the_extent_is_from_the_lowest_to_the_highest() {
        assert_eq!(extent([0.2, -1.5, 3.0, 0.0]), [-1.5, 3.0]);
        assert_eq!(extent([f64::NAN, 2.0, f64::NAN]), [2.0, 2.0]);
        assert_eq!(extent([f64::INFINITY, 1.0]), [1.0, f64::INFINITY]);
        assert_eq!(extent([]), [f64::INFINITY, f64::NEG_INFINITY]);
        assert_eq!(extent([f64::NAN]), [f64::INFINITY, f64::NEG_INFINITY]);
    }

    #[test]
    fn numbers_as_given_lose_trailing_zeros_only() {
        assert_eq!(as_given(0.0009), "0.0009");
        assert_eq!(as_given(100.0), "100");
        assert_eq!(as_given(2.5e-6), "2.5e-6");
        assert_eq!(as_given(0.0), "0");
        assert_eq!(significant(12.345, 3), "12.3");
        assert_eq!(mrad(0.00214), "2.14 mrad");
    }

    #[test]
    fn shares_are_whole_percentages_but_close_to_all() {
        assert_eq!([0.0, -0.001, 0.934, 0.9934, 1.0 - 1e-9].map(percent), ["0 %", "0 %", "93 %", "99.3 %", "100 %"]);
        assert_eq!([f64::NAN, -0.5].map(percent), [UNKNOWN, "-50 %"]);
    }

    proptest! {
        #[test]
        fn rounding_never_moves_a_number_by_more_than_its_uncertainty_allows(
            value in -1e3..1e3f64, below in 1e-6..10.0f64, ratio in 0.1..10.0f64, power in -12..12i32,
        ) {
            let unit = 10f64.powi(power);
            let (value, below, above) = (value * unit, below * unit, below * ratio * unit);
            let text = format_with_uncertainty(value, [value - below, value + above]);
            let read = |text: &str| text.parse::<f64>().expect("a written number can be read");
            let width = below.min(above);
            prop_assert!((read(&text.value) - value).abs() <= 0.051 * width + 1e-11 * value.abs());
            prop_assert!(read(&text.low) <= read(&text.value) && read(&text.value) <= read(&text.high));
        }

        #[test]
        fn any_input_is_written_in_few_characters(value: f64, low: f64, high: f64) {
            let text = format_with_uncertainty(value, [low, high]);
            prop_assert!(text.value.len() <= 24, "{}", text.value);
            prop_assert!(significant(value, 3).len() <= 24);
        }
    }
}
