//! Chapter 4's open question: the real q2 joints could not follow their setpoints, the simulated ones did. Why?
//!
//! Each explanation that has been offered is put into a "real" robot, with other masses, friction and floor and at
//! another step than a diagnosis uses; its logs are diagnosed without being told. What a diagnosis makes of each says
//! which logs would have settled the question in 2005.

use crate::gap::robot::{JointTrace, RobotCase, RobotDiagnosis, RobotGapError, RobotOptions, diagnose_robot};
use crate::robot::simulate::SimulateError;
use crate::synth::{Spec, SynthError, make};
use std::path::{Path, PathBuf};

/// An explanation of weak q2 joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rival {
    /// The motors of all q2 joints have no more than so much torque.
    TorqueLimit,
    /// The gains P and I of q1 and q2 are swapped, as another source of the ERS-7 has them.
    GainsSwapped,
    /// The floor is more slippery.
    FloorFriction,
    /// Setpoints reach the joints every 128 ms only (a motion file's frames).
    Frames,
    /// The gears of all q2 joints have play.
    Play,
}

impl Rival {
    /// All of them, in the order of the report.
    pub const ALL: [Rival; 5] =
        [Rival::TorqueLimit, Rival::GainsSwapped, Rival::FloorFriction, Rival::Frames, Rival::Play];

    /// What is true.
    pub fn words(self) -> &'static str {
        match self {
            Rival::TorqueLimit => "q2 motors with at most 0.25 N m",
            Rival::GainsSwapped => "gains of q1 and q2 swapped",
            Rival::FloorFriction => "floor with half the friction",
            Rival::Frames => "setpoints every 128 ms",
            Rival::Play => "20 mrad of play in q2",
        }
    }

    /// Whether an id names it.
    pub fn is_named_by(self, cause: &str) -> bool {
        match self {
            Rival::TorqueLimit => cause == "torque_limit",
            // What the catalogue has for gains that are off.
            Rival::GainsSwapped => cause == "motor_gain",
            Rival::FloorFriction => cause == "floor_friction",
            Rival::Frames => cause == "setpoint_hold",
            Rival::Play => cause == "backlash",
        }
    }

    fn name(self) -> &'static str {
        match self {
            Rival::TorqueLimit => "torque-limit",
            Rival::GainsSwapped => "gains-swapped",
            Rival::FloorFriction => "floor-friction",
            Rival::Frames => "frames",
            Rival::Play => "play",
        }
    }

    fn spec(self, scenario: &str, seed: u64) -> String {
        let q2 = r#"joints = ["lf2", "rf2", "lr2", "rr2"]"#;
        let gains = match self {
            Rival::GainsSwapped => "[control]\ngains = { q1 = [7.0, 4.88e-4, 0.5], q2 = [5.0, 2.44e-4, 0.5] }\n",
            _ => "",
        };
        let floor = match self {
            Rival::FloorFriction if scenario == "floor" => "[truth.floor]\ncoulomb = 0.3\nstatic = 0.35\n",
            _ => "",
        };
        let effect = match self {
            Rival::TorqueLimit => format!("[[effect]]\nid = \"torque_limit\"\n{q2}\ntau_max = 0.25\n"),
            Rival::Frames => "[[effect]]\nid = \"setpoint_hold\"\njoints = \"all\"\nT_h = 0.128\n".to_owned(),
            Rival::Play => format!("[[effect]]\nid = \"backlash\"\n{q2}\nb = 0.02\nrotor = 0.2\n"),
            Rival::GainsSwapped | Rival::FloorFriction => String::new(),
        };
        let forward = if scenario == "floor" { "forward = [2.0, 10.0]\n" } else { "" };
        format!(
            "schema = 1\nseed = {seed}\n[robot]\nmodel = \"ers7\"\nscenario = \"{scenario}\"\n{gains}[sensor]\n\
             resolution = 0.006\nperiod = 0.008\nnoise = 0.002\n[truth]\nscatter = 0.02\nstep = 1e-4\n{floor}{effect}\
             [[log]]\nfile = \"trot.csv\"\ngait = \"trot\"\n{forward}"
        )
    }
}

/// A rival as one kind of log shows it.
pub struct Diagnosed {
    /// What is true.
    pub rival: Rival,
    /// The trunk was clamped.
    pub in_the_air: bool,
    /// The study, for `aibo-fit gap`.
    pub study: PathBuf,
    /// Setpoint less reading of the q2 joints, RMS \[rad\].
    pub q2_error_rad: f64,
    /// The same of the robot as the study has it \[rad\].
    pub q2_error_given_rad: f64,
    /// What the diagnosis says.
    pub diagnosis: RobotDiagnosis,
}

impl Diagnosed {
    /// Whether the answer has what is true, alone or in its set.
    pub fn is_named(&self) -> bool {
        let answer = &self.diagnosis.answer;
        answer.equivalent.iter().any(|cause| self.rival.is_named_by(cause.id()))
            || answer.second.as_ref().is_some_and(|found| self.rival.is_named_by(found.cause.id()))
    }
}

/// Why a case could not be made or diagnosed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WeakQ2Error {
    /// A "real" robot could not be made.
    #[error(transparent)]
    Synth(Box<SynthError>),
    /// Its spec or files cannot be read.
    #[error(transparent)]
    Log(Box<crate::log::LogError>),
    /// Its study does not fit the robot.
    #[error(transparent)]
    Simulate(Box<SimulateError>),
    /// There is nothing to diagnose.
    #[error(transparent)]
    Gap(#[from] RobotGapError),
    /// A file could not be written.
    #[error("{}: {source}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

impl From<SynthError> for WeakQ2Error {
    fn from(error: SynthError) -> Self {
        Self::Synth(Box::new(error))
    }
}

impl From<crate::log::LogError> for WeakQ2Error {
    fn from(error: crate::log::LogError) -> Self {
        Self::Log(Box::new(error))
    }
}

impl From<SimulateError> for WeakQ2Error {
    fn from(error: SimulateError) -> Self {
        Self::Simulate(Box::new(error))
    }
}

/// Makes a rival's logs under a folder and diagnoses them from the files alone.
///
/// # Errors
/// [`WeakQ2Error`].
pub fn diagnose_rival(
    rival: Rival,
    in_the_air: bool,
    folder: &Path,
    seed: u64,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Diagnosed, WeakQ2Error> {
    let scenario = if in_the_air { "air" } else { "floor" };
    let folder = folder.join(format!("{}-{scenario}", rival.name()));
    let spec = Spec::from_toml(&folder.join("spec.toml"), &rival.spec(scenario, seed))?;
    let made = make(&spec, None)?;
    let write = |name: &str, text: &str| {
        let file = folder.join(name);
        std::fs::write(&file, text).map_err(|source| WeakQ2Error::Write { file, source })
    };
    std::fs::create_dir_all(&folder).map_err(|source| WeakQ2Error::Write { file: folder.clone(), source })?;
    write("study.toml", &with_printed_gains(&made.study_toml))?;
    for (name, text) in &made.logs {
        write(name, text)?;
    }
    let study = folder.join("study.toml");
    let case = RobotCase::of_study(&study)?;
    let diagnosis = diagnose_robot(&case, &RobotOptions::default(), progress)?;
    let q2: Vec<&JointTrace> = diagnosis.traces.iter().filter(|trace| trace.joint.ends_with('2')).collect();
    let q2_error_rad = following_error_rad(q2.iter().map(|trace| (&trace.setpoint_rad, &trace.measured_rad)));
    let q2_error_given_rad = following_error_rad(q2.iter().map(|trace| (&trace.setpoint_rad, &trace.before_rad)));
    Ok(Diagnosed { rival, in_the_air, study, q2_error_rad, q2_error_given_rad, diagnosis })
}

/// The study believes the printed gains whatever is true: it is without the table `[control.gains]`.
fn with_printed_gains(study: &str) -> String {
    let mut is_of_gains = false;
    let kept = study.lines().filter(|line| {
        is_of_gains = *line == "[control.gains]" || is_of_gains && !line.is_empty();
        !is_of_gains
    });
    kept.flat_map(|line| [line, "\n"]).collect()
}

/// RMS of setpoints less angles, where there is a setpoint \[rad\].
fn following_error_rad<'a>(pairs: impl Iterator<Item = (&'a Vec<f64>, &'a Vec<f64>)>) -> f64 {
    let errors = pairs.flat_map(|(setpoints, angles)| setpoints.iter().zip(angles));
    let (sum, count) = errors
        .filter(|(setpoint, _)| setpoint.is_finite())
        .fold((0.0, 0.0), |(sum, count), (setpoint, q)| (sum + (setpoint - q).powi(2), count + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_study_does_not_tell_what_is_true() {
        let study = |rival: Rival| {
            let spec = Spec::from_toml(Path::new("spec.toml"), &rival.spec("air", 1)).unwrap();
            with_printed_gains(&make(&spec, None).unwrap().study_toml)
        };
        assert_eq!(study(Rival::GainsSwapped), study(Rival::Play));
    }
}
