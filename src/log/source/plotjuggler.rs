//! Columns of PlotJuggler: a path for each field of a message, and `__time` of its receipt.

use std::collections::BTreeMap;

use super::joint_columns::{Columns, Content, Fields, Names, Stamp, field, fields_of, numbered};
use super::message::{Kind, is_command};
use super::stamps::NS;

/// The two parts of a controller's state, as its versions call them.
const READ: [&str; 2] = ["feedback", "actual"];
const ASKED: [&str; 2] = ["reference", "desired"];

/// Paths by topic.
#[derive(Default)]
struct Paths<'a> {
    /// `/topic/joint/position`
    states: BTreeMap<&'a str, Vec<(String, Fields)>>,
    /// `/topic/position[0]`, `/topic/feedback/positions[0]`: joints without names.
    numbered: BTreeMap<&'a str, Vec<(String, Fields)>>,
    /// `/topic/data[0]`, `/topic/points[0]/positions[0]`
    arrays: BTreeMap<&'a str, Vec<(usize, usize)>>,
    /// `/topic/data` of a command.
    numbers: Vec<(&'a str, usize)>,
}

/// The topics of a table; none where it is not PlotJuggler's, or no joint is read in it.
pub(super) fn topics(names: &[String]) -> Vec<Columns> {
    let Some(time) = names.iter().position(|name| name == "__time") else { return Vec::new() };
    let mut paths = Paths::default();
    names.iter().enumerate().for_each(|(cell, name)| paths.add(cell, name));
    let stamp = |topic: &str| stamp_of(names, time, topic);
    let whole = |joints: Vec<(String, Fields)>| joints.into_iter().filter(|(_, cells)| cells[0].is_some());
    let wide = |topic: &str, kind: Kind, names: Vec<String>, cells: Vec<Fields>| {
        let content = Content::Wide { names: Names::Known(names), cells };
        Columns { topic: topic.to_owned(), kind, stamp: stamp(topic), content }
    };
    let is_named =
        paths.states.iter().any(|(topic, joints)| !is_command(topic) && joints.iter().any(|(_, c)| c[0].is_some()));
    let mut topics: Vec<Columns> = Vec::new();
    for (topic, joints) in paths.states {
        let (names, cells): (Vec<String>, Vec<Fields>) = whole(joints).unzip();
        if !cells.is_empty() {
            topics.push(wide(topic, Kind::JointState, names, cells));
        }
    }
    for (topic, joints) in paths.numbered {
        let (names, cells): (Vec<String>, Vec<Fields>) = whole(joints).unzip();
        match is_named {
            _ if cells.is_empty() => {}
            false => topics.push(wide(topic, Kind::JointState, names, cells)),
            // Whose they are, the readings that have names tell.
            true if is_command(topic) => topics.push(wide(topic, Kind::MultiArray, Vec::new(), cells)),
            true => {}
        }
    }
    if topics.iter().all(|columns| is_command(&columns.topic)) {
        return Vec::new();
    }
    for (topic, mut numbers) in paths.arrays {
        numbers.sort_unstable();
        let cells: Vec<Fields> = numbers.iter().map(|(_, cell)| [Some(*cell), None, None]).collect();
        topics.push(wide(topic, Kind::MultiArray, Vec::new(), cells));
    }
    topics.extend(
        paths
            .numbers
            .iter()
            .map(|(topic, cell)| wide(topic, Kind::Number, Vec::new(), vec![[Some(*cell), None, None]])),
    );
    topics
}

impl<'a> Paths<'a> {
    fn add(&mut self, cell: usize, name: &'a str) {
        let Some((before, last)) = name.rsplit_once('/') else { return };
        if let (Some(field), Some((topic, joint))) = (field(last), before.rsplit_once('/')) {
            fields_of(self.states.entry(topic).or_default(), joint)[field] = Some(cell);
            return;
        }
        if last == "data" && is_command(before) {
            self.numbers.push((before, cell));
            return;
        }
        let Some((word, number)) = numbered(last) else { return };
        let trajectory = before.strip_suffix("/points[0]").or_else(|| before.strip_suffix("/points.0"));
        let part = before.rsplit('/').next().unwrap_or_default();
        let joint = format!("joint{}", number + 1);
        match (word, trajectory, field(word)) {
            ("data", None, _) => self.arrays.entry(before).or_default().push((number, cell)),
            ("positions", Some(topic), _) => self.arrays.entry(topic).or_default().push((number, cell)),
            // Of a controller's state, not of its errors; and of a JointState whose names were not plotted.
            (_, None, Some(field))
                if READ.contains(&part)
                    || ASKED.contains(&part)
                    || matches!(word, "position" | "velocity" | "effort") =>
            {
                fields_of(self.numbered.entry(before).or_default(), &joint)[field] = Some(cell);
            }
            _ => {}
        }
    }
}

/// The stamp of a topic: of its header, or, without one, that of the receipt.
fn stamp_of(names: &[String], time: usize, topic: &str) -> Stamp {
    let find = |name: String| names.iter().position(|other| *other == name);
    let of = |topic: &str| {
        let parts = |sec: &str, nano: &str| {
            let part = |word: &str| find(format!("{topic}/header/stamp/{word}"));
            Some(Stamp::Two(part(sec)?, part(nano)?))
        };
        let one = find(format!("{topic}/header/stamp")).map(|cell| Stamp::One(cell, NS));
        one.or_else(|| parts("sec", "nanosec")).or_else(|| parts("secs", "nsecs"))
    };
    // A part of a message has the header of the whole.
    let above = topic.rsplit_once('/').filter(|(_, part)| READ.contains(part) || ASKED.contains(part));
    of(topic).or_else(|| of(above?.0)).unwrap_or(Stamp::One(time, NS))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(header: &str) -> Vec<Columns> {
        topics(&header.split(',').map(str::to_owned).collect::<Vec<String>>())
    }

    #[test]
    fn states_and_arrays_have_the_stamps_of_their_headers() {
        let found = find("__time,/arm/elbow/position,/arm/header/stamp,/cmd/data[1],/cmd/data[0]");
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].topic.as_str(), found[0].stamp), ("/arm", Stamp::One(2, NS)));
        let Content::Wide { cells, .. } = &found[1].content else { panic!("numbers") };
        assert_eq!((found[1].stamp, cells[0][0]), (Stamp::One(0, NS), Some(4)));
    }

    #[test]
    fn a_controllers_state_is_read_and_asked_but_its_errors_are_neither() {
        let of = |part: &str| format!("/c/state/{part}/positions[0]");
        let header = format!("__time,{},{},{},/c/state/header/stamp", of("error"), of("feedback"), of("reference"));
        let found = find(&header);
        let seen: Vec<_> = found.iter().map(|one| (one.topic.as_str(), one.kind, one.stamp)).collect();
        let stamp = Stamp::One(4, NS);
        assert_eq!(
            seen,
            [("/c/state/feedback", Kind::JointState, stamp), ("/c/state/reference", Kind::JointState, stamp)]
        );
        // Beside readings that have names, they tell whose the setpoints are.
        let found = find(&(header + ",/joint_states/elbow/position"));
        let seen: Vec<_> = found.iter().map(|one| (one.topic.as_str(), one.kind)).collect();
        assert_eq!(seen, [("/joint_states", Kind::JointState), ("/c/state/reference", Kind::MultiArray)]);
    }

    #[test]
    fn a_table_in_which_nothing_is_read_is_none() {
        assert!(find("__time,/cmd/data[0],/joint_command/elbow/position").is_empty());
        assert_eq!(find("__time,/joint_states/position.0,/elbow/cmd/data").len(), 2);
    }
}
