//! The words of errors: what to do, lists of names, defects after the first.

use std::collections::BTreeSet;
use std::io;

use super::LogError;
use crate::log::column::{Column, column_of};
use crate::log::columns::{ColumnSpec, Columns};
use crate::log::header::alias;

pub(super) fn reading_fix(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::NotFound => "check the path and the folder you are in",
        io::ErrorKind::IsADirectory => "expected the name of a file in it",
        io::ErrorKind::PermissionDenied => "ask for permission to read it",
        _ => "check the disk and the file",
    }
}

pub(super) fn writing_fix(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::IsADirectory => "this is a folder, expected the name of a file",
        io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
            "a file stands where a folder is needed, choose another folder"
        }
        io::ErrorKind::StorageFull => "make room on the disk",
        io::ErrorKind::InvalidData => "say in [columns] which of the log's columns is which",
        _ => "choose a folder that you may write to",
    }
}

pub(super) fn list(names: &[String]) -> String {
    if names.is_empty() {
        return "no other columns".into();
    }
    let more = if names.len() > 12 { format!(" and {} more", names.len() - 12) } else { String::new() };
    let shown: Vec<String> = names.iter().take(12).map(|name| format!("`{name}`")).collect();
    shown.join(", ") + &more
}

pub(super) fn joints_found(joints: &[String]) -> String {
    if joints.is_empty() {
        "the log names no joint; read it without naming one".into()
    } else {
        format!("the log has {}", list(joints))
    }
}

pub(super) fn tail(hint: &Option<String>) -> String {
    hint.as_ref().map_or_else(String::new, |hint| format!("; {hint}"))
}

pub(super) fn count(samples: usize) -> &'static str {
    if samples == 0 { "no samples" } else { "1 sample" }
}

pub(super) fn separator(found: char) -> &'static str {
    match found {
        ';' => "semicolons",
        '\t' => "tabs",
        '|' => "bars",
        _ => "blanks",
    }
}

pub(super) fn time_fix(time_s: f64, previous_s: f64) -> &'static str {
    if time_s == previous_s {
        "delete the doubled sample, or write `t` with more digits"
    } else {
        "sort the samples, or split the log where the clock was set back"
    }
}

/// How often more a defect is there.
pub(super) fn more(count: usize) -> String {
    if count > 1 { format!("\n  and {} more of this kind", count - 1) } else { String::new() }
}

/// The defects after the first.
pub(super) fn tell_others(others: &[(LogError, usize)], beyond: usize) -> String {
    let mut text: String = others.iter().map(|(error, count)| format!("\nalso: {error}{}", more(*count))).collect();
    if beyond > 0 {
        text += &format!("\nand {beyond} of other kinds");
    }
    text
}

/// What would mend a file: the lines that read it, or, where no name tells which column an angle is, how to say it.
pub(super) fn tell_mend(mend: &Columns, first: &LogError, others: &[(LogError, usize)]) -> String {
    if mend.0.is_empty() {
        let mut all = std::iter::once(first).chain(others.iter().map(|(error, _)| error));
        return all.find_map(LogError::names_without_angle).map_or_else(String::new, tell_naming);
    }
    let lines = mend.toml();
    format!(
        "\nin a study, or in the sidecar NAME.toml of the log with `schema = 1`, these lines would read the file as it is \
         (units are guesses, check them):\n{}",
        lines.trim_end()
    )
}

/// How to say which column is which, by the names that are there.
fn tell_naming(names: &[String]) -> String {
    let is_stamp = |name: &String| alias(Column::Time, std::slice::from_ref(name)).is_some();
    let Some(angle) = names.iter().find(|name| !is_stamp(name) && column_of(name).is_none()) else {
        return tell_angles(names);
    };
    let mut lines = Columns([("joint_1.q".to_owned(), ColumnSpec::named(angle))].into());
    let has_ours = names.iter().any(|name| name == Column::Time.name());
    if let Some(stamp) = names.iter().find(|name| is_stamp(name)).filter(|_| !has_ours) {
        lines.0.insert(Column::Time.name().to_owned(), ColumnSpec::named(stamp));
    }
    format!(
        "\nthe names do not tell which column is which; name them in a study, or in NAME.toml beside the log with `schema = 1` \
         (`aibo-fit init`, `check`, `convert` and `drop` read it), for each joint (`q` alone where there is one only; with \
         unit = \"deg\" and so on where they are not radians) as in:\n{}",
        lines.toml().trim_end()
    )
}

/// Which angles would go with the columns that are there, where all of them are known and none is an angle.
fn tell_angles(names: &[String]) -> String {
    let known = names.iter().filter_map(|name| column_of(name)).filter(|(_, column)| *column != Column::Time);
    let of_joint =
        |joint: Option<&str>| joint.map_or_else(String::new, |joint| format!("{joint}.")) + Column::Angle.name();
    let angles: BTreeSet<String> = known.map(|(joint, _)| of_joint(joint)).collect();
    let angles: Vec<String> = if angles.is_empty() { vec![of_joint(None)] } else { angles.into_iter().collect() };
    format!("\nthe angle is missing: expected {} beside them", list(&angles))
}
