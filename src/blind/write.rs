//! From a motion to the files of a study: what the encoder and the logger make of it.

use super::belief::Belief;
use super::dice::{Dice, significant};
use super::joint::Joint;
use super::plan::LogPlan;
use super::sensor::Reader;
use super::sim::Trace;
use super::truth::FourNumbers;
use crate::number::STANDARD_GRAVITY_M_S2;
use std::fmt::Write;
use std::ops::Range;

/// The files of a study: names and contents, `study.toml` first.
pub(super) fn files(
    joint: &Joint,
    belief: &Belief,
    plans: &[LogPlan],
    traces: &[Trace],
    dice: &mut Dice,
) -> Vec<(String, String)> {
    let mut files = vec![("study.toml".to_owned(), study(joint, belief, plans, dice.chance(0.3)))];
    let holes = holes(joint, plans, dice);
    for (i, (plan, trace)) in plans.iter().zip(traces).enumerate() {
        files.push((name(i), log(joint, plan, trace, &holes[i], dice)));
    }
    files
}

fn name(i: usize) -> String {
    format!("log-{i:02}.csv")
}

/// The study file; numbers as TOML floats.
fn study(joint: &Joint, belief: &Belief, plans: &[LogPlan], states_rest: bool) -> String {
    let mut text = String::from("schema = 1\n\n[joint]\nname = \"joint\"\n");
    // writing to a string cannot fail
    for (name, value) in FourNumbers::NAMES.iter().zip(belief.nominal.list()) {
        let _ = writeln!(text, "{name} = {value:?}");
    }
    let _ = writeln!(text, "gravity = {STANDARD_GRAVITY_M_S2:?}");
    if states_rest {
        text.push_str("rest = 0.0\n");
    }
    let sensor = &joint.sensor;
    let _ = write!(text, "\n[sensor]\nresolution = {:?}\nperiod = {:?}\n", sensor.resolution_rad, sensor.period_s);
    if plans.iter().any(LogPlan::is_driven) {
        let _ = write!(text, "\n[motor]\nkp = {:?}\nkd = {:?}\n", belief.gains.kp, belief.gains.kd);
    }
    if belief.believed.written {
        text.push_str(&uncertain(belief, plans));
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

/// How sure the engineer is.
fn uncertain(belief: &Belief, plans: &[LogPlan]) -> String {
    let sure = &belief.believed;
    let mut text = format!(
        "\n[uncertain]\ninertia = {:?}\nmoment = {:?}\nfriction = {:?}\n",
        sure.inertia, sure.moment, sure.friction
    );
    if plans.iter().any(LogPlan::is_driven) {
        let _ = writeln!(text, "gain = {:?}", sure.gain);
    }
    text
}

/// Samples that no log has, as ranges by log: each hole in any log, past its beginning and before its end.
fn holes(joint: &Joint, plans: &[LogPlan], dice: &mut Dice) -> Vec<Vec<Range<usize>>> {
    let mut holes = vec![Vec::new(); plans.len()];
    for _ in 0..joint.sensor.holes {
        let (log, length) = (dice.whole(0, plans.len() - 1), dice.whole(4, 30));
        let (from, to) = (plans[log].first_free() + 40, plans[log].times_s.len() - 40 - length);
        if from < to {
            let from = dice.whole(from, to);
            holes[log].push(from..from + length);
        }
    }
    holes
}

/// One log as CSV.
fn log(joint: &Joint, plan: &LogPlan, trace: &Trace, holes: &[Range<usize>], dice: &mut Dice) -> String {
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
    let mut reader = Reader::new(&joint.sensor);
    for (i, (t_s, q_rad)) in plan.times_s.iter().zip(&trace.q_rad).enumerate() {
        let changed = changes.get(at + 1).is_some_and(|(t, _)| *t <= t_s + 1e-9);
        at += usize::from(changed);
        let reading = reader.read(*t_s, *q_rad, dice);
        let stamp_s = joint.sensor.stamp_s(*t_s, dice);
        let is_lost = dice.chance(joint.sensor.lost);
        // a sample that brings a setpoint, and those around a release, are there
        if is_lost && !changed && i > 0 && i < last && i.abs_diff(free) > 3 {
            continue;
        }
        // what falls into a hole is lost, setpoints and all
        if holes.iter().any(|hole| hole.contains(&i)) {
            continue;
        }
        let _ = write!(text, "{stamp_s:.6},{reading:.7}");
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
