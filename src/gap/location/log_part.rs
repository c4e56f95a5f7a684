//! One log beside the model, sample by sample: what it holds of the gap.

use super::along::Along;
use crate::gap::diagnosis::{Phase, ResidualTorque};
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
    pub(in crate::gap) fn len(&self) -> usize {
        self.residual_rad.len().min(self.torque.torque_nm.len()).min(self.weights_s.len())
    }

    /// What a sample adds to the gap \[rad^2 s\]: its squared residual beyond the noise.
    ///
    /// The readings of a joint at rest share one rounding error, of half a step at the most: it may explain all of them.
    pub(in crate::gap) fn excess(&self, k: usize) -> f64 {
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
pub(in crate::gap) const NOTICEABLE: f64 = 0.1;

/// Whether residuals have more energy than their noise explains, by this share of it.
pub(in crate::gap) fn exceeds(parts: &[LogPart], share: f64) -> bool {
    let noise: f64 = parts.iter().map(|p| p.noise_rad.powi(2) * p.weights_s.iter().sum::<f64>()).sum();
    total_excess(parts) > share * noise
}

/// The whole gap \[rad^2 s\].
fn total_excess(parts: &[LogPart]) -> f64 {
    parts.iter().flat_map(|p| (0..p.len()).map(|k| p.excess(k))).sum()
}

/// Whether logs have hardly any gap, beside others that have one: none at all, or less than a share of it per second.
pub(in crate::gap) fn is_spared(free: &[LogPart], driven: &[LogPart], share: f64) -> bool {
    let time_s = |parts: &[LogPart]| parts.iter().flat_map(|p| &p.weights_s).sum::<f64>();
    !exceeds(free, NOTICEABLE) || total_excess(free) / time_s(free) < share * total_excess(driven) / time_s(driven)
}
