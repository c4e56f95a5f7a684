//! How often stated intervals cover the truth.

use super::Trial;
use super::judge::Judgement;
use super::rate::Rate;
use crate::blind::answer::StatedNumber;
use crate::blind::truth::FourNumbers;
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

    fn coverage(self, name: String) -> Coverage {
        Coverage {
            name,
            textbook: Rate::over(self.textbook),
            textbook_naive: Rate::over(self.naive),
            variant: Rate::over(self.variant),
        }
    }
}

/// Coverage of the four numbers, in their order, then of the effects' parameters by name.
pub fn coverage(trials: &[Trial]) -> Vec<Coverage> {
    let mut joint: [Counts; 4] = Default::default();
    let mut effects: BTreeMap<String, Counts> = BTreeMap::new();
    for trial in trials.iter().filter(|trial| Judgement::of(trial).top) {
        let Ok(answer) = &trial.answer else { continue };
        // what is unexplained is in the numbers too, and the answer says so
        if !answer.intervals_trusted {
            continue;
        }
        let truth = &trial.truth;
        for (k, (name, value)) in FourNumbers::NAMES.iter().zip(truth.joint.list()).enumerate() {
            if let Some(stated) = answer.joint.iter().find(|stated| stated.name == *name) {
                joint[k].see(stated, value, truth.textbook, false);
            }
        }
        for stated in &answer.effects {
            let id = stated.effect.id();
            let Some(mechanism) = truth.mechanisms.iter().find(|m| m.id == id) else { continue };
            for parameter in &stated.parameters {
                let Some(number) = mechanism.parameters.iter().find(|n| n.name == parameter.name) else { continue };
                let counts = effects.entry(format!("{id}.{}", number.name)).or_default();
                counts.see(parameter, number.value, truth.textbook, number.name == "phi");
            }
        }
    }
    let joint = FourNumbers::NAMES.iter().zip(joint).map(|(name, counts)| counts.coverage((*name).to_owned()));
    joint.chain(effects.into_iter().map(|(name, counts)| counts.coverage(name))).collect()
}
