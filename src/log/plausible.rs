//! Whether a log's numbers can be radians and seconds.

use std::f64::consts::PI;
use std::path::Path;

use super::column::Column;
use super::error::{LogError, UnitFault};
use super::types::{Log, SensorSpec};
use crate::number::extent;

/// Gaps longer than this are two recordings \[s\].
pub(super) const LONGEST_GAP_S: f64 = 60.0;
/// No joint logger is slower than this \[s\]; 8 ms read as seconds is far beyond it.
const SLOWEST_STEP_S: f64 = 0.5;
/// No logger of joints is faster, on average \[s\]; 10 ms read as us is far below it.
const FASTEST_STEP_S: f64 = 1e-6;
/// Loggers that are faster than this are as likely to tell milliseconds: it is the motion that shows \[s\].
const HASTY_STEP_S: f64 = 1e-4;
/// Two turns \[rad\]: more than a limb's joint does, little in degrees.
const WIDEST_ANGLE: f64 = 4.0 * PI;
/// Median speed of a moving joint that only degrees reach \[rad/s\].
const FASTEST_MEDIAN: f64 = 60.0;
/// Speeds are taken over at least this long \[s\], so that noise at a high sampling rate is not speed.
const SPEED_BASE_S: f64 = 0.02;

/// Where a row of a log starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Byte offset in the file.
    pub(super) byte: u64,
    /// Line as the CSV reader counts; used only where the file cannot be read again.
    pub(super) line: u64,
}

/// Columns that seem to be in another unit, each with the sample that shows it, time first. A reading that is not a number
/// counts for nothing here.
pub(super) fn faults(t: &[f64], q: &[f64], q_ref: &[f64]) -> Vec<(Column, usize, UnitFault)> {
    let mut faults = Vec::new();
    let step_s = median_step(t);
    if step_s >= SLOWEST_STEP_S {
        let unit = match step_s {
            s if s < 500.0 => "milliseconds",
            s if s < 5e5 => "microseconds",
            _ => "nanoseconds",
        };
        faults.push((Column::Time, 0, UnitFault::Time { step_s, unit }));
    } else if let Some(step_s) = hasty_step(t, q) {
        faults.push((Column::Time, 0, UnitFault::Haste { step_s }));
    }
    let Some((at, angle)) = largest(q) else { return faults };
    let beyond = |values: &[f64], value: f64| {
        let whole = values.iter().all(|value| value.is_nan() || value.fract() == 0.0);
        if whole && value.abs() > 720.0 { UnitFault::Counts { value } } else { UnitFault::Angle { value } }
    };
    if angle.abs() > WIDEST_ANGLE {
        faults.push((Column::Angle, at, beyond(q, angle)));
    } else if faults.is_empty() {
        let median_rad_s = median_moving_speed(t, q, step_s);
        if median_rad_s > FASTEST_MEDIAN {
            faults.push((Column::Angle, at, UnitFault::Speed { median_rad_s }));
        }
    }
    if let Some((at, setpoint)) = largest(q_ref) {
        // pi/180 apart: a joint follows its setpoint closer than this
        let ratio = setpoint.abs() / angle.abs();
        if angle.abs() > WIDEST_ANGLE && setpoint.abs() > WIDEST_ANGLE {
            faults.push((Column::Setpoint, at, beyond(q_ref, setpoint)));
        } else if setpoint.abs() > WIDEST_ANGLE || (setpoint.abs() > 2.0 && ratio > 40.0 && ratio < 80.0) {
            faults.push((Column::Setpoint, at, UnitFault::Setpoint { value: setpoint, angle_rad: angle.abs() }));
        }
    }
    faults
}

/// The mean step \[s\], where it is too short for any log, or for the way that the joint goes from its one end to its other.
fn hasty_step(t: &[f64], q: &[f64]) -> Option<f64> {
    let lasts_s = t.last()? - t.first()?;
    let step_s = lasts_s / (t.len() - 1) as f64;
    let [low, high] = extent(q.iter().copied());
    // What goes farther is another unit of angles.
    let is_angle = high - low <= WIDEST_ANGLE;
    let is_too_far = step_s < HASTY_STEP_S && is_angle && high - low > FASTEST_MEDIAN * lasts_s;
    (step_s > 0.0 && (step_s < FASTEST_STEP_S || is_too_far)).then_some(step_s)
}

/// The number of largest magnitude, the first of several.
fn largest(values: &[f64]) -> Option<(usize, f64)> {
    let numbers = values.iter().copied().enumerate().filter(|(_, value)| !value.is_nan());
    numbers.fold(None, |most: Option<(usize, f64)>, (at, value)| match most {
        Some((_, largest)) if value.abs() <= largest.abs() => most,
        _ => Some((at, value)),
    })
}

/// Median of the sampling steps \[s\]; zero where there are fewer than two samples.
pub(super) fn median_step(t_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = t_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    median(&mut steps)
}

/// Upper median; zero of nothing.
pub(super) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

fn median_moving_speed(t: &[f64], q: &[f64], step_s: f64) -> f64 {
    let stride = ((SPEED_BASE_S / step_s).ceil().clamp(1.0, t.len() as f64) as usize).max(1);
    let pairs = t.iter().zip(q).zip(t.iter().zip(q).skip(stride)).step_by(stride);
    let mut speeds: Vec<f64> =
        pairs.map(|((t0, q0), (t1, q1))| (q1 - q0).abs() / (t1 - t0)).filter(|speed| *speed > 0.0).collect();
    median(&mut speeds)
}

/// Checks a log's time stamps against the period that the study states.
///
/// Only a factor of about a thousand (300 to 3000) is an error: it is milliseconds. A smaller difference is the
/// study's business and shows in [`Health::period_s`](super::Health::period_s).
///
/// # Errors
/// [`LogError::Period`].
pub fn check_period(log: &Log, sensor: &SensorSpec) -> Result<(), LogError> {
    sensor.period_s.map_or(Ok(()), |period_s| check_stamps(&log.file, &log.t_s, period_s))
}

/// [`check_period`] of any log.
pub(super) fn check_stamps(file: &Path, t_s: &[f64], period_s: f64) -> Result<(), LogError> {
    let median_s = median_step(t_s);
    let ratio = median_s / period_s;
    if (300.0..3000.0).contains(&ratio) || (300.0..3000.0).contains(&ratio.recip()) {
        return Err(LogError::Period { file: file.to_path_buf(), median_s, period_s });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_at_a_high_rate_is_not_speed() {
        let t: Vec<f64> = (0..2000).map(|i| f64::from(i) * 1e-5).collect();
        let q: Vec<f64> = (0..2000).map(|i| if i % 2 == 0 { 0.0 } else { 0.002 }).collect();
        assert!(median_moving_speed(&t, &q, 1e-5) < 1.0);
    }

    /// Seconds that were said to be nanoseconds made a log of 2e-9 s, without a word.
    #[test]
    fn stamps_that_are_too_near_to_one_another_are_in_a_larger_unit() {
        let of = |unit_s: f64, size: f64| {
            let t: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k) * unit_s).collect();
            let q: Vec<f64> = (0..200).map(|k| size * f64::from(k % 40)).collect();
            faults(&t, &q, &[]).first().map(|(column, _, fault)| (*column, *fault))
        };
        for unit_s in [1e-3, 1e-6, 1e-9] {
            let (column, fault) = of(unit_s, 0.02).unwrap();
            let said = fault.to_string();
            assert!(column == Column::Time && said.contains("`[columns] t.unit`"), "{unit_s}: {said}");
        }
        assert_eq!(of(1.0, 0.02), None);
        // 100 kHz is a rate at which joints at rest are looked at.
        assert_eq!(of(1e-3, 1e-6), None);
        assert!(hasty_step(&[0.0], &[0.0]).is_none() && hasty_step(&[0.0, 0.0], &[0.0; 2]).is_none());
        assert!(hasty_step(&[], &[]).is_none() && hasty_step(&[f64::NAN; 3], &[0.0; 3]).is_none());
    }

    #[test]
    fn stamps_that_are_no_numbers_have_no_speed() {
        assert_eq!(median_moving_speed(&[f64::NAN; 3], &[0.0, 1.0, 2.0], f64::NAN), 0.0);
    }

    #[test]
    fn period_a_thousand_off_is_milliseconds() {
        let log = Log {
            file: "a.csv".into(),
            t_s: vec![0.0, 0.3, 0.6],
            q_rad: vec![0.0; 3],
            dq_rad_s: None,
            tau_nm: None,
            q_ref_rad: None,
            setpoints: None,
            drive: None,
            ignored_columns: vec![],
            notes: vec![],
        };
        let sensor = |period| SensorSpec { resolution_rad: None, period_s: Some(period) };
        let message = check_period(&log, &sensor(3e-4)).unwrap_err().to_string();
        assert!(message.contains("`t` looks like milliseconds"), "{message}");
        assert!(check_period(&log, &sensor(0.1)).is_ok());
        assert!(check_period(&log, &SensorSpec::default()).is_ok());
    }
}
