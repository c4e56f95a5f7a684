//! Does the displacement depend on the step?

use super::super::CliError;
use super::super::common::print;
use crate::robot::Floor;
use crate::robot::simulate::{Method, Scenario, Walked, run as simulate};
use std::time::Instant;

/// Steps of the table [s]; the last is what the others are held against.
const STEPS_S: [f64; 7] = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5];

/// Prints displacement and cost of the stiff method over its step.
pub(super) fn print_table(scenario: &Scenario<'_>, floor: &Floor, from_s: f64) -> Result<(), CliError> {
    print("step [s]  displacement [m]  drift [m]  bob [mm]     steps  evaluations  times real time\n");
    for step_s in STEPS_S {
        let clock = Instant::now();
        let recording = simulate(scenario, Method::Stiff { step_s })?;
        let wall_s = clock.elapsed().as_secs_f64();
        let simulated_s = recording.t_s.last().zip(recording.t_s.first()).map_or(0.0, |(last, first)| last - first);
        let (counts, factor) = (recording.counts, simulated_s / wall_s);
        match Walked::of(floor, scenario.model, &recording, from_s).filter(|_| recording.diverged.is_none()) {
            Some(ground) => print(&format!(
                "{step_s:<8}  {:>16.4}  {:>9.4}  {:>8.2}  {:>8}  {:>11}  {factor:>15.1}\n",
                ground.displacement_m,
                ground.drift_m,
                1e3 * ground.bob_m,
                counts.steps,
                counts.evaluations
            )),
            None => print(&format!("{step_s:<8}  diverged\n")),
        }
    }
    print("\n");
    Ok(())
}
