//! The fleet for a terminal.

use super::{FleetReport, JointTrend};
use crate::report::gap::text::{WIDTH, paragraph};
use crate::report::number::UNKNOWN;
use crate::report::text::{finish, number, one_line, table};
use comfy_table::Cell;

/// Joints and errors that are printed; the page has all of them.
const PRINTED: usize = 25;

/// Writes the joints that part from their models, the studies without an answer, and the sentence in the last line.
pub fn fleet_text(report: &FleetReport) -> String {
    let mut blocks = Vec::new();
    let off: Vec<&JointTrend> = report.off().collect();
    if !off.is_empty() {
        let mut table = table(WIDTH, &["robot", "joint", "since", "cause"], &["first gap", "latest gap"]);
        for joint in off.iter().take(PRINTED) {
            let gap = |gap: f64| number(joint.measure().quantity(gap));
            table.add_row([
                Cell::new(one_line(joint.robot.as_deref().unwrap_or("-"))),
                Cell::new(one_line(&joint.joint)),
                Cell::new(joint.since.map_or_else(|| UNKNOWN.to_owned(), |day| day.to_string())),
                Cell::new(joint.latest.cause.as_deref().unwrap_or_default()),
                gap(joint.points.first().map_or(f64::NAN, |point| point.gap)),
                gap(joint.gap()),
            ]);
        }
        blocks.push(finish(&mut table));
        if off.len() > PRINTED {
            blocks.push(format!("... and {} more joints", off.len() - PRINTED));
        }
    }
    let told = |(study, why): (&str, &str)| {
        // Most errors begin with the file that they are in.
        let why = why.strip_prefix(study).and_then(|why| why.strip_prefix(": ")).unwrap_or(why);
        format!("{study}: no answer: {why}")
    };
    let failed: Vec<String> = report.failed().map(told).collect();
    blocks.extend(failed.iter().take(PRINTED).cloned());
    if failed.len() > PRINTED {
        blocks.push(format!("... and {} more studies without an answer", failed.len() - PRINTED));
    }
    blocks.push(paragraph(&report.sentence()));
    blocks.join("\n\n") + "\n"
}
