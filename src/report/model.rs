//! What a drop report shows, as plain data: the command line assembles it, figures and HTML draw it.

use super::FullDrop;
use crate::identify::BeliefFound;
use crate::log::{LogError, log_files};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io;
use std::path::PathBuf;

/// Everything the report of `aibo-fit drop` shows.
#[derive(Clone, Debug)]
pub struct DropReport {
    /// Name of the joint, e.g. `q1`.
    pub joint: String,
    /// One sentence a colleague would say; opens the report.
    pub sentence: String,
    /// Honest messages, most important first (what the logs cannot determine, what looked odd).
    pub notes: Vec<String>,
    /// What the study states of the numbers, and where the extensive model has them.
    pub beliefs: Vec<BeliefFound>,
    /// What the logs leave to what the study states, in sentences.
    pub undetermined: Vec<String>,
    /// One row per log.
    pub health: Vec<LogHealthRow>,
    /// Curves of every log that moves.
    pub logs: Vec<LogCurves>,
    /// The simple model (3.2) and the extensive model (3.13), in this order.
    pub models: Vec<ModelSummary>,
    /// Correlation of the extensive model's fitted parameters.
    pub correlation: Correlation,
    /// Friction torque against speed of the extensive model; empty where the scale is not determined.
    pub friction: Vec<FrictionPoint>,
    /// The same drop in the whole robot, where the logs are of a leg whose pose is known.
    pub full: Option<FullDrop>,
    /// Where the report comes from.
    pub provenance: Provenance,
}

impl DropReport {
    /// The 95 % interval of one of the extensive model's parameters.
    pub(super) fn interval(&self, name: &str) -> Option<[f64; 2]> {
        self.models.iter().rev().flat_map(|model| &model.parameters).find(|row| row.name == name)?.interval
    }
}

/// One row of the data-health table.
#[derive(Clone, Debug, Serialize)]
pub struct LogHealthRow {
    /// As the user named it.
    pub file: String,
    /// `fit` or `validate`.
    pub role: String,
    /// Number of samples.
    pub samples: usize,
    /// Last time less first \[s\].
    pub duration_s: f64,
    /// Median sampling period \[s\].
    pub period_s: f64,
    /// Standard deviation of the sampling period \[s\].
    pub jitter_s: f64,
    /// Samples that are missing by the median period.
    pub lost: usize,
    /// Quantisation step found in the data, or given \[rad\]; 0 where none was found.
    pub resolution_rad: f64,
    /// Standard deviation of the reading while the joint rests \[rad\].
    pub noise_rad: Option<f64>,
    /// Instant of release \[s\], for a log that begins held.
    pub release_s: Option<f64>,
    /// Instant from which the joint rests until the end \[s\].
    pub rest_from_s: Option<f64>,
    /// Plain-language remarks; empty where all is well.
    pub remarks: Vec<String>,
    /// What the table of a report has no room for.
    #[serde(flatten)]
    pub more: HealthMore,
}

/// What else is known of a log: for programs, and for the page of `check`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct HealthMore {
    /// Longest step between two stamps \[s\].
    pub longest_step_s: f64,
    /// From the lowest to the highest reading \[rad\].
    pub travel_rad: f64,
    /// The speed that one reading in a hundred exceeds \[rad/s\].
    pub top_speed_rad_s: f64,
    /// How often the motion turns back.
    pub reversals: usize,
    /// Share of the time in which the joint does not move \[0 to 1\].
    pub still_share: f64,
    /// Share of the readings in motion that repeat the one before \[0 to 1\].
    pub stale_share: f64,
    /// How long the noise at rest hangs together \[s\]; `None`: it cannot be told.
    pub noise_lasts_s: Option<f64>,
    /// Correlation of that noise with itself so many samples later, from 0 on.
    pub noise_correlation: Vec<f64>,
    /// Of setpoints with stamps of their own: their median step \[s\].
    pub setpoint_period_s: Option<f64>,
    /// Their median time to the next reading \[s\].
    pub setpoint_before_reading_s: Option<f64>,
    /// The median departure of that time from its median \[s\].
    pub setpoint_spread_s: Option<f64>,
    /// The torque at which the drive is limited, as the log shows it \[N m\].
    pub torque_limit_nm: Option<f64>,
    /// The share of the samples at it \[0 to 1\].
    pub torque_limit_share: Option<f64>,
    /// Where readings stand while the setpoint goes on \[rad\].
    pub stuck_at_rad: Option<f64>,
    /// For how long \[s\].
    pub stuck_s: Option<f64>,
    /// How far the setpoint goes beyond that \[rad\], and how far it comes back before the reading follows \[rad\].
    pub stuck_setpoint_rad: Option<[f64; 2]>,
    /// How often it stands there, and at how many other places.
    pub stuck_times: Option<[usize; 2]>,
}

/// One log with the two models' predictions on the fitted samples.
#[derive(Clone, Debug)]
pub struct LogCurves {
    /// As the user named it.
    pub file: String,
    /// `fit` or `validate`.
    pub role: String,
    /// All sample times \[s\] and readings \[rad\].
    pub t_s: Vec<f64>,
    /// Readings \[rad\], same length.
    pub measured_rad: Vec<f64>,
    /// First fitted sample (samples before it were held).
    pub first_fitted: usize,
    /// Instant of release, as in [`LogHealthRow`] \[s\]; of a log with holes in its first part.
    pub release_s: Option<f64>,
    /// Same length as `t_s`, from `first_fitted` on; NaN before it.
    pub simple_rad: Vec<f64>,
    /// As `simple_rad`, of the extensive model \[rad\].
    pub extensive_rad: Vec<f64>,
    /// Speed of the extensive model \[rad/s\], NaN before `first_fitted`.
    pub extensive_rate_rad_s: Vec<f64>,
    /// Setpoint \[rad\], for a driven log.
    pub setpoint_rad: Option<Vec<f64>>,
    /// Half a quantisation step \[rad\], for the band in the residual panel.
    pub half_step_rad: f64,
    /// RMS of the residual on the fitted samples \[rad\].
    pub simple_rms_rad: f64,
    /// The same of the extensive model \[rad\].
    pub extensive_rms_rad: f64,
}

/// A fitted model: its numbers and how the optimiser got there.
#[derive(Clone, Debug)]
pub struct ModelSummary {
    /// e.g. `simple (3.2)`.
    pub name: String,
    /// Over all fitted samples \[rad\].
    pub rms_rad: f64,
    /// The thesis's integral (3.7) \[rad^2 s\].
    pub criterion_rad2_s: f64,
    /// In the order in which they are shown.
    pub parameters: Vec<ParameterRow>,
    /// `lm`, `bfgs` or `dfp`.
    pub method: String,
    /// Why the optimiser stopped, e.g. `converged`.
    pub stop: String,
    /// Evaluations of the criterion or of the residuals.
    pub evaluations: usize,
    /// Criterion after each iteration \[rad^2 s\].
    pub trace_rad2_s: Vec<f64>,
}

/// One parameter of a fitted model.
#[derive(Clone, Debug)]
pub struct ParameterRow {
    /// e.g. `inertia`.
    pub name: String,
    /// e.g. `I*`; may be empty.
    pub symbol: String,
    /// Its unit.
    pub unit: String,
    /// What may be said of it.
    pub status: ParameterStatus,
    /// The estimate, or the value at which it was held.
    pub value: f64,
    /// 95 % interval that allows for correlated residuals; `None` for a held parameter.
    pub interval: Option<[f64; 2]>,
    /// 95 % interval as if residuals were white.
    pub interval_naive: Option<[f64; 2]>,
    /// What the engineer believed, where known.
    pub nominal: Option<f64>,
}

/// What may be said about a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterStatus {
    /// The logs determine it.
    Determined,
    /// Held at a given value; the others are conditional on it.
    Held,
    /// The logs do not determine it: show its name, not its value.
    NotDetermined,
}

/// Correlation matrix of fitted parameters, row-major.
#[derive(Clone, Debug, Default)]
pub struct Correlation {
    /// Parameter names, in the order of the rows.
    pub names: Vec<String>,
    /// Between -1 and 1.
    pub matrix: Vec<Vec<f64>>,
}

/// One point of the friction-speed curve.
#[derive(Clone, Copy, Debug)]
pub struct FrictionPoint {
    /// Speed \[rad/s\].
    pub rate_rad_s: f64,
    /// Friction torque \[N m\].
    pub torque_nm: f64,
    /// 95 % band \[N m\].
    pub low_nm: f64,
    /// Upper edge \[N m\].
    pub high_nm: f64,
}

/// Where the report comes from.
#[derive(Clone, Debug)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// The command line, with the paths as the user gave them.
    pub command: String,
    /// Input file and its SHA-256.
    pub inputs: Vec<(String, String)>,
}

/// An input file and its hash, for JSON.
#[derive(Clone, Debug, Serialize)]
pub struct HashedInput<'a> {
    /// As the user named it.
    pub file: &'a str,
    /// SHA-256 of its content, in hexadecimal digits.
    pub sha256: &'a str,
}

impl Provenance {
    /// Where an answer to a command comes from; the input files are hashed in their order, each once.
    ///
    /// # Errors
    /// [`LogError::Read`] where a file has gone since it was read.
    pub fn of(command: String, inputs: impl IntoIterator<Item = PathBuf>) -> Result<Self, LogError> {
        let mut hashed: Vec<(String, String)> = Vec::new();
        let files: Vec<Vec<PathBuf>> = inputs.into_iter().map(|path| log_files(&path)).collect::<Result<_, _>>()?;
        for file in files.into_iter().flatten() {
            let name = file.display().to_string();
            if hashed.iter().any(|(known, _)| *known == name) {
                continue;
            }
            let mut hash = Sha256::new();
            File::open(&file)
                .and_then(|mut reader| io::copy(&mut reader, &mut hash))
                .map_err(|source| LogError::Read { file, source })?;
            hashed.push((name, hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()));
        }
        Ok(Self { version: env!("CARGO_PKG_VERSION").to_owned(), command, inputs: hashed })
    }

    /// The inputs by name, for JSON.
    pub fn hashed(&self) -> Vec<HashedInput<'_>> {
        self.inputs.iter().map(|(file, sha256)| HashedInput { file, sha256 }).collect()
    }
}
