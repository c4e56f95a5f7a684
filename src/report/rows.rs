//! A parameter in words and numbers, the same in the text table, the page and the figure.

use super::model::{ParameterRow, ParameterStatus};
use super::number::{UNKNOWN, as_given, format_with_uncertainty, significant};

/// The cells of one parameter; empty where there is nothing to say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ParameterCells {
    /// Name and symbol.
    pub label: String,
    pub unit: String,
    /// A number, `held at ...` or `not determined`.
    pub estimate: String,
    pub interval: String,
    pub naive: String,
    pub nominal: String,
}

impl From<&ParameterRow> for ParameterCells {
    fn from(row: &ParameterRow) -> Self {
        let label = if row.symbol.is_empty() { row.name.clone() } else { format!("{} {}", row.name, row.symbol) };
        let (estimate, interval, naive) = match row.status {
            ParameterStatus::Held => (format!("held at {}", as_given(row.value)), String::new(), String::new()),
            ParameterStatus::Determined if row.value.is_finite() => {
                let (estimate, interval) = match row.interval {
                    Some(interval) => written(row.value, interval),
                    None => (significant(row.value, 4), UNKNOWN.to_owned()),
                };
                let naive = row.interval_naive.map(|naive| written(row.value, naive).1).unwrap_or_default();
                (estimate, interval, naive)
            }
            _ => ("not determined".to_owned(), String::new(), String::new()),
        };
        Self {
            label,
            unit: row.unit.clone(),
            estimate,
            interval,
            naive,
            nominal: row.nominal.map(as_given).unwrap_or_default(),
        }
    }
}

/// Whether the parameter has a fitted number that may be shown.
pub(super) fn is_shown(row: &ParameterRow) -> bool {
    row.status == ParameterStatus::Determined && row.value.is_finite()
}

fn written(value: f64, interval: [f64; 2]) -> (String, String) {
    let shown = format_with_uncertainty(value, interval);
    (shown.value, format!("{} to {}", shown.low, shown.high))
}

/// `kg m^2` as `kg m²`, for figures and pages.
pub(super) fn typeset_unit(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³")
}

/// Shortens a text in its middle to at most `most` characters: both ends of a file name tell files apart.
pub(super) fn shorten(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.to_owned();
    }
    let kept = most.saturating_sub(1);
    let head: String = text.chars().take(kept.div_ceil(2)).collect();
    let tail: String = text.chars().skip(count - kept / 2).collect();
    format!("{head}\u{2026}{tail}")
}

/// Names without the end that all of them have, from its first `_`, `-`, `.` or `/` on: `hip_joint` and `knee_joint` as `hip` and
/// `knee`.
pub(super) fn without_common_end<'a>(names: &[&'a str]) -> Vec<&'a str> {
    let [first, others @ ..] = names else { return Vec::new() };
    let alike = |other: &str| first.bytes().rev().zip(other.bytes().rev()).take_while(|(a, b)| a == b).count();
    let shared = others.iter().map(|other| alike(other)).min().unwrap_or(0);
    let end = first.as_bytes()[first.len() - shared..].iter().position(|byte| b"_-./".contains(byte));
    let kept = end.map_or(0, |at| shared - at);
    let shorter = names.iter().map(|name| name.len() - kept);
    match shorter.clone().all(|length| length > 0) {
        true => names.iter().zip(shorter).map(|(name, length)| &name[..length]).collect(),
        false => names.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_that_all_names_have_tells_none_of_them_apart() {
        assert_eq!(
            without_common_end(&["RR_hip_joint", "RR_calf_joint", "FL_calf_joint"]),
            ["RR_hip", "RR_calf", "FL_calf"]
        );
        assert_eq!(without_common_end(&["left_knee", "right_knee"]), ["left", "right"]);
        for names in [vec!["lf1", "rf1"], vec!["_joint", "hip_joint"], vec!["only_joint"], vec!["knäl", "hüftgeläl"]]
        {
            assert_eq!(without_common_end(&names), names);
        }
        assert!(without_common_end(&[]).is_empty());
    }

    fn row(status: ParameterStatus) -> ParameterRow {
        ParameterRow {
            name: "inertia".into(),
            symbol: "I*".into(),
            unit: "kg m^2".into(),
            status,
            value: 9.1234e-4,
            interval: Some([8.9e-4, 9.4e-4]),
            interval_naive: Some([9.1e-4, 9.15e-4]),
            nominal: Some(9e-4),
        }
    }

    #[test]
    fn a_determined_parameter_shows_its_number_and_both_intervals() {
        let cells = ParameterCells::from(&row(ParameterStatus::Determined));
        assert_eq!((cells.label.as_str(), cells.estimate.as_str()), ("inertia I*", "0.000912"));
        assert_eq!(cells.interval, "0.000890 to 0.000940");
        assert_eq!(cells.naive, "0.0009100 to 0.0009150");
        assert_eq!(cells.nominal, "0.0009");
    }

    #[test]
    fn held_and_undetermined_parameters_show_words() {
        let held = ParameterCells::from(&row(ParameterStatus::Held));
        assert_eq!((held.estimate.as_str(), held.interval.as_str()), ("held at 0.00091234", ""));
        let unknown = ParameterCells::from(&row(ParameterStatus::NotDetermined));
        assert_eq!((unknown.estimate.as_str(), unknown.interval.as_str()), ("not determined", ""));
        let broken = ParameterRow { value: f64::NAN, ..row(ParameterStatus::Determined) };
        assert_eq!(ParameterCells::from(&broken).estimate, "not determined");
    }

    #[test]
    fn long_names_keep_both_ends() {
        assert_eq!(shorten("short.csv", 20), "short.csv");
        let long = shorten("a-very-long-name-of-a-log-number-07.csv", 20);
        assert_eq!(long, "a-very-lon\u{2026}er-07.csv");
        assert_eq!(long.chars().count(), 20);
    }
}
