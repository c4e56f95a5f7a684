//! Reads a log of several joints: `t`, then `<joint>.q` and, where present, `<joint>.q_ref`, `<joint>.tau`,
//! `<joint>.drive`; trunk and accelerometer columns.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use csv::ByteRecord;
use rayon::prelude::*;

use super::error::LogError;
use super::header::{Column, hint, no_table};
use super::place::{Place, Subject};
use super::plausible::{self, Extremes, Row};
use super::rows;

/// A log of a whole robot: samples in columns, all of the same length.
///
/// Invariants that the reader has checked: at least two samples, `t_s` strictly increasing, every number finite, at least
/// one joint, no joint twice.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLog {
    /// The file as the user named it; used in messages only.
    pub file: PathBuf,
    /// Sample times \[s\], strictly increasing, not necessarily uniform.
    pub t_s: Vec<f64>,
    /// At least one, in the order of their `q` columns.
    pub joints: Vec<JointColumns>,
    /// The trunk, where the log has any column of it.
    pub base: Option<BaseColumns>,
    /// Accelerometer readings along the trunk's x, y, z \[m/s^2\], where the log has all three.
    pub acceleration_m_s2: Option<[Vec<f64>; 3]>,
    /// Columns that were present and are not used, in file order.
    pub ignored_columns: Vec<String>,
}

/// One joint of a [`RobotLog`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointColumns {
    /// `lf1` for instance.
    pub name: String,
    /// Angle as the encoder reads it \[rad\].
    pub q_rad: Vec<f64>,
    /// Setpoint \[rad\].
    pub q_ref_rad: Option<Vec<f64>>,
    /// Torque \[N m\].
    pub tau_nm: Option<Vec<f64>>,
    /// Whether the motor is on, from each sample to the next; `None`: as the study says.
    pub drive: Option<Vec<bool>>,
}

/// The trunk along a [`RobotLog`]; `R = Ry(yaw) Rx(pitch) Rz(roll)`.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "the fields are the columns base.x to base.yaw, in m and rad")]
pub struct BaseColumns {
    pub x_m: Option<Vec<f64>>,
    pub y_m: Option<Vec<f64>>,
    pub z_m: Option<Vec<f64>>,
    pub roll_rad: Option<Vec<f64>>,
    pub pitch_rad: Option<Vec<f64>>,
    pub yaw_rad: Option<Vec<f64>>,
}

impl RobotLog {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t_s.len()
    }

    /// Always false for a log that the reader has accepted.
    pub fn is_empty(&self) -> bool {
        self.t_s.is_empty()
    }

    /// A joint by name.
    pub fn joint(&self, name: &str) -> Option<&JointColumns> {
        self.joints.iter().find(|joint| joint.name == name)
    }
}

const BASE: [&str; 6] = ["base.x", "base.y", "base.z", "base.roll", "base.pitch", "base.yaw"];
const FELT: [&str; 3] = ["acc.x", "acc.y", "acc.z"];
/// Columns of a joint, behind its name and a point.
const OF_JOINT: [Column; 4] = [Column::Angle, Column::Setpoint, Column::Torque, Column::Drive];
/// No trunk goes farther \[m\], and no accelerometer reads more \[m/s^2\].
const FARTHEST: f64 = 1e5;

/// Reads a log of several joints.
///
/// # Errors
/// As [`read_log`](super::read_log); a joint without a `q` column, or with a reading or setpoint missing in a row, is
/// named with line and column.
pub fn read_robot_log(path: &Path) -> Result<RobotLog, LogError> {
    let mut table: Option<Table> = None;
    rows::for_each_row(path, |row, record| match &mut table {
        None => {
            let cells = rows::text_cells(path, row, record)?;
            table = Some(Table::new(path, &cells, row)?);
            Ok(())
        }
        Some(table) => table.push(row, record),
    })?;
    table.ok_or_else(|| LogError::Empty { file: path.to_path_buf() })?.finish()
}

/// Reads the logs of a study, whose period is known where the study says it.
///
/// # Errors
/// The error of the first log, in their order, that cannot be read, or whose period is about 1000 times off the study's.
pub(super) fn read_robot_logs(paths: &[&Path], period_s: Option<f64>) -> Result<Vec<RobotLog>, LogError> {
    let read = |path: &&Path| {
        let log = read_robot_log(path)?;
        period_s.map_or(Ok(()), |period_s| plausible::check_stamps(&log.file, &log.t_s, period_s))?;
        Ok(log)
    };
    let logs: Vec<Result<RobotLog, LogError>> = paths.par_iter().map(read).collect();
    logs.into_iter().collect()
}

#[derive(Clone, Copy, PartialEq)]
enum Target {
    Time,
    Joint(usize, Column),
    Base(usize),
    Felt(usize),
}

/// A column that is used.
struct Used {
    cell: usize,
    target: Target,
    values: Vec<f64>,
}

impl Used {
    fn limit_and_unit(&self) -> (f64, &'static str) {
        match self.target {
            Target::Time => (Column::Time.limit(), Column::Time.unit()),
            Target::Joint(_, column) => (column.limit(), column.unit()),
            Target::Base(k) => (FARTHEST, if k < 3 { "m" } else { "rad" }),
            Target::Felt(_) => (FARTHEST, "m/s^2"),
        }
    }
}

struct Table<'a> {
    path: &'a Path,
    names: Vec<String>,
    /// Time first.
    used: Vec<Used>,
    joints: Vec<String>,
    header_row: Row,
    previous: Row,
    extremes: Vec<Extremes>,
}

impl<'a> Table<'a> {
    fn new(path: &'a Path, cells: &[&str], row: Row) -> Result<Self, LogError> {
        let names: Vec<String> = cells.iter().map(|cell| cell.trim().to_owned()).collect();
        let at = |subject, cell| Box::new(Place::in_log(path, row.byte, row.line, subject, cell));
        let line = || at(Subject::Line, None);
        if let Some(error) = no_table(&names, line) {
            return Err(error);
        }
        let missing = |column: String, hint: Option<String>| {
            Err(LogError::MissingColumn { at: line(), column, found: names.clone(), hint })
        };
        let Some(time) = names.iter().position(|name| name == Column::Time.name()) else {
            return missing(Column::Time.name().to_owned(), hint(path, Column::Time, &names));
        };
        let of = |name: &str, column: Column| {
            name.strip_suffix(column.name()).and_then(|rest| rest.strip_suffix('.')).map(str::to_owned)
        };
        let joints: Vec<String> =
            names.iter().filter_map(|name| of(name, Column::Angle)).filter(|joint| !joint.is_empty()).collect();
        if joints.is_empty() {
            let one = names.iter().any(|name| name == Column::Angle.name());
            let hint =
                one.then(|| "this is a log of one joint; name its columns after the joint, as in `lf1.q`".into());
            return missing("<joint>.q".to_owned(), hint.or_else(|| self::hint(path, Column::Angle, &names)));
        }
        let mut used = vec![Used { cell: time, target: Target::Time, values: Vec::new() }];
        let mut first: BTreeMap<&str, usize> = BTreeMap::new();
        for (cell, name) in names.iter().enumerate() {
            let joint = OF_JOINT.iter().find_map(|column| Some((of(name, *column)?, *column)));
            let target = match joint {
                Some((joint, column)) if !joint.is_empty() => match joints.iter().position(|other| *other == joint) {
                    Some(joint) => Target::Joint(joint, column),
                    None => return missing(format!("{joint}.q"), Some(format!("`{name}` needs the joint's angle"))),
                },
                _ if name == Column::Time.name() => Target::Time,
                _ => match (BASE.iter().position(|n| n == name), FELT.iter().position(|n| n == name)) {
                    (Some(k), _) => Target::Base(k),
                    (_, Some(k)) => Target::Felt(k),
                    _ => continue,
                },
            };
            if let Some(first) = first.insert(name, cell) {
                let at = at(Subject::Column(name.clone()), Some(cell));
                return Err(LogError::DoubledColumn { at, first: first + 1, second: cell + 1 });
            }
            if target != Target::Time {
                used.push(Used { cell, target, values: Vec::new() });
            }
        }
        let felt = |used: &Used| matches!(used.target, Target::Felt(_));
        if used.iter().filter(|used| felt(used)).count() < FELT.len() {
            used.retain(|used| !felt(used));
        }
        let extremes = joints.iter().map(|_| Extremes::default()).collect();
        Ok(Self { path, names, used, joints, header_row: row, previous: row, extremes })
    }

    fn place(&self, row: Row, cell: usize) -> Box<Place> {
        let subject = Subject::Column(self.names[cell].clone());
        Box::new(Place::in_log(self.path, row.byte, row.line, subject, Some(cell)))
    }

    fn push(&mut self, row: Row, record: &ByteRecord) -> Result<(), LogError> {
        rows::check_row(self.path, row, record, &self.names)?;
        for k in 0..self.used.len() {
            let used = &self.used[k];
            let (at, target, (limit, unit)) = (used.cell, used.target, used.limit_and_unit());
            let Some(cell) = record.get(at) else { continue };
            let read = match target {
                Target::Joint(_, Column::Drive) => rows::switch(cell).map(|on| f64::from(u8::from(on))),
                _ => rows::number(cell, limit, unit, used.values.is_empty()),
            };
            let value = read.map_err(|fault| rows::cell_error(self.place(row, at), cell, fault))?;
            match target {
                Target::Time => self.take_time(row, value)?,
                Target::Joint(joint, column) => self.extremes[joint].see(column, value, row),
                _ => {}
            }
            self.used[k].values.push(value);
        }
        self.previous = row;
        Ok(())
    }

    fn take_time(&mut self, row: Row, time_s: f64) -> Result<(), LogError> {
        for extremes in &mut self.extremes {
            extremes.see(Column::Time, time_s, row);
        }
        let Some(&previous_s) = self.used[0].values.last() else { return Ok(()) };
        if time_s <= previous_s {
            let cell = self.used[0].cell;
            let previous_line = self.place(self.previous, cell).line;
            return Err(LogError::TimeOrder { at: self.place(row, cell), previous_line, time_s, previous_s });
        }
        self.extremes[0].see_step(time_s - previous_s, self.previous, row);
        Ok(())
    }

    fn finish(self) -> Result<RobotLog, LogError> {
        let samples = self.used[0].values.len();
        if samples < 2 {
            return Err(rows::too_few(self.path, if samples == 0 { self.header_row } else { self.previous }, samples));
        }
        let column = |target: Target| self.used.iter().find(|used| used.target == target);
        let values = |target| column(target).map(|used| used.values.clone());
        let t_s = self.used[0].values.clone();
        let mut joints = Vec::with_capacity(self.joints.len());
        for (j, name) in self.joints.iter().enumerate() {
            let of = |column| values(Target::Joint(j, column));
            let joint = JointColumns {
                name: name.clone(),
                q_rad: of(Column::Angle).unwrap_or_default(),
                q_ref_rad: of(Column::Setpoint),
                tau_nm: of(Column::Torque),
                drive: of(Column::Drive).map(|column| column.iter().map(|on| *on == 1.0).collect()),
            };
            let q_ref = joint.q_ref_rad.as_deref().unwrap_or_default();
            if let Some((row, wrong, fault)) = plausible::check(&t_s, &joint.q_rad, q_ref, &self.extremes[j]) {
                let target = if wrong == Column::Time { Target::Time } else { Target::Joint(j, wrong) };
                let cell = column(target).map_or(self.used[0].cell, |used| used.cell);
                return Err(LogError::Units { at: self.place(row, cell), fault });
            }
            joints.push(joint);
        }
        if let Some((gap_s, before, after)) = self.extremes[0].gap {
            let cell = self.used[0].cell;
            let previous_line = self.place(before, cell).line;
            return Err(LogError::TimeGap { at: self.place(after, cell), previous_line, gap_s });
        }
        let [x_m, y_m, z_m, roll_rad, pitch_rad, yaw_rad] = [0, 1, 2, 3, 4, 5].map(|k| values(Target::Base(k)));
        let base = BaseColumns { x_m, y_m, z_m, roll_rad, pitch_rad, yaw_rad };
        let [x, y, z] = [0, 1, 2].map(|k| values(Target::Felt(k)));
        let is_used = |cell: usize| self.used.iter().any(|used| used.cell == cell);
        let unused = self.names.iter().enumerate().filter(|(cell, _)| !is_used(*cell));
        let ignored_columns = unused
            .map(|(i, name)| if name.is_empty() { format!("unnamed column {}", i + 1) } else { name.clone() })
            .collect();
        Ok(RobotLog {
            file: self.path.to_path_buf(),
            t_s,
            joints,
            base: (base != BaseColumns::default()).then_some(base),
            acceleration_m_s2: x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]),
            ignored_columns,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<RobotLog, LogError> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("log.csv");
        std::fs::write(&path, text).unwrap();
        read_robot_log(&path)
    }

    #[test]
    fn columns_are_found_in_any_order() {
        let log = read(
            "lf1.q_ref,t,volts,lf1.q,base.z,rr3.q,rr3.drive,acc.x,acc.y,acc.z\n\
             0.1,0,7.4,0.11,-1,0.2,1,0,9.81,0\n0.1,0.008,7.4,0.12,-1.5,0.3,0,0,9.8,0.1\n",
        )
        .unwrap();
        assert_eq!((log.len(), log.joints.len(), log.joints[1].name.as_str()), (2, 2, "rr3"));
        assert_eq!(log.joint("lf1").unwrap().q_ref_rad.as_deref(), Some(&[0.1, 0.1][..]));
        assert_eq!(log.joint("rr3").unwrap().drive.as_deref(), Some(&[true, false][..]));
        let base = log.base.unwrap();
        assert_eq!((base.z_m.as_deref(), base.x_m), (Some(&[-1.0, -1.5][..]), None));
        assert_eq!(log.acceleration_m_s2.unwrap()[1], [9.81, 9.8]);
        assert_eq!(log.ignored_columns, ["volts"]);
    }

    #[test]
    fn each_fault_is_one_error_that_names_line_and_column() {
        for (text, expected) in [
            ("t,lf1.q,lf1.q_ref\n0,0,0\n0.008,0,\n", "line 3, column `lf1.q_ref`: the cell is empty"),
            ("t,lf1.q,lf1.q_ref\n0,0,0\n0.008,0,nan\n", "line 3, column `lf1.q_ref`: found `nan`"),
            ("t,lf1.q\n0,0\n0,0\n", "line 3, column `t`: time repeats"),
            ("t,lf1.q,lf1.q\n0,0,0\n1,0,0\n", "column `lf1.q`: the column appears twice"),
            ("t,lf1.q,t\n0,0,0\n1,0,0\n", "column `t`: the column appears twice"),
            ("t,q\n0,0\n0.1,0\n", "column `<joint>.q` is missing"),
            ("t,lf1.q,lf2.q_ref\n0,0,0\n0.1,0,0\n", "column `lf2.q` is missing"),
            ("lf1.q\n0\n0\n", "column `t` is missing"),
            ("t;lf1.q\n0;0\n", "semicolons"),
            ("t,lf1.q\n0,0\n0.008\n", "line 3: 1 cells, expected 2"),
            ("t,lf1.q,lf1.drive\n0,0,2\n", "line 2, column `lf1.drive`: found `2`"),
            ("t,lf1.q\n0,0\n", "1 sample after the header"),
            ("t,lf1.q\n0,30\n0.008,31.5\n", "looks like degrees"),
            ("t,lf1.q\n0,0\n8,0\n16,0\n", "looks like milliseconds"),
            ("", "the file is empty"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected) && message.contains("log.csv"), "{text:?}: {message}");
        }
    }
}
