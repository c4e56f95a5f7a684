//! What the report says in words, the same on the page and in the terminal.

use super::RobotGapReport;
use crate::gap::Verdict;
use crate::gap::robot::{
    Cause, Found, GaitCell, GaitPhase, RobotAnswer, RobotCandidate, RobotDetectable, RobotDiagnosis, RobotStage,
    RobotWhere,
};
use crate::joint::Stage;
use crate::report::chances::{self, Chances};
use crate::report::gap::words::{GAP, on_demand, range, size, there, variable};
use crate::report::number::mrad;

/// What stands above the sizes that would have been seen.
pub(super) const DETECTABLE: &str = "Smallest size of each cause that these logs would have shown (of limits, stops and stiffness between motor and link the largest \
     value), on the joint where it shows best:";

/// What the columns of the ranking mean.
pub(super) const BEHIND: &str = "Closes alone: share of what refitted numbers leave above the sensor's noise. Worse by: how much worse than the best a cause \
    explains the samples it was fitted to, as a sum of squares in units of the sensor's noise; below ten or so it may be chance. \
    Causes that are not here explain less already to first order. Both are of a robot simulated with the cause, masses and friction \
    adapted within what is uncertain anyway; on a floor these to first order only.";

/// Probabilities of the answer, of its rivals, and of something else, as they are shown.
pub(super) fn chances(diagnosis: &RobotDiagnosis) -> Chances {
    let answer = &diagnosis.answer;
    let candidate = |candidate: &RobotCandidate| chances::Candidate {
        name: found(&candidate.found),
        probability: candidate.probability,
        is_named: is_named(answer, candidate),
    };
    Chances::of(answer.probability, &diagnosis.ranking.iter().map(candidate).collect::<Vec<_>>())
}

/// From so many joints on a place is said by their number.
const MANY: usize = 5;

/// A phase in a sentence.
fn phase(phase: GaitPhase) -> &'static str {
    match phase {
        GaitPhase::Hold => "while the robot stands",
        GaitPhase::Stance => "in stance",
        GaitPhase::Swing => "in swing",
        GaitPhase::TouchDown => "at touch-down",
        GaitPhase::Run => "while it swings freely",
    }
}

/// `lf2, rf2`; `12 joints`; `the robot`.
pub(super) fn place(joints: &[String]) -> String {
    match joints.len() {
        0 => "the robot".to_owned(),
        n if n >= MANY => format!("{n} joints"),
        _ => joints.join(", "),
    }
}

/// `lf2 and rf2`, in a sentence.
fn places(joints: &[String]) -> String {
    match joints {
        [one, two] => format!("{one} and {two}"),
        _ => place(joints),
    }
}

/// `motor_gain lf2, rf2`
pub(super) fn found(found: &Found) -> String {
    if found.joints.is_empty() { found.cause.to_string() } else { format!("{} {}", found.cause, place(&found.joints)) }
}

/// The causes that were added for the answer, or the one that comes closest; `None` where nothing was added.
pub(super) fn answer(answer: &RobotAnswer) -> Option<String> {
    let first = answer.first.as_ref().or(answer.partial.as_ref())?;
    let second = answer.second.as_ref().map_or_else(String::new, |second| format!(" and {}", found(second)));
    Some(format!("with {}{second}", found(first)))
}

/// Whether a candidate is part of the answer, stands as well as it, or comes closest where there is none.
pub(super) fn is_named(answer: &RobotAnswer, candidate: &RobotCandidate) -> bool {
    let Found { cause, joints, .. } = &candidate.found;
    let is = |found: &Found| found.cause == *cause && found.joints == *joints;
    let first = answer.first.as_ref().or(answer.partial.as_ref());
    if first.into_iter().chain(&answer.second).any(is) {
        return true;
    }
    answer.equivalent.contains(cause) && (cause.is_of_robot() || answer.places.contains(joints))
}

/// What the candidates that [`is_named`] marks are; `None` where it marks none.
pub(super) fn mark(answer: &RobotAnswer) -> Option<&'static str> {
    match answer.verdict {
        Verdict::None => None,
        Verdict::Unexplained => answer.partial.as_ref().map(|_| "comes closest"),
        _ if answer.equivalent.len() > 1 || answer.places.len() > 1 => Some("cannot be told apart by these logs"),
        _ => Some("the answer"),
    }
}

/// Joints and phases of the map, each in the order in which it is shown.
pub(super) fn joints_and_phases(cells: &[GaitCell]) -> (Vec<&str>, Vec<GaitPhase>) {
    let phases = GaitPhase::ALL.into_iter().filter(|phase| cells.iter().any(|cell| cell.phase == *phase)).collect();
    let mut joints: Vec<&str> = Vec::new();
    for cell in cells {
        if !joints.contains(&cell.joint.as_str()) {
            joints.push(&cell.joint);
        }
    }
    (joints, phases)
}

/// A stage in a sentence.
fn at(stage: RobotStage) -> &'static str {
    match stage {
        RobotStage::Joint(Stage::Setpoint) => "in the setpoints that reach the controller",
        RobotStage::Joint(Stage::Delay) => "in the time at which setpoints act",
        RobotStage::Joint(Stage::Controller) => "in the control law",
        RobotStage::Joint(Stage::Motor) => "in the torque that the motor delivers",
        RobotStage::Joint(Stage::Gearing) => "between motor and link",
        RobotStage::Joint(Stage::Link) => "at the link (its friction, gravity, springs or stops)",
        RobotStage::Joint(Stage::Sensor) => "in the reading of the angle",
        RobotStage::Floor => "the floor",
        RobotStage::Trunk => "what the trunk carries",
    }
}

/// Where the gap lies, in a few sentences.
pub(super) fn location(location: &RobotWhere) -> String {
    let when = location.phase.map_or_else(String::new, |of| format!(", most of it {}", phase(of)));
    let mut sentences = match (location.stage, location.joints.is_empty()) {
        (Some(stage), true) => vec![format!("The gap comes from {} (stage `{}`).", at(stage), stage.name())],
        (Some(stage), false) => vec![
            format!("The gap lies {}, on {} (stage `{}`).", at(stage), places(&location.joints), stage.name()),
            there(GAP, location.share, &when),
        ],
        (None, true) => vec!["There is no gap to place.".to_owned()],
        (None, false) => {
            vec![format!("Most of the gap is seen in {}.", places(&location.joints)), there(GAP, location.share, &when)]
        }
    };
    // Neither a setpoint that acts late nor another floor is a torque that is missing in a joint.
    let is_torque = match location.stage {
        Some(RobotStage::Joint(stage)) => !matches!(stage, Stage::Setpoint | Stage::Delay),
        Some(RobotStage::Floor | RobotStage::Trunk) => false,
        None => true,
    };
    if let Some(of) = location.variable.filter(|_| is_torque) {
        let ends = location.range.map(|ends| format!(", {}", range(of, ends))).unwrap_or_default();
        sentences.push(format!("The torque that is missing depends most on the {}{ends}.", variable(of)));
    }
    if !location.logs.is_empty() {
        sentences.push(format!("Logs with more than their share: {}.", location.logs.join(", ")));
    }
    sentences.join(" ")
}

/// `mu_st 0.0031 N m`, or that the logs cannot show it.
pub(super) fn threshold(detectable: &RobotDetectable) -> String {
    size(detectable.name, detectable.value, detectable.unit, 2)
}

/// The repaired robot is worth a note where it leaves so much more than the answer.
const WORSE: f64 = 1.2;

/// The notes of the diagnosis, what the repaired robot leaves, then what was left out or singled out by demand.
pub(super) fn notes(report: &RobotGapReport) -> Vec<String> {
    let mut notes = report.diagnosis.notes.clone();
    let after = report.diagnosis.gap.after;
    if let Some(rms) = report.diagnosis.repaired_rms_rad().filter(|rms| *rms > WORSE * after) {
        notes.push(format!(
            "The repaired robot itself leaves {}, more than the {} above: those have masses and friction adapted within \
             what is uncertain anyway, which its file does not have.",
            mrad(rms),
            mrad(after)
        ));
    }
    let ids = |causes: &[Cause]| causes.iter().map(|cause| cause.id()).collect::<Vec<_>>();
    notes.extend(on_demand(&ids(&report.diagnosis.withheld), &ids(&report.options.only)));
    notes
}
