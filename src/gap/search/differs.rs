//! Numbers that differ from session to session, or from log to log, where one set of numbers does not serve all.

use super::attribute::Attribution;
use super::within::predicts;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::logs::{By, Group, Groups};
use crate::gap::hypothesis::model::{COULOMB, GAIN, REST};
use crate::gap::hypothesis::score::Measure;
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::identify::JointModel;
use crate::number::{mrad, quantity};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// Numbers that may differ: what the drive delivers, what rubs, and where the joint hangs.
const MAY_DIFFER: [usize; 3] = [GAIN, COULOMB, REST];
/// Score by which a number that differs has to be better.
const CLEARLY: f64 = 24.0;
/// It has to leave less than this share of the squares.
const LESS: f64 = 0.9;

/// A number that is not the same in all logs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Differs {
    /// Which one: `gain`, `coulomb` or `rest`.
    pub number: String,
    /// Its unit.
    pub unit: String,
    /// By what the logs are told apart.
    pub by: By,
    /// The value in each session or log, in the order of the study.
    #[serde(serialize_with = "as_map")]
    pub values: Vec<(String, f64)>,
    /// No cause is needed then: this explains the logs better than those that were found.
    pub instead: bool,
    /// RMS over the fitted logs with one value for all, and with these, before and after \[rad\].
    pub rms: [f64; 2],
}

impl Differs {
    /// The values in words, e.g. `0.002 N m in cold, 0.001 N m in warm`.
    fn values_in_words(&self) -> String {
        let value = |(name, value): &(String, f64)| quantity(*value, None, &self.unit) + " in " + name;
        self.values.iter().map(value).collect::<Vec<_>>().join(", ")
    }

    /// The number in a note.
    pub(in crate::gap) fn in_words(&self) -> String {
        format!(
            "One {} does not serve all logs: by {} it is {}; with that the error over the fitted logs falls from {} to {}.",
            self.number,
            self.by.name(),
            self.values_in_words(),
            mrad(self.rms[0]),
            mrad(self.rms[1])
        )
    }

    /// What is to be added to an answer that names causes, where this explains the logs better than they do.
    pub(in crate::gap) fn instead_of_causes(&self) -> Option<String> {
        let (number, by, values) = (&self.number, self.by.name(), self.values_in_words());
        self.instead.then(|| {
            format!(
                " But without any cause the logs are explained better by a {number} that differs by {by}: {values}."
            )
        })
    }
}

fn as_map<S: serde::Serializer>(values: &[(String, f64)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(values.iter().map(|(name, value)| (name, value)))
}

/// Numbers that clearly differ between the logs, the one that explains most first: beside the causes that were found, or
/// instead of them where that explains the logs better.
pub(in crate::gap) fn differing(evidence: &Evidence, a: &Attribution) -> Vec<Differs> {
    let coarse = evidence.coarse();
    let Some(groups) = Groups::of(&coarse.fit, &coarse.held) else { return Vec::new() };
    let best = a.best.carried(evidence, &coarse, AGAIN);
    let mut bases = vec![best.clone()];
    if !best.effects().is_empty() {
        bases.push(a.calibrated.carried(evidence, &coarse, AGAIN));
    }
    let grown: Vec<(Trial, Vec<Differs>)> = bases.into_par_iter().map(|base| from(&coarse, base, &groups)).collect();
    let score = |t: &Trial| Measure::by(&coarse, &best).score(&coarse, t);
    let least = grown.into_iter().min_by(|a, b| score(&a.0).total_cmp(&score(&b.0)));
    let (trial, mut found) = least.unwrap_or_else(|| (best.clone(), Vec::new()));
    // Nothing is said of what explains less than the causes do.
    if !(score(&trial) < score(&best) - CLEARLY) {
        found.clear();
    }
    found.iter_mut().for_each(|differs| differs.instead = trial.effects().len() < best.effects().len());
    found
}

/// A hypothesis with all numbers that clearly differ from group to group.
fn from(coarse: &Evidence, mut base: Trial, groups: &Groups) -> (Trial, Vec<Differs>) {
    let mut found: Vec<Differs> = Vec::new();
    loop {
        let left: Vec<usize> = MAY_DIFFER.into_iter().filter(|number| base.model.may_differ(*number)).collect();
        let tried: Vec<(usize, Trial)> =
            left.into_par_iter().map(|number| (number, apart(coarse, &base, number, groups))).collect();
        let loss = |t: &Trial| t.fit_loss(coarse);
        let Some((number, best)) = tried.into_iter().min_by(|a, b| loss(&a.1).total_cmp(&loss(&b.1))) else { break };
        let alike = alike(coarse, &base, number);
        let measure = Measure::by(coarse, &best);
        let gained = measure.score(coarse, &alike) - measure.score(coarse, &best);
        let is_clear = gained > CLEARLY && loss(&best) < LESS * loss(&alike);
        if !is_clear || predicts(coarse, &best, &alike) <= 0.0 {
            break;
        }
        found.push(stated(coarse, &alike, &best, number, groups));
        base = best;
    }
    (base, found)
}

/// A hypothesis with one value of a number for all logs, which need not be the one that is held.
fn alike(evidence: &Evidence, base: &Trial, number: usize) -> Trial {
    let mut model = base.model.clone();
    model.parameters_mut()[number].fixed = false;
    Trial::solved(evidence, model, &base.found.values, base.found.starts.clone(), AGAIN).settled(evidence, AGAIN)
}

/// A hypothesis with a value of a number for each group.
fn apart(evidence: &Evidence, base: &Trial, number: usize, groups: &Groups) -> Trial {
    let model =
        base.model.clone().differing(number, groups.groups.iter().map(|g| Arc::new(g.inside.clone())).collect());
    let mut values = base.found.values.clone();
    values.extend(groups.groups.iter().map(|_| base.found.values[number]));
    let fitted = Trial::solved(evidence, model, &values, base.found.starts.clone(), AGAIN);
    fitted.settled(evidence, AGAIN)
}

fn stated(evidence: &Evidence, before: &Trial, after: &Trial, number: usize, groups: &Groups) -> Differs {
    let first = after.found.values.len() - groups.groups.len();
    let value = |(g, group): (usize, &Group)| (group.name.clone(), after.found.values[first + g]);
    let samples: f64 = evidence.fit.iter().map(|e| crate::gap::hypothesis::evidence::counts(e).sum::<f64>()).sum();
    let p = &after.model.parameters()[number];
    Differs {
        number: p.name.clone(),
        unit: p.unit.clone(),
        by: groups.by,
        values: groups.groups.iter().enumerate().map(value).collect(),
        instead: false,
        rms: [before, after].map(|t| (t.fit_loss(evidence) / samples).sqrt()),
    }
}
