//! Writes a study as TOML, in the format that is read: what is set stands there, what is usual does not.

use toml::{Table, Value};

use super::motor::{DERIVATIVES, ENCODERS, HOLDS};
use super::motor_types::{MotorModel, MotorSpec, TauIs};
use super::study::{DRIVES, ROLES};
use super::types::{ExtraMass, JointSpec, Release, SensorSpec, Study, StudyLog};
use super::uncertain::{Spread, Uncertain};
use super::window::Window;

/// A joint study, or the sidecar of a log, as text that [`read_study`](super::read_study) reads to the same study.
///
/// A current's torque constant and gear are written as their product, and a log's overrides of `[motor]` as all that
/// differs from it.
///
/// ```
/// use aibo_fit::log::{read_study, study_text};
/// let study = read_study("data/examples/delay/study.toml".as_ref())?;
/// assert!(study_text(&study).contains("[motor]\n"));
/// # Ok::<(), aibo_fit::log::LogError>(())
/// ```
pub fn study_text(study: &Study) -> String {
    let mut root = Table::new();
    root.insert("schema".into(), Value::Integer(1));
    let mut add = |key: &str, table: Table| {
        if !table.is_empty() {
            root.insert(key.into(), Value::Table(table));
        }
    };
    add("joint", joint(&study.joint));
    add("sensor", sensor(&study.sensor));
    add("motor", study.motor.as_ref().map(|motor| self::motor(motor, None)).unwrap_or_default());
    add("uncertain", uncertain(&study.uncertain));
    add("release", study.release.as_ref().map(release).unwrap_or_default());
    let logs = study.logs.iter().map(|entry| Value::Table(log(entry, study.motor.as_ref())));
    root.insert("log".into(), Value::Array(logs.collect()));
    // Tables of numbers and words have no form that TOML lacks.
    toml::to_string(&root).unwrap_or_default()
}

fn put(table: &mut Table, key: &str, value: impl Into<Value>) {
    table.insert(key.into(), value.into());
}

fn put_some(table: &mut Table, key: &str, value: Option<f64>) {
    if let Some(value) = value {
        put(table, key, value);
    }
}

fn word<T: PartialEq>(words: &[(&'static str, T)], meaning: &T) -> &'static str {
    words.iter().find(|(_, other)| other == meaning).map_or("", |(word, _)| word)
}

fn joint(joint: &JointSpec) -> Table {
    let mut table = Table::new();
    put(&mut table, "name", joint.name.clone());
    if let Some(nominal) = &joint.nominal {
        put(&mut table, "inertia", nominal.inertia_kg_m2);
        put(&mut table, "moment", nominal.moment_kg_m);
        put(&mut table, "coulomb", nominal.coulomb_nm);
        put(&mut table, "viscous", nominal.viscous_nm_s_rad);
    }
    put(&mut table, "gravity", joint.gravity_m_s2);
    put_some(&mut table, "rest", joint.rest_rad);
    table
}

fn sensor(sensor: &SensorSpec) -> Table {
    let mut table = Table::new();
    put_some(&mut table, "resolution", sensor.resolution_rad);
    put_some(&mut table, "period", sensor.period_s);
    table
}

/// What differs from `base`, or from the defaults where there is none; the gains always stand in a table of its own.
fn motor(motor: &MotorSpec, base: Option<&MotorSpec>) -> Table {
    let usual = MotorSpec::pd(f64::NAN, f64::NAN);
    let base = base.unwrap_or(&usual);
    let mut table = Table::new();
    let numbers = [
        ("kp", Some(motor.kp_nm_rad), Some(base.kp_nm_rad)),
        ("ki", Some(motor.ki_nm_rad_s), Some(base.ki_nm_rad_s)),
        ("kd", Some(motor.kd_nm_s_rad), Some(base.kd_nm_s_rad)),
        ("sample_period", motor.sample_period_s, base.sample_period_s),
        ("torque_limit", motor.torque_limit_nm, base.torque_limit_nm),
        ("speed_limit", motor.speed_limit_rad_s, base.speed_limit_rad_s),
        ("armature", Some(motor.armature_kg_m2), Some(base.armature_kg_m2)),
    ];
    for (key, own, other) in numbers {
        put_some(&mut table, key, own.filter(|_| own != other));
    }
    let words = [
        ("hold", word(&HOLDS, &motor.hold), word(&HOLDS, &base.hold)),
        ("derivative", word(&DERIVATIVES, &motor.derivative), word(&DERIVATIVES, &base.derivative)),
        ("encoder", word(&ENCODERS, &motor.encoder), word(&ENCODERS, &base.encoder)),
    ];
    for (key, own, _) in words.into_iter().filter(|(_, own, other)| own != other) {
        put(&mut table, key, own);
    }
    if motor.model != base.model {
        match &motor.model {
            MotorModel::Torque => put(&mut table, "model", "torque"),
            MotorModel::Voltage(voltage) => {
                put(&mut table, "model", "voltage");
                put(&mut table, "kt", voltage.kt_nm_a);
                put(&mut table, "resistance", voltage.resistance_ohm);
                put(&mut table, "supply", voltage.supply_v);
                put(&mut table, "duty_limit", voltage.duty_limit);
            }
        }
    }
    table
}

fn uncertain(uncertain: &Uncertain) -> Table {
    let usual = Uncertain::default();
    let spreads = [
        ("inertia", &uncertain.inertia, &usual.inertia),
        ("moment", &uncertain.moment, &usual.moment),
        ("mass", &uncertain.mass, &usual.mass),
        ("friction", &uncertain.friction, &usual.friction),
        ("gain", &uncertain.gain, &usual.gain),
        ("torque", &uncertain.torque, &usual.torque),
        ("floor", &uncertain.floor, &usual.floor),
    ];
    let set = spreads.into_iter().filter(|(_, own, usual)| own != usual);
    set.map(|(key, own, _)| (key.to_owned(), spread(own))).collect()
}

fn spread(spread: &Spread) -> Value {
    if spread.by_name.is_empty() {
        return spread.all.into();
    }
    let mut table: Table = spread.by_name.iter().map(|(name, value)| (name.clone(), (*value).into())).collect();
    put(&mut table, "default", spread.all);
    table.into()
}

fn release(release: &Release) -> Table {
    let mut table = Table::new();
    put_some(&mut table, "time", release.time_s);
    put_some(&mut table, "setpoint", release.setpoint_rad);
    put_some(&mut table, "angle", release.angle_rad);
    table
}

fn log(entry: &StudyLog, base: Option<&MotorSpec>) -> Table {
    let mut table = Table::new();
    put(&mut table, "file", Window::file(entry.window.as_ref(), &entry.file));
    put(&mut table, "role", word(&ROLES, &entry.role));
    put(&mut table, "drive", word(&DRIVES, &entry.drive));
    if let Some(window) = &entry.window {
        put_some(&mut table, "from", window.from_s);
        put_some(&mut table, "to", window.to_s);
    }
    if let Some(session) = &entry.session {
        put(&mut table, "session", session.clone());
    }
    match entry.tau_is {
        None => {}
        Some(TauIs::Applied) => put(&mut table, "tau_is", "applied"),
        Some(TauIs::Commanded) => put(&mut table, "tau_is", "commanded"),
        Some(TauIs::Current { nm_per_a }) => {
            put(&mut table, "tau_is", "current");
            put(&mut table, "kt", nm_per_a);
        }
    }
    let own = entry.motor.as_ref().map(|own| motor(own, base)).filter(|own| !own.is_empty());
    if let Some(own) = own {
        put(&mut table, "motor", own);
    }
    if let Some(ExtraMass { mass_kg, distance_m, radius_m, length_m }) = entry.extra {
        let numbers = [("mass", mass_kg), ("distance", distance_m), ("radius", radius_m), ("length", length_m)];
        let extra: Table = numbers.into_iter().map(|(key, value)| (key.to_owned(), value.into())).collect();
        put(&mut table, "extra", extra);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::read_study;

    #[test]
    fn a_study_with_every_key_is_read_back_as_it_was() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["a.csv", "b.csv", "c.csv"] {
            std::fs::write(dir.path().join(name), "t,q\n").unwrap();
        }
        let path = dir.path().join("study.toml");
        let text = r#"schema = 1
[joint]
name = "elbow"
inertia = 0.1
moment = 0.2
coulomb = 0.3
viscous = 0.4
gravity = 9.80665
rest = -0.5
[sensor]
resolution = 0.006
period = 0.008
[motor]
kp = 5.0
ki = 0.1
kd = 0.05
hold = "linear"
derivative = "error"
sample_period = 0.002
torque_limit = 2.0
speed_limit = 8.0
model = "voltage"
kt = 1.5
resistance = 2.0
supply = 12.0
duty_limit = 0.9
encoder = "motor"
armature = 0.01
[uncertain]
inertia = 0.3
friction = { coulomb = 0.2, default = 0.4 }
gain = 0.0
[[log]]
file = "a.csv"
role = "fit"
drive = "position"
session = "feb"
tau_is = "current"
kt = 0.5
gear = 3.0
[[log]]
file = "b.csv"
role = "validate"
drive = "position"
tau_is = "commanded"
motor = { model = "torque", kp = 7.0, ki = 0.0, encoder = "link", armature = 0.0, torque_limit = 1.0 }
[log.extra]
mass = 0.22
distance = 0.12
radius = 0.015
length = 0.03
[[log]]
file = "c.csv"
role = "fit"
drive = "off"
"#;
        std::fs::write(&path, text).unwrap();
        let study = read_study(&path).unwrap();
        std::fs::write(&path, study_text(&study)).unwrap();
        assert_eq!(read_study(&path).unwrap(), study);
        assert_eq!(study.logs[0].tau_is, Some(TauIs::Current { nm_per_a: 1.5 }));
    }
}
