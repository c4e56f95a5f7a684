//! The study of one joint.

use super::seen::{Seen, SeenJoint, drive_word, is_hand, median, of_currents};
use super::shared::shared;
use super::{DraftError, digits, listed, relative};
use crate::log::{Columns, DriveMode, toml_string};
use std::fmt::Write as _;
use std::path::Path;

/// Readings that never come as near to 0 count from somewhere else than where the link hangs \[rad\].
const FAR_RAD: f64 = 0.5;
/// A single log that lasts longer is worth parting \[s\], and the share of it that is fitted then.
const WORTH_PARTING_S: f64 = 8.0;
const FITTED: f64 = 0.75;
/// Who says what a log calls its columns, where nobody guesses.
pub(super) const TOLD: &str = "as the log's sidecar says";

/// The text, what could not be told, and the keys that have to be filled in.
pub(super) fn study(
    seen: &[Seen],
    asked: Option<&str>,
    folder: &Path,
) -> Result<(String, Vec<String>, Vec<&'static str>), DraftError> {
    let name = chosen(seen, asked);
    let mut of_joint: Vec<(&Seen, &SeenJoint)> = Vec::new();
    for log in seen {
        let joint = match (&name, &log.joints[..]) {
            (_, [only]) if asked.is_none() || only.name.is_none() => Some(only),
            (Some(name), joints) => joints.iter().find(|joint| joint.name.as_ref() == Some(name)),
            (None, joints) => joints.first(),
        };
        let joint = joint.ok_or_else(|| DraftError::NoJoint {
            file: log.path.clone(),
            joint: name.clone().unwrap_or_default(),
            known: known(log),
        })?;
        of_joint.push((log, joint));
    }
    let joints: Vec<&SeenJoint> = of_joint.iter().map(|(_, joint)| *joint).collect();
    let far = far_from_zero(&joints);
    let mut untold = vec![
        "inertia, moment and friction of the joint, which `gap` starts from: fill them in under [joint]".to_owned(),
        rest(far),
    ];
    let is_driven = of_joint.iter().any(|(_, joint)| joint.drive == DriveMode::Position);
    let mut text = String::from(
        "# Written by `aibo-fit init` from the logs below. What stands here they show; what is marked as a guess is one; lines\n\
         # that begin with `# ` and a key are for you to fill in (drop the `# `).\nschema = 1\n\n",
    );
    let title = name.as_deref().unwrap_or("joint");
    let _ = writeln!(text, "[joint]\nname = {}", toml_string(title));
    text += "# inertia = 0.0    # kg m^2, of the bare link about its axis: from CAD, or mass x length^2 / 3 of a rod\n\
             # moment = 0.0     # kg m, mass x distance of its centre of mass from the axis: weigh it; 0 where the axis is vertical\n\
             # coulomb = 0.0    # N m, dry friction: the torque that just turns it by hand\n\
             # viscous = 0.0    # N m s/rad: from the data sheet, or 0 if unknown ([uncertain] friction = 1.0 says so)\n\
             # gravity = 9.81   # m/s^2, in the plane of motion\n\
             # rest = 0.0       # rad, the logged angle at which the link hangs straight down; `gap` and `check`\n\
             #                  # take 0 where it is not stated, `drop` and `simulate` estimate it\n\n";
    text += &sensor(&joints, &mut untold);
    if is_driven {
        untold.push("the controller's gains: a log shows setpoints, not what the drive makes of them".to_owned());
        text += "\n[motor]\n\
                 # kp = 0.0         # N m/rad: tau = kp (q_ref - q) - kd q'; from the drive's parameters and its torque\n\
                 #                  # constant, or a known torque by the angle that the joint gives under it\n\
                 # kd = 0.0         # N m s/rad\n\
                 # torque_limit = 0.0   # N m, where you know it\n\
                 # armature = 0.0   # kg m^2, rotor inertia x gear ratio^2\n";
    }
    let lines: Vec<(&Seen, Columns)> = seen.iter().map(|log| (log, log.columns.clone())).collect();
    text += &told_columns(seen, &shared(&lines)?);
    untold.extend(of_currents(seen).map(|currents| format!("the unit of {currents}")));
    for (k, (log, joint)) in of_joint.iter().enumerate() {
        let file = toml_string(&relative(&log.path, folder));
        let _ = write!(text, "\n[[log]]\nfile = {file}\n{}\n", role(log, k, of_joint.len()));
        let _ = writeln!(text, "drive = \"{}\"{}", drive_word(joint.drive), why(joint));
        text += &notes(log);
        untold.extend(of_drive(log, joint));
    }
    let others: Vec<&str> = seen.iter().flat_map(|log| &log.joints).filter_map(|joint| joint.name.as_deref()).collect();
    let mut others: Vec<&str> = others.into_iter().filter(|other| Some(*other) != name.as_deref()).collect();
    others.sort_unstable();
    others.dedup();
    if !others.is_empty() && name.is_some() {
        let others = listed(&others);
        let how = if asked.is_some() { "as asked" } else { "it moves most" };
        untold.push(format!("the logs have several joints: this is the study of {title} ({how}); --joint chooses another of {others}, --robot FILE makes one study of all, which is what an arm needs: of one joint alone the others are taken to stand still"));
    }
    let mut to_fill = vec!["inertia", "moment", "coulomb", "viscous"];
    to_fill.extend(far.map(|_| "rest"));
    if is_driven {
        to_fill.extend(["kp", "kd"]);
    }
    Ok((text, untold, to_fill))
}

/// The range that all readings keep to, where it is far from 0.
fn far_from_zero(joints: &[&SeenJoint]) -> Option<[f64; 2]> {
    let low = joints.iter().map(|joint| joint.range_rad[0]).reduce(f64::min)?;
    let high = joints.iter().map(|joint| joint.range_rad[1]).reduce(f64::max)?;
    (low > FAR_RAD || high < -FAR_RAD).then_some([low, high])
}

/// What no log tells of where the link hangs, by the range of its readings where that is far from 0.
fn rest(far: Option<[f64; 2]>) -> String {
    let taken = "the logged angle at which the link hangs straight down, and so the encoder's zero and sign: unless you state \
                 `rest`, `gap` and `check` take 0 (`drop` and `simulate` estimate it)";
    let Some([low, high]) = far else { return taken.to_owned() };
    format!("{taken}, but readings stay from {low:.2} to {high:.2} rad: the encoder seems to count from somewhere else")
}

/// The joint that was asked for, or the one that moves most and is driven; a hand, which is no pendulum, last.
fn chosen(seen: &[Seen], asked: Option<&str>) -> Option<String> {
    if let Some(asked) = asked {
        return Some(asked.to_owned());
    }
    let joints = seen.first()?.joints.iter().filter(|joint| joint.name.is_some());
    let rank = |joint: &SeenJoint| (joint.drive != DriveMode::Off, !joint.name.as_deref().is_some_and(is_hand));
    let most = joints.max_by(|a, b| rank(a).cmp(&rank(b)).then(a.span_rad().total_cmp(&b.span_rad())));
    most.and_then(|joint| joint.name.clone())
}

fn known(log: &Seen) -> String {
    let names: Vec<&str> = log.joints.iter().filter_map(|joint| joint.name.as_deref()).collect();
    if names.is_empty() { "one without a name".to_owned() } else { names.join(", ") }
}

/// `[sensor]` of joints.
pub(super) fn sensor(joints: &[&SeenJoint], untold: &mut Vec<String>) -> String {
    let mut text = String::from("[sensor]\n");
    if let Some(period_s) = median(joints.iter().map(|joint| joint.period_s).collect()) {
        let _ = writeln!(text, "period = {}   # s, median step of the stamps", digits(period_s));
    }
    match median(joints.iter().filter_map(|joint| joint.step_rad).collect()) {
        Some(step_rad) => {
            let _ = writeln!(text, "resolution = {}   # rad, the step of the readings", digits(step_rad));
        }
        None => {
            untold.push("the encoder's step: the readings show none".to_owned());
            text += "# resolution = 0.001534   # rad, the encoder's step: 2 pi / 4096 of 12 bits\n";
        }
    }
    text
}

/// `[columns]`, where names or units are not ours.
fn told_columns(seen: &[Seen], columns: &Columns) -> String {
    if columns.0.is_empty() {
        return String::new();
    }
    let is_guessed = seen.iter().any(|log| log.is_guessed);
    let how = if is_guessed { "guess: by the columns' names and numbers; check units, signs and zeros" } else { TOLD };
    let currents = of_currents(seen).map_or_else(String::new, |currents| format!("# {currents}\n"));
    format!("\n# {how}\n{currents}{}", columns.toml())
}

/// The role of a log, by its place among so many: of several the last may be the one to hold out, of one its last part.
pub(super) fn role(log: &Seen, k: usize, logs: usize) -> String {
    let fit = "role = \"fit\"";
    match log.source.clocks.first().and_then(|t_s| Some([*t_s.first()?, *t_s.last()?])) {
        Some([begins_s, ends_s]) if logs == 1 && ends_s - begins_s > WORTH_PARTING_S => {
            let at_s = (begins_s + FITTED * (ends_s - begins_s)).round();
            format!(
                "{fit}\n# to = {at_s:?}   # s: holds what follows out, as a second [[log]] of this file with from = {at_s:?} and\n\
                 #               # role = \"validate\": predicted only"
            )
        }
        _ if logs > 1 && k + 1 == logs => {
            format!("{fit}   # or \"validate\": predicted only; hold a motion out that differs from the others")
        }
        _ => fit.to_owned(),
    }
}

/// Why a log is taken to be driven so.
pub(super) fn why(joint: &SeenJoint) -> &'static str {
    match joint.drive {
        DriveMode::Position => "   # its setpoints move",
        DriveMode::Torque => {
            "   # guess: no setpoint, and a torque that varies, taken to be the one applied to the joint"
        }
        DriveMode::Off => "   # guess: nothing that is asked of the joint moves",
    }
}

/// Columns that are not used, of which so many are named.
const MOST_NAMED: usize = 6;

/// What could not be told of how a log is driven.
fn of_drive(log: &Seen, joint: &SeenJoint) -> Option<String> {
    let file = log.path.display();
    match joint.drive {
        DriveMode::Off if joint.is_unsigned => {
            Some(format!("{file}: what moves the joint: its torque has no sign, and no setpoint stands beside it"))
        }
        DriveMode::Off => {
            let unused = log.source.ignored.iter().take(MOST_NAMED).map(|name| format!("`{name}`"));
            let unused = unused.collect::<Vec<_>>().join(", ");
            let unused = if unused.is_empty() { unused } else { format!(" (not used: {unused})") };
            Some(format!(
                "{file}: whether the motor was off: no setpoint or torque that moves stands beside the angle{unused}"
            ))
        }
        DriveMode::Torque => Some(format!("{file}: whether its torque was commanded, applied or computed")),
        DriveMode::Position if joint.has_torque => Some(format!(
            "{file}: what its torque column is; `tau_is = \"applied\"`, \"commanded\" or \"current\" says it"
        )),
        DriveMode::Position => None,
    }
}

/// What the reader decided, as comments.
pub(super) fn notes(log: &Seen) -> String {
    log.source.notes.iter().map(|note| format!("# {note}\n")).collect()
}
