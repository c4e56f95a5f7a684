//! `aibo-fit fleet`: many studies, one table and one page.

mod worker;

use super::CliError;
use super::common::{CommonArgs, print, write_outputs};
use super::error::NO;
use super::gap::Named;
use super::progress::Progress;
use crate::fleet::{Fleet, FleetError, FleetOptions, Outcome, PAGE_FILE, TABLE_FILE};
use crate::report::{fleet_json, fleet_text};
use clap::Args;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use worker::Worker;
pub(super) use worker::end_with_fleet;

/// Diagnose many studies on all cores into one table and one page: which joints of which robots drift, since when
///
/// Each study is answered by a process of its own, as `gap` would: a study that is bad, crashes or is killed is a row with
/// its error (a crash is tried once more) and the others go on. Each answer is kept in --out as it comes; a fleet that was
/// interrupted, or is run again, answers only what is missing or has changed. Writes fleet.parquet (a row for each joint in
/// each log), report.html, and studies/*.json.
#[derive(Args, Debug)]
#[command(
    after_help = "Robots are told by [about] robot = \"...\" in a study, else by the first folder below the pattern's fixed part; days by \
[about] day = \"2026-03-01\", else by a day in the log's or a folder's name, the log's own stamps, the file's date.\n\n\
Exit codes: 0 all studies are answered; 1 some are not; 2 usage; 5 --out cannot be written.\n\n\
Example: aibo-fit fleet 'logs/**/study.toml' --out fits/fleet"
)]
pub(super) struct FleetArgs {
    /// Studies, or patterns in quotes: * and ? within a name, ** for any folders
    #[arg(value_name = "PATTERN", required = true)]
    patterns: Vec<String>,
    /// Withhold effects from the catalogue, separated by commas [default: none]
    #[arg(long, value_name = "IDS", value_delimiter = ',', value_parser = super::gap::named)]
    without: Vec<Named>,
    /// Consider these effects only, separated by commas [default: all]
    #[arg(long, value_name = "IDS", value_delimiter = ',', value_parser = super::gap::named)]
    only: Vec<Named>,
    /// Write each study's own report too, in studies/, and lead to it from the page
    #[arg(long)]
    pages: bool,
    #[command(flatten)]
    common: CommonArgs,
}

/// Runs the command.
pub(super) fn run(args: &FleetArgs) -> Result<u8, CliError> {
    let ids = |named: &[Named]| named.iter().map(|named| named.id().to_owned()).collect();
    let options = FleetOptions { without: ids(&args.without), only: ids(&args.only), pages: args.pages };
    let folder = args.common.folder("fleet");
    let progress = Progress::new(args.common.quiet);
    progress.say("looking for studies");
    let fleet = Fleet::begin(&args.patterns, &folder, options)?;
    let pending = fleet.pending();
    let cores = thread::available_parallelism().map_or(1, usize::from);
    answer(&fleet, &pending, args.common.threads.map_or(cores, usize::from), &progress)?;
    progress.say("the table");
    let report = fleet.report()?;
    let mut outputs = fleet.outputs(&report)?;
    let document = fleet_json(&report).map_err(|error| CliError::Encode(error.to_string()))?;
    args.common.add_json(&mut outputs, &document)?;
    let inputs: Vec<PathBuf> = (0..fleet.len()).map(|study| fleet.path(study).to_path_buf()).collect();
    write_outputs(outputs, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        print(&fleet_text(&report));
        let kept = fleet.len() - pending.len();
        print(&format!("\nanswered now: {}; kept from before: {kept}\n", pending.len()));
        print(&format!("table: {}\nreport: {}\n", folder.join(TABLE_FILE).display(), folder.join(PAGE_FILE).display()));
    }
    Ok(if report.failed().next().is_none() { 0 } else { NO })
}

/// Answers the studies, so many at a time; each answer is kept as soon as it is there.
fn answer(fleet: &Fleet, pending: &[usize], threads: usize, progress: &Progress) -> Result<(), CliError> {
    if pending.is_empty() {
        return Ok(());
    }
    let workers = threads.min(pending.len());
    // Where there are fewer studies than cores each has several.
    let worker = Worker::new(threads / workers)?;
    let (next, done, lost) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
    let failed: Mutex<Option<FleetError>> = Mutex::new(None);
    let stop = |error: FleetError| {
        next.store(pending.len(), Ordering::Relaxed);
        failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner).get_or_insert(error);
    };
    let work = || {
        while let Some(study) = pending.get(next.fetch_add(1, Ordering::Relaxed)) {
            let outcome = worker.answer(fleet, *study);
            lost.fetch_add(usize::from(!matches!(outcome, Outcome::Answer(_))), Ordering::Relaxed);
            if let Err(error) = fleet.store(*study, outcome) {
                return stop(error);
            }
            let (done, lost) = (done.fetch_add(1, Ordering::Relaxed) + 1, lost.load(Ordering::Relaxed));
            let without = if lost > 0 { format!(", {lost} without an answer") } else { String::new() };
            progress.say(&format!("{done} of {} studies{without}", pending.len()));
        }
    };
    thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
    failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).map_or(Ok(()), |error| Err(error.into()))
}
