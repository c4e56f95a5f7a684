//! `aibo-fit gap` on the study of any robot with a clamped base.

use super::CliError;
use super::common::{print, study_name, warn, write_outputs};
use super::gap::{GapArgs, add_report, options};
use super::progress::Progress;
use super::provenance::provenance;
use crate::gap::clamped::{ClampedCase, diagnose_clamped};
use crate::log::{Outputs, mcap_bytes};
use crate::report::{
    ClampedGapReport, clamped_gap_figures, clamped_gap_html, clamped_gap_json, clamped_gap_text, trace_topics,
};
use std::path::Path;

/// Runs the command.
pub(super) fn run(args: &GapArgs, study: &Path) -> Result<u8, CliError> {
    let options = options(args)?;
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let case = ClampedCase::of_study(study).map_err(|error| CliError::ClampedCase(Box::new(error)))?;
    if !args.common.quiet {
        case.warnings.iter().for_each(|warning| warn(warning));
    }
    let diagnosis = args.common.on_threads(|| diagnose_clamped(&case, &options, &progress))??;
    progress.say("drawing");
    let report = ClampedGapReport::new(&case, diagnosis, &options, &provenance(case.inputs.clone())?);
    let folder = args.common.folder(&study_name(study));
    let mut outputs = Outputs::default();
    for figure in clamped_gap_figures(&report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    for (name, joint) in &report.joints {
        add_report(&mut outputs, &folder.join(name), joint)?;
    }
    if let Some(path) = &args.mcap {
        let traces = report.joints.iter().map(|(_, joint)| (&*joint.diagnosis.joint, &joint.diagnosis.traces[..]));
        outputs.add_apart(path, mcap_bytes(&trace_topics(&traces.collect::<Vec<_>>())));
    }
    let page = folder.join("report.html");
    outputs.add_page(&page, clamped_gap_html(&report)?);
    let document = clamped_gap_json(&report).map_err(|error| CliError::Encode(error.to_string()))?;
    args.common.add_json(&mut outputs, &document)?;
    write_outputs(outputs, &case.inputs)?;
    drop(progress);
    if !args.common.quiet {
        print(&clamped_gap_text(&report));
        print(&format!("\nreport: {}\n", page.display()));
    }
    Ok(0)
}
