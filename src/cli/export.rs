//! `aibo-fit export`: a robot's description with what was found in it.

use super::CliError;
use super::common::{CommonArgs, json_text, print, study_name, warn, write_outputs};
use crate::log::{LogError, Outputs};
use crate::number::quantity;
use crate::report::{Quantity, friction_csv, friction_tables};
use crate::robot::description::{Description, FoundKey, FoundNumber, to_isaac, to_mjcf, to_pace, to_urdf};
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
    if let Some(repaired) = document["repaired"]["file"].as_str() {
        return Err(wrong(format!(
            "the diagnosis of a walking robot cannot be exported; `{repaired}` beside its report is its robot as found"
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
        });
    }
    let name = document["name"].as_str().ok_or_else(|| {
        wrong("found neither `found` (what gap --json writes of a robot) nor `name` and `joint` (a fit)".to_owned())
    })?;
    let number = |of: &str, key: FoundKey| {
        let quantity = &document["joint"][of];
        let interval =
            quantity["interval"].as_array().and_then(|ends| Some([ends.first()?.as_f64()?, ends.get(1)?.as_f64()?]));
        Some(FoundNumber {
            name: name.to_owned(),
            key,
            was: None,
            value: quantity["value"].as_f64()?,
            interval,
            unit: quantity["unit"].as_str()?.to_owned(),
            place_m: None,
        })
    };
    let numbers: Vec<FoundNumber> = [number("coulomb", FoundKey::Frictionloss), number("viscous", FoundKey::Damping)]
        .into_iter()
        .flatten()
        .collect();
    if numbers.is_empty() {
        return Err(wrong("`joint` has neither coulomb nor viscous with a value".to_owned()));
    }
    let effects = document["effects"].as_array().into_iter().flatten();
    let ids = effects.filter_map(|effect| effect["id"].as_str()).map(|id| format!("{name}: {id}"));
    let law = document["law"]["looks_like"].as_str().map(|like| format!("{name}: a law ({like})"));
    let links = ["inertia", "moment"].map(|of| format!("{name}: {of} as found (masses of the links are as described)"));
    let others = ["gain", "kd", "ki", "rest", "armature"].into_iter().filter_map(|of| unsaid(document, name, of));
    Ok(Found { model: None, numbers, cannot_say: ids.chain(law).chain(links).chain(others).collect() })
}

/// A number of a joint's fit that no description has a place for, where it is not as given: gains are factors of stated
/// ones, and of a rest angle that was held there is nothing to say.
fn unsaid(document: &Value, name: &str, of: &str) -> Option<String> {
    let found: Quantity = serde_json::from_value(document["joint"].get(of)?.clone()).ok()?;
    let value = found.value?;
    let is_factor = !["rest", "armature"].contains(&of);
    let given = document["beliefs"][of]["believed"].as_f64().or(is_factor.then_some(1.0));
    let is_as_given = given.map_or(!found.identifiable, |given| given == value);
    (!is_as_given).then(|| format!("{name}: {of} = {}", quantity(value, found.interval, &found.unit)))
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
}
