//! From the model as given to the floor, step by step, and what became of what was believed: the same in text, figure and
//! JSON.

use super::words;
use crate::gap::{BeliefFound, CauseShare, Diagnosis, LawFound, Verdict};
use crate::report::beliefs;
use crate::report::measure::Measure;
use crate::report::number::quantity;

/// A gap that exceeds the floor by less than this factor is hardly one: shares of it would be numbers without meaning.
pub(in crate::report) use crate::gap::HARDLY_A_GAP as HARDLY;

/// A step with a share below this one opens the gap.
const OPENS: f64 = -0.005;
/// A number that was moved by no more than so many of its standard deviations is as it was believed to be.
const AS_BELIEVED: f64 = 1.0;

/// What a step does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Nothing: the numbers are those of the study.
    Given,
    /// The numbers are refitted within what is believed of them.
    Recalibrated,
    /// A cause is added to those before it.
    Cause,
    /// A curve without a name is added to all causes.
    Law,
    /// None: the sensor's own noise.
    Floor,
}

/// One step of the waterfall.
#[derive(Clone, Debug)]
pub(super) struct Step<'a> {
    pub kind: Kind,
    /// `as given`, `recalibrated`, the id of a cause, `floor`.
    pub name: &'static str,
    /// RMS over the held-out logs after it, in the gap's unit.
    pub rms: f64,
    /// Share of the whole gap above the floor that this step closes; `None` where it closes none by its nature.
    pub closes: Option<f64>,
    /// The cause that it adds.
    pub cause: Option<&'a CauseShare>,
    /// The law that it adds.
    pub law: Option<&'a LawFound>,
}

impl Step<'_> {
    /// The step's name with the form of its cause and the logs in which it holds.
    pub fn label(&self) -> String {
        let of_law = |law: &LawFound| {
            let by: Vec<&str> = law.table.variables.iter().map(|variable| variable.name()).collect();
            format!("{} by {}", law.table.acts, by.join(", "))
        };
        let form = self.cause.map(|cause| cause.form.to_owned()).filter(|form| !form.is_empty());
        let form = form.or_else(|| self.law.map(of_law));
        let form = form.map_or(String::new(), |form| format!(" ({form})"));
        let only = self.cause.and_then(|cause| cause.only.as_ref());
        let only = only.map_or(String::new(), |set| format!(", {}", set.words));
        format!("{}{form}{only}", self.name)
    }

    /// Share of what recalibration leaves that the cause closes alone.
    pub fn alone(&self) -> Option<f64> {
        self.cause.and_then(|cause| cause.alone)
    }

    /// The same with all other causes in place.
    pub fn last(&self) -> Option<f64> {
        self.cause.and_then(|cause| cause.last)
    }
}

/// The steps from as given down to the floor. What recalibration closes is its own step and in no other.
pub(super) fn steps(diagnosis: &Diagnosis) -> Vec<Step<'_>> {
    let gap = &diagnosis.gap;
    let step = |kind, name, rms, cause| Step { kind, name, rms, closes: None, cause, law: None };
    let mut steps = vec![
        step(Kind::Given, "as given", gap.before, None),
        step(Kind::Recalibrated, "recalibrated", gap.calibrated, None),
    ];
    steps.extend(diagnosis.causes.iter().map(|c| step(Kind::Cause, c.effect.id(), c.after, Some(c))));
    let law = diagnosis.law.as_ref();
    steps.extend(law.map(|found| Step { law, ..step(Kind::Law, "law", found.after, None) }));
    let whole = gap.before - gap.floor;
    if gap.before > HARDLY * gap.floor {
        for k in 1..steps.len() {
            let share = (steps[k - 1].rms - steps[k].rms) / whole;
            steps[k].closes = Some(share).filter(|share| share.is_finite());
        }
    }
    steps.push(step(Kind::Floor, "floor", gap.floor, None));
    steps
}

/// Share of what recalibration leaves that is closed down to an RMS; `None` where it leaves hardly anything.
pub(in crate::report) fn closes_alone([calibrated, floor]: [f64; 2], rms: f64) -> Option<f64> {
    let share = (calibrated - rms) / (calibrated - floor);
    Some(share).filter(|share| calibrated > HARDLY * floor && share.is_finite())
}

/// What introduces the steps.
pub(super) fn heading(diagnosis: &Diagnosis) -> &'static str {
    match diagnosis.answer.verdict {
        Verdict::Unexplained => "What is known so far, from as given to the floor",
        _ => "From as given to the floor",
    }
}

/// Whether the sentence of the answer says already which causes these logs cannot tell apart.
fn sentence_tells_apart(diagnosis: &Diagnosis) -> bool {
    matches!(diagnosis.answer.verdict, Verdict::Effect | Verdict::Unexplained) && diagnosis.gap.unit == "rad"
}

/// What the columns of the steps mean, and what is to be kept in mind with these causes.
pub(super) fn explanation(diagnosis: &Diagnosis) -> String {
    let mut text = format!(
        "RMS of the {} over the {}. Closes: share of the whole gap above the floor; what refitting the numbers closes is \
         credited to no cause.",
        Measure::of(diagnosis.gap.unit).what,
        words::logs_of(&diagnosis.gap)
    );
    if !diagnosis.causes.is_empty() {
        text += " Alone: share of what refitted numbers leave that the cause closes by itself; last: with all others \
                 already in place.";
    }
    if steps(diagnosis).iter().any(|step| step.closes.is_some_and(|share| share < OPENS)) {
        text += " Where a share is negative the step predicts these logs worse than without it.";
    }
    let untold = if sentence_tells_apart(diagnosis) { &[][..] } else { &diagnosis.causes };
    for cause in untold {
        let others: Vec<&str> = cause.equivalent.iter().filter(|e| **e != cause.effect).map(|e| e.id()).collect();
        if !others.is_empty() {
            text += &format!(" These logs cannot tell {} from {}.", cause.effect, others.join(" or "));
        }
    }
    if !diagnosis.gap.is_held_out() {
        text += " What was fitted is followed better than what is predicted, so the figures flatter.";
    } else if !diagnosis.gap.outer && !diagnosis.causes.is_empty() {
        text += " These logs also helped to choose the causes, so the figures flatter a little.";
    }
    text
}

/// A number that is not as it was believed to be, in words.
pub(super) struct Moved<'a> {
    pub name: &'a str,
    /// With its standard deviation and its unit.
    pub believed: String,
    /// With its 95 % interval, where there is one, and its unit.
    pub found: String,
    /// By how many standard deviations, with its sign.
    pub moved: String,
    /// Further than belief allows.
    pub is_finding: bool,
}

/// The numbers that were moved by more than one standard deviation of what was believed of them, and the one that the answer
/// names.
pub(super) fn moved(diagnosis: &Diagnosis) -> Vec<Moved<'_>> {
    let is_told = |belief: &&BeliefFound| belief.moved_sd.abs() > AS_BELIEVED || diagnosis.names(belief);
    diagnosis.beliefs.iter().filter(is_told).map(|belief| in_words(diagnosis, belief)).collect()
}

fn in_words<'a>(diagnosis: &Diagnosis, belief: &'a BeliefFound) -> Moved<'a> {
    let interval = diagnosis.parameters.iter().find(|p| p.name == belief.name).and_then(|p| p.interval);
    Moved {
        name: &belief.name,
        believed: beliefs::believed(belief),
        found: quantity(belief.found, interval, &belief.unit),
        moved: beliefs::moved(belief),
        is_finding: belief.is_finding(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn what_recalibration_closes_is_credited_to_no_effect() {
        for (name, report) in sample::all() {
            let diagnosis = &report.diagnosis;
            let steps = steps(diagnosis);
            let of_causes: f64 = steps.iter().filter(|s| s.kind == Kind::Cause).filter_map(|s| s.closes).sum();
            let gap = &diagnosis.gap;
            let below_recalibrated = (gap.calibrated - gap.floor) / (gap.before - gap.floor);
            assert!(of_causes <= below_recalibrated.max(0.0) + 1e-9, "{name}: {of_causes} of {below_recalibrated}");
        }
        let two = sample::two_effects();
        let closes: Vec<Option<f64>> = steps(&two.diagnosis).iter().map(|step| step.closes).collect();
        let whole = 0.061 - 0.0019;
        assert_eq!(closes[0], None);
        assert!((closes[1].unwrap() - (0.061 - 0.034) / whole).abs() < 1e-12);
        assert!((closes[2].unwrap() - (0.034 - 0.012) / whole).abs() < 1e-12);
        assert_eq!(closes[4], None, "the floor closes nothing");
    }

    #[test]
    fn an_effect_that_adds_nothing_to_recalibration_closes_nothing() {
        let gap = sample::set_of_two().diagnosis.gap;
        assert_eq!(closes_alone([gap.calibrated, gap.floor], gap.calibrated), Some(0.0));
        assert_eq!(closes_alone([gap.calibrated, gap.floor], gap.floor), Some(1.0));
        let hardly = sample::nothing_missing().diagnosis.gap;
        assert_eq!(closes_alone([hardly.calibrated, hardly.floor], 0.0019), None);
    }

    #[test]
    fn shares_of_hardly_any_gap_are_not_said() {
        let report = sample::nothing_missing();
        assert!(steps(&report.diagnosis).iter().all(|step| step.closes.is_none()));
    }

    #[test]
    fn only_numbers_that_moved_are_listed_and_far_ones_are_findings() {
        let report = sample::wrong_numbers();
        let moved = moved(&report.diagnosis);
        let names: Vec<(&str, bool)> = moved.iter().map(|row| (row.name, row.is_finding)).collect();
        assert_eq!(names, [("moment", false), ("coulomb", true)]);
        assert_eq!(moved[1].believed, "0.0110 ± 0.0011 N m");
        assert_eq!(moved[1].found, "0.00710 [0.00682, 0.00746] N m");
    }

    #[test]
    fn causes_of_an_unexplained_gap_are_what_is_known_so_far() {
        assert!(heading(&sample::unexplained().diagnosis).starts_with("What is known so far"));
        let words = explanation(&sample::unexplained().diagnosis);
        assert!(words.ends_with("so the figures flatter a little."), "{words}");
    }

    /// Logs that were fitted with the others were once told as held out.
    #[test]
    fn logs_that_were_fitted_are_not_said_to_be_held_out() {
        let mut diagnosis = sample::two_effects().diagnosis;
        assert!(explanation(&diagnosis).contains("over the held-out logs."));
        diagnosis.gap.held_out = crate::gap::NOT_HELD_OUT.to_owned();
        let words = explanation(&diagnosis);
        assert!(words.contains("over the validate logs (fitted).") && !words.contains("held-out"), "{words}");
        assert!(words.ends_with("so the figures flatter."), "{words}");
    }

    #[test]
    fn what_cannot_be_told_apart_is_not_said_again_below_a_sentence_that_says_it() {
        let mut diagnosis = sample::set_of_two().diagnosis;
        assert!(!explanation(&diagnosis).contains("cannot tell"));
        diagnosis.gap.unit = "N m";
        assert!(explanation(&diagnosis).contains("tell stribeck from load_friction"));
        (diagnosis.gap.unit, diagnosis.answer.verdict) = ("rad", Verdict::Unexplained);
        assert!(!explanation(&diagnosis).contains("cannot tell"));
    }
}
