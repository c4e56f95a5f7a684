//! Logs of Rhoban's BAM (a servo with a pendulum): one JSON object with what the person at the bench noted, and entries.

use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::channel::{Channel, Source};
use crate::log::error::LogError;
use crate::log::format::Format;

/// Entries of a log at the most: a day at a kilohertz.
const MOST_ENTRIES: usize = 100_000_000;

/// Reads a log: angle, speed, goal and whether the torque is on; stamps, or the period `dt`.
///
/// # Errors
/// [`LogError::Format`] where it is no such JSON.
pub(super) fn read_bam(path: &Path) -> Result<Source, LogError> {
    let wrong = |what: String| LogError::Format { file: path.to_path_buf(), format: Format::Bam, what };
    let file = File::open(path).map_err(|source| LogError::Read { file: path.to_path_buf(), source })?;
    let bench: Bench = serde_json::from_reader(BufReader::with_capacity(1 << 18, file)).map_err(|error| {
        let what = if error.is_eof() { "cut short: " } else { "" };
        wrong(format!("{what}{error}"))
    })?;
    let entries = bench.entries;
    let samples = entries.position.len();
    if samples == 0 {
        return Err(wrong("no entry with a position".to_owned()));
    }
    let mut source = Source::new(path.to_path_buf(), Format::Bam);
    source.clocks.push(if entries.timestamp.len() == samples {
        entries.timestamp
    } else if let Some(dt_s) = bench.dt.filter(|dt_s| *dt_s > 0.0) {
        (0..samples).map(|k| k as f64 * dt_s).collect()
    } else {
        return Err(wrong("entries without a `timestamp`, and no `dt`".to_owned()));
    });
    let columns = [
        ("q", "position", entries.position),
        ("dq", "speed", entries.speed),
        ("q_ref", "goal_position", entries.goal),
        ("drive", "torque_enable", entries.on),
    ];
    for (ours, theirs, values) in columns {
        if values.len() == samples {
            let ours = Some(ours.to_owned());
            source.channels.push(Channel { ours, theirs: theirs.to_owned(), clock: 0, values, cell: None, spec: None });
        } else if !values.is_empty() {
            source.notes.push(format!("{theirs}: not in every entry, left out"));
        }
    }
    let said = [
        ("motor", bench.motor),
        ("kp", bench.kp),
        ("mass", bench.mass),
        ("arm_mass", bench.arm_mass),
        ("length", bench.length),
        ("vin", bench.vin),
    ];
    let said = said.into_iter().filter_map(|(key, value)| Some(format!("{key} {}", value?)));
    let said: Vec<String> = said.collect();
    if !said.is_empty() {
        source.notes.push(format!("the recorder says {} (kp in the servo's own unit)", said.join(", ")));
    }
    Ok(source)
}

#[derive(Deserialize)]
struct Bench {
    dt: Option<f64>,
    motor: Option<Said>,
    kp: Option<Said>,
    mass: Option<Said>,
    arm_mass: Option<Said>,
    length: Option<Said>,
    vin: Option<Said>,
    entries: Entries,
}

/// A word or a number of the person at the bench.
#[derive(Deserialize)]
#[serde(untagged)]
enum Said {
    Number(f64),
    Word(String),
}

impl fmt::Display for Said {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Word(word) => word.chars().take(40).collect::<String>().fmt(f),
        }
    }
}

/// The entries, in columns.
#[derive(Default)]
struct Entries {
    timestamp: Vec<f64>,
    position: Vec<f64>,
    speed: Vec<f64>,
    goal: Vec<f64>,
    on: Vec<f64>,
}

/// One entry; what else a servo says is passed over.
#[derive(Default)]
struct Entry {
    timestamp: Option<f64>,
    position: Option<f64>,
    speed: Option<f64>,
    goal: Option<f64>,
    on: Option<f64>,
}

impl<'de> Deserialize<'de> for Entry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfMap;
        impl<'de> Visitor<'de> for OfMap {
            type Value = Entry;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an entry")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entry, A::Error> {
                let mut entry = Entry::default();
                while let Some(key) = map.next_key::<std::borrow::Cow<'de, str>>()? {
                    match &*key {
                        "timestamp" => entry.timestamp = map.next_value()?,
                        "position" => entry.position = map.next_value()?,
                        "speed" => entry.speed = map.next_value()?,
                        "goal_position" => entry.goal = map.next_value()?,
                        "torque_enable" => entry.on = Some(f64::from(u8::from(map.next_value::<Switch>()?.0))),
                        _ => drop(map.next_value::<IgnoredAny>()?),
                    }
                }
                Ok(entry)
            }
        }
        deserializer.deserialize_map(OfMap)
    }
}

/// `true`, `false`, 1 or 0.
struct Switch(bool);

impl<'de> Deserialize<'de> for Switch {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Either {
            Word(bool),
            Number(f64),
        }
        Ok(Self(match Either::deserialize(deserializer)? {
            Either::Word(on) => on,
            Either::Number(on) => on != 0.0,
        }))
    }
}

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfSeq;
        impl<'de> Visitor<'de> for OfSeq {
            type Value = Entries;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of entries")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Entries, A::Error> {
                let mut all = Entries::default();
                while let Some(entry) = seq.next_element::<Entry>()? {
                    // An entry without an angle says nothing.
                    let Some(position) = entry.position else { continue };
                    all.position.push(position);
                    all.timestamp.extend(entry.timestamp);
                    all.speed.extend(entry.speed);
                    all.goal.extend(entry.goal);
                    all.on.extend(entry.on);
                    if all.position.len() > MOST_ENTRIES {
                        return Err(serde::de::Error::custom("more entries than a log has"));
                    }
                }
                Ok(all)
            }
        }
        deserializer.deserialize_seq(OfSeq)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Source, LogError> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("log.json");
        std::fs::write(&path, text).unwrap();
        read_bam(&path)
    }

    #[test]
    fn entries_become_columns_and_the_bench_a_note() {
        let entry = |t: f64, on: &str| {
            format!(
                "{{\"timestamp\":{t},\"position\":{t},\"speed\":1,\"load\":3,\"goal_position\":0.5,\"torque_enable\":{on}}}"
            )
        };
        let text = format!(
            "{{\"mass\":0.5,\"motor\":\"mx64\",\"kp\":8,\"entries\":[{},{}]}}",
            entry(0.0, "true"),
            entry(0.1, "0")
        );
        let source = read(&text).unwrap();
        assert_eq!(source.ours("drive").unwrap().values, [1.0, 0.0]);
        assert_eq!(source.ours("q_ref").unwrap().values, [0.5, 0.5]);
        assert!(source.notes[0].contains("motor mx64, kp 8, mass 0.5"), "{:?}", source.notes);
        let text = "{\"dt\":0.005,\"entries\":[{\"position\":1},{\"position\":2}]}";
        assert_eq!(read(text).unwrap().clocks[0], [0.0, 0.005]);
    }

    #[test]
    fn what_is_no_such_log_is_told() {
        for (text, part) in [
            ("{\"entries\":[{\"position\":1", "cut short"),
            ("{\"entries\":[]}", "no entry with a position"),
            ("{\"entries\":[{\"position\":\"a\"}]}", "string"),
            ("{\"a\":1}", "missing field `entries`"),
            ("{\"entries\":[{\"position\":1}]}", "no `dt`"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("log.json"), "{text}: {message}");
        }
    }
}
