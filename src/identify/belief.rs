//! What an engineer believes of a joint's numbers, and what became of it.

use super::{Parameter, Search};
use crate::log::{Nominal, Uncertain};
use serde::{Deserialize, Serialize};

/// Standard deviations of what is believed of a joint's four numbers: relative for inertia and moment, in their units for
/// what may be zero.
pub(crate) struct Deviations {
    pub inertia: f64,
    /// Relative where there is a moment, else \[kg m\].
    pub moment: f64,
    pub coulomb_nm: f64,
    pub viscous_nm_s_rad: f64,
}

impl Deviations {
    /// Friction is not known better than to this share of the largest torque seen.
    pub const LEAST_FRICTION: f64 = 0.01;

    /// Of friction that is known to a share of its value, but not better than `least`; 0 where it is exact.
    pub fn of_friction(share: f64, value: f64, least: f64) -> f64 {
        if share == 0.0 { 0.0 } else { (share * value).max(least) }
    }

    /// By the study; `largest_nm` is the largest torque of its logs, `speed_rad_s` a typical speed and `moment_kg_m` the
    /// moment that would matter where there is none.
    pub fn of(nominal: &Nominal, uncertain: &Uncertain, largest_nm: f64, speed_rad_s: f64, moment_kg_m: f64) -> Self {
        let friction =
            |name: &str, value: f64, least: f64| Self::of_friction(uncertain.friction.of(name), value, least);
        let least_nm = Self::LEAST_FRICTION * largest_nm;
        let moment = uncertain.moment.of("moment");
        Self {
            inertia: uncertain.inertia.of("inertia"),
            moment: if nominal.moment_kg_m > 0.0 { moment } else { moment * moment_kg_m },
            coulomb_nm: friction("coulomb", nominal.coulomb_nm, least_nm),
            viscous_nm_s_rad: friction("viscous", nominal.viscous_nm_s_rad, least_nm / speed_rad_s),
        }
    }
}

/// A number that was moved by more standard deviations of its belief is a finding.
pub(super) const FINDING_SD: f64 = 3.0;

/// What was believed of a number, and what the logs made of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BeliefFound {
    /// Which number.
    #[serde(default)]
    pub name: String,
    /// As the study states it.
    pub believed: f64,
    /// Standard deviation of that, in its unit.
    pub sd: f64,
    /// As found, with the causes of the answer in place.
    pub found: f64,
    /// By how many of its standard deviations it was moved.
    pub moved_sd: f64,
    /// Its unit.
    pub unit: String,
}

impl BeliefFound {
    /// What was believed of each of these parameters that is searched, and where a fit has it.
    pub fn of(parameters: &[Parameter], values: &[f64]) -> Vec<Self> {
        let searched = parameters.iter().zip(values).filter(|(p, _)| !p.fixed);
        let found = |(p, &found): (&Parameter, &f64)| {
            let (belief, believed) = (p.belief?, p.nominal?);
            let sd = match p.search {
                Search::Logarithm => belief.sd * believed,
                Search::Linear { .. } => belief.sd,
            };
            let moved_sd = p.moved_sd(found)?;
            Some(Self { name: p.name.clone(), believed, sd, found, moved_sd, unit: p.unit.clone() })
        };
        searched.filter_map(found).collect()
    }

    /// Whether it was moved further than belief allows.
    #[must_use]
    pub fn is_finding(&self) -> bool {
        self.moved_sd.abs() > FINDING_SD
    }
}
