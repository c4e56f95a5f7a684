//! Typical sizes in a set of experiments: where a search starts when nothing is known, and how far a step may go.

use super::smooth::motion;
use super::{Experiment, Named, Parameter};
use crate::log::Nominal;
use crate::number::{STANDARD_GRAVITY_M_S2, math};

/// Typical sizes in the experiments, from which searches start and steps are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Largest torque about the joint \[N m\]: gravity's, or the drive's.
    pub torque_nm: f64,
    /// \[kg m^2\]
    pub inertia_kg_m2: f64,
    /// Of small swings \[rad/s\].
    pub frequency_rad_s: f64,
    /// In the plane of motion \[m/s^2\].
    pub gravity_m_s2: f64,
    /// Where the joint hangs, by guess or as given \[rad\].
    pub rest_rad: f64,
    /// The study gives the rest angle.
    pub rest_given: bool,
}

/// Frequency of small swings that is assumed where nothing shows it \[rad/s\].
const TYPICAL_RAD_S: f64 = 8.0;

impl Scale {
    /// Sizes in `experiments`, with what the study gives. Without a nominal model everything is per unit of inertia.
    pub fn of(experiments: &[Experiment], nominal: Option<&Nominal>, rest_rad: Option<f64>) -> Self {
        let gravity_m_s2 = experiments.first().map_or(STANDARD_GRAVITY_M_S2, |e| e.gravity_m_s2);
        let rest = rest_rad.unwrap_or_else(|| resting_angle(experiments));
        let load =
            |f: fn(&super::Load) -> f64| experiments.iter().filter_map(|e| e.load.as_ref()).map(f).fold(0.0, f64::max);
        let inertia_kg_m2 = nominal.map_or(1.0, |n| n.inertia_kg_m2);
        let total_inertia = inertia_kg_m2 + load(|l| l.inertia_kg_m2);
        let frequency_rad_s = match nominal {
            Some(n) if n.moment_kg_m > 0.0 => {
                ((n.moment_kg_m + load(|l| l.moment_kg_m)) * gravity_m_s2 / total_inertia).sqrt()
            }
            _ => seen_frequency(experiments, rest),
        };
        let driven_nm = experiments.iter().map(Experiment::largest_command_nm);
        let gravity_nm = total_inertia * frequency_rad_s.powi(2);
        Self {
            torque_nm: driven_nm.fold(gravity_nm, f64::max),
            inertia_kg_m2,
            frequency_rad_s,
            gravity_m_s2,
            rest_rad: rest,
            rest_given: rest_rad.is_some(),
        }
    }

    pub(super) fn moment_kg_m(&self) -> f64 {
        self.inertia_kg_m2 * self.frequency_rad_s.powi(2) / self.gravity_m_s2
    }

    pub(super) fn rest(&self) -> Parameter {
        let p = Parameter::angle(Named::Rest, "q_rest", self.rest_given.then_some(self.rest_rad), self.rest_rad);
        if self.rest_given { p.fixed() } else { p }
    }

    pub(super) fn friction(&self, nominal: Option<&Nominal>, stribeck: bool) -> Vec<Parameter> {
        let damping = self.torque_nm / self.frequency_rad_s;
        let mut parameters = vec![
            Parameter::friction(
                Named::Coulomb,
                "mu_c",
                "N m",
                nominal.map(|n| n.coulomb_nm),
                nominal.map_or(0.01 * self.torque_nm, |n| n.coulomb_nm),
                self.torque_nm,
            ),
            Parameter::friction(
                Named::Viscous,
                "mu_v",
                "N m s/rad",
                nominal.map(|n| n.viscous_nm_s_rad),
                nominal.map_or(0.05 * damping, |n| n.viscous_nm_s_rad),
                damping,
            ),
        ];
        if stribeck {
            let start = 0.3 * parameters[0].start.max(0.01 * self.torque_nm);
            parameters.push(Parameter::friction(
                Named::StaticExcess,
                "mu_st - mu_c",
                "N m",
                None,
                start,
                self.torque_nm,
            ));
            parameters.push(Parameter::positive(
                Named::StribeckSpeed,
                "v_st",
                "rad/s",
                None,
                0.05 * self.frequency_rad_s,
            ));
        }
        parameters
    }
}

/// Where free joints come to rest: the mean of their last readings; zero where every log is driven.
fn resting_angle(experiments: &[Experiment]) -> f64 {
    let ends: Vec<f64> = experiments
        .iter()
        .filter(|e| !e.is_driven())
        .map(|e| {
            let tail = &e.measured_rad[e.measured_rad.len() - (e.measured_rad.len() / 5).max(1)..];
            tail.iter().sum::<f64>() / tail.len() as f64
        })
        .collect();
    if ends.is_empty() { 0.0 } else { ends.iter().sum::<f64>() / ends.len() as f64 }
}

/// Frequency that relates acceleration to the sine of the angle in free logs.
fn seen_frequency(experiments: &[Experiment], rest_rad: f64) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for e in experiments.iter().filter(|e| !e.is_driven()) {
        for m in motion(&e.t_s, &e.measured_rad, e.uncompared, (e.t_s.len() / 400).max(1)) {
            let sine = math::sin(m.angle_rad - rest_rad);
            product -= m.acceleration_rad_s2 * sine;
            square += sine * sine;
        }
    }
    let squared = product / square;
    if squared.is_finite() && squared > 0.1 { squared.sqrt().min(200.0) } else { TYPICAL_RAD_S }
}
