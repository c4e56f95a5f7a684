//! Section C.3: a walk of 2 Hz whose setpoints come every 128 ms only, and without that limit.

use super::super::CliError;
use super::super::progress::Progress;
use super::super::provenance::provenance;
use super::WalkArgs;
use super::plan::gait_of;
use super::setting::Setting;
use super::study::{Run, empty, joints, write};
use crate::geometry::robot_file::FRAME_S;
use crate::report::{Figure, PairedCurves, StudyTable, joints_figure};
use crate::robot::simulate::{Setpoints, distortion_rad};
use crate::robot::{Between, Gait, Model, Sampled, Setpoints as Source};
use rayon::prelude::*;
use serde::Serialize;

/// The gait of Figure C.3 \[1/s\].
const FREQUENCY_HZ: f64 = 2.0;
/// Cycles that the figures show.
const CYCLES: f64 = 4.0;

/// A row as the JSON has it.
#[derive(Debug, Serialize)]
struct Row {
    setpoints: String,
    /// Time between two setpoints \[s\].
    period_s: f64,
    displacement_m: Option<f64>,
    drift_m: Option<f64>,
    turn_rad: Option<f64>,
    bob_m: Option<f64>,
    tilt_rad: Option<f64>,
    steps: Option<usize>,
    /// Root mean square of setpoints less gait over the leg joints while it walks \[rad\].
    distortion_rad: f64,
}

/// Runs the study.
pub(super) fn run(args: &WalkArgs, model: &Model) -> Result<u8, CliError> {
    let gait = gait_of(args, "trot", model)?.at_frequency(args.frequency.unwrap_or(FREQUENCY_HZ));
    let end_s = args.duration.unwrap_or(gait.stand_s() + gait.walk_s());
    let kinds = [
        ("every 8 ms, joined by lines", FRAME_S, Between::Linear),
        ("every 96 ms, joined by lines", 0.096, Between::Linear),
        ("every 128 ms, joined by lines", 0.128, Between::Linear),
        ("every 128 ms, held", 0.128, Between::Hold),
    ];
    let progress = Progress::new(args.common.quiet);
    progress.say("simulating");
    let one = |&(_, period_s, between): &(&str, f64, Between)| {
        let source = Sampled { source: gait.clone(), period_s, between };
        let setpoints = Setpoints::sampled(&source, model, end_s, FRAME_S)?;
        let setting = Setting::new(model.clone(), joints(args, model)?, &setpoints, Some(args.ground.floor(model)?));
        Run::of(&setting, args.method(), gait.stand_s())
    };
    let runs: Vec<Result<Run, CliError>> = args.common.on_threads(|| kinds.par_iter().map(one).collect())?;
    let runs: Vec<Run> = runs.into_iter().collect::<Result<_, _>>()?;
    drop(progress);
    let row = |((name, period_s, _), run): (&(&str, f64, Between), &Run)| {
        let ground = run.ground.as_ref();
        Row {
            setpoints: (*name).to_owned(),
            period_s: *period_s,
            displacement_m: ground.map(|g| g.displacement_m),
            drift_m: ground.map(|g| g.drift_m),
            turn_rad: ground.map(|g| g.turn_rad),
            bob_m: ground.map(|g| g.bob_m),
            tilt_rad: ground.map(|g| g.tilt_rad),
            steps: ground.map(|g| g.steps),
            distortion_rad: distortion_rad(&gait, model, &run.recording),
        }
    };
    let rows: Vec<Row> = kinds.iter().zip(&runs).map(row).collect();
    let title = format!("Section C.3: {} at {:.2} Hz", gait.name(), 1.0 / gait.period_s());
    let mut report = empty("frames", &title, provenance(args.robot.iter().chain(&args.gait_file()).cloned())?);
    report.sentence = sentence(&rows, gait.period_s());
    report.notes = vec![
        "Frames of a Tekkotsu motion file are 128 ms apart and joined by lines; an algorithm of one's own in C++ has \
         frames of 8 ms (4.2.1). The thesis's robot stumbled at 2 Hz with the first and crashed with 96 ms: the crash is \
         the robot's software and not its dynamics."
            .to_owned(),
    ];
    report.table = table(&rows);
    for (k, file) in [(2, "figure-c-3"), (0, "figure-c-3-8ms"), (3, "figure-c-3-held")] {
        report.figures.push(figure(file, kinds[k].0, &gait, model, &runs[k])?);
    }
    report.rows = rows;
    write(args, &report, &args.gait_file().into_iter().chain(args.robot.clone()).collect::<Vec<_>>())?;
    Ok(0)
}

fn sentence(rows: &[Row], period_s: f64) -> String {
    let went = |k: usize| rows[k].displacement_m.map_or("runs away".to_owned(), |m| format!("goes {m:.3} m"));
    format!(
        "With {:.1} setpoints in a cycle (128 ms) the robot {} instead of {:.3} m with setpoints every 8 ms, and the \
         setpoints are {:.0} mrad RMS off the gait instead of {:.1} mrad.",
        period_s / 0.128,
        went(2),
        rows[0].displacement_m.unwrap_or(f64::NAN),
        1e3 * rows[2].distortion_rad,
        1e3 * rows[0].distortion_rad
    )
}

fn table(rows: &[Row]) -> StudyTable {
    let number = |value: Option<f64>, scale: f64, digits: usize| {
        value.map_or_else(|| "-".to_owned(), |x| format!("{:.digits$}", scale * x))
    };
    let cells = |row: &Row| {
        vec![
            row.setpoints.clone(),
            number(row.displacement_m, 1.0, 3),
            number(row.drift_m, 1.0, 3),
            number(row.turn_rad, 1.0, 3),
            number(row.bob_m, 1e3, 1),
            number(row.tilt_rad, 1.0, 3),
            row.steps.map_or_else(|| "-".to_owned(), |n| n.to_string()),
            number(Some(row.distortion_rad), 1e3, 1),
        ]
    };
    StudyTable {
        words: vec!["setpoints"],
        numbers: vec![
            "forward [m]",
            "right [m]",
            "turned [rad]",
            "bob [mm]",
            "tilt [rad]",
            "steps",
            "off the gait [mrad]",
        ],
        rows: rows.iter().map(cells).collect(),
        remarks: Vec::new(),
    }
}

fn figure(file: &str, kind: &str, gait: &Gait, model: &Model, run: &Run) -> Result<Figure, CliError> {
    let recording = &run.recording;
    let end_s = recording.t_s.last().copied().unwrap_or(0.0);
    let first = recording.t_s.partition_point(|t| *t < end_s - CYCLES * gait.period_s());
    let t_s = recording.t_s[first..].to_vec();
    let joints = ["lf1", "lf2", "lf3"].iter().filter_map(|name| model.joint(name).ok()).map(|id| PairedCurves {
        label: format!("{} [rad]", model.joints()[id.index()].name),
        columns: vec![
            t_s.iter().map(|t| gait.angle_rad(id, *t)).collect(),
            recording.setpoint_rad[id.index()][first..].to_vec(),
            recording.angle_rad[id.index()][first..].to_vec(),
        ],
        t_s: t_s.clone(),
    });
    let title = format!("Figure C.3, setpoints {kind}");
    Ok(Figure {
        file_name: format!("{file}.svg"),
        caption: format!(
            "Figure C.3. The left front leg in a walk of {:.0} Hz: the gait, what the controller is asked for with \
             setpoints {kind}, and what the simulated joint does.",
            1.0 / gait.period_s()
        ),
        svg: joints_figure(&title, &["gait", "setpoint", "simulated"], &joints.collect::<Vec<_>>())?,
        title,
    })
}
