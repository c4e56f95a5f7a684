//! The report of a robot with a clamped base: all joints at a glance, and a report for each of them.
//!
//! A joint's own report is that of the bench (`report::gap`), in a folder with the joint's name.

mod animation;
mod html;
mod json;
mod map;
mod text;
mod waterfall;

pub use html::{clamped_gap_figures, clamped_gap_html};
pub use json::clamped_gap_json;
pub use text::clamped_gap_text;

use super::{Animation, GapReport, LogHealthRow, Provenance, percent_of_answer};
use crate::gap::clamped::{ClampedCase, ClampedDiagnosis, ClampedSetup};
use crate::gap::inverse::{ClampedFound, TorqueDiagnosis, TorqueTraces};
use crate::gap::whole::{FoundRobot, LeftOut, Whole, found_robot, simulated};
use crate::gap::{BeliefFound, Diagnosis, GapOptions, LogGap, Verdict};
use crate::report::by_joint::by_joint;
use crate::report::data_health::health_rows_of_joint;
use crate::report::gap::waterfall::HARDLY;
use crate::report::gap::{NEXT_FILE, words};
use crate::report::measure::{ANGLE, Measure};
use crate::report::number::{significant, spoken};
use std::path::PathBuf;

/// Name of the moving picture beside a report.
pub const ANIMATION_FILE: &str = "animation.html";

/// A robot's diagnosis with what was asked and where it comes from.
#[derive(Clone, Debug)]
pub struct ClampedGapReport {
    /// What was found.
    pub diagnosis: ClampedDiagnosis,
    /// The reports of those joints that move, with the joint's folder.
    pub joints: Vec<(String, GapReport)>,
    /// The description that was read, and what was found as numbers of it.
    pub model: PathBuf,
    /// See `model`.
    pub found: FoundRobot,
    /// The whole robot simulated at once; an error says why not. `None` where torques are predicted.
    pub whole: Option<Result<Whole, String>>,
    /// The robot as given, as found and logged; `None` where it was not simulated as a whole.
    pub animation: Option<Animation>,
    /// What was asked.
    pub options: GapOptions,
    /// Where the report comes from.
    pub provenance: Provenance,
}

impl ClampedGapReport {
    /// The report of what was found.
    pub fn new(setup: &ClampedSetup, found: ClampedFound, options: &GapOptions, provenance: &Provenance) -> Self {
        match found {
            ClampedFound::Motion { case, diagnosis } => Self::of_motion(setup, &case, diagnosis, options, provenance),
            ClampedFound::Torque(diagnosis) => Self::of_torques(setup, diagnosis, options, provenance),
        }
    }

    /// The report of a case's diagnosis.
    fn of_motion(
        setup: &ClampedSetup,
        case: &ClampedCase,
        mut diagnosis: ClampedDiagnosis,
        options: &GapOptions,
        provenance: &Provenance,
    ) -> Self {
        let found = diagnosis.joints.iter().filter_map(|joint| Some((&joint.joint, joint.diagnosis.clone()?)));
        let report = |(name, diagnosis): (&String, Diagnosis)| {
            let own = case.joints.iter().find(|joint| joint.name == *name)?;
            Some(GapReport::new(&own.case, diagnosis, options.clone(), provenance.clone()))
        };
        let joints = in_folders(found.filter_map(report));
        let whole = simulated(setup, &diagnosis);
        if let Ok(whole) = &whole {
            diagnosis.answer.sentence += &whole_words(whole, &diagnosis);
        }
        let found = match &whole {
            Ok(whole) => whole.robot.clone(),
            Err(_) => found_robot(setup, Some(&diagnosis)).unwrap_or_default(),
        };
        let told: Vec<&Diagnosis> = diagnosis.found().collect();
        let animation = whole.as_ref().ok().and_then(|whole| animation::animation(setup, whole, &told));
        let whole = Some(whole);
        let model = setup.study.model_path.clone();
        let (options, provenance) = (options.clone(), provenance.clone());
        Self { diagnosis, joints, model, found, whole, animation, options, provenance }
    }

    /// The report of a diagnosis by torques.
    fn of_torques(
        setup: &ClampedSetup,
        diagnosis: TorqueDiagnosis,
        options: &GapOptions,
        provenance: &Provenance,
    ) -> Self {
        let TorqueDiagnosis { found, traces } = diagnosis;
        let diagnosed = found.joints.iter().filter_map(|joint| Some((&joint.joint, joint.diagnosis.clone()?)));
        let report = |((name, diagnosis), torques): ((&String, Diagnosis), Vec<TorqueTraces>)| {
            let (options, provenance) = (options.clone(), provenance.clone());
            let health = health_rows_of_joint(setup, name);
            GapReport { diagnosis, options, health, armature_kg_m2: None, drive: None, provenance, torques }
        };
        let joints = in_folders(diagnosed.zip(traces).map(report));
        let numbers = found_robot(setup, Some(&found)).unwrap_or_default();
        let model = setup.study.model_path.clone();
        let (options, provenance) = (options.clone(), provenance.clone());
        let (whole, animation) = (None, None);
        Self { diagnosis: found, joints, model, found: numbers, whole, animation, options, provenance }
    }

    /// The health of the logs, joint by joint.
    fn health(&self) -> Vec<(&str, &[LogHealthRow])> {
        self.joints.iter().map(|(_, report)| (report.diagnosis.joint.as_str(), &report.health[..])).collect()
    }

    /// What is to be questioned of the study, each once, after the joints that it is true of.
    pub fn doubts(&self) -> Vec<String> {
        let told = self.joints.iter().map(|(_, report)| report);
        by_joint(
            told.flat_map(|of| {
                of.diagnosis.doubts.iter().map(move |doubt| (of.diagnosis.joint.as_str(), doubt.as_str()))
            }),
        )
    }

    /// What the logs leave open, joint by joint.
    fn undetermined(&self) -> Vec<String> {
        let told = self.joints.iter().map(|(_, report)| &report.diagnosis);
        by_joint(told.flat_map(|of| of.undetermined.iter().map(move |sentence| (of.joint.as_str(), sentence.as_str()))))
    }

    /// The joint with the most left of those that have a next experiment, with its folder.
    fn to_ask_next(&self) -> Option<&(String, GapReport)> {
        let left = |report: &GapReport| report.diagnosis.gap.after;
        let asked = self.joints.iter().filter(|(_, report)| report.diagnosis.next.is_some());
        asked.max_by(|(_, a), (_, b)| left(a).total_cmp(&left(b)))
    }

    /// The next experiment in words.
    fn next(&self) -> Option<String> {
        let (folder, report) = self.to_ask_next()?;
        let words = words::next(report.diagnosis.next.as_ref()?, &format!("{folder}/{NEXT_FILE}"));
        Some(format!("Next, on {}: {words}", report.diagnosis.joint))
    }

    /// The notes of the diagnosis, then what was left out or singled out by demand.
    fn notes(&self) -> Vec<String> {
        let GapOptions { without, only, without_bodies, only_bodies, .. } = &self.options;
        let mut notes = self.diagnosis.notes.clone();
        notes.extend(words::on_demand(&words::ids(without, without_bodies), &words::ids(only, only_bodies)));
        notes
    }

    /// A joint's own sentence; that the search was ended by its time is told by the robot's.
    fn own_sentence<'a>(&self, joint: &'a Diagnosis) -> &'a str {
        let sentence = joint.answer.sentence.as_str();
        self.diagnosis.budget.as_ref().map_or(sentence, |spent| spent.bare(sentence))
    }

    /// What the columns of the joints at a glance are.
    fn columns(&self) -> String {
        let sure = if Measure::of(self.diagnosis.gap.unit) == ANGLE { RATE } else { REDRAWS };
        format!(
            "What: causes, and numbers found beside those that were believed, where they moved by two of their standard \
             deviations and more, or are the answer. Sure: {sure}."
        )
    }

    /// What one simulation of the whole robot says.
    fn whole_words(&self) -> Option<String> {
        Some(match self.whole.as_ref()? {
            Ok(whole) => {
                let [before, after] = [whole.before, whole.after].map(crate::report::number::mrad);
                let what = if whole.left_out.is_empty() { "everything" } else { "the rest" };
                format!(
                    "The whole robot simulated at once under the study's setpoints is {before} off as given and {after} with \
                     {what} that was found."
                )
            }
            Err(why) => format!("The whole robot was not simulated at once: {why}."),
        })
    }

    /// How far each joint's gap closes, and all of them together.
    fn rows(&self) -> Vec<LogGap> {
        let gap = &self.diagnosis.gap;
        let of = |diagnosis: &Diagnosis| {
            let own = &diagnosis.gap;
            LogGap {
                file: diagnosis.joint.clone(),
                before: own.before,
                calibrated: own.calibrated,
                after: own.after,
                floor: own.floor,
            }
        };
        let all = LogGap {
            file: "all joints".to_owned(),
            before: gap.before,
            calibrated: gap.calibrated,
            after: gap.after,
            floor: gap.floor,
        };
        self.joints.iter().map(|(_, report)| of(&report.diagnosis)).chain([all]).collect()
    }
}

/// Which logs the figures over all joints are of.
pub(super) fn logs_of(diagnosis: &ClampedDiagnosis) -> &'static str {
    let is_held_out = diagnosis.found().all(|own| own.gap.is_held_out());
    if is_held_out { "held-out logs" } else { "validate logs (of some joints fitted)" }
}

/// What the whole robot says against the answers; empty where it is better with all of them.
fn whole_words(whole: &Whole, diagnosis: &ClampedDiagnosis) -> String {
    use crate::report::number::mrad;
    let mut text = String::new();
    if diagnosis.answer.verdict != Verdict::None && whole.before < HARDLY * diagnosis.gap.floor {
        text += &format!(
            " With all joints simulated at once nothing is missing: as stated the robot explains the held-out logs that setpoints \
             drive to their noise ({}). What is said of single joints comes of following their neighbours along samples that are too far \
             apart.",
            mrad(whole.before)
        );
    }
    if !whole.left_out.is_empty() {
        let what = |left: &LeftOut| {
            let change = left
                .joint
                .as_ref()
                .map_or_else(|| "masses as found".to_owned(), |joint| format!("what was found on {joint}"));
            let with_it =
                if left.with_it.is_finite() { mrad(left.with_it) } else { "nothing: it runs away".to_owned() };
            format!("{change} ({with_it} with it, {} without)", mrad(left.without_it))
        };
        let all: Vec<String> = whole.left_out.iter().map(what).collect();
        text += &format!(
            " With all joints simulated at once the robot is worse with {}; that is left out of the whole and of what is exported.",
            all.join(", then with ")
        );
    }
    if whole.after > whole.before {
        text += &format!(
            " All at once the robot is not better with what was found: {} as given, {} with it.",
            mrad(whole.before),
            mrad(whole.after)
        );
    }
    text
}

/// Reports with a folder of its own for each.
fn in_folders(reports: impl Iterator<Item = GapReport>) -> Vec<(String, GapReport)> {
    let mut joints: Vec<(String, GapReport)> = Vec::new();
    for report in reports {
        let folder =
            folder_of(&report.diagnosis.joint, |taken| joints.iter().any(|(folder, _)| is_same(folder, taken)));
        joints.push((folder, report));
    }
    joints
}

/// A joint's name as the name of a folder that no other joint has: descriptions have names with slashes, blanks and points.
fn folder_of(joint: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let folder: String = joint.chars().map(plain).collect();
    if !is_taken(&folder) {
        return folder;
    }
    let mut numbered = (2..).map(|number: usize| format!("{folder}-{number}"));
    numbered.find(|folder| !is_taken(folder)).expect("no report has endlessly many joints")
}

/// Whether two names are one to a file system that does not tell small letters from large ones.
fn is_same(folder: &str, other: &str) -> bool {
    folder.to_lowercase() == other.to_lowercase()
}

/// How sure a joint's answer is, where that is stated.
fn sure(diagnosis: &Diagnosis) -> String {
    diagnosis.answer.probability.map_or_else(|| "-".to_owned(), percent_of_answer)
}

/// What a joint carries that is other than described and its causes, in few words, and the numbers that had to move far.
fn summary(report: &ClampedGapReport, diagnosis: &Diagnosis) -> String {
    let carried: Vec<String> = report
        .diagnosis
        .bodies
        .iter()
        .filter(|body| body.joints.contains(&diagnosis.joint))
        .map(|body| body.name().id())
        .collect();
    let causes = diagnosis.causes.iter().map(|cause| cause.effect.id().to_owned());
    let law = diagnosis.law.is_some().then(|| "a law".to_owned());
    // Where it is what the joint carries, the number that moved most is no answer.
    let is_answer = |belief: &BeliefFound| carried.is_empty() && diagnosis.names(belief);
    let is_told = |belief: &&BeliefFound| belief.moved_sd.abs() >= TOLD_SD || is_answer(belief);
    let mut moved: Vec<&BeliefFound> = diagnosis.beliefs.iter().filter(is_told).collect();
    moved.sort_by(|a, b| b.moved_sd.abs().total_cmp(&a.moved_sd.abs()));
    let numbers = moved.into_iter().take(MOVED).map(|belief| {
        // As many digits as tell them apart.
        let differ = |digits: &i32| significant(belief.found, *digits) != significant(belief.believed, *digits);
        let digits = (2..MOST_DIGITS).find(differ).unwrap_or(MOST_DIGITS);
        let value = |value: f64| significant(value, digits);
        let unit = spoken(&belief.unit);
        format!("{} {} {unit} (was {})", belief.name, value(belief.found), value(belief.believed)).replace("  ", " ")
    });
    let all: Vec<String> = carried.iter().cloned().chain(causes).chain(law).chain(numbers).collect();
    if all.is_empty() { "–".to_owned() } else { all.join(", ") }
}

/// A joint's error step by step: as given, recalibrated, with each cause; `None` where no more than one is named, of which
/// the sentence tells it.
fn step_by_step(diagnosis: &Diagnosis) -> Option<String> {
    let measure = Measure::of(diagnosis.gap.unit);
    let causes = diagnosis.causes.iter().map(|cause| (cause.effect.id(), cause.after));
    let law = diagnosis.law.iter().map(|_| ("a law", diagnosis.gap.after));
    let mut steps: Vec<(&str, f64)> = causes.chain(law).collect();
    if steps.len() < 2 {
        return None;
    }
    // What every cause leaves is told at the end as well; once is enough.
    steps.last_mut()?.1 = diagnosis.gap.after;
    let steps: Vec<String> =
        steps.into_iter().map(|(name, after)| format!("{} with {name}", measure.number(after))).collect();
    let [given, calibrated] = [diagnosis.gap.before, diagnosis.gap.calibrated].map(|error| measure.number(error));
    let (joint, unit) = (&diagnosis.joint, measure.unit);
    Some(format!("{joint}, step by step [{unit}]: {given} as given, {calibrated} recalibrated, {}.", steps.join(", ")))
}

/// What probabilities are, by what is predicted.
const RATE: &str = "how often answers like this one were right in the exam that each joint's own report names";
const REDRAWS: &str = "the share of redraws of the held-out seconds that give the same answer";

/// Standard deviations of its belief from which on a number that moved is told, and how many are.
const TOLD_SD: f64 = 2.0;
const MOVED: usize = 2;
/// Digits of a number that has hardly moved.
const MOST_DIGITS: i32 = 4;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_whose_names_differ_have_folders_that_do() {
        let mut taken: Vec<String> = Vec::new();
        for joint in ["\u{80a9}", "\u{8098}", "arm/elbow", "arm elbow", "Arm.Elbow", "arm_elbow-2"] {
            let folder = folder_of(joint, |name| taken.iter().any(|folder| is_same(folder, name)));
            taken.push(folder);
        }
        let expected = ["\u{80a9}", "\u{8098}", "arm_elbow", "arm_elbow-2", "Arm_Elbow-3", "arm_elbow-2-2"];
        assert_eq!(taken, expected);
    }
}
