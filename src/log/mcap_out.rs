//! Writes JointState messages as MCAP, in CDR and with an index, as Foxglove and Rerun read them.

use super::source::{Crc, joint_state};

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
    let first_s = topics.iter().flat_map(|topic| &topic.t_s).copied().fold(0.0, f64::min);
    let mut order: Vec<(i64, usize, usize)> = Vec::new();
    for (k, topic) in topics.iter().enumerate() {
        let ns = topic.t_s.iter().map(|t_s| ((t_s - first_s) * 1e9).round() as i64);
        order.extend(ns.enumerate().map(|(sample, ns)| (ns, k, sample)));
    }
    order.sort_unstable();
    let mut file = File::new(topics);
    for (ns, k, sample) in order {
        file.message(&topics[k], k, sample, ns);
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

struct File {
    out: Vec<u8>,
    chunk: Vec<u8>,
    /// Stamp and place of the messages of each channel in the chunk.
    index: Vec<Vec<[u64; 2]>>,
    counts: Vec<u64>,
    chunks: Vec<Vec<u8>>,
    span_ns: Option<[u64; 2]>,
}

impl File {
    fn new(topics: &[McapTopic]) -> Self {
        let (mut out, mut header) = (MAGIC.to_vec(), Vec::new());
        text(&mut header, "ros2");
        text(&mut header, concat!("aibo-fit ", env!("CARGO_PKG_VERSION")));
        record(&mut out, 0x01, &header);
        let index = vec![Vec::new(); topics.len()];
        Self {
            out,
            chunk: descriptions(topics),
            index,
            counts: vec![0; topics.len()],
            chunks: Vec::new(),
            span_ns: None,
        }
    }

    fn message(&mut self, topic: &McapTopic, channel: usize, sample: usize, ns: i64) {
        let names: Vec<&str> = topic.joints.iter().map(String::as_str).collect();
        let of = |columns: &[Vec<f64>]| {
            columns.iter().filter_map(|column| column.get(sample).copied()).collect::<Vec<f64>>()
        };
        let fields = [of(&topic.position_rad), of(&topic.velocity_rad_s), of(&topic.effort_nm)];
        let stamp = ns as u64;
        let mut content = (channel as u16).to_le_bytes().to_vec();
        content.extend((self.counts[channel] as u32).to_le_bytes());
        longs(&mut content, &[stamp, stamp]);
        content.extend(joint_state(ns, &names, [&fields[0], &fields[1], &fields[2]]));
        self.index[channel].push([stamp, self.chunk.len() as u64]);
        self.counts[channel] += 1;
        record(&mut self.chunk, 0x05, &content);
        if self.chunk.len() > CHUNK {
            self.close_chunk();
        }
    }

    fn close_chunk(&mut self) {
        let stamps = || self.index.iter().flatten().map(|[stamp, _]| *stamp);
        let (Some(from), Some(to)) = (stamps().min(), stamps().max()) else { return };
        let [first, last] = self.span_ns.unwrap_or([from, to]);
        self.span_ns = Some([first.min(from), last.max(to)]);
        let chunk = std::mem::take(&mut self.chunk);
        let size = chunk.len() as u64;
        let mut crc = Crc::default();
        crc.add(&chunk);
        let mut content = Vec::with_capacity(chunk.len() + 64);
        longs(&mut content, &[from, to, size]);
        content.extend(crc.value().to_le_bytes());
        text(&mut content, "");
        longs(&mut content, &[size]);
        content.extend(&chunk);
        let start = self.out.len() as u64;
        record(&mut self.out, 0x06, &content);
        let length = self.out.len() as u64 - start;
        let indices = self.out.len();
        let mut places = Vec::new();
        for (channel, entries) in self.index.iter_mut().enumerate().filter(|(_, entries)| !entries.is_empty()) {
            places.extend((channel as u16).to_le_bytes());
            longs(&mut places, &[self.out.len() as u64]);
            let mut content = (channel as u16).to_le_bytes().to_vec();
            content.extend((entries.len() as u32 * 16).to_le_bytes());
            entries.drain(..).for_each(|entry| longs(&mut content, &entry));
            record(&mut self.out, 0x07, &content);
        }
        let mut about = Vec::new();
        longs(&mut about, &[from, to, start, length]);
        about.extend((places.len() as u32).to_le_bytes());
        about.extend(places);
        longs(&mut about, &[(self.out.len() - indices) as u64]);
        text(&mut about, "");
        longs(&mut about, &[size, size]);
        self.chunks.push(about);
    }

    fn finish(mut self, topics: &[McapTopic]) -> Vec<u8> {
        self.close_chunk();
        record(&mut self.out, 0x0f, &0_u32.to_le_bytes());
        let summary = self.out.len() as u64;
        self.out.extend(descriptions(topics));
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
        record(&mut self.out, 0x0b, &about);
        for chunk in &self.chunks {
            record(&mut self.out, 0x08, chunk);
        }
        let mut footer = Vec::new();
        longs(&mut footer, &[summary, 0]);
        footer.extend(0_u32.to_le_bytes());
        record(&mut self.out, 0x02, &footer);
        self.out.extend(MAGIC);
        self.out
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
