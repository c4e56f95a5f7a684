//! A robot, what is asked of it, and the floor under it, as one run needs them.

use super::ground;
use crate::geometry::robot_file::FRAME_S;
use crate::robot::simulate::{Joints, Scenario, Setpoints, Surroundings};
use crate::robot::{Floor, JointId, Model, State};

/// Everything that a scenario borrows.
pub(super) struct Setting {
    pub model: Model,
    pub joints: Joints,
    /// Within the software's limits.
    pub setpoints: Setpoints,
    /// Joints for which that changed something.
    pub clipped: Vec<JointId>,
    pub start: State,
    /// None in the air.
    pub floor: Option<Floor>,
}

impl Setting {
    /// At rest at the first setpoints, lifted over the floor.
    pub fn new(model: Model, joints: Joints, setpoints: &Setpoints, floor: Option<Floor>) -> Self {
        let (setpoints, clipped) = setpoints.clipped(&model);
        let mut start = State::at_rest(&model);
        for id in model.joint_ids() {
            if joints.drive(id).chain.motor.is_some() {
                start.angle_rad[id.index()] = setpoints.at(id, setpoints.t_s[0]).unwrap_or(0.0);
            }
        }
        if let Some(floor) = &floor {
            ground::lift(floor, &model, &mut start);
        }
        Self { model, joints, setpoints, clipped, start, floor }
    }

    pub fn scenario(&self) -> Scenario<'_> {
        Scenario {
            model: &self.model,
            joints: &self.joints,
            setpoints: &self.setpoints,
            start: &self.start,
            surroundings: self.floor.as_ref().map(|floor| floor as &dyn Surroundings),
            period_s: self.model.encoder().map_or(FRAME_S, |encoder| encoder.period_s),
        }
    }
}
