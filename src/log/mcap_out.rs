//! Writes JointState messages as MCAP, in CDR and with an index, as Foxglove and Rerun read them.

use super::source::{Crc, JointStateForm};
use std::io::{self, Write};

/// Messages of one topic.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct McapTopic {
    /// Such as `/measured/joint_states`.
    pub name: String,
    /// Of the joints, in the order of the columns.
    pub joints: Vec<String>,
    /// Stamps \[s\], in any order that they are to be replayed in.
    pub t_s: Vec<f64>,
    /// Of each joint, as long as the stamps \[rad\].
    pub position_rad: Vec<Vec<f64>>,
    /// As the angles \[rad/s\]; empty: none.
    pub velocity_rad_s: Vec<Vec<f64>>,
    /// As the angles \[N m\]; empty: none.
    pub effort_nm: Vec<Vec<f64>>,
}

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// A chunk is closed beyond this size \[bytes\].
const CHUNK: usize = 1 << 20;
const TYPE: &str = "sensor_msgs/msg/JointState";
const DEFINITION: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
================================================================================\nMSG: std_msgs/Header\n\
builtin_interfaces/Time stamp\nstring frame_id\n\
================================================================================\nMSG: builtin_interfaces/Time\n\
int32 sec\nuint32 nanosec\n";

/// A file with these topics, messages in the order of their stamps. Times before the earliest are none: the first message
/// is at zero where a stamp is negative.
pub fn mcap_bytes(topics: &[McapTopic]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_mcap(topics, &mut bytes).expect("memory takes every byte");
    bytes
}

/// As [`mcap_bytes`], chunk after chunk.
///
/// # Errors
/// What `out` answers.
pub fn write_mcap(topics: &[McapTopic], out: &mut dyn Write) -> io::Result<()> {
    let first_s = topics.iter().flat_map(|topic| &topic.t_s).copied().fold(0.0, f64::min);
    let mut order: Vec<(i64, u32, u32)> = Vec::new();
    for (k, topic) in topics.iter().enumerate() {
        let ns = topic.t_s.iter().map(|t_s| ((t_s - first_s) * 1e9).round() as i64);
        order.extend(ns.enumerate().map(|(sample, ns)| (ns, k as u32, sample as u32)));
    }
    order.sort_unstable();
    let mut file = File::new(topics, out)?;
    for (ns, k, sample) in order {
        file.message(&topics[k as usize], k as usize, sample as usize, ns)?;
    }
    file.finish(topics)
}

/// A record: its kind, its length, its content.
fn record(out: &mut Vec<u8>, kind: u8, content: &[u8]) {
    out.push(kind);
    out.extend((content.len() as u64).to_le_bytes());
    out.extend(content);
}

fn text(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

fn longs(out: &mut Vec<u8>, values: &[u64]) {
    values.iter().for_each(|value| out.extend(value.to_le_bytes()));
}

/// The schema and all channels, which stand before the messages and again in the summary.
fn descriptions(topics: &[McapTopic]) -> Vec<u8> {
    let (mut out, mut schema) = (Vec::new(), 1_u16.to_le_bytes().to_vec());
    text(&mut schema, TYPE);
    text(&mut schema, "ros2msg");
    text(&mut schema, DEFINITION);
    record(&mut out, 0x03, &schema);
    for (k, topic) in topics.iter().enumerate() {
        let mut channel = [(k as u16).to_le_bytes(), 1_u16.to_le_bytes()].concat();
        text(&mut channel, &topic.name);
        text(&mut channel, "cdr");
        channel.extend(0_u32.to_le_bytes());
        record(&mut out, 0x04, &channel);
    }
    out
}

struct File<'a> {
    out: Counted<'a>,
    forms: Vec<JointStateForm>,
    chunk: Vec<u8>,
    /// Stamp and place of the messages of each channel in the chunk.
    index: Vec<Vec<[u64; 2]>>,
    counts: Vec<u64>,
    chunks: Vec<Vec<u8>>,
    span_ns: Option<[u64; 2]>,
}

impl<'a> File<'a> {
    fn new(topics: &[McapTopic], out: &'a mut dyn Write) -> io::Result<Self> {
        let (mut start, mut header) = (MAGIC.to_vec(), Vec::new());
        text(&mut header, "ros2");
        text(&mut header, concat!("aibo-fit ", env!("CARGO_PKG_VERSION")));
        record(&mut start, 0x01, &header);
        let mut out = Counted { out, count: 0 };
        out.write(&start)?;
        let counts = |topic: &McapTopic| {
            [&topic.position_rad, &topic.velocity_rad_s, &topic.effort_nm].map(|columns| columns.len())
        };
        Ok(Self {
            out,
            forms: topics.iter().map(|topic| JointStateForm::new(&topic.joints, counts(topic))).collect(),
            chunk: descriptions(topics),
            index: vec![Vec::new(); topics.len()],
            counts: vec![0; topics.len()],
            chunks: Vec::new(),
            span_ns: None,
        })
    }

    fn message(&mut self, topic: &McapTopic, channel: usize, sample: usize, ns: i64) -> io::Result<()> {
        let (form, stamp) = (&self.forms[channel], ns as u64);
        self.index[channel].push([stamp, self.chunk.len() as u64]);
        self.chunk.push(0x05);
        longs(&mut self.chunk, &[22 + form.len() as u64]);
        self.chunk.extend((channel as u16).to_le_bytes());
        self.chunk.extend((self.counts[channel] as u32).to_le_bytes());
        longs(&mut self.chunk, &[stamp, stamp]);
        let fields = [&topic.position_rad, &topic.velocity_rad_s, &topic.effort_nm].map(|columns| at(columns, sample));
        form.write(&mut self.chunk, ns, fields);
        self.counts[channel] += 1;
        if self.chunk.len() > CHUNK { self.close_chunk() } else { Ok(()) }
    }

    fn close_chunk(&mut self) -> io::Result<()> {
        let stamps = || self.index.iter().flatten().map(|[stamp, _]| *stamp);
        let (Some(from), Some(to)) = (stamps().min(), stamps().max()) else { return Ok(()) };
        let [first, last] = self.span_ns.unwrap_or([from, to]);
        self.span_ns = Some([first.min(from), last.max(to)]);
        let chunk = std::mem::take(&mut self.chunk);
        let size = chunk.len() as u64;
        let mut crc = Crc::default();
        crc.add(&chunk);
        let mut head = Vec::new();
        longs(&mut head, &[from, to, size]);
        head.extend(crc.value().to_le_bytes());
        text(&mut head, "");
        longs(&mut head, &[size]);
        let start = self.out.count;
        let mut about = vec![0x06];
        longs(&mut about, &[head.len() as u64 + size]);
        [&about, &head, &chunk].into_iter().try_for_each(|part| self.out.write(part))?;
        let length = self.out.count - start;
        let indices = self.out.count;
        let (mut places, mut own) = (Vec::new(), Vec::new());
        for (channel, entries) in self.index.iter_mut().enumerate().filter(|(_, entries)| !entries.is_empty()) {
            places.extend((channel as u16).to_le_bytes());
            longs(&mut places, &[indices + own.len() as u64]);
            let mut content = (channel as u16).to_le_bytes().to_vec();
            content.extend((entries.len() as u32 * 16).to_le_bytes());
            entries.drain(..).for_each(|entry| longs(&mut content, &entry));
            record(&mut own, 0x07, &content);
        }
        self.out.write(&own)?;
        let mut about = Vec::new();
        longs(&mut about, &[from, to, start, length]);
        about.extend((places.len() as u32).to_le_bytes());
        about.extend(places);
        longs(&mut about, &[self.out.count - indices]);
        text(&mut about, "");
        longs(&mut about, &[size, size]);
        self.chunks.push(about);
        Ok(())
    }

    fn finish(mut self, topics: &[McapTopic]) -> io::Result<()> {
        self.close_chunk()?;
        let mut end = Vec::new();
        record(&mut end, 0x0f, &0_u32.to_le_bytes());
        let summary = self.out.count + end.len() as u64;
        end.extend(descriptions(topics));
        let mut about = Vec::new();
        longs(&mut about, &[self.counts.iter().sum()]);
        about.extend(1_u16.to_le_bytes());
        let (none, chunks) = (0_u32.to_le_bytes(), (self.chunks.len() as u32).to_le_bytes());
        [(topics.len() as u32).to_le_bytes(), none, none, chunks].iter().for_each(|count| about.extend(count));
        longs(&mut about, &self.span_ns.unwrap_or_default());
        about.extend((self.counts.len() as u32 * 10).to_le_bytes());
        for (channel, count) in self.counts.iter().enumerate() {
            about.extend((channel as u16).to_le_bytes());
            longs(&mut about, &[*count]);
        }
        record(&mut end, 0x0b, &about);
        self.chunks.iter().for_each(|chunk| record(&mut end, 0x08, chunk));
        let mut footer = Vec::new();
        longs(&mut footer, &[summary, 0]);
        footer.extend(0_u32.to_le_bytes());
        record(&mut end, 0x02, &footer);
        end.extend(MAGIC);
        self.out.write(&end)
    }
}

/// A sample of every column.
fn at(columns: &[Vec<f64>], sample: usize) -> impl Iterator<Item = &f64> {
    columns.iter().map(move |column| &column[sample])
}

/// Counts what is written.
struct Counted<'a> {
    out: &'a mut dyn Write,
    count: u64,
}

impl Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.count += bytes.len() as u64;
        self.out.write_all(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Columns, read_source};

    #[test]
    fn what_is_written_is_read_back() {
        let t_s: Vec<f64> = (0..20_000).map(|k| 0.01 * f64::from(k)).collect();
        let position_rad = vec![t_s.iter().map(|t| t.sin()).collect(), t_s.iter().map(|t| t.cos()).collect()];
        let joints = vec!["a".to_owned(), "b".to_owned()];
        let read = McapTopic { name: "/joint_states".into(), joints, t_s, position_rad, ..McapTopic::default() };
        let asked = McapTopic { name: "/joint_command".into(), ..read.clone() };
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("out.mcap");
        std::fs::write(&path, mcap_bytes(&[read.clone(), asked])).unwrap();
        let source = read_source(&path, &Columns::default()).unwrap();
        assert_eq!(source.ours("b.q").unwrap().values, read.position_rad[1]);
        assert_eq!(source.ours("a.q_ref").unwrap().values, read.position_rad[0]);
        assert!((source.clocks[0][7] - 0.07).abs() < 1e-12);
    }
}
