//! The header row of a table: which cells are wanted, as what, and what to say of those that are missing.

use std::path::Path;

use super::defects::Defects;
use super::guess::{Guess, guess, is_asked};
use super::want::Want;
use crate::log::column::{Column, column_of};
use crate::log::columns::{ColumnSpec, Columns};
use crate::log::error::LogError;
use crate::log::header::{alias, hint, no_table, none_there};
use crate::log::place::{Place, Subject};
use crate::log::plausible::Row;

pub(super) const BASE: [&str; 6] = ["base.x", "base.y", "base.z", "base.roll", "base.pitch", "base.yaw"];
pub(super) const FELT: [&str; 3] = ["acc.x", "acc.y", "acc.z"];
/// No trunk goes farther \[m\], and no accelerometer reads more \[m/s^2\].
const FARTHEST: f64 = 1e5;

/// A cell of every row that is used.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub cell: usize,
    /// What we call it.
    pub ours: String,
    /// `None`: of the trunk.
    pub column: Option<Column>,
    pub spec: Option<ColumnSpec>,
}

impl Wanted {
    /// Largest magnitude, and the unit that is told with it.
    pub fn limit_and_unit(&self) -> (f64, &'static str) {
        match self.column {
            Some(column) => (column.limit(), column.unit()),
            None if FELT.contains(&&*self.ours) => (FARTHEST, "m/s^2"),
            None => (FARTHEST, if BASE[..3].contains(&&*self.ours) { "m" } else { "rad" }),
        }
    }
}

/// A header that has been understood.
#[derive(Debug)]
pub(super) struct Heading {
    /// All names, blanks around them removed.
    pub names: Vec<String>,
    /// Time first.
    pub wanted: Vec<Wanted>,
}

/// A cell under one of the names that it goes by.
struct Entry<'a> {
    cell: usize,
    name: &'a str,
    spec: Option<&'a ColumnSpec>,
}

impl Entry<'_> {
    fn wanted(&self, column: Option<Column>) -> Wanted {
        Wanted { cell: self.cell, ours: self.name.to_owned(), column, spec: self.spec.cloned() }
    }
}

impl Heading {
    /// Finds the cells that are wanted. What is missing and can be guessed goes to `defects`, and the guess is read on.
    ///
    /// # Errors
    /// [`LogError`] where the row is no header, or nothing can be read on.
    pub fn find(
        file: &Path,
        cells: &[&str],
        row: Row,
        want: Want<'_>,
        columns: &Columns,
        defects: &mut Defects,
    ) -> Result<Self, LogError> {
        let names: Vec<String> = cells.iter().map(|cell| cell.trim().to_owned()).collect();
        let at = |subject, cell| Box::new(Place::in_log(file, row.byte, row.line, subject, cell));
        let line = || at(Subject::Line, None);
        let entries = entries(&names, columns);
        let is_robot = match want {
            Want::Robot => true,
            Want::Any => entries.iter().any(|entry| joint_of(entry.name, Column::Angle).is_some()),
            Want::One | Want::Joint(_) => false,
        };
        let mut wanted = match want {
            _ if is_robot => of_robot(&entries, matches!(want, Want::Any)),
            Want::Joint(joint) => of_joint(&entries, &format!("{joint}.")),
            _ => of_joint(&entries, ""),
        };
        for (k, one) in wanted.iter().enumerate() {
            if let Some(first) = wanted[..k].iter().find(|other| other.ours == one.ours) {
                let at = at(Subject::Column(one.ours.clone()), Some(one.cell));
                return Err(LogError::DoubledColumn { at, first: first.cell + 1, second: one.cell + 1 });
            }
        }
        // Its own name does not stand in for the one that is said, whose unit and sign it may not have.
        let said_of = |one: &Wanted| columns.0.get_key_value(&one.ours).filter(|_| one.spec.is_none());
        if let Some((ours, spec)) = wanted.iter().find_map(said_of) {
            let hint = Some(none_there(ours, spec));
            return Err(LogError::MissingColumn { at: line(), column: spec.name.clone(), found: names, hint });
        }
        let has = |wanted: &[Wanted], column| wanted.iter().any(|one| one.column == Some(column));
        let missing: Vec<Column> =
            [Column::Time, Column::Angle].into_iter().filter(|column| !has(&wanted, *column)).collect();
        if !missing.is_empty()
            && let Some(error) = no_table(&names, line)
        {
            return Err(error);
        }
        let orphan = if is_robot { orphan(&wanted) } else { None };
        let joints =
            || entries.iter().filter_map(|entry| joint_of(entry.name, Column::Angle)).map(str::to_owned).collect();
        if missing.contains(&Column::Angle) {
            let joints: Vec<String> = joints();
            match want {
                Want::Joint(joint) => {
                    return Err(LogError::NoSuchJoint { at: line(), joint: joint.to_owned(), joints });
                }
                _ if !joints.is_empty() => return Err(LogError::SeveralJoints { at: line(), joints }),
                _ => {}
            }
        }
        let mut can_go_on = true;
        for column in missing {
            let mapped = columns.get(column.name());
            let hint = match mapped {
                Some(spec) => Some(none_there(column.name(), spec)),
                None if is_robot && entries.iter().any(|entry| entry.name == Column::Angle.name()) => {
                    Some("this is a log of one joint; name its columns after the joint, as in `lf1.q`".to_owned())
                }
                None => hint(file, column, &names),
            };
            let name = if is_robot && column == Column::Angle { "<joint>.q" } else { column.name() };
            let error = LogError::MissingColumn { at: line(), column: name.to_owned(), found: names.clone(), hint };
            defects.push(Some(column as usize), error);
            let guessed = if mapped.is_some() { Vec::new() } else { guessed(&names, column, is_robot) };
            can_go_on &= !guessed.is_empty();
            wanted.extend(guessed);
        }
        if let Some((joint, name)) = orphan {
            let hint = Some(format!("`{name}` needs the joint's angle"));
            defects.push(
                None,
                LogError::MissingColumn { at: line(), column: format!("{joint}.q"), found: names.clone(), hint },
            );
            can_go_on = false;
        }
        let heading = Self { names, wanted };
        if can_go_on {
            let mut heading = heading;
            heading.wanted.sort_by_key(|one| (one.column != Some(Column::Time), one.cell));
            return Ok(heading);
        }
        let mend = heading.mend(&[]);
        std::mem::take(defects).into_result(mend)?;
        Ok(heading)
    }

    /// Names of cells that are not used, in file order; one without a name is called by its number.
    pub fn ignored(&self) -> Vec<String> {
        let is_used = |cell: &usize| self.wanted.iter().any(|one| one.cell == *cell);
        let unused = self.names.iter().enumerate().filter(|(cell, _)| !is_used(cell));
        unused
            .map(|(i, name)| if name.is_empty() { format!("unnamed column {}", i + 1) } else { name.clone() })
            .collect()
    }

    /// The lines of `[columns]` that would read this table, with units for the cells that need them; empty where they
    /// would say nothing.
    pub fn mend(&self, units: &[(usize, crate::log::columns::Unit)]) -> Columns {
        let mut columns = Columns::default();
        for one in &self.wanted {
            let unit = units.iter().find(|(cell, _)| *cell == one.cell).map(|(_, unit)| *unit);
            let spec = one.spec.clone().unwrap_or_else(|| ColumnSpec::named(&self.names[one.cell]));
            let spec = ColumnSpec { unit: unit.or(spec.unit), ..spec };
            if spec != ColumnSpec::named(&one.ours) {
                columns.0.insert(one.ours.clone(), spec);
            }
        }
        // A setpoint that looks like another unit has that of its angle, whichever it looks like.
        for one in self.wanted.iter().filter(|one| one.column == Some(Column::Setpoint)) {
            let is_suspect = units.iter().any(|(cell, _)| *cell == one.cell);
            let angle = one.ours.strip_suffix("_ref").and_then(|angle| columns.0.get(angle)?.unit);
            if let (true, Some(unit), Some(spec)) = (is_suspect, angle, columns.0.get_mut(&one.ours)) {
                spec.unit = Some(unit);
            }
        }
        let mut guesses: Vec<(usize, Guess)> =
            self.names.iter().enumerate().filter_map(|(cell, name)| Some((cell, guess(name)?))).collect();
        // What was measured goes before what was asked for.
        guesses.sort_by_key(|(cell, _)| is_asked(&self.names[*cell]));
        let angles = guesses.iter().filter(|(_, guess)| guess.column == Column::Angle);
        let read: Vec<String> = angles.filter_map(|(_, guess)| guess.joint.clone()).collect();
        for (cell, found) in guesses {
            let joint = found.joint.filter(|_| read.len() > 1);
            // What is asked of a joint is nothing without its angle.
            if joint.as_ref().is_some_and(|joint| !read.contains(joint)) {
                continue;
            }
            let ours = match joint {
                Some(joint) => format!("{joint}.{}", found.column.name()),
                None => found.column.name().to_owned(),
            };
            let is_known =
                columns.0.contains_key(&ours) || self.wanted.iter().any(|one| one.cell == cell || one.ours == ours);
            if !is_known && self.names[cell] != ours {
                columns.0.insert(ours, ColumnSpec { unit: found.unit, ..ColumnSpec::named(&self.names[cell]) });
            }
        }
        columns
    }
}

fn entries<'a>(names: &'a [String], columns: &'a Columns) -> Vec<Entry<'a>> {
    let is_there = |name: &str| names.iter().any(|other| other == name);
    let mut entries = Vec::with_capacity(names.len());
    for (cell, name) in names.iter().enumerate() {
        let mapped = columns.0.iter().filter(|(_, spec)| spec.name == *name);
        let before = entries.len();
        entries.extend(mapped.map(|(ours, spec)| Entry { cell, name: ours, spec: Some(spec) }));
        let is_mapped_elsewhere = columns.get(name).is_some_and(|spec| is_there(&spec.name));
        if entries.len() == before && !is_mapped_elsewhere {
            entries.push(Entry { cell, name, spec: None });
        }
    }
    entries
}

/// The joint of a column `<joint>.<name>`.
fn joint_of(name: &str, column: Column) -> Option<&str> {
    column_of(name).filter(|(_, found)| *found == column)?.0
}

fn of_joint(entries: &[Entry<'_>], prefix: &str) -> Vec<Wanted> {
    let column = |entry: &Entry<'_>| {
        Column::ALL.into_iter().find(|column| match column {
            Column::Time => entry.name == column.name(),
            column => entry.name.strip_prefix(prefix) == Some(column.name()),
        })
    };
    entries.iter().filter_map(|entry| Some(entry.wanted(Some(column(entry)?)))).collect()
}

/// Cells of a log of several joints; speeds are not needed by a robot's log, only by who asks for all there is.
fn of_robot(entries: &[Entry<'_>], with_speeds: bool) -> Vec<Wanted> {
    let all_felt = FELT.iter().all(|name| entries.iter().any(|entry| entry.name == *name));
    let wanted = |entry: &Entry<'_>| match column_of(entry.name) {
        Some((None, Column::Time)) => Some(entry.wanted(Some(Column::Time))),
        Some((Some(_), Column::Speed)) if !with_speeds => None,
        Some((None, _)) => None,
        Some((Some(_), column)) => Some(entry.wanted(Some(column))),
        None => {
            let is_trunk = BASE.contains(&entry.name) || all_felt && FELT.contains(&entry.name);
            is_trunk.then(|| entry.wanted(None))
        }
    };
    entries.iter().filter_map(wanted).collect()
}

/// The first joint with a setpoint, torque or switch and without an angle, and the column that it has.
fn orphan(wanted: &[Wanted]) -> Option<(String, String)> {
    let has_angle = |joint: &str| wanted.iter().any(|one| joint_of(&one.ours, Column::Angle) == Some(joint));
    wanted.iter().find_map(|one| {
        let joint = column_of(&one.ours)?.0?;
        (!has_angle(joint)).then(|| (joint.to_owned(), one.ours.clone()))
    })
}

/// Cells that look like a column that is missing.
fn guessed(names: &[String], missing: Column, is_robot: bool) -> Vec<Wanted> {
    let of = |cell: usize, joint: Option<&str>| {
        let name = missing.name();
        let ours = joint.map_or_else(|| name.to_owned(), |joint| format!("{joint}.{name}"));
        Wanted { cell, ours, column: Some(missing), spec: Some(ColumnSpec::named(&names[cell])) }
    };
    let by_name = names.iter().enumerate().filter_map(|(cell, name)| Some((cell, guess(name)?)));
    let alike: Vec<(usize, Guess)> = by_name.filter(|(_, guess)| guess.column == missing).collect();
    if is_robot && missing == Column::Angle {
        return alike.iter().filter_map(|(cell, guess)| Some(of(*cell, Some(guess.joint.as_deref()?)))).collect();
    }
    let of_joints: Vec<usize> =
        alike.iter().filter(|(_, guess)| guess.joint.is_some()).map(|(cell, _)| *cell).collect();
    let several = of_joints.len() > 1;
    let is_one_of_several = |cell: &usize| several && of_joints.contains(cell);
    let by_alias = alias(missing, names).filter(|cell| !is_one_of_several(cell));
    let first = by_alias.or(alike.first().map(|(cell, _)| *cell).filter(|_| !several));
    let unit = first.and_then(|cell| guess(&names[cell])).and_then(|guess| guess.unit);
    first
        .map(|cell| {
            let one = of(cell, None);
            Wanted { spec: one.spec.map(|spec| ColumnSpec { unit, ..spec }), ..one }
        })
        .into_iter()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(row: &str, joint: Option<&str>) -> Result<Heading, LogError> {
        find_as(row, joint, &Columns::default())
    }

    fn find_as(row: &str, joint: Option<&str>, columns: &Columns) -> Result<Heading, LogError> {
        let want = joint.map_or(Want::One, Want::Joint);
        let mut defects = Defects::default();
        let row_at = Row { byte: 0, line: 1 };
        let cells: Vec<&str> = row.split(',').collect();
        let heading = Heading::find(Path::new("log.csv"), &cells, row_at, want, columns, &mut defects)?;
        let mend = heading.mend(&[]);
        defects.into_result(mend).map(|()| heading)
    }

    fn cell(heading: &Heading, column: Column) -> Option<usize> {
        heading.wanted.iter().find(|one| one.column == Some(column)).map(|one| one.cell)
    }

    #[test]
    fn columns_are_found_in_any_order_and_others_are_listed() {
        let heading = find(" q , volts,t, ,drive", None).unwrap();
        assert_eq!((cell(&heading, Column::Time), cell(&heading, Column::Angle)), (Some(2), Some(0)));
        assert_eq!(cell(&heading, Column::Torque), None);
        assert_eq!(heading.ignored(), ["volts", "unnamed column 4"]);
    }

    #[test]
    fn a_joint_is_chosen_by_its_prefix() {
        let heading = find("t,lf1.q,lf2.q,lf2.tau", Some("lf2")).unwrap();
        assert_eq!((cell(&heading, Column::Angle), cell(&heading, Column::Torque)), (Some(2), Some(3)));
        assert_eq!(heading.ignored(), ["lf1.q"]);
    }

    #[test]
    fn near_misses_are_hinted_at_with_the_lines_that_read_them() {
        for row in ["T,q", "time,q", "Time [s],q", "t_s,Q", "t,angle", "t,Position (rad)", "t,joint_angle"] {
            let message = find(row, None).unwrap_err().to_string();
            assert!(message.contains("looks like it: rename it") && message.contains("[columns]"), "{row}: {message}");
        }
        let message = find("stamp_ms,angle_deg,target_deg", None).unwrap_err().to_string();
        for line in [
            "column `t` is missing",
            "also: log.csv: line 1: column `q` is missing",
            "t = { name = \"stamp_ms\", unit = \"ms\" }",
            "q = { name = \"angle_deg\", unit = \"deg\" }",
            "q_ref = { name = \"target_deg\", unit = \"deg\" }",
        ] {
            assert!(message.contains(line), "`{line}` is not in\n{message}");
        }
    }

    #[test]
    fn a_column_that_is_said_to_be_another_is_not_read_in_its_place() {
        let said = |ours: &str| Columns([(ours.to_owned(), ColumnSpec::named("angle"))].into());
        let message = find_as("t,q", None, &said("q")).unwrap_err().to_string();
        for part in ["column `angle` is missing", "says that `q` is `angle` here, and there is none"] {
            assert!(message.contains(part), "`{part}` is not in\n{message}");
        }
        assert!(find_as("t,q,angle", None, &said("q")).is_ok() && find_as("t,q", None, &said("tau")).is_ok());
    }

    #[test]
    fn a_doubled_column_that_is_not_used_does_not_matter() {
        assert!(find("t,q,volts,volts", None).is_ok());
        assert!(matches!(find("t,q,q", None), Err(LogError::DoubledColumn { first: 2, second: 3, .. })));
    }
}
