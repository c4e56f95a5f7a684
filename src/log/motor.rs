//! Reads `[motor]` and what a log says beside it: the control law, what turns it into torque, and what `tau` is.

use toml::Spanned;

use super::document::{Document, NOT_NEGATIVE, Number, PERIOD, POSITIVE, Range64, Text, range};
use super::error::LogError;
use super::motor_types::{Derivative, EncoderSide, Hold, MotorModel, MotorSpec, TauIs, VoltageMotor};
use super::schema::{RawLog, RawMotor};
use super::types::DriveMode;

const GAIN: Range64 = range(|x| x >= 0.0, "a number not below 0 (N m/rad; where model = \"voltage\" duty per rad)");
const DAMPING: Range64 = range(
    |x| x >= 0.0,
    "a number not below 0 (N m s/rad; where model = \"voltage\" duty s/rad); 0 where the drive has no such gain",
);
const DUTY: Range64 = range(|x| x > 0.0 && x <= 1.0, "a share of the supply above 0 and at most 1");

pub(super) const HOLDS: [(&str, Hold); 2] = [("step", Hold::Step), ("linear", Hold::Linear)];
pub(super) const DERIVATIVES: [(&str, Derivative); 2] =
    [("measurement", Derivative::Measurement), ("error", Derivative::Error)];
pub(super) const ENCODERS: [(&str, EncoderSide); 2] = [("link", EncoderSide::Link), ("motor", EncoderSide::Motor)];

/// The words of `model`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Model {
    Torque,
    Voltage,
}

const MODELS: [(&str, Model); 2] = [("torque", Model::Torque), ("voltage", Model::Voltage)];

/// The words of `tau_is`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tau {
    Applied,
    Commanded,
    Current,
}

const TAUS: [(&str, Tau); 3] = [("applied", Tau::Applied), ("commanded", Tau::Commanded), ("current", Tau::Current)];

/// A motor; `table` is what stands before the name of a key, as in `[motor] `.
pub(super) fn motor(document: &Document<'_>, table: &str, raw: &RawMotor) -> Result<MotorSpec, LogError> {
    let key = |name: &str| format!("{table}{name}");
    let motor = MotorSpec {
        kp_nm_rad: document.needed(&key("kp"), &raw.kp, GAIN)?,
        ki_nm_rad_s: document.number(&key("ki"), &raw.ki, NOT_NEGATIVE)?.unwrap_or(0.0),
        kd_nm_s_rad: document.needed(&key("kd"), &raw.kd, DAMPING)?,
        hold: document.word(&key("hold"), &raw.hold, &HOLDS)?.unwrap_or_default(),
        derivative: document.word(&key("derivative"), &raw.derivative, &DERIVATIVES)?.unwrap_or_default(),
        sample_period_s: document.number(&key("sample_period"), &raw.sample_period, PERIOD)?,
        torque_limit_nm: document.number(&key("torque_limit"), &raw.torque_limit, POSITIVE)?,
        speed_limit_rad_s: document.number(&key("speed_limit"), &raw.speed_limit, POSITIVE)?,
        model: model(document, table, raw)?,
        encoder: document.word(&key("encoder"), &raw.encoder, &ENCODERS)?.unwrap_or_default(),
        armature_kg_m2: document.number(&key("armature"), &raw.armature, NOT_NEGATIVE)?.unwrap_or(0.0),
    };
    if motor.derivative == Derivative::Error && motor.hold == Hold::Step {
        let span = raw.derivative.as_ref().map_or(0..0, Spanned::span);
        let expected = "hold = \"linear\" beside it: a setpoint held in steps has no derivative";
        return Err(document.wrong(&key("derivative"), span, "\"error\" with hold = \"step\"", expected));
    }
    if motor.speed_limit_rad_s.is_some() && motor.torque_limit_nm.is_none() {
        let span = raw.speed_limit.as_ref().map_or(0..0, Spanned::span);
        let expected = "torque_limit beside it, the stall torque of the torque-speed line";
        return Err(document.wrong(&key("speed_limit"), span, "speed_limit alone", expected));
    }
    Ok(motor)
}

/// What turns the law's answer into torque; the keys of a motor fed by voltage belong to that model only.
pub(super) fn model(document: &Document<'_>, table: &str, raw: &RawMotor) -> Result<MotorModel, LogError> {
    let key = |name: &str| format!("{table}{name}");
    let said = document.word(&key("model"), &raw.model, &MODELS)?;
    let is_current = document.word(&key("tau_is"), &raw.tau_is, &TAUS)? == Some(Tau::Current);
    if said == Some(Model::Voltage) {
        let needed = |name: &str, value: &Number, what: &str| {
            document
                .number(&key(name), value, POSITIVE)?
                .ok_or_else(|| document.missing(key(name), format!("{what}, which model = \"voltage\" needs")))
        };
        return Ok(MotorModel::Voltage(VoltageMotor {
            kt_nm_a: needed("kt", &raw.kt, "the torque constant after the gear [N m/A]")?,
            resistance_ohm: needed("resistance", &raw.resistance, "the resistance of the winding [Ohm]")?,
            supply_v: needed("supply", &raw.supply, "the voltage of the supply [V]")?,
            duty_limit: document.number(&key("duty_limit"), &raw.duty_limit, DUTY)?.unwrap_or(1.0),
        }));
    }
    let voltage_only =
        [("kt", &raw.kt), ("resistance", &raw.resistance), ("supply", &raw.supply), ("duty_limit", &raw.duty_limit)];
    for (name, value) in voltage_only {
        if let Some(value) = value.as_ref().filter(|_| !(name == "kt" && is_current)) {
            let also = if name == "kt" { " (or tau_is = \"current\")" } else { "" };
            let expected = format!("model = \"voltage\"{also} beside it, or no {name}");
            return Err(document.wrong(&key(name), value.span(), value.get_ref().to_string(), &expected));
        }
    }
    Ok(MotorModel::Torque)
}

/// Checks each key that turns the law's answer or a current into torque by itself: whether they go together is another question.
pub(super) fn each_key(document: &Document<'_>, table: &str, raw: &RawMotor) -> Result<(), LogError> {
    let key = |name: &str| format!("{table}{name}");
    document.word(&key("model"), &raw.model, &MODELS)?;
    document.word(&key("tau_is"), &raw.tau_is, &TAUS)?;
    document.number(&key("duty_limit"), &raw.duty_limit, DUTY)?;
    let positive = [("kt", &raw.kt), ("resistance", &raw.resistance), ("supply", &raw.supply), ("gear", &raw.gear)];
    for (name, value) in positive {
        document.number(&key(name), value, POSITIVE)?;
    }
    Ok(())
}

/// What the column `tau` of a log is: as the log says, or else its motor; `None` where nobody says it, and in logs that
/// no controller drives.
pub(super) fn tau_is(
    document: &Document<'_>,
    table: &str,
    log: &RawLog,
    motor: Option<(&str, &RawMotor)>,
    drive: DriveMode,
) -> Result<Option<TauIs>, LogError> {
    let own = document.word(&format!("{table} tau_is"), &log.tau_is, &TAUS)?;
    if let Some(said) = log.tau_is.as_ref().filter(|_| drive != DriveMode::Position) {
        let found = format!("\"{}\" in a log that is not driven by position", said.get_ref());
        let expected = "tau_is beside drive = \"position\" only: with drive = \"torque\" the column is applied";
        return Err(document.wrong(&format!("{table} tau_is"), said.span(), found, expected));
    }
    let of_motor = |said: &Text, table: &str| document.word(&format!("{table}tau_is"), said, &TAUS);
    let from_motor = motor.map(|(table, raw)| of_motor(&raw.tau_is, table)).transpose()?.flatten();
    let said = own.or(from_motor);
    if said != Some(Tau::Current) {
        let motor_gear = motor.and_then(|(table, raw)| Some((format!("{table}gear"), raw.gear.as_ref()?)));
        let of_log = |name: &str, value: &Number| Some((format!("{table} {name}"), value.clone()?));
        let stray = [of_log("kt", &log.kt), of_log("gear", &log.gear)].into_iter().flatten().next();
        let stray = stray.or(motor_gear.filter(|_| own.is_none()).map(|(key, value)| (key, value.clone())));
        if let Some((key, value)) = stray {
            let expected = "tau_is = \"current\" beside it, which alone needs kt and gear";
            return Err(document.wrong(&key, value.span(), value.get_ref().to_string(), expected));
        }
    }
    if drive != DriveMode::Position {
        return Ok(None);
    }
    let current = || {
        let motor_value =
            |pick: fn(&RawMotor) -> &Number| motor.and_then(|(table, raw)| Some((table, pick(raw).clone()?)));
        let number = |name: &str, own: &Number, pick: fn(&RawMotor) -> &Number| match (own, motor_value(pick)) {
            (None, Some((table, value))) => document.number(&format!("{table}{name}"), &Some(value), POSITIVE),
            (own, _) => document.number(&format!("{table} {name}"), own, POSITIVE),
        };
        let kt = number("kt", &log.kt, |raw| &raw.kt)?.ok_or_else(|| {
            let expected = "the torque constant [N m/A], which tau_is = \"current\" needs";
            let place =
                motor.filter(|_| own.is_none()).map_or_else(|| format!("{table} "), |(table, _)| table.to_owned());
            document.missing(format!("{place}kt"), expected)
        })?;
        let gear = number("gear", &log.gear, |raw| &raw.gear)?.unwrap_or(1.0);
        Ok(TauIs::Current { nm_per_a: kt * gear })
    };
    said.map(|said| match said {
        Tau::Applied => Ok(TauIs::Applied),
        Tau::Commanded => Ok(TauIs::Commanded),
        Tau::Current => current(),
    })
    .transpose()
}
