//! Messages gathered by topic, and what of them is a reading and what a setpoint.

use std::collections::BTreeMap;
use std::path::Path;

use super::channel::{Channel, Source};
use super::message::{KINDS, Kind, Message};
use super::roles::{name_by_readings, role};
use super::stream::{Stream, with_joints_whole};
use crate::log::error::LogError;
use crate::log::format::Format;

/// Lists of names that one topic may alternate between: several publishers.
const MOST_STREAMS: usize = 64;
/// Clocks that differ by more than this are not the same clock \[ns\].
const SAME_CLOCK_NS: i64 = 1_000_000_000;

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
    /// Topics of kinds that are not read.
    others: Vec<String>,
}

/// Of topics that are not read so many are named.
const MOST_NAMED: usize = 6;

impl Topics {
    /// Messages so far.
    pub fn messages(&self) -> usize {
        self.messages
    }

    /// Leaves a topic out, of a kind that is not read; it is named where nothing that is read says what is asked of the joints.
    pub fn leave_out(&mut self, about: &str) {
        if !self.others.iter().any(|known| known == about) {
            self.others.push(about.to_owned());
        }
    }

    /// What was left out, where what is asked of the joints may be among it.
    fn left_out(&self) -> Option<String> {
        let is_missed = !self.others.is_empty() && !self.streams.iter().any(Stream::is_asked);
        is_missed.then(|| {
            let (named, more) = self.others.split_at(MOST_NAMED.min(self.others.len()));
            let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
            format!("what is asked of the joints is in no topic that is read; left out are {}{more}", named.join(", "))
        })
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
        let width = if kind.is_unnamed() {
            message.points.first().map_or(0, |point| point.position.len())
        } else {
            names.len()
        };
        let fits = |stream: &Stream| {
            stream.topic == topic
                && (kind.is_unnamed() && stream.position.len() == width
                    || !kind.is_unnamed() && stream.names.iter().eq(names))
        };
        let is_shuffled = |stream: &Stream| stream.topic == topic && !kind.is_unnamed() && stream.has_names(names);
        if !self.streams.get(self.last).is_some_and(fits) {
            self.last = match self.streams.iter().position(|stream| fits(stream) || is_shuffled(stream)) {
                Some(at) => at,
                None => {
                    if self.streams.len() >= MOST_STREAMS {
                        return Err(format!("more than {MOST_STREAMS} different lists of joints"));
                    }
                    let names = match kind {
                        Kind::MultiArray | Kind::Number => (0..width).map(|k| format!("data[{k}]")).collect(),
                        _ => names.iter().map(|name| (*name).to_owned()).collect(),
                    };
                    self.streams.push(Stream::new(topic, kind, names));
                    self.streams.len() - 1
                }
            };
        }
        let stream = &mut self.streams[self.last];
        let order = if fits(stream) { Vec::new() } else { stream.places_in(names) };
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
            let point = if order.is_empty() { point } else { point.in_order(&order) };
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
                format!("no message of a kind that is read ({KINDS})")
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
        source.notes.extend(self.left_out());
        if let Some(set_back) = self.streams.iter().find_map(Stream::set_back) {
            return Err(wrong(set_back));
        }
        let offset_ns = self.clock_offset_ns();
        self.streams = with_joints_whole(self.streams);
        for stream in &mut self.streams {
            source.notes.extend(stream.settle(offset_ns));
        }
        let base_ns = self.streams.iter().filter_map(|stream| stream.stamps_ns.first()).min().copied().unwrap_or(0);
        source.from_s = base_ns as f64 * 1e-9;
        self.streams.retain(|stream| !stream.stamps_ns.is_empty());
        if self.streams.is_empty() {
            return Err(wrong("no message in which every position is a number".to_owned()));
        }
        // Of several topics with the same joints the one with the usual name is the reading, then that with most messages.
        self.streams.sort_by_key(|stream| std::cmp::Reverse((is_usual(&stream.topic), stream.stamps_ns.len())));
        let has_follower = self.streams.iter().any(|stream| !stream.is_asked() && !stream.leads());
        // A joint is read from one topic, and asked by one: those of two may be of two robots.
        let mut taken: BTreeMap<(String, bool), String> = BTreeMap::new();
        let mut unnamed: Vec<(Vec<usize>, String, Kind)> = Vec::new();
        let mut clocks_ns: Vec<Vec<i64>> = Vec::new();
        for stream in self.streams {
            let asked = stream.is_asked() || stream.leads() && has_follower;
            let first = source.channels.len();
            // Joints that come in messages of their own, and at the same times, share a clock all the same.
            let clock =
                clocks_ns.iter().position(|known: &Vec<i64>| *known == stream.stamps_ns).unwrap_or(clocks_ns.len());
            if clock == clocks_ns.len() {
                let from_base = |ns: &i64| ns.saturating_sub(base_ns) as f64 * 1e-9;
                source.clocks.push(stream.stamps_ns.iter().map(from_base).collect());
                clocks_ns.push(stream.stamps_ns);
            }
            let samples = clocks_ns[clock].len();
            let mut doubled: BTreeMap<String, Vec<&str>> = BTreeMap::new();
            let fields = [("position", stream.position), ("velocity", stream.velocity), ("effort", stream.effort)];
            for (field, columns) in fields {
                let of_topic = role(&stream.topic, stream.kind, asked, field);
                for (name, values) in stream.names.iter().zip(columns) {
                    if values.len() != samples || values.iter().any(|value| !value.is_finite()) {
                        continue;
                    }
                    let theirs = match stream.kind {
                        kind if kind.is_unnamed() => format!("{}/{name}", stream.topic),
                        _ => format!("{}/{name}/{field}", stream.topic),
                    };
                    let ours = of_topic.filter(|_| !stream.kind.is_unnamed()).map(|of| format!("{name}.{of}"));
                    let known = taken.get(&(name.clone(), asked)).filter(|other| **other != stream.topic);
                    if let Some(other) = known.filter(|_| field == "position" && ours.is_some()) {
                        doubled.entry(other.clone()).or_default().push(name);
                    }
                    let ours = ours.filter(|_| known.is_none());
                    if ours.is_some() {
                        taken.insert((name.clone(), asked), stream.topic.clone());
                    }
                    if ours.is_none() && !stream.kind.is_unnamed() {
                        source.ignored.push(theirs.clone());
                    }
                    source.channels.push(Channel { ours, theirs, clock, values, cell: None, spec: None });
                }
            }
            for (other, names) in doubled {
                let (topic, names) = (&stream.topic, names.join(", "));
                source.notes.push(format!("{topic}: {names} left out, which {other} has"));
            }
            if stream.kind.is_unnamed() {
                unnamed.push(((first..source.channels.len()).collect(), stream.topic, stream.kind));
            }
        }
        for (channels, topic, kind) in unnamed {
            name_by_readings(&mut source, &channels, &topic, kind);
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

/// Whether a topic has the name that readings of joints usually have.
fn is_usual(topic: &str) -> bool {
    topic.rsplit('/').next() == Some("joint_states")
}

#[cfg(test)]
#[path = "topics_tests.rs"]
mod tests;
