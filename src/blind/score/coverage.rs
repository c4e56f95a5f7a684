//! How often stated intervals cover the truth.

use super::Trial;
use super::judge::Judgement;
use super::rate::Rate;
use crate::blind::answer::{Answered, StatedNumber};
use crate::blind::truth::{FourNumbers, Gains, Truth};
use serde::Serialize;
use std::collections::BTreeMap;

/// How often 95 % intervals of a number cover its true value, where the answer is right.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coverage {
    /// Name of the number, of an effect's with the effect before it.
    pub name: String,
    /// In studies made by the catalogue's definitions.
    pub textbook: Rate,
    /// The same with the intervals that take residuals for white.
    pub textbook_naive: Rate,
    /// In studies made by variants of them, where an effect's parameter means nearly the same.
    pub variant: Rate,
}

#[derive(Default)]
struct Counts {
    textbook: Vec<bool>,
    naive: Vec<bool>,
    variant: Vec<bool>,
}

impl Counts {
    fn see(&mut self, stated: &StatedNumber, truth: f64, textbook: bool, turns: bool) {
        let covers = |[low, high]: [f64; 2]| {
            // an angle is as good a whole turn further
            let turn = std::f64::consts::TAU;
            let shift = if turns { (0.5 * (low + high) - truth) / turn } else { 0.0 };
            let truth = truth + shift.round() * turn;
            low <= truth && truth <= high
        };
        if let Some(interval) = stated.interval {
            if textbook { &mut self.textbook } else { &mut self.variant }.push(covers(interval));
        }
        if let (Some(interval), true) = (stated.interval_naive, textbook) {
            self.naive.push(covers(interval));
        }
    }

    fn some(&self) -> bool {
        !(self.textbook.is_empty() && self.variant.is_empty())
    }

    fn coverage(self, name: String) -> Coverage {
        Coverage {
            name,
            textbook: Rate::over(self.textbook),
            textbook_naive: Rate::over(self.naive),
            variant: Rate::over(self.variant),
        }
    }
}

/// Coverage of the numbers, in their order, then of the effects' parameters by name, where the causes are right.
pub fn coverage(trials: &[Trial]) -> Vec<Coverage> {
    let names = || FourNumbers::NAMES.into_iter().chain(Gains::SHARES);
    let mut joint: [Counts; 6] = Default::default();
    let mut effects: BTreeMap<String, Counts> = BTreeMap::new();
    for (truth, answer) in right(trials) {
        // what is unexplained is in the numbers too, and the answer says so
        if !answer.intervals_trusted {
            continue;
        }
        for (k, name) in names().enumerate() {
            let stated = answer.joint.iter().find(|stated| stated.name == name);
            if let (Some(stated), Some(value)) = (stated, truth.number(name)) {
                joint[k].see(stated, value, truth.textbook, false);
            }
        }
        for (name, stated, value) in parameters(truth, answer) {
            let turns = name.ends_with(".phi");
            effects.entry(name).or_default().see(stated, value, truth.textbook, turns);
        }
    }
    let joint = names().zip(joint).filter(|(name, counts)| FourNumbers::NAMES.contains(name) || counts.some());
    let joint = joint.map(|(name, counts)| counts.coverage(name.to_owned()));
    joint.chain(effects.into_iter().map(|(name, counts)| counts.coverage(name))).collect()
}

/// Coverage of all numbers together and of all effects' parameters together, where the causes are right: of answers
/// that say their intervals are to be trusted, and of all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Covered {
    /// Numbers, of answers that trust them.
    pub numbers: Rate,
    /// Effects' parameters, of answers that trust them.
    pub parameters: Rate,
    /// Numbers, of all answers.
    pub numbers_of_all: Rate,
    /// Effects' parameters, of all answers.
    pub parameters_of_all: Rate,
}

/// All together.
pub(super) fn covered(trials: &[Trial]) -> Covered {
    let rates = |all: bool| {
        let (mut numbers, mut others) = (Counts::default(), Counts::default());
        for (truth, answer) in right(trials).filter(|(_, answer)| all || answer.intervals_trusted) {
            for stated in &answer.joint {
                if let Some(value) = truth.number(&stated.name) {
                    numbers.see(stated, value, true, false);
                }
            }
            for (name, stated, value) in parameters(truth, answer) {
                others.see(stated, value, true, name.ends_with(".phi"));
            }
        }
        [numbers, others].map(|counts| Rate::over(counts.textbook))
    };
    let ([numbers, parameters], [numbers_of_all, parameters_of_all]) = (rates(false), rates(true));
    Covered { numbers, parameters, numbers_of_all, parameters_of_all }
}

/// Trials whose answer is wholly right.
fn right(trials: &[Trial]) -> impl Iterator<Item = (&Truth, &Answered)> {
    let right = trials.iter().filter(|trial| Judgement::of(trial).top);
    right.filter_map(|trial| Some((&trial.truth, trial.answer.as_ref().ok()?)))
}

/// Parameters of effects that are there, with their names, as they are stated and as they are.
fn parameters<'a>(truth: &'a Truth, answer: &'a Answered) -> impl Iterator<Item = (String, &'a StatedNumber, f64)> {
    answer.effects.iter().flat_map(move |stated| {
        let id = stated.effect.id();
        let mechanism = truth.mechanisms.iter().find(|m| m.id == id);
        stated.parameters.iter().filter_map(move |parameter| {
            let number = mechanism?.parameters.iter().find(|n| n.name == parameter.name)?;
            Some((format!("{id}.{}", number.name), parameter, number.value))
        })
    })
}
