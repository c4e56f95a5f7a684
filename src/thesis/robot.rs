//! Table 3.4 as a robot: `data/ers7.toml` with the masses and frictions that were found.

use super::{Printed, Row};
use std::fmt::Write;

/// A robot file in the format of `data/ers7.toml`: legs with the masses of `masses`, friction set `chosen` by `friction`.
///
/// What is not identifiable stays as printed. The inertias of the leg's parts are left to (3.1), which scales with mass.
pub(super) fn robot_toml(masses: &[&Row], friction: &[&Row]) -> String {
    let mut text = String::from(
        "# The ERS-7 of data/ers7.toml with the masses and the friction that `aibo-fit tables` found (Tables 3.2, 3.4).\n",
    );
    let mut part = String::new();
    let mut in_chosen = false;
    for line in include_str!("../../data/ers7.toml").lines() {
        if line.starts_with('#') {
            continue;
        }
        if line.starts_with('[') {
            (part, in_chosen) = (String::new(), line.starts_with("[friction.chosen]"));
        }
        if let Some(name) = line.strip_prefix("name = ") {
            part = name.trim_matches('"').to_owned();
        }
        let body = body_of(&part);
        let mass = body.and_then(|body| masses.iter().find(|row| row.identifiable && row.of.name() == body)?.ours);
        let replaced = if line.starts_with("mass_kg") {
            mass.map(|mass| format!("mass_kg = {mass:.6}"))
        } else if line.starts_with("inertia_kg_m2") && mass.is_some() {
            continue;
        } else if in_chosen && line.starts_with("coulomb_nm") {
            Some(format!("coulomb_nm = {:?}", by_joint(friction, "coulomb", |row| row.coulomb_nm)))
        } else if in_chosen && line.starts_with("viscous_nm_s_rad") {
            Some(format!("viscous_nm_s_rad = {:?}", by_joint(friction, "viscous", |row| row.viscous_nm_s_rad)))
        } else {
            None
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", replaced.as_deref().unwrap_or(line));
    }
    text
}

/// `shoulder` for `rf_shoulder`, and so on; nothing for what is no part of a leg.
fn body_of(part: &str) -> Option<&'static str> {
    let (leg, kind) = part.split_once('_')?;
    if !["lf", "rf", "lr", "rr"].contains(&leg) {
        return None;
    }
    [("shoulder", "shoulder"), ("upper", "upper leg"), ("lower", "lower leg")]
        .into_iter()
        .find(|(name, _)| *name == kind)
        .map(|(_, body)| body)
}

/// One value for each joint to the micro-unit; the printed one where none was found.
fn by_joint(friction: &[&Row], quantity: &str, printed: impl Fn(&super::FrictionRow) -> f64) -> Vec<f64> {
    let value = |row: &super::FrictionRow| {
        let found = friction.iter().find(|r| r.of.name() == row.joint.to_string() && r.quantity == quantity);
        let value = found.and_then(|r| r.ours).unwrap_or_else(|| printed(row));
        (value * 1e6).round() / 1e6
    };
    Printed::embedded().table_3_4.iter().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Model;
    use crate::thesis::Of;
    use std::path::Path;

    #[test]
    fn the_simulator_loads_the_robot_with_what_was_found() {
        let mass = Row::new(Of::Body("lower leg".into()), "mass", "all", "kg", None).estimated(0.0345, [0.03, 0.04]);
        let coulomb = Row::new(Of::Joint("q3".into()), "coulomb", "all", "N m", None).estimated(0.0201, [0.0, 0.1]);
        let text = robot_toml(&[&mass], &[&coulomb]);
        let robot = Model::from_toml(Path::new("robot.toml"), &text).expect("a robot file");
        assert_eq!(robot.bodies().len(), Model::ers7().bodies().len());
        assert!(text.contains("mass_kg = 0.034500") && text.contains("coulomb_nm = [0.001, 0.007, 0.0201]"), "{text}");
        assert_eq!(text.matches("mass_kg = 0.034500").count(), 4);
    }
}
