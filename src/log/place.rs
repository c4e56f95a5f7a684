//! Where in a file an error is: the line, the cell or key, and the line itself with a caret.

use std::fmt;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Longest piece of a line that an excerpt shows, in characters.
const SHOWN: usize = 96;
/// Longest piece of a line that is read back, in bytes; logs with longer lines are shown from their start only.
const READ_BACK: usize = 16_384;

/// What an error in a file is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The line as a whole.
    Line,
    /// A column of a log, by its name in the header.
    Column(String),
    /// A key of a study, with its table: `[joint] inertia`, `[[log]] 2 extra.mass`.
    Key(String),
}

/// A place in a text file: file, line, column or key, and the line itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file as the user named it.
    pub file: PathBuf,
    /// Line number as an editor counts, from 1; 0 in a file that has no lines.
    pub line: u64,
    /// The column or key that is wrong.
    pub subject: Subject,
    /// The line without its end; empty where it cannot be read back (a pipe).
    pub text: String,
    /// The characters of `text` that are wrong; empty where it is the line as a whole.
    pub caret: Range<usize>,
}

impl Place {
    /// The offending line with a caret under what is wrong, on lines of its own; empty where there is no text.
    pub fn excerpt(&self) -> String {
        if self.text.is_empty() {
            return String::new();
        }
        let chars: Vec<char> = self.text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let start =
            if self.caret.end.min(chars.len()) > SHOWN { self.caret.start.saturating_sub(SHOWN / 2) } else { 0 };
        let start = start.min(chars.len());
        let end = (start + SHOWN).min(chars.len());
        let (head, tail) = (if start > 0 { "..." } else { "" }, if end < chars.len() { "..." } else { "" });
        let shown: String = chars[start..end].iter().collect();
        let number = self.line.to_string();
        let mut out = format!("\n  {number} | {head}{shown}{tail}");
        if !self.caret.is_empty() {
            let indent = head.len() + self.caret.start.saturating_sub(start);
            let width = self.caret.len().min(SHOWN);
            out += &format!("\n  {} | {}{}", " ".repeat(number.len()), " ".repeat(indent), "^".repeat(width));
        }
        out
    }

    /// A file without lines as a whole.
    pub(super) fn in_file(file: &Path) -> Self {
        Self { file: file.to_path_buf(), line: 0, subject: Subject::Line, text: String::new(), caret: 0..0 }
    }

    /// A channel of a file without lines.
    pub(super) fn of_column(file: &Path, name: &str) -> Self {
        Self { subject: Subject::Column(name.to_owned()), ..Self::in_file(file) }
    }

    /// The place of a byte span in a text that is at hand.
    pub(super) fn in_text(file: &Path, text: &str, span: Range<usize>, subject: Subject) -> Self {
        let from = floor_boundary(text, span.start);
        let to = floor_boundary(text, span.end).max(from);
        let line_start = text[..from].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[from..].find('\n').map_or(text.len(), |i| from + i);
        let caret_start = text[line_start..from].chars().count();
        let caret_end = caret_start + text[from..to.min(line_end)].chars().count();
        Self {
            file: file.to_path_buf(),
            line: 1 + text[..line_start].matches('\n').count() as u64,
            subject,
            text: text[line_start..line_end].trim_end().to_owned(),
            caret: caret_start..caret_end,
        }
    }

    /// The place of a row of a log that starts at `byte`; `cell` is the field that is wrong.
    ///
    /// The file is read again up to there: this happens once, on the way out, and keeps the reading itself free of
    /// book-keeping.
    pub(super) fn in_log(file: &Path, byte: u64, line: u64, subject: Subject, cell: Option<usize>) -> Self {
        let (line, text) = line_at(file, byte).unwrap_or((line, String::new()));
        let caret = cell.map_or(0..0, |index| cell_range(&text, index));
        Self { file: file.to_path_buf(), line, subject, text, caret }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if self.line > 0 {
            write!(f, ": line {}", self.line)?;
        }
        match &self.subject {
            Subject::Line => Ok(()),
            Subject::Column(name) if self.line == 0 => write!(f, ": `{name}`"),
            Subject::Column(name) => write!(f, ", column `{name}`"),
            Subject::Key(name) => write!(f, ", key `{name}`"),
        }
    }
}

fn floor_boundary(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

/// Number and text of the first line that is not blank at or after `byte`.
///
/// `None` for pipes, which cannot be read twice (opening one again may block), and for files that have gone.
fn line_at(file: &Path, byte: u64) -> Option<(u64, String)> {
    if !std::fs::metadata(file).ok()?.is_file() {
        return None;
    }
    let mut input = BufReader::new(File::open(file).ok()?);
    let (mut line, mut at, mut after_cr) = (1_u64, 0_u64, false);
    let mut text = Vec::new();
    loop {
        let chunk = input.fill_buf().ok()?;
        if chunk.is_empty() {
            break;
        }
        let length = chunk.len();
        for &b in chunk {
            let end_of_line = b == b'\n' || b == b'\r';
            if !text.is_empty() && (end_of_line || text.len() >= READ_BACK) {
                return Some((line, clean(&text)));
            }
            if end_of_line {
                line += u64::from(!(b == b'\n' && after_cr));
            } else if at >= byte {
                text.push(b);
            }
            after_cr = b == b'\r';
            at += 1;
        }
        input.consume(length);
    }
    Some((line, clean(&text)))
}

fn clean(line: &[u8]) -> String {
    String::from_utf8_lossy(line.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(line)).into_owned()
}

/// Character range of the cell with this index, without the blanks around it; the line's end if there is no such cell.
fn cell_range(text: &str, index: usize) -> Range<usize> {
    let chars: Vec<char> = text.chars().collect();
    let (mut cell, mut start, mut quoted) = (0, 0, false);
    let mut range = None;
    for (i, &c) in chars.iter().enumerate() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => {
                if cell == index {
                    range = Some(start..i);
                    break;
                }
                (cell, start) = (cell + 1, i + 1);
            }
            _ => {}
        }
    }
    let range = range.unwrap_or(if cell == index { start..chars.len() } else { chars.len()..chars.len() });
    let from = range.clone().find(|&i| !chars[i].is_whitespace()).unwrap_or(range.start);
    let to = range.clone().rev().find(|&i| !chars[i].is_whitespace()).map_or(from, |i| i + 1);
    from..to.max(from + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caret_stands_under_the_cell() {
        let place = Place {
            file: "a.csv".into(),
            line: 12,
            subject: Subject::Column("q".into()),
            text: "0.008, abc ,1".into(),
            caret: cell_range("0.008, abc ,1", 1),
        };
        assert_eq!(place.to_string(), "a.csv: line 12, column `q`");
        assert_eq!(place.excerpt(), "\n  12 | 0.008, abc ,1\n     |        ^^^");
    }

    #[test]
    fn caret_of_an_empty_or_missing_cell_is_one_wide() {
        assert_eq!(cell_range("1,,3", 1), 2..3);
        assert_eq!(cell_range("1,2", 2), 3..4);
        assert_eq!(cell_range("\"1,5\",2", 0), 0..5);
    }

    #[test]
    fn long_lines_are_cut_around_the_caret() {
        let text = format!("{},bad,{}", "1,".repeat(300), "2,".repeat(300));
        let caret = 601..604;
        let place = Place { file: "a".into(), line: 7, subject: Subject::Line, text, caret };
        let excerpt = place.excerpt();
        let lines: Vec<&str> = excerpt.lines().collect();
        let column = lines[2].find('^').unwrap();
        assert_eq!(&lines[1][column..column + 3], "bad");
    }

    #[test]
    fn span_in_a_text_becomes_line_and_columns() {
        let text = "schema = 1\n[joint]\ninertia = -1\n";
        let at = text.find("-1").unwrap();
        let place = Place::in_text(Path::new("s.toml"), text, at..at + 2, Subject::Key("[joint] inertia".into()));
        assert_eq!((place.line, place.caret, place.text.as_str()), (3, 10..12, "inertia = -1"));
    }
}
