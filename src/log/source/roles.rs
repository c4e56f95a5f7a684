//! What of the messages is a reading and what a setpoint, and whose a number without a name is.

use super::channel::Source;
use super::message::Kind;

/// Instants at which setpoints without names are compared with readings.
const COMPARED: usize = 2000;

/// Our name for a field of a topic, where it has one.
pub(super) fn role(topic: &str, kind: Kind, asked: bool, field: &str) -> Option<&'static str> {
    match (asked, field) {
        (false, "position") => Some("q"),
        (false, "velocity") => Some("dq"),
        (false, "effort") => Some("tau"),
        (true, "position") if kind.is_unnamed() => array_role(topic),
        (true, "position") => Some("q_ref"),
        _ => None,
    }
}

fn array_role(topic: &str) -> Option<&'static str> {
    let topic = topic.to_lowercase();
    match topic {
        topic if topic.contains("effort") || topic.contains("torque") => Some("tau"),
        topic if topic.contains("velocity") => None,
        _ => Some("q_ref"),
    }
}

/// Gives setpoints without names the joints whose readings they are nearest to, and says so. Where another topic names
/// what is asked of those joints, that stands.
pub(super) fn name_by_readings(source: &mut Source, asked: &[usize], topic: &str, kind: Kind) {
    let joints: Vec<String> = source.joints().into_iter().flatten().map(str::to_owned).collect();
    let Some(role) = array_role(topic) else {
        source.notes.push(format!("{topic}: velocities, which nothing here is driven by"));
        return;
    };
    let found = match kind {
        Kind::Number => by_topic(&joints, topic).map(|joint| (vec![joint], "by the topic's name")),
        _ => by_distance(source, asked, &joints, role),
    };
    let Some((assigned, how)) = found else {
        if kind != Kind::Number {
            let numbers = asked.len();
            source.notes.push(format!("{topic}: {numbers} numbers without names; say in [columns] whose they are"));
        }
        return;
    };
    let ours: Vec<String> = assigned.iter().map(|joint| format!("{}.{role}", joints[*joint])).collect();
    if ours.iter().any(|ours| source.ours(ours).is_some()) && role == "q_ref" {
        source.notes.push(format!("{topic}: left out, another topic names what is asked of these joints"));
        return;
    }
    for (k, ours) in asked.iter().zip(ours) {
        source.channels.iter_mut().filter(|c| c.ours.as_ref() == Some(&ours)).for_each(|c| c.ours = None);
        source.channels[*k].ours = Some(ours);
    }
    let names: Vec<&str> = assigned.iter().map(|joint| joints[*joint].as_str()).collect();
    source.notes.push(format!("{topic}: taken to be {role} of {} {how} (a guess)", names.join(", ")));
}

/// The joint that a topic is named after; of several the one with the longest name.
fn by_topic(joints: &[String], topic: &str) -> Option<usize> {
    let lower = topic.to_lowercase();
    let is_in = |name: &String| {
        let name = name.to_lowercase();
        let short = name.strip_suffix("_joint").unwrap_or(&name);
        lower.contains(short).then_some(short.len())
    };
    let lengths = joints.iter().enumerate().filter_map(|(k, name)| Some((is_in(name)?, k)));
    lengths.max_by_key(|(length, k)| (*length, std::cmp::Reverse(*k))).map(|(_, k)| k)
}

/// The joint of each channel, by the readings that it is nearest to, or in their order, and how it was told.
fn by_distance(source: &Source, asked: &[usize], joints: &[String], role: &str) -> Option<(Vec<usize>, &'static str)> {
    let distances: Vec<Vec<f64>> =
        asked.iter().map(|k| joints.iter().map(|joint| distance(source, *k, joint)).collect()).collect();
    let least =
        |row: &Vec<f64>| row.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(usize::MAX, |(at, _)| at);
    let nearest: Vec<usize> = distances.iter().map(least).collect();
    let distinct = nearest.iter().enumerate().all(|(k, joint)| *joint < joints.len() && !nearest[..k].contains(joint));
    match role {
        "q_ref" if distinct => Some((nearest, "by the readings that they are nearest to")),
        _ if asked.len() == joints.len() => Some(((0..asked.len()).collect(), "in the order of the readings")),
        _ => None,
    }
}

/// Mean distance of a setpoint from a joint's reading \[rad\].
fn distance(source: &Source, asked: usize, joint: &str) -> f64 {
    let asked = &source.channels[asked];
    let Some(read) = source.ours(&format!("{joint}.q")) else { return f64::INFINITY };
    let (asked_s, read_s) = (source.t_s(asked), source.t_s(read));
    let stride = (asked_s.len() / COMPARED).max(1);
    let apart = asked_s.iter().zip(&asked.values).step_by(stride).filter_map(|(t, value)| {
        let after = read_s.partition_point(|other| other <= t);
        Some((value - read.values.get(after.checked_sub(1)?)?).abs())
    });
    let (sum, count) = apart.fold((0.0, 0), |(sum, count), apart| (sum + apart, count + 1));
    if count == 0 { f64::INFINITY } else { sum / f64::from(count) }
}
