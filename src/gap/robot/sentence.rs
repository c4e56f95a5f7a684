//! The answer as a sentence that a colleague would say.

use super::cause::Cause;
use super::diagnosis::{Found, RobotGap};
use crate::gap::verdict::sentence::{REFITTED, closing, far, moved, them, words as effect_words};
use crate::gap::{BeliefFound, Verdict};
use crate::number::{mrad, quantity};

/// Words for a cause.
pub(super) fn words(cause: Cause) -> &'static str {
    match cause {
        Cause::Effect(effect) => effect_words(effect),
        Cause::Coulomb => "another Coulomb friction than the study's",
        Cause::Viscous => "another viscous friction than the study's",
        Cause::Payload => "a mass on the trunk that the study does not know",
        Cause::FloorFriction => "another friction of the floor",
        Cause::FloorSlope => "a floor that is not level",
        Cause::FloorStiffness => "another stiffness of the floor",
    }
}

fn place(found: &Found) -> String {
    match found.joints.as_slice() {
        [] => String::new(),
        [one] => format!(" in {one}"),
        [a, b] => format!(" in {a} and {b}"),
        many if many.len() > 4 => format!(" in all {} joints", many.len()),
        many => format!(" in {}", many.join(", ")),
    }
}

/// Cause, place and size. How well a size is known holds only where nothing is left: of what does not explain the gap it is not
/// said.
fn sized(found: &Found, explains: bool) -> String {
    let number = found.parameters.first();
    let number =
        number.map(|n| format!(" ({} = {})", n.name, quantity(n.value, n.interval.filter(|_| explains), &n.unit)));
    format!("{}{}{}", words(found.cause), place(found), number.unwrap_or_default())
}

/// What is said of a robot.
pub(super) struct Said<'a> {
    pub robot: &'a str,
    pub verdict: Verdict,
    pub first: Option<&'a Found>,
    /// Whether `first`, if there is one, was only refitted with all other numbers, and is no cause that was searched.
    pub is_refitted: bool,
    pub second: Option<&'a Found>,
    pub partial: Option<&'a Found>,
    pub equivalent: &'a [Cause],
    pub places: &'a [Vec<String>],
    /// Numbers that moved far in units of their standard deviations, the farthest first.
    pub broken: &'a [&'a BeliefFound],
}

/// The sentence of an answer.
pub(super) fn sentence(said: &Said<'_>, gap: &RobotGap) -> String {
    let Said { robot, verdict, first, is_refitted, second, partial, equivalent, places, broken } = said;
    let figures = [gap.before, gap.calibrated, gap.after, gap.floor];
    match (verdict, first) {
        (Verdict::None, _) => format!(
            "{robot}: nothing is missing. With masses, friction and floor within what is believed of them it explains the held-out samples ({} against the sensor's {}).",
            mrad(gap.calibrated),
            mrad(gap.floor)
        ),
        // A number that was searched on all its joints is the answer, not those that it bent.
        (Verdict::Calibration, _) if !broken.is_empty() && *is_refitted => format!(
            "{robot}: the structure is right and numbers of the study are off: {}; refitting them takes the error from {} to {} (noise {}).",
            moved(broken),
            mrad(gap.before),
            mrad(gap.after),
            mrad(gap.floor)
        ),
        (Verdict::Effect | Verdict::Calibration, Some(first)) => {
            let mut text = format!("{robot}: the gap is {}", sized(first, true));
            if let Some(second) = second {
                text += &format!(", together with {}", sized(second, true));
            }
            let causes = 1 + usize::from(second.is_some());
            text += &format!("; {}.", closing(figures, REFITTED, &them(causes, false)));
            let others: Vec<&str> =
                equivalent.iter().filter(|cause| **cause != first.cause).map(|cause| words(*cause)).collect();
            if !others.is_empty() {
                text += &format!(" These logs cannot tell it apart from {}.", others.join(", nor from "));
            }
            let elsewhere: Vec<String> =
                places.iter().filter(|place| **place != first.joints).map(|place| place.join(", ")).collect();
            if !elsewhere.is_empty() {
                text += &format!(" It could as well be in {}.", elsewhere.join("; or in "));
            }
            text
        }
        _ => {
            let nearest = partial.map_or(String::new(), |found| {
                format!(
                    " What comes closest is {}; {}.",
                    sized(found, false),
                    closing(figures, REFITTED, &them(1, false))
                )
            });
            let far = far(broken).unwrap_or_default();
            format!(
                "{robot}: the causes I know do not explain this gap; {} are left, and the sensor itself makes {}.{nearest}{far}",
                mrad(gap.after),
                mrad(gap.floor)
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_was_searched_is_told_and_not_the_masses_that_it_bent() {
        let first =
            Found { cause: Cause::Coulomb, joints: vec!["lf1".to_owned(), "rf1".to_owned()], parameters: Vec::new() };
        let bent = BeliefFound {
            name: "trunk.mass".to_owned(),
            believed: 1.0,
            sd: 0.1,
            found: 1.6,
            moved_sd: 6.0,
            unit: "kg".to_owned(),
        };
        let gap = RobotGap {
            unit: "rad",
            before: 0.02,
            calibrated: 0.01,
            after_first: 0.001,
            after: 0.001,
            floor: 0.001,
            closed: Some(1.0),
            closed_interval: None,
            held_out: String::new(),
            per_log: Vec::new(),
            per_joint: Vec::new(),
            displacement: Vec::new(),
        };
        let said = |is_refitted| {
            let said = Said {
                robot: "dog",
                verdict: Verdict::Calibration,
                first: Some(&first),
                is_refitted,
                second: None,
                partial: None,
                equivalent: &[],
                places: &[],
                broken: &[&bent],
            };
            sentence(&said, &gap)
        };
        assert!(said(false).contains("Coulomb friction") && !said(false).contains("trunk.mass"), "{}", said(false));
        assert!(said(true).contains("trunk.mass"), "{}", said(true));
    }
}
