//! One answer against one truth.

use super::Trial;
use crate::blind::answer::Answered;
use crate::blind::truth::Truth;
use crate::gap::Verdict;
use crate::joint::EffectId;
use serde::Serialize;

/// What is right about an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Judgement {
    /// The kind of answer is right.
    pub verdict: bool,
    /// The whole answer is right: the kind, and of effects exactly those that are there, in any order.
    pub top: bool,
    /// As `top`, or every effect that is there is among those that the answer could not tell apart or names.
    pub set: bool,
    /// At least one of the effects that are there is named; `None` where there is none.
    pub any: Option<bool>,
    /// The stage is right, of two effects either's; `None` where there is no stage.
    pub stage: Option<bool>,
    /// An effect, or something unexplained, was seen where there is nothing; `None` where there is something.
    pub false_alarm: Option<bool>,
    /// Something was taken for nothing or for wrong numbers; `None` where there is nothing.
    pub missed: Option<bool>,
}

impl Judgement {
    /// Judges a trial; a diagnosis that failed is wrong in everything, but no false alarm.
    pub fn of(trial: &Trial) -> Self {
        let truth = &trial.truth;
        let nothing = matches!(truth.verdict, Verdict::None | Verdict::Calibration);
        let there = truth.effects();
        let Ok(answer) = &trial.answer else {
            return Self {
                verdict: false,
                top: false,
                set: false,
                any: (!there.is_empty()).then_some(false),
                stage: truth.stage.map(|_| false),
                false_alarm: nothing.then_some(false),
                missed: (!nothing).then_some(true),
            };
        };
        let verdict = answer.verdict == truth.verdict;
        let named = answer.named();
        let mut sorted = [named.clone(), there.clone()];
        sorted.iter_mut().for_each(|list| list.sort_unstable());
        let calls_something = matches!(answer.verdict, Verdict::Effect | Verdict::Unexplained);
        Self {
            verdict,
            top: verdict && sorted[0] == sorted[1],
            set: verdict && (sorted[0] == sorted[1] || in_set(answer, &there)),
            any: (!there.is_empty()).then(|| there.iter().any(|effect| named.contains(effect))),
            stage: truth.stage.map(|_| truth.mechanisms.iter().any(|m| Some(m.stage) == answer.stage)),
            false_alarm: nothing.then_some(calls_something),
            missed: (!nothing).then_some(!calls_something),
        }
    }
}

/// Every effect that is there is named or could not be told apart, and no more are named than are there.
fn in_set(answer: &Answered, there: &[&str]) -> bool {
    let named = answer.named();
    let known = |effect: &&str| named.contains(effect) || answer.equivalent.iter().any(|e| e.id() == *effect);
    !there.is_empty() && named.len() <= there.len() && there.iter().all(known)
}

impl Truth {
    /// The effects of the catalogue that are there.
    pub fn effects(&self) -> Vec<&'static str> {
        if self.verdict != Verdict::Effect {
            return Vec::new();
        }
        self.effect.into_iter().chain(self.second.map(EffectId::id)).collect()
    }
}
