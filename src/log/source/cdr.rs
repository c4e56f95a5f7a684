//! Messages of ROS 2 in CDR, and of MCAP in JSON: the three kinds that joints have.

use serde::Deserialize;

/// A kind of message that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// `sensor_msgs/msg/JointState`
    JointState,
    /// `trajectory_msgs/msg/JointTrajectory`
    JointTrajectory,
    /// `std_msgs/msg/Float64MultiArray`
    MultiArray,
}

impl Kind {
    /// By the name of a type or schema, with or without `/msg/`.
    pub fn of_type(name: &str) -> Option<Self> {
        match name.rsplit(['/', '.']).next()? {
            "JointState" => Some(Self::JointState),
            "JointTrajectory" => Some(Self::JointTrajectory),
            "Float64MultiArray" => Some(Self::MultiArray),
            _ => None,
        }
    }
}

/// A message, borrowed where it can be.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Message<'a> {
    /// Of the header \[ns\]; `None`: the kind has none, or it is zero.
    pub stamp_ns: Option<i64>,
    pub names: Vec<&'a str>,
    /// One of a state, several of a trajectory.
    pub points: Vec<Point>,
}

/// Joints at an instant.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Point {
    /// After the message's stamp \[ns\].
    pub after_ns: i64,
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    pub effort: Vec<f64>,
}

/// Decodes a message.
///
/// # Errors
/// What is wrong with it, in words.
pub(super) fn decode(kind: Kind, bytes: &[u8]) -> Result<Message<'_>, String> {
    let mut cdr = Cdr::new(bytes)?;
    match kind {
        Kind::JointState => {
            let stamp_ns = cdr.header()?;
            let names = cdr.strings()?;
            let (position, velocity, effort) = (cdr.doubles()?, cdr.doubles()?, cdr.doubles()?);
            Ok(Message { stamp_ns, names, points: vec![Point { after_ns: 0, position, velocity, effort }] })
        }
        Kind::JointTrajectory => {
            let stamp_ns = cdr.header()?;
            let names = cdr.strings()?;
            let count = cdr.length(16)?;
            let mut points = Vec::with_capacity(count.min(1024));
            for _ in 0..count {
                let (position, velocity, _, effort) = (cdr.doubles()?, cdr.doubles()?, cdr.doubles()?, cdr.doubles()?);
                let after_ns = cdr.time()?;
                points.push(Point { after_ns, position, velocity, effort });
            }
            Ok(Message { stamp_ns, names, points })
        }
        Kind::MultiArray => {
            for _ in 0..cdr.length(12)? {
                cdr.string()?;
                cdr.u32()?;
                cdr.u32()?;
            }
            cdr.u32()?;
            let point = Point { position: cdr.doubles()?, ..Point::default() };
            Ok(Message { stamp_ns: None, names: Vec::new(), points: vec![point] })
        }
    }
}

struct Cdr<'a> {
    /// After the encapsulation header: alignment counts from here.
    bytes: &'a [u8],
    at: usize,
    is_little: bool,
    /// Largest alignment: 8, of XCDR2 4.
    align: usize,
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
        Ok(Self { bytes: body, at: 0, is_little, align })
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
        let is_little = self.is_little;
        let double = |bytes: &[u8]| {
            let bytes: [u8; 8] = bytes.try_into().unwrap_or_default();
            if is_little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) }
        };
        Ok(bytes.chunks_exact(8).map(double).collect())
    }
}

/// A message in JSON, with the fields of any of the kinds.
#[derive(Deserialize)]
struct Json<'a> {
    #[serde(default)]
    header: JsonHeader,
    #[serde(default, borrow, alias = "joint_names")]
    name: Vec<std::borrow::Cow<'a, str>>,
    #[serde(default)]
    position: Vec<Option<f64>>,
    #[serde(default)]
    velocity: Vec<Option<f64>>,
    #[serde(default)]
    effort: Vec<Option<f64>>,
    #[serde(default)]
    points: Vec<JsonPoint>,
    #[serde(default)]
    data: Vec<Option<f64>>,
}

#[derive(Default, Deserialize)]
struct JsonHeader {
    #[serde(default)]
    stamp: JsonTime,
}

#[derive(Default, Deserialize)]
struct JsonTime {
    #[serde(default, alias = "secs")]
    sec: i64,
    #[serde(default, alias = "nsec", alias = "nsecs")]
    nanosec: i64,
}

impl JsonTime {
    fn ns(&self) -> i64 {
        self.sec.saturating_mul(1_000_000_000).saturating_add(self.nanosec)
    }
}

#[derive(Deserialize)]
struct JsonPoint {
    #[serde(default)]
    positions: Vec<Option<f64>>,
    #[serde(default)]
    velocities: Vec<Option<f64>>,
    #[serde(default)]
    effort: Vec<Option<f64>>,
    #[serde(default)]
    time_from_start: JsonTime,
}

/// A message in JSON, and its names.
///
/// # Errors
/// What is wrong with it, in words.
pub(super) fn decode_json(kind: Kind, bytes: &[u8]) -> Result<(Vec<String>, Message<'static>), String> {
    let json: Json<'_> = serde_json::from_slice(bytes).map_err(|error| format!("its JSON: {error}"))?;
    let numbers = |values: Vec<Option<f64>>| values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
    let points = match kind {
        Kind::JointState => vec![Point {
            after_ns: 0,
            position: numbers(json.position),
            velocity: numbers(json.velocity),
            effort: numbers(json.effort),
        }],
        Kind::JointTrajectory => {
            let point = |point: JsonPoint| Point {
                after_ns: point.time_from_start.ns(),
                position: numbers(point.positions),
                velocity: numbers(point.velocities),
                effort: numbers(point.effort),
            };
            json.points.into_iter().map(point).collect()
        }
        Kind::MultiArray => vec![Point { position: numbers(json.data), ..Point::default() }],
    };
    let stamp = json.header.stamp.ns();
    let message = Message { stamp_ns: (stamp != 0).then_some(stamp), names: Vec::new(), points };
    Ok((json.name.into_iter().map(std::borrow::Cow::into_owned).collect(), message))
}

/// A JointState in little-endian CDR.
pub(in crate::log) fn joint_state(stamp_ns: i64, names: &[&str], fields: [&[f64]; 3]) -> Vec<u8> {
    let mut out = vec![0, 1, 0, 0];
    let pad = |out: &mut Vec<u8>, align: usize| {
        let body = out.len() - 4;
        out.resize(4 + body.next_multiple_of(align), 0);
    };
    let number = |out: &mut Vec<u8>, value: u32| {
        pad(out, 4);
        out.extend(value.to_le_bytes());
    };
    let string = |out: &mut Vec<u8>, text: &str| {
        number(out, text.len() as u32 + 1);
        out.extend(text.as_bytes());
        out.push(0);
    };
    number(&mut out, stamp_ns.div_euclid(1_000_000_000) as u32);
    number(&mut out, stamp_ns.rem_euclid(1_000_000_000) as u32);
    string(&mut out, "");
    number(&mut out, names.len() as u32);
    names.iter().for_each(|name| string(&mut out, name));
    for field in fields {
        number(&mut out, field.len() as u32);
        if !field.is_empty() {
            pad(&mut out, 8);
        }
        field.iter().for_each(|value| out.extend(value.to_le_bytes()));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_joint_state_is_read_as_it_was_written() {
        let bytes = joint_state(1_500_000_007, &["elbow", "a"], [&[1.5, -2.0], &[], &[0.25, 4.0]]);
        let message = decode(Kind::JointState, &bytes).unwrap();
        assert_eq!((message.stamp_ns, &message.names[..]), (Some(1_500_000_007), &["elbow", "a"][..]));
        let point = &message.points[0];
        assert_eq!(
            (&point.position[..], point.velocity.len(), &point.effort[..]),
            (&[1.5, -2.0][..], 0, &[0.25, 4.0][..])
        );
    }

    #[test]
    fn json_has_the_same_fields() {
        let text = br#"{"header":{"stamp":{"sec":1,"nsec":5}},"name":["a"],"position":[0.5],"effort":[null]}"#;
        let (names, message) = decode_json(Kind::JointState, text).unwrap();
        assert_eq!((names, message.stamp_ns), (vec!["a".to_owned()], Some(1_000_000_005)));
        assert!(message.points[0].position == [0.5] && message.points[0].effort[0].is_nan());
        assert!(decode_json(Kind::JointState, b"{\"name\": 3}").is_err());
    }

    proptest! {
        #[test]
        fn damaged_messages_are_errors_and_never_more(cut in 0usize..120, at in 0usize..120, to in any::<u8>()) {
            let mut bytes = joint_state(7, &["elbow", "wrist"], [&[1.0, 2.0], &[3.0, 4.0], &[]]);
            if let Some(byte) = bytes.get_mut(at) {
                *byte = to;
            }
            bytes.truncate(cut);
            for kind in [Kind::JointState, Kind::JointTrajectory, Kind::MultiArray] {
                let _ = decode(kind, &bytes);
                let _ = decode_json(kind, &bytes);
            }
        }
    }
}
