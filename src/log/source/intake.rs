//! Takes messages as a bag stores them: packed one by one or not, in any of the encodings.

use std::borrow::Cow;
use std::io::Read;

use super::bytes::ZSTD_MAGIC;
use super::cdr::decode;
use super::json_message::decode_json;
use super::message::{Encoding, Kind, Message};
use super::topics::Topics;

/// Largest message, unpacked \[bytes\].
pub(super) const LARGEST_MESSAGE: u64 = 32 << 20;

/// What is known of a topic before its messages come.
#[derive(Clone, Debug)]
pub(super) struct Topic {
    pub name: String,
    pub kind: Kind,
    pub encoding: Encoding,
}

/// Takes a message of a topic.
///
/// # Errors
/// What is wrong with it, in words that name the topic.
pub(super) fn take_message(topics: &mut Topics, topic: &Topic, received_ns: i64, stored: &[u8]) -> Result<(), String> {
    let number = topics.messages() + 1;
    let wrong = |what: String| format!("message {number} of {}: {what}", topic.name);
    let bytes = unpacked(stored).map_err(wrong)?;
    match topic.encoding {
        Encoding::Json => {
            let (names, message) = decode_json(topic.kind, &bytes).map_err(wrong)?;
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            take(topics, topic, &names, received_ns, message)
        }
        encoding => {
            let mut message = decode(topic.kind, encoding, &bytes).map_err(wrong)?;
            let names = std::mem::take(&mut message.names);
            take(topics, topic, &names, received_ns, message)
        }
    }
}

/// The state of a controller is a reading and a setpoint; others are what they are.
fn take(
    topics: &mut Topics,
    topic: &Topic,
    names: &[&str],
    received_ns: i64,
    mut message: Message<'_>,
) -> Result<(), String> {
    if topic.kind != Kind::ControllerState {
        return topics.take(&topic.name, topic.kind, names, received_ns, message);
    }
    let (stamp_ns, asked) = (message.stamp_ns, message.asked.take());
    if let Some(asked) = asked.filter(|asked| !asked.position.is_empty()) {
        let asked = Message { stamp_ns, points: vec![asked], ..Message::default() };
        topics.take(&format!("{}/reference", topic.name), Kind::JointState, names, received_ns, asked)?;
    }
    topics.take(&format!("{}/feedback", topic.name), Kind::JointState, names, received_ns, message)
}

/// A message that `ros2 bag record --compression-mode message` packed; no message of ROS begins like that.
fn unpacked(stored: &[u8]) -> Result<Cow<'_, [u8]>, String> {
    if !stored.starts_with(&ZSTD_MAGIC) {
        return Ok(Cow::Borrowed(stored));
    }
    let mut bytes = Vec::new();
    let frames = ruzstd::decoding::StreamingDecoder::new(stored).map_err(|error| format!("its zstd: {error}"))?;
    frames.take(LARGEST_MESSAGE + 1).read_to_end(&mut bytes).map_err(|error| format!("its zstd: {error}"))?;
    if bytes.len() as u64 > LARGEST_MESSAGE {
        return Err(format!("it unpacks to more than {LARGEST_MESSAGE} bytes"));
    }
    Ok(Cow::Owned(bytes))
}
