//! Messages of joints: the kinds that are read, and what one says, however it was written.

/// A kind of message that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// `sensor_msgs/msg/JointState`
    JointState,
    /// `control_msgs/msg/DynamicJointState`
    DynamicState,
    /// `control_msgs/msg/JointTrajectoryControllerState`: what was asked and what was read, in one message.
    ControllerState,
    /// `trajectory_msgs/msg/JointTrajectory`
    JointTrajectory,
    /// `std_msgs/msg/Float64MultiArray`
    MultiArray,
    /// `std_msgs/msg/Float64`, of a topic that says that it is a command.
    Number,
}

/// The kinds as a user knows them.
pub(super) const KINDS: &str =
    "JointState, DynamicJointState, JointTrajectoryControllerState, JointTrajectory, Float64MultiArray";

impl Kind {
    /// By the topic and the name of its type or schema, with or without `/msg/`.
    pub fn of(topic: &str, kind: &str) -> Option<Self> {
        match kind.rsplit(['/', '.']).next()? {
            "JointState" => Some(Self::JointState),
            "DynamicJointState" => Some(Self::DynamicState),
            "JointTrajectoryControllerState" => Some(Self::ControllerState),
            "JointTrajectory" => Some(Self::JointTrajectory),
            "Float64MultiArray" => Some(Self::MultiArray),
            "Float64" if is_command(topic) => Some(Self::Number),
            _ => None,
        }
    }

    /// Whether its numbers come without the joints' names.
    pub fn is_unnamed(self) -> bool {
        matches!(self, Self::MultiArray | Self::Number)
    }
}

/// Whether a topic's name says that it is what is asked.
pub(super) fn is_command(topic: &str) -> bool {
    let words = ["command", "cmd", "desired", "target", "goal", "reference", "setpoint", "_ref"];
    words.iter().any(|word| topic.to_lowercase().contains(word))
}

/// How messages are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// ROS 2.
    Cdr,
    /// ROS 1.
    Ros1,
    Json,
}

/// A message, borrowed where it can be.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Message<'a> {
    /// Of the header \[ns\]; `None`: the kind has none, or it is zero.
    pub stamp_ns: Option<i64>,
    pub names: Vec<&'a str>,
    /// One of a state, several of a trajectory.
    pub points: Vec<Point>,
    /// What a controller's state says that was asked.
    pub asked: Option<Point>,
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

impl Point {
    /// The same with the joints in another order, which says where each of them stands; fields that lack some are none.
    pub fn in_order(&self, order: &[usize]) -> Self {
        let of = |values: &[f64]| order.iter().map(|k| values.get(*k).copied()).collect::<Option<Vec<f64>>>();
        let [position, velocity, effort] =
            [&self.position, &self.velocity, &self.effort].map(|values| of(values).unwrap_or_default());
        Self { after_ns: self.after_ns, position, velocity, effort }
    }
}
