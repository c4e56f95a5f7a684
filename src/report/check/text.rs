//! `check` as text for a terminal.

use super::summary::{COLUMNS, doubts, summary};
use super::{CheckReport, LEFT, SOUND, STILL, are_sound, left, sizes, without_study};
use crate::gap::Checkup;
use crate::identify::BeliefFound;
use crate::report::beliefs::belief_table;
use crate::report::data_health::{health_text, motion_text};
use crate::report::gap::text::{WIDTH, detectable, paragraph, undetermined};
use crate::report::gap::words::UNDETERMINED;
use crate::report::text::wrap;

/// Writes a check as plain text, at most 100 columns wide where file names allow it, ending in a newline.
pub fn check_text(report: &CheckReport) -> String {
    // What makes all below it doubtful comes first.
    let doubts = report.doubts.iter().map(|doubt| paragraph(doubt) + "\n\n");
    let sound = if are_sound(&[("", Some(report))]) { paragraph(SOUND) + "\n\n" } else { String::new() };
    doubts.collect::<String>() + &sound + &told(report)
}

/// What a check has found, but for what is to be questioned of the study.
fn told(report: &CheckReport) -> String {
    let mut blocks: Vec<String> =
        report.checkup.iter().map(|checkup| paragraph(&sizes(&report.joint, checkup))).collect();
    blocks.extend([health_text(&report.health), motion_text(&report.health)]);
    match &report.checkup {
        None => blocks.push(paragraph(&without_study([report].into_iter()))),
        Some(checkup) => {
            blocks.push(numbers(checkup));
            blocks.push(undetermined(&checkup.undetermined).unwrap_or_else(|| {
                paragraph(&format!("{UNDETERMINED}: nothing; of every number they say more than is believed of it."))
            }));
            blocks.extend(detectable(&checkup.detectable));
            if left(checkup) {
                blocks.push(paragraph(LEFT));
            }
        }
    }
    blocks.join("\n\n") + "\n"
}

/// All joints at a glance, then the check of each with its name above it; `None`: one that never moved.
pub fn checks_text(joints: &[(&str, Option<&CheckReport>)], notes: &[String]) -> String {
    let is_study = joints.iter().any(|(_, report)| report.is_some_and(CheckReport::is_of_study));
    let mut text: String = doubts(joints).iter().map(|doubt| paragraph(doubt) + "\n\n").collect();
    if are_sound(joints) {
        text += &(paragraph(SOUND) + "\n\n");
    }
    if let Some(rows) = summary(joints) {
        text += &format!("{}\n{}\n\n", rows.text(WIDTH), paragraph(COLUMNS));
    }
    for (name, report) in joints {
        text += &format!("== {name} ==\n");
        text += &match report {
            None => "It never moved: nothing to check.\n".to_owned(),
            Some(CheckReport { health: rows, checkup: None, predicts_torques, .. }) => {
                let is_still = is_study && !predicts_torques;
                let more = if is_still { format!("\n{STILL}\n") } else { String::new() };
                health_text(rows) + "\n\n" + &motion_text(rows) + "\n" + &more
            }
            Some(report) => told(report),
        };
        text += "\n";
    }
    if !is_study && joints.iter().any(|(_, report)| report.is_some()) {
        text += &paragraph(&without_study(joints.iter().filter_map(|(_, report)| *report)));
        text += "\n";
    }
    notes.iter().for_each(|note| text += &(wrap(WIDTH, note, "- ", "  ") + "\n"));
    text
}

/// What is believed of each number, and what these logs make of it.
fn numbers(checkup: &Checkup) -> String {
    let table = belief_table(WIDTH, &checkup.beliefs, |belief| interval(checkup, belief));
    let words = "No effect is added yet: these numbers also take up what one would explain.";
    format!("{table}\n{}", paragraph(words))
}

fn interval(checkup: &Checkup, belief: &BeliefFound) -> Option<[f64; 2]> {
    checkup.parameters.iter().find(|p| p.name == belief.name).and_then(|p| p.interval)
}
