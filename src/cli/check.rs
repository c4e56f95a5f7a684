//! `aibo-fit check`: what logs are like and what they can tell, before any diagnosis.

use super::CliError;
use super::common::{CommonArgs, log_name, print, warn, write_outputs};
use super::init::{drafted, warn_of_unused};
use super::progress::Progress;
use super::provenance::provenance;
use super::still::never_moved;
use crate::gap::clamped::{ClampedCase, ClampedSetup};
use crate::gap::{Checkup, GapError, check};
use crate::identify::{Case, CaseError};
use crate::log::{
    ArrayLog, JointSpec, LogError, Outputs, Predict, SensorSpec, Source, StudyKind, Uncertain, read_robot_study,
    read_source, sidecar_columns, sidecar_of, study_kind,
};
use crate::report::{
    CheckReport, PREDICTS_TORQUES, Provenance, check_html, check_json, check_text, checks_json, checks_text,
};
use clap::Args;
use rayon::prelude::*;
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

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
    Joint { case: Box<Case>, inputs: Vec<PathBuf>, predict: Option<Predict> },
    /// The joints of a robot, and what its reader has to know.
    Joints { name: String, cases: Vec<Case>, inputs: Vec<PathBuf>, predict: Predict, notes: Vec<String> },
    /// The joints of a log, of which nothing is believed.
    Log { source: Source, names: Vec<String>, inputs: Vec<PathBuf> },
}

/// Runs the command.
pub(super) fn run(args: &CheckArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let is_study = args.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let checked = match &args.robot {
        Some(robot) => robot_study(&drafted(&args.path, robot, &args.common)?, args, &progress)?,
        None if is_study => study(args, &progress)?,
        None => log(args, &progress)?,
    };
    match checked {
        Checked::Joint { case, inputs, predict } => Check::new(args, &progress, inputs, predict)?.joint(&case),
        Checked::Joints { name, cases, inputs, predict, notes } => {
            let names: Vec<String> = cases.iter().map(|case| case.joint.name.clone()).collect();
            let case = |k: usize| Ok(Cow::Borrowed(&cases[k]));
            Check::new(args, &progress, inputs, Some(predict))?.joints(&name, &names, &case, &notes)
        }
        Checked::Log { source, names, inputs } => {
            let (name, notes) = (log_name(&args.path), source.notes.clone());
            // A long log is held once: each joint takes its samples out, and they are gone when it is done.
            let source = Mutex::new(source);
            let case = |k: usize| joint_of(&source, Some(&names[k])).map(|case| Cow::Owned(*case));
            Check::new(args, &progress, inputs, None)?.joints(&name, &names, &case, &notes)
        }
    }
}

fn moves(case: &Case) -> bool {
    case.items.iter().any(|item| !item.experiments.is_empty())
}

/// What makes a joint's case, by the joint's number.
type OfJoint<'a> = &'a (dyn Fn(usize) -> Result<Cow<'a, Case>, CliError> + Sync);

/// What is checked for whom.
struct Check<'a> {
    args: &'a CheckArgs,
    progress: &'a Progress,
    inputs: Vec<PathBuf>,
    /// What the study predicts; `None`: there is no study.
    predict: Option<Predict>,
    provenance: Provenance,
}

impl<'a> Check<'a> {
    fn new(
        args: &'a CheckArgs,
        progress: &'a Progress,
        inputs: Vec<PathBuf>,
        predict: Option<Predict>,
    ) -> Result<Self, CliError> {
        // The text on a terminal does not say what the inputs hash to.
        let hashed = if args.common.json.is_some() || args.common.out.is_some() { inputs.clone() } else { Vec::new() };
        Ok(Self { args, progress, inputs, predict, provenance: provenance(hashed)? })
    }

    fn joint(&self, case: &Case) -> Result<u8, CliError> {
        if !moves(case) {
            return never_moved(&self.args.common, case, "nothing to check");
        }
        let report = self.args.common.on_threads(|| self.report(case))??;
        let text = check_text(&report);
        let mut outputs = Outputs::default();
        self.args.common.add_json(&mut outputs, &check_json(&report))?;
        let name = report.joint.clone();
        tell(self.args, outputs, (&name, &[report], &[]), &text, &self.inputs)
    }

    fn joints(&self, name: &str, names: &[String], case: OfJoint<'_>, notes: &[String]) -> Result<u8, CliError> {
        // The first joint's case is kept where it does not move: should none, it says why.
        let look = |k: usize| {
            let case = case(k)?;
            let report = moves(&case).then(|| self.report(&case)).transpose()?;
            let still = (k == 0 && report.is_none()).then(|| case.into_owned());
            Ok((report, still))
        };
        let looked = self.args.common.on_threads(|| match self.predict {
            // The joint of a study keeps all cores busy.
            Some(_) => (0..names.len()).map(look).collect::<Result<Vec<_>, CliError>>(),
            None => (0..names.len()).into_par_iter().map(look).collect(),
        })??;
        let (found, still): (Vec<_>, Vec<_>) = looked.into_iter().unzip();
        if let Some(case) = still.into_iter().next().flatten()
            && found.iter().all(Option::is_none)
        {
            return never_moved(&self.args.common, &case, "nothing to check");
        }
        let told: Vec<(&str, Option<&CheckReport>)> =
            names.iter().zip(&found).map(|(name, report)| (name.as_str(), report.as_ref())).collect();
        let text = checks_text(&told, notes);
        let mut outputs = Outputs::default();
        self.args.common.add_json(&mut outputs, &checks_json(name, &told, notes))?;
        let reports: Vec<CheckReport> = found.into_iter().flatten().collect();
        tell(self.args, outputs, (name, &reports, notes), &text, &self.inputs)
    }

    fn report(&self, case: &Case) -> Result<CheckReport, CliError> {
        self.progress.say(&format!("what the logs of {} can tell", case.joint.name));
        let checkup = match self.predict {
            Some(Predict::Motion) => checkup(case)?,
            Some(Predict::Torque) | None => None,
        };
        let report = CheckReport::new(case, checkup, self.provenance.clone());
        let predicts_torques = self.predict == Some(Predict::Torque);
        // Only the page draws the samples, and where nothing is stated only the columns can be questioned.
        let series = if self.args.common.out.is_some() { report.series } else { Vec::new() };
        let doubts = if self.predict.is_some() { report.doubts } else { case.doubts_of_columns() };
        Ok(CheckReport { predicts_torques, series, doubts, ..report })
    }
}

/// What the logs can tell; `None` where the joint moved in none of those to be fitted: it has no model to check.
fn checkup(case: &Case) -> Result<Option<Checkup>, CliError> {
    match check(case) {
        Err(GapError::NeverMoved) => Ok(None),
        checkup => Ok(Some(checkup?)),
    }
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
        print(&format!("\nnext: aibo-fit {}\n", next(args, reports)));
        page.iter().for_each(|page| print(&format!("\nreport: {}\n", page.display())));
    }
    Ok(0)
}

/// What to ask after a check.
fn next(args: &CheckArgs, reports: &[CheckReport]) -> String {
    let path = args.path.display();
    match &args.robot {
        Some(robot) => format!("gap {path} --robot {}", robot.display()),
        None if reports.iter().any(CheckReport::is_of_study) => format!("gap {path}"),
        None => format!("init {path}"),
    }
}

/// A study of a joint or of a robot with a clamped base; those of walking robots are refused.
fn study(args: &CheckArgs, progress: &Progress) -> Result<Checked, CliError> {
    let path = args.path.as_path();
    match study_kind(path)? {
        StudyKind::Robot => Err(of_walking(path)),
        StudyKind::Clamped => robot_study(path, args, progress),
        StudyKind::Joint => Ok(of_joint(Case::of_study(path)?, Some(Predict::Motion))),
    }
}

/// What is wrong with the study of a walking robot, or else that it is one.
fn of_walking(path: &Path) -> CliError {
    match read_robot_study(path) {
        Err(error) => error.into(),
        Ok(_) => CliError::Usage(format!(
            "{}: the study of a walking robot; check looks at the study of a joint or of a robot with scenario = \"fixed\", or at a log",
            path.display()
        )),
    }
}

fn of_joint(case: Case, predict: Option<Predict>) -> Checked {
    Checked::Joint { inputs: case.inputs(), case: Box::new(case), predict }
}

fn robot_study(path: &Path, args: &CheckArgs, progress: &Progress) -> Result<Checked, CliError> {
    let wrong = |error| CliError::ClampedCase(Box::new(error));
    let setup = ClampedSetup::read(path).map_err(wrong)?;
    if !args.common.quiet {
        progress.pause(|| setup.description.warnings.iter().for_each(|warning| warn(warning)));
    }
    let ClampedCase { robot: name, joints, mut notes, .. } = ClampedCase::of(&setup).map_err(wrong)?;
    let (inputs, predict) = (setup.inputs(), setup.study.predict);
    notes.extend((predict == Predict::Torque).then(|| PREDICTS_TORQUES.to_owned()));
    let cases = joints.into_iter().map(|joint| joint.case).collect();
    Ok(Checked::Joints { name, cases, inputs, predict, notes })
}

/// A log by its sidecar: each joint of several, or the only one.
fn log(args: &CheckArgs, progress: &Progress) -> Result<Checked, CliError> {
    let path = args.path.as_path();
    let mut source = match read_source(path, &sidecar_columns(path)?) {
        Ok(source) => source,
        Err(error) => {
            // Read as the log of one joint it is told what is wrong with it, unless all that is wrong is that it has several.
            return match Case::of_logs(&[path.to_path_buf()], None) {
                Err(CaseError::Log(LogError::SeveralJoints { .. })) => Err(error.into()),
                case => Ok(of_joint(case?, None)),
            };
        }
    };
    let unused = |why: &str| {
        if !args.common.quiet {
            progress.pause(|| warn_of_unused(path, why));
        }
    };
    let names: Vec<Option<String>> = source.joints().into_iter().map(|name| name.map(str::to_owned)).collect();
    let sidecar = sidecar_of(path);
    let is_told = sidecar.is_some();
    let inputs: Vec<PathBuf> = std::iter::once(path.to_path_buf()).chain(sidecar).collect();
    if matches!(names[..], [None]) {
        let told = if is_told { by_sidecar(path)? } else { None };
        return match told {
            Some(case) => Ok(of_joint(case, None)),
            None => {
                unused("where no `drive` says what moves the joint `check` takes only [columns] of the sidecar");
                Ok(Checked::Joint { case: joint_of(&Mutex::new(source), None)?, inputs, predict: None })
            }
        };
    }
    let names: Vec<String> = names.into_iter().flatten().collect();
    if names.is_empty() {
        return Ok(of_joint(Case::of_logs(&[path.to_path_buf()], None)?, None));
    }
    unused("of the sidecar of several joints `check` takes only [columns]");
    // What is not looked at need not be held.
    source.channels.retain(|channel| !channel.ours.as_ref().is_none_or(|ours| ours.ends_with(".dq")));
    Ok(Checked::Log { source, names, inputs })
}

/// The log of one joint with all that its sidecar says; `None`: that is not what moves the joint, and only its health is told.
fn by_sidecar(path: &Path) -> Result<Option<Case>, CliError> {
    match Case::of_logs(&[path.to_path_buf()], None) {
        Err(CaseError::Log(LogError::DriveUnknown { .. })) => Ok(None),
        case => Ok(Some(case?)),
    }
}

fn joint_of(source: &Mutex<Source>, name: Option<&str>) -> Result<Box<Case>, CliError> {
    let log = source.lock().unwrap_or_else(PoisonError::into_inner).take_joint_log(name)?;
    // Nothing is believed of what was asked or delivered, but how it lies to the readings is part of their health.
    let (q_ref_rad, tau_nm, setpoints, on) = (log.q_ref_rad, log.tau_nm, log.setpoints, log.drive);
    let (file, notes, ignored_columns) = (log.file, log.notes, log.ignored_columns);
    let named = ArrayLog::new(file.display().to_string(), log.t_s, log.q_rad);
    let array = ArrayLog { q_ref_rad, tau_nm, setpoints, on, holes_are_known: true, ..named };
    let is_alone = name.is_none();
    let name = name.map_or_else(|| log_name(&file), str::to_owned);
    let spec = JointSpec { name, nominal: None, gravity_m_s2: 9.81, rest_rad: None };
    let mut case = Case::of_arrays(spec, SensorSpec::default(), None, Uncertain::default(), vec![array])?;
    // Of several joints it is told once, of all of them.
    if let (true, [item]) = (is_alone, &mut case.items[..]) {
        (item.log.notes, item.log.ignored_columns) = (notes, ignored_columns);
    }
    Ok(Box::new(case))
}
