//! Makes the logs of a spec.

use super::described::file_of;
use super::error::{Blame, SynthError};
use super::joint;
use super::plan::{Plan, plans};
use super::spec::{Believed, Spec};
use super::truth::{self, Truth};
use super::write;
use crate::geometry::robot_file::FRAME_S;
use crate::log::{Forward, LogError, RobotStudy, RobotStudyLog};
use crate::robot::description::Description;
use crate::robot::simulate::{Method, PositionSensor, Recording, Setpoints, run};
use crate::robot::{Model, Nominal, RobotError};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rayon::prelude::*;

/// What came of a spec.
#[derive(Clone, Debug)]
pub struct Made {
    /// The study: what is believed, and nothing of the truth.
    pub study_toml: String,
    /// The robot's file where it is not the embedded one: its name in the study, and its text.
    pub robot: Option<(String, String)>,
    /// Names and contents of the logs, in the spec's order.
    pub logs: Vec<(String, String)>,
    /// What is true.
    pub truth: Truth,
}

impl Made {
    /// Names and contents of the study's files, `study.toml` first.
    pub fn files(self) -> impl Iterator<Item = (String, String)> {
        std::iter::once(("study.toml".to_owned(), self.study_toml)).chain(self.robot).chain(self.logs)
    }
}

/// Name of the robot's file beside a study.
const ROBOT_FILE: &str = "robot.toml";

/// What a caller changes that no spec can say, after all that the spec says.
#[derive(Clone, Copy)]
pub struct Alteration<'a> {
    /// The true robot.
    pub robot: &'a (dyn Fn(&mut Nominal) + Sync),
    /// The setpoints on their way to the controllers; the log says what was asked.
    pub setpoints: &'a (dyn Fn(&mut Setpoints) + Sync),
    /// What the study of a robot says.
    pub study: &'a (dyn Fn(&mut RobotStudy) + Sync),
}

impl Alteration<'_> {
    /// Changes nothing.
    pub const NONE: Alteration<'static> = Alteration { robot: &|_| {}, setpoints: &|_| {}, study: &|_| {} };
}

/// Makes logs, study and truth; the same spec gives the same bytes on any number of threads (`None`: all cores).
///
/// # Errors
/// [`SynthError`] naming the spec's key where a truth, an effect or a log cannot be, or where the motion ran away.
pub fn make(spec: &Spec, threads: Option<usize>) -> Result<Made, SynthError> {
    make_altered(spec, threads, Alteration::NONE)
}

/// The same of a robot that is altered beyond what a spec can say; of that the truth says nothing.
///
/// # Errors
/// As [`make()`].
pub fn make_altered(spec: &Spec, threads: Option<usize>, alteration: Alteration<'_>) -> Result<Made, SynthError> {
    let Some(threads) = threads else { return made(spec, alteration) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| SynthError::Threads(error.to_string()))?.install(|| made(spec, alteration))
}

fn made(spec: &Spec, alteration: Alteration<'_>) -> Result<Made, SynthError> {
    let blame = Blame { file: &spec.file };
    let (Believed::Robot(study) | Believed::Joint(study, _)) = &spec.believed;
    // A file that cannot be read says so by itself.
    let read = Nominal::robot_of(study).map_err(|error| blame.refused("[robot] model", error))?.map(|(robot, _)| robot);
    let (model, file) = match (&study.model_path, &study.described) {
        (None, _) => (study.model.clone(), None),
        (Some(path), None) => {
            let text = std::fs::read_to_string(path).map_err(|source| LogError::Read { file: path.clone(), source })?;
            (ROBOT_FILE.to_owned(), Some((ROBOT_FILE.to_owned(), text)))
        }
        (Some(path), Some(_)) => {
            let read = Description::read(path).map_err(RobotError::from);
            file_of(&read.map_err(|error| blame.refused("[robot] model", error))?, path)?
        }
    };
    let robot = read.as_ref().unwrap_or(Model::ers7());
    // The belief has to make sense by itself.
    Nominal::on(robot, study).map_err(|error| blame.refused("[robot]", error))?;
    let (mut truth_robot, method, truth) = truth::of(spec, robot, study)?;
    (alteration.robot)(&mut truth_robot);
    let period_s = study.sensor.period_s.unwrap_or(FRAME_S);
    let plans = plans(spec, robot, period_s)?;
    let make = Make { spec, study, robot: &truth_robot, method, period_s, alteration };
    let made: Vec<Result<(RobotStudyLog, String), SynthError>> =
        plans.par_iter().enumerate().map(|(k, plan)| make.log(k, plan)).collect();
    let made: Vec<(RobotStudyLog, String)> = made.into_iter().collect::<Result<_, _>>()?;
    let (entries, texts): (Vec<RobotStudyLog>, Vec<String>) = made.into_iter().unzip();
    let logs = entries.iter().map(|entry| entry.file.clone()).zip(texts).collect();
    let study_toml = match &spec.believed {
        Believed::Robot(study) => {
            let mut said = study.clone();
            (alteration.study)(&mut said);
            write::robot_study(&said, &model, &entries)
        }
        Believed::Joint(_, bench) => write::joint_study(&joint::believed(&blame, bench)?, study, &entries),
    };
    Ok(Made { study_toml, robot: file, logs, truth })
}

struct Make<'a> {
    spec: &'a Spec,
    study: &'a RobotStudy,
    robot: &'a Nominal,
    method: Method,
    period_s: f64,
    alteration: Alteration<'a>,
}

impl Make<'_> {
    /// Log number `k`, with its entry in the study.
    fn log(&self, k: usize, plan: &Plan) -> Result<(RobotStudyLog, String), SynthError> {
        let blame = Blame { file: &self.spec.file };
        let refused = |error| blame.refused(&format!("[[log]] {}", k + 1), error);
        let mut scene = self.robot.scene(&plan.entry, &plan.asked).map_err(refused)?;
        let asked = scene.setpoints.clone();
        (self.alteration.setpoints)(&mut scene.setpoints);
        let mut recording = run(&self.robot.scenario(&scene, self.period_s), self.method).map_err(refused)?;
        if let Some(source) = recording.diverged {
            let (file, log) = (self.spec.file.clone(), plan.entry.file.clone());
            return Err(SynthError::Diverged { file, log, source: Box::new(source) });
        }
        let sensor = PositionSensor::Normal {
            step_rad: self.study.sensor.resolution_rad.unwrap_or(0.0),
            sigma_rad: self.study.sensor.noise_rad.unwrap_or(0.0),
        };
        let mut rng = ChaCha8Rng::seed_from_u64(self.spec.seed);
        rng.set_stream(1 + k as u64);
        let (model, joints) = (&self.robot.model, &self.robot.joints);
        if scene.setpoints != asked {
            for (id, column) in model.joint_ids().zip(&mut recording.setpoint_rad) {
                for (setpoint, t_s) in column.iter_mut().zip(&recording.t_s) {
                    *setpoint = asked.at(id, *t_s).unwrap_or(*setpoint);
                }
            }
        }
        let text = match &self.spec.believed {
            Believed::Robot(_) => {
                let has_base = self.spec.logs.get(k).is_some_and(|log| log.base);
                write::robot_log(model, joints, &recording, plan, has_base, sensor, &mut rng)
            }
            Believed::Joint(_, bench) => {
                let joint = model.joint(&bench.name).map_err(|error| blame.refused("[joint] name", error))?;
                write::joint_log(joints.drive(joint), joint, &recording, plan, sensor, &mut rng)
            }
        };
        let forward = plan.forward_s.map(|[from_s, to_s]| Forward {
            distance_m: (1e3 * went_m(&recording, from_s, to_s)).round() * 1e-3,
            from_s,
            to_s,
        });
        Ok((RobotStudyLog { forward, ..plan.entry.clone() }, text))
    }
}

/// How far the trunk went forward between the samples nearest to two times \[m\].
fn went_m(recording: &Recording, from_s: f64, to_s: f64) -> f64 {
    let z = |t_s: f64| {
        let nearest = recording.t_s.iter().enumerate().min_by(|a, b| (a.1 - t_s).abs().total_cmp(&(b.1 - t_s).abs()));
        nearest.and_then(|(k, _)| recording.base.get(k)).map_or(f64::NAN, |base| base.position_m.z)
    };
    z(from_s) - z(to_s)
}
