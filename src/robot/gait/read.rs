//! Reads a gait's file.

use super::wave::{Gait, Setpoints, Shape, Wave};
use crate::geometry::robot_file::FRAME_S;
use crate::log::{Document, LogError, NOT_NEGATIVE, POSITIVE, Range64, finite_within, range};
use crate::robot::{JointId, Model, RobotError};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;

const SCHEMA: i64 = 1;
/// The angle that a limit may be missed by, for values that are written with three digits \[rad\].
const ROUNDING_RAD: f64 = 1e-9;

const ANGLE: Range64 = finite_within(6.3, "an angle within 6.3 rad; a larger one looks like degrees");
const PHASE: Range64 = finite_within(1.0, "a share of the cycle within 1; a larger one looks like degrees");
const PERIOD: Range64 = range(|x| (0.05..=60.0).contains(&x), "a time from 0.05 to 60 s");

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawGait {
    schema: Spanned<i64>,
    name: String,
    #[serde(default)]
    about: String,
    stand_s: Spanned<f64>,
    walk_s: Spanned<f64>,
    period_s: Spanned<f64>,
    ramp_s: Spanned<f64>,
    /// Amplitude sets in order of preference; absent: one set.
    amplitudes: Option<Spanned<Vec<String>>>,
    #[serde(default)]
    hold_rad: BTreeMap<Spanned<String>, Spanned<f64>>,
    #[serde(default)]
    wave: Vec<RawWave>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawWave {
    joints: Spanned<Vec<Spanned<String>>>,
    stand_rad: Spanned<f64>,
    shape: Spanned<String>,
    keys: Option<Spanned<Vec<Spanned<[f64; 2]>>>>,
    phase: Option<Spanned<Vec<Spanned<f64>>>>,
    sign: Option<Spanned<Vec<Spanned<i64>>>>,
    amplitude_rad: Spanned<RawAmplitude>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected an amplitude, or one for each set such as { floor = 0.1, air = 0.3 }")]
enum RawAmplitude {
    Same(f64),
    BySet(BTreeMap<String, f64>),
}

impl Gait {
    /// Reads a gait's file, for a robot.
    ///
    /// # Errors
    /// [`RobotError::File`] with file, line and key: unknown keys and joints, two waves on a joint, gaps in the keys of
    /// a wave, angles beyond the hardware's limits and jumps beyond the speed limits (Table A.3).
    pub fn read(file: &Path, model: &Model) -> Result<Self, RobotError> {
        Ok(checked(&Document::open(file)?, model)?)
    }

    /// Reads a gait that is at hand; `file` is its name in errors.
    ///
    /// # Errors
    /// As [`Gait::read`].
    pub fn from_toml(file: &Path, text: &str, model: &Model) -> Result<Self, RobotError> {
        Ok(checked(&Document::of_text(file, text), model)?)
    }
}

fn checked(document: &Document<'_>, model: &Model) -> Result<Gait, LogError> {
    let raw: RawGait = document.parse()?;
    if *raw.schema.get_ref() != SCHEMA {
        let found = raw.schema.get_ref().to_string();
        return Err(document.wrong("schema", raw.schema.span(), found, "1, the only schema there is"));
    }
    let number =
        |key: &str, value: &Spanned<f64>, range: Range64| document.within(key, value.span(), *value.get_ref(), range);
    let sets = match &raw.amplitudes {
        None => vec!["default".to_owned()],
        Some(sets) if sets.get_ref().is_empty() => {
            return Err(document.wrong("amplitudes", sets.span(), "[]", "at least one name of a set"));
        }
        Some(sets) => sets.get_ref().clone(),
    };
    let mut gait = Gait {
        stand_s: number("stand_s", &raw.stand_s, NOT_NEGATIVE)?,
        walk_s: number("walk_s", &raw.walk_s, POSITIVE)?,
        period_s: number("period_s", &raw.period_s, PERIOD)?,
        ramp_s: number("ramp_s", &raw.ramp_s, NOT_NEGATIVE)?,
        name: raw.name,
        about: raw.about,
        set: 0,
        sets,
        waves: vec![Wave::still(0.0); model.joints().len()],
    };
    // Where each joint's numbers stand, for messages.
    let mut places: Vec<Option<(String, Range<usize>)>> = vec![None; model.joints().len()];
    for (name, value) in &raw.hold_rad {
        let key = format!("[hold_rad] {}", name.get_ref());
        let joint = joint_of(document, &key, name, model)?;
        gait.waves[joint.index()] = Wave::still(number(&key, value, ANGLE)?);
        places[joint.index()] = Some((key, value.span()));
    }
    for (index, wave) in raw.wave.iter().enumerate() {
        let key = |key: &str| format!("[[wave]] {} {key}", index + 1);
        for (place, name) in wave.joints.get_ref().iter().enumerate() {
            let joint = joint_of(document, &key("joints"), name, model)?;
            if places[joint.index()].is_some() {
                let found = format!("{} a second time", name.get_ref());
                return Err(document.wrong(
                    &key("joints"),
                    name.span(),
                    found,
                    "every joint in one wave or hold_rad only",
                ));
            }
            gait.waves[joint.index()] = self::wave(document, &key, wave, place, &gait.sets)?;
            places[joint.index()] = Some((key("amplitude_rad"), wave.amplitude_rad.span()));
        }
    }
    limits(document, &gait, model, &places)?;
    Ok(gait)
}

fn joint_of(document: &Document<'_>, key: &str, name: &Spanned<String>, model: &Model) -> Result<JointId, LogError> {
    model.joint(name.get_ref()).map_err(|_| {
        let names: Vec<&str> = model.joints().iter().map(|joint| joint.name.as_str()).collect();
        let expected = format!("a joint of {}: {}", model.name(), names.join(", "));
        document.wrong(key, name.span(), format!("\"{}\"", name.get_ref()), &expected)
    })
}

/// The wave of one of the joints that share it.
fn wave(
    document: &Document<'_>,
    key: &impl Fn(&str) -> String,
    raw: &RawWave,
    place: usize,
    sets: &[String],
) -> Result<Wave, LogError> {
    let joints = raw.joints.get_ref().len();
    let long = |name: &str, span: Range<usize>, found: usize| {
        let expected = format!("{joints} numbers, one for each of `joints`");
        document.wrong(&key(name), span, format!("{found} numbers"), &expected)
    };
    let phase = match &raw.phase {
        None => 0.0,
        Some(list) => match list.get_ref().get(place) {
            Some(phase) if list.get_ref().len() == joints => {
                document.within(&key("phase"), phase.span(), *phase.get_ref(), PHASE)?
            }
            _ => return Err(long("phase", list.span(), list.get_ref().len())),
        },
    };
    let sign = match &raw.sign {
        None => 1.0,
        Some(list) => match list.get_ref().get(place) {
            Some(sign) if list.get_ref().len() == joints && sign.get_ref().abs() == 1 => *sign.get_ref() as f64,
            Some(sign) if list.get_ref().len() == joints => {
                return Err(document.wrong(&key("sign"), sign.span(), sign.get_ref().to_string(), "1 or -1"));
            }
            _ => return Err(long("sign", list.span(), list.get_ref().len())),
        },
    };
    let amplitude = |value: f64| {
        document.within(&key("amplitude_rad"), raw.amplitude_rad.span(), value, ANGLE).map(|value| sign * value)
    };
    let amplitude_rad = match raw.amplitude_rad.get_ref() {
        RawAmplitude::Same(value) => sets.iter().map(|_| amplitude(*value)).collect::<Result<_, _>>()?,
        RawAmplitude::BySet(by_set) => {
            let expected = format!("one for each of `amplitudes` = {sets:?}");
            if by_set.len() != sets.len() || !sets.iter().all(|set| by_set.contains_key(set)) {
                let found = format!("{:?}", by_set.keys().collect::<Vec<_>>());
                return Err(document.wrong(&key("amplitude_rad"), raw.amplitude_rad.span(), found, &expected));
            }
            sets.iter().map(|set| amplitude(by_set[set])).collect::<Result<_, _>>()?
        }
    };
    let stand_rad = document.within(&key("stand_rad"), raw.stand_rad.span(), *raw.stand_rad.get_ref(), ANGLE)?;
    Ok(Wave { stand_rad, shape: shape(document, key, raw)?, phase, amplitude_rad })
}

fn shape(document: &Document<'_>, key: &impl Fn(&str) -> String, raw: &RawWave) -> Result<Shape, LogError> {
    let keyed = match raw.shape.get_ref().as_str() {
        "sin" => Ok(Shape::Sine),
        "cos" => Ok(Shape::Cosine),
        "linear" => Err(Shape::Linear as fn(Vec<[f64; 2]>) -> Shape),
        "smooth" => Err(Shape::Smooth as fn(Vec<[f64; 2]>) -> Shape),
        other => {
            let expected = "\"sin\", \"cos\", or \"linear\" or \"smooth\" with `keys`";
            return Err(document.wrong(&key("shape"), raw.shape.span(), format!("\"{other}\""), expected));
        }
    };
    match (keyed, &raw.keys) {
        (Ok(shape), None) => Ok(shape),
        (Ok(_), Some(keys)) => {
            let expected = "no keys: only \"linear\" and \"smooth\" have them";
            Err(document.wrong(&key("keys"), keys.span(), "keys", expected))
        }
        (Err(_), None) => Err(document.missing(key("keys"), "[phase, value] pairs, the first at phase 0")),
        (Err(make), Some(keys)) => {
            let mut last = -1.0;
            for pair in keys.get_ref() {
                let [phase, value] = *pair.get_ref();
                let starts = last < 0.0 && phase != 0.0;
                if starts || !(phase > last && phase < 1.0 && value.abs() <= 10.0) {
                    let expected = "phases from 0, each larger than the one before and below 1 (the cycle closes by \
                                    itself), and values within 10 amplitudes";
                    return Err(document.wrong(&key("keys"), pair.span(), format!("[{phase}, {value}]"), expected));
                }
                last = phase;
            }
            if keys.get_ref().len() < 2 {
                let expected = "at least two pairs; one would stand still";
                return Err(document.wrong(&key("keys"), keys.span(), "a gap", expected));
            }
            Ok(make(keys.get_ref().iter().map(|pair| *pair.get_ref()).collect()))
        }
    }
}

/// Every frame from the start to a full cycle at full size stays within what the joints can do.
fn limits(
    document: &Document<'_>,
    gait: &Gait,
    model: &Model,
    places: &[Option<(String, Range<usize>)>],
) -> Result<(), LogError> {
    let end_s = gait.stand_s + (gait.ramp_s / gait.period_s).ceil().min(1e3) * gait.period_s + 2.0 * gait.period_s;
    let frames = (end_s / FRAME_S).min(1e5) as usize;
    let first = (gait.stand_s / FRAME_S) as usize;
    for set in &gait.sets {
        let gait = gait.with_amplitude(set).expect("the set is its own");
        for (joint, place) in model.joint_ids().zip(places) {
            let (limits, Some((key, span))) = (&model.joints()[joint.index()], place) else { continue };
            let mut before = gait.angle_rad(joint, first as f64 * FRAME_S);
            for frame in first..=frames {
                let t_s = frame as f64 * FRAME_S;
                let angle = gait.angle_rad(joint, t_s);
                let wrong = |found: String, expected: String| {
                    let found = format!("{}: {found} at {t_s:.3} s (amplitudes \"{set}\")", limits.name);
                    Err(document.wrong(key, span.clone(), found, &expected))
                };
                if let Some([low, high]) = limits.hardware_rad
                    && !(low - ROUNDING_RAD <= angle && angle <= high + ROUNDING_RAD)
                {
                    return wrong(format!("{angle:.4} rad"), format!("an angle from {low} to {high} rad (Table A.3)"));
                }
                let speed = (angle - before).abs() / FRAME_S;
                if let Some(most) = limits.speed_rad_s
                    && speed > most
                {
                    return wrong(format!("a jump at {speed:.2} rad/s"), format!("at most {most} rad/s (Table A.3)"));
                }
                before = angle;
            }
        }
    }
    Ok(())
}
