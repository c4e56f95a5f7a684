//! Logs that are at hand as arrays: the checks of the CSV reader, with errors that name the array and the index.

use super::column::Column;
use super::error::LogError;
use super::motor_types::TauIs;
use super::plausible::{self, LONGEST_GAP_S};
use super::types::{DriveMode, ExtraMass, Log, Role, Stamped};
use std::path::PathBuf;

/// One log in memory, and what a study's `[[log]]` says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct ArrayLog {
    /// What reports and errors call it.
    pub name: String,
    /// Sample times \[s\], strictly increasing.
    pub t_s: Vec<f64>,
    /// Joint angle as the encoder reads it \[rad\].
    pub q_rad: Vec<f64>,
    /// Position setpoint \[rad\]; needed by [`DriveMode::Position`].
    pub q_ref_rad: Option<Vec<f64>>,
    /// Torque \[N m\]; needed by [`DriveMode::Torque`], and of a position-driven log what `tau_is` says.
    pub tau_nm: Option<Vec<f64>>,
    /// Motor on, or joint held in a log with [`DriveMode::Off`].
    pub on: Option<Vec<bool>>,
    /// What the log is used for.
    pub role: Role,
    /// What moves the joint.
    pub drive: DriveMode,
    /// Logs of one session were taken in one go.
    pub session: Option<String>,
    /// A known mass on the link.
    pub extra: Option<ExtraMass>,
    /// What `tau_nm` of a position-driven log is.
    pub tau_is: Option<TauIs>,
    /// Setpoints at stamps of their own, where `q_ref_rad` is what was in force at each sample \[rad\].
    pub setpoints: Option<Stamped>,
    /// A gap of more than a minute is no mistake: the reader of a file has seen it.
    pub holes_are_known: bool,
}

impl ArrayLog {
    /// A log to be fitted in which nothing drives the joint; other fields are set with `..`.
    pub fn new(name: impl Into<String>, t_s: Vec<f64>, q_rad: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            t_s,
            q_rad,
            q_ref_rad: None,
            tau_nm: None,
            on: None,
            role: Role::Fit,
            drive: DriveMode::Off,
            session: None,
            extra: None,
            tau_is: None,
            setpoints: None,
            holes_are_known: false,
        }
    }

    /// The log, checked as the reader of CSV files checks one.
    ///
    /// # Errors
    /// [`LogError::Array`] naming the log, the array and, where there is one, the index.
    pub fn into_log(self) -> Result<Log, LogError> {
        self.check_arrays()?;
        Ok(Log {
            file: PathBuf::from(self.name),
            t_s: self.t_s,
            q_rad: self.q_rad,
            dq_rad_s: None,
            tau_nm: self.tau_nm,
            q_ref_rad: self.q_ref_rad,
            setpoints: self.setpoints,
            drive: self.on,
            ignored_columns: Vec::new(),
            notes: Vec::new(),
        })
    }

    fn check_arrays(&self) -> Result<(), LogError> {
        let n = self.t_s.len();
        let columns = [
            (Column::Time, Some(&self.t_s)),
            (Column::Angle, Some(&self.q_rad)),
            (Column::Setpoint, self.q_ref_rad.as_ref()),
            (Column::Torque, self.tau_nm.as_ref()),
        ];
        let lengths = columns.iter().filter_map(|(column, values)| Some((column.name(), values.as_ref()?.len())));
        for (array, found) in lengths.chain(self.on.iter().map(|on| (Column::Drive.name(), on.len()))) {
            if found != n {
                return Err(self.wrong(array, None, format!("{found} values, expected {n} as in `t`")));
            }
        }
        if n < 2 {
            return Err(self.wrong("t", None, format!("{n} samples, expected at least 2")));
        }
        for (column, values) in columns.iter().filter_map(|(column, values)| Some((*column, (*values)?))) {
            for (index, &value) in values.iter().enumerate() {
                self.check(column, index, value)?;
            }
        }
        for (index, pair) in self.t_s.windows(2).enumerate() {
            if pair[1] <= pair[0] {
                let what = format!("{} s after {} s, expected strictly increasing", pair[1], pair[0]);
                return Err(self.wrong("t", Some(index + 1), what));
            }
        }
        let q_ref = self.q_ref_rad.as_deref().unwrap_or_default();
        if let Some((column, index, fault)) = plausible::faults(&self.t_s, &self.q_rad, q_ref).into_iter().next() {
            return Err(self.wrong(column.name(), Some(index), fault.to_string()));
        }
        let gap = |pair: &[f64]| pair[1] - pair[0] > LONGEST_GAP_S;
        if let Some(before) = self.t_s.windows(2).position(gap).filter(|_| !self.holes_are_known) {
            let gap_s = self.t_s[before + 1] - self.t_s[before];
            let what = format!("a gap of {gap_s:.1} s, expected at most 60 s; split the log there");
            return Err(self.wrong("t", Some(before + 1), what));
        }
        self.check_drive()
    }

    fn check(&self, column: Column, index: usize, value: f64) -> Result<(), LogError> {
        let what = if !value.is_finite() {
            format!("{value}, expected a finite number [{}]", column.unit())
        } else if value.abs() > column.limit() {
            format!("{value}, expected at most {:e} {} in magnitude", column.limit(), column.unit())
        } else {
            return Ok(());
        };
        Err(self.wrong(column.name(), Some(index), what))
    }

    fn check_drive(&self) -> Result<(), LogError> {
        let (array, word) = match self.drive {
            DriveMode::Position if self.q_ref_rad.is_none() => ("q_ref", "position"),
            DriveMode::Torque if self.tau_nm.is_none() => ("tau", "torque"),
            _ => return Ok(()),
        };
        Err(self.wrong(array, None, format!("missing, which drive = \"{word}\" needs")))
    }

    pub(crate) fn wrong(&self, array: &'static str, index: Option<usize>, what: String) -> LogError {
        LogError::Array { log: self.name.clone(), array, index, what }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log() -> ArrayLog {
        let t_s: Vec<f64> = (0..20).map(|k| 0.01 * f64::from(k)).collect();
        let q_rad = t_s.iter().map(|t| 0.3 * (5.0 * t).sin()).collect();
        ArrayLog::new("swing", t_s, q_rad)
    }

    #[test]
    fn good_arrays_are_a_log() {
        let good = log();
        let read = good.clone().into_log().unwrap();
        assert_eq!((read.t_s, read.q_rad, read.drive), (good.t_s, good.q_rad, None));
    }

    type Fault = fn(&mut ArrayLog);

    #[test]
    fn each_fault_is_one_error_that_names_array_and_index() {
        let faults: [(Fault, &str); 10] = [
            (|l| l.q_rad.truncate(5), "swing: array `q`: 5 values, expected 20 as in `t`"),
            (|l| l.on = Some(vec![true]), "swing: array `drive`: 1 values"),
            (|l| l.q_rad[7] = f64::NAN, "swing: array `q`[7]: NaN, expected a finite number [rad]"),
            (|l| l.t_s[3] = l.t_s[2], "swing: array `t`[3]: 0.02 s after 0.02 s, expected strictly increasing"),
            (|l| l.t_s[19] = 100.0, "swing: array `t`[19]: a gap of 99.8 s"),
            (|l| l.t_s.iter_mut().for_each(|t| *t *= 1e3), "swing: array `t`[0]: the median step is 10"),
            (|l| l.q_rad[4] = 45.0, "swing: array `q`[4]: found 45, beyond 4 pi: this looks like degrees"),
            (|l| l.tau_nm = Some(vec![1e9; 20]), "swing: array `tau`[0]: 1000000000, expected at most 1e5 N m"),
            (|l| l.drive = DriveMode::Position, "swing: array `q_ref`: missing, which drive = \"position\" needs"),
            (|l| (l.t_s, l.q_rad) = (vec![0.0], vec![0.0]), "swing: array `t`: 1 samples, expected at least 2"),
        ];
        for (fault, expected) in faults {
            let mut log = log();
            fault(&mut log);
            let message = log.into_log().unwrap_err().to_string();
            assert!(message.starts_with(expected), "`{expected}` is not how this begins:\n{message}");
        }
    }
}
