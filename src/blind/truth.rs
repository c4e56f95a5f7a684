//! The sealed answer of a made study.

use super::cause::OutsideId;
use super::joint::Family;
use crate::gap::Verdict;
use crate::joint::{EffectId, Stage};
use serde::Serialize;

/// A number that the maker has put in.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrueNumber {
    /// The catalogue's name, e.g. `mu_st`.
    pub name: &'static str,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
}

impl TrueNumber {
    pub(super) fn new(name: &'static str, unit: &'static str, value: f64) -> Self {
        Self { name, unit, value }
    }
}

/// One mechanism with its numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrueMechanism {
    /// Id of an effect or of a mechanism outside the catalogue.
    pub id: &'static str,
    /// Stage of the chain on which it sits.
    pub stage: Stage,
    /// Its numbers; for effects by the catalogue's names, for variants as near as they come.
    pub parameters: Vec<TrueNumber>,
    /// RMS angle that it changes in the logs, over the standard deviation of a reading.
    pub ratio: f64,
    /// What of that is left when inertia, moment, frictions and starts are adapted to it, to first order.
    pub left: f64,
}

/// The four numbers of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FourNumbers {
    /// `I*` \[kg m^2\]
    pub inertia: f64,
    /// `M*` \[kg m\]
    pub moment: f64,
    /// \[N m\]
    pub coulomb: f64,
    /// \[N m s/rad\]
    pub viscous: f64,
}

impl FourNumbers {
    /// Their names, in order.
    pub const NAMES: [&'static str; 4] = ["inertia", "moment", "coulomb", "viscous"];

    /// As a list, in that order.
    pub fn list(&self) -> [f64; 4] {
        [self.inertia, self.moment, self.coulomb, self.viscous]
    }

    pub(super) fn of(list: [f64; 4]) -> Self {
        let [inertia, moment, coulomb, viscous] = list;
        Self { inertia, moment, coulomb, viscous }
    }
}

/// The effect of the catalogue that imitates another mechanism best.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Nearest {
    /// Which.
    pub effect: EffectId,
    /// RMS angle that it leaves when numbers, starts and the effect are adapted, over the standard deviation of a
    /// reading.
    pub left: f64,
}

/// What is true of a made study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Truth {
    /// Seed of the run.
    pub seed: u64,
    /// Which study of the run.
    pub trial: u64,
    /// The right kind of answer.
    pub verdict: Verdict,
    /// The effect; for wrong numbers only the one that accounts for most.
    pub effect: Option<&'static str>,
    /// The second effect of a pair.
    pub second: Option<EffectId>,
    /// The mechanism outside the catalogue.
    pub outside: Option<OutsideId>,
    /// The stage on which the cause sits: of a pair, the first's.
    pub stage: Option<Stage>,
    /// Everything that was put in.
    pub mechanisms: Vec<TrueMechanism>,
    /// RMS angle that the whole cause changes in the logs, over the standard deviation of a reading.
    pub ratio: f64,
    /// What of that is left when inertia, moment, frictions and starts are adapted to it, to first order.
    pub left: f64,
    /// The effect of the catalogue that imitates a mechanism outside it best, and what is left then, to first order.
    pub nearest: Option<Nearest>,
    /// The joint as it is.
    pub joint: FourNumbers,
    /// The joint as the study states it.
    pub nominal: FourNumbers,
    /// What kind of joint.
    pub family: Family,
    /// By the catalogue's definitions, to the letter.
    pub textbook: bool,
    /// Standard deviation of a reading \[rad\].
    pub noise_rad: f64,
    /// Free logs.
    pub free_logs: usize,
    /// Driven logs.
    pub driven_logs: usize,
    /// Logs with an extra mass.
    pub loaded_logs: usize,
}
