//! The end of a run, of joints or of robots: the answers are opened, scored and written down.

use super::{BlindArgs, SEAL_FILE, diagnosis_file, encode};
use crate::blind::{RunRecord, Sealed, TRUTHS_FILE, Trial, TrialRecord};
use crate::cli::CliError;
use crate::cli::common::{json_text, write_outputs};
use crate::cli::provenance::provenance;
use crate::gap::Rates;
use crate::log::{LogError, Outputs};
use crate::report::{BlindReport, Figure, Provenance};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A run whose answers are sealed.
pub(super) struct Run<'a> {
    pub args: &'a BlindArgs,
    pub seed: u64,
    /// Where the result goes.
    pub folder: &'a Path,
    /// Where studies, seal and diagnoses are until all is done.
    pub workshop: &'a Path,
    /// Files of the studies.
    pub made: &'a [PathBuf],
    pub sealed: &'a Sealed,
}

/// The report as it is looked at.
pub(super) struct Drawn {
    pub figures: Vec<Figure>,
    pub page: String,
}

impl Run<'_> {
    /// Opens the answers, compares them with the seal that was stored before the first diagnosis, and scores.
    pub(super) fn open<T: Clone + Serialize, A, S>(
        &self,
        trials: Vec<Trial<T, A>>,
        score: fn(&[Trial<T, A>]) -> S,
    ) -> Result<BlindReport<S, Trial<T, A>>, CliError> {
        let truths: Vec<T> = trials.iter().map(|trial| trial.truth.clone()).collect();
        let opened = Sealed::new(&truths).map_err(encode)?;
        let file = self.workshop.join(SEAL_FILE);
        let stored = std::fs::read_to_string(&file).map_err(|source| LogError::Read { file, source })?;
        let (seal_holds, score, provenance) = (stored == opened.line(), score(&trials), provenance([])?);
        Ok(BlindReport { seed: self.seed, sha256: opened.sha256, seal_holds, score, trials, provenance })
    }

    /// Adds what the run has written so far; a diagnosis that failed has no file.
    fn take_over(&self, outputs: &mut Outputs) -> Result<(), CliError> {
        let diagnoses = (0..u64::from(self.args.trials)).map(|trial| diagnosis_file(self.workshop, trial));
        let diagnoses = diagnoses.filter(|file| file.exists());
        for file in self.made.iter().cloned().chain(diagnoses).chain([self.workshop.join(SEAL_FILE)]) {
            let content = std::fs::read(&file).map_err(|source| LogError::Read { file: file.clone(), source })?;
            outputs.add(self.placed(&file), content);
        }
        Ok(())
    }

    /// Where a file of the workshop is once all is done.
    fn placed(&self, file: &Path) -> PathBuf {
        file.strip_prefix(self.workshop).map_or_else(|_| file.to_path_buf(), |within| self.folder.join(within))
    }

    /// Where inputs come from, by the names that they have once all is done.
    pub(super) fn provenance(&self, inputs: impl IntoIterator<Item = PathBuf>) -> Result<Provenance, CliError> {
        let mut provenance = provenance(inputs)?;
        for (file, _) in &mut provenance.inputs {
            *file = self.placed(Path::new(file.as_str())).display().to_string();
        }
        Ok(provenance)
    }

    /// Writes everything; each answer is judged, and counts for the rates as its standing and whether it was right.
    pub(super) fn write<T: Serialize, A: Serialize, S: Serialize, J: Serialize>(
        &self,
        report: &BlindReport<S, Trial<T, A>>,
        drawn: Drawn,
        judge: fn(&Trial<T, A>) -> J,
        counted: for<'a> fn(&'a A, &J) -> (&'a str, bool),
    ) -> Result<PathBuf, CliError> {
        let record = RunRecord {
            schema: 1,
            version: &report.provenance.version,
            command: &report.provenance.command,
            seed: report.seed,
            sha256: &report.sha256,
            seal_holds: report.seal_holds,
            score: &report.score,
            trials: report.trials.iter().map(|trial| TrialRecord::of(trial, judge(trial))).collect(),
        };
        let mut outputs = Outputs::default();
        outputs.add(self.folder.join(TRUTHS_FILE), self.sealed.text.as_str());
        for figure in drawn.figures {
            outputs.add(self.folder.join(figure.file_name), figure.svg);
        }
        outputs.add(self.folder.join("score.json"), json_text(&record)?);
        self.take_over(&mut outputs)?;
        let page = self.folder.join("report.html");
        outputs.add_page(&page, drawn.page);
        self.args.common.add_json(&mut outputs, &record)?;
        if let Some(path) = &self.args.rates {
            let answers = record.trials.iter().filter_map(|trial| Some(counted(trial.answer?, &trial.judgement)));
            let rates = Rates::count(report.provenance.command.clone(), answers);
            outputs.add_apart(path, toml::to_string(&rates).map_err(|error| CliError::Encode(error.to_string()))?);
        }
        write_outputs(outputs, &[])?;
        Ok(page)
    }
}
