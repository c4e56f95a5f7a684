//! `aibo-fit blind`: sealed trials of the diagnosis.

mod open;
mod robot;

use super::CliError;
use super::common::{CommonArgs, file_to_write, json_text, print};
use super::progress::Progress;
use crate::blind::{Answered, CauseFilter, Judgement, Made, Sealed, Trial, Truth, UnknownCause, make_filtered, score};
use crate::gap::{Diagnosis, GapOptions, Verdict, diagnose};
use crate::identify::Case;
use crate::log::{Outputs, Workshop};
use crate::progress::Silent;
use crate::report::{GapReport, blind_figures, blind_html, blind_text, gap_json};
use clap::Args;
use open::{Drawn, Run};
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Test the diagnosis on studies whose cause is drawn at random and sealed before it starts
///
/// Makes studies of joints with a hidden cause, prints and stores the SHA-256 of the answers, diagnoses every study from
/// its files, opens the answers and scores. The maker has its own integrator, formulas and mechanisms. With --robot the
/// studies are of whole robots: the ERS-7 and quadrupeds of another size, walking in the air or on the floor or dropping
/// a leg, and arms of three to six joints that are made at random. They are made by the simulator with another integrator
/// and step than the diagnosis, masses and floor off by 5 to 10 %, friction by 10 to 30 %. Writes studies, sealed.sha256,
/// diagnoses, truths.json, score.json, report.html and the figures as SVG.
#[derive(Args, Debug)]
#[command(
    after_help = "Causes: any, none, calibration, effect, pair, three, four, servo, outside; the id of an effect, as \
delay; up to four of them, as delay+stribeck; a mechanism that the catalogue does not have, as cogging. Of robots also payload, \
floor_friction, floor_slope, floor_stiffness, coulomb, viscous.\n\n\
Check of the seal: sha256sum --check sealed.sha256, in the output folder.\n\n\
Example: aibo-fit blind --trials 20 --seed 7"
)]
pub(super) struct BlindArgs {
    /// Studies to make
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    trials: u32,
    /// Seed of all that is drawn [default: from the system, and printed]
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// What is behind the gaps
    #[arg(long, value_name = "CAUSE", default_value = "any")]
    cause: String,
    /// Studies of a whole robot
    #[arg(long)]
    robot: bool,
    /// Scenario of all robot studies [default: drawn, of a hundred 45 air, 20 floor, 10 drop, 25 arm]
    #[arg(long, value_name = "SCENARIO", requires = "robot", value_parser = ["air", "floor", "drop", "arm"])]
    scenario: Option<String>,
    /// Diagnose nothing; write the studies to DIR/studies and the open answers to DIR/truth
    #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "json"])]
    make_only: Option<PathBuf>,
    /// Write how often answers of each standing were right, as TOML in the form of data/rates.toml (or rates-robot.toml)
    #[arg(long, value_name = "FILE", conflicts_with = "make_only", value_parser = file_to_write())]
    rates: Option<PathBuf>,
    #[command(flatten)]
    common: CommonArgs,
}

/// The hash of the answers, stored before the first diagnosis.
const SEAL_FILE: &str = "sealed.sha256";

/// Runs the command.
pub(super) fn run(args: &BlindArgs) -> Result<u8, CliError> {
    if args.robot {
        return robot::run(args);
    }
    let filter: CauseFilter = args.cause.parse().map_err(|error: UnknownCause| CliError::Usage(error.to_string()))?;
    let make = |seed: u64, trial: u64| {
        let Made { study, truth } = make_filtered(seed, trial, &filter);
        Ok((study, truth))
    };
    run_with(args, "blind", &make, |run, truths, progress| {
        let trials = diagnose_all(run, truths, progress)?;
        progress.say("opening and scoring");
        let report = run.open(trials, score)?;
        let drawn = Drawn { figures: blind_figures(&report)?, page: blind_html(&report)? };
        let page = run.write(&report, drawn, Judgement::of, counted)?;
        Ok((blind_text(&report), page))
    })
}

/// Wrong numbers are rightly called so, whichever of them is named first.
fn counted<'a>(answer: &'a Answered, judgement: &Judgement) -> (&'a str, bool) {
    (&answer.standing, if answer.verdict == Verdict::Effect { judgement.set } else { judgement.verdict })
}

/// Names and contents of a study's files, and what is true of it.
type Study<T> = (Vec<(String, String)>, T);

/// Makes, seals, and lets `rest` diagnose, open and write; its text and page are printed.
fn run_with<T: Serialize + Send>(
    args: &BlindArgs,
    name: &str,
    make: &(dyn Fn(u64, u64) -> Result<Study<T>, CliError> + Sync),
    rest: impl FnOnce(&Run<'_>, &[T], &Progress) -> Result<(String, PathBuf), CliError>,
) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    let seed = args.seed.unwrap_or_else(rand::random);
    if let Some(folder) = &args.make_only {
        let began = Instant::now();
        let (_, truths) = args.common.on_threads(|| make_all(args, seed, folder, make, &progress))??;
        let each_s = began.elapsed().as_secs_f64() / f64::from(args.trials);
        let mut outputs = Outputs::default();
        for (trial, truth) in truths.iter().enumerate() {
            outputs.add(folder.join("truth").join(format!("{trial:03}.json")), json_text(truth)?);
        }
        outputs.write()?;
        drop(progress);
        say(args, &format!("{} studies, seed {seed}, {each_s:.2} s each, in {}\n", args.trials, folder.display()));
        return Ok(0);
    }
    let folder = args.common.folder(name);
    let began = Instant::now();
    // The folder's earlier result stays until there is another.
    let workshop = Workshop::inside(&folder)?;
    let (made, truths) = args.common.on_threads(|| make_all(args, seed, workshop.path(), make, &progress))??;
    let each_s = began.elapsed().as_secs_f64() / f64::from(args.trials);
    let sealed = Sealed::new(&truths).map_err(encode)?;
    let mut seal = Outputs::default();
    seal.add(workshop.path().join(SEAL_FILE), sealed.line());
    seal.write()?;
    progress.pause(|| {
        say(
            args,
            &format!(
                "{} studies made, {each_s:.2} s each\n{} answers sealed: SHA-256 {}\n",
                truths.len(),
                truths.len(),
                sealed.sha256
            ),
        )
    });
    let run = Run { args, seed, folder: &folder, workshop: workshop.path(), made: &made, sealed: &sealed };
    let (text, page) = rest(&run, &truths, &progress)?;
    drop(progress);
    say(args, &format!("\n{text}\nreport: {}\n", page.display()));
    Ok(0)
}

fn say(args: &BlindArgs, text: &str) {
    if !args.common.quiet {
        print(text);
    }
}

fn encode(error: serde_json::Error) -> CliError {
    CliError::Encode(error.to_string())
}

/// Folder of a study under the folder of all.
fn study_folder(folder: &Path, trial: u64) -> PathBuf {
    folder.join("studies").join(format!("{trial:03}"))
}

/// Makes and writes every study, and gives their files; what is true of them stays in memory.
fn make_all<T: Send>(
    args: &BlindArgs,
    seed: u64,
    folder: &Path,
    make: &(dyn Fn(u64, u64) -> Result<Study<T>, CliError> + Sync),
    progress: &Progress,
) -> Result<(Vec<PathBuf>, Vec<T>), CliError> {
    let done = AtomicUsize::new(0);
    let one = |trial: u64| -> Result<(Vec<PathBuf>, T), CliError> {
        let (study, truth) = make(seed, trial)?;
        let mut outputs = Outputs::default();
        for (name, content) in study {
            outputs.add(study_folder(folder, trial).join(name), content);
        }
        let files = outputs.paths().map(Path::to_path_buf).collect();
        outputs.write()?;
        progress.say(&format!("making studies: {} of {}", 1 + done.fetch_add(1, Ordering::Relaxed), args.trials));
        Ok((files, truth))
    };
    let all: Vec<(Vec<PathBuf>, T)> =
        (0..u64::from(args.trials)).into_par_iter().map(one).collect::<Result<_, CliError>>()?;
    let (files, truths): (Vec<Vec<PathBuf>>, Vec<T>) = all.into_iter().unzip();
    Ok((files.concat(), truths))
}

/// Diagnoses every study from its files; results in the order of the trials.
fn diagnose_all(run: &Run<'_>, truths: &[Truth], progress: &Progress) -> Result<Vec<Trial>, CliError> {
    one_by_one(run.args, truths, progress, &|truth: &Truth| {
        let study = study_folder(run.workshop, truth.trial).join("study.toml");
        let began = Instant::now();
        let diagnosis = diagnose_one(&study);
        let wall_s = began.elapsed().as_secs_f64();
        let answer = diagnosis.as_ref().map(|(_, diagnosis)| Answered::of(diagnosis)).map_err(Clone::clone);
        if let Ok((case, diagnosis)) = diagnosis {
            let report = GapReport::new(&case, diagnosis, GapOptions::default(), run.provenance(case.inputs())?);
            write_diagnosis(run.workshop, truth.trial, &gap_json(&report))?;
        }
        Ok(Trial { truth: truth.clone(), answer, wall_s })
    })
}

/// File of a diagnosis under the folder of all.
fn diagnosis_file(folder: &Path, trial: u64) -> PathBuf {
    folder.join("diagnoses").join(format!("{trial:03}.json"))
}

fn write_diagnosis(folder: &Path, trial: u64, diagnosis: &impl Serialize) -> Result<(), CliError> {
    let mut output = Outputs::default();
    output.add(diagnosis_file(folder, trial), json_text(diagnosis)?);
    Ok(output.write()?)
}

/// Results in the order of the truths.
///
/// Each diagnosis has one thread of its own, so that its time is its own: a shared pool would let it wait for others.
fn one_by_one<T: Sync, R: Send>(
    args: &BlindArgs,
    truths: &[T],
    progress: &Progress,
    diagnose: &(dyn Fn(&T) -> Result<R, CliError> + Sync),
) -> Result<Vec<R>, CliError> {
    let threads = args.common.threads.map_or_else(rayon::current_num_threads, usize::from).min(truths.len());
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let worker = || -> Result<Vec<(usize, R)>, CliError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let pool = pool.map_err(|error| CliError::Threads(error.to_string()))?;
        let mut trials = Vec::new();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(truth) = truths.get(at) else { return Ok(trials) };
            trials.push((at, pool.install(|| diagnose(truth))?));
            progress.say(&format!("diagnosing: {} of {}", 1 + done.fetch_add(1, Ordering::Relaxed), truths.len()));
        }
    };
    let found: Vec<Result<Vec<(usize, R)>, CliError>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let join = |worker: std::thread::ScopedJoinHandle<'_, _>| match worker.join() {
            Ok(found) => found,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        workers.into_iter().map(join).collect()
    });
    let mut trials = Vec::with_capacity(truths.len());
    for part in found {
        trials.extend(part?);
    }
    trials.sort_unstable_by_key(|(at, _)| *at);
    Ok(trials.into_iter().map(|(_, trial)| trial).collect())
}

fn diagnose_one(study: &Path) -> Result<(Case, Diagnosis), String> {
    let case = Case::of_study(study).map_err(|error| error.to_string())?;
    let diagnosis = diagnose(&case, &GapOptions::default(), &Silent).map_err(|error| error.to_string())?;
    Ok((case, diagnosis))
}
