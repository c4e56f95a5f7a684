//! What the named causes leave, as a law without a name.
//!
//! To first order a law is a ridge regression of the residuals on what each of its waves changes in the simulation,
//! beyond what the hypothesis can take up. How large the waves are believed to be is chosen by the evidence (MacKay
//! 1992). The laws that promise most are fitted inside the simulation together with all other numbers, and one is kept
//! only if it predicts what it was not fitted to.

use super::law_candidates::{candidates, typical};
use super::projector::Projector;
use super::sight::weighted;
use crate::fit::{Budget, Residuals};
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::folds::Folds;
use crate::gap::hypothesis::held_out::Elsewhere;
use crate::gap::hypothesis::law_shape::LawShape;
use crate::gap::hypothesis::model::GapModel;
use crate::gap::hypothesis::score::{FOR_THE_CHOICE, Measure};
use crate::gap::hypothesis::trial::{Trial, losses};
use crate::identify::{Found, JointModel, Problem};
use crate::number::math;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Sizes that a law's waves are tried with, as shares of a typical one.
const SIZES: [f64; 4] = [0.01, 0.04, 0.15, 0.6];
/// Rounds in which size of the rest and size of the law are brought together.
const ROUNDS: usize = 3;
/// Laws that are fitted in full.
const FITTED: usize = 3;
/// Evaluations of a first fit with a law, and of one that begins near its end.
const FULL: Budget = Budget { evaluations: 12 };
const BESIDE_A_LAW: Budget = Budget { evaluations: 10 };
/// Score by which a law has to be better than none.
const EARNS: f64 = 10.0;
/// Standard deviations by which it has to predict parts better that were not fitted, and whole logs.
const PREDICTS: f64 = 2.0;
const ELSEWHERE: f64 = 1.0;
/// Share of the squares, as predicted, below which it has to leave of them.
const MATTERS: f64 = 0.7;
/// No single log may be predicted worse by more than this share of all squares.
const WORSE: f64 = 0.02;
/// Standard deviations by which a law has to predict parts better that were not fitted to say where the gap lies.
const HINTS: f64 = 1.5;

/// What was found of laws.
#[derive(Default)]
pub(in crate::gap) struct Lawful {
    /// The best hypothesis with a law: beside the causes that were found, beside some of them, or instead of them all.
    /// `None` where no law earns its place.
    pub law: Option<Trial>,
    /// Where none does, what says where to look.
    pub hint: Option<Hint>,
    /// Whether held-out logs refute a law that would have earned its place.
    pub refuted: bool,
}

/// A law that predicts parts of logs by the rest of them, which whole logs do not bear out.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Hint {
    pub law: Trial,
    /// Share of the squares of the parts that it leaves.
    left: f64,
}

/// The laws beside the causes that were found, or instead of them, that held-out logs do not refute.
pub(in crate::gap) fn lawful(
    evidence: &Evidence,
    best: &Trial,
    calibrated: &Trial,
    refutes: &dyn Fn(&Trial) -> bool,
) -> Lawful {
    let mut found = Lawful::default();
    let beside = in_one_body(evidence, best, calibrated);
    let mut on_whole_logs = added(evidence, &beside);
    if !beside.effects().is_empty() {
        on_whole_logs.extend(added(evidence, calibrated));
    }
    found.look_among(on_whole_logs, evidence, best, refutes);
    if found.law.is_none() {
        found.look_among(added_in_parts(evidence, &beside), evidence, best, refutes);
    }
    found
}

/// A hypothesis without the causes that part motor side and link: these imitate much, take many short steps, and a law says
/// as much with less.
fn in_one_body(evidence: &Evidence, best: &Trial, calibrated: &Trial) -> Trial {
    let causes = best.effects();
    let kept: Vec<usize> = (0..causes.len()).filter(|&k| !causes[k].parts_two_bodies()).collect();
    match kept.len() {
        0 => calibrated.clone(),
        all if all == causes.len() => best.clone(),
        _ => best.keeping(evidence, &kept, BESIDE_A_LAW),
    }
}

impl Lawful {
    /// Looks among hypotheses with laws: for the best that predicts whole logs, without the causes that it has made needless,
    /// and for what predicts parts of logs best.
    fn look_among(
        &mut self,
        mut those: Vec<Trial>,
        evidence: &Evidence,
        best: &Trial,
        refutes: &dyn Fn(&Trial) -> bool,
    ) {
        let richest = those.iter().min_by(|a, b| a.fit_loss(evidence).total_cmp(&b.fit_loss(evidence)));
        let Some(measure) = richest.map(|t| Measure::by(evidence, t)) else { return };
        let score = |t: &Trial| measure.score(evidence, t);
        those.retain(|t| score(t) < score(best) - EARNS);
        those.sort_by(|a, b| score(a).total_cmp(&score(b)));
        for law in those {
            let Parts { z, left } = Parts::of(evidence, best, &law);
            if !(left < MATTERS && z > HINTS) {
                continue;
            }
            if z > PREDICTS && predicts_elsewhere(evidence, best, &law) {
                let law = pruned(evidence, measure, law.clone());
                if !refutes(&law) {
                    *self = Self { law: Some(law), hint: None, refuted: false };
                    return;
                }
                self.refuted = true;
            }
            if self.hint.as_ref().is_none_or(|hint| left < hint.left) {
                self.hint = Some(Hint { law, left });
            }
        }
    }
}

/// Without the causes that a law has made needless.
fn pruned(evidence: &Evidence, measure: Measure, mut best: Trial) -> Trial {
    while !best.effects().is_empty() {
        let score = |t: &Trial| measure.score(evidence, t);
        let without: Vec<Trial> =
            (0..best.effects().len()).into_par_iter().map(|k| best.without(evidence, k, BESIDE_A_LAW)).collect();
        match without.into_iter().min_by(|a, b| score(a).total_cmp(&score(b))) {
            Some(less) if score(&less) <= score(&best) => best = less,
            _ => break,
        }
    }
    best
}

/// How much better a hypothesis predicts parts of logs than one without its law.
struct Parts {
    /// By so many standard deviations.
    z: f64,
    /// Share of the squares that it leaves.
    left: f64,
}

impl Parts {
    fn of(evidence: &Evidence, without: &Trial, with: &Trial) -> Self {
        let folds = Folds::of(evidence);
        let (poor, rich) = (folds.residuals(without), folds.residuals(with));
        let left = losses(&evidence.fit, &rich) / losses(&evidence.fit, &poor);
        Self { z: folds.difference(&poor, &rich).z(), left }
    }
}

/// Whether a hypothesis predicts whole logs better than one without its law: clearly, and by a share that matters.
fn predicts_elsewhere(evidence: &Evidence, without: &Trial, with: &Trial) -> bool {
    if evidence.fit.len() == 1 {
        return true;
    }
    let elsewhere = Elsewhere::of(evidence, without, with, Measure::by(evidence, with).effective);
    elsewhere.z > ELSEWHERE && elsewhere.left < MATTERS && elsewhere.worst < WORSE
}

/// A hypothesis with each of the laws that promise most added and everything refitted.
fn added(evidence: &Evidence, base: &Trial) -> Vec<Trial> {
    let problem = Problem::new(&base.model, &evidence.fit);
    let Ok(blocks) = problem.linearise(&problem.coordinates_from(&base.found)) else { return Vec::new() };
    let projector = Projector::of(&blocks, base.model.free());
    let absent: Vec<DVector<f64>> = blocks.iter().map(|b| DVector::from_column_slice(&b.residual)).collect();
    let Some(left) = projector.project(&absent) else { return Vec::new() };
    let measure = Measure::by(evidence, base);
    let mut promising: Vec<Promise> = candidates(evidence)
        .into_par_iter()
        .filter_map(|shape| promise(evidence, base, &projector, &left, measure.effective, &shape))
        .collect();
    promising.sort_by(|a, b| a.score.total_cmp(&b.score));
    promising.retain(|p| p.score < 0.0);
    promising.truncate(FITTED);
    promising.into_par_iter().map(|p| fitted(evidence, base, p)).collect()
}

/// The same with laws that were found on short parts of the logs, along which no hypothesis runs far from them.
fn added_in_parts(evidence: &Evidence, base: &Trial) -> Vec<Trial> {
    let short = evidence.in_parts();
    let starts = short.fit.iter().map(|e| e.start_coordinates(&e.start)).collect();
    let there = Trial::solved(&short, base.model.clone(), &base.found.values, starts, FULL);
    let carried = |t: Trial| {
        let starts = base.found.starts.clone();
        Trial::solved(evidence, t.model, &t.found.values, starts, FULL).settled(evidence, BESIDE_A_LAW)
    };
    added(&short, &there).into_par_iter().map(carried).collect()
}

/// A law with the numbers that explain most to first order.
struct Promise {
    shape: LawShape,
    numbers: Vec<f64>,
    /// Deviance with what the law is charged, less that without it.
    score: f64,
}

/// What a law promises beside a hypothesis, in the size that the evidence picks.
fn promise(
    evidence: &Evidence,
    base: &Trial,
    projector: &Projector,
    left: &[DVector<f64>],
    effective: f64,
    shape: &LawShape,
) -> Option<Promise> {
    let columns = columns(evidence, base, projector, shape)?;
    let n = columns.len();
    let dot = |a: &[DVector<f64>], b: &[DVector<f64>]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
    let gram = DMatrix::from_fn(n, n, |i, k| if i <= k { dot(&columns[i], &columns[k]) } else { 0.0 });
    let gram = gram.upper_triangle() + gram.upper_triangle().transpose() - DMatrix::from_diagonal(&gram.diagonal());
    let slopes = DVector::from_iterator(n, columns.iter().map(|c| -dot(c, left)));
    let before: f64 = left.iter().map(|r| r.norm_squared()).sum();
    let typical = typical(evidence, shape.acts);
    let roughness = [true, false].into_iter().flat_map(|falls| SIZES.map(|size| (size, falls)));
    let sized = roughness.filter_map(|(size, falls)| {
        let shape = shape.sized(size * typical, falls);
        let sd = DVector::from_column_slice(shape.sd());
        let mut unit = before / effective;
        let mut found = None;
        for _ in 0..ROUNDS {
            // Everything in units of what is believed of each wave.
            let told = DMatrix::from_fn(n, n, |i, k| gram[(i, k)] * sd[i] * sd[k] / unit + f64::from(u8::from(i == k)));
            let factor = told.cholesky()?;
            let sizes = factor.solve(&slopes.component_mul(&sd)) / unit;
            let numbers = sizes.component_mul(&sd);
            let explained = before - 2.0 * slopes.dot(&numbers) + numbers.dot(&(&gram * &numbers));
            let whole = explained.max(0.0) + unit * sizes.norm_squared();
            let charge = 2.0 * factor.l_dirty().diagonal().iter().map(|d| math::ln(*d)).sum::<f64>();
            unit = whole / effective;
            found = Some((numbers, charge, effective * math::ln((whole / before).max(1e-12))));
        }
        let (numbers, charge, gained) = found?;
        let score = gained + charge + FOR_THE_CHOICE;
        score.is_finite().then(|| Promise { shape: shape.charged(charge), numbers: numbers.as_slice().to_vec(), score })
    });
    sized.min_by(|a, b| a.score.total_cmp(&b.score))
}

/// What each wave of a law changes beyond what a hypothesis can take up, log by log.
fn columns(
    evidence: &Evidence,
    base: &Trial,
    projector: &Projector,
    shape: &LawShape,
) -> Option<Vec<Vec<DVector<f64>>>> {
    let held: Vec<usize> = (0..base.model.parameters().len()).collect();
    let model: GapModel = base.model.clone().holding(&held, &base.found.values).with_law(shape.clone());
    let values: Vec<f64> = base.found.values.iter().copied().chain(vec![0.0; shape.count()]).collect();
    let problem = Problem::new(&model, &evidence.fit);
    let x = problem.coordinates_from(&Found { values, ..base.found.clone() });
    let blocks = problem.linearise(&x).ok()?;
    let column = |j: usize| {
        let of_log = |b: &crate::fit::Block| {
            let width = b.columns.len();
            DVector::from_iterator(b.residual.len(), b.jacobian.iter().skip(j).step_by(width).copied())
        };
        projector.project(&blocks[..evidence.fit.len()].iter().map(of_log).collect::<Vec<_>>())
    };
    (0..shape.count()).map(column).collect()
}

/// A law fitted inside the simulation, from what it promises or from nothing.
fn fitted(evidence: &Evidence, base: &Trial, promise: Promise) -> Trial {
    let model = base.model.with_law(promise.shape);
    let values = |share: f64| -> Vec<f64> {
        base.found.values.iter().copied().chain(promise.numbers.iter().map(|b| share * b)).collect()
    };
    let rest = |values: &[f64]| -> f64 {
        let problem = Problem::new(&model, &evidence.fit);
        let x = problem.coordinates_from(&Found { values: values.to_vec(), ..base.found.clone() });
        let square = |k: usize| weighted(&problem, &x, k).map_or(f64::INFINITY, |r| r.norm_squared());
        (0..evidence.fit.len()).map(square).sum()
    };
    let from = [1.0, 0.5, 0.0].map(values).into_iter().min_by(|a, b| rest(a).total_cmp(&rest(b)));
    let from = from.unwrap_or_else(|| values(0.0));
    Trial::solved(evidence, model, &from, base.found.starts.clone(), FULL).settled(evidence, BESIDE_A_LAW)
}
