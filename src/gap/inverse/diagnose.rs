//! Every joint of a robot diagnosed by the torques that its motion asks for.

use super::answer::{TorqueTraces, diagnosis};
use super::bodies::{BODIES, MARGIN, find};
use super::case::TorqueCase;
use super::design::JointData;
use super::search::{Found, search};
use crate::gap::clamped::{BodyCause, ClampedCaseError, ClampedDiagnosis, ClampedSetup, JointAnswer, concluded};
use crate::gap::{GapError, GapOptions};
use crate::joint::EffectId;
use crate::progress::{Cancelled, Progress, Step};
use crate::robot::description::LinkId;
use rayon::prelude::*;

/// Effects that torques along a motion show; the others change what a setpoint becomes, or part two bodies.
const SHOWN: [EffectId; 13] = [
    EffectId::Stribeck,
    EffectId::LoadFriction,
    EffectId::GearFriction,
    EffectId::QuadraticDrag,
    EffectId::AsymmetricFriction,
    EffectId::PositionFriction,
    EffectId::FrictionDrift,
    EffectId::JointSpring,
    EffectId::EndStop,
    EffectId::AngleOffset,
    EffectId::SensorGain,
    EffectId::SensorDelay,
    EffectId::DeadBand,
];

/// A robot's diagnosis with the curves of its joints.
#[derive(Clone, Debug)]
pub struct TorqueDiagnosis {
    /// What was found, errors in N m.
    pub found: ClampedDiagnosis,
    /// Of every joint that moves, in the diagnosis's order.
    pub traces: Vec<Vec<TorqueTraces>>,
}

/// Diagnoses a robot's joints by the torques along its measured motion.
///
/// # Errors
/// [`TorqueError`] where no log has a torque, no joint moves, or the diagnosis is no longer wanted.
pub fn diagnose_torques(
    setup: &ClampedSetup,
    options: &GapOptions,
    progress: &dyn Progress,
) -> Result<TorqueDiagnosis, TorqueError> {
    let allows = |effect: EffectId| SHOWN.contains(&effect) && options.considers(effect);
    progress.go_on(Step::stage("torques along the motion"))?;
    let first = TorqueCase::of(setup)?;
    let (mut answers, mut founds, moving) = searched(&first, &[], &allows);
    let mut case = moving;
    let as_described: Vec<JointAnswer> = answers.iter().map(|(answer, _)| answer.clone()).collect();
    let (mut changed, mut bodies) = (setup.clone(), Vec::<BodyCause>::new());
    // Whoever asks for some effects only does not ask for bodies.
    let may_be_other = |bodies: &[BodyCause]| options.considers_bodies() && bodies.len() < MOST_BODIES;
    while may_be_other(&bodies) && !founds.is_empty() && !options.deadline.leaves_out(BODIES) {
        progress.go_on(Step::stage("payload and masses"))?;
        let taken: Vec<LinkId> = bodies.iter().map(|body| body.link).collect();
        let found = find(&changed, &case, &founds, &taken, &options.withheld_bodies(), MARGIN, &options.deadline)?;
        let Some(body) = found.into_iter().next() else { break };
        changed = changed.with_change(body.link, &body.change)?;
        bodies.push(body);
        (answers, founds, case) = searched(&TorqueCase::of(&changed)?, &as_described, &allows);
    }
    if founds.is_empty() {
        return Err(GapError::NeverMoved.into());
    }
    let (mut joints, traces): (Vec<JointAnswer>, Vec<_>) = answers.into_iter().unzip();
    for diagnosis in joints.iter_mut().filter_map(|joint| joint.diagnosis.as_mut()) {
        diagnosis.withheld = EffectId::ALL.iter().copied().filter(|effect| !options.considers(*effect)).collect();
        let carries = bodies.iter().filter(|body| body.joints.contains(&diagnosis.joint));
        diagnosis.notes.extend(carries.map(|body| {
            format!(
                "With {} in place, found over all joints that carry it: numbers are told beside it.",
                body.name().words()
            )
        }));
    }
    let found = concluded(&first.robot, &first.groups, joints, bodies, Some(&as_described), first.notes.clone());
    let found = found.asked(options).within(&options.deadline);
    Ok(TorqueDiagnosis { found, traces: traces.into_iter().flatten().collect() })
}

/// Bodies that may be other than described in one answer.
const MOST_BODIES: usize = 2;

/// A joint's answer, and its curves where it moves.
type Answered = (JointAnswer, Option<Vec<TorqueTraces>>);

/// Every joint's own answer; what was found of those that move, and the case of these. `described` are the answers before a body
/// was changed.
pub(super) fn searched(
    case: &TorqueCase,
    described: &[JointAnswer],
    allows: &(dyn Fn(EffectId) -> bool + Sync),
) -> (Vec<Answered>, Vec<Found>, TorqueCase) {
    let of_joint = |joint: &JointData| {
        let found = joint.moves().then(|| search(joint, &case.logs, &|effect| allows(effect)));
        let first = described.iter().find(|first| first.joint == joint.name);
        let first = first.and_then(|first| first.diagnosis.as_ref());
        let (diagnosis, traces) = found.as_ref().map(|found| diagnosis(joint, &case.logs, found, first)).unzip();
        ((JointAnswer { joint: joint.name.clone(), diagnosis }, traces), found)
    };
    let answers: Vec<(Answered, Option<Found>)> = case.joints.par_iter().map(of_joint).collect();
    let moving = case.joints.iter().zip(&answers).filter(|(_, (_, found))| found.is_some());
    let moving = TorqueCase { joints: moving.map(|(joint, _)| joint.clone()).collect(), ..case.clone() };
    let (answers, founds): (Vec<Answered>, Vec<Option<Found>>) = answers.into_iter().unzip();
    (answers, founds.into_iter().flatten().collect(), moving)
}

/// Why torques cannot be diagnosed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TorqueError {
    /// The study makes no case.
    #[error(transparent)]
    Case(#[from] ClampedCaseError),
    /// There is nothing to diagnose.
    #[error(transparent)]
    Gap(#[from] GapError),
}

impl From<Cancelled> for TorqueError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Gap(cancelled.into())
    }
}

impl JointData {
    /// Whether any log shows it moving.
    fn moves(&self) -> bool {
        let moving = |rates: &[f64], resting: f64| rates.iter().filter(|rate| rate.abs() > resting).count();
        let shown = self.logs.iter().flatten();
        shown.map(|s| moving(&s.rate_rad_s, s.resting_rad_s)).sum::<usize>() > LEAST_MOVING
    }
}

/// Samples of motion that a diagnosis takes.
const LEAST_MOVING: usize = 50;
