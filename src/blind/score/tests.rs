//! Scores of hand-made trials.

use super::*;
use crate::blind::OutsideId;
use crate::blind::answer::{Answered, GapNumbers, StatedEffect, StatedNumber};
use crate::blind::joint::Family;
use crate::blind::sensor::{Noise, Stamps};
use crate::blind::truth::{Believed, FourNumbers, TrueMechanism, TrueNumber, TrueWhere};
use crate::gap::Variable;
use crate::joint::{EffectId, Stage};
use approx::assert_relative_eq;

fn mechanism(effect: EffectId) -> TrueMechanism {
    let parameters = vec![TrueNumber::new(effect.named_parameters()[0].name, "", 2.0)];
    TrueMechanism { id: effect.id(), counts: true, stage: effect.stage(), parameters, ratio: 10.0, left: 5.0 }
}

fn truth(verdict: Verdict, effects: &[EffectId]) -> Truth {
    let numbers = FourNumbers::of([1.0, 2.0, 3.0, 4.0]);
    Truth {
        seed: 1,
        trial: 0,
        verdict,
        causes: effects.to_vec(),
        servo: false,
        numbers: vec![],
        within: false,
        outside: (verdict == Verdict::Unexplained).then_some(OutsideId::Cogging),
        location: None,
        stage: effects.first().map(|effect| effect.stage()),
        mechanisms: effects.iter().map(|effect| mechanism(*effect)).collect(),
        ratio: 10.0,
        left: 5.0,
        nearest: None,
        joint: numbers,
        nominal: numbers,
        gains: None,
        nominal_gains: None,
        believed: Believed { inertia: 0.1, moment: 0.05, friction: 0.5, gain: 0.1, written: false },
        family: Family::Servo,
        textbook: true,
        noise: Noise::Rounding,
        stamps: Stamps::Regular,
        holes: 0,
        noise_rad: 1e-3,
        free_logs: 5,
        driven_logs: 2,
        loaded_logs: 1,
    }
}

fn answered(verdict: Verdict, effects: &[EffectId], equivalent: &[EffectId], probability: f64) -> Answered {
    let number = |name: &str, value: f64, interval: [f64; 2]| StatedNumber {
        name: name.to_owned(),
        value,
        interval: Some(interval),
        interval_naive: Some([value, value]),
    };
    let stated = |effect: &EffectId| StatedEffect {
        equivalent: vec![],
        effect: *effect,
        parameters: vec![number(effect.named_parameters()[0].name, 2.1, [1.9, 2.3])],
    };
    Answered {
        verdict,
        effect: effects.first().map(|effect| effect.id().to_owned()),
        causes: effects.to_vec(),
        equivalent: equivalent.to_vec(),
        probability,
        standing: String::new(),
        partial: None,
        intervals_trusted: true,
        stage: effects.first().map(|effect| effect.stage()),
        variable: None,
        range: None,
        gap: GapNumbers {
            before: 0.03,
            calibrated: 0.02,
            after_first: 0.002,
            after: 0.002,
            floor: 0.002,
            closed: Some(1.0),
            closed_interval: None,
        },
        ranking: vec![],
        effects: effects.iter().map(stated).collect(),
        joint: vec![number("inertia", 1.1, [0.9, 1.3]), number("moment", 3.0, [2.5, 3.5])],
    }
}

fn counts(rate: Rate) -> (u32, u32) {
    (rate.hits, rate.of)
}

fn trial(truth: Truth, answer: Answered, wall_s: f64) -> Trial {
    Trial { truth, answer: Ok(answer), wall_s }
}

use EffectId::{Delay, MotorGain, Stribeck};
use Verdict::{Calibration, Effect, None as Nothing, Unexplained};

#[test]
fn an_answer_is_judged_by_what_it_names() {
    let one = truth(Effect, &[Delay]);
    let judge = |truth: &Truth, answer: Answered| Judgement::of(&trial(truth.clone(), answer, 1.0));

    let right = judge(&one, answered(Effect, &[Delay], &[Delay], 0.9));
    assert!(right.verdict && right.top && right.set && right.stage == Some(true) && right.missed == Some(false));
    let near = judge(&one, answered(Effect, &[MotorGain], &[MotorGain, Delay], 0.9));
    assert!(near.verdict && !near.top && near.set && near.any == Some(false) && near.stage == Some(false));
    let too_much = judge(&one, answered(Effect, &[Delay, Stribeck], &[Delay], 0.9));
    assert!(!too_much.top && !too_much.set && too_much.any == Some(true));
    let missed = judge(&one, answered(Calibration, &[], &[], 0.9));
    assert!(!missed.verdict && missed.missed == Some(true) && missed.false_alarm.is_none());

    let two = truth(Effect, &[Delay, Stribeck]);
    let turned = judge(&two, answered(Effect, &[Stribeck, Delay], &[Stribeck], 0.9));
    assert!(turned.top && turned.set && turned.stage == Some(true), "the order of several effects does not count");
    let half = judge(&two, answered(Effect, &[Stribeck], &[Stribeck], 0.9));
    assert!(half.verdict && !half.top && !half.set && half.any == Some(true));

    let nothing = truth(Nothing, &[]);
    let alarm = judge(&nothing, answered(Unexplained, &[], &[], 0.9));
    assert!(alarm.false_alarm == Some(true) && alarm.any.is_none() && alarm.stage.is_none());
    let needless = judge(&nothing, answered(Calibration, &[], &[], 0.9));
    assert!(!needless.verdict && needless.false_alarm == Some(false));
}

#[test]
fn a_gain_that_is_stated_wrong_is_a_motor_that_delivers_something_else() {
    let judge = |truth: &Truth, effects: &[EffectId]| {
        Judgement::of(&trial(truth.clone(), answered(Effect, effects, &effects[..1], 0.9), 1.0))
    };
    let stated = |numbers: &[&'static str], truth: Truth| Truth { numbers: numbers.to_vec(), ..truth };
    let wrong = stated(&["inertia", "kp"], truth(Calibration, &[]));
    let named = judge(&wrong, &[MotorGain]);
    assert!(named.verdict && named.top && named.false_alarm == Some(false));
    assert_eq!(judge(&wrong, &[Delay]).false_alarm, Some(true));
    assert_eq!(judge(&wrong, &[MotorGain, Delay]).false_alarm, Some(true));
    assert_eq!(judge(&stated(&["kd"], truth(Calibration, &[])), &[MotorGain]).false_alarm, Some(true));
    // Beside an effect it is neither asked for nor needless.
    let beside = stated(&["kp"], truth(Effect, &[Delay]));
    assert!(judge(&beside, &[Delay]).top && judge(&beside, &[Delay, MotorGain]).top);
    assert!(!judge(&truth(Effect, &[Delay]), &[Delay, MotorGain]).top);
}

#[test]
fn every_cause_has_its_own_set() {
    let two = truth(Effect, &[Delay, Stribeck]);
    let mut answer = answered(Effect, &[Delay, MotorGain], &[Delay], 0.9);
    assert!(!Judgement::of(&trial(two.clone(), answer.clone(), 1.0)).set);
    answer.effects[1].equivalent = vec![MotorGain, Stribeck];
    let judged = Judgement::of(&trial(two, answer, 1.0));
    assert!(judged.set && !judged.top);
}

#[test]
fn a_run_is_scored_by_hand() {
    let mut wrong_number = answered(Calibration, &[], &[], 0.6);
    wrong_number.effect = Some("moment".into());
    let mut calibration = truth(Calibration, &[]);
    calibration.numbers = vec!["coulomb", "moment"];
    let trials = vec![
        trial(truth(Effect, &[Delay]), answered(Effect, &[Delay], &[Delay, MotorGain], 0.9), 0.5),
        trial(truth(Effect, &[Stribeck]), answered(Calibration, &[], &[], 0.7), 1.5),
        trial(truth(Effect, &[Delay, Stribeck]), answered(Effect, &[Delay], &[Delay], 0.5), 1.0),
        trial(truth(Nothing, &[]), answered(Nothing, &[], &[], 0.98), 0.2),
        trial(calibration, wrong_number, 0.3),
        trial(truth(Unexplained, &[]), answered(Effect, &[Delay], &[Delay], 0.4), 0.4),
        Trial { truth: truth(Unexplained, &[]), answer: Err("no".into()), wall_s: 0.1 },
    ];
    let score = score(&trials);
    assert_eq!((score.trials, score.failed), (7, 1));
    assert_eq!(counts(score.verdict), (4, 7));
    assert_eq!(counts(score.top), (3, 7));
    assert_eq!((counts(score.single), counts(score.several), counts(score.all)), ((1, 2), (0, 1), (0, 1)));
    assert_eq!((counts(score.half), counts(score.needless)), ((1, 1), (1, 3)));
    assert_eq!((counts(score.number), counts(score.number_any)), ((0, 1), (1, 1)));
    assert_relative_eq!(score.set_size.unwrap(), 4.0 / 3.0, epsilon = 1e-12);
    assert_eq!((counts(score.false_alarms), counts(score.missed)), ((0, 2), (2, 5)));
    assert_relative_eq!(score.false_alarm_bound, 1.0 - 0.05_f64.sqrt(), epsilon = 1e-9);
    assert_eq!((counts(score.unexplained), counts(score.needless_calibration)), ((0, 2), (0, 1)));
    assert_eq!(score.stated.bins.iter().map(|bin| bin.right.of).sum::<u32>(), 6, "a failure states nothing");
    assert_eq!((score.wall.median_s, score.wall.max_s), (0.4, 1.5));

    // right answers: delay, nothing, calibration; inertia 1 within [0.9, 1.3], moment 2 not within [2.5, 3.5]
    assert_eq!(score.coverage[0].name, "inertia");
    assert_eq!((counts(score.coverage[0].textbook), counts(score.coverage[1].textbook)), ((3, 3), (0, 3)));
    assert_eq!(counts(score.coverage[0].textbook_naive), (0, 3));
    let delay = score.coverage.iter().find(|c| c.name == "delay.T").unwrap();
    assert_eq!((counts(delay.textbook), counts(delay.variant)), ((1, 1), (0, 0)));

    let causes: Vec<&str> = score.causes.iter().map(|cause| cause.cause.as_str()).collect();
    assert_eq!(causes, ["delay", "stribeck", "delay+stribeck", "cogging", "calibration", "none"]);
    assert_eq!(score.causes[1].taken_for, Some(("calibration".into(), 1)));
    assert_eq!((score.sizes.len(), score.sizes[0].from, counts(score.sizes[0].missed)), (1, 3.0, (1, 2)));
}

#[test]
fn confusion_has_what_occurs_and_a_whole_diagonal() {
    let trials = vec![
        trial(truth(Effect, &[Delay]), answered(Calibration, &[], &[], 0.7), 1.0),
        trial(truth(Effect, &[Delay, Stribeck]), answered(Effect, &[Stribeck, Delay], &[], 0.7), 1.0),
        trial(truth(Unexplained, &[]), answered(Effect, &[MotorGain], &[], 0.7), 1.0),
    ];
    let table = Table::of(&trials);
    assert_eq!(table.rows, ["delay", "several effects", "outside"]);
    assert_eq!(table.columns, ["delay", "motor_gain", "several effects", "calibration", "unexplained"]);
    assert_eq!(table.counts, [[0, 0, 0, 1, 0], [0, 0, 1, 0, 0], [0, 1, 0, 0, 0]]);
    assert!(Table::is_right("outside", "unexplained") && !Table::is_right("delay", "unexplained"));
}

#[test]
fn angles_are_covered_modulo_a_turn() {
    let position = EffectId::PositionFriction;
    let mut truth = truth(Effect, &[position]);
    truth.mechanisms[0].parameters = vec![TrueNumber::new("phi", "rad", 3.1)];
    let mut answer = answered(Effect, &[position], &[position], 0.9);
    let turned = [3.0 - std::f64::consts::TAU, 3.2 - std::f64::consts::TAU];
    answer.effects[0].parameters[0].name = "phi".into();
    answer.effects[0].parameters[0].interval = Some(turned);
    answer.effects[0].effect = position;
    assert_eq!(answer.effects[0].effect.stage(), Stage::Link);
    let found = coverage::coverage(&[trial(truth, answer, 1.0)]);
    assert_eq!(found.iter().find(|c| c.name == "position_friction.phi").unwrap().textbook, Rate::new(1, 1));
}

#[test]
fn a_place_is_right_where_stage_variable_and_range_are() {
    let place =
        TrueWhere { stage: Stage::Link, variables: &[Variable::Angle, Variable::Speed], range: Some([0.2, 0.4]) };
    let truth = Truth { location: Some(place), ..truth(Unexplained, &[]) };
    let located = |stage, variable, range| {
        let answer =
            Answered { stage: Some(stage), variable: Some(variable), range, ..answered(Unexplained, &[], &[], 0.9) };
        Judgement::of(&trial(truth.clone(), answer, 1.0)).located
    };
    assert_eq!(located(Stage::Link, Variable::Angle, Some([0.3, 0.9])), Some(true));
    assert_eq!(located(Stage::Link, Variable::Angle, Some([0.5, 0.9])), Some(false));
    assert_eq!(located(Stage::Link, Variable::Speed, Some([3.0, 9.0])), Some(true), "the range is one of angles");
    assert_eq!(located(Stage::Motor, Variable::Angle, Some([0.3, 0.9])), Some(false));
    assert_eq!(located(Stage::Link, Variable::Time, Some([0.3, 0.9])), Some(false));
}

#[test]
fn sets_count_what_is_right_what_is_missing_and_what_is_needless() {
    let four = truth(Effect, &[Delay, Stribeck, MotorGain, EffectId::Backlash]);
    let judge = |effects: &[EffectId]| {
        let j = Judgement::of(&trial(four.clone(), answered(Effect, effects, &[], 0.9), 1.0));
        (j.top, j.all, j.half, j.needless)
    };
    assert_eq!(judge(&[Delay, Stribeck]), (false, Some(false), Some(true), 0));
    assert_eq!(judge(&[Delay, EffectId::EndStop]), (false, Some(false), Some(false), 1));
    let all = [EffectId::Backlash, MotorGain, Stribeck, Delay];
    assert_eq!(judge(&all), (true, Some(true), Some(true), 0));
    assert_eq!(judge(&[&all[..], &[EffectId::EndStop]].concat()), (false, Some(true), Some(true), 1));

    // what is there but too small to be asked for is not needless
    let mut servo = truth(Effect, &[Delay, Stribeck]);
    servo.mechanisms.push(TrueMechanism { counts: false, ..mechanism(EffectId::LoadFriction) });
    servo.servo = true;
    let answer = answered(Effect, &[Delay, Stribeck, EffectId::LoadFriction], &[], 0.9);
    let trials = [trial(servo, answer, 1.0), trial(four, answered(Effect, &all[..1], &[], 0.9), 1.0)];
    let score = score(&trials);
    let sets: Vec<_> = score.sets.iter().map(|set| (set.what, counts(set.exact), counts(set.clean))).collect();
    assert_eq!(sets, [("four effects", (0, 1), (1, 1)), ("a servo", (1, 1), (1, 1))]);
    assert_eq!((counts(score.several), counts(score.half)), ((1, 2), (1, 2)));
}

#[test]
fn numbers_off_within_what_the_study_states_may_be_refitted_or_not() {
    let mut off = truth(Nothing, &[]);
    off.within = true;
    off.stamps = Stamps::Lying;
    let trials = [
        trial(off.clone(), answered(Calibration, &[], &[], 0.9), 1.0),
        trial(off.clone(), answered(Nothing, &[], &[], 0.9), 1.0),
        trial(off, answered(Unexplained, &[], &[], 0.9), 1.0),
        trial(truth(Nothing, &[]), answered(Nothing, &[], &[], 0.9), 1.0),
    ];
    let score = score(&trials);
    assert_eq!((counts(score.top), counts(score.needless_calibration)), ((3, 4), (0, 1)));
    let lying = score.noises.iter().find(|noise| noise.what == "stamps that are wrong").unwrap();
    assert_eq!((counts(lying.false_alarms), counts(lying.top)), ((1, 3), (2, 3)));
}
