//! `aibo-fit walk`: the walk of Chapter 4.

mod answer;
mod converge;
mod described;
mod falls;
mod film;
mod frames;
mod ground;
mod integrators;
mod plan;
mod setting;
mod study;
mod weak;

use super::CliError;
use super::common::{CommonArgs, file_to_write, log_name, print, refuse_clashes, write_outputs};
use super::progress::Progress;
use super::provenance::provenance;
use crate::geometry::robot_file::{Base, FRICTION_SET, GAIN_SET};
use crate::integrate::{self, Tolerance};
use crate::log::Outputs;
use crate::report::{walk_figures, walk_html, walk_text};
use crate::robot::simulate::{Method, PositionSensor, log_csv, run as simulate};
use crate::robot::{Model, Motion};
use clap::{Args, ValueEnum};
use described::DescribedArgs;
use ground::GroundArgs;
use plan::Plan;
use setting::Setting;
use std::path::PathBuf;
use std::time::Instant;

/// The walk of Chapter 4: dropped from 0.02 m, two seconds to settle, then eight seconds of trot
///
/// Prints how far the trunk went and how well each joint follows its setpoint (amplitude, delay, RMS). Writes
/// report.html, the trunk's displacement (Figure 4.5) and one figure per leg (Figure 4.6; C.2 in the air) as SVG,
/// animation.html and walk.gif (Figure 4.4), and log.csv (t [s], <joint>.q, <joint>.q_ref [rad], <joint>.tau [N m],
/// base.* [m, rad], acc.* [m/s^2]).
#[derive(Args, Debug)]
#[command(after_help = "Example: aibo-fit walk --gait trot --slope 0.05")]
pub(super) struct WalkArgs {
    /// Clamp the trunk, so that no foot touches the floor (C.2); gaits take their amplitudes for the air
    #[arg(long, conflicts_with_all = ["slope", "floor", "touch"])]
    air: bool,
    /// A gait that is built in (trot, trot-2hz, crawl, pace, turn-left, sideways-right, fall, topple), a gait's file (.toml), or
    /// a motion file of Tekkotsu (.mot) [default: trot; topple for --falls]
    #[arg(long, value_name = "NAME|FILE")]
    gait: Option<String>,
    /// Setpoints: CSV with t [s] and a column [rad] for each joint [default: the gait's]
    #[arg(long, value_name = "FILE.csv")]
    setpoints: Option<PathBuf>,
    /// Frequency of the gait [1/s] [default: the gait's own, 1 for setpoints]
    #[arg(long, value_name = "HZ")]
    frequency: Option<f64>,
    /// Simulated time, standing included [s] [default: the gait's own]
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    #[command(flatten)]
    ground: GroundArgs,
    /// Write the gait as a motion file of Tekkotsu, with frames of 128 ms
    #[arg(long, value_name = "FILE.mot", value_parser = file_to_write())]
    export_motion: Option<PathBuf>,
    /// Print displacement and cost for steps from 1e-3 to 1e-5 s first (stiff method)
    #[arg(long, conflicts_with = "air")]
    converge: bool,
    /// Repeat Table 4.1 on the reference walk instead: every method and step of the thesis, each row judged; "all" also
    /// runs Runge-Kutta 4 with 1e-6 s, which takes minutes. Rows run on all threads at once
    #[arg(long, value_enum, value_name = "WHICH", num_args = 0..=1, require_equals = true,
        default_missing_value = "quick",
        conflicts_with_all = ["air", "gait", "setpoints", "frequency", "slope", "floor", "touch", "converge", "export_motion"])]
    integrators: Option<IntegratorsArg>,
    /// Section C.3 instead: a gait of 2 Hz with setpoints every 8, 96 and 128 ms
    #[arg(long, conflicts_with_all = ["air", "setpoints", "integrators", "converge", "export_motion"])]
    frames: bool,
    /// Section 5.2 instead: when a gait falls, and how that time moves with each parameter by 10 %
    #[arg(long, conflicts_with_all = ["air", "setpoints", "frequency", "integrators", "frames", "converge", "export_motion"])]
    falls: bool,
    /// Chapter 4's open question instead: why could the real q2 joints not follow? Five explanations, each made into a
    /// "real" robot and diagnosed from its log without being told, on the floor and in the air
    #[arg(long, conflicts_with_all = ["air", "robot", "setpoints", "frequency", "integrators", "frames", "falls", "converge", "export_motion"])]
    weak_q2: bool,
    /// A robot: the format of data/ers7.toml, or a URDF or MJCF with revolute joints, whose friction, armature, gains and feet
    /// are taken (with --air an arm) [default: the embedded ERS-7]
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    #[command(flatten)]
    described: DescribedArgs,
    /// Friction set of the robot's file
    #[arg(long, value_name = "NAME", default_value = FRICTION_SET)]
    friction: String,
    /// Gain set of the robot's file
    #[arg(long, value_name = "NAME", default_value = GAIN_SET)]
    gains: String,
    /// Evaluate the control laws only every so often and hold their torques, 0.008 being the robot's frames [s]
    /// [default: continuously]
    #[arg(long, value_name = "S")]
    control_period: Option<f64>,
    /// How to integrate
    #[arg(long, value_enum, default_value_t = MethodArg::Stiff)]
    method: MethodArg,
    /// Longest step of stiff, rk2 and rk4 [s] [default: 0.0005 for stiff, 0.001 in the air,
    /// 0.0002 for more than a minute, 0.0001 for --falls, 1e-5 for rk2 and rk4]
    #[arg(long, value_name = "S")]
    step: Option<f64>,
    /// Tolerance of dormand-prince, adams and bdf [rad, rad/s, and relative]
    #[arg(long, value_name = "X", default_value_t = 1e-6)]
    tolerance: f64,
    /// What the log's angles are
    #[arg(long, value_enum, default_value_t = SensorArg::Ideal)]
    sensor: SensorArg,
    /// Seed of the sensors' noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    common: CommonArgs,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MethodArg {
    /// The project's own: implicit where joints are stiff, with true sticking
    Stiff,
    /// Runge-Kutta 2
    Rk2,
    /// Runge-Kutta 4
    Rk4,
    /// Dormand-Prince 5(4), step by tolerance
    DormandPrince,
    /// Adams, orders 1 to 12
    Adams,
    /// Backward differentiation, orders 1 to 5
    Bdf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum IntegratorsArg {
    /// All rows but those that take minutes
    Quick,
    /// All rows
    All,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SensorArg {
    /// The angle itself
    Ideal,
    /// Steps of 0.006 rad, never below the angle (section B.1)
    B1,
}

impl WalkArgs {
    /// The output folder: as asked for, or `fits/<name>`, with the robot's name where it is not the ERS-7.
    fn folder(&self, name: &str) -> PathBuf {
        let of_robot = |robot: &PathBuf| format!("{name}-{}", log_name(robot));
        self.common.folder(&self.robot.as_ref().map_or_else(|| name.to_owned(), of_robot))
    }

    /// The gait's file, where it is one.
    fn gait_file(&self) -> Option<PathBuf> {
        self.gait.as_ref().filter(|name| name.contains(['.', '/', '\\'])).map(PathBuf::from)
    }

    /// Files that are read.
    fn inputs(&self) -> Vec<PathBuf> {
        self.robot.iter().chain(&self.setpoints).cloned().chain(self.gait_file()).collect()
    }

    /// Files that are written whatever comes out, figures apart.
    fn results(&self) -> Vec<PathBuf> {
        let studies = [
            (self.integrators.is_some(), "walk-integrators"),
            (self.frames, "walk-frames"),
            (self.falls, "walk-falls"),
            (self.weak_q2, "walk-weak-q2"),
        ];
        let study = studies.into_iter().find_map(|(is_asked, name)| is_asked.then_some(name));
        let (name, files) = match study {
            Some(name) => (name, OF_STUDIES),
            None => (if self.air { "walk-air" } else { "walk" }, OF_WALKS),
        };
        let folder = self.folder(name);
        let named = self.common.json.iter().chain(&self.export_motion).cloned();
        files.iter().map(|file| folder.join(file)).chain(named).collect()
    }

    fn method(&self) -> Method {
        let is_long = self.duration.is_some_and(|duration_s| duration_s > LONG_S);
        self.method_by(match (self.air, is_long) {
            (true, _) => 1e-3,
            (false, true) => 2e-4,
            (false, false) => 5e-4,
        })
    }

    /// With another step of the stiff method where none was asked for [s].
    fn method_by(&self, stiff_s: f64) -> Method {
        let (step, tolerance) = (|default: f64| self.step.unwrap_or(default), Tolerance::of(self.tolerance));
        match self.method {
            MethodArg::Stiff => Method::Stiff { step_s: step(stiff_s) },
            MethodArg::Rk2 => Method::Smooth(integrate::Method::Rk2 { step_s: step(1e-5) }),
            MethodArg::Rk4 => Method::Smooth(integrate::Method::Rk4 { step_s: step(1e-5) }),
            MethodArg::DormandPrince => Method::Smooth(integrate::Method::DormandPrince(tolerance)),
            MethodArg::Adams => Method::Smooth(integrate::Method::Adams(tolerance)),
            MethodArg::Bdf => Method::Smooth(integrate::Method::Bdf(tolerance)),
        }
    }
}

/// A walk that is longer takes shorter steps: what they leave of error turns the heading a little with every cycle [s].
const LONG_S: f64 = 60.0;

/// Files of a walk, and of a study of walks, whatever figures go with them.
const OF_WALKS: &[&str] = &["report.html", "animation.html", "walk.gif", "log.csv"];
const OF_STUDIES: &[&str] = &["report.html"];

/// Steps per second beyond which no leg of this size walks [1/s].
const FASTEST_HZ: f64 = 50.0;

/// Runs the command.
pub(super) fn run(args: &WalkArgs) -> Result<u8, CliError> {
    if let Some(hz) = args.frequency.filter(|hz| !(*hz > 0.0 && *hz <= FASTEST_HZ)) {
        return Err(CliError::Usage(format!("--frequency is {hz}, expected above 0, at most {FASTEST_HZ} 1/s")));
    }
    if let Some(period) = args.control_period.filter(|period| !(1e-5..=1.0).contains(period)) {
        return Err(CliError::Usage(format!("--control-period is {period}, expected 1e-5 to 1 s")));
    }
    if args.step.is_some() && matches!(args.method, MethodArg::DormandPrince | MethodArg::Adams | MethodArg::Bdf) {
        let why = "--step is for stiff, rk2 and rk4; this --method chooses its own steps, by --tolerance";
        return Err(CliError::Usage(why.to_owned()));
    }
    refuse_clashes(&args.results(), &args.inputs())?;
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let read = args.robot.as_deref().map(|file| described::read(file, &args.described, args.air)).transpose()?;
    let robot = read.as_ref().unwrap_or(Model::ers7());
    let model = if args.air { robot.with_base(Base::Clamped) } else { robot.with_base(Base::Floating) };
    if args.export_motion.is_some() && !Motion::has_outputs_of(&model) {
        let why = "--export-motion: such files move joints of the ERS-7 alone, and this robot has none of them";
        return Err(CliError::Usage(why.to_owned()));
    }
    if let Some(which) = args.integrators {
        return integrators::run(args, &model, which);
    }
    if args.frames {
        return frames::run(args, &model);
    }
    if args.weak_q2 {
        return weak::run(args);
    }
    if args.falls {
        return falls::run(args, &model);
    }
    let floor = if args.air { None } else { Some(args.ground.floor(&model)?) };
    let plan = Plan::of(args, &model)?;
    let setting = Setting::new(model.clone(), study::joints(args, &model)?, &plan.setpoints, floor);
    let (model, joints, floor) = (&setting.model, &setting.joints, setting.floor.as_ref());
    progress.say("simulating");
    let scenario = setting.scenario();
    if let Some(floor) = floor.filter(|_| args.converge && !args.common.quiet) {
        converge::print_table(&scenario, floor, plan.stand_s)?;
    }
    let method = args.method();
    let clock = Instant::now();
    let recording = args.common.on_threads(|| simulate(&scenario, method))??;
    let wall_s = clock.elapsed().as_secs_f64();
    progress.say("drawing");
    let sensor = match args.sensor {
        SensorArg::Ideal => PositionSensor::Ideal,
        SensorArg::B1 => PositionSensor::of(model),
    };
    let inputs: Vec<PathBuf> = args.robot.iter().chain(&args.setpoints).chain(&plan.file).cloned().collect();
    let asked = answer::Asked {
        args,
        scenario: &scenario,
        method,
        sensor,
        clipped: &setting.clipped,
        plan: &plan,
        floor,
        wall_s,
    };
    let mut report = answer::report(&asked, &recording, provenance(inputs.iter().cloned())?);
    let film = film::Film::of(model, &recording, (&report.title(), &report.sentence, 1.0 / plan.frequency_hz));
    report.cycle = film.cycle()?;
    let folder = args.folder(if args.air { "walk-air" } else { "walk" });
    let mut outputs = Outputs::default();
    for figure in walk_figures(&report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    let page = folder.join("report.html");
    outputs.add_page(&page, walk_html(&report)?);
    film.add(&mut outputs, &folder)?;
    outputs.add(folder.join("log.csv"), log_csv(model, joints, &recording, sensor, args.seed));
    if let Some(path) = &args.export_motion {
        outputs.add_apart(path, plan.motion.to_text(model));
    }
    args.common.add_json(&mut outputs, &report)?;
    write_outputs(outputs, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        print(&walk_text(&report));
        print(&format!("\nreport: {}\n", page.display()));
    }
    recording.diverged.map_or(Ok(0), |diverged| Err(CliError::RanAway(Box::new(diverged))))
}
