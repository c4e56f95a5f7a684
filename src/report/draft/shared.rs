//! One table `[columns]` for all logs of a study.

use super::DraftError;
use super::seen::Seen;
use crate::log::{Channel, ColumnSpec, Columns, Format, Unit, toml_key};

/// The lines of all logs in one table.
///
/// # Errors
/// [`DraftError::ColumnsDiffer`] where a line that one log needs reads another log otherwise than that log says.
pub(super) fn shared(logs: &[(&Seen, Columns)]) -> Result<Columns, DraftError> {
    let mut all = Columns::default();
    for (log, columns) in logs {
        for (ours, line) in &columns.0 {
            for (other, others) in logs {
                if let Some(instead) = instead(other, others, ours, line) {
                    return Err(DraftError::ColumnsDiffer {
                        file: log.path.clone(),
                        line: written(ours, line),
                        other: other.path.clone(),
                        instead,
                    });
                }
            }
        }
        all.0.extend(columns.0.clone());
    }
    Ok(all)
}

/// What a log that has these lines needs in the place of another's line; `None`: that line does not change how it is read.
fn instead(log: &Seen, columns: &Columns, ours: &str, line: &ColumnSpec) -> Option<String> {
    let differs = |own: &ColumnSpec| own != line && !(is_table(log) && are_alike(own, line));
    if let Some(own) = columns.get(ours) {
        return differs(own).then(|| written(ours, own));
    }
    if let Some((other, own)) = columns.0.iter().find(|(_, own)| own.name == line.name) {
        return Some(written(other, own));
    }
    let own = ColumnSpec::named(without_line(log, ours, line)?);
    differs(&own).then(|| written(ours, &own))
}

/// Whether a log has no units but ours where no line says one.
fn is_table(log: &Seen) -> bool {
    matches!(log.source.format, Format::Csv | Format::StaggeredCsv)
}

/// Whether two lines read a column of a table alike, one of them without the unit that goes without saying.
fn are_alike(a: &ColumnSpec, b: &ColumnSpec) -> bool {
    let scale = |line: &ColumnSpec| line.unit.map_or(1.0, Unit::scale);
    (&a.name, a.is_reversed, a.zero, scale(a)) == (&b.name, b.is_reversed, b.zero, scale(b))
}

/// What a log without a line for a column calls that which the line is about; `None`: the log has nothing of it.
fn without_line<'a>(log: &'a Seen, ours: &str, line: &'a ColumnSpec) -> Option<&'a str> {
    match (ours, log.source.format) {
        ("t", _) if is_table(log) => Some("t"),
        // Arrays of stamps go by many names, and none of them is kept.
        ("t", Format::Npz) => Some(&line.name),
        ("t", _) => None,
        _ => {
            let is_named = |channel: &&Channel| channel.theirs == line.name && channel.ours.is_some();
            let found = log.source.ours(ours).or_else(|| log.source.channels.iter().find(is_named));
            found.map(|channel| channel.theirs.as_str())
        }
    }
}

/// A line as it stands in a study.
fn written(ours: &str, line: &ColumnSpec) -> String {
    format!("{} = {}", toml_key(ours), line.toml())
}
