//! Numbers of a hypothesis with intervals, under the catalogue's names.

use super::bench::Bench;
use super::diagnosis::Found;
use super::part::{change, moved};
use super::refine::Hypothesis;
use crate::gap::Number;
use crate::number::chance::HALF_95;

/// One part of a hypothesis with its numbers.
///
/// The naive interval takes what is left as white noise; the other is wider by as much as more than noise is left.
pub(super) fn found(bench: &Bench<'_>, hypothesis: &Hypothesis, part: usize) -> Found {
    let of = &hypothesis.parts[part];
    let parameters = of.parameters(bench);
    let samples = bench.noise.count().max(1) as f64;
    let left = (hypothesis.loss() / samples).max(1.0).sqrt();
    let here = change(bench, of.cause, &of.place, &of.values).values;
    let names = of.cause.named();
    let number = |k: usize| {
        let at = |by: f64| {
            let mut values = of.values.clone();
            values[k] = moved(&parameters[k], values[k], by);
            change(bench, of.cause, &of.place, &values).values[k]
        };
        let sd = hypothesis.sd(part, k);
        let interval = |widened: f64| {
            sd.map(|sd| {
                let (a, b) = (at(-HALF_95 * widened * sd), at(HALF_95 * widened * sd));
                [a.min(b), a.max(b)]
            })
        };
        Number {
            name: names[k].0.to_owned(),
            value: here[k],
            unit: names[k].1.to_owned(),
            interval: interval(left),
            interval_naive: interval(1.0),
        }
    };
    Found {
        cause: of.cause,
        joints: of.place.names(&bench.case.names),
        parameters: (0..of.values.len()).map(number).collect(),
    }
}
