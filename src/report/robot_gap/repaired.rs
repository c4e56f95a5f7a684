//! The repaired robot as a file: the study's robot with the changes of the answer, for `walk --robot` and for a study's
//! `model`.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use toml::{Table, Value};

use crate::gap::robot::{Cause, Change, RobotCase};
use crate::geometry::robot_file::{ERS7_TOML, FRICTION_SET, GAIN_SET, JointFriction};
use crate::joint::EffectId;
use crate::log::{LogError, RobotScenario, RobotStudy};
use crate::robot::FloorParameters;

/// Name of the repaired robot's file.
pub const REPAIRED_FILE: &str = "repaired.toml";

/// The robot of a study with the changes of an answer, as a robot file.
///
/// The study's friction becomes the set `chosen`, its gains come before those of the set `printed`, its floor, in the
/// floor scenario, is written beside them. Coulomb and viscous friction of an answer stand in the set, a payload as
/// `[[attached]]`, the floor's changes in `[floor]`, everything else as `[[effect]]`. `sentence` opens the file.
///
/// # Errors
/// [`LogError`] where the study's robot file has gone, or has been spoilt, since it was read.
pub fn repaired_robot(case: &RobotCase, changes: &[Change], sentence: &str) -> Result<String, LogError> {
    let text = match &case.study.model_path {
        Some(path) => std::fs::read_to_string(path)
            .map_err(|source| LogError::Read { file: path.clone(), source })?
            .trim_start_matches('\u{feff}')
            .to_owned(),
        None => ERS7_TOML.to_owned(),
    };
    let file = case.study.model_path.clone().unwrap_or_else(|| "ers7.toml".into());
    let unread = |source| LogError::Toml { file, source: Box::new(source), hint: None };
    let mut robot: Table = toml::from_str(&text).map_err(unread)?;
    let model = &case.nominal.model;
    robot.insert("name".into(), format!("{}-repaired", model.name()).into());
    let friction = friction(case, changes);
    table(&mut robot, "friction").insert(FRICTION_SET.into(), friction.into());
    gains(&mut robot, &case.study);
    let names = |change: &Change| Value::Array(change.place.names(&case.names).into_iter().map(Value::from).collect());
    for change in changes {
        match change.cause {
            Cause::Effect(effect) => {
                let values = effect_values(case, effect, change);
                let named = effect.named_parameters().iter().map(|parameter| parameter.name.to_owned());
                let parameters: Table = named.zip(values.into_iter().map(Value::from)).collect();
                let mut entry = Table::new();
                entry.insert("id".into(), effect.id().into());
                entry.insert("joints".into(), names(change));
                entry.insert("parameters".into(), parameters.into());
                list(&mut robot, "effect").push(entry.into());
            }
            Cause::Payload => {
                let mut entry = Table::new();
                entry.insert("part".into(), model.bodies()[0].name.clone().into());
                entry.insert("mass_kg".into(), change.values[0].into());
                entry.insert("at_m".into(), vec![change.values[1], 0.0, change.values[2]].into());
                list(&mut robot, "attached").push(entry.into());
            }
            _ => {}
        }
    }
    if case.study.scenario == RobotScenario::Floor {
        let (floor, slope_rad) = floor(case, changes);
        robot.insert("floor".into(), floor.into());
        robot.insert("floor_slope_rad".into(), slope_rad.to_vec().into());
    }
    let body = toml::to_string(&robot).expect("a table of TOML values is TOML");
    Ok(header(case, changes, sentence) + &body)
}

fn header(case: &RobotCase, changes: &[Change], sentence: &str) -> String {
    let control = &case.study.control;
    let period = control.sample_period_s.map_or_else(String::new, |period_s| format!(" --control-period {period_s}"));
    let air = if case.study.scenario == RobotScenario::Air { " --air" } else { "" };
    let plain = |text: &str| -> String { text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect() };
    let mut text =
        "# The robot of a study as repaired by `aibo-fit gap`, in the format of data/ers7.toml.\n".to_owned();
    let _ = writeln!(text, "# {}", plain(sentence));
    for change in changes {
        let named = change.cause.named().into_iter().zip(&change.values);
        let values: Vec<String> = named.map(|((name, unit), value)| format!("{name} = {value} {unit}")).collect();
        let joints = change.place.names(&case.names).join(", ");
        let joints = if joints.is_empty() { String::new() } else { format!(" of {}", plain(&joints)) };
        let _ = writeln!(text, "# Changed: {}{joints}: {}", change.cause, values.join(", ").trim_end());
    }
    if changes.is_empty() {
        text.push_str("# Changed: nothing.\n");
    }
    let _ = writeln!(text, "# aibo-fit walk{air}{period} --robot {REPAIRED_FILE}");
    text
}

/// Friction of every joint that has any, as `[friction.chosen]`.
fn friction(case: &RobotCase, changes: &[Change]) -> Table {
    let model = &case.nominal.model;
    let mut rows: Vec<(String, JointFriction)> = Vec::new();
    for (id, joint) in model.joint_ids().zip(model.joints()) {
        let mut row = model.friction(FRICTION_SET, id).unwrap_or_default();
        let law = &case.nominal.joints.drive(id).chain.friction;
        (row.coulomb_nm, row.viscous_nm_s_rad) = (law.coulomb_nm, law.viscous_nm_s_rad);
        for change in changes.iter().filter(|change| change.place.joints.contains(&id.index())) {
            match change.cause {
                Cause::Coulomb => row.coulomb_nm = change.values[0],
                Cause::Viscous => row.viscous_nm_s_rad = change.values[0],
                _ => {}
            }
        }
        if row != JointFriction::default() {
            rows.push((joint.name.clone(), row));
        }
    }
    let column = |of: fn(&JointFriction) -> f64| -> Value {
        Value::Array(rows.iter().map(|(_, row)| Value::from(of(row))).collect())
    };
    let mut set = Table::new();
    set.insert("joints".into(), Value::Array(rows.iter().map(|(name, _)| Value::from(name.clone())).collect()));
    set.insert("coulomb_nm".into(), column(|row| row.coulomb_nm));
    set.insert("viscous_nm_s_rad".into(), column(|row| row.viscous_nm_s_rad));
    set.insert("static_nm".into(), column(|row| row.static_nm));
    set.insert("stribeck_rad_s".into(), column(|row| row.stribeck_rad_s));
    set.insert("steepness_s_rad".into(), column(|row| row.steepness_s_rad));
    set
}

/// The study's gains as `[gains.printed.si]`, before what the file has there.
fn gains(robot: &mut Table, study: &RobotStudy) {
    if study.control.gains.is_empty() {
        return;
    }
    let set = table(table(robot, "gains"), GAIN_SET);
    set.entry("shift").or_insert_with(|| Value::Array(vec![Value::Integer(0); 3]));
    let si = table(set, "si");
    let rows: BTreeMap<_, _> = study.control.gains.iter().collect();
    si.extend(rows.into_iter().map(|(joint, gains)| (joint.clone(), Value::from(gains.to_vec()))));
}

/// An effect's values as they act: static friction is never below the Coulomb friction that it comes on top of.
fn effect_values(case: &RobotCase, effect: EffectId, change: &Change) -> Vec<f64> {
    let mut values = change.values.clone();
    if effect == EffectId::Stribeck {
        let coulomb = case.nominal.model.joint_ids().filter(|id| change.place.joints.contains(&id.index()));
        let most = coulomb.map(|id| case.nominal.joints.drive(id).chain.friction.coulomb_nm).fold(0.0, f64::max);
        values[0] = values[0].max(most);
    }
    values
}

/// `[floor]` with the floor's changes, and its slope towards the front and the right.
fn floor(case: &RobotCase, changes: &[Change]) -> (Table, [f64; 2]) {
    let given = case.nominal.floor.as_ref().map_or_else(FloorParameters::default, |floor| *floor.parameters());
    let mut floor = given;
    let (_, mut slope_rad) = case.nominal.model.floor();
    for Change { cause, values, .. } in changes {
        match cause {
            Cause::FloorFriction => {
                floor.static_friction *= values[0] / floor.coulomb;
                floor.coulomb = values[0];
            }
            Cause::FloorSlope => slope_rad = [values[0], values[1]],
            Cause::FloorStiffness => floor.stiffness_n_m = values[0],
            _ => {}
        }
    }
    let rows = [
        ("stiffness", floor.stiffness_n_m),
        ("damping", floor.damping_n_s_m2),
        ("exponent", floor.exponent),
        ("static", floor.static_friction),
        ("coulomb", floor.coulomb),
        ("viscous", floor.viscous_s_m),
        ("steepness", floor.steepness_s_m),
        ("stribeck_speed", floor.stribeck_speed_m_s),
        ("torsion_radius", floor.torsion_radius_m),
    ];
    (rows.into_iter().map(|(key, value)| (key.to_owned(), Value::from(value))).collect(), slope_rad)
}

/// The table under a key, new where there is none.
fn table<'a>(of: &'a mut Table, key: &str) -> &'a mut Table {
    let value = of.entry(key).or_insert_with(|| Value::Table(Table::new()));
    if !value.is_table() {
        *value = Value::Table(Table::new());
    }
    value.as_table_mut().expect("it is a table now")
}

/// The list of tables under a key, new where there is none.
fn list<'a>(of: &'a mut Table, key: &str) -> &'a mut Vec<Value> {
    let value = of.entry(key).or_insert_with(|| Value::Array(Vec::new()));
    if !value.is_array() {
        *value = Value::Array(Vec::new());
    }
    value.as_array_mut().expect("it is a list now")
}
