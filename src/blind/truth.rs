//! The sealed answer of a made study.

use super::cause::OutsideId;
use super::joint::Family;
use super::sensor::{Noise, Stamps};
use crate::gap::{Variable, Verdict};
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
    /// It shows, and is asked for; what is there but too small is neither.
    pub counts: bool,
    /// Stage of the chain on which it sits.
    pub stage: Stage,
    /// Its numbers; for effects by the catalogue's names, for variants as near as they come.
    pub parameters: Vec<TrueNumber>,
    /// RMS angle by which the logs would differ without it, over the standard deviation of a reading.
    pub ratio: f64,
    /// What of that is left when inertia, moment, frictions and starts, and sizes of the other mechanisms, are adapted
    /// to it, to first order.
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

/// Gains of a position drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gains {
    /// \[N m/rad\]
    pub kp: f64,
    /// \[N m s/rad\]
    pub kd: f64,
}

impl Gains {
    /// Their names, in order.
    pub const NAMES: [&'static str; 2] = ["kp", "kd"];

    /// What answers call the shares of stated gains: torque that arrives per torque that they ask for, and the
    /// derivative gain's share beside that.
    pub const SHARES: [&'static str; 2] = ["gain", "kd"];

    /// As a list, in that order.
    pub fn list(&self) -> [f64; 2] {
        [self.kp, self.kd]
    }

    /// Shares of stated gains, in the order of [`Gains::SHARES`].
    fn shares_of(self, stated: Self) -> [f64; 2] {
        let gain = self.kp / stated.kp;
        [gain, self.kd / stated.kd / gain]
    }
}

/// Relative standard deviations of what the study states.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Believed {
    /// Of the inertia.
    pub inertia: f64,
    /// Of the moment.
    pub moment: f64,
    /// Of Coulomb and viscous friction.
    pub friction: f64,
    /// Of `kp` and `kd`.
    pub gain: f64,
    /// The study says so itself; else they are the defaults of `[uncertain]`.
    pub written: bool,
}

/// Where a mechanism outside the catalogue sits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrueWhere {
    /// Stage of the chain.
    pub stage: Stage,
    /// What it depends on: each of these is a right answer.
    pub variables: &'static [Variable],
    /// Between which values of the first of them it acts, in its unit; `None`: everywhere.
    pub range: Option<[f64; 2]>,
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
    /// Effects that are there and show, in no order.
    pub causes: Vec<EffectId>,
    /// The whole is a servo.
    pub servo: bool,
    /// Numbers that are off by more than three of the standard deviations that the study states; without effects the
    /// one that accounts for most comes first.
    pub numbers: Vec<&'static str>,
    /// Nothing is wrong, but numbers are off within what the study states: to refit them is no mistake.
    pub within: bool,
    /// The mechanism outside the catalogue.
    pub outside: Option<OutsideId>,
    /// Where that sits.
    pub location: Option<TrueWhere>,
    /// The stage on which the cause sits: of several, the first's.
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
    /// The drive's gains as they are; `None` where nothing drives.
    pub gains: Option<Gains>,
    /// The drive's gains as the study states them.
    pub nominal_gains: Option<Gains>,
    /// How sure the study is.
    pub believed: Believed,
    /// What kind of joint.
    pub family: Family,
    /// By the catalogue's definitions, to the letter.
    pub textbook: bool,
    /// Noise of the readings.
    pub noise: Noise,
    /// How samples are stamped.
    pub stamps: Stamps,
    /// Stretches of 4 to 30 periods without samples.
    pub holes: usize,
    /// Standard deviation of a reading, with what wrong stamps add to it \[rad\].
    pub noise_rad: f64,
    /// Free logs.
    pub free_logs: usize,
    /// Driven logs.
    pub driven_logs: usize,
    /// Logs with an extra mass.
    pub loaded_logs: usize,
}

impl Truth {
    /// Ids of the effects of the catalogue that are there and show.
    pub fn effects(&self) -> Vec<&'static str> {
        self.causes.iter().map(|effect| effect.id()).collect()
    }

    /// Whether the study states a `kp` that is off further than it believes.
    pub(super) fn has_wrong_gain(&self) -> bool {
        self.numbers.contains(&Gains::NAMES[0])
    }

    /// True value of a joint's number, or of a share of a drive's stated gain, under the names of an answer.
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        let delivered = self.mechanisms.iter().filter(|m| m.id == EffectId::MotorGain.id()).flat_map(|m| &m.parameters);
        let delivered: f64 = delivered.map(|c| c.value).product();
        let shares = self.gains.zip(self.nominal_gains).map(|(gains, nominal)| gains.shares_of(nominal));
        let shares = shares.map(|[gain, derivative]| [gain * delivered, derivative]);
        let shares = shares.into_iter().flat_map(|shares| Gains::SHARES.into_iter().zip(shares));
        let numbers = FourNumbers::NAMES.into_iter().zip(self.joint.list());
        numbers.chain(shares).find(|(known, _)| *known == name).map(|(_, value)| value)
    }
}
