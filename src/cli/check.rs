//! `aibo-fit check`: what logs are like and what they can tell, before any diagnosis.

use super::CliError;
use super::common::{CommonArgs, log_name, print, write_outputs};
use super::init::drafted;
use super::progress::Progress;
use super::provenance::provenance;
use super::still::never_moved;
use crate::gap::clamped::{ClampedCase, ClampedSetup};
use crate::gap::{GapError, check};
use crate::identify::Case;
use crate::log::{
    ArrayLog, Columns, JointSpec, Outputs, SensorSpec, Source, StudyKind, Uncertain, read_source, study_kind,
};
use crate::report::{CheckReport, check_html, check_json, check_text, checks_json, checks_text};
use clap::Args;
use std::path::{Path, PathBuf};

/// Look at logs before any diagnosis: their health, what they can and cannot determine, what they would show
///
/// Of each log: sampling, jitter, lost samples, holes, stamps of setpoints against readings, the encoder's step, noise and
/// how it hangs together, motion, rest, a drive at its limit. Of a study besides: what the logs
/// make of the numbers that it states, which of them they cannot determine and what would, and the smallest size of each
/// effect that they would show. Nothing is written unless --json or --out (check.html, one page with figures, and
/// check.txt) asks for it.
#[derive(Args, Debug)]
#[command(
    after_help = "Angles are in rad, times in s, torques in N m. Exit codes: 0 done; 1 the joint never moved.\n\n\
Example: aibo-fit check data/examples/delay/study.toml"
)]
pub(super) struct CheckArgs {
    /// A study (.toml) of a joint or of a robot with a clamped base, or a log of any format; of a log alone only the health is told
    #[arg(value_name = "STUDY|LOG")]
    path: PathBuf,
    /// Check a log of this robot (URDF, MJCF or TOML) without a study: one is written into --out, as `init` would
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    #[command(flatten)]
    common: CommonArgs,
}

/// What is checked.
enum Checked {
    /// One joint; with a study what the logs can tell, too.
    Joint { case: Box<Case>, inputs: Vec<PathBuf>, is_study: bool },
    /// The joints of a robot, and what its reader has to know.
    Joints { name: String, cases: Vec<Case>, inputs: Vec<PathBuf>, notes: Vec<String>, is_study: bool },
}

/// Runs the command.
pub(super) fn run(args: &CheckArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let is_study = args.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let checked = match &args.robot {
        Some(robot) => robot_study(&drafted(&args.path, robot, &args.common)?)?,
        None if is_study => study(&args.path)?,
        None => log(&args.path)?,
    };
    match checked {
        Checked::Joint { case, inputs, is_study } => joint(args, &progress, &case, inputs, is_study),
        Checked::Joints { name, cases, inputs, notes, is_study } => {
            joints(args, &progress, &name, &cases, (inputs, notes, is_study))
        }
    }
}

fn moves(case: &Case) -> bool {
    case.items.iter().any(|item| !item.experiments.is_empty())
}

fn joint(
    args: &CheckArgs,
    progress: &Progress,
    case: &Case,
    inputs: Vec<PathBuf>,
    is_study: bool,
) -> Result<u8, CliError> {
    if !moves(case) {
        return never_moved(&args.common, case, "nothing to check");
    }
    let report = report(args, progress, case, is_study, inputs.clone())?;
    let text = check_text(&report);
    let mut outputs = Outputs::default();
    args.common.add_json(&mut outputs, &check_json(&report))?;
    let name = report.joint.clone();
    tell(args, outputs, (&name, &[report], &[]), &text, &inputs)
}

fn joints(
    args: &CheckArgs,
    progress: &Progress,
    name: &str,
    cases: &[Case],
    (inputs, notes, is_study): (Vec<PathBuf>, Vec<String>, bool),
) -> Result<u8, CliError> {
    if let Some(case) = cases.first().filter(|_| !cases.iter().any(moves)) {
        return never_moved(&args.common, case, "nothing to check");
    }
    let found = cases.iter().map(|case| {
        let report = moves(case).then(|| report(args, progress, case, is_study, inputs.clone())).transpose()?;
        Ok::<_, CliError>((case.joint.name.as_str(), report))
    });
    let found: Vec<(&str, Option<CheckReport>)> = found.collect::<Result<_, _>>()?;
    let told: Vec<(&str, Option<&CheckReport>)> = found.iter().map(|(name, report)| (*name, report.as_ref())).collect();
    let text = checks_text(&told, &notes);
    let reports: Vec<CheckReport> = found.into_iter().filter_map(|(_, report)| report).collect();
    let mut outputs = Outputs::default();
    args.common.add_json(&mut outputs, &checks_json(name, &reports))?;
    tell(args, outputs, (name, &reports, &notes), &text, &inputs)
}

fn report(
    args: &CheckArgs,
    progress: &Progress,
    case: &Case,
    is_study: bool,
    inputs: Vec<PathBuf>,
) -> Result<CheckReport, CliError> {
    progress.say(&format!("what the logs of {} can tell", case.joint.name));
    let checkup = args.common.on_threads(|| is_study.then(|| check(case)))?;
    // A joint that moved in none of the logs to be fitted has no model to check.
    let checkup = match checkup.transpose() {
        Err(GapError::NeverMoved) => None,
        checkup => checkup?,
    };
    Ok(CheckReport::new(case, checkup, provenance(inputs)?))
}

/// Prints the text; with --out also writes it, and the page.
fn tell(
    args: &CheckArgs,
    mut outputs: Outputs,
    (name, reports, notes): (&str, &[CheckReport], &[String]),
    text: &str,
    inputs: &[PathBuf],
) -> Result<u8, CliError> {
    let page = args.common.out.as_ref().map(|folder| folder.join("check.html"));
    if let (Some(folder), Some(page)) = (&args.common.out, &page) {
        outputs.add(folder.join("check.txt"), text.to_owned());
        outputs.add_page(page, check_html(name, reports, notes)?);
    }
    write_outputs(outputs, inputs)?;
    if !args.common.quiet {
        print(text);
        page.iter().for_each(|page| print(&format!("\nreport: {}\n", page.display())));
    }
    Ok(0)
}

/// A study of a joint or of a robot with a clamped base; those of walking robots are refused.
fn study(path: &Path) -> Result<Checked, CliError> {
    match study_kind(path)? {
        StudyKind::Robot => Err(CliError::Usage(format!(
            "{}: the study of a walking robot; check looks at the study of a joint or of a robot with scenario = \"fixed\", or at a log",
            path.display()
        ))),
        StudyKind::Clamped => robot_study(path),
        StudyKind::Joint => Ok(of_joint(Case::of_study(path)?, true)),
    }
}

fn of_joint(case: Case, is_study: bool) -> Checked {
    Checked::Joint { inputs: case.inputs(), case: Box::new(case), is_study }
}

fn robot_study(path: &Path) -> Result<Checked, CliError> {
    let wrong = |error| CliError::ClampedCase(Box::new(error));
    let setup = ClampedSetup::read(path).map_err(wrong)?;
    let ClampedCase { robot: name, joints, notes, .. } = ClampedCase::of(&setup).map_err(wrong)?;
    let inputs = setup.inputs();
    let cases = joints.into_iter().map(|joint| joint.case).collect();
    Ok(Checked::Joints { name, cases, inputs, notes, is_study: true })
}

/// A log with its sidecar, or each joint of a log without one.
fn log(path: &Path) -> Result<Checked, CliError> {
    let is_told = path.with_extension("toml").is_file();
    let source = read_source(path, &Columns::default());
    let names = |source: &Source| -> Vec<Option<String>> {
        source.joints().into_iter().map(|name| name.map(str::to_owned)).collect()
    };
    match source.map(|source| (names(&source), source)) {
        Ok((names, source)) if !is_told && matches!(names[..], [None]) => {
            let case = Box::new(joint_of(&source, None)?);
            Ok(Checked::Joint { case, inputs: vec![path.to_path_buf()], is_study: false })
        }
        Ok((names, source)) if names.iter().any(Option::is_some) => {
            let cases = names.iter().flatten().map(|name| joint_of(&source, Some(name))).collect::<Result<_, _>>()?;
            let inputs = vec![path.to_path_buf()];
            Ok(Checked::Joints { name: log_name(path), cases, inputs, notes: source.notes, is_study: false })
        }
        // A sidecar may say more of it than the file does.
        _ => Ok(of_joint(Case::of_logs(&[path.to_path_buf()], None)?, false)),
    }
}

fn joint_of(source: &Source, name: Option<&str>) -> Result<Case, CliError> {
    let log = source.joint_log(name)?;
    // Nothing is believed of what was asked or delivered, but how it lies to the readings is part of their health.
    let (q_ref_rad, tau_nm, setpoints, on) = (log.q_ref_rad, log.tau_nm, log.setpoints, log.drive);
    let named = ArrayLog::new(source.file.display().to_string(), log.t_s, log.q_rad);
    let array = ArrayLog { q_ref_rad, tau_nm, setpoints, on, holes_are_known: true, ..named };
    let name = name.map_or_else(|| log_name(&source.file), str::to_owned);
    let spec = JointSpec { name, nominal: None, gravity_m_s2: 9.81, rest_rad: None };
    Ok(Case::of_arrays(spec, SensorSpec::default(), None, Uncertain::default(), vec![array])?)
}
