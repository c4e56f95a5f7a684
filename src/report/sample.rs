//! Reports for tests: made-up swings that look like logged ones. Nothing here is evidence about a fit.

use std::f64::consts::PI;

use super::*;

/// The value of a parameter that must not be shown, as it would be written.
pub const SECRET: &str = "0.0777";

fn swing(file: &str, role: &str, amplitude_rad: f64, samples: usize, period_s: f64) -> LogCurves {
    let first_fitted = samples / 15;
    let release_s = period_s * first_fitted as f64;
    let t_s: Vec<f64> = (0..samples).map(|i| period_s * i as f64).collect();
    let damped = |t: f64, speed: f64, decay: f64| {
        let t = t - release_s;
        let (sine, cosine) = (speed * t).sin_cos();
        let envelope = amplitude_rad * (-decay * t).exp();
        (envelope * cosine, -envelope * (decay * cosine + speed * sine))
    };
    let truth = |t: f64| if t < release_s { amplitude_rad } else { damped(t, 7.70, 0.90).0 };
    let quantised = |t: f64| ((truth(t) + 0.0015 * (917.0 * t).sin()) / 0.006).round() * 0.006;
    let from_release = |model: &dyn Fn(f64) -> f64| -> Vec<f64> {
        t_s.iter().enumerate().map(|(i, t)| if i < first_fitted { f64::NAN } else { model(*t) }).collect()
    };
    LogCurves {
        file: file.into(),
        role: role.into(),
        measured_rad: t_s.iter().map(|t| quantised(*t)).collect(),
        first_fitted,
        release_s: Some(0.4),
        simple_rad: from_release(&|t| damped(t, 7.60, 0.80).0),
        extensive_rad: from_release(&|t| damped(t, 7.70, 0.905).0),
        extensive_rate_rad_s: from_release(&|t| damped(t, 7.70, 0.905).1),
        t_s,
        setpoint_rad: None,
        half_step_rad: 0.003,
        simple_rms_rad: 0.0123,
        extensive_rms_rad: 0.00214,
    }
}

fn health(log: &LogCurves) -> LogHealthRow {
    LogHealthRow {
        file: log.file.clone(),
        role: log.role.clone(),
        samples: log.t_s.len(),
        duration_s: log.t_s.last().copied().unwrap_or(0.0),
        period_s: 0.008,
        jitter_s: 2.1e-5,
        lost: 0,
        resolution_rad: 0.006,
        noise_rad: Some(0.0011),
        release_s: Some(0.4),
        rest_from_s: Some(4.912),
        remarks: Vec::new(),
        more: HealthMore::default(),
    }
}

fn parameter(name: &str, symbol: &str, unit: &str, value: f64, share: f64, nominal: Option<f64>) -> ParameterRow {
    ParameterRow {
        name: name.into(),
        symbol: symbol.into(),
        unit: unit.into(),
        status: ParameterStatus::Determined,
        value,
        interval: Some([value * (1.0 - share), value * (1.0 + 1.2 * share)]),
        interval_naive: Some([value * (1.0 - 0.3 * share), value * (1.0 + 0.3 * share)]),
        nominal,
    }
}

fn report(logs: Vec<LogCurves>) -> DropReport {
    let simple = ModelSummary {
        name: "simple (3.2)".into(),
        rms_rad: 0.0123,
        criterion_rad2_s: 8.47e-4,
        parameters: vec![
            parameter("gravity ratio", "g/L", "1/s^2", 59.31, 0.004, Some(60.0)),
            parameter("viscous ratio", "c/I", "1/s", 1.83, 0.11, None),
        ],
        method: "dfp".into(),
        stop: "converged".into(),
        evaluations: 87,
        trace_rad2_s: (0..12).map(|i| 8.47e-4 + 0.05 * (-1.4 * f64::from(i)).exp()).chain([8.47e-4]).collect(),
    };
    let extensive = ModelSummary {
        name: "extensive (3.13)".into(),
        rms_rad: 0.00214,
        criterion_rad2_s: 2.61e-5,
        parameters: vec![
            parameter("inertia", "I*", "kg m^2", 9.12e-4, 0.027, Some(9.0e-4)),
            parameter("moment", "M*", "kg m", 5.48e-3, 0.008, Some(5.0e-3)),
            parameter("coulomb", "mu_c", "N m", 1.12e-3, 0.16, Some(1.0e-3)),
            parameter("viscous", "mu_v", "N m s/rad", 1.7e-3, 0.06, Some(1.7e-3)),
            parameter("rest angle", "q0", "rad", -0.0021, -0.4, None),
        ],
        method: "bfgs".into(),
        stop: "converged".into(),
        evaluations: 214,
        trace_rad2_s: (0..31).map(|i| 2.61e-5 + 0.08 * (-0.8 * f64::from(i)).exp()).chain([2.61e-5]).collect(),
    };
    let names = ["inertia", "moment", "coulomb", "viscous", "rest angle"].map(String::from).to_vec();
    let matrix = (0..5i32)
        .map(|i| (0..5i32).map(|j| if i == j { 1.0 } else { (f64::from(i + j) * 1.9).cos() * 0.97 }).collect())
        .collect();
    let friction = (-60..=60).filter(|k| *k != 0).map(|k| {
        let rate = 0.05 * f64::from(k);
        let torque = rate.signum() * (1.1e-3 + 5e-4 * (-(rate / 0.4).powi(2)).exp()) + 1.7e-3 * rate;
        let width = 1.5e-4 + 8e-5 * rate.abs();
        FrictionPoint { rate_rad_s: rate, torque_nm: torque, low_nm: torque - width, high_nm: torque + width }
    });
    DropReport {
        joint: "q1".into(),
        sentence: "The logs fix inertia, moment and friction of q1; the extensive model follows them to 2.1 mrad, \
                   which is the encoder's own step, the simple one to 12.3 mrad."
            .into(),
        notes: vec!["The moment lies 10 % above its nominal value, outside the interval.".into()],
        beliefs: Vec::new(),
        undetermined: Vec::new(),
        health: logs.iter().map(health).collect(),
        logs,
        models: vec![simple, extensive],
        correlation: Correlation { names, matrix },
        friction: friction.collect(),
        full: None,
        provenance: Provenance {
            version: "0.1.0".into(),
            command: "aibo-fit drop data/q1.csv --joint q1".into(),
            inputs: vec![(
                "data/q1.csv".into(),
                "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08".into(),
            )],
        },
    }
}

/// One log, all parameters determined.
pub fn single() -> DropReport {
    report(vec![swing("q1.csv", "fit", 0.4, 751, 0.008)])
}

/// As many logs as asked for.
pub fn many(count: usize) -> DropReport {
    let role = |i: usize| if i % 4 == 3 { "validate" } else { "fit" };
    let log = |i: usize| swing(&format!("q1-{i:02}.csv"), role(i), 0.25 + 0.03 * i as f64, 751, 0.008);
    report((0..count).map(log).collect())
}

/// A driven log of 10,000 samples.
pub fn driven() -> DropReport {
    let mut log = swing("real/torque-driven.csv", "fit", 1.0, 10_000, 0.002);
    let wave = |t: f64| 0.9 * (2.0 * PI * 0.21 * t).sin() + 0.4 * (2.0 * PI * 0.93 * t).sin();
    let slope = |t: f64| {
        0.9 * 2.0 * PI * 0.21 * (2.0 * PI * 0.21 * t).cos() + 0.4 * 2.0 * PI * 0.93 * (2.0 * PI * 0.93 * t).cos()
    };
    log.first_fitted = 0;
    log.setpoint_rad = Some(log.t_s.iter().map(|t| (wave(t + 0.03) / 0.2).round() * 0.2).collect());
    log.measured_rad = log.t_s.iter().map(|t| (wave(*t) / 1.5e-3).round() * 1.5e-3).collect();
    log.simple_rad = log.t_s.iter().map(|t| 0.93 * wave(t - 0.01)).collect();
    log.extensive_rad = log.t_s.iter().map(|t| wave(*t) + 0.002 * (3.0 * t).sin()).collect();
    log.extensive_rate_rad_s = log.t_s.iter().map(|t| slope(*t)).collect();
    log.half_step_rad = 7.5e-4;
    report(vec![log])
}

/// Big residuals, a held and an undetermined parameter, no friction scale, names that need care.
pub fn troubled() -> DropReport {
    let mut first = swing(
        "logs/a very long directory name/and a file <b>name</b> & more, of 2026-11-20 at noon, run 17.csv",
        "fit",
        0.5,
        751,
        0.008,
    );
    for (i, angle) in first.simple_rad.iter_mut().enumerate() {
        *angle += 0.3 * (0.02 * i as f64).sin();
    }
    first.simple_rms_rad = 0.213;
    let mut second = swing("flat.csv", "validate", 0.2, 751, 0.008);
    second.measured_rad.fill(0.204);
    second.simple_rad.fill(f64::NAN);
    second.simple_rms_rad = f64::NAN;
    let mut report = report(vec![first, second]);
    report.joint = "q3".into();
    report.sentence =
        "The joint swings, but bare-link logs alone do not fix the scale: only ratios to the inertia are known.".into();
    report.notes = vec![
        "Inertia, moment and friction are known only relative to each other: hang a known mass on the link and log one more swing, and all four get their own numbers.".into(),
        "flat.csv: the joint never moved; Coulomb friction holds it at this angle.".into(),
    ];
    report.health[0].remarks =
        vec!["12 samples are missing between 1.2 s and 1.3 s".into(), "the release is between two samples".into()];
    report.health[1].release_s = None;
    report.logs[1].release_s = None;
    report.health[1].noise_rad = None;
    report.health[1].resolution_rad = 0.0;
    let parameters = &mut report.models[1].parameters;
    parameters[0].status = ParameterStatus::NotDetermined;
    parameters[0].value = 0.0777;
    parameters[1].nominal = Some(8e-3);
    parameters[3].interval = None;
    parameters.push(ParameterRow {
        status: ParameterStatus::Held,
        interval: None,
        interval_naive: None,
        ..parameter("gravity", "g", "m/s^2", 9.81, 0.0, Some(9.81))
    });
    report.models[0].trace_rad2_s = vec![8.47e-4];
    report.models[0].stop = "no step lowered the criterion".into();
    report.correlation.matrix[1][2] = f64::NAN;
    report.friction.clear();
    report
}

/// Nothing at all.
pub fn empty() -> DropReport {
    let mut report = report(Vec::new());
    report.notes.clear();
    report.models.clear();
    report.correlation = Correlation::default();
    report.friction.clear();
    report.provenance.inputs.clear();
    report
}
