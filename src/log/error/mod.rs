//! What can be wrong with a log or a study, said so that the user can mend it.

mod faults;
mod words;

pub use faults::{CellFault, FileKind, UnitFault};

use std::io;
use std::path::{Path, PathBuf};

use super::columns::Columns;
use super::format::Format;
use super::place::Place;
use words::{
    count, joints_found, list, more, reading_fix, separator, tail, tell_mend, tell_others, time_fix, writing_fix,
};

/// Why a log or a study could not be read or written.
///
/// Every message names the file and, where it can, the line, the column or key, what was found and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the words of the message above them")]
pub enum LogError {
    /// The file could not be opened or read.
    #[error("{}: could not be read: {source}; {}", file.display(), reading_fix(source))]
    Read { file: PathBuf, source: io::Error },
    /// The file could not be written; nothing half-written is left behind.
    #[error("{}: could not be written: {source}; {}", file.display(), writing_fix(source))]
    Write { file: PathBuf, source: io::Error },
    /// A log that a study names is not there.
    #[error("{at}: the log `{}` could not be opened: {source}; paths are relative to the study{}", path.display(), at.excerpt())]
    NamedLog { at: Box<Place>, path: PathBuf, source: io::Error },
    /// A byte that is not UTF-8.
    #[error("{at}: byte 0x{byte:02x} is not UTF-8 (Latin-1 or Windows-1252?); save the file as UTF-8{}", at.excerpt())]
    NotUtf8 { at: Box<Place>, byte: u8 },
    /// The file is not a text file in an encoding that is read here.
    #[error("{}: line 1: {found}, expected UTF-8 text; {}", file.display(), found.fix())]
    NotText { file: PathBuf, found: FileKind },
    /// The file has no content.
    #[error("{}: the file is empty, expected a header row such as `t,q` and at least two samples", file.display())]
    Empty { file: PathBuf },
    /// Fewer than two samples.
    #[error("{at}: {} after the header, expected at least 2; was the recording cut off?{}", count(*samples), at.excerpt())]
    TooFewSamples { at: Box<Place>, samples: usize },
    /// Nothing was asked of a joint before its last reading.
    #[error("{at}: the setpoints begin at {asked_from_s:.3} s, {:.3} s after the last reading (at {read_to_s:.3} s), expected readings and setpoints that overlap in time; do their clocks differ?", asked_from_s - read_to_s)]
    NoOverlap { at: Box<Place>, read_to_s: f64, asked_from_s: f64 },
    /// The first row holds numbers.
    #[error("{at}: the first row holds numbers, expected column names; add a header row such as `t,q`{}", at.excerpt())]
    NoHeader { at: Box<Place> },
    /// The cells are not separated by commas.
    #[error("{at}: the cells are separated by {}, expected commas (with `.` as decimal mark); export the log as comma-separated CSV{}", separator(*found), at.excerpt())]
    Separator { at: Box<Place>, found: char },
    /// A column that is needed is not there.
    #[error("{at}: column `{column}` is missing; found {}{}{}", list(found), tail(hint), at.excerpt())]
    MissingColumn { at: Box<Place>, column: String, found: Vec<String>, hint: Option<String> },
    /// A column is there twice.
    #[error("{at}: the column appears twice, as cells {first} and {second} of the header; rename or delete one{}", at.excerpt())]
    DoubledColumn { at: Box<Place>, first: usize, second: usize },
    /// A log of several joints where one of one joint was asked for.
    #[error("{at}: column `q` is missing: this is a log of several joints ({}); choose one with --joint or as a study's `[joint] name`, or keep its columns only, named `t,q`{}", list(joints), at.excerpt())]
    SeveralJoints { at: Box<Place>, joints: Vec<String> },
    /// A log of several joints, and none of them is the study's.
    #[error(
        "{at}: no joint `{joint}`, which is the study's `[joint] name`: this is a log of several joints ({}); name one of them there (or by --joint where the command has it)",
        list(joints)
    )]
    NotTheStudysJoint { at: Box<Place>, joint: String, joints: Vec<String> },
    /// The log does not have the joint that was asked for.
    #[error("{at}: no column `{joint}.q`; {}{}", joints_found(joints), at.excerpt())]
    NoSuchJoint { at: Box<Place>, joint: String, joints: Vec<String> },
    /// A row with more or fewer cells than the header.
    #[error("{at}: {found} cells, expected {expected} as in the header{}{}", tail(hint), at.excerpt())]
    RowLength { at: Box<Place>, found: usize, expected: usize, hint: Option<String> },
    /// A cell that cannot be used.
    #[error("{at}: {}{}", fault.describe(found), at.excerpt())]
    Cell { at: Box<Place>, found: String, fault: CellFault },
    /// Time repeats or runs back.
    #[error("{at}: time {} from {previous_s} s (line {previous_line}) to {time_s} s, expected strictly increasing; {}{}", if time_s == previous_s { "repeats" } else { "runs back" }, time_fix(*time_s, *previous_s), at.excerpt())]
    TimeOrder { at: Box<Place>, previous_line: u64, time_s: f64, previous_s: f64 },
    /// A hole in the recording.
    #[error("{at}: a gap of {gap_s:.1} s between lines {previous_line} and {}, expected at most 60 s; split the log there{}", at.line, at.excerpt())]
    TimeGap { at: Box<Place>, previous_line: u64, gap_s: f64 },
    /// A column in another unit than the format's.
    #[error("{at}: {fault}{}", at.excerpt())]
    Units { at: Box<Place>, fault: UnitFault },
    /// Log and study disagree about the sampling period by about a thousand.
    #[error("{}: column `t`: median step {median_s} s, but `[sensor] period` is {period_s} s, about 1000 times {}; {}", file.display(), if median_s > period_s { "less" } else { "more" }, if median_s > period_s { "`t` looks like milliseconds, expected seconds" } else { "the period looks like milliseconds, expected seconds" })]
    Period { file: PathBuf, median_s: f64, period_s: f64 },
    /// A log lacks the column that its `drive` needs; `entry` counts the study's logs from 1.
    #[error("{}: line 1: column `{column}` is missing, which drive = \"{drive}\" in [[log]] {entry} of {} needs; found {}{}", file.display(), study.display(), list(found), tail(hint))]
    MissingInput {
        file: Box<Path>,
        study: Box<Path>,
        entry: usize,
        drive: &'static str,
        column: Box<str>,
        found: Vec<String>,
        hint: Option<String>,
    },
    /// The part of a log that `[[log]]` number `entry`, from 1, takes has no motion.
    #[error("{}: [[log]] {entry} from, to: {samples} sample{} in {log}, expected at least 2; its stamps go from {begins_s} to {ends_s} s", study.display(), if *samples == 1 { "" } else { "s" })]
    EmptyWindow { study: Box<Path>, entry: usize, log: String, samples: usize, begins_s: f64, ends_s: f64 },
    /// An array that is no column of a log; `index` counts from 0.
    #[error("{log}: array `{array}`{}: {what}", index.map_or_else(String::new, |index| format!("[{index}]")))]
    Array { log: String, array: &'static str, index: Option<usize>, what: String },
    /// A log that is commanded, and nothing says how.
    #[error("{}: column `{column}` varies, and nothing says what moves the joint: expected {} beside it with `schema = 1`, `[[log]]` and in it `drive = \"{}\"`{}, or `drive = \"off\"` where the motor is off and the joint swings freely", file.display(), file.with_extension("toml").display(), if *column == "tau" { "torque" } else { "position" }, if *column == "tau" { "" } else { " (which needs `[motor]` with kp and kd)" })]
    DriveUnknown { file: PathBuf, column: &'static str },
    /// A torque or current without its sign, where the study says what it is.
    #[error("{}: column `tau`: no negative value although the joint moves both ways: this is a magnitude (some drives report only that), expected torque or current with its sign; log the signed value, or leave tau_is out", file.display())]
    UnsignedTorque { file: PathBuf },
    /// Not TOML, an unknown key, or a value of the wrong type; the parser's own message shows the line.
    #[error("{}: {}{}", file.display(), source.to_string().trim_end(), hint.map_or_else(String::new, |hint| format!("; {hint}")))]
    Toml { file: PathBuf, source: Box<toml::de::Error>, hint: Option<&'static str> },
    /// A log where a study was asked for.
    #[error("{} is a log, not a study; write one with `aibo-fit init {}`", file.display(), file.display())]
    LogAsStudy { file: PathBuf },
    /// Several numbers that are needed are not there.
    #[error("{}: {table} does not say {}; fill in what you believe of them", file.display(), keys.join(", "))]
    MissingNumbers { file: PathBuf, table: &'static str, keys: Vec<&'static str> },
    /// A key that is needed is not there.
    #[error("{}: key `{key}` is missing; expected {expected}", file.display())]
    MissingKey { file: PathBuf, key: String, expected: String },
    /// A value that cannot be.
    #[error("{at}: found {found}, expected {expected}{}", at.excerpt())]
    Value { at: Box<Place>, found: String, expected: String },
    /// A robot study where a joint study was asked for.
    #[error("{at}: this is a robot study (it has a table `[robot]`), expected a joint study with a table `[joint]`; read it with a command that takes robot studies{}", at.excerpt())]
    RobotStudy { at: Box<Place> },
    /// Several things wrong with one file.
    #[error("{first}{}{}{}", more(*count), tell_others(others, *beyond), tell_mend(mend, first, others))]
    Defects { first: Box<LogError>, count: usize, others: Vec<(LogError, usize)>, beyond: usize, mend: Columns },
    /// A file of a known format that is damaged, or holds nothing that can be read.
    #[error("{}: {format}: {what}", file.display())]
    Format { file: PathBuf, format: Format, what: String },
    /// The columns of a log to be written differ in length.
    #[error("{}: column `{column}` has {found} values, expected {expected} as in `t`; nothing was written", file.display())]
    Ragged { file: PathBuf, column: &'static str, found: usize, expected: usize },
}

impl LogError {
    /// Whether a file could not be opened, read or written (exit code 5), as opposed to bad data in it (3).
    pub fn is_io(&self) -> bool {
        match self {
            Self::Defects { first, .. } => first.is_io(),
            error => matches!(error, Self::Read { .. } | Self::Write { .. } | Self::NamedLog { .. }),
        }
    }

    /// The names of a table's columns, where none of them tells which is an angle.
    pub(in crate::log) fn names_without_angle(&self) -> Option<&[String]> {
        match self {
            Self::MissingColumn { column, found, hint: None, .. } if column == "q" || column.ends_with(".q") => {
                Some(found.as_slice())
            }
            _ => None,
        }
    }
}
