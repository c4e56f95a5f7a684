//! Reads `[uncertain]`: how sure the engineer is of what a study states.

use toml::{Spanned, Value};

use super::document::{Document, Range64, range};
use super::error::LogError;
use super::schema::{RawSpread, RawUncertain};
use super::uncertain::{Spread, Uncertain};

const RELATIVE: Range64 =
    range(|x| (0.0..=10.0).contains(&x), "a relative standard deviation from 0 (exact) to 10; 0.1 is ten percent");

/// Name in a table of names for all that are not named.
const ALL: &str = "default";

/// Which names a key may give numbers by; empty: any, because the robot's description has them.
pub(super) type Names = fn(&str) -> &'static [&'static str];

/// The numbers of one joint; inertia, moment and mass are those of its links.
pub(super) const JOINT_NAMES: Names = |key| match key {
    "friction" => &["coulomb", "viscous"],
    "gain" => &["kp", "ki", "kd"],
    "torque" => &["tau", "torque_limit"],
    _ => &[],
};

/// A robot's names are looked up by those who have its description.
pub(super) const ANY_NAME: Names = |_| &[];

/// Table `[uncertain]`, with the defaults of [`Uncertain`] where it is silent.
pub(super) fn uncertain(document: &Document<'_>, raw: &RawUncertain, names: Names) -> Result<Uncertain, LogError> {
    let read = |key: &str, raw: &RawSpread, usual: Spread| match raw {
        Some(value) => spread(document, key, value, usual, names(key)),
        None => Ok(usual),
    };
    let usual = Uncertain::default();
    Ok(Uncertain {
        inertia: read("inertia", &raw.inertia, usual.inertia)?,
        moment: read("moment", &raw.moment, usual.moment)?,
        mass: read("mass", &raw.mass, usual.mass)?,
        friction: read("friction", &raw.friction, usual.friction)?,
        gain: read("gain", &raw.gain, usual.gain)?,
        torque: read("torque", &raw.torque, usual.torque)?,
        floor: read("floor", &raw.floor, usual.floor)?,
    })
}

fn spread(
    document: &Document<'_>,
    key: &str,
    raw: &Spanned<Value>,
    usual: Spread,
    names: &[&str],
) -> Result<Spread, LogError> {
    let key = format!("[uncertain] {key}");
    let number = |key: &str, value: &Value| match value {
        Value::Float(number) => document.within(key, raw.span(), *number, RELATIVE),
        Value::Integer(number) => document.within(key, raw.span(), *number as f64, RELATIVE),
        other => Err(document.wrong(key, raw.span(), other.to_string(), RELATIVE.expected())),
    };
    let Value::Table(table) = raw.get_ref() else {
        return number(&key, raw.get_ref()).map(Spread::of_all);
    };
    let mut spread = usual;
    for (name, value) in table {
        let key = format!("{key}.{name}");
        if name == ALL {
            spread.all = number(&key, value)?;
            continue;
        }
        if !names.is_empty() && !names.contains(&&**name) {
            let expected = format!("{ALL} or one of {}", names.join(", "));
            return Err(document.wrong(&key, raw.span(), format!("the name `{name}`"), &expected));
        }
        spread.by_name.insert(name.clone(), number(&key, value)?);
    }
    Ok(spread)
}
