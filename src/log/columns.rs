//! What a file calls the columns that we know, and the units, signs and zeros it has them in.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt;

use super::column::Column;
use super::toml_text::{toml_key, toml_string};

/// The unit of a column of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unit {
    /// Times a second of this length \[s\]: `s`, `ms`, `us`, `ns`.
    Time(f64),
    /// Times this many radians \[rad\]: `rad`, `mrad`, `deg`, `rev`; of a speed, per second, and `rpm`.
    Angle(f64),
    /// So many to a turn: encoder counts, or a fraction of a range.
    Ticks {
        /// \[1\]
        per_rev: f64,
    },
    /// Times this many newton metres \[N m\]: `N m`, `mN m`.
    Torque(f64),
    /// Times this many amperes \[A\]: `A`, `mA`; a current, which `tau_is = "current"` turns into torque.
    Current(f64),
}

/// The words of a study for units, but for `ticks`.
pub(in crate::log) const WORDS: [(&str, Unit); 13] = [
    ("s", Unit::Time(1.0)),
    ("ms", Unit::Time(1e-3)),
    ("us", Unit::Time(1e-6)),
    ("ns", Unit::Time(1e-9)),
    ("rad", Unit::Angle(1.0)),
    ("deg", Unit::Angle(TAU / 360.0)),
    ("rev", Unit::Angle(TAU)),
    ("mrad", Unit::Angle(1e-3)),
    ("rpm", Unit::RPM),
    ("N m", Unit::Torque(1.0)),
    ("mN m", Unit::Torque(1e-3)),
    ("A", Unit::Current(1.0)),
    ("mA", Unit::Current(1e-3)),
];

impl Unit {
    /// Turns a minute, of a speed.
    pub(in crate::log) const RPM: Self = Self::Angle(TAU / 60.0);

    /// In SI per unit of the file.
    pub fn scale(self) -> f64 {
        match self {
            Self::Time(scale) | Self::Angle(scale) | Self::Torque(scale) | Self::Current(scale) => scale,
            Self::Ticks { per_rev } => TAU / per_rev,
        }
    }

    /// Units that a column may have.
    pub(in crate::log) fn fits(self, column: Column) -> bool {
        match column {
            Column::Time => matches!(self, Self::Time(_)),
            Column::Angle | Column::Setpoint if self == Self::RPM => false,
            Column::Angle | Column::Setpoint | Column::Speed => matches!(self, Self::Angle(_) | Self::Ticks { .. }),
            Column::Torque => matches!(self, Self::Torque(_) | Self::Current(_)),
            Column::Drive => false,
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(WORDS.iter().find(|(_, unit)| unit == self).map_or("ticks", |(word, _)| word))
    }
}

/// What a file has for one of our columns: `ours = sign * (theirs in SI) - zero`.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnSpec {
    /// As the file calls it.
    pub name: String,
    /// In what it stands there; `None`: as ours.
    pub unit: Option<Unit>,
    /// Where theirs grows the other way.
    pub is_reversed: bool,
    /// What ours reads less \[our unit\].
    pub zero: f64,
}

impl ColumnSpec {
    /// A column that is ours under another name.
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into(), unit: None, is_reversed: false, zero: 0.0 }
    }

    /// Ours, of a number of theirs.
    pub fn apply(&self, theirs: f64) -> f64 {
        let value = self.unit.map_or(theirs, |unit| theirs * unit.scale());
        (if self.is_reversed { -value } else { value }) - self.zero
    }

    /// The value that it has in a study.
    pub fn toml(&self) -> String {
        let mut text = format!("{{ name = {}", toml_string(&self.name));
        if let Some(unit) = self.unit {
            text += &format!(", unit = \"{unit}\"");
        }
        if let Some(Unit::Ticks { per_rev }) = self.unit {
            text += &format!(", per_rev = {per_rev:?}");
        }
        if self.is_reversed {
            text += ", sign = -1";
        }
        if self.zero != 0.0 {
            text += &format!(", zero = {:?}", self.zero);
        }
        text + " }"
    }
}

/// `[columns]`, by our names: `t`, `q`, `elbow.q_ref`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns(pub BTreeMap<String, ColumnSpec>);

impl Columns {
    /// What the file has for one of our columns.
    pub fn get(&self, ours: &str) -> Option<&ColumnSpec> {
        self.0.get(ours)
    }

    /// The table as it stands in a study; empty where there is nothing to say.
    pub fn toml(&self) -> String {
        let lines = self.0.iter().map(|(ours, spec)| format!("{} = {}\n", toml_key(ours), spec.toml()));
        if self.0.is_empty() { String::new() } else { "[columns]\n".to_owned() + &lines.collect::<String>() }
    }
}
