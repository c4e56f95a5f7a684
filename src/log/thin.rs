//! Fewer samples of a long log, for a search that looks at every sample hundreds of times.

use super::health::Health;
use super::release::Start;
use super::types::Log;

/// Share of the samples that a joint at rest keeps: it says the same again and again.
const REST_SHARE: usize = 10;

/// At most about `most` samples of a log, evenly spaced while the joint moves and wider apart where it rests; `None`
/// where the log is no longer than that.
///
/// The first and the last sample stay, and both sides of every instant at which the joint is let go or caught. The
/// health is the whole log's, with the places of the release in the shorter one.
pub fn thinned(log: &Log, health: &Health, most: usize) -> Option<(Log, Health)> {
    let n = log.len();
    if n <= most.max(2) {
        return None;
    }
    let rest_from = health.rest_from_s.map_or(n, |from_s| log.t_s.partition_point(|t| *t < from_s));
    let moving_stride = rest_from.div_ceil(most - most / REST_SHARE).max(1);
    let rest_stride = (n - rest_from).div_ceil((most / REST_SHARE).max(1)).max(moving_stride);
    let changes = |k: usize| log.drive.as_ref().is_some_and(|d| k > 0 && k < n && d[k] != d[k - 1]);
    let held = health.start.held();
    let stays = |k: &usize| {
        let k = *k;
        let on_grid =
            if k < rest_from { k.is_multiple_of(moving_stride) } else { (k - rest_from).is_multiple_of(rest_stride) };
        let at_release = held.is_some_and(|h| k == h.last_held || k == h.first_free);
        on_grid || k + 1 == n || at_release || changes(k) || changes(k + 1)
    };
    let kept: Vec<usize> = (0..n).filter(stays).collect();
    let pick = |column: &[f64]| kept.iter().map(|&k| column[k]).collect::<Vec<f64>>();
    let pick_some = |column: &Option<Vec<f64>>| column.as_deref().map(pick);
    let shorter = Log {
        file: log.file.clone(),
        t_s: pick(&log.t_s),
        q_rad: pick(&log.q_rad),
        dq_rad_s: pick_some(&log.dq_rad_s),
        tau_nm: pick_some(&log.tau_nm),
        q_ref_rad: pick_some(&log.q_ref_rad),
        setpoints: log.setpoints.clone(),
        notes: log.notes.clone(),
        drive: log.drive.as_ref().map(|drive| kept.iter().map(|&k| drive[k]).collect()),
        ignored_columns: log.ignored_columns.clone(),
    };
    let mut health = health.clone();
    if let Start::Held(phase) = &mut health.start {
        phase.last_held = kept.partition_point(|k| *k < phase.last_held);
        phase.first_free = kept.partition_point(|k| *k < phase.first_free);
    }
    Some((shorter, health))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{DriveMode, SensorSpec, health};

    /// Held for a second, a decaying swing, then rest; 1 kHz.
    fn long() -> Log {
        let t_s: Vec<f64> = (0..60_000).map(|i| f64::from(i) * 1e-3).collect();
        let swing = |t: f64| if t < 1.0 { 0.5 } else { 0.5 * (-0.5 * (t - 1.0)).exp() * (7.0 * (t - 1.0)).cos() };
        Log {
            file: "long.csv".into(),
            q_rad: t_s.iter().map(|t| (swing(*t) / 0.001).round() * 0.001).collect(),
            drive: Some(t_s.iter().map(|t| *t < 1.0).collect()),
            dq_rad_s: None,
            tau_nm: None,
            q_ref_rad: None,
            setpoints: None,
            ignored_columns: vec![],
            notes: vec![],
            t_s,
        }
    }

    #[test]
    fn a_long_log_gets_short_and_keeps_its_release() {
        let log = long();
        let whole = health(&log, &SensorSpec::default(), DriveMode::Off);
        let (short, found) = thinned(&log, &whole, 5_000).unwrap();
        assert!((2_500..=5_010).contains(&short.len()), "{}", short.len());
        let (was, is) = (whole.start.held().unwrap(), found.start.held().unwrap());
        assert_eq!(
            (short.t_s[is.last_held], short.t_s[is.first_free]),
            (log.t_s[was.last_held], log.t_s[was.first_free])
        );
        assert_eq!((is.window_s, found.samples), (was.window_s, 60_000));
        assert_eq!((short.t_s[0], short.t_s.last()), (0.0, log.t_s.last()));
        let from = whole.rest_from_s.unwrap();
        let resting = short.t_s.iter().filter(|t| **t >= from).count();
        assert!((300..=502).contains(&resting), "{resting}");
    }

    #[test]
    fn a_short_log_is_left_alone() {
        let log = long();
        let whole = health(&log, &SensorSpec::default(), DriveMode::Off);
        assert_eq!(thinned(&log, &whole, 60_000), None);
    }
}
