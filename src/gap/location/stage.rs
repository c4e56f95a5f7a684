//! The stage of the chain at which a gap looks to arise, from its signature alone.

use super::blocks::is_moving;
use super::log_part::{LogPart, is_spared};
use super::variables::{Explained, Form};
use crate::gap::diagnosis::{Phase, Variable};
use crate::joint::Stage;

/// Driven logs alone have the gap if free logs have less than this share of it per second.
const HARDLY: f64 = 0.1;
/// A phase dominates if it holds the first share of the residual torque's energy, and exceeds its share of the time by
/// the second factor.
const DOMINANT: [f64; 2] = [0.5, 1.5];
/// The same of saturation, which is over in a moment.
const SATURATED: [f64; 2] = [0.25, 4.0];
/// A variable that explains more than this share knows better than the phase.
const EXPLAINED: f64 = 0.3;

pub(in crate::gap) fn stage_of(parts: &[LogPart], best: Option<&Explained>) -> Stage {
    let (driven, free): (Vec<LogPart>, Vec<LogPart>) = parts.iter().cloned().partition(|p| p.driven);
    let motor_alone = !driven.is_empty() && !free.is_empty() && is_spared(&free, &driven, HARDLY);
    let of_motor = |e: &Explained| match (e.variable, e.form) {
        (Variable::SetpointRate, _) => Some(Stage::Delay),
        (Variable::Torque, Form::AgainstMotion) => Some(Stage::Gearing),
        (Variable::Torque, _) => Some(Stage::Motor),
        _ => None,
    };
    let saturation = share_of(parts, Phase::Saturation, SATURATED);
    if saturation > best.map_or(0.0, Explained::share) {
        return Stage::Motor;
    }
    let explained = best.filter(|e| e.share() > EXPLAINED);
    if let Some(stage) = explained.and_then(of_motor) {
        return stage;
    }
    if explained.is_none() && share_of(parts, Phase::Reversal, DOMINANT) > 0.0 && runs_free_after_reversals(parts) {
        return Stage::Gearing;
    }
    match explained {
        _ if motor_alone => Stage::Motor,
        Some(e) if e.variable == Variable::Amplitude => Stage::Sensor,
        None if free.is_empty() => Stage::Delay,
        _ => Stage::Link,
    }
}

/// Share of the residual torque's energy in a phase; zero where it does not dominate.
fn share_of(parts: &[LogPart], phase: Phase, [most, denser]: [f64; 2]) -> f64 {
    let (mut energy, mut time_s) = ([0.0; 2], [0.0; 2]);
    for part in parts {
        for k in (0..part.len()).filter(|k| is_moving(part, *k)) {
            let inside = usize::from(part.torque.phase[k] == phase);
            let beyond = part.torque.torque_nm[k].powi(2) - part.torque.sigma_nm[k].powi(2);
            energy[inside] += part.weights_s[k] * beyond.max(0.0);
            time_s[inside] += part.weights_s[k];
        }
    }
    let share = |x: [f64; 2]| if x[1] > 0.0 { x[1] / (x[0] + x[1]) } else { 0.0 };
    if share(energy) > most && share(energy) > denser * share(time_s) { share(energy) } else { 0.0 }
}

/// Whether the motion meets less resistance near reversals than elsewhere, as it does in free play; friction that rises
/// towards rest does the opposite.
fn runs_free_after_reversals(parts: &[LogPart]) -> bool {
    let (mut against, mut time_s) = ([0.0; 2], [0.0; 2]);
    for part in parts {
        let r = &part.torque;
        for k in (0..part.len()).filter(|k| is_moving(part, *k)) {
            let near = usize::from(r.phase[k] == Phase::Reversal);
            against[near] -= part.weights_s[k] * r.torque_nm[k] * r.rate_rad_s[k].signum();
            time_s[near] += part.weights_s[k];
        }
    }
    against[1] / time_s[1] < against[0] / time_s[0]
}
