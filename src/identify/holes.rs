//! Holes in a recording: nobody knows what was asked of the joint in one, so that what follows begins anew.

use super::Experiment;
use crate::log::Log;
use crate::number::extent;
use std::ops::Range;

/// A step is a hole beyond this many periods: three, and half of one for jitter.
const HOLE_PERIODS: f64 = 3.5;
/// Steps either way that say how densely the log is sampled about a step.
const ABOUT: usize = 6;
/// Fewest samples of a log, and of a part. A baseline fit of one log has six unknowns: inertia, two frictions, rest angle,
/// and the start's two. Two samples more show how well it does.
pub(super) const FEWEST_SAMPLES: usize = 8;

/// Instants at which a log goes on after a hole \[s\], in the log's time.
///
/// A hole is a step beyond three periods. Stamps that come in bursts, and a log that changes its rate, have none: the
/// period is the upper quartile of all steps, or the median of those about the step where that is longer.
pub(crate) fn ends_of_holes(t_s: &[f64]) -> Vec<f64> {
    let steps: Vec<f64> = t_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.is_empty() {
        return Vec::new();
    }
    let mut sorted = steps.clone();
    let usual_s = *sorted.select_nth_unstable_by(steps.len() * 3 / 4, f64::total_cmp).1;
    let is_hole = |k: usize| {
        let near = k.saturating_sub(ABOUT)..(k + ABOUT + 1).min(steps.len());
        let mut near: Vec<f64> = near.filter(|other| *other != k).map(|other| steps[other]).collect();
        near.sort_unstable_by(f64::total_cmp);
        let local_s = near.get(near.len() / 2).copied().unwrap_or(usual_s);
        steps[k] > HOLE_PERIODS * usual_s.max(local_s)
    };
    (0..steps.len()).filter(|&k| steps[k] > HOLE_PERIODS * usual_s && is_hole(k)).map(|k| t_s[k + 1]).collect()
}

/// Where the parts of a log begin that have a start of their own \[s\], in the log's time.
pub(super) struct Begins {
    /// After holes.
    pub after_holes_s: Vec<f64>,
    /// After what was left out of a long log.
    pub stretches_s: Vec<f64>,
}

/// An experiment cut where its parts begin, each with a start of its own, and a remark for each part that is left out
/// because it is too short or nothing moves in it.
///
/// `noise_rad` is what a reading scatters by.
pub(super) fn cut(whole: Experiment, log: &Log, begins: &Begins, noise_rad: f64) -> (Vec<Experiment>, Vec<String>) {
    let t0_s = log.t_s.first().copied().unwrap_or(0.0);
    let at = |from_s: &f64| whole.t_s.partition_point(|t| *t < from_s - t0_s);
    let inside = |k: &usize| *k > 0 && *k < whole.t_s.len();
    let cuts_at = |all_s: &[f64]| all_s.iter().map(at).filter(inside).collect::<Vec<usize>>();
    let stretches = cuts_at(&begins.stretches_s);
    let mut cuts = cuts_at(&begins.after_holes_s);
    cuts.retain(|k| !stretches.contains(k));
    cuts.dedup();
    let holes = cuts.len();
    cuts.extend(&stretches);
    cuts.sort_unstable();
    if cuts.is_empty() {
        return (vec![whole], Vec::new());
    }
    cuts.push(whole.t_s.len());
    let still_rad = 3.0 * whole.resolution_rad.max(noise_rad);
    let (mut parts, mut remarks) = (Vec::new(), Vec::new());
    if holes > 0 {
        remarks.push(format!("{holes} hole{}: each part has a start of its own", if holes == 1 { "" } else { "s" }));
    }
    if !stretches.is_empty() {
        remarks.push(format!("{} stretches from all along it, each with a start of its own", stretches.len() + 1));
    }
    let mut from = 0;
    for (k, to) in cuts.into_iter().enumerate() {
        let range = from..to;
        from = to;
        let left_out = |why: String| {
            let (first_s, last_s) = (t0_s + whole.t_s[range.start], t0_s + whole.t_s[range.end - 1]);
            format!("part {} ({first_s:.3} to {last_s:.3} s) is left out: {why}", k + 1)
        };
        if range.len() < FEWEST_SAMPLES {
            remarks.push(left_out(format!("{} samples", range.len())));
        } else if span(&whole.measured_rad, &range) <= still_rad {
            remarks.push(left_out("nothing moves".to_owned()));
        } else {
            parts.push(whole.part_of_log(range, k + 1));
        }
    }
    (parts, remarks)
}

fn span(measured_rad: &[f64], range: &Range<usize>) -> f64 {
    let [low, high] = extent(measured_rad[range.clone()].iter().copied());
    high - low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::Signal;
    use crate::log::{DriveMode, MotorSpec, Role, SensorSpec, StudyLog, health};

    fn entry() -> StudyLog {
        StudyLog {
            file: "a.csv".into(),
            path: "a.csv".into(),
            role: Role::Fit,
            drive: DriveMode::Position,
            motor: Some(MotorSpec::pd(1.0, 0.1)),
            extra: None,
            session: None,
            tau_is: None,
            window: None,
        }
    }

    /// A driven log at 100 Hz with the samples of `lost` missing.
    fn log(lost: impl Fn(usize) -> bool, q: fn(f64) -> f64) -> Log {
        let t_s: Vec<f64> = (0..400).filter(|k| !lost(*k)).map(|k| 5.0 + 0.01 * k as f64).collect();
        Log {
            file: "a.csv".into(),
            q_rad: t_s.iter().map(|t| q(*t)).collect(),
            q_ref_rad: Some(t_s.iter().map(|t| 2.0 * q(*t)).collect()),
            setpoints: None,
            dq_rad_s: None,
            tau_nm: None,
            drive: None,
            ignored_columns: vec![],
            notes: vec![],
            t_s,
        }
    }

    fn parts(log: &Log) -> (Vec<Experiment>, Vec<String>) {
        let found = health(log, &SensorSpec::default(), DriveMode::Position);
        let whole = Experiment::new(log, &entry(), &found, 0.0, 9.81).unwrap();
        let begins = Begins { after_holes_s: ends_of_holes(&log.t_s), stretches_s: Vec::new() };
        cut(whole, log, &begins, found.noise_rad)
    }

    #[test]
    fn a_hole_beyond_three_periods_splits_a_log_and_each_part_has_its_own_setpoints() {
        let log =
            log(|k| (100..103).contains(&k) || (200..202).contains(&k) || (300..303).contains(&k), |t| (3.0 * t).sin());
        let (parts, remarks) = parts(&log);
        assert_eq!(
            parts.iter().map(|e| (e.part, e.first_sample, e.t_s.len())).collect::<Vec<_>>(),
            [(1, 0, 100), (2, 100, 195), (3, 295, 97)]
        );
        assert_eq!(remarks, ["2 holes: each part has a start of its own"]);
        for e in &parts {
            let range = e.first_sample..e.first_sample + e.t_s.len();
            let Signal::Position { setpoint_rad, .. } = &e.signal else { panic!("driven") };
            assert_eq!(setpoint_rad[..], log.q_ref_rad.as_ref().unwrap()[range.clone()]);
            assert_eq!(e.measured_rad[..], log.q_rad[range.clone()]);
            assert!((e.t_s[0] - (log.t_s[range.start] - 5.0)).abs() < 1e-12);
            assert!((e.start.angle_rad - e.measured_rad[0]).abs() < 0.02 && e.release_window_s.is_none());
            assert_eq!((e.weights_s.len(), &*e.label()), (e.t_s.len(), &*format!("a.csv (part {})", e.part)));
        }
    }

    #[test]
    fn a_part_that_is_too_short_or_still_is_left_out_with_a_remark() {
        let log = log(
            |k| (100..110).contains(&k) || (113..120).contains(&k),
            |t| if t > 6.15 { 0.4 } else { (3.0 * t).sin() },
        );
        let (parts, remarks) = parts(&log);
        assert_eq!(parts.iter().map(|e| e.part).collect::<Vec<_>>(), [1]);
        assert_eq!(remarks[1], "part 2 (6.100 to 6.120 s) is left out: 3 samples");
        assert_eq!(remarks[2], "part 3 (6.200 to 8.990 s) is left out: nothing moves");
    }

    #[test]
    fn stretches_of_a_long_log_are_parts_and_no_holes() {
        let log = log(|k| (100..200).contains(&k), |t| (3.0 * t).sin());
        let found = health(&log, &SensorSpec::default(), DriveMode::Position);
        let whole = Experiment::new(&log, &entry(), &found, 0.0, 9.81).unwrap();
        let begins = Begins { after_holes_s: ends_of_holes(&log.t_s), stretches_s: vec![log.t_s[100]] };
        let (parts, remarks) = cut(whole, &log, &begins, found.noise_rad);
        assert_eq!(parts.iter().map(|e| e.first_sample).collect::<Vec<_>>(), [0, 100]);
        assert_eq!(remarks, ["2 stretches from all along it, each with a start of its own"]);
    }

    #[test]
    fn jitter_bursts_and_another_rate_are_no_holes() {
        let even: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.01).collect();
        assert_eq!(ends_of_holes(&even), [0.0; 0]);
        let bursts: Vec<f64> = (0..100).map(|k| f64::from(k / 2) * 0.02 + f64::from(k % 2) * 1e-4).collect();
        assert_eq!(ends_of_holes(&bursts), [0.0; 0]);
        let slower = even.iter().copied().chain((0..20).map(|k| 1.09 + 0.1 * f64::from(k))).collect::<Vec<_>>();
        assert_eq!(ends_of_holes(&slower), [0.0; 0]);
        assert_eq!(ends_of_holes(&[]), [0.0; 0]);
    }
}
