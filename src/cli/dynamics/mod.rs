//! `aibo-fit dynamics`: the equations of motion of a robot at given states.

mod answer;
mod described;
mod read;

use super::CliError;
use super::common::{CommonArgs, log_name, print, write_outputs};
use super::progress::Progress;
use super::provenance::provenance;
use crate::geometry::robot_file::Base;
use crate::log::Outputs;
use crate::robot::description::Format;
use crate::robot::{Dynamics, Input, Model};
use answer::{Answers, StateAnswer, Timing, answer};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::PathBuf;

/// Forward dynamics, mass matrix, bias and energies of a robot at given states
///
/// STATES.json holds `{"states": [...]}`, or just the list; each state has base_pos [m], base_quat_wxyz (body to world),
/// base_vel_world [m/s], base_omega_body [rad/s], q [rad], dq [rad/s] and tau [N m], the last three in joint order. An
/// `out` that is there already is ignored, so a file of answers can be asked again. A robot with a clamped base needs no
/// base keys. Axes: x right, y up, z to the rear; v = [base velocity, world axes; base rate, body axes; joint rates];
/// M qacc + bias = [0; tau].
///
/// --robot also takes a URDF or an MJCF file (told by its content; what it includes is read along, meshes are not needed).
/// Then q, dq and tau are objects by joint name, axes are the file's, and vectors have six base rows only where the base is
/// free: as `base` beside `states` says, or --base, or the MJCF itself. What is not supported is refused by its name; what
/// looks like a mistake is a warning.
#[derive(Args, Debug)]
#[command(after_help = "Example: aibo-fit dynamics data/examples/states.json --json out.json --repeat 1000\n\
Example: aibo-fit dynamics data/examples/robots/arm-states.json --robot data/examples/robots/arm.urdf")]
pub(super) struct DynamicsArgs {
    /// The states
    #[arg(value_name = "STATES.json")]
    states: PathBuf,
    /// A robot: URDF, MJCF, or the format of data/ers7.toml [default: the embedded ERS-7]
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// How its base is held [default: as the states or the robot's file say; a URDF does not: fixed]
    #[arg(long, value_name = "HOW", value_enum)]
    base: Option<HeldBase>,
    /// Also measure the time of one forward-dynamics evaluation [us]: the median of so many goes over the states
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    repeat: Option<u32>,
    #[command(flatten)]
    common: CommonArgs,
}

/// How a base is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum HeldBase {
    /// Not moving.
    Fixed,
    /// Free in space.
    Free,
}

/// Runs the command.
pub(super) fn run(args: &DynamicsArgs) -> Result<u8, CliError> {
    if let Some(robot) = &args.robot
        && Format::of_file(robot)? != Format::Toml
    {
        return described::run(args, robot);
    }
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let read_model = args.robot.as_deref().map(Model::read).transpose()?;
    let held_model = args.base.map(|base| {
        let base = if base == HeldBase::Free { Base::Floating } else { Base::Clamped };
        read_model.as_ref().unwrap_or(Model::ers7()).with_base(base)
    });
    let model = held_model.as_ref().or(read_model.as_ref()).unwrap_or(Model::ers7());
    let asked = read::states(&args.states, model)?;
    progress.say("evaluating");
    let mut dynamics = Dynamics::new(model);
    let mut states = Vec::with_capacity(asked.len());
    for (index, one) in asked.iter().enumerate() {
        let found = answer(&mut dynamics, one)
            .ok_or_else(|| CliError::NotFinite { file: args.states.clone(), what: format!("states[{index}]") })?;
        states.push(found);
    }
    let mut acceleration = vec![0.0; dynamics.freedoms()];
    let timing = args.repeat.map(|goes| {
        Timing::of(goes, &asked, |one| {
            dynamics.forward(black_box(&one.state), &Input::torques(black_box(&one.torque_nm)), &mut acceleration);
            black_box(&acceleration);
        })
    });
    let inputs: Vec<PathBuf> = std::iter::once(&args.states).chain(&args.robot).cloned().collect();
    let answers = Answers::new(model, states, timing, &provenance(inputs.iter().cloned())?);
    write(args, &answers, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        if args.common.json.is_none() {
            print(&table(model, &answers.states));
        }
        answers.timing.iter().for_each(Timing::print);
    }
    Ok(0)
}

/// Writes the answers where they are asked for.
fn write(args: &DynamicsArgs, answers: &impl Serialize, inputs: &[PathBuf]) -> Result<(), CliError> {
    let mut outputs = Outputs::default();
    // One line: thousands of numbers on lines of their own help nobody.
    let text = serde_json::to_string(answers).map_err(|error| CliError::Encode(error.to_string()))? + "\n";
    let folder = args.common.out.as_ref();
    let in_folder = folder.map(|folder| folder.join(format!("{}.dynamics.json", log_name(&args.states))));
    for path in args.common.json.iter().chain(&in_folder) {
        outputs.add(path, text.clone());
    }
    write_outputs(outputs, inputs)
}

/// One row for each state.
fn table(model: &Model, states: &[StateAnswer]) -> String {
    let mut text = format!("{}: {} bodies, {} joints\n\n", model.name(), model.bodies().len(), model.joints().len());
    let _ = writeln!(
        text,
        "{:>5} {:>13} {:>13} {:>13} {:>13}  largest joint acceleration",
        "state", "base [m/s^2]", "com y [m]", "kinetic [J]", "potential [J]"
    );
    for (index, state) in states.iter().enumerate() {
        let out = &state.out;
        let base = out.qacc[..3].iter().map(|x| x * x).sum::<f64>().sqrt();
        let joints = out.qacc[6..].iter().zip(model.joints());
        let largest = joints.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let largest = largest.map_or_else(String::new, |(x, joint)| format!("{} {x:.4e} rad/s^2", joint.name));
        let _ = writeln!(
            text,
            "{index:>5} {base:>13.6} {:>13.6} {:>13.6} {:>13.6}  {largest}",
            out.com[1], out.kinetic_energy, out.potential_energy
        );
    }
    text
}
