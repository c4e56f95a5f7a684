//! Bags of ROS 1 (format 2.0): records in chunks that are packed by bz2, lz4 or nothing.
//!
//! After wiki.ros.org/Bags/Format/2.0. The file is streamed; a chunk is unpacked as it is read.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use super::bytes::{cut, read_up_to, skip};
use super::intake::{LARGEST_MESSAGE, Topic, take_message};
use super::message::{Encoding, KINDS, Kind};
use super::topics::Topics;
use crate::log::error::LogError;
use crate::log::format::Format;

const VERSION: &[u8] = b"#ROSBAG V2.0\n";
/// Largest header of a record \[bytes\].
const LARGEST_HEAD: u32 = 1 << 20;
/// Largest chunk, unpacked \[bytes\].
const LARGEST_CHUNK: u64 = 1 << 30;
/// Topics of one bag.
const MOST_CONNECTIONS: usize = 65_536;

/// Adds the messages of a bag.
///
/// # Errors
/// [`LogError::Format`] where the file is damaged, with what had been read of it.
pub(super) fn read_ros1(path: &Path, file: File, topics: &mut Topics) -> Result<(), LogError> {
    let length = file.metadata().map_or(u64::MAX, |meta| meta.len());
    let before = topics.messages();
    let mut reader = Reader { connections: Vec::new(), chunks: 0, topics, held: Vec::new() };
    let read = reader.file(BufReader::with_capacity(1 << 16, file), length);
    let found = reader.found();
    let taken = topics.messages() - before;
    let what = match read {
        Err(what) if taken > 0 => format!("{what}; {taken} messages of joints had been read"),
        Err(what) => what,
        Ok(()) if taken == 0 => found,
        Ok(()) => return Ok(()),
    };
    Err(LogError::Format { file: path.to_path_buf(), format: Format::Rosbag1, what })
}

struct Connection {
    id: u32,
    /// `None`: of no kind that is read.
    topic: Option<Topic>,
    /// As told where nothing is read.
    about: String,
}

struct Reader<'a> {
    connections: Vec<Connection>,
    chunks: u32,
    topics: &'a mut Topics,
    /// The message at hand.
    held: Vec<u8>,
}

/// The header of a record, and how much data follows.
struct Head {
    fields: Vec<u8>,
    data: u64,
}

impl Head {
    /// `None` at the end of the input. `left` is what can be there at the most.
    fn read(input: &mut dyn Read, left: &mut u64) -> Result<Option<Self>, String> {
        let mut word = [0; 4];
        match read_up_to(input, &mut word)? {
            0 => return Ok(None),
            4 => {}
            _ => return Err("cut short within the head of a record".to_owned()),
        }
        let length = u32::from_le_bytes(word);
        if length > LARGEST_HEAD || u64::from(length) + 8 > *left {
            return Err(format!("cut short or damaged: a header of {length} bytes is announced, {left} are left"));
        }
        let mut fields = vec![0; length as usize];
        input.read_exact(&mut fields).map_err(cut)?;
        input.read_exact(&mut word).map_err(cut)?;
        *left -= u64::from(length) + 8;
        let data = u64::from(u32::from_le_bytes(word));
        if data > *left {
            return Err(format!("cut short or damaged: a record of {data} bytes is announced, {left} are left"));
        }
        *left -= data;
        Ok(Some(Self { fields, data }))
    }

    fn op(&self) -> Option<u8> {
        field(&self.fields, b"op")?.first().copied()
    }

    fn word(&self, name: &[u8]) -> Result<u32, String> {
        let bytes = field(&self.fields, name).and_then(|bytes| bytes.try_into().ok());
        let named = || format!("damaged: a record without its `{}`", String::from_utf8_lossy(name));
        bytes.map(u32::from_le_bytes).ok_or_else(named)
    }
}

/// What a header says of a name.
fn field<'a>(mut fields: &'a [u8], wanted: &[u8]) -> Option<&'a [u8]> {
    while let Some((length, rest)) = fields.split_at_checked(4) {
        let (own, rest) = rest.split_at_checked(u32::from_le_bytes(length.try_into().ok()?) as usize)?;
        fields = rest;
        let at = own.iter().position(|byte| *byte == b'=')?;
        if &own[..at] == wanted {
            return Some(&own[at + 1..]);
        }
    }
    None
}

impl Reader<'_> {
    fn file(&mut self, mut input: impl Read, length: u64) -> Result<(), String> {
        let mut version = [0; 13];
        input.read_exact(&mut version).map_err(|_| "shorter than its first line".to_owned())?;
        if version != VERSION {
            let found = String::from_utf8_lossy(&version[1..]).trim().to_owned();
            return Err(format!("`{found}`, expected `ROSBAG V2.0`; `rosbag migrate` makes it so"));
        }
        let mut left = length.saturating_sub(13);
        let announced = match Head::read(&mut input, &mut left)? {
            Some(head) if head.op() == Some(3) => {
                skip(&mut input, head.data)?;
                if field(&head.fields, b"index_pos").is_none_or(|at| at.iter().all(|byte| *byte == 0)) {
                    return Err("it was never closed (no index); mend it first with `rosbag reindex`".to_owned());
                }
                head.word(b"chunk_count")?
            }
            _ => return Err("damaged: it does not begin with the header of a bag".to_owned()),
        };
        while let Some(head) = Head::read(&mut input, &mut left)? {
            match head.op() {
                Some(5) => self.chunk(&head, &mut input)?,
                _ => self.record(&head, &mut input)?,
            }
        }
        let read = self.chunks;
        if read == announced {
            Ok(())
        } else {
            Err(format!("cut short: {announced} chunks are announced, {read} are there"))
        }
    }

    fn chunk(&mut self, head: &Head, input: &mut dyn Read) -> Result<(), String> {
        self.chunks += 1;
        let size = u64::from(head.word(b"size")?);
        if size > LARGEST_CHUNK {
            return Err(format!("a chunk of {size} bytes, unpacked, is announced; at most {LARGEST_CHUNK} are read"));
        }
        let mut own = input.take(head.data);
        match field(&head.fields, b"compression") {
            None | Some(b"none") => self.records(&mut own, size)?,
            Some(b"lz4") => self.records(&mut lz4_flex::frame::FrameDecoder::new(&mut own), size)?,
            Some(b"bz2") => self.records(&mut bzip2::read::BzDecoder::new(&mut own), size)?,
            Some(other) => {
                let other = String::from_utf8_lossy(other);
                return Err(format!("a chunk is packed by `{other}`, expected bz2, lz4 or nothing"));
            }
        }
        let left = own.limit();
        skip(&mut own, left)
    }

    /// The records of a chunk that unpacks to so many bytes.
    fn records(&mut self, chunk: &mut dyn Read, size: u64) -> Result<(), String> {
        let mut input = BufReader::with_capacity(1 << 14, chunk.take(size));
        let mut left = size;
        while let Some(head) = Head::read(&mut input, &mut left)? {
            self.record(&head, &mut input)?;
        }
        if left == 0 { Ok(()) } else { Err(format!("cut short: a chunk lacks {left} of its {size} bytes")) }
    }

    fn record(&mut self, head: &Head, input: &mut dyn Read) -> Result<(), String> {
        match head.op() {
            Some(7) if head.data <= u64::from(LARGEST_HEAD) => {
                let mut about = vec![0; head.data as usize];
                input.read_exact(&mut about).map_err(cut)?;
                self.connection(head, &about)
            }
            Some(2) => self.message(head, input),
            _ => skip(input, head.data),
        }
    }

    fn connection(&mut self, head: &Head, about: &[u8]) -> Result<(), String> {
        let id = head.word(b"conn")?;
        if self.connections.iter().any(|known| known.id == id) || self.connections.len() >= MOST_CONNECTIONS {
            return Ok(());
        }
        let text = |bytes: Option<&[u8]>| String::from_utf8_lossy(bytes.unwrap_or_default()).into_owned();
        let (name, kind) = (text(field(&head.fields, b"topic")), text(field(about, b"type")));
        let about = format!("{name} ({kind})");
        let topic = Kind::of(&name, &kind).map(|kind| Topic { name, kind, encoding: Encoding::Ros1 });
        if topic.is_none() {
            self.topics.leave_out(&about);
        }
        self.connections.push(Connection { id, topic, about });
        Ok(())
    }

    fn message(&mut self, head: &Head, input: &mut dyn Read) -> Result<(), String> {
        let id = head.word(b"conn")?;
        let Some(connection) = self.connections.iter().find(|known| known.id == id) else {
            return Err(format!("damaged: a message of connection {id}, which nothing describes"));
        };
        let Some(topic) = &connection.topic else { return skip(input, head.data) };
        if head.data > LARGEST_MESSAGE {
            return Err(format!("damaged: a message of {} bytes of {}", head.data, topic.name));
        }
        let time = field(&head.fields, b"time").filter(|bytes| bytes.len() == 8);
        let time = time.ok_or("damaged: a message without its time")?;
        let word = |at: usize| i64::from(u32::from_le_bytes([time[at], time[at + 1], time[at + 2], time[at + 3]]));
        let received_ns = word(0) * 1_000_000_000 + word(4);
        self.held.resize(head.data as usize, 0);
        input.read_exact(&mut self.held).map_err(cut)?;
        take_message(self.topics, topic, received_ns, &self.held)
    }

    /// What there is, where nothing of it is read.
    fn found(&self) -> String {
        if self.connections.iter().any(|known| known.topic.is_some()) {
            return "its topics of joints have no message".to_owned();
        }
        let found: Vec<&str> = self.connections.iter().map(|known| known.about.as_str()).collect();
        let found = if found.is_empty() { "no topic at all".to_owned() } else { found.join(", ") };
        format!("no topic of a kind that is read ({KINDS}); found {found}")
    }
}
