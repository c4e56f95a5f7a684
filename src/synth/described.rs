//! Makes the logs of a robot that a description describes, its base clamped.

use super::error::{Blame, SynthError};
use super::excite;
use super::make::Made;
use super::plan::{Of, Plan};
use super::spec::{DescribedSpec, MassScale};
use super::truth::{self, JointTruth, Scatter, Truth, joint_names};
use super::write;
use crate::gap::clamped::{ClampedCaseError, ClampedSetup};
use crate::gap::whole::{WholeRobot, found_robot};
use crate::geometry::robot_file::FRAME_S;
use crate::log::{RobotScenario, Role};
use crate::robot::description::{BodyChange, Description, LinkId};
use crate::robot::simulate::{Method, PositionSensor, Scenario, Setpoints, run};
use crate::robot::study::{settled, standing};
use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rayon::prelude::*;
use std::path::Path;
use toml::{Table, Value};

/// Makes the logs. `threads` is how many logs are simulated at a time; the results do not depend on it.
///
/// # Errors
/// [`SynthError`] where spec or description are wrong, or the true robot runs away.
pub fn make_described(spec: &DescribedSpec, threads: Option<usize>) -> Result<Made, SynthError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    pool.map_err(|error| SynthError::Threads(error.to_string()))?.install(|| made(spec))
}

/// The true robot, and the setup that is believed.
struct Make<'a> {
    spec: &'a DescribedSpec,
    robot: WholeRobot,
    method: Method,
    period_s: f64,
}

fn made(spec: &DescribedSpec) -> Result<Made, SynthError> {
    let blame = Blame { file: &spec.file };
    let setup = ClampedSetup::of_study(spec.study.clone());
    let setup = setup.map_err(|error| SynthError::Described(Box::new(error)))?;
    let cannot = |what: String| {
        SynthError::Described(Box::new(ClampedCaseError::NotSimulated { file: spec.study.model_path.clone(), what }))
    };
    if let Some(at) = setup.tree.joints().iter().find(|at| setup.motor(**at).is_none()) {
        let joint = setup.description.joints[at.0].name.clone();
        return Err(SynthError::Described(Box::new(ClampedCaseError::NoGain { file: spec.file.clone(), joint })));
    }
    let believed = found_robot(&setup, None).map_err(|error| cannot(error.to_string()))?;
    let (true_setup, mut scatter, of_friction) = bodies(&blame, spec, &setup)?;
    let mut robot = WholeRobot::of(&true_setup, &believed.numbers, &[]).map_err(cannot)?;
    scatter.scatter = of_friction;
    truth::friction(&blame, &spec.truth, &robot.model, &mut robot.joints, &mut scatter)?;
    gains(&blame, spec, &mut robot)?;
    let effects = truth::effects(&blame, &spec.effects, None, &robot.model, &mut robot.joints)?;
    let method = truth::method(&blame, &spec.truth)?;
    let friction_of = |id| {
        let law = &robot.joints.drive(id).chain.friction;
        JointTruth { coulomb: law.coulomb_nm, viscous: law.viscous_nm_s_rad }
    };
    let links = true_setup.description.links.iter().filter(|link| link.inertia.mass_kg > 0.0);
    let truth = Truth {
        schema: 1,
        seed: spec.seed,
        stated: spec.truth.clone(),
        effects,
        mass_kg: links.map(|link| (link.name.clone(), link.inertia.mass_kg)).collect(),
        friction: robot
            .model
            .joint_ids()
            .map(|id| (robot.model.joints()[id.index()].name.clone(), friction_of(id)))
            .collect(),
        floor: None,
        method: format!("{method:?}"),
    };
    let period_s = spec.study.sensor.period_s.unwrap_or(FRAME_S);
    let make = Make { spec, robot, method, period_s };
    let plans = make.plans()?;
    let texts: Vec<Result<String, SynthError>> =
        plans.par_iter().enumerate().map(|(k, (plan, setpoints))| make.log(k, plan, setpoints)).collect();
    let texts: Vec<String> = texts.into_iter().collect::<Result<_, _>>()?;
    let logs = plans.iter().map(|(plan, _)| plan.entry.file.clone()).zip(texts).collect();
    let (model, robot) = file_of(&setup.description, &spec.study.model_path)?;
    Ok(Made { study_toml: study_toml(spec, &model, &plans), robot, logs, truth })
}

impl Make<'_> {
    /// What is asked of the robot in each log.
    fn plans(&self) -> Result<Vec<(Plan, Setpoints)>, SynthError> {
        let blame = Blame { file: &self.spec.file };
        if self.spec.logs.is_empty() {
            return Err(blame.value("[[log]]", "no log", "at least one"));
        }
        let folder = self.spec.file.parent().unwrap_or(Path::new(""));
        let mut plans: Vec<(Plan, Setpoints)> = Vec::with_capacity(self.spec.logs.len());
        for (k, log) in self.spec.logs.iter().enumerate() {
            let (model, period_s) = (&self.robot.model, self.period_s);
            let of = Of { blame: &blame, table: format!("[[log]] {}", k + 1), log, model, period_s };
            let file = of.file(plans.iter().map(|(plan, _)| plan.entry.file.as_str()))?;
            let of_walks = [("base", log.base), ("forward", log.forward.is_some())];
            of.refuse(log.of_a_drop().into_iter().chain(of_walks), "scenario = \"fixed\"")?;
            let mut rng = ChaCha8Rng::seed_from_u64(self.spec.seed);
            rng.set_stream(1001 + k as u64);
            let setpoints = match excite::named(&of, &mut rng)? {
                Some(setpoints) => setpoints,
                None => of.setpoints(folder, RobotScenario::Air)?,
            };
            let setpoints = Setpoints { hold: self.spec.study.hold, ..setpoints.clipped(model).0 };
            let entry = of.entry(file, of.role()?, None);
            plans.push((Plan { asked: of.asked(&setpoints, None), entry, forward_s: None }, setpoints));
        }
        if plans.iter().all(|(plan, _)| plan.entry.role == Role::Validate) {
            return Err(blame.value("[[log]] role", "\"validate\" only", "at least one log with role = \"fit\""));
        }
        Ok(plans)
    }

    /// Log number `k`.
    fn log(&self, k: usize, plan: &Plan, setpoints: &Setpoints) -> Result<String, SynthError> {
        let blame = Blame { file: &self.spec.file };
        let refused = |error| blame.refused(&format!("[[log]] {}", k + 1), error);
        let WholeRobot { model, joints } = &self.robot;
        let start = settled(model, joints, setpoints, standing(model, joints, setpoints)).map_err(refused)?;
        let period_s = self.period_s;
        let scenario = Scenario { model, joints, setpoints, start: &start, surroundings: None, period_s };
        let recording = run(&scenario, self.method).map_err(refused)?;
        if let Some(source) = recording.diverged {
            let (file, log) = (self.spec.file.clone(), plan.entry.file.clone());
            return Err(SynthError::Diverged { file, log, source: Box::new(source) });
        }
        let sigma_rad = self.spec.truth.noise.unwrap_or(0.0);
        let sigma_rad = blame.number("[truth] noise", sigma_rad, |x| (0.0..=0.1).contains(&x), "0 to 0.1 rad")?;
        let step_rad = self.spec.study.sensor.resolution_rad.unwrap_or(0.0);
        let mut rng = ChaCha8Rng::seed_from_u64(self.spec.seed);
        rng.set_stream(1 + k as u64);
        let sensor = PositionSensor::Normal { step_rad, sigma_rad };
        Ok(write::robot_log(model, joints, &recording, plan, false, sensor, &mut rng))
    }
}

/// The robot with its true masses, what draws its scatter, and that of friction.
fn bodies(
    blame: &Blame<'_>,
    spec: &DescribedSpec,
    setup: &ClampedSetup,
) -> Result<(ClampedSetup, Scatter, f64), SynthError> {
    let stated = &spec.truth;
    if stated.slope != 0.0 {
        return Err(blame.value("[truth] slope", stated.slope, "nothing: there is no floor here"));
    }
    let [scatter, of_friction] = truth::scatters(blame, stated)?;
    let mut scatter = Scatter { rng: ChaCha8Rng::seed_from_u64(spec.seed), scatter };
    let link_of = |key: &str, name: &str| {
        let links = setup.description.links.iter().filter(|link| link.is_named).map(|link| link.name.as_str());
        let known = || links.collect::<Vec<_>>().join(", ");
        setup.description.link(name).ok_or_else(|| blame.value(key, format!("\"{name}\""), known()))
    };
    if let MassScale::ByPart(by_part) = &stated.mass_scale {
        for name in by_part.keys() {
            link_of(&format!("[truth] mass_scale.{name}"), name)?;
        }
    }
    let changed = |setup: &ClampedSetup, link: LinkId, change: &BodyChange| {
        setup.with_change(link, change).map_err(|error| SynthError::Described(Box::new(error)))
    };
    let mut true_setup = setup.clone();
    for k in 0..setup.description.links.len() {
        let link = &setup.description.links[k];
        let scale = match &stated.mass_scale {
            MassScale::All(scale) => *scale,
            MassScale::ByPart(by_part) => by_part.get(&link.name).copied().unwrap_or(1.0),
        };
        let key = "[truth] mass_scale";
        let scale = blame.number(key, scale, |x| (0.01..=100.0).contains(&x), "a factor from 0.01 to 100")?;
        let factor = scale * scatter.factor();
        if factor != 1.0 && link.inertia.mass_kg > 0.0 {
            true_setup = changed(&true_setup, LinkId(k), &BodyChange::Mass { factor })?;
        }
    }
    for (k, payload) in stated.payload.iter().enumerate() {
        let key = |name: &str| format!("[[truth.payload]] {} {name}", k + 1);
        let link = match &payload.body {
            Some(name) => link_of(&key("body"), name)?,
            None => tip(setup),
        };
        let right = |x: f64| x > 0.0 && x <= 100.0;
        let mass_kg = blame.number(&key("mass"), payload.mass, right, "a mass above 0, at most 100 kg")?;
        for x in payload.at {
            blame.number(&key("at"), x, |x| x.abs() <= 10.0, "lengths within 10 m of the link's frame")?;
        }
        let place_m = Vector3::from(payload.at);
        true_setup = changed(&true_setup, link, &BodyChange::Payload { mass_kg, place_m })?;
    }
    Ok((true_setup, scatter, of_friction))
}

/// The link that the study calls its tip, or the end of the longest chain.
fn tip(setup: &ClampedSetup) -> LinkId {
    let description = &setup.description;
    let stated = setup.study.tip.as_ref().and_then(|tip| description.link(tip));
    let heavy = (0..description.links.len()).filter(|k| description.links[*k].inertia.mass_kg > 0.0).map(LinkId);
    stated.or_else(|| heavy.max_by_key(|link| description.carriers(*link).len())).unwrap_or(LinkId(0))
}

fn gains(blame: &Blame<'_>, spec: &DescribedSpec, robot: &mut WholeRobot) -> Result<(), SynthError> {
    for (joint, share) in &spec.truth.gain {
        let key = format!("[truth] gain.{joint}");
        let id = robot.model.joint(joint).map_err(|_| blame.value(&key, "no such joint", joint_names(&robot.model)))?;
        let share = blame.number(&key, *share, |x| (0.01..=100.0).contains(&x), "a factor from 0.01 to 100")?;
        if let Some(motor) = &mut robot.joints.drive_mut(id).chain.motor {
            motor.gain = share;
        }
    }
    Ok(())
}

/// What the study calls the description, and the copy beside it; one of several files stays where it is.
pub(super) fn file_of(
    description: &Description,
    path: &Path,
) -> Result<(String, Option<(String, String)>), SynthError> {
    let read = |source| crate::log::LogError::Read { file: path.to_path_buf(), source };
    match path.file_name().filter(|_| description.files.len() < 2) {
        Some(name) => {
            let name = name.to_string_lossy().into_owned();
            let text = std::fs::read_to_string(path).map_err(read)?;
            Ok((name.clone(), Some((name, text))))
        }
        None => {
            let path = std::path::absolute(path).map_err(read)?;
            Ok((path.display().to_string(), None))
        }
    }
}

/// The study: the spec as it is written without what is true, with the logs that were made.
fn study_toml(spec: &DescribedSpec, model: &str, plans: &[(Plan, Setpoints)]) -> String {
    let mut tables = spec.tables.clone();
    for hidden in ["truth", "effect", "log", "seed"] {
        tables.remove(hidden);
    }
    tables.insert("schema".to_owned(), Value::Integer(1));
    if let Some(Value::Table(robot)) = tables.get_mut("robot") {
        robot.insert("model".to_owned(), Value::String(model.to_owned()));
    }
    let sensor = tables.entry("sensor").or_insert_with(|| Value::Table(Table::new()));
    if let Value::Table(sensor) = sensor {
        sensor.entry("period").or_insert(Value::Float(FRAME_S));
    }
    let entry = |((plan, _), log): (&(Plan, Setpoints), &super::LogSpec)| {
        let role = if plan.entry.role == Role::Fit { "fit" } else { "validate" };
        let mut words = vec![("file", plan.entry.file.as_str()), ("role", role), ("drive", "position")];
        words.extend(log.session.as_deref().map(|session| ("session", session)));
        Value::Table(words.into_iter().map(|(key, word)| (key.to_owned(), Value::String(word.to_owned()))).collect())
    };
    tables.insert("log".to_owned(), Value::Array(plans.iter().zip(&spec.logs).map(entry).collect()));
    toml::to_string(&tables).unwrap_or_default()
}
