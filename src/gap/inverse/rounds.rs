//! Joints along the robot as found: what they push one another with is better known once something was found.

use super::diagnose::TorqueError;
use crate::gap::clamped::{
    ClampedCase, ClampedDiagnosis, ClampedJoint, ClampedSetup, JointAnswer, concluded_of, diagnose_clamped,
    diagnose_joints,
};
use crate::gap::hypothesis::evidence::WholeLeft;
use crate::gap::verdict::decide::leaves_something;
use crate::gap::whole::{AsFound, as_found};
use crate::gap::{GapError, GapOptions, Verdict};
use crate::joint::EffectId;
use crate::progress::{Progress, Step};
use crate::robot::description::{FoundKey, FoundNumber};

/// Times that joints are followed anew along the robot as found, and what of the error another has to leave at most.
const ROUNDS: usize = 2;
const WORTH_A_ROUND: f64 = 0.9;
/// What is left out where that is not.
const AS_FOUND: &str = "joints along the robot as found";
/// What held-out logs had a say in where it is.
const FOLLOWED: &str =
    "Joints are followed along the robot as found, with which they predict the held-out logs better, or no worse.";
/// With something changed about the robot the joints' error may be so much larger, relative.
pub(super) const NO_WORSE: f64 = 1.02;

/// The joints along the robot as found, again and again, where that follows motions better which the logs hardly resolve: what
/// joints push one another with is then known better, and so is what is missing.
pub(super) fn followed(
    setup: &ClampedSetup,
    options: &GapOptions,
    progress: &dyn Progress,
    (mut case, mut found): (ClampedCase, ClampedDiagnosis),
) -> Result<(ClampedCase, ClampedDiagnosis), TorqueError> {
    let allows = |effect: EffectId| options.considers(effect);
    let (mut rounds, mut may_be_common, mut is_chosen) = (0, true, false);
    while rounds < ROUNDS {
        let is_sound = found.answer.verdict == Verdict::None;
        if is_sound || options.deadline.leaves_out(AS_FOUND) {
            break;
        }
        let Some(robot) = as_found(setup, &found, may_be_common.then_some(&allows), &options.deadline) else { break };
        progress.go_on(Step::stage(AS_FOUND))?;
        case.joints.iter_mut().for_each(|joint| tell(joint, &robot));
        let masses: Vec<FoundNumber> =
            found.weighed.iter().filter(|number| number.key == FoundKey::Mass).cloned().collect();
        let whole = &robot.whole;
        let weighed = if robot.explains { whole.numbers_but_causes() } else { whole.masses() };
        let again = ClampedCase::as_found(setup, &masses, whole)?.map(|mut again| {
            for (joint, before) in again.joints.iter_mut().zip(&case.joints) {
                joint.as_described.clone_from(&before.as_described);
                joint.has_bodies = before.has_bodies;
                joint.whole = before.whole;
                joint.needs_no_cause = before.needs_no_cause;
                joint.at_best.clone_from(&before.at_best);
            }
            again
        });
        if let Some(common) = robot.common {
            // What the whole robot does not need is not asked for.
            let needed = whole.causes.iter().map(|cause| cause.form.id).collect();
            let only = GapOptions { only: needed, ..options.clone() };
            let second = diagnose_clamped(again.as_ref().unwrap_or(&case), &only, progress)?.with_weighed(weighed);
            let second = second.with_common(&common, &|joint| whole.left_rad(joint), &found);
            if second.gap.after < NO_WORSE * found.gap.after
                && second.unexplained().all(|joint| is_unexplained(&found, joint))
            {
                return Ok((again.unwrap_or(case), second.chosen_by_held_out(FOLLOWED)));
            }
            may_be_common = false;
            continue;
        }
        rounds += 1;
        let second = match again {
            None => None,
            Some(again) => {
                let second = diagnose_clamped(&again, options, progress)?.with_weighed(weighed.clone());
                Some((again, second))
            }
        };
        let worth = if robot.explains { NO_WORSE } else { WORTH_A_ROUND };
        let is_better =
            |second: &ClampedDiagnosis| second.gap.after < worth * found.gap.after || explains_one_more(second, &found);
        let Some(better) = second.filter(|(_, second)| is_better(second)) else {
            let weighed = if robot.explains { weighed } else { masses };
            found = explained(&case, options, progress, found, weighed)?;
            break;
        };
        (case, found) = better;
        is_chosen = true;
        if robot.explains && found.accused().len() <= robot.joints.len() {
            break;
        }
    }
    Ok((case, if is_chosen { found.chosen_by_held_out(FOLLOWED) } else { found }))
}

fn is_unexplained(diagnosis: &ClampedDiagnosis, joint: &str) -> bool {
    diagnosis.unexplained().any(|own| own == joint)
}

/// Whether a joint that was left with more than noise is left with much less, and all of them together with no more: of many
/// joints one hardly shows in what they leave together.
fn explains_one_more(second: &ClampedDiagnosis, first: &ClampedDiagnosis) -> bool {
    let both = first.joints.iter().zip(&second.joints);
    let mut gaps =
        both.filter_map(|(before, now)| Some([&before.diagnosis.as_ref()?.gap, &now.diagnosis.as_ref()?.gap]));
    second.gap.after <= first.gap.after
        && gaps.any(|[before, now]| {
            leaves_something(before.after, before.floor) && now.after < WORTH_A_ROUND * before.after
        })
}

/// Tells a joint what the whole robot as found leaves of it, and, where that explains all joints, its causes.
fn tell(joint: &mut ClampedJoint, robot: &AsFound) {
    let left_rad = joint.whole.zip(robot.whole.left_rad(&joint.name));
    joint.whole = left_rad.map(|(before, rad)| WholeLeft {
        bare_rad: if robot.joints.contains(&joint.name) { before.bare_rad } else { rad },
        found_rad: rad,
    });
    joint.at_best = if robot.explains { robot.whole.causes_of(&joint.name) } else { Vec::new() };
}

/// The same with joints diagnosed again that the whole robot explains but nothing did, that have causes which it does not need,
/// or of which it knows the causes better.
fn explained(
    case: &ClampedCase,
    options: &GapOptions,
    progress: &dyn Progress,
    found: ClampedDiagnosis,
    weighed: Vec<FoundNumber>,
) -> Result<ClampedDiagnosis, GapError> {
    let is_explained = |joint: &&ClampedJoint| {
        let own = found.joints.iter().find(|own| own.joint == joint.name).and_then(|own| own.diagnosis.as_ref());
        own.zip(joint.whole).is_some_and(|(own, whole)| {
            let is_better = |left_rad: f64| left_rad < own.gap.after && !leaves_something(left_rad, own.gap.floor);
            match own.answer.verdict {
                Verdict::Unexplained => is_better(whole.found_rad),
                _ => !own.causes.is_empty() && is_better(whole.bare_rad),
            }
        }) || !joint.at_best.is_empty()
    };
    let those: Vec<&ClampedJoint> = case.joints.iter().filter(is_explained).collect();
    if those.is_empty() {
        return Ok(found);
    }
    let again = diagnose_joints(&those, options, &[], progress)?;
    let own = |joint: &JointAnswer| again.iter().find(|own| own.joint == joint.joint).unwrap_or(joint).clone();
    let joints: Vec<JointAnswer> = found.joints.iter().map(own).collect();
    Ok(concluded_of(case, joints).with_weighed(weighed))
}
