//! Bags of ROS 2 in SQLite (`.db3`).

use std::fs::File;
use std::path::Path;

use super::intake::{Topic, take_message};
use super::message::{Encoding, KINDS, Kind};
use super::sqlite::Database;
use super::topics::Topics;
use crate::log::error::LogError;
use crate::log::format::Format;

/// Adds the messages of a bag.
///
/// # Errors
/// [`LogError::Format`] where the file is damaged, with what had been read of it.
pub(super) fn read_db3(path: &Path, file: File, topics: &mut Topics) -> Result<(), LogError> {
    let wrong = |what: String| LogError::Format { file: path.to_path_buf(), format: Format::Rosbag2, what };
    let mut wal = path.as_os_str().to_owned();
    wal.push("-wal");
    if std::fs::metadata(&wal).is_ok_and(|wal| wal.len() > 0) {
        let what = "its write-ahead log (-wal) holds messages that are not in it yet; close the recorder, or open the file once with sqlite3";
        return Err(wrong(what.to_owned()));
    }
    let before = topics.messages();
    messages(file, topics).map_err(|what| {
        let read = topics.messages() - before;
        wrong(if read > 0 { format!("{what}; {read} messages of joints had been read") } else { what })
    })
}

fn messages(file: File, topics: &mut Topics) -> Result<(), String> {
    let mut database = Database::open(file)?;
    let no = |name: &str| format!("no table `{name}`: an SQLite file, but no bag");
    let listed = database.table("topics")?.ok_or_else(|| no("topics"))?;
    let stored = database.table("messages")?.ok_or_else(|| no("messages"))?;
    let (name, kind, encoding) =
        (listed.column("name")?, listed.column("type")?, listed.column("serialization_format")?);
    let mut wanted: Vec<(i64, Topic)> = Vec::new();
    let mut others: Vec<String> = Vec::new();
    database.rows(&listed, &mut |row, values| {
        let text = |at: usize| values.get(at).and_then(super::sqlite::Value::text).unwrap_or("");
        match Kind::of(text(name), text(kind)) {
            Some(kind) if text(encoding) == "cdr" || text(encoding).is_empty() => {
                wanted.push((row, Topic { name: text(name).to_owned(), kind, encoding: Encoding::Cdr }));
            }
            Some(_) => others.push(format!("{} ({} in {}, expected cdr)", text(name), text(kind), text(encoding))),
            None => others.push(format!("{} ({})", text(name), text(kind))),
        }
        Ok(())
    })?;
    if wanted.is_empty() {
        let found = if others.is_empty() { "no topic at all".to_owned() } else { others.join(", ") };
        return Err(format!("no topic of a kind that is read ({KINDS}); found {found}"));
    }
    others.iter().for_each(|about| topics.leave_out(about));
    let (of, stamp, data) = (stored.column("topic_id")?, stored.column("timestamp")?, stored.column("data")?);
    let mut count = 0_u64;
    database.rows(&stored, &mut |_, values| {
        count += 1;
        let topic = values.get(of).and_then(super::sqlite::Value::integer);
        let Some((_, topic)) = wanted.iter().find(|(id, _)| Some(*id) == topic) else { return Ok(()) };
        let (Some(received), Some(super::sqlite::Value::Blob(bytes))) =
            (values.get(stamp).and_then(super::sqlite::Value::integer), values.get(data))
        else {
            return Err(format!("damaged: message {count} has no stamp or no content"));
        };
        take_message(topics, topic, received, bytes)
    })?;
    if count == 0 { Err("the bag has no message".to_owned()) } else { Ok(()) }
}
