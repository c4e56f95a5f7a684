//! What a diagnosis says, as plain data: the engine fills it, reports and JSON show it.

use super::body_kind::BodyKind;
use super::hypothesis::logs::LogSet;
use super::on_demand;
use super::search::differs::Differs;
use crate::deadline::{Deadline, Spent};
use crate::identify::{BeliefFound, Directives, Estimate};
use crate::joint::{EffectId, LawTable, LawVariable, Stage};
use serde::Serialize;

/// How to diagnose.
#[derive(Clone, Debug, Default)]
pub struct GapOptions {
    /// Effects that are withheld from the catalogue.
    pub without: Vec<EffectId>,
    /// The only effects that are considered; empty: all, or none where `only_bodies` names any.
    pub only: Vec<EffectId>,
    /// Of a robot with a clamped base what of bodies is withheld.
    pub without_bodies: Vec<BodyKind>,
    /// All of bodies that is considered there; empty: everything, or nothing where `only` names effects.
    pub only_bodies: Vec<BodyKind>,
    /// Twins of the study on which the probabilities are measured; 0: the shipped rates are used.
    pub twins: usize,
    /// Seed of the twins.
    pub seed: u64,
    /// What the user demands of numbers and of parameters of effects, e.g. `inertia` or `delay.T`.
    pub demands: Directives,
    /// Until when causes are looked for.
    pub deadline: Deadline,
}

impl GapOptions {
    /// Whether an effect is asked for: it is not withheld, and one of the only ones where there are such.
    pub(super) fn considers(&self, effect: EffectId) -> bool {
        !self.without.contains(&effect) && (self.only.contains(&effect) || !self.names_alone())
    }

    /// Whether anything is named that alone is considered.
    pub(super) fn names_alone(&self) -> bool {
        !(self.only.is_empty() && self.only_bodies.is_empty())
    }

    /// The sentence of an answer about what bears a name, with what was looked for on demand.
    pub(super) fn told_in(&self, sentence: &str, name: &str) -> String {
        let ids = |effects: &[EffectId], bodies: &[BodyKind]| -> Vec<&'static str> {
            effects.iter().map(|effect| effect.id()).chain(bodies.iter().map(|kind| kind.id())).collect()
        };
        let (without, only) = (ids(&self.without, &self.without_bodies), ids(&self.only, &self.only_bodies));
        on_demand::told_in(sentence, name, &without, &only)
    }
}

/// The kinds of answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// An effect of the catalogue closes the gap.
    Effect,
    /// The model as given explains the logs to their noise.
    None,
    /// The structure is right; one or more of the four numbers are wrong.
    Calibration,
    /// A gap stays that no effect of the catalogue closes.
    Unexplained,
}

impl Verdict {
    /// The word in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Effect => "effect",
            Verdict::None => "none",
            Verdict::Calibration => "calibration",
            Verdict::Unexplained => "unexplained",
        }
    }
}

/// What the residual torque depends on most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Variable {
    /// Joint speed without its sign \[rad/s\].
    Speed,
    /// Sign of the joint speed.
    Direction,
    /// Joint angle \[rad\].
    Angle,
    /// Gravity torque of link and extra mass without its sign \[N m\].
    Load,
    /// Time from the start of the log \[s\].
    Time,
    /// Slope of the setpoint \[rad/s\].
    SetpointRate,
    /// Motor torque \[N m\].
    Torque,
    /// Amplitude of the present half swing \[rad\].
    Amplitude,
}

impl Variable {
    /// The word in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Variable::Speed => "speed",
            Variable::Direction => "direction",
            Variable::Angle => "angle",
            Variable::Load => "load",
            Variable::Time => "time",
            Variable::SetpointRate => "setpoint_rate",
            Variable::Torque => "torque",
            Variable::Amplitude => "amplitude",
        }
    }

    /// Its unit; empty for a direction.
    pub fn unit(self) -> &'static str {
        match self {
            Variable::Speed | Variable::SetpointRate => "rad/s",
            Variable::Direction => "",
            Variable::Angle | Variable::Amplitude => "rad",
            Variable::Load | Variable::Torque => "N m",
            Variable::Time => "s",
        }
    }
}

/// The variable of a law as one that a gap may depend on.
impl From<LawVariable> for Variable {
    fn from(law: LawVariable) -> Self {
        match law {
            LawVariable::Angle => Variable::Angle,
            LawVariable::Speed => Variable::Speed,
            LawVariable::Load => Variable::Load,
            LawVariable::MotorTorque => Variable::Torque,
            LawVariable::Time => Variable::Time,
            LawVariable::SetpointRate => Variable::SetpointRate,
        }
    }
}

/// What the joint is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Held by the experimenter, or driven to stand still.
    Hold,
    /// At rest under friction.
    Stick,
    /// Within 100 ms of a change of direction.
    Reversal,
    /// Moving.
    Run,
    /// Moving with the motor near the largest torque of the log.
    Saturation,
    /// At a stop.
    Stop,
}

impl Phase {
    /// All of them, in the order in which they are shown.
    pub const ALL: [Phase; 6] =
        [Phase::Hold, Phase::Stick, Phase::Reversal, Phase::Run, Phase::Saturation, Phase::Stop];

    /// The word in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Hold => "hold",
            Phase::Stick => "stick",
            Phase::Reversal => "reversal",
            Phase::Run => "run",
            Phase::Saturation => "saturation",
            Phase::Stop => "stop",
        }
    }
}

/// A number with unit and 95 % intervals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Number {
    /// The catalogue's name, e.g. `mu_st`.
    pub name: String,
    /// The estimate.
    pub value: f64,
    /// Its unit.
    pub unit: String,
    /// 95 %, allowing for correlated residuals; `None` where the logs do not determine it.
    pub interval: Option<[f64; 2]>,
    /// 95 %, as if residuals were white.
    pub interval_naive: Option<[f64; 2]>,
}

/// The answer in short.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// Which kind.
    pub verdict: Verdict,
    /// The effect's id; for [`Verdict::Calibration`] the parameter that accounts for most.
    pub effect: Option<String>,
    /// A further effect that was found after the first.
    pub second: Option<EffectId>,
    /// Effects that these logs cannot tell apart from the answer, the answer included, best first; empty where no
    /// effect is named.
    pub equivalent: Vec<EffectId>,
    /// The measured rate at which an answer like this was right; `None` where the search was not finished.
    pub probability: Option<f64>,
    /// Where `probability` was measured: a command, and counts; or why there is none.
    pub probability_source: String,
    /// The kind of answer and how clearly it stands, in words that are counted.
    pub standing: String,
    /// One sentence a colleague would say.
    pub sentence: String,
    /// For [`Verdict::Unexplained`]: the effect that closes most of the gap.
    pub partial: Option<EffectId>,
    /// Whether intervals of parameters are to be trusted: nothing is left that the model does not explain.
    pub intervals_trusted: bool,
}

/// One cause of the answer, in the order of the waterfall.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CauseShare {
    /// Which family of effects.
    pub effect: EffectId,
    /// The form in which it was found; empty where the family has only one.
    pub form: &'static str,
    /// The logs in which it holds; `None`: all.
    pub only: Option<LogSet>,
    /// Effects that these logs cannot tell apart from it in the presence of the others, itself included, best first.
    pub equivalent: Vec<EffectId>,
    /// Its parameters.
    pub parameters: Vec<Number>,
    /// Share of what recalibration leaves that it closes alone, on the held-out logs.
    pub alone: Option<f64>,
    /// The same of it with all other causes in place.
    pub last: Option<f64>,
    /// RMS over the held-out logs when it is added to those before it \[rad\].
    pub after: f64,
}

/// Where the gap lies.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Where {
    /// The stage of the chain; `None` where there is no gap.
    pub stage: Option<Stage>,
    /// What the residual torque depends on most.
    pub variable: Option<Variable>,
    /// Between which values of the variable most of it lies, in the variable's unit.
    pub range: Option<[f64; 2]>,
    /// The phase with most of it.
    pub phase: Option<Phase>,
    /// Logs that have more than their share of it, most first.
    pub logs: Vec<String>,
    /// Share of the gap in that range \[0 to 1\].
    pub share: f64,
    /// Share of the gap by log and phase, for the map.
    pub cells: Vec<MapCell>,
    /// Share of the residual torque's variance that each variable explains \[0 to 1\], best first.
    pub variables: Vec<(Variable, f64)>,
    /// The residual torque against the best variable, binned.
    pub profile: Vec<ProfileBin>,
}

impl Where {
    /// The variable by which the gap is placed, of which the profile is; the one that explains most where none is named.
    pub fn by(&self) -> Option<Variable> {
        self.variable.or_else(|| self.variables.first().map(|(variable, _)| *variable))
    }
}

/// One cell of the map: a log in a phase.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapCell {
    /// The log.
    pub file: String,
    /// What the joint was doing.
    pub phase: Phase,
    /// Seconds in this phase.
    pub time_s: f64,
    /// Share of the whole gap's energy \[0 to 1\].
    pub share: f64,
    /// RMS of the residual torque there \[N m\].
    pub torque_rms_nm: f64,
    /// 95 % band of that RMS by blocks \[N m\].
    pub band_nm: [f64; 2],
    /// The band lies above what noise alone gives, also when all cells are looked at (Benjamini-Hochberg, 5 %).
    pub significant: bool,
}

/// The residual torque in one bin of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProfileBin {
    /// Middle of the bin, in the variable's unit.
    pub at: f64,
    /// Mean residual torque \[N m\]; friction-like variables count it against the motion.
    pub torque_nm: f64,
    /// 95 % band of the mean \[N m\].
    pub band_nm: [f64; 2],
}

/// How far the gap closes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// Always `rad`.
    pub unit: &'static str,
    /// RMS over the held-out logs with the study's values as given.
    pub before: f64,
    /// After refitting inertia, moment, coulomb and viscous.
    pub calibrated: f64,
    /// With the first effect of the answer.
    pub after_first: f64,
    /// With every effect of the answer.
    pub after: f64,
    /// The sensor's own noise.
    pub floor: f64,
    /// `1 - (after - floor) / (before - floor)`; `None` where `before <= floor`.
    pub closed: Option<f64>,
    /// 95 % interval of `closed`.
    pub closed_interval: Option<[f64; 2]>,
    /// Whether the figures come from logs on which no choice was made.
    pub outer: bool,
    /// How the logs were held out, in words.
    pub held_out: String,
    /// One for each held-out log.
    pub per_log: Vec<LogGap>,
}

/// How logs were held out that were not.
pub(crate) const NOT_HELD_OUT: &str =
    "not at all; these logs were fitted with the others, which do not show by themselves what all logs do";

/// How parts of a log were held out that stands alone.
pub(crate) const PARTS_IN_TURN: &str = "each part of the only log predicted by a fit to its other parts";

/// How logs were held out of which the study holds none out, or none that shows the joint moving.
pub(crate) const LOGS_IN_TURN: &str = "each log predicted by a fit to all others";

impl Gap {
    /// Whether its figures are of fitted logs, or parts of the only one, each predicted by the others.
    pub(crate) fn is_in_turn(&self) -> bool {
        self.is_of_parts() || self.held_out == LOGS_IN_TURN
    }

    /// Whether its figures are of parts of the only log, each predicted by the others.
    pub(crate) fn is_of_parts(&self) -> bool {
        self.held_out == PARTS_IN_TURN
    }

    /// Whether the logs of its figures were held out: else they were fitted with the others.
    pub fn is_held_out(&self) -> bool {
        self.held_out != NOT_HELD_OUT
    }
}

/// The gap of one held-out log \[rad RMS\].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogGap {
    /// As the user named it.
    pub file: String,
    /// As given.
    pub before: f64,
    /// Recalibrated.
    pub calibrated: f64,
    /// With the effects of the answer.
    pub after: f64,
    /// The sensor's own noise.
    pub floor: f64,
}

/// One candidate of the ranking.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// Which effect.
    pub effect: EffectId,
    /// Measured rate at which a candidate that stood like this one was the cause.
    pub probability: f64,
    /// RMS over the held-out logs with it added \[rad\].
    pub after: f64,
    /// Share of the gap that it closes.
    pub closed: Option<f64>,
    /// How much worse than the best it explains all logs, in units of the standard deviation of that difference; 0 for
    /// the best.
    pub behind_sd: f64,
    /// The effect's parameters.
    pub parameters: Vec<Number>,
    /// Refitted in full, or judged by the screening alone.
    pub refitted: bool,
}

/// A cause without a name: a curve that predicts logs to which it was not fitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LawFound {
    /// Its curve, what it acts on, the share of what recalibration leaves that it closes behind the causes, and what it
    /// looks like.
    pub table: LawTable,
    /// Standard deviations of the curve at its knots, in its unit; `None` where the logs do not determine them.
    pub sd: Option<Vec<f64>>,
    /// RMS over the held-out logs when it is added \[rad\].
    pub after: f64,
}

/// The smallest size of an effect that these logs would have shown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Detectable {
    /// Which effect.
    pub effect: EffectId,
    /// Its size, of the parameter `name`; `None`: these logs cannot show it at all.
    pub value: Option<f64>,
    /// Which parameter measures the size.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
}

/// The experiment that would separate effects that these logs cannot tell apart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Next {
    /// In words.
    pub what: String,
    /// Probability that it separates them.
    pub power: f64,
    /// The motion: times \[s\] and setpoints \[rad\]; `None` for a free swing.
    pub motion: Option<(Vec<f64>, Vec<f64>)>,
}

/// How often answers were right on twins: rows are true causes, columns are answers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Confusion {
    /// Names of rows and columns: effect ids, `none`, `calibration`, `unexplained`.
    pub names: Vec<String>,
    /// `counts[row][column]`
    pub counts: Vec<Vec<u32>>,
    /// The command that made it.
    pub command: String,
}

/// Curves of one log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogTraces {
    /// As the user named it.
    pub file: String,
    /// `fit` or `validate`.
    pub role: String,
    /// Compared samples \[s\].
    pub t_s: Vec<f64>,
    /// Readings \[rad\].
    pub measured_rad: Vec<f64>,
    /// Setpoint of a log driven by position \[rad\].
    pub setpoint_rad: Option<Vec<f64>>,
    /// Prediction with the study's values as given \[rad\].
    pub before_rad: Vec<f64>,
    /// Recalibrated \[rad\].
    pub calibrated_rad: Vec<f64>,
    /// With the effects of the answer, or of the best partial candidate \[rad\].
    pub after_rad: Vec<f64>,
    /// The torque that the recalibrated model lacks.
    pub residual_torque: ResidualTorque,
}

/// The torque that a model lacks along a log, as an input of the joint, with its uncertainty.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ResidualTorque {
    /// Instants, as the log's compared samples \[s\].
    pub t_s: Vec<f64>,
    /// \[N m\]; NaN while the joint sticks, where any torque within the breakaway is possible.
    pub torque_nm: Vec<f64>,
    /// Standard deviation \[N m\].
    pub sigma_nm: Vec<f64>,
    /// Joint angle by the smoother \[rad\].
    pub angle_rad: Vec<f64>,
    /// Joint speed by the smoother \[rad/s\].
    pub rate_rad_s: Vec<f64>,
    /// What the joint is doing.
    pub phase: Vec<Phase>,
}

/// A diagnosis.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// The joint's name.
    pub joint: String,
    /// The answer in short.
    pub answer: Answer,
    /// Where the gap lies.
    pub location: Where,
    /// How far it closes.
    pub gap: Gap,
    /// Candidates, best first.
    pub ranking: Vec<Candidate>,
    /// One for each effect of the catalogue that was considered.
    pub detectable: Vec<Detectable>,
    /// Inertia, moment, Coulomb and viscous friction with the effects of the answer, fitted to all fit logs, and the rest
    /// angle with which they were.
    pub parameters: Vec<Estimate>,
    /// The same of the effects of the answer.
    pub effect_parameters: Vec<(EffectId, Vec<Number>)>,
    /// Every cause that was found, in the order of the waterfall, whatever the verdict.
    pub causes: Vec<CauseShare>,
    /// The numbers that are not exact.
    pub beliefs: Vec<BeliefFound>,
    /// What the causes leave and no name explains, as a measured curve.
    pub law: Option<LawFound>,
    /// Numbers that are not the same in all logs; looked for where one set of numbers leaves much.
    pub differs: Vec<Differs>,
    /// What these logs cannot determine and what would, in sentences.
    pub undetermined: Vec<String>,
    /// What to do next where effects cannot be told apart.
    pub next: Option<Next>,
    /// Table of the twins, where there were any.
    pub confusion: Option<Confusion>,
    /// Curves of every log that moves.
    pub traces: Vec<LogTraces>,
    /// What is to be questioned of the study, in sentences: what [`Case::doubts`](crate::identify::Case::doubts) says, and
    /// what shows in what was found.
    pub doubts: Vec<String>,
    /// Honest remarks, most important first.
    pub notes: Vec<String>,
    /// Effects that were withheld from the catalogue.
    pub withheld: Vec<EffectId>,
    /// What was demanded, parameters of effects with the effect's id before them.
    pub demands: Directives,
    /// What became of its time, where that was limited.
    pub budget: Option<Spent>,
}

impl Diagnosis {
    /// Whether the answer is that this number is another.
    pub fn names(&self, belief: &BeliefFound) -> bool {
        self.answer.verdict == Verdict::Calibration && self.answer.effect.as_ref() == Some(&belief.name)
    }

    /// Every effect that the answer names, in the order of the waterfall; empty where it names none.
    pub fn causes(&self) -> Vec<EffectId> {
        match self.answer.verdict {
            Verdict::Effect => self.effect_parameters.iter().map(|(effect, _)| *effect).collect(),
            _ => Vec::new(),
        }
    }
}
