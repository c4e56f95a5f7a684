//! What the report says in words, the same on the page and in the terminal.

use super::rows::{is_side, number_row};
use super::{GapReport, NEXT_FILE};
use crate::gap::{
    Answer, BodyKind, Candidate, Detectable, Diagnosis, Gap, MapCell, Next, Number, Phase, Variable, Verdict, Where,
};
use crate::joint::{EffectId, Stage};
pub(super) use crate::report::chances::power;
use crate::report::chances::{self, Chances};
use crate::report::number::{between, quantity, share, shares, significant, spoken, stands_out};
use crate::report::rows::ParameterCells;

/// What stands beside intervals that cannot be believed.
pub(in crate::report) const UNTRUSTED: &str = "Something is left in these logs that the model does not explain: the intervals allow \
    for its correlation but not for all of the bias that comes with it, so do not trust them.";

/// What the column `worse by` of the ranking means.
pub(in crate::report) const BEHIND: &str = "Closes alone: share of what refitted numbers leave. Worse by: how much worse than the best it \
    predicts, in standard deviations of that difference; less than two may be chance.";

/// What stands above the sizes that would have been seen.
pub(in crate::report) const DETECTABLE: &str = "Smallest size of each effect that these logs would have shown (of limits, stops and stiffness between motor and link the largest \
     value):";

/// What stands above the sentences about it.
pub(in crate::report) const UNDETERMINED: &str = "What these logs cannot determine";

/// An experiment that decides with less than this probability is no advice.
const DECIDES: f64 = 0.2;

/// Logs that a sentence names.
const MOST_NAMED: usize = 4;

/// The next experiment, whose motion is in that file.
pub(in crate::report) fn next(next: &Next, file: &str) -> String {
    let power = power(next.power);
    if next.power < DECIDES && next.motion.is_some() {
        return format!(
            "No motion that was tried would tell much: the best of them, in {file}, decides with probability {power}."
        );
    }
    let is_untold = next.motion.is_some() && !next.what.contains(NEXT_FILE);
    let where_from = if is_untold { format!(" The motion is in {file}.") } else { String::new() };
    let what = next.what.replace(NEXT_FILE, file);
    format!("{what} It would decide with probability {power}.{where_from}")
}

/// What stands in its place where there is none.
pub(in crate::report) fn no_next(diagnosis: &Diagnosis) -> &'static str {
    if diagnosis.budget.as_ref().is_some_and(|spent| !spent.not_tried.is_empty()) {
        "None was looked for: the search was ended by its time."
    } else if diagnosis.answer.verdict == Verdict::Unexplained {
        "No motion would tell the effects I know apart any better. What is left is none of them; a log in which it is larger would say \
         more of it."
    } else if diagnosis.causes.iter().any(|cause| cause.equivalent.len() > 1) {
        "None is needed to tell the first cause apart; for the others none is looked for."
    } else {
        "None is needed to tell effects apart."
    }
}

/// A variable in a sentence.
pub(in crate::report) fn variable(variable: Variable) -> &'static str {
    match variable {
        Variable::Speed => "speed",
        Variable::Direction => "direction of motion",
        Variable::Angle => "angle",
        Variable::Load => "gravity load",
        Variable::Time => "time in the log",
        Variable::SetpointRate => "slope of the setpoint",
        Variable::Torque => "motor torque",
        Variable::Amplitude => "amplitude of the swing",
    }
}

/// A stage in a sentence: where something is missing.
fn stage(stage: Stage) -> &'static str {
    match stage {
        Stage::Setpoint => "in the setpoints that reach the controller",
        Stage::Delay => "in the time at which setpoints act",
        Stage::Controller => "in the control law",
        Stage::Motor => "in the torque that the motor delivers",
        Stage::Gearing => "between motor and link",
        Stage::Link => "at the link: its friction, gravity, springs or stops",
        Stage::Sensor => "in the reading of the angle",
    }
}

/// A phase in a sentence.
fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::Hold => "while the joint is held",
        Phase::Stick => "while the joint sticks",
        Phase::Reversal => "around reversals",
        Phase::Run => "while the joint moves",
        Phase::Saturation => "near the motor's largest torque",
        Phase::Stop => "at a stop",
    }
}

/// The effects that were added for the answer, or that are known so far, and a law beside them; `None` where no effect was.
pub(super) fn answer(diagnosis: &Diagnosis) -> Option<String> {
    if !matches!(diagnosis.answer.verdict, Verdict::Effect | Verdict::Unexplained) {
        return None;
    }
    let mut with: Vec<String> = match &diagnosis.causes[..] {
        [] => return None,
        few @ ([_] | [_, _]) => few.iter().map(|cause| cause.effect.to_string()).collect(),
        more => vec![format!("all {} causes", more.len())],
    };
    with.extend(diagnosis.law.is_some().then(|| "a law".to_owned()));
    Some(format!("with {}", with.join(" and ")))
}

/// Whether an effect is part of the answer, or comes closest where there is none.
pub(super) fn is_named(answer: &Answer, effect: EffectId) -> bool {
    let closest = answer.partial.filter(|_| answer.verdict == Verdict::Unexplained);
    answer.equivalent.contains(&effect) || [answer.second, closest].contains(&Some(effect))
}

/// What the effects that [`is_named`] marks are; `None` where it marks none.
pub(super) fn mark(answer: &Answer) -> Option<&'static str> {
    match (answer.verdict, answer.equivalent.len()) {
        (Verdict::Unexplained, _) => answer.partial.map(|_| "comes closest"),
        (Verdict::Effect, 2..) => Some("cannot be told apart by these logs"),
        (Verdict::Effect, _) => Some("the answer"),
        _ => None,
    }
}

/// The logs that a gap's figures are of.
pub(super) fn logs_of(gap: &Gap) -> &'static str {
    if gap.is_held_out() { "held-out logs" } else { "validate logs (fitted)" }
}

/// One of them.
pub(super) fn log_of(gap: &Gap) -> &'static str {
    if gap.is_held_out() { "held-out log" } else { "validate log (fitted)" }
}

/// Logs and phases of the map, each in the order in which it is shown.
pub(super) fn files_and_phases(cells: &[MapCell]) -> (Vec<&str>, Vec<Phase>) {
    let phases = Phase::ALL.into_iter().filter(|phase| cells.iter().any(|cell| cell.phase == *phase)).collect();
    let mut files: Vec<&str> = Vec::new();
    for cell in cells {
        if !files.contains(&cell.file.as_str()) {
            files.push(&cell.file);
        }
    }
    (files, phases)
}

/// The shares of a map's cells; together they are the gap.
pub(super) fn shares_of_cells(cells: &[MapCell]) -> Vec<String> {
    shares(&cells.iter().map(|cell| cell.share).collect::<Vec<f64>>())
}

/// Whether a map has anything to show: nothing is placed where nothing is left.
pub(super) fn is_mapped(cells: &[MapCell]) -> bool {
    cells.iter().any(|cell| cell.share >= LEAST_SHOWN)
}

/// A smaller share is shown as none.
const LEAST_SHOWN: f64 = 0.005;

/// Names of files without their folders, where these are not needed to tell them apart.
pub(super) fn names_without_folder(files: &[&str]) -> Vec<String> {
    let bare = |file: &&str| file.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
    let names: Vec<String> = files.iter().map(bare).collect();
    let is_alone = |name: &String| names.iter().filter(|other| *other == name).count() == 1;
    if names.iter().all(is_alone) { names } else { files.iter().map(|file| (*file).to_owned()).collect() }
}

/// Probabilities of the answer, of its rivals, and of something else, as they are shown.
pub(super) fn chances(diagnosis: &Diagnosis) -> Chances {
    let answer = &diagnosis.answer;
    let candidate = |candidate: &Candidate| chances::Candidate {
        name: candidate.effect.id().to_owned(),
        probability: candidate.probability,
        is_named: is_named(answer, candidate.effect),
    };
    Chances::of(answer.probability, &diagnosis.ranking.iter().map(candidate).collect::<Vec<_>>())
}

/// Where the gap lies, in a few sentences.
pub(super) fn location(location: &Where) -> String {
    let mut sentences = vec![match location.stage {
        Some(of) => format!("The gap lies {} (stage `{}`).", stage(of), of.name()),
        None => "There is no gap to place.".to_owned(),
    }];
    // A setpoint that acts late or otherwise is no torque.
    let is_torque = !matches!(location.stage, Some(Stage::Setpoint | Stage::Delay));
    let variable_seen = location.variable.filter(|_| is_torque);
    if let Some(variable_of) = variable_seen {
        let range = location.range.map(|ends| format!(", {}", range(variable_of, ends))).unwrap_or_default();
        sentences.push(format!("The torque that is missing depends most on the {}{range}.", variable(variable_of)));
    }
    if location.stage.is_some() {
        let when = location.phase.map(|p| format!(", most of it {}", phase(p))).unwrap_or_default();
        let of = if variable_seen.is_some() { "that torque, by squares," } else { GAP };
        sentences.push(there(of, location.share, &when));
        if !location.logs.is_empty() {
            let (named, others) = location.logs.split_at(MOST_NAMED.min(location.logs.len()));
            let more = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
            sentences.push(format!("Logs with more than their share: {}{more}.", named.join(", ")));
        }
    }
    sentences.join(" ")
}

/// `between 0 and 0.40 rad/s`, `at 0.34 N m`; a direction in words.
pub(in crate::report) fn range(variable: Variable, [low, high]: [f64; 2]) -> String {
    match (variable, low, high) {
        (Variable::Direction, _, high) if high <= 0.0 => "in the negative direction".to_owned(),
        (Variable::Direction, low, _) if low >= 0.0 => "in the positive direction".to_owned(),
        (Variable::Direction, ..) => "in both directions".to_owned(),
        _ => between([low, high], variable.unit()),
    }
}

/// What is where it was placed.
pub(in crate::report) const GAP: &str = "the gap";

/// How much of something is where it was placed; `when` ends the sentence.
pub(in crate::report) fn there(of: &str, part: f64, when: &str) -> String {
    if stands_out(part) {
        format!("{} of {of} is there{when}.", share(part))
    } else {
        "No share of the gap stands out there: it is spread over all that the logs show.".to_owned()
    }
}

/// `mu_st 0.0120 [0.0110, 0.0130] N m`
pub(in crate::report) fn parameter(number: &Number) -> String {
    match number.interval {
        Some(interval) if number.value.is_finite() => {
            format!("{} {}", number.name, quantity(number.value, Some(interval), &number.unit))
        }
        None if is_side(number) => format!("{} {:+}", number.name, number.value),
        _ => format!("{} {}", number.name, ParameterCells::from(&number_row(number)).estimate),
    }
}

/// `mu_st 0.0031 N m`, or that the logs cannot show it.
pub(super) fn threshold(detectable: &Detectable) -> String {
    // A gain differs from one, not from nothing.
    let digits = if detectable.effect == EffectId::MotorGain { 3 } else { 2 };
    size(detectable.name, detectable.value, detectable.unit, digits)
}

/// The smallest size of a parameter that would have been seen; `None`: none would.
pub(in crate::report) fn size(name: &str, value: Option<f64>, unit: &str, digits: i32) -> String {
    match value {
        Some(value) => format!("{name} {} {}", significant(value, digits), spoken(unit)).trim_end().to_owned(),
        None => "not at any size".to_owned(),
    }
}

/// `0.93 [0.90, 0.95]` as percentages.
pub(in crate::report) fn closed(closed: Option<f64>, interval: Option<[f64; 2]>) -> String {
    match (closed, interval) {
        (Some(closed), Some([low, high])) if low.is_finite() && high.is_finite() => {
            format!("{} [{}, {}]", share(closed), share(low), share(high))
        }
        (Some(closed), _) => share(closed),
        (None, _) => "no gap above the noise".to_owned(),
    }
}

/// A share of the gap that a step closes; one that opens it is negative.
pub(super) fn part(share: f64) -> String {
    if share.is_finite() { crate::report::number::share(share) } else { String::new() }
}

/// Doubts of the study's numbers, the notes of the diagnosis, then what was left out by demand.
pub(super) fn notes(report: &GapReport) -> Vec<String> {
    let mut notes = report.diagnosis.doubts.clone();
    notes.extend(report.diagnosis.notes.iter().cloned());
    notes.extend(on_demand(&ids(&report.diagnosis.withheld, &[]), &[]));
    notes
}

/// Ids of effects, and then of what may be other about bodies.
pub(in crate::report) fn ids(effects: &[EffectId], bodies: &[BodyKind]) -> Vec<&'static str> {
    effects.iter().map(|effect| effect.id()).chain(bodies.iter().map(|kind| kind.id())).collect()
}

/// What was left out and what was singled out by demand, by ids.
pub(in crate::report) fn on_demand(without: &[&str], only: &[&str]) -> Vec<String> {
    let told = |what: &str, ids: &[&str]| (!ids.is_empty()).then(|| format!("{what} on demand: {}.", ids.join(", ")));
    let singled_out = told("Only these causes were considered,", only);
    told("Withheld from the catalogue", without).into_iter().chain(singled_out).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn folders_are_left_out_where_names_differ_without_them() {
        assert_eq!(names_without_folder(&["a/one.csv", "b/two.csv"]), ["one.csv", "two.csv"]);
        assert_eq!(names_without_folder(&["a/one.csv", "b/one.csv"]), ["a/one.csv", "b/one.csv"]);
    }

    #[test]
    fn place_is_said_in_words() {
        let mut place = sample::set_of_two().diagnosis.location;
        assert_eq!(
            location(&place),
            "The gap lies at the link: its friction, gravity, springs or stops (stage `link`). The torque that is missing depends most on the speed, between 0 and 0.42 \
             rad/s. 71 % of that torque, by squares, is there, most of it around reversals. Logs with more than their share: \
             swing-03-220g.csv, swing-02-220g.csv."
        );
        place.logs = (0..6).map(|i| format!("{i}.csv")).collect();
        assert!(location(&place).ends_with("0.csv, 1.csv, 2.csv, 3.csv and 2 more."));
        assert_eq!(location(&sample::nothing_missing().diagnosis.location), "There is no gap to place.");
        assert_eq!(range(Variable::Direction, [0.0, 1.0]), "in the positive direction");
        assert_eq!(range(Variable::Load, [0.3401, 0.3404]), "at 0.340 N m");
        place.share = 0.004;
        let said = location(&place);
        assert!(said.contains(" No share of the gap stands out there") && !said.contains("0 %"), "{said}");
        assert!(!said.contains("around reversals"), "{said}");
    }

    #[test]
    fn what_several_causes_leave_is_not_put_down_to_the_first() {
        let mut diagnosis = sample::two_effects().diagnosis;
        assert_eq!(answer(&diagnosis).as_deref(), Some("with torque_limit and delay"));
        diagnosis.causes.push(diagnosis.causes[0].clone());
        assert_eq!(answer(&diagnosis).as_deref(), Some("with all 3 causes"));
        diagnosis.answer.verdict = Verdict::Calibration;
        assert_eq!(answer(&diagnosis), None);
    }

    #[test]
    fn no_more_than_all_of_a_gap_closes() {
        assert_eq!(closed(Some(1.02), Some([0.97, 1.05])), "100 % [97 %, 100 %]");
    }

    #[test]
    fn parameters_and_thresholds_are_written_without_a_dash_for_no_unit() {
        let ranking = sample::set_of_two().diagnosis.ranking;
        assert_eq!(parameter(&ranking[1].parameters[0]), "mu_l 0.131 [0.121, 0.143]");
        let side =
            Number { name: "side".into(), value: -1.0, unit: String::new(), interval: None, interval_naive: None };
        assert_eq!(parameter(&side), "side -1");
        let detectable = sample::set_of_two().diagnosis.detectable;
        let written: Vec<String> = detectable.iter().map(threshold).collect();
        assert_eq!(written, ["mu_st 0.0011 N m", "mu_l 0.012", "not at any size"]);
    }
}
