//! Probabilities that were measured, not computed from losses.
//!
//! How often was an answer that stands like this one right? `data/rates.toml` has the counts of a sealed trial, by the
//! kind of answer and by how clearly it stands out; the command that made them is in the file. `--twins` measures on
//! copies of the user's own study instead.

use super::decide::{Decision, EXPLAINED};
use super::twins::Measured;
use crate::gap::diagnosis::{Candidate, Verdict};
use serde::{Deserialize, Serialize};

/// Counts of a sealed trial, in the form of `data/rates.toml`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Rates {
    /// The command that made them.
    pub command: String,
    /// One for each standing that occurred.
    #[serde(default)]
    pub rate: Vec<Rate>,
}

/// How often answers of one standing were right.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Rate {
    /// The kind of answer and how clearly it stands, in words.
    pub standing: String,
    /// How many there were.
    pub answers: u32,
    /// How many of these were right.
    pub right: u32,
}

impl Rates {
    /// The rates that come with the program, for joints.
    pub(in crate::gap) fn shipped() -> Self {
        read(include_str!("../../../data/rates.toml"))
    }

    /// The same for whole robots.
    pub(in crate::gap) fn shipped_for_robots() -> Self {
        read(include_str!("../../../data/rates-robot.toml"))
    }

    /// Counts a trial's answers by their standing.
    pub fn count<'a>(command: String, answers: impl Iterator<Item = (&'a str, bool)>) -> Self {
        let mut rate: Vec<Rate> = Vec::new();
        for (standing, right) in answers {
            let at = rate.iter().position(|r| r.standing == standing).unwrap_or_else(|| {
                rate.push(Rate { standing: standing.to_owned(), answers: 0, right: 0 });
                rate.len() - 1
            });
            rate[at].answers += 1;
            rate[at].right += u32::from(right);
        }
        rate.sort_by(|a, b| a.standing.cmp(&b.standing));
        Self { command, rate }
    }

    /// Answers and right ones among those whose standing begins so.
    fn of(&self, beginning: &str) -> (u32, u32) {
        let those = self.rate.iter().filter(|r| r.standing.starts_with(beginning));
        those.fold((0, 0), |sum, r| (sum.0 + r.answers, sum.1 + r.right))
    }
}

fn read(shipped: &str) -> Rates {
    toml::from_str(shipped).expect("the file is compiled in and tested")
}

/// Deviance by which the next hypothesis must be behind for an answer to stand out.
const STANDS_OUT: f64 = 60.0;
/// Deviance that an answer must have gained to be a strong one.
const STRONG: f64 = 400.0;
/// Answers of one standing from which on their rate is taken; below, those of the wider kind are.
const ENOUGH: u32 = 8;

/// The kind of an answer and how clearly it stands, in words that are counted.
pub(in crate::gap) fn standing(decision: &Decision<'_>) -> String {
    let kind = match (decision.verdict, decision.second()) {
        (Verdict::Effect, Some(_)) => "two effects",
        (Verdict::Effect, None) => "effect",
        (verdict, _) => verdict.name(),
    };
    let rest = if decision.excess < EXPLAINED { "to the noise" } else { "with a rest" };
    let clear = match decision.verdict {
        Verdict::Effect if decision.margin > STANDS_OUT && decision.gain > STRONG => "clear",
        Verdict::Effect if decision.equivalent.len() > 1 => "one of several",
        Verdict::Effect => "narrow",
        Verdict::Unexplained if decision.effect().is_some() => "nearest effect named",
        _ => "plain",
    };
    format!("{kind}, {rest}, {clear}")
}

/// The measured rate for a standing, by the rule of succession, and where it was measured.
pub(in crate::gap) fn probability(standing: &str, rates: &Rates) -> (f64, String) {
    let kind = standing.split(',').next().unwrap_or(standing);
    let wider = standing.rsplit_once(',').map_or(kind, |(wider, _)| wider);
    let counted = [standing, wider, kind].map(|beginning| (beginning, rates.of(beginning)));
    let &(beginning, (answers, right)) =
        counted.iter().find(|(_, (answers, _))| *answers >= ENOUGH).unwrap_or(&counted[2]);
    let probability = (f64::from(right) + 1.0) / (f64::from(answers) + 2.0);
    let source = format!(
        "{right} of {answers} answers like this one ({}) were right in `{}`",
        in_words(beginning),
        rates.command
    );
    (probability, source)
}

/// A standing as a reader takes it in; what is plain needs no words.
fn in_words(standing: &str) -> String {
    let word = |part| match part {
        "effect" => "one effect is named",
        "two effects" => "several effects are named",
        "joint effect" => "one effect at joints is named",
        "two causes" => "two causes are named",
        "robot cause" => "a cause of the whole robot is named",
        "none" => "nothing is missing",
        "calibration" => "the numbers are off",
        "unexplained" => "no effect explains it",
        "clamped" => "trunk clamped",
        "floor" => "on the floor",
        "arm" => "an arm",
        "one cause" => "one cause on all joints together",
        "several causes" => "several causes on all joints together",
        "to the noise" => "nothing of size is left",
        "with a rest" => "something is left",
        "clear" => "far ahead of the next",
        "narrow" => "little ahead of the next",
        "one of several" => "others do as well",
        "nearest effect named" | "nearest cause named" => "what comes closest is told",
        other => other,
    };
    let parts = standing.split(", ").filter(|part| *part != "plain");
    parts.map(word).collect::<Vec<_>>().join(", ")
}

/// Shares an answer's probability out among the candidates that cannot be told apart.
pub(in crate::gap) fn share_out(candidates: &mut [Candidate], decision: &Decision<'_>, probability: f64) {
    if decision.verdict != Verdict::Effect {
        return;
    }
    let among = decision.equivalent.len().max(1) as f64;
    for c in candidates {
        if decision.equivalent.contains(&c.effect) {
            c.probability = probability / among;
        }
    }
}

/// The rate at which answers like this one were right, and where it was measured: on twins of the study where enough of them
/// are alike, else as shipped.
pub(in crate::gap) fn probability_of(standing: &str, twins: Option<&Measured>) -> (f64, String) {
    let measured = twins.and_then(|twins| twins.rate.clone());
    measured.unwrap_or_else(|| probability(standing, &Rates::shipped()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_counted_by_standing_and_a_rare_one_takes_the_wider_kind() {
        let answers =
            [("none, to the noise, plain", true), ("none, to the noise, plain", false), ("effect, x, y", true)];
        let rates = Rates::count("aibo-fit blind".into(), answers.into_iter());
        assert_eq!((rates.of("none"), rates.of("effect, x"), rates.of("two effects")), ((2, 1), (1, 1), (0, 0)));
    }

    #[test]
    fn every_standing_that_is_counted_has_words() {
        assert_eq!(in_words("effect, with a rest"), "one effect is named, something is left");
        for rates in [Rates::shipped(), Rates::shipped_for_robots()] {
            for part in rates.rate.iter().flat_map(|rate| rate.standing.split(", ")) {
                assert!(part == "plain" || in_words(part) != part, "{part}");
            }
        }
    }

    #[test]
    fn the_shipped_rates_can_be_read() {
        for rates in [Rates::shipped(), Rates::shipped_for_robots()] {
            assert!(rates.command.starts_with("aibo-fit blind") && !rates.rate.is_empty());
            assert!(rates.rate.iter().all(|r| r.right <= r.answers));
        }
    }
}
