//! Falls (section 5.2): when does an unstable gait fall, and how does that move with each parameter?

use super::super::CliError;
use super::super::progress::Progress;
use super::super::provenance::provenance;
use super::WalkArgs;
use super::answer::PERIOD_S;
use super::ground::tilt_rad;
use super::plan::gait_of;
use super::setting::Setting;
use super::study::{empty, joints, write};
use crate::joint::EffectId;
use crate::report::{Figure, StudyTable, sensitivity_figure};
use crate::robot::simulate::{Recording, Setpoints, run as simulate};
use crate::robot::{Floor, Gait, JointId, Model, Setpoints as Source, Touching};
use rayon::prelude::*;
use serde::Serialize;

/// A trunk that leans by so much has fallen \[rad\]: 45 degrees.
const FALLEN_RAD: f64 = std::f64::consts::FRAC_PI_4;
/// How far each parameter is moved.
const SHARE: f64 = 0.1;
/// Steps of the stiff method: half of them move no fall by more than a few milliseconds \[s\].
const STEP_S: f64 = 1e-4;
/// A delay has no nominal value to take a share of: it is moved by a frame \[s\].
const FRAME_S: f64 = 0.008;

/// What is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Knob {
    TrunkMass,
    HeadMass,
    LegMasses,
    LowerLegMasses,
    JointCoulomb,
    JointViscous,
    ControllerGains,
    FloorStiffness,
    FloorDamping,
    FloorFriction,
    FloorSteepness,
    Amplitude,
    Frequency,
    Delay,
}

impl Knob {
    const ALL: [Self; 14] = [
        Self::TrunkMass,
        Self::HeadMass,
        Self::LegMasses,
        Self::LowerLegMasses,
        Self::JointCoulomb,
        Self::JointViscous,
        Self::ControllerGains,
        Self::FloorStiffness,
        Self::FloorDamping,
        Self::FloorFriction,
        Self::FloorSteepness,
        Self::Amplitude,
        Self::Frequency,
        Self::Delay,
    ];

    /// A property of the gait and not of robot or floor.
    fn is_of_gait(self) -> bool {
        matches!(self, Self::Amplitude | Self::Frequency | Self::Delay)
    }

    fn words(self) -> &'static str {
        match self {
            Self::TrunkMass => "mass of the trunk",
            Self::HeadMass => "masses of head and neck",
            Self::LegMasses => "masses of all leg parts",
            Self::LowerLegMasses => "masses of the lower legs",
            Self::JointCoulomb => "Coulomb friction of the joints",
            Self::JointViscous => "viscous friction of the joints",
            Self::ControllerGains => "gains of the controllers (P, I, D)",
            Self::FloorStiffness => "stiffness of the floor",
            Self::FloorDamping => "damping of the floor",
            Self::FloorFriction => "friction of the floor (mu_st, mu_c)",
            Self::FloorSteepness => "steepness of the friction (s)",
            Self::Amplitude => "amplitude of the gait",
            Self::Frequency => "frequency of the gait",
            Self::Delay => "delay of the setpoints (0 and 8 ms)",
        }
    }
}

/// A row as the JSON has it.
#[derive(Debug, Serialize)]
struct Row {
    parameter: Knob,
    /// Fall times after the walk's start with 10 % less and 10 % more; null: it does not fall. A delay is moved by 8 ms
    /// and has no less \[s\].
    less_s: Option<f64>,
    more_s: Option<f64>,
    /// Per cent of the fall time for a per cent of the parameter; null where it does not fall.
    sensitivity: Option<f64>,
}

/// A gait with its amplitude scaled.
struct Scaled<'a> {
    gait: &'a Gait,
    factor: f64,
}

impl Source for Scaled<'_> {
    fn joints(&self) -> usize {
        self.gait.joints()
    }

    fn angle_rad(&self, joint: JointId, t_s: f64) -> f64 {
        let stand_rad = self.gait.angle_rad(joint, 0.0);
        stand_rad + self.factor * (self.gait.angle_rad(joint, t_s) - stand_rad)
    }
}

/// Runs the study.
pub(super) fn run(args: &WalkArgs, model: &Model) -> Result<u8, CliError> {
    let gait = gait_of(args, "topple", model)?;
    let progress = Progress::new(args.common.quiet);
    let cases: Vec<(Option<Knob>, f64)> = std::iter::once((None, 1.0))
        .chain(Knob::ALL.into_iter().flat_map(|knob| [1.0 - SHARE, 1.0 + SHARE].map(|factor| (Some(knob), factor))))
        .collect();
    let one = |&(knob, factor): &(Option<Knob>, f64)| {
        progress.say(knob.map_or("the gait as it is", Knob::words));
        let setting = setting(args, model, &gait, knob, factor)?;
        let recording = simulate(&setting.scenario(), args.method_by(STEP_S))?;
        let floor = setting.floor.as_ref();
        Ok(floor.and_then(|floor| fall_s(floor, &recording)).map(|t_s| t_s - gait.stand_s()))
    };
    let times: Vec<Result<Option<f64>, CliError>> =
        args.common.on_threads(|| cases.par_iter().with_max_len(1).map(one).collect())?;
    let times: Vec<Option<f64>> = times.into_iter().collect::<Result<_, _>>()?;
    drop(progress);
    let nominal_s = times[0];
    let row = |(knob, pair): (Knob, &[Option<f64>])| {
        let less_s = if knob == Knob::Delay { None } else { pair[0] };
        let sensitivity = match (knob, less_s, pair[1], nominal_s) {
            (Knob::Delay, ..) => None,
            (_, Some(less), Some(more), Some(nominal)) => Some((more - less) / (2.0 * SHARE * nominal)),
            _ => None,
        };
        Row { parameter: knob, less_s, more_s: pair[1], sensitivity }
    };
    let mut rows: Vec<Row> = Knob::ALL.into_iter().zip(times[1..].chunks(2)).map(row).collect();
    // What stops the fall comes first, then what moves it most.
    let rank = |row: &Row| {
        let falls = row.more_s.is_some() && (row.less_s.is_some() || row.parameter == Knob::Delay);
        if falls { spread_s(row, nominal_s) } else { f64::INFINITY }
    };
    rows.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    let title = format!("Falls (5.2): {}", gait.name());
    let mut report = empty("falls", &title, provenance(args.robot.iter().chain(&args.gait_file()).cloned())?);
    report.sentence = sentence(&gait, &rows, nominal_s);
    report.notes = notes();
    report.table = table(&rows, nominal_s);
    if let Some(nominal_s) = nominal_s {
        report.figures.push(figure(&rows, nominal_s)?);
    }
    report.rows = rows;
    write(args, &report, &args.gait_file().into_iter().chain(args.robot.clone()).collect::<Vec<_>>())?;
    Ok(if nominal_s.is_none() { super::super::error::NO } else { 0 })
}

/// When the trunk has leant over \[s\].
fn fall_s(floor: &Floor, recording: &Recording) -> Option<f64> {
    let tilts: Vec<f64> = recording.base.iter().map(|base| tilt_rad(floor, base)).collect();
    let k = tilts.iter().position(|tilt| *tilt > FALLEN_RAD).filter(|k| *k > 0)?;
    let share = (FALLEN_RAD - tilts[k - 1]) / (tilts[k] - tilts[k - 1]);
    Some(recording.t_s[k - 1] + share * (recording.t_s[k] - recording.t_s[k - 1]))
}

/// The walk with one parameter moved.
fn setting(args: &WalkArgs, model: &Model, gait: &Gait, knob: Option<Knob>, factor: f64) -> Result<Setting, CliError> {
    let mut moved = model.clone();
    let heavier = |name: &str| match knob {
        Some(Knob::TrunkMass) => name == "trunk",
        Some(Knob::HeadMass) => ["neck", "head", "mouth"].contains(&name),
        Some(Knob::LegMasses) => ["_shoulder", "_upper", "_lower"].iter().any(|part| name.ends_with(part)),
        Some(Knob::LowerLegMasses) => name.ends_with("_lower"),
        _ => false,
    };
    for body in model.body_ids() {
        let part = &model.bodies()[body.index()];
        if heavier(&part.name) {
            moved = moved.with_mass(body, factor * part.mass_kg)?;
        }
    }
    let mut joints = joints(args, &moved)?;
    for id in moved.joint_ids() {
        let friction = &mut joints.drive_mut(id).chain.friction;
        match knob {
            Some(Knob::JointCoulomb) => friction.coulomb_nm *= factor,
            Some(Knob::JointViscous) => friction.viscous_nm_s_rad *= factor,
            Some(Knob::ControllerGains) => joints.add_effect(&moved, id, EffectId::MotorGain, &[factor])?,
            Some(Knob::Delay) if factor > 1.0 => joints.add_effect(&moved, id, EffectId::Delay, &[FRAME_S])?,
            _ => {}
        }
    }
    let mut floor = args.ground.parameters(model)?;
    match knob {
        Some(Knob::FloorStiffness) => floor.stiffness_n_m *= factor,
        Some(Knob::FloorDamping) => floor.damping_n_s_m2 *= factor,
        Some(Knob::FloorSteepness) => floor.steepness_s_m *= factor,
        Some(Knob::FloorFriction) => {
            floor.static_friction *= factor;
            floor.coulomb *= factor;
        }
        _ => {}
    }
    let floor = Floor::new(floor, &moved, Touching::All).map_err(|error| CliError::Usage(error.to_string()))?;
    let faster = if knob == Some(Knob::Frequency) { gait.at_frequency(factor / gait.period_s()) } else { gait.clone() };
    let source = Scaled { gait: &faster, factor: if knob == Some(Knob::Amplitude) { factor } else { 1.0 } };
    let end_s = args.duration.unwrap_or(gait.stand_s() + gait.walk_s());
    let setpoints = Setpoints::sampled(&source, &moved, end_s, PERIOD_S)?;
    Ok(Setting::new(moved, joints, &setpoints, Some(floor)))
}

/// How far the fall moves at the most \[s\].
fn spread_s(row: &Row, nominal_s: Option<f64>) -> f64 {
    let nominal_s = nominal_s.unwrap_or(0.0);
    [row.less_s, row.more_s].into_iter().flatten().map(|t| (t - nominal_s).abs()).fold(0.0, f64::max)
}

fn sentence(gait: &Gait, rows: &[Row], nominal_s: Option<f64>) -> String {
    let Some(nominal_s) = nominal_s else {
        return format!("{} does not fall: the trunk never leans by 45 degrees.", gait.name());
    };
    let mut words = format!("{} falls {nominal_s:.3} s after its walk begins.", gait.name());
    let stops: Vec<&str> = rows
        .iter()
        .filter(|row| row.more_s.is_none() || (row.less_s.is_none() && row.parameter != Knob::Delay))
        .map(|row| row.parameter.words())
        .collect();
    if !stops.is_empty() {
        words.push_str(&format!(" With 10 % less or more of {} it does not fall at all.", stops.join(", of ")));
    }
    let sharpest = |of_gait: bool| {
        let candidates = rows.iter().filter(|row| {
            row.parameter.is_of_gait() == of_gait && row.more_s.is_some() && !stops.contains(&row.parameter.words())
        });
        candidates.max_by(|a, b| spread_s(a, Some(nominal_s)).total_cmp(&spread_s(b, Some(nominal_s))))
    };
    if let Some(row) = sharpest(false) {
        let moves_ms = 1e3 * spread_s(row, Some(nominal_s));
        words.push_str(&format!(
            " Of robot and floor it is the sharpest test for the {}: 10 % move it by up to {moves_ms:.0} ms.",
            row.parameter.words()
        ));
    }
    if let Some(row) = sharpest(true) {
        let moves_ms = 1e3 * spread_s(row, Some(nominal_s));
        words.push_str(&format!(
            " Of what is asked of the robot the {} moves it most: up to {moves_ms:.0} ms.",
            row.parameter.words()
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

fn table(rows: &[Row], nominal_s: Option<f64>) -> StudyTable {
    let moved = |time: Option<f64>| match (time, nominal_s) {
        (Some(time), Some(nominal)) => format!("{:+.1}", 1e3 * (time - nominal)),
        _ => "does not fall".to_owned(),
    };
    let cells = |row: &Row| {
        let less = if row.parameter == Knob::Delay { "-".to_owned() } else { moved(row.less_s) };
        let share = row.sensitivity.map_or_else(|| "-".to_owned(), |x| format!("{x:+.2}"));
        vec![row.parameter.words().to_owned(), less, moved(row.more_s), share]
    };
    StudyTable {
        words: vec!["parameter"],
        numbers: vec!["10 % less [ms]", "10 % more [ms]", "% per %"],
        rows: rows.iter().map(cells).collect(),
        remarks: Vec::new(),
    }
}

fn figure(rows: &[Row], nominal_s: f64) -> Result<Figure, CliError> {
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
