//! From a motion to the files of a study: what the encoder and the logger make of it.

use super::dice::{Dice, significant};
use super::joint::{Joint, Sensor};
use super::plan::{GRAVITY_M_S2, LogPlan};
use super::sim::Trace;
use super::truth::FourNumbers;
use std::fmt::Write;

/// The files of a study: names and contents, `study.toml` first.
pub(super) fn files(
    joint: &Joint,
    nominal: &FourNumbers,
    plans: &[LogPlan],
    traces: &[Trace],
    dice: &mut Dice,
) -> Vec<(String, String)> {
    let mut files = vec![("study.toml".to_owned(), study(joint, nominal, plans, dice.chance(0.3)))];
    for (i, (plan, trace)) in plans.iter().zip(traces).enumerate() {
        files.push((name(i), log(joint, plan, trace, dice)));
    }
    files
}

fn name(i: usize) -> String {
    format!("log-{i:02}.csv")
}

/// The study file; numbers as TOML floats.
fn study(joint: &Joint, nominal: &FourNumbers, plans: &[LogPlan], states_rest: bool) -> String {
    let mut text = String::from("schema = 1\n\n[joint]\nname = \"joint\"\n");
    // writing to a string cannot fail
    for (name, value) in FourNumbers::NAMES.iter().zip(nominal.list()) {
        let _ = writeln!(text, "{name} = {value:?}");
    }
    let _ = writeln!(text, "gravity = {GRAVITY_M_S2:?}");
    if states_rest {
        text.push_str("rest = 0.0\n");
    }
    let sensor = &joint.sensor;
    let _ = write!(text, "\n[sensor]\nresolution = {:?}\nperiod = {:?}\n", sensor.resolution_rad, sensor.period_s);
    if plans.iter().any(LogPlan::is_driven) {
        let _ = write!(text, "\n[motor]\nkp = {:?}\nkd = {:?}\n", joint.kp, joint.kd);
    }
    for (i, plan) in plans.iter().enumerate() {
        let role = if plan.validate { "validate" } else { "fit" };
        let drive = if plan.is_driven() { "position" } else { "off" };
        let _ = write!(text, "\n[[log]]\nfile = \"{}\"\nrole = \"{role}\"\ndrive = \"{drive}\"\n", name(i));
        if let Some(extra) = &plan.load {
            let (m, d, r, l) = (extra.mass_kg, extra.distance_m, extra.radius_m, extra.length_m);
            let _ = write!(text, "[log.extra]\nmass = {m:?}\ndistance = {d:?}\nradius = {r:?}\nlength = {l:?}\n");
        }
    }
    text
}

/// One log as CSV.
fn log(joint: &Joint, plan: &LogPlan, trace: &Trace, dice: &mut Dice) -> String {
    let driven = plan.is_driven();
    let with_tau = driven && joint.tau_column;
    let mut text = String::from("t,q");
    text.push_str(if driven { ",q_ref" } else { "" });
    text.push_str(if with_tau { ",tau" } else { "" });
    text.push_str(if plan.drive_column { ",drive" } else { "" });
    text.push('\n');
    let free = plan.first_free();
    let last = plan.times_s.len().saturating_sub(1);
    let changes = plan.changes.as_deref().unwrap_or_default();
    let mut at = 0;
    for (i, (t_s, q_rad)) in plan.times_s.iter().zip(&trace.q_rad).enumerate() {
        let changed = changes.get(at + 1).is_some_and(|(t, _)| *t <= t_s + 1e-9);
        at += usize::from(changed);
        let reading = read(&joint.sensor, *q_rad, dice);
        let is_lost = dice.chance(joint.sensor.lost);
        // a sample that brings a setpoint, and those around a release, are there
        if is_lost && !changed && i > 0 && i < last && i.abs_diff(free) > 3 {
            continue;
        }
        let _ = write!(text, "{t_s:.4},{reading:.7}");
        if driven {
            let _ = write!(text, ",{}", changes.get(at).map_or(0.0, |(_, value)| *value));
        }
        if with_tau {
            let _ = write!(text, ",{}", significant(trace.tau_nm.get(i).copied().unwrap_or(0.0), 4));
        }
        if plan.drive_column {
            let _ = write!(text, ",{}", u8::from(i < free));
        }
        text.push('\n');
    }
    text
}

/// What the encoder says: noise, rounding, flicker.
fn read(sensor: &Sensor, q_rad: f64, dice: &mut Dice) -> f64 {
    let before = if sensor.before_rad > 0.0 { sensor.before_rad * dice.uniform(-1.0, 1.0) } else { 0.0 };
    let mut steps = ((q_rad + before) / sensor.resolution_rad).round();
    if sensor.flicker > 0.0 && dice.chance(sensor.flicker) {
        steps += dice.sign();
    }
    // no minus zero
    steps * sensor.resolution_rad + 0.0
}
