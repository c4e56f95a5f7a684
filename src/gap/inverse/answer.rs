//! What was found on one joint, as a diagnosis.

use super::design::{JointData, LogData};
use super::numbers::Which;
use super::parameters::{Estimated, detectable, law, named};
use super::search::{Choice, Found, values};
use super::sure::Redraws;
use crate::gap::hypothesis::held_out::closed;
use crate::gap::verdict::as_given::AsGiven;
use crate::gap::verdict::sentence::{MUCH_LEFT, REFITTED, closing_in, number_words, them, words};
use crate::gap::{
    Answer, Candidate, CauseShare, Detectable, Diagnosis, Gap, LawFound, LogGap, Number, Variable, Verdict, Where,
};
use crate::identify::{BeliefFound, Directives, Estimate, Status};
use crate::joint::EffectId;
use crate::number::chance::HALF_95;
use crate::number::{capital, newton_metres, quantity};

/// A number of which the logs leave more than this share of what was believed open is not determined by them.
const OPEN: f64 = 0.9;
/// Recalibrating has to take away this share of the squares to be an answer.
const CLEAR: f64 = 0.1;

/// One log of a joint: what its drive gave and what models ask for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TorqueTraces {
    /// As the user named it.
    pub file: String,
    /// `fit` or `validate`.
    pub role: &'static str,
    /// Compared samples \[s\].
    pub t_s: Vec<f64>,
    /// The logged torque after the low pass \[N m\].
    pub measured_nm: Vec<f64>,
    /// As given, recalibrated, with the causes \[N m\].
    pub given_nm: Vec<f64>,
    /// Recalibrated \[N m\].
    pub calibrated_nm: Vec<f64>,
    /// With the causes, and the law \[N m\].
    pub after_nm: Vec<f64>,
}

/// A joint's diagnosis along its measured motion; `described` is the one before a body that it carries was changed.
pub(super) fn diagnosis(
    joint: &JointData,
    logs: &[LogData],
    found: &Found,
    described: Option<&Diagnosis>,
) -> (Diagnosis, Vec<TorqueTraces>) {
    let choice = found.choice();
    let nothing = Choice::default();
    let named_only = Choice { curve: None, ..choice.clone() };
    let (before, before_logs) = found.figure_as_given();
    let (calibrated, calibrated_logs) = found.figure(&nothing);
    let (with_causes, _) = found.figure(&named_only);
    let (after, after_logs) = found.figure(&choice);
    let floor = floor(joint, found);
    let refits = found.system.refits(&found.solved.chosen);
    let estimated = |unknown: usize| Estimated::new(unknown, &found.solved, &refits);
    let now = values(joint, &found.design, &found.solved);

    let law = found.curve.map(|k| {
        let curve = &found.design.curves[k];
        let knots: Vec<Estimated> = curve.columns.iter().map(|c| estimated(*c)).collect();
        let left = calibrated - floor;
        let closed = (left > 0.0).then(|| (with_causes - after) / left);
        law(&joint.name, curve, &knots, after, closed)
    });
    let causes = causes(found, calibrated, floor, &|family| {
        let family = &found.design.families[family];
        named(family, &family.columns.iter().map(|c| estimated(*c)).collect::<Vec<_>>(), &now)
    });
    let parameters = estimates(joint, found, &estimated, &now);
    let beliefs = beliefs(joint, found);
    let most = beliefs.iter().max_by(|a, b| a.moved_sd.abs().total_cmp(&b.moved_sd.abs()));
    let verdict = match before <= floor {
        true => Verdict::None,
        false => verdict(&causes, law.is_some(), [before, calibrated, with_causes, after], most),
    };
    let effect = match verdict {
        Verdict::Effect => causes.first().map(|cause| cause.effect.id().to_owned()),
        Verdict::Calibration => most.map(|number| number.name.clone()),
        _ => None,
    };
    let named_effects = verdict == Verdict::Effect;
    let mut gap = Gap {
        unit: "N m",
        before,
        calibrated,
        after_first: causes.first().map_or(after, |cause| cause.after),
        after,
        floor,
        closed: closed(before, after, floor),
        closed_interval: None,
        outer: found.has_outer() && !found.asked_outer(),
        held_out: held_out(found),
        per_log: per_log(logs, floor, &[before_logs, calibrated_logs, after_logs]),
    };
    if let Some(described) = described {
        AsGiven::of(described).begin(&mut gap);
    }
    let redraws = Redraws::new(found);
    let (probability, probability_source) = redraws.of_answer(verdict, causes.first().map(|cause| cause.effect));
    let answer = Answer {
        verdict,
        effect,
        second: causes.get(1).filter(|_| named_effects).map(|cause| cause.effect),
        equivalent: causes.first().filter(|_| named_effects).map_or_else(Vec::new, |cause| cause.equivalent.clone()),
        probability: Some(probability),
        probability_source,
        standing: format!("torque along the motion, {}", verdict.name()),
        sentence: sentence(&joint.name, verdict, &gap, &causes, law.as_ref(), most),
        partial: causes.first().filter(|_| verdict == Verdict::Unexplained).map(|cause| cause.effect),
        intervals_trusted: verdict != Verdict::Unexplained,
    };
    let traces = traces(logs, found, &choice);
    let diagnosis = Diagnosis {
        joint: joint.name.clone(),
        location: location(logs, found, &causes, law.as_ref()),
        ranking: ranking(found, &gap, &now, &redraws),
        detectable: detectable_sizes(found, &now),
        effect_parameters: causes.iter().map(|cause| (cause.effect, cause.parameters.clone())).collect(),
        undetermined: undetermined(joint, found),
        answer,
        gap,
        parameters,
        causes,
        beliefs,
        law,
        differs: Vec::new(),
        next: None,
        confusion: None,
        traces: Vec::new(),
        doubts: Vec::new(),
        notes: refuted(found),
        withheld: Vec::new(),
        demands: Directives::default(),
        budget: None,
    };
    (diagnosis, traces)
}

/// What stays of the readings' noise below the cutoff, over all logs \[N m\].
fn floor(joint: &JointData, found: &Found) -> f64 {
    let outer = found.has_outer();
    joint.noise_nm(|log| found.system.blocks.iter().any(|block| block.log == log && block.is_fit != outer))
}

fn causes(found: &Found, calibrated: f64, floor: f64, named: &dyn Fn(usize) -> Vec<Number>) -> Vec<CauseShare> {
    let all = Choice { curve: None, ..found.choice() };
    let whole = calibrated - floor;
    let share = |closed: f64| (whole > 0.0).then_some(closed / whole);
    let with_all = found.figure(&all).0;
    let mut so_far = Choice::default();
    let mut causes = Vec::new();
    for family in &found.causes {
        so_far = so_far.with(*family);
        let effect = found.design.families[*family].effect;
        causes.push(CauseShare {
            effect,
            form: effect.forms().next().map_or("", |form| form.name()),
            only: None,
            equivalent: found.equivalent(*family),
            parameters: named(*family),
            alone: share(calibrated - found.figure(&Choice::default().with(*family)).0),
            last: share(found.figure(&all.without(*family)).0 - with_all),
            after: found.figure(&so_far).0,
        });
    }
    causes
}

fn estimates(
    joint: &JointData,
    found: &Found,
    estimated: &dyn Fn(usize) -> Estimated,
    now: &[f64; 6],
) -> Vec<Estimate> {
    let of = |which: Which| {
        let [name, symbol, unit] = which.words();
        let unknown = found.design.numbers.iter().position(|own| *own == which);
        let value = now[which as usize];
        let around = |sd: f64| sd.is_finite().then_some([value - HALF_95 * sd, value + HALF_95 * sd]);
        let estimate = unknown.map(estimated);
        Estimate {
            name: name.to_owned(),
            symbol: symbol.to_owned(),
            unit: unit.to_owned(),
            status: if unknown.is_some() { Status::Determined } else { Status::Held },
            value,
            interval: estimate.and_then(|estimate| around(estimate.sd)),
            interval_naive: estimate.and_then(|estimate| around(estimate.naive_sd)),
            nominal: Some(joint.believed.values[which as usize]),
        }
    };
    Which::ALL.into_iter().map(of).collect()
}

fn beliefs(joint: &JointData, found: &Found) -> Vec<BeliefFound> {
    let of = |(k, which): (usize, &Which)| {
        let [name, _, unit] = which.words();
        let (believed, sd) = (joint.believed.values[*which as usize], joint.believed.sd[*which as usize]);
        let moved = found.solved.x[k];
        BeliefFound {
            name: name.to_owned(),
            believed,
            sd,
            found: believed + moved,
            moved_sd: moved / sd,
            unit: unit.to_owned(),
        }
    };
    found.design.numbers.iter().enumerate().map(of).collect()
}

fn verdict(causes: &[CauseShare], has_law: bool, rms: [f64; 4], most: Option<&BeliefFound>) -> Verdict {
    let [before, calibrated, with_causes, after] = rms.map(|rms| rms * rms);
    if !causes.is_empty() && calibrated - with_causes >= with_causes - after {
        return Verdict::Effect;
    }
    if has_law {
        return Verdict::Unexplained;
    }
    let is_finding = most.is_some_and(BeliefFound::is_finding);
    if is_finding || before - calibrated > CLEAR * before { Verdict::Calibration } else { Verdict::None }
}

fn held_out(found: &Found) -> String {
    if found.has_outer() {
        let said = match (found.asked_outer(), found.refuted.is_empty()) {
            (false, _) => "on which no choice was made",
            (true, false) => "which refuted a cause",
            (true, true) => "which refuted a law",
        };
        return format!("the validate logs, {said}");
    }
    "each fitted log, or part of the only one, predicted from the others; these also had a say in the causes".to_owned()
}

fn refuted(found: &Found) -> Vec<String> {
    let law = found.is_curve_refuted.then_some("a law");
    let names: Vec<&str> = found.refuted.iter().map(|k| found.design.families[*k].effect.id()).chain(law).collect();
    if names.is_empty() {
        return Vec::new();
    }
    vec![format!("The fitted logs asked for {}; the held-out logs are predicted better without.", names.join(", "))]
}

fn per_log(logs: &[LogData], floor: f64, of: &[Vec<(usize, f64)>; 3]) -> Vec<LogGap> {
    let [before, calibrated, after] = of;
    let row = |k: usize| LogGap {
        file: logs[before[k].0].file.clone(),
        before: before[k].1,
        calibrated: calibrated[k].1,
        after: after[k].1,
        floor,
    };
    (0..before.len()).map(row).collect()
}

/// The shape of each family that predicts best, alone beside the numbers, the best first.
fn ranking(found: &Found, gap: &Gap, now: &[f64; 6], redraws: &Redraws) -> Vec<Candidate> {
    let squares = |choice: &Choice| found.system.held_out(&choice.columns(&found.design));
    let mut best: Vec<(EffectId, usize, f64)> = Vec::new();
    for (k, family) in found.design.families.iter().enumerate() {
        let sum = squares(&Choice::default().with(k)).iter().sum::<f64>();
        match best.iter_mut().find(|(effect, _, _)| *effect == family.effect) {
            Some(known) if sum < known.2 => (known.1, known.2) = (k, sum),
            Some(_) => {}
            None => best.push((family.effect, k, sum)),
        }
    }
    best.sort_by(|a, b| a.2.total_cmp(&b.2));
    let Some(first) = best.first().map(|(_, k, _)| squares(&Choice::default().with(*k))) else { return Vec::new() };
    let candidate = |(effect, k, _): &(EffectId, usize, f64)| {
        let choice = Choice::default().with(*k);
        let (after, _) = found.figure(&choice);
        let family = &found.design.families[*k];
        let solved = found.fit(&choice);
        let own: Vec<Estimated> = family.columns.iter().map(|c| Estimated::new(*c, &solved, &[])).collect();
        let behind_sd = super::system::saved(&squares(&choice), &first).1.max(0.0);
        Candidate {
            effect: *effect,
            probability: redraws.of(*effect),
            after,
            closed: closed(gap.before, after, gap.floor),
            behind_sd,
            parameters: named(family, &own, now),
            refitted: true,
        }
    };
    best.iter().map(candidate).collect()
}

fn detectable_sizes(found: &Found, now: &[f64; 6]) -> Vec<Detectable> {
    let mut sizes: Vec<Detectable> = Vec::new();
    for (k, family) in found.design.families.iter().enumerate() {
        let choice = found.choice();
        let is_known = sizes.iter().any(|known| known.effect == family.effect);
        if is_known || found.causes.iter().any(|c| found.design.families[*c].effect == family.effect) {
            continue;
        }
        let solved = found.fit(&choice.with(k));
        sizes.push(detectable(family, solved.sd(family.columns[0]), now));
    }
    sizes
}

fn undetermined(joint: &JointData, found: &Found) -> Vec<String> {
    let is_open = |(k, which): &(usize, &Which)| found.solved.sd(*k) > OPEN * joint.believed.sd[**which as usize];
    let open: Vec<&str> =
        found.design.numbers.iter().enumerate().filter(is_open).map(|(_, which)| which.words()[0]).collect();
    if open.is_empty() {
        return Vec::new();
    }
    vec![format!(
        "These logs say next to nothing of {}: it stays as believed. Motions that ask for more of its torque below the \
         low pass would tell.",
        open.join(", ")
    )]
}

/// Where the recalibrated joint's error is.
fn location(logs: &[LogData], found: &Found, causes: &[CauseShare], law: Option<&LawFound>) -> Where {
    let before: f64 = found.system.held_out(&Choice::default().columns(&found.design)).iter().sum();
    let explained = |k: usize| {
        let choice = Choice { curve: Some(k), ..Choice::default() };
        let after: f64 = found.system.held_out(&choice.columns(&found.design)).iter().sum();
        (Variable::from(found.design.curves[k].variable), (1.0 - after / before).max(0.0))
    };
    let plain = (0..found.design.curves.len()).filter(|k| found.design.curves[*k].per_turn.is_none());
    let mut variables: Vec<(Variable, f64)> = plain.map(explained).collect();
    variables.sort_by(|a, b| b.1.total_cmp(&a.1));
    let best = variables.first().filter(|(_, share)| *share > 0.0).copied();
    let of_law = law.and_then(|law| law.table.stage());
    let (_, by_log) = found.figure(&Choice::default());
    let squares: f64 = by_log.iter().map(|(_, rms)| rms * rms).sum();
    let mut most: Vec<&(usize, f64)> =
        by_log.iter().filter(|(_, rms)| rms * rms * by_log.len() as f64 > squares).collect();
    most.sort_by(|a, b| b.1.total_cmp(&a.1));
    Where {
        stage: causes.first().map(|cause| cause.effect.stage()).or(of_law),
        variable: best.map(|(variable, _)| variable),
        share: best.map_or(0.0, |(_, share)| share),
        logs: most.into_iter().map(|(log, _)| logs[*log].file.clone()).collect(),
        variables,
        ..Where::default()
    }
}

fn sentence(
    joint: &str,
    verdict: Verdict,
    gap: &Gap,
    causes: &[CauseShare],
    law: Option<&LawFound>,
    most: Option<&BeliefFound>,
) -> String {
    let [before, calibrated] = [gap.before, gap.calibrated].map(newton_metres);
    let size =
        |number: &Number| format!(" ({} = {})", number.name, quantity(number.value, number.interval, &number.unit));
    let each: Vec<String> = causes
        .iter()
        .map(|cause| format!("{}{}", words(cause.effect), cause.parameters.first().map_or_else(String::new, size)))
        .collect();
    let number = most.map_or_else(
        || "numbers".to_owned(),
        |number| {
            format!(
                "{}: {} instead of {}",
                number_words(&number.name),
                quantity(number.found, None, &number.unit),
                quantity(number.believed, None, &number.unit)
            )
        },
    );
    let unnamed = law.map_or_else(String::new, |law| {
        format!(
            " Without a name there is a torque that depends on the {} ({}).",
            law.table.variables.iter().map(|v| v.words()).collect::<Vec<_>>().join(" and the "),
            law.table.looks_like
        )
    });
    let figures = [gap.before, gap.calibrated, gap.after, gap.floor];
    let goes = if causes.is_empty() && law.is_none() {
        format!("the error goes from {before} as given to {calibrated} with {REFITTED}")
    } else {
        closing_in(figures, REFITTED, &them(causes.len(), law.is_some()), newton_metres)
    };
    let apart = if gap.per_log.len() > 1 { "any two logs" } else { "any two parts of the log" };
    let stays = if gap.after > MUCH_LEFT * gap.floor {
        format!(" What is left is not the same in {apart}, as far as I can tell, so that no cause is named for it.")
    } else {
        String::new()
    };
    let stays = format!("{}{stays}", capital(&format!("{goes}.")));
    match verdict {
        Verdict::Effect => format!("{joint}: {}.{unnamed} {stays}", each.join(", together with ")),
        Verdict::Calibration => {
            format!("{joint}: the structure is right and the numbers are off, most of all the {number}. {stays}")
        }
        Verdict::None => format!("{joint}: nothing is missing that these logs would show. {stays}"),
        Verdict::Unexplained => {
            let known = if each.is_empty() {
                String::new()
            } else {
                format!(" What is known so far is {}.", each.join(", together with "))
            };
            format!("{joint}: the effects I know do not explain this gap.{unnamed}{known} {stays}")
        }
    }
}

fn traces(logs: &[LogData], found: &Found, choice: &Choice) -> Vec<TorqueTraces> {
    let nothing = vec![0.0; found.design.unknowns.len()];
    let calibrated = found.fit(&Choice::default());
    let solved = found.fit(choice);
    let of = |(k, log): (usize, &LogData)| {
        let compared = &found.design.logs[k];
        (!compared.t_s.is_empty()).then(|| TorqueTraces {
            file: log.file.clone(),
            role: if log.is_fit { "fit" } else { "validate" },
            t_s: compared.t_s.clone(),
            measured_nm: compared.measured_nm.clone(),
            given_nm: found.design.predicted_nm(k, &nothing),
            calibrated_nm: found.design.predicted_nm(k, calibrated.x.as_slice()),
            after_nm: found.design.predicted_nm(k, solved.x.as_slice()),
        })
    };
    logs.iter().enumerate().filter_map(of).collect()
}
