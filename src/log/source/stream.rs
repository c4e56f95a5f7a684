//! Messages of one topic with one list of names, in columns.

use super::message::{Kind, Point, is_command};

/// A clock that was set back goes on from there for so many messages at least, and does so in fewer than one message of so many.
const IN_A_ROW: usize = 4;
const OVERTAKEN: usize = 20;

/// Messages of one topic with one list of names.
pub(super) struct Stream {
    pub topic: String,
    pub kind: Kind,
    pub names: Vec<String>,
    /// Of the header, or, where that has none, of the receipt \[ns\].
    pub stamps_ns: Vec<i64>,
    /// Messages whose header has a stamp.
    stamped: usize,
    pub received_ns: Vec<i64>,
    pub position: Vec<Vec<f64>>,
    pub velocity: Vec<Vec<f64>>,
    pub effort: Vec<Vec<f64>>,
}

impl Stream {
    /// Without a message yet.
    pub fn new(topic: &str, kind: Kind, names: Vec<String>) -> Self {
        let columns = || vec![Vec::new(); names.len()];
        let [position, velocity, effort] = [columns(), columns(), columns()];
        let topic = topic.to_owned();
        Self {
            topic,
            kind,
            names,
            stamps_ns: Vec::new(),
            stamped: 0,
            received_ns: Vec::new(),
            position,
            velocity,
            effort,
        }
    }

    /// Adds a sample.
    pub fn push(&mut self, stamp_ns: i64, received_ns: i64, is_stamped: bool, point: Point) {
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

    /// Whether its names are these, in whatever order.
    pub fn has_names(&self, names: &[&str]) -> bool {
        self.names.len() == names.len() && self.names.iter().all(|own| names.contains(&own.as_str()))
    }

    /// Where each of its names stands among others.
    pub fn places_in(&self, names: &[&str]) -> Vec<usize> {
        self.names.iter().filter_map(|own| names.iter().position(|name| *name == own)).collect()
    }

    /// Takes the last sample back.
    pub fn pop(&mut self) {
        self.stamps_ns.pop();
        self.received_ns.pop();
        let left = self.stamps_ns.len();
        for column in self.position.iter_mut().chain(&mut self.velocity).chain(&mut self.effort) {
            column.truncate(left);
        }
    }

    /// Takes over a joint from streams that have it at these places, all messages of one after those of the other.
    fn add_joint(&mut self, name: &str, of: &[(&Stream, usize)]) {
        if self.names.is_empty() {
            for (from, _) in of {
                self.stamps_ns.extend_from_slice(&from.stamps_ns);
                self.received_ns.extend_from_slice(&from.received_ns);
                self.stamped += from.stamped;
            }
        }
        self.names.push(name.to_owned());
        self.position.push(joined(of, |from| &from.position));
        self.velocity.push(joined(of, |from| &from.velocity));
        self.effort.push(joined(of, |from| &from.effort));
    }

    /// Whether the headers have stamps: a first one may well be zero.
    pub fn has_stamps(&self) -> bool {
        self.stamped + 1 >= self.stamps_ns.len() && self.stamped > 0
    }

    /// Whether it says what is asked of the joints.
    pub fn is_asked(&self) -> bool {
        !matches!(self.kind, Kind::JointState | Kind::DynamicState) || is_command(&self.topic)
    }

    /// Whether it is what moves another robot of the same joints.
    pub fn leads(&self) -> bool {
        self.topic.split('/').any(|part| matches!(part, "leader" | "master"))
    }

    /// Where the clock of its headers was set back, in words: two recordings that were made one after the other. Messages that
    /// overtake one another do so one at a time, or again and again.
    pub fn set_back(&self) -> Option<String> {
        if !self.has_stamps() || self.kind == Kind::JointTrajectory {
            return None;
        }
        let stamps = &self.stamps_ns[1..];
        let falls: Vec<usize> = (1..stamps.len()).filter(|k| stamps[*k] < stamps[k - 1]).collect();
        if falls.len() > stamps.len() / OVERTAKEN {
            return None;
        }
        let goes_on = |k: &&usize| {
            let after = &stamps[**k..(**k + IN_A_ROW).min(stamps.len())];
            after.len() == IN_A_ROW
                && after.windows(2).all(|pair| pair[0] < pair[1])
                && after[IN_A_ROW - 1] < stamps[**k - 1]
        };
        let at = *falls.iter().find(goes_on)?;
        Some(format!(
            "the stamps of {} run back by {:.3} s at message {}: its clock was set back, or these are two recordings; cut the file \
             there",
            self.topic,
            stamps[at - 1].saturating_sub(stamps[at]) as f64 * 1e-9,
            at + 2
        ))
    }

    /// Puts messages in the order of their stamps, each stamp once; answers with what was done.
    pub fn settle(&mut self, offset_ns: i64) -> Vec<String> {
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
        notes.extend(self.without_blanks());
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

    /// Drops joints that never have a position, then messages in which one is not a number: a driver that starts says so.
    fn without_blanks(&mut self) -> Vec<String> {
        let mut notes = Vec::new();
        let is_blank = |column: &Vec<f64>| column.iter().all(|value| !value.is_finite());
        let blank: Vec<bool> = self.position.iter().map(is_blank).collect();
        if blank.iter().any(|blank| *blank) && !blank.iter().all(|blank| *blank) {
            let of = |is_blank: bool| blank.iter().enumerate().filter(move |(_, b)| **b == is_blank).map(|(k, _)| k);
            let names: Vec<&str> = of(true).map(|k| self.names[k].as_str()).collect();
            notes.push(format!("{}: no position of {}, left out", self.topic, names.join(", ")));
            let kept: Vec<usize> = of(false).collect();
            self.names = kept.iter().map(|k| std::mem::take(&mut self.names[*k])).collect();
            for columns in [&mut self.position, &mut self.velocity, &mut self.effort] {
                *columns = kept.iter().map(|k| std::mem::take(&mut columns[*k])).collect();
            }
        }
        let samples = self.stamps_ns.len();
        let is_whole: Vec<bool> =
            (0..samples).map(|k| self.position.iter().all(|column| column[k].is_finite())).collect();
        let left_out = is_whole.iter().filter(|whole| !**whole).count();
        if left_out > 0 {
            notes
                .push(format!("{}: {left_out} messages with a position that is not a number are left out", self.topic));
            for column in self.position.iter_mut().chain(&mut self.velocity).chain(&mut self.effort) {
                if column.len() == samples {
                    retain_at(column, &is_whole);
                }
            }
            retain_at(&mut self.stamps_ns, &is_whole);
        }
        notes
    }
}

/// The same with each joint of a topic in one of them, whichever other joints its messages have.
pub(super) fn with_joints_whole(streams: Vec<Stream>) -> Vec<Stream> {
    let is_same = |a: &Stream, b: &Stream| !a.kind.is_unnamed() && a.topic == b.topic && a.kind == b.kind;
    let shares = |a: &Stream, b: &Stream| is_same(a, b) && a.names.iter().any(|name| b.names.contains(name));
    if (1..streams.len()).all(|k| !streams[..k].iter().any(|other| shares(other, &streams[k]))) {
        return streams;
    }
    let mut whole: Vec<(Vec<usize>, Stream)> = Vec::new();
    for (k, stream) in streams.iter().enumerate() {
        for (at, name) in stream.names.iter().enumerate() {
            let has_it = |other: &usize| {
                *other == k || is_same(stream, &streams[*other]) && streams[*other].names.contains(name)
            };
            let of: Vec<usize> = (0..streams.len()).filter(has_it).collect();
            if of[0] != k {
                continue;
            }
            let known = whole.iter().position(|(other, _)| *other == of);
            let into = known.unwrap_or_else(|| {
                whole.push((of.clone(), Stream::new(&stream.topic, stream.kind, Vec::new())));
                whole.len() - 1
            });
            let places = of.iter().map(|one| {
                let own = &streams[*one];
                (own, if *one == k { at } else { own.names.iter().position(|own| own == name).unwrap_or(at) })
            });
            whole[into].1.add_joint(name, &places.collect::<Vec<_>>());
        }
    }
    whole.into_iter().map(|(_, stream)| stream).collect()
}

/// A field of a joint that streams have at these places, one after the other.
fn joined(of: &[(&Stream, usize)], field: fn(&Stream) -> &Vec<Vec<f64>>) -> Vec<f64> {
    of.iter().flat_map(|(from, at)| field(from)[*at].iter().copied()).collect()
}

/// Keeps the values that are marked.
fn retain_at<T>(values: &mut Vec<T>, keep: &[bool]) {
    let mut kept = keep.iter();
    values.retain(|_| kept.next().copied().unwrap_or(true));
}
