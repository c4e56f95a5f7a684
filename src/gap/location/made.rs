//! Logs for tests, made by an integrator of their own: semi-implicit Euler in steps of 5 or 20 microseconds, friction by hand.

use super::log_part::LogPart;
use super::residual_torque::residual_torque;
use crate::fit::{Budget, Method};
use crate::identify::{Experiment, ExtensiveModel, JointModel, Prediction, Scale, predict, search};
use crate::joint::{Chain, Friction, Link, Motor};
use crate::log::{DriveMode, ExtraMass, Log, MotorSpec, Nominal, Role, SensorSpec, StudyLog, health};
use crate::pendulum::Start;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A joint as it really is: the baseline's four numbers, and what the model will lack.
#[derive(Clone, Copy)]
pub(in crate::gap) struct Joint {
    pub inertia: f64,
    pub moment: f64,
    pub coulomb: f64,
    pub viscous: f64,
    /// What the model lacks.
    pub extra: Extra,
    /// `kp`, `kd` of a motor.
    pub motor: Option<(f64, f64)>,
    /// By how much the setpoint is late \[s\].
    pub delay: f64,
}

/// A torque \[N m\] by where the joint is.
pub(in crate::gap) type Extra = fn(&At) -> f64;

/// Where a torque is asked for.
pub(in crate::gap) struct At {
    pub t: f64,
    pub q: f64,
    pub v: f64,
    pub gravity: f64,
    pub motor: f64,
}

/// The thesis's leg, swinging freely.
pub(in crate::gap) const LEG: Joint =
    Joint { inertia: 9e-4, moment: 6e-3, coulomb: 0.0015, viscous: 0.0012, extra: |_| 0.0, motor: None, delay: 0.0 };

/// A geared servo with a stiff controller.
pub(in crate::gap) const SERVO: Joint = Joint {
    inertia: 0.019,
    moment: 0.11,
    coulomb: 0.05,
    viscous: 0.01,
    extra: |_| 0.0,
    motor: Some((13.6, 0.2)),
    delay: 0.0,
};

/// One recording. `noise` is the size of a read noise of -1, 0 or +1 times it.
#[derive(Clone, Copy)]
pub(in crate::gap) struct Swing {
    pub angle: f64,
    pub period: f64,
    pub step: f64,
    pub noise: f64,
    pub lasts: f64,
    pub setpoint: Option<fn(f64) -> f64>,
    /// Mass \[kg\] and distance \[m\] of a body on the link.
    pub mass: Option<(f64, f64)>,
    pub seed: u64,
}

impl Swing {
    /// Let go at an angle; the thesis's encoder.
    pub(in crate::gap) fn from(angle: f64) -> Self {
        let seed = (angle.abs() * 1000.0) as u64;
        Self { angle, period: 0.008, step: 0.006, noise: 0.0, lasts: 4.0, setpoint: None, mass: None, seed }
    }

    /// Driven along a setpoint; a servo's encoder.
    pub(in crate::gap) fn along(setpoint: fn(f64) -> f64) -> Self {
        Self { period: 0.005, step: 0.0015, setpoint: Some(setpoint), ..Self::from(setpoint(0.0)) }
    }
}

/// A recording, the model of it, and what the model lacks.
pub(in crate::gap) struct Made {
    pub experiment: Experiment,
    pub start: Start<f64>,
    /// The joint without its extra torque and delay.
    pub chain: Chain<f64>,
    pub noise_rad: f64,
    /// The missing torque about each compared sample, over half a period either way \[N m\].
    pub extra_nm: Vec<f64>,
    /// True speed there \[rad/s\].
    pub rate_rad_s: Vec<f64>,
}

pub(in crate::gap) fn made(joint: &Joint, swing: &Swing) -> Made {
    let mut rng = ChaCha8Rng::seed_from_u64(swing.seed);
    let driven = swing.setpoint.is_some();
    let h = if driven { 5e-6 } else { 2e-5 };
    let body = swing.mass.map(|(mass_kg, distance_m)| ExtraMass { mass_kg, distance_m, radius_m: 0.0, length_m: 0.0 });
    let (inertia, moment) =
        swing.mass.map_or((joint.inertia, joint.moment), |(m, d)| (joint.inertia + m * d * d, joint.moment + m * d));
    let per_sample = (swing.period / h).round() as usize;
    let released = if driven { 0.0 } else { 0.2 + swing.period * rng.random::<f64>() };
    // The setpoint as it is held between samples.
    let held = |t: f64| swing.setpoint.map_or(0.0, |f| f(((t + 1e-9) / swing.period).floor().max(0.0) * swing.period));
    let law = |setpoint: f64, q: f64, v: f64| match joint.motor {
        Some((kp, kd)) if driven => kp * (setpoint - q) - kd * v,
        _ => 0.0,
    };
    let mut log = Log {
        file: "made.csv".into(),
        t_s: vec![],
        q_rad: vec![],
        dq_rad_s: None,
        tau_nm: None,
        q_ref_rad: driven.then(Vec::new),
        setpoints: None,
        drive: (!driven).then(Vec::new),
        ignored_columns: vec![],
        notes: vec![],
    };
    let (mut q, mut v) = (swing.angle, 0.0f64);
    let samples = (swing.lasts / swing.period) as usize;
    let (mut rate, mut extra) = (vec![], vec![0.0; samples + 1]);
    for i in 0..samples * per_sample {
        let t = i as f64 * h;
        let gravity = -9.81 * moment * q.sin();
        let motor = law(held(t - joint.delay), q, v);
        let added = (joint.extra)(&At { t, q, v, gravity, motor });
        if i % per_sample == 0 {
            let reading = q + swing.noise * f64::from(rng.random_range(-1..=1));
            log.t_s.push((i / per_sample) as f64 * swing.period);
            log.q_rad.push(if swing.step > 0.0 { (reading / swing.step).round() * swing.step } else { reading });
            log.q_ref_rad.iter_mut().for_each(|c| c.push(held(t)));
            log.drive.iter_mut().for_each(|c| c.push(t < released));
            rate.push(v);
        }
        extra[(i + per_sample / 2) / per_sample] += (added + motor - law(held(t), q, v)) / per_sample as f64;
        let net = added + motor + gravity;
        if t < released || (v == 0.0 && net.abs() <= joint.coulomb) {
            continue;
        }
        let direction = if v != 0.0 { v.signum() } else { net.signum() };
        let next = v + h * (net - (joint.coulomb + joint.viscous * v.abs()) * direction) / inertia;
        v = if v != 0.0 && next * v < 0.0 { 0.0 } else { next };
        q += h * v;
    }
    let motor = joint.motor.filter(|_| driven).map(|(kp, kd)| MotorSpec::pd(kp, kd));
    let entry = StudyLog {
        file: format!("made-{}.csv", swing.seed),
        path: "made.csv".into(),
        role: Role::Fit,
        drive: if driven { DriveMode::Position } else { DriveMode::Off },
        motor,
        extra: body,
        session: None,
        tau_is: None,
        window: None,
    };
    let sensor = SensorSpec { resolution_rad: Some(swing.step), period_s: Some(swing.period) };
    let found = health(&log, &sensor, entry.drive);
    let experiment = Experiment::new(&log, &entry, &found, swing.step, 9.81).expect("enough samples");
    let from = experiment.first_sample + experiment.uncompared;
    Made {
        start: Start { angle_rad: swing.angle, rate_rad_s: 0.0, release_s: (!driven).then_some(released) },
        chain: Chain::new(
            Link::new(inertia, moment, 0.0, 9.81),
            Friction::coulomb_viscous(joint.coulomb, joint.viscous),
            motor.map(Motor::new),
        ),
        noise_rad: (swing.step.powi(2) / 12.0 + 2.0 / 3.0 * swing.noise.powi(2)).sqrt(),
        extra_nm: extra[from..samples].to_vec(),
        rate_rad_s: rate.split_off(from),
        experiment,
    }
}

/// Recordings of a joint against the baseline model refitted to them, as a diagnosis would have them.
///
/// The moment is held where no log shows more than ratios.
pub(in crate::gap) fn recalibrated(joint: &Joint, swings: &[Swing]) -> Vec<LogPart> {
    let (experiments, noise_rad, mut model) = recorded(joint, swings);
    model.parameters[1].fixed = swings.iter().all(|s| s.mass.is_none() && s.setpoint.is_none());
    let found = search(&model, &experiments, Method::Lm, Budget::default()).expect("the logs have a motion");
    against(&model, &found.values, &experiments, noise_rad)
}

/// Recordings of a joint against its true baseline.
pub(in crate::gap) fn as_given(joint: &Joint, swings: &[Swing]) -> Vec<LogPart> {
    let (experiments, noise_rad, model) = recorded(joint, swings);
    let values: Vec<f64> = model.parameters.iter().map(|p| p.start).collect();
    against(&model, &values, &experiments, noise_rad)
}

fn recorded(joint: &Joint, swings: &[Swing]) -> (Vec<Experiment>, f64, ExtensiveModel) {
    let made: Vec<Made> = swings.iter().map(|s| made(joint, s)).collect();
    let noise_rad = made[0].noise_rad;
    let experiments: Vec<Experiment> = made.into_iter().map(|m| m.experiment).collect();
    let nominal = Nominal {
        inertia_kg_m2: joint.inertia,
        moment_kg_m: joint.moment,
        coulomb_nm: joint.coulomb,
        viscous_nm_s_rad: joint.viscous,
    };
    let scale = Scale::of(&experiments, Some(&nominal), Some(0.0));
    let model = ExtensiveModel::lumped(&scale, Some(&nominal), false);
    (experiments, noise_rad, model)
}

fn against(model: &ExtensiveModel, values: &[f64], experiments: &[Experiment], noise_rad: f64) -> Vec<LogPart> {
    let predicted = predict(model, experiments, values).expect("the model has a motion");
    let part = |(e, p): (&Experiment, &Prediction)| {
        let residual = p.angle_rad.iter().zip(&e.measured_rad).map(|(a, b)| a - b).skip(e.uncompared).collect();
        let chain = model.chain(values, e);
        let torque = residual_torque(&chain, e, e.start_from(p.start[0], p.start[1]), noise_rad);
        LogPart::new(&chain, e, residual, torque, noise_rad)
    };
    experiments.iter().zip(&predicted).map(part).collect()
}
