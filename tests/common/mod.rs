//! Sets of logs from random joints whose truth is known, for coverage of intervals only.
//!
//! The logs are made by the same chain that is fitted. That is right for one question, whether an interval contains the
//! truth as often as it says when the model is right, and for no other: it says nothing about how good the model is.

use aibo_fit::identify::{Experiment, Load};
use aibo_fit::joint::{Chain, Contact, Encoder, Friction, FrictionTerm, Link, Motor, Stribeck};
use aibo_fit::log::{DriveMode, ExtraMass, Hold, Log, MotorSpec, Nominal, Role, SensorSpec, StudyLog};
use aibo_fit::log::{Start as Begins, health};
use aibo_fit::pendulum::{Input, Start, rollout_refined};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What the data have and the model lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lack {
    Nothing,
    /// Static friction half as large again as Coulomb friction, and at least 2 % of gravity more.
    Stribeck,
    /// A drag that doubles the viscous friction at the fastest speed.
    Drag,
}

/// How the logs of a set are driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driven {
    No,
    Position,
    Torque,
}

/// One set: logs made ready, the truth behind them, and what kind of set it is.
pub struct Set {
    pub experiments: Vec<Experiment>,
    /// Inertia, moment, Coulomb, viscous, rest.
    pub truth: [f64; 5],
    pub nominal: Nominal,
    /// The moment is to be held.
    pub moment_held: bool,
    /// Read noise in steps, half-width.
    pub noise_steps: f64,
    pub driven: Driven,
    /// A log ends in more than half a second at rest.
    pub tail: bool,
    /// A log begins held.
    pub held: bool,
    /// True start of each log: angle, then release instant or rate.
    pub starts: Vec<[f64; 2]>,
}

/// Names of the parameters in the order of [`Set::truth`].
pub const NAMES: [&str; 5] = ["inertia", "moment", "coulomb", "viscous", "rest"];

const GRAVITY: f64 = 9.81;

struct Drag {
    c2: f64,
}

impl FrictionTerm<f64> for Drag {
    fn resistance_nm(&self, at: &Contact<f64>) -> f64 {
        self.c2 * at.speed_rad_s * at.speed_rad_s
    }
    fn slope_nm_s_rad(&self, speed_rad_s: f64, _t_s: f64) -> f64 {
        2.0 * self.c2 * speed_rad_s
    }
}

fn log_uniform(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    (rng.random_range(low.ln()..high.ln())).exp()
}

/// The set of a seed. The kind of set (noise, held phase, drive, loads) goes round with the seed, so that every kind
/// has its share of any two dozen seeds.
pub fn set(seed: u64, lack: Lack) -> Set {
    // A set in which nothing moves, or that the library refuses, is drawn again.
    (0..20).find_map(|attempt| draw(seed, attempt, lack)).expect("one draw in twenty moves")
}

fn draw(seed: u64, attempt: u64, lack: Lack) -> Option<Set> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed + 1_000_003 * attempt);
    let rng = &mut rng;
    // Thesis leg (1e-3 kg m^2) to geared servo.
    let inertia = log_uniform(rng, 3e-4, 2e-2);
    let omega = rng.random_range(5.0..11.0f64);
    let moment = inertia * omega * omega / GRAVITY;
    let gravity_nm = moment * GRAVITY;
    let viscous = 2.0 * log_uniform(rng, 0.01, 1.5) * omega * inertia;
    let coulomb = log_uniform(rng, 5e-4, 0.15) * gravity_nm;
    let rest = rng.random_range(-0.4..0.4);
    let step = rng.random_range(0.0015..0.006);
    let noise_steps = [0.0, 0.5, 1.0][(seed % 3) as usize];
    let driven = match seed % 8 {
        3 => Driven::Position,
        7 => Driven::Torque,
        _ => Driven::No,
    };
    let held = driven == Driven::No && seed % 4 < 2;
    let column = seed.is_multiple_of(4);
    let loads = if seed % 5 < 2 { rng.random_range(2..=3) } else { 1 };
    let logs = (rng.random_range(1..=4usize)).max(loads);
    let period = rng.random_range(0.004..0.01);
    let jitter = if rng.random_bool(0.5) { 0.2 } else { 0.0 };
    let off = |rng: &mut ChaCha8Rng| {
        let by = rng.random_range(0.1..0.3);
        if rng.random_bool(0.5) { 1.0 + by } else { 1.0 - by }
    };
    let moment_held = loads == 1 && driven == Driven::No;
    let nominal = Nominal {
        inertia_kg_m2: inertia * off(rng),
        moment_kg_m: if moment_held { moment } else { moment * off(rng) },
        coulomb_nm: coulomb * off(rng),
        viscous_nm_s_rad: viscous * off(rng),
    };
    let kp_nm_rad = gravity_nm * log_uniform(rng, 0.5, 6.0);
    let motor = MotorSpec::pd(kp_nm_rad, inertia * omega * rng.random_range(0.1..0.6));
    let mut experiments = Vec::new();
    let mut tail = false;
    let mut starts = Vec::new();
    for k in 0..logs {
        // The first load of several is the bare link; a single one may be.
        let extra = ((loads > 1 && k % loads > 0) || (loads == 1 && seed.is_multiple_of(2))).then(|| {
            let distance_m = rng.random_range(0.06..0.16);
            let share = if loads > 1 { 0.8 * (k % loads) as f64 } else { 1.0 };
            ExtraMass { mass_kg: share * moment / distance_m, distance_m, radius_m: 0.015, length_m: 0.03 }
        });
        let duration = rng.random_range(3.0..7.0);
        let n = (duration / period) as usize;
        let t_s: Vec<f64> = (0..n)
            .map(|i| period * (i as f64 + if i > 0 && jitter > 0.0 { rng.random_range(-jitter..jitter) } else { 0.0 }))
            .collect();
        let begin = rest + rng.random_range(0.3..2.0) * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let release_s = held.then(|| rng.random_range(0.15..0.5));
        let start = Start {
            angle_rad: if driven == Driven::No { begin } else { rest },
            rate_rad_s: if held || driven != Driven::No { 0.0 } else { rng.random_range(-2.0..2.0) },
            release_s,
        };
        let tones: Vec<(f64, f64, f64)> = (0..4)
            .map(|_| (rng.random_range(0.3..1.0), omega * rng.random_range(0.2..1.3), rng.random_range(0.0..6.3)))
            .collect();
        let wave = |t: f64| tones.iter().map(|(a, w, phase)| a * (w * t + phase).sin()).sum::<f64>();
        let tau: Vec<f64> = t_s.iter().map(|&t| 0.5 * gravity_nm * wave(t)).collect();
        let q_ref: Vec<f64> = t_s.iter().map(|&t| rest + 0.5 * wave(t)).collect();
        let input = match driven {
            Driven::No => Input::Off,
            Driven::Position => Input::Position { setpoint_rad: &q_ref, hold: Hold::Step, on: None },
            Driven::Torque => Input::Torque { torque_nm: &tau, on: None },
        };
        let mut link = Link::new(inertia, moment, rest, GRAVITY);
        if let Some(extra) = &extra {
            let load = Load::on_the_link(extra);
            link = link.joined(Link::new(load.inertia_kg_m2, load.moment_kg_m, rest, GRAVITY));
        }
        let mut friction = Friction::coulomb_viscous(coulomb, viscous);
        match lack {
            Lack::Nothing => {}
            Lack::Stribeck => {
                let static_nm = coulomb + (0.5 * coulomb).max(0.02 * gravity_nm);
                friction.stribeck = Some(Stribeck { static_nm, speed_rad_s: 0.1 * omega, curve: Default::default() });
            }
            Lack::Drag => friction.terms.push(Box::new(Drag { c2: viscous / omega })),
        }
        let chain = Chain::new(link, friction, Some(Motor::new(motor)));
        let encoder = Encoder { resolution_rad: step, noise_rad: noise_steps * step };
        let (mut q_rad, mut angle) = (Vec::with_capacity(n), Vec::with_capacity(n));
        rollout_refined(&chain, input, &t_s, start, 4.0, |_, s| {
            angle.push(s.angle_rad);
            q_rad.push(encoder.read(s.angle_rad, rng));
        })
        .ok()?;
        // A joint thrown over the top is chaotic; no fit of a whole log is asked to follow that.
        if angle.iter().any(|a| (a - rest).abs() > 3.0) {
            return None;
        }
        let at_rest = angle.iter().rev().take_while(|a| (*a - angle[n - 1]).abs() < 1e-9).count();
        tail |= at_rest as f64 * period > 0.5;
        let log = Log {
            file: "made.csv".into(),
            drive: (held && column).then(|| t_s.iter().map(|&t| release_s.is_some_and(|r| t < r)).collect()),
            q_rad,
            dq_rad_s: None,
            tau_nm: (driven == Driven::Torque).then_some(tau),
            q_ref_rad: (driven == Driven::Position).then_some(q_ref),
            setpoints: None,
            ignored_columns: Vec::new(),
            notes: Vec::new(),
            t_s,
        };
        let drive = match driven {
            Driven::No => DriveMode::Off,
            Driven::Position => DriveMode::Position,
            Driven::Torque => DriveMode::Torque,
        };
        let entry = StudyLog {
            file: format!("made-{k}.csv"),
            path: "made.csv".into(),
            role: Role::Fit,
            drive,
            motor: (driven == Driven::Position).then_some(motor),
            extra,
            session: None,
            tau_is: None,
            window: None,
        };
        let found = health(&log, &SensorSpec { resolution_rad: Some(step), period_s: None }, drive);
        // A held phase that the angle does not show cannot be fitted as what it is: such a log is read as free.
        if !found.moved || held && !matches!(found.start, Begins::Held(_)) {
            return None;
        }
        starts.push([start.angle_rad, release_s.unwrap_or(start.rate_rad_s)]);
        experiments.push(Experiment::new(&log, &entry, &found, step, GRAVITY)?);
    }
    let truth = [inertia, moment, coulomb, viscous, rest];
    Some(Set { experiments, truth, nominal, moment_held, noise_steps, driven, tail, held, starts })
}
