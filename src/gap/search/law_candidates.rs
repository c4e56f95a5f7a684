//! The laws that a study's logs may show: of which variable, over which range.

use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::law_shape::LawShape;
use crate::identify::{Experiment, Signal};
use crate::joint::{LawActs, LawVariable};
use crate::number::math;

/// Waves of a law of the angle, where teeth and magnets make ripples, and of any other.
const WAVES_OF_ANGLE: usize = 32;
const WAVES: usize = 12;
/// Readings beyond these shares are left out of a variable's range.
const TAILS: f64 = 0.002;
/// A range below this share of a full one shows nothing.
const FLAT: f64 = 1e-9;

/// Every law that the logs may show, with beliefs of size one.
pub(in crate::gap) fn candidates(evidence: &Evidence) -> Vec<LawShape> {
    use LawActs::{Friction, Gain, Reading, Torque};
    use LawVariable::{Angle, Load, MotorTorque, SetpointRate, Speed, Time};
    let kinds = [
        (Torque, Angle),
        (Torque, Speed),
        (Torque, MotorTorque),
        (Torque, SetpointRate),
        (Torque, Time),
        (Friction, Speed),
        (Friction, Angle),
        (Friction, Load),
        (Friction, MotorTorque),
        (Friction, Time),
        (Reading, Angle),
        (Reading, Time),
        (Gain, Angle),
        (Gain, Speed),
        (Gain, Time),
    ];
    kinds.into_iter().filter_map(|(acts, variable)| candidate(evidence, acts, variable)).collect()
}

fn candidate(evidence: &Evidence, acts: LawActs, variable: LawVariable) -> Option<LawShape> {
    let signed = acts != LawActs::Friction || variable == LawVariable::Angle;
    let shows = |e: &&Experiment| acts != LawActs::Gain || e.is_driven();
    let mut seen: Vec<f64> = evidence.fit.iter().filter(shows).flat_map(|e| values_of(evidence, e, variable)).collect();
    if !signed {
        seen.iter_mut().for_each(|x| *x = x.abs());
    }
    seen.retain(|x| x.is_finite());
    if seen.is_empty() {
        return None;
    }
    seen.sort_by(f64::total_cmp);
    let at = |share: f64| seen[((seen.len() - 1) as f64 * share).round() as usize];
    let (from, to) = (if signed { at(TAILS) } else { 0.0 }, at(1.0 - TAILS));
    let count = if variable == LawVariable::Angle { WAVES_OF_ANGLE } else { WAVES };
    (to - from > FLAT * (from.abs() + to.abs())).then(|| LawShape::between(acts, variable, [from, to], count))
}

/// A typical size, in the law's unit: all the torque that there is, a radian, or the whole share.
pub(in crate::gap) fn typical(evidence: &Evidence, acts: LawActs) -> f64 {
    match acts {
        LawActs::Reading | LawActs::Gain => 1.0,
        _ => evidence.reach.torque_nm.max(evidence.reach.driven.map_or(0.0, |driven| driven.command_nm)),
    }
}

/// What a variable was along a log, roughly.
fn values_of(evidence: &Evidence, e: &Experiment, variable: LawVariable) -> Vec<f64> {
    let (t, q) = (&e.t_s[e.uncompared..], &e.measured_rad[e.uncompared..]);
    let slope = |x: &[f64]| -> Vec<f64> {
        let stride = (x.len() / 200).clamp(1, 4);
        (stride..x.len()).map(|k| (x[k] - x[k - stride]) / (t[k] - t[k - stride])).collect()
    };
    match (variable, &e.signal) {
        (LawVariable::Angle, _) => q.to_vec(),
        (LawVariable::Speed, _) => slope(q),
        (LawVariable::Load, _) => {
            let nominal = evidence.nominal.moment_kg_m;
            let load = e.load.map_or((0.0, 0.0), |l| (l.moment_kg_m, l.angle_rad));
            let pull = |q: &f64| {
                nominal * math::sin(q - evidence.rest_rad) + load.0 * math::sin(q - evidence.rest_rad - load.1)
            };
            q.iter().map(|q| e.gravity_m_s2 * pull(q)).collect()
        }
        (LawVariable::Time, _) => t.to_vec(),
        (LawVariable::MotorTorque, Signal::Torque { torque_nm, .. }) => torque_nm[e.uncompared..].to_vec(),
        (LawVariable::MotorTorque, Signal::Position { setpoint_rad, .. }) => {
            let kp = e.motor.map_or(0.0, |motor| motor.nm_per_answer() * motor.kp_nm_rad);
            setpoint_rad[e.uncompared..].iter().zip(q).map(|(r, q)| kp * (r - q)).collect()
        }
        (LawVariable::SetpointRate, Signal::Position { setpoint_rad, .. }) => slope(&setpoint_rad[e.uncompared..]),
        _ => Vec::new(),
    }
}
