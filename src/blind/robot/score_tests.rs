//! Answers about robots made by hand.

use super::*;
use crate::gap::Verdict;
use crate::gap::robot::Cause;
use crate::joint::EffectId;

const DELAY: Cause = Cause::Effect(EffectId::Delay);
const GAIN: Cause = Cause::Effect(EffectId::MotorGain);

fn names(joints: &[&str]) -> Vec<String> {
    joints.iter().map(|joint| (*joint).to_owned()).collect()
}

fn truth(verdict: Verdict, causes: &[(Cause, &[&str])]) -> RobotTruth {
    let fault = |(cause, joints): &(Cause, &[&str])| TrueFault {
        id: cause.id(),
        joints: names(joints),
        parameters: vec![],
        ratio: 6.0,
    };
    RobotTruth {
        seed: 1,
        trial: 0,
        scenario: "air",
        robot: "ers7".to_owned(),
        verdict,
        causes: causes.iter().map(|(cause, _)| *cause).collect(),
        outside: (verdict == Verdict::Unexplained).then_some(RobotOutside::Boot),
        faults: causes.iter().map(fault).collect(),
        ratio: 6.0,
        noise_rad: 0.0026,
        scatter: 0.07,
        friction_scatter: 0.2,
        method: String::new(),
        motions: vec![],
    }
}

fn answered(verdict: Verdict, causes: &[(Cause, &[&str])]) -> RobotAnswered {
    let mut stated =
        causes.iter().map(|(cause, joints)| StatedCause { cause: *cause, joints: names(joints), parameters: vec![] });
    let (first, second) = (stated.next(), stated.next());
    RobotAnswered {
        verdict,
        equivalent: first.iter().map(|stated| stated.cause).collect(),
        places: first.iter().map(|stated| stated.joints.clone()).collect(),
        first,
        second,
        more: vec![],
        probability: 0.8,
        standing: "joint effect, clamped, clear".to_owned(),
        partial: None,
        joints: vec![],
        before: 0.01,
        after: 0.003,
        floor: 0.0026,
        ranking: vec![],
        sentence: String::new(),
    }
}

fn trial(truth: RobotTruth, answer: RobotAnswered) -> RobotTrial {
    RobotTrial { truth, answer: Ok(answer), wall_s: 10.0 }
}

#[test]
fn an_answer_is_right_where_kind_cause_and_joints_are() {
    let there: &[(Cause, &[&str])] = &[(DELAY, &["lf2", "rf2"])];
    let judge = |answer| RobotJudgement::of(&trial(truth(Verdict::Effect, there), answer));
    let right = judge(answered(Verdict::Effect, &[(DELAY, &["rf2", "lf2"])]));
    assert!(right.top && right.set && right.place == Some(true), "the order of joints is no matter");
    let half = judge(answered(Verdict::Effect, &[(DELAY, &["lf2"])]));
    assert!(half.verdict && !half.top && half.named == Some(true));
    assert_eq!((half.place, half.overlaps), (Some(false), Some(true)));
    let elsewhere = judge(answered(Verdict::Effect, &[(DELAY, &["rr3"])]));
    assert_eq!((elsewhere.place, elsewhere.overlaps, elsewhere.set), (Some(false), Some(false), false));
    // in the set: another cause and place are named, the right ones could not be told apart
    let mut either = answered(Verdict::Effect, &[(GAIN, &["lf2"])]);
    either.equivalent.push(DELAY);
    assert!(!judge(either.clone()).set, "the place is not in the set");
    either.places.push(names(&["lf2", "rf2"]));
    assert!(judge(either.clone()).set && !judge(either).top);
    let missed = judge(answered(Verdict::None, &[]));
    assert_eq!((missed.missed, missed.false_alarm, missed.top), (Some(true), None, false));
}

#[test]
fn numbers_of_an_arm_that_were_drawn_off_may_be_recalibrated() {
    let arm = RobotTruth { scenario: "arm", ..truth(Verdict::None, &[]) };
    let judge = |truth: &RobotTruth, answer| RobotJudgement::of(&trial(truth.clone(), answer));
    let right = judge(&arm, answered(Verdict::Calibration, &[(Cause::Viscous, &["lf1"])]));
    assert!(right.top && right.set && right.false_alarm == Some(false));
    assert_eq!(judge(&arm, answered(Verdict::Effect, &[(DELAY, &["lf1"])])).false_alarm, Some(true));
    let exact = RobotTruth { scatter: 0.0, friction_scatter: 0.0, ..arm };
    assert_eq!(judge(&exact, answered(Verdict::Calibration, &[])).false_alarm, Some(true));
}

#[test]
fn two_causes_are_right_in_any_order_and_three_are_too_many() {
    let there: &[(Cause, &[&str])] = &[(DELAY, &["lf2"]), (Cause::Payload, &[])];
    let judge = |answer| RobotJudgement::of(&trial(truth(Verdict::Effect, there), answer));
    assert!(judge(answered(Verdict::Effect, &[(Cause::Payload, &[]), (DELAY, &["lf2"])])).top);
    assert!(!judge(answered(Verdict::Effect, &[(DELAY, &["lf2"])])).top);
    let one = RobotJudgement::of(&trial(
        truth(Verdict::Effect, &there[..1]),
        answered(Verdict::Effect, &[(DELAY, &["lf2"]), (GAIN, &["lf2"])]),
    ));
    assert!(!one.top && !one.set, "a second cause that is not there");
}

#[test]
fn a_score_counts_alarms_misses_and_what_was_taken_for_what() {
    let outside = truth(Verdict::Unexplained, &[]);
    let trials = [
        trial(truth(Verdict::None, &[]), answered(Verdict::None, &[])),
        trial(truth(Verdict::None, &[]), answered(Verdict::Calibration, &[(Cause::Viscous, &["lf1"])])),
        trial(outside, answered(Verdict::Unexplained, &[])),
        trial(truth(Verdict::Effect, &[(DELAY, &["lf2"])]), answered(Verdict::Effect, &[(GAIN, &["lf2"])])),
        RobotTrial {
            truth: truth(Verdict::Effect, &[(DELAY, &["lf2"])]),
            answer: Err("log-00.csv: cannot be read".to_owned()),
            wall_s: 1.0,
        },
    ];
    let score = score_robots(&trials);
    assert_eq!((score.false_alarms.hits, score.false_alarms.of), (1, 2), "an accused friction is a false alarm");
    assert_eq!((score.top.hits, score.set.hits, score.failed), (2, 2, 1));
    assert_eq!((score.unexplained.hits, score.unexplained.of), (1, 1));
    assert_eq!((score.place.hits, score.overlaps.hits, score.place.of), (1, 1, 2));
    assert_eq!(score.confusion.rows, ["delay", "none", "outside"]);
    assert_eq!(score.confusion.columns, ["delay", "motor_gain", "viscous", "none", "unexplained", "failed"]);
    assert_eq!(score.causes[0].taken_for, Some(("failed".to_owned(), 1)));
    assert_eq!(score.scenarios.len(), 1);
}
