//! The entries of a zip file, stored or deflated, unpacked as they are read.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use miniz_oxide::inflate::stream::{InflateState, inflate};
use miniz_oxide::{DataFormat, MZError, MZFlush, MZStatus};

use super::bytes::size;
use super::crc::Crc;

/// Where the end of the directory is looked for: its own length and the longest comment \[bytes\].
const LONGEST_END: u64 = 22 + 65_535;
/// Entries at the most.
const MOST_ENTRIES: u64 = 4096;
/// The directory at the most \[bytes\].
const LONGEST_DIRECTORY: u64 = 1 << 22;

/// An entry of a zip file.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// As stored.
    pub name: String,
    /// Unpacked, as the directory says \[bytes\].
    pub size: u64,
    packed: u64,
    is_deflated: bool,
    checksum: u32,
    offset: u64,
}

/// A zip file.
pub(super) struct Archive {
    file: File,
    /// As the directory lists them.
    pub entries: Vec<Entry>,
}

fn at<const N: usize>(bytes: &[u8], from: usize) -> [u8; N] {
    bytes.get(from..from + N).and_then(|part| part.try_into().ok()).unwrap_or([0; N])
}

fn short(bytes: &[u8], from: usize) -> usize {
    usize::from(u16::from_le_bytes(at(bytes, from)))
}

fn word(bytes: &[u8], from: usize) -> u64 {
    u64::from(u32::from_le_bytes(at(bytes, from)))
}

fn long(bytes: &[u8], from: usize) -> u64 {
    u64::from_le_bytes(at(bytes, from))
}

impl Archive {
    /// Reads the directory.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn open(mut file: File) -> Result<Self, String> {
        let length = size(&mut file)?;
        let from = length.saturating_sub(LONGEST_END);
        let tail = read_at(&mut file, from, (length - from) as usize)?;
        let end = tail.windows(4).rposition(|bytes| bytes == b"PK\x05\x06");
        let end = end.ok_or("cut short: it has no directory at its end")?;
        let (mut count, mut bytes, mut start) =
            (short(&tail, end + 10) as u64, word(&tail, end + 12), word(&tail, end + 16));
        if let Some(locator) = end.checked_sub(20).filter(|at| tail[*at..].starts_with(b"PK\x06\x07")) {
            let record = read_at(&mut file, long(&tail, locator + 8).min(length), 56)?;
            if record.starts_with(b"PK\x06\x06") {
                (count, bytes, start) = (long(&record, 32), long(&record, 40), long(&record, 48));
            }
        }
        if count > MOST_ENTRIES || bytes > LONGEST_DIRECTORY || start.checked_add(bytes).is_none_or(|to| to > length) {
            return Err(format!("damaged: a directory of {count} entries in {bytes} bytes is announced"));
        }
        let directory = read_at(&mut file, start, bytes as usize)?;
        let mut rest = &directory[..];
        let mut entries = Vec::new();
        for _ in 0..count {
            let (name, extra, comment) = (short(rest, 28), short(rest, 30), short(rest, 32));
            if !rest.starts_with(b"PK\x01\x02") || rest.len() < 46 + name + extra + comment {
                return Err("damaged: its directory cannot be read".to_owned());
            }
            let mut entry = Entry {
                name: String::from_utf8_lossy(&rest[46..46 + name]).into_owned(),
                size: word(rest, 24),
                packed: word(rest, 20),
                is_deflated: short(rest, 10) == 8,
                checksum: word(rest, 16) as u32,
                offset: word(rest, 42),
            };
            if !matches!(short(rest, 10), 0 | 8) {
                return Err(format!(
                    "`{}` is packed by method {}, expected deflate or none",
                    entry.name,
                    short(rest, 10)
                ));
            }
            entry.widen(&rest[46 + name..46 + name + extra]);
            entries.push(entry);
            rest = &rest[46 + name + extra + comment..];
        }
        Ok(Self { file, entries })
    }

    /// What an entry holds; the checksum is compared when all of it has been read.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn content(&mut self, entry: &Entry) -> Result<impl Read + '_, String> {
        let head = read_at(&mut self.file, entry.offset, 30)?;
        if !head.starts_with(b"PK\x03\x04") {
            return Err("damaged: it is not where the directory says".to_owned());
        }
        let skipped = (short(&head, 26) + short(&head, 28)) as u64;
        let start = entry.offset.saturating_add(30).saturating_add(skipped);
        self.file.seek(SeekFrom::Start(start)).map_err(|error| error.to_string())?;
        let packed = (&mut self.file).take(entry.packed);
        let inflate = entry.is_deflated.then(|| InflateState::new_boxed(DataFormat::Raw));
        Ok(Content {
            packed,
            inflate,
            input: vec![0; 1 << 16],
            from: 0,
            to: 0,
            crc: Crc::default(),
            left: entry.size,
            checksum: entry.checksum,
        })
    }
}

impl Entry {
    /// Takes sizes and place from the field for large files.
    fn widen(&mut self, mut extra: &[u8]) {
        while extra.len() >= 4 {
            let (id, length) = (short(extra, 0), short(extra, 2));
            let Some(mut field) = extra.get(4..4 + length) else { return };
            if id == 1 {
                for value in [&mut self.size, &mut self.packed, &mut self.offset] {
                    if *value == u64::from(u32::MAX) && field.len() >= 8 {
                        *value = long(field, 0);
                        field = &field[8..];
                    }
                }
            }
            extra = &extra[4 + length..];
        }
    }
}

fn read_at(file: &mut File, from: u64, length: usize) -> Result<Vec<u8>, String> {
    let mut bytes = vec![0; length];
    let read = file.seek(SeekFrom::Start(from)).and_then(|_| file.read_exact(&mut bytes));
    read.map_err(|error| {
        if error.kind() == io::ErrorKind::UnexpectedEof { "cut short".to_owned() } else { error.to_string() }
    })?;
    Ok(bytes)
}

struct Content<'a> {
    packed: io::Take<&'a mut File>,
    inflate: Option<Box<InflateState>>,
    input: Vec<u8>,
    /// What of the input is still to be unpacked.
    from: usize,
    to: usize,
    crc: Crc,
    /// Still to come, as the directory says.
    left: u64,
    checksum: u32,
}

impl Content<'_> {
    fn more(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let Some(state) = &mut self.inflate else { return self.packed.read(into) };
        loop {
            if self.from == self.to {
                (self.from, self.to) = (0, self.packed.read(&mut self.input)?);
            }
            let done = inflate(state, &self.input[self.from..self.to], into, MZFlush::None);
            self.from += done.bytes_consumed;
            match done.status {
                _ if done.bytes_written > 0 => return Ok(done.bytes_written),
                Ok(MZStatus::StreamEnd) => return Ok(0),
                Ok(_) if done.bytes_consumed > 0 => {}
                Err(MZError::Buf) | Ok(_) if self.to == 0 => return Ok(0),
                Err(MZError::Buf) | Ok(_) if self.from == self.to => {}
                _ => return Err(io::Error::new(io::ErrorKind::InvalidData, "it cannot be unpacked")),
            }
        }
    }
}

impl Read for Content<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let most = usize::try_from(self.left).unwrap_or(usize::MAX).min(into.len());
        if most == 0 {
            return Ok(0);
        }
        let count = self.more(&mut into[..most])?;
        self.crc.add(&into[..count]);
        self.left -= count as u64;
        if self.left == 0 && self.crc.value() != self.checksum {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "its checksum is not that of what it holds"));
        }
        Ok(count)
    }
}
