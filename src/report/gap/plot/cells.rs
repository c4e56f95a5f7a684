//! Maps of cells: where the gap lies, and which answers the twins got.

use plotters::style::RGBColor;

use crate::gap::{Confusion, Diagnosis, Phase};
use crate::report::ReportError;
use crate::report::gap::words::{files_and_phases, names_without_folder};
use crate::report::number;
use crate::report::plot::canvas::{AFTER, POSITIVE, SHADE};
use crate::report::plot::heat::{Heat, HeatCell, NO_VALUE, UNUSED, heat, tint};

/// Draws the share of the gap by log and phase, with the sums.
pub(super) fn map(diagnosis: &Diagnosis) -> Result<String, ReportError> {
    let cells = &diagnosis.location.cells;
    let (files, phases) = files_and_phases(cells);
    let mut rows = names_without_folder(&files);
    rows.push("all logs".to_owned());
    let mut columns: Vec<String> = phases.iter().map(|phase| phase.name().to_owned()).collect();
    columns.push("all".to_owned());
    let most = cells.iter().map(|cell| cell.share).filter(|share| share.is_finite()).fold(0.0, f64::max);
    let height = if rows.len() > 24 { 20.0 } else { 32.0 };
    let map = Heat {
        title: &format!("{}: where the gap lies", diagnosis.joint),
        rows: &rows,
        columns: &columns,
        name_room: 190.0,
        cell: [96.0, height],
        names_above: true,
        axes: ["", ""],
        colour: |share| tint(POSITIVE, share),
        scale: &[(1.0, &number::share(most)), (0.0, "0 %")],
        nothing: "no log moves",
    };
    let shares: Vec<f64> = cells.iter().map(|cell| cell.share).collect();
    let (percents, shown) = (number::share_percents(&shares), number::shares(&shares));
    // Sums of what is shown: nobody adds up anything else.
    let sum = |file: Option<&&str>, phase: Option<&Phase>| -> u32 {
        let counts = |cell: &crate::gap::MapCell| {
            file.is_none_or(|file| cell.file == **file) && phase.is_none_or(|phase| cell.phase == *phase)
        };
        cells.iter().zip(&percents).filter(|(cell, _)| counts(cell)).map(|(_, percent)| percent).sum()
    };
    let of_most = |share: f64| if most > 0.0 && share.is_finite() { share / most } else { 0.0 };
    heat(&map, |row, column| {
        let (file, phase) = (files.get(row), phases.get(column));
        let (Some(file), Some(phase)) = (file, phase) else {
            return HeatCell { ground: NO_VALUE, words: format!("{} %", sum(file, phase)), framed: false };
        };
        match cells.iter().zip(&shown).find(|(cell, _)| cell.file == *file && cell.phase == *phase) {
            Some((cell, shown)) => HeatCell {
                ground: tint(if cell.significant { POSITIVE } else { SHADE }, of_most(cell.share)),
                words: shown.clone(),
                framed: cell.significant,
            },
            None => HeatCell { ground: tint(SHADE, 0.0), words: String::new(), framed: false },
        }
    })
}

/// Draws how often each answer was given for each true cause, as counts; the colour is the share of the cause's twins.
pub(super) fn confusion(joint: &str, table: &Confusion) -> Result<String, ReportError> {
    let map = Heat {
        title: &format!("{joint}: answers on twins of these logs"),
        rows: &table.names,
        columns: &table.names,
        name_room: 150.0,
        cell: [56.0, 40.0],
        names_above: false,
        axes: ["true cause \u{2193}", "answer \u{2192}, names below"],
        colour: share_of_cause,
        scale: &[(1.0, "100 %"), (0.5, "50 %"), (0.0, "0 %")],
        nothing: "no twins",
    };
    heat(&map, |row, column| {
        let counts = table.counts.get(row).map_or(&[][..], |counts| counts);
        let (count, total) = (counts.get(column).copied().unwrap_or(0), counts.iter().sum::<u32>());
        HeatCell {
            ground: if count > 0 { share_of_cause(f64::from(count) / f64::from(total)) } else { UNUSED },
            words: if count > 0 { count.to_string() } else { String::new() },
            framed: false,
        }
    })
}

fn share_of_cause(share: f64) -> RGBColor {
    tint(AFTER, share)
}
