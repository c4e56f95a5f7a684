//! Hypotheses about a robot: as given, with one cause, with two.

use super::bench::Bench;
use super::cause::Cause;
use super::comes_back::may_be_noise;
use super::decide::{is_explained, leaves_enough, leaves_much};
use super::part::Part;
use super::rank::{Candidate, rank};
use super::refine::{Hypothesis, refine, refine_on, refine_roughly};
use super::screen::{around, columns, rescan_holds};
use super::tried::Attribution;
use rayon::prelude::*;

/// Candidates that are refitted, and of one cause at most so many.
const TRIED: usize = 8;
const OF_A_CAUSE: usize = 3;
/// A leg that is let go goes far from what a cause does to first order: a cause is refitted from so many of its starts.
const STARTS_LET_GO: usize = 3;
/// Free play is refitted if to first order it promises this share of what the best has gained.
const PLAY_PROMISES: f64 = 0.3;
/// More that are refitted on the joints of the best; fewer where every trial is a walk.
const TRIED_THERE: [usize; 2] = [5, 2];
/// Sets of joints on which the best is refitted besides.
const TRIED_ELSEWHERE: usize = 2;
/// Of those that were fitted roughly so many are fitted in full.
const IN_FULL: usize = 3;
const PAIRS_IN_FULL: usize = 2;
/// Seconds that are refitted; fewer where every trial is a walk.
const TRIED_SECOND: [usize; 2] = [5, 3];
const TRIED_BESIDE_PLAY: usize = 1;
/// What gains less to first order is not worth a refit.
const LEAST_GAIN: f64 = 6.0;
/// From this gain on a first cause is worth a search for a second.
pub(super) const CLEAR_GAIN: f64 = 40.0;

/// Tries all causes that are considered; `None` where the robot runs away with its numbers adapted.
pub(super) fn attribute(
    bench: &Bench<'_>,
    considered: &(dyn Fn(Cause) -> bool + Sync),
    progress: &(dyn Fn(&str) + Sync),
) -> Option<Attribution> {
    progress("what each cause would change");
    let given = Hypothesis::given(bench)?;
    let mut columns = columns(bench, &|cause| !cause.is_play() && considered(cause), &given.residual);
    progress("fitting the likeliest causes");
    let firsts = one_each(bench, &given, &rank(bench, &columns, &given.residual));
    let firsts = elsewhere(bench, &given, firsts);
    let mut firsts = in_full(bench, &given, firsts, IN_FULL);
    let lead = firsts.first().filter(|first| first.loss() < given.loss()).unwrap_or(&given);
    if !is_explained(bench, lead) && !may_be_noise(bench, &lead.attained.residual) {
        progress("trying free play");
        let play = self::columns(bench, &|cause| cause.is_play() && considered(cause), &given.residual);
        let best_play = rank(bench, &play, &given.residual).into_iter().next();
        let promising = best_play.filter(|play| play.gain > PLAY_PROMISES * (given.loss() - lead.loss()));
        firsts = best(firsts.into_iter().chain(refitted(bench, &given, promising.as_slice())).collect());
        columns.extend(play);
    }
    let is_clear = |first: &&Hypothesis| given.loss() - first.loss() > CLEAR_GAIN && leaves_enough(bench, first);
    let Some(first) = firsts.first().filter(is_clear) else {
        return Some(Attribution { columns, given, firsts, seconds: Vec::new() });
    };
    progress("looking for a second cause");
    let mut beside = |first: &Hypothesis| {
        rescan_holds(bench, &mut columns, considered, &first.residual);
        two_each(bench, &given, first, &rank(bench, &columns, &first.residual))
    };
    let mut seconds = beside(first);
    if let Some(pair) = seconds.first().filter(|pair| leaves_much(bench, pair)) {
        // What is best alone need not be best beside the other.
        let other = refine(bench, &given, vec![pair.parts[1].clone()]);
        seconds.extend(other.iter().flat_map(beside));
        seconds = best(seconds);
    }
    let firsts = match seconds.first() {
        Some(pair) => reconsidered(bench, &given, firsts, pair),
        None => firsts,
    };
    Some(Attribution { columns, given, firsts, seconds })
}

/// One cause each, best first: the likeliest, and what the joints of the best may have besides. To first order a strong
/// friction looks weak.
fn one_each(bench: &Bench<'_>, given: &Hypothesis, candidates: &[Candidate]) -> Vec<Hypothesis> {
    let likeliest = chosen(candidates, TRIED, |_| true);
    let firsts = best_of_each(refitted(bench, given, &from_other_starts(bench, candidates, &likeliest)));
    let Some(place) = firsts.first().map(|first| &first.parts[0].place) else { return firsts };
    let is_tried = |candidate: &Candidate| likeliest.iter().any(|other| other.is_where(candidate));
    let count = TRIED_THERE[usize::from(!bench.case.is_clamped())];
    let cousins = chosen(candidates, count, |candidate| candidate.place == *place && !is_tried(candidate));
    let cousins = from_other_starts(bench, candidates, &cousins);
    best_of_each(refitted(bench, given, &cousins).into_iter().chain(firsts).collect())
}

/// Some candidates, and in a drop the same causes on the same places from their other starts.
fn from_other_starts<'a>(
    bench: &Bench<'_>,
    candidates: &'a [Candidate],
    chosen: &[&'a Candidate],
) -> Vec<&'a Candidate> {
    let starts = if bench.case.is_let_go() { STARTS_LET_GO } else { 1 };
    let of = |one: &&'a Candidate| {
        let others = candidates.iter().filter(|other| other.is_where(one) && !std::ptr::eq(*other, *one));
        std::iter::once(*one).chain(others.take(starts - 1)).collect::<Vec<_>>()
    };
    chosen.iter().flat_map(of).collect()
}

/// On the floor few sets of joints are tried: the best cause on fewer of its joints, and on more.
fn elsewhere(bench: &Bench<'_>, given: &Hypothesis, firsts: Vec<Hypothesis>) -> Vec<Hypothesis> {
    let Some(named) = firsts.first().map(|first| &first.parts[0]) else { return firsts };
    if bench.case.is_clamped() || named.cause.is_of_robot() {
        return firsts;
    }
    let candidates = rank(bench, &around(bench, named), &given.residual);
    let is_tried =
        |candidate: &Candidate| firsts.iter().any(|first| first.parts[0].is_where(candidate.cause, &candidate.place));
    let others = chosen(&candidates, TRIED_ELSEWHERE, |candidate| !is_tried(candidate));
    best(refitted(bench, given, &others).into_iter().chain(firsts).collect())
}

/// All were fitted roughly: the best, and those that may still pass them, are fitted in full.
fn in_full(bench: &Bench<'_>, given: &Hypothesis, mut rough: Vec<Hypothesis>, count: usize) -> Vec<Hypothesis> {
    let rest = rough.split_off(rough.len().min(count));
    let fine: Vec<Hypothesis> = rough.into_par_iter().map(|rough| refine_on(bench, given, rough)).collect();
    best(fine.into_iter().chain(rest).collect())
}

/// The best cause with another each, best first.
fn two_each(bench: &Bench<'_>, given: &Hypothesis, first: &Hypothesis, candidates: &[Candidate]) -> Vec<Hypothesis> {
    let named = &first.parts[0];
    let is_other = |candidate: &Candidate| {
        let shares = candidate.place.joints.iter().any(|joint| named.place.joints.contains(joint));
        let is_new = candidate.cause != named.cause || (!shares && !candidate.cause.is_of_robot());
        is_new && !candidate.cause.is_play()
    };
    let count = match named.cause.is_play() {
        true => TRIED_BESIDE_PLAY,
        false => TRIED_SECOND[usize::from(!bench.case.is_clamped())],
    };
    let pair = |candidate: &Candidate| refine_roughly(bench, given, vec![named.clone(), part(candidate)]);
    let rough = best(chosen(candidates, count, is_other).into_par_iter().filter_map(pair).collect());
    in_full(bench, given, rough, PAIRS_IN_FULL)
}

/// A search that began elsewhere may have missed what one of two causes explains alone.
fn reconsidered(bench: &Bench<'_>, given: &Hypothesis, firsts: Vec<Hypothesis>, pair: &Hypothesis) -> Vec<Hypothesis> {
    let alone: Vec<Hypothesis> =
        pair.parts.clone().into_par_iter().filter_map(|part| refine(bench, given, vec![part])).collect();
    let is_same = |a: &Hypothesis, b: &Hypothesis| a.parts[0].is_where(b.parts[0].cause, &b.parts[0].place);
    let is_new = |new: &Hypothesis| {
        firsts.iter().filter(|old| is_same(old, new)).all(|old| new.loss() < old.loss() - CLEAR_GAIN)
    };
    let better: Vec<Hypothesis> = alone.into_iter().filter(is_new).collect();
    let kept = firsts.into_iter().filter(|old| !better.iter().any(|new| is_same(old, new)));
    let kept: Vec<Hypothesis> = kept.collect();
    best(kept.into_iter().chain(better).collect())
}

fn refitted<C: std::borrow::Borrow<Candidate> + Sync>(
    bench: &Bench<'_>,
    given: &Hypothesis,
    candidates: &[C],
) -> Vec<Hypothesis> {
    candidates.par_iter().filter_map(|candidate| refine_roughly(bench, given, vec![part(candidate.borrow())])).collect()
}

fn part(candidate: &Candidate) -> Part {
    Part { cause: candidate.cause, place: candidate.place.clone(), values: candidate.values.clone() }
}

fn best(mut hypotheses: Vec<Hypothesis>) -> Vec<Hypothesis> {
    hypotheses.sort_by(|a, b| a.loss().total_cmp(&b.loss()));
    hypotheses
}

/// Of every cause on every place the best, best first.
fn best_of_each(hypotheses: Vec<Hypothesis>) -> Vec<Hypothesis> {
    let mut kept: Vec<Hypothesis> = Vec::new();
    for hypothesis in best(hypotheses) {
        let part = &hypothesis.parts[0];
        if !kept.iter().any(|other| other.parts[0].is_where(part.cause, &part.place)) {
            kept.push(hypothesis);
        }
    }
    kept
}

/// The best few, each cause on each place once.
fn chosen(candidates: &[Candidate], count: usize, is_right: impl Fn(&Candidate) -> bool) -> Vec<&Candidate> {
    let mut chosen: Vec<&Candidate> = Vec::new();
    for candidate in candidates.iter().filter(|candidate| candidate.gain > LEAST_GAIN && is_right(candidate)) {
        let is_new = !chosen.iter().any(|other| other.is_where(candidate));
        let of_cause = chosen.iter().filter(|other| other.cause == candidate.cause).count();
        if is_new && of_cause < OF_A_CAUSE {
            chosen.push(candidate);
        }
        if chosen.len() == count {
            break;
        }
    }
    chosen
}
