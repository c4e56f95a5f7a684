//! Motions that show what joints are like, for robots that have no gait: sines and steps within the joints' limits.

use super::error::SynthError;
use super::plan::{Of, times};
use crate::geometry::Joint;
use crate::number::math;
use crate::robot::simulate::{Column, Setpoints};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// How long a motion is unless it is stated \[s\].
const DURATION_S: f64 = 20.0;
/// Joints move so far about the middle of their range at the most, as a share of half of it and as an angle \[rad\].
const SHARE: f64 = 0.35;
const FAR_RAD: f64 = 0.6;
/// Half the range of a joint without limits \[rad\].
const FREE_RAD: f64 = 1.0;
/// Of the greatest rate, where the description has one.
const RATE_SHARE: f64 = 0.6;
/// Frequencies of the slow and of the fast sine where none is stated \[1/s\].
const SLOW_HZ: [f64; 2] = [0.1, 0.35];
const FAST_HZ: [f64; 2] = [0.5, 1.2];
/// A motion grows in this time \[s\].
const RAMP_S: f64 = 1.0;
/// Steps are held between these times \[s\].
const HELD_S: [f64; 2] = [0.6, 1.8];

/// A motion by its name; `None` where the word is none of them.
pub(super) fn named(of: &Of<'_>, rng: &mut ChaCha8Rng) -> Result<Option<Setpoints>, SynthError> {
    let word = of.log.gait.as_deref().unwrap_or("sines");
    if of.log.setpoints.is_some() || !matches!(word, "sines" | "steps") {
        return Ok(None);
    }
    of.refuse([("amplitude", of.log.amplitude.is_some())], word)?;
    let expected = "from two periods to 3600 s";
    let right = |x: f64| x >= 2.0 * of.period_s && x <= 3600.0;
    let end_s = of.blame.number(&of.key("duration"), of.log.duration.unwrap_or(DURATION_S), right, expected)?;
    let right = |hz: f64| hz > 0.0 && hz <= 50.0;
    let hz = of.log.frequency.map(|hz| of.blame.number(&of.key("frequency"), hz, right, "above 0, at most 50 1/s"));
    let hz = hz.transpose()?;
    let t_s = times(0.0, end_s, of.period_s);
    let column = |joint: &Joint| {
        let angle_rad = if word == "steps" { steps(joint, &t_s, hz, rng) } else { sines(joint, &t_s, hz, rng) };
        Some(Column { angle_rad, on: None })
    };
    let columns = of.model.joints().iter().map(column).collect();
    Ok(Some(Setpoints { t_s, columns, hold: crate::log::Hold::Step }))
}

/// Middle of a joint's motion, and how far it goes \[rad\].
fn reach(joint: &Joint) -> [f64; 2] {
    let [low, high] = joint.software_rad.filter(|[low, high]| high > low).unwrap_or([-FREE_RAD, FREE_RAD]);
    [0.5 * (low + high), (SHARE * 0.5 * (high - low)).min(FAR_RAD)]
}

fn sines(joint: &Joint, t_s: &[f64], hz: Option<f64>, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let [middle, far] = reach(joint);
    let mut within = |[low, high]: [f64; 2]| rng.random_range(low..high);
    let (mut slow, mut fast) = (within(SLOW_HZ), within(FAST_HZ));
    if let Some(hz) = hz {
        (slow, fast) = (slow * hz / fast, hz);
    }
    let phases = [within([0.0, TAU]), within([0.0, TAU])];
    let peak_rad_s = far * TAU * (0.65 * slow + 0.35 * fast);
    let far = joint.speed_rad_s.map_or(far, |most| far * (RATE_SHARE * most / peak_rad_s).min(1.0));
    let at = |t: &f64| {
        let x = (t / RAMP_S).min(1.0);
        let grown = x * x * (3.0 - 2.0 * x);
        let [a, b] = [slow * TAU * t + phases[0], fast * TAU * t + phases[1]];
        middle + far * grown * (0.65 * math::sin(a) + 0.35 * math::sin(b))
    };
    t_s.iter().map(at).collect()
}

fn steps(joint: &Joint, t_s: &[f64], hz: Option<f64>, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let [middle, far] = reach(joint);
    let held_s = hz.map_or(HELD_S, |hz| [0.5 / hz, 1.5 / hz]);
    let (mut level, mut until_s) = (middle, RAMP_S);
    let at = |t: &f64| {
        if *t >= until_s {
            level = middle + far * rng.random_range(-1.0..1.0);
            until_s = t + rng.random_range(held_s[0]..held_s[1]);
        }
        level
    };
    t_s.iter().map(at).collect()
}
