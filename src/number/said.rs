//! Quantities, ranges and shares as a sentence has them: one notation for one quantity, wherever it stands.

use super::{UNKNOWN, WithUncertainty, format_with_uncertainty, percent, significant};

/// Digits of a quantity without an interval.
const DIGITS: i32 = 3;

/// Ends of a range that differ by no more than this share are one number.
const ONE_NUMBER: f64 = 0.01;

/// A unit beside a number; a dash or a one stands for none.
pub(crate) fn spoken(unit: &str) -> &str {
    if matches!(unit, "-" | "1") { "" } else { unit }
}

fn with_unit(number: &str, unit: &str) -> String {
    format!("{number} {}", spoken(unit)).trim_end().to_owned()
}

/// Words as a sentence begins with them.
pub(crate) fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// `0.0162 s`: a value with its unit; with an interval, `0.0162 [0.0151, 0.0173] s`, to its digits.
pub(crate) fn quantity(value: f64, interval: Option<[f64; 2]>, unit: &str) -> String {
    match interval.filter(|_| value.is_finite()) {
        Some(interval) => {
            let WithUncertainty { value, low, high } = format_with_uncertainty(value, interval);
            with_unit(&format!("{value} [{low}, {high}]"), unit)
        }
        None => with_unit(&significant(value, DIGITS), unit),
    }
}

/// `between 0.340 and 0.347 N m`, to as many digits as tell the ends apart; `at 0.340 N m` where they are one number.
pub(crate) fn between([low, high]: [f64; 2], unit: &str) -> String {
    let (low, high) = (low.min(high), low.max(high));
    let largest = low.abs().max(high.abs());
    if (high - low) <= ONE_NUMBER * largest {
        return format!("at {}", quantity(0.5 * (low + high), None, unit));
    }
    let written = |number: f64, digits: i32| {
        if number == 0.0 { "0".to_owned() } else { significant(number, digits) }
    };
    let number = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    let ends = |digits: i32| [written(low, digits), written(high, digits)];
    let are_apart = |[low, high]: &[String; 2]| number(low) != number(high);
    // Ends that differ by more than one in a hundred differ in the fourth digit at the latest.
    let [low, high] = (2..4).map(ends).find(are_apart).unwrap_or_else(|| ends(4));
    with_unit(&format!("between {low} and {high}"), unit)
}

/// A share of a whole as a percentage: never above 100 %, whatever noise makes of it.
pub(crate) fn share(share: f64) -> String {
    percent(share.min(1.0))
}

/// Whether a share is worth a number: `0 %` of something is no place to look at.
pub(crate) fn stands_out(share: f64) -> bool {
    share.is_finite() && share >= 0.005
}

/// Shares of one whole as whole percentages that together are what the shares together are, and never more than 100 %.
pub(crate) fn shares(shares: &[f64]) -> Vec<String> {
    let percents = share_percents(shares);
    let written = |(share, percent): (&f64, u32)| {
        if share.is_finite() { format!("{percent} %") } else { UNKNOWN.to_owned() }
    };
    shares.iter().zip(percents).map(written).collect()
}

/// The numbers of [`shares`]; what is not finite has none.
pub(crate) fn share_percents(shares: &[f64]) -> Vec<u32> {
    let all: f64 = shares.iter().map(|share| of_whole(*share)).sum();
    whole_percents(shares, (100.0 * all).round().min(100.0) as u32)
}

/// A share as a part of a whole: not negative, not more than all of it.
fn of_whole(share: f64) -> f64 {
    if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
}

/// Percentages in proportion to shares that add up to a total exactly: each is rounded down, and those that lose most by
/// that are rounded up instead, of equals the first (the method of the largest remainder). Nothing of nothing is nothing.
pub(crate) fn whole_percents(shares: &[f64], total: u32) -> Vec<u32> {
    let all: f64 = shares.iter().map(|share| of_whole(*share)).sum();
    if !(all > 0.0) {
        return vec![0; shares.len()];
    }
    // What a product loses in its last bits is not to cost a whole percent.
    let exact = shares.iter().map(|share| (f64::from(total) * of_whole(*share) / all * 1e9).round() / 1e9);
    let exact: Vec<f64> = exact.collect();
    let mut percents: Vec<u32> = exact.iter().map(|exact| exact.floor() as u32).collect();
    let missing = total.saturating_sub(percents.iter().sum()) as usize;
    let mut by_loss: Vec<usize> = (0..exact.len()).collect();
    by_loss.sort_by(|a, b| exact[*b].fract().total_cmp(&exact[*a].fract()));
    by_loss.into_iter().take(missing).for_each(|k| percents[k] += 1);
    percents
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn one_quantity_has_one_notation() {
        assert_eq!(quantity(0.016_15, None, "s"), "0.0162 s");
        assert_eq!(quantity(0.016_15, Some([0.0151, 0.0173]), "s"), "0.0162 [0.0151, 0.0173] s");
        assert_eq!(quantity(0.131, None, "-"), "0.131");
        assert_eq!(quantity(f64::NAN, Some([0.0, 1.0]), "s"), "unknown s");
        assert_eq!(quantity(1.0e-9, None, "kg m^2"), "1.00e-9 kg m^2");
    }

    #[test]
    fn a_range_has_two_ends_or_is_one_number() {
        assert_eq!(between([0.0, 0.42], "rad/s"), "between 0 and 0.42 rad/s");
        assert_eq!(between([0.339, 0.344], "N m"), "between 0.339 and 0.344 N m");
        assert_eq!(between([0.3399, 0.3401], "N m"), "at 0.340 N m");
        assert_eq!(between([-0.5, -0.5], "rad"), "at -0.500 rad");
        assert_eq!(between([0.2, -0.1], "rad"), "between -0.10 and 0.20 rad");
    }

    #[test]
    fn shares_never_exceed_the_whole() {
        assert_eq!([1.04, 0.5, -0.5].map(share), ["100 %", "50 %", "-50 %"]);
        assert_eq!(shares(&[0.005, 0.005, 0.99]), ["1 %", "0 %", "99 %"]);
        assert_eq!(shares(&[0.125; 8]), ["13 %", "13 %", "13 %", "13 %", "12 %", "12 %", "12 %", "12 %"]);
        assert_eq!(shares(&[1.0 / 3.0; 3]), ["34 %", "33 %", "33 %"]);
        assert_eq!(whole_percents(&[0.0, 0.0], 75), [0, 0]);
        assert_eq!(whole_percents(&[0.375, 0.375], 75), [38, 37]);
        assert_eq!(shares(&[f64::NAN, 0.3]), ["unknown", "30 %"]);
        assert!(stands_out(0.006) && !stands_out(0.004) && !stands_out(f64::NAN));
    }

    proptest! {
        #[test]
        fn no_quantity_is_misprinted(mantissa in 1.0..10.0f64, power in -14..14i32, sign in prop::bool::ANY) {
            let value = mantissa * 10f64.powi(power) * if sign { 1.0 } else { -1.0 };
            let text = quantity(value, None, "");
            let read: f64 = text.parse().expect("a number");
            prop_assert!((read / value - 1.0).abs() < 6e-3, "{value} as {text}");
            prop_assert!(!(1e-4..1e5).contains(&value.abs()) || !text.contains('e'), "{text}");
        }

        #[test]
        fn ends_that_differ_are_shown_to_differ(low in -1e3..1e3f64, wide in 0.0101..3.0f64, power in -12..9i32) {
            let unit = 10f64.powi(power);
            let (low, high) = (low * unit, low * unit + wide * low.abs() * unit);
            prop_assume!(high - low > 0.01 * low.abs().max(high.abs()));
            let text = between([low, high], "");
            let read: Vec<f64> = text.split(' ').filter_map(|word| word.parse().ok()).collect();
            prop_assert!(read.len() == 2 && read[0] < read[1], "{low} {high}: {text}");
            for (read, end) in read.iter().zip([low, high]) {
                prop_assert!((read - end).abs() <= 0.051 * end.abs(), "{end}: {text}");
            }
        }

        #[test]
        fn shares_of_one_whole_add_up_to_it(parts in prop::collection::vec(0.0..1.0f64, 1..40), of in 0.1..1.3f64) {
            let whole: f64 = parts.iter().sum::<f64>().max(1e-9) / of;
            let parts: Vec<f64> = parts.iter().map(|part| part / whole).collect();
            let written: Vec<f64> =
                shares(&parts).iter().map(|text| text.trim_end_matches(" %").parse().expect("a number")).collect();
            let sum: f64 = parts.iter().sum();
            prop_assert!((written.iter().sum::<f64>() - (100.0 * sum).min(100.0)).abs() <= 0.5 + 1e-6);
            prop_assert!(of > 1.0 || written.iter().zip(&parts).all(|(shown, part)| (shown - 100.0 * part).abs() <= 1.0));
        }
    }
}
