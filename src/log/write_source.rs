//! Writes what a file of any format holds as the project's own CSV, or as MCAP.

use std::collections::BTreeMap;
use std::io::{self, Write};

use rayon::prelude::*;

use super::column::{Column, column_of};
use super::mcap_out::McapTopic;
use super::source::{Channel, Source};

/// Rows that are made at a time.
const BLOCK: usize = 1 << 14;
/// No sample of a clock at a row's stamp.
const NONE: u32 = u32::MAX;

/// Writes the channels that we have names for as CSV: one row a stamp, empty cells where a channel has no sample there.
///
/// # Errors
/// What `out` answers.
pub fn write_csv(source: &Source, out: &mut dyn Write) -> io::Result<()> {
    let used: Vec<(&str, &Channel)> =
        source.channels.iter().filter_map(|channel| Some((channel.ours.as_deref()?, channel))).collect();
    let names: String = used.iter().map(|(name, _)| format!(",{name}")).collect();
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
    let mut next = vec![0; clocks.len()];
    loop {
        let (stamps, samples) = block(source, &clocks, &mut next);
        if stamps.is_empty() {
            return Ok(());
        }
        let share = stamps.len().div_ceil(rayon::current_num_threads()).max(1);
        let parts = stamps.par_chunks(share).zip(samples.par_chunks(share * clocks.len()));
        let parts: Vec<Vec<u8>> = parts.map(|(stamps, samples)| rows(stamps, samples, &columns)).collect();
        parts.iter().try_for_each(|part| out.write_all(part))?;
    }
}

/// A column that is written: its samples are those of the clock with this place among the used ones.
struct CsvColumn<'a> {
    values: &'a [f64],
    clock: usize,
    is_switch: bool,
}

/// The next stamps, and for each of them and of the clocks the sample that it is, or none.
fn block(source: &Source, clocks: &[usize], next: &mut [usize]) -> (Vec<f64>, Vec<u32>) {
    let (mut stamps, mut samples) = (Vec::with_capacity(BLOCK), Vec::with_capacity(BLOCK * clocks.len()));
    while stamps.len() < BLOCK {
        let stamp = |k: usize, next: &[usize]| source.clocks[clocks[k]].get(next[k]).copied();
        let Some(now_s) = (0..clocks.len()).filter_map(|k| stamp(k, next)).min_by(f64::total_cmp) else { break };
        stamps.push(now_s);
        for k in 0..clocks.len() {
            let is_now = stamp(k, next) == Some(now_s);
            samples.push(if is_now { next[k] as u32 } else { NONE });
            next[k] += usize::from(is_now);
        }
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
}
