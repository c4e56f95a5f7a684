//! `aibo-fit gap` on the study of any robot with a clamped base.

use super::CliError;
use super::common::{print, study_name, warn, write_outputs};
use super::gap::{GapArgs, add_report, options_of_clamped};
use super::progress::Progress;
use super::provenance::provenance;
use crate::deadline::Deadline;
use crate::gap::clamped::ClampedSetup;
use crate::gap::inverse::diagnose_setup;
use crate::log::{Outputs, mcap_bytes};
use crate::report::{
    ANIMATION_FILE, ClampedGapReport, animation_html, clamped_gap_figures, clamped_gap_html, clamped_gap_json,
    clamped_gap_text, trace_topics,
};
use std::path::Path;

/// Runs the command.
pub(super) fn run(args: &GapArgs, study: &Path, deadline: Deadline) -> Result<u8, CliError> {
    let options = options_of_clamped(args, deadline)?;
    let progress = Progress::within(args.common.quiet, args.budget);
    progress.say("reading");
    let setup = ClampedSetup::read(study)?;
    if !args.common.quiet {
        setup.description.warnings.iter().for_each(|warning| warn(warning));
    }
    let inputs = setup.inputs();
    let provenance = provenance(inputs.clone())?;
    let found = args.common.on_threads(|| diagnose_setup(&setup, &options, &progress))??;
    let report = ClampedGapReport::new(&setup, found, &options, &provenance);
    progress.say("drawing");
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
    if let Some(Ok(whole)) = &report.whole {
        for (k, (_, csv)) in whole.predicted.iter().enumerate() {
            outputs.add(folder.join(format!("predicted-{k:02}.csv")), csv.clone());
        }
    }
    if let Some(animation) = &report.animation {
        outputs.add(folder.join(ANIMATION_FILE), animation_html(animation)?);
    }
    let page = folder.join("report.html");
    outputs.add_page(&page, clamped_gap_html(&report)?);
    let document = clamped_gap_json(&report).map_err(|error| CliError::Encode(error.to_string()))?;
    args.common.add_json(&mut outputs, &document)?;
    write_outputs(outputs, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        report.doubts().iter().for_each(|doubt| warn(doubt));
        print(&clamped_gap_text(&report));
        print(&format!("\nreport: {}\n", page.display()));
    }
    Ok(0)
}
