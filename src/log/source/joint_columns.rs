//! Where a topic's messages stand in the columns of a table.

use super::message::Kind;

/// Cells of position, velocity and effort.
pub(super) type Fields = [Option<usize>; 3];

/// Columns of one topic.
#[derive(Debug)]
pub(super) struct Columns {
    pub topic: String,
    pub kind: Kind,
    pub stamp: Stamp,
    pub content: Content,
}

/// Where the stamp of a message stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stamp {
    /// In one cell, of so many nanoseconds each.
    One(usize, i64),
    /// In one cell, of a unit that its steps tell.
    Unknown(usize),
    /// Seconds and nanoseconds.
    Two(usize, usize),
}

#[derive(Debug)]
pub(super) enum Content {
    /// A cell for each joint and field: position, velocity, effort.
    Wide { names: Names, cells: Vec<Fields> },
    /// Cells with lists: names, and the three fields.
    Lists { names: usize, cells: Fields },
    /// One joint a row.
    Long { name: usize, cells: Fields },
}

#[derive(Debug)]
pub(super) enum Names {
    Known(Vec<String>),
    /// In cells of each row.
    Cells(Vec<usize>),
}

/// The field that a word is: 0 position, 1 velocity, 2 effort.
pub(super) fn field(word: &str) -> Option<usize> {
    match word {
        "position" | "positions" => Some(0),
        "velocity" | "velocities" => Some(1),
        "effort" | "efforts" => Some(2),
        _ => None,
    }
}

/// A name and its number: `position[3]`, `position.3`, `position_3`, `position3`.
pub(super) fn numbered(word: &str) -> Option<(&str, usize)> {
    let word = word.strip_suffix(']').unwrap_or(word);
    let digits = word.len() - word.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let (name, number) = word.split_at(word.len() - digits);
    Some((name.trim_end_matches(['[', '.', '_']), number.parse().ok().filter(|number| *number < 512)?))
}

/// The fields of a joint in a list of joints.
pub(super) fn fields_of<'a>(joints: &'a mut Vec<(String, Fields)>, joint: &str) -> &'a mut Fields {
    let at = joints.iter().position(|(name, _)| name == joint).unwrap_or(joints.len());
    if at == joints.len() {
        joints.push((joint.to_owned(), [None; 3]));
    }
    &mut joints[at].1
}
