//! Sentences about the joints of a robot, each once.

/// Every sentence once, after the joints that it is true of, in the order in which they come.
pub(super) fn by_joint<'a>(said: impl IntoIterator<Item = (&'a str, &'a str)>) -> Vec<String> {
    let mut known: Vec<(&str, Vec<&str>)> = Vec::new();
    for (joint, sentence) in said {
        match known.iter_mut().find(|(known, _)| *known == sentence) {
            Some((_, joints)) => joints.push(joint),
            None => known.push((sentence, vec![joint])),
        }
    }
    known.into_iter().map(|(sentence, joints)| format!("{}: {sentence}", joints.join(", "))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_true_of_several_joints_is_said_once() {
        let said = [("hip", "It sticks."), ("knee", "It slips."), ("ankle", "It sticks.")];
        assert_eq!(by_joint(said), ["hip, ankle: It sticks.", "knee: It slips."]);
    }
}
