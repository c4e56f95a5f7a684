//! Where a robot's gap lies: joint by phase.

use super::ClampedGapReport;
use crate::gap::{Diagnosis, Phase};
use crate::report::ReportError;
use crate::report::number::{share, share_percents};
use crate::report::plot::canvas::{POSITIVE, SHADE};
use crate::report::plot::heat::{Heat, HeatCell, NO_VALUE, heat, tint};

/// What a cell has of the whole robot's gap, and whether that is more than chance in any log.
fn cell(diagnosis: &Diagnosis, phase: Phase, all: f64) -> Option<(f64, bool)> {
    let cells = || diagnosis.location.cells.iter().filter(|cell| cell.phase == phase);
    cells().next()?;
    let of_joint: f64 = cells().map(|cell| cell.share).filter(|share| share.is_finite()).sum();
    Some((above(diagnosis) * of_joint / all.max(f64::MIN_POSITIVE), cells().any(|cell| cell.significant)))
}

/// Squares above the sensor's noise.
fn above(diagnosis: &Diagnosis) -> f64 {
    (diagnosis.gap.before.powi(2) - diagnosis.gap.floor.powi(2)).max(0.0)
}

/// Draws the share of the robot's gap by joint and phase; `None` where no joint has a map, or none has a gap.
pub(super) fn map(report: &ClampedGapReport) -> Result<Option<String>, ReportError> {
    let joints: Vec<&Diagnosis> = report.joints.iter().map(|(_, joint)| &joint.diagnosis).collect();
    let occurs = |phase: &Phase| joints.iter().any(|own| own.location.cells.iter().any(|cell| cell.phase == *phase));
    let phases: Vec<Phase> = Phase::ALL.into_iter().filter(occurs).collect();
    let all: f64 = joints.iter().map(|own| above(own)).sum();
    if phases.is_empty() || all <= 0.0 {
        return Ok(None);
    }
    let cells: Vec<Option<(f64, bool)>> =
        joints.iter().flat_map(|own| phases.iter().map(|phase| cell(own, *phase, all))).collect();
    let of_all: Vec<f64> = cells.iter().map(|cell| cell.map_or(0.0, |(share, _)| share)).collect();
    let (percents, most) = (share_percents(&of_all), of_all.iter().copied().fold(0.0, f64::max));
    if most <= 0.0 {
        return Ok(None);
    }
    let rows: Vec<String> = joints.iter().map(|own| own.joint.clone()).collect();
    let mut columns: Vec<String> = phases.iter().map(|phase| phase.name().to_owned()).collect();
    columns.push("all".to_owned());
    let table = Heat {
        title: &format!("{}: where the gap lies, joint by phase", report.diagnosis.robot),
        rows: &rows,
        columns: &columns,
        name_room: 150.0,
        cell: [96.0, if rows.len() > 14 { 22.0 } else { 30.0 }],
        names_above: true,
        axes: ["", ""],
        colour: |share| tint(POSITIVE, share),
        scale: &[(1.0, &share(most)), (0.0, "0 %")],
        nothing: "no joint moves",
    };
    let drawn = heat(&table, |row, column| {
        let none = HeatCell { ground: NO_VALUE, words: String::new(), framed: false };
        let first = row * phases.len();
        if column == phases.len() {
            // The sum of what is shown.
            let all: u32 = percents.iter().skip(first).take(phases.len()).sum();
            return HeatCell { words: format!("{all} %"), ..none };
        }
        cells.get(first + column).copied().flatten().map_or(none, |(of_all, significant)| HeatCell {
            ground: tint(if significant { POSITIVE } else { SHADE }, of_all / most),
            words: format!("{} %", percents[first + column]),
            framed: significant,
        })
    })?;
    Ok(Some(drawn))
}
