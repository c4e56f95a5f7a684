//! Messages as ROS writes them: CDR of ROS 2, either byte order, and the packed form of ROS 1.

use super::message::{Encoding, Kind, Message, Point};

/// Decodes a message.
///
/// # Errors
/// What is wrong with it, in words.
pub(super) fn decode(kind: Kind, encoding: Encoding, bytes: &[u8]) -> Result<Message<'_>, String> {
    let mut cdr = if encoding == Encoding::Ros1 { Cdr::of_ros1(bytes) } else { Cdr::new(bytes)? };
    match kind {
        Kind::JointState => {
            let stamp_ns = cdr.header()?;
            let names = cdr.strings()?;
            let (position, velocity, effort) = (cdr.doubles()?, cdr.doubles()?, cdr.doubles()?);
            let points = vec![Point { after_ns: 0, position, velocity, effort }];
            Ok(Message { stamp_ns, names, points, asked: None })
        }
        Kind::DynamicState => {
            let stamp_ns = cdr.header()?;
            let names = cdr.strings()?;
            let mut point = Point::default();
            for _ in 0..cdr.length(8)? {
                let (interfaces, values) = (cdr.strings()?, cdr.doubles()?);
                let value = |word: &str| {
                    let at = interfaces.iter().position(|name| *name == word);
                    at.and_then(|at| values.get(at)).copied().unwrap_or(f64::NAN)
                };
                point.position.push(value("position"));
                point.velocity.push(value("velocity"));
                point.effort.push(value("effort"));
            }
            Ok(Message { stamp_ns, names, points: vec![point], asked: None })
        }
        Kind::ControllerState => {
            let stamp_ns = cdr.header()?;
            let names = cdr.strings()?;
            // Errors and what later versions add follow.
            let (asked, read) = (cdr.point()?, cdr.point()?);
            let points = vec![Point { after_ns: 0, ..read }];
            Ok(Message { stamp_ns, names, points, asked: Some(Point { after_ns: 0, ..asked }) })
        }
        Kind::JointTrajectory => {
            let stamp_ns = cdr.header()?;
            let names = cdr.strings()?;
            let count = cdr.length(16)?;
            let mut points = Vec::with_capacity(count.min(1024));
            for _ in 0..count {
                points.push(cdr.point()?);
            }
            Ok(Message { stamp_ns, names, points, asked: None })
        }
        Kind::MultiArray => {
            for _ in 0..cdr.length(12)? {
                cdr.string()?;
                cdr.u32()?;
                cdr.u32()?;
            }
            cdr.u32()?;
            let point = Point { position: cdr.doubles()?, ..Point::default() };
            Ok(Message { points: vec![point], ..Message::default() })
        }
        Kind::Number => {
            let point = Point { position: vec![cdr.double()?], ..Point::default() };
            Ok(Message { points: vec![point], ..Message::default() })
        }
    }
}

struct Cdr<'a> {
    /// After the encapsulation header: alignment counts from here.
    bytes: &'a [u8],
    at: usize,
    is_little: bool,
    /// Largest alignment: 8, of XCDR2 4, of ROS 1 none.
    align: usize,
    /// A header has a number of its own.
    is_ros1: bool,
}

const CUT: &str = "it ends within a field";

impl<'a> Cdr<'a> {
    fn new(bytes: &'a [u8]) -> Result<Self, String> {
        let (head, body) = bytes.split_at_checked(4).ok_or("shorter than its header of 4 bytes")?;
        let (is_little, align) = match head[1] {
            0 => (false, 8),
            1 => (true, 8),
            6 => (false, 4),
            7 => (true, 4),
            other => return Err(format!("its encapsulation is 0x{:02x}{other:02x}, expected plain CDR", head[0])),
        };
        Ok(Self { bytes: body, at: 0, is_little, align, is_ros1: false })
    }

    fn of_ros1(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, is_little: true, align: 1, is_ros1: true }
    }

    fn take(&mut self, count: usize, align: usize) -> Result<&'a [u8], String> {
        let from = self.at.next_multiple_of(align.min(self.align));
        let taken = from.checked_add(count).and_then(|to| self.bytes.get(from..to)).ok_or(CUT)?;
        self.at = from + count;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32, String> {
        let bytes: [u8; 4] = self.take(4, 4)?.try_into().map_err(|_| CUT)?;
        Ok(if self.is_little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    /// The length of a sequence whose elements take at least so many bytes each.
    fn length(&mut self, least: usize) -> Result<usize, String> {
        let length = self.u32()? as usize;
        if length.saturating_mul(least) > self.bytes.len() - self.at {
            return Err(format!("a sequence of {length} is announced, more than the message holds"));
        }
        Ok(length)
    }

    fn time(&mut self) -> Result<i64, String> {
        let (seconds, nanos) = (self.u32()? as i32, self.u32()?);
        Ok(i64::from(seconds) * 1_000_000_000 + i64::from(nanos))
    }

    /// `std_msgs/Header`; a stamp of zero is none.
    fn header(&mut self) -> Result<Option<i64>, String> {
        if self.is_ros1 {
            self.u32()?;
        }
        let stamp = self.time()?;
        self.string()?;
        Ok((stamp != 0).then_some(stamp))
    }

    fn string(&mut self) -> Result<&'a str, String> {
        let length = self.length(1)?;
        let bytes = self.take(length, 1)?;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        std::str::from_utf8(bytes).map_err(|_| "a name in it is not UTF-8".to_owned())
    }

    fn strings(&mut self) -> Result<Vec<&'a str>, String> {
        let count = self.length(4)?;
        (0..count).map(|_| self.string()).collect()
    }

    fn doubles(&mut self) -> Result<Vec<f64>, String> {
        let count = self.length(8)?;
        if count == 0 {
            return Ok(Vec::new());
        }
        let bytes = self.take(count * 8, 8)?;
        Ok(bytes.chunks_exact(8).map(|bytes| self.double_of(bytes)).collect())
    }

    fn double(&mut self) -> Result<f64, String> {
        let bytes = self.take(8, 8)?;
        Ok(self.double_of(bytes))
    }

    fn double_of(&self, bytes: &[u8]) -> f64 {
        let bytes: [u8; 8] = bytes.try_into().unwrap_or_default();
        if self.is_little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) }
    }

    /// A point of a trajectory; accelerations are passed over.
    fn point(&mut self) -> Result<Point, String> {
        let (position, velocity, _, effort) = (self.doubles()?, self.doubles()?, self.doubles()?, self.doubles()?);
        Ok(Point { after_ns: self.time()?, position, velocity, effort })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::source::cdr_write::joint_state;
    use crate::log::source::json_message::decode_json;
    use proptest::prelude::*;

    #[test]
    fn a_joint_state_is_read_as_it_was_written() {
        let bytes = joint_state(1_500_000_007, &["elbow", "a"], [&[1.5, -2.0], &[], &[0.25, 4.0]]);
        let message = decode(Kind::JointState, Encoding::Cdr, &bytes).unwrap();
        assert_eq!((message.stamp_ns, &message.names[..]), (Some(1_500_000_007), &["elbow", "a"][..]));
        let point = &message.points[0];
        assert_eq!(
            (&point.position[..], point.velocity.len(), &point.effort[..]),
            (&[1.5, -2.0][..], 0, &[0.25, 4.0][..])
        );
    }

    #[test]
    fn a_controllers_state_has_both_what_was_asked_and_what_was_read() {
        // Of ROS 1: packed, with a number in the header.
        let mut bytes = Vec::new();
        for word in [9_u32, 2, 5, 0, 1, 1] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.push(b'a');
        for value in [0.5_f64, 0.25] {
            bytes.extend(1_u32.to_le_bytes());
            bytes.extend(value.to_le_bytes());
            bytes.extend([0; 12 + 8]);
        }
        let message = decode(Kind::ControllerState, Encoding::Ros1, &bytes).unwrap();
        assert_eq!((message.stamp_ns, &message.names[..]), (Some(2_000_000_005), &["a"][..]));
        assert_eq!((message.points[0].position[0], message.asked.unwrap().position[0]), (0.25, 0.5));
    }

    proptest! {
        #[test]
        fn damaged_messages_are_errors_and_never_more(cut in 0usize..120, at in 0usize..120, to in any::<u8>()) {
            let mut bytes = joint_state(7, &["elbow", "wrist"], [&[1.0, 2.0], &[3.0, 4.0], &[]]);
            if let Some(byte) = bytes.get_mut(at) {
                *byte = to;
            }
            bytes.truncate(cut);
            let kinds = [Kind::JointState, Kind::DynamicState, Kind::ControllerState, Kind::JointTrajectory, Kind::MultiArray];
            for kind in kinds {
                let _ = decode(kind, Encoding::Cdr, &bytes);
                let _ = decode(kind, Encoding::Ros1, &bytes);
                let _ = decode_json(kind, &bytes);
            }
        }
    }
}
