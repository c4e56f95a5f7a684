//! Lines of `[columns]` that would read a file which cannot be read as it is: told only where trying them has read it.

use super::channel::{Channel, Source};
use crate::log::columns::{Columns, Unit};
use crate::log::error::LogError;
use crate::log::place::Place;

/// Lines are tried so often at the most: under the right names units of stamps show, then of angles, then of setpoints.
const TRIES: usize = 4;

/// The error of a file that was read by these `columns`, with the lines that do read it; without any where none do.
/// What else is wrong with the file, as trying them with `read` has shown, is added.
pub(in crate::log) fn tried(
    error: LogError,
    columns: &Columns,
    read: impl Fn(&Columns) -> Result<Source, LogError>,
) -> LogError {
    match error {
        LogError::Defects { first, count, mut others, beyond, mend } if !mend.0.is_empty() => {
            let (mend, shown) = try_lines(columns, mend, read);
            for (defect, times) in shown {
                let is_known = is_same(&first, &defect) || others.iter().any(|(known, _)| is_same(known, &defect));
                if !is_known && !matches!(defect, LogError::MissingColumn { .. }) {
                    others.push((defect, times));
                }
            }
            // Names alone stop nobody who guesses them; what else is wrong does.
            let mut all: Vec<(LogError, usize)> = std::iter::once((*first, count)).chain(others).collect();
            all.sort_by_key(|(error, _)| mend.0.is_empty() && matches!(error, LogError::MissingColumn { .. }));
            let (first, count) = all.remove(0);
            LogError::Defects { first: Box::new(first), count, others: all, beyond, mend }
        }
        other => other,
    }
}

/// The error of a file that can be read only once: no line is told, since none can be tried.
pub(super) fn untried(error: LogError) -> LogError {
    match error {
        LogError::Defects { first, count, others, beyond, .. } => {
            LogError::Defects { first, count, others, beyond, mend: Columns::default() }
        }
        other => other,
    }
}

/// The lines that read a file, those that were told before among them, or none; and what else turned out to be wrong.
fn try_lines(
    told: &Columns,
    mend: Columns,
    read: impl Fn(&Columns) -> Result<Source, LogError>,
) -> (Columns, Vec<(LogError, usize)>) {
    let mut lines = with(told, mend);
    let mut shown = Vec::new();
    for _ in 0..TRIES {
        match read(&lines) {
            Ok(source) => return (without_guessed_amperes(lines, told, &source), shown),
            Err(LogError::Defects { first, count, others, mend, .. }) => {
                shown.push((*first, count));
                shown.extend(others);
                let better = with(&lines, mend);
                if better == lines {
                    break;
                }
                lines = better;
            }
            Err(error) => {
                shown.push((error, 1));
                break;
            }
        }
    }
    (Columns::default(), shown)
}

/// Lines, and others that stand over them.
fn with(lines: &Columns, others: Columns) -> Columns {
    let mut all = lines.clone();
    all.0.extend(others.0);
    all
}

/// The same without the unit of currents that nobody told and that seem to be counts: who knows the drive has to say it.
fn without_guessed_amperes(mut lines: Columns, told: &Columns, source: &Source) -> Columns {
    for (ours, spec) in &mut lines.0 {
        let is_guess = spec.unit == Some(Unit::Current(1.0)) && told.get(ours).is_none();
        if is_guess && source.ours(ours).is_some_and(Channel::is_current_in_counts) {
            spec.unit = None;
        }
    }
    lines
}

/// Whether two defects are one: what a place has wrong is told once, though it has been read in another unit since.
fn is_same(a: &LogError, b: &LogError) -> bool {
    let is_of_a_kind = std::mem::discriminant(a) == std::mem::discriminant(b);
    is_of_a_kind
        && match (place_of(a), place_of(b)) {
            (Some(a), Some(b)) => a == b,
            _ => a.to_string() == b.to_string(),
        }
}

/// Where a defect of a cell, a row or a column stands.
fn place_of(error: &LogError) -> Option<&Place> {
    match error {
        LogError::Cell { at, .. }
        | LogError::RowLength { at, .. }
        | LogError::TimeGap { at, .. }
        | LogError::TimeOrder { at, .. }
        | LogError::Units { at, .. } => Some(at.as_ref()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::source::read::read_wanted;
    use crate::log::source::want::Want;

    /// 60 rows of a user's own logger, read as whatever it is.
    fn read(header: &str, row: impl Fn(f64) -> String, want: Want<'_>) -> Result<Source, LogError> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("log.csv");
        let rows: Vec<String> = (0..60).map(|k| row(f64::from(k))).collect();
        std::fs::write(&path, format!("{header}\n{}\n", rows.join("\n"))).unwrap();
        read_wanted(&path, want, &Columns::default())
    }

    fn lines(error: &LogError) -> String {
        match error {
            LogError::Defects { mend, .. } => mend.toml(),
            _ => String::new(),
        }
    }

    #[test]
    fn lines_that_do_not_read_the_file_are_not_told() {
        let arm = read("time,A1_act,A1_cmd,A2_act,A2_cmd", |k| format!("{},1,1,1,1", 0.01 * k), Want::Any).unwrap_err();
        assert_eq!(lines(&arm), "");
        let message = arm.to_string();
        assert!(message.contains("\"joint_1.q\" = { name = \"A1_act\" }"), "{message}");
        assert!(message.contains("t = { name = \"time\" }") && !message.contains("as it is"), "{message}");

        let dates = read("time,q", |k| format!("2024-05-01T12:00:{k:02},0.1"), Want::Any).unwrap_err();
        assert_eq!(lines(&dates), "");
        let message = dates.to_string();
        assert!(message.contains("write stamps in seconds") && !message.contains("[columns]"), "{message}");
    }

    #[test]
    fn what_is_known_to_be_no_angle_is_not_offered_as_one() {
        let told = |header: &str| {
            let error = read(header, |k| format!("{},0.1,0.2", 0.01 * k), Want::Any).unwrap_err();
            error.to_string()
        };
        let message = told("t,elbow.q_ref,wrist.q_ref");
        assert!(
            message.contains("expected `elbow.q`, `wrist.q` beside them") && !message.contains("joint_1"),
            "{message}"
        );
        let message = told("t,q_ref,tau");
        assert!(message.contains("expected `q` beside them") && !message.contains("[columns]"), "{message}");
        let message = told("t,q_ref,A1");
        assert!(message.contains("\"joint_1.q\" = { name = \"A1\" }"), "{message}");
    }

    #[test]
    fn a_robots_log_needs_lines_that_name_its_joints() {
        let row = |k: f64| format!("{},0.1", 0.01 * k);
        assert_eq!(lines(&read("time,q", row, Want::Robot).unwrap_err()), "");
        assert_eq!(lines(&read("time,q", row, Want::One).unwrap_err()), "[columns]\nt = { name = \"time\" }\n");
    }

    #[test]
    fn what_is_asked_of_a_joint_without_an_angle_is_left_out() {
        let row = |k: f64| format!("{},0.1,0.2,0.3", 0.01 * k);
        let error = read("time,elbow_pos,wrist_pos,gripper_cmd", row, Want::Any).unwrap_err();
        assert!(lines(&error).contains("elbow.q") && !lines(&error).contains("gripper"), "{error}");
    }

    #[test]
    fn units_that_show_only_under_the_right_names_are_found() {
        let wave = |k: f64| 10.0 * (0.4 * k).sin();
        let row = |k: f64| format!("{},{},{}", 10.0 * k, wave(k), wave(k + 1.0));
        let error = read("stamp,elbow_angle,elbow_goal", row, Want::Any).unwrap_err();
        for line in [
            "t = { name = \"stamp\", unit = \"ms\" }",
            "q = { name = \"elbow_angle\", unit = \"deg\" }",
            "q_ref = { name = \"elbow_goal\", unit = \"deg\" }",
        ] {
            assert!(lines(&error).contains(line), "`{line}` is not in\n{error}");
        }
    }

    #[test]
    fn what_is_wrong_with_a_cell_is_told_once_whatever_the_units() {
        let row =
            |k: f64| format!("{},{}", if k == 30.0 { 290.0 } else { 10.0 * k }, if k == 7.0 { "x" } else { "0.1" });
        let message = read("time,angle", row, Want::Any).unwrap_err().to_string();
        assert_eq!(message.matches("time repeats").count(), 1, "{message}");
        assert_eq!(message.matches("found `x`").count(), 1, "{message}");
    }

    #[test]
    fn a_current_in_counts_has_no_unit_until_somebody_says_it() {
        let row = |scale: f64| move |k: f64| format!("{},{},{}", 0.01 * k, 0.1 * k.sin(), (scale * k.sin()).round());
        let of = |scale| lines(&read("time,angle,Present Current", row(scale), Want::One).unwrap_err());
        assert!(of(29.0).contains("tau = { name = \"Present Current\" }"), "{}", of(29.0));
        assert!(of(3.0).contains("tau = { name = \"Present Current\", unit = \"A\" }"), "{}", of(3.0));
    }
}
