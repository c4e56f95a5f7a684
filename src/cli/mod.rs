//! The command line: parses, runs, and says how it ended.

mod blind;
mod check;
mod clamped_gap;
mod common;
mod convert;
mod demands;
mod drop;
mod dynamics;
mod error;
mod export;
mod fleet;
mod gap;
mod gate;
mod init;
mod progress;
mod provenance;
mod restart;
mod robot_gap;
mod sensor_test;
mod servo;
mod shell;
mod simulate;
mod still;
mod synth;
mod tables;
mod walk;

use crate::report::limit_width;
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

pub use error::CliError;

/// What `--version` says: which logs can be read depends on how the program was built.
const VERSION: &str = if cfg!(feature = "parquet") {
    concat!(env!("CARGO_PKG_VERSION"), "\nfeatures: cli, report, parquet (LeRobot datasets)")
} else {
    concat!(env!("CARGO_PKG_VERSION"), "\nfeatures: cli, report; without parquet (no LeRobot datasets)")
};

/// Says why a robot does not do what its simulation does, and turns logs of joints into trustworthy dynamics.
#[derive(Parser, Debug)]
#[command(name = "aibo-fit", version, long_version = VERSION, max_term_width = 100, propagate_version = true)]
#[command(after_help = "Exit codes: 0 done; 1 the answer is no (nothing moved, a gate failed); 2 usage; 3 bad data; \
4 did not converge or diverged; 5 could not read or write.\n\nExample: aibo-fit drop data/q1.csv")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    Init(init::InitArgs),
    Check(check::CheckArgs),
    Gap(gap::GapArgs),
    Simulate(simulate::SimulateArgs),
    Export(export::ExportArgs),
    Drop(Box<drop::DropArgs>),
    Convert(convert::ConvertArgs),
    Gate(gate::GateArgs),
    Fleet(fleet::FleetArgs),
    Synth(synth::SynthArgs),
    Blind(Box<blind::BlindArgs>),
    Walk(walk::WalkArgs),
    Tables(tables::TablesArgs),
    SensorTest(sensor_test::SensorTestArgs),
    Dynamics(dynamics::DynamicsArgs),
    Completions(shell::CompletionsArgs),
    Man(shell::ManArgs),
}

/// The program with all its commands and options.
fn program() -> clap::Command {
    Cli::command()
}

/// Runs the program and answers with its exit code.
pub fn run() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os()))
}

/// As [`run_with`], in a process that is another program: what begins a command line that starts this one.
pub fn run_within(program: Vec<OsString>, words: impl IntoIterator<Item = OsString>) -> u8 {
    restart::remember(program);
    run_with(words)
}

/// Columns of the terminal; of a pipe, as into a pager, those that `COLUMNS` names.
fn columns() -> Option<usize> {
    let named = || std::env::var("COLUMNS").ok()?.parse().ok();
    let terminal = terminal_size::terminal_size_of(std::io::stdout());
    terminal.map(|(terminal_size::Width(columns), _)| usize::from(columns)).or_else(named)
}

/// Runs the program on a command line, its own name first.
pub fn run_with(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words: Vec<OsString> = words.into_iter().collect();
    let cli = match Cli::try_parse_from(&words) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are no errors; clap knows which stream they go to.
            let _ = error.print();
            return if error.use_stderr() { error::USAGE } else { 0 };
        }
    };
    fleet::end_with_fleet();
    provenance::remember(&words);
    if let Some(columns) = columns() {
        limit_width(columns);
    }
    let result = match cli.command {
        Command::Blind(args) => blind::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Completions(args) => shell::completions(&args),
        Command::Convert(args) => convert::run(&args),
        Command::Drop(args) => drop::run(&args),
        Command::Dynamics(args) => dynamics::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Fleet(args) => fleet::run(&args),
        Command::Gap(args) => gap::run(&args),
        Command::Gate(args) => gate::run(&args),
        Command::Init(args) => init::run(&args),
        Command::Man(args) => shell::man(&args),
        Command::SensorTest(args) => sensor_test::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Synth(args) => synth::run(&args),
        Command::Tables(args) => tables::run(&args),
        Command::Walk(args) => walk::run(&args),
    };
    match result.and_then(|code| common::printed().map(|()| code)) {
        Ok(code) => code,
        Err(error) => {
            // Nobody may be listening any more.
            let _ = writeln!(std::io::stderr().lock(), "error: {error}");
            error.exit_code()
        }
    }
}
