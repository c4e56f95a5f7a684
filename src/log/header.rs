//! The header row of a log: which column is where, and what to say if one is not.

use std::path::Path;

use super::error::LogError;
use super::place::{Place, Subject};

/// A column of the log format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    Time,
    Angle,
    Speed,
    Torque,
    Setpoint,
    Drive,
}

impl Column {
    const ALL: [Self; 6] = [Self::Time, Self::Angle, Self::Speed, Self::Torque, Self::Setpoint, Self::Drive];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Time => "t",
            Self::Angle => "q",
            Self::Speed => "dq",
            Self::Torque => "tau",
            Self::Setpoint => "q_ref",
            Self::Drive => "drive",
        }
    }

    pub(super) fn unit(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Angle | Self::Setpoint => "rad",
            Self::Speed => "rad/s",
            Self::Torque => "N m",
            Self::Drive => "0 or 1",
        }
    }

    /// Beyond this a cell is refused at once; wide, so that whole columns in a wrong unit get the better message.
    pub(super) fn limit(self) -> f64 {
        match self {
            Self::Time => 1e20, // an epoch in nanoseconds is 1.8e18
            Self::Torque => 1e5,
            _ => 1e9, // 32-bit encoder counts are recognised later
        }
    }

    /// Names that people give this column, without case, blanks, units and punctuation.
    fn aliases(self) -> &'static [&'static str] {
        match self {
            Self::Time => {
                &["t", "time", "timestamp", "timestamps", "times", "stamp", "seconds", "sec", "tsec", "ts", "ms"]
            }
            Self::Angle => &[
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
            Self::Speed => &["dq", "speed", "velocity", "qdot", "qd"],
            Self::Torque => &["tau", "torque", "effort", "taunm", "torquenm", "u", "torquecmd"],
            Self::Setpoint => &[
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
            Self::Drive => &["drive", "motor", "motoron", "enable", "enabled", "torqueenable", "held"],
        }
    }
}

/// The columns of a log, by their place in a row.
#[derive(Debug)]
pub(super) struct Header {
    /// All names, blanks around them removed.
    pub(super) names: Vec<String>,
    /// Where each of [`Column::ALL`] is.
    cells: [Option<usize>; 6],
    /// Name of each used column as it stands in the file.
    prefix: String,
}

impl Header {
    /// Finds the columns of a joint (`None`: of a log of one joint) in the first row.
    pub(super) fn find(file: &Path, cells: &[&str], byte: u64, joint: Option<&str>) -> Result<Self, LogError> {
        let names: Vec<String> = cells.iter().map(|cell| cell.trim().to_owned()).collect();
        let at = |subject, cell| Box::new(Place::in_log(file, byte, 1, subject, cell));
        let prefix = joint.map_or_else(String::new, |joint| format!("{joint}."));
        let mut header = Self { names, cells: [None; 6], prefix };
        for column in Column::ALL {
            let wanted = header.column_name(column);
            let mut places = header.names.iter().enumerate().filter(|(_, name)| **name == wanted).map(|(i, _)| i);
            let (first, second) = (places.next(), places.next());
            if let (Some(first), Some(second)) = (first, second) {
                let at = at(Subject::Column(wanted), Some(second));
                return Err(LogError::DoubledColumn { at, first: first + 1, second: second + 1 });
            }
            header.cells[column as usize] = first;
        }
        let missing = [Column::Time, Column::Angle].into_iter().find(|column| header.cell(*column).is_none());
        let Some(missing) = missing else { return Ok(header) };

        if let Some(error) = no_table(&header.names, || at(Subject::Line, None)) {
            return Err(error);
        }
        let joints = header.joints();
        if missing == Column::Angle {
            if let Some(joint) = joint {
                let at = at(Subject::Line, None);
                return Err(LogError::NoSuchJoint { at, joint: joint.to_owned(), joints });
            }
            if !joints.is_empty() {
                return Err(LogError::SeveralJoints { at: at(Subject::Line, None), joints });
            }
        }
        let hint = hint(file, missing, &header.names);
        let column = header.column_name(missing);
        Err(LogError::MissingColumn { at: at(Subject::Line, None), column, found: header.names, hint })
    }

    /// Name that the column has in this file: time is shared by all joints.
    pub(super) fn column_name(&self, column: Column) -> String {
        if column == Column::Time { column.name().to_owned() } else { format!("{}{}", self.prefix, column.name()) }
    }

    /// Where the column is in a row.
    pub(super) fn cell(&self, column: Column) -> Option<usize> {
        self.cells[column as usize]
    }

    /// Columns that are not used, in file order; one without a name is called by its number.
    pub(super) fn ignored(&self) -> Vec<String> {
        let unused = self.names.iter().enumerate().filter(|(i, _)| !self.cells.contains(&Some(*i)));
        unused
            .map(|(i, name)| if name.is_empty() { format!("unnamed column {}", i + 1) } else { name.clone() })
            .collect()
    }

    fn joints(&self) -> Vec<String> {
        let joints = self.names.iter().filter_map(|name| name.strip_suffix(".q"));
        joints.filter(|joint| !joint.is_empty()).map(str::to_owned).collect()
    }
}

/// Whether the first row is no header at all: other separators, or numbers.
pub(super) fn no_table(names: &[String], at: impl Fn() -> Box<Place>) -> Option<LogError> {
    if let Some(found) = other_separator(names) {
        return Some(LogError::Separator { at: at(), found });
    }
    names.iter().all(|name| name.parse::<f64>().is_ok()).then(|| LogError::NoHeader { at: at() })
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
    let unit = missing.unit();
    for alias in missing.aliases() {
        if let Some(name) = names.iter().find(|name| bare(name) == *alias) {
            return Some(format!("`{name}` looks like it: rename it to `{}` and give it in {unit}", missing.name()));
        }
    }
    None
}

/// A name without case, punctuation, and a unit in brackets.
fn bare(name: &str) -> String {
    let end = name.find(['[', '(', '{', '/']).filter(|&i| i > 0).unwrap_or(name.len());
    name[..end].chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(row: &str, joint: Option<&str>) -> Result<Header, LogError> {
        Header::find(Path::new("log.csv"), &row.split(',').collect::<Vec<_>>(), 0, joint)
    }

    #[test]
    fn columns_are_found_in_any_order_and_others_are_listed() {
        let header = find(" q , volts,t, ,drive", None).unwrap();
        assert_eq!((header.cell(Column::Time), header.cell(Column::Angle)), (Some(2), Some(0)));
        assert_eq!(header.cell(Column::Torque), None);
        assert_eq!(header.ignored(), ["volts", "unnamed column 4"]);
    }

    #[test]
    fn a_joint_is_chosen_by_its_prefix() {
        let header = find("t,lf1.q,lf2.q,lf2.tau", Some("lf2")).unwrap();
        assert_eq!((header.cell(Column::Angle), header.cell(Column::Torque)), (Some(2), Some(3)));
        assert_eq!(header.ignored(), ["lf1.q"]);
    }

    #[test]
    fn near_misses_are_hinted_at() {
        for row in ["T,q", "time,q", "Time [s],q", "t_s,Q", "t,angle", "t,Position (rad)", "t,joint_angle"] {
            let message = find(row, None).unwrap_err().to_string();
            assert!(message.contains("looks like it: rename it"), "{row}: {message}");
        }
    }

    #[test]
    fn a_doubled_column_that_is_not_used_does_not_matter() {
        assert!(find("t,q,volts,volts", None).is_ok());
        assert!(matches!(find("t,q,q", None), Err(LogError::DoubledColumn { first: 2, second: 3, .. })));
    }
}
