//! What can be wrong with a log or a study, said so that the user can mend it.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::place::Place;
use super::source::{Columns, Format, more, tell_mend, tell_others};

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
        column: &'static str,
        found: Vec<String>,
        hint: Option<String>,
    },
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
    #[error("{first}{}{}{}", more(*count), tell_others(others, *beyond), tell_mend(mend))]
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
}

/// What a file is that is not UTF-8 text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileKind {
    /// UTF-16, with or without a byte order mark.
    Utf16,
    /// A zip archive: also what spreadsheet programs save.
    Zip,
    /// A gzip file.
    Gzip,
    /// Bytes that no text has.
    Binary,
}

impl FileKind {
    fn fix(self) -> &'static str {
        match self {
            Self::Utf16 => "save it as `CSV UTF-8`",
            Self::Zip => "a spreadsheet has to be exported as CSV",
            Self::Gzip => "unpack it with gunzip first",
            Self::Binary => "export the recording as CSV",
        }
    }
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Utf16 => "the file is UTF-16",
            Self::Zip => "the file is a zip archive or a spreadsheet",
            Self::Gzip => "the file is compressed (gzip)",
            Self::Binary => "the file is binary",
        })
    }
}

/// What is wrong with a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the words of the message above them")]
pub enum CellFault {
    /// Nothing in it.
    Empty,
    /// A comma where the decimal point belongs.
    DecimalComma,
    /// A typographic minus sign (U+2212) or dash.
    Minus,
    /// NaN or infinity.
    NotFinite,
    /// Text; in the first row after the header often units.
    Text { first_row: bool, unit: &'static str },
    /// Neither 0 nor 1 in column `drive`.
    Drive,
    /// No list of numbers, or one of another length.
    List { expected: Option<usize> },
    /// A magnitude that no joint has.
    Absurd { limit: f64, unit: &'static str },
}

impl CellFault {
    fn describe(self, found: &str) -> String {
        match self {
            Self::Empty => "the cell is empty, expected a number; delete the row or fill the cell".into(),
            Self::DecimalComma => {
                format!(
                    "found `{found}`: a decimal comma, expected a decimal point, as in `{}`",
                    found.replace(',', ".")
                )
            }
            Self::Minus => format!("found `{found}`: a typographic minus sign, expected `-`"),
            Self::NotFinite => format!("found `{found}`, expected a finite number; delete rows without a reading"),
            Self::Text { first_row: true, unit } => {
                format!("found `{found}`, expected a number [{unit}]; if this row holds units, delete it")
            }
            Self::Text { first_row: false, unit } => format!("found `{found}`, expected a number [{unit}]"),
            Self::Drive => {
                format!("found `{found}`, expected 0 (motor off, joint free) or 1 (motor on, or joint held)")
            }
            Self::List { expected: None } => {
                format!("found `{found}`, expected a list of numbers such as `[0.1, 0.2]`")
            }
            Self::List { expected: Some(count) } => {
                format!("found `{found}`, expected a list of {count} numbers as in the rows before")
            }
            Self::Absurd { limit, unit } => {
                format!(
                    "found `{found}`, expected at most {limit:e} {unit} in magnitude; is the column in another unit?"
                )
            }
        }
    }
}

/// A column that is in another unit than the format's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the words of the message above them")]
pub enum UnitFault {
    /// The median step is longer than any joint logger's.
    Time { step_s: f64, unit: &'static str },
    /// Angles beyond two turns.
    Angle { value: f64 },
    /// Angles that are large whole numbers.
    Counts { value: f64 },
    /// Speeds that no joint reaches.
    Speed { median_rad_s: f64 },
    /// Setpoints that are in degrees while the angles are not.
    Setpoint { value: f64, angle_rad: f64 },
}

impl fmt::Display for UnitFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Time { step_s, unit } => {
                write!(f, "the median step is {step_s}: this looks like {unit}, expected seconds; convert the column")
            }
            Self::Angle { value } => write!(
                f,
                "found {value}, beyond 4 pi: this looks like degrees, expected radians; multiply the column by pi/180"
            ),
            Self::Counts { value } => write!(
                f,
                "found {value}, and whole numbers only: this looks like encoder counts (or degrees), expected radians"
            ),
            Self::Speed { median_rad_s } => write!(
                f,
                "the angle moves at {median_rad_s:.0} per second: this looks like degrees (or `t` in the wrong unit), expected radians and seconds"
            ),
            Self::Setpoint { value, angle_rad } => write!(
                f,
                "found {value} while `q` stays within {angle_rad} rad: this looks like degrees, expected radians; multiply the column by pi/180"
            ),
        }
    }
}

fn reading_fix(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::NotFound => "check the path and the folder you are in",
        io::ErrorKind::IsADirectory => "expected the name of a file in it",
        io::ErrorKind::PermissionDenied => "ask for permission to read it",
        _ => "check the disk and the file",
    }
}

fn writing_fix(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::IsADirectory => "this is a folder, expected the name of a file",
        io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
            "a file stands where a folder is needed, choose another folder"
        }
        io::ErrorKind::StorageFull => "make room on the disk",
        _ => "choose a folder that you may write to",
    }
}

fn list(names: &[String]) -> String {
    if names.is_empty() {
        return "no other columns".into();
    }
    let more = if names.len() > 12 { format!(" and {} more", names.len() - 12) } else { String::new() };
    let shown: Vec<String> = names.iter().take(12).map(|name| format!("`{name}`")).collect();
    shown.join(", ") + &more
}

fn joints_found(joints: &[String]) -> String {
    if joints.is_empty() {
        "the log names no joint; read it without naming one".into()
    } else {
        format!("the log has {}", list(joints))
    }
}

fn tail(hint: &Option<String>) -> String {
    hint.as_ref().map_or_else(String::new, |hint| format!("; {hint}"))
}

fn count(samples: usize) -> &'static str {
    if samples == 0 { "no samples" } else { "1 sample" }
}

fn separator(found: char) -> &'static str {
    match found {
        ';' => "semicolons",
        '\t' => "tabs",
        '|' => "bars",
        _ => "blanks",
    }
}

fn time_fix(time_s: f64, previous_s: f64) -> &'static str {
    if time_s == previous_s {
        "delete the doubled sample, or write `t` with more digits"
    } else {
        "sort the samples, or split the log where the clock was set back"
    }
}
