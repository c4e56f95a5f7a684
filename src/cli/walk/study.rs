//! What the studies share: running, measuring, writing.

use super::super::CliError;
use super::super::common::{print, write_outputs};
use super::WalkArgs;
use super::setting::Setting;
use crate::log::Outputs;
use crate::report::{Provenance, StudyReport, study_html, study_text};
use crate::robot::Model;
use crate::robot::simulate::{Control, Joints, Method, Recording, TrunkCurves, Walked, run};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Joints as the arguments want them.
pub(super) fn joints(args: &WalkArgs, model: &Model) -> Result<Joints, CliError> {
    let mut joints = Joints::passive(model);
    joints.set_friction(model, &args.friction)?;
    let control =
        Control { sample_period_s: args.control_period, derivative: model.derivative(), ..Control::default() };
    joints.set_control(model, &args.gains, control)?;
    joints.add_effects_of_file(model)?;
    Ok(joints)
}

/// One run and what it took.
pub(super) struct Run {
    pub recording: Recording,
    pub ground: Option<Walked>,
    pub trunk: Option<TrunkCurves>,
    pub wall_s: f64,
}

impl Run {
    pub fn of(setting: &Setting, method: Method, from_s: f64) -> Result<Self, CliError> {
        let clock = Instant::now();
        let recording = run(&setting.scenario(), method)?;
        let wall_s = clock.elapsed().as_secs_f64();
        let floor = setting.floor.as_ref().filter(|_| recording.diverged.is_none());
        let ground = floor.and_then(|floor| Walked::of(floor, &setting.model, &recording, from_s));
        let trunk = floor.and_then(|floor| TrunkCurves::of(floor, &recording));
        Ok(Self { recording, ground, trunk, wall_s })
    }
}

/// Writes a study's report, page, figures and JSON.
pub(super) fn write<R: Serialize>(
    args: &WalkArgs,
    report: &StudyReport<R>,
    inputs: &[PathBuf],
) -> Result<(), CliError> {
    let folder = args.folder(&format!("walk-{}", report.study));
    let mut outputs = Outputs::default();
    for figure in &report.figures {
        outputs.add(folder.join(&figure.file_name), figure.svg.clone());
    }
    let page = folder.join("report.html");
    outputs.add_page(&page, study_html(report)?);
    args.common.add_json(&mut outputs, report)?;
    write_outputs(outputs, inputs)?;
    if !args.common.quiet {
        print(&study_text(report));
        print(&format!("\nreport: {}\n", page.display()));
    }
    Ok(())
}

/// A report without rows, table and figures.
pub(super) fn empty<R: Serialize>(study: &str, title: &str, provenance: Provenance) -> StudyReport<R> {
    StudyReport {
        schema: 1,
        study: study.to_owned(),
        title: title.to_owned(),
        sentence: String::new(),
        notes: Vec::new(),
        rows: Vec::new(),
        table: Default::default(),
        figures: Vec::new(),
        provenance,
    }
}
