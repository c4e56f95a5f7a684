//! Falls (section 5.2): when does an unstable gait fall, and how does that move with each parameter?

use super::super::CliError;
use super::super::progress::Progress;
use super::super::provenance::provenance;
use super::WalkArgs;
use super::plan::gait_of;
use super::setting::Setting;
use super::study::{empty, joints, write};
use crate::geometry::robot_file::FRAME_S;
use crate::report::{Figure, StudyTable, sensitivity_figure};
use crate::robot::simulate::run as simulate;
use crate::robot::{Floor, Gait, Model, Touching};
use crate::thesis::falls::{Change, Falls, Knob, Moved, fall_s};
use rayon::prelude::*;

/// Steps of the stiff method: half of them move no fall by more than a few milliseconds \[s\].
const STEP_S: f64 = 1e-4;

/// Runs the study.
pub(super) fn run(args: &WalkArgs, model: &Model) -> Result<u8, CliError> {
    let gait = gait_of(args, "topple", model)?;
    let progress = Progress::new(args.common.quiet);
    let changes = Change::all();
    let one = |change: &Change| {
        progress.say(change.knob.map_or("the gait as it is", Knob::words));
        let setting = setting(args, model, &gait, change)?;
        let recording = simulate(&setting.scenario(), args.method_by(STEP_S))?;
        let floor = setting.floor.as_ref();
        Ok(floor.and_then(|floor| fall_s(floor, &recording)).map(|t_s| t_s - gait.stand_s()))
    };
    let times: Vec<Result<Option<f64>, CliError>> =
        args.common.on_threads(|| changes.par_iter().with_max_len(1).map(one).collect())?;
    let times: Vec<Option<f64>> = times.into_iter().collect::<Result<_, _>>()?;
    drop(progress);
    let falls = Falls::of(&times);
    let title = format!("Falls (5.2): {}", gait.name());
    let mut report = empty("falls", &title, provenance(args.robot.iter().chain(&args.gait_file()).cloned())?);
    report.sentence = sentence(&gait, &falls);
    report.notes = notes();
    report.table = table(&falls);
    if let Some(nominal_s) = falls.nominal_s {
        report.figures.push(figure(&falls.moved, nominal_s)?);
    }
    report.rows = falls.moved;
    write(args, &report, &args.gait_file().into_iter().chain(args.robot.clone()).collect::<Vec<_>>())?;
    Ok(if falls.nominal_s.is_none() { super::super::error::NO } else { 0 })
}

/// The walk with one parameter moved.
fn setting(args: &WalkArgs, model: &Model, gait: &Gait, change: &Change) -> Result<Setting, CliError> {
    let moved = change.model(model)?;
    let mut joints = joints(args, &moved)?;
    change.move_joints(&moved, &mut joints)?;
    let floor = change.floor(args.ground.parameters(model)?);
    let floor = Floor::new(floor, &moved, Touching::All).map_err(|error| CliError::Usage(error.to_string()))?;
    let end_s = args.duration.unwrap_or(gait.stand_s() + gait.walk_s());
    let setpoints = change.setpoints(gait, &moved, end_s, FRAME_S)?;
    Ok(Setting::new(moved, joints, &setpoints, Some(floor)))
}

fn sentence(gait: &Gait, falls: &Falls) -> String {
    let Some(nominal_s) = falls.nominal_s else {
        return format!("{} does not fall: the trunk never leans by 45 degrees.", gait.name());
    };
    let mut words = format!("{} falls {nominal_s:.3} s after its walk begins.", gait.name());
    let stops: Vec<&str> = falls.moved.iter().filter(|row| !row.falls()).map(|row| row.parameter.words()).collect();
    if !stops.is_empty() {
        words.push_str(&format!(" With 10 % less or more of {} it does not fall at all.", stops.join(", of ")));
    }
    if let Some((knob, by_s)) = falls.sharpest(false) {
        let moves_ms = 1e3 * by_s;
        words.push_str(&format!(
            " Of robot and floor it is the sharpest test for the {}: 10 % move it by up to {moves_ms:.0} ms.",
            knob.words()
        ));
    }
    if let Some((knob, by_s)) = falls.sharpest(true) {
        let moves_ms = 1e3 * by_s;
        words.push_str(&format!(
            " Of what is asked of the robot the {} moves it most: up to {moves_ms:.0} ms.",
            knob.words()
        ));
    }
    words
}

fn notes() -> Vec<String> {
    vec![
        "Fallen: the trunk's vertical axis leans by 45 degrees from the floor's normal; the time is interpolated between \
         samples of 8 ms. All parts touch the floor. The thesis recommends such motions as the sharper test of a model \
         (5.2), and has none."
            .to_owned(),
        "Less and more: each parameter alone by 10 %; a delay has no nominal value and is 8 ms instead of 0. Where less \
         and more move the fall the same way it is not linear, and per cent per per cent is only the mean slope."
            .to_owned(),
    ]
}

fn table(falls: &Falls) -> StudyTable {
    let moved = |time: Option<f64>| match (time, falls.nominal_s) {
        (Some(time), Some(nominal)) => format!("{:+.1}", 1e3 * (time - nominal)),
        _ => "does not fall".to_owned(),
    };
    let cells = |row: &Moved| {
        let less = if row.parameter == Knob::Delay { "-".to_owned() } else { moved(row.less_s) };
        let share = row.sensitivity.map_or_else(|| "-".to_owned(), |x| format!("{x:+.2}"));
        vec![row.parameter.words().to_owned(), less, moved(row.more_s), share]
    };
    StudyTable {
        words: vec!["parameter"],
        numbers: vec!["10 % less [ms]", "10 % more [ms]", "% per %"],
        rows: falls.moved.iter().map(cells).collect(),
        remarks: Vec::new(),
    }
}

fn figure(rows: &[Moved], nominal_s: f64) -> Result<Figure, CliError> {
    let moved = |time: Option<f64>| time.map(|time| 1e3 * (time - nominal_s));
    let bars: Vec<(String, [Option<f64>; 2])> = rows
        .iter()
        .map(|row| {
            let less = if row.parameter == Knob::Delay { Some(0.0) } else { moved(row.less_s) };
            (row.parameter.words().to_owned(), [less, moved(row.more_s)])
        })
        .collect();
    let title = format!("Section 5.2, how the fall at {nominal_s:.3} s moves");
    let svg = sensitivity_figure(&title, "later by [ms]", ["10 % less", "10 % more"], &bars)?;
    let caption = "Section 5.2. Change of the time of the fall [ms] for 10 % less and 10 % more of each parameter: the \
                   longer a bar, the sharper a test the fall is for that parameter.";
    Ok(Figure { file_name: "falls.svg".to_owned(), title, caption: caption.to_owned(), svg })
}
