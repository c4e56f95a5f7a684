//! A robot whose motion is predicted, joint by joint, and the bodies that all of its joints ask to be other than described.
//!
//! Bodies are looked for along the measured motion, by the torques that the servos gave as study and description state
//! them, and weighed by the whole robot simulated at once; what is found has to let the simulated joints predict held-out logs
//! no worse.

use super::bodies::{BODIES, MARGIN, find, is_one_payload};
use super::case::TorqueCase;
use super::diagnose::{TorqueError, searched};
use super::rounds::{NO_WORSE, followed};
use super::weigh::{mean_share, weighed_case};
use crate::gap::clamped::{
    BodyCause, BodyName, ClampedCase, ClampedDiagnosis, ClampedJoint, ClampedSetup, JointAnswer, concluded,
    concluded_of, diagnose_clamped, diagnose_joints,
};
use crate::gap::verdict::decide::leaves_something;
use crate::gap::verdict::recalibrated::Refitted;
use crate::gap::whole::{BodyAtBest, body_at_best, numbers_alone_leave_noise, placed_causes};
use crate::gap::{Diagnosis, GapOptions, Verdict};
use crate::joint::EffectId;
use crate::progress::{Progress, Step};
use crate::robot::description::{FoundKey, FoundNumber};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A body that closes less is not named unless it takes the place of causes, or of numbers that no one believes.
const CLOSES: f64 = 0.98;
/// A body is worth a search beside it where numbers alone leave so much less with it, or more of them than its own come back to
/// what is believed.
const PROMISING: f64 = 0.95;
/// Bodies with which the whole robot leaves so little more than with the best explain as much.
const AS_GOOD: f64 = 1.01;
/// Numbers that moved by fewer of their standard deviations ask for nothing.
const MOVED_SD: f64 = 1.0;

/// What held-out logs had a say in where masses are others.
const OTHER_MASSES: &str = "Joints predict the held-out logs better where bodies have other masses.";

/// Diagnoses a robot whose motion is predicted: every joint, then the bodies that they share.
///
/// # Errors
/// [`TorqueError`] where the study makes no case or no joint can be diagnosed.
pub fn diagnose_motion(
    setup: &ClampedSetup,
    options: &GapOptions,
    progress: &dyn Progress,
) -> Result<(ClampedCase, ClampedDiagnosis), TorqueError> {
    let (case, found) = searched_within(setup, options, progress)?;
    Ok((case, found.asked(options).within(&options.deadline)))
}

fn searched_within(
    setup: &ClampedSetup,
    options: &GapOptions,
    progress: &dyn Progress,
) -> Result<(ClampedCase, ClampedDiagnosis), TorqueError> {
    let (case, masses) = weighed_case(setup, options, progress)?;
    let (case, glance) = at_a_glance(setup, (case, &masses), options, progress)?;
    let bodies_were_tried = match glance {
        Glance::Answers(found) => return Ok((case, *found)),
        Glance::Leaves { bodies_were_tried } => bodies_were_tried,
    };
    let are_chosen = !masses.is_empty();
    let first = diagnose_clamped(&case, options, progress)?.with_weighed(masses);
    let (case, mut first) = followed(setup, options, progress, (case, first))?;
    if are_chosen {
        first = first.chosen_by_held_out(OTHER_MASSES);
    }
    // Beside what all joints have, as the whole robot tells it, no body is looked for.
    let has_common = first.causes.iter().any(|cause| cause.common);
    let may_ask = options.considers_bodies() && !has_common && first.found().any(asks);
    if !may_ask || options.deadline.leaves_out(BODIES) {
        return Ok((case, first));
    }
    progress.go_on(Step::stage("payload and masses"))?;
    let mut bodies = may_be_other(setup, &case, &first, options)?;
    // No other one explained anything before.
    bodies.retain(|body| is_asked(body) || !bodies_were_tried);
    let Some(asked) = best_of(setup, bodies, &first, options) else { return Ok((case, first)) };
    if let Some(better) = with_body(setup, (&case, &first), &asked, options, progress)? {
        return Ok(better);
    }
    if is_asked(&asked.body) {
        first.notes.push(format!(
            "Along the measured motion the servos' torques ask for {}; simulated with it, the joints predict held-out logs \
             no better, so it is not named.",
            asked.body.words()
        ));
    }
    Ok((case, first))
}

/// What a robot shows before causes of joints are looked for.
enum Glance {
    /// It needs none.
    Answers(Box<ClampedDiagnosis>),
    /// It leaves something, with any body beside numbers where these were tried.
    Leaves { bodies_were_tried: bool },
}

/// The robot where no causes of joints are needed, so that none are looked for: with numbers alone, or with a body in place that
/// the torques ask for rather than for such causes, it leaves only noise of every joint, simulated as a whole. No answer elsewhere.
fn at_a_glance(
    setup: &ClampedSetup,
    (case, masses): (ClampedCase, &[FoundNumber]),
    options: &GapOptions,
    progress: &dyn Progress,
) -> Result<(ClampedCase, Glance), TorqueError> {
    let needs_no_cause = |case: ClampedCase, is: bool| {
        let joints = case.joints.into_iter().map(|joint| ClampedJoint { needs_no_cause: is, ..joint });
        ClampedCase { joints: joints.collect(), ..case }
    };
    let case = needs_no_cause(case, true);
    let first = diagnose_clamped(&case, options, progress)?.with_weighed(masses.to_vec());
    if numbers_alone_leave_noise(setup, &first, &options.deadline) {
        let (along, found) = followed(setup, options, progress, (case.clone(), first.clone()))?;
        // Who says that nothing explains the rest has to have looked.
        if !found.found().any(is_unexplained) {
            let found = if masses.is_empty() { found } else { found.chosen_by_held_out(OTHER_MASSES) };
            return Ok((along, Glance::Answers(Box::new(found))));
        }
    }
    let case = needs_no_cause(case, false);
    let leaves = |bodies_were_tried: bool| Glance::Leaves { bodies_were_tried };
    if !options.considers_bodies() || !first.found().any(is_unexplained) || options.deadline.leaves_out(BODIES) {
        return Ok((case, leaves(false)));
    }
    progress.go_on(Step::stage("payload and masses"))?;
    let bodies = may_be_other(setup, &case, &first, options)?;
    if !bodies.iter().any(is_asked) {
        return Ok((case, leaves(false)));
    }
    let asked = best_of(setup, bodies, &first, options).filter(|asked| asked.explains && is_asked(&asked.body));
    let with_it = asked.map(|asked| with_body(setup, (&case, &first), &asked, options, progress)).transpose()?;
    Ok(match with_it.flatten() {
        Some((with_it, found)) => (with_it, Glance::Answers(Box::new(found))),
        None => (case, leaves(true)),
    })
}

/// A body that may be other than described.
struct Asked {
    body: BodyCause,
    /// Numbers of the whole robot beside it, as [`BodyAtBest`] has them.
    numbers: Vec<FoundNumber>,
    /// Whether the whole robot with it and numbers alone leaves only noise of every joint.
    explains: bool,
}

/// Whether torques ask for a body.
fn is_asked(body: &BodyCause) -> bool {
    body.saved >= MARGIN
}

/// Bodies that may be other than described, with what torques along the joints' measured motion ask of them: those that say most
/// first.
fn may_be_other(
    setup: &ClampedSetup,
    case: &ClampedCase,
    first: &ClampedDiagnosis,
    options: &GapOptions,
) -> Result<Vec<BodyCause>, TorqueError> {
    let late_s: BTreeMap<String, f64> = first.found().filter_map(|d| Some((d.joint.clone(), late_s(d)?))).collect();
    let commanded = TorqueCase::commanded(setup, &late_s)?;
    let (_, mut founds, moving) = searched(&commanded, &[], &|effect| options.considers(effect));
    for (own, data) in founds.iter_mut().zip(&moving.joints) {
        let simulated = first.found().find(|d| d.joint == data.name);
        own.with_causes(simulated.iter().flat_map(|d| &d.causes).map(|cause| cause.effect));
    }
    if founds.is_empty() {
        return Ok(Vec::new());
    }
    // Where numbers alone explain everything only what torques ask for is worth a look.
    let least = if needs_only_numbers(case, first) { MARGIN } else { f64::NEG_INFINITY };
    Ok(find(setup, &moving, &founds, &[], &options.withheld_bodies(), least, &options.deadline)?)
}

/// The robot diagnosed with a body in place; `None` where that is worth no more than what was found before.
fn with_body(
    setup: &ClampedSetup,
    (case, first): (&ClampedCase, &ClampedDiagnosis),
    asked: &Asked,
    options: &GapOptions,
    progress: &dyn Progress,
) -> Result<Option<(ClampedCase, ClampedDiagnosis)>, TorqueError> {
    let Asked { body, numbers, explains } = asked;
    let changed = setup.with_change(body.link, &body.change)?;
    let (mut with_it, masses) = weighed_case(&changed, options, progress)?;
    let carriers: Vec<&str> =
        setup.description.carriers(body.link).iter().map(|at| setup.description.joints[at.0].name.as_str()).collect();
    let carries = |joint: &ClampedJoint| carriers.contains(&joint.name.as_str());
    for joint in &mut with_it.joints {
        joint.needs_no_cause = *explains;
        if let Some(own) = case.joints.iter().find(|own| own.name == joint.name && carries(own)) {
            joint.as_described = Some(own.as_described.as_ref().unwrap_or(&own.case).clone());
            joint.has_bodies = true;
        }
    }
    // To joints that do not carry it nothing has changed, unless it leaves nothing to explain of them either.
    let looks_again = |joint: &ClampedJoint| *explains || carries(joint);
    if !is_promising(case, &those(&with_it, &looks_again), options) {
        return Ok(None);
    }
    let told = |with_it: &ClampedCase| diagnose_joints(&those(with_it, &looks_again), options, &first.joints, progress);
    let mut again = told(&with_it)?;
    let leaves_none = !again.iter().any(|joint| joint.diagnosis.as_ref().is_some_and(is_unexplained));
    if *explains && !leaves_none {
        // Who says that nothing explains the rest has to have looked.
        with_it.joints.iter_mut().for_each(|joint| joint.needs_no_cause = false);
        again = told(&with_it)?;
    }
    let own = |joint: &JointAnswer| again.iter().find(|own| own.joint == joint.joint).unwrap_or(joint).clone();
    let mut joints: Vec<JointAnswer> = first.joints.iter().map(own).collect();
    let needs_no_cause = *explains && leaves_none;
    if needs_no_cause {
        joints.iter_mut().filter_map(|joint| joint.diagnosis.as_mut()).for_each(|own| tell_of_whole(own, numbers));
    }
    let mut second = concluded_of(&with_it, joints).with_weighed(masses);
    if !needs_no_cause {
        (with_it, second) = followed(&changed, options, progress, (with_it, second))?;
    }
    let mut notes = case.notes.clone();
    notes.push(in_place(body, needs_no_cause));
    let named = vec![body.clone()];
    // Where no joint has causes the whole robot knows all numbers best.
    let weighed = if needs_no_cause { numbers.clone() } else { second.weighed };
    let second =
        concluded(&case.robot, &case.groups, second.joints, named, Some(&first.joints), notes).with_weighed(weighed);
    let [without, with] = [first, &second].map(|d| d.gap.after);
    // The body is one more.
    let is_worth = with <= CLOSES * without || needs(&second) + 1 < needs(first);
    Ok((with <= NO_WORSE * without && is_worth).then(|| {
        let what = format!(
            "With {} in place joints predict the held-out logs better, or with fewer causes.",
            body.name().words()
        );
        (with_it, second.chosen_by_held_out(&what))
    }))
}

/// Adds what the whole robot has for the number that a joint's answer is: along the measured motion of the others it is told less
/// well.
fn tell_of_whole(own: &mut Diagnosis, numbers: &[FoundNumber]) {
    let key = match own.answer.effect.as_deref().filter(|_| own.answer.verdict == Verdict::Calibration) {
        Some("coulomb") => FoundKey::Frictionloss,
        Some("viscous") => FoundKey::Damping,
        Some("gain") => FoundKey::Kp,
        _ => return,
    };
    if let Some(number) = numbers.iter().find(|number| number.key == key && number.name == own.joint) {
        let words = number.words();
        own.answer.sentence += &format!(" All joints simulated at once ask for {words}, which is what is exported.");
    }
}

/// The body with which the whole robot leaves only noise of every joint, if there is one; else, of those that the torques
/// ask for, the one with which it leaves least, with the mass and the place at which it does; the first of them where the robot
/// cannot be simulated.
fn best_of(
    setup: &ClampedSetup,
    bodies: Vec<BodyCause>,
    first: &ClampedDiagnosis,
    options: &GapOptions,
) -> Option<Asked> {
    let causes = placed_causes(first);
    let at_best = |body: &BodyCause| {
        let alone = body_at_best(setup, body, &[], first, &options.deadline);
        if alone.as_ref().is_some_and(|alone| alone.explains) || !is_asked(body) {
            return alone.filter(|alone| alone.explains);
        }
        let beside =
            (!causes.is_empty()).then(|| body_at_best(setup, body, &causes, first, &options.deadline)).flatten();
        // Beside causes it explains nothing alone.
        let beside = beside.map(|beside| BodyAtBest { explains: false, ..beside });
        alone.into_iter().chain(beside).min_by(|a, b| a.left_rad.total_cmp(&b.left_rad))
    };
    let mut tried: Vec<BodyAtBest> = bodies.par_iter().filter_map(at_best).collect();
    let explains = tried.iter().any(|one| one.explains);
    tried.retain(|one| one.explains || !explains);
    let least_rad = tried.iter().map(|one| one.left_rad).fold(f64::INFINITY, f64::min);
    let mut as_good = tried.into_iter().filter(|one| one.left_rad <= AS_GOOD * least_rad);
    let Some(best) = as_good.next() else {
        let first = bodies.into_iter().next().filter(is_asked);
        return first.map(|body| Asked { body, numbers: Vec::new(), explains: false });
    };
    let BodyAtBest { body: mut best, numbers, .. } = best;
    let is_another = |other: &BodyAtBest| {
        let other = &other.body;
        !is_one_payload(setup, (best.kind, best.link), (other.kind, other.link))
    };
    let as_good: Vec<BodyName> = as_good.filter(is_another).map(|other| other.body.name()).collect();
    // What the whole robot did not try is as good as torques tell.
    let was_tried = |other: &BodyName| bodies.iter().any(|body| body.name() == *other);
    let others = std::mem::take(&mut best.equivalent);
    let others = others.into_iter().filter(|other| other.kind == best.kind && !was_tried(other));
    best.equivalent = [best.name()].into_iter().chain(others).chain(as_good).collect();
    Some(Asked { body: best, numbers, explains })
}

/// Whether the whole robot at its best needs no more than numbers to leave only noise of every joint.
fn needs_only_numbers(case: &ClampedCase, first: &ClampedDiagnosis) -> bool {
    first.found().all(|own| {
        let whole = case.joints.iter().find(|joint| joint.name == own.joint).and_then(|joint| joint.whole);
        whole.is_some_and(|whole| !leaves_something(whole.bare_rad, own.gap.floor))
    })
}

/// Whether causes beside a body are worth a search on the joints that carry it: with it in place their numbers alone predict
/// better, or no worse while more of them than its own stay near what is believed.
fn is_promising(case: &ClampedCase, carrying: &[&ClampedJoint], options: &GapOptions) -> bool {
    let refitted = |joint: &&ClampedJoint| {
        let without = case.joints.iter().find(|own| own.name == joint.name)?;
        Some([Refitted::of(&without.case, options)?, Refitted::of(&joint.case, options)?])
    };
    let refitted: Vec<[Refitted; 2]> = carrying.par_iter().filter_map(refitted).collect();
    let [without, with] = [0, 1].map(|k| refitted.iter().map(|both| Some(both[k].left_rad)).collect::<Vec<_>>());
    let share = mean_share(&with, &without);
    let [far_without, far_with] = [0, 1].map(|k| refitted.iter().map(|both| both[k].far).sum::<usize>());
    share <= NO_WORSE && (share < PROMISING || far_with + 1 < far_without)
}

/// How many causes joints need, and numbers far from what is believed.
fn needs(diagnosis: &ClampedDiagnosis) -> usize {
    let far = |own: &Diagnosis| own.beliefs.iter().filter(|belief| belief.is_finding()).count();
    diagnosis.found().map(|own| own.causes.len() + far(own)).sum()
}

fn those<'a>(case: &'a ClampedCase, are: &dyn Fn(&ClampedJoint) -> bool) -> Vec<&'a ClampedJoint> {
    case.joints.iter().filter(|joint| are(joint)).collect()
}

fn is_unexplained(diagnosis: &Diagnosis) -> bool {
    diagnosis.answer.verdict == Verdict::Unexplained
}

fn in_place(body: &BodyCause, needs_no_cause: bool) -> String {
    let looked = match needs_no_cause {
        true => " It and numbers alone leave only noise of every joint: no causes of joints were looked for beside it.",
        false => "",
    };
    format!(
        "With {} in place, which all joints that carry it share: joints' numbers are told beside it, what they were before \
         belongs to the robot as described.{looked}",
        body.name().words()
    )
}

/// Whether a joint's answer leaves anything that a body could explain.
fn asks(diagnosis: &Diagnosis) -> bool {
    let is_load = |name: &str| ["inertia", "moment"].contains(&name);
    let moved = diagnosis.beliefs.iter().any(|belief| is_load(&belief.name) && belief.moved_sd.abs() > MOVED_SD);
    moved || !diagnosis.causes.is_empty() || diagnosis.law.is_some() || is_unexplained(diagnosis)
}

fn late_s(diagnosis: &Diagnosis) -> Option<f64> {
    let delay = diagnosis.causes.iter().find(|cause| cause.effect == EffectId::Delay)?;
    delay.parameters.first().map(|number| number.value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::clamped::tests::of_another_gain;

    #[test]
    fn who_is_left_unexplained_asks_for_bodies_too() {
        let mut own = of_another_gain("elbow");
        assert!(!asks(&own));
        own.answer.verdict = Verdict::Unexplained;
        assert!(asks(&own));
    }

    #[test]
    fn a_number_is_told_as_the_whole_robot_has_it_too() {
        let mut own = of_another_gain("elbow");
        (own.answer.verdict, own.answer.effect) = (Verdict::Calibration, Some("viscous".to_owned()));
        let number = FoundNumber {
            name: "elbow".to_owned(),
            key: FoundKey::Damping,
            was: Some(0.06),
            value: 0.0598,
            interval: Some([0.0566, 0.0631]),
            unit: "N m s/rad".to_owned(),
            place_m: None,
        };
        tell_of_whole(&mut own, &[FoundNumber { name: "wrist".to_owned(), ..number.clone() }]);
        assert!(!own.answer.sentence.contains("at once"), "{}", own.answer.sentence);
        tell_of_whole(&mut own, &[number]);
        let told = "All joints simulated at once ask for damping 0.0598 [0.0566, 0.0631] N m s/rad, was 0.06, which";
        assert!(own.answer.sentence.contains(told), "{}", own.answer.sentence);
    }
}
