//! Twins of a study: the same logs, drives, loads and encoder, with a cause that is known.
//!
//! The program runs itself on them and counts: nothing missing, wrong numbers, each candidate at several sizes, and
//! each candidate taken out of the catalogue, where the right answer is that none explains it.

use super::decide::decide;
use crate::gap::diagnosis::{Confusion, Verdict};
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::held_out::HeldOut;
use crate::gap::hypothesis::model::{BASELINE, DERIVATIVE, GAIN, INTEGRAL, REST};
use crate::gap::hypothesis::trial::Trial;
use crate::gap::search::attribute::Attribution;
use crate::identify::{Experiment, Problem};
use crate::joint::EffectId;
use crate::log::Nominal;
use crate::number::chance::normal_quantile;
use crate::number::math;
use crate::progress::{Cancelled, Progress, Quiet, Step};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Candidates that are tried as causes, at the most.
const CANDIDATES: usize = 5;
/// Sizes of a candidate, relative to what was found of it.
const SIZES: [f64; 3] = [1.0, 0.5, 2.0];
/// Twins with the same answer from which on their rate is taken.
const ENOUGH: u32 = 3;

/// What is true of a twin.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cause {
    Nothing,
    Numbers,
    /// A candidate, by its place, at a size.
    Effect(usize, f64),
    /// The same, withheld from the catalogue.
    Withheld(usize, f64),
}

/// The table of a run of twins, and the measured rate of an answer.
pub(in crate::gap) struct Measured {
    pub confusion: Confusion,
    /// Rate at which answers like the study's were right, and counts in words; `None` where too few were alike.
    pub rate: Option<(f64, String)>,
}

/// Runs the diagnosis on `count` twins; `candidates` are the fits of the study with one effect each, best first.
pub(in crate::gap) fn measure(
    evidence: &Evidence,
    a: &Attribution,
    effects: &[EffectId],
    answer: (Verdict, Option<EffectId>),
    (count, seed): (usize, u64),
    progress: &dyn Progress,
) -> Result<Measured, Cancelled> {
    let candidates: Vec<&Trial> = a.firsts.iter().take(CANDIDATES).collect();
    let mut causes = vec![Cause::Nothing, Cause::Numbers];
    for size in SIZES {
        causes.extend((0..candidates.len()).map(|k| Cause::Effect(k, size)));
        causes.extend((0..candidates.len()).map(|k| Cause::Withheld(k, size)));
    }
    let mut names: Vec<String> = candidates.iter().map(|t| t.effects()[0].id().to_owned()).collect();
    names.extend(["none", "calibration", "unexplained", "another effect"].map(str::to_owned));
    let place = |name: &str| names.iter().position(|n| n == name).unwrap_or(names.len() - 1);
    let mut counts = vec![vec![0u32; names.len()]; names.len()];
    let (mut alike, mut right) = (0, 0);
    for n in 0..count {
        progress.go_on(Step { stage: "twins", done: n, of: count })?;
        let cause = causes[n % causes.len()];
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(n as u64);
        let twin = make(evidence, a, &candidates, cause, &mut random);
        let out = match cause {
            Cause::Withheld(k, _) => Some(candidates[k].effects()[0]),
            _ => None,
        };
        let catalogue: Vec<EffectId> = effects.iter().copied().filter(|e| Some(*e) != out).collect();
        let attribution = Attribution::of(&twin, &catalogue, &Quiet(progress))?;
        let held = HeldOut::of(&twin);
        let found = decide(&twin, &held, &attribution, &catalogue);
        let truth = match cause {
            Cause::Nothing => "none",
            Cause::Numbers => "calibration",
            Cause::Effect(k, _) => candidates[k].effects()[0].id(),
            Cause::Withheld(..) => "unexplained",
        };
        let said = match (found.verdict, found.effect()) {
            (Verdict::Effect, Some(effect)) => effect.id(),
            (verdict, _) => verdict.name(),
        };
        counts[place(truth)][place(said)] += 1;
        let in_set = found.verdict == Verdict::Effect && found.equivalent.iter().any(|e| e.id() == truth);
        if found.verdict == answer.0 && (answer.0 != Verdict::Effect || found.effect() == answer.1) {
            alike += 1;
            right += u32::from(said == truth || in_set);
        }
    }
    let rate = (alike >= ENOUGH).then(|| {
        let rate = (f64::from(right) + 1.0) / (f64::from(alike) + 2.0);
        (rate, format!("{right} of {alike} twins of this study that got this answer had this cause"))
    });
    let command = format!("--twins {count} --seed {seed}");
    Ok(Measured { confusion: Confusion { names, counts, command }, rate })
}

/// A twin: the study's logs as a joint with the cause would have written them.
fn make(
    evidence: &Evidence,
    a: &Attribution,
    candidates: &[&Trial],
    cause: Cause,
    random: &mut ChaCha8Rng,
) -> Evidence {
    let (truth, mut values) = match cause {
        Cause::Nothing | Cause::Numbers => (&a.calibrated, a.calibrated.found.values.clone()),
        Cause::Effect(k, _) | Cause::Withheld(k, _) => (candidates[k], candidates[k].found.values.clone()),
    };
    // Where no effect is missing the drive and the zero are as believed.
    if let Cause::Nothing | Cause::Numbers = cause {
        [GAIN, DERIVATIVE, INTEGRAL, REST].iter().for_each(|&i| values[i] = a.given.found.values[i]);
    }
    if let Cause::Effect(k, size) | Cause::Withheld(k, size) = cause {
        resize(candidates[k].effects()[0], &mut values[BASELINE..], size);
    }
    // The engineer of the twin is off as the engineer of the study is, or by a random share.
    let share = |i: usize| a.given.found.values[i] / a.calibrated.found.values[i];
    let nominal = |i: usize, random: &mut ChaCha8Rng| {
        let share = match cause {
            Cause::Nothing => 1.0,
            Cause::Numbers => math::exp(0.3 * (2.0 * random.random::<f64>() - 1.0)),
            _ => share(i),
        };
        if share.is_finite() { values[i] * share.clamp(0.3, 3.0) } else { values[i] }
    };
    let nominal = Nominal {
        inertia_kg_m2: nominal(0, random),
        moment_kg_m: nominal(1, random),
        coulomb_nm: nominal(2, random),
        viscous_nm_s_rad: nominal(3, random),
    };
    let read = |e: &Experiment, start: [f64; 2], random: &mut ChaCha8Rng| {
        let problem = Problem::of_starts(&truth.model, std::slice::from_ref(e), &values);
        let mut measured_rad = Vec::with_capacity(e.t_s.len());
        let moved = problem.motion(&start, 0, |_, s| measured_rad.push(s.angle_rad));
        if moved.is_err() {
            return e.clone();
        }
        let step = e.resolution_rad;
        let rough = (a.noise_rad.powi(2) - step * step / 12.0).max(0.0).sqrt();
        for q in &mut measured_rad {
            let u: f64 = random.random_range(1e-9..1.0);
            let noisy = *q + rough * normal_quantile(u);
            *q = if step > 0.0 { (noisy / step).round() * step } else { noisy };
        }
        Experiment { measured_rad, ..e.clone() }
    };
    let fit = evidence.fit.iter().zip(&truth.found.starts).map(|(e, s)| read(e, *s, random)).collect();
    let held = evidence.held.iter().zip(&truth.held_starts).map(|(e, s)| read(e, *s, random)).collect();
    Evidence { nominal, ..evidence.with_logs(fit, held) }
}

/// Makes an effect stronger or milder: the distance from its zero for most, the reach of a limit for limits.
fn resize(effect: EffectId, values: &mut [f64], size: f64) {
    match effect {
        EffectId::MotorGain => values[0] = math::powf(values[0], size),
        EffectId::TorqueLimit => values[0] /= size.sqrt(),
        EffectId::SpeedLimit => values[1] /= size.sqrt(),
        EffectId::Compliance => values[0] /= size,
        EffectId::SetpointProfile => values.iter_mut().for_each(|v| *v /= size.sqrt()),
        EffectId::EndStop => values[2] *= size,
        EffectId::PositionFriction => values.iter_mut().for_each(|v| *v *= size),
        _ => values[0] *= size,
    }
}
