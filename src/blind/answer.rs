//! What a diagnosis answered, as plain data to be scored.

use crate::gap::{Diagnosis, Gap, Number, Variable, Verdict};
use crate::joint::{EffectId, Stage};
use serde::Serialize;

/// A number that a diagnosis states.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatedNumber {
    /// The catalogue's name, or that of one of the four numbers.
    pub name: String,
    /// The estimate.
    pub value: f64,
    /// 95 %, allowing for correlated residuals.
    pub interval: Option<[f64; 2]>,
    /// 95 %, as if residuals were white.
    pub interval_naive: Option<[f64; 2]>,
}

impl StatedNumber {
    pub(super) fn of(number: &Number) -> Self {
        Self {
            name: number.name.clone(),
            value: number.value,
            interval: number.interval,
            interval_naive: number.interval_naive,
        }
    }
}

/// An effect of the answer with its numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatedEffect {
    /// Which.
    pub effect: EffectId,
    /// Effects that would do as well in its place, itself included; empty where that was not asked.
    pub equivalent: Vec<EffectId>,
    /// Its parameters.
    pub parameters: Vec<StatedNumber>,
}

/// A place in the ranking.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ranked {
    /// Which effect.
    pub effect: EffectId,
    /// The stated probability that it is the cause.
    pub probability: f64,
    /// How much worse than the best it explains the logs, in standard deviations of that difference.
    pub behind_sd: f64,
    /// RMS over the held-out logs with it \[rad\].
    pub after: f64,
}

/// RMS angle errors over the held-out logs \[rad\], as the diagnosis states them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GapNumbers {
    /// As given.
    pub before: f64,
    /// Recalibrated.
    pub calibrated: f64,
    /// With the first effect.
    pub after_first: f64,
    /// With all effects of the answer.
    pub after: f64,
    /// The sensor's own noise.
    pub floor: f64,
    /// Share of the gap that is closed.
    pub closed: Option<f64>,
    /// 95 % interval of that.
    pub closed_interval: Option<[f64; 2]>,
}

impl GapNumbers {
    fn of(gap: &Gap) -> Self {
        Self {
            before: gap.before,
            calibrated: gap.calibrated,
            after_first: gap.after_first,
            after: gap.after,
            floor: gap.floor,
            closed: gap.closed,
            closed_interval: gap.closed_interval,
        }
    }
}

/// What a diagnosis answered.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answered {
    /// Which kind.
    pub verdict: Verdict,
    /// The effect; for wrong numbers the one that accounts for most.
    pub effect: Option<String>,
    /// Every effect that the answer names, in its order; none unless the verdict is an effect.
    pub causes: Vec<EffectId>,
    /// Effects that cannot be told apart from the answer, the answer included.
    pub equivalent: Vec<EffectId>,
    /// The stated probability that the answer is right.
    pub probability: f64,
    /// How clearly the answer stands, in the words under which rates are counted.
    pub standing: String,
    /// The effect that closes most of an unexplained gap.
    pub partial: Option<EffectId>,
    /// Whether the intervals are meant to be trusted.
    pub intervals_trusted: bool,
    /// Where the gap was placed.
    pub stage: Option<Stage>,
    /// What it depends on most.
    pub variable: Option<Variable>,
    /// Between which values of that most of it lies, in the variable's unit.
    pub range: Option<[f64; 2]>,
    /// How large it is and how far it closes.
    pub gap: GapNumbers,
    /// The best candidates, five at the most.
    pub ranking: Vec<Ranked>,
    /// Effects of the answer with their parameters.
    pub effects: Vec<StatedEffect>,
    /// Inertia, moment, Coulomb and viscous friction.
    pub joint: Vec<StatedNumber>,
}

/// Candidates of a ranking that are kept.
const KEPT: usize = 5;

impl Answered {
    /// Takes from a diagnosis what is scored.
    pub fn of(diagnosis: &Diagnosis) -> Self {
        let answer = &diagnosis.answer;
        let ranked = |c: &crate::gap::Candidate| Ranked {
            effect: c.effect,
            probability: c.probability,
            behind_sd: c.behind_sd,
            after: c.after,
        };
        let equivalent = |effect: EffectId| {
            let cause = diagnosis.causes.iter().find(|cause| cause.effect == effect);
            cause.map_or_else(Vec::new, |cause| cause.equivalent.clone())
        };
        Self {
            verdict: answer.verdict,
            effect: answer.effect.clone(),
            causes: diagnosis.causes(),
            equivalent: answer.equivalent.clone(),
            // Exams search to the end.
            probability: answer.probability.unwrap_or_default(),
            standing: answer.standing.clone(),
            partial: answer.partial,
            intervals_trusted: answer.intervals_trusted,
            stage: diagnosis.location.stage,
            variable: diagnosis.location.variable,
            range: diagnosis.location.range,
            gap: GapNumbers::of(&diagnosis.gap),
            ranking: diagnosis.ranking.iter().take(KEPT).map(ranked).collect(),
            effects: diagnosis
                .effect_parameters
                .iter()
                .map(|(effect, numbers)| StatedEffect {
                    effect: *effect,
                    equivalent: equivalent(*effect),
                    parameters: numbers.iter().map(StatedNumber::of).collect(),
                })
                .collect(),
            joint: diagnosis
                .parameters
                .iter()
                .map(|estimate| StatedNumber {
                    name: estimate.name.clone(),
                    value: estimate.value,
                    interval: estimate.interval,
                    interval_naive: estimate.interval_naive,
                })
                .collect(),
        }
    }

    /// Ids of the effects named, in their order; none unless the verdict is an effect.
    pub fn named(&self) -> Vec<&'static str> {
        self.causes.iter().map(|effect| effect.id()).collect()
    }
}
