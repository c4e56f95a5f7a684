//! The report of sealed trials of a whole robot, for a terminal and as one page.

use comfy_table::Cell;
use minijinja::{Value, context};

use super::BlindReport;
use super::confusion::confusion;
use super::reliability::reliability;
use super::rows::{Row, alarms, counts, interval, percent, share, stated};
use super::text::{cause_table, confusion_table, rate_table, stated_table};
use crate::blind::Rate;
use crate::blind::robot::{RobotAnswered, RobotBySize, RobotJudgement, RobotScore, RobotTrial, StatedCause};
use crate::report::ReportError;
use crate::report::html::{both, figure_views, render};
use crate::report::plot::Figure;
use crate::report::text::{finish, number, table, wrap};

/// Sealed trials of a robot, opened and scored.
pub type RobotBlindReport = BlindReport<RobotScore, RobotTrial>;

/// Columns of the text.
const WIDTH: usize = 108;

fn sentence(score: &RobotScore) -> String {
    let alarms = match score.false_alarms {
        rate if rate.of == 0 => "no study where nothing is the matter".to_owned(),
        rate => alarms(&rate, "where nothing is the matter", score.false_alarm_bound),
    };
    format!(
        "{} answers had kind, cause and joints right, {} had what is there in their set; {alarms}.",
        counts(&score.top),
        counts(&score.set)
    )
}

fn rates(score: &RobotScore) -> Vec<Row> {
    let mut rows = vec![
        Row::of("kind of answer right", &score.verdict),
        Row::of("kind, cause and joints right", &score.top),
        Row::of("right, or what is there is in the set", &score.set),
        Row::of("one cause: named, and nothing beside it", &score.single),
        Row::of("one cause: in the set", &score.single_set),
        Row::of("two causes: both named", &score.both),
        Row::of("causes on joints: exactly these joints", &score.place),
        Row::of("causes on joints: some of these joints", &score.overlaps),
        Row::of("something there, but nothing seen", &score.missed),
        Row::of("nothing there, but something seen (false alarm)", &score.false_alarms),
        Row::of("outside the catalogue: called unexplained", &score.unexplained),
    ];
    for group in &score.scenarios {
        rows.push(Row::of(format!("{}: kind of answer right", group.name), &group.verdict));
        rows.push(Row::of(format!("{}: right, or in the set", group.name), &group.set));
        rows.push(Row::of(format!("{}: false alarms", group.name), &group.false_alarms));
    }
    rows
}

fn numbers(score: &RobotScore) -> Vec<(String, String)> {
    let mean = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2}"));
    let mut numbers = vec![
        stated("probability that what is there is in the set", &score.stated),
        ("mean size of the sets of causes".to_owned(), mean(score.set_size)),
        ("mean number of places".to_owned(), mean(score.places)),
        ("false alarms, 95 % upper bound".to_owned(), percent(score.false_alarm_bound)),
        ("diagnoses that failed".to_owned(), score.failed.to_string()),
    ];
    for group in &score.scenarios {
        let wall = format!("median {:.1} s, longest {:.1} s", group.wall.median_s, group.wall.max_s);
        numbers.push((format!("wall time in scenario {}, one thread each", group.name), wall));
    }
    numbers
}

/// Writes the report as plain text, as a rule at most 108 columns wide, ending in a newline.
pub fn robot_blind_text(report: &RobotBlindReport) -> String {
    let score = &report.score;
    let seal = if report.seal_holds { "as stated before the first diagnosis" } else { "WHICH IS NOT WHAT WAS SEALED" };
    let head = format!(
        "{} robot studies, seed {}; answers opened: SHA-256 {}, {seal}.",
        score.trials, report.seed, report.sha256
    );
    let lines: Vec<String> = numbers(score).into_iter().map(|(what, value)| format!("{what}: {value}")).collect();
    let mut blocks = vec![
        wrap(WIDTH, &head, "", ""),
        wrap(WIDTH, &sentence(score), "", ""),
        rate_table(rates(score)),
        lines.join("\n"),
        confusion_table(&score.confusion),
        cause_table(&score.causes, "joints"),
    ];
    if !score.sizes.is_empty() {
        let mut rows = table(WIDTH, &["one cause; change of its joints"], &["right", "in the set", "not seen"]);
        for size in &score.sizes {
            let cells = [&size.top, &size.set, &size.missed].map(|rate: &Rate| number(counts(rate)));
            rows.add_row(std::iter::once(Cell::new(range(size))).chain(cells));
        }
        blocks.push(finish(&mut rows));
    }
    blocks.push(stated_table(&score.stated));
    blocks.join("\n\n") + "\n"
}

fn range(size: &RobotBySize) -> String {
    match size.to {
        Some(to) => format!("{} to {to} times the noise", size.from),
        None => format!("more than {} times the noise", size.from),
    }
}

/// Draws the figures: confusion, and reliability of the stated probabilities.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn robot_blind_figures(report: &RobotBlindReport) -> Result<Vec<Figure>, ReportError> {
    let score = &report.score;
    let figure = |file_name: &str, title: &str, caption: &str, svg: String| Figure {
        file_name: file_name.to_owned(),
        title: title.to_owned(),
        caption: caption.to_owned(),
        svg,
    };
    let map = confusion(&score.confusion)?;
    let set = reliability("Stated probabilities: what is there is in the set", &score.stated.bins)?;
    Ok(vec![
        figure("confusion.svg", "Confusion", "Framed cells are right answers, wherever on the robot.", map),
        figure(
            "reliability.svg",
            "Reliability",
            "Dots on the line: answers are right as often as they say. Below it, they are too sure.",
            set,
        ),
    ])
}

/// Puts the report of sealed trials of a robot into one HTML page.
///
/// The page holds its figures, its font and its script, and loads nothing; it can be read without the script. Same report,
/// same bytes.
///
/// # Errors
/// [`ReportError::Draw`] or [`ReportError::Font`] from the figures, [`ReportError::Page`] from the template; none depends
/// on the data.
pub fn robot_blind_html(report: &RobotBlindReport) -> Result<String, ReportError> {
    let score = &report.score;
    let view =
        |row: Row| context! { what => row.what, count => row.count, share => row.share, interval => row.interval };
    let sizes = score.sizes.iter().map(|size| {
        context! {
            from => size.from, to => size.to,
            top => counts(&size.top), set => counts(&size.set), missed => counts(&size.missed),
        }
    });
    let bins = score.stated.bins.iter().filter(|bin| bin.right.of > 0).map(|bin| {
        context! {
            range => format!("{} to {}", bin.range[0], bin.range[1]),
            stated => bin.stated.map(percent),
            right => counts(&bin.right), share => share(&bin.right), interval => interval(&bin.right),
        }
    });
    let causes = score.causes.iter().map(|cause| {
        context! {
            cause => cause.cause.as_str(),
            top => counts(&cause.top),
            set => counts(&cause.set),
            stage => if cause.stage.of > 0 { counts(&cause.stage) } else { String::new() },
            taken_for => cause.taken_for.as_ref().map(|(name, count)| format!("{name} ({count})")),
        }
    });
    let values = context! {
        robot => true,
        trials => score.trials,
        seed => report.seed,
        sha256 => report.sha256.as_str(),
        seal_holds => report.seal_holds,
        sentence => sentence(score),
        rates => rates(score).into_iter().map(view).collect::<Vec<Value>>(),
        numbers => numbers(score),
        figures => figure_views(both(|| robot_blind_figures(report))?.each_ref()),
        causes => causes.collect::<Vec<Value>>(),
        sizes => sizes.collect::<Vec<Value>>(),
        bins => bins.collect::<Vec<Value>>(),
        studies => report.trials.iter().map(study).collect::<Vec<Value>>(),
        version => report.provenance.version.as_str(),
        command => report.provenance.command.as_str(),
    };
    render("blind.html", include_str!("../templates/blind.html"), values)
}

fn study(trial: &RobotTrial) -> Value {
    let truth = &trial.truth;
    let faults: Vec<String> = truth.faults.iter().map(|fault| on(fault.id, &fault.joints)).collect();
    let there = match (faults.is_empty(), truth.outside) {
        (true, _) => "none".to_owned(),
        (false, Some(_)) => format!("outside: {}", faults.join(" + ")),
        (false, None) => faults.join(" + "),
    };
    let (answered, probability) = match &trial.answer {
        Err(why) => (format!("failed: {why}"), String::new()),
        Ok(answer) => (said(answer), percent(answer.probability)),
    };
    let judgement = RobotJudgement::of(trial);
    context! {
        number => truth.trial,
        joint => truth.scenario,
        logs => truth.motions.join("; "),
        there,
        left => if truth.ratio > 0.0 { format!("{:.1}", truth.ratio) } else { String::new() },
        answered,
        probability,
        word => if judgement.top { "right" } else if judgement.set { "in the set" } else { "wrong" },
        wall => format!("{:.1}", trial.wall_s),
    }
}

/// A cause with its joints; of many joints how many.
fn on(id: &str, joints: &[String]) -> String {
    match joints {
        [] => id.to_owned(),
        some => format!("{id} {}", place(some)),
    }
}

fn place(joints: &[String]) -> String {
    if joints.len() <= 4 { format!("in {}", joints.join(", ")) } else { format!("in {} joints", joints.len()) }
}

fn said(answer: &RobotAnswered) -> String {
    let of = |stated: &StatedCause| on(stated.cause.id(), &stated.joints);
    let named: Vec<String> = answer.named().map(of).collect();
    let Some(first) = &answer.first else {
        let nearest = answer.partial.as_ref().map_or(String::new(), |stated| format!(" (nearest {})", of(stated)));
        return answer.verdict.name().to_owned() + &nearest;
    };
    let causes = answer.equivalent.iter().filter(|cause| **cause != first.cause).map(|cause| cause.id().to_owned());
    let places = answer.places.iter().filter(|joints| **joints != first.joints).map(|joints| place(joints));
    let others: Vec<String> = causes.chain(places).collect();
    let alike = if others.is_empty() { String::new() } else { format!(" (or {})", others.join("; ")) };
    named.join(" + ") + &alike
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blind::robot::{RobotTruth, TrueFault, score_robots};
    use crate::gap::Verdict;
    use crate::gap::robot::Cause;
    use crate::report::Provenance;

    fn report() -> RobotBlindReport {
        let truth = |verdict, causes: Vec<Cause>| RobotTruth {
            seed: 7,
            trial: 0,
            scenario: "floor",
            robot: "ers7".to_owned(),
            verdict,
            faults: causes
                .iter()
                .map(|cause| TrueFault { id: cause.id(), joints: vec![], parameters: vec![], ratio: 6.0 })
                .collect(),
            causes,
            outside: None,
            ratio: 6.0,
            noise_rad: 0.0026,
            scatter: 0.07,
            friction_scatter: 0.2,
            method: String::new(),
            motions: vec!["trot at 1 Hz".to_owned()],
        };
        let stated = |cause, joints: &[&str]| StatedCause {
            cause,
            joints: joints.iter().map(|joint| (*joint).to_owned()).collect(),
            parameters: vec![],
        };
        let answer = |verdict, first: Option<StatedCause>| RobotAnswered {
            verdict,
            equivalent: first.iter().map(|stated| stated.cause).chain([Cause::Viscous]).collect(),
            places: vec![vec!["lf1".to_owned()], vec!["rf1".to_owned()]],
            first,
            second: None,
            more: vec![],
            probability: 0.7,
            standing: String::new(),
            partial: None,
            joints: vec![],
            before: 0.01,
            after: 0.003,
            floor: 0.0026,
            ranking: vec![],
            sentence: String::new(),
        };
        let trial = |truth, answer| RobotTrial { truth, answer: Ok(answer), wall_s: 60.0 };
        let wrong = answer(Verdict::Calibration, Some(stated(Cause::Coulomb, &["lf1"])));
        let trials = vec![
            trial(
                truth(Verdict::Effect, vec![Cause::Payload]),
                answer(Verdict::Effect, Some(stated(Cause::Payload, &[]))),
            ),
            trial(truth(Verdict::None, vec![]), wrong),
        ];
        let provenance = Provenance { version: "1".to_owned(), command: "aibo-fit <b>".to_owned(), inputs: vec![] };
        let score = score_robots(&trials);
        RobotBlindReport { seed: 7, sha256: "cafe".to_owned(), seal_holds: true, score, trials, provenance }
    }

    #[test]
    fn text_says_what_was_right_and_what_was_accused_without_cause() {
        let text = robot_blind_text(&report());
        for words in [
            "2 robot studies, seed 7; answers opened: SHA-256 cafe, as stated before the first diagnosis.",
            "1 of 2 answers had kind, cause and joints right",
            "1 false alarm in 1\nstudy",
            "coulomb (1)",
            "wall time in scenario floor, one thread each: median 60.0 s",
            "5 to 12 times the noise",
        ] {
            assert!(text.contains(words), "no `{words}` in\n{text}");
        }
        assert!(robot_blind_text(&RobotBlindReport { seal_holds: false, ..report() }).contains("NOT WHAT WAS SEALED"));
    }

    #[test]
    fn page_needs_no_network_and_says_what_else_it_could_be() {
        let page = robot_blind_html(&report()).expect("a page");
        crate::report::html::tests::is_alone(&page);
        assert!(!page.contains("href="));
        assert!(page.contains("aibo-fit &lt;b&gt;") && page.contains("trot at 1 Hz"));
        assert!(page.contains("coulomb in lf1 (or viscous; in rf1)"), "{page}");
        assert_eq!(page, robot_blind_html(&report()).expect("a page"), "same report, same bytes");
    }
}
