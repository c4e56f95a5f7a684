//! One answer against one truth.

use super::Trial;
use crate::blind::answer::Answered;
use crate::blind::truth::TrueWhere;
use crate::gap::Verdict;
use crate::joint::EffectId;
use serde::Serialize;

/// What is right about an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Judgement {
    /// The kind of answer is right; where numbers are off within what the study states, also to have refitted them, and
    /// where `kp` is off further, also to name the motor's gain.
    pub verdict: bool,
    /// The whole answer is right: the kind, and of effects exactly those that are there, in any order.
    pub top: bool,
    /// As `top`, or every effect that is there is among those that the answer could not tell apart or names.
    pub set: bool,
    /// Every effect that is there is named, whatever else is; `None` where there is none.
    pub all: Option<bool>,
    /// At least half of the effects that are there are named; `None` where there is none.
    pub half: Option<bool>,
    /// At least one of the effects that are there is named; `None` where there is none.
    pub any: Option<bool>,
    /// Effects that are named and not there, not even too small to be asked for.
    pub needless: u32,
    /// The stage is right, of several effects any's; `None` where there is no stage.
    pub stage: Option<bool>,
    /// Stage and variable of a cause outside the catalogue are right, and where it acts in a range only, that is met;
    /// `None` where there is no such cause.
    pub located: Option<bool>,
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
        let of_effects = |is: bool| (!there.is_empty()).then_some(is);
        let Ok(answer) = &trial.answer else {
            return Self {
                verdict: false,
                top: false,
                set: false,
                all: of_effects(false),
                half: of_effects(false),
                any: of_effects(false),
                needless: 0,
                stage: truth.stage.map(|_| false),
                located: truth.location.as_ref().map(|_| false),
                false_alarm: nothing.then_some(false),
                missed: (!nothing).then_some(true),
            };
        };
        let named = answer.named();
        let gain = EffectId::MotorGain.id();
        // A kp that is off further than the study states is a motor that delivers more or less than commanded.
        let is_gain = truth.verdict == Verdict::Calibration && truth.has_wrong_gain() && named == [gain];
        let verdict =
            answer.verdict == truth.verdict || is_gain || (truth.within && answer.verdict == Verdict::Calibration);
        let right = there.iter().filter(|effect| named.contains(effect)).count();
        let small = |id: &str| truth.mechanisms.iter().any(|m| !m.counts && m.id == id);
        let is_number = |id: &str| id == gain && truth.has_wrong_gain();
        let needless = named.iter().filter(|id| !there.contains(id) && !small(id) && !is_number(id)).count() as u32;
        let top = verdict && right == there.len() && needless == 0;
        let calls_something = matches!(answer.verdict, Verdict::Effect | Verdict::Unexplained);
        Self {
            verdict,
            top,
            set: top || (verdict && in_set(answer, &there)),
            all: of_effects(right == there.len()),
            half: of_effects(2 * right >= there.len()),
            any: of_effects(right > 0),
            needless,
            stage: truth.stage.map(|_| truth.mechanisms.iter().any(|m| m.counts && Some(m.stage) == answer.stage)),
            located: truth.location.as_ref().map(|place| is_located(answer, place)),
            false_alarm: nothing.then_some(calls_something && !is_gain),
            missed: (!nothing).then_some(!calls_something),
        }
    }
}

/// Every effect that is there is named or could not be told apart, and no more are named than are there.
fn in_set(answer: &Answered, there: &[&str]) -> bool {
    let named = answer.named();
    let all = || answer.equivalent.iter().chain(answer.effects.iter().flat_map(|e| &e.equivalent));
    let known = |effect: &&str| named.contains(effect) || all().any(|e| e.id() == *effect);
    !there.is_empty() && named.len() <= there.len() && there.iter().all(known)
}

fn is_located(answer: &Answered, place: &TrueWhere) -> bool {
    let variable = answer.variable.is_some_and(|variable| place.variables.contains(&variable));
    let meets = match (place.range, answer.range) {
        (Some([from, to]), Some([low, high])) if place.variables.first() == answer.variable.as_ref() => {
            low <= to && from <= high
        }
        (Some(_), None) => false,
        _ => true,
    };
    answer.stage == Some(place.stage) && variable && meets
}
