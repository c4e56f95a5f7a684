//! What a user hands over, made ready: a study, or logs with their sidecars, as one joint and its experiments.

use super::holes::{FEWEST_SAMPLES, cut};
use super::ready::Ready;
use super::{Experiment, LegCase};
use crate::geometry::{GeometryError, LegJoint};
use crate::log::{
    ArrayLog, Columns, DriveMode, Health, JointSpec, Log, LogError, MotorSpec, Role, SensorSpec, Start, Study,
    StudyLog, Uncertain, check_drive_stated, check_inputs, check_period, check_torque_sign, read_each_log,
    read_joint_log_as, read_pose_for, read_sidecar, read_sidecar_for, read_study,
};
use crate::number::STANDARD_GRAVITY_M_S2;
use std::path::{Path, PathBuf};

/// One joint and its logs.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name, gravity, rest angle; the nominal model of the study, or of the thesis's tables for a leg.
    pub joint: JointSpec,
    /// The leg of the ERS-7 that swings; `None` for any other joint, and where a study states a nominal model and no
    /// pose stands beside its logs.
    pub leg: Option<LegCase>,
    /// The link is written by the masses of its bodies, because nothing else is stated of it.
    pub by_bodies: bool,
    /// How sure the engineer is of what the study states.
    pub uncertain: Uncertain,
    /// In the order given.
    pub items: Vec<Item>,
    /// Files that were read beside the logs: study, sidecars, poses.
    pub documents: Vec<PathBuf>,
}

/// One log of a case.
#[derive(Clone, Debug)]
pub struct Item {
    /// What was recorded; of a very long log, a choice of its samples: 20 000 at the most of a free one, of a driven one
    /// stretches with 48 000.
    pub log: Log,
    /// What the study or the sidecar says of it.
    pub entry: StudyLog,
    /// Its encoder.
    pub sensor: SensorSpec,
    /// What it is like.
    pub health: Health,
    /// The log made ready, one for each part between two holes; none where the joint never moved, or was never let go.
    pub experiments: Vec<Experiment>,
    /// What was left out of it and why, in words.
    pub remarks: Vec<String>,
}

/// Why logs do not make a case.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError {
    /// A file cannot be read or is wrong.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The sidecar's or pose's geometry is impossible.
    #[error("{}: {source}", file.display())]
    Geometry {
        /// The log whose geometry it is.
        file: PathBuf,
        /// What is impossible about it.
        source: GeometryError,
    },
    /// Logs of different joints were given together.
    #[error("{}: a log of joint {found}, but {} is of joint {expected}; fit one joint at a time, or name it with --joint", file.display(), first.display())]
    JointsDiffer {
        /// The log that differs.
        file: PathBuf,
        /// Its joint.
        found: String,
        /// The first log.
        first: PathBuf,
        /// The first log's joint.
        expected: String,
    },
    /// Sidecars of the logs contradict each other.
    #[error("{}: {key} is {found}, but {} has {expected}; logs that are fitted together share it", file.display(), first.display())]
    SidecarsDiffer {
        /// The log that differs.
        file: PathBuf,
        /// Which key.
        key: &'static str,
        /// Its value.
        found: String,
        /// The first log.
        first: PathBuf,
        /// The first log's value.
        expected: String,
    },
    /// Setpoints, and no controller that makes torque of them.
    #[error("{log}: drive = \"position\" needs a motor with kp and kd")]
    NoMotor {
        /// The log.
        log: String,
    },
    /// A log is shorter than what is to be found from it.
    #[error("{}: only {samples} samples while the joint is free, but at least {needed} are needed for 6 unknowns; record longer", file.display())]
    TooFewSamples {
        /// The log.
        file: PathBuf,
        /// Samples that count.
        samples: usize,
        /// Samples that are needed.
        needed: usize,
    },
}

impl Case {
    /// A study with its logs.
    ///
    /// # Errors
    /// [`CaseError`] where a file cannot be read or is wrong.
    pub fn of_study(path: &Path) -> Result<Self, CaseError> {
        let study = read_study(path)?;
        let documents = vec![path.to_path_buf()];
        Self::of_named(study, documents)
    }

    /// A study whose logs are read, each of them shortened before the next is.
    fn of_named(study: Study, documents: Vec<PathBuf>) -> Result<Self, CaseError> {
        let count = study.logs.len();
        let ready = read_each_log(&study, |entry, log| Ready::of(log, &study.sensor, entry.drive, count))?;
        Self::of_ready(study, ready, documents)
    }

    /// A study and its logs, in its order, that are read already.
    ///
    /// # Errors
    /// [`CaseError`] where a log is too short, or the geometry beside a leg's logs is impossible.
    pub fn of_read(study: Study, logs: Vec<Log>) -> Result<Self, CaseError> {
        let documents = if study.file.is_file() { vec![study.file.clone()] } else { Vec::new() };
        let count = study.logs.len();
        let ready = logs.into_iter().zip(&study.logs);
        let ready = ready.map(|(log, entry)| Ready::of(log, &study.sensor, entry.drive, count)).collect();
        Self::of_ready(study, ready, documents)
    }

    fn of_ready(study: Study, ready: Vec<Ready>, documents: Vec<PathBuf>) -> Result<Self, CaseError> {
        let Study { joint, sensor, uncertain, logs, .. } = study;
        let items = ready.into_iter().zip(logs).map(|(ready, entry)| (ready, entry, sensor)).collect();
        Self::new(joint, uncertain, items, documents)
    }

    /// A log that a study does not name, read by the study's joint and by what the study says of its first log.
    ///
    /// # Errors
    /// As [`Case::of_study`].
    pub fn of_log_in_study(path: &Path, log: &Path) -> Result<Self, CaseError> {
        let mut study = read_study(path)?;
        study.logs.truncate(1);
        for entry in &mut study.logs {
            entry.file = log.display().to_string();
            entry.path = log.to_path_buf();
            entry.role = Role::Validate;
            entry.extra = read_sidecar_for(log)?.and_then(|sidecar| sidecar.logs.first()?.extra).or(entry.extra);
        }
        Self::of_named(study, vec![path.to_path_buf()])
    }

    /// Logs with their sidecars; `joint` overrides what sidecar and file name say.
    ///
    /// # Errors
    /// As [`Case::of_study`], and where the logs are not of one joint.
    pub fn of_logs(paths: &[PathBuf], joint: Option<&str>) -> Result<Self, CaseError> {
        let mut first: Option<(PathBuf, JointSpec)> = None;
        let mut believed: Option<Uncertain> = None;
        let mut items = Vec::with_capacity(paths.len());
        let mut documents = Vec::new();
        for path in paths {
            let sidecar = read_sidecar(path)?;
            if sidecar.is_some() {
                documents.push(path.with_extension("toml"));
            }
            let columns = sidecar.as_ref().map_or_else(Columns::default, |(sidecar, _)| sidecar.columns.clone());
            let log = match read_joint_log_as(path, &columns, None) {
                Err(LogError::SeveralJoints { .. }) if joint.is_some() => read_joint_log_as(path, &columns, joint)?,
                read => read?,
            };
            if sidecar.as_ref().is_none_or(|(_, is_stated)| !is_stated) {
                check_drive_stated(&log)?;
            }
            let sidecar = sidecar.map(|(sidecar, _)| sidecar);
            if let Some(sidecar) = &sidecar {
                believed.get_or_insert_with(|| sidecar.uncertain.clone());
            }
            let (mut spec, sensor, entry) = match sidecar {
                Some(Study { joint, sensor, mut logs, .. }) if !logs.is_empty() => (joint, sensor, logs.remove(0)),
                Some(Study { joint, sensor, .. }) => (joint, sensor, plain_entry(path)),
                None => (plain_joint(path), SensorSpec::default(), plain_entry(path)),
            };
            if let Some(name) = joint {
                spec.name = name.to_owned();
            } else if spec.name.is_empty() {
                spec.name = name_from_file(path);
            }
            // On the command line the path is what the user typed.
            let entry = StudyLog { file: path.display().to_string(), path: path.clone(), ..entry };
            match &first {
                None => first = Some((path.clone(), spec)),
                Some((first, expected)) => same_joint(path, &spec, first, expected)?,
            }
            let log = check_inputs(&path.with_extension("toml"), 0, &entry, log)?;
            items.push((Ready::of(log, &sensor, entry.drive, paths.len()), entry, sensor));
        }
        let spec = first.map_or_else(|| plain_joint(Path::new("joint")), |(_, spec)| spec);
        Self::new(spec, believed.unwrap_or_default(), items, documents)
    }

    /// A joint whose logs are at hand as arrays; no file is read. The motor is in force for every log.
    ///
    /// ```
    /// use aibo_fit::gap::{GapOptions, diagnose};
    /// use aibo_fit::identify::Case;
    /// use aibo_fit::log::{ArrayLog, JointSpec, Nominal, SensorSpec, Uncertain, read_log};
    /// use aibo_fit::progress::Silent;
    ///
    /// let swing = read_log("data/q1.csv".as_ref())?;
    /// let nominal = Nominal { inertia_kg_m2: 4e-3, moment_kg_m: 0.03, coulomb_nm: 1e-3, viscous_nm_s_rad: 0.017 };
    /// let joint = JointSpec { name: "hip".into(), nominal: Some(nominal), gravity_m_s2: 9.81, rest_rad: None };
    /// let log = ArrayLog { on: swing.drive, ..ArrayLog::new("swing", swing.t_s, swing.q_rad) };
    /// let case = Case::of_arrays(joint, SensorSpec::default(), None, Uncertain::default(), vec![log])?;
    /// let diagnosis = diagnose(&case, &GapOptions::default(), &Silent)?;
    /// assert_eq!(diagnosis.joint, "hip");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CaseError`] that names the log, the array and the index.
    pub fn of_arrays(
        joint: JointSpec,
        sensor: SensorSpec,
        motor: Option<MotorSpec>,
        uncertain: Uncertain,
        logs: Vec<ArrayLog>,
    ) -> Result<Self, CaseError> {
        let count = logs.len();
        let item = |given: ArrayLog| {
            let (file, session) = (given.name.clone(), given.session.clone());
            let (role, drive, extra, tau_is) = (given.role, given.drive, given.extra, given.tau_is);
            let log = given.into_log()?;
            if drive == DriveMode::Position && motor.is_none() {
                return Err(CaseError::NoMotor { log: file });
            }
            check_period(&log, &sensor)?;
            let entry =
                StudyLog { file, path: PathBuf::new(), role, drive, motor, extra, session, tau_is, window: None };
            check_torque_sign(&log, &entry)?;
            Ok((Ready::of(log, &sensor, drive, count), entry, sensor))
        };
        let items = logs.into_iter().map(item).collect::<Result<_, CaseError>>()?;
        Self::new(joint, uncertain, items, Vec::new())
    }

    fn new(
        mut joint: JointSpec,
        uncertain: Uncertain,
        items: Vec<(Ready, StudyLog, SensorSpec)>,
        mut documents: Vec<PathBuf>,
    ) -> Result<Self, CaseError> {
        let by_bodies = joint.nominal.is_none();
        let mut leg = None;
        if let Ok(leg_joint) = joint.name.parse::<LegJoint>() {
            let path = items.first().map_or_else(PathBuf::new, |(_, entry, _)| entry.path.clone());
            let in_file = !path.as_os_str().is_empty();
            let pose = if in_file { read_pose_for(&path, &leg_joint.to_string())? } else { None };
            if pose.is_some() {
                documents.push(path.with_file_name("pose.toml"));
            }
            if pose.is_some() || by_bodies {
                let impossible = |source| CaseError::Geometry { file: path.clone(), source };
                let case = LegCase::new(leg_joint, pose.as_ref(), joint.gravity_m_s2).map_err(impossible)?;
                if by_bodies {
                    joint.nominal = Some(case.nominal().map_err(impossible)?);
                }
                leg = Some(case);
            }
        }
        let gravity_m_s2 = match &leg {
            Some(leg) => {
                leg.bare()
                    .map_err(|source| CaseError::Geometry { file: PathBuf::from("pose.toml"), source })?
                    .gravity_m_s2
            }
            None => joint.gravity_m_s2,
        };
        joint.gravity_m_s2 = gravity_m_s2;
        let items = items
            .into_iter()
            .enumerate()
            .map(|(i, (ready, entry, sensor))| item(i, ready, entry, sensor, gravity_m_s2, leg.as_ref()))
            .collect::<Result<_, _>>()?;
        let by_bodies = by_bodies && leg.is_some();
        Ok(Self { joint, leg, by_bodies, uncertain, items, documents })
    }

    /// Every file that was read: logs first, then what stood beside them. Arrays are none.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let logs = self.items.iter().map(|item| &item.entry.path).filter(|path| !path.as_os_str().is_empty());
        logs.chain(&self.documents).cloned().collect()
    }

    /// Experiments of the logs with a role, in order, parts of a log one after the other; logs in which nothing moved are
    /// left out.
    pub fn experiments(&self, role: Role) -> Vec<Experiment> {
        self.items.iter().filter(|i| i.entry.role == role).flat_map(|i| i.experiments.iter().cloned()).collect()
    }
}

fn item(
    log_index: usize,
    ready: Ready,
    entry: StudyLog,
    sensor: SensorSpec,
    gravity_m_s2: f64,
    leg: Option<&LegCase>,
) -> Result<Item, CaseError> {
    let Ready { log, health, begins } = ready;
    let free = health.start.held().map_or(log.len(), |held| log.len() - held.first_free);
    if free < FEWEST_SAMPLES && health.start != Start::AlwaysHeld {
        return Err(CaseError::TooFewSamples { file: log.file.clone(), samples: free, needed: FEWEST_SAMPLES });
    }
    let resolution_rad = sensor.resolution_rad.or(health.step_rad).unwrap_or(0.0);
    let experiment =
        health.moved.then(|| Experiment::new(&log, &entry, &health, resolution_rad, gravity_m_s2)).flatten();
    let (mut experiments, mut remarks) = (Vec::new(), Vec::new());
    if let Some(mut e) = experiment {
        e.log_index = log_index;
        if e.compared() < FEWEST_SAMPLES {
            let (file, samples) = (log.file.clone(), e.compared());
            return Err(CaseError::TooFewSamples { file, samples, needed: FEWEST_SAMPLES });
        }
        if let Some(leg) = leg {
            let impossible = |source| CaseError::Geometry { file: entry.path.clone(), source };
            e.bodies = leg.bodies().map_err(impossible)?;
            e.load = entry.extra.as_ref().map(|extra| leg.load(extra)).transpose().map_err(impossible)?;
        }
        (experiments, remarks) = cut(e, &log, &begins, health.noise_rad);
    }
    Ok(Item { log, entry, sensor, health, experiments, remarks })
}

fn same_joint(path: &Path, spec: &JointSpec, first: &Path, expected: &JointSpec) -> Result<(), CaseError> {
    let (file, first) = (path.to_path_buf(), first.to_path_buf());
    if spec.name != expected.name {
        let (found, expected) = (spec.name.clone(), expected.name.clone());
        return Err(CaseError::JointsDiffer { file, found, first, expected });
    }
    if spec.gravity_m_s2 != expected.gravity_m_s2 {
        let (found, expected) = (spec.gravity_m_s2.to_string(), expected.gravity_m_s2.to_string());
        return Err(CaseError::SidecarsDiffer { file, key: "[joint] gravity", found, first, expected });
    }
    if spec.rest_rad != expected.rest_rad {
        let word = |rest: Option<f64>| rest.map_or("absent".to_owned(), |r| r.to_string());
        let (found, expected) = (word(spec.rest_rad), word(expected.rest_rad));
        return Err(CaseError::SidecarsDiffer { file, key: "[joint] rest", found, first, expected });
    }
    Ok(())
}

fn plain_joint(path: &Path) -> JointSpec {
    JointSpec { name: name_from_file(path), nominal: None, gravity_m_s2: STANDARD_GRAVITY_M_S2, rest_rad: None }
}

fn plain_entry(path: &Path) -> StudyLog {
    StudyLog {
        file: path.display().to_string(),
        path: path.to_path_buf(),
        role: Role::Fit,
        drive: DriveMode::Off,
        motor: None,
        extra: None,
        session: None,
        tau_is: None,
        window: None,
    }
}

/// `q1` for `q1.csv`, `q1-bare-0.csv` and `Q1_402g.csv`; the file's stem where it names no leg joint.
pub(crate) fn name_from_file(path: &Path) -> String {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let head = stem.split(['-', '_', '.', ' ']).next().unwrap_or_default().to_lowercase();
    if head.parse::<LegJoint>().is_ok() { head } else { stem }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_joint_is_known_from_the_file_name() {
        for (file, joint) in
            [("q1.csv", "q1"), ("a/Q2_bare.csv", "q2"), ("q3-220g-1.csv", "q3"), ("pendulum.csv", "pendulum")]
        {
            assert_eq!(name_from_file(Path::new(file)), joint);
        }
    }

    #[test]
    fn a_log_with_sidecar_and_pose_is_a_leg() {
        let case = Case::of_logs(&[PathBuf::from("data/q1.csv")], None).expect("readable");
        let leg = case.leg.expect("q1 is a joint of the leg");
        assert!(leg.pose_known);
        let e = case.items[0].experiments.first().expect("it swings");
        assert_eq!((e.bodies.len(), e.uncompared), (3, 1));
        assert_eq!(case.documents.len(), 2);
    }

    #[test]
    fn logs_of_two_joints_are_refused() {
        let paths = ["data/thesis-robot/q1-bare-0.csv", "data/thesis-robot/q2-bare-0.csv"].map(PathBuf::from);
        let error = Case::of_logs(&paths, None).expect_err("two joints");
        assert!(error.to_string().contains("q2-bare-0.csv: a log of joint q2"), "{error}");
    }
}
