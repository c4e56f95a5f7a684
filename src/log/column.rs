//! The columns of a log, as we call them.

/// A column of the log format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::log) enum Column {
    Time,
    Angle,
    Speed,
    Torque,
    Setpoint,
    Drive,
}

impl Column {
    pub(in crate::log) const ALL: [Self; 6] =
        [Self::Time, Self::Angle, Self::Speed, Self::Torque, Self::Setpoint, Self::Drive];

    pub(in crate::log) fn name(self) -> &'static str {
        match self {
            Self::Time => "t",
            Self::Angle => "q",
            Self::Speed => "dq",
            Self::Torque => "tau",
            Self::Setpoint => "q_ref",
            Self::Drive => "drive",
        }
    }

    pub(in crate::log) fn unit(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Angle | Self::Setpoint => "rad",
            Self::Speed => "rad/s",
            Self::Torque => "N m",
            Self::Drive => "0 or 1",
        }
    }

    /// Beyond this a cell is refused at once; wide, so that whole columns in a wrong unit get the better message.
    pub(in crate::log) fn limit(self) -> f64 {
        match self {
            Self::Time => 1e20, // an epoch in nanoseconds is 1.8e18
            Self::Torque => 1e5,
            _ => 1e9, // 32-bit encoder counts are recognised later
        }
    }
}

/// Which of our columns a name is: `elbow.q_ref` is the setpoint of `elbow`.
pub(in crate::log) fn column_of(ours: &str) -> Option<(Option<&str>, Column)> {
    let (joint, name) = ours.rsplit_once('.').map_or((None, ours), |(joint, name)| (Some(joint), name));
    let column = Column::ALL.into_iter().find(|column| column.name() == name)?;
    let is_named = joint.is_none_or(|joint| !joint.is_empty() && column != Column::Time);
    is_named.then_some((joint, column))
}
