//! Writes what a file of any format holds as the project's own CSV, or as MCAP.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use rayon::prelude::*;

use super::column::{Column, column_of};
use super::mcap_out::McapTopic;
use super::source::{Channel, Source, are_of_messages};

/// Rows that are made at a time.
const BLOCK: usize = 1 << 14;
/// No sample of a clock at a row's stamp.
const NONE: u32 = u32::MAX;

/// Writes the channels that we have names for as CSV: one row a stamp, empty cells where a channel has no sample there. A
/// few empty cells would be read as samples that are missing: there each clock has rows of its own.
///
/// # Errors
/// What `out` answers; where two channels have one name, so that nothing could read the file, that.
pub fn write_csv(source: &Source, out: &mut dyn Write) -> io::Result<()> {
    let used: Vec<(&str, &Channel)> =
        source.channels.iter().filter_map(|channel| Some((channel.ours.as_deref()?, channel))).collect();
    let twice = used.iter().enumerate().find(|(k, (name, _))| used[..*k].iter().any(|(other, _)| other == name));
    if let Some((_, (name, _))) = twice {
        let what = format!("column `{name}` would appear twice");
        return Err(io::Error::new(io::ErrorKind::InvalidData, what));
    }
    let names: String = used.iter().map(|(name, _)| format!(",{}", quoted(name))).collect();
    writeln!(out, "{}{names}", Column::Time.name())?;
    let mut clocks: Vec<usize> = used.iter().map(|(_, channel)| channel.clock).collect();
    clocks.sort_unstable();
    clocks.dedup();
    let columns: Vec<CsvColumn<'_>> = used
        .iter()
        .map(|(name, channel)| CsvColumn {
            values: &channel.values,
            clock: clocks.iter().position(|clock| *clock == channel.clock).unwrap_or(0),
            is_switch: name.ends_with(Column::Drive.name()),
        })
        .collect();
    let sharing = Sharing::of(source, &clocks);
    let mut next = vec![0; clocks.len()];
    loop {
        let (stamps, samples) = block(source, &clocks, sharing, &mut next);
        if stamps.is_empty() {
            return Ok(());
        }
        let share = stamps.len().div_ceil(rayon::current_num_threads()).max(1);
        let parts = stamps.par_chunks(share).zip(samples.par_chunks(share * clocks.len()));
        let parts: Vec<Vec<u8>> = parts.map(|(stamps, samples)| rows(stamps, samples, &columns)).collect();
        parts.iter().try_for_each(|part| out.write_all(part))?;
    }
}

/// A name as a cell of CSV.
fn quoted(name: &str) -> Cow<'_, str> {
    match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")).into(),
        false => name.into(),
    }
}

/// A column that is written: its samples are those of the clock with this place among the used ones.
struct CsvColumn<'a> {
    values: &'a [f64],
    clock: usize,
    is_switch: bool,
}

/// Which samples of the same stamp stand in a row.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sharing {
    /// All.
    All,
    /// Those of one clock.
    OneClock,
}

impl Sharing {
    /// All, unless that leaves empty cells that are too few to be told from missing samples.
    fn of(source: &Source, clocks: &[usize]) -> Self {
        let (mut next, mut rows) = (vec![0; clocks.len()], 0);
        while step(source, clocks, Self::All, &mut next, |_| {}).is_some() {
            rows += 1;
        }
        let empty = |clock: &usize| rows - source.clocks[*clock].len();
        let is_whole = clocks.iter().all(|clock| empty(clock) == 0);
        if is_whole || clocks.iter().any(|clock| are_of_messages(empty(clock), rows)) {
            Self::All
        } else {
            Self::OneClock
        }
    }
}

/// The stamp of the next row; `is_in` is told of each clock the sample that is in it, or none.
fn step(
    source: &Source,
    clocks: &[usize],
    sharing: Sharing,
    next: &mut [usize],
    mut is_in: impl FnMut(Option<usize>),
) -> Option<f64> {
    let stamp = |k: usize, next: &[usize]| source.clocks[clocks[k]].get(next[k]).copied();
    let now_s = (0..clocks.len()).filter_map(|k| stamp(k, next)).min_by(f64::total_cmp)?;
    let mut is_free = true;
    for k in 0..clocks.len() {
        let is_now = is_free && stamp(k, next) == Some(now_s);
        is_in(is_now.then_some(next[k]));
        next[k] += usize::from(is_now);
        is_free &= !is_now || sharing == Sharing::All;
    }
    Some(now_s)
}

/// The stamps of the next rows, and for each of them and of the clocks the sample that is in it, or none.
fn block(source: &Source, clocks: &[usize], sharing: Sharing, next: &mut [usize]) -> (Vec<f64>, Vec<u32>) {
    let (mut stamps, mut samples) = (Vec::with_capacity(BLOCK), Vec::with_capacity(BLOCK * clocks.len()));
    while stamps.len() < BLOCK {
        let is_in = |sample: Option<usize>| samples.push(sample.map_or(NONE, |sample| sample as u32));
        let Some(now_s) = step(source, clocks, sharing, next, is_in) else { break };
        stamps.push(now_s);
    }
    (stamps, samples)
}

/// Rows as text.
fn rows(stamps: &[f64], samples: &[u32], columns: &[CsvColumn<'_>]) -> Vec<u8> {
    let clocks = samples.len() / stamps.len().max(1);
    let mut text = Vec::with_capacity(stamps.len() * (columns.len() + 1) * 12);
    let mut digits = zmij::Buffer::new();
    let mut number = |text: &mut Vec<u8>, value: f64| {
        // The shortest digits that read back as the same number.
        let own = digits.format(value);
        text.extend_from_slice(own.strip_suffix(".0").unwrap_or(own).as_bytes());
    };
    for (row, stamp_s) in stamps.iter().enumerate() {
        number(&mut text, *stamp_s);
        for column in columns {
            text.push(b',');
            let sample = samples[row * clocks + column.clock];
            match column.values.get(sample as usize).filter(|_| sample != NONE) {
                Some(value) if column.is_switch => text.push(if *value == 1.0 { b'1' } else { b'0' }),
                Some(value) => number(&mut text, *value),
                None => {}
            }
        }
        text.push(b'\n');
    }
    text
}

/// The same as topics: `/joint_states` of what was read, `/joint_command` of what was asked, one pair for each set of
/// stamps. `alone` is the name of a joint that has none.
pub fn mcap_topics(source: Source, alone: &str) -> Vec<McapTopic> {
    let mut source = source;
    let mut topics: BTreeMap<(usize, bool), McapTopic> = BTreeMap::new();
    for angle in [Column::Angle, Column::Setpoint] {
        let is_read = angle == Column::Angle;
        for k in 0..source.channels.len() {
            let channel = &source.channels[k];
            let Some((joint, column)) = channel.ours.as_deref().and_then(column_of) else { continue };
            if column != angle {
                continue;
            }
            let (clock, joint) = (channel.clock, joint.map(str::to_owned));
            let topic = topics.entry((clock, is_read)).or_insert_with(|| McapTopic {
                name: if is_read { "/joint_states" } else { "/joint_command" }.to_owned(),
                t_s: source.clocks[clock].clone(),
                ..McapTopic::default()
            });
            let name = |column: Column| match &joint {
                Some(joint) => format!("{joint}.{}", column.name()),
                None => column.name().to_owned(),
            };
            let mut beside = |column: Column| {
                let is_it = |other: &&mut Channel| other.clock == clock && other.ours == Some(name(column));
                let found = source.channels.iter_mut().find(is_it).filter(|_| is_read);
                found.map(|other| std::mem::take(&mut other.values))
            };
            topic.velocity_rad_s.extend(beside(Column::Speed));
            topic.effort_nm.extend(beside(Column::Torque));
            topic.position_rad.push(std::mem::take(&mut source.channels[k].values));
            topic.joints.push(joint.unwrap_or_else(|| alone.to_owned()));
        }
    }
    let whole = |mut topic: McapTopic| {
        // Speeds and torques of some of the joints only cannot be told apart in a message.
        let joints = topic.joints.len();
        for columns in [&mut topic.velocity_rad_s, &mut topic.effort_nm] {
            if columns.len() != joints {
                columns.clear();
            }
        }
        topic
    };
    topics.into_values().map(whole).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Columns, read_source};

    #[test]
    fn what_is_stamped_apart_stands_in_rows_of_its_own_and_is_read_back() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("log.csv");
        let mut text = "t,elbow.q,elbow.q_ref\n".to_owned();
        for k in 0..40 {
            text += &format!(
                "{},{},\n{},,{}\n",
                0.02 * f64::from(k),
                0.1 * f64::from(k % 5),
                0.02 * f64::from(k) + 0.01,
                0.5
            );
        }
        std::fs::write(&path, text).unwrap();
        let source = read_source(&path, &Columns::default()).unwrap();
        assert_eq!((source.clocks.len(), source.clocks[1][0]), (2, 0.01));
        let mut written = Vec::new();
        write_csv(&source, &mut written).unwrap();
        let again = dir.path().join("again.csv");
        std::fs::write(&again, written).unwrap();
        let read = read_source(&again, &Columns::default()).unwrap();
        assert_eq!((read.channels, read.clocks), (source.channels.clone(), source.clocks.clone()));
        let topics = mcap_topics(source, "joint");
        assert_eq!((topics.len(), topics[0].joints[0].as_str(), topics[1].t_s[0]), (2, "elbow", 0.01));
    }

    #[test]
    fn names_are_quoted_as_csv_does_and_stand_once() {
        let write = |names: [&str; 2]| {
            let channels = names.map(|name| (format!("{name}.q"), 0, vec![0.1, 0.11]));
            let source = Source::of_arrays("log", vec![vec![0.0, 0.01]], channels.to_vec()).unwrap();
            let mut written = Vec::new();
            write_csv(&source, &mut written).map(|()| String::from_utf8(written).unwrap())
        };
        let text = write(["left, upper", "a \"b\""]).unwrap();
        assert_eq!(text.lines().next(), Some("t,\"left, upper.q\",\"a \"\"b\"\".q\""));
        let path = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(path.path(), text).unwrap();
        let read = read_source(path.path(), &Columns::default()).unwrap();
        assert_eq!(read.joints(), [Some("left, upper"), Some("a \"b\"")]);
        let twice = write(["a", "a"]).unwrap_err();
        assert!(twice.to_string().contains("`a.q` would appear twice"), "{twice}");
    }

    #[test]
    fn clocks_that_share_all_stamps_but_a_few_are_read_back_as_they_were() {
        let dir = tempfile::tempdir().unwrap();
        let stamps = |is_there: &dyn Fn(u32) -> bool| -> Vec<f64> {
            (0..300).filter(|k| is_there(*k)).map(|k| 0.01 * f64::from(k)).collect()
        };
        let clocks = vec![stamps(&|k| k != 7), stamps(&|k| k % 100 != 50)];
        let angles =
            |clock: usize, size: f64| (0..clocks[clock].len()).map(|k| size * (0.1 * k as f64).sin()).collect();
        let channels = vec![("a.q".to_owned(), 0, angles(0, 0.5)), ("b.q".to_owned(), 1, angles(1, 0.3))];
        let source = Source::of_arrays("log", clocks.clone(), channels).unwrap();
        let mut written = Vec::new();
        write_csv(&source, &mut written).unwrap();
        let again = dir.path().join("again.csv");
        std::fs::write(&again, written).unwrap();
        let read = read_source(&again, &Columns::default()).unwrap();
        assert_eq!((&read.clocks, &read.channels[1].values), (&source.clocks, &source.channels[1].values));
        // Stamps that are all the same need one row each.
        let same = Source::of_arrays(
            "log",
            vec![clocks[0].clone(), clocks[0].clone()],
            vec![("a.q".to_owned(), 0, angles(0, 0.5)), ("b.q".to_owned(), 1, angles(0, 0.3))],
        );
        let mut written = Vec::new();
        write_csv(&same.unwrap(), &mut written).unwrap();
        assert_eq!(String::from_utf8(written).unwrap().lines().count(), 1 + clocks[0].len());
    }
}
