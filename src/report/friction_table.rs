//! A joint's friction as a table over its speed, for simulators that take one, or none of our formulas.

use super::EffectFit;
use crate::number::{math, quantity};
use serde::Serialize;
use serde_json::Value;
use std::fmt::Write as _;

/// Speeds on each side of rest.
const STEPS: u32 = 20;
/// Speed up to which the table goes where no log says how fast the joint was \[rad/s\].
const TOP_RAD_S: f64 = 10.0;

/// Friction of a joint over its speed: Coulomb, viscous and static friction of the Stribeck form (eq. 3.11).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrictionTable {
    /// The joint.
    pub joint: String,
    /// Rising, zero in the middle \[rad/s\].
    pub speed_rad_s: Vec<f64>,
    /// What friction takes, with the sign of the speed \[N m\]; at rest 0, the joint then sticks up to the first entries.
    pub torque_nm: Vec<f64>,
    /// Lower end of the torque's 95 % interval \[N m\]; `None`: the logs do not determine it.
    pub low_nm: Vec<Option<f64>>,
    /// Upper end.
    pub high_nm: Vec<Option<f64>>,
    /// Causes that change this friction and that a table over speed cannot say.
    pub cannot_say: Vec<String>,
}

/// A number with the ends of its interval; both are the value where the study holds it.
#[derive(Clone, Copy)]
struct Known {
    value: f64,
    ends: Option<[f64; 2]>,
}

impl Known {
    fn of(quantity: &Value) -> Option<Self> {
        let end = |at: usize| quantity["interval"][at].as_f64();
        Some(Self { value: quantity["value"].as_f64()?, ends: end(0).zip(end(1)).map(|(low, high)| [low, high]) })
    }
}

/// Static friction above Coulomb's and how it falls with speed.
struct Static {
    torque: Known,
    speed_rad_s: f64,
    form: String,
}

impl Static {
    fn of(effect: &Value) -> Option<Self> {
        let parameters = &effect["parameters"];
        let speed_rad_s = parameters["v_st"]["value"].as_f64().filter(|speed| *speed > 0.0)?;
        let form = effect["form"].as_str().unwrap_or("gaussian").to_owned();
        Some(Self { torque: Known::of(&parameters["mu_st"])?, speed_rad_s, form })
    }

    /// The share of it that is left at a speed.
    fn share(&self, speed_rad_s: f64) -> f64 {
        let u = speed_rad_s / self.speed_rad_s;
        match self.form.as_str() {
            "exponential" => math::exp(-u),
            "rational" => 1.0 / (1.0 + u * u),
            _ => math::exp(-u * u),
        }
    }
}

/// The tables of what `gap --json` says of a joint or of a robot's joints, or of a joint's `fit.json`; joints without a
/// value of their friction are left out.
pub fn friction_tables(document: &Value) -> Vec<FrictionTable> {
    match document.get("joints").and_then(Value::as_object) {
        Some(joints) => joints.iter().filter_map(|(joint, own)| table(joint, own)).collect(),
        None => document["name"].as_str().and_then(|joint| table(joint, document)).into_iter().collect(),
    }
}

fn table(joint: &str, document: &Value) -> Option<FrictionTable> {
    let coulomb = Known::of(&document["joint"]["coulomb"])?;
    let viscous = Known::of(&document["joint"]["viscous"])?;
    let effects = document["effects"].as_array().map_or(&[][..], Vec::as_slice);
    let of_friction = effects.iter().find(|effect| effect["id"] == "stribeck").and_then(Static::of);
    let health = document["health"].as_array().into_iter().flatten();
    let top_rad_s = health.filter_map(|log| log["top_speed_rad_s"].as_f64()).fold(0.0, f64::max);
    let top_rad_s = if top_rad_s > 0.0 { top_rad_s } else { TOP_RAD_S };
    // Close at rest, where friction changes most.
    let speeds: Vec<f64> = (1..=STEPS).map(|k| top_rad_s * (f64::from(k) / f64::from(STEPS)).powi(2)).collect();
    let torque = |speed: f64, coulomb: f64, viscous: f64, held: Option<f64>| {
        let share = of_friction.as_ref().map_or(0.0, |held| held.share(speed));
        coulomb + (held.unwrap_or(coulomb) - coulomb) * share + viscous * speed
    };
    let of_end = |speed: f64, end: usize| {
        // The study holds a number without an interval: it is as it stands.
        let at = |known: Known| known.ends.map_or(known.value, |ends| ends[end]).max(0.0);
        (coulomb.ends.is_some() || viscous.ends.is_some())
            .then(|| torque(speed, at(coulomb), at(viscous), of_friction.as_ref().map(|held| at(held.torque))))
    };
    let held = of_friction.as_ref().map(|held| held.torque.value);
    let rows = speeds.iter().map(|&w| (w, torque(w, coulomb.value, viscous.value, held), of_end(w, 0), of_end(w, 1)));
    let rows: Vec<_> = rows.collect();
    let back = rows.iter().rev().map(|(w, torque, low, high)| (-w, -torque, high.map(|x| -x), low.map(|x| -x)));
    let all: Vec<_> = back.chain([(0.0, 0.0, Some(0.0), Some(0.0))]).chain(rows.iter().copied()).collect();
    let in_words = |effect: &Value| {
        let id = effect["id"].as_str().filter(|id| *id != "stribeck")?;
        let read = serde_json::from_value::<EffectFit>(effect.clone());
        Some(format!("{joint}: {}", read.map_or_else(|_| id.to_owned(), |effect| effect.words())))
    };
    // Who takes the friction without the gain beside which it was found has another joint.
    let gain = Known::of(&document["joint"]["gain"]).filter(|gain| gain.value != 1.0);
    let gain = gain.map(|gain| {
        let gain = quantity(gain.value, gain.ends, "");
        format!("{joint}: gain = {gain} of what is stated, beside which this friction was found")
    });
    Some(FrictionTable {
        joint: joint.to_owned(),
        speed_rad_s: all.iter().map(|row| row.0).collect(),
        torque_nm: all.iter().map(|row| row.1).collect(),
        low_nm: all.iter().map(|row| row.2).collect(),
        high_nm: all.iter().map(|row| row.3).collect(),
        cannot_say: effects.iter().filter_map(in_words).chain(gain).collect(),
    })
}

/// The tables as CSV: `joint,speed_rad_s,torque_nm,low_nm,high_nm`, a row for each joint and speed.
pub fn friction_csv(tables: &[FrictionTable]) -> String {
    let mut text = String::from("joint,speed_rad_s,torque_nm,low_nm,high_nm\n");
    for table in tables {
        let needs_quotes = table.joint.contains([',', '"', '\n']);
        let joint =
            if needs_quotes { format!("\"{}\"", table.joint.replace('"', "\"\"")) } else { table.joint.clone() };
        let end = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.9}"));
        for (i, (speed, torque)) in table.speed_rad_s.iter().zip(&table.torque_nm).enumerate() {
            let _ = writeln!(text, "{joint},{speed:.6},{torque:.9},{},{}", end(table.low_nm[i]), end(table.high_nm[i]));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn document(effects: Value) -> Value {
        json!({
            "name": "knee", "effects": effects, "health": [{ "top_speed_rad_s": 4.0 }],
            "joint": { "coulomb": { "value": 0.1, "interval": [0.09, 0.12] }, "viscous": { "value": 0.05, "interval": null } },
        })
    }

    #[test]
    fn friction_is_odd_in_speed_and_its_interval_holds_it() {
        let table = &friction_tables(&document(json!([{ "id": "delay", "parameters": {} }])))[0];
        let n = table.speed_rad_s.len();
        assert_eq!((n, table.speed_rad_s[0], table.speed_rad_s[n - 1]), (41, -4.0, 4.0));
        assert!(table.speed_rad_s.is_sorted() && table.torque_nm.is_sorted());
        assert!((table.torque_nm[n - 1] - 0.3).abs() < 1e-12);
        for i in 0..n {
            assert_eq!(table.torque_nm[i], -table.torque_nm[n - 1 - i]);
            assert!(table.low_nm[i].unwrap() <= table.torque_nm[i] && table.torque_nm[i] <= table.high_nm[i].unwrap());
        }
        assert!((table.high_nm[n - 1].unwrap() - 0.32).abs() < 1e-12);
        assert_eq!(table.cannot_say, ["knee: delay"]);
        let text = friction_csv(std::slice::from_ref(table));
        assert_eq!(
            (text.lines().count(), text.lines().nth(21)),
            (42, Some("knee,0.000000,0.000000000,0.000000000,0.000000000"))
        );
    }

    #[test]
    fn static_friction_stands_at_low_speed_in_its_own_form() {
        for (form, share) in [("gaussian", (-1.0_f64).exp()), ("exponential", (-1.0_f64).exp()), ("rational", 0.5)] {
            let stribeck = json!([{ "id": "stribeck", "form": form, "parameters": {
                "mu_st": { "value": 0.2, "interval": [0.15, 0.25] }, "v_st": { "value": 1.0 } } }]);
            let table = &friction_tables(&document(stribeck))[0];
            let at = table.speed_rad_s.iter().position(|w| (w - 1.0).abs() < 1e-12).unwrap();
            assert!((table.torque_nm[at] - (0.1 + 0.1 * share + 0.05)).abs() < 1e-12, "{form}");
            assert!(table.torque_nm[21] > 0.199 && table.cannot_say.is_empty());
        }
    }

    #[test]
    fn what_a_table_cannot_say_stands_with_its_values() {
        let late = json!([{ "id": "delay", "form": null, "parameters": {
            "T": { "value": 0.025, "unit": "s", "interval": [0.024, 0.026] } } }]);
        let mut document = document(late);
        document["joint"]["gain"] = json!({ "value": 1.1, "interval": [1.0, 1.2] });
        let told = &friction_tables(&document)[0].cannot_say;
        assert_eq!(told[0], "knee: delay (T = 0.0250 [0.0240, 0.0260] s)");
        assert!(told[1].starts_with("knee: gain = 1.10 [1.00, 1.20] of what is stated"), "{}", told[1]);
    }

    #[test]
    fn joints_without_a_friction_have_no_table() {
        let robot =
            json!({ "joints": { "a": document(json!([])), "b": { "joint": { "coulomb": { "value": null } } } } });
        let names: Vec<String> = friction_tables(&robot).into_iter().map(|table| table.joint).collect();
        assert_eq!(names, ["a"]);
        assert!(friction_tables(&json!({ "name": "dog", "joint": {} })).is_empty());
    }
}
