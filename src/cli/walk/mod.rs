//! `aibo-fit walk`: the walk of Chapter 4.

mod answer;
mod converge;
mod film;
mod ground;
mod plan;

use super::CliError;
use super::common::{CommonArgs, print, write_outputs};
use super::error::NOT_CONVERGED;
use super::progress::Progress;
use super::provenance::provenance;
use crate::geometry::robot_file::Base;
use crate::integrate::{self, Tolerance};
use crate::log::Outputs;
use crate::report::{walk_figures, walk_html, walk_text};
use crate::robot::simulate::{
    Control, Joints, Method, PositionSensor, Scenario, Surroundings, log_csv, run as simulate,
};
use crate::robot::{Model, State};
use clap::{Args, ValueEnum};
use ground::GroundArgs;
use plan::Plan;
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
    #[arg(long)]
    air: bool,
    /// A gait that is built in (trot, trot-2hz, crawl, pace, turn-left, sideways-right, fall), a gait's file (.toml), or
    /// a motion file of Tekkotsu (.mot)
    #[arg(long, value_name = "NAME|FILE", default_value = "trot")]
    gait: String,
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
    #[arg(long, value_name = "FILE.mot")]
    export_motion: Option<PathBuf>,
    /// Print displacement and cost for steps from 1e-3 to 1e-5 s first (stiff method)
    #[arg(long, conflicts_with = "air")]
    converge: bool,
    /// A robot in the format of data/ers7.toml [default: the embedded ERS-7]
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// Friction set of the robot's file
    #[arg(long, value_name = "NAME", default_value = "chosen")]
    friction: String,
    /// Gain set of the robot's file
    #[arg(long, value_name = "NAME", default_value = "printed")]
    gains: String,
    /// Evaluate the control laws only every so often and hold their torques, 0.008 being the robot's frames [s]
    /// [default: continuously]
    #[arg(long, value_name = "S")]
    control_period: Option<f64>,
    /// How to integrate
    #[arg(long, value_enum, default_value_t = MethodArg::Stiff)]
    method: MethodArg,
    /// Longest step of stiff, rk2 and rk4 [s] [default: 0.0005 for stiff, 0.001 in the air, 1e-5 for rk2 and rk4]
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

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SensorArg {
    /// The angle itself
    Ideal,
    /// Steps of 0.006 rad, never below the angle (section B.1)
    B1,
}

impl WalkArgs {
    fn method(&self) -> Method {
        let (step, tolerance) = (|default: f64| self.step.unwrap_or(default), Tolerance::of(self.tolerance));
        match self.method {
            MethodArg::Stiff => Method::Stiff { step_s: step(if self.air { 1e-3 } else { 5e-4 }) },
            MethodArg::Rk2 => Method::Smooth(integrate::Method::Rk2 { step_s: step(1e-5) }),
            MethodArg::Rk4 => Method::Smooth(integrate::Method::Rk4 { step_s: step(1e-5) }),
            MethodArg::DormandPrince => Method::Smooth(integrate::Method::DormandPrince(tolerance)),
            MethodArg::Adams => Method::Smooth(integrate::Method::Adams(tolerance)),
            MethodArg::Bdf => Method::Smooth(integrate::Method::Bdf(tolerance)),
        }
    }
}

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
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let read = args.robot.as_deref().map(Model::read).transpose()?;
    let robot = read.as_ref().unwrap_or(Model::ers7());
    let model = if args.air { robot.with_base(Base::Clamped) } else { robot.with_base(Base::Floating) };
    let mut joints = Joints::passive(&model);
    joints.set_friction(&model, &args.friction)?;
    let control = Control { sample_period_s: args.control_period, ..Control::default() };
    joints.set_control(&model, &args.gains, control)?;
    joints.add_effects_of_file(&model)?;
    let plan = Plan::of(args, &model)?;
    let (within, clipped) = plan.setpoints.clipped(&model);
    let mut start = State::at_rest(&model);
    for id in model.joint_ids() {
        if joints.drive(id).chain.motor.is_some() {
            start.angle_rad[id.index()] = within.at(id, within.t_s[0]).unwrap_or(0.0);
        }
    }
    let floor = if args.air { None } else { Some(args.ground.floor(&model)?) };
    if let Some(floor) = &floor {
        ground::lift(floor, &model, &mut start);
    }
    progress.say("simulating");
    let scenario = Scenario {
        model: &model,
        joints: &joints,
        setpoints: &within,
        start: &start,
        surroundings: floor.as_ref().map(|floor| floor as &dyn Surroundings),
        period_s: model.encoder().map_or(answer::PERIOD_S, |encoder| encoder.period_s),
    };
    if let Some(floor) = floor.as_ref().filter(|_| args.converge && !args.common.quiet) {
        converge::print_table(&scenario, floor, plan.stand_s)?;
    }
    let method = args.method();
    let clock = Instant::now();
    let recording = args.common.on_threads(|| simulate(&scenario, method))??;
    let wall_s = clock.elapsed().as_secs_f64();
    progress.say("drawing");
    let sensor = match args.sensor {
        SensorArg::Ideal => PositionSensor::Ideal,
        SensorArg::B1 => PositionSensor::of(&model),
    };
    let inputs: Vec<PathBuf> = args.robot.iter().chain(&args.setpoints).chain(&plan.file).cloned().collect();
    let floor = floor.as_ref();
    let asked =
        answer::Asked { args, scenario: &scenario, method, sensor, clipped: &clipped, plan: &plan, floor, wall_s };
    let report = answer::report(&asked, &recording, provenance(inputs.iter().cloned())?);
    let folder = args.common.folder(if args.air { "walk-air" } else { "walk" });
    let mut outputs = Outputs::default();
    for figure in walk_figures(&report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    let page = folder.join("report.html");
    outputs.add(&page, walk_html(&report)?);
    film::add(&mut outputs, &folder, &model, &recording, (&report.title(), &report.sentence, 1.0 / plan.frequency_hz))?;
    outputs.add(folder.join("log.csv"), log_csv(&model, &joints, &recording, sensor, args.seed));
    if let Some(path) = &args.export_motion {
        outputs.add(path, plan.motion.to_text(&model));
    }
    args.common.add_json(&mut outputs, &report)?;
    write_outputs(outputs, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        print(&walk_text(&report));
        print(&format!("\nreport: {}\n", page.display()));
    }
    Ok(if recording.diverged.is_some() { NOT_CONVERGED } else { 0 })
}
