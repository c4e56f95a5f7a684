//! Writes what a file of any format holds as the project's own CSV, or as MCAP.

use std::collections::BTreeMap;
use std::io::{self, Write};

use super::column::{Column, column_of};
use super::mcap_out::McapTopic;
use super::source::{Channel, Source};

/// Writes the channels that we have names for as CSV: one row a stamp, empty cells where a channel has no sample there.
///
/// # Errors
/// What `out` answers.
pub fn write_csv(source: &Source, out: &mut dyn Write) -> io::Result<()> {
    let used: Vec<(&str, &Channel)> =
        source.channels.iter().filter_map(|channel| Some((channel.ours.as_deref()?, channel))).collect();
    write!(out, "{}", Column::Time.name())?;
    for (name, _) in &used {
        write!(out, ",{name}")?;
    }
    writeln!(out)?;
    let mut next = vec![0; source.clocks.len()];
    let clocks: Vec<usize> = (0..next.len()).filter(|clock| used.iter().any(|(_, c)| c.clock == *clock)).collect();
    loop {
        let stamp = |clock: &usize| source.clocks[*clock].get(next[*clock]).copied();
        let Some(now_s) = clocks.iter().filter_map(stamp).min_by(f64::total_cmp) else { return Ok(()) };
        let is_now: Vec<bool> =
            (0..next.len()).map(|clock| clocks.contains(&clock) && stamp(&clock) == Some(now_s)).collect();
        write!(out, "{now_s}")?;
        for (name, channel) in &used {
            match channel.values.get(next[channel.clock]).filter(|_| is_now[channel.clock]) {
                Some(value) if name.ends_with(Column::Drive.name()) => write!(out, ",{}", u8::from(*value == 1.0))?,
                Some(value) => write!(out, ",{value}")?,
                None => write!(out, ",")?,
            }
        }
        writeln!(out)?;
        next.iter_mut().zip(is_now).for_each(|(next, is_now)| *next += usize::from(is_now));
    }
}

/// The same as topics: `/joint_states` of what was read, `/joint_command` of what was asked, one pair for each set of
/// stamps. `alone` is the name of a joint that has none.
pub fn mcap_topics(source: &Source, alone: &str) -> Vec<McapTopic> {
    let mut topics: BTreeMap<(usize, bool), McapTopic> = BTreeMap::new();
    for angle in [Column::Angle, Column::Setpoint] {
        let is_read = angle == Column::Angle;
        for channel in &source.channels {
            let Some((joint, column)) = channel.ours.as_deref().and_then(column_of) else { continue };
            if column != angle {
                continue;
            }
            let topic = topics.entry((channel.clock, is_read)).or_insert_with(|| McapTopic {
                name: if is_read { "/joint_states" } else { "/joint_command" }.to_owned(),
                t_s: source.clocks[channel.clock].clone(),
                ..McapTopic::default()
            });
            topic.joints.push(joint.unwrap_or(alone).to_owned());
            topic.position_rad.push(channel.values.clone());
            let beside = |column: Column| {
                let name = joint.map_or_else(|| column.name().to_owned(), |joint| format!("{joint}.{}", column.name()));
                source
                    .ours(&name)
                    .filter(|other| is_read && other.clock == channel.clock)
                    .map(|other| other.values.clone())
            };
            topic.velocity_rad_s.extend(beside(Column::Speed));
            topic.effort_nm.extend(beside(Column::Torque));
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
        let topics = mcap_topics(&source, "joint");
        assert_eq!((topics.len(), topics[0].joints[0].as_str(), topics[1].t_s[0]), (2, "elbow", 0.01));
    }
}
