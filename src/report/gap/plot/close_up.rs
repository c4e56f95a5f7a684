//! The moment at which an answer matters most, large enough to be seen: asked, read and simulated over time.

use std::ops::Range;

use crate::gap::inverse::TorqueTraces;
use crate::gap::{Diagnosis, LogTraces, Verdict};
use crate::number::extent;
use crate::report::ReportError;
use crate::report::gap::words;
use crate::report::plot::axis::drawable;
use crate::report::plot::canvas::{AFTER, BEFORE, CALIBRATED};
use crate::report::plot::overlay::{Curve, Overlay, overlay};

/// A turn counts where the motion goes back by this share of its range.
const TURNS_BY: f64 = 0.05;
/// Room before and behind the turns that are shown, as a share of the time between them.
const ROOM: f64 = 0.25;
/// Fewest samples of a close-up, and the most for each of its sides.
const FEWEST: usize = 24;
const MOST_ASIDE: usize = 400;

/// A log, which of its samples to show, and the instant in the middle \[s\].
pub(super) struct Moment<'a> {
    pub log: &'a LogTraces,
    samples: Range<usize>,
    pub at_s: f64,
}

/// The turn of the motion around which the answer parts most from what it replaces; `None` where there is no gap.
pub(super) fn moment(diagnosis: &Diagnosis) -> Option<Moment<'_>> {
    if diagnosis.answer.verdict == Verdict::None {
        return None;
    }
    let has_answer = words::answer(diagnosis).is_some();
    let of = |log: &LogTraces| {
        let models = [&log.before_rad, &log.calibrated_rad, &log.after_rad].map(|model| &model[..]);
        farthest(diagnosis, has_answer, &log.measured_rad, models)
    };
    let (log, worst) = most_of(&diagnosis.traces, of)?;
    let moves = log.setpoint_rad.as_deref().filter(|setpoint| turns(setpoint).len() > 1).unwrap_or(&log.measured_rad);
    let samples = around(&turns(moves), worst, log.t_s.len());
    let at_s = *log.t_s.get(worst)?;
    (samples.len() > 2).then_some(Moment { log, samples, at_s })
}

/// Of logs the one in which something is largest, and at which sample; `None` where it is nowhere above nothing.
fn most_of<L>(logs: &[L], of: impl Fn(&L) -> Option<(usize, f64)>) -> Option<(&L, usize)> {
    let mut best: Option<(f64, &L, usize)> = None;
    for log in logs {
        let Some((at, most)) = of(log) else { continue };
        if most > best.map_or(0.0, |(before, ..)| before) {
            best = Some((most, log, at));
        }
    }
    best.map(|(_, log, at)| (log, at))
}

/// Where the answer parts most from what it replaces, and by how much; models as given, recalibrated, with the causes.
fn farthest(
    diagnosis: &Diagnosis,
    has_answer: bool,
    measured: &[f64],
    [before, calibrated, after]: [&[f64]; 3],
) -> Option<(usize, f64)> {
    let (one, other) = match (has_answer, diagnosis.answer.verdict) {
        (true, _) => (calibrated, after),
        (false, Verdict::Calibration) => (before, calibrated),
        (false, _) => (measured, calibrated),
    };
    let apart = one.iter().zip(other).map(|(a, b)| (a - b).abs()).enumerate();
    apart.filter(|(_, apart)| drawable(*apart)).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The stretch between turns of the torque around which the answer parts most from what it replaces, and the instant in its
/// middle \[s\]; `None` where torques are not predicted, or where there is no gap.
pub(super) fn torques(diagnosis: &Diagnosis, logs: &[TorqueTraces]) -> Option<(TorqueTraces, f64)> {
    if diagnosis.answer.verdict == Verdict::None {
        return None;
    }
    let has_answer = !diagnosis.causes.is_empty() || diagnosis.law.is_some();
    let of = |log: &TorqueTraces| {
        let models = [&log.given_nm, &log.calibrated_nm, &log.after_nm].map(|model| &model[..]);
        farthest(diagnosis, has_answer, &log.measured_nm, models)
    };
    let (log, worst) = most_of(logs, of)?;
    let samples = around(&turns(&log.measured_nm), worst, log.t_s.len());
    let cut = |values: &[f64]| values.get(samples.clone()).unwrap_or(&[]).to_vec();
    let stretch = TorqueTraces {
        file: log.file.clone(),
        role: log.role,
        t_s: cut(&log.t_s),
        measured_nm: cut(&log.measured_nm),
        given_nm: cut(&log.given_nm),
        calibrated_nm: cut(&log.calibrated_nm),
        after_nm: cut(&log.after_nm),
    };
    (samples.len() > 2).then_some((stretch, *log.t_s.get(worst)?))
}

/// Samples at which a motion turns round.
fn turns(values: &[f64]) -> Vec<usize> {
    let [low, high] = extent(values.iter().copied().filter(|value| drawable(*value)));
    let back = TURNS_BY * (high - low);
    if !(back > 0.0) {
        return Vec::new();
    }
    let mut turns = Vec::new();
    // The last extreme, and whether the motion rises towards it.
    let (mut extreme, mut rises): (Option<(usize, f64)>, Option<bool>) = (None, None);
    for (i, value) in values.iter().copied().enumerate().filter(|(_, value)| drawable(*value)) {
        let Some((at, last)) = extreme else {
            extreme = Some((i, value));
            continue;
        };
        match rises {
            None if (value - last).abs() > back => (extreme, rises) = (Some((i, value)), Some(value > last)),
            Some(true) if value >= last => extreme = Some((i, value)),
            Some(false) if value <= last => extreme = Some((i, value)),
            Some(up) if (value - last).abs() > back => {
                turns.push(at);
                (extreme, rises) = (Some((i, value)), Some(!up));
            }
            _ => {}
        }
    }
    turns
}

/// From the turn before the nearest one to the turn behind it, with a little room.
fn around(turns: &[usize], worst: usize, length: usize) -> Range<usize> {
    let nearest = turns.iter().enumerate().min_by_key(|(_, turn)| turn.abs_diff(worst)).map(|(k, _)| k);
    let (from, to) = match nearest {
        Some(k) => (
            turns[k.saturating_sub(1)].min(worst),
            turns.get(k + 1).or(turns.last()).copied().unwrap_or(worst).max(worst),
        ),
        None => (worst, worst),
    };
    let room = ((ROOM * (to - from) as f64) as usize).max(FEWEST / 2);
    let from = from.saturating_sub(room).max(worst.saturating_sub(MOST_ASIDE));
    from..(to + room + 1).min(worst + MOST_ASIDE).min(length)
}

/// Draws the moment; `half_step_rad` is 0 where the sensor's step is unknown.
pub(super) fn close_up(diagnosis: &Diagnosis, moment: &Moment<'_>, half_step_rad: f64) -> Result<String, ReportError> {
    let Moment { log, samples, .. } = moment;
    let cut = |values: &[f64]| values.get(samples.clone()).unwrap_or(&[]).to_vec();
    let (t_s, measured_rad) = (cut(&log.t_s), cut(&log.measured_rad));
    let setpoint_rad = cut(log.setpoint_rad.as_deref().unwrap_or(&[]));
    let [before, calibrated, after] = [&log.before_rad, &log.calibrated_rad, &log.after_rad].map(|model| cut(model));
    let curve = |name: &str, colour, angle_rad| Curve { name: name.to_owned(), colour, angle_rad, first: 0 };
    let mut models = vec![curve("as given", BEFORE, &before), curve("recalibrated", CALIBRATED, &calibrated)];
    if let Some(answer) = words::answer(diagnosis) {
        models.push(curve(&answer, AFTER, &after));
    }
    overlay(&Overlay {
        title: &format!("{}, close-up of {} at {:.2} s", diagnosis.joint, log.file, moment.at_s),
        t_s: &t_s,
        measured_rad: &measured_rad,
        setpoint_rad: &setpoint_rad,
        models,
        half_step_rad,
        shades: Vec::new(),
        shaded: "",
        torque: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::gap::sample;

    #[test]
    fn a_motion_turns_where_it_goes_back_and_not_where_it_trembles() {
        let wave: Vec<f64> =
            (0..400).map(|i| (0.05 * f64::from(i)).sin() + 0.01 * (3.0 * f64::from(i)).sin()).collect();
        let turns = turns(&wave);
        assert_eq!(turns.len(), 6, "{turns:?}");
        assert!(turns.windows(2).all(|pair| pair[1].abs_diff(pair[0] + 63) < 6), "{turns:?}");
        assert!(super::turns(&[1.0; 9]).is_empty() && super::turns(&[]).is_empty());
    }

    #[test]
    fn a_close_up_holds_the_turn_and_its_neighbours() {
        assert_eq!(around(&[100, 160, 220], 150, 1000), 70..251);
        assert_eq!(around(&[], 5, 1000), 0..18);
        assert_eq!(around(&[10, 990], 500, 1000).len(), 800);
    }

    #[test]
    fn a_torque_is_shown_where_the_causes_matter_most() {
        let diagnosis = sample::two_effects().diagnosis;
        let t_s: Vec<f64> = (0..600).map(|i| 0.01 * f64::from(i)).collect();
        let wave = |t: &f64| (3.0 * t).sin();
        let with = |more: &dyn Fn(f64) -> f64| t_s.iter().map(|t| wave(t) + more(*t)).collect::<Vec<f64>>();
        let log = TorqueTraces {
            measured_nm: with(&|_| 0.0),
            given_nm: with(&|_| 0.5),
            calibrated_nm: with(&|t| if (t - 4.0).abs() < 0.05 { 0.3 } else { 0.01 }),
            after_nm: with(&|_| 0.0),
            t_s: t_s.clone(),
            ..TorqueTraces::default()
        };
        let (stretch, at_s) = torques(&diagnosis, &[TorqueTraces::default(), log]).expect("a gap");
        assert!((at_s - 4.0).abs() < 0.06, "{at_s}");
        let [from, to] = [stretch.t_s[0], stretch.t_s[stretch.t_s.len() - 1]];
        assert!(from < at_s && at_s < to && to - from < 4.0, "{from} to {to}");
        assert_eq!(stretch.after_nm.len(), stretch.t_s.len());
        assert!(torques(&diagnosis, &[]).is_none());
    }

    #[test]
    fn there_is_a_close_up_wherever_there_is_a_gap() {
        for (name, report) in sample::all() {
            let moment = moment(&report.diagnosis);
            let is_gap = report.diagnosis.answer.verdict != Verdict::None && !report.diagnosis.traces.is_empty();
            assert_eq!(moment.is_some(), is_gap, "{name}");
        }
    }
}
