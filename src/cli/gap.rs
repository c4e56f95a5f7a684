//! `aibo-fit gap`: where model and logs of a joint part, which effect is behind it, how far the gap closes. Studies of
//! robots go to [`robot_gap`] and [`clamped_gap`].

use super::common::{CommonArgs, file_to_write, json_text, print, study_name, warn, write_outputs};
use super::demands::DemandArgs;
use super::init::drafted;
use super::progress::Progress;
use super::provenance::provenance;
use super::still::never_moved;
use super::{CliError, clamped_gap, robot_gap};
use crate::deadline::{self, Deadline};
use crate::gap::clamped::{BodyKind, NoSuchCause};
use crate::gap::robot::{Cause, UnknownCause};
use crate::gap::{GapError, GapOptions, diagnose};
use crate::identify::Case;
use crate::joint::EffectId;
use crate::log::{Outputs, StudyKind, mcap_bytes, study_kind};
use crate::report::{FitFile, GapReport, NEXT_FILE, gap_figures, gap_json, gap_text, render_gap_html, trace_topics};
use clap::Args;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What `--without` and `--only` name.
pub(super) use crate::gap::clamped::NamedCause as Named;

/// Diagnose the gap between a nominal model and logs, of a joint or of the whole robot
///
/// Says where the two part, which unmodelled effect is behind it, and how far the gap closes when that effect is added;
/// or that nothing is missing, that only the given numbers are off, that these logs cannot tell two effects apart, or
/// that no effect of the catalogue explains them. Prints the answer, and writes report.html, the figures as SVG,
/// fit.json (for simulate --fit), and next.csv (t [s], q_ref [rad]) where a motion would tell more. Of a robot study (one
/// with [robot]) it says which joints and which phase of the gait as well.
#[derive(Args, Debug)]
#[command(after_help = after_help())]
pub(super) struct GapArgs {
    /// The study: nominal model and logs in one TOML file; with --robot a log
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
    /// Diagnose a log of this robot (URDF, MJCF or TOML) without a study: one is written into --out, as `init` would
    #[arg(long, value_name = "FILE")]
    pub robot: Option<PathBuf>,
    /// Write measured, predicted and residual of every joint as MCAP, for Foxglove and Rerun
    #[arg(long, value_name = "FILE", value_parser = file_to_write())]
    pub mcap: Option<PathBuf>,
    /// Withhold effects from the catalogue, separated by commas [default: none]
    #[arg(long, value_name = "IDS", value_delimiter = ',', value_parser = named)]
    pub without: Vec<Named>,
    /// Consider these effects only, separated by commas [default: all]
    #[arg(long, value_name = "IDS", value_delimiter = ',', value_parser = named)]
    pub only: Vec<Named>,
    /// Measure the probabilities on so many twins of this joint study; 0: take the rates that come with the program
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    pub twins: u32,
    /// Time for the search, such as 60s or 5min, from the start on; what cannot be tried in it is named, and the answer is then
    /// that of an unfinished search [default: as long as it takes]
    #[arg(long, value_name = "TIME", value_parser = budget, conflicts_with = "twins")]
    pub budget: Option<Duration>,
    /// Seed of the twins
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    pub demands: DemandArgs,
    #[command(flatten)]
    pub common: CommonArgs,
}

fn after_help() -> String {
    let ids: Vec<&str> = EffectId::ALL.iter().map(|effect| effect.id()).collect();
    let of_walking = Cause::all().filter(|cause| !matches!(cause, Cause::Effect(_))).map(Cause::id);
    let of_arms = BodyKind::ALL.map(BodyKind::id);
    format!(
        "Effects: {}; of a robot that walks also {}, of one with a clamped base {}.\n\
         Names for --fix, --free, --bound and --start (of a joint): inertia, moment, coulomb, viscous, gain, kd, ki, rest, and \
         parameters of effects such as delay.T.\nAngles are in rad, times in s, torques in N m; the exit code is 0 for any verdict.\n\n\
         Study, all keys with units and defaults in docs/reference/study.md: schema = 1; [joint] name, inertia [kg m^2], moment [kg m], \
         coulomb [N m], viscous [N m s/rad], gravity, rest [rad]; [sensor] resolution [rad], period [s]; [motor] kp [N m/rad], \
         kd, model = torque|voltage, encoder = link|motor, armature, ...; [uncertain], relative; [[log]] file, role = fit|validate, \
         drive = off|position|torque, session, tau_is = applied|commanded|current, motor, extra.\n\n\
         Example: aibo-fit gap study.toml --without delay,backlash",
        ids.join(", "),
        of_walking.collect::<Vec<_>>().join(", "),
        of_arms.join(", ")
    )
}

/// A cause by its id, with blanks around it.
pub(super) fn named(word: &str) -> Result<Named, UnknownCause> {
    word.trim().parse()
}

/// A time with its unit: `60s`, `1.5min`.
pub(super) fn budget(text: &str) -> Result<Duration, String> {
    let expected = || "expected a time with its unit, such as 60s or 5min".to_owned();
    let (number, unit_s) = match (text.strip_suffix("min"), text.strip_suffix('s')) {
        (Some(number), _) => (number, 60.0),
        (None, Some(number)) => (number, 1.0),
        (None, None) => return Err(expected()),
    };
    let time_s = unit_s * number.trim().parse::<f64>().map_err(|_| expected())?;
    deadline::budget(time_s).map_err(|error| error.to_string())
}

/// Causes of a robot that is simulated as a whole; those of bodies are looked for along the motion of clamped ones.
pub(super) fn causes(named: &[Named]) -> Result<Vec<Cause>, CliError> {
    named.iter().map(|cause| cause.of_whole_robot().map_err(none_such)).collect()
}

fn none_such(error: NoSuchCause) -> CliError {
    CliError::Usage(error.to_string())
}

/// What is asked of the diagnosis of a robot with a clamped base.
pub(super) fn options_of_clamped(args: &GapArgs, deadline: Deadline) -> Result<GapOptions, CliError> {
    Ok(asked(args, GapOptions::of_arm(&args.without, &args.only).map_err(none_such)?, deadline))
}

/// What is asked of a joint's diagnosis.
pub(super) fn options(args: &GapArgs, deadline: Deadline) -> Result<GapOptions, CliError> {
    Ok(asked(args, GapOptions::of_joint(&args.without, &args.only).map_err(none_such)?, deadline))
}

/// The rest of what is asked, beside the causes that are looked for.
fn asked(args: &GapArgs, causes: GapOptions, deadline: Deadline) -> GapOptions {
    let (twins, seed, demands) = (args.twins as usize, args.seed, args.demands.directives());
    GapOptions { twins, seed, demands, deadline, ..causes }
}

/// Whether a path is a log by its ending, or a folder of one: what is read of it as text says nothing that helps.
fn is_recording(path: &Path) -> bool {
    const ENDINGS: [&str; 9] = ["db3", "mcap", "bag", "zstd", "zst", "npz", "npy", "parquet", "json"];
    let is_log = |ending: &std::ffi::OsStr| ENDINGS.iter().any(|of| ending.eq_ignore_ascii_case(of));
    path.is_dir() || (path.is_file() && path.extension().is_some_and(is_log))
}

/// Runs the command.
pub(super) fn run(args: &GapArgs) -> Result<u8, CliError> {
    if let Some(both) = args.only.iter().find(|effect| args.without.contains(effect)) {
        return Err(CliError::Usage(format!("`{}` stands in --without and in --only; leave it out of one", both.id())));
    }
    let deadline = args.budget.map_or_else(Deadline::default, Deadline::within);
    if let Some(robot) = &args.robot {
        let study = drafted(&args.study, robot, &args.common)?;
        return clamped_gap::run(args, &study, deadline);
    }
    if is_recording(&args.study) {
        let log = args.study.display();
        return Err(CliError::Usage(format!(
            "{log}: this is a log, not a study; `aibo-fit init {log}` writes one to fill in, and --robot FILE takes a log as it is"
        )));
    }
    match study_kind(&args.study)? {
        StudyKind::Robot if args.mcap.is_some() => {
            let why = "--mcap shows joints of a bench or of a robot whose base is clamped";
            return Err(CliError::Usage(why.to_owned()));
        }
        StudyKind::Robot => return robot_gap::run(args, deadline),
        StudyKind::Clamped => return clamped_gap::run(args, &args.study, deadline),
        StudyKind::Joint => {}
    }
    let options = options(args, deadline)?;
    let progress = Progress::within(args.common.quiet, args.budget);
    progress.say("reading");
    let case = Case::of_study(&args.study)?;
    let told = case.doubts();
    if !args.common.quiet {
        progress.pause(|| told.iter().for_each(|doubt| warn(doubt)));
    }
    let diagnosis = args.common.on_threads(|| diagnose(&case, &options, &progress))?;
    let diagnosis = match diagnosis {
        Err(GapError::NeverMoved) => return never_moved(&args.common, &case, "no diagnosis"),
        diagnosis => diagnosis?,
    };
    progress.say("drawing");
    let report = GapReport::new(&case, diagnosis, options, provenance(case.inputs())?);
    let page = write_report(args, &case, &report)?;
    drop(progress);
    if !args.common.quiet {
        // The search shows more than the numbers alone.
        report.diagnosis.doubts.iter().filter(|doubt| !told.contains(doubt)).for_each(|doubt| warn(doubt));
        print(&gap_text(&report));
        print(&format!("\nreport: {}\n", page.display()));
    }
    Ok(0)
}

/// Draws everything first and writes it then, so that an error leaves no half of a report.
fn write_report(args: &GapArgs, case: &Case, report: &GapReport) -> Result<PathBuf, CliError> {
    let folder = args.common.folder(&study_name(&args.study));
    let mut outputs = Outputs::default();
    let page = add_report(&mut outputs, &folder, report)?;
    if let Some(path) = &args.mcap {
        let traces = [(report.diagnosis.joint.as_str(), &report.diagnosis.traces[..])];
        outputs.add_apart(path, mcap_bytes(&trace_topics(&traces)));
    }
    args.common.add_json(&mut outputs, &gap_json(report))?;
    write_outputs(outputs, &case.inputs())?;
    Ok(page)
}

/// A joint's page, figures, fit and next motion in a folder; answers with the page.
pub(super) fn add_report(outputs: &mut Outputs, folder: &Path, report: &GapReport) -> Result<PathBuf, CliError> {
    for figure in gap_figures(report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    let fit = FitFile::of_diagnosis(report);
    outputs.add(folder.join("fit.json"), json_text(&fit)?);
    if let Some((t_s, q_ref_rad)) = report.diagnosis.next.as_ref().and_then(|next| next.motion.as_ref()) {
        outputs.add(folder.join(NEXT_FILE), motion_csv(t_s, q_ref_rad));
    }
    let page = folder.join("report.html");
    outputs.add_page(&page, render_gap_html(report)?);
    Ok(page)
}

/// A motion as CSV, in the columns of a log's setpoint.
fn motion_csv(t_s: &[f64], q_ref_rad: &[f64]) -> String {
    let mut text = String::from("t,q_ref\n");
    for (t, q_ref) in t_s.iter().zip(q_ref_rad) {
        let _ = writeln!(text, "{t:.6},{q_ref:.7}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_are_read_with_blanks_or_refused_with_the_catalogue() {
        assert_eq!(named(" delay"), Ok(Named::Cause(Cause::Effect(EffectId::Delay))));
        assert_eq!(named("body_com"), Ok(Named::Body(BodyKind::BodyCom)));
        let error = named("friction").unwrap_err().to_string();
        assert!(error.contains("`friction`") && error.contains("stribeck, load_friction"), "{error}");
    }

    #[test]
    fn what_a_study_cannot_have_is_a_matter_of_the_command_line() {
        assert_eq!(causes(&[Named::Cause(Cause::Payload)]).unwrap(), [Cause::Payload]);
        let error = causes(&[Named::Body(BodyKind::BodyMass)]).unwrap_err();
        assert_eq!(error.exit_code(), crate::cli::error::USAGE);
        assert!(error.to_string().contains("`body_mass` is looked for in studies with scenario"), "{error}");
    }

    #[test]
    fn a_time_has_a_unit_and_is_not_endless() {
        let seconds = |text| budget(text).map(|time| time.as_secs_f64());
        assert_eq!((seconds("60s"), seconds("1.5 min"), seconds("0.5 s")), (Ok(60.0), Ok(90.0), Ok(0.5)));
        for wrong in ["60", "s", "0s", "-1s", "nans", "infs", "1e300min", "1h", ""] {
            assert!(budget(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_motion_has_the_columns_of_a_log() {
        assert_eq!(motion_csv(&[0.0, 0.02], &[-0.1, 0.25]), "t,q_ref\n0.000000,-0.1000000\n0.020000,0.2500000\n");
    }
}
