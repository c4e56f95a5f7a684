//! Layer 9: many studies, whoever answers them.
//!
//! A [`Fleet`] knows which studies there are and which of them have an answer already that still holds; it keeps each
//! new answer in a file of its own, written whole or not at all, and puts all of them into one table and one page. It
//! answers nothing itself: the program runs a worker process for each study, the Python package a task on a Ray cluster.
//!
//! # What the folder holds
//! `studies/NAME.json` for each study, `fleet.parquet`, `report.html`, and, where they are asked for, the studies' own pages
//! in `studies/NAME/`. NAME is the study's path with a part of its hash. Whoever breaks off loses nothing: the next run
//! answers what is missing, what has changed since (the study, a file that it names, a file that was read, the version, the
//! options), and what failed for no fault of the study's own.

mod error;
mod find;
mod inputs;
mod name;
mod outcome;
mod stored;
#[cfg(test)]
mod tests;
mod whose;

pub use error::FleetError;
pub use outcome::Outcome;

use crate::log::{Outputs, write_atomically};
use crate::report::{FleetReport, FleetStudy, fleet_html, fleet_parquet};
use find::Found;
use inputs::Inputs;
use rayon::prelude::*;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use stored::Stored;

/// The table.
pub const TABLE_FILE: &str = "fleet.parquet";
/// The page.
pub const PAGE_FILE: &str = "report.html";
/// Where answers are.
const STUDIES: &str = "studies";
/// Where workers write while they run, in the fleet's folder.
const WORKING: &str = "working";
/// Held as long as a fleet runs.
const LOCK_FILE: &str = ".fleet.lock";

/// What is asked of every study.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FleetOptions {
    /// Effects that are withheld from the catalogue, by their ids.
    pub without: Vec<String>,
    /// Effects that are considered alone; empty: all.
    pub only: Vec<String>,
    /// Whether each study's own page is written as well.
    pub pages: bool,
}

impl FleetOptions {
    /// As they stand after `aibo-fit gap STUDY`.
    pub fn words(&self) -> Vec<String> {
        let option = |name: &str, ids: &[String]| (!ids.is_empty()).then(|| [name.to_owned(), ids.join(",")]);
        let all = [option("--without", &self.without), option("--only", &self.only)];
        all.into_iter().flatten().flatten().collect()
    }
}

/// Many studies, and the folder of their answers.
#[derive(Debug)]
pub struct Fleet {
    folder: PathBuf,
    patterns: Vec<String>,
    options: FleetOptions,
    studies: Vec<Study>,
    /// Nobody else writes into the folder while it is held.
    _lock: File,
}

#[derive(Debug)]
struct Study {
    found: Found,
    name: String,
    /// What is known before it is answered.
    inputs: Inputs,
    has_answer: bool,
}

impl Fleet {
    /// Looks for studies and for the answers that they have.
    ///
    /// A pattern is a path, or has `*`, `?`, `[...]` and `**` for any folders.
    ///
    /// # Errors
    /// [`FleetError`]: a pattern is none or matches nothing, the folder cannot be made, another fleet writes into it.
    pub fn begin(patterns: &[String], folder: &Path, options: FleetOptions) -> Result<Self, FleetError> {
        let found = find::find(patterns)?;
        let failed = |source| FleetError::Folder { folder: folder.to_path_buf(), source };
        fs::create_dir_all(folder.join(STUDIES)).map_err(failed)?;
        let lock = File::create(folder.join(LOCK_FILE)).map_err(failed)?;
        lock.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => FleetError::Busy { folder: folder.to_path_buf() },
            TryLockError::Error(source) => failed(source),
        })?;
        // A fleet that was killed left it.
        let _ = fs::remove_dir_all(folder.join(WORKING));
        let study = |found: Found| {
            let name = name::name(&found.path);
            let stored = Stored::read(&answer_file(folder, &name));
            let inputs = Inputs::named_by(&found.path);
            let has_page = || !options.pages || folder.join(page_of(&name)).is_file();
            let holds = stored.is_some_and(|stored| {
                stored.holds(&found.path, &options, &inputs) && (stored.failed.is_some() || has_page())
            });
            Study { found, name, inputs, has_answer: holds }
        };
        let studies = found.into_par_iter().map(study).collect();
        Ok(Self { folder: folder.to_path_buf(), patterns: patterns.to_vec(), options, studies, _lock: lock })
    }

    /// How many studies there are.
    pub fn len(&self) -> usize {
        self.studies.len()
    }

    /// Whether there are none, which [`Fleet::begin`] refuses.
    pub fn is_empty(&self) -> bool {
        self.studies.is_empty()
    }

    /// Numbers of the studies that have no answer that holds.
    pub fn pending(&self) -> Vec<usize> {
        (0..self.studies.len()).filter(|study| !self.studies[*study].has_answer).collect()
    }

    /// A study's file, as the user named it.
    pub fn path(&self, study: usize) -> &Path {
        &self.studies[study].found.path
    }

    /// What is asked of every study.
    pub fn options(&self) -> &FleetOptions {
        &self.options
    }

    /// The folder of a study's own page.
    pub fn pages_of(&self, study: usize) -> PathBuf {
        self.folder.join(STUDIES).join(&self.studies[study].name)
    }

    /// A place for what a worker leaves while it runs; it is no part of the answers.
    pub fn working(&self, study: usize) -> PathBuf {
        self.folder.join(WORKING).join(&self.studies[study].name)
    }

    /// Keeps what came of a study.
    ///
    /// # Errors
    /// [`FleetError::Log`] where it cannot be written.
    pub fn store(&self, study: usize, outcome: Outcome) -> Result<(), FleetError> {
        let Study { found, name, inputs, .. } = &self.studies[study];
        let stored = Stored::of(found, &self.options, inputs, outcome);
        let text = serde_json::to_vec_pretty(&stored).map_err(|error| FleetError::Encode(error.to_string()))?;
        Ok(write_atomically(&answer_file(&self.folder, name), |out| out.write_all(&text))?)
    }

    /// All answers together.
    ///
    /// # Errors
    /// [`FleetError::Missing`] where a study has none.
    pub fn report(&self) -> Result<FleetReport, FleetError> {
        let study = |Study { found, name, .. }: &Study| {
            let missing = || FleetError::Missing { study: found.path.clone() };
            let stored = Stored::read(&answer_file(&self.folder, name)).ok_or_else(missing)?;
            let robot = whose::robot(found, stored.answer.as_ref());
            let (days, page) = (stored.days, page_of(name));
            Ok(FleetStudy {
                study: found.path.display().to_string(),
                robot,
                days,
                answer: stored.answer.ok_or(stored.failed.map_or_else(String::new, |failed| failed.why)),
                page: self.folder.join(&page).is_file().then_some(page),
            })
        };
        let studies = self.studies.iter().map(study).collect::<Result<Vec<_>, FleetError>>()?;
        let patterns = self.patterns.iter().map(|pattern| find::in_shell(pattern));
        let words = patterns.chain(self.options.words()).collect::<Vec<_>>().join(" ");
        Ok(FleetReport::new(&studies, env!("CARGO_PKG_VERSION"), &format!("aibo-fit fleet {words}")))
    }

    /// Table and page of a report.
    ///
    /// # Errors
    /// [`FleetError::Report`], which does not depend on the data.
    pub fn outputs(&self, report: &FleetReport) -> Result<Outputs, FleetError> {
        let mut outputs = Outputs::default();
        outputs.add(self.folder.join(TABLE_FILE), fleet_parquet(&report.rows)?);
        outputs.add(self.folder.join(PAGE_FILE), fleet_html(report)?);
        Ok(outputs)
    }
}

fn answer_file(folder: &Path, name: &str) -> PathBuf {
    folder.join(STUDIES).join(format!("{name}.json"))
}

/// A study's own page, relative to the fleet's.
fn page_of(name: &str) -> String {
    format!("{STUDIES}/{name}/{PAGE_FILE}")
}
