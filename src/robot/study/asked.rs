//! What a log asks of the joints at the times at which it does: setpoints with stamps of their own stay at them.

use crate::log::{Hold, RobotLog, Stamped};

/// Stamps that are nearer than this are one \[s\].
const SAME_S: f64 = 1e-7;

/// The times of a table of setpoints: the log's, and within it the stamps of setpoints that have some of their own.
pub(crate) fn times(log: &RobotLog) -> Vec<f64> {
    let mut t_s = log.t_s.clone();
    let (Some(first_s), Some(last_s)) = (t_s.first().copied(), t_s.last().copied()) else { return t_s };
    let own = log.joints.iter().filter_map(|joint| joint.setpoints.as_ref()).flat_map(|own| &own.t_s);
    t_s.extend(own.filter(|t| (first_s..=last_s).contains(*t)));
    if t_s.len() > log.len() {
        t_s.sort_unstable_by(f64::total_cmp);
        t_s.dedup_by(|later, kept| *later - *kept < SAME_S);
    }
    t_s
}

/// A joint's setpoints at the times of the table: its own, or those that stand beside its readings.
pub(crate) fn setpoints(log: &RobotLog, beside: &[f64], own: Option<&Stamped>, t_s: &[f64], hold: Hold) -> Vec<f64> {
    match own {
        None if t_s.len() == log.len() => beside.to_vec(),
        None => t_s.iter().map(|t| at(&log.t_s, beside, *t, hold)).collect(),
        Some(own) => t_s.iter().map(|t| at(&own.t_s, &own.values, *t, hold)).collect(),
    }
}

/// Whether the motor is on at the times of the table: as at the last sample.
pub(crate) fn switches(log: &RobotLog, on: &[bool], t_s: &[f64]) -> Vec<bool> {
    let last = |t: &f64| log.t_s.partition_point(|sample| *sample < t + SAME_S).saturating_sub(1);
    t_s.iter().map(|t| on.get(last(t)).copied().unwrap_or(true)).collect()
}

/// In force at an instant, or on the straight line between two of them; before the first the first.
fn at(own_s: &[f64], values: &[f64], t_s: f64, hold: Hold) -> f64 {
    let next = own_s.partition_point(|own| *own < t_s + SAME_S);
    let k = next.saturating_sub(1);
    let value = values.get(k).copied().unwrap_or(0.0);
    match (hold, values.get(k + 1), own_s.get(k + 1)) {
        (Hold::Linear, Some(after), Some(after_s)) => {
            value + (after - value) * ((t_s - own_s[k]) / (after_s - own_s[k])).clamp(0.0, 1.0)
        }
        _ => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::JointColumns;

    #[test]
    fn own_stamps_stand_between_those_of_the_readings() {
        let own = Stamped { t_s: vec![-0.5, 0.003, 0.0100000001, 0.5], values: vec![1.0, 2.0, 3.0, 4.0] };
        let a = JointColumns { name: "a".into(), setpoints: Some(own.clone()), ..JointColumns::default() };
        let log = RobotLog {
            file: "log.csv".into(),
            t_s: vec![0.0, 0.01, 0.02],
            joints: vec![a],
            base: None,
            acceleration_m_s2: None,
            ignored_columns: Vec::new(),
            notes: Vec::new(),
        };
        let t_s = times(&log);
        assert_eq!(t_s, [0.0, 0.003, 0.01, 0.02]);
        assert_eq!(setpoints(&log, &[9.0; 3], Some(&own), &t_s, Hold::Step), [1.0, 2.0, 3.0, 3.0]);
        let line = setpoints(&log, &[9.0; 3], Some(&own), &t_s, Hold::Linear);
        assert!((line[0] - (1.0 + 0.5 / 0.503)).abs() < 1e-9 && (line[3] - 3.0 - 0.01 / 0.49).abs() < 1e-6, "{line:?}");
        // What stands beside the readings is read at the other times, too; switches stay until the next sample.
        assert_eq!(setpoints(&log, &[5.0, 6.0, 7.0], None, &t_s, Hold::Step), [5.0, 5.0, 6.0, 7.0]);
        assert_eq!(switches(&log, &[true, false, true], &t_s), [true, true, false, true]);
    }
}
