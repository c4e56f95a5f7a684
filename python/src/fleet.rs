//! Many studies, answered by whoever calls: which are to be answered, what came of each, and table and page of all.

use crate::errors::Failed;
use aibo_fit::fleet::{Fleet as Studies, FleetOptions, Outcome};
use aibo_fit::gap::clamped::BodyKind;
use aibo_fit::gap::robot::Cause;
use aibo_fit::report::{fleet_json, fleet_text};
use pyo3::prelude::*;
use std::path::PathBuf;

/// As `aibo-fit fleet` has it: same folder, same files.
#[pyclass(frozen, module = "aibo_fit._core")]
pub struct Fleet(Studies);

#[pymethods]
impl Fleet {
    #[new]
    fn new(
        py: Python<'_>,
        patterns: Vec<String>,
        folder: PathBuf,
        without: Vec<String>,
        only: Vec<String>,
        pages: bool,
    ) -> PyResult<Self> {
        let bodies = [BodyKind::BodyMass, BodyKind::BodyCom].map(BodyKind::id);
        for id in without.iter().chain(&only).filter(|id| !bodies.contains(&id.as_str())) {
            id.parse::<Cause>().map_err(Failed::of)?;
        }
        let options = FleetOptions { without, only, pages };
        Ok(Self(py.detach(|| Studies::begin(&patterns, &folder, options)).map_err(Failed::of)?))
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// Numbers of the studies that have no answer that holds.
    fn pending(&self) -> Vec<usize> {
        self.0.pending()
    }

    fn path(&self, study: usize) -> String {
        self.0.path(study).display().to_string()
    }

    fn pages_of(&self, study: usize) -> PathBuf {
        self.0.pages_of(study)
    }

    /// Keeps what `gap --json` says of a study.
    fn store_answer(&self, py: Python<'_>, study: usize, document: &str) -> PyResult<()> {
        py.detach(|| self.0.store(study, Outcome::of_text(document))).map_err(|error| Failed::of(error).into())
    }

    /// Keeps why a study has no answer; `lost`: another try may have another outcome.
    fn store_error(&self, py: Python<'_>, study: usize, why: String, lost: bool) -> PyResult<()> {
        let outcome = if lost { Outcome::Lost(why) } else { Outcome::None(why) };
        py.detach(|| self.0.store(study, outcome)).map_err(|error| Failed::of(error).into())
    }

    /// Writes table and page, and the document where it is asked for; gives the text and whether all are answered.
    #[pyo3(signature = (json=None))]
    fn finish(&self, py: Python<'_>, json: Option<PathBuf>) -> PyResult<(String, bool)> {
        let work = || -> Result<(String, bool), Failed> {
            let report = self.0.report()?;
            let mut outputs = self.0.outputs(&report)?;
            if let Some(path) = json {
                outputs.add_apart(path, crate::answer::json_text(&fleet_json(&report)?)?);
            }
            outputs.write()?;
            Ok((fleet_text(&report), report.failed().next().is_none()))
        };
        Ok(py.detach(work)?)
    }
}
