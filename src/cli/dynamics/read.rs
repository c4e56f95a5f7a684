//! Reads states; whatever is wrong is named by file, state, key and index.

use crate::cli::CliError;
use crate::geometry::robot_file::Base;
use crate::log::LogError;
use crate::robot::{Model, State};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::{Map, Value};
use std::path::Path;

/// A state, and the torques that act there.
pub(super) struct Asked {
    pub state: State,
    pub torque_nm: Vec<f64>,
}

/// How far a quaternion may be from one that rotates.
pub(super) const QUATERNION_TOLERANCE: f64 = 1e-6;
const EXPECTED: &str = "expected {\"states\": [...]} with base_pos, base_quat_wxyz, base_vel_world, base_omega_body, q, \
                        dq and tau in each, as in data/examples/states.json";

/// What a file of states says.
pub(super) fn opened(file: &Path) -> Result<Value, CliError> {
    let bytes = std::fs::read(file).map_err(|source| LogError::Read { file: file.to_path_buf(), source })?;
    let wrong = |what: String| CliError::States { file: file.to_path_buf(), what };
    let text = String::from_utf8(bytes).map_err(|_| wrong(format!("not UTF-8 text; {EXPECTED}")))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    serde_json::from_str(text).map_err(|error| wrong(not_json(text, &error)))
}

/// The states in it, at least one.
pub(super) fn list(value: &Value) -> Result<&[Value], String> {
    let list = match value {
        Value::Array(list) => list,
        Value::Object(object) => match object.get("states") {
            Some(Value::Array(list)) => list,
            Some(other) => return Err(format!("states: found {}, expected a list", kind(other))),
            None => return Err(format!("key `states` is missing; {EXPECTED}")),
        },
        other => return Err(format!("found {}; {EXPECTED}", kind(other))),
    };
    if list.is_empty() {
        return Err("states: the list is empty, expected at least one state".to_owned());
    }
    Ok(list)
}

/// The states of a file.
pub(super) fn states(file: &Path, model: &Model) -> Result<Vec<Asked>, CliError> {
    let value = opened(file)?;
    let wrong = |what: String| CliError::States { file: file.to_path_buf(), what };
    let list = list(&value).map_err(wrong)?;
    list.iter().enumerate().map(|(index, one)| state(index, one, model).map_err(wrong)).collect()
}

fn state(index: usize, value: &Value, model: &Model) -> Result<Asked, String> {
    let Value::Object(object) = value else {
        return Err(format!("states[{index}]: found {}, expected an object", kind(value)));
    };
    let reader = Reader { object, index, model };
    let clamped = model.base() == Base::Clamped;
    let quaternion = reader.fixed::<4>("base_quat_wxyz", "-", clamped.then_some([1.0, 0.0, 0.0, 0.0]))?;
    let base_orientation = Quaternion::new(quaternion[0], quaternion[1], quaternion[2], quaternion[3]);
    if !((base_orientation.norm() - 1.0).abs() <= QUATERNION_TOLERANCE) {
        let length = base_orientation.norm();
        return Err(format!("states[{index}].base_quat_wxyz: found one of length {length}, expected length 1"));
    }
    let rest = clamped.then_some([0.0; 3]);
    let base = |key, unit| reader.fixed::<3>(key, unit, rest).map(Vector3::from);
    let state = State {
        base_position_m: base("base_pos", "m")?,
        base_orientation: UnitQuaternion::new_normalize(base_orientation),
        base_velocity_m_s: base("base_vel_world", "m/s")?,
        base_rate_rad_s: base("base_omega_body", "rad/s")?,
        angle_rad: reader.joints("q", "rad")?,
        rate_rad_s: reader.joints("dq", "rad/s")?,
    };
    for (key, velocity) in [("base_vel_world", state.base_velocity_m_s), ("base_omega_body", state.base_rate_rad_s)] {
        if clamped && velocity != Vector3::zeros() {
            let found: [f64; 3] = velocity.into();
            return Err(format!(
                "states[{index}].{key}: found {found:?}, expected zeros: the base of {} is clamped",
                model.name()
            ));
        }
    }
    Ok(Asked { state, torque_nm: reader.joints("tau", "N m")? })
}

/// The keys of one state.
struct Reader<'a> {
    object: &'a Map<String, Value>,
    index: usize,
    model: &'a Model,
}

impl Reader<'_> {
    /// So many numbers, or what stands for them where the key is absent.
    fn fixed<const N: usize>(&self, key: &str, unit: &str, absent: Option<[f64; N]>) -> Result<[f64; N], String> {
        if let (Some(absent), None) = (absent, self.object.get(key)) {
            return Ok(absent);
        }
        let numbers = self.numbers(key, N, unit, "")?;
        <[f64; N]>::try_from(numbers).map_err(|_| format!("states[{}].{key}: expected {N} numbers", self.index))
    }

    /// One number for each joint.
    fn joints(&self, key: &str, unit: &str) -> Result<Vec<f64>, String> {
        let joints = self.model.joints();
        let ends = match joints {
            [first, .., last] => {
                format!(", one for each joint of {} ({} to {})", self.model.name(), first.name, last.name)
            }
            _ => format!(", one for each joint of {}", self.model.name()),
        };
        self.numbers(key, joints.len(), unit, &ends)
    }

    fn numbers(&self, key: &str, count: usize, unit: &str, whose: &str) -> Result<Vec<f64>, String> {
        let place = format!("states[{}].{key}", self.index);
        let expected = format!("expected {count} numbers [{unit}]{whose}");
        let list = match self.object.get(key) {
            Some(Value::Array(list)) => list,
            Some(other) => return Err(format!("{place}: found {}, {expected}", kind(other))),
            None => return Err(format!("{place} is missing, {expected}")),
        };
        if list.len() != count {
            return Err(format!("{place}: found {} numbers, {expected}", list.len()));
        }
        let number = |(k, value): (usize, &Value)| {
            let number = value.as_f64().filter(|x| x.is_finite());
            number.ok_or_else(|| format!("{place}[{k}]: found {}, expected a number [{unit}]", kind(value)))
        };
        list.iter().enumerate().map(number).collect()
    }
}

/// What a value is, for a message.
pub(super) fn kind(value: &Value) -> String {
    match value {
        Value::Null => "null (not a number?)".to_owned(),
        Value::Bool(found) => found.to_string(),
        Value::Number(found) => found.to_string(),
        Value::String(found) => format!("the text {found:?}"),
        Value::Array(list) => format!("a list of {}", list.len()),
        Value::Object(_) => "an object".to_owned(),
    }
}

/// A syntax error, with the key and index that it stands at: `NaN` is none of JSON's numbers.
fn not_json(text: &str, error: &serde_json::Error) -> String {
    let line_start: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
    let at = (line_start + error.column()).min(text.len());
    let before = &text.as_bytes()[..at];
    match place(&String::from_utf8_lossy(before)) {
        Some(place) => format!("{place}: {error}; expected a finite number, which NaN and Infinity are not in JSON"),
        None => format!("{error}; {EXPECTED}"),
    }
}

/// Key and index that a text breaks off in, if that is inside a list of numbers of a state.
fn place(before: &str) -> Option<String> {
    let open = before.rfind('[')?;
    let inside = &before[open + 1..];
    if inside.contains(['{', ']', '"']) {
        return None;
    }
    let key_text = before[..open].trim_end().strip_suffix(':')?.trim_end().strip_suffix('"')?;
    let key = &key_text[key_text.rfind('"')? + 1..];
    let index = before.matches(&format!("\"{key}\"")).count() - 1;
    Some(format!("states[{index}].{key}[{}]", inside.matches(',').count()))
}
