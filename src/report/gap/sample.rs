//! Diagnoses for tests: made-up logs and answers that look like real ones. Nothing here is evidence about the engine.

use super::GapReport;
use crate::gap::*;
use crate::identify::{Directives, Estimate, Status};
use crate::joint::{EffectForm, EffectId, Stage};
use crate::report::{HealthMore, LogHealthRow, Provenance};

const STEP_RAD: f64 = 0.006;
const PERIOD_S: f64 = 0.008;
const SAMPLES: usize = 600;

/// A log of a free swing with gaps of the given sizes [rad] before, calibrated and after.
fn traces(file: &str, role: &str, amplitude_rad: f64, [before, calibrated, after]: [f64; 3]) -> LogTraces {
    let t_s: Vec<f64> = (0..SAMPLES).map(|i| PERIOD_S * i as f64).collect();
    let truth = |t: f64| amplitude_rad * (-0.9 * t).exp() * (7.7 * t).cos();
    let rate = |t: f64| -amplitude_rad * (-0.9 * t).exp() * (7.7 * (7.7 * t).sin() + 0.9 * (7.7 * t).cos());
    let off = |size: f64| t_s.iter().map(|t| truth(*t) + 1.5 * size * (3.1 * t).sin() * (-0.2 * t).exp()).collect();
    let stuck = |t: f64| amplitude_rad * (-0.9 * t).exp() < 0.02;
    let phase = |t: f64| match () {
        () if stuck(t) => Phase::Stick,
        () if rate(t).abs() < 0.3 * 7.7 * amplitude_rad * (-0.9 * t).exp() => Phase::Reversal,
        () => Phase::Run,
    };
    let lacking = |t: f64| {
        let ripple = 2e-4 * (61.0 * t).sin();
        let excess = -8e-3 * rate(t).signum() * (-(rate(t) / 0.5).powi(2)).exp() * (calibrated / 0.02);
        if stuck(t) { f64::NAN } else { excess + ripple }
    };
    LogTraces {
        file: file.into(),
        role: role.into(),
        measured_rad: t_s
            .iter()
            .map(|t| ((truth(*t) + 0.001 * (917.0 * t).sin()) / STEP_RAD).round() * STEP_RAD)
            .collect(),
        setpoint_rad: None,
        before_rad: off(before),
        calibrated_rad: off(calibrated),
        after_rad: off(after),
        residual_torque: ResidualTorque {
            t_s: t_s.clone(),
            torque_nm: t_s.iter().map(|t| lacking(*t)).collect(),
            sigma_nm: t_s.iter().map(|t| if stuck(*t) { f64::NAN } else { 6e-4 + 2e-4 * (5.0 * t).sin() }).collect(),
            angle_rad: t_s.iter().map(|t| truth(*t)).collect(),
            rate_rad_s: t_s.iter().map(|t| rate(*t)).collect(),
            phase: t_s.iter().map(|t| phase(*t)).collect(),
        },
        t_s,
    }
}

/// The same log, driven by steps of its setpoint.
fn driven(mut log: LogTraces) -> LogTraces {
    let step = |t: f64| 0.4 * f64::from((1.3 * t) as i32 % 2) - 0.2;
    log.setpoint_rad = Some(log.t_s.iter().map(|t| step(*t)).collect());
    for (phase, t) in log.residual_torque.phase.iter_mut().zip(&log.t_s) {
        if (1.3 * t).fract() < 0.15 {
            *phase = Phase::Saturation;
        }
    }
    log
}

fn health(log: &LogTraces) -> LogHealthRow {
    LogHealthRow {
        file: log.file.clone(),
        role: log.role.clone(),
        samples: log.t_s.len(),
        duration_s: PERIOD_S * log.t_s.len() as f64,
        period_s: PERIOD_S,
        jitter_s: 1.2e-5,
        lost: 0,
        resolution_rad: STEP_RAD,
        noise_rad: Some(0.0011),
        release_s: Some(0.4),
        rest_from_s: Some(3.2),
        remarks: Vec::new(),
        more: HealthMore::default(),
    }
}

fn estimate(name: &str, symbol: &str, unit: &str, value: f64, nominal: f64) -> Estimate {
    Estimate {
        name: name.into(),
        symbol: symbol.into(),
        unit: unit.into(),
        status: Status::Determined,
        value,
        interval: Some([0.96 * value, 1.05 * value]),
        interval_naive: Some([0.99 * value, 1.01 * value]),
        nominal: Some(nominal),
    }
}

fn number(name: &str, unit: &str, value: f64) -> Number {
    Number {
        name: name.into(),
        value,
        unit: unit.into(),
        interval: Some([0.92 * value, 1.09 * value]),
        interval_naive: Some([0.98 * value, 1.02 * value]),
    }
}

fn candidate(effect: EffectId, probability: f64, after: f64, behind_sd: f64, parameters: Vec<Number>) -> Candidate {
    Candidate {
        effect,
        probability,
        after,
        closed: Some(1.0 - (after - 0.0019) / 0.029),
        behind_sd,
        parameters,
        refitted: true,
    }
}

fn stribeck() -> Vec<Number> {
    vec![number("mu_st", "N m", 0.0121), number("v_st", "rad/s", 0.41)]
}

fn torque_limit() -> Vec<Number> {
    vec![number("tau_max", "N m", 0.312)]
}

/// A cause that alone and with the others in place closes so much of what recalibration leaves.
fn cause(effect: EffectId, parameters: Vec<Number>, [alone, last]: [f64; 2], after: f64) -> CauseShare {
    CauseShare {
        only: None,
        effect,
        form: EffectForm::from(effect).name(),
        equivalent: vec![effect],
        parameters,
        alone: Some(alone),
        last: Some(last),
        after,
    }
}

/// The numbers of a joint that were believed to some percent; each is `[believed, sd, found]`.
fn beliefs() -> Vec<BeliefFound> {
    [
        ("inertia", "kg m^2", [9.0e-4, 9.0e-5, 9.12e-4]),
        ("moment", "kg m", [5.0e-3, 2.5e-4, 5.48e-3]),
        ("coulomb", "N m", [7.0e-3, 3.5e-3, 7.1e-3]),
        ("viscous", "N m s/rad", [0.019, 9.5e-3, 0.0187]),
    ]
    .map(|(name, unit, [believed, sd, found])| BeliefFound {
        name: name.into(),
        believed,
        sd,
        found,
        moved_sd: (found - believed) / sd,
        unit: unit.into(),
    })
    .to_vec()
}

/// Cells of one log: all of its phases, with shares that add up to `share`.
fn cells(file: &str, share: f64) -> Vec<MapCell> {
    [(Phase::Stick, 0.1, 0.6), (Phase::Reversal, 0.65, 1.1), (Phase::Run, 0.25, 2.4)]
        .into_iter()
        .map(|(phase, part, time_s)| MapCell {
            file: file.into(),
            phase,
            time_s,
            share: share * part,
            torque_rms_nm: 6e-3 * share * part,
            band_nm: [4e-3 * share * part, 9e-3 * share * part],
            significant: share * part > 0.04,
        })
        .collect()
}

fn profile() -> Vec<ProfileBin> {
    (0..14)
        .map(|i| {
            let at = 0.1 + 0.22 * f64::from(i);
            let torque_nm = 7.8e-3 * (-(at / 0.5_f64).powi(2)).exp() + 2e-4 * (5.0 * at).sin();
            let half = 3e-4 + 1.1e-4 * f64::from(i);
            ProfileBin { at, torque_nm, band_nm: [torque_nm - half, torque_nm + half] }
        })
        .collect()
}

fn gap(logs: &[LogTraces], [before, calibrated, after_first, after]: [f64; 4]) -> Gap {
    let floor = 0.0019;
    let per_log = logs.iter().enumerate().filter(|(_, log)| log.role == "validate").map(|(i, log)| {
        let scale = 0.75 + 0.25 * i as f64;
        LogGap {
            file: log.file.clone(),
            before: before * scale,
            calibrated: calibrated * scale,
            after: after * scale.sqrt(),
            floor: floor * 0.95,
        }
    });
    let closed = (before > floor).then(|| 1.0 - (after - floor) / (before - floor));
    Gap {
        unit: "rad",
        before,
        calibrated,
        after_first,
        after,
        floor,
        closed,
        closed_interval: closed.map(|c| [c - 0.03, (c + 0.02).min(1.0)]),
        outer: true,
        held_out: "predicted by fits to the other logs, as the study says".into(),
        per_log: per_log.collect(),
    }
}

/// Cell counts of a table of twins, mostly right.
fn confusion() -> Confusion {
    let names = ["stribeck", "load_friction", "delay", "none", "calibration", "unexplained"].map(String::from).to_vec();
    let counts = (0..names.len())
        .map(|row| {
            (0..names.len())
                .map(|column| if row == column { 17 } else { ((3 * row + 5 * column) % 7 == 1).into() })
                .collect()
        })
        .collect();
    Confusion { names, counts, command: "aibo-fit gap studies/q2/study.toml --twins 120 --seed 7".into() }
}

fn report(sizes: [f64; 4], sentence: &str) -> GapReport {
    let [before, calibrated, _, after] = sizes;
    let log = |(i, file): (usize, &str)| {
        let role = if i % 2 == 1 { "validate" } else { "fit" };
        let scale = 0.75 + 0.25 * i as f64;
        traces(file, role, 0.35 + 0.12 * i as f64, [before * scale, calibrated * scale, after])
    };
    let files = [
        "swing-00.csv",
        "swing-01.csv",
        "swing-02-220g.csv",
        "swing-03-220g.csv",
        "swing-04-80g.csv",
        "swing-05-80g.csv",
    ];
    let logs: Vec<LogTraces> = files.into_iter().enumerate().map(log).collect();
    let shares = [0.05, 0.08, 0.22, 0.3, 0.15, 0.2];
    GapReport {
        health: logs.iter().map(health).collect(),
        armature_kg_m2: None,
        drive: None,
        options: GapOptions { twins: 0, seed: 7, ..GapOptions::default() },
        provenance: Provenance {
            version: "0.1.0".into(),
            command: "aibo-fit gap studies/q2/study.toml --seed 7".into(),
            inputs: vec![(
                "studies/q2/study.toml".into(),
                "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08".into(),
            )],
        },
        diagnosis: Diagnosis {
            law: None,
            joint: "q2".into(),
            answer: Answer {
                verdict: Verdict::Effect,
                effect: Some("stribeck".into()),
                second: None,
                equivalent: vec![EffectId::Stribeck],
                probability: Some(0.88),
                probability_source: "an answer like this one was right in 132 of 150 twins (shipped rates, \
                                     `aibo-fit blind --trials 2000 --seed 11`)"
                    .into(),
                standing: "effect, to the noise, clear".into(),
                sentence: sentence.into(),
                partial: None,
                intervals_trusted: true,
            },
            location: Where {
                stage: Some(Stage::Link),
                variable: Some(Variable::Speed),
                range: Some([0.0, 0.42]),
                phase: Some(Phase::Reversal),
                logs: vec!["swing-03-220g.csv".into(), "swing-02-220g.csv".into()],
                share: 0.71,
                cells: files.into_iter().zip(shares).flat_map(|(file, share)| cells(file, share)).collect(),
                variables: vec![
                    (Variable::Speed, 0.63),
                    (Variable::Direction, 0.31),
                    (Variable::Load, 0.22),
                    (Variable::Amplitude, 0.12),
                    (Variable::Angle, 0.06),
                    (Variable::Time, 0.02),
                ],
                profile: profile(),
            },
            gap: gap(&logs, sizes),
            ranking: vec![
                candidate(EffectId::Stribeck, 0.62, after, 0.0, stribeck()),
                candidate(EffectId::LoadFriction, 0.26, after + 1e-4, 0.7, vec![number("mu_l", "-", 0.131)]),
                candidate(EffectId::QuadraticDrag, 0.04, 0.0148, 6.1, vec![number("c2", "N m s^2/rad^2", 3.1e-4)]),
                Candidate { refitted: false, ..candidate(EffectId::JointSpring, 0.01, f64::NAN, 14.0, Vec::new()) },
                Candidate { refitted: false, ..candidate(EffectId::AngleOffset, 0.01, f64::NAN, 17.5, Vec::new()) },
            ],
            detectable: vec![
                Detectable { effect: EffectId::Stribeck, value: Some(0.0011), name: "mu_st", unit: "N m" },
                Detectable { effect: EffectId::LoadFriction, value: Some(0.012), name: "mu_l", unit: "-" },
                Detectable { effect: EffectId::Delay, value: None, name: "T", unit: "s" },
            ],
            parameters: vec![
                estimate("inertia", "I*", "kg m^2", 9.12e-4, 9.0e-4),
                estimate("moment", "M*", "kg m", 5.48e-3, 5.0e-3),
                estimate("coulomb", "mu_c", "N m", 7.1e-3, 7.0e-3),
                estimate("viscous", "mu_v", "N m s/rad", 0.0187, 0.019),
            ],
            effect_parameters: vec![(EffectId::Stribeck, stribeck())],
            causes: vec![cause(EffectId::Stribeck, stribeck(), [0.93, 0.93], after)],
            beliefs: beliefs(),
            undetermined: Vec::new(),
            next: None,
            confusion: None,
            traces: logs,
            doubts: Vec::new(),
            notes: vec!["The nominal moment 0.005 kg m lies outside its 95 % interval.".into()],
            withheld: Vec::new(),
            demands: Directives::default(),
            budget: None,
            differs: Vec::new(),
        },
        torques: Vec::new(),
    }
}

/// An effect that these logs cannot tell from another, with twins and a next experiment.
pub fn set_of_two() -> GapReport {
    let mut report = report(
        [0.031, 0.022, 0.0032, 0.0032],
        "q2: 96 % [93, 98] of the gap above the sensor's noise is static friction above Coulomb's or friction that grows \
         with the load; these logs cannot tell the two apart, a swing with a 0.1 kg mass would.",
    );
    report.options.twins = 120;
    let diagnosis = &mut report.diagnosis;
    diagnosis.answer.equivalent = vec![EffectId::Stribeck, EffectId::LoadFriction];
    diagnosis.causes[0].equivalent = diagnosis.answer.equivalent.clone();
    diagnosis.undetermined = vec![
        "These logs cannot tell inertia, moment, coulomb and viscous apart: they can be changed together. Free swings show \
         ratios of torques; weigh the link, or hang on a known mass."
            .into(),
    ];
    diagnosis.confusion = Some(confusion());
    diagnosis.next = Some(Next {
        what: "Hang 0.1 kg at 0.12 m on the link and follow the motion.".into(),
        power: 0.91,
        motion: Some((0..400).map(|i| (0.02 * f64::from(i), 0.5 * (0.012 * f64::from(i * i).sqrt()).sin())).unzip()),
    });
    report
}

/// Nothing is missing.
pub fn nothing_missing() -> GapReport {
    let mut report = report(
        [0.0020, 0.0019, 0.0019, 0.0019],
        "q2: the model as given explains these logs to the sensor's noise; nothing is missing that they could show.",
    );
    let diagnosis = &mut report.diagnosis;
    let answer = &mut diagnosis.answer;
    (answer.verdict, answer.effect, answer.equivalent) = (Verdict::None, None, Vec::new());
    let location = &mut diagnosis.location;
    (location.stage, location.variable, location.range, location.phase) = (None, None, None, None);
    location.logs.clear();
    location.share = 0.0;
    location.cells.iter_mut().for_each(|cell| cell.significant = false);
    diagnosis.gap.closed = None;
    diagnosis.gap.closed_interval = None;
    diagnosis.effect_parameters.clear();
    diagnosis.causes.clear();
    diagnosis.beliefs.iter_mut().for_each(|belief| (belief.found, belief.moved_sd) = (belief.believed, 0.0));
    report
}

/// Only the numbers are off, and what the logs cannot determine.
pub fn wrong_numbers() -> GapReport {
    let mut report = report(
        [0.031, 0.0021, 0.0021, 0.0021],
        "q2: the structure is right but the Coulomb friction is not: 0.0071 instead of 0.0110 N m closes 99 % of the gap.",
    );
    let diagnosis = &mut report.diagnosis;
    diagnosis.answer.verdict = Verdict::Calibration;
    diagnosis.answer.effect = Some("coulomb".into());
    diagnosis.answer.equivalent.clear();
    diagnosis.parameters[2].nominal = Some(0.011);
    diagnosis.parameters[3].status = Status::NotDetermined;
    (diagnosis.parameters[3].interval, diagnosis.parameters[3].interval_naive) = (None, None);
    diagnosis.effect_parameters.clear();
    diagnosis.causes.clear();
    (diagnosis.beliefs[2].believed, diagnosis.beliefs[2].sd, diagnosis.beliefs[2].moved_sd) = (0.011, 0.0011, -3.55);
    diagnosis.ranking.clear();
    report
}

/// A gap that no effect closes, in logs with odd names, with withheld effects and numbers that are none.
pub fn unexplained() -> GapReport {
    let mut report = report(
        [0.031, 0.022, 0.014, 0.014],
        "q2: a gap of 14 mrad stays that no effect of the catalogue closes; quadratic drag comes closest and closes 58 %.",
    );
    let odd = "logs/a very long directory name/a file <b>name</b> & more, of 2026-11-20 at noon, run 17.csv";
    report.health[1].file = odd.into();
    report.health[1].remarks = vec!["12 samples lost".into(), "uneven sampling".into()];
    let diagnosis = &mut report.diagnosis;
    let answer = &mut diagnosis.answer;
    (answer.verdict, answer.effect, answer.intervals_trusted) = (Verdict::Unexplained, None, false);
    answer.equivalent.clear();
    answer.partial = Some(EffectId::QuadraticDrag);
    diagnosis.location.cells.iter_mut().filter(|c| c.file == "swing-01.csv").for_each(|cell| cell.file = odd.into());
    diagnosis.location.logs[0] = odd.into();
    diagnosis.gap.per_log[0].file = odd.into();
    diagnosis.gap.per_log[1].after = f64::NAN;
    diagnosis.gap.closed_interval = Some([f64::NAN, f64::INFINITY]);
    diagnosis.traces[1].file = odd.into();
    diagnosis.traces[5].after_rad.fill(f64::NAN);
    diagnosis.ranking[1].parameters[0].interval = None;
    diagnosis.ranking[2].parameters[0].value = f64::NAN;
    diagnosis.withheld = vec![EffectId::Stribeck, EffectId::Backlash];
    let drag = vec![number("c2", "N m s^2/rad^2", 3.1e-4)];
    diagnosis.causes =
        vec![CauseShare { alone: None, ..cause(EffectId::QuadraticDrag, drag.clone(), [0.4, 0.4], 0.014) }];
    diagnosis.effect_parameters = vec![(EffectId::QuadraticDrag, drag)];
    diagnosis.gap.outer = false;
    report
}

/// Two effects of a driven joint.
pub fn two_effects() -> GapReport {
    let mut report = report(
        [0.061, 0.034, 0.012, 0.0024],
        "q2: the motor's torque saturates at 0.31 N m, and the setpoint acts 16 ms late; together they close 99 % [96, 100] \
         of the gap.",
    );
    let diagnosis = &mut report.diagnosis;
    diagnosis.answer.effect = Some("torque_limit".into());
    diagnosis.answer.second = Some(EffectId::Delay);
    diagnosis.answer.equivalent = vec![EffectId::TorqueLimit];
    diagnosis.location.stage = Some(Stage::Motor);
    diagnosis.location.variable = Some(Variable::Torque);
    diagnosis.location.range = Some([0.28, 0.5]);
    diagnosis.location.phase = Some(Phase::Saturation);
    diagnosis.location.variables.insert(0, (Variable::Torque, 0.66));
    diagnosis.traces = diagnosis.traces.drain(..).map(driven).collect();
    let delay = vec![number("T", "s", 0.0161)];
    diagnosis.effect_parameters = vec![(EffectId::TorqueLimit, torque_limit()), (EffectId::Delay, delay.clone())];
    diagnosis.causes = vec![
        cause(EffectId::TorqueLimit, torque_limit(), [0.69, 0.58], 0.012),
        cause(EffectId::Delay, delay.clone(), [0.4, 0.3], 0.0024),
    ];
    diagnosis.parameters.push(estimate("gain", "c", "", 0.93, 1.0));
    let gain =
        BeliefFound { name: "gain".into(), believed: 1.0, sd: 0.1, found: 0.93, moved_sd: -0.73, unit: String::new() };
    diagnosis.beliefs.push(gain);
    diagnosis.ranking = vec![
        candidate(EffectId::TorqueLimit, 0.81, 0.012, 0.0, torque_limit()),
        candidate(
            EffectId::SpeedLimit,
            0.07,
            0.0133,
            2.4,
            vec![number("w_max", "rad/s", 9.1), number("tau_stall", "N m", 0.34)],
        ),
        candidate(EffectId::Delay, 0.06, 0.021, 8.9, delay),
    ];
    report
}

/// Many logs, the whole catalogue in the ranking and in the table of twins.
pub fn crowded() -> GapReport {
    let mut report = set_of_two();
    let diagnosis = &mut report.diagnosis;
    let files: Vec<String> = (0..14).map(|i| format!("driven/torque-chirp-{i:02}-of-the-session.csv")).collect();
    let log = |(i, file): (usize, &String)| {
        let role = if i % 3 == 2 { "validate" } else { "fit" };
        driven(traces(file, role, 0.3 + 0.04 * i as f64, [0.03, 0.02, 0.0032]))
    };
    diagnosis.traces = files.iter().enumerate().map(log).collect();
    diagnosis.gap = gap(&diagnosis.traces, [0.031, 0.022, 0.0032, 0.0032]);
    diagnosis.location.logs = files[8..].to_vec();
    diagnosis.location.cells = files.iter().flat_map(|file| cells(file, 1.0 / 14.0)).collect();
    diagnosis.ranking = EffectId::ALL
        .iter()
        .enumerate()
        .map(|(i, effect)| {
            let parameters = vec![number("size", "N m s/rad", 0.01 * (i + 1) as f64)];
            candidate(*effect, 0.3 / (i + 1) as f64, 0.0032 + 0.0011 * i as f64, 0.9 * i as f64, parameters)
        })
        .collect();
    diagnosis.detectable = EffectId::ALL
        .iter()
        .map(|effect| Detectable { effect: *effect, value: Some(0.0012), name: "size", unit: "N m" })
        .collect();
    let names: Vec<String> =
        EffectId::ALL.iter().map(|e| e.id()).chain(["none", "calibration", "unexplained"]).map(String::from).collect();
    let count = |row: usize, column: usize| match (row.abs_diff(column), (3 * row + 5 * column) % 7) {
        (0, _) => 90 + row as u32,
        (_, 1) => 3,
        _ => 0,
    };
    let counts = (0..names.len()).map(|row| (0..names.len()).map(|column| count(row, column)).collect()).collect();
    diagnosis.confusion = Some(Confusion { names, counts, command: "aibo-fit blind --trials 2000 --seed 11".into() });
    report
}

/// Logs that held nothing to show.
pub fn empty() -> GapReport {
    let mut report = nothing_missing();
    report.health.clear();
    report.provenance.inputs.clear();
    let diagnosis = &mut report.diagnosis;
    let location = &mut diagnosis.location;
    location.cells.clear();
    location.variables.clear();
    location.profile.clear();
    diagnosis.gap.per_log.clear();
    diagnosis.ranking.clear();
    diagnosis.detectable.clear();
    diagnosis.parameters.clear();
    diagnosis.beliefs.clear();
    diagnosis.traces.clear();
    diagnosis.notes.clear();
    report
}

/// All of them, with names for files.
pub fn all() -> [(&'static str, GapReport); 7] {
    [
        ("set", set_of_two()),
        ("none", nothing_missing()),
        ("calibration", wrong_numbers()),
        ("unexplained", unexplained()),
        ("two", two_effects()),
        ("crowded", crowded()),
        ("empty", empty()),
    ]
}
