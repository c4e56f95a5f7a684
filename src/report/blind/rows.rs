//! The numbers of a score in words, for terminal and page alike.

use crate::blind::{Rate, Score, Stated};

/// One line: what, how often of how many, and its share with interval.
pub(super) struct Row {
    pub what: String,
    pub count: String,
    pub share: String,
    pub interval: String,
}

impl Row {
    pub(super) fn of(what: impl Into<String>, rate: &Rate) -> Self {
        Self { what: what.into(), count: counts(rate), share: share(rate), interval: interval(rate) }
    }
}

/// `3 of 7`.
pub(super) fn counts(rate: &Rate) -> String {
    format!("{} of {}", rate.hits, rate.of)
}

/// `43 %`.
pub(super) fn share(rate: &Rate) -> String {
    rate.share.map_or_else(|| "–".to_owned(), percent)
}

/// `10 to 82 %`; nothing where nothing was seen.
pub(super) fn interval(rate: &Rate) -> String {
    if rate.of == 0 {
        return String::new();
    }
    let [low, high] = rate.interval;
    format!("{:.0} to {:.0} %", 100.0 * low, 100.0 * high)
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// `1 false alarm in 7 studies without an effect (below 43 % with 95 % confidence)`.
pub(super) fn alarms(rate: &Rate, of_which: &str, bound: f64) -> String {
    let alarms = if rate.hits == 1 { "alarm" } else { "alarms" };
    let studies = if rate.of == 1 { "study" } else { "studies" };
    format!(
        "{} false {alarms} in {} {studies} {of_which} (below {} with 95 % confidence)",
        rate.hits,
        rate.of,
        percent(bound)
    )
}

/// The sentence that the report opens with.
pub(super) fn sentence(score: &Score) -> String {
    let alarms = match score.false_alarms {
        rate if rate.of == 0 => "no study without an effect".to_owned(),
        rate => alarms(&rate, "without an effect", score.false_alarm_bound),
    };
    let outside = match score.unexplained {
        rate if rate.of == 0 => "no study with a cause outside the catalogue".to_owned(),
        rate => format!("{} of what the catalogue does not have was called unexplained", counts(&rate)),
    };
    format!("{} answers were wholly right ({}); {alarms}; {outside}.", counts(&score.top), share(&score.top))
}

/// The rates, in the order in which one reads.
pub(super) fn rates(score: &Score) -> Vec<Row> {
    vec![
        Row::of("kind of answer right", &score.verdict),
        Row::of("whole answer right", &score.top),
        Row::of("right, or what is there is in the set", &score.set),
        Row::of("one effect: named, and nothing beside it", &score.single),
        Row::of("one effect: in the set", &score.single_set),
        Row::of("several effects: all named, and nothing beside them", &score.several),
        Row::of("several effects: all named", &score.all),
        Row::of("several effects: at least half named", &score.half),
        Row::of("effects named: one that is not there among them", &score.needless),
        Row::of("stage right", &score.stage),
        Row::of("something there, but nothing seen", &score.missed),
        Row::of("nothing there, but something seen (false alarm)", &score.false_alarms),
        Row::of("exact numbers, but a calibration seen", &score.needless_calibration),
        Row::of("wrong numbers: the number that matters most", &score.number),
        Row::of("wrong numbers: any that is wrong", &score.number_any),
        Row::of("outside the catalogue: called unexplained", &score.unexplained),
        Row::of("outside the catalogue: stage, variable and range right", &score.located),
        Row::of("95 % intervals of numbers that cover, where trusted", &score.covered.numbers),
        Row::of("the same of effects' parameters", &score.covered.parameters),
        Row::of("95 % intervals of numbers that cover, trusted or not", &score.covered.numbers_of_all),
        Row::of("the same of effects' parameters, trusted or not", &score.covered.parameters_of_all),
    ]
}

/// How good stated probabilities are.
pub(super) fn stated(name: &str, s: &Stated) -> (String, String) {
    let text = match (s.brier, s.log_score, s.excess) {
        (Some(brier), Some(log), Some(excess)) => {
            let points = (100.0 * excess.abs()).round();
            let word = if excess >= 0.0 { "too sure" } else { "too modest" };
            let lean = match points {
                0.0 => "neither too sure nor too modest".to_owned(),
                1.0 => format!("{word} by 1 point"),
                _ => format!("{word} by {points:.0} points"),
            };
            format!("Brier {brier:.3}, log score {log:.3}, {lean}")
        }
        _ => "none stated".to_owned(),
    };
    (name.to_owned(), text)
}

/// What is one number each.
pub(super) fn numbers(score: &Score) -> Vec<(String, String)> {
    vec![
        stated("probability that the answer is right", &score.stated),
        stated("the same, for the set", &score.stated_set),
        ("mean size of the sets".to_owned(), score.set_size.map_or("–".to_owned(), |size| format!("{size:.2}"))),
        ("false alarms, 95 % upper bound".to_owned(), percent(score.false_alarm_bound)),
        ("wall time of a diagnosis, one thread each".to_owned(), {
            format!("median {:.2} s, longest {:.2} s", score.wall.median_s, score.wall.max_s)
        }),
        ("diagnoses that failed".to_owned(), score.failed.to_string()),
    ]
}
