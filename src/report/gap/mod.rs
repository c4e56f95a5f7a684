//! The report of a diagnosis: where model and logs part, which effect is behind it, how far the gap closes.
//!
//! A [`GapReport`] is a diagnosis with what the reader has to know beside it. [`gap_json`] is the contract of the
//! specification's section 6, [`gap_text`] is for a terminal, [`FitFile::of_diagnosis`] for programs that go on from
//! here.

mod fit;
mod html;
pub(super) mod json;
pub(super) mod plot;
mod rows;
#[cfg(test)]
pub(super) mod sample;
pub(super) mod text;
pub(super) mod waterfall;
pub(super) mod words;

use fit::{stated_armature_kg_m2, stated_gains};

pub(super) use fit::quantities;
pub use html::render_gap_html;
pub(super) use html::{detectable_view, gap_view, with_code};
pub use json::gap_json;
pub use plot::{gap_figures, law_figure};
pub use text::gap_text;

#[cfg(doc)]
use super::FitFile;
use super::data_health::health_rows;
use super::{DriveGains, LogHealthRow, Provenance};
use crate::gap::inverse::TorqueTraces;
use crate::gap::{Diagnosis, GapOptions};
use crate::identify::Case;

/// Name of the file that holds the motion of the next experiment.
pub const NEXT_FILE: &str = "next.csv";

/// A diagnosis with what was asked, the health of its logs and where it comes from.
#[derive(Clone, Debug)]
pub struct GapReport {
    /// What was found.
    pub diagnosis: Diagnosis,
    /// What was asked.
    pub options: GapOptions,
    /// One row per log.
    pub health: Vec<LogHealthRow>,
    /// What the study states of the rotor \[kg m^2\]; `None`: nothing, or not the same of all logs.
    pub armature_kg_m2: Option<f64>,
    /// What it states of the drive's gains; `None`: nothing, or not the same of all logs.
    pub drive: Option<DriveGains>,
    /// Where the report comes from.
    pub provenance: Provenance,
    /// Curves of the logs where torques are predicted.
    pub torques: Vec<TorqueTraces>,
}

impl GapReport {
    /// The report of a case's diagnosis.
    pub fn new(case: &Case, diagnosis: Diagnosis, options: GapOptions, provenance: Provenance) -> Self {
        let (health, armature_kg_m2, drive) = (health_rows(case), stated_armature_kg_m2(case), stated_gains(case));
        Self { diagnosis, options, health, armature_kg_m2, drive, provenance, torques: Vec::new() }
    }
}
