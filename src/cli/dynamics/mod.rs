//! `aibo-fit dynamics`: the equations of motion of a robot at given states.

mod answer;
mod read;

use super::CliError;
use super::common::{CommonArgs, log_name, print, write_outputs};
use super::progress::Progress;
use super::provenance::provenance;
use crate::log::Outputs;
use crate::robot::{Dynamics, Input, Model};
use answer::{Answers, StateAnswer, Timing, answer};
use clap::Args;
use read::Asked;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

/// Forward dynamics, mass matrix, bias and energies of a robot at given states
///
/// STATES.json holds `{"states": [...]}`, or just the list; each state has base_pos [m], base_quat_wxyz (body to world),
/// base_vel_world [m/s], base_omega_body [rad/s], q [rad], dq [rad/s] and tau [N m], the last three in joint order. An
/// `out` that is there already is ignored, so a file of answers can be asked again. A robot with a clamped base needs no
/// base keys. Axes: x right, y up, z to the rear; v = [base velocity, world axes; base rate, body axes; joint rates];
/// M qacc + bias = [0; tau].
#[derive(Args, Debug)]
#[command(after_help = "Example: aibo-fit dynamics data/examples/states.json --json out.json --repeat 1000")]
pub(super) struct DynamicsArgs {
    /// The states
    #[arg(value_name = "STATES.json")]
    states: PathBuf,
    /// A robot in the format of data/ers7.toml [default: the embedded ERS-7]
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// Also measure the time of one forward-dynamics evaluation [us]: the median of so many goes over the states
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    repeat: Option<u32>,
    #[command(flatten)]
    common: CommonArgs,
}

/// A go takes at least so many evaluations, so that the clock's own time does not count.
const EVALUATIONS: usize = 16;

/// Runs the command.
pub(super) fn run(args: &DynamicsArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let read_model = args.robot.as_deref().map(Model::read).transpose()?;
    let model = read_model.as_ref().unwrap_or(Model::ers7());
    let asked = read::states(&args.states, model)?;
    progress.say("evaluating");
    let mut dynamics = Dynamics::new(model);
    let mut states = Vec::with_capacity(asked.len());
    for (index, one) in asked.iter().enumerate() {
        let found = answer(&mut dynamics, one)
            .ok_or_else(|| CliError::NotFinite { file: args.states.clone(), what: format!("states[{index}]") })?;
        states.push(found);
    }
    let timing = args.repeat.map(|goes| timing(&mut dynamics, &asked, goes));
    let inputs: Vec<PathBuf> = std::iter::once(&args.states).chain(&args.robot).cloned().collect();
    let answers = Answers::new(model, states, timing, &provenance(inputs.iter().cloned())?);
    let mut outputs = Outputs::default();
    // One line: thousands of numbers on lines of their own help nobody.
    let text = serde_json::to_string(&answers).map_err(|error| CliError::Encode(error.to_string()))? + "\n";
    let folder = args.common.out.as_ref();
    let in_folder = folder.map(|folder| folder.join(format!("{}.dynamics.json", log_name(&args.states))));
    for path in args.common.json.iter().chain(&in_folder) {
        outputs.add(path, text.clone());
    }
    write_outputs(outputs, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        if args.common.json.is_none() {
            print(&table(model, &answers.states));
        }
        if let Some(timing) = &answers.timing {
            print(&format!(
                "forward dynamics: {:.3} us (median of {} goes over the states)\n",
                timing.median_us, timing.goes
            ));
        }
    }
    Ok(0)
}

/// Median time of one evaluation.
fn timing(dynamics: &mut Dynamics<'_>, asked: &[Asked], goes: u32) -> Timing {
    let rounds = EVALUATIONS.div_ceil(asked.len());
    let mut acceleration = vec![0.0; dynamics.freedoms()];
    let mut go = || {
        let start = Instant::now();
        for _ in 0..rounds {
            for one in asked {
                dynamics.forward(black_box(&one.state), &Input::torques(black_box(&one.torque_nm)), &mut acceleration);
                black_box(&acceleration);
            }
        }
        1e6 * start.elapsed().as_secs_f64() / (rounds * asked.len()) as f64
    };
    let mut times_us: Vec<f64> = (0..goes).map(|_| go()).collect();
    times_us.sort_by(f64::total_cmp);
    Timing { median_us: times_us[times_us.len() / 2], goes }
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
