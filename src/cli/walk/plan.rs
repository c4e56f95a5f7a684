//! What is asked of the joints: a gait, a motion file, or a table.

use super::super::CliError;
use super::WalkArgs;
use crate::geometry::Joint;
use crate::geometry::robot_file::FRAME_S;
use crate::robot::simulate::Setpoints;
use crate::robot::{Body, Gait, JointId, Model, Motion, Setpoints as Source};
use std::path::{Path, PathBuf};

/// Setpoints and what is known of them.
pub(super) struct Plan {
    pub name: String,
    pub setpoints: Setpoints,
    /// The same as a motion of frames.
    pub motion: Motion,
    pub frequency_hz: f64,
    /// The walk begins then [s].
    pub stand_s: f64,
    /// The gait's or motion's file.
    pub file: Option<PathBuf>,
}

/// A table stands so long before it walks [s]; motions too.
const STAND_S: f64 = 2.0;

/// The gait of a walk that does not say.
const DEFAULT: &str = "trot";

/// The gait that was asked for, or the default, at the frequency that was asked for.
pub(super) fn gait_of(args: &WalkArgs, default: &str, model: &Model) -> Result<Gait, CliError> {
    let gait = match args.gait_file() {
        Some(file) => Gait::read(&file, model)?,
        None if model.bodies().iter().all(Body::is_ellipsoid) => {
            Gait::built_in(args.gait.as_deref().unwrap_or(default), model)
                .map_err(|error| CliError::Usage(error.to_string()))?
        }
        None => {
            let what = "gaits that are built in have joints of the ERS-7; say what this robot does by --gait FILE.toml or \
                        --setpoints FILE.csv";
            return Err(CliError::Usage(format!("{}: {what}", model.name())));
        }
    };
    Ok(args.frequency.map_or(gait.clone(), |hz| gait.at_frequency(hz)))
}

impl Plan {
    pub fn of(args: &WalkArgs, model: &Model) -> Result<Self, CliError> {
        let frame = |source: &dyn Fn(JointId, f64) -> f64, end_s: f64| {
            let source = By { joints: model.joints().len(), angle_rad: source };
            let table = Setpoints::sampled(&source, model, end_s, FRAME_S)?;
            Ok::<_, CliError>((table, Motion::of(&source, model, Motion::FRAME_MS, end_s)))
        };
        let file = args.gait_file();
        let asked = args.gait.as_deref().unwrap_or(DEFAULT);
        let name = args.setpoints.as_ref().or(file.as_ref()).map_or(asked.to_owned(), |file| named(file));
        if let Some(path) = file.as_ref().filter(|path| path.extension().is_some_and(|end| end == "mot")) {
            let motion = Motion::read(path, model)?;
            let end_s = args.duration.unwrap_or(motion.end_s());
            let (setpoints, motion) = frame(&|joint, t_s| motion.angle_rad(joint, t_s), end_s)?;
            let frequency_hz = args.frequency.unwrap_or(1.0);
            return Ok(Self { name, setpoints, motion, frequency_hz, stand_s: STAND_S.min(0.5 * end_s), file });
        }
        let mut gait = match (gait_of(args, DEFAULT, model), &args.setpoints) {
            // The default gait is for legs; a table needs none.
            (Err(_), Some(table)) if args.gait.is_none() => return Self::of_table(args, model, table, name),
            (gait, _) => gait?,
        };
        if args.air && gait.amplitudes().iter().any(|set| set == "air") {
            gait = gait.with_amplitude("air")?;
        }
        let end_s = args.duration.unwrap_or(gait.stand_s() + gait.walk_s());
        let (setpoints, motion) = frame(&|joint, t_s| gait.angle_rad(joint, t_s), end_s)?;
        let plan = Self {
            name,
            setpoints,
            motion,
            frequency_hz: 1.0 / gait.period_s(),
            stand_s: gait.stand_s().min(0.5 * end_s),
            file,
        };
        let Some(table) = &args.setpoints else { return Ok(plan) };
        let first: Vec<f64> =
            plan.setpoints.columns.iter().map(|column| column.as_ref().map_or(0.0, |c| c.angle_rad[0])).collect();
        let setpoints = Setpoints::read(model, table, &first)?;
        let stand_s = standing_s(&setpoints);
        Ok(Self { setpoints, frequency_hz: args.frequency.unwrap_or(1.0), stand_s, ..plan })
    }

    /// A table alone; joints that it does not have stay at rest.
    fn of_table(args: &WalkArgs, model: &Model, table: &Path, name: String) -> Result<Self, CliError> {
        let resting: Vec<f64> = model.joints().iter().map(Joint::resting_rad).collect();
        let setpoints = Setpoints::read(model, table, &resting)?;
        let at = |joint: JointId, t_s: f64| setpoints.at(joint, t_s).unwrap_or(resting[joint.index()]);
        let source = By { joints: resting.len(), angle_rad: &at };
        let motion = Motion::of(&source, model, Motion::FRAME_MS, setpoints.t_s[setpoints.t_s.len() - 1]);
        let (frequency_hz, stand_s) = (args.frequency.unwrap_or(1.0), standing_s(&setpoints));
        Ok(Self { name, motion, frequency_hz, stand_s, file: None, setpoints })
    }
}

/// When a table begins to walk.
fn standing_s(setpoints: &Setpoints) -> f64 {
    let (from_s, to_s) = (setpoints.t_s[0], setpoints.t_s[setpoints.t_s.len() - 1]);
    from_s + STAND_S.min(0.5 * (to_s - from_s))
}

/// Setpoints by a formula.
struct By<'a> {
    joints: usize,
    angle_rad: &'a dyn Fn(JointId, f64) -> f64,
}

impl Source for By<'_> {
    fn joints(&self) -> usize {
        self.joints
    }

    fn angle_rad(&self, joint: JointId, t_s: f64) -> f64 {
        (self.angle_rad)(joint, t_s)
    }
}

fn named(file: &Path) -> String {
    file.file_stem().map_or_else(|| "setpoints".to_owned(), |name| name.to_string_lossy().into_owned())
}
