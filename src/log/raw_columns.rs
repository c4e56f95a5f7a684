//! `[columns]` of a study as it stands in the file.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use super::column::{Column, column_of};
use super::columns::{ColumnSpec, Columns, Unit, WORDS};
use super::document::{Document, FINITE, Number, POSITIVE, Text};
use super::error::LogError;

/// One entry as it stands in the file.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::log) struct RawColumn {
    name: Text,
    unit: Text,
    per_rev: Number,
    sign: Number,
    zero: Number,
}

/// `[columns]` as it stands in the file.
pub(in crate::log) type RawColumns = BTreeMap<String, Spanned<RawColumn>>;

/// Checks the table `[columns]`.
pub(in crate::log) fn columns(document: &Document<'_>, raw: &RawColumns) -> Result<Columns, LogError> {
    let mut checked = BTreeMap::new();
    for (ours, entry) in raw {
        let key = format!("[columns] {ours}");
        let Some((_, column)) = column_of(ours) else {
            let expected =
                "t, q, dq, tau, q_ref or drive, of several joints with the joint's name before it: \"elbow.q\"";
            return Err(document.wrong(&key, entry.span(), format!("\"{ours}\""), expected));
        };
        let RawColumn { name, unit, per_rev, sign, zero } = entry.get_ref();
        let name = name.as_ref().ok_or_else(|| document.missing(format!("{key}.name"), "what the file calls it"))?;
        // One switch may turn on the motors of several joints.
        let is_shared = |ours: &str| column == Column::Drive && ours.ends_with(Column::Drive.name());
        let is_same = |(ours, spec): &(&String, &ColumnSpec)| spec.name == *name.get_ref() && !is_shared(ours);
        if let Some((other, _)) = checked.iter().find(is_same) {
            let found = format!("\"{}\", which is also `{other}`", name.get_ref());
            return Err(document.wrong(&format!("{key}.name"), name.span(), found, "every column of the log once"));
        }
        let unit = self::unit(document, &key, column, unit, per_rev)?;
        let is_reversed = match sign {
            None => false,
            Some(sign) if sign.get_ref().abs() == 1.0 => *sign.get_ref() < 0.0,
            Some(sign) => {
                return Err(document.wrong(&format!("{key}.sign"), sign.span(), sign.get_ref().to_string(), "1 or -1"));
            }
        };
        let zero = document.number(&format!("{key}.zero"), zero, FINITE)?.unwrap_or(0.0);
        checked.insert(ours.clone(), ColumnSpec { name: name.get_ref().clone(), unit, is_reversed, zero });
    }
    Ok(Columns(checked))
}

/// The table `[columns]` of a study of any kind; empty where it has none.
///
/// # Errors
/// [`LogError`] where the file is no TOML, or the table is wrong.
pub fn study_columns(path: &std::path::Path) -> Result<Columns, LogError> {
    #[derive(Deserialize)]
    struct Only {
        #[serde(default)]
        columns: RawColumns,
    }
    let document = Document::open(path)?;
    let only: Only = document.parse_any()?;
    columns(&document, &only.columns)
}

fn unit(
    document: &Document<'_>,
    key: &str,
    column: Column,
    unit: &Text,
    per_rev: &Number,
) -> Result<Option<Unit>, LogError> {
    let per_rev_key = format!("{key}.per_rev");
    let Some(word) = unit else {
        if let Some(per_rev) = per_rev {
            return Err(document.wrong(&per_rev_key, per_rev.span(), "it alone", "unit = \"ticks\" beside it"));
        }
        return Ok(None);
    };
    let found = if word.get_ref() == "ticks" {
        Some(Unit::Ticks { per_rev: document.needed(&per_rev_key, per_rev, POSITIVE)? })
    } else {
        if let Some(per_rev) = per_rev {
            return Err(document.wrong(&per_rev_key, per_rev.span(), "it", "it with unit = \"ticks\" only"));
        }
        WORDS.iter().find(|(known, _)| known == word.get_ref()).map(|(_, unit)| *unit)
    };
    match found.filter(|unit| unit.fits(column)) {
        Some(unit) => Ok(Some(unit)),
        None => {
            let expected = match column {
                Column::Time => "\"s\", \"ms\", \"us\" or \"ns\"",
                Column::Torque => "\"N m\", \"mN m\", \"A\" or \"mA\"",
                Column::Drive => "no unit: 0 or 1",
                Column::Speed => {
                    "\"rad\", \"mrad\", \"deg\", \"rev\" or \"ticks\" (with per_rev), per second, or \"rpm\""
                }
                _ => "\"rad\", \"mrad\", \"deg\", \"rev\" or \"ticks\" (with per_rev)",
            };
            Err(document.wrong(&format!("{key}.unit"), word.span(), format!("\"{}\"", word.get_ref()), expected))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;
    use std::path::Path;

    #[derive(Deserialize)]
    struct Whole {
        columns: RawColumns,
    }

    fn read(text: &str) -> Result<Columns, String> {
        let document = Document::of_text(Path::new("study.toml"), text);
        let whole: Whole = document.parse_any().map_err(|error| error.to_string())?;
        columns(&document, &whole.columns).map_err(|error| error.to_string())
    }

    #[test]
    fn ours_is_sign_times_theirs_in_si_less_zero() {
        let text = "[columns]\nt = { name = \"stamp\", unit = \"ns\" }\nq = { name = \"a\", unit = \"deg\", sign = -1, \
                    zero = 0.1 }\n\"elbow.q\" = { name = \"raw\", unit = \"ticks\", per_rev = 4096 }\n";
        let columns = read(text).unwrap();
        assert!((columns.get("q").unwrap().apply(90.0) + TAU / 4.0 + 0.1).abs() < 1e-12);
        assert!((columns.get("t").unwrap().apply(5e6) - 0.005).abs() < 1e-15);
        assert!((columns.get("elbow.q").unwrap().apply(1024.0) - TAU / 4.0).abs() < 1e-12);
        assert_eq!(read(&columns.toml()).unwrap(), columns);
    }

    #[test]
    fn what_cannot_be_is_an_error_that_names_the_key() {
        for (entry, expected) in [
            ("q = { name = \"a\", unit = \"ms\" }", "[columns] q.unit"),
            ("t = { name = \"a\", unit = \"deg\" }", "expected \"s\", \"ms\", \"us\" or \"ns\""),
            ("q = { name = \"a\", unit = \"ticks\" }", "[columns] q.per_rev"),
            ("q = { name = \"a\", per_rev = 4096.0 }", "unit = \"ticks\" beside it"),
            ("q = { name = \"a\", sign = 2.0 }", "expected 1 or -1"),
            ("q = { unit = \"deg\" }", "[columns] q.name"),
            ("q = { name = \"a\" }\nq_ref = { name = \"a\" }", "found \"a\", which is also `q`, expected every column"),
            ("angle = { name = \"a\" }", "[columns] angle"),
            ("\"elbow.t\" = { name = \"a\" }", "[columns] elbow.t"),
            ("q = { name = \"a\", units = \"deg\" }", "units"),
        ] {
            let message = read(&format!("[columns]\n{entry}\n")).unwrap_err();
            assert!(message.contains(expected) && message.contains("study.toml"), "{entry}: {message}");
        }
    }
}
