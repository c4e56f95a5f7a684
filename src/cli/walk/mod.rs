//! `aibo-fit walk`: the walk of Chapter 4.

mod answer;

use super::CliError;
use super::common::{CommonArgs, print, write_outputs};
use super::error::NOT_CONVERGED;
use super::progress::Progress;
use super::provenance::provenance;
use crate::geometry::robot_file::Base;
use crate::integrate::{self, Tolerance};
use crate::log::Outputs;
use crate::report::{walk_figures, walk_html, walk_text};
use crate::robot::simulate::{Control, Joints, Method, PositionSensor, Scenario, Setpoints, log_csv, run as simulate};
use crate::robot::{Gait, Model, State};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Walk in the air: every joint follows the gait's setpoints, the trunk is clamped (C.2)
///
/// Prints how well each leg joint follows its setpoint (amplitude, delay, RMS) and writes report.html, one figure per
/// leg as SVG (Figure C.2) and log.csv (t [s], <joint>.q, <joint>.q_ref [rad], <joint>.tau [N m], base.*, acc.*).
#[derive(Args, Debug)]
#[command(after_help = "Example: aibo-fit walk --air --method stiff --step 0.001")]
pub(super) struct WalkArgs {
    /// Clamp the trunk, so that no foot touches the floor
    #[arg(long, required = true)]
    air: bool,
    /// Setpoints: CSV with t [s] and a column [rad] for each joint [default: the reference trot, 1 Hz]
    #[arg(long, value_name = "FILE.csv")]
    setpoints: Option<PathBuf>,
    /// Frequency of the gait [1/s]
    #[arg(long, value_name = "HZ", default_value_t = 1.0)]
    frequency: f64,
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
    /// Longest step of stiff, rk2 and rk4 [s] [default: 0.001 for stiff, 1e-5 for rk2 and rk4]
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
            MethodArg::Stiff => Method::Stiff { step_s: step(1e-3) },
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
    if !(args.frequency > 0.0 && args.frequency <= FASTEST_HZ) {
        return Err(CliError::Usage(format!(
            "--frequency is {}, expected above 0, at most {FASTEST_HZ} 1/s",
            args.frequency
        )));
    }
    if let Some(period) = args.control_period.filter(|period| !(1e-5..=1.0).contains(period)) {
        return Err(CliError::Usage(format!("--control-period is {period}, expected 1e-5 to 1 s")));
    }
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let read = args.robot.as_deref().map(Model::read).transpose()?;
    let model = read.as_ref().unwrap_or(Model::ers7()).with_base(Base::Clamped);
    let mut joints = Joints::passive(&model);
    joints.set_friction(&model, &args.friction)?;
    let control = Control { sample_period_s: args.control_period, ..Control::default() };
    joints.set_control(&model, &args.gains, control)?;
    let gait = Gait::built_in("trot", &model)?.with_amplitude("air")?.at_frequency(args.frequency);
    let standing = Setpoints::sampled(&gait, &model, gait.stand_s() + gait.walk_s(), answer::PERIOD_S)?;
    let setpoints = match &args.setpoints {
        None => standing,
        Some(file) => {
            let first: Vec<f64> =
                standing.columns.iter().map(|column| column.as_ref().map_or(0.0, |c| c.angle_rad[0])).collect();
            Setpoints::read(&model, file, &first)?
        }
    };
    let (within, clipped) = setpoints.clipped(&model);
    let mut start = State::at_rest(&model);
    for id in model.joint_ids() {
        if joints.drive(id).chain.motor.is_some() {
            start.angle_rad[id.index()] = within.at(id, within.t_s[0]).unwrap_or(0.0);
        }
    }
    progress.say("simulating");
    let scenario = Scenario {
        model: &model,
        joints: &joints,
        setpoints: &within,
        start: &start,
        surroundings: None,
        period_s: model.encoder().map_or(answer::PERIOD_S, |encoder| encoder.period_s),
    };
    let method = args.method();
    let recording = args.common.on_threads(|| simulate(&scenario, method))??;
    progress.say("drawing");
    let sensor = match args.sensor {
        SensorArg::Ideal => PositionSensor::Ideal,
        SensorArg::B1 => PositionSensor::of(&model),
    };
    let inputs: Vec<PathBuf> = args.robot.iter().chain(&args.setpoints).cloned().collect();
    let asked = answer::Asked { args, scenario: &scenario, method, sensor, clipped: &clipped };
    let report = answer::report(&asked, &recording, provenance(inputs.iter().cloned())?);
    let folder = args.common.folder("walk-air");
    let mut outputs = Outputs::default();
    for figure in walk_figures(&report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    let page = folder.join("report.html");
    outputs.add(&page, walk_html(&report)?);
    outputs.add(folder.join("log.csv"), log_csv(&model, &joints, &recording, sensor, args.seed));
    args.common.add_json(&mut outputs, &report)?;
    write_outputs(outputs, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        print(&walk_text(&report));
        print(&format!("\nreport: {}\n", page.display()));
    }
    Ok(if recording.diverged.is_some() { NOT_CONVERGED } else { 0 })
}
