//! Diagnoses of a robot, made up, for the tests of the report.

use super::{LogRow, RobotGapReport, Sketch};
use crate::gap::robot::{
    Cause, Change, Displacement, Found, GaitCell, GaitPhase, JointGap, JointTrace, Place, RobotAnswer, RobotCandidate,
    RobotDetectable, RobotDiagnosis, RobotGap, RobotOptions, RobotWhere,
};
use crate::gap::{LogGap, Next, Number, Variable, Verdict};
use crate::joint::EffectId;
use crate::log::RobotScenario;
use crate::report::Provenance;
use crate::robot::Model;

const JOINTS: [&str; 4] = ["lf2", "rf2", "lr2", "rr2"];

fn number(name: &str, value: f64, unit: &str) -> Number {
    Number {
        name: name.into(),
        value,
        unit: unit.into(),
        interval: Some([0.9 * value, 1.1 * value]),
        interval_naive: None,
    }
}

fn weak() -> Found {
    Found {
        cause: Cause::Effect(EffectId::TorqueLimit),
        joints: JOINTS.map(str::to_owned).to_vec(),
        parameters: vec![number("tau_max", 0.12, "N m")],
    }
}

fn slippery() -> Found {
    Found { cause: Cause::FloorFriction, joints: Vec::new(), parameters: vec![number("mu", 0.31, "")] }
}

fn cells() -> Vec<GaitCell> {
    let of = |joint: &str, k: usize| {
        let cell = move |(p, phase): (usize, &GaitPhase)| GaitCell {
            joint: joint.to_owned(),
            phase: *phase,
            time_s: 2.0,
            excess_rad: 0.004 * (k + p) as f64,
            share: 0.05,
            significant: k + p > 2,
        };
        GaitPhase::ALL.iter().take(4).enumerate().map(cell).collect::<Vec<_>>()
    };
    JOINTS.iter().enumerate().flat_map(|(k, joint)| of(joint, k)).collect()
}

fn trace(joint: &str) -> JointTrace {
    let t_s: Vec<f64> = (0..400).map(|k| 0.008 * f64::from(k)).collect();
    let of = |size: f64| t_s.iter().map(|t| size * (6.0 * t).sin()).collect::<Vec<f64>>();
    JointTrace {
        file: "a <b>walk.csv".into(),
        joint: joint.into(),
        measured_rad: of(0.30),
        setpoint_rad: vec![f64::NAN; t_s.len()],
        before_rad: of(0.25),
        after_rad: of(0.299),
        residual_torque_nm: t_s.iter().map(|t| if *t < 0.1 { f64::NAN } else { 0.02 * t.sin() }).collect(),
        phase: vec![GaitPhase::Swing; t_s.len()],
        held: (0..t_s.len()).map(|k| (125..250).contains(&k)).collect(),
        t_s,
    }
}

/// A gap whose cause is named, with what cannot be told from it.
pub(super) fn effect() -> RobotGapReport {
    let candidate = |found: Found, probability, behind| RobotCandidate {
        found,
        probability,
        after: 0.0031,
        closed: Some(0.98),
        behind,
    };
    let joints: Vec<String> = Model::ers7().joints().iter().map(|joint| joint.name.clone()).collect();
    let diagnosis = RobotDiagnosis {
        robot: "ers7".into(),
        scenario: RobotScenario::Floor,
        answer: RobotAnswer {
            verdict: Verdict::Effect,
            first: Some(weak()),
            second: Some(slippery()),
            equivalent: vec![Cause::Effect(EffectId::TorqueLimit)],
            places: vec![weak().joints],
            probability: Some(0.87),
            probability_source: "26 of 30 answers of this standing were right in `blind --robot`".into(),
            standing: "two causes, floor, clear".into(),
            sentence: "ers7: the gap is a motor torque that saturates in four <joints>.".into(),
            partial: None,
            intervals_trusted: true,
        },
        location: RobotWhere {
            joints: weak().joints,
            stage: Some(weak().cause.stage()),
            variable: Some(Variable::Torque),
            range: Some([0.11, 0.16]),
            phase: Some(GaitPhase::Stance),
            logs: vec!["a <b>walk.csv".into()],
            share: 0.83,
            cells: cells(),
        },
        gap: RobotGap {
            unit: "rad",
            before: 0.037,
            calibrated: 0.035,
            after_first: 0.0047,
            after: 0.0031,
            floor: 0.0026,
            closed: Some(0.985),
            closed_interval: Some([0.97, 0.99]),
            held_out: "the middle one of three cycles".into(),
            per_log: vec![LogGap {
                file: "a <b>walk.csv".into(),
                before: 0.037,
                calibrated: 0.035,
                after: 0.0031,
                floor: 0.0026,
            }],
            per_joint: JOINTS
                .map(|joint| JointGap {
                    joint: joint.into(),
                    before: 0.06,
                    calibrated: 0.05,
                    after_first: 0.007,
                    after: 0.004,
                })
                .to_vec(),
            displacement: vec![Displacement {
                file: "a <b>walk.csv".into(),
                measured: 0.362,
                before: 0.374,
                after: 0.363,
            }],
        },
        ranking: vec![candidate(weak(), 0.87, 0.0), candidate(slippery(), 0.0, 4.1e5)],
        detectable: [Some(0.02), None]
            .map(|value| RobotDetectable { cause: Cause::Payload, value, name: "mass", unit: "kg" })
            .to_vec(),
        next: Some(Next { what: "The same motion, wider".into(), power: 0.9, motion: None }),
        beliefs: Vec::new(),
        changes: vec![Change { cause: weak().cause, place: Place { joints: vec![1, 4, 7, 10] }, values: vec![0.12] }],
        traces: JOINTS.map(trace).to_vec(),
        notes: vec!["On the floor a foot lands a little earlier or later with anything that changes.".into()],
        withheld: vec![Cause::FloorSlope],
        budget: None,
    };
    let walk = LogRow { file: "a <b>walk.csv".into(), role: "fit".into(), samples: 400, duration_s: 3.192, joints: 4 };
    RobotGapReport {
        diagnosis,
        options: RobotOptions { without: vec![Cause::FloorSlope], ..RobotOptions::default() },
        joints,
        logs: vec![walk],
        sketch: Sketch::of(Model::ers7()),
        beside: vec![("repaired.toml".into(), "the repaired robot".into())],
        half_step_rad: 0.003,
        provenance: Provenance {
            version: "0.1.0".into(),
            command: "aibo-fit gap study.toml".into(),
            inputs: vec![("study.toml".into(), "00".into())],
        },
    }
}

/// Nothing is missing.
pub(super) fn nothing() -> RobotGapReport {
    let mut report = effect();
    let diagnosis = &mut report.diagnosis;
    diagnosis.answer.verdict = Verdict::None;
    (diagnosis.answer.first, diagnosis.answer.second) = (None, None);
    (diagnosis.answer.equivalent, diagnosis.answer.places) = (Vec::new(), Vec::new());
    diagnosis.location = RobotWhere { cells: cells(), ..RobotWhere::default() };
    (diagnosis.gap.closed, diagnosis.gap.closed_interval) = (None, None);
    diagnosis.gap.displacement.clear();
    (diagnosis.ranking, diagnosis.next, diagnosis.changes) = (Vec::new(), None, Vec::new());
    report
}

/// A gap that no cause closes, of the floor's friction at best.
pub(super) fn unexplained() -> RobotGapReport {
    let mut report = effect();
    let diagnosis = &mut report.diagnosis;
    diagnosis.answer.verdict = Verdict::Unexplained;
    (diagnosis.answer.first, diagnosis.answer.second) = (None, None);
    diagnosis.answer.partial = Some(slippery());
    (diagnosis.answer.equivalent, diagnosis.answer.places) = (Vec::new(), Vec::new());
    diagnosis.answer.intervals_trusted = false;
    diagnosis.location.stage = None;
    diagnosis.gap.closed_interval = Some([f64::NAN, f64::NAN]);
    diagnosis.scenario = RobotScenario::Drop;
    report
}

/// All of them with their names.
pub(in crate::report) fn all() -> [(&'static str, RobotGapReport); 3] {
    [("effect", effect()), ("nothing", nothing()), ("unexplained", unexplained())]
}
