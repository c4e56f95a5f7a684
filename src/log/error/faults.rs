//! What can be wrong with a file, a cell, a unit.

use std::fmt;

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
    /// HDF5, which MATLAB writes as well.
    Hdf5,
    /// What MATLAB wrote before.
    Matlab,
    /// What Git leaves in the place of a large file.
    LfsPointer,
    /// Bytes that no text has.
    Binary,
}

impl FileKind {
    pub(super) fn fix(self) -> &'static str {
        match self {
            Self::Utf16 => "save it as `CSV UTF-8`",
            Self::Zip => "a spreadsheet has to be exported as CSV",
            Self::Gzip => "unpack it with gunzip first",
            Self::Hdf5 | Self::Matlab => "write its arrays as CSV, or as .npz (numpy.savez)",
            Self::LfsPointer => "fetch it by `git lfs pull`",
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
            Self::Hdf5 => "the file is HDF5",
            Self::Matlab => "the file is one of MATLAB",
            Self::LfsPointer => "the file is a pointer of Git LFS, and not what it points at",
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
    pub(super) fn describe(self, found: &str) -> String {
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
            Self::Text { unit: "s", .. } if found.contains(':') => {
                format!("found `{found}`, a date or a time of day, expected a number [s]; write stamps in seconds")
            }
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
    /// The mean step is shorter than any joint logger's, or than the way that the joint goes meanwhile allows.
    Haste { step_s: f64 },
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
            Self::Haste { step_s } => write!(
                f,
                "the mean step is {step_s:.1e} s, too short for any log, or for a joint that moves so: this looks like \
                 stamps in a larger unit, expected seconds; is `[columns] t.unit` right, where it is stated, or the column in minutes \
                 or hours?"
            ),
            Self::Angle { value } => write!(
                f,
                "found {value}, beyond 4 pi: this looks like degrees, expected radians; multiply the column by pi/180, or, where the \
                 joint turns so far, say unit = \"rad\" in [columns]"
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
