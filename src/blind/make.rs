//! Makes a study and keeps its answer.

use super::cause::{Cause, CauseFilter, OutsideId, simulable};
use super::dice::{Dice, significant};
use super::joint::{DIGITS, Joint};
use super::plan::{LogPlan, one_sided, plan};
use super::sim::{Drive, Machine, Trace};
use super::size::{all_logs, coarse, rms_rad};
use super::truth::{FourNumbers, Truth};
use super::write::files;
use crate::gap::Verdict;
use crate::joint::{EffectId, Stage};

/// Step of the logs that are written \[s\].
const FINE_S: f64 = 2.5e-5;
/// Studies that are drawn until one shows its cause; the last is taken as it is.
const ATTEMPTS: usize = 40;
/// No log goes beyond this angle \[rad\]: a joint that turns over is another experiment.
const WIDEST_RAD: f64 = 2.7;

/// A study and its answer.
#[derive(Clone, Debug)]
pub struct Made {
    /// Names and contents of the study's files, `study.toml` first.
    pub study: Vec<(String, String)>,
    /// What is true of it.
    pub truth: Truth,
}

/// Makes study `trial` of a run, with a cause drawn at random.
pub fn make(seed: u64, trial: u64) -> Made {
    make_filtered(seed, trial, CauseFilter::Any)
}

/// Makes study `trial` of a run, with a cause drawn from a kind.
pub fn make_filtered(seed: u64, trial: u64, filter: CauseFilter) -> Made {
    let mut dice = Dice::new(seed, trial);
    let cause = draw_cause(filter, &mut dice);
    made(seed, trial, cause, dice)
}

/// Makes study `trial` of a run, with a given cause.
pub fn make_with(seed: u64, trial: u64, cause: Cause) -> Made {
    make_filtered(seed, trial, CauseFilter::Only(cause))
}

/// Of a hundred studies 12 have nothing, 12 wrong numbers, 48 one effect, 14 two, 14 something outside the catalogue.
fn draw_cause(filter: CauseFilter, dice: &mut Dice) -> Cause {
    let filter = match filter {
        CauseFilter::Any => match dice.uniform(0.0, 1.0) {
            x if x < 0.12 => CauseFilter::Nothing,
            x if x < 0.24 => CauseFilter::Calibration,
            x if x < 0.72 => CauseFilter::AnyEffect,
            x if x < 0.86 => CauseFilter::AnyPair,
            _ => CauseFilter::AnyOutside,
        },
        given => given,
    };
    match filter {
        CauseFilter::Any | CauseFilter::Nothing => Cause::Nothing,
        CauseFilter::Calibration => Cause::Calibration,
        CauseFilter::AnyEffect => Cause::One(dice.pick(&simulable())),
        CauseFilter::AnyOutside => Cause::Outside(dice.pick(OutsideId::ALL)),
        CauseFilter::AnyPair => {
            let first = dice.pick(&simulable());
            let others: Vec<EffectId> = simulable().into_iter().filter(|other| can_pair(first, *other)).collect();
            Cause::Two(first, dice.pick(&others))
        }
        CauseFilter::Only(cause) => cause,
    }
}

/// Effects of a pair are of two kinds, and not one effect by another name: a spring with a constant torque is a spring
/// that is slack elsewhere.
fn can_pair(first: EffectId, second: EffectId) -> bool {
    use EffectId::{AsymmetricFriction, JointSpring};
    let one_spring = [(JointSpring, AsymmetricFriction), (AsymmetricFriction, JointSpring)];
    kind(first) != kind(second) && !one_spring.contains(&(first, second))
}

/// Effects of one kind do much the same.
fn kind(effect: EffectId) -> u8 {
    use EffectId::*;
    match effect {
        Stribeck | LoadFriction | GearFriction | QuadraticDrag | AsymmetricFriction | PositionFriction
        | FrictionDrift => 0,
        Backlash | EndStop | Compliance => 1,
        JointSpring | AngleOffset | SensorGain => 2,
        Delay | SetpointHold | SetpointProfile | SensorDelay => 3,
        TorqueLimit | SpeedLimit | MotorGain | DeadBand => 4,
    }
}

fn made(seed: u64, trial: u64, cause: Cause, mut dice: Dice) -> Made {
    loop {
        for attempt in 1..=ATTEMPTS {
            if let Some(made) =
                Draft::draw(cause, &mut dice).finish((seed, trial), cause, attempt == ATTEMPTS, &mut dice)
            {
                return made;
            }
        }
    }
}

/// A joint with its logs, before anything is the matter with it.
pub(super) struct Draft {
    pub joint: Joint,
    pub plans: Vec<LogPlan>,
    pub plain: Machine,
    /// By the catalogue's definitions, to the letter.
    pub textbook: bool,
}

impl Draft {
    fn draw(cause: Cause, dice: &mut Dice) -> Self {
        let joint = Joint::draw(dice);
        let driven = dice.chance(0.6) || cause.needs_motor();
        let mut plans = plan(&joint, driven, dice);
        let (is_one_sided, side) = (dice.chance(0.25), dice.sign());
        let has_stop = match cause {
            Cause::One(effect) => effect == EffectId::EndStop,
            Cause::Two(first, second) => first == EffectId::EndStop || second == EffectId::EndStop,
            _ => false,
        };
        if is_one_sided || has_stop {
            one_sided(&mut plans, side);
        }
        let textbook = dice.chance(0.5);
        let mut plain =
            Machine::plain(joint.inertia_kg_m2, joint.peak_gravity_nm(), joint.coulomb_nm, joint.viscous_nm_s_rad);
        plain.drive = Drive { kp: joint.kp, kd: joint.kd, ..Drive::default() };
        let presliding = dice.chance(0.5);
        let bristle_rad = joint.sensor.noise_rad() * dice.uniform(0.1, 0.5);
        if !textbook && presliding {
            presliding_within_noise(&mut plain, &plans, joint.sensor.noise_rad(), bristle_rad);
        }
        Self { joint, plans, plain, textbook }
    }

    /// Puts the cause in and writes the logs; `None` where it would not show as it should, unless it is `forced`.
    fn finish(self, (seed, trial): (u64, u64), cause: Cause, forced: bool, dice: &mut Dice) -> Option<Made> {
        let plain = coarse(&self.plain, &self.plans);
        if !tame(&plain) {
            return None;
        }
        let matter = self.matter(cause, plain, forced, dice)?;
        let traces = all_logs(&matter.machine, &self.plans, FINE_S);
        if !tame(&traces) {
            return None;
        }
        let study = files(&self.joint, &matter.nominal, &self.plans, &traces, dice);
        let (verdict, effect, second, outside, stage): (_, Option<&'static str>, _, _, Option<Stage>) = match cause {
            Cause::Nothing => (Verdict::None, None, None, None, None),
            Cause::Calibration => (Verdict::Calibration, matter.number, None, None, None),
            Cause::One(effect) => (Verdict::Effect, Some(effect.id()), None, None, Some(effect.stage())),
            Cause::Two(first, second) => (Verdict::Effect, Some(first.id()), Some(second), None, Some(first.stage())),
            Cause::Outside(id) => (Verdict::Unexplained, None, None, Some(id), Some(id.stage())),
        };
        let driven_logs = self.plans.iter().filter(|plan| plan.is_driven()).count();
        let truth = Truth {
            seed,
            trial,
            verdict,
            effect,
            second,
            outside,
            stage,
            mechanisms: matter.mechanisms,
            ratio: matter.ratio,
            left: matter.left,
            nearest: matter.nearest,
            joint: self.numbers(),
            nominal: matter.nominal,
            family: self.joint.family,
            textbook: self.textbook,
            noise_rad: self.joint.sensor.noise_rad(),
            free_logs: self.plans.len() - driven_logs,
            driven_logs,
            loaded_logs: self.plans.iter().filter(|plan| plan.load.is_some()).count(),
        };
        Some(Made { study, truth })
    }

    /// The four numbers as they are.
    pub(super) fn numbers(&self) -> FourNumbers {
        let j = &self.joint;
        FourNumbers::of([j.inertia_kg_m2, j.moment_kg_m, j.coulomb_nm, j.viscous_nm_s_rad])
    }

    /// Half of the nominal values are right, the others off by 3 to 15 % each.
    pub(super) fn believed(&self, dice: &mut Dice) -> FourNumbers {
        if dice.chance(0.5) {
            return self.numbers();
        }
        let off =
            |value: f64, dice: &mut Dice| significant(value * (1.0 + dice.sign() * dice.uniform(0.03, 0.15)), DIGITS);
        FourNumbers::of(self.numbers().list().map(|value| off(value, dice)))
    }
}

/// Friction gives way a little before it slips, by so little that the logs do not show it.
///
/// Not so stiff that the steps would have to be shorter; where that leaves no choice, friction stays rigid.
fn presliding_within_noise(machine: &mut Machine, plans: &[LogPlan], noise_rad: f64, from_rad: f64) {
    let stiffest = machine.friction.coulomb_nm / (machine.inertia_kg_m2 * 900.0_f64.powi(2));
    let rigid = coarse(machine, plans);
    let mut bristle_rad = from_rad;
    while bristle_rad > stiffest {
        machine.friction.soften(bristle_rad, machine.inertia_kg_m2);
        let soft = coarse(machine, plans);
        let each =
            plans.iter().enumerate().map(|(i, plan)| rms_rad(&soft[i..=i], &rigid[i..=i], std::slice::from_ref(plan)));
        if each.fold(0.0, f64::max) <= 0.4 * noise_rad {
            return;
        }
        bristle_rad *= 0.5;
    }
    machine.friction.bristle_rad = 0.0;
}

/// Every reading is a number, and no log turns over.
fn tame(traces: &[Trace]) -> bool {
    traces.iter().all(|trace| trace.q_rad.iter().all(|q| q.abs() < WIDEST_RAD))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Outputs, Role, read_study, read_study_logs};

    #[test]
    fn same_seed_same_study_and_trials_differ() {
        let [a, b, c] = [(4, 1), (4, 1), (4, 2)].map(|(seed, trial)| make(seed, trial));
        assert_eq!(a.study, b.study);
        assert_eq!(a.truth, b.truth);
        assert_ne!(a.study, c.study);
    }

    #[test]
    fn studies_are_read_without_complaint_and_show_their_cause() {
        let dir = tempfile::tempdir().unwrap();
        for trial in 0..24 {
            let made = make(11, trial);
            let folder = dir.path().join(trial.to_string());
            let mut outputs = Outputs::default();
            for (name, content) in &made.study {
                outputs.add(folder.join(name), content.as_str());
            }
            outputs.write().unwrap();
            let study = read_study(&folder.join("study.toml")).unwrap();
            let logs = read_study_logs(&study).unwrap();
            assert!((5..=9).contains(&logs.len()));
            assert_eq!(study.logs.iter().filter(|log| log.role == Role::Validate).count(), 2);
            for log in &logs {
                assert!(log.len() > 150 && log.ignored_columns.is_empty());
            }
            let truth = &made.truth;
            assert_eq!(truth.joint == truth.nominal, truth.verdict == Verdict::None || truth.joint == truth.nominal);
            let expected = if truth.verdict == Verdict::None { 0.0..=0.0 } else { 1.3..=5000.0 };
            assert!(expected.contains(&truth.ratio), "{truth:?}");
        }
    }

    #[test]
    fn sizes_lie_where_they_are_sought() {
        for (trial, effect) in simulable().iter().enumerate() {
            let truth = make_with(12, trial as u64, Cause::One(*effect)).truth;
            let mechanism = &truth.mechanisms[0];
            assert_eq!((mechanism.id, truth.effect), (effect.id(), Some(effect.id())));
            assert!((1.3..300.0).contains(&mechanism.ratio) && mechanism.left >= 0.4, "{mechanism:?}");
            assert!(mechanism.left <= mechanism.ratio * 1.001, "{mechanism:?}");
            assert!(!super::super::cause::needs_motor(*effect) || truth.driven_logs >= 2);
        }
    }

    #[test]
    fn pairs_are_of_two_kinds_and_every_part_shows() {
        for trial in 0..4 {
            let truth = make_filtered(13, trial, CauseFilter::AnyPair).truth;
            assert_eq!(truth.mechanisms.len(), 2);
            assert!(truth.mechanisms.iter().all(|m| m.ratio >= 2.0), "{truth:?}");
        }
        assert!(can_pair(EffectId::Delay, EffectId::Stribeck) && !can_pair(EffectId::Delay, EffectId::SetpointHold));
        assert!(!can_pair(EffectId::JointSpring, EffectId::AsymmetricFriction));
    }
}
