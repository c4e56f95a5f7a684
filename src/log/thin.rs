//! Fewer samples of a long log, for a search that looks at every sample hundreds of times.

use super::health::Health;
use super::release::Start;
use super::types::{Log, Stamped};
use std::ops::Range;

/// Share of the samples that a joint at rest keeps: it says the same again and again.
const REST_SHARE: usize = 10;
/// Samples of a stretch that stays of a long driven log: it is long beside what a joint remembers.
const STRETCH: usize = 4000;
/// Setpoints from so long before a stretch stay, for what arrives late \[s\].
const LEAD_S: f64 = 1.0;

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
    let shorter = picked(log, &kept);
    let mut health = health.clone();
    if let Start::Held(phase) = &mut health.start {
        phase.last_held = kept.partition_point(|k| *k < phase.last_held);
        phase.first_free = kept.partition_point(|k| *k < phase.first_free);
    }
    Some((shorter, health))
}

/// At most about `most` samples of a driven log, in stretches: its beginning, and from all along it those in which the
/// joint goes farthest; and where in the shorter log each but the first begins. `None` where the log is no longer than that.
///
/// What drives a joint between two samples counts, so that none is left out in a stretch. Setpoints keep stamps of their
/// own, from a second before each stretch on.
pub fn stretches(log: &Log, most: usize) -> Option<(Log, Vec<usize>)> {
    let n = log.len();
    if n <= most {
        return None;
    }
    let count = most.div_ceil(STRETCH);
    let (block, width) = (n / count, most / count);
    let of_block = |k: usize| {
        if k == 0 {
            return 0..width;
        }
        let from = k * block;
        let at = liveliest(&log.q_rad[from..from + block], width);
        from + at.start..from + at.end
    };
    let chosen: Vec<Range<usize>> = (0..count).map(of_block).collect();
    let begins = chosen.windows(2).enumerate().filter(|(_, pair)| pair[1].start > pair[0].end);
    let begins = begins.map(|(k, _)| (k + 1) * width).collect();
    let kept: Vec<usize> = chosen.iter().cloned().flatten().collect();
    let asked = log.setpoints.as_ref().map(|own| (&own.t_s, &own.values));
    let asked = asked.or_else(|| Some((&log.t_s, log.q_ref_rad.as_ref()?)));
    let setpoints = asked.map(|(t_s, values)| {
        let mut own = Stamped::default();
        let mut done = 0;
        for at in &chosen {
            // The one that is in force when the second begins, however old it is.
            let first = t_s.partition_point(|t| *t <= log.t_s[at.start] - LEAD_S).saturating_sub(1).max(done);
            done = t_s.partition_point(|t| *t <= log.t_s[at.end - 1]).max(first);
            own.t_s.extend(&t_s[first..done]);
            own.values.extend(&values[first..done]);
        }
        own
    });
    Some((Log { setpoints, ..picked(log, &kept) }, begins))
}

/// The so many neighbouring readings along which a joint goes farthest; all where they are fewer.
pub fn liveliest(q_rad: &[f64], width: usize) -> Range<usize> {
    let n = q_rad.len();
    if n <= width || width == 0 {
        return 0..n;
    }
    let mut way_rad = vec![0.0; n];
    for k in 1..n {
        way_rad[k] = way_rad[k - 1] + (q_rad[k] - q_rad[k - 1]).abs();
    }
    let way = |from: &usize| way_rad[from + width - 1] - way_rad[*from];
    let from = (0..=n - width).step_by((width / 8).max(1)).max_by(|a, b| way(a).total_cmp(&way(b))).unwrap_or(0);
    from..from + width
}

/// A log of these samples alone.
fn picked(log: &Log, kept: &[usize]) -> Log {
    let pick = |column: &[f64]| kept.iter().map(|&k| column[k]).collect::<Vec<f64>>();
    let pick_some = |column: &Option<Vec<f64>>| column.as_deref().map(pick);
    Log {
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
    }
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

    #[test]
    fn a_long_driven_log_keeps_whole_stretches_from_all_along_it_and_what_was_asked_before_them() {
        let log = Log { q_ref_rad: Some(long().t_s), drive: None, ..long() };
        let (short, begins) = stretches(&log, 24_000).unwrap();
        assert_eq!((short.len(), begins.len()), (24_000, 5));
        let period = |k: usize| ((short.t_s[k] - short.t_s[k - 1]) * 1e3).round();
        assert!((1..24_000).all(|k| (period(k) == 1.0) != begins.contains(&k)));
        assert!(short.t_s[0] == 0.0 && short.t_s[begins[4]] >= 50.0, "{} {}", short.t_s[0], short.t_s[begins[4]]);
        let asked = short.setpoints.unwrap();
        let before = |k: usize| asked.t_s.iter().filter(|t| **t < short.t_s[k] && **t >= short.t_s[k] - 1.0).count();
        assert!(
            begins.iter().all(|&k| before(k) >= 999),
            "{:?}",
            begins.iter().map(|&k| before(k)).collect::<Vec<_>>()
        );
        assert_eq!(asked.t_s, asked.values);
        let rare = Stamped { t_s: vec![0.0, 9.0], values: vec![0.1, 0.2] };
        let short = stretches(&Log { setpoints: Some(rare.clone()), ..log.clone() }, 24_000).unwrap().0;
        assert_eq!(short.setpoints, Some(rare));
        assert_eq!(stretches(&log, 60_000), None);
    }
}
