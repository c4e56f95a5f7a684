//! A robot study with its logs, ready to be compared with a simulation.

use crate::gap::hypothesis::reach::travels;
use crate::log::{Forward, RobotLog, RobotScenario, RobotStudy, Role, read_robot_study, read_robot_study_logs};
use crate::robot::Model;
use crate::robot::simulate::SimulateError;
use crate::robot::study::{Nominal, Scene};
use std::path::{Path, PathBuf};

/// A robot study, read.
pub struct RobotCase {
    /// What the engineer believes.
    pub study: RobotStudy,
    /// The same as a robot.
    pub nominal: Nominal,
    /// The logs with what was asked of the joints.
    pub(super) logs: Vec<CaseLog>,
    /// Names of all joints of the robot, in its order.
    pub names: Vec<String>,
}

/// A log as it is compared.
#[derive(Clone)]
pub(super) struct CaseLog {
    pub log: RobotLog,
    pub file: String,
    pub is_validate: bool,
    pub scene: Scene,
    /// By joint of the robot: its place in the log.
    pub columns: Vec<Option<usize>>,
    pub forward: Option<Forward>,
    /// Place of the joint that is let go, and when \[s\].
    pub release: Option<(usize, f64)>,
}

impl RobotCase {
    /// Reads a study and its logs.
    ///
    /// # Errors
    /// [`SimulateError`] with file, line and key where something is wrong in them.
    pub fn of_study(path: &Path) -> Result<Self, SimulateError> {
        let study = read_robot_study(path)?;
        let logs = read_robot_study_logs(&study)?;
        Self::new(study, logs)
    }

    /// Of a study and its logs in the study's order.
    ///
    /// # Errors
    /// As [`RobotCase::of_study`].
    pub fn new(study: RobotStudy, logs: Vec<RobotLog>) -> Result<Self, SimulateError> {
        let nominal = Nominal::of(&study)?;
        let model = &nominal.model;
        let names: Vec<String> = model.joints().iter().map(|joint| joint.name.clone()).collect();
        let compared = |(entry, log): (&crate::log::RobotStudyLog, RobotLog)| {
            let scene = nominal.scene(entry, &log)?;
            let columns = names.iter().map(|name| log.joints.iter().position(|joint| joint.name == *name)).collect();
            let release = entry.release.as_ref().map(|release| (&release.joint, release.time_s));
            let release = release.and_then(|(joint, at_s)| Some((names.iter().position(|name| name == joint)?, at_s)));
            Ok::<_, SimulateError>(CaseLog {
                file: entry.file.clone(),
                is_validate: entry.role == Role::Validate,
                forward: entry.forward,
                log,
                scene,
                columns,
                release,
            })
        };
        let logs = study.logs.iter().zip(logs).map(compared).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { study, nominal, logs, names })
    }

    /// Name of the robot.
    pub fn robot(&self) -> &str {
        self.nominal.model.name()
    }

    /// Whether a joint of the clamped robot is let go.
    pub fn is_let_go(&self) -> bool {
        self.study.scenario == RobotScenario::Drop
    }

    /// Whether the trunk is clamped.
    pub fn is_clamped(&self) -> bool {
        self.study.scenario != RobotScenario::Floor
    }

    /// All files that were read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let robot = self.study.model_path.iter().cloned();
        std::iter::once(self.study.file.clone())
            .chain(robot)
            .chain(self.study.logs.iter().map(|log| log.path.clone()))
            .collect()
    }

    pub(super) fn model(&self) -> &Model {
        &self.nominal.model
    }
}

impl CaseLog {
    /// When it begins to move, or is let go \[s\].
    pub fn motion_begins_s(&self) -> f64 {
        if let Some((_, at_s)) = self.release {
            return at_s;
        }
        let setpoints = &self.scene.setpoints;
        let moved =
            |k: &usize| setpoints.columns.iter().flatten().any(|c| (c.angle_rad[*k] - c.angle_rad[0]).abs() > 1e-4);
        setpoints.t_s[(0..setpoints.t_s.len()).find(moved).unwrap_or(0)]
    }

    pub fn end_s(&self) -> f64 {
        self.log.t_s[self.log.len() - 1]
    }

    /// What is asked from a time on, in the place of all of it, and how many samples come before that.
    pub fn from(&self, from_s: f64) -> (Self, usize) {
        let mut late = self.clone();
        let lacks = late.log.t_s.partition_point(|t| *t < from_s);
        late.log.t_s.drain(..lacks);
        let setpoints = &mut late.scene.setpoints;
        let before = setpoints.t_s.partition_point(|t| *t < from_s);
        setpoints.t_s.drain(..before);
        for column in setpoints.columns.iter_mut().flatten() {
            column.angle_rad.drain(..before);
            if let Some(on) = &mut column.on {
                on.drain(..before);
            }
        }
        (late, lacks)
    }

    /// The same log with setpoints that go farther from where they begin.
    pub fn widened(&self, factor: f64) -> Self {
        let mut scene = self.scene.clone();
        for column in scene.setpoints.columns.iter_mut().flatten() {
            let first_rad = column.angle_rad[0];
            column.angle_rad.iter_mut().for_each(|q| *q = first_rad + factor * (*q - first_rad));
        }
        scene.setpoints = scene.setpoints.clipped(&scene.model).0;
        Self { scene, ..self.clone() }
    }

    /// Readings of a joint of the robot \[rad\].
    pub fn measured_rad(&self, joint: usize) -> Option<&[f64]> {
        self.columns[joint].map(|column| self.log.joints[column].q_rad.as_slice())
    }

    /// Whether a joint is asked to move, or is let go.
    pub fn moves(&self, joint: usize) -> bool {
        let Some(column) = &self.scene.setpoints.columns[joint] else { return false };
        travels(&column.angle_rad) || self.release.is_some_and(|(released, _)| released == joint)
    }
}
