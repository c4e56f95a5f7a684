//! Which joint of a robot a joint of a log is.

/// How a pair was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum How {
    /// The same name.
    Name,
    /// The same but for case, punctuation, and what stands before a `/`.
    Alike,
    /// By their order, the others being as many, or those of the log numbers from the first on.
    Order,
}

/// Pairs of joints, by their places in the two lists; joints of the log that are none of the robot's are in none.
pub(super) fn pairs(log: &[String], robot: &[String]) -> Vec<(usize, usize, How)> {
    let mut pairs = Vec::new();
    let mut taken = vec![false; robot.len()];
    let mut left: Vec<usize> = (0..log.len()).collect();
    let counts_from = counted_from(log);
    // Where one counts from 0 and the other from 1 the same number is another joint.
    let counts_otherwise = counts_from == Some(0) && !robot.iter().any(|name| bare(name) == bare(&log[0]));
    let by_name = if counts_otherwise { &[][..] } else { &[How::Name, How::Alike] };
    for &how in by_name {
        let is_same = |a: &str, b: &str| if how == How::Name { a == b } else { bare(a) == bare(b) };
        left.retain(|own| {
            let found = (0..robot.len()).find(|k| !taken[*k] && is_same(&log[*own], &robot[*k]));
            if let Some(at) = found {
                taken[at] = true;
                pairs.push((*own, at, how));
            }
            found.is_none()
        });
    }
    let free: Vec<usize> = (0..robot.len()).filter(|k| !taken[*k]).collect();
    // Names that differ are paired by order only where the rest is in the same order too.
    let in_order = pairs.windows(2).all(|pair| (pair[0].0 < pair[1].0) == (pair[0].1 < pair[1].1));
    let are_numbers = pairs.is_empty() && left.len() < free.len() && counts_from.is_some();
    if free.len() == left.len() && in_order || are_numbers {
        pairs.extend(left.into_iter().zip(free).map(|(own, at)| (own, at, How::Order)));
    }
    pairs.sort_unstable_by_key(|(own, _, _)| *own);
    pairs
}

/// The number from which on names count that differ by nothing else, where that is 0 or 1: joints of a log that leaves a
/// gripper out.
fn counted_from(names: &[String]) -> Option<usize> {
    let parts = |name: &String| {
        let word = name.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
        Some((name[word.len()..].parse::<usize>().ok()?, word))
    };
    let all = names.iter().map(parts).collect::<Option<Vec<_>>>()?;
    let is_next = |pair: &[(usize, String)]| pair[1].0 == pair[0].0 + 1 && pair[1].1 == pair[0].1;
    (all.len() > 1 && all.windows(2).all(is_next)).then_some(all[0].0).filter(|first| *first <= 1)
}

fn bare(name: &str) -> String {
    let last = name.rsplit('/').next().unwrap_or(name);
    let words: String = last.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    words.strip_suffix("joint").map(str::to_owned).unwrap_or(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn names_go_before_order() {
        let robot = names("shoulder_pan shoulder_lift elbow_flex wrist_flex wrist_roll gripper");
        let log = names("Rotation Pitch Elbow Wrist_Pitch Wrist_Roll Jaw");
        let found = pairs(&log, &robot);
        assert_eq!(found.len(), 6);
        assert!(found.iter().all(|(own, at, _)| own == at));
        assert_eq!((found[4].2, found[0].2), (How::Alike, How::Order));
    }

    #[test]
    fn joints_that_are_too_many_stay_out() {
        let found = pairs(&names("elbow finger"), &names("arm/elbow arm/shoulder arm/wrist"));
        assert_eq!(found, [(0, 0, How::Alike)]);
    }

    #[test]
    fn numbers_count_the_joints_of_a_robot_that_has_a_gripper_more() {
        let robot = names("pan lift elbow gripper");
        assert_eq!(pairs(&names("joint_0 joint_1 joint_2"), &robot), [0, 1, 2].map(|k| (k, k, How::Order)));
        // The first of a log that counts from 0 is not the last of a robot that counts from 1.
        let counted = pairs(&names("joint_0 joint_1 joint_2"), &names("joint1 joint2 joint3"));
        assert_eq!(counted, [0, 1, 2].map(|k| (k, k, How::Order)));
        assert_eq!(pairs(&names("joint_1 joint_2"), &names("joint1 joint2 joint3"))[1], (1, 1, How::Alike));
        // No numbers, or such as begin elsewhere, tell no order.
        assert_eq!(pairs(&names("joint_3 joint_4"), &robot), []);
        assert_eq!(pairs(&names("left right"), &robot), []);
    }
}
