//! A study of a robot with a clamped base with everything that it names: description, tree, logs.

use super::alike::alike;
use crate::identify::CaseError;
use crate::log::{
    ClampedStudy, DriveMode, JointBeliefs, LogError, MotorSpec, RobotLog, Uncertain, read_clamped_study,
    read_clamped_study_logs,
};
use crate::robot::description::{
    Actuator, BodyChange, Description, DescriptionError, FoundNumber, LinkId, Mover, MoverId, NoSuchPart,
};
use crate::robot::tree::{Tree, TreeBase, TreeError};
use nalgebra::Vector3;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Numbers that every joint has, whatever its name.
const NUMBERS: [&str; 7] = ["coulomb", "viscous", "kp", "ki", "kd", "tau", "torque_limit"];

/// A study with its robot and logs, as they were read.
#[derive(Clone, Debug)]
pub struct ClampedSetup {
    /// What is believed, and what to predict.
    pub study: ClampedStudy,
    /// The robot.
    pub description: Description,
    /// Its tree under the study's gravity, the base fixed.
    pub tree: Tree,
    /// In the study's order.
    pub logs: Vec<RobotLog>,
}

impl ClampedSetup {
    /// Reads a study with its robot and logs.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where a file cannot be read or is wrong, or names do not fit.
    pub fn read(path: &Path) -> Result<Self, ClampedCaseError> {
        let study = read_clamped_study(path)?;
        let logs = read_clamped_study_logs(&study)?;
        Self::of_read(study, logs)
    }

    /// A study and its logs, in its order, that are read already.
    ///
    /// # Errors
    /// As [`ClampedSetup::read`].
    pub fn of_read(study: ClampedStudy, logs: Vec<RobotLog>) -> Result<Self, ClampedCaseError> {
        let logs = logs.into_iter().map(RobotLog::without_spikes).collect();
        let mut setup = Self { logs, ..Self::of_robot(study)? };
        setup.leave_out()?;
        for log in &setup.logs {
            for joint in &log.joints {
                let column = || format!("column `{}.q`", joint.name);
                known_joint(&log.file, &column, &joint.name, &setup.description)?;
            }
        }
        let is_logged = |name: &str| setup.logs.iter().any(|log| log.joint(name).is_some());
        setup.lacking(&is_logged).map_or(Ok(()), Err)?;
        Ok(setup)
    }

    /// The robot of a study with what it believes, before its logs are read.
    ///
    /// # Errors
    /// As [`ClampedSetup::read`].
    pub fn of_study(study: ClampedStudy) -> Result<Self, ClampedCaseError> {
        let setup = Self::of_robot(study)?;
        setup.lacking(&|_| true).map_or(Ok(()), Err)?;
        Ok(setup)
    }

    /// The same, whatever its joints lack.
    fn of_robot(study: ClampedStudy) -> Result<Self, ClampedCaseError> {
        if !study.model_path.exists() {
            return Err(ClampedCaseError::NoModel { file: study.file, model: study.model_path });
        }
        let description =
            Description::read(&study.model_path).map_err(|error| ClampedCaseError::Description(Box::new(error)))?;
        if let Some(what) = description.too_heavy_to_move() {
            return Err(ClampedCaseError::TooHeavy { file: study.model_path, what });
        }
        // The base is held by whoever took the logs, though a description of a robot that walks lets it go.
        let mut description = Description { free_joint: None, ..description.with_equalities() };
        let of_tree = |source| ClampedCaseError::Tree { file: study.model_path.clone(), source };
        let mut tree = Tree::new(&description, TreeBase::Fixed).map_err(of_tree)?;
        // Other masses than described do not damp a servo otherwise.
        description.actuators = tree.servos(&description);
        if let Some([x, y, z]) = study.gravity_m_s2 {
            tree = tree.with_gravity(Vector3::new(x, y, z));
        }
        check_names(&study, &description)?;
        Ok(Self { study, description, tree, logs: Vec::new() })
    }

    /// Why what all joints have is not enough for one of these that has no beliefs of its own.
    fn lacking(&self, is_meant: &dyn Fn(&str) -> bool) -> Option<ClampedCaseError> {
        let why = self.study.all_lacks.clone()?;
        let is_bare = |name: &&str| is_meant(name) && !self.study.by_joint.contains_key(*name);
        let joint = self.tree.joint_names().find(is_bare)?.to_owned();
        Some(ClampedCaseError::Incomplete { joint, why })
    }

    /// Leaves out the joints that the study does not want: of its logs, or of robots that its logs need not have all of.
    fn leave_out(&mut self) -> Result<(), ClampedCaseError> {
        let Self { study, description, logs, .. } = self;
        let is_there =
            |name: &str| logs.iter().any(|log| log.joint(name).is_some()) || description.joint(name).is_some();
        if let Some(name) = study.without.iter().find(|name| !is_there(name)) {
            let known = logs.iter().flat_map(|log| &log.joints).map(|joint| joint.name.as_str());
            let known: BTreeSet<&str> =
                known.chain(description.joints.iter().map(|joint| joint.name.as_str())).collect();
            return Err(ClampedCaseError::Unknown {
                file: study.file.clone(),
                place: "[robot] without".to_owned(),
                what: "joint",
                name: name.clone(),
                known: known.into_iter().collect::<Vec<_>>().join(", "),
            });
        }
        logs.iter_mut().for_each(|log| log.joints.retain(|joint| !study.without.contains(&joint.name)));
        Ok(())
    }

    /// Why a joint of a log cannot follow the setpoints that drive it, in the study's order.
    pub fn without_gain(&self) -> Option<ClampedCaseError> {
        let driven = self.study.logs.iter().zip(&self.logs).filter(|(entry, _)| entry.drive == DriveMode::Position);
        let names = driven.flat_map(|(_, log)| &log.joints).map(|joint| joint.name.as_str());
        // A joint that follows another has no motor of its own.
        let mut movers =
            names.filter_map(|name| self.description.joint(name)).filter(|at| self.tree.joints().contains(at));
        let lacks_gain = movers.find(|at| self.motor(*at).is_none())?;
        let joint = self.description.joints[lacks_gain.0].name.clone();
        Some(ClampedCaseError::NoGain { file: self.study.file.clone(), joint })
    }

    /// Joints that may share a cause: the study's groups, and joints that the tree makes alike.
    pub fn groups(&self) -> BTreeMap<String, Vec<String>> {
        let mut groups = alike(&self.description);
        groups.extend(self.study.groups.clone());
        groups
    }

    /// What study and description say of a joint, the study first.
    pub fn beliefs(&self, joint: MoverId) -> JointBeliefs {
        let mover = &self.description.joints[joint.0];
        self.study.of_joint(&mover.name).over(self.described(joint))
    }

    /// What the description alone says of a joint's motor.
    pub(in crate::gap) fn described(&self, joint: MoverId) -> JointBeliefs {
        of_description(&self.description.joints[joint.0], self.servo(joint).as_ref())
    }

    /// The position servo that the description gives a joint.
    pub(in crate::gap) fn servo(&self, joint: MoverId) -> Option<Actuator> {
        let its = self.description.actuators.iter().filter(|servo| servo.joint == joint);
        its.filter_map(Actuator::as_servo).next()
    }

    /// How a joint's setpoints become torques, where anybody says it: study and description.
    pub fn motor(&self, joint: MoverId) -> Option<MotorSpec> {
        let said = self.beliefs(joint);
        said.kp_nm_rad.map(|kp_nm_rad| self.motor_with(joint, &said, kp_nm_rad))
    }

    pub(super) fn motor_with(&self, joint: MoverId, said: &JointBeliefs, kp_nm_rad: f64) -> MotorSpec {
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
            armature_kg_m2: said.armature_kg_m2.unwrap_or(self.description.joints[joint.0].armature_kg_m2),
        }
    }

    /// The same with a body changed.
    ///
    /// # Errors
    /// [`ClampedCaseError::Tree`], which does not depend on the change.
    pub fn with_change(&self, link: LinkId, change: &BodyChange) -> Result<Self, ClampedCaseError> {
        self.with_description(self.description.with_change(link, change))
    }

    /// The same with masses as found.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where they are of another robot.
    pub(in crate::gap) fn with_masses(&self, masses: &[FoundNumber]) -> Result<Self, ClampedCaseError> {
        let other = |error: NoSuchPart| ClampedCaseError::NotSimulated {
            file: self.study.model_path.clone(),
            what: error.to_string(),
        };
        self.with_description(self.description.with_found(masses).map_err(other)?)
    }

    fn with_description(&self, description: Description) -> Result<Self, ClampedCaseError> {
        let of_tree = |source| ClampedCaseError::Tree { file: self.study.model_path.clone(), source };
        let tree = Tree::new(&description, TreeBase::Fixed).map_err(of_tree)?.with_gravity(self.tree.gravity_m_s2());
        Ok(Self { description, tree, ..self.clone() })
    }

    /// Files that were read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let logs = self.study.logs.iter().map(|log| log.path.clone()).chain([self.study.file.clone()]);
        logs.filter(|path| path.exists()).chain(self.description.files.iter().cloned()).collect()
    }
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
    /// There is no such description.
    #[error(
        "{}: `[robot] model`: there is no file {}; expected the path of a URDF, MJCF or TOML, relative to the study \
         (package:// is not resolved)",
        file.display(),
        model.display()
    )]
    NoModel {
        /// The study.
        file: PathBuf,
        /// The description that it names.
        model: PathBuf,
    },
    /// A link that moves is heavier than any of a machine.
    #[error("{}: {what}", file.display())]
    TooHeavy {
        /// The description.
        file: PathBuf,
        /// Which link, what it has, and what was expected.
        what: String,
    },
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
    /// The whole robot cannot be simulated.
    #[error("{}: {what}", file.display())]
    NotSimulated {
        /// The description.
        file: PathBuf,
        /// Why.
        what: String,
    },
    /// What all joints have makes no motor, and a joint says no more.
    #[error("joint {joint} has no table [joints.{joint}], and what [joints.default] says is not enough for it: {why}")]
    Incomplete {
        /// Which joint.
        joint: String,
        /// What is wrong with it.
        why: String,
    },
    /// Nobody says how setpoints become torques.
    #[error("{}: joint {joint} is driven by position, and neither [joints.{joint}] nor [joints.default] states kp [N m/rad], nor has the description a position actuator; it is a known torque by the angle that the joint gives under it", file.display())]
    NoGain {
        /// The study.
        file: PathBuf,
        /// Which joint.
        joint: String,
    },
    /// Torques are to be predicted, and no log has any of this robot.
    #[error("{}: predict = \"torque\" compares with `<joint>.tau`, and no log has such a column", file.display())]
    NoTorque {
        /// The study.
        file: PathBuf,
    },
    /// A number of the joint's load is not finite, or its inertia not above zero.
    #[error(
        "joint {joint}: no link from it on has mass and inertia; add them to the description (`<inertial>`, in an MJCF \
         geoms with mass too)"
    )]
    NoInertia {
        /// Which joint.
        joint: String,
    },
}

/// What the description says of a joint's motor: that of its position servo.
fn of_description(mover: &Mover, servo: Option<&Actuator>) -> JointBeliefs {
    let limit_of = |range: Option<[f64; 2]>| range.map(|[low, high]| high.min(-low)).filter(|most| *most > 0.0);
    let of_servo = servo.and_then(|servo| limit_of(servo.force_range_nm));
    JointBeliefs {
        kp_nm_rad: servo.map(|servo| servo.gain).filter(|kp| *kp >= 0.0),
        kd_nm_s_rad: servo.map(|servo| -servo.bias[2]).filter(|kd| *kd >= 0.0),
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
    let Uncertain { inertia, moment, mass, friction, gain, torque, .. } = &study.uncertain;
    let spreads = [
        ("inertia", inertia),
        ("moment", moment),
        ("mass", mass),
        ("friction", friction),
        ("gain", gain),
        ("torque", torque),
    ];
    let named = spreads.iter().flat_map(|(key, spread)| spread.by_name.keys().map(move |name| (key, name)));
    for (key, name) in named.filter(|(_, name)| !NUMBERS.contains(&name.as_str())) {
        if description.link(name).is_none() {
            known_joint(&study.file, &|| format!("[uncertain] {key}"), name, description)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    const ARM: &str = r#"<mujoco><compiler angle="radian"/><worldbody><body name="a"><joint name="j" axis="0 1 0"/>
        <geom size=".1" pos="0 0 -.3" mass="1"/><body name="b" pos="0 0 -.4"><joint name="k" axis="0 1 0"/>
        <geom size=".1" mass=".5"/></body></body></worldbody><actuator><position joint="j" kp="16" dampratio="1"/>
        <general joint="k" biastype="affine" gainprm="7" biasprm="0 -7 -.4" forcerange="-3 3"/></actuator></mujoco>"#;
    const STUDY: &str = "schema = 1\n[robot]\nmodel = \"arm.xml\"\nscenario = \"fixed\"\n[[log]]\nfile = \"log.csv\"\n\
                         role = \"fit\"\ndrive = \"position\"\n";

    #[test]
    fn a_servo_is_that_of_the_masses_as_described_and_a_general_one_is_a_servo() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("study.toml");
        std::fs::write(dir.path().join("arm.xml"), ARM).unwrap();
        std::fs::write(&file, STUDY).unwrap();
        std::fs::write(dir.path().join("log.csv"), "t,j,k\n0,0,0\n").unwrap();
        let setup = ClampedSetup::of_study(read_clamped_study(&file).unwrap()).unwrap();
        let joint = |name: &str| setup.description.joint(name).unwrap();
        let said = setup.beliefs(joint("k"));
        assert_eq!((said.kp_nm_rad, said.kd_nm_s_rad, said.torque_limit_nm), (Some(7.0), Some(0.4), Some(3.0)));
        let payload = BodyChange::Payload { mass_kg: 0.5, place_m: Vector3::new(0.0, 0.0, -0.3) };
        let heavier = setup.with_change(setup.description.link("a").unwrap(), &payload).unwrap();
        let damping = |setup: &ClampedSetup| setup.beliefs(joint("j")).kd_nm_s_rad;
        assert!(damping(&setup).is_some_and(|kd| kd > 0.0));
        assert_eq!(damping(&setup), damping(&heavier));
    }

    #[test]
    fn what_all_joints_have_is_enough_for_each_joint_that_logs_show_or_its_own_table_says_more() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("study.toml");
        std::fs::write(dir.path().join("arm.xml"), ARM).unwrap();
        let joints = "[joints.default]\ntau_is = \"current\"\n[joints.j]\nkt = 2.0\n";
        std::fs::write(&file, format!("{STUDY}{joints}")).unwrap();
        let read = |log: &str| {
            std::fs::write(dir.path().join("log.csv"), log).unwrap();
            ClampedSetup::read(&file).map_err(|error| error.to_string())
        };
        assert!(read("t,j.q\n0,0\n0.01,0\n").is_ok());
        let error = read("t,j.q,k.q\n0,0,0\n0.01,0,0\n").unwrap_err();
        assert!(error.starts_with("joint k has no table [joints.k], "), "{error}");
        assert!(error.contains("`[joints.default] kt` is missing"), "{error}");
        let error = ClampedSetup::of_study(read_clamped_study(&file).unwrap()).unwrap_err().to_string();
        assert!(error.starts_with("joint k has no table"), "before logs are read any joint may be meant: {error}");
    }

    /// `simulate` let such a joint go without a word, where `check` and `gap` refused it.
    #[test]
    fn a_joint_that_setpoints_drive_needs_a_gain() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("study.toml");
        std::fs::write(dir.path().join("log.csv"), "t,j.q,k.q\n0,0,0\n0.01,0,0\n").unwrap();
        let said = |arm: &str, study: &str| {
            std::fs::write(dir.path().join("arm.xml"), arm).unwrap();
            std::fs::write(&file, study).unwrap();
            ClampedSetup::read(&file).unwrap().without_gain().map(|error| error.to_string())
        };
        assert_eq!(said(ARM, STUDY), None);
        let general = ARM.find("<general").unwrap()..ARM.find("</actuator>").unwrap();
        let mut bare = ARM.to_owned();
        bare.replace_range(general, "");
        let error = said(&bare, STUDY).unwrap();
        assert!(error.contains("study.toml: joint k is driven by position") && error.contains("states kp"), "{error}");
        assert_eq!(said(&bare, &STUDY.replace("drive = \"position\"", "drive = \"off\"")), None);
        assert_eq!(said(&bare, &format!("{STUDY}[joints.k]\nkp = 2.0\n")), None);
    }

    /// A name that nothing has was passed over.
    #[test]
    fn joints_that_are_left_out_are_joints_of_the_logs_or_of_the_robot() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("study.toml");
        std::fs::write(dir.path().join("arm.xml"), ARM).unwrap();
        std::fs::write(dir.path().join("log.csv"), "t,j.q,hand.q\n0,0,0\n0.01,0,0\n").unwrap();
        let joints = |without: &str| {
            let without = format!("scenario = \"fixed\"\nwithout = [{without}]");
            std::fs::write(&file, STUDY.replace("scenario = \"fixed\"", &without)).unwrap();
            let setup = ClampedSetup::read(&file).map_err(|error| error.to_string())?;
            Ok::<_, String>(setup.logs[0].joints.iter().map(|joint| joint.name.clone()).collect::<Vec<_>>())
        };
        assert_eq!(joints("\"hand\", \"k\"").unwrap(), ["j"]);
        let error = joints("\"hand\", \"hnad\"").unwrap_err();
        assert!(error.contains("[robot] without: the robot has no joint `hnad`; it has hand, j, k"), "{error}");
    }

    /// Such a robot was simulated, for minutes or without an end.
    #[test]
    fn what_joints_move_is_not_heavier_than_a_machine() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("study.toml");
        std::fs::write(dir.path().join("log.csv"), "t,j.q,k.q\n0,0,0\n0.01,0,0\n").unwrap();
        std::fs::write(dir.path().join("arm.xml"), ARM.replace("mass=\".5\"", "mass=\"1e9\"")).unwrap();
        std::fs::write(&file, STUDY).unwrap();
        let error = ClampedSetup::read(&file).unwrap_err().to_string();
        assert!(error.contains("arm.xml: link \"b\": a mass of 1e9 kg, expected at most 1e6 kg"), "{error}");
    }

    #[test]
    fn what_is_uncertain_of_a_robot_is_a_part_of_it() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("study.toml");
        std::fs::write(dir.path().join("arm.xml"), ARM).unwrap();
        std::fs::write(dir.path().join("log.csv"), "t,j,k\n0,0,0\n").unwrap();
        let with = |uncertain: &str| {
            std::fs::write(&file, format!("{STUDY}[uncertain]\n{uncertain}\n")).unwrap();
            ClampedSetup::of_study(read_clamped_study(&file).unwrap()).map(drop).map_err(|error| error.to_string())
        };
        assert_eq!(with("mass = { a = 0.1 }\nfriction = { j = 0.2, coulomb = 0.3 }"), Ok(()));
        let error = with("mass = { nos = 0.1 }").unwrap_err();
        assert!(error.contains("[uncertain] mass") && error.contains("nos"), "{error}");
    }
}
