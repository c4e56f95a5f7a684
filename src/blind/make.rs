//! Makes a study and keeps its answer.

use super::cause::{Cause, CauseFilter};
use super::dice::Dice;
use super::draw::draw_cause;
use super::joint::Joint;
use super::plan::{Driven, LogPlan, one_sided, plan};
use super::sim::{Drive, Machine, Trace};
use super::size::{all_logs, coarse, rms_rad, rms_speed_rad_s};
use super::truth::{FourNumbers, Gains, Truth};
use super::write::files;
use crate::joint::EffectId;

/// Step of the logs that are written \[s\].
const FINE_S: f64 = 2.5e-5;
/// Studies that are drawn until one shows its cause; the last is taken as it is.
const ATTEMPTS: usize = 25;
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
    make_filtered(seed, trial, &CauseFilter::Any)
}

/// Makes study `trial` of a run, with a cause drawn from a kind.
pub fn make_filtered(seed: u64, trial: u64, filter: &CauseFilter) -> Made {
    let mut dice = Dice::new(seed, trial);
    let cause = draw_cause(filter, &mut dice);
    made(seed, trial, &cause, dice)
}

/// Makes study `trial` of a run, with a given cause.
pub fn make_with(seed: u64, trial: u64, cause: Cause) -> Made {
    make_filtered(seed, trial, &CauseFilter::Only(cause))
}

fn made(seed: u64, trial: u64, cause: &Cause, mut dice: Dice) -> Made {
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
    /// How much a servo's motor brakes by its voltage \[N m s/rad\].
    pub back_emf_nm_s_rad: f64,
}

impl Draft {
    fn draw(cause: &Cause, dice: &mut Dice) -> Self {
        let mut joint = Joint::draw(dice);
        let driven = match cause {
            Cause::Servo if dice.chance(0.5) => Driven::All,
            _ if cause.needs_motor() || dice.chance(0.6) => Driven::Some,
            _ => Driven::None,
        };
        let mut plans = plan(&joint, driven, dice);
        let (is_one_sided, side) = (dice.chance(0.25), dice.sign());
        if is_one_sided || cause.has(EffectId::EndStop) {
            one_sided(&mut plans, side);
        }
        let textbook = dice.chance(0.5);
        let mut plain =
            Machine::plain(joint.inertia_kg_m2, joint.peak_gravity_nm(), joint.coulomb_nm, joint.viscous_nm_s_rad);
        plain.drive = Drive { kp: joint.kp, kd: joint.kd, ..Drive::default() };
        let mut back_emf_nm_s_rad = 0.0;
        if *cause == Cause::Servo {
            // the drive of a servo knows no torque
            joint.tau_column = false;
            back_emf_nm_s_rad = joint.kd * dice.log_uniform(0.1, 1.0);
            plain.drive.back_emf_nm_s_rad = back_emf_nm_s_rad;
        }
        let presliding = dice.chance(0.5);
        let bristle_rad = joint.sensor.noise_rad() * dice.uniform(0.1, 0.5);
        if !textbook && presliding {
            presliding_within_noise(&mut plain, &plans, joint.sensor.noise_rad(), bristle_rad);
        }
        Self { joint, plans, plain, textbook, back_emf_nm_s_rad }
    }

    /// Puts the cause in and writes the logs; `None` where it would not show as it should, unless it is `forced`.
    fn finish(self, (seed, trial): (u64, u64), cause: &Cause, forced: bool, dice: &mut Dice) -> Option<Made> {
        let plain = coarse(&self.plain, &self.plans);
        if !tame(&plain) {
            return None;
        }
        let noise_rad = self.joint.sensor.noise_at_rad(rms_speed_rad_s(&plain, &self.plans));
        let matter = self.matter(cause, plain, noise_rad, forced, dice)?;
        let traces = all_logs(&matter.machine, &self.plans, FINE_S);
        if !tame(&traces) {
            return None;
        }
        let study = files(&self.joint, &matter.belief, &self.plans, &traces, dice);
        let driven_logs = self.plans.iter().filter(|plan| plan.is_driven()).count();
        let truth = Truth {
            seed,
            trial,
            verdict: matter.verdict,
            causes: matter.causes,
            servo: *cause == Cause::Servo,
            numbers: matter.numbers,
            within: matter.within,
            outside: if let Cause::Outside(id) = cause { Some(*id) } else { None },
            location: matter.location,
            stage: matter.mechanisms.iter().find(|mechanism| mechanism.counts).map(|mechanism| mechanism.stage),
            mechanisms: matter.mechanisms,
            ratio: matter.ratio,
            left: matter.left,
            nearest: matter.nearest,
            joint: self.numbers(),
            nominal: matter.belief.nominal,
            gains: (driven_logs > 0).then(|| self.gains()),
            nominal_gains: (driven_logs > 0).then_some(matter.belief.gains),
            believed: matter.belief.believed,
            family: self.joint.family,
            textbook: self.textbook,
            noise: self.joint.sensor.noise,
            stamps: self.joint.sensor.stamps,
            holes: self.joint.sensor.holes,
            noise_rad,
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

    /// The gains as they are; what a motor brakes by its voltage adds to `kd`.
    pub(super) fn gains(&self) -> Gains {
        Gains { kp: self.joint.kp, kd: self.joint.kd + self.back_emf_nm_s_rad }
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
    use crate::gap::Verdict;
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
            assert_eq!(study.uncertain == crate::log::Uncertain::default(), !truth.believed.written);
            let exact = truth.joint == truth.nominal && truth.gains == truth.nominal_gains;
            assert!(!(exact && (truth.within || !truth.numbers.is_empty())), "{truth:?}");
            assert_eq!(truth.verdict == Verdict::Effect, !truth.causes.is_empty());
            let expected = match truth.verdict {
                Verdict::None => 0.0..=1e6,
                Verdict::Calibration => 2.0..=1e6,
                Verdict::Effect | Verdict::Unexplained => 1.3..=5000.0,
            };
            assert!(expected.contains(&truth.ratio), "{truth:?}");
        }
    }

    #[test]
    fn sizes_lie_where_they_are_sought() {
        for (trial, effect) in EffectId::ALL.iter().enumerate() {
            let truth = make_with(12, trial as u64, Cause::Effects(vec![*effect])).truth;
            let mechanism = &truth.mechanisms[0];
            assert_eq!((mechanism.id, truth.effects()), (effect.id(), vec![effect.id()]));
            assert!((1.3..300.0).contains(&mechanism.ratio) && mechanism.left >= 0.4, "{mechanism:?}");
            assert!(mechanism.left <= mechanism.ratio * 1.001, "{mechanism:?}");
            assert!(!super::super::cause::needs_motor(*effect) || truth.driven_logs >= 2);
        }
    }

    #[test]
    fn of_several_effects_every_one_shows() {
        for count in 2..=4 {
            let truth = make_filtered(13, count, &CauseFilter::Effects(count as usize)).truth;
            assert_eq!((truth.mechanisms.len(), truth.causes.len()), (count as usize, count as usize));
            assert!(truth.mechanisms.iter().all(|m| m.ratio >= 2.5 && m.left >= 0.8), "{truth:?}");
        }
    }

    #[test]
    fn a_servo_is_several_things_and_says_which() {
        for trial in 0..3 {
            let truth = make_with(14, trial, Cause::Servo).truth;
            assert!(truth.servo && truth.causes.len() >= 2 && truth.driven_logs >= 2, "{truth:?}");
            let braked = truth.gains.is_some_and(|gains| gains.kd > 0.0);
            assert!(braked && truth.mechanisms.len() == 5, "{truth:?}");
        }
    }
}
