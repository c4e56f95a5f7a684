//! Logs of a joint and of a robot, made of a source's channels.

use std::path::Path;

use super::channel::{Channel, Rows, Source};
use super::heading::{BASE, FELT};
use crate::log::column::{Column, column_of};
use crate::log::error::LogError;
use crate::log::format::Format;
use crate::log::place::Place;
use crate::log::robot_log::{BaseColumns, JointColumns, RobotLog};
use crate::log::types::{Log, Stamped};

/// Torques are read with the angle.
const TORQUE_APART: &str = "torques have stamps of their own: at each reading of the angle the last of them is taken";

impl Source {
    /// The log of one joint; without a name that of the only one.
    ///
    /// # Errors
    /// [`LogError`] where the source has no such joint, or several and none was named.
    pub fn joint_log(&self, joint: Option<&str>) -> Result<Log, LogError> {
        let mut own = self.shell(joint);
        for (own, channel) in own.channels.iter_mut().zip(&self.channels).filter(|(own, _)| is_of(own, joint)) {
            own.values.clone_from(&channel.values);
        }
        joint_log(own, joint)
    }

    /// As [`Source::joint_log`], taking the joint's samples out of the source: those of a long log are held once.
    ///
    /// # Errors
    /// As [`Source::joint_log`].
    pub fn take_joint_log(&mut self, joint: Option<&str>) -> Result<Log, LogError> {
        let mut own = self.shell(joint);
        for (own, channel) in own.channels.iter_mut().zip(&mut self.channels).filter(|(own, _)| is_of(own, joint)) {
            own.values = std::mem::take(&mut channel.values);
        }
        joint_log(own, joint)
    }

    /// The same without samples and places, with the stamps of a joint.
    fn shell(&self, joint: Option<&str>) -> Source {
        let is_used =
            |clock: usize| self.channels.iter().any(|channel| channel.clock == clock && is_of(channel, joint));
        let clocks = self.clocks.iter().enumerate();
        let clocks = clocks.map(|(k, t_s)| if is_used(k) { t_s.clone() } else { Vec::new() }).collect();
        let bare = |channel: &Channel| Channel {
            ours: channel.ours.clone(),
            theirs: channel.theirs.clone(),
            clock: channel.clock,
            values: Vec::new(),
            cell: channel.cell,
            spec: None,
        };
        Source {
            file: self.file.clone(),
            format: self.format,
            clocks,
            from_s: self.from_s,
            channels: self.channels.iter().map(bare).collect(),
            ignored: self.ignored.clone(),
            notes: self.notes.clone(),
            rows: self.rows.as_ref().map(|_| Rows::default()),
            stated: self.stated.clone(),
        }
    }
}

/// Whether a channel is a joint's; without a name there is only one joint.
fn is_of(channel: &Channel, joint: Option<&str>) -> bool {
    let of = channel.ours.as_deref().and_then(column_of);
    of.is_some_and(|(own, _)| joint.is_none() || own == joint)
}

/// The log of one joint; without a name that of the only one.
///
/// # Errors
/// [`LogError`] where the source has no such joint, or several and none was named.
pub(in crate::log) fn joint_log(mut source: Source, joint: Option<&str>) -> Result<Log, LogError> {
    let named = |source: &Source| source.joints().into_iter().flatten().map(str::to_owned).collect::<Vec<_>>();
    let found = source.joints();
    let prefix = match (joint, &found[..]) {
        (_, []) => return Err(no_angle(&source)),
        (None, [one]) => one.map_or_else(String::new, |joint| format!("{joint}.")),
        (Some(joint), all) if all.contains(&Some(joint)) => format!("{joint}."),
        (Some(joint), _) => {
            let at = Box::new(Place::in_file(&source.file));
            return Err(LogError::NoSuchJoint { at, joint: joint.to_owned(), joints: named(&source) });
        }
        (None, _) => {
            return Err(LogError::SeveralJoints { at: Box::new(Place::in_file(&source.file)), joints: named(&source) });
        }
    };
    let mut of = |column: Column| take(&mut source, &format!("{prefix}{}", column.name()));
    let [angle, speed, torque, setpoint, drive] =
        [Column::Angle, Column::Speed, Column::Torque, Column::Setpoint, Column::Drive].map(&mut of);
    let Some(angle) = angle else { return Err(no_angle(&source)) };
    let is_table = source.rows.take().is_some();
    let clock = angle.clock;
    let is_apart = torque.as_ref().is_some_and(|torque| torque.clock != clock);
    let mut joint = OfJoint::new(&source, angle, setpoint, torque, drive);
    let first = joint.first_sample(&source, clock);
    joint.from(first);
    let dq_rad_s = speed.filter(|speed| speed.clock == clock).map(|speed| speed.values[first..].to_vec());
    let mut notes = std::mem::take(&mut source.notes);
    notes.extend(is_apart.then(|| TORQUE_APART.to_owned()));
    notes.extend(head_note(&source.clocks[clock], first));
    let mut before_s = source.clocks.swap_remove(clock);
    let t_s = before_s.split_off(first);
    too_short(&source.file, &t_s, &before_s, joint.asked_from_s())?;
    let others = source.channels.iter().filter(|channel| channel.ours.is_some());
    let others: Vec<String> = others.map(|channel| channel.theirs.clone()).collect();
    let ignored_columns = if is_table { source.ignored } else { [source.ignored, others].concat() };
    let OfJoint { q_rad, q_ref_rad, setpoints, tau_nm, drive } = joint;
    Ok(Log { file: source.file, t_s, q_rad, dq_rad_s, tau_nm, q_ref_rad, setpoints, drive, ignored_columns, notes })
}

/// The log of all joints.
///
/// # Errors
/// [`LogError`] where the source has no joint that has a name.
pub(in crate::log) fn robot_log(mut source: Source) -> Result<RobotLog, LogError> {
    let names: Vec<String> = source.joints().into_iter().flatten().map(str::to_owned).collect();
    let clock_of = |name: &String| source.ours(&format!("{name}.q")).map(|channel| channel.clock);
    // The angles' own stamps are the log's; where joints have different ones, those of most joints.
    let clocks: Vec<usize> = names.iter().filter_map(clock_of).collect();
    let most = |clock: &usize| (clocks.iter().filter(|other| *other == clock).count(), std::cmp::Reverse(*clock));
    let Some(clock) = clocks.iter().copied().max_by_key(most) else { return Err(no_joint(&source)) };
    let mut notes = std::mem::take(&mut source.notes);
    let mut joints = Vec::with_capacity(names.len());
    let (mut first, mut last) = (0, source.clocks[clock].len());
    let mut moved_over = Vec::new();
    for name in names {
        let mut of = |column: Column| take(&mut source, &format!("{name}.{}", column.name()));
        let [angle, torque, setpoint, drive] =
            [Column::Angle, Column::Torque, Column::Setpoint, Column::Drive].map(&mut of);
        let Some(mut angle) = angle else { continue };
        if angle.clock != clock {
            let (t_s, own) = (&source.clocks[clock], &source.clocks[angle.clock]);
            let (Some(from), Some(to)) = (own.first(), own.last()) else { continue };
            first = first.max(t_s.partition_point(|t| t < from));
            last = last.min(t_s.partition_point(|t| t <= to));
            angle.values = t_s.iter().map(|t| between(own, &angle.values, *t)).collect();
            angle.clock = clock;
            moved_over.push(name.clone());
        }
        if torque.as_ref().is_some_and(|torque| torque.clock != clock) && !notes.iter().any(|note| note == TORQUE_APART)
        {
            notes.push(TORQUE_APART.to_owned());
        }
        let joint = OfJoint::new(&source, angle, setpoint, torque, drive);
        first = first.max(joint.first_sample(&source, clock));
        joints.push((name, joint));
    }
    if !moved_over.is_empty() {
        let names = moved_over.join(", ");
        notes.push(format!(
            "readings of {names} have stamps of their own: they stand between two of them on a straight line"
        ));
    }
    let first = first.min(last);
    notes.extend(head_note(&source.clocks[clock], first));
    let t_s = source.clocks[clock][first..last].to_vec();
    let asked_from_s = joints.iter().filter_map(|(_, joint)| joint.asked_from_s()).reduce(f64::max);
    too_short(&source.file, &t_s, &source.clocks[clock][..first], asked_from_s)?;
    let joints = joints.into_iter().map(|(name, mut joint)| {
        joint.until(last);
        joint.from(first);
        let OfJoint { q_rad, q_ref_rad, setpoints, tau_nm, drive } = joint;
        JointColumns { name, q_rad, q_ref_rad, setpoints, tau_nm, drive }
    });
    let joints: Vec<JointColumns> = joints.collect();
    let mut plain =
        |name: &str| take(&mut source, name).filter(|c| c.clock == clock).map(|c| c.values[first..last].to_vec());
    let [x_m, y_m, z_m, roll_rad, pitch_rad, yaw_rad] = BASE.map(&mut plain);
    let [x, y, z] = FELT.map(&mut plain);
    let base = BaseColumns { x_m, y_m, z_m, roll_rad, pitch_rad, yaw_rad };
    Ok(RobotLog {
        file: source.file,
        t_s,
        joints,
        base: (base != BaseColumns::default()).then_some(base),
        acceleration_m_s2: x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]),
        ignored_columns: source.ignored,
        notes,
    })
}

/// What a joint's log has beside its stamps, as long as the angle.
struct OfJoint {
    q_rad: Vec<f64>,
    q_ref_rad: Option<Vec<f64>>,
    setpoints: Option<Stamped>,
    tau_nm: Option<Vec<f64>>,
    drive: Option<Vec<bool>>,
}

impl OfJoint {
    fn new(
        source: &Source,
        angle: Channel,
        setpoint: Option<Channel>,
        torque: Option<Channel>,
        drive: Option<Channel>,
    ) -> Self {
        let t_s = &source.clocks[angle.clock];
        let at_samples = |channel: Channel| match channel.clock == angle.clock {
            true => channel.values,
            false => in_force(&source.clocks[channel.clock], &channel.values, t_s),
        };
        let is_apart = |channel: &&Channel| channel.clock != angle.clock;
        let setpoints = setpoint
            .as_ref()
            .filter(is_apart)
            .map(|channel| Stamped { t_s: source.clocks[channel.clock].clone(), values: channel.values.clone() });
        let q_ref_rad = setpoint.map(at_samples);
        let tau_nm = torque.map(at_samples);
        let drive = drive.map(|channel| at_samples(channel).iter().map(|on| *on == 1.0).collect());
        Self { q_rad: angle.values, q_ref_rad, setpoints, tau_nm, drive }
    }

    /// When something is first asked of the joint, where that has stamps of its own \[s\].
    fn asked_from_s(&self) -> Option<f64> {
        self.setpoints.as_ref().and_then(|setpoints| setpoints.t_s.first()).copied()
    }

    /// The first sample at which something is asked of the joint, where that has stamps of its own.
    fn first_sample(&self, source: &Source, clock: usize) -> usize {
        self.asked_from_s().map_or(0, |first_s| source.clocks[clock].partition_point(|t| *t < first_s))
    }

    fn from(&mut self, first: usize) {
        let cut = |values: &mut Vec<f64>| drop(values.drain(..first.min(values.len())));
        cut(&mut self.q_rad);
        self.q_ref_rad.iter_mut().for_each(cut);
        self.tau_nm.iter_mut().for_each(cut);
        self.drive.iter_mut().for_each(|drive| drop(drive.drain(..first.min(drive.len()))));
    }

    fn until(&mut self, last: usize) {
        self.q_rad.truncate(last);
        self.q_ref_rad.iter_mut().chain(&mut self.tau_nm).for_each(|values| values.truncate(last));
        self.drive.iter_mut().for_each(|drive| drive.truncate(last));
    }
}

/// Takes a channel that we call so out of the source.
fn take(source: &mut Source, ours: &str) -> Option<Channel> {
    let channel = source.channels.iter_mut().find(|channel| channel.ours.as_deref() == Some(ours))?;
    let taken = Channel { values: std::mem::take(&mut channel.values), ..channel.clone() };
    channel.ours = None;
    Some(taken)
}

/// The value in force at each instant: that of the last sample not after it, before the first the first.
fn in_force(own_s: &[f64], values: &[f64], at_s: &[f64]) -> Vec<f64> {
    let mut k = 0;
    let value = |t: &f64| {
        while own_s.get(k + 1).is_some_and(|next| next <= t) {
            k += 1;
        }
        values.get(k).copied().unwrap_or(0.0)
    };
    at_s.iter().map(value).collect()
}

/// On the straight line between the samples about an instant; beyond the ends the end's value.
fn between(own_s: &[f64], values: &[f64], at_s: f64) -> f64 {
    let after = own_s.partition_point(|t| *t <= at_s).clamp(1, own_s.len().saturating_sub(1).max(1));
    let (Some(&t0), Some(&t1)) = (own_s.get(after - 1), own_s.get(after)) else {
        return values.first().copied().unwrap_or(0.0);
    };
    let share = ((at_s - t0) / (t1 - t0)).clamp(0.0, 1.0);
    values[after - 1] + share * (values[after] - values[after - 1])
}

fn head_note(t_s: &[f64], first: usize) -> Option<String> {
    let (start, from) = (t_s.first()?, t_s.get(first)?);
    (first > 0)
        .then(|| format!("the first {:.3} s are left out: nothing had been asked of every joint yet", from - start))
}

/// Refuses a log of which too little is left, and says so where that is because the setpoints begin after the readings.
fn too_short(file: &Path, t_s: &[f64], before_s: &[f64], asked_from_s: Option<f64>) -> Result<(), LogError> {
    if t_s.len() >= 2 {
        return Ok(());
    }
    let at = Box::new(Place::in_file(file));
    let apart = before_s.last().copied().zip(asked_from_s).filter(|(read_to_s, from_s)| from_s > read_to_s);
    Err(match apart {
        Some((read_to_s, asked_from_s)) if t_s.is_empty() => LogError::NoOverlap { at, read_to_s, asked_from_s },
        _ => LogError::TooFewSamples { at, samples: t_s.len() },
    })
}

/// The error about a file that has no joint's angle.
pub(super) fn no_angle(source: &Source) -> LogError {
    missing(source, Column::Angle.name())
}

fn no_joint(source: &Source) -> LogError {
    missing(source, "<joint>.q")
}

fn missing(source: &Source, column: &str) -> LogError {
    let found = source.channels.iter().map(|channel| channel.theirs.clone()).chain(source.ignored.iter().cloned());
    let hint = match source.format {
        Format::Csv | Format::StaggeredCsv => None,
        format => {
            let notes: String = source.notes.iter().map(|note| format!("; {note}")).collect();
            Some(format!("the file is {format}; name the channel in [columns]{notes}"))
        }
    };
    let at = Box::new(Place::in_file(&source.file));
    LogError::MissingColumn { at, column: column.to_owned(), found: found.collect(), hint }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(channels: &[(&str, usize, &[f64])], clocks: &[&[f64]]) -> Source {
        let mut source = Source::new("a.db3".into(), Format::Rosbag2);
        source.clocks = clocks.iter().map(|clock| clock.to_vec()).collect();
        source.channels = channels
            .iter()
            .map(|(ours, clock, values)| Channel {
                ours: Some((*ours).to_owned()),
                theirs: format!("/x/{ours}"),
                clock: *clock,
                values: values.to_vec(),
                cell: None,
                spec: None,
            })
            .collect();
        source
    }

    #[test]
    fn setpoints_keep_their_own_stamps_and_what_precedes_them_is_left_out() {
        let made = source(
            &[("a.q", 0, &[1.0, 2.0, 3.0, 4.0]), ("a.q_ref", 1, &[5.0, 6.0])],
            &[&[0.0, 0.1, 0.2, 0.3], &[0.05, 0.25]],
        );
        let log = joint_log(made, Some("a")).unwrap();
        assert_eq!((log.t_s, log.q_rad), (vec![0.1, 0.2, 0.3], vec![2.0, 3.0, 4.0]));
        assert_eq!(log.q_ref_rad.unwrap(), [5.0, 5.0, 6.0]);
        assert_eq!(log.setpoints.unwrap().t_s, [0.05, 0.25]);
        assert!(log.notes[0].contains("first 0.100 s"), "{:?}", log.notes);
    }

    #[test]
    fn setpoints_by_another_clock_are_no_short_recording() {
        let made =
            || source(&[("a.q", 0, &[1.0, 2.0]), ("a.q_ref", 1, &[5.0, 6.0])], &[&[0.0, 0.1], &[3000.0, 3000.1]]);
        for error in [joint_log(made(), Some("a")).unwrap_err(), robot_log(made()).unwrap_err()] {
            let message = error.to_string();
            assert!(message.contains("2999.900 s after the last reading") && message.contains("clocks"), "{message}");
        }
    }

    #[test]
    fn a_joint_that_is_read_at_other_times_is_told() {
        let made = source(
            &[("a.q", 0, &[0.0; 4]), ("c.q", 0, &[0.0; 4]), ("b.q", 1, &[1.0, 3.0])],
            &[&[0.0, 0.1, 0.2, 0.3], &[0.05, 0.25]],
        );
        let log = robot_log(made).unwrap();
        assert_eq!(log.t_s, [0.1, 0.2]);
        let b = &log.joint("b").unwrap().q_rad;
        assert!((b[0] - 1.5).abs() < 1e-12 && (b[1] - 2.5).abs() < 1e-12, "{b:?}");
        assert!(log.notes[0].contains("readings of b"));
    }

    #[test]
    fn one_of_several_has_to_be_named() {
        let made = || source(&[("a.q", 0, &[0.0; 2]), ("b.q", 0, &[0.0; 2])], &[&[0.0, 0.1]]);
        assert!(matches!(joint_log(made(), None), Err(LogError::SeveralJoints { .. })));
        assert!(joint_log(made(), Some("c")).unwrap_err().to_string().contains("`a`, `b`"));
        assert_eq!(joint_log(made(), Some("b")).unwrap().ignored_columns, ["/x/a.q"]);
    }
}
