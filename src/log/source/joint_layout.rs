//! Where messages of joints stand in a table, by its header and the row after it.

use super::guess::{guess, is_asked};
use super::joint_columns::{Columns, Content, Fields, Names, Stamp, field, fields_of, numbered};
use super::message::Kind;
use super::plotjuggler;
use crate::log::column::Column;

/// How the messages stand in the rows.
#[derive(Debug)]
pub(super) struct Layout {
    pub topics: Vec<Columns>,
}

impl Layout {
    /// Recognises a layout by the header and the row after it; `None`: none of these.
    pub fn find(names: &[String], first: &[String]) -> Option<Self> {
        let plotted = plotjuggler::topics(names);
        if !plotted.is_empty() {
            return Some(Self { topics: plotted });
        }
        let one = frame(names, first).or_else(|| per_joint(names))?;
        Some(Self { topics: vec![one] })
    }
}

fn position(names: &[String], wanted: &[&str]) -> Option<usize> {
    names.iter().position(|name| wanted.contains(&name.to_lowercase().as_str()))
}

/// The stamp of a frame: of the header where it has one.
fn stamp(names: &[String]) -> Option<Stamp> {
    let parts = |sec: &[&str], nano: &[&str]| Some(Stamp::Two(position(names, sec)?, position(names, nano)?));
    let sec = ["header.stamp.secs", "header.stamp.sec", "header_stamp_sec", "stamp.sec", "sec", "secs"];
    let nano = [
        "header.stamp.nsecs",
        "header.stamp.nanosec",
        "header_stamp_nanosec",
        "stamp.nanosec",
        "nanosec",
        "nsecs",
        "nsec",
    ];
    parts(&sec, &nano)
        .or_else(|| Some(Stamp::One(position(names, &["field.header.stamp"])?, 1)))
        .or_else(|| Some(Stamp::Unknown(position(names, &["header.stamp", "stamp"])?)))
        .or_else(|| Some(Stamp::One(position(names, &["%time"])?, 1)))
        .or_else(|| {
            Some(Stamp::Unknown(position(names, &["time", "timestamp", "t", "ts", "__time", "rosbagtimestamp"])?))
        })
}

/// A frame with the message's own fields: lists, numbered columns, or one joint a row.
fn frame(names: &[String], first: &[String]) -> Option<Columns> {
    let bare: Vec<String> = names.iter().map(|name| name.trim_start_matches("field.").to_lowercase()).collect();
    let stamp = stamp(names)?;
    let topic = "joint_states".to_owned();
    let of = |content| Columns { topic: topic.clone(), kind: Kind::JointState, stamp, content };
    let whole = ["position", "velocity", "effort"].map(|word| bare.iter().position(|name| name == word));
    let name = bare.iter().position(|name| matches!(name.as_str(), "name" | "joint" | "joint_name" | "names"));
    if let (Some(name), Some(at)) = (name, whole[0]) {
        let is_list = |cell: usize| {
            first
                .get(cell)
                .is_some_and(|text| text.trim_start().starts_with(['[', '(', 'a']) && text.contains(['[', '(']))
        };
        return Some(of(match is_list(name) && is_list(at) {
            true => Content::Lists { names: name, cells: whole },
            false => Content::Long { name, cells: whole },
        }));
    }
    let mut cells: Vec<Fields> = Vec::new();
    let mut titles: Vec<Option<usize>> = Vec::new();
    for (cell, bare) in bare.iter().enumerate() {
        let Some((word, number)) = numbered(bare) else { continue };
        if word == "name" {
            titles.resize(titles.len().max(number + 1), None);
            titles[number] = Some(cell);
        } else if let Some(field) = field(word) {
            cells.resize(cells.len().max(number + 1), [None; 3]);
            cells[number][field] = Some(cell);
        }
    }
    let is_whole = !cells.is_empty() && cells.iter().all(|cells| cells[0].is_some());
    let titled: Vec<usize> = titles.into_iter().flatten().collect();
    let names = match titled.len() == cells.len() {
        true => Names::Cells(titled),
        false => Names::Known((1..=cells.len()).map(|k| format!("joint{k}")).collect()),
    };
    is_whole.then(|| of(Content::Wide { names, cells }))
}

/// A column for each joint and field: `elbow_position`, `elbow.velocity`, `elbow/effort`.
fn per_joint(names: &[String]) -> Option<Columns> {
    let mut joints: Vec<(String, Fields)> = Vec::new();
    for (cell, name) in names.iter().enumerate() {
        let Some((joint, last)) = name.rsplit_once(['_', '.', '/', ' ']) else { continue };
        let Some(field) = field(&last.to_lowercase()).filter(|_| !joint.is_empty()) else { continue };
        // What is asked stands beside what is read: a table of both, whose names tell which is which.
        if is_asked(joint) {
            return None;
        }
        fields_of(&mut joints, joint)[field] = Some(cell);
    }
    // One column of that kind is a name like any other; other columns may hold what was asked, and units of their own.
    let is_state = joints.len() > 1 && joints.iter().all(|(_, cells)| cells[0].is_some());
    let others =
        names.iter().enumerate().filter(|(cell, _)| !joints.iter().any(|(_, cells)| cells.contains(&Some(*cell))));
    let mut others = others.filter_map(|(_, name)| guess(name));
    if !is_state || others.any(|guess| guess.column != Column::Time) {
        return None;
    }
    let (names_of, cells) = joints.into_iter().unzip();
    let content = Content::Wide { names: Names::Known(names_of), cells };
    Some(Columns { topic: "joint_states".to_owned(), kind: Kind::JointState, stamp: stamp(names)?, content })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(header: &str, first: &str) -> Option<Layout> {
        let cells = |row: &str| row.split(',').map(str::to_owned).collect::<Vec<String>>();
        Layout::find(&cells(header), &cells(first))
    }

    #[test]
    fn tables_of_tools_are_told_by_their_names() {
        let echo = find("%time,field.header.stamp,field.name0,field.position0,field.velocity0", "1,1,a,0,0").unwrap();
        assert_eq!(echo.topics[0].stamp, Stamp::One(1, 1));
        let long = find("time,joint,position,effort", "0,elbow,1,2").unwrap();
        assert!(matches!(long.topics[0].content, Content::Long { name: 1, cells: [Some(2), None, Some(3)] }));
        let wide = find("time,elbow_position,elbow_velocity,wrist_position", "0,1,2,3").unwrap();
        assert!(matches!(&wide.topics[0].content, Content::Wide { cells, .. } if cells.len() == 2));
    }

    #[test]
    fn other_tables_are_none_of_these() {
        for header in [
            "time,angle",
            "t,position",
            "time,elbow_position,elbow_target",
            "stamp,x,y",
            "name,position",
            "time,present_position,goal_position",
        ] {
            assert!(find(header, "0,1,2").is_none(), "{header}");
        }
    }
}
