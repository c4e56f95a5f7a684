//! Where the gap lies: in which logs and phases, at which values of which variable, and on which stage of the chain.
//!
//! The angle residual says how much of the gap each log and phase holds; the residual torque says what it depends on.
//! Nothing here looks at a catalogue of effects, so it answers also where none of them fits.

use super::along::Along;
use super::diagnosis::{MapCell, Phase, ResidualTorque, Where};
use super::map::map;
use super::stage::stage_of;
use super::variables::{best, explained_by_each, shares};
use crate::identify::Experiment;
use crate::joint::Chain;
use crate::pendulum::Input;

/// One log, compared with the model, sample by sample of those that are compared.
#[derive(Clone, Debug)]
pub struct LogPart {
    /// As the user named it.
    pub file: String,
    /// Angle of the model less the reading \[rad\].
    pub residual_rad: Vec<f64>,
    /// The torque that the model lacks.
    pub torque: ResidualTorque,
    /// Gravity torque of link and extra mass along the smoothed path \[N m\].
    pub gravity_nm: Vec<f64>,
    /// Torque of the motor by its law along the smoothed path \[N m\]; zero where it is off.
    pub motor_nm: Vec<f64>,
    /// Slope of the setpoint \[rad/s\]; zero without one.
    pub setpoint_rate_rad_s: Vec<f64>,
    /// Weights of the samples (3.7) \[s\].
    pub weights_s: Vec<f64>,
    /// Standard deviation of a reading \[rad\].
    pub noise_rad: f64,
    /// A motor acts at some time.
    pub driven: bool,
}

/// The setpoint's slope is taken over at least this long \[s\]: where it moves in steps, delays of that size show.
const SLOPE_S: f64 = 0.02;

impl LogPart {
    /// Prepares a log of which the residual angles and the residual torque against `chain` are known.
    pub fn new(
        chain: &Chain<f64>,
        e: &Experiment,
        residual_rad: Vec<f64>,
        torque: ResidualTorque,
        noise_rad: f64,
    ) -> Self {
        let motor_nm = Along::new(chain, e.input(), &e.t_s).motor_compared_nm(&torque, e.uncompared);
        Self {
            file: e.file.clone(),
            gravity_nm: torque
                .t_s
                .iter()
                .zip(&torque.angle_rad)
                .map(|(t, q)| chain.link_at(*t).0.gravity_nm(*q))
                .collect(),
            motor_nm,
            setpoint_rate_rad_s: setpoint_rates(e),
            weights_s: e.weights_s.clone(),
            noise_rad: noise_rad.max(e.resolution_rad / 12f64.sqrt()),
            driven: e.is_driven(),
            residual_rad,
            torque,
        }
    }

    /// Samples of which all is known.
    pub(super) fn len(&self) -> usize {
        self.residual_rad.len().min(self.torque.torque_nm.len()).min(self.weights_s.len())
    }

    /// What a sample adds to the gap \[rad^2 s\]: its squared residual beyond the noise.
    ///
    /// The readings of a joint at rest share one rounding error, of half a step at the most: it may explain all of them.
    pub(super) fn excess(&self, k: usize) -> f64 {
        let square = self.residual_rad[k].powi(2);
        let noise = self.noise_rad.powi(2);
        let excess = match self.torque.phase[k] {
            Phase::Hold | Phase::Stick => (square - 3.0 * noise).max(0.0),
            _ => square - noise,
        };
        self.weights_s[k] * excess
    }
}

/// Backward slope of the setpoint at each compared sample; the motor must be on.
fn setpoint_rates(e: &Experiment) -> Vec<f64> {
    let Input::Position { setpoint_rad, on, .. } = e.input_at_samples() else { return vec![0.0; e.compared()] };
    let slope = |k: usize| {
        let to_s = e.t_s[k];
        let back = e.t_s[..k].iter().rposition(|t| *t <= to_s - SLOPE_S).unwrap_or(0);
        if on.is_some_and(|on| !on[k]) || back >= k {
            return 0.0;
        }
        (setpoint_rad[k] - setpoint_rad[back]) / (to_s - e.t_s[back])
    };
    (e.uncompared..e.t_s.len()).map(slope).collect()
}

/// A gap below this share of the noise's energy is none: noise is not known better than that.
const NOTICEABLE: f64 = 0.1;
/// Up to this share it must show in the residual torque too, in one cell of the map at least.
const OBVIOUS: f64 = 1.0;
/// A log has more than its share of the gap if it exceeds it by this factor.
const MORE: f64 = 1.2;

/// Where the gap of a recalibrated model lies, over all logs together.
///
/// The stage is what the signature suggests; an effect that explains the gap knows better:
/// - The motor, where the torque that is lacking sits where the motor saturates.
/// - Where one variable explains it: the delay if that is the setpoint's slope, the motor if it is a torque along the
///   motor's, the gearing if it is a friction that goes with the motor's torque.
/// - The gearing, where nothing else explains it and the joint moves more freely about its reversals than elsewhere.
/// - The motor, where free logs do not have it; the sensor, where a friction that goes with the amplitude explains it;
///   the delay, where all logs are driven and nothing explains it.
/// - Else the link.
///
/// Where the residuals do not exceed their noise, nothing is named and the map's shares are zero.
pub fn localise(parts: &[LogPart]) -> Where {
    let cells = map(parts);
    let shown = if cells.iter().any(|c| c.significant) { NOTICEABLE } else { OBVIOUS };
    if !exceeds(parts, shown) {
        let cells = cells.into_iter().map(|cell| MapCell { share: 0.0, ..cell }).collect();
        return Where { cells, ..nowhere() };
    }
    let explained = explained_by_each(parts);
    let best = best(&explained);
    Where {
        stage: Some(stage_of(parts, best)),
        variable: best.map(|e| e.variable),
        range: best.and_then(|e| e.binned.range()),
        share: best.map_or(0.0, |e| e.binned.energy_in_range()),
        phase: largest(&cells),
        logs: with_more_than_their_share(parts, &cells),
        variables: shares(&explained),
        profile: best.map(|e| e.binned.profile()).unwrap_or_default(),
        cells,
    }
}

fn nowhere() -> Where {
    Where {
        stage: None,
        variable: None,
        range: None,
        phase: None,
        logs: Vec::new(),
        share: 0.0,
        cells: Vec::new(),
        variables: Vec::new(),
        profile: Vec::new(),
    }
}

/// Whether residuals have more energy than their noise explains, by this share of it.
fn exceeds(parts: &[LogPart], share: f64) -> bool {
    let noise: f64 = parts.iter().map(|p| p.noise_rad.powi(2) * p.weights_s.iter().sum::<f64>()).sum();
    total_excess(parts) > share * noise
}

/// The whole gap \[rad^2 s\].
fn total_excess(parts: &[LogPart]) -> f64 {
    parts.iter().flat_map(|p| (0..p.len()).map(|k| p.excess(k))).sum()
}

/// Whether logs have hardly any gap, beside others that have one: none at all, or less than a share of it per second.
pub(super) fn is_spared(free: &[LogPart], driven: &[LogPart], share: f64) -> bool {
    let time_s = |parts: &[LogPart]| parts.iter().flat_map(|p| &p.weights_s).sum::<f64>();
    !exceeds(free, NOTICEABLE) || total_excess(free) / time_s(free) < share * total_excess(driven) / time_s(driven)
}

/// The phase with the largest share.
fn largest(cells: &[MapCell]) -> Option<Phase> {
    let share = |phase: Phase| cells.iter().filter(|c| c.phase == phase).map(|c| c.share).sum::<f64>();
    Phase::ALL
        .into_iter()
        .map(|p| (share(p), p))
        .filter(|(s, _)| *s > 0.0)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|x| x.1)
}

fn with_more_than_their_share(parts: &[LogPart], cells: &[MapCell]) -> Vec<String> {
    let time_s: f64 = parts.iter().flat_map(|p| &p.weights_s).sum();
    let mut logs: Vec<(f64, &str)> = parts
        .iter()
        .filter_map(|p| {
            let share: f64 = cells.iter().filter(|c| c.file == p.file).map(|c| c.share).sum();
            let fair = p.weights_s.iter().sum::<f64>() / time_s;
            (share > MORE * fair).then_some((share, p.file.as_str()))
        })
        .collect();
    logs.sort_by(|a, b| b.0.total_cmp(&a.0));
    logs.into_iter().map(|(_, file)| file.to_owned()).collect()
}

#[cfg(test)]
#[path = "localise_tests.rs"]
mod tests;
