//! Reads the tables of an SQLite file, as far as a bag needs it: plain tables, no index, no query.
//!
//! After the file format as sqlite.org describes it (`fileformat2.html`). Pages are read one at a time; whatever a
//! damaged file says, no page is visited twice and no more is held than the file has.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

/// Deeper trees than this are none: 2^32 pages with two children each.
const DEEPEST: usize = 40;
/// Largest row that is read \[bytes\].
const LARGEST_ROW: u64 = 256 << 20;

/// A database.
pub(super) struct Database {
    file: File,
    page_size: usize,
    /// What of a page is used.
    usable: usize,
    pages: u32,
}

/// Takes a row with its number, or says what is wrong with it.
type TakeRow<'a> = &'a mut dyn FnMut(i64, &[Value<'_>]) -> Result<(), String>;

/// A value of a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'a> {
    Null,
    Integer(i64),
    Real,
    Text(&'a str),
    Blob(&'a [u8]),
}

impl Value<'_> {
    /// A whole number.
    pub fn integer(&self) -> Option<i64> {
        if let Self::Integer(value) = self { Some(*value) } else { None }
    }

    /// A text.
    pub fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }
}

/// A table by name: where it is rooted, and its columns.
#[derive(Clone, Debug)]
pub(super) struct Table {
    root: u32,
    columns: Vec<String>,
}

impl Table {
    /// Which column has this name.
    pub fn column(&self, name: &str) -> Result<usize, String> {
        self.columns
            .iter()
            .position(|column| column == name)
            .ok_or_else(|| format!("no column `{name}` in a table of messages"))
    }
}

impl Database {
    /// Opens a database.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn open(mut file: File) -> Result<Self, String> {
        let mut head = [0; 100];
        file.read_exact(&mut head).map_err(|_| "shorter than its header of 100 bytes".to_owned())?;
        let page_size = page_size(&head)?;
        if head[56..60] != [0, 0, 0, 1] && head[56..60] != [0; 4] {
            return Err("its texts are UTF-16, expected UTF-8".to_owned());
        }
        let usable = page_size - usize::from(head[20]);
        if usable < 480 {
            return Err(format!("{} of {page_size} bytes of a page reserved, expected at least 480 left", head[20]));
        }
        let length = file.seek(SeekFrom::End(0)).map_err(|error| error.to_string())?;
        let there = length / page_size as u64;
        let announced = u32::from_be_bytes([head[28], head[29], head[30], head[31]]);
        let is_valid = self::announced(&head).is_some();
        if is_valid && u64::from(announced) > there {
            return Err(format!("cut short: {announced} pages of {page_size} bytes announced, {there} are there"));
        }
        let pages = if is_valid { announced } else { u32::try_from(there).unwrap_or(u32::MAX) };
        Ok(Self { file, page_size, usable, pages })
    }

    /// The table with this name.
    ///
    /// # Errors
    /// Where there is none, or the list of tables is damaged.
    pub fn table(&mut self, name: &str) -> Result<Option<Table>, String> {
        let mut found = None;
        self.scan(1, &mut |_, row| {
            if let [kind, own, _, root, sql, ..] = row
                && kind.text() == Some("table")
                && own.text() == Some(name)
                && let (Some(root), Some(sql)) = (root.integer(), sql.text())
            {
                found = Some((u32::try_from(root).unwrap_or(0), column_names(sql)));
            }
            Ok(())
        })?;
        Ok(found.map(|(root, columns)| Table { root, columns }))
    }

    /// Hands over every row of a table with its number.
    ///
    /// # Errors
    /// Where the table is damaged, and that of `take`.
    pub fn rows(&mut self, table: &Table, take: TakeRow<'_>) -> Result<(), String> {
        self.scan(table.root, take)
    }

    fn page(&mut self, number: u32, into: &mut Vec<u8>) -> Result<(), String> {
        if number == 0 || number > self.pages {
            return Err(format!("damaged: page {number} is referred to, and there are {}", self.pages));
        }
        into.resize(self.page_size, 0);
        let at = u64::from(number - 1) * self.page_size as u64;
        let read = self.file.seek(SeekFrom::Start(at)).and_then(|_| self.file.read_exact(into));
        read.map_err(|error| format!("page {number} could not be read: {error}"))
    }

    fn scan(&mut self, root: u32, take: TakeRow<'_>) -> Result<(), String> {
        // Children that are still to be visited, innermost last.
        let mut levels = vec![vec![root]];
        let mut visited = 0_u64;
        let (mut page, mut payload) = (Vec::new(), Vec::new());
        while let Some(level) = levels.last_mut() {
            let Some(number) = level.pop() else {
                levels.pop();
                continue;
            };
            visited += 1;
            if visited > u64::from(self.pages) || levels.len() > DEEPEST {
                return Err("damaged: a table refers to itself".to_owned());
            }
            self.page(number, &mut page)?;
            let start = if number == 1 { 100 } else { 0 };
            let damaged = || format!("damaged: page {number} is no page of a table");
            let head = page.get(start..start + 12).ok_or_else(damaged)?;
            let (kind, cells) = (head[0], usize::from(u16::from_be_bytes([head[3], head[4]])));
            let right = u32::from_be_bytes([head[8], head[9], head[10], head[11]]);
            let pointers = start + if kind == 5 { 12 } else { 8 };
            match kind {
                5 => {
                    let mut children = vec![right];
                    for k in (0..cells).rev() {
                        let bytes =
                            pointer(&page, pointers + 2 * k).and_then(|at| page.get(at..at + 4)).ok_or_else(damaged)?;
                        children.push(u32::from_be_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
                    }
                    levels.push(children);
                }
                13 => {
                    let own = std::mem::take(&mut page);
                    for k in 0..cells {
                        let at = pointer(&own, pointers + 2 * k).ok_or_else(|| format!("damaged: page {number}"))?;
                        let row = self
                            .payload(&own, at, &mut payload)
                            .map_err(|what| format!("damaged: page {number}: {what}"))?;
                        let values =
                            record(&payload).ok_or_else(|| format!("damaged: page {number}: a row that is none"))?;
                        take(row, &values)?;
                    }
                    page = own;
                }
                _ => return Err(damaged()),
            }
        }
        Ok(())
    }

    /// The row's number; its bytes, with those on pages of their own, go to `into`.
    fn payload(&mut self, page: &[u8], at: usize, into: &mut Vec<u8>) -> Result<i64, String> {
        const CUT: &str = "a row ends beyond its page";
        let mut cell = page.get(at..self.usable.min(page.len())).ok_or(CUT)?;
        let length = varint(&mut cell).ok_or(CUT)? as u64;
        let row = varint(&mut cell).ok_or(CUT)?;
        if length > LARGEST_ROW || length > u64::from(self.pages) * self.page_size as u64 {
            return Err(format!("a row of {length} bytes is announced, more than the file holds"));
        }
        let (length, usable) = (length as usize, self.usable);
        let most = usable - 35;
        let local = if length <= most {
            length
        } else {
            let least = (usable - 12) * 32 / 255 - 23;
            let kept = least + (length - least) % (usable - 4);
            if kept <= most { kept } else { least }
        };
        into.clear();
        into.extend_from_slice(cell.get(..local).ok_or(CUT)?);
        if local == length {
            return Ok(row);
        }
        let next = cell.get(local..local + 4).ok_or(CUT)?;
        let mut next = u32::from_be_bytes([next[0], next[1], next[2], next[3]]);
        let mut overflow = Vec::new();
        while into.len() < length {
            self.page(next, &mut overflow)?;
            next = u32::from_be_bytes([overflow[0], overflow[1], overflow[2], overflow[3]]);
            let part = (length - into.len()).min(usable - 4);
            into.extend_from_slice(&overflow[4..4 + part]);
        }
        Ok(row)
    }
}

/// Of a page \[bytes\].
fn page_size(head: &[u8; 100]) -> Result<usize, String> {
    match u16::from_be_bytes([head[16], head[17]]) {
        1 => Ok(65_536),
        size if size.is_power_of_two() && size >= 512 => Ok(usize::from(size)),
        size => Err(format!("a page size of {size}, expected a power of two from 512")),
    }
}

/// The size that a header of 100 bytes announces \[bytes\]; `None` where the last writer did not know of it.
pub(super) fn announced(head: &[u8]) -> Option<u64> {
    let head: &[u8; 100] = head.try_into().ok()?;
    let pages = u32::from_be_bytes([head[28], head[29], head[30], head[31]]);
    let is_valid = head[24..28] == head[92..96] && pages > 0;
    is_valid.then_some(u64::from(pages) * page_size(head).ok()? as u64)
}

/// Where a cell of a page starts.
fn pointer(page: &[u8], at: usize) -> Option<usize> {
    let bytes = page.get(at..at + 2)?;
    Some(usize::from(u16::from_be_bytes([bytes[0], bytes[1]])))
}

/// A whole number of up to nine bytes, taken from the front.
fn varint(bytes: &mut &[u8]) -> Option<i64> {
    let mut value = 0_u64;
    for k in 0..9 {
        let (first, rest) = bytes.split_first()?;
        *bytes = rest;
        if k == 8 {
            return Some(((value << 8) | u64::from(*first)) as i64);
        }
        value = (value << 7) | u64::from(first & 0x7f);
        if first & 0x80 == 0 {
            break;
        }
    }
    Some(value as i64)
}

/// The values of a row.
fn record(payload: &[u8]) -> Option<Vec<Value<'_>>> {
    let mut head = payload;
    let length = usize::try_from(varint(&mut head)?).ok()?;
    let mut types = payload.get(payload.len() - head.len()..length)?;
    let mut body = payload.get(length..)?;
    let mut values = Vec::with_capacity(8);
    while !types.is_empty() {
        let kind = varint(&mut types)?;
        let size = match kind {
            0 | 8 | 9 => 0,
            1..=4 => kind as usize,
            5 => 6,
            6 | 7 => 8,
            12.. => usize::try_from((kind - 12) / 2).ok()?,
            _ => return None,
        };
        let (own, rest) = body.split_at_checked(size)?;
        body = rest;
        values.push(match kind {
            0 => Value::Null,
            1..=6 => {
                let negative = own[0] & 0x80 != 0;
                let start = if negative { -1_i64 } else { 0 };
                Value::Integer(own.iter().fold(start, |value, byte| (value << 8) | i64::from(*byte)))
            }
            7 => Value::Real,
            8 => Value::Integer(0),
            9 => Value::Integer(1),
            kind if kind % 2 == 0 => Value::Blob(own),
            _ => Value::Text(std::str::from_utf8(own).ok()?),
        });
    }
    Some(values)
}

/// Names of the columns in `CREATE TABLE`.
fn column_names(sql: &str) -> Vec<String> {
    let body =
        sql.find('(').and_then(|from| Some(&sql[from + 1..sql.rfind(')').filter(|to| *to > from)?])).unwrap_or("");
    let mut depth = 0;
    let parts = body.split(|c: char| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == ',' && depth == 0
    });
    let first =
        |part: &str| part.split_whitespace().next().map(|word| word.trim_matches(['"', '`', '[', ']']).to_owned());
    parts.filter_map(first).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_length_are_read() {
        for (bytes, value) in [(&[0x07][..], 7), (&[0x81, 0x00], 128), (&[0xff; 9], -1)] {
            assert_eq!(varint(&mut &*bytes), Some(value));
        }
        assert_eq!(varint(&mut &[0x80][..]), None);
    }

    #[test]
    fn columns_are_named_in_the_order_of_the_table() {
        let sql = "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp NUMERIC(1,2) NOT NULL, data BLOB NOT NULL)";
        assert_eq!(column_names(sql), ["id", "topic_id", "timestamp", "data"]);
    }

    #[test]
    fn a_row_is_numbers_and_texts() {
        let row = [6, 1, 0, 17, 16, 8, 0xfe, b'a', b'b', 7, 9];
        let values = record(&row);
        assert_eq!(
            values,
            Some(vec![Value::Integer(-2), Value::Null, Value::Text("ab"), Value::Blob(&[7, 9]), Value::Integer(0)])
        );
    }
}
