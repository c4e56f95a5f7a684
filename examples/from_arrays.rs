//! Diagnoses a joint from arrays, with nothing of the program: `cargo run --release --no-default-features --example
//! from_arrays`. What an own recorder has at hand stands here in `recorded`.

use aibo_fit::gap::{GapOptions, diagnose};
use aibo_fit::identify::Case;
use aibo_fit::log::{ArrayLog, DriveMode, JointSpec, MotorSpec, Nominal, SensorSpec, Uncertain};
use aibo_fit::progress::Step;
use std::error::Error;

/// Stamps \[s\], readings \[rad\] and setpoints \[rad\] of a servo with a pendulum.
fn recorded() -> Result<[Vec<f64>; 3], Box<dyn Error>> {
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    for row in include_str!("../data/examples/delay/chirp-0.csv").lines().skip(1) {
        for (column, cell) in columns.iter_mut().zip(row.split(',')) {
            column.push(cell.parse()?);
        }
    }
    Ok(columns)
}

fn main() -> Result<(), Box<dyn Error>> {
    let [t_s, q_rad, q_ref_rad] = recorded()?;
    let log = ArrayLog { q_ref_rad: Some(q_ref_rad), drive: DriveMode::Position, ..ArrayLog::new("chirp", t_s, q_rad) };
    // What is believed of the joint, its encoder and its servo.
    let nominal = Nominal { inertia_kg_m2: 0.011, moment_kg_m: 0.05, coulomb_nm: 0.02, viscous_nm_s_rad: 0.03 };
    let joint = JointSpec { name: "pendulum".into(), nominal: Some(nominal), gravity_m_s2: 9.81, rest_rad: Some(0.0) };
    let sensor = SensorSpec { resolution_rad: Some(0.006), period_s: Some(0.008) };
    let motor = MotorSpec::pd(8.0, 0.15);

    let case = Case::of_arrays(joint, sensor, Some(motor), Uncertain::default(), vec![log])?;
    let progress = |step: Step| eprintln!("{} {}/{}", step.stage, step.done, step.of);
    let diagnosis = diagnose(&case, &GapOptions::default(), &progress)?;

    println!("{}", diagnosis.answer.sentence);
    println!("verdict {}", diagnosis.answer.verdict.name());
    if let Some(probability) = diagnosis.answer.probability {
        println!("right in {:.0} % of such answers", 100.0 * probability);
    }
    println!("{}", serde_json::to_string_pretty(&diagnosis.gap)?);
    Ok(())
}
