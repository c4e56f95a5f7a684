//! `aibo-fit export`: a robot's description with what was found in it.

use super::CliError;
use super::common::{CommonArgs, json_text, print, study_name, warn, write_outputs};
use crate::log::{LogError, Outputs};
use crate::number::quantity;
use crate::report::{DriveGains, EffectFit, Quantity, friction_csv, friction_tables};
use crate::robot::description::{Actuator, Description, FoundKey, FoundNumber, to_isaac, to_mjcf, to_pace, to_urdf};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Write a robot's description with what a diagnosis or a fit found
///
/// Numbers that logs put elsewhere (friction, armature, servo gains and limits, springs, masses, payloads) are written
/// where the format has them, each marked by a comment with its 95 % interval and what it was; what the format cannot say
/// is listed. Looks and contacts are not written.
#[derive(Args, Debug)]
#[command(
    after_help = "Reads what `gap --json` wrote of a robot's study (its description is known from there), or a joint's \
fit.json with --model; a joint of that name has to be in the description. --to table takes what gap --json wrote of a joint, too.\nUnits are SI; exit code 3 where numbers and \
description do not fit.\n\nExample: aibo-fit export gap.json --to mjcf --out exported"
)]
pub(super) struct ExportArgs {
    /// What gap --json wrote, or a joint's fit.json
    #[arg(value_name = "FIT|DIAGNOSIS")]
    file: PathBuf,
    /// The format to write
    #[arg(long, value_enum)]
    to: Format,
    /// The description to put it into [default: the diagnosis's own]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    #[command(flatten)]
    common: CommonArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// MuJoCo's XML
    Mjcf,
    /// ROS's XML
    Urdf,
    /// Actuators of Isaac Lab, as Python
    Isaac,
    /// Parameters of PACE, as YAML
    Pace,
    /// Friction over speed with its interval, as CSV and JSON, for any simulator; needs no description
    Table,
    /// The changed numbers alone
    Json,
}

/// What is put into a description.
struct Found {
    model: Option<PathBuf>,
    numbers: Vec<FoundNumber>,
    cannot_say: Vec<String>,
    /// Whether it is a joint's fit, which knows of no description.
    is_of_fit: bool,
}

impl Found {
    /// A joint's fit with what a description has of its numbers; what that has no place for goes among the words.
    fn beside(self, described: &Description) -> Self {
        let has_servo = self.numbers.iter().any(|number| number.key == FoundKey::Kp);
        let (mut numbers, mut cannot_say) = (Vec::new(), self.cannot_say);
        for number in self.numbers {
            let of = |key: FoundKey| described_as(described, &number.name, key);
            let has_no_place = match number.key {
                FoundKey::TorqueLimit => !has_servo && of(FoundKey::Kp).is_none(),
                FoundKey::Stiffness | FoundKey::Springref => of(FoundKey::Stiffness).is_some_and(|k| k != 0.0),
                _ => false,
            };
            let was = of(number.key);
            if has_no_place {
                cannot_say.push(format!("{}: {}", number.name, number.words()));
            } else if number.interval.is_some() || was != Some(number.value) {
                numbers.push(FoundNumber { was, ..number });
            }
        }
        Self { numbers, cannot_say, ..self }
    }
}

/// What a description has of a joint's number; `None`: nothing, or no such joint.
fn described_as(described: &Description, joint: &str, key: FoundKey) -> Option<f64> {
    let at = described.joint(joint)?;
    let mover = &described.joints[at.0];
    let servo = || described.actuators.iter().filter(|driver| driver.joint == at).find_map(Actuator::as_servo);
    match key {
        FoundKey::Frictionloss => Some(mover.friction_nm),
        FoundKey::Damping => Some(mover.damping[0]),
        FoundKey::Armature => Some(mover.armature_kg_m2),
        FoundKey::Stiffness => Some(mover.stiffness[0]),
        FoundKey::Kp => servo().map(|servo| servo.gain),
        FoundKey::Kd => servo().map(|servo| -servo.bias[2]),
        FoundKey::TorqueLimit => servo().and_then(|servo| servo.force_range_nm).map(|[_, high]| high),
        _ => None,
    }
}

/// Runs the command.
pub(super) fn run(args: &ExportArgs) -> Result<u8, CliError> {
    let document = read_document(&args.file)?;
    if args.to == Format::Table {
        return friction(args, &document);
    }
    let found = read(&args.file, &document)?;
    let model = match (&args.model, &found.model) {
        (Some(model), _) => model.clone(),
        (None, Some(named)) => description(&args.file, named)?,
        (None, None) => {
            let why = format!("{} says of no description; add --model FILE", args.file.display());
            return Err(CliError::Usage(why));
        }
    };
    let described = Description::read(&model)?.with_equalities();
    if !args.common.quiet {
        described.warnings.iter().for_each(|warning| warn(warning));
    }
    let wrong = |what: String| CliError::FitFile { file: args.file.clone(), what };
    let found = if found.is_of_fit { found.beside(&described) } else { found };
    let changed = described.with_found(&found.numbers).map_err(|error| wrong(error.to_string()))?;
    let mut cannot_say = found.cannot_say;
    cannot_say.extend(described.left_out.iter().cloned());
    cannot_say.extend(
        found
            .numbers
            .iter()
            // Static friction stands there with its curve already.
            .filter(|number| !says(args.to, number.key) && number.key != FoundKey::StaticFriction)
            .map(|number| format!("{}: {}", number.name, number.words())),
    );
    cannot_say.extend(match args.to {
        Format::Mjcf => without_gear(&described, &changed),
        Format::Pace => late_alone(&changed, &found.numbers),
        _ => Vec::new(),
    });
    let said: Vec<FoundNumber> = found.numbers.iter().filter(|number| says(args.to, number.key)).cloned().collect();
    let (name, text) = match args.to {
        Format::Mjcf => ("robot.xml", to_mjcf(&changed, &said)),
        Format::Urdf => {
            let text = to_urdf(&changed, &said).map_err(|what| wrong(format!("URDF cannot say this robot: {what}")))?;
            ("robot.urdf", text)
        }
        Format::Isaac => {
            let text = to_isaac(&changed, &found.numbers);
            ("isaac.py", text.map_err(|what| wrong(format!("Isaac Lab's actuators cannot say this robot: {what}")))?)
        }
        Format::Pace => {
            let text = to_pace(&changed, &found.numbers);
            ("pace.yaml", text.map_err(|what| wrong(format!("PACE's parameters cannot say this robot: {what}")))?)
        }
        // Friction alone is written without a description.
        Format::Table | Format::Json => {
            let document = json!({ "schema": 1, "model": model, "found": found.numbers, "cannot_say": cannot_say });
            let text = serde_json::to_string_pretty(&document).map_err(|error| CliError::Encode(error.to_string()))?;
            ("robot.json", text + "\n")
        }
    };
    let path = args.common.folder(&study_name(&args.file)).join(name);
    let mut outputs = Outputs::default();
    outputs.add(path.clone(), text);
    let document = json!({
        "schema": 1, "file": path, "model": model, "found": found.numbers, "cannot_say": cannot_say,
    });
    args.common.add_json(&mut outputs, &document)?;
    let mut inputs = vec![args.file.clone()];
    inputs.extend(described.files.iter().cloned());
    write_outputs(outputs, &inputs)?;
    if !args.common.quiet {
        for number in found.numbers.iter().filter(|number| says(args.to, number.key)) {
            print(&format!("{}: {}\n", number.name, number.words()));
        }
        if !cannot_say.is_empty() {
            print("\nNot in this format:\n");
            cannot_say.iter().for_each(|what| print(&format!("- {what}\n")));
        }
        print(&format!("\nwritten: {}\n", path.display()));
    }
    Ok(0)
}

/// Servos that are written without their gear, as numbers of studies are: their setpoints are angles of the joint then.
fn without_gear(described: &Description, changed: &Description) -> Vec<String> {
    let is_without = |own: &&Actuator| {
        let written = changed.actuators.iter().find(|other| other.joint == own.joint && other.name == own.name);
        own.gear != 1.0 && written.is_some_and(|written| written.gear == 1.0)
    };
    let told = described.actuators.iter().filter(is_without).map(|own| {
        let joint = &described.joints[own.joint.0].name;
        format!("{joint}: gear {} of its servo, which is in kp and kd: its control is the joint's angle here", own.gear)
    });
    told.collect()
}

/// Joints that alone are late, where the format has one delay for all.
fn late_alone(described: &Description, found: &[FoundNumber]) -> Vec<String> {
    let late: Vec<&FoundNumber> = found.iter().filter(|number| number.key == FoundKey::Delay).collect();
    let driven = |joint: &str| described.actuators.iter().any(|own| described.joints[own.joint.0].name == joint);
    let others = described.joints.iter().filter(|joint| driven(&joint.name));
    let is_all = others.clone().all(|joint| late.iter().any(|number| number.name == joint.name));
    match late[..] {
        [] => Vec::new(),
        _ if is_all => Vec::new(),
        _ => {
            let names: Vec<&str> = late.iter().map(|number| number.name.as_str()).collect();
            vec![format!("a delay of {} alone: it is written for all joints, as the format has one", names.join(", "))]
        }
    }
}

/// The description that a diagnosis names: from here, or from the diagnosis's own folder.
fn description(file: &Path, named: &Path) -> Result<PathBuf, CliError> {
    let beside = file.parent().unwrap_or(Path::new("")).join(named);
    // Where both are one path its reader says what is wrong with it.
    if named.exists() || beside == named {
        return Ok(named.to_path_buf());
    }
    if beside.exists() {
        return Ok(beside);
    }
    Err(CliError::NoDescription { file: file.to_path_buf(), named: named.to_path_buf(), beside })
}

/// Whether a format has a word for a number.
fn says(format: Format, key: FoundKey) -> bool {
    use FoundKey::{Armature, Damping, Delay, EncoderZero, Frictionloss, Kd, Kp, Springref, Stiffness};
    match format {
        Format::Table | Format::Json => true,
        Format::Mjcf => key.is_described(),
        Format::Urdf => key.is_described() && !matches!(key, Armature | Kd | Kp | Springref | Stiffness),
        Format::Isaac => key.is_of_joint() && !matches!(key, EncoderZero | Springref | Stiffness),
        Format::Pace => matches!(key, Armature | Damping | Frictionloss | EncoderZero | Delay | Kp | Kd),
    }
}

/// Writes the friction of joints as tables over their speed.
fn friction(args: &ExportArgs, document: &Value) -> Result<u8, CliError> {
    let tables = friction_tables(document);
    if tables.is_empty() {
        let what = "expected `joint` with coulomb and viscous (a fit, or what gap --json wrote of a joint or an arm)";
        return Err(CliError::FitFile { file: args.file.clone(), what: what.to_owned() });
    }
    let folder = args.common.folder(&study_name(&args.file));
    let all = json!({ "schema": 1, "tables": tables });
    let mut outputs = Outputs::default();
    outputs.add(folder.join("friction.csv"), friction_csv(&tables));
    outputs.add(folder.join("friction.json"), json_text(&all)?);
    args.common.add_json(&mut outputs, &all)?;
    write_outputs(outputs, std::slice::from_ref(&args.file))?;
    if !args.common.quiet {
        for table in &tables {
            let top = table.speed_rad_s.last().copied().unwrap_or_default();
            print(&format!("{}: friction up to {top:.3} rad/s\n", table.joint));
        }
        let cannot_say: Vec<&String> = tables.iter().flat_map(|table| &table.cannot_say).collect();
        if !cannot_say.is_empty() {
            print("\nNot in this format:\n");
            cannot_say.iter().for_each(|what| print(&format!("- {what}\n")));
        }
        print(&format!("\nwritten: {}\n", folder.join("friction.csv").display()));
    }
    Ok(0)
}

fn read_document(file: &Path) -> Result<Value, CliError> {
    let text = std::fs::read_to_string(file).map_err(|source| LogError::Read { file: file.to_path_buf(), source })?;
    let wrong = |what: String| CliError::FitFile { file: file.to_path_buf(), what };
    let document: Value = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    if document["schema"] != 1 {
        return Err(wrong("`schema` is not 1".to_owned()));
    }
    if let Some(repaired) = document.get("repaired") {
        let as_found = repaired["file"].as_str();
        let as_found = as_found.map(|file| format!("; `{file}` beside its report is its robot as found"));
        return Err(wrong(format!(
            "the diagnosis of a walking robot cannot be exported{}",
            as_found.unwrap_or_default()
        )));
    }
    Ok(document)
}

fn read(file: &Path, document: &Value) -> Result<Found, CliError> {
    let wrong = |what: String| CliError::FitFile { file: file.to_path_buf(), what };
    if let Some(numbers) = document.get("found") {
        let numbers = serde_json::from_value(numbers.clone()).map_err(|error| wrong(format!("`found`: {error}")))?;
        let said = document["cannot_say"].as_array().into_iter().flatten();
        return Ok(Found {
            model: document["model"].as_str().map(PathBuf::from),
            numbers,
            cannot_say: said.filter_map(|what| what.as_str().map(str::to_owned)).collect(),
            is_of_fit: false,
        });
    }
    if document.get("verdict").is_some() {
        return Err(wrong(
            "this is what gap --json writes of a joint; its fit is in `fit.json`, in the folder of the report"
                .to_owned(),
        ));
    }
    let name = document["name"].as_str().ok_or_else(|| {
        wrong("found neither `found` (what gap --json writes of a robot) nor `name` and `joint` (a fit)".to_owned())
    })?;
    let joint = |of: &str| serde_json::from_value::<Quantity>(document["joint"].get(of)?.clone()).ok();
    let number = |of: &str, key: FoundKey| number(name, key, &joint(of)?);
    let friction = [number("coulomb", FoundKey::Frictionloss), number("viscous", FoundKey::Damping)];
    let mut numbers: Vec<FoundNumber> = friction.into_iter().flatten().collect();
    if numbers.is_empty() {
        return Err(wrong("`joint` has neither coulomb nor viscous with a value".to_owned()));
    }
    numbers.extend(number("armature", FoundKey::Armature));
    let effects = document["effects"].as_array().into_iter().flatten();
    let effects: Vec<(&str, Option<EffectFit>)> = effects
        .filter_map(|effect| Some((effect["id"].as_str()?, serde_json::from_value(effect.clone()).ok())))
        .collect();
    let mut cannot_say = Vec::new();
    let is_gain = |effect: &EffectFit| effect.id == "motor_gain" && effect.logs.is_empty();
    let gain_named = effects.iter().filter_map(|(_, effect)| effect.as_ref()).find(|effect| is_gain(effect));
    let gain = gain_named.and_then(|effect| effect.parameters.get("c").cloned()).or_else(|| joint("gain"));
    let drive = document.get("drive").and_then(|drive| serde_json::from_value::<DriveGains>(drive.clone()).ok());
    if let Some(drive) = &drive {
        numbers.extend(gains(name, drive, gain.as_ref(), joint("kd").as_ref()));
    }
    for (id, effect) in &effects {
        let said = effect.as_ref().map(|effect| numbers_of(name, effect)).unwrap_or_default();
        let is_said = drive.is_some() && effect.as_ref().is_some_and(is_gain);
        // How static friction fades no format says.
        if !is_said && (said.is_empty() || *id == "stribeck") {
            let words = effect.as_ref().map_or_else(|| (*id).to_owned(), EffectFit::words);
            cannot_say.push(format!("{name}: {words}"));
        }
        numbers.extend(said);
    }
    cannot_say.extend(document["law"]["looks_like"].as_str().map(|like| format!("{name}: a law ({like})")));
    let links = ["inertia", "moment"].into_iter().filter_map(|of| {
        let found = joint(of)?;
        let found = quantity(found.value?, found.interval, &found.unit);
        Some(format!("{name}: {of} = {found} (masses of the links are as described)"))
    });
    cannot_say.extend(links);
    let others = if drive.is_some() { &["ki", "rest"][..] } else { &["gain", "kd", "ki", "rest"] };
    cannot_say.extend(others.iter().filter_map(|of| unsaid(document, name, of)));
    Ok(Found { model: None, numbers, cannot_say, is_of_fit: true })
}

/// A number of a fit as one of a description; what that has, nobody knows yet.
fn number(name: &str, key: FoundKey, of: &Quantity) -> Option<FoundNumber> {
    let (interval, unit) = (of.interval, of.unit.clone());
    Some(FoundNumber { name: name.to_owned(), key, was: None, value: of.value?, interval, unit, place_m: None })
}

/// Gains of a servo beside which its joint's friction was found: those that the study states, times what was found of them.
fn gains(name: &str, stated: &DriveGains, gain: Option<&Quantity>, kd: Option<&Quantity>) -> Vec<FoundNumber> {
    let value = |of: Option<&Quantity>| of.and_then(|of| of.value).unwrap_or(1.0);
    let around = |of: Option<&Quantity>, times: f64| of?.interval.map(|ends| ends.map(|end| end * times));
    let (times, share) = (value(gain), value(kd));
    let found = |key: FoundKey, value: f64, interval: Option<[f64; 2]>, unit: &str| {
        number(name, key, &Quantity { value: Some(value), unit: unit.to_owned(), interval, ..Quantity::default() })
    };
    let (kp_nm_rad, kd_nm_s_rad) = (stated.kp_nm_rad, stated.kd_nm_s_rad);
    let of_kd = around(kd, times * kd_nm_s_rad).or_else(|| around(gain, share * kd_nm_s_rad));
    let of_kd = of_kd.filter(|_| kd_nm_s_rad > 0.0);
    let kp = found(FoundKey::Kp, times * kp_nm_rad, around(gain, kp_nm_rad), "N m/rad");
    let kd = found(FoundKey::Kd, times * share * kd_nm_s_rad, of_kd, "N m s/rad");
    kp.into_iter().chain(kd).collect()
}

/// What some format has a word for of an effect; nothing of one that holds in some logs only.
fn numbers_of(name: &str, effect: &EffectFit) -> Vec<FoundNumber> {
    let words: &[(&str, FoundKey)] = match (effect.id.as_str(), effect.parameters.len()) {
        _ if !effect.logs.is_empty() => &[],
        ("delay", 1) => &[("T", FoundKey::Delay)],
        ("angle_offset", 1) => &[("d", FoundKey::EncoderZero)],
        ("joint_spring", 2) => &[("k", FoundKey::Stiffness), ("q_s", FoundKey::Springref)],
        ("torque_limit", _) => &[("tau_max", FoundKey::TorqueLimit)],
        ("stribeck", _) => &[("mu_st", FoundKey::StaticFriction)],
        _ => &[],
    };
    let found = words.iter().map(|(parameter, key)| number(name, *key, effect.parameters.get(*parameter)?));
    // Half of a spring is none.
    found.collect::<Option<Vec<FoundNumber>>>().unwrap_or_default()
}

/// A number of a joint's fit that no description has a place for, where it is not as given: gains are factors of stated
/// ones, and of a rest angle that was held there is nothing to say.
fn unsaid(document: &Value, name: &str, of: &str) -> Option<String> {
    let found: Quantity = serde_json::from_value(document["joint"].get(of)?.clone()).ok()?;
    let value = found.value?;
    let is_factor = of != "rest";
    let given = document["beliefs"][of]["believed"].as_f64().or(is_factor.then_some(1.0));
    let is_as_given = given.map_or(!found.identifiable, |given| given == value);
    let beside = if of == "gain" { " of what is stated, beside which this friction was found" } else { "" };
    (!is_as_given).then(|| format!("{name}: {of} = {}{beside}", quantity(value, found.interval, &found.unit)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_joints_fit_has_beyond_friction_is_listed() {
        let number =
            |value: f64, identifiable: bool| json!({ "value": value, "unit": "1", "identifiable": identifiable });
        let document = json!({
            "name": "knee", "law": { "looks_like": "a ripple" }, "beliefs": { "ki": { "believed": 0.9 } },
            "joint": {
                "coulomb": number(0.1, true), "gain": number(0.8, true), "kd": number(1.0, false), "ki": number(0.9, true),
                "rest": number(0.02, true),
            },
        });
        let told = read(Path::new("fit.json"), &document).unwrap().cannot_say.join("\n");
        for part in ["knee: a law (a ripple)", "knee: gain = 0.8", "knee: rest = 0.02"] {
            assert!(told.contains(part), "{part} not in {told}");
        }
        assert!(!told.contains("kd") && !told.contains("ki"), "{told}");
    }

    const ARM: &str = r#"<mujoco><worldbody><body name="a"><joint name="knee" frictionloss=".04"/>
        <geom size=".1" mass="1"/></body></worldbody><actuator><position joint="knee" kp="12" kv=".3"/></actuator></mujoco>"#;

    fn fit(drive: &Value, effects: &Value) -> Found {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("arm.xml");
        std::fs::write(&file, ARM).unwrap();
        let quantity = |value: f64, half: f64, unit: &str| {
            let interval = [value - half, value + half];
            json!({ "value": value, "unit": unit, "interval": interval, "identifiable": true })
        };
        let joint = json!({ "coulomb": quantity(0.03, 0.002, "N m"), "gain": quantity(1.1, 0.1, ""),
            "kd": quantity(0.5, 0.1, ""), "inertia": quantity(0.02, 0.001, "kg m^2") });
        let document = json!({ "name": "knee", "drive": drive, "effects": effects, "joint": joint });
        read(Path::new("fit.json"), &document).unwrap().beside(&Description::read(&file).unwrap())
    }

    fn late() -> Value {
        json!([{ "id": "delay", "parameters": { "T": { "value": 0.025, "unit": "s", "interval": [0.024, 0.026] } } }])
    }

    /// Friction was once written without the gain beside which it was found, "not described" said of what the description has, and
    /// the delay listed without its value.
    #[test]
    fn a_joints_fit_is_written_with_the_gain_beside_which_its_friction_was_found() {
        let found = fit(&json!({ "kp_nm_rad": 10.0, "kd_nm_s_rad": 0.2 }), &late());
        let words: Vec<String> = found.numbers.iter().map(FoundNumber::words).collect();
        let expected = [
            "frictionloss 0.0300 [0.0280, 0.0320] N m, was 0.04",
            "kp 11.0 [10.0, 12.0] N m/rad, was 12",
            "kd 0.110 [0.088, 0.132] N m s/rad, was 0.3",
            "delay 0.0250 [0.0240, 0.0260] s, not described",
        ];
        assert_eq!(words, expected);
        assert_eq!(
            found.cannot_say,
            ["knee: inertia = 0.0200 [0.0190, 0.0210] kg m^2 (masses of the links are as described)"]
        );
        assert!(says(Format::Isaac, FoundKey::Delay) && !says(Format::Mjcf, FoundKey::Delay));
    }

    #[test]
    fn where_nothing_states_the_gains_they_are_listed_as_factors() {
        let found = fit(&Value::Null, &json!([]));
        assert!(found.numbers.iter().all(|number| number.key == FoundKey::Frictionloss));
        let told = found.cannot_say.join("\n");
        assert!(told.contains("knee: gain = 1.10 [1.00, 1.20] of what is stated, beside which"), "{told}");
        assert!(told.contains("knee: kd = 0.50 [0.40, 0.60]"), "{told}");
    }

    #[test]
    fn what_no_format_says_of_effects_is_listed_with_its_values() {
        let effects = json!([
            { "id": "backlash", "parameters": { "b": { "value": 0.02, "unit": "rad", "interval": [0.01, 0.03] } } },
            { "id": "torque_limit", "form": "hard", "parameters": { "tau_max": { "value": 0.7, "unit": "N m" } } },
            { "id": "delay", "logs": ["a.csv"], "parameters": { "T": { "value": 0.02, "unit": "s" } } },
            { "id": "gremlins" }
        ]);
        let found = fit(&Value::Null, &effects);
        assert!(found.numbers.iter().any(|number| number.key == FoundKey::TorqueLimit));
        assert!(!found.numbers.iter().any(|number| number.key == FoundKey::Delay));
        for words in ["knee: backlash (b = 0.020 [0.010, 0.030] rad)", "knee: delay (T = 0.0200 s) in a.csv only"] {
            assert!(found.cannot_say.contains(&words.to_owned()), "{words}: {:?}", found.cannot_say);
        }
        assert!(found.cannot_say.contains(&"knee: gremlins".to_owned()), "{:?}", found.cannot_say);
    }
}
