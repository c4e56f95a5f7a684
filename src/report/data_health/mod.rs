//! The health of logs as every report has it: computed once, from what a case knows of its logs.

mod text;

pub(super) use text::{health_text, motion_text, robot_health_text, together};

use super::assemble::role;
use super::{HealthMore, LogHealthRow};
use crate::gap::clamped::ClampedSetup;
use crate::identify::{Case, Item};
use crate::log::{ClampedStudyLog, Health, Log, RobotLog, SetpointStamps, Start, StudyLog, health};

/// Setpoints whose time to the next reading spreads by more than this share of their period run by a clock of their own.
const FREELY: f64 = 0.05;

/// One row per log.
pub(super) fn health_rows(case: &Case) -> Vec<LogHealthRow> {
    case.items.iter().map(health_row).collect()
}

/// One row per log that a joint of a robot is in, of what was read alone: no model is asked.
pub(super) fn health_rows_of_joint(setup: &ClampedSetup, joint: &str) -> Vec<LogHealthRow> {
    let study = &setup.study;
    let row = |(entry, all): (&ClampedStudyLog, &RobotLog)| {
        let own = all.joint(joint)?.clone();
        let log = Log {
            file: all.file.clone(),
            t_s: all.t_s.clone(),
            q_rad: own.q_rad,
            dq_rad_s: None,
            tau_nm: own.tau_nm,
            q_ref_rad: own.q_ref_rad,
            setpoints: own.setpoints,
            drive: own.drive,
            ignored_columns: all.ignored_columns.clone(),
            notes: all.notes.clone(),
        };
        let entry = StudyLog {
            file: entry.file.clone(),
            path: entry.path.clone(),
            role: entry.role,
            drive: entry.drive,
            motor: None,
            extra: None,
            session: entry.session.clone(),
            tau_is: None,
            window: None,
        };
        let (sensor, health) = (study.sensor, health(&log, &study.sensor, entry.drive));
        Some(health_row(&Item { log, entry, sensor, health, experiments: Vec::new(), remarks: Vec::new() }))
    };
    study.logs.iter().zip(&setup.logs).filter_map(row).collect()
}

fn health_row(item: &Item) -> LogHealthRow {
    let h = &item.health;
    let mut remarks = Vec::new();
    match &h.start {
        Start::AlwaysHeld => remarks.push("held throughout: never let go".to_owned()),
        _ if !h.moved => remarks.push("never moves".to_owned()),
        _ => {}
    }
    if let Some(e) = item.experiments.last() {
        let last = e.first_sample + e.t_s.len();
        if last < item.log.len() && item.log.drive.as_ref().is_some_and(|held| held[last]) {
            remarks.push(format!("caught again at {:.3} s; what follows is not fitted", item.log.t_s[last]));
        }
    }
    remarks.extend(item.remarks.iter().cloned());
    if item.log.len() < h.samples {
        remarks.push(format!("long log: {} of its samples are fitted", item.log.len()));
    }
    if h.lost_samples > 0 {
        remarks.push(format!("{} samples lost", h.lost_samples));
    }
    remarks.extend(h.doubts());
    if h.jitter_s > 0.1 * h.period_s {
        remarks.push("uneven sampling".to_owned());
    }
    if let (Some(given), Some(seen)) = (item.sensor.resolution_rad, h.step_rad)
        && (given / seen - 1.0).abs() > 0.05
    {
        remarks.push(format!("readings move in steps of {seen:.6} rad, the study says {given} rad"));
    }
    if let Some(given) = item.sensor.period_s
        && (given / h.period_s - 1.0).abs() > 0.2
    {
        remarks.push(format!("samples every {:.4} s, the study says {given} s", h.period_s));
    }
    remarks.extend(h.setpoint_stamps.as_ref().map(stamps_apart));
    remarks.extend(item.log.notes.iter().cloned());
    if !item.log.ignored_columns.is_empty() {
        remarks.push(format!("columns not used: {}", item.log.ignored_columns.join(", ")));
    }
    LogHealthRow {
        file: item.entry.file.clone(),
        role: role(item.entry.role),
        samples: h.samples,
        duration_s: h.duration_s,
        period_s: h.period_s,
        jitter_s: h.jitter_s,
        lost: h.lost_samples,
        resolution_rad: item.sensor.resolution_rad.or(h.step_rad).unwrap_or(0.0),
        noise_rad: h.held_std_rad.or(Some(h.noise_rad)),
        release_s: h.start.held().map(|held| held.release_s),
        rest_from_s: h.rest_from_s,
        remarks,
        more: HealthMore::of(h),
    }
}

/// How setpoints with stamps of their own lie to the readings.
fn stamps_apart(stamps: &SetpointStamps) -> String {
    let [period, before, spread] = [stamps.period_s, stamps.before_reading_s, stamps.spread_s].map(|s| 1e3 * s);
    let words =
        format!("setpoints have stamps of their own, every {period:.2} ms, {before:.2} ms before the next reading");
    if stamps.spread_s > FREELY * stamps.period_s { words + &format!(" (spread {spread:.2} ms)") } else { words }
}

impl HealthMore {
    /// What a log is like beyond its table.
    fn of(health: &Health) -> Self {
        let stamps = health.setpoint_stamps.as_ref();
        Self {
            longest_step_s: health.longest_step_s,
            travel_rad: health.travel_rad,
            top_speed_rad_s: health.top_speed_rad_s,
            reversals: health.reversals,
            still_share: health.still_share,
            stale_share: health.stale_share,
            noise_lasts_s: health.noise_lasts_s,
            noise_correlation: health.noise_correlation.clone(),
            setpoint_period_s: stamps.map(|stamps| stamps.period_s),
            setpoint_before_reading_s: stamps.map(|stamps| stamps.before_reading_s),
            setpoint_spread_s: stamps.map(|stamps| stamps.spread_s),
            torque_limit_nm: health.torque_plateau.map(|(at_nm, _)| at_nm),
            torque_limit_share: health.torque_plateau.map(|(_, share)| share),
            stuck_at_rad: health.stuck.map(|stuck| stuck.at_rad),
            stuck_s: health.stuck.map(|stuck| stuck.lasts_s),
            stuck_setpoint_rad: health.stuck.map(|stuck| [stuck.beyond_rad, stuck.back_rad]),
            stuck_times: health.stuck.map(|stuck| [stuck.visits, stuck.elsewhere]),
        }
    }
}
