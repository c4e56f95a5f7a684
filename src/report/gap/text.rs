//! A diagnosis as text for a terminal.

use comfy_table::{Cell, Table};

use super::rows::{effect_rows, joint_rows};
use super::waterfall::{closes_alone, explanation, heading, moved, steps};
use super::words;
use super::{GapReport, NEXT_FILE};
use crate::gap::{Candidate, Detectable, Diagnosis, Gap, MapCell, Phase, Verdict};
use crate::report::chances::Chances;
use crate::report::data_health::health_text;
use crate::report::measure::Measure;
use crate::report::number::{share, significant};
use crate::report::rows::shorten;
use crate::report::text::{cell, finish, number, one_line, parameter_table, table, wrap};

/// Columns of the text.
pub(in crate::report) const WIDTH: usize = 100;
/// Characters of a file name.
const NAME: usize = 36;
/// Characters of the longest bar.
const BAR: usize = 24;

/// Writes a diagnosis as plain text, as a rule at most 100 columns wide, ending in a newline.
///
/// The sentence with its probability, the steps from as given to the floor, what to do next, the health of the logs, which
/// numbers are not as believed, what the logs cannot determine, where the gap lies, which effects were considered, how far
/// the gap closes, the parameters, what the logs could not have shown, then the notes.
pub fn gap_text(report: &GapReport) -> String {
    let diagnosis = &report.diagnosis;
    let answer = &diagnosis.answer;
    // The first screen holds the answer, how far it goes, and what to do next.
    let blocks = [
        Some(opening(&answer.sentence, &words::chances(diagnosis), &answer.probability_source)),
        Some(waterfall(diagnosis)),
        next(diagnosis),
        (!report.health.is_empty()).then(|| format!("Data health:\n{}", health_text(&report.health))),
        beliefs(diagnosis),
        undetermined(&diagnosis.undetermined),
        Some(location(diagnosis)),
        (!diagnosis.ranking.is_empty()).then(|| ranking(diagnosis)),
        Some(how_far(&diagnosis.gap)),
        parameters(diagnosis),
        detectable(&diagnosis.detectable),
        notes(report),
    ];
    blocks.into_iter().flatten().collect::<Vec<_>>().join("\n\n") + "\n"
}

/// What is answered, and how sure it is.
pub(in crate::report) fn opening(sentence: &str, chances: &Chances, source: &str) -> String {
    let sure = format!("Probability {}: {}.", chances.words(), source.trim_end_matches('.'));
    format!("{}\n{}", paragraph(sentence), paragraph(&sure))
}

/// The steps from as given to the floor, each with a bar.
fn waterfall(diagnosis: &Diagnosis) -> String {
    let (steps, measure) = (steps(diagnosis), Measure::of(diagnosis.gap.unit));
    let longest = steps.iter().map(|step| step.rms).filter(|rms| rms.is_finite()).fold(0.0, f64::max);
    let mut table = table(WIDTH, &["step", ""], &[&*measure.over("RMS"), "closes", "alone", "last"]);
    let part = |share: Option<f64>| number(share.map_or_else(String::new, words::part));
    for step in &steps {
        table.add_row([
            Cell::new(step.label()),
            Cell::new(characters(step.rms, longest)),
            number(measure.number(step.rms)),
            part(step.closes),
            part(step.alone()),
            part(step.last()),
        ]);
    }
    format!("{}:\n{}\n{}", heading(diagnosis), finish(&mut table), paragraph(&explanation(diagnosis)))
}

/// A bar of characters for an error; empty where there is none.
pub(in crate::report) fn characters(rms: f64, longest: f64) -> String {
    let length = (rms / longest * BAR as f64).round();
    if length.is_finite() { "#".repeat((length as usize).clamp(1, BAR)) } else { String::new() }
}

/// Numbers that the logs put elsewhere than they were believed to be.
fn beliefs(diagnosis: &Diagnosis) -> Option<String> {
    let rows = moved(diagnosis);
    if rows.is_empty() {
        return None;
    }
    let mut table = table(WIDTH, &["not as believed", "believed", "found [95 %]"], &["moved\n[sd]"]);
    let is_any = rows.iter().any(|row| row.is_finding);
    for row in rows {
        let mark = if row.is_finding { "*" } else { "" };
        table.add_row([Cell::new(one_line(row.name) + mark), cell(row.believed), cell(row.found), number(row.moved)]);
    }
    let key = if is_any { "\n* a finding: more than three standard deviations from what was believed" } else { "" };
    Some(finish(&mut table) + key)
}

/// What the logs leave open, sentence by sentence.
pub(in crate::report) fn undetermined(sentences: &[String]) -> Option<String> {
    let lines: Vec<String> = sentences.iter().map(|sentence| wrap(WIDTH, sentence, "- ", "  ")).collect();
    (!lines.is_empty()).then(|| format!("{}:\n{}", words::UNDETERMINED, lines.join("\n")))
}

/// Columns of how far a gap closes, as pages name them; the longest name in two lines.
pub(in crate::report) const HOW_FAR: [&str; 4] = ["as given", "recalibrated", "with\ncauses", "floor"];

/// The table of how far a gap closes.
pub(in crate::report) fn rms_table(of: &str, measure: Measure) -> Table {
    let names = HOW_FAR.map(|name| measure.over(name));
    table(WIDTH, &[of], &names.each_ref().map(|name| &**name))
}

/// A row of it: as given, recalibrated, with the answer, the sensor's noise.
pub(in crate::report) fn rms_row(name: Cell, measure: Measure, rms: [f64; 4]) -> Vec<Cell> {
    std::iter::once(name).chain(rms.map(|rms| number(measure.number(rms)))).collect()
}

/// A paragraph of the page's width.
pub(in crate::report) fn paragraph(text: &str) -> String {
    wrap(WIDTH, text, "", "")
}

/// A file's name, shortened where it is long.
pub(in crate::report) fn file(name: &str) -> Cell {
    Cell::new(shorten(&one_line(name), NAME))
}

/// An angle in mrad.
pub(in crate::report) fn mrad(rad: f64) -> Cell {
    number(significant(1e3 * rad, 3))
}

/// Words, then the map of log and phase.
fn location(diagnosis: &Diagnosis) -> String {
    let location = &diagnosis.location;
    let words = paragraph(&words::location(location));
    if !words::is_mapped(&location.cells) {
        return words;
    }
    let (files, phases) = words::files_and_phases(&location.cells);
    let names: Vec<&str> = phases.iter().map(|phase| phase.name()).collect();
    let mut table = table(WIDTH, &["share of the gap"], &names);
    let shown = words::shares_of_cells(&location.cells);
    for name in files {
        let of_phase = |phase: &Phase| {
            let mut cells = location.cells.iter().zip(&shown);
            let cell = cells.find(|(cell, _)| cell.file == name && cell.phase == *phase);
            number(cell.map_or_else(|| "-".to_owned(), |(cell, shown)| marked(cell, shown)))
        };
        table.add_row(std::iter::once(file(name)).chain(phases.iter().map(of_phase)));
    }
    format!("{words}\n{}\n* more than noise alone would give", finish(&mut table))
}

fn marked(cell: &MapCell, shown: &str) -> String {
    let mark = if cell.significant { "*" } else { " " };
    format!("{shown}{mark}")
}

/// Every candidate that was refitted, between what was given and the sensor's noise; the others by name.
fn ranking(diagnosis: &Diagnosis) -> String {
    let gap = &diagnosis.gap;
    let measure = Measure::of(gap.unit);
    let words = ["which", "parameters with 95 % intervals"];
    let chances = words::chances(diagnosis);
    let rms = measure.over("RMS");
    let numbers = [&*rms, "closes\nalone", "worse by\n[sd]", "probability"];
    // Where no effect has a part of the probability there is nothing to tell of it.
    let numbers = if chances.is_shared_out { &numbers[..] } else { &numbers[..numbers.len() - 1] };
    let mut table = table(WIDTH, &words, numbers);
    let plain = |table: &mut Table, name: &str, rms: f64| {
        table.add_row([Cell::new(name), Cell::new(""), number(measure.number(rms))]);
    };
    plain(&mut table, "(as given)", gap.before);
    plain(&mut table, "(recalibrated)", gap.calibrated);
    if let (Some(_), Some(both)) = (diagnosis.answer.second, words::answer(diagnosis)) {
        plain(&mut table, &format!("({both})"), gap.after);
    }
    for (candidate, chance) in diagnosis.ranking.iter().zip(&chances.candidates).filter(|(c, _)| c.refitted) {
        let mark = if words::is_named(&diagnosis.answer, candidate.effect) { " *" } else { "" };
        let cells = [
            Cell::new(format!("{}{mark}", candidate.effect)),
            Cell::new(candidate.parameters.iter().map(words::parameter).collect::<Vec<_>>().join("\n")),
            number(measure.number(candidate.after)),
            number(closes_alone([gap.calibrated, gap.floor], candidate.after).map_or_else(|| "-".to_owned(), share)),
            number(significant(candidate.behind_sd, 2)),
        ];
        table.add_row(cells.into_iter().chain(chances.is_shared_out.then(|| number(chance))));
    }
    plain(&mut table, "(sensor noise)", gap.floor);
    if chances.is_shared_out {
        let cells = ["(something else)", "", "", "", ""].map(Cell::new);
        table.add_row(cells.into_iter().chain([number(&chances.rest)]));
    }
    let mut text = finish(&mut table);
    if let Some(mark) = words::mark(&diagnosis.answer) {
        text += &format!("\n* {mark}");
    }
    text += "\n";
    text += &paragraph(words::BEHIND);
    let screened: Vec<&Candidate> = diagnosis.ranking.iter().filter(|c| !c.refitted).collect();
    if !screened.is_empty() {
        let names: Vec<&str> = screened.iter().map(|c| c.effect.id()).collect();
        text += "\n";
        text += &wrap(WIDTH, &names.join(", "), "Judged by the screening alone: ", "  ");
    }
    text
}

fn how_far(gap: &Gap) -> String {
    let measure = Measure::of(gap.unit);
    let mut table = rms_table(&format!("RMS of the {}", words::logs_of(gap)), measure);
    for log in &gap.per_log {
        table.add_row(rms_row(file(&log.file), measure, [log.before, log.calibrated, log.after, log.floor]));
    }
    table.add_row(rms_row(Cell::new("all"), measure, [gap.before, gap.calibrated, gap.after, gap.floor]));
    let closed = format!(
        "Closed in all, recalibration included: {}. Held out: {}.",
        words::closed(gap.closed, gap.closed_interval),
        gap.held_out
    );
    format!("{}\n{}", finish(&mut table), paragraph(&closed))
}

fn parameters(diagnosis: &Diagnosis) -> Option<String> {
    let (joint, effects) = (joint_rows(diagnosis), effect_rows(diagnosis));
    if joint.is_empty() && effects.is_empty() {
        return None;
    }
    let table = parameter_table(WIDTH, joint.iter().chain(&effects));
    Some(if diagnosis.answer.intervals_trusted { table } else { format!("{table}\n{}", paragraph(words::UNTRUSTED)) })
}

/// The smallest size of each effect that would have been seen.
pub(in crate::report) fn detectable(all: &[Detectable]) -> Option<String> {
    let first = all.first()?;
    let mut text = wrap(WIDTH, words::DETECTABLE, "", "");
    let room = all.iter().map(|d| d.effect.id().len()).fold(first.effect.id().len(), usize::max) + 2;
    for detectable in all {
        text += &format!("\n  {:<room$}{}", detectable.effect.id(), words::threshold(detectable));
    }
    Some(text)
}

fn next(diagnosis: &Diagnosis) -> Option<String> {
    let what = match &diagnosis.next {
        Some(next) => words::next(next, NEXT_FILE),
        None if diagnosis.answer.verdict == Verdict::Unexplained => words::no_next(diagnosis).to_owned(),
        None => return None,
    };
    Some(wrap(WIDTH, &what, "Next: ", "  "))
}

fn notes(report: &GapReport) -> Option<String> {
    let notes: Vec<String> = words::notes(report).iter().map(|note| wrap(WIDTH, note, "- ", "  ")).collect();
    (!notes.is_empty()).then(|| notes.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn text_of_an_effect_that_cannot_be_told_from_another() {
        insta::assert_snapshot!(gap_text(&sample::set_of_two()));
    }

    #[test]
    fn no_line_is_wider_than_the_page() {
        for (name, report) in sample::all() {
            let text = gap_text(&report);
            let widest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
            assert!(widest <= WIDTH, "{name}, {widest} columns:\n{text}");
            assert!(text.ends_with('\n') && !text.contains(" \n") && !text.contains("NaN"), "{name}:\n{text}");
        }
    }

    #[test]
    fn verdict_opens_the_text() {
        for (name, report) in sample::all() {
            let text = gap_text(&report);
            let opening = text.split_once("Probability").expect("a probability").0;
            let words: Vec<&str> = opening.split_whitespace().collect();
            let sentence: Vec<&str> = report.diagnosis.answer.sentence.split_whitespace().collect();
            assert_eq!(words, sentence, "{name}");
        }
    }
}
