//! MCAP: JointState and command messages, in CDR or JSON, in chunks or not.
//!
//! After the specification of version 0 (mcap.dev/spec). The file is streamed; a chunk is unpacked as it is read, so that
//! what a header announces is never held, and its checksum is compared at its end.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use super::bytes::{MCAP_MAGIC, cut, read_up_to, skip};
use super::crc::Crc;
use super::intake::{LARGEST_MESSAGE, Topic, take_message};
use super::message::{Encoding, KINDS, Kind};
use super::topics::Topics;
use crate::log::error::LogError;
use crate::log::format::Format;

/// Largest chunk, unpacked \[bytes\].
const LARGEST_CHUNK: u64 = 1 << 30;
/// Schemas and channels of one file.
const MOST_CHANNELS: usize = 65_536;

/// Adds the messages of a file.
///
/// # Errors
/// [`LogError::Format`] where the file is damaged, with what had been read of it.
pub(super) fn read_mcap(path: &Path, file: File, topics: &mut Topics) -> Result<(), LogError> {
    let length = file.metadata().map_or(u64::MAX, |meta| meta.len());
    let before = topics.messages();
    let mut reader = Reader { schemas: Vec::new(), channels: Vec::new(), topics, held: Vec::new() };
    let read = reader.file(BufReader::with_capacity(1 << 16, file), length);
    let found = reader.found();
    let taken = topics.messages() - before;
    let wrong = |what: String| LogError::Format { file: path.to_path_buf(), format: Format::Mcap, what };
    match read {
        Err(what) if taken > 0 => Err(wrong(format!("{what}; {taken} messages of joints had been read"))),
        Err(what) => Err(wrong(what)),
        Ok(()) if taken == 0 => Err(wrong(found)),
        Ok(()) => Ok(()),
    }
}

struct Channel {
    id: u16,
    /// `None`: of no kind that is read.
    topic: Option<Topic>,
    /// As told where nothing is read.
    about: String,
}

struct Reader<'a> {
    schemas: Vec<(u16, String)>,
    channels: Vec<Channel>,
    topics: &'a mut Topics,
    /// The record at hand.
    held: Vec<u8>,
}

/// How a file ended.
#[derive(PartialEq)]
enum End {
    Data,
    Input,
}

impl Reader<'_> {
    fn file(&mut self, mut input: impl Read, length: u64) -> Result<(), String> {
        self.data(&mut input, length)?;
        // What follows the data is an index, which nothing here needs; that it is whole says that the file is.
        let (mut last, mut piece) = (Vec::new(), [0; 4096]);
        loop {
            match input.read(&mut piece).map_err(cut)? {
                0 => break,
                count => {
                    last.extend_from_slice(&piece[..count]);
                    last.drain(..last.len().saturating_sub(MCAP_MAGIC.len()));
                }
            }
        }
        if last == MCAP_MAGIC { Ok(()) } else { Err("cut short after its data".to_owned()) }
    }

    fn data(&mut self, input: &mut dyn Read, length: u64) -> Result<(), String> {
        let mut magic = [0; 8];
        input.read_exact(&mut magic).map_err(|_| "shorter than its first 8 bytes".to_owned())?;
        let end = self.records(input, length.saturating_sub(8), true)?;
        if end == End::Input {
            return Err("cut short: it has no end of data".to_owned());
        }
        Ok(())
    }

    /// Reads records up to the end of the data; `left` is what the file can hold at the most.
    fn records(&mut self, input: &mut dyn Read, left: u64, is_file: bool) -> Result<End, String> {
        let mut left = left;
        loop {
            let mut head = [0; 9];
            match read_up_to(input, &mut head)? {
                0 => return Ok(End::Input),
                9 => {}
                _ => return Err("cut short within the head of a record".to_owned()),
            }
            let length = u64::from_le_bytes(head[1..].try_into().unwrap_or_default());
            left = left.saturating_sub(9);
            if length > left {
                return Err(format!(
                    "cut short or damaged: a record of {length} bytes is announced, at most {left} are left"
                ));
            }
            left -= length;
            match head[0] {
                0x0f if is_file => {
                    skip(input, length)?;
                    return Ok(End::Data);
                }
                0x06 if is_file => self.chunk(input, length)?,
                0x03..=0x05 => self.known(head[0], input, length)?,
                _ => skip(input, length)?,
            }
        }
    }

    fn known(&mut self, op: u8, input: &mut dyn Read, length: u64) -> Result<(), String> {
        if op == 0x05 {
            // The channel's number says whether the rest is wanted.
            let mut id = [0; 2];
            let Some(rest) = length.checked_sub(22) else {
                return Err("damaged: a message of fewer than 22 bytes".into());
            };
            input.read_exact(&mut id).map_err(cut)?;
            let id = u16::from_le_bytes(id);
            let Some(at) = self.channels.iter().position(|channel| channel.id == id) else {
                return Err(format!("damaged: a message of channel {id}, which nothing describes"));
            };
            if self.channels[at].topic.is_none() {
                return skip(input, length - 2);
            }
            return self.message(at, input, rest);
        }
        if length > LARGEST_MESSAGE {
            return Err(format!("damaged: a description of {length} bytes"));
        }
        let mut held = std::mem::take(&mut self.held);
        held.resize(length as usize, 0);
        input.read_exact(&mut held).map_err(cut)?;
        let read = if op == 0x03 { self.schema(&held) } else { self.channel(&held) };
        self.held = held;
        read.ok_or_else(|| "damaged: a schema or channel that is none".to_owned())
    }

    fn schema(&mut self, bytes: &[u8]) -> Option<()> {
        let mut fields = Fields(bytes);
        let (id, name) = (fields.u16()?, fields.text()?);
        if !self.schemas.iter().any(|(known, _)| *known == id) && self.schemas.len() < MOST_CHANNELS {
            self.schemas.push((id, name.to_owned()));
        }
        Some(())
    }

    fn channel(&mut self, bytes: &[u8]) -> Option<()> {
        let mut fields = Fields(bytes);
        let (id, schema, name, encoding) = (fields.u16()?, fields.u16()?, fields.text()?, fields.text()?);
        if self.channels.iter().any(|channel| channel.id == id) || self.channels.len() >= MOST_CHANNELS {
            return Some(());
        }
        let named = self.schemas.iter().find(|(known, _)| *known == schema).map_or("", |(_, name)| name);
        let of = match encoding {
            "cdr" => Some(Encoding::Cdr),
            "ros1" => Some(Encoding::Ros1),
            "json" => Some(Encoding::Json),
            _ => None,
        };
        let about = format!("{name} ({named}, {encoding})");
        let topic = Kind::of(name, named).zip(of);
        let topic = topic.map(|(kind, encoding)| Topic { name: name.to_owned(), kind, encoding });
        if topic.is_none() {
            self.topics.leave_out(&about);
        }
        self.channels.push(Channel { id, topic, about });
        Some(())
    }

    /// The rest of a message, after its channel's number.
    fn message(&mut self, at: usize, input: &mut dyn Read, length: u64) -> Result<(), String> {
        let mut head = [0; 20];
        input.read_exact(&mut head).map_err(cut)?;
        if length > LARGEST_MESSAGE {
            return Err(format!("damaged: a message of {length} bytes of {}", self.channels[at].about));
        }
        self.held.resize(length as usize, 0);
        input.read_exact(&mut self.held).map_err(cut)?;
        let received = u64::from_le_bytes(head[4..12].try_into().unwrap_or_default());
        let received = i64::try_from(received).map_err(|_| "damaged: a receipt beyond the year 2262".to_owned())?;
        match &self.channels[at].topic {
            Some(topic) => take_message(self.topics, topic, received, &self.held),
            None => Ok(()),
        }
    }

    fn chunk(&mut self, input: &mut dyn Read, length: u64) -> Result<(), String> {
        // Both ends, size, checksum, compression, size of what follows.
        let mut head = [0; 32];
        let Some(rest) = length.checked_sub(32) else { return Err("damaged: a chunk of fewer than 32 bytes".into()) };
        input.read_exact(&mut head).map_err(cut)?;
        let size = u64::from_le_bytes(head[16..24].try_into().unwrap_or_default());
        let checksum = u32::from_le_bytes(head[24..28].try_into().unwrap_or_default());
        let word = u32::from_le_bytes(head[28..32].try_into().unwrap_or_default());
        if word > 16 || u64::from(word) + 8 > rest {
            return Err("damaged: a chunk whose compression is no word".into());
        }
        let mut name = vec![0; word as usize];
        input.read_exact(&mut name).map_err(cut)?;
        let mut packed = [0; 8];
        input.read_exact(&mut packed).map_err(cut)?;
        let packed = u64::from_le_bytes(packed);
        if packed != rest - 8 - u64::from(word) {
            return Err(format!("damaged: a chunk of {packed} bytes in a record of {length}"));
        }
        if size > LARGEST_CHUNK {
            return Err(format!("a chunk of {size} bytes is announced, more than the {LARGEST_CHUNK} that are read"));
        }
        let mut own = input.take(packed);
        let unpacked = match &*name {
            b"" => self.unpacked(&mut own, size, checksum),
            b"lz4" => self.unpacked(&mut lz4_flex::frame::FrameDecoder::new(&mut own), size, checksum),
            b"zstd" => match ruzstd::decoding::StreamingDecoder::new(&mut own) {
                Ok(mut frames) => self.unpacked(&mut frames, size, checksum),
                Err(error) => Err(format!("damaged: a chunk of zstd: {error}")),
            },
            other => {
                Err(format!("a chunk is packed by `{}`, expected zstd, lz4 or nothing", String::from_utf8_lossy(other)))
            }
        };
        unpacked?;
        let left = own.limit();
        skip(&mut own, left)
    }

    fn unpacked(&mut self, chunk: &mut dyn Read, size: u64, checksum: u32) -> Result<(), String> {
        let mut summed = Summed { input: chunk.take(size), crc: Crc::default(), read: 0 };
        let mut buffered = BufReader::with_capacity(1 << 14, &mut summed);
        self.records(&mut buffered, size, false)?;
        if summed.read != size {
            return Err(format!("cut short: a chunk of {size} bytes is announced, {} are there", summed.read));
        }
        if checksum != 0 && summed.crc.value() != checksum {
            return Err("damaged: a chunk's checksum is not that of what it holds".to_owned());
        }
        Ok(())
    }

    /// What there is, where nothing of it is read.
    fn found(&self) -> String {
        let known = self.channels.iter().any(|channel| channel.topic.is_some());
        if known {
            return "its topics of joints have no message".to_owned();
        }
        let found: Vec<&str> = self.channels.iter().map(|channel| channel.about.as_str()).collect();
        let found = if found.is_empty() { "no topic at all".to_owned() } else { found.join(", ") };
        format!("no topic of a kind that is read ({KINDS}, in cdr, ros1 or json); found {found}")
    }
}

/// Counts and sums what is read.
struct Summed<R> {
    input: R,
    crc: Crc,
    read: u64,
}

impl<R: Read> Read for Summed<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let count = self.input.read(into)?;
        self.crc.add(&into[..count]);
        self.read += count as u64;
        Ok(count)
    }
}

struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn u16(&mut self) -> Option<u16> {
        let (own, rest) = self.0.split_at_checked(2)?;
        self.0 = rest;
        Some(u16::from_le_bytes([own[0], own[1]]))
    }

    fn text(&mut self) -> Option<&'a str> {
        let (length, rest) = self.0.split_at_checked(4)?;
        let (own, rest) = rest.split_at_checked(u32::from_le_bytes(length.try_into().ok()?) as usize)?;
        self.0 = rest;
        std::str::from_utf8(own).ok()
    }
}
