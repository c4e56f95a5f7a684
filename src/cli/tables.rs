//! `aibo-fit tables`: the thesis's chapter 3 in one command.

use super::CliError;
use super::common::{CommonArgs, print, write_outputs};
use super::progress::Progress;
use super::provenance::provenance;
use crate::log::Outputs;
use crate::report::{ThesisReport, thesis_csv, thesis_figures, thesis_html, thesis_json, thesis_markdown, thesis_text};
use crate::thesis::tables;
use clap::Args;
use std::path::PathBuf;

/// Repeat the thesis's chapter 3 on logged swings: Tables 3.1 to 3.4, printed numbers beside ours
///
/// Reads every log with a sidecar in the folder (joints q1, q2, q3; without and with extra masses), fits the simple
/// pendulum for Table 3.1 and the extensive one about q3, q2, q1 for Tables 3.2 to 3.4, and scans what may be behind the
/// puzzles that the thesis left. Writes tables.md, tables.csv, report.html, the figures as SVG, and robot.toml: the ERS-7
/// with what was found.
#[derive(Args, Debug)]
#[command(after_help = "Units: kg, N m, N m s/rad, 1/s, 1/s^2.\n\n\
Example: aibo-fit tables\nExample: aibo-fit tables --data data/sealed-robot --out fits/sealed")]
pub(super) struct TablesArgs {
    /// Folder of swings: logs NAME.csv with sidecars NAME.toml, and pose.toml
    #[arg(long, value_name = "DIR", default_value = "data/thesis-robot")]
    data: PathBuf,
    #[command(flatten)]
    common: CommonArgs,
}

/// Runs the command.
pub(super) fn run(args: &TablesArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    let found = args.common.on_threads(|| tables(&args.data, &|what| progress.say(what)))??;
    let inputs = found.inputs();
    let report =
        ThesisReport { provenance: provenance(inputs.clone())?, data: args.data.display().to_string(), tables: found };
    let folder = args.common.folder("tables");
    let mut outputs = Outputs::default();
    outputs.add(folder.join("tables.md"), thesis_markdown(&report));
    outputs.add(folder.join("tables.csv"), thesis_csv(&report));
    outputs.add(folder.join("robot.toml"), report.tables.robot_toml.as_str());
    for figure in thesis_figures(&report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    let page = folder.join("report.html");
    outputs.add_page(&page, thesis_html(&report)?);
    args.common.add_json(&mut outputs, &thesis_json(&report))?;
    write_outputs(outputs, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        print(&thesis_text(&report));
        print(&format!("\nreport: {}\n", page.display()));
    }
    Ok(0)
}
