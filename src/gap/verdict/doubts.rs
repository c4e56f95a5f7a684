//! Slips in a study that show once its joint was simulated: a gain in another unit, a zero at which no link hangs.
//!
//! They are questions, as those of [`Case::doubts`], which simulates nothing, and leave so much room that no honest
//! number is questioned.

use crate::deadline::Deadline;
use crate::gap::diagnosis::CauseShare;
use crate::gap::hypothesis::calibrate::calibrate;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::trial::Trial;
use crate::identify::{BeliefFound, Case};
use crate::joint::EffectId;
use crate::log::{DriveMode, MotorModel, MotorSpec};
use crate::number::{as_given, math, mrad, significant};
use std::f64::consts::{FRAC_PI_2, PI};

/// A gain that logs put more than this factor away is one in another unit.
const OTHER_UNIT: f64 = 5.0;
/// A moment that was moved by more of its standard deviations has nothing to do with the link; at another zero one that was
/// moved by fewer has.
const FAR_SD: f64 = 10.0;
const NEAR_SD: f64 = 3.0;
/// Another zero is looked for where the model as given is off by so many times the sensor's own noise, and by so much
/// \[rad\].
const OFF: f64 = 10.0;
const OFF_RAD: f64 = 0.05;
/// Where links hang whose zero is another: ticks are counted from the other side, or from the horizontal.
const OTHER_RESTS_RAD: [f64; 3] = [PI, FRAC_PI_2, -FRAC_PI_2];
/// It is another where the model leaves less than this share of its error.
const SHARE: f64 = 1.0 / 3.0;

/// With what the question begins where a link hangs.
const HANGS: &str = "Does the link hang straight down at 0 rad in these logs?";
/// And where readings stand off setpoints.
const SAME_ZERO: &str = "Do readings and setpoints count from the same zero?";
/// What the first sentence of an answer says of each.
const ASKED: [(&str, &str); 2] = [
    (HANGS, "or the link hangs elsewhere than at 0 rad"),
    (SAME_ZERO, "or readings and setpoints count from different zeros"),
];

/// An answer's sentences, of which the first asks whether the link hangs elsewhere, or readings have another zero than setpoints,
/// where that is among the doubts: a spring or another moment that is found may be no more than that. `is_named`: a cause is
/// named, and the question stands behind it.
pub(in crate::gap) fn asking(sentence: &str, doubts: &[String], is_named: bool) -> String {
    let is_asked = |question: &str| doubts.iter().any(|doubt| doubt.starts_with(question));
    let Some((_, elsewhere)) = ASKED.into_iter().find(|(question, _)| is_asked(question)) else {
        return sentence.to_owned();
    };
    let first = sentence.find(". ").unwrap_or(sentence.trim_end_matches('.').len());
    if let Some(at) = sentence[..first].find("; ").filter(|_| is_named) {
        return format!("{}, {elsewhere} (see the question below){}", &sentence[..at], &sentence[at..]);
    }
    format!("{}; {elsewhere}: see the question below{}", &sentence[..first], &sentence[first..])
}

/// What simulations made of a study.
pub(in crate::gap) struct Simulated<'a> {
    /// Causes of the answer; none before any is looked for.
    pub causes: &'a [CauseShare],
    /// The joint's numbers beside them.
    pub beliefs: &'a [BeliefFound],
    /// Error of the model as given \[rad\].
    pub given_rad: f64,
    /// The sensor's own \[rad\].
    pub floor_rad: f64,
    /// Until when more may be simulated.
    pub deadline: &'a Deadline,
}

impl Simulated<'_> {
    /// What is to be questioned of the study, in sentences.
    pub fn doubts(&self, case: &Case) -> Vec<String> {
        if case.has_crossed_columns() {
            return Vec::new();
        }
        let torque = self.torque().and_then(|share| other_gain(case, share));
        torque.into_iter().chain(self.other_rest(case)).chain(self.other_zero(case)).collect()
    }

    /// What is found of a number as a share of what is believed.
    fn share(&self, name: &str) -> Option<f64> {
        let own = self.beliefs.iter().find(|belief| belief.name == name && belief.believed > 0.0)?;
        Some(own.found / own.believed)
    }

    /// Torque that the motion asks for beside the link as stated, as a share of what the drive is stated to give: logs may
    /// tell no more than the ratio of both, and so it is in the gain, or in what turns and hangs alike. `None` where the gain is
    /// exact or there is no drive.
    fn torque(&self) -> Option<f64> {
        let is_everywhere = |cause: &&CauseShare| cause.effect == EffectId::MotorGain && cause.only.is_none();
        let cause = self.causes.iter().find(is_everywhere).and_then(|cause| cause.parameters.first());
        let gain = cause.map(|number| number.value).or_else(|| self.share("gain"))?;
        let link = match [self.share("inertia")?, self.share("moment").unwrap_or(1.0)] {
            [inertia, moment] if (inertia > 1.0) == (moment > 1.0) => {
                if math::ln(inertia).abs() < math::ln(moment).abs() { inertia } else { moment }
            }
            _ => 1.0,
        };
        Some(gain / link)
    }

    /// Whether the moment, or a spring, was bent to what hangs on the other side of the zero.
    fn has_lost_its_link(&self) -> bool {
        let moment = self.beliefs.iter().find(|belief| belief.name == "moment");
        moment.is_some_and(|moment| moment.moved_sd.abs() > FAR_SD)
            || self.causes.iter().any(|cause| cause.effect == EffectId::JointSpring)
    }

    /// A link that hangs elsewhere than at zero in the logs, where the study does not say it.
    fn other_rest(&self, case: &Case) -> Option<String> {
        let nominal = case.joint.nominal.filter(|nominal| nominal.moment_kg_m > 0.0)?;
        if case.joint.rest_rad.is_some() || case.is_described() || self.given_rad <= OFF * self.floor_rad {
            return None;
        }
        if self.given_rad <= OFF_RAD && !self.has_lost_its_link() {
            return None;
        }
        let mut evidence = Evidence::of(case, nominal)?.coarse();
        evidence.deadline = self.deadline.clone();
        let here = Hung::at(&evidence, 0.0);
        let others = OTHER_RESTS_RAD.map(|rest_rad| Hung::at(&evidence, rest_rad));
        let best = others.into_iter().min_by(|a, b| a.given_rad().total_cmp(&b.given_rad()))?;
        let given = [best.given_rad(), here.given_rad()];
        if is_far_better(given) {
            return Some(question(best.rest_rad, "as given", given));
        }
        // A drive may hide where the link hangs until numbers are refitted to it, and so may another cause.
        let [there, here] = [&best, &here].map(Hung::refitted);
        let refitted = [&there, &here].map(|trial| trial.fit_rms_rad(&best.evidence));
        let finds_its_link = moment_sd(&here) > FAR_SD && moment_sd(&there) < NEAR_SD && refitted[0] <= refitted[1];
        (finds_its_link || is_far_better(refitted)).then(|| question(best.rest_rad, "with refitted numbers", refitted))
    }

    /// Readings that stand off those of the model all along, where a servo holds these at its setpoints.
    fn other_zero(&self, case: &Case) -> Option<String> {
        let is_held = case.items.iter().all(|item| item.entry.drive == DriveMode::Position);
        let nominal = case.joint.nominal?;
        if self.given_rad <= OFF * self.floor_rad || !is_held {
            return None;
        }
        let mut evidence = Evidence::of(case, nominal)?.coarse();
        evidence.deadline = self.deadline.clone();
        let given = Trial::as_given(&evidence, &evidence.baseline());
        let means: Vec<f64> = given.fit.iter().filter(|log| !log.is_empty()).map(|log| mean(log)).collect();
        let off_rad = mean(&means);
        let squares =
            |log: &Vec<f64>| log.iter().map(|above| [above * above, (above - off_rad).powi(2)]).collect::<Vec<_>>();
        let both: Vec<[f64; 2]> = given.fit.iter().flat_map(squares).collect();
        let [here, there] = [0, 1].map(|k| (both.iter().map(|pair| pair[k]).sum::<f64>() / both.len() as f64).sqrt());
        let is_everywhere = means.iter().all(|own| (own - off_rad).abs() < SHARE * off_rad.abs());
        (is_everywhere && is_far_better([there, here])).then(|| {
            format!(
                "{SAME_ZERO} The readings stand {} {} what the model reads as given, all \
                 along; without that it would be off by {} in place of {}: state `zero` of q in [columns] if they do not.",
                mrad(off_rad.abs()),
                if off_rad > 0.0 { "below" } else { "above" },
                mrad(there),
                mrad(here)
            )
        })
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// By how many of its standard deviations a moment was moved.
fn moment_sd(trial: &Trial) -> f64 {
    trial.beliefs().iter().find(|belief| belief.name == "moment").map_or(0.0, |moment| moment.moved_sd.abs())
}

/// A torque of the drive that logs put far from the stated one.
fn other_gain(case: &Case, share: f64) -> Option<String> {
    if !share.is_finite() || (OTHER_UNIT.recip()..=OTHER_UNIT).contains(&share) {
        return None;
    }
    let servos = case.items.iter().map(|item| &item.entry).filter(|entry| entry.drive == DriveMode::Position);
    let motors: Vec<&MotorSpec> = servos.filter_map(|entry| entry.motor.as_ref()).collect();
    let asked = match motors[..] {
        [] => "these logs state: is `tau` in N m at the joint?".to_owned(),
        [first, ..] if motors.iter().all(|motor| *motor == first) => {
            format!("the drive is stated to give, {}", of_servo(first, share))
        }
        _ => "the drives of these logs are stated to give: are their gains in N m/rad (docs/tutorials/servo.md)?"
            .to_owned(),
    };
    Some(format!("The motion asks for {} times the torque that {asked}", significant(share, 3)))
}

fn of_servo(motor: &MotorSpec, share: f64) -> String {
    let [found, stated] = [significant(share * motor.kp_nm_rad, 3), as_given(motor.kp_nm_rad)];
    let ask = match motor.model {
        MotorModel::Torque => {
            "is kp in N m/rad (N/m where the joint slides)? A servo's firmware gain needs conversion (docs/tutorials/servo.md)."
        }
        MotorModel::Voltage(_) => {
            "is kp the duty per rad, and are kt, resistance and supply those of this drive (docs/tutorials/servo.md)?"
        }
    };
    format!("as with kp = {found} in place of {stated}: {ask}")
}

/// Whether what is left there is far less than what is left here.
fn is_far_better([there_rad, here_rad]: [f64; 2]) -> bool {
    there_rad < SHARE * here_rad
}

fn question(rest_rad: f64, model: &str, left_rad: [f64; 2]) -> String {
    let off = |rad: f64| if rad.is_finite() { mrad(rad) } else { "running away".to_owned() };
    let [there, here] = left_rad.map(off);
    format!(
        "{HANGS} At rest = {} rad the model {model} would be off by {there} in place of {here}: state `rest` in [joint].",
        significant(rest_rad, 3)
    )
}

/// A joint as given that hangs at another angle.
struct Hung {
    rest_rad: f64,
    evidence: Evidence,
    given: Trial,
}

impl Hung {
    fn at(evidence: &Evidence, rest_rad: f64) -> Self {
        let evidence = Evidence { rest_rad, ..evidence.with_logs(evidence.fit.clone(), Vec::new()) };
        let given = Trial::as_given(&evidence, &evidence.baseline());
        Self { rest_rad, evidence, given }
    }

    fn given_rad(&self) -> f64 {
        self.given.fit_rms_rad(&self.evidence)
    }

    fn refitted(&self) -> Trial {
        calibrate(&self.evidence, &self.evidence.baseline(), &self.given)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::check;
    use crate::identify::Signal;
    use crate::log::VoltageMotor;

    const DRIVEN: &str = "data/examples/delay/study.toml";
    const FREE: &str = "data/examples/ambiguous/study.toml";

    fn case(study: &str) -> Case {
        Case::of_study(study.as_ref()).unwrap()
    }

    /// The free swings, read from a zero `by_rad` away, of a study that says nothing of it.
    fn turned(by_rad: f64) -> Case {
        let mut case = case(FREE);
        case.joint.rest_rad = None;
        for e in case.items.iter_mut().flat_map(|item| &mut item.experiments) {
            e.measured_rad.iter_mut().for_each(|reading| *reading += by_rad);
            e.start.angle_rad += by_rad;
        }
        case
    }

    #[test]
    fn honest_studies_are_not_questioned() {
        let mut driven = case(DRIVEN);
        driven.joint.rest_rad = None;
        for case in [case(DRIVEN), driven, case(FREE), turned(0.0)] {
            assert_eq!(check(&case).unwrap().doubts, [""; 0]);
        }
    }

    /// A swing about a zero on the other side was headlined as a spring, and the question stood at the end of the page alone.
    #[test]
    fn the_first_sentence_asks_where_the_link_hangs_where_that_is_questioned() {
        let doubts = [question(PI, "as given", [0.1, 3.0])];
        let spring = "arm: the gap is a spring (k = 0.6 N m/rad); the error goes from 3 to 1. Something else is left.";
        assert_eq!(asking(spring, &[], true), spring);
        assert_eq!(
            asking(spring, &doubts, true),
            "arm: the gap is a spring (k = 0.6 N m/rad), or the link hangs elsewhere than at 0 rad (see the question below); \
             the error goes from 3 to 1. Something else is left."
        );
        assert_eq!(
            asking("arm: the numbers are off; refitting them goes from 3.2 to 1.", &doubts, false),
            "arm: the numbers are off; refitting them goes from 3.2 to 1; or the link hangs elsewhere than at 0 rad: see the \
             question below."
        );
    }

    #[test]
    fn a_gain_in_another_unit_is_questioned_with_what_the_logs_make_of_it() {
        let mut case = case(DRIVEN);
        for item in &mut case.items {
            item.entry.motor.as_mut().unwrap().kp_nm_rad = 400.0;
            item.experiments.iter_mut().for_each(|e| e.motor.as_mut().unwrap().kp_nm_rad = 400.0);
        }
        let doubts = check(&case).unwrap().doubts;
        assert_eq!(doubts.len(), 1, "{doubts:?}");
        for part in ["in place of 400", "is kp in N m/rad", "docs/tutorials/servo.md"] {
            assert!(doubts[0].contains(part), "{}", doubts[0]);
        }
    }

    #[test]
    fn a_gain_within_a_factor_of_a_few_is_no_other_unit() {
        let case = case(DRIVEN);
        for share in [0.21, 1.0, 4.9, f64::NAN] {
            assert_eq!(other_gain(&case, share), None, "{share}");
        }
        assert!(other_gain(&case, 0.19).is_some_and(|words| words.contains("0.190 times the torque")));
        assert!(other_gain(&case, 57.3).is_some_and(|words| words.contains("kp = 458 in place of 8:")));
    }

    #[test]
    fn what_turns_and_hangs_alike_is_told_as_torque() {
        let belief = |name: &str, share| BeliefFound {
            name: name.to_owned(),
            believed: 2.0,
            found: 2.0 * share,
            ..BeliefFound::default()
        };
        let torque = |gain, inertia, moment| {
            let beliefs = [belief("gain", gain), belief("inertia", inertia), belief("moment", moment)];
            let deadline = &Deadline::default();
            Simulated { causes: &[], beliefs: &beliefs, given_rad: 0.0, floor_rad: 0.0, deadline }.torque().unwrap()
        };
        // A torque logged in kgf m; a gain in a firmware's unit; a rotor that nobody stated; a delay that slows everything.
        approx::assert_relative_eq!(torque(1.05, 0.105, 0.105), 10.0, max_relative = 1e-12);
        assert!(torque(0.6, 45.0, 37.0) < 0.02);
        assert_eq!(torque(1.0, 10.0, 0.98), 1.0);
        assert!(torque(0.174, 0.43, 0.18) > 0.4);
    }

    #[test]
    fn of_each_kind_of_drive_its_own_numbers_are_questioned() {
        let mut case = case(DRIVEN);
        let asked = |case: &Case| other_gain(case, 0.01).unwrap();
        let fed = VoltageMotor { kt_nm_a: 1.5, resistance_ohm: 2.0, supply_v: 12.0, duty_limit: 1.0 };
        case.items.push(case.items[0].clone());
        case.items[0].entry.motor.as_mut().unwrap().model = MotorModel::Voltage(fed);
        assert!(asked(&case).contains("are their gains in N m/rad"), "{}", asked(&case));
        case.items.iter_mut().for_each(|item| item.entry.motor.as_mut().unwrap().model = MotorModel::Voltage(fed));
        assert!(asked(&case).contains("is kp the duty per rad"), "{}", asked(&case));
        case.items.iter_mut().for_each(|item| item.entry.drive = DriveMode::Torque);
        assert!(asked(&case).contains("is `tau` in N m"), "{}", asked(&case));
    }

    #[test]
    fn a_link_that_hangs_on_the_other_side_of_the_zero_is_questioned_unless_the_study_says_it() {
        let mut case = turned(PI);
        let doubts = check(&case).unwrap().doubts;
        assert_eq!(doubts.len(), 1, "{doubts:?}");
        assert!(doubts[0].contains("At rest = 3.14 rad") && doubts[0].contains("state `rest`"), "{}", doubts[0]);
        case.joint.rest_rad = Some(PI);
        assert_eq!(check(&case).unwrap().doubts, [""; 0]);
    }

    #[test]
    fn so_is_one_whose_servo_is_late_and_hides_it() {
        let mut case = case(DRIVEN);
        case.joint.rest_rad = None;
        for e in case.items.iter_mut().flat_map(|item| &mut item.experiments) {
            e.measured_rad.iter_mut().for_each(|reading| *reading += PI);
            e.start.angle_rad += PI;
            let Signal::Position { setpoint_rad, .. } = &mut e.signal else { panic!("driven") };
            setpoint_rad.iter_mut().for_each(|setpoint| *setpoint += PI);
        }
        let doubts = check(&case).unwrap().doubts;
        assert!(matches!(&doubts[..], [only] if only.contains("At rest = 3.14 rad")), "{doubts:?}");
    }

    #[test]
    fn readings_that_stand_off_their_setpoints_all_along_are_questioned() {
        let mut case = case(DRIVEN);
        let asks = |case: &Case| {
            let doubts = check(case).unwrap().doubts;
            doubts.into_iter().find(|doubt| doubt.contains("count from the same zero"))
        };
        assert_eq!(asks(&case), None);
        for e in case.items.iter_mut().flat_map(|item| &mut item.experiments) {
            e.measured_rad.iter_mut().for_each(|reading| *reading += 0.3);
            e.start.angle_rad += 0.3;
        }
        let doubt = asks(&case).expect("no servo holds a joint so far off");
        assert!(doubt.contains("above what the model reads"), "{doubt}");
    }
}
