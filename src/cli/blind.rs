//! `aibo-fit blind`: sealed trials of the diagnosis.

use super::CliError;
use super::common::{CommonArgs, json_text, print};
use super::progress::Progress;
use crate::blind::{CauseFilter, Made, make_filtered};
use crate::log::Outputs;
use clap::Args;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Test the diagnosis on studies whose cause is drawn at random and sealed before it starts
#[derive(Args, Debug)]
#[command(after_help = "Example: aibo-fit blind --trials 20 --seed 7")]
pub(super) struct BlindArgs {
    /// Studies to make
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    trials: u32,
    /// Seed of all that is drawn [default: from the system, and printed]
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// What is behind the gaps: any, none, calibration, effect, pair, outside, an effect's id, or two joined by +
    #[arg(long, value_name = "KIND", default_value = "any")]
    cause: CauseFilter,
    /// Only write the studies to DIR/studies and the answers to DIR/truth
    #[arg(long, value_name = "DIR")]
    make_only: Option<PathBuf>,
    #[command(flatten)]
    common: CommonArgs,
}

/// Runs the command.
pub(super) fn run(args: &BlindArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    let seed = args.seed.unwrap_or_else(rand::random);
    progress.say("making studies");
    let made = args.common.on_threads(|| make_all(args, seed))?;
    let Some(folder) = &args.make_only else {
        return Err(CliError::Usage("only --make-only yet".into()));
    };
    let mut outputs = Outputs::default();
    for made in &made {
        let name = format!("{:03}", made.truth.trial);
        add_study(&mut outputs, &folder.join("studies").join(&name), made);
        outputs.add(folder.join("truth").join(name + ".json"), json_text(&made.truth)?);
    }
    outputs.write()?;
    drop(progress);
    if !args.common.quiet {
        print(&format!("seed {seed}: {} studies in {}\n", made.len(), folder.display()));
    }
    Ok(0)
}

fn make_all(args: &BlindArgs, seed: u64) -> Vec<Made> {
    (0..u64::from(args.trials)).into_par_iter().map(|trial| make_filtered(seed, trial, args.cause)).collect()
}

fn add_study(outputs: &mut Outputs, folder: &Path, made: &Made) {
    for (name, content) in &made.study {
        outputs.add(folder.join(name), content.as_str());
    }
}
