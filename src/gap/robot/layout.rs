//! All that is compared, in one vector: joint after joint, log after log, then the trunk.

use super::case::{CaseLog, RobotCase};
use super::forward::Predicted;
use super::still::repeats;
use std::ops::Range;

/// What a row of the vector is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    /// Reading of a joint of the robot \[rad\].
    Joint(usize),
    /// `base.x` to `base.yaw` \[m, rad\].
    Base(usize),
    /// The measured displacement, one number \[m\].
    Forward,
}

/// A channel of a log.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    pub log: usize,
    pub channel: Channel,
    pub range: Range<usize>,
}

/// The order of everything.
pub(super) struct Layout {
    pub rows: Vec<Row>,
    pub len: usize,
    /// Samples that are compared at all.
    pub compared: Vec<bool>,
    /// Samples that no fit sees.
    pub held: Vec<bool>,
}

/// The first moments tell how the log, or its motion, began and not how the robot is \[s\].
const SETTLING_S: f64 = 0.4;
/// A gait whose cycle is a longer share of the motion has no period.
const LONGEST_CYCLE: f64 = 0.34;
/// The time of motion is cut into so many parts where it has no period ...
const PARTS: usize = 8;
/// ... and of three in a row the middle one is held out; of a walk, whose first is not compared, the last.
const OF_THREE: usize = 3;
const HELD: usize = 1;
const HELD_ON_THE_FLOOR: usize = 2;
/// A displacement is measured to so much \[m\].
pub(super) const FORWARD_SD_M: f64 = 5e-3;

impl Layout {
    pub fn of(case: &RobotCase) -> Self {
        let mut layout = Self { rows: Vec::new(), len: 0, compared: Vec::new(), held: Vec::new() };
        let has_validate = case.logs.iter().any(|log| log.is_validate);
        for (index, log) in case.logs.iter().enumerate() {
            let (compared_from_s, clamped) = (compared_from_s(case, log), case.is_clamped());
            let held = if clamped { HELD } else { HELD_ON_THE_FLOOR };
            let blocks = if has_validate { Vec::new() } else { held_out_blocks(log, held) };
            let is_held = |t_s: f64| log.is_validate || blocks.iter().any(|block| block.contains(&t_s));
            let joints = (0..case.names.len()).filter(|j| log.columns[*j].is_some() && log.moves(*j));
            let mut channels: Vec<Channel> = joints.map(Channel::Joint).collect();
            if !clamped {
                channels.extend((0..6).filter(|k| base_column(log, *k).is_some()).map(Channel::Base));
            }
            for channel in channels {
                let from = layout.len;
                let readings = match channel {
                    Channel::Joint(joint) => log.measured_rad(joint),
                    _ => None,
                };
                let repeats = readings.map(repeats);
                for (k, t_s) in log.log.t_s.iter().enumerate() {
                    let is_new = repeats.as_ref().is_none_or(|repeats| !repeats[k]);
                    layout.compared.push(*t_s >= compared_from_s && is_new);
                    layout.held.push(is_held(*t_s));
                }
                layout.len += log.log.len();
                layout.rows.push(Row { log: index, channel, range: from..layout.len });
            }
            if log.forward.is_some() {
                layout.rows.push(Row { log: index, channel: Channel::Forward, range: layout.len..layout.len + 1 });
                layout.compared.push(true);
                layout.held.push(log.is_validate);
                layout.len += 1;
            }
        }
        layout
    }

    /// Rows of joints with their joint.
    pub fn joints(&self) -> impl Iterator<Item = (usize, &Row)> {
        self.rows.iter().filter_map(|row| match row.channel {
            Channel::Joint(joint) => Some((joint, row)),
            _ => None,
        })
    }

    /// Joints that are compared, rising, each once.
    pub fn moving(&self) -> Vec<usize> {
        let mut joints: Vec<usize> = self.joints().map(|(joint, _)| joint).collect();
        joints.sort_unstable();
        joints.dedup();
        joints
    }

    /// What the logs read.
    pub fn measured(&self, case: &RobotCase) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.len);
        for row in &self.rows {
            let log = &case.logs[row.log];
            match row.channel {
                Channel::Joint(joint) => all.extend_from_slice(log.measured_rad(joint).unwrap_or(&[])),
                Channel::Base(k) => all.extend_from_slice(base_column(log, k).unwrap_or(&[])),
                Channel::Forward => all.push(log.forward.map_or(0.0, |forward| forward.distance_m)),
            }
        }
        all
    }

    /// What a simulation reads; NaN beyond its end.
    pub fn predicted(&self, case: &RobotCase, logs: &[Predicted]) -> Vec<f64> {
        let mut all = vec![f64::NAN; self.len];
        for row in &self.rows {
            let (log, predicted) = (&case.logs[row.log], &logs[row.log]);
            let out = &mut all[row.range.clone()];
            match row.channel {
                Channel::Joint(joint) => {
                    for (out, q) in out.iter_mut().zip(&predicted.reading_rad[joint]) {
                        *out = *q;
                    }
                }
                Channel::Base(k) => {
                    for (out, base) in out.iter_mut().zip(&predicted.base) {
                        let turned = base.roll_pitch_yaw_rad();
                        *out = if k < 3 { base.position_m[k] } else { turned[k - 3] };
                    }
                }
                Channel::Forward => out[0] = displacement_m(log, predicted).unwrap_or(f64::NAN),
            }
        }
        all
    }
}

/// From when on a log is compared \[s\]. On a floor feet stand where the landing happened to put them, which no two honest
/// simulations agree on, until all have stepped once: the first cycle of the gait is walked and not compared.
pub(super) fn compared_from_s(case: &RobotCase, log: &CaseLog) -> f64 {
    if case.is_clamped() {
        return log.log.t_s[0] + SETTLING_S;
    }
    let begin_s = log.motion_begins_s();
    let cycle_s = period_s(log, begin_s).filter(|period| *period < LONGEST_CYCLE * (log.end_s() - begin_s));
    begin_s + cycle_s.unwrap_or(SETTLING_S)
}

/// How far a simulated trunk goes forward over the measured times \[m\].
pub(super) fn displacement_m(log: &CaseLog, predicted: &Predicted) -> Option<f64> {
    let forward = log.forward?;
    let at = |t_s: f64| {
        let k = log.log.t_s.partition_point(|t| *t < t_s - 1e-9).min(log.log.len() - 1);
        predicted.base.get(k).map(|base| base.position_m.z)
    };
    Some(at(forward.from_s)? - at(forward.to_s)?)
}

fn base_column(log: &CaseLog, k: usize) -> Option<&[f64]> {
    let base = log.log.base.as_ref()?;
    let column = match k {
        0 => &base.x_m,
        1 => &base.y_m,
        2 => &base.z_m,
        3 => &base.roll_rad,
        4 => &base.pitch_rad,
        _ => &base.yaw_rad,
    };
    column.as_deref()
}

/// Times that no fit sees: one of three cycles of the gait; where nothing repeats, of three parts.
fn held_out_blocks(log: &CaseLog, held: usize) -> Vec<Range<f64>> {
    let (begin_s, end_s) = (log.motion_begins_s(), log.end_s());
    let time_s = end_s - begin_s;
    let period_s =
        period_s(log, begin_s).filter(|period| *period < LONGEST_CYCLE * time_s).unwrap_or(time_s / PARTS as f64);
    let blocks = (time_s / period_s).ceil() as usize;
    let block = |k: usize| begin_s + k as f64 * period_s..begin_s + (k + 1) as f64 * period_s;
    (0..blocks).filter(|k| k % OF_THREE == held).map(block).collect()
}

/// The shortest time after which the setpoints repeat \[s\], from autocorrelation.
pub(super) fn period_s(log: &CaseLog, begin_s: f64) -> Option<f64> {
    let setpoints = &log.scene.setpoints;
    let from = setpoints.t_s.partition_point(|t| *t < begin_s);
    let n = setpoints.t_s.len().checked_sub(from).filter(|n| *n >= 16)?;
    let dt_s = (setpoints.t_s[setpoints.t_s.len() - 1] - setpoints.t_s[from]) / (n - 1) as f64;
    let centred: Vec<Vec<f64>> = setpoints
        .columns
        .iter()
        .flatten()
        .map(|column| {
            let tail = &column.angle_rad[from..];
            let mean = tail.iter().sum::<f64>() / n as f64;
            tail.iter().map(|q| q - mean).collect()
        })
        .collect();
    let alike = |lag: usize| {
        let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
        for column in &centred {
            for (a, b) in column.iter().zip(&column[lag..]) {
                ab += a * b;
                aa += a * a;
                bb += b * b;
            }
        }
        if aa * bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
    };
    let mut has_parted = false;
    for lag in 1..n / 2 {
        let here = alike(lag);
        has_parted |= here < 0.5;
        if has_parted && here > 0.85 && here >= alike(lag + 1) {
            return Some(lag as f64 * dt_s);
        }
    }
    None
}

/// What readings differ from others by; 0 where they end.
pub(super) fn less(there: &[f64], given: &[f64]) -> Vec<f64> {
    let pairs = there.iter().zip(given);
    pairs.map(|(there, given)| if there.is_finite() { there - given } else { 0.0 }).collect()
}
