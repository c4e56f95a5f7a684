//! What others call the columns of a log, and what to say if one is not there.

use std::path::Path;

use super::column::Column;
use super::columns::ColumnSpec;
use super::error::LogError;
use super::place::Place;

/// Names that people give a column, without case, blanks, units and punctuation.
fn aliases(column: Column) -> &'static [&'static str] {
    match column {
        Column::Time => {
            &["t", "time", "timestamp", "timestamps", "times", "stamp", "seconds", "sec", "tsec", "ts", "ms"]
        }
        Column::Angle => &[
            "q",
            "angle",
            "angles",
            "theta",
            "phi",
            "pos",
            "position",
            "jointangle",
            "jointposition",
            "qrad",
            "rad",
            "anglerad",
            "deg",
            "angledeg",
            "qdeg",
            "encoder",
            "qmeas",
            "qactual",
            "presentposition",
        ],
        Column::Speed => &["dq", "speed", "velocity", "qdot", "qd"],
        Column::Torque => &["tau", "torque", "effort", "taunm", "torquenm", "u", "torquecmd"],
        Column::Setpoint => &[
            "qref",
            "setpoint",
            "ref",
            "reference",
            "target",
            "goal",
            "goalposition",
            "qdes",
            "qd",
            "qcmd",
            "command",
            "desired",
            "qtarget",
            "qrefrad",
        ],
        Column::Drive => &["drive", "motor", "motoron", "enable", "enabled", "torqueenable", "held"],
    }
}

/// No joint has a number with more digits.
const LONGEST_NUMBER: usize = 4;

/// Whether the first row is no header at all: other separators, or numbers.
pub(super) fn no_table(names: &[String], at: impl Fn() -> Box<Place>) -> Option<LogError> {
    if let Some(found) = other_separator(names) {
        return Some(LogError::Separator { at: at(), found });
    }
    let is_number = |name: &String| name.parse::<f64>().is_ok();
    // Joints may be called by their numbers; these are samples or stamps.
    let is_sample = |name: &&String| is_number(name) && (name.contains('.') || name.len() > LONGEST_NUMBER);
    let is_row = names.iter().all(is_number) || names.iter().filter(is_sample).count() > 1;
    is_row.then(|| LogError::NoHeader { at: at() })
}

/// The separator that the header seems to use instead of the comma.
fn other_separator(names: &[String]) -> Option<char> {
    let parts = |c: char| -> Vec<&str> {
        names.iter().flat_map(|name| name.split(c)).map(|part| part.trim().trim_matches('"')).collect()
    };
    // a header that falls into the wanted names, or a single cell that falls into several
    [';', '\t', '|', ' '].into_iter().find(|&c| {
        let parts = parts(c);
        let known = ["t", "q"].iter().all(|wanted| parts.iter().any(|part| part.eq_ignore_ascii_case(wanted)));
        // a blank within a name is common, one between names only where there are no commas
        parts.len() > names.len() && (known || c != ' ') && (names.len() == 1 || known && c != ' ')
    })
}

/// What to do about a missing column, from the names that are there.
pub(super) fn hint(file: &Path, missing: Column, names: &[String]) -> Option<String> {
    if file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        return Some("this looks like a study, not a log".into());
    }
    if let Some(name) = names.iter().find(|name| name.starts_with(['#', '%'])) {
        return Some(format!("the first row has to be the header: remove the comment sign of `{name}` or the comment"));
    }
    let name = &names[alias(missing, names)?];
    Some(format!("`{name}` looks like it: rename it to `{}` and give it in {}", missing.name(), missing.unit()))
}

/// What to say of a column that `[columns]` names and that is not there.
pub(super) fn none_there(ours: &str, spec: &ColumnSpec) -> String {
    format!("[columns] says that `{ours}` is `{}` here, and there is none", spec.name)
}

/// The first name that people give this column.
pub(super) fn alias(column: Column, names: &[String]) -> Option<usize> {
    aliases(column).iter().find_map(|alias| names.iter().position(|name| bare(name) == *alias))
}

/// A name without case, punctuation, and a unit in brackets.
fn bare(name: &str) -> String {
    let end = name.find(['[', '(', '{', '/']).filter(|&i| i > 0).unwrap_or(name.len());
    name[..end].chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}
