//! `aibo-fit drop`: fits the simple and the extensive pendulum to logged swings.

use super::CliError;
use super::common::{CommonArgs, json_text, log_name, print, study_name, warn, write_outputs};
use super::demands::DemandArgs;
use super::error::NOT_CONVERGED;
use super::progress::Progress;
use super::provenance::provenance;
use super::still::never_moved;
use crate::fit::{Budget, Method, Stop};
use crate::gap::neighbours::Repeated;
use crate::identify::{Case, DropError, DropFit, DropOptions, Item, fit_drop};
use crate::log::{DriveMode, Outputs};
use crate::report::{DropReport, FitFile, FullDrop, drop_report, drop_text, figures, render_html};
use crate::robot::Model;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Fit the simple and the extensive pendulum to logged swings of a joint
///
/// Reads LOGs (CSV: t [s], q [rad], optional drive, q_ref, tau) with the sidecar NAME.toml and pose.toml beside them,
/// or a study with several logs. Prints a table, and writes report.html, the figures as SVG, fit.json and fit.toml.
#[derive(Args, Debug)]
#[command(after_help = "Parameters: inertia [kg m^2], moment [kg m], coulomb [N m], viscous [N m s/rad], rest [rad]; \
legs of the ERS-7: mass_shoulder, mass_upper_leg, mass_lower_leg [kg], zero [rad]; \
simple model: b_over_ml2 [1/s], g_over_l [1/s^2].\n\n\
Sidecar and study, all keys with units and defaults in docs/reference/study.md: schema = 1; [joint] name, inertia, moment, coulomb, \
viscous, gravity, rest; [sensor] resolution, period; [motor] kp, ki, kd, hold, torque_limit, model, encoder, armature, ...; \
[uncertain]; [[log]] file, role, drive, session, tau_is, motor, extra. A log with a varying q_ref or tau needs a sidecar or \
study that states its drive: \"position\" (needs [motor]), \"torque\", or \"off\".\n\nExample: aibo-fit drop data/q1.csv")]
pub(super) struct DropArgs {
    /// Logs of one joint, fitted together
    #[arg(value_name = "LOG", required_unless_present = "study", conflicts_with = "study")]
    logs: Vec<PathBuf>,
    /// A study: nominal model and logs in one TOML file
    #[arg(long, value_name = "FILE")]
    study: Option<PathBuf>,
    /// The joint: q1, q2 or q3 of an ERS-7 leg, or any other name [default: from sidecar or file name]
    #[arg(long, value_name = "NAME", conflicts_with = "study", value_parser = joint_name)]
    joint: Option<String>,
    /// How to search
    #[arg(long, value_enum, default_value_t = MethodArg::Lm)]
    method: MethodArg,
    #[command(flatten)]
    demands: DemandArgs,
    /// Friction by (3.11): static friction above Coulomb's and a Stribeck speed
    #[arg(long)]
    stribeck: bool,
    /// The robot that repeats the drop, in the format of data/ers7.toml: what hangs on it, its gains and its effects; the
    /// leg's masses and the joint's friction are the fit's [default: the embedded ERS-7]
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// Fit inertia and moment of the link even where its bodies are known
    #[arg(long)]
    lump: bool,
    #[command(flatten)]
    common: CommonArgs,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MethodArg {
    /// Levenberg-Marquardt
    Lm,
    /// Broyden-Fletcher-Goldfarb-Shanno
    Bfgs,
    /// Davidon-Fletcher-Powell, the thesis's method
    Dfp,
}

impl From<MethodArg> for Method {
    fn from(method: MethodArg) -> Self {
        match method {
            MethodArg::Lm => Method::Lm,
            MethodArg::Bfgs => Method::Bfgs,
            MethodArg::Dfp => Method::Dfp,
        }
    }
}

fn joint_name(text: &str) -> Result<String, String> {
    let name = text.trim();
    if name.is_empty() || name.chars().any(char::is_control) {
        return Err("a joint needs a name, such as q1".into());
    }
    Ok(name.to_owned())
}

/// Runs the command.
pub(super) fn run(args: &DropArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let (case, name) = match &args.study {
        Some(study) => (Case::of_study(study)?, study_name(study)),
        None => {
            let name = args.logs.first().map(|log| log_name(log)).unwrap_or_default();
            (Case::of_logs(&args.logs, args.joint.as_deref())?, name)
        }
    };
    let robot = args.robot.as_deref().map(Model::read).transpose()?;
    let surprising = driven(&case);
    if let Some(told) = surprising.as_deref().filter(|_| !args.common.quiet) {
        progress.pause(|| warn(told));
    }
    let inputs: Vec<PathBuf> = case.inputs().into_iter().chain(args.robot.clone()).collect();
    let options = DropOptions {
        method: args.method.into(),
        directives: args.demands.directives(),
        stribeck: args.stribeck,
        lump: args.lump,
        budget: Budget::default(),
    };
    let fit = args.common.on_threads(|| fit_drop(&case, &options, &progress));
    let fit = match fit? {
        Err(DropError::NeverMoved) => return never_moved(&args.common, &case, "no fit"),
        fit => fit?,
    };
    progress.say("the same drop in the whole robot");
    let robot = robot.as_ref().unwrap_or(Model::ers7());
    let repeated = args.common.on_threads(|| Repeated::of(&case, &fit, robot))??;
    progress.say("drawing");
    let mut report = drop_report(&case, &fit, provenance(inputs)?);
    report.full = repeated.map(FullDrop::of);
    report.notes.splice(0..0, surprising);
    let written = write_report(args, &case, &fit, &report, &name)?;
    drop(progress);
    if !args.common.quiet {
        print(&drop_text(&report));
        print(&format!("\nreport: {}\n", written.display()));
    }
    let budget_spent = fit.extensive.stop() == Stop::BudgetSpent;
    Ok(if budget_spent { NOT_CONVERGED } else { 0 })
}

/// What a fit of swings makes of logs in which a servo follows setpoints.
fn driven(case: &Case) -> Option<String> {
    let by_setpoints = |item: &&Item| item.entry.drive == DriveMode::Position;
    let files: Vec<&str> = case.items.iter().filter(by_setpoints).map(|item| item.entry.file.as_str()).collect();
    (!files.is_empty()).then(|| {
        format!(
            "{}: driven by setpoints. Inertia and friction are fitted through [motor] as the study has it: whatever else the \
             drive does ends up in them. A swing with the motor off measures them; `gap` asks what the drive does.",
            files.join(", ")
        )
    })
}

/// Draws everything first and writes it then, so that an error leaves no half of a report.
fn write_report(
    args: &DropArgs,
    case: &Case,
    fit: &DropFit,
    report: &DropReport,
    name: &str,
) -> Result<PathBuf, CliError> {
    let folder = args.common.folder(name);
    let file = FitFile::of_drop(fit, report);
    let mut outputs = Outputs::default();
    for figure in figures(report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    outputs.add(folder.join("fit.json"), json_text(&file)?);
    outputs.add(folder.join("fit.toml"), toml::to_string(&file).map_err(|error| CliError::Encode(error.to_string()))?);
    let page = folder.join("report.html");
    outputs.add_page(&page, render_html(report)?);
    args.common.add_json(&mut outputs, &file)?;
    write_outputs(outputs, &case.inputs().into_iter().chain(args.robot.clone()).collect::<Vec<_>>())?;
    Ok(page)
}
