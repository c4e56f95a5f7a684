//! A robot's joints as cases of the bench, with the robot as stated, or as found, to follow motions by that its logs hardly
//! resolve.

use super::common::{explains, in_common, misfit};
use super::numbers::found_robot;
use super::parts::{append, parts};
use super::robot::{Stretch, WholeRobot, placed_causes};
use super::settled::{Settled, settled};
use super::simulated::simulated;
use crate::deadline::Deadline;
use crate::gap::Diagnosis;
use crate::gap::clamped::{ClampedCase, ClampedCaseError, ClampedDiagnosis, ClampedSetup, Common, SimulatedMotion};
use crate::gap::hypothesis::reach::mean_period_s;
use crate::joint::EffectId;
use crate::log::{DriveMode, RobotLog};
use crate::robot::description::FoundNumber;

/// Instants between which a load is taken as linear lie no further apart \[s\].
const DENSE_S: f64 = 2.5e-3;
/// But no more of them between two samples: slow logs would take more steps than a motion may.
const MOST_PER_SAMPLE: f64 = 40.0;
/// Causes of so many joints at most are tried without those of the others.
const FEW: usize = 2;
/// Without causes the robot may leave so many times what joints' own answers do, where both are noise.
const HARDLY_WORSE: f64 = 1.1;
/// What is no more than noise is at most so many times as large.
const NO_MORE: f64 = 1.05;
/// One cause on all joints has to leave this share of what those leave, in squares of noise.
const CLEARLY_LESS: f64 = 0.95;

impl ClampedCase {
    /// The case of a robot and its logs.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where a joint's logs make no case.
    pub fn of(setup: &ClampedSetup) -> Result<Self, ClampedCaseError> {
        Self::with_masses(setup, &[])
    }

    /// The same where joints push one another as bodies of these masses do.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where a joint's logs make no case, or masses are of another robot.
    pub(in crate::gap) fn with_masses(setup: &ClampedSetup, masses: &[FoundNumber]) -> Result<Self, ClampedCaseError> {
        Self::along(setup, masses, &as_stated(setup, masses))
    }

    /// The same with joints followed along the whole robot at its best.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where a joint's logs make no case.
    pub(in crate::gap) fn settled(setup: &ClampedSetup, whole: &Settled) -> Result<Self, ClampedCaseError> {
        Self::along(setup, &whole.masses(), &of_settled(setup, whole))
    }

    /// The same where that follows any of them better than the robot as stated, but for these masses; `None` elsewhere.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where a joint's logs make no case.
    pub(in crate::gap) fn as_found(
        setup: &ClampedSetup,
        masses: &[FoundNumber],
        whole: &Settled,
    ) -> Result<Option<Self>, ClampedCaseError> {
        let (stated, found) = (as_stated(setup, masses), of_settled(setup, whole));
        let is_better = |(log, (found, stated)): (&RobotLog, (&Option<SimulatedMotion>, &Option<SimulatedMotion>))| {
            found.as_ref().is_some_and(|found| found.follows_better(log, stated.as_ref()))
        };
        let better: Vec<bool> = setup.logs.iter().zip(found.iter().zip(&stated)).map(is_better).collect();
        if !better.contains(&true) {
            return Ok(None);
        }
        let both = found.into_iter().zip(stated).zip(better);
        let motions: Vec<_> = both.map(|((found, stated), better)| if better { found } else { stated }).collect();
        Self::along(setup, &whole.masses(), &motions).map(Some)
    }
}

/// The whole robot at its best beside what was found.
pub(in crate::gap) struct AsFound {
    pub whole: Settled,
    /// Joints whose causes it has.
    pub joints: Vec<String>,
    /// The one cause that all joints have.
    pub common: Option<Common>,
    /// Whether it leaves only noise of every joint.
    pub explains: bool,
}

/// The whole robot at its best beside what was found: with numbers alone, or the causes of the few joints that explain it all,
/// those first that close most, or one cause on all joints that leaves less, or else with everything but what the whole robot
/// refutes. `allows` says which effects may be common to all, if any.
pub(in crate::gap) fn as_found(
    setup: &ClampedSetup,
    diagnosis: &ClampedDiagnosis,
    allows: Option<&dyn Fn(EffectId) -> bool>,
    deadline: &Deadline,
) -> Option<AsFound> {
    let accused = diagnosis.accused();
    if !accused.is_empty()
        && let Some(sound) = with_numbers_alone(setup, diagnosis, deadline)
    {
        return Some(sound);
    }
    let few = (1..accused.len()).take(FEW).find_map(|n| {
        let only = diagnosis.with_answers_of(&accused[..n]);
        let found = found_robot(setup, Some(&only)).ok()?;
        let whole = settled(setup, &found.numbers, &placed_causes(&only), deadline)?;
        let joints = accused[..n].iter().map(|&joint| joint.to_owned()).collect();
        explains(&whole, diagnosis).then_some(AsFound { whole, joints, common: None, explains: true })
    });
    let asks = !accused.is_empty() || diagnosis.unexplained().next().is_some();
    let in_common = allows.filter(|_| asks).and_then(|allows| in_common(setup, diagnosis, allows, deadline));
    let of_all = in_common.map(|(common, whole)| {
        let joints = whole.causes.iter().map(|cause| cause.joint.clone()).collect();
        let explains = explains(&whole, diagnosis);
        AsFound { whole, joints, common: Some(common), explains }
    });
    let own: Vec<&Diagnosis> = diagnosis.found().collect();
    let left = |found: &AsFound| misfit(&found.whole, &own);
    let leaves_less =
        |of_all: &AsFound| few.as_ref().is_none_or(|few| of_all.explains && left(of_all) < CLEARLY_LESS * left(few));
    let best = of_all.filter(leaves_less).or(few);
    if best.is_some() {
        return best;
    }
    let whole = simulated(setup, diagnosis).ok()?;
    let is_left_out = |joint: &String| whole.left_out.iter().any(|left| left.joint.as_ref() == Some(joint));
    let mut causes = placed_causes(diagnosis);
    causes.retain(|cause| !is_left_out(&cause.joint));
    let joints = accused.into_iter().map(str::to_owned).filter(|joint| !is_left_out(joint)).collect();
    let whole = settled(setup, &whole.robot.numbers, &causes, deadline)?;
    let explains = explains(&whole, diagnosis);
    Some(AsFound { whole, joints, common: None, explains })
}

/// The whole robot with the joints' numbers, where it needs no cause to leave only noise of every joint, and hardly more than
/// with causes these left.
fn with_numbers_alone(setup: &ClampedSetup, diagnosis: &ClampedDiagnosis, deadline: &Deadline) -> Option<AsFound> {
    let whole = numbers_at_best(setup, diagnosis, deadline)?;
    let leaves_no_more = diagnosis.found().all(|own| {
        own.causes.is_empty()
            || whole.left_rad(&own.joint).is_some_and(|left_rad| left_rad <= HARDLY_WORSE * own.gap.after)
    });
    (leaves_no_more && explains(&whole, diagnosis)).then(|| AsFound {
        whole,
        joints: Vec::new(),
        common: None,
        explains: true,
    })
}

/// Whether the whole robot with the joints' numbers leaves no more than noise of every joint, so that no cause could show.
pub(in crate::gap) fn numbers_alone_leave_noise(
    setup: &ClampedSetup,
    diagnosis: &ClampedDiagnosis,
    deadline: &Deadline,
) -> bool {
    let is_noise = |own: &Diagnosis, whole: &Settled| {
        whole.left_rad(&own.joint).is_some_and(|left_rad| left_rad <= NO_MORE * own.gap.floor)
    };
    let whole = numbers_at_best(setup, diagnosis, deadline);
    whole.is_some_and(|whole| diagnosis.found().all(|own| is_noise(own, &whole)))
}

/// The whole robot with the joints' numbers and without their causes, at its best.
fn numbers_at_best(setup: &ClampedSetup, diagnosis: &ClampedDiagnosis, deadline: &Deadline) -> Option<Settled> {
    let found = found_robot(setup, Some(&diagnosis.without_causes())).ok()?;
    settled(setup, &found.numbers, &[], deadline)
}

/// The whole robot as stated, at its best.
pub(in crate::gap) fn as_stated_at_best(setup: &ClampedSetup, deadline: &Deadline) -> Option<Settled> {
    settled(setup, &found_robot(setup, None).ok()?.numbers, &[], deadline)
}

fn of_settled(setup: &ClampedSetup, whole: &Settled) -> Vec<Option<SimulatedMotion>> {
    motions(setup, WholeRobot::of(setup, &whole.numbers, &whole.causes))
}

/// Each log as the robot as stated, but for these masses, moves under its setpoints, where anything drives it so and it does not
/// run away.
fn as_stated(setup: &ClampedSetup, masses: &[FoundNumber]) -> Vec<Option<SimulatedMotion>> {
    let stated = found_robot(setup, None).map_err(|error| error.to_string());
    let numbers = stated.map(|stated| [stated.numbers, masses.to_vec()].concat());
    motions(setup, numbers.and_then(|numbers| WholeRobot::of(setup, &numbers, &[])))
}

fn motions(setup: &ClampedSetup, robot: Result<WholeRobot, String>) -> Vec<Option<SimulatedMotion>> {
    let Ok(mut robot) = robot else { return vec![None; setup.logs.len()] };
    let logs = setup.study.logs.iter().zip(&setup.logs);
    logs.map(|(entry, log)| match entry.drive {
        DriveMode::Position => motion(&mut robot, setup, log),
        _ => None,
    })
    .collect()
}

fn motion(robot: &mut WholeRobot, setup: &ClampedSetup, log: &RobotLog) -> Option<SimulatedMotion> {
    if log.len() < 2 {
        return None;
    }
    let mut all = SimulatedMotion { t_s: Vec::new(), joints: Vec::new(), readings: Vec::new() };
    for part in parts(log) {
        let own = motion_of_part(robot, setup, &part)?;
        all.t_s.extend(own.t_s);
        append(&mut all.joints, own.joints);
        append(&mut all.readings, own.readings);
    }
    Some(all)
}

fn motion_of_part(robot: &mut WholeRobot, setup: &ClampedSetup, log: &RobotLog) -> Option<SimulatedMotion> {
    let period_s = mean_period_s(&log.t_s);
    let per_sample = (period_s / DENSE_S).ceil().min(MOST_PER_SAMPLE);
    let from = robot.beginning(setup, log);
    let recording = robot.motion(setup, log, &from, &Stretch::whole(period_s / per_sample)).ok()?;
    let t_s = &recording.t_s;
    let joints = log.joints.iter().map(|joint| {
        let id = robot.model.joint(&joint.name).ok()?.index();
        let (angle, rate) = (&recording.angle_rad[id], &recording.rate_rad_s[id]);
        let acceleration = |k: usize| {
            let (from, to) = (k.saturating_sub(1), (k + 1).min(t_s.len() - 1));
            (rate[to] - rate[from]) / (t_s[to] - t_s[from])
        };
        Some((0..t_s.len()).map(|k| [angle[k], rate[k], acceleration(k)]).collect())
    });
    let joints: Vec<Vec<[f64; 3]>> = joints.collect::<Option<_>>()?;
    let readings = robot.read(&recording, log).ok()?;
    Some(SimulatedMotion { t_s: recording.t_s, joints, readings })
}
