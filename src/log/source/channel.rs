//! Channels, their stamps, and where in the file a sample stands.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::guess::guess;
use super::want::Want;
use crate::log::column::{Column, column_of};
use crate::log::columns::{ColumnSpec, Unit};
use crate::log::day::Day;
use crate::log::format::Format;
use crate::log::place::{Place, Subject};
use crate::log::plausible::Row;

/// No servo takes more current \[A\]; one that counts milliamperes says more.
const MOST_AMPERES: f64 = 10.0;

/// Samples of one quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// What we call it: `q`, `elbow.q_ref`, `base.z`; `None`: nothing that is used.
    pub ours: Option<String>,
    /// What the file calls it.
    pub theirs: String,
    /// Which of [`Source::clocks`] its samples are stamped by.
    pub clock: usize,
    /// In SI units, radians.
    pub values: Vec<f64>,
    /// The cell of a row that it stands in, of a table.
    pub(in crate::log) cell: Option<usize>,
    /// What its reader takes it to be, until `[columns]` is applied; only ever set while a file is read.
    pub(in crate::log) spec: Option<ColumnSpec>,
}

impl Channel {
    /// Whether it is used where so much is wanted of its file.
    pub(super) fn is_wanted(&self, want: Want<'_>) -> bool {
        match (want, self.ours.as_deref().and_then(column_of)) {
            (Want::Joint(wanted), Some((Some(own), _))) => own == wanted,
            _ => self.ours.is_some(),
        }
    }

    /// Whether it is a current by its name, and counts by its numbers: whole ones, and more than a servo takes amperes.
    pub(crate) fn is_current_in_counts(&self) -> bool {
        let is_current = guess(&self.theirs).is_some_and(|guess| matches!(guess.unit, Some(Unit::Current(_))));
        let is_beyond = self.values.iter().any(|value| value.abs() > MOST_AMPERES);
        is_current && is_beyond && self.values.iter().all(|value| value.fract() == 0.0)
    }
}

/// A file's channels.
#[derive(Clone, Debug)]
pub struct Source {
    /// As the user named it.
    pub file: PathBuf,
    /// What it is.
    pub format: Format,
    /// Stamps \[s\], strictly increasing; channels that were sampled together share one.
    pub clocks: Vec<Vec<f64>>,
    /// What the stamps are counted from, where that is not the file's own zero \[s\].
    pub from_s: f64,
    /// In file order.
    pub channels: Vec<Channel>,
    /// What the file calls that which is not used, in file order.
    pub ignored: Vec<String>,
    /// What the reader decided that a user may want to know, in sentences.
    pub notes: Vec<String>,
    /// Where samples stand in a table.
    pub(in crate::log) rows: Option<Rows>,
    /// Channels, as we call them, whose unit somebody said: it is not questioned.
    pub(in crate::log) stated: BTreeSet<String>,
}

/// Where the rows of a table are.
#[derive(Clone, Debug, Default)]
pub(in crate::log) struct Rows {
    /// Of all rows after the header.
    pub all: Vec<Row>,
    /// The row of each sample of a clock; `None`: sample and row count alike.
    pub of_clock: Vec<Option<Vec<u32>>>,
    /// The cell that stamps stand in, and its name.
    pub time: (usize, String),
}

impl Source {
    /// A file without channels yet.
    pub(in crate::log) fn new(file: PathBuf, format: Format) -> Self {
        Self {
            file,
            format,
            clocks: Vec::new(),
            from_s: 0.0,
            channels: Vec::new(),
            ignored: Vec::new(),
            notes: Vec::new(),
            rows: None,
            stated: BTreeSet::new(),
        }
    }

    /// The channel that we call so.
    pub fn ours(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.ours.as_deref() == Some(name))
    }

    /// Stamps of a channel \[s\].
    pub fn t_s(&self, channel: &Channel) -> &[f64] {
        &self.clocks[channel.clock]
    }

    /// The day of the first sample, where stamps count from 1970.
    pub fn day(&self) -> Option<Day> {
        let first_s = self.clocks.iter().filter_map(|clock| clock.first()).copied().reduce(f64::min);
        Day::of_epoch_s(self.from_s + first_s?)
    }

    /// Joints that have an angle, in file order; the joint of a log of one has the name `None`.
    pub fn joints(&self) -> Vec<Option<&str>> {
        let ours = self.channels.iter().filter_map(|channel| column_of(channel.ours.as_deref()?));
        ours.filter(|(_, column)| *column == Column::Angle).map(|(joint, _)| joint).collect()
    }

    /// Where a sample stands, as far as the format has places; `time`: where its stamp does.
    pub(in crate::log) fn place(&self, channel: &Channel, sample: usize, time: bool) -> Box<Place> {
        let row_of = |rows: &Rows| match rows.of_clock.get(channel.clock) {
            Some(Some(of)) => of.get(sample).map(|row| *row as usize),
            _ => Some(sample),
        };
        let found = self.rows.as_ref().and_then(|rows| Some((rows, *rows.all.get(row_of(rows)?)?)));
        let Some((rows, row)) = found else { return Box::new(Place::of_column(&self.file, &channel.theirs)) };
        let (cell, name) =
            if time { (rows.time.0, &rows.time.1) } else { (channel.cell.unwrap_or(0), &channel.theirs) };
        Box::new(Place::in_log(&self.file, row.byte, row.line, Subject::Column(name.clone()), Some(cell)))
    }
}
