//! What a log shows by itself.

use crate::log::{
    Columns, DriveMode, LogError, SensorSpec, Source, StudyKind, Unit, health, read_source, sidecar_columns,
    sidecar_of, study_beside,
};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// A log that was looked at.
pub(super) struct Seen {
    pub path: PathBuf,
    pub source: Source,
    /// Names and units, where the file has others than ours.
    pub columns: Columns,
    /// Whether any of them is guessed.
    pub is_guessed: bool,
    /// The sidecar that tells names or units.
    pub sidecar: Option<PathBuf>,
    /// Currents, as the file calls them, that seem to be counts, and whose unit nobody told.
    pub counts: Vec<String>,
    pub joints: Vec<SeenJoint>,
}

/// What a log shows of a joint.
pub(super) struct SeenJoint {
    /// `None`: the log of a joint without a name.
    pub name: Option<String>,
    pub drive: DriveMode,
    /// From the lowest to the highest reading \[rad\].
    pub range_rad: [f64; 2],
    pub period_s: f64,
    /// Step between readings \[rad\]; `None`: they show none.
    pub step_rad: Option<f64>,
    /// A torque without a sign.
    pub is_unsigned: bool,
    pub has_torque: bool,
}

impl SeenJoint {
    pub fn span_rad(&self) -> f64 {
        self.range_rad[1] - self.range_rad[0]
    }
}

/// Reads a log by its sidecar, where it has one; names and units that it does not tell are those that columns look like.
pub(super) fn look(path: &Path) -> Result<Seen, LogError> {
    let told = told(path)?;
    seen(path, read(path, &told)?, &told)
}

impl Seen {
    /// The same of a robot some of whose joints turn on and on: what goes far there was taken for degrees.
    pub fn turning(self, turns: &dyn Fn(&str) -> bool) -> Result<Self, LogError> {
        let degrees = Some(Unit::Angle(TAU / 360.0));
        let mut columns = self.columns.clone();
        for (ours, spec) in columns.0.iter_mut().filter(|_| self.is_guessed) {
            let is_of_turning = ours.rsplit_once('.').is_some_and(|(joint, _)| turns(joint));
            if is_of_turning && spec.unit == degrees && !spec.name.to_lowercase().contains("deg") {
                spec.unit = Some(Unit::Angle(1.0));
            }
        }
        if columns == self.columns {
            return Ok(self);
        }
        seen(&self.path, read(&self.path, &columns)?, &Columns::default())
    }
}

/// What was read of a log, with lines of `[columns]` of which some were told.
fn seen(path: &Path, (source, columns): (Source, Columns), told: &Columns) -> Result<Seen, LogError> {
    let names: Vec<Option<String>> = source.joints().into_iter().map(|name| name.map(str::to_owned)).collect();
    let joints = names.into_iter().map(|name| joint(&source, name)).collect::<Result<_, _>>()?;
    let sidecar = sidecar_of(path).filter(|_| !told.0.is_empty());
    let counts = currents_in_counts(&source, &columns, told);
    Ok(Seen { path: path.to_path_buf(), source, is_guessed: columns != *told, columns, sidecar, counts, joints })
}

/// What the sidecar of a log says of its columns. A study that has the log's name is none: that of a robot calls columns after
/// the robot's joints, and that of a joint says what was guessed, unless somebody has changed it.
fn told(path: &Path) -> Result<Columns, LogError> {
    let said = sidecar_columns(path)?;
    let is_guess = match study_beside(path) {
        None => false,
        Some(StudyKind::Joint) => read(path, &Columns::default()).is_ok_and(|(_, guess)| guess == said),
        Some(StudyKind::Clamped | StudyKind::Robot) => true,
    };
    Ok(if is_guess { Columns::default() } else { said })
}

/// Reads a log by the lines of `[columns]` that are told, or by those that mend it; answers with the lines, too.
fn read(path: &Path, told: &Columns) -> Result<(Source, Columns), LogError> {
    match read_source(path, told) {
        Err(LogError::Defects { mend, first, count, others, beyond }) if !mend.0.is_empty() => {
            match read_source(path, &mend) {
                Ok(source) => Ok((source, mend)),
                // What is wrong with it is more than names and units.
                Err(_) => Err(LogError::Defects { mend, first, count, others, beyond }),
            }
        }
        read => Ok((read?, told.clone())),
    }
}

/// Currents whose unit was left open because their numbers seem to be counts.
fn currents_in_counts(source: &Source, columns: &Columns, told: &Columns) -> Vec<String> {
    let open = columns.0.iter().filter(|(ours, spec)| spec.unit.is_none() && told.get(ours).is_none());
    let channels = open.filter_map(|(ours, _)| source.ours(ours));
    channels.filter(|channel| channel.is_current_in_counts()).map(|channel| channel.theirs.clone()).collect()
}

/// What to ask of currents whose unit is open.
pub(super) fn of_currents(seen: &[Seen]) -> Option<String> {
    let mut names: Vec<&String> = seen.iter().flat_map(|log| &log.counts).collect();
    names.sort_unstable();
    names.dedup();
    let quoted: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
    let list = quoted.join(", ");
    (!names.is_empty()).then(|| format!("{list}: counts? 1 count is 1 mA on an XL330, 2.69 mA on other X-series"))
}

fn joint(source: &Source, name: Option<String>) -> Result<SeenJoint, LogError> {
    let log = source.joint_log(name.as_deref())?;
    let varies = |values: &Option<Vec<f64>>| values.as_ref().is_some_and(|v| v.iter().any(|value| *value != v[0]));
    let is_unsigned = log.tau_nm.as_ref().is_some_and(|tau| tau.iter().all(|tau| *tau >= 0.0));
    let drive = match &log {
        log if varies(&log.q_ref_rad) => DriveMode::Position,
        log if varies(&log.tau_nm) && !is_unsigned => DriveMode::Torque,
        _ => DriveMode::Off,
    };
    let found = health(&log, &SensorSpec::default(), drive);
    let range = log.q_rad.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], q| [low.min(*q), high.max(*q)]);
    Ok(SeenJoint {
        name,
        drive,
        range_rad: range,
        period_s: found.period_s,
        step_rad: found.step_rad,
        is_unsigned,
        has_torque: log.tau_nm.is_some(),
    })
}

/// Whether a joint is that of a hand, by its name.
pub(super) fn is_hand(joint: &str) -> bool {
    let lower = joint.to_lowercase();
    ["jaw", "gripper", "finger", "hand"].iter().any(|word| lower.contains(word))
}

/// How the logs are driven, as a study says it.
pub(super) fn drive_word(drive: DriveMode) -> &'static str {
    match drive {
        DriveMode::Off => "off",
        DriveMode::Position => "position",
        DriveMode::Torque => "torque",
    }
}

/// The middle one.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
