//! What the name of a column says: whose it is, what it holds, in which unit. A guess, and always told as one.

use crate::log::column::Column;
use crate::log::columns::Unit;
use std::f64::consts::TAU;

/// What a name looks like.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::log) struct Guess {
    /// What is left of the name; `None`: nothing is.
    pub joint: Option<String>,
    /// What it seems to hold.
    pub column: Column,
    /// The unit that the name states.
    pub unit: Option<Unit>,
}

const TIMES: [&str; 8] = ["t", "time", "timestamp", "timestamps", "stamp", "times", "ts", "tsec"];
const ANGLES: [&str; 12] = [
    "q",
    "pos",
    "position",
    "positions",
    "angle",
    "angles",
    "theta",
    "phi",
    "encoder",
    "jointangle",
    "jointposition",
    "qpos",
];
/// What says that it was read, of an angle where nothing else is said.
const READ: [&str; 10] =
    ["present", "actual", "measured", "state", "estimate", "estimated", "feedback", "fbk", "meas", "ist"];
const SETPOINTS: [&str; 25] = [
    "ref",
    "qref",
    "target",
    "goal",
    "cmd",
    "command",
    "commanded",
    "desired",
    "des",
    "setpoint",
    "reference",
    "action",
    "qdes",
    "refs",
    "targets",
    "goals",
    "cmds",
    "commands",
    "setpoints",
    "references",
    "actions",
    "qtarget",
    "ctrl",
    "soll",
    "demand",
];
/// What is asked where it stands beside a word for an angle: `q_d`, `angle_sp` behind it, `input_pos`, `control_position` before it.
const BEHIND_AN_ANGLE: [&str; 3] = ["d", "sp", "set"];
const BEFORE_AN_ANGLE: [&str; 3] = ["input", "control", "set"];
/// What switches a drive, and is no torque, speed or angle of it.
const SWITCHES: [&str; 3] = ["enable", "enabled", "enabling"];
/// Units that are not read, as they stand in brackets.
const OTHER_UNITS: [&str; 12] =
    ["%", "percent", "mm", "cm", "gon", "grad", "min", "h", "0.1ms", "ncm", "n cm", "kg cm"];
const SPEEDS: [&str; 8] = ["dq", "vel", "velocity", "velocities", "speed", "qdot", "qd", "qvel"];
const TORQUES: [&str; 5] = ["tau", "torque", "torques", "effort", "efforts"];
const CURRENTS: [&str; 3] = ["current", "currents", "amps"];
const NOISE: [&str; 4] = ["joint", "states", "field", "header"];

/// What a unit at the end of a name, or in brackets, is.
fn unit_of(word: &str) -> Option<Unit> {
    Some(match word {
        "s" | "sec" | "secs" | "seconds" => Unit::Time(1.0),
        "ms" | "msec" | "millis" | "milliseconds" => Unit::Time(1e-3),
        "us" | "usec" | "micros" | "microseconds" => Unit::Time(1e-6),
        "ns" | "nsec" | "nanos" | "nanoseconds" => Unit::Time(1e-9),
        "rad" | "rads" | "radians" => Unit::Angle(1.0),
        "deg" | "degs" | "degree" | "degrees" => Unit::Angle(TAU / 360.0),
        "rev" | "revs" | "turns" | "revolutions" => Unit::Angle(TAU),
        "mrad" | "mrads" => Unit::Angle(1e-3),
        "rpm" => Unit::RPM,
        "nm" => Unit::Torque(1.0),
        "mnm" => Unit::Torque(1e-3),
        "a" | "amperes" => Unit::Current(1.0),
        "ma" | "milliamps" => Unit::Current(1e-3),
        _ => return None,
    })
}

/// The words of a name; a number behind one that says what the column holds is a word of its own: `q0`, `tau1`.
fn words(name: &str) -> Vec<&str> {
    let words =
        name.split(|c: char| !c.is_alphanumeric()).map(without_number).flat_map(|(word, number)| [word, number]);
    words.filter(|word| !word.is_empty()).collect()
}

fn without_number(word: &str) -> (&str, &str) {
    let held = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let sets: [&[&str]; 6] = [&ANGLES, &READ, &SETPOINTS, &SPEEDS, &TORQUES, &CURRENTS];
    let is_held = sets.iter().any(|set| set.contains(&&*held.to_lowercase()));
    word.split_at(if is_held { held.len() } else { word.len() })
}

/// Whether the name of a column says that it is asked for, not measured.
pub(super) fn is_asked(name: &str) -> bool {
    words(name).iter().any(|word| SETPOINTS.contains(&&*word.to_lowercase()))
}

/// Whether a name states a unit that is not read: what it holds would be taken for something else.
fn is_in_other_unit(name: &str) -> bool {
    let inside =
        name.trim_end_matches([']', ')']).rsplit_once(['[', '(']).map(|(_, inside)| inside.trim().to_lowercase());
    inside.is_some_and(|inside| OTHER_UNITS.contains(&&*inside))
}

/// What a column's name looks like; `None`: like nothing that is used.
pub(in crate::log) fn guess(name: &str) -> Option<Guess> {
    let words = words(name);
    let lower: Vec<String> = words.iter().map(|word| word.to_lowercase()).collect();
    let is = |set: &[&str], word: &str| set.contains(&word);
    if is_in_other_unit(name) || lower.iter().any(|word| is(&SWITCHES, word)) {
        return None;
    }
    // The unit may be a fraction: `rad/s`. Without brackets a letter may be anybody's.
    let is_unit = |k: usize| (lower[k] != "a" || name.contains(['[', '('])) && unit_of(&lower[k]).is_some();
    let last_unit = (1..lower.len()).rev().find(|&k| is_unit(k));
    let unit_at = last_unit.filter(|&k| k > 1 && is_unit(k - 1)).map_or(last_unit, |k| Some(k - 1));
    let is_of_unit = |k: usize| Some(k) == unit_at || Some(k) == last_unit;
    let unit = unit_at.and_then(|k| unit_of(&lower[k]));
    // A unit alone is a name too: `ms`, `deg`.
    let alone = if lower.len() == 1 { unit_of(&lower[0]) } else { None };
    let asks = |k: usize| {
        let beside = |at: Option<usize>| at.and_then(|at| lower.get(at)).is_some_and(|word| is(&ANGLES, word));
        is(&SETPOINTS, &lower[k])
            || is(&BEHIND_AN_ANGLE, &lower[k]) && beside(k.checked_sub(1))
            || is(&BEFORE_AN_ANGLE, &lower[k]) && beside(Some(k + 1))
    };
    let is_asked = (0..lower.len()).any(|k| !is_of_unit(k) && asks(k));
    let any = |set: &[&str]| lower.iter().enumerate().any(|(k, word)| !is_of_unit(k) && is(set, word));
    let column = if is_asked && !any(&TORQUES) && !any(&SPEEDS) {
        Column::Setpoint
    } else if is_asked && any(&SPEEDS) {
        return None;
    } else if any(&SPEEDS) {
        Column::Speed
    } else if any(&TORQUES) || any(&CURRENTS) && !any(&ANGLES) {
        Column::Torque
    } else if any(&ANGLES) || any(&READ) || matches!(alone, Some(Unit::Angle(_))) {
        Column::Angle
    } else if any(&TIMES) || matches!(alone, Some(Unit::Time(_))) {
        Column::Time
    } else {
        return None;
    };
    let unit = match (unit.or(alone).filter(|unit| unit.fits(column)), column) {
        (None, Column::Torque) if any(&CURRENTS) => Some(Unit::Current(1.0)),
        (unit, _) => unit,
    };
    let known = |k: usize, word: &str| {
        let sets: [&[&str]; 8] = [&TIMES, &ANGLES, &READ, &SETPOINTS, &SPEEDS, &TORQUES, &CURRENTS, &NOISE];
        is_of_unit(k) || asks(k) || lower.len() == 1 || sets.iter().any(|set| set.contains(&word))
    };
    let rest: Vec<&str> =
        words.iter().enumerate().filter(|(k, _)| !known(*k, &lower[*k])).map(|(_, word)| *word).collect();
    let is_number = rest.iter().all(|word| word.bytes().all(|b| b.is_ascii_digit()));
    let joint = (!rest.is_empty() && column != Column::Time)
        .then(|| if is_number { format!("joint_{}", rest.join("_")) } else { rest.join("_") });
    (column != Column::Time || rest.is_empty()).then_some(Guess { joint, column, unit })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_people_give_are_understood() {
        let deg = Some(Unit::Angle(TAU / 360.0));
        for (name, joint, column, unit) in [
            ("time", None, Column::Time, None),
            ("t [s]", None, Column::Time, Some(Unit::Time(1.0))),
            ("stamp_ns", None, Column::Time, Some(Unit::Time(1e-9))),
            ("ms", None, Column::Time, Some(Unit::Time(1e-3))),
            ("angle_deg", None, Column::Angle, deg),
            ("elbow_pos", Some("elbow"), Column::Angle, None),
            ("elbow_target_position (deg)", Some("elbow"), Column::Setpoint, deg),
            ("left_hip.velocity", Some("left_hip"), Column::Speed, None),
            ("shoulder current", Some("shoulder"), Column::Torque, Some(Unit::Current(1.0))),
            ("effort", None, Column::Torque, None),
            ("q0", Some("joint_0"), Column::Angle, None),
            ("pos[1] (deg)", Some("joint_1"), Column::Angle, deg),
            ("joint_2_cmd", Some("joint_2"), Column::Setpoint, None),
            ("actual_qd_3", Some("joint_3"), Column::Speed, None),
            ("joint4_pos", Some("joint4"), Column::Angle, None),
            ("velocity [rad/s]", None, Column::Speed, Some(Unit::Angle(1.0))),
            ("elbow_velocity_deg_s", Some("elbow"), Column::Speed, deg),
            ("speed [rpm]", None, Column::Speed, Some(Unit::RPM)),
            ("current [mA]", None, Column::Torque, Some(Unit::Current(1e-3))),
            ("current [A]", None, Column::Torque, Some(Unit::Current(1.0))),
            ("current_position", None, Column::Angle, None),
            ("Present Current", None, Column::Torque, Some(Unit::Current(1.0))),
            ("time_s", None, Column::Time, Some(Unit::Time(1.0))),
            ("torque [mNm]", None, Column::Torque, Some(Unit::Torque(1e-3))),
            ("position [mrad]", None, Column::Angle, Some(Unit::Angle(1e-3))),
            ("q_d[0]", Some("joint_0"), Column::Setpoint, None),
            ("theta_d", None, Column::Setpoint, None),
            ("angle_sp", None, Column::Setpoint, None),
            ("input_pos", None, Column::Setpoint, None),
            ("pos_estimate", None, Column::Angle, None),
            ("control_position", None, Column::Setpoint, None),
            ("ctrl", None, Column::Setpoint, None),
            ("joint_d_pos", Some("d"), Column::Angle, None),
            ("goal_position", None, Column::Setpoint, None),
        ] {
            let found = guess(name).unwrap_or_else(|| panic!("{name}: nothing"));
            assert_eq!(found, Guess { joint: joint.map(str::to_owned), column, unit }, "{name}");
        }
        assert_eq!(guess("volts"), None);
        assert_eq!(guess("temperature"), None);
        for other in ["torque_enable", "position [%]", "angle (gon)", "time [min]", "stroke [mm]", "position [mm]"] {
            assert_eq!(guess(other), None, "{other}");
        }
        // A speed that is asked for is none that is measured.
        assert_eq!(guess("target_qd_0"), None);
        assert!(is_asked("target_current_0") && !is_asked("actual_current_0"));
    }
}
