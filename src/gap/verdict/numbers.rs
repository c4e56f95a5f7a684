//! Parameters of a hypothesis with intervals, under the catalogue's names.

use crate::fit::{Residuals, Uncertainty, uncertainty};
use crate::gap::diagnosis::Number;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::model::{BASELINE, COULOMB, GAIN};
use crate::gap::hypothesis::trial::Trial;
use crate::gap::search::unnamed::{between_logs, by_the_unnamed};
use crate::identify::{Estimate, JointModel, Problem, Status};
use crate::joint::EffectId;
use nalgebra::DMatrix;

/// A size that is so near to none, in its own unit, is none.
const NO_SIZE: f64 = 1e-6;

/// Where what measures an effect's size is when the effect is absent; friction at rest is then that of motion.
pub(in crate::gap) fn none_of(effect: EffectId, coulomb_nm: f64) -> f64 {
    match effect {
        EffectId::Stribeck => coulomb_nm,
        _ => effect.named_parameters().first().map_or(0.0, |named| named.zero),
    }
}

/// Whether what measures an effect's size is where the effect is absent, or its interval reaches there. A limit is absent at
/// infinity: the interval of its inverse reaches none where its own reaches 0.
pub(in crate::gap) fn includes_none(effect: EffectId, numbers: &[Number], coulomb_nm: f64) -> bool {
    let none = none_of(effect, coulomb_nm);
    let is_limit =
        effect.named_parameters().first().is_some_and(|size| size.zero.is_infinite() && !size.bounds.admit(0.0));
    numbers.first().is_some_and(|size| {
        let reaches = |[low, high]: [f64; 2]| low <= none && none <= high || is_limit && low <= 0.0;
        (size.value - none).abs() < NO_SIZE || size.interval.is_some_and(reaches)
    })
}

/// Estimates of the four numbers and of the rest angle, which is held, and of each effect's parameters.
pub(in crate::gap) fn numbers(evidence: &Evidence, trial: &Trial) -> (Vec<Estimate>, Vec<(EffectId, Vec<Number>)>) {
    numbers_beside(evidence, trial, &[])
}

/// What is left out where intervals do not allow for it.
pub(in crate::gap) const UNNAMED: &str = "what effects that are not named would move the numbers by";

/// The same with intervals that allow for what effects which are not named, of those that are considered, would move.
pub(in crate::gap) fn numbers_beside(
    evidence: &Evidence,
    trial: &Trial,
    effects: &[EffectId],
) -> (Vec<Estimate>, Vec<(EffectId, Vec<Number>)>) {
    let problem = Problem::new(&trial.model, &evidence.fit);
    let x = problem.coordinates_from(&trial.found);
    let mut sure = problem.linearise(&x).ok().and_then(|blocks| uncertainty(&problem, &blocks).ok());
    if let Some(sure) = sure.as_mut().filter(|_| !effects.is_empty()) {
        widened(evidence, trial, effects, sure);
    }
    let spread = Spread { trial, free: free(trial), x, sure };
    // A gain that is an effect has what the number had before, and that stands at one.
    let in_effect = |i: usize| i == GAIN && trial.effects().contains(&EffectId::MotorGain);
    let parameters = trial.model.parameters()[..BASELINE].iter().enumerate();
    let joint = parameters
        .map(|(i, p)| {
            let [interval, interval_naive] = spread.intervals(&|values| values[i], p.lower, p.upper);
            Estimate {
                name: p.name.clone(),
                symbol: p.symbol.clone(),
                unit: p.unit.clone(),
                status: match (p.fixed, interval) {
                    (true, _) => Status::Held,
                    (false, Some(_)) => Status::Determined,
                    (false, None) => Status::NotDetermined,
                },
                value: if in_effect(i) { 1.0 } else { trial.found.values[i] },
                interval,
                interval_naive,
                nominal: p.nominal,
            }
        })
        .collect();
    let effects = trial.model.forms().iter().enumerate().map(|(k, &effect)| {
        let place = trial.model.place(k);
        let named = |values: &[f64]| {
            let mut own = effect.named(&values[place.clone()], values[COULOMB]);
            own.iter_mut().filter(|_| effect.id == EffectId::MotorGain).for_each(|c| *c *= values[GAIN]);
            own
        };
        let values = named(&trial.found.values);
        let of = |i: usize| {
            let p = effect.named_parameters()[i];
            let wide = spread.intervals(&|v| named(v)[i], f64::NEG_INFINITY, f64::INFINITY);
            let [interval, interval_naive] = wide.map(|interval| interval.map(|interval| p.bounds.clip(interval)));
            Number { name: p.name.into(), value: values[i], unit: p.unit.into(), interval, interval_naive }
        };
        (effect.id, (0..values.len()).map(of).collect())
    });
    (joint, effects.collect())
}

/// Standard deviations of several functions of the values, with correlated residuals allowed for; `None` where the logs
/// do not determine them.
pub(in crate::gap) fn spread_of(
    evidence: &Evidence,
    trial: &Trial,
    count: usize,
    functions: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let problem = Problem::new(&trial.model, &evidence.fit);
    let x = problem.coordinates_from(&trial.found);
    let sure = uncertainty(&problem, &problem.linearise(&x).ok()?).ok()?;
    let quantile = sure.quantile_robust();
    let spread = Spread { trial, free: free(trial), x, sure: Some(sure) };
    let sd = |k: usize| {
        let [interval, _] = spread.intervals(&|values| functions(values)[k], f64::NEG_INFINITY, f64::INFINITY);
        interval.map(|[low, high]| 0.5 * (high - low) / quantile)
    };
    (0..count).map(sd).collect()
}

/// Intervals that allow for what differs between logs and for what nobody named.
fn widened(evidence: &Evidence, trial: &Trial, effects: &[EffectId], sure: &mut Uncertainty) {
    if let Some(between) = between_logs(evidence, trial) {
        sure.widen_to(&between);
    }
    if let Some(unnamed) = by_the_unnamed(evidence, trial, effects) {
        let mut numbers = sure.robust.view_mut((0, 0), unnamed.shape());
        numbers += unnamed;
    }
}

fn free(trial: &Trial) -> Vec<usize> {
    let parameters = trial.model.parameters();
    (0..parameters.len()).filter(|&i| !parameters[i].fixed).collect()
}

struct Spread<'a> {
    trial: &'a Trial,
    free: Vec<usize>,
    x: Vec<f64>,
    sure: Option<Uncertainty>,
}

impl Spread<'_> {
    /// 95 % intervals of a function of the values by the delta method, robust and naive, within bounds; `None` where
    /// the logs do not determine it.
    fn intervals(&self, function: &dyn Fn(&[f64]) -> f64, lower: f64, upper: f64) -> [Option<[f64; 2]>; 2] {
        let Some(sure) = &self.sure else { return [None, None] };
        let parameters = self.trial.model.parameters();
        let value = function(&self.trial.found.values);
        let slopes: Vec<f64> = self
            .free
            .iter()
            .enumerate()
            .map(|(k, &i)| {
                let at = |x: f64| {
                    let mut values = self.trial.found.values.clone();
                    values[i] = parameters[i].from_coordinate(x);
                    function(&values)
                };
                let step = 1e-5 * self.x[k].abs().max(1e-3);
                (at(self.x[k] + step) - at(self.x[k] - step)) / (2.0 * step)
            })
            .collect();
        if slopes.iter().all(|s| *s == 0.0) {
            return [None, None];
        }
        let half = |covariance: &DMatrix<f64>, quantile: f64| {
            let mut variance = 0.0;
            for (i, a) in slopes.iter().enumerate().filter(|(_, a)| **a != 0.0) {
                for (k, b) in slopes.iter().enumerate().filter(|(_, b)| **b != 0.0) {
                    variance += a * b * covariance[(i, k)];
                }
            }
            quantile * variance.max(0.0).sqrt()
        };
        [half(&sure.robust, sure.quantile_robust()), half(&sure.naive, sure.quantile_naive())]
            .map(|half| half.is_finite().then(|| [(value - half).max(lower), (value + half).min(upper)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Budget;
    use crate::identify::Case;

    #[test]
    fn an_effect_of_no_size_or_with_none_in_its_interval_is_not_certain() {
        let late = |value: f64, interval: Option<[f64; 2]>| {
            vec![Number { name: "T".to_owned(), value, unit: "s".to_owned(), interval, interval_naive: None }]
        };
        let may_be_none = |effect, value, interval| includes_none(effect, &late(value, interval), 0.03);
        assert!(may_be_none(EffectId::Delay, 0.0, None));
        assert!(may_be_none(EffectId::Delay, 0.002, Some([-0.001, 0.005])));
        assert!(!may_be_none(EffectId::Delay, 0.002, Some([0.001, 0.003])));
        assert!(!may_be_none(EffectId::Delay, 0.002, None));
        assert!(may_be_none(EffectId::Stribeck, 0.035, Some([0.028, 0.042])), "it covers the friction of motion");
        assert!(!may_be_none(EffectId::Stribeck, 0.05, Some([0.04, 0.06])));
        assert!(may_be_none(EffectId::SpeedLimit, 6.0, Some([0.0, 18.0])), "a limit that may be anywhere");
        assert!(!may_be_none(EffectId::SpeedLimit, 6.0, Some([4.0, 8.0])));
        assert!(!may_be_none(EffectId::EndStop, -1.0, Some([-1.1, -0.9])), "a stop at a negative angle");
    }

    #[test]
    fn a_gain_that_is_an_effect_is_said_in_full() {
        let case = Case::of_study("data/examples/delay/study.toml".as_ref()).unwrap();
        let evidence = Evidence::of(&case, case.joint.nominal.unwrap()).unwrap();
        let bare = Trial::as_given(&evidence, &evidence.baseline());
        let mut values = bare.found.values.clone();
        values[GAIN] = 0.8;
        values.push(0.9);
        let model = evidence.baseline().with(EffectId::MotorGain, &evidence.reach);
        let trial = Trial::solved(&evidence, model, &values, bare.found.starts, Budget { evaluations: 12 });
        let (joint, effects) = numbers(&evidence, &trial);
        let (c, found) = (&effects[0].1[0], trial.found.values.last().unwrap());
        assert_eq!((joint[GAIN].value, c.value), (1.0, 0.8 * found));
    }
}
