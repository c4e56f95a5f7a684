//! How a command fails, and with which exit code.

use crate::fleet::FleetError;
use crate::gap::GapError;
use crate::gap::clamped::ClampedCaseError;
use crate::gap::inverse::TorqueError;
use crate::gap::neighbours::RepeatError;
use crate::gap::robot::RobotGapError;
use crate::identify::{CaseError, DropError};
use crate::log::LogError;
use crate::report::{DraftError, ReportError};
use crate::robot::RobotError;
use crate::robot::description::DescriptionError;
use crate::robot::simulate::SimulateError;
use crate::robot::tree::TreeError;
use crate::synth::SynthError;
use crate::thesis::TablesError;
use std::path::PathBuf;

/// The answer is "no": nothing moved, or a gate failed.
pub(super) const NO: u8 = 1;
/// The command line cannot be understood.
pub(super) const USAGE: u8 = 2;
/// A file is wrong.
const DATA: u8 = 3;
/// The search did not converge, or the motion diverged.
pub(super) const NOT_CONVERGED: u8 = 4;
/// A file cannot be read or written.
pub(super) const IO: u8 = 5;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// A log or study cannot be read, is wrong, or a result cannot be written.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The logs do not make a case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// No fit can be made.
    #[error(transparent)]
    Drop(#[from] DropError),
    /// No diagnosis can be made.
    #[error(transparent)]
    Gap(#[from] GapError),
    /// A robot study does not make a case.
    #[error(transparent)]
    RobotCase(Box<SimulateError>),
    /// The study of a robot with a clamped base does not make a case.
    #[error(transparent)]
    ClampedCase(Box<ClampedCaseError>),
    /// No diagnosis of a robot can be made.
    #[error(transparent)]
    RobotGap(#[from] RobotGapError),
    /// No study can be written from the logs.
    #[error(transparent)]
    Draft(#[from] DraftError),
    /// A figure cannot be drawn.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The command line asks for something impossible.
    #[error("{0}")]
    Usage(String),
    /// A result would be written over a file that was read.
    #[error("{}: a result would be written over this input; choose another --out or --json", input.display())]
    Overwrites {
        /// The input.
        input: PathBuf,
    },
    /// A result cannot be put into JSON or TOML.
    #[error("a result cannot be written down: {0}; please report this")]
    Encode(String),
    /// Standard output takes no more.
    #[error("standard output could not be written: {0}")]
    Print(String),
    /// A motion diverged.
    #[error("{file}: {source}; check the parameters' units and sizes")]
    Diverged {
        /// The log that was predicted.
        file: String,
        /// When it ran away.
        source: crate::pendulum::Diverged,
    },
    /// A simulated robot ran away; what was computed until then is written.
    #[error(transparent)]
    RanAway(Box<crate::robot::simulate::Diverged>),
    /// A fit file cannot be understood.
    #[error("{}: {what}", file.display())]
    FitFile {
        /// The file.
        file: PathBuf,
        /// What is wrong with it, and what was expected.
        what: String,
    },
    /// The description that a fit file names is not there.
    #[error("{}: its description is neither {} nor {}; name it by --model FILE", file.display(), named.display(), beside.display())]
    NoDescription {
        /// The fit file.
        file: PathBuf,
        /// As it stands there.
        named: PathBuf,
        /// The same from the fit file's folder.
        beside: PathBuf,
    },
    /// The robot cannot be read or is none.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// A robot description cannot be used.
    #[error(transparent)]
    Description(Box<DescriptionError>),
    /// A described robot cannot be held so.
    #[error(transparent)]
    Tree(#[from] TreeError),
    /// A simulation cannot begin.
    #[error(transparent)]
    Simulate(Box<SimulateError>),
    /// A file of states cannot be understood.
    #[error("{}: {what}", file.display())]
    States {
        /// The file.
        file: PathBuf,
        /// Where in it, what was found, and what was expected.
        what: String,
    },
    /// A state has no finite answer.
    #[error("{}: {what}: the answer is not finite; check the units and sizes of its numbers", file.display())]
    NotFinite {
        /// The file.
        file: PathBuf,
        /// The state.
        what: String,
    },
    /// No logs can be made.
    #[error(transparent)]
    Synth(Box<SynthError>),
    /// The tables cannot be made.
    #[error(transparent)]
    Tables(Box<TablesError>),
    /// A fleet cannot run.
    #[error(transparent)]
    Fleet(#[from] FleetError),
    /// The worker threads cannot be started.
    #[error("cannot start the worker threads: {0}")]
    Threads(String),
}

impl From<TablesError> for CliError {
    fn from(error: TablesError) -> Self {
        CliError::Tables(Box::new(error))
    }
}

impl From<SynthError> for CliError {
    fn from(error: SynthError) -> Self {
        CliError::Synth(Box::new(error))
    }
}

impl From<DescriptionError> for CliError {
    fn from(error: DescriptionError) -> Self {
        CliError::Description(Box::new(error))
    }
}

impl From<ClampedCaseError> for CliError {
    fn from(error: ClampedCaseError) -> Self {
        CliError::ClampedCase(Box::new(error))
    }
}

impl From<TorqueError> for CliError {
    fn from(error: TorqueError) -> Self {
        match error {
            TorqueError::Case(error) => error.into(),
            TorqueError::Gap(error) => error.into(),
        }
    }
}

impl From<RepeatError> for CliError {
    fn from(error: RepeatError) -> Self {
        match error {
            RepeatError::Simulate(error) => CliError::Simulate(error),
            RepeatError::Rejected(error) => CliError::Drop(error.into()),
        }
    }
}

impl CliError {
    /// Whether a file or an output cannot be read or written, which may pass.
    pub fn is_io(&self) -> bool {
        self.exit_code() == IO
    }

    /// The exit code of the specification.
    pub fn exit_code(&self) -> u8 {
        match self {
            CliError::Log(error) | CliError::Case(CaseError::Log(error)) | CliError::Robot(RobotError::File(error)) => {
                of_file(error)
            }
            CliError::Tables(error) => match error.as_ref() {
                TablesError::Log(error) | TablesError::Case(CaseError::Log(error)) => of_file(error),
                TablesError::Rejected(_) | TablesError::Diverged(_) => NOT_CONVERGED,
                _ => DATA,
            },
            CliError::ClampedCase(error) => match error.as_ref() {
                ClampedCaseError::Log(error) => of_file(error),
                ClampedCaseError::Description(error) if error.is_io() => IO,
                _ => DATA,
            },
            CliError::Draft(error) => match error {
                DraftError::Log(error) => of_file(error),
                DraftError::Description(error) if error.is_io() => IO,
                DraftError::NoJoint { .. } => USAGE,
                _ => DATA,
            },
            CliError::RobotCase(error) | CliError::Simulate(error) => match error.as_ref() {
                SimulateError::File(error) | SimulateError::Robot(RobotError::File(error)) => of_file(error),
                // All that a robot study is made of stands in files.
                _ if matches!(self, CliError::RobotCase(_)) => DATA,
                SimulateError::Value { .. } | SimulateError::NoSet { .. } => USAGE,
                _ => DATA,
            },
            CliError::Synth(error) => match error.as_ref() {
                SynthError::File(error) => of_file(error),
                SynthError::Diverged { .. } => NOT_CONVERGED,
                SynthError::Threads(_) => IO,
                _ => DATA,
            },
            CliError::Case(CaseError::JointsDiffer { .. }) | CliError::Usage(_) | CliError::Overwrites { .. } => USAGE,
            CliError::Drop(DropError::Directive(_)) | CliError::Gap(GapError::Demand(_)) => USAGE,
            CliError::Drop(DropError::NeverMoved) => NO,
            CliError::Gap(GapError::NoNominal) => DATA,
            CliError::Gap(GapError::NeverMoved) | CliError::RobotGap(RobotGapError::NeverMoved) => NO,
            CliError::Gap(_)
            | CliError::RobotGap(_)
            | CliError::Drop(_)
            | CliError::Diverged { .. }
            | CliError::RanAway(_)
            | CliError::NotFinite { .. } => NOT_CONVERGED,
            CliError::Description(error) if error.is_io() => IO,
            CliError::Description(_) | CliError::Tree(_) => DATA,
            CliError::Case(_) | CliError::FitFile { .. } | CliError::Robot(_) | CliError::States { .. } => DATA,
            CliError::Fleet(FleetError::Pattern { .. } | FleetError::Nothing { .. } | FleetError::Busy { .. }) => USAGE,
            CliError::Fleet(_)
            | CliError::NoDescription { .. }
            | CliError::Report(_)
            | CliError::Threads(_)
            | CliError::Encode(_)
            | CliError::Print(_) => IO,
        }
    }
}

fn of_file(error: &LogError) -> u8 {
    if error.is_io() { IO } else { DATA }
}

impl From<SimulateError> for CliError {
    fn from(error: SimulateError) -> Self {
        CliError::Simulate(Box::new(error))
    }
}
