//! `aibo-fit simulate` on the study of a robot with a clamped base: all joints at once.

use super::super::CliError;
use super::super::common::{log_name, study_name, warn};
use super::super::progress::Progress;
use super::super::provenance::provenance;
use super::{SimulateArgs, free_name, named_values};
use crate::gap::clamped::{ClampedCaseError, ClampedSetup};
use crate::gap::whole::{PlacedCause, WholeRobot, found_robot, predicted_csv};
use crate::joint::{EffectForm, EffectId};
use crate::log::{DriveMode, LogError, Outputs, Role};
use crate::report::{Quantity, SCHEMA};
use crate::robot::description::{FoundKey, FoundNumber};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Runs the command.
pub(super) fn run(args: &SimulateArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let setup = ClampedSetup::read(&args.study)?;
    if !args.common.quiet {
        setup.description.warnings.iter().for_each(|warning| warn(warning));
    }
    let (numbers, causes, left_out) = match &args.fit {
        Some(fit) => found_in(fit)?,
        None => (found_robot(&setup, None).unwrap_or_default().numbers, Vec::new(), Vec::new()),
    };
    if let Some(error) = setup.without_gain() {
        return Err(error.into());
    }
    if let Some(fit) = &args.fit {
        refuse_other_robot(fit, &setup, &numbers, &causes)?;
    }
    let source = args.fit.as_ref().unwrap_or(&args.study).display().to_string();
    let cannot = |what| CliError::from(ClampedCaseError::NotSimulated { file: setup.study.model_path.clone(), what });
    let mut robot = WholeRobot::of(&setup, &numbers, &causes).map_err(cannot)?;
    let folder = args.common.folder(&study_name(&args.study));
    let mut inputs = setup.inputs();
    inputs.extend(args.fit.iter().cloned());
    let provenance = provenance(inputs.iter().cloned())?;
    let (mut outputs, mut rows) = (Outputs::default(), Vec::new());
    let mut text = format!("{}: parameters from {source}\n\n", setup.description.name);
    let _ = writeln!(text, "{:<40} {:<9} {:<20} {:>8} {:>12}", "log", "role", "joint", "samples", "RMS [mrad]");
    progress.say("simulating");
    for (entry, log) in setup.study.logs.iter().zip(&setup.logs) {
        let role = if entry.role == Role::Fit { "fit" } else { "validate" };
        if entry.drive != DriveMode::Position {
            let _ = writeln!(text, "{:<40} {role:<9} not driven by setpoints", entry.file);
            rows.push(json!({ "file": entry.file, "role": role, "rms": null }));
            continue;
        }
        let motion = args.common.on_threads(|| robot.readings(&setup, log))?.map_err(cannot)?;
        let csv = free_name(&outputs, &folder, &log_name(&entry.path));
        outputs.add(&csv, predicted_csv(log, &motion));
        let mut per_joint = BTreeMap::new();
        for (joint, motion) in log.joints.iter().zip(&motion) {
            let squares = joint.q_rad.iter().zip(motion).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            let rms_rad = (squares / log.len() as f64).sqrt();
            let (file, samples) = (&entry.file, log.len());
            let _ = writeln!(text, "{file:<40} {role:<9} {:<20} {samples:>8} {:>12.3}", joint.name, 1e3 * rms_rad);
            per_joint.insert(joint.name.clone(), rms_rad);
        }
        let squares: f64 = per_joint.values().map(|rms| rms * rms).sum();
        rows.push(json!({ "file": entry.file, "role": role, "rms": (squares / per_joint.len() as f64).sqrt(),
            "samples": log.len(), "per_joint": per_joint, "predicted": csv.display().to_string() }));
    }
    for what in &left_out {
        let _ = writeln!(text, "\nNot simulated: {what}.");
    }
    let found = json!({
        "schema": SCHEMA, "name": setup.description.name, "parameters": source, "logs": rows, "left_out": left_out,
        "version": provenance.version, "command": provenance.command, "inputs": provenance.hashed(),
    });
    drop(progress);
    args.end(outputs, &inputs, &found, &text)
}

/// Refuses what was found on another robot.
fn refuse_other_robot(
    fit: &Path,
    setup: &ClampedSetup,
    numbers: &[FoundNumber],
    causes: &[PlacedCause],
) -> Result<(), CliError> {
    let described = &setup.description;
    let (of_joints, of_links): (Vec<&FoundNumber>, Vec<&FoundNumber>) =
        numbers.iter().partition(|number| number.key.is_of_joint());
    let mut names = of_joints.iter().map(|number| &number.name).chain(causes.iter().map(|cause| &cause.joint));
    let joint = names.find(|name| described.joint(name).is_none());
    let link = of_links.iter().map(|number| &number.name).find(|name| described.link(name).is_none());
    let (what, name, known): (&str, &String, Vec<&str>) = match (joint, link) {
        (Some(name), _) => ("joint", name, described.joints.iter().map(|joint| joint.name.as_str()).collect()),
        (None, Some(name)) => ("link", name, described.links.iter().map(|link| link.name.as_str()).collect()),
        (None, None) => return Ok(()),
    };
    let model = setup.study.model_path.display();
    let what = format!("found on another robot: {model} has no {what} `{name}`, but {}", known.join(", "));
    Err(CliError::FitFile { file: fit.to_path_buf(), what })
}

/// Numbers and causes that `gap --json` wrote, and what of it is not simulated, in words.
type Found = (Vec<FoundNumber>, Vec<PlacedCause>, Vec<String>);

fn found_in(file: &Path) -> Result<Found, CliError> {
    let text = std::fs::read_to_string(file).map_err(|source| LogError::Read { file: file.to_path_buf(), source })?;
    let wrong = |what: String| CliError::FitFile { file: file.to_path_buf(), what };
    let document: Value = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let numbers = document.get("found").cloned().ok_or_else(|| {
        let expected = "expected what `aibo-fit gap --json` writes of a robot's study";
        let of_joint = document["name"].as_str().filter(|_| document["joint"].is_object());
        wrong(match of_joint {
            Some(joint) => format!("this is what was found on the joint `{joint}` alone; {expected}"),
            None => format!("key `found` is missing; {expected}"),
        })
    })?;
    let numbers: Vec<FoundNumber> =
        serde_json::from_value(numbers).map_err(|error| wrong(format!("`found`: {error}")))?;
    let of_whole = document["gap"]["whole"]["left_out"].as_array();
    let dropped: Vec<&str> = of_whole.into_iter().flatten().filter_map(|left| left["joint"].as_str()).collect();
    let (mut causes, mut left_out) = (Vec::new(), Vec::new());
    for (joint, own) in document["joints"].as_object().into_iter().flatten() {
        if own["law"].is_object() {
            left_out.push(format!("{joint}: a law"));
        }
        for effect in own["effects"].as_array().into_iter().flatten() {
            let bad = |what: String| wrong(format!("joints.{joint}.effects: {what}"));
            let id: EffectId =
                effect["id"].as_str().unwrap_or_default().parse().map_err(|unknown| bad(format!("{unknown}")))?;
            let form = EffectForm::named_so(id, effect["form"].as_str()).map_err(|unknown| bad(unknown.to_string()))?;
            // Springs and limits of the default form stand among the numbers, and a gain that was found as one is in kp.
            let is_in_kp = || {
                let has_kp = |number: &FoundNumber| number.key == FoundKey::Kp && number.name == *joint;
                own["joint"]["gain"].is_object() && numbers.iter().any(has_kp)
            };
            let is_number = match id {
                EffectId::JointSpring | EffectId::TorqueLimit => form.is_default(),
                EffectId::MotorGain => is_in_kp(),
                _ => false,
            };
            if is_number {
                continue;
            }
            let in_some = effect["logs"].as_array().is_some_and(|logs| !logs.is_empty());
            if in_some || !id.is_known_to_robots() || dropped.contains(&joint.as_str()) {
                left_out.push(format!("{joint}: {form}{}", if in_some { " in some logs" } else { "" }));
                continue;
            }
            let parameters: BTreeMap<String, Quantity> = serde_json::from_value(effect["parameters"].clone())
                .map_err(|error| bad(format!("{form}: {error}")))?;
            let values = named_values(form, &parameters).map_err(bad)?;
            causes.push(PlacedCause { joint: joint.clone(), form, values, spreads: Vec::new() });
        }
    }
    Ok((numbers, causes, left_out))
}
