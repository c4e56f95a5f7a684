//! Messages gathered by topic, and what of them is a reading and what a setpoint.

use std::collections::BTreeMap;
use std::path::Path;

use super::cdr::{Kind, Message, Point};
use super::channel::{Channel, Format, Source};
use crate::log::error::LogError;

/// Lists of names that one topic may alternate between: several publishers.
const MOST_STREAMS: usize = 64;
/// Clocks that differ by more than this are not the same clock \[ns\].
const SAME_CLOCK_NS: i64 = 1_000_000_000;
/// Instants at which setpoints without names are compared with readings.
const COMPARED: usize = 2000;

/// Messages of one topic with one list of names.
struct Stream {
    topic: String,
    kind: Kind,
    names: Vec<String>,
    /// Of the header, or, where that has none, of the receipt \[ns\].
    stamps_ns: Vec<i64>,
    /// Messages whose header has a stamp.
    stamped: usize,
    received_ns: Vec<i64>,
    position: Vec<Vec<f64>>,
    velocity: Vec<Vec<f64>>,
    effort: Vec<Vec<f64>>,
}

/// All messages of a file.
#[derive(Default)]
pub(super) struct Topics {
    streams: Vec<Stream>,
    last: usize,
    messages: usize,
    /// Messages whose arrays are not as long as their names.
    uneven: usize,
    /// Trajectories of several points.
    trajectories: usize,
}

impl Topics {
    /// Messages so far.
    pub fn messages(&self) -> usize {
        self.messages
    }

    /// Takes a message.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn take(
        &mut self,
        topic: &str,
        kind: Kind,
        names: &[&str],
        received_ns: i64,
        message: Message<'_>,
    ) -> Result<(), String> {
        self.messages += 1;
        let width = if kind == Kind::MultiArray {
            message.points.first().map_or(0, |point| point.position.len())
        } else {
            names.len()
        };
        let fits = |stream: &Stream| {
            stream.topic == topic
                && (kind == Kind::MultiArray && stream.position.len() == width
                    || kind != Kind::MultiArray && stream.names.iter().eq(names))
        };
        if !self.streams.get(self.last).is_some_and(fits) {
            self.last = match self.streams.iter().position(fits) {
                Some(at) => at,
                None => {
                    if self.streams.len() >= MOST_STREAMS {
                        return Err(format!("more than {MOST_STREAMS} different lists of joints"));
                    }
                    let names = match kind {
                        Kind::MultiArray => (0..width).map(|k| format!("data[{k}]")).collect(),
                        _ => names.iter().map(|name| (*name).to_owned()).collect(),
                    };
                    let columns = || vec![Vec::new(); width];
                    self.streams.push(Stream {
                        topic: topic.to_owned(),
                        kind,
                        names,
                        stamps_ns: Vec::new(),
                        stamped: 0,
                        received_ns: Vec::new(),
                        position: columns(),
                        velocity: columns(),
                        effort: columns(),
                    });
                    self.streams.len() - 1
                }
            };
        }
        let stream = &mut self.streams[self.last];
        let stamp_ns = message.stamp_ns.unwrap_or(received_ns);
        if kind == Kind::JointTrajectory {
            // What an earlier trajectory asked for from here on is not to come any more.
            let starts_ns = stamp_ns.saturating_add(message.points.first().map_or(0, |point| point.after_ns));
            while stream.stamps_ns.last().is_some_and(|last| *last >= starts_ns) {
                stream.pop();
            }
        }
        let is_single = message.points.len() == 1;
        self.trajectories += usize::from(!is_single && kind == Kind::JointTrajectory);
        for point in message.points {
            if point.position.len() != width {
                // A state without positions says nothing that is used.
                self.uneven += 1;
                continue;
            }
            // A trajectory of one point is a setpoint at once.
            let after_ns = if is_single { 0 } else { point.after_ns };
            stream.push(stamp_ns.saturating_add(after_ns), received_ns, message.stamp_ns.is_some(), point);
        }
        Ok(())
    }

    /// The channels of a file, readings and setpoints told apart.
    ///
    /// # Errors
    /// [`LogError::Format`] where nothing is there.
    pub fn into_source(mut self, path: &Path, format: Format) -> Result<Source, LogError> {
        let wrong = |what: String| LogError::Format { file: path.to_path_buf(), format, what };
        let mut source = Source::new(path.to_path_buf(), format);
        self.streams.retain(|stream| !stream.stamps_ns.is_empty());
        if self.streams.is_empty() {
            let what = if self.messages > 0 {
                format!("{} messages of joints, and none with positions", self.messages)
            } else {
                "no message of a kind that is read (JointState, JointTrajectory, Float64MultiArray)".to_owned()
            };
            return Err(wrong(what));
        }
        if self.uneven > 0 {
            source.notes.push(format!("{} messages without a position for each name are left out", self.uneven));
        }
        if self.trajectories > 0 {
            let note = "{} trajectories of several points, each a setpoint at its own time: a controller that interpolates is \
                        read by hold = \"linear\"";
            source.notes.push(note.replacen("{}", &self.trajectories.to_string(), 1));
        }
        let offset_ns = self.clock_offset_ns();
        for stream in &mut self.streams {
            source.notes.extend(stream.settle(offset_ns));
        }
        let base_ns = self.streams.iter().filter_map(|stream| stream.stamps_ns.first()).min().copied().unwrap_or(0);
        // Of several topics with the same joints the one with most messages is the reading.
        self.streams.sort_by_key(|stream| std::cmp::Reverse(stream.stamps_ns.len()));
        let mut taken: BTreeMap<String, ()> = BTreeMap::new();
        let mut unnamed: Vec<(Vec<usize>, String)> = Vec::new();
        let mut clocks_ns: Vec<Vec<i64>> = Vec::new();
        for stream in self.streams {
            let (asked, first) = (stream.is_asked(), source.channels.len());
            // Joints that come in messages of their own, and at the same times, share a clock all the same.
            let clock =
                clocks_ns.iter().position(|known: &Vec<i64>| *known == stream.stamps_ns).unwrap_or(clocks_ns.len());
            if clock == clocks_ns.len() {
                let from_base = |ns: &i64| ns.saturating_sub(base_ns) as f64 * 1e-9;
                source.clocks.push(stream.stamps_ns.iter().map(from_base).collect());
                clocks_ns.push(stream.stamps_ns);
            }
            let samples = clocks_ns[clock].len();
            let fields = [("position", stream.position), ("velocity", stream.velocity), ("effort", stream.effort)];
            for (field, columns) in fields {
                let of_topic = role(&stream.topic, stream.kind, asked, field);
                for (name, values) in stream.names.iter().zip(columns) {
                    if values.len() != samples || values.iter().any(|value| !value.is_finite()) {
                        continue;
                    }
                    let theirs = match stream.kind {
                        Kind::MultiArray => format!("{}/{name}", stream.topic),
                        _ => format!("{}/{name}/{field}", stream.topic),
                    };
                    let ours = of_topic.filter(|_| stream.kind != Kind::MultiArray).map(|of| format!("{name}.{of}"));
                    let ours = ours.filter(|ours| taken.insert(ours.clone(), ()).is_none());
                    if ours.is_none() && stream.kind != Kind::MultiArray {
                        source.ignored.push(theirs.clone());
                    }
                    source.channels.push(Channel { ours, theirs, clock, values, cell: None, spec: None });
                }
            }
            if stream.kind == Kind::MultiArray {
                unnamed.push(((first..source.channels.len()).collect(), stream.topic));
            }
        }
        for (channels, topic) in unnamed {
            name_by_readings(&mut source, &channels, &topic);
        }
        Ok(source)
    }

    /// By how much receipt runs ahead of the headers' clock, where they are different clocks \[ns\].
    fn clock_offset_ns(&self) -> i64 {
        let stamped = self.streams.iter().filter(|stream| stream.has_stamps());
        let Some(stream) = stamped.max_by_key(|stream| stream.stamps_ns.len()) else { return 0 };
        let ahead =
            stream.received_ns.iter().zip(&stream.stamps_ns).map(|(received, stamp)| received.saturating_sub(*stamp));
        // The message that came quickest is the nearest to its stamp.
        ahead.min_by_key(|ns| ns.saturating_abs()).filter(|ns| ns.saturating_abs() > SAME_CLOCK_NS).unwrap_or(0)
    }
}

impl Stream {
    fn push(&mut self, stamp_ns: i64, received_ns: i64, is_stamped: bool, point: Point) {
        self.stamps_ns.push(stamp_ns);
        self.received_ns.push(received_ns);
        self.stamped += usize::from(is_stamped);
        let fields = [
            (&mut self.position, point.position),
            (&mut self.velocity, point.velocity),
            (&mut self.effort, point.effort),
        ];
        for (columns, values) in fields {
            if values.len() == columns.len() {
                columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
            }
        }
    }

    fn pop(&mut self) {
        self.stamps_ns.pop();
        self.received_ns.pop();
        let left = self.stamps_ns.len();
        for column in self.position.iter_mut().chain(&mut self.velocity).chain(&mut self.effort) {
            column.truncate(left);
        }
    }

    /// Whether the headers have stamps: a first one may well be zero.
    fn has_stamps(&self) -> bool {
        self.stamped + 1 >= self.stamps_ns.len() && self.stamped > 0
    }

    /// Whether it says what is asked of the joints.
    fn is_asked(&self) -> bool {
        let words = ["command", "cmd", "desired", "target", "goal", "reference", "setpoint", "_ref"];
        self.kind != Kind::JointState || words.iter().any(|word| self.topic.to_lowercase().contains(word))
    }

    /// Puts messages in the order of their stamps, each stamp once; answers with what was done.
    fn settle(&mut self, offset_ns: i64) -> Vec<String> {
        let mut notes = Vec::new();
        if !self.has_stamps() {
            if self.stamped > 0 || self.kind != Kind::JointTrajectory {
                self.stamps_ns.clone_from(&self.received_ns);
            }
            self.stamps_ns.iter_mut().for_each(|stamp| *stamp = stamp.saturating_sub(offset_ns));
            let by = if offset_ns == 0 {
                String::new()
            } else {
                format!(", less {:.3} s, by which the clocks differ", offset_ns as f64 * 1e-9)
            };
            notes.push(format!("{}: without stamps of its own, taken at its receipt{by}", self.topic));
        } else if self.stamped < self.stamps_ns.len()
            && let Some(first) = self.stamps_ns.first_mut()
        {
            // The one message without a stamp is one at zero.
            *first = 0;
        }
        self.received_ns = Vec::new();
        if self.stamps_ns.windows(2).all(|pair| pair[0] < pair[1]) {
            return notes;
        }
        let mut order: Vec<u32> = (0..self.stamps_ns.len() as u32).collect();
        order.sort_by_key(|k| self.stamps_ns[*k as usize]);
        let before = order.len();
        order.dedup_by_key(|k| self.stamps_ns[*k as usize]);
        if order.len() < before {
            notes.push(format!("{}: {} messages repeat a stamp and are left out", self.topic, before - order.len()));
        }
        let in_order =
            |values: &[f64]| order.iter().filter_map(|k| values.get(*k as usize).copied()).collect::<Vec<f64>>();
        for column in self.position.iter_mut().chain(&mut self.velocity).chain(&mut self.effort) {
            if column.len() == before {
                *column = in_order(column);
            }
        }
        self.stamps_ns = order.iter().map(|k| self.stamps_ns[*k as usize]).collect();
        notes
    }
}

/// Our name for a field of a topic, where it has one.
fn role(topic: &str, kind: Kind, asked: bool, field: &str) -> Option<&'static str> {
    match (asked, field) {
        (false, "position") => Some("q"),
        (false, "velocity") => Some("dq"),
        (false, "effort") => Some("tau"),
        (true, "position") if kind == Kind::MultiArray => array_role(topic),
        (true, "position") => Some("q_ref"),
        _ => None,
    }
}

fn array_role(topic: &str) -> Option<&'static str> {
    let topic = topic.to_lowercase();
    match topic {
        topic if topic.contains("effort") || topic.contains("torque") => Some("tau"),
        topic if topic.contains("velocity") => None,
        _ => Some("q_ref"),
    }
}

/// Gives setpoints without names the joints whose readings they are nearest to, and says so.
fn name_by_readings(source: &mut Source, asked: &[usize], topic: &str) {
    let joints: Vec<String> = source.joints().into_iter().flatten().map(str::to_owned).collect();
    let Some(role) = array_role(topic) else {
        source.notes.push(format!("{topic}: velocities, which nothing here is driven by"));
        return;
    };
    let distances: Vec<Vec<f64>> =
        asked.iter().map(|k| joints.iter().map(|joint| distance(source, *k, joint)).collect()).collect();
    let nearest: Vec<usize> = distances
        .iter()
        .map(|row| row.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(usize::MAX, |(at, _)| at))
        .collect();
    let distinct = nearest.iter().enumerate().all(|(k, joint)| *joint < joints.len() && !nearest[..k].contains(joint));
    let in_order: Vec<usize> = (0..asked.len()).collect();
    let (assigned, how) = match role {
        "q_ref" if distinct => (nearest, "by the readings that they are nearest to"),
        _ if asked.len() == joints.len() => (in_order, "in the order of the readings"),
        _ => {
            source
                .notes
                .push(format!("{topic}: {} numbers without names; say in [columns] whose they are", asked.len()));
            return;
        }
    };
    for (k, joint) in asked.iter().zip(&assigned) {
        let ours = format!("{}.{role}", joints[*joint]);
        source.channels.iter_mut().filter(|c| c.ours.as_deref() == Some(&ours)).for_each(|c| c.ours = None);
        source.channels[*k].ours = Some(ours);
    }
    let names: Vec<&str> = assigned.iter().map(|joint| joints[*joint].as_str()).collect();
    source.notes.push(format!("{topic}: taken to be {role} of {} {how} (a guess)", names.join(", ")));
}

/// Mean distance of a setpoint from a joint's reading \[rad\].
fn distance(source: &Source, asked: usize, joint: &str) -> f64 {
    let asked = &source.channels[asked];
    let Some(read) = source.ours(&format!("{joint}.q")) else { return f64::INFINITY };
    let (asked_s, read_s) = (source.t_s(asked), source.t_s(read));
    let stride = (asked_s.len() / COMPARED).max(1);
    let apart = asked_s.iter().zip(&asked.values).step_by(stride).filter_map(|(t, value)| {
        let after = read_s.partition_point(|other| other <= t);
        Some((value - read.values.get(after.checked_sub(1)?)?).abs())
    });
    let (sum, count) = apart.fold((0.0, 0), |(sum, count), apart| (sum + apart, count + 1));
    if count == 0 { f64::INFINITY } else { sum / f64::from(count) }
}

#[cfg(test)]
#[path = "topics_tests.rs"]
mod tests;
