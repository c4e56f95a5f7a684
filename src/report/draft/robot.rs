//! The study of a robot that somebody described.

use super::beliefs::tables;
use super::joint::{TOLD, notes, role, sensor, why};
use super::match_joints::{How, pairs};
use super::seen::{Seen, SeenJoint, drive_word, is_hand, of_currents};
use super::shared::shared;
use super::{DraftError, relative};
use crate::log::{ColumnSpec, Columns, DriveMode, Unit, toml_string};
use crate::robot::description::{Description, LinkId, Mover};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

/// The text, what could not be told, and the keys that have to be filled in.
pub(super) fn study(
    seen: &[Seen],
    model: &Path,
    robot: &Description,
    folder: &Path,
) -> Result<(String, Vec<String>, Vec<&'static str>), DraftError> {
    let moving = leaders(robot);
    let names: Vec<String> = moving.iter().map(|joint| joint.name.clone()).collect();
    let mut untold = vec!["whether the robot's base was clamped: scenario = \"fixed\" says so".to_owned()];
    let mut to_fill = Vec::new();
    let mut lines: Vec<(&Seen, Columns)> = Vec::new();
    let mut without: Vec<String> = Vec::new();
    let mut by_order: Vec<String> = Vec::new();
    let mut comments: Vec<String> = Vec::new();
    let mut is_guessed = seen.iter().any(|log| log.is_guessed);
    for log in seen {
        let own: Vec<String> = log.joints.iter().map(|joint| joint.name.clone().unwrap_or_default()).collect();
        let found = pairs(&own, &names);
        if found.is_empty() {
            return Err(DraftError::NoMatch { file: log.path.clone(), found: own.join(", "), known: names.join(", ") });
        }
        without.extend((0..own.len()).filter(|k| !found.iter().any(|(at, _, _)| at == k)).map(|k| own[k].clone()));
        let mut under_own_names = log.columns.0.clone();
        let mut columns = Columns::default();
        for (at, of, how) in found {
            let (joint, mover) = (&log.joints[at], moving[of]);
            let range = fraction(joint, mover, log);
            if how != How::Name || range.is_some() {
                map(log, joint, mover, range, &mut columns);
                own_names(joint).iter().for_each(|(_, own)| drop(under_own_names.remove(own)));
                is_guessed = true;
            }
            if how == How::Order {
                by_order.push(format!("{} is {}", own[at], mover.name));
            }
            if let Some((_, note)) = range {
                comments.push(format!("{}: {note}", mover.name));
            } else if let Some(note) = beyond(joint, mover) {
                comments.push(note);
            }
        }
        columns.0.extend(under_own_names);
        lines.push((log, columns));
    }
    let columns = shared(&lines)?;
    for list in [&mut without, &mut by_order, &mut comments] {
        list.sort();
        list.dedup();
    }
    if !by_order.is_empty() {
        untold.push(format!("which joint is which: by their order {} (a guess)", by_order.join(", ")));
    }
    untold.push("the encoders' zeros and signs against the robot's: they are taken to be the robot's own".to_owned());
    let mut text = String::from(
        "# Written by `aibo-fit init` from the logs below. What stands here they show, or the robot's description; what is\n\
         # marked as a guess is one; lines that begin with `# ` and a key are for you to fill in (drop the `# `).\nschema = 1\n\n",
    );
    let _ = writeln!(text, "[robot]\nmodel = {}", toml_string(&relative(model, folder)));
    text += "scenario = \"fixed\"   # guess: the base is clamped; a log does not say. Of a robot that walked: \"floor\"\n\
             # tip = \"\"           # the link that carries a payload; by itself the end of the longest chain\n";
    if !without.is_empty() {
        let list: Vec<String> = without.iter().map(|name| toml_string(name)).collect();
        let _ = writeln!(text, "without = [{}]   # joints of the logs that are none of the robot's", list.join(", "));
        untold.push(format!("which joints of the robot {} are: left out", without.join(", ")));
    }
    let joints: Vec<&SeenJoint> = seen.iter().flat_map(|log| &log.joints).collect();
    let is_driven = joints.iter().any(|joint| joint.drive == DriveMode::Position);
    text += &tables(robot, &moving, is_driven, &mut untold, &mut to_fill);
    if is_driven {
        text += "\n[control]\nhold = \"step\"      # guess: setpoints stay until the next\n";
    }
    text += "\n";
    text += &sensor(&joints, &mut untold);
    if let Some(currents) = of_currents(seen) {
        untold.push(format!("the unit of {currents}"));
        comments.push(currents);
    }
    if !columns.0.is_empty() {
        let guess = "guess: which column is which joint, and in which unit; check signs and zeros";
        let how = if is_guessed { guess } else { TOLD };
        comments.insert(0, how.to_owned());
    }
    if !comments.is_empty() {
        text += "\n";
        comments.iter().for_each(|note| text += &format!("# {note}\n"));
    }
    text += &columns.toml();
    text += &log_tables(seen, folder, &mut untold);
    Ok((text, untold, to_fill))
}

/// `[[log]]` of every log.
fn log_tables(seen: &[Seen], folder: &Path, untold: &mut Vec<String>) -> String {
    let logs: Vec<(&Seen, &SeenJoint)> = seen.iter().filter_map(|log| Some((log, strongest(log)?))).collect();
    let are_of_torques = !logs.is_empty() && logs.iter().all(|(_, joint)| joint.drive == DriveMode::Torque);
    if are_of_torques {
        untold.push(
            "whether to simulate: an arm under its torques alone may run away; `predict = \"torque\"` in every [[log]] \
             compares the torques of the measured motion with the logged ones instead, without a simulation"
                .to_owned(),
        );
    }
    let mut text = String::new();
    for (k, (log, joint)) in logs.iter().enumerate() {
        let file = toml_string(&relative(&log.path, folder));
        let _ = write!(text, "\n[[log]]\nfile = {file}\n{}\n", role(log, k, logs.len()));
        let _ = writeln!(text, "drive = \"{}\"{}", drive_word(joint.drive), why(joint));
        if are_of_torques {
            text += "# predict = \"torque\"   # compares torques along the measured motion instead of simulating\n";
        }
        text += &notes(log);
    }
    text
}

/// The joint of a log that most is asked of.
fn strongest(log: &Seen) -> Option<&SeenJoint> {
    let drives = [DriveMode::Position, DriveMode::Torque, DriveMode::Off];
    drives.iter().find_map(|drive| log.joints.iter().find(|joint| joint.drive == *drive))
}

/// Joints that follow no other, in the file's order where it has parents before children, else in the tree's: many a URDF of
/// an arm begins at its gripper, and nobody's log does.
fn leaders(robot: &Description) -> Vec<&Mover> {
    let above = |link: LinkId| std::iter::successors(robot.links[link.0].parent, |above| robot.links[above.0].parent);
    let is_below = |(k, joint): (usize, &Mover)| {
        above(joint.link).flat_map(|link| &robot.links[link.0].joints).all(|parent| parent.0 < k)
    };
    let order: Vec<usize> = if robot.joints.iter().enumerate().all(is_below) {
        (0..robot.joints.len()).collect()
    } else {
        robot.links.iter().flat_map(|link| &link.joints).map(|joint| joint.0).collect()
    };
    let follows = |k: usize| robot.couplings.iter().any(|coupling| coupling.follower.0 == k);
    order.into_iter().filter(|k| !follows(*k)).map(|k| &robot.joints[k]).collect()
}

/// The range that a joint's readings are a fraction of \[rad\], and a note: a gripper from 0 to 1, or from 0 to 100.
fn fraction(joint: &SeenJoint, mover: &Mover, log: &Seen) -> Option<((f64, [f64; 2]), &'static str)> {
    let name = joint.name.as_deref()?;
    let range = mover.limit_rad.filter(|[low, high]| high > low && (is_hand(name) || is_hand(&mover.name)))?;
    let said = |words: &str| log.source.notes.iter().any(|note| note.starts_with(&format!("{name}: {words}")));
    if said("0 to 100") {
        return Some(((100.0, range), "from 0 to 100, taken to be percent of the description's range"));
    }
    let [low, high] = joint.range_rad;
    (low >= -0.02 && high <= 1.02 && said("from 0 to 1"))
        .then_some(((1.0, range), "from 0 to 1, taken to be a fraction of the description's range"))
}

/// Our columns of a joint, and what they are called under the name that it has in its log.
fn own_names(joint: &SeenJoint) -> [(&'static str, String); 5] {
    let prefix = joint.name.as_ref().map_or_else(String::new, |name| format!("{name}."));
    ["q", "q_ref", "tau", "drive", "dq"].map(|column| (column, format!("{prefix}{column}")))
}

/// Adds the columns of a joint under the robot's name of it.
fn map(log: &Seen, joint: &SeenJoint, mover: &Mover, range: Option<((f64, [f64; 2]), &str)>, columns: &mut Columns) {
    let name = |column: &str| format!("{}.{column}", mover.name);
    for (column, own) in own_names(joint) {
        let Some(channel) = log.source.ours(&own) else { continue };
        let mut spec = match (log.columns.get(&own), column) {
            (Some(told), _) => told.clone(),
            (None, "dq") => rate(&channel.theirs, columns.get(&name("q"))),
            (None, _) => ColumnSpec::named(&channel.theirs),
        };
        if let (Some(((whole, [low, high]), _)), "q" | "q_ref") = (range, column) {
            spec.unit = Some(Unit::Ticks { per_rev: rounded(TAU * whole / (high - low)) });
            spec.zero = rounded(-low);
        }
        columns.0.insert(name(column), spec);
    }
}

/// A rate of which nobody tells anything: in the unit that goes with its angle's, and with its sign.
fn rate(theirs: &str, angle: Option<&ColumnSpec>) -> ColumnSpec {
    let (unit, is_reversed) = angle.map_or((None, false), |angle| (angle.unit, angle.is_reversed));
    ColumnSpec { unit, is_reversed, ..ColumnSpec::named(theirs) }
}

fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// A remark where a joint goes where the description says it cannot.
fn beyond(joint: &SeenJoint, mover: &Mover) -> Option<String> {
    const SLACK_RAD: f64 = 0.1;
    let what = mover.beyond_limits("read", joint.range_rad, SLACK_RAD)?;
    Some(format!("{what}: is its zero or sign another?"))
}
