//! A robot whose motion is predicted, joint by joint, and the bodies that all of its joints ask to be other than described.
//!
//! Bodies are looked for along the measured motion, by the torques that the servos gave as study and description state
//! them; what is found has to let the simulated joints predict held-out logs no worse.

use super::bodies::find;
use super::case::TorqueCase;
use super::diagnose::{TorqueError, searched};
use crate::gap::clamped::{
    BodyCause, ClampedCase, ClampedDiagnosis, ClampedSetup, before_of, concluded, diagnose_clamped,
};
use crate::gap::{Diagnosis, GapOptions};
use crate::joint::EffectId;
use crate::progress::{Progress, Step};
use std::collections::BTreeMap;

/// With a body changed the joints' error may be so much larger, relative.
const NO_WORSE: f64 = 1.02;
/// Numbers that moved by fewer of their standard deviations ask for nothing.
const MOVED_SD: f64 = 1.0;

/// Diagnoses a robot whose motion is predicted: every joint, then the bodies that they share.
///
/// # Errors
/// [`TorqueError`] where the study makes no case or no joint can be diagnosed.
pub fn diagnose_motion(
    setup: &ClampedSetup,
    options: &GapOptions,
    progress: &dyn Progress,
) -> Result<(ClampedCase, ClampedDiagnosis), TorqueError> {
    let case = ClampedCase::of(setup)?;
    let first = diagnose_clamped(&case, options, progress)?;
    let found = || first.joints.iter().filter_map(|joint| joint.diagnosis.as_ref());
    if !options.only.is_empty() || !found().any(asks) {
        return Ok((case, first));
    }
    progress.go_on(Step::stage("payload and masses"))?;
    let late_s: BTreeMap<String, f64> = found().filter_map(|d| Some((d.joint.clone(), late_s(d)?))).collect();
    let commanded = TorqueCase::commanded(setup, &late_s)?;
    let (_, founds, moving) = searched(&commanded, &|effect| is_asked(effect, options));
    let without = &options.without_bodies;
    let body = (!founds.is_empty()).then(|| find(setup, &moving, &founds, &[], without)).transpose()?.flatten();
    let Some(body) = body else { return Ok((case, first)) };
    let changed = setup.with_change(body.link, &body.change)?;
    let changed_case = ClampedCase::of(&changed)?;
    let mut then = diagnose_clamped(&changed_case, options, progress)?;
    if then.gap.after > NO_WORSE * first.gap.after {
        let mut first = first;
        first.notes.push(format!(
            "Along the measured motion the servos' torques ask for {}; simulated with it, the joints predict held-out logs \
             worse, so it is not named.",
            body.words()
        ));
        return Ok((case, first));
    }
    before_of(&first.joints, &mut then.joints);
    let mut notes = case.notes.clone();
    notes.push(with_body(&body));
    let diagnosis = concluded(&case.robot, &case.groups, then.joints, vec![body], Some(&first.joints), notes);
    Ok((changed_case, diagnosis))
}

fn with_body(body: &BodyCause) -> String {
    format!(
        "With {} in place, found along the measured motion over all joints that carry it: joints' numbers are told beside it, \
         what they were before belongs to the robot as described.",
        body.words()
    )
}

/// Whether a joint's answer leaves anything that a body could explain.
fn asks(diagnosis: &Diagnosis) -> bool {
    let is_load = |name: &str| ["inertia", "moment"].contains(&name);
    let moved = diagnosis.beliefs.iter().any(|belief| is_load(&belief.name) && belief.moved_sd.abs() > MOVED_SD);
    moved || !diagnosis.causes.is_empty() || diagnosis.law.is_some()
}

fn late_s(diagnosis: &Diagnosis) -> Option<f64> {
    let delay = diagnosis.causes.iter().find(|cause| cause.effect == EffectId::Delay)?;
    delay.parameters.first().map(|number| number.value)
}

fn is_asked(effect: EffectId, options: &GapOptions) -> bool {
    !options.without.contains(&effect)
}
