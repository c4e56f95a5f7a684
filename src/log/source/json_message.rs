//! Messages of ROS as JSON: the fields of the same names.

use serde::Deserialize;

use super::message::{Kind, Message, Point};

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
    data: JsonData,
    #[serde(default, alias = "desired")]
    reference: JsonPoint,
    #[serde(default, alias = "actual")]
    feedback: JsonPoint,
    #[serde(default)]
    interface_values: Vec<JsonInterfaces>,
}

/// Of an array, or one number.
#[derive(Deserialize)]
#[serde(untagged)]
enum JsonData {
    Many(Vec<Option<f64>>),
    One(f64),
}

impl Default for JsonData {
    fn default() -> Self {
        Self::Many(Vec::new())
    }
}

#[derive(Deserialize)]
struct JsonInterfaces {
    #[serde(default)]
    interface_names: Vec<String>,
    #[serde(default)]
    values: Vec<Option<f64>>,
}

impl JsonInterfaces {
    fn value(&self, word: &str) -> f64 {
        let at = self.interface_names.iter().position(|name| name == word);
        at.and_then(|at| *self.values.get(at)?).unwrap_or(f64::NAN)
    }
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

#[derive(Default, Deserialize)]
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
    let point = |point: JsonPoint| Point {
        after_ns: point.time_from_start.ns(),
        position: numbers(point.positions),
        velocity: numbers(point.velocities),
        effort: numbers(point.effort),
    };
    let asked = (kind == Kind::ControllerState).then(|| Point { after_ns: 0, ..point(json.reference) });
    let points = match kind {
        Kind::JointState => vec![Point {
            after_ns: 0,
            position: numbers(json.position),
            velocity: numbers(json.velocity),
            effort: numbers(json.effort),
        }],
        Kind::JointTrajectory => json.points.into_iter().map(point).collect(),
        Kind::ControllerState => vec![Point { after_ns: 0, ..point(json.feedback) }],
        Kind::DynamicState => {
            let of = |word: &str| json.interface_values.iter().map(|joint| joint.value(word)).collect();
            vec![Point { after_ns: 0, position: of("position"), velocity: of("velocity"), effort: of("effort") }]
        }
        Kind::MultiArray | Kind::Number => {
            let position = match json.data {
                JsonData::Many(values) => numbers(values),
                JsonData::One(value) => vec![value],
            };
            vec![Point { position, ..Point::default() }]
        }
    };
    let stamp = json.header.stamp.ns();
    let message = Message { stamp_ns: (stamp != 0).then_some(stamp), names: Vec::new(), points, asked };
    Ok((json.name.into_iter().map(std::borrow::Cow::into_owned).collect(), message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_has_the_same_fields() {
        let text = br#"{"header":{"stamp":{"sec":1,"nsec":5}},"name":["a"],"position":[0.5],"effort":[null]}"#;
        let (names, message) = decode_json(Kind::JointState, text).unwrap();
        assert_eq!((names, message.stamp_ns), (vec!["a".to_owned()], Some(1_000_000_005)));
        assert!(message.points[0].position == [0.5] && message.points[0].effort[0].is_nan());
        assert!(decode_json(Kind::JointState, b"{\"name\": 3}").is_err());
    }

    #[test]
    fn a_controllers_state_is_a_reading_and_a_setpoint() {
        let text = br#"{"header":{"stamp":{"sec":1,"nanosec":5}},"joint_names":["a"],"reference":{"positions":[0.5]},"feedback":{"positions":[0.25]}}"#;
        let (_, message) = decode_json(Kind::ControllerState, text).unwrap();
        assert_eq!((message.points[0].position[0], message.asked.unwrap().position[0]), (0.25, 0.5));
    }
}
