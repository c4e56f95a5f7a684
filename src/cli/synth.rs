//! `aibo-fit synth`: logs from a known truth.

mod quick;

use super::CliError;
use super::common::{CommonArgs, file_to_write, json_text, log_name, print, write_outputs};
use super::progress::Progress;
use crate::log::{MANIFEST_FILE, Outputs, StudyKind, sha256, study_kind};
use crate::synth::{AnySpec, make, make_described};
use clap::Args;
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

/// Make logs from a known truth with the full simulator: any robot, any scenario, any effects, payload, floor, extra masses
///
/// SPEC.toml has what the engineer believes (the sections of a robot study, or [joint] for a joint of a leg on the bench),
/// [truth] and [[effect]] with what is true instead, and a [[log]] for each log. Writes the logs and study.toml, which
/// `gap` reads and which says nothing of the truth, to --out, and the truth beside that folder. With --robot in the place
/// of a spec: a URDF or MJCF whose joints follow sines and steps within their limits, with what --effect says.
#[derive(Args, Debug)]
#[command(after_help = "Examples: aibo-fit synth data/examples/synth/weak-knees.toml\n          \
aibo-fit synth --robot so101.xml --effect elbow_flex.delay=0.02 --out sealed")]
pub(super) struct SynthArgs {
    /// What is believed, what is true, and which logs to make; format in docs/reference/robot.md
    #[arg(value_name = "SPEC.toml", required_unless_present = "robot")]
    spec: Option<PathBuf>,
    #[command(flatten)]
    described: quick::DescribedArgs,
    /// Where the truth goes [default: <out>-truth.json]
    #[arg(long, value_name = "FILE", value_parser = file_to_write())]
    truth: Option<PathBuf>,
    /// Seed of scatter and sensors' noise [default: the spec's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    #[command(flatten)]
    common: CommonArgs,
}

/// What `--json` says: what was made, and not what is true.
#[derive(Serialize)]
struct Answer {
    schema: u32,
    study: String,
    truth: String,
    logs: Vec<LogAnswer>,
}

#[derive(Serialize)]
struct LogAnswer {
    file: String,
    samples: usize,
}

/// Runs the command.
pub(super) fn run(args: &SynthArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let (spec, inputs) = match &args.spec {
        Some(path) => (AnySpec::read(path)?, vec![path.clone()]),
        None => args.described.spec()?,
    };
    let folder = args.common.folder(&log_name(inputs.first().map_or(Path::new("spec"), |path| path)));
    let study = folder.join("study.toml");
    refuse_anothers(&study)?;
    let threads = args.common.threads.map(usize::from);
    progress.say("simulating");
    let made = match spec {
        AnySpec::Robot(mut spec) => {
            spec.seed = args.seed.unwrap_or(spec.seed);
            make(&spec, threads)?
        }
        AnySpec::Described(mut spec) => {
            spec.seed = args.seed.unwrap_or(spec.seed);
            make_described(&spec, threads)?
        }
    };
    let truth = args.truth.clone().unwrap_or_else(|| {
        let name = folder.file_name().map_or_else(|| "synth".into(), |name| name.to_string_lossy().into_owned());
        folder.with_file_name(format!("{name}-truth.json"))
    });
    let answer = Answer {
        schema: 1,
        study: study.display().to_string(),
        truth: truth.display().to_string(),
        logs: made
            .logs
            .iter()
            .map(|(file, text)| LogAnswer { file: file.clone(), samples: text.lines().count().saturating_sub(1) })
            .collect(),
    };
    let mut outputs = Outputs::default();
    outputs.add_page(&study, made.study_toml);
    for (name, text) in made.robot.into_iter().chain(made.logs) {
        outputs.add(folder.join(name), text);
    }
    outputs.add_apart(&truth, json_text(&made.truth)?);
    args.common.add_json(&mut outputs, &answer)?;
    write_outputs(outputs, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        for log in &answer.logs {
            print(&format!("{}: {} samples\n", folder.join(&log.file).display(), log.samples));
        }
        let Answer { study: path, truth, .. } = &answer;
        let check = match study_kind(&study)? {
            StudyKind::Joint | StudyKind::Clamped => format!("  aibo-fit check {path}\n"),
            StudyKind::Robot => String::new(),
        };
        print(&format!("study: {path}\ntruth: {truth}\n\nnext:\n{check}  aibo-fit gap {path}\n"));
    }
    Ok(0)
}

/// Refuses to write over a study, unless an earlier run wrote it: the folder's list has its digest.
fn refuse_anothers(study: &Path) -> Result<(), CliError> {
    let list = fs::read_to_string(study.with_file_name(MANIFEST_FILE)).unwrap_or_default();
    if fs::read(study).is_ok_and(|there| !list.contains(&sha256(&there))) {
        let why = "there is a study already, and not one that synth wrote; choose another --out";
        return Err(CliError::Usage(format!("{}: {why}", study.display())));
    }
    Ok(())
}
