//! What the residual torque depends on: the share of its energy that a binned mean over each variable explains.
//!
//! A friction is looked for in the torque against the motion, a force in the torque as it is; of a magnitude (load, motor
//! torque, slope of the setpoint) in the torque along it.

use super::binned::{Binned, Sample, explain};
use super::blocks::{Blocks, is_moving};
use super::log_part::LogPart;
use crate::gap::diagnosis::{Phase, Variable};

/// A variable that explains at least this share, and so many times what the earlier ones do, needs no more.
const NOTABLE: f64 = 0.1;
const ALONE: f64 = 3.0;
/// A torque counts up to this many times its RMS.
const SPIKE: f64 = 2.5;

/// The sign with which a torque enters a mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gap) enum Form {
    /// As it is.
    Plain,
    /// Counted against the motion: a friction.
    AgainstMotion,
    /// Counted along the quantity whose magnitude is the variable.
    Along,
}

/// Variables and forms, plain explanations first.
///
/// One variable passes for another: a constant torque for one of the angle, the speed for the setpoint's slope, and over
/// a decaying swing time and amplitude for the speed. So a later one is taken for the answer only if it explains at
/// least the given share of what the earlier ones leave.
const TRIED: [(Variable, Form, f64); 11] = [
    (Variable::Direction, Form::Plain, 0.0),
    (Variable::Speed, Form::AgainstMotion, 0.0),
    (Variable::Load, Form::AgainstMotion, 0.0),
    (Variable::Torque, Form::AgainstMotion, 0.0),
    (Variable::Load, Form::Along, 0.1),
    (Variable::Torque, Form::Along, 0.1),
    (Variable::Angle, Form::Plain, 0.25),
    (Variable::Angle, Form::AgainstMotion, 0.25),
    (Variable::Time, Form::AgainstMotion, 0.1),
    (Variable::Amplitude, Form::AgainstMotion, 0.1),
    (Variable::SetpointRate, Form::Along, 0.25),
];

/// What one variable explains.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Explained {
    pub variable: Variable,
    pub form: Form,
    /// How.
    pub binned: Binned,
}

impl Explained {
    /// Share of the residual torque's energy.
    pub(in crate::gap) fn share(&self) -> f64 {
        self.binned.share
    }
}

/// What every variable explains in each form, in the order in which they are tried.
pub(in crate::gap) fn explained_by_each(parts: &[LogPart]) -> Vec<Explained> {
    explained_by(parts, &TRIED.map(|(variable, form, _)| (variable, form)))
}

/// What variables explain, each in a form.
pub(in crate::gap) fn explained_by(parts: &[LogPart], tried: &[(Variable, Form)]) -> Vec<Explained> {
    let (samples, places) = samples(parts);
    let amplitudes: Vec<Vec<f64>> = parts.iter().map(amplitudes).collect();
    let explain = |&(variable, form): &(Variable, Form)| {
        let look = |&(log, k): &(usize, usize)| look(&parts[log], &amplitudes[log], k, variable, form);
        Explained { variable, form, binned: explain(&samples, &places.iter().map(look).collect::<Vec<_>>()) }
    };
    tried.iter().map(explain).collect()
}

/// The variable that is taken for the answer; `None` where none explains anything.
pub(in crate::gap) fn best(explained: &[Explained]) -> Option<&Explained> {
    let mut best: Option<&Explained> = None;
    for (e, (_, _, gain)) in explained.iter().zip(TRIED) {
        let known = best.map_or(0.0, Explained::share);
        let alone = e.share() > NOTABLE && e.share() > ALONE * known;
        if alone || e.share() > known + gain * (1.0 - known) {
            best = Some(e);
        }
    }
    best
}

/// The share that each variable explains in its better form, largest first.
pub(in crate::gap) fn shares(explained: &[Explained]) -> Vec<(Variable, f64)> {
    let mut shares: Vec<(Variable, f64)> = Vec::new();
    for e in explained {
        match shares.iter_mut().find(|(variable, _)| *variable == e.variable) {
            Some((_, share)) => *share = share.max(e.share()),
            None => shares.push((e.variable, e.share())),
        }
    }
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    shares
}

/// The samples with an estimate of the torque, and in which log and where each is. Their weight is their time, less where the
/// estimate is uncertain; a spike counts no more than [`SPIKE`] times what is typical, so that one event does not drown what
/// comes back.
fn samples(parts: &[LogPart]) -> (Vec<Sample>, Vec<(usize, usize)>) {
    let moving: Vec<Vec<usize>> = parts.iter().map(|p| (0..p.len()).filter(|k| is_moving(p, *k)).collect()).collect();
    let (mut typical, mut limit) = (0.0, f64::INFINITY);
    for _ in 0..3 {
        let (mut energy, mut time_s) = (0.0, 0.0);
        for (part, moving) in parts.iter().zip(&moving) {
            energy += moving.iter().map(|&k| part.weights_s[k] * clipped(part, k, limit).powi(2)).sum::<f64>();
            time_s += moving.iter().map(|&k| part.weights_s[k]).sum::<f64>();
        }
        typical = energy / time_s;
        limit = SPIKE * typical.sqrt();
    }
    let (mut samples, mut places) = (Vec::new(), Vec::new());
    let mut blocks_before = 0;
    for (log, (part, moving)) in parts.iter().zip(&moving).enumerate() {
        let length_s = Blocks::of(part).length_s;
        let begin_s = part.torque.t_s.first().copied().unwrap_or(0.0);
        let mut last = blocks_before;
        for &k in moving {
            let inside = ((part.torque.t_s[k] - begin_s) / length_s) as usize;
            last = blocks_before + inside;
            let weight = part.weights_s[k] / (1.0 + part.torque.sigma_nm[k].powi(2) / typical);
            if weight > 0.0 {
                let odd = (inside + log) % 2 == 1;
                samples.push(Sample {
                    torque_nm: part.torque.torque_nm[k],
                    clipped_nm: clipped(part, k, limit),
                    sigma_nm: part.torque.sigma_nm[k],
                    weight,
                    block: last,
                    odd,
                });
                places.push((log, k));
            }
        }
        blocks_before = last + 1;
    }
    (samples, places)
}

fn clipped(part: &LogPart, k: usize, limit_nm: f64) -> f64 {
    part.torque.torque_nm[k].clamp(-limit_nm, limit_nm)
}

/// Half the distance between the turning points of the half swing to which each sample belongs \[rad\].
fn amplitudes(part: &LogPart) -> Vec<f64> {
    let r = &part.torque;
    let rests = |k: usize| matches!(r.phase[k], Phase::Hold | Phase::Stick);
    let mut amplitudes = Vec::with_capacity(part.len());
    while amplitudes.len() < part.len() {
        let from = amplitudes.len();
        let same = |k: &usize| (r.rate_rad_s[*k] < 0.0) == (r.rate_rad_s[from] < 0.0) && rests(*k) == rests(from);
        let to = from + (from..part.len()).take_while(same).count();
        let swing = &r.angle_rad[from..to];
        let [low, high] = crate::number::extent(swing.iter().copied());
        amplitudes.resize(to, 0.5 * (high - low));
    }
    amplitudes
}

/// The variable at a sample, and the sign with which the torque enters: zero where the variable says nothing.
fn look(part: &LogPart, amplitudes: &[f64], k: usize, variable: Variable, form: Form) -> (f64, f64) {
    let r = &part.torque;
    let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
    let direction = sign(r.rate_rad_s[k]);
    let (value, along) = match variable {
        Variable::Speed => (r.rate_rad_s[k].abs(), 1.0),
        Variable::Direction => (direction, 1.0),
        Variable::Angle => (r.angle_rad[k], 1.0),
        Variable::Load => (part.gravity_nm[k].abs(), sign(part.gravity_nm[k])),
        Variable::Time => (r.t_s[k], 1.0),
        Variable::SetpointRate => (part.setpoint_rate_rad_s[k].abs(), sign(part.setpoint_rate_rad_s[k])),
        Variable::Torque => (part.motor_nm[k].abs(), sign(part.motor_nm[k])),
        Variable::Amplitude => (amplitudes[k], 1.0),
    };
    // Where there is no motor its torque explains nothing, not even a mean.
    let factor = match form {
        Form::Plain => 1.0,
        Form::AgainstMotion => -direction * along.abs(),
        Form::Along => along,
    };
    (value, factor)
}
