//! `aibo-fit simulate`: predicts the logs of a study from their start.

mod robot;

use super::CliError;
use super::common::{CommonArgs, log_name, print, study_name, write_outputs};
use super::progress::Progress;
use super::provenance::provenance;
use crate::fit::{Budget, Method};
use crate::gap::{GapModel, LogSet, reach_of};
use crate::identify::{
    Case, Experiment, Item, JointModel, Parameter, Prediction, Scale, WithLaws, conclude, name_from_file, predict,
};
use crate::joint::{EffectForm, EffectId, Law, UnknownEffect};
use crate::log::{LogError, Nominal, Outputs, Role, StudyKind, study_kind};
use crate::report::{EffectFit, FitFile, Quantity, SCHEMA};
use clap::Args;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Predict the logs of a study from their start, with given or fitted parameters
///
/// Only where each log starts is taken from the log itself: angle and speed as its first samples show them, or the instant of
/// release. Prints the RMS of each log and writes <log>.predicted.csv (t [s], q [rad], dq [rad/s], q_measured [rad]). The joints
/// of a robot with a clamped base are simulated all at once under the study's setpoints (t [s], <joint>.q [rad]).
#[derive(Args, Debug)]
#[command(after_help = "Example: aibo-fit simulate study.toml --fit fits/study/fit.json")]
pub(super) struct SimulateArgs {
    /// The study whose logs are predicted
    #[arg(value_name = "STUDY")]
    study: PathBuf,
    /// Parameters, effects and law found by drop or gap; of a robot what gap --json wrote [default: as the study says]
    #[arg(long, value_name = "FIT.json")]
    fit: Option<PathBuf>,
    /// Predict this log instead, by the study's joint and by what the study says of its first log
    #[arg(long, value_name = "LOG.csv")]
    log: Option<PathBuf>,
    #[command(flatten)]
    common: CommonArgs,
}

/// Parameters in force, and where they come from.
struct InForce {
    nominal: Nominal,
    /// Of every motor; `None`: as the study states it.
    armature_kg_m2: Option<f64>,
    rest_rad: Option<f64>,
    /// What arrives per stated torque, and the control law's gains per stated ones, by the names of their numbers.
    gains: Vec<(&'static str, f64)>,
    /// Effects with their values as they are searched.
    effects: Vec<InEffect>,
    /// What no effect describes.
    laws: Vec<Law<f64>>,
    source: String,
}

/// No number of a joint is larger, whatever its SI unit.
const LARGEST: f64 = 1e6;
/// Share by which a static friction that was written down may lie below the Coulomb friction.
const ROUNDING: f64 = 1e-9;

/// Runs the command.
pub(super) fn run(args: &SimulateArgs) -> Result<u8, CliError> {
    if args.log.is_none() && study_kind(&args.study)? == StudyKind::Clamped {
        return robot::run(args);
    }
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let mut case = match &args.log {
        Some(log) => Case::of_log_in_study(&args.study, log)?,
        None => Case::of_study(&args.study)?,
    };
    let in_force = in_force(args, &case)?;
    if let Some(armature_kg_m2) = in_force.armature_kg_m2 {
        let experiments = case.items.iter_mut().flat_map(|item| &mut item.experiments);
        experiments.filter_map(|e| e.motor.as_mut()).for_each(|motor| motor.armature_kg_m2 = armature_kg_m2);
    }
    progress.say("predicting");
    let predicted = args.common.on_threads(|| predictions(&case, &in_force))??;
    let folder = args.common.folder(&study_name(&args.study));
    let mut inputs = case.inputs();
    inputs.extend(args.fit.iter().cloned());
    let provenance = provenance(inputs.iter().cloned())?;
    let mut outputs = Outputs::default();
    let mut rows = Vec::new();
    let mut text = format!("{}: parameters from {}\n\n", case.joint.name, in_force.source);
    let _ = writeln!(text, "{:<40} {:<9} {:>8} {:>12}", "log", "role", "samples", "RMS [mrad]");
    for (item, prediction) in &predicted {
        let role = match item.entry.role {
            Role::Fit => "fit",
            Role::Validate => "validate",
        };
        if prediction.is_empty() {
            let _ = writeln!(text, "{:<40} {role:<9} {:>8} {:>12}", item.entry.file, item.log.len(), "never moves");
            rows.push(json!({ "file": item.entry.file, "role": role, "rms": null, "moved": false }));
            continue;
        }
        let csv = free_name(&outputs, &folder, &log_name(&item.entry.path));
        outputs.add(&csv, predicted_csv(item, prediction));
        let samples: usize = prediction.iter().map(|(e, _)| e.compared()).sum();
        let squares: f64 = prediction.iter().map(|(e, p)| p.rms_rad.powi(2) * e.compared() as f64).sum();
        let rms_rad = if let [(_, only)] = &prediction[..] { only.rms_rad } else { (squares / samples as f64).sqrt() };
        let criterion: f64 = prediction.iter().map(|(_, p)| p.criterion_rad2_s).sum();
        let _ = writeln!(text, "{:<40} {role:<9} {samples:>8} {:>12.3}", item.entry.file, 1e3 * rms_rad);
        for remark in &item.remarks {
            let _ = writeln!(text, "  {remark}");
        }
        rows.push(json!({ "file": item.entry.file, "role": role, "rms": rms_rad, "samples": samples,
            "criterion": criterion, "remarks": item.remarks, "predicted": csv.display().to_string() }));
    }
    let found = json!({
        "schema": SCHEMA, "joint": case.joint.name, "parameters": in_force.source, "logs": rows,
        "version": provenance.version, "command": provenance.command, "inputs": provenance.hashed(),
    });
    drop(progress);
    args.end(outputs, &inputs, &found, &text)
}

impl SimulateArgs {
    /// Writes what was predicted and says it.
    fn end(&self, mut outputs: Outputs, inputs: &[PathBuf], found: &Value, text: &str) -> Result<u8, CliError> {
        self.common.add_json(&mut outputs, found)?;
        write_outputs(outputs, inputs)?;
        if !self.common.quiet {
            print(text);
            print(&format!("\npredictions: {}\n", self.common.folder(&study_name(&self.study)).display()));
        }
        Ok(0)
    }
}

/// The parameters of the fit file, or of the study.
fn in_force(args: &SimulateArgs, case: &Case) -> Result<InForce, CliError> {
    let Some(path) = &args.fit else {
        let nominal = case.joint.nominal.ok_or_else(|| CliError::FitFile {
            file: args.study.clone(),
            what: "the study has no nominal model; give parameters with --fit".into(),
        })?;
        let source = format!("{}, as given", args.study.display());
        let (rest_rad, effects, laws) = (case.joint.rest_rad, Vec::new(), Vec::new());
        let (armature_kg_m2, gains) = (None, Vec::new());
        return Ok(InForce { nominal, armature_kg_m2, rest_rad, gains, effects, laws, source });
    };
    let file = read_fit(path)?;
    let wrong = |what: String| CliError::FitFile { file: path.clone(), what };
    if is_of_other_joint(&file, &case.joint.name) {
        let (own, joint, study) = (&file.name, &case.joint.name, args.study.display());
        return Err(wrong(format!(
            "the fit of joint `{own}`, expected that of `{joint}`, which {study} is of; where they are one joint, write its name \
             as `name` into the fit"
        )));
    }
    let number = |key: &str, quantity: &Quantity, zero_allowed: bool| match quantity.value {
        Some(v) if v < LARGEST && (v > 0.0 || v == 0.0 && zero_allowed) => Ok(v),
        Some(v) => Err(wrong(format!(
            "{key}.value is {v:?}, expected a number {} zero and below {LARGEST:e} in SI units",
            if zero_allowed { "not below" } else { "above" }
        ))),
        None => Err(wrong(format!(
            "{key}.value is null: this fit does not determine it; fit more logs, or write a value there"
        ))),
    };
    let nominal = if file.ratios.is_empty() {
        Nominal {
            inertia_kg_m2: number("joint.inertia", &file.joint.inertia, false)?,
            moment_kg_m: number("joint.moment", &file.joint.moment, true)?,
            coulomb_nm: number("joint.coulomb", &file.joint.coulomb, true)?,
            viscous_nm_s_rad: number("joint.viscous", &file.joint.viscous, true)?,
        }
    } else {
        // Only ratios are known: everything per unit of inertia moves the same.
        let ratio = |key: &str| {
            let quantity = file.ratios.get(key).ok_or_else(|| wrong(format!("ratios.{key} is missing")))?;
            number(&format!("ratios.{key}"), quantity, true)
        };
        Nominal {
            inertia_kg_m2: 1.0,
            moment_kg_m: ratio("moment_per_inertia")?,
            coulomb_nm: ratio("coulomb_per_inertia")?,
            viscous_nm_s_rad: ratio("viscous_per_inertia")?,
        }
    };
    let effects = effects(&file.effects, nominal.coulomb_nm).map_err(|what| wrong(format!("effects: {what}")))?;
    let laws = file.law.iter().map(|table| table.law().map_err(|bad| wrong(format!("law: {bad}"))));
    let laws = laws.collect::<Result<Vec<_>, _>>()?;
    let rest_rad = file.joint.rest.as_ref().and_then(|r| r.value).or(case.joint.rest_rad);
    if let Some(rest) = rest_rad.filter(|rest| !(rest.abs() <= std::f64::consts::TAU)) {
        return Err(wrong(format!("joint.rest.value is {rest:?}, expected an angle within 2 pi (6.283) rad")));
    }
    let armature = file.joint.armature.as_ref().map(|armature| number("joint.armature", armature, true));
    let armature_kg_m2 = armature.transpose()?;
    let share = |name: &str, share: &Option<Quantity>| {
        share.as_ref().map_or(Ok(1.0), |share| number(&format!("joint.{name}"), share, false))
    };
    let gains = [("gain", &file.joint.gain), ("kd", &file.joint.kd), ("ki", &file.joint.ki)];
    let gains = gains.into_iter().map(|(name, own)| share(name, own).map(|share| (name, share)));
    let gains = gains.collect::<Result<Vec<_>, _>>()?;
    let of = |law: &Law<f64>| format!(", with a law of the {} by {}", law.acts(), law.variable());
    let source = path.display().to_string() + &laws.iter().map(of).collect::<String>();
    Ok(InForce { nominal, armature_kg_m2, rest_rad, gains, effects, laws, source })
}

/// Whether a fit says that it is of another joint. One of logs without a study has their name, which says nothing.
fn is_of_other_joint(file: &FitFile, joint: &str) -> bool {
    let is_of_log = file.logs.iter().any(|log| name_from_file(Path::new(&log.file)).eq_ignore_ascii_case(&file.name));
    !file.name.is_empty() && file.name != joint && !is_of_log
}

/// An effect of a fit file.
#[derive(Debug, PartialEq)]
struct InEffect {
    form: EffectForm,
    /// Its values as they are searched.
    searched: Vec<f64>,
    /// Files of the logs in which it holds; empty: all.
    logs: Vec<String>,
}

/// The effects of a fit file with their values as they are searched, or what is wrong with them.
fn effects(fits: &[EffectFit], coulomb_nm: f64) -> Result<Vec<InEffect>, String> {
    let mut effects: Vec<InEffect> = Vec::new();
    for fit in fits {
        let family: EffectId = fit.id.parse().map_err(|unknown: UnknownEffect| unknown.to_string())?;
        let effect = EffectForm::named_so(family, fit.form.as_deref()).map_err(|unknown| unknown.to_string())?;
        if effects.iter().any(|other| other.form.id == family) {
            return Err(format!("{family} stands there twice"));
        }
        let named = named_values(effect, &fit.parameters)?;
        if family == EffectId::Stribeck && named[0] < coulomb_nm * (1.0 - ROUNDING) {
            let below = format!("below the Coulomb friction {coulomb_nm:?}");
            return Err(format!("{family} mu_st.value is {:?}, {below}; static friction is not less", named[0]));
        }
        effects.push(InEffect { form: effect, searched: effect.searched(&named, coulomb_nm), logs: fit.logs.clone() });
    }
    Ok(effects)
}

/// An effect's values in the catalogue's order, or what is wrong with them.
fn named_values(form: EffectForm, parameters: &BTreeMap<String, Quantity>) -> Result<Vec<f64>, String> {
    let (known, effect) = (form.named_parameters(), form.id);
    if let Some(other) = parameters.keys().find(|name| known.iter().all(|p| p.name != name.as_str())) {
        let names: Vec<&str> = known.iter().map(|p| p.name).collect();
        return Err(format!("{effect} has no parameter `{other}`; it has {}", names.join(", ")));
    }
    known
        .iter()
        .map(|p| {
            let quantity = parameters.get(p.name).ok_or_else(|| format!("{effect} lacks {}", p.name))?;
            let key = format!("{effect} {}.value", p.name);
            let unit = if p.unit.is_empty() { String::new() } else { format!(" {}", p.unit) };
            match quantity.value {
                Some(value) if p.bounds.admit(value) => Ok(value),
                Some(value) => Err(format!("{key} is {value:?}{unit}, expected {}{unit}", p.bounds)),
                None => Err(format!("{key} is null: this fit does not determine it; write a value there")),
            }
        })
        .collect()
}

/// `<log>.predicted.csv`, or with a number where another log of that name has it already.
fn free_name(outputs: &Outputs, folder: &Path, log: &str) -> PathBuf {
    let taken = |path: &PathBuf| outputs.paths().any(|other| other == path);
    let plain = folder.join(format!("{log}.predicted.csv"));
    let numbered = (2..).map(|n| folder.join(format!("{log}-{n}.predicted.csv")));
    std::iter::once(plain.clone()).chain(numbered).find(|path| !taken(path)).unwrap_or(plain)
}

fn read_fit(path: &Path) -> Result<FitFile, CliError> {
    const EXPECTED: &str = "expected a fit.json as `aibo-fit drop` or `aibo-fit gap` writes it";
    let bytes = fs::read(path).map_err(|source| LogError::Read { file: path.to_path_buf(), source })?;
    let wrong = |what: String| CliError::FitFile { file: path.to_path_buf(), what };
    let text = String::from_utf8(bytes).map_err(|_| wrong(format!("not UTF-8 text; {EXPECTED}")))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let any: serde_json::Value = serde_json::from_str(text).map_err(|error| wrong(format!("{error}; {EXPECTED}")))?;
    match any.get("schema") {
        Some(schema) if *schema == SCHEMA => {}
        Some(schema) => return Err(wrong(format!("schema is {schema}, expected {SCHEMA}, the only schema there is"))),
        None => return Err(wrong(format!("key `schema` is missing; {EXPECTED}"))),
    }
    if any.get("moved") == Some(&serde_json::Value::Bool(false)) {
        return Err(wrong("the joint never moved, so this holds no fit; leave --fit out, or fit another log".into()));
    }
    if any.get("found").is_some() && any.get("joints").is_some() {
        let what = "this is what `gap --json` wrote of a whole robot, expected the fit of one joint: fit.json in that joint's \
                    folder beside the robot's report";
        return Err(wrong(what.into()));
    }
    if any.get("verdict").is_some() {
        return Err(wrong(
            "this is what `gap --json` wrote, expected the fit.json beside the report of that run".into(),
        ));
    }
    serde_json::from_str(text).map_err(|error| wrong(format!("{error}; {EXPECTED}")))
}

/// A log, and its parts with what is predicted of each.
type Predicted<'a> = (&'a Item, Vec<(&'a Experiment, Prediction)>);

/// Predicts every log of a case; a log in which nothing moves has no prediction.
fn predictions<'a>(case: &'a Case, in_force: &InForce) -> Result<Vec<Predicted<'a>>, CliError> {
    let moving: Vec<Experiment> = case.items.iter().flat_map(|i| i.experiments.iter().cloned()).collect();
    let scale = Scale::of(&moving, Some(&in_force.nominal), in_force.rest_rad);
    let reach = reach_of(&moving, &in_force.nominal);
    let baseline = GapModel::baseline(&in_force.nominal, scale.rest_rad, &reach, &case.uncertain);
    let stated =
        |p: &Parameter| in_force.gains.iter().find(|(name, _)| *name == p.name).map_or(p.start, |(_, share)| *share);
    let mut values: Vec<f64> = baseline.parameters().iter().map(stated).collect();
    values.extend(in_force.effects.iter().flat_map(|effect| &effect.searched));
    let mut model = baseline;
    for (k, effect) in in_force.effects.iter().enumerate() {
        model = model.with(effect.form, &reach);
        if !effect.logs.is_empty() {
            model = model.only_in(k, Arc::new(LogSet { files: effect.logs.clone(), words: String::new() }));
        }
    }
    let mut model = WithLaws { model, laws: in_force.laws.clone() };
    for (p, value) in model.parameters_mut().iter_mut().zip(&values) {
        (p.start, p.fixed) = (*value, p.name != "rest" || in_force.rest_rad.is_some());
    }
    if in_force.rest_rad.is_none() && !moving.is_empty() {
        // Nobody states where the joint hangs: the logs say it.
        let fitted =
            conclude(&model, &moving, Method::Lm, Budget::default()).map_err(crate::identify::DropError::from)?;
        values = fitted.found.values;
    }
    case.items
        .iter()
        .map(|item| {
            let predicted = predict(&model, &item.experiments, &values)
                .map_err(|source| CliError::Diverged { file: item.entry.file.clone(), source })?;
            Ok((item, item.experiments.iter().zip(predicted).collect()))
        })
        .collect()
}

/// Times of the log, prediction and reading; what lies in its holes is not predicted.
fn predicted_csv(item: &Item, parts: &[(&Experiment, Prediction)]) -> String {
    let t0 = item.log.t_s[0];
    let mut text = String::from("t,q,dq,q_measured\n");
    let samples = parts.iter().flat_map(|(e, prediction)| (e.uncompared..e.t_s.len()).map(move |k| (e, prediction, k)));
    for (e, prediction, k) in samples {
        let (t, q, dq) = (t0 + e.t_s[k], prediction.angle_rad[k], prediction.rate_rad_s[k]);
        let _ = writeln!(text, "{t:.6},{q:.7},{dq:.6},{:.7}", e.measured_rad[k]);
    }
    text
}
