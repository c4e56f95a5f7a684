//! A robot's diagnosis as text for a terminal.

use comfy_table::{Cell, Table};

use super::RobotGapReport;
use super::{waterfall, words};
use crate::gap::robot::{GaitCell, GaitPhase, RobotCandidate, RobotDiagnosis, RobotGap};
use crate::report::chances::power;
use crate::report::gap::text::{WIDTH, file, mrad, opening, paragraph, rms_row, rms_table};
use crate::report::gap::waterfall::closes_alone;
use crate::report::gap::words as joint_words;
use crate::report::measure::ANGLE;
use crate::report::number::{share, significant};
use crate::report::text::{finish, number, one_line, table, wrap};

/// Writes a robot's diagnosis as plain text, as a rule at most 100 columns wide, ending in a newline.
///
/// The sentence with its probability, the steps from as given to the floor, what to do next, where the gap lies, which
/// causes were fitted, how far the gap closes joint by joint and in the trunk's way, what the logs could have shown, then
/// the notes.
pub fn robot_gap_text(report: &RobotGapReport) -> String {
    let diagnosis = &report.diagnosis;
    let answer = &diagnosis.answer;
    let blocks = [
        Some(opening(&answer.sentence, &words::chances(diagnosis), &answer.probability_source)),
        Some(waterfall::text(diagnosis)),
        next(diagnosis),
        Some(location(diagnosis)),
        (!diagnosis.ranking.is_empty()).then(|| ranking(diagnosis)),
        Some(how_far(&diagnosis.gap)),
        displacement(&diagnosis.gap),
        detectable(diagnosis),
        notes(report),
    ];
    blocks.into_iter().flatten().collect::<Vec<_>>().join("\n\n") + "\n"
}

/// Words, then the map of joint and phase.
fn location(diagnosis: &RobotDiagnosis) -> String {
    let location = &diagnosis.location;
    let words = paragraph(&words::location(location));
    if location.cells.is_empty() {
        return words;
    }
    let (joints, phases) = words::joints_and_phases(&location.cells);
    let names: Vec<&str> = phases.iter().map(|phase| phase.name()).collect();
    let mut table = table(WIDTH, &["gap above the\nnoise [mrad RMS]"], &names);
    for joint in joints {
        let excess = |phase: &GaitPhase| {
            let cell = location.cells.iter().find(|cell| cell.joint == joint && cell.phase == *phase);
            number(cell.map_or_else(|| "-".to_owned(), excess))
        };
        table.add_row(std::iter::once(Cell::new(one_line(joint))).chain(phases.iter().map(excess)));
    }
    format!("{words}\n{}\n* more than noise alone would give", finish(&mut table))
}

fn excess(cell: &GaitCell) -> String {
    let mark = if cell.significant { "*" } else { " " };
    format!("{}{mark}", significant(1e3 * cell.excess_rad, 2))
}

/// Every candidate that was refitted, between what was given and the sensor's noise.
fn ranking(diagnosis: &RobotDiagnosis) -> String {
    let gap = &diagnosis.gap;
    let words = ["which", "parameters with 95 % intervals"];
    let mut table = table(WIDTH, &words, &["RMS\n[mrad]", "closes\nalone", "worse\nby", "probability"]);
    let plain = |table: &mut Table, name: &str, rms: f64| {
        table.add_row([Cell::new(name), Cell::new(""), mrad(rms)]);
    };
    plain(&mut table, "(as given)", gap.before);
    plain(&mut table, "(recalibrated)", gap.calibrated);
    if let (Some(_), Some(both)) = (&diagnosis.answer.second, words::answer(&diagnosis.answer)) {
        plain(&mut table, &format!("({both})"), gap.after);
    }
    let chances = words::chances(diagnosis);
    for (candidate, chance) in diagnosis.ranking.iter().zip(&chances.candidates) {
        let RobotCandidate { found, after, behind, .. } = candidate;
        let closes = closes_alone([gap.calibrated, gap.floor], *after);
        let mark = if words::is_named(&diagnosis.answer, candidate) { " *" } else { "" };
        table.add_row([
            Cell::new(format!("{}{mark}", words::found(found).replacen(' ', "\n  ", 1))),
            Cell::new(found.parameters.iter().map(joint_words::parameter).collect::<Vec<_>>().join("\n")),
            mrad(*after),
            number(closes.map_or_else(|| "-".to_owned(), share)),
            number(significant(*behind, 2)),
            number(chance),
        ]);
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
    format!("{text}\n{}", paragraph(words::BEHIND))
}

/// Joint by joint, log by log where there are several, and in all.
fn how_far(gap: &RobotGap) -> String {
    let mut table = rms_table("RMS, held-out samples", ANGLE);
    for joint in &gap.per_joint {
        let name = Cell::new(one_line(&joint.joint));
        table.add_row(rms_row(name, ANGLE, [joint.before, joint.calibrated, joint.after, gap.floor]));
    }
    // A log without held-out samples has no error there.
    for log in gap.per_log.iter().filter(|log| gap.per_log.len() > 1 && log.before > 0.0) {
        table.add_row(rms_row(file(&log.file), ANGLE, [log.before, log.calibrated, log.after, log.floor]));
    }
    table.add_row(rms_row(Cell::new("all"), ANGLE, [gap.before, gap.calibrated, gap.after, gap.floor]));
    let closed =
        format!("Gap closed: {}. Held out: {}.", joint_words::closed(gap.closed, gap.closed_interval), gap.held_out);
    format!("{}\n{}", finish(&mut table), paragraph(&closed))
}

fn displacement(gap: &RobotGap) -> Option<String> {
    if gap.displacement.is_empty() {
        return None;
    }
    let mut table = table(WIDTH, &["how far the trunk went"], &["measured\n[m]", "as given\n[m]", "after\n[m]"]);
    let metres = |m: f64| number(format!("{m:.3}"));
    for log in &gap.displacement {
        table.add_row([file(&log.file), metres(log.measured), metres(log.before), metres(log.after)]);
    }
    Some(finish(&mut table))
}

fn detectable(diagnosis: &RobotDiagnosis) -> Option<String> {
    let room = diagnosis.detectable.iter().map(|d| d.cause.id().len()).max()? + 2;
    let mut text = paragraph(words::DETECTABLE);
    for detectable in &diagnosis.detectable {
        text += &format!("\n  {:<room$}{}", detectable.cause.id(), words::threshold(detectable));
    }
    Some(text)
}

fn next(diagnosis: &RobotDiagnosis) -> Option<String> {
    let next = diagnosis.next.as_ref()?;
    let power = power(next.power);
    Some(wrap(WIDTH, &format!("{}; it would decide with probability {power}.", next.what), "Next: ", "  "))
}

fn notes(report: &RobotGapReport) -> Option<String> {
    let notes: Vec<String> = words::notes(report).iter().map(|note| wrap(WIDTH, note, "- ", "  ")).collect();
    (!notes.is_empty()).then(|| notes.join("\n"))
}
