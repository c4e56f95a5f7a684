//! A study of a robot with a clamped base, made ready: one bench case for each joint.

use super::along::Along;
use crate::identify::{Case, CaseError};
use crate::log::{
    ArrayLog, ClampedStudy, DriveMode, JointBeliefs, JointSpec, LogError, MotorSpec, Nominal, RobotLog, Spread,
    Uncertain, read_clamped_study, read_clamped_study_logs,
};
use crate::robot::description::{Actuator, ActuatorKind, Description, DescriptionError, Mover};
use crate::robot::tree::{Tree, TreeBase, TreeError};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A robot and its logs.
#[derive(Debug)]
pub struct ClampedCase {
    /// The robot's name.
    pub robot: String,
    /// In the description's order; those that logs show.
    pub joints: Vec<ClampedJoint>,
    /// Joints that may share a cause, by the group's name.
    pub groups: BTreeMap<String, Vec<String>>,
    /// What looks like a mistake in the description.
    pub warnings: Vec<String>,
    /// What the reader has to know of how the case was made.
    pub notes: Vec<String>,
    /// Files that were read.
    pub inputs: Vec<PathBuf>,
}

/// One joint of a robot as a case of the bench.
#[derive(Debug)]
pub struct ClampedJoint {
    /// Its name.
    pub name: String,
    /// Its logs, each with what it carries along it.
    pub case: Case,
}

/// Why a study makes no case.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ClampedCaseError {
    /// Study or log cannot be read or is wrong.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The description cannot be read or is wrong.
    #[error(transparent)]
    Description(Box<DescriptionError>),
    /// The description makes no tree.
    #[error("{}: {source}", file.display())]
    Tree {
        /// The description.
        file: PathBuf,
        /// What is wrong with it.
        source: TreeError,
    },
    /// Study or log names a joint or link that the description does not have.
    #[error("{}: {place}: the robot has no {what} `{name}`; it has {known}", file.display())]
    Unknown {
        /// Study or log.
        file: PathBuf,
        /// Table, key or column.
        place: String,
        /// `joint` or `link`.
        what: &'static str,
        /// As written.
        name: String,
        /// Names that there are.
        known: String,
    },
    /// A joint's arrays do not make a case.
    #[error("joint {joint}: {source}")]
    Joint {
        /// Which one.
        joint: String,
        /// Why.
        source: Box<CaseError>,
    },
    /// Nobody says how setpoints become torques.
    #[error("{}: joint {joint} is driven by position, and neither [joints.{joint}] nor [joints.default] states kp, nor has the description a position actuator", file.display())]
    NoGain {
        /// The study.
        file: PathBuf,
        /// Which joint.
        joint: String,
    },
    /// A number of the joint's load is not finite, or its inertia not above zero.
    #[error("joint {joint}: the description gives it no inertia above zero along the logs")]
    NoInertia {
        /// Which joint.
        joint: String,
    },
}

impl ClampedCase {
    /// A study with its robot and logs.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where a file cannot be read or is wrong, or names do not fit.
    pub fn of_study(path: &Path) -> Result<Self, ClampedCaseError> {
        let study = read_clamped_study(path)?;
        let description =
            Description::read(&study.model_path).map_err(|error| ClampedCaseError::Description(Box::new(error)))?;
        let of_tree = |source| ClampedCaseError::Tree { file: study.model_path.clone(), source };
        let mut tree = Tree::new(&description, TreeBase::Fixed).map_err(of_tree)?;
        if let Some([x, y, z]) = study.gravity_m_s2 {
            tree = tree.with_gravity(Vector3::new(x, y, z));
        }
        check_names(&study, &description)?;
        let logs = read_clamped_study_logs(&study)?;
        for log in &logs {
            for joint in &log.joints {
                let column = || format!("column `{}.q`", joint.name);
                known_joint(&log.file, &column, &joint.name, &description)?;
            }
        }
        let along = Along::new(&description, &tree);
        let links = along.links(&logs);
        let servos = tree.servos(&description);
        let mut joints = Vec::new();
        let mut unseen = Vec::new();
        for (at, link) in tree.joints().iter().zip(links) {
            let mover = &description.joints[at.0];
            if logs.iter().all(|log| log.joint(&mover.name).is_none()) {
                unseen.push(mover.name.clone());
                continue;
            }
            let (bare, carriages) = link.ok_or_else(|| ClampedCaseError::NoInertia { joint: mover.name.clone() })?;
            let said = study.of_joint(&mover.name).over(of_description(mover, &description, &servos));
            let maker = Maker { study: &study, mover, said, gravity_m_s2: along.gravity_m_s2() };
            let mut case = maker.case(bare, &logs)?;
            let with_it = logs.iter().zip(carriages).filter(|(log, _)| log.joint(&mover.name).is_some());
            for (item, (_, carriage)) in case.items.iter_mut().zip(with_it) {
                for e in &mut item.experiments {
                    e.carriage = Some(carriage.clone());
                }
            }
            joints.push(ClampedJoint { name: mover.name.clone(), case });
        }
        let mut notes = Vec::new();
        if !unseen.is_empty() {
            notes.push(format!("No log has {}: taken to stand as drawn.", unseen.join(", ")));
        }
        for log in logs.iter().filter(|log| !log.notes.is_empty()) {
            notes.push(format!("{}: {}.", log.file.display(), log.notes.join("; ")));
        }
        notes.extend(description.left_out.iter().cloned());
        let mut inputs: Vec<PathBuf> = study.logs.iter().map(|log| log.path.clone()).collect();
        inputs.push(study.file.clone());
        inputs.extend(description.files.iter().cloned());
        Ok(Self {
            robot: description.name.clone(),
            joints,
            groups: study.groups,
            warnings: description.warnings,
            notes,
            inputs,
        })
    }
}

/// What a joint's case is made from.
struct Maker<'a> {
    study: &'a ClampedStudy,
    mover: &'a Mover,
    said: JointBeliefs,
    gravity_m_s2: f64,
}

impl Maker<'_> {
    fn case(&self, bare: Nominal, logs: &[RobotLog]) -> Result<Case, ClampedCaseError> {
        let name = &self.mover.name;
        let coulomb_nm = self.said.coulomb_nm.unwrap_or(self.mover.friction_nm);
        let viscous_nm_s_rad = self.said.viscous_nm_s_rad.unwrap_or(self.mover.damping[0]);
        let joint = JointSpec {
            name: name.clone(),
            nominal: Some(Nominal { coulomb_nm, viscous_nm_s_rad, ..bare }),
            gravity_m_s2: self.gravity_m_s2,
            rest_rad: None,
        };
        let arrays = self.study.logs.iter().zip(logs).filter_map(|(entry, log)| {
            let own = log.joint(name)?;
            Some(ArrayLog {
                q_ref_rad: own.q_ref_rad.clone(),
                setpoints: own.setpoints.clone(),
                holes_are_known: true,
                tau_nm: if entry.drive == DriveMode::Torque { own.tau_nm.clone() } else { None },
                on: own.drive.clone(),
                role: entry.role,
                drive: entry.drive,
                session: entry.session.clone(),
                ..ArrayLog::new(entry.file.clone(), log.t_s.clone(), own.q_rad.clone())
            })
        });
        let arrays: Vec<ArrayLog> = arrays.collect();
        let is_driven_by_position = arrays.iter().any(|log| log.drive == DriveMode::Position);
        let motor = match self.said.kp_nm_rad {
            Some(kp_nm_rad) => self.motor(kp_nm_rad),
            None if is_driven_by_position => {
                return Err(ClampedCaseError::NoGain { file: self.study.file.clone(), joint: name.clone() });
            }
            // Only its gears matter.
            None => self.motor(0.0),
        };
        Case::of_arrays(joint, self.study.sensor, Some(motor), self.uncertain(), arrays)
            .map_err(|source| ClampedCaseError::Joint { joint: name.clone(), source: Box::new(source) })
    }

    fn motor(&self, kp_nm_rad: f64) -> MotorSpec {
        let said = &self.said;
        MotorSpec {
            kp_nm_rad,
            ki_nm_rad_s: said.ki_nm_rad_s.unwrap_or(0.0),
            kd_nm_s_rad: said.kd_nm_s_rad.unwrap_or(0.0),
            hold: self.study.hold,
            derivative: self.study.derivative,
            sample_period_s: self.study.sample_period_s,
            torque_limit_nm: said.torque_limit_nm,
            // A line of torque against speed needs the stall torque.
            speed_limit_rad_s: said.speed_limit_rad_s.filter(|_| said.torque_limit_nm.is_some()),
            model: said.model.unwrap_or_default(),
            encoder: said.encoder.unwrap_or_default(),
            armature_kg_m2: said.armature_kg_m2.unwrap_or(self.mover.armature_kg_m2),
        }
    }

    /// What is uncertain of this joint: inertia and moment by the masses of what it carries.
    fn uncertain(&self) -> Uncertain {
        let name = &self.mover.name;
        let all = &self.study.uncertain;
        let own = |spread: &Spread| Spread::of_all(spread.of(name));
        Uncertain {
            inertia: own(&all.mass),
            moment: own(&all.mass),
            friction: own(&all.friction),
            gain: own(&all.gain),
            torque: own(&all.torque),
            ..all.clone()
        }
    }
}

/// What the description says of a joint's motor: that of its position actuator.
fn of_description(mover: &Mover, description: &Description, servos: &[Actuator]) -> JointBeliefs {
    let is_its = |servo: &&Actuator| {
        servo.kind == ActuatorKind::Position && description.joints[servo.joint.0].name == mover.name
    };
    let servo = servos.iter().find(is_its);
    // A setpoint is one of the joint's: the actuator's length is `gear` times the joint's angle.
    let square = servo.map_or(1.0, |servo| servo.gear * servo.gear);
    let limit_of = |range: Option<[f64; 2]>| range.map(|[low, high]| high.min(-low)).filter(|most| *most > 0.0);
    let of_servo = servo.and_then(|servo| Some(limit_of(servo.force_range_nm)? * servo.gear.abs()));
    JointBeliefs {
        kp_nm_rad: servo.map(|servo| square * servo.gain).filter(|kp| *kp >= 0.0),
        kd_nm_s_rad: servo.map(|servo| -square * servo.bias[2]).filter(|kd| *kd >= 0.0),
        torque_limit_nm: of_servo.or(limit_of(mover.actuator_range_nm)).or(mover.effort_nm.filter(|most| *most > 0.0)),
        ..JointBeliefs::default()
    }
}

fn check_names(study: &ClampedStudy, description: &Description) -> Result<(), ClampedCaseError> {
    for name in study.by_joint.keys() {
        known_joint(&study.file, &|| format!("[joints.{name}]"), name, description)?;
    }
    for (group, joints) in &study.groups {
        for name in joints {
            known_joint(&study.file, &|| format!("[groups] {group}"), name, description)?;
        }
    }
    if let Some(tip) = study.tip.as_ref().filter(|tip| description.link(tip).is_none()) {
        let named = description.links.iter().filter(|link| link.is_named);
        return Err(ClampedCaseError::Unknown {
            file: study.file.clone(),
            place: "[robot] tip".to_owned(),
            what: "link",
            name: tip.clone(),
            known: named.map(|link| link.name.as_str()).collect::<Vec<_>>().join(", "),
        });
    }
    Ok(())
}

fn known_joint(
    file: &Path,
    place: &dyn Fn() -> String,
    name: &str,
    description: &Description,
) -> Result<(), ClampedCaseError> {
    if description.joint(name).is_some() {
        return Ok(());
    }
    Err(ClampedCaseError::Unknown {
        file: file.to_path_buf(),
        place: place(),
        what: "joint",
        name: name.to_owned(),
        known: description.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>().join(", "),
    })
}
