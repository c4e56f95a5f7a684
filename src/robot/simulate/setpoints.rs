//! What is asked of the joints: a table over time.

use super::SimulateError;
use crate::log::Hold;
use crate::robot::{JointId, Model, Setpoints as Source};
use std::f64::consts::TAU;
use std::path::Path;

/// Setpoints of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// One for each time \[rad\].
    pub angle_rad: Vec<f64>,
    /// Whether the motor is on, from each time to the next; `None`: always.
    pub on: Option<Vec<bool>>,
}

/// Setpoints of all joints; a joint without a column has its motor off.
#[derive(Clone, Debug, PartialEq)]
pub struct Setpoints {
    /// Rising times \[s\]; a run goes from the first to the last.
    pub t_s: Vec<f64>,
    /// By joint, in the model's order.
    pub columns: Vec<Option<Column>>,
    /// How they are read between two times.
    pub hold: Hold,
}

/// Longest table \[s\]: what a run records of a longer one would not fit.
const LONGEST_S: f64 = 3600.0;

impl Setpoints {
    /// Constant setpoints for all joints that have a controller.
    ///
    /// # Errors
    /// [`SimulateError::Value`] for a duration that is not above 0 and at most an hour.
    pub fn constant(model: &Model, angle_rad: &[f64], duration_s: f64, period_s: f64) -> Result<Self, SimulateError> {
        let t_s = grid(duration_s, period_s)?;
        let column = |angle: &f64| Some(Column { angle_rad: vec![*angle; t_s.len()], on: None });
        let columns = angle_rad.iter().take(model.joints().len()).map(column).collect();
        Ok(Self { t_s, columns, hold: Hold::Linear })
    }

    /// A gait, or any other source of setpoints, from its beginning, read at a period and joined by lines.
    ///
    /// # Errors
    /// [`SimulateError::Value`] for a duration or period that makes no table.
    pub fn sampled(source: &impl Source, model: &Model, duration_s: f64, period_s: f64) -> Result<Self, SimulateError> {
        let t_s = grid(duration_s, period_s)?;
        let column = |id| Some(Column { angle_rad: t_s.iter().map(|t| source.angle_rad(id, *t)).collect(), on: None });
        let columns = model.joint_ids().map(column).collect();
        Ok(Self { t_s, columns, hold: Hold::Linear })
    }

    /// Reads a table: `t` and columns by joint (`lf1`, or `lf1.q_ref`); joints without a column keep their first value of
    /// `others_rad`.
    ///
    /// # Errors
    /// [`SimulateError::File`] where it cannot be read, [`SimulateError::Setpoints`] with line and column.
    pub fn read(model: &Model, file: &Path, others_rad: &[f64]) -> Result<Self, SimulateError> {
        let bytes =
            std::fs::read(file).map_err(|source| crate::log::LogError::Read { file: file.to_path_buf(), source })?;
        let wrong = |what: String| SimulateError::Setpoints { what: format!("{}: {what}", file.display()) };
        let text = String::from_utf8(bytes).map_err(|_| wrong("not UTF-8 text".to_owned()))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let (_, header) = lines.next().ok_or_else(|| wrong("the file is empty".to_owned()))?;
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let time = names.iter().position(|name| *name == "t").ok_or_else(|| wrong("column `t` is missing".into()))?;
        let joint_of = |name: &&str| model.joint(name.strip_suffix(".q_ref").unwrap_or(name)).ok();
        let joints: Vec<Option<JointId>> = names.iter().map(joint_of).collect();
        if joints.iter().all(Option::is_none) {
            let names: Vec<&str> = model.joints().iter().map(|joint| joint.name.as_str()).collect();
            let (robot, names) = (model.name(), names.join(", "));
            return Err(wrong(format!("no column is a joint of {robot}; columns are named by joint: {names}")));
        }
        let mut t_s: Vec<f64> = Vec::new();
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
        for (line, text) in lines {
            let cells: Vec<&str> = text.split(',').collect();
            if cells.len() != names.len() {
                let found = cells.len();
                return Err(wrong(format!("line {}: {found} cells, expected {}", line + 1, names.len())));
            }
            for (k, cell) in cells.iter().enumerate() {
                if k != time && joints[k].is_none() {
                    continue;
                }
                let number = cell.trim().parse().ok().filter(|x: &f64| x.is_finite());
                let number = number
                    .ok_or_else(|| wrong(format!("line {}, column {}: `{cell}` is no number", line + 1, names[k])))?;
                // What has no end may turn as far as it likes.
                let has_ends = joints[k].is_some_and(|id| model.joints()[id.index()].software_rad.is_some());
                if has_ends && number.abs() > TAU {
                    let column = names[k];
                    return Err(wrong(format!("line {}, column {column}: {number} looks like degrees", line + 1)));
                }
                values[k].push(number);
            }
            let now = values[time][t_s.len()];
            if t_s.last().is_some_and(|last| *last >= now) {
                return Err(wrong(format!("line {}: t does not rise", line + 1)));
            }
            t_s.push(now);
        }
        let duration_s = t_s.last().zip(t_s.first()).map_or(0.0, |(last, first)| last - first);
        if t_s.len() < 2 || duration_s > LONGEST_S {
            return Err(wrong(format!(
                "{} rows over {duration_s} s; expected two rows or more, an hour at most",
                t_s.len()
            )));
        }
        let mut columns: Vec<Option<Column>> =
            others_rad.iter().map(|q| Some(Column { angle_rad: vec![*q; t_s.len()], on: None })).collect();
        columns.resize(model.joints().len(), None);
        for (joint, values) in joints.into_iter().zip(values) {
            if let Some(joint) = joint {
                columns[joint.index()] = Some(Column { angle_rad: values, on: None });
            }
        }
        Ok(Self { t_s, columns, hold: Hold::Linear })
    }

    /// The setpoints clipped to the software's limits (Table A.3), with the joints for which that changed something.
    #[must_use]
    pub fn clipped(&self, model: &Model) -> (Self, Vec<JointId>) {
        let mut clipped = self.clone();
        let mut joints = Vec::new();
        for (id, column) in model.joint_ids().zip(&mut clipped.columns) {
            let (Some(column), Some([low, high])) = (column, model.joints()[id.index()].software_rad) else { continue };
            let mut changed = false;
            for angle in &mut column.angle_rad {
                let within = angle.max(low).min(high);
                changed |= within != *angle;
                *angle = within;
            }
            if changed {
                joints.push(id);
            }
        }
        (clipped, joints)
    }

    /// Switches a joint's motor off from a time on; before the table's first time: all along.
    pub fn switch_off(&mut self, joint: JointId, from_s: f64) {
        let k = self.t_s.partition_point(|t| *t < from_s);
        if k > 0 && k < self.t_s.len() && self.t_s[k] > from_s {
            // A row of its own for the instant.
            let share = (from_s - self.t_s[k - 1]) / (self.t_s[k] - self.t_s[k - 1]);
            self.t_s.insert(k, from_s);
            for column in self.columns.iter_mut().flatten() {
                let (before, after) = (column.angle_rad[k - 1], column.angle_rad[k]);
                let between = match self.hold {
                    Hold::Step => before,
                    Hold::Linear => before + (after - before) * share,
                };
                column.angle_rad.insert(k, between);
                if let Some(on) = &mut column.on {
                    on.insert(k, on[k - 1]);
                }
            }
        }
        if let Some(column) = self.columns.get_mut(joint.index()).and_then(Option::as_mut) {
            let on = column.on.get_or_insert_with(|| vec![true; self.t_s.len()]);
            on[k.min(self.t_s.len())..].fill(false);
        }
    }

    /// A joint's setpoint at a time \[rad\]; `None` where it has no column.
    pub fn at(&self, joint: JointId, t_s: f64) -> Option<f64> {
        let column = self.columns.get(joint.index())?.as_ref()?;
        let next = self.t_s.partition_point(|t| *t <= t_s + 1e-9);
        let k = next.max(1) - 1;
        let value = column.angle_rad.get(k)?;
        Some(match (self.hold, column.angle_rad.get(k + 1)) {
            (Hold::Linear, Some(after)) => {
                value + (after - value) * ((t_s - self.t_s[k]) / (self.t_s[k + 1] - self.t_s[k])).clamp(0.0, 1.0)
            }
            _ => *value,
        })
    }

    pub(super) fn check(&self, model: &Model) -> Result<(), SimulateError> {
        let wrong = |what: String| Err(SimulateError::Setpoints { what });
        if self.t_s.len() < 2 || !self.t_s.windows(2).all(|t| t[0] < t[1]) || !self.t_s.iter().all(|t| t.is_finite()) {
            return wrong("times must rise, and be two or more".to_owned());
        }
        if self.columns.len() != model.joints().len() {
            return wrong(format!("{} columns for {} joints", self.columns.len(), model.joints().len()));
        }
        for (joint, column) in model.joints().iter().zip(&self.columns) {
            let Some(column) = column else { continue };
            let on = column.on.as_ref().map_or(self.t_s.len(), Vec::len);
            if column.angle_rad.len() != self.t_s.len() || on != self.t_s.len() {
                return wrong(format!("joint {}: its column has not the table's length", joint.name));
            }
            if let Some(angle) = column.angle_rad.iter().find(|q| !(q.abs() <= 1e3)) {
                return wrong(format!("joint {}: {angle} rad", joint.name));
            }
        }
        Ok(())
    }
}

/// Times from 0 to a duration.
fn grid(duration_s: f64, period_s: f64) -> Result<Vec<f64>, SimulateError> {
    if !(duration_s > 0.0 && duration_s <= LONGEST_S) {
        let what = "the duration [s]";
        return Err(SimulateError::Value { what, value: duration_s, allowed: "above 0, at most 3600" });
    }
    if !(period_s > 1e-5 && period_s <= duration_s) {
        let what = "the period [s]";
        return Err(SimulateError::Value { what, value: period_s, allowed: "above 1e-5, not above the duration" });
    }
    let n = (duration_s / period_s).round() as usize;
    Ok((0..=n).map(|k| k as f64 * period_s).collect())
}
