//! `aibo-fit sensor-test`: the sweeps of section B.1.

use super::CliError;
use super::common::{CommonArgs, print, write_outputs};
use super::progress::Progress;
use super::provenance::provenance;
use crate::geometry::robot_file::Base;
use crate::log::Outputs;
use crate::report::{SensorReport, sensor_figures, sensor_html, sensor_text};
use crate::robot::Model;
use crate::robot::simulate::{Joints, PositionSensor, Swept, sweep};
use clap::Args;

/// Set a joint to 312 places over a wide and a fine range and read its sensor (section B.1, Figures B.1 to B.3)
///
/// The trunk is clamped, the joint has its controller and friction. Prints what of reading less setpoint is the sensor's
/// and what is the controller giving way under gravity [rad]; writes report.html and the three figures.
#[derive(Args, Debug)]
#[command(after_help = "Example: aibo-fit sensor-test --joint lf1")]
pub(super) struct SensorTestArgs {
    /// The joint
    #[arg(long, value_name = "NAME", default_value = "lf1")]
    joint: String,
    /// Measurements in each sweep
    #[arg(long, value_name = "N", default_value_t = 312, value_parser = clap::value_parser!(u16).range(2..=5000))]
    measurements: u16,
    /// Seed of the sensor's noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    common: CommonArgs,
}

/// Ranges of B.1 \[rad\], the fine one around the angle at which the joint rests.
const WIDE_RAD: [f64; 2] = [-2.0, 2.0];
const FINE_RAD: [f64; 2] = [-0.05, 0.05];

/// Runs the command.
pub(super) fn run(args: &SensorTestArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    progress.say("sweeping");
    let model = Model::ers7().with_base(Base::Clamped);
    let joint = model.joint(&args.joint).map_err(|error| CliError::Usage(error.to_string()))?;
    let joints = Joints::of_thesis(&model)?;
    if joints.drive(joint).chain.motor.is_none() {
        return Err(CliError::Usage(format!("--joint {}: it has no controller (Table B.2)", args.joint)));
    }
    let sensor = (PositionSensor::of(&model), args.seed);
    let one = |range: &[f64; 2]| {
        let points = sweep(&model, &joints, joint, *range, usize::from(args.measurements), sensor)?;
        Ok::<_, CliError>(Swept::of(&points))
    };
    let rest_rad = model.joints()[joint.index()].resting_rad();
    let ranges = [WIDE_RAD, FINE_RAD.map(|away_rad| rest_rad + away_rad)];
    let sweeps = args.common.on_threads(|| ranges.iter().map(one).collect::<Result<Vec<_>, _>>())??;
    let mut sentence = format!(
        "{}: the sensor itself is off by {:.1} mrad RMS; held against gravity the joint is off by up to {:.1} mrad at the \
         borders of its range, which is the controller's and not the sensor's.",
        args.joint,
        1e3 * sweeps.iter().map(|sweep| sweep.sensor_rms_rad).sum::<f64>() / sweeps.len() as f64,
        1e3 * sweeps[0].droop_worst_rad,
    );
    if sweeps.iter().zip(&ranges).any(|(sweep, asked)| sweep.range_rad != *asked) {
        sentence += " Setpoints stay within the joint's software limits.";
    }
    let report = SensorReport { schema: 1, joint: args.joint.clone(), sentence, sweeps, provenance: provenance([])? };
    progress.say("drawing");
    let folder = args.common.folder("sensor-test");
    let mut outputs = Outputs::default();
    for figure in sensor_figures(&report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    let page = folder.join("report.html");
    outputs.add_page(&page, sensor_html(&report)?);
    args.common.add_json(&mut outputs, &report)?;
    write_outputs(outputs, &[])?;
    drop(progress);
    if !args.common.quiet {
        print(&sensor_text(&report));
        print(&format!("\nreport: {}\n", page.display()));
    }
    Ok(0)
}
