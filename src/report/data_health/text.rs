//! Data health for a terminal.

use comfy_table::Cell;

use crate::report::LogHealthRow;
use crate::report::gap::text::WIDTH;
use crate::report::number::significant;
use crate::report::rows::shorten;
use crate::report::text::{at_most, finish, number, one_line, table, wrap};

/// Characters of a file name, and on a narrow terminal, where remarks name it in full.
const NAME: usize = 22;
const SHORT_NAME: usize = 15;
/// From so many columns on a terminal is not narrow.
const ROOMY: usize = 90;

fn name(file: &str) -> Cell {
    Cell::new(shorten(&one_line(file), if at_most(WIDTH) < ROOMY { SHORT_NAME } else { NAME }))
}

/// One line for each log, then what is odd about it.
pub(in crate::report) fn health_text(rows: &[LogHealthRow]) -> String {
    let rests = rows.iter().any(|row| row.rest_from_s.is_some());
    let columns = [
        "samples",
        "duration\n[s]",
        "period\n[ms]",
        "jitter\n[ms]",
        "lost",
        "step\n[mrad]",
        "noise\n[mrad]",
        "rests from\n[s]",
    ];
    let columns = if rests { &columns[..] } else { &columns[..columns.len() - 1] };
    let mut table = table(WIDTH, &["log", "role"], columns);
    let milli = |value: f64| number(if value < 1e-9 { "0".to_owned() } else { significant(1e3 * value, 3) });
    let dash = || number("-".to_owned());
    for row in rows {
        let cells = [
            name(&row.file),
            Cell::new(&row.role),
            number(row.samples.to_string()),
            number(format!("{:.2}", row.duration_s)),
            milli(row.period_s),
            milli(row.jitter_s),
            number(row.lost.to_string()),
            if row.resolution_rad > 0.0 { milli(row.resolution_rad) } else { dash() },
            row.noise_rad.map_or_else(dash, milli),
        ];
        let rest_from = || row.rest_from_s.map_or_else(dash, |rest| number(format!("{rest:.2}")));
        table.add_row(cells.into_iter().chain(rests.then(rest_from)));
    }
    let mut text = finish(&mut table);
    for row in rows.iter().filter(|row| !row.remarks.is_empty()) {
        text += "\n";
        text += &remark(&one_line(&row.file), &row.remarks);
    }
    text
}

fn remark(of: &str, remarks: &[String]) -> String {
    wrap(WIDTH, &format!("{of}: {}.", remarks.join("; ")), "- ", "  ")
}

/// What each log's motion offers to a fit.
pub(in crate::report) fn motion_text(rows: &[LogHealthRow]) -> String {
    let columns =
        ["travel\n[rad]", "top speed\n[rad/s]", "reversals", "still\n[%]", "noise lasts\n[ms]", "longest step\n[ms]"];
    let mut table = table(WIDTH, &["motion"], &columns);
    for row in rows {
        let more = &row.more;
        table.add_row([
            name(&row.file),
            number(significant(more.travel_rad, 3)),
            number(significant(more.top_speed_rad_s, 3)),
            number(more.reversals.to_string()),
            number(format!("{:.0}", 100.0 * more.still_share)),
            number(more.noise_lasts_s.map_or_else(|| "-".to_owned(), |lasts_s| format!("{:.1}", 1e3 * lasts_s))),
            number(significant(1e3 * more.longest_step_s, 3)),
        ]);
    }
    finish(&mut table)
}

/// The health of a robot's logs: what joints have in common once, steps and noise as the largest of them.
pub(in crate::report) fn robot_health_text(joints: &[(&str, &[LogHealthRow])]) -> String {
    let (rows, remarks) = together(joints);
    let bare: Vec<LogHealthRow> = rows.into_iter().map(|row| LogHealthRow { remarks: Vec::new(), ..row }).collect();
    let lines = remarks.iter().map(|(of, remarks)| "\n".to_owned() + &remark(&one_line(of), remarks));
    health_text(&bare) + &lines.collect::<String>()
}

/// One row for each log of a robot, and remarks with whose they are: the log's where all joints have them.
pub(in crate::report) fn together(
    joints: &[(&str, &[LogHealthRow])],
) -> (Vec<LogHealthRow>, Vec<(String, Vec<String>)>) {
    let mut rows: Vec<LogHealthRow> = Vec::new();
    let mut said: Vec<(String, String, Vec<&str>)> = Vec::new();
    for (joint, own) in joints {
        for row in *own {
            match rows.iter_mut().find(|known| known.file == row.file) {
                Some(known) => {
                    known.resolution_rad = known.resolution_rad.max(row.resolution_rad);
                    known.noise_rad = known.noise_rad.into_iter().chain(row.noise_rad).reduce(f64::max);
                    known.rest_from_s = known.rest_from_s.zip(row.rest_from_s).map(|(a, b)| a.max(b));
                }
                None => rows.push(row.clone()),
            }
            for remark in &row.remarks {
                match said.iter_mut().find(|(file, known, _)| *file == row.file && known == remark) {
                    Some((_, _, of)) => of.push(joint),
                    None => said.push((row.file.clone(), remark.clone(), vec![joint])),
                }
            }
        }
    }
    let mut remarks: Vec<(String, Vec<String>)> = Vec::new();
    for (file, remark, of) in said {
        let whose = if of.len() == joints.len() { file } else { format!("{file}, {}", of.join(", ")) };
        match remarks.iter_mut().find(|(known, _)| *known == whose) {
            Some((_, own)) => own.push(remark),
            None => remarks.push((whose, vec![remark])),
        }
    }
    (rows, remarks)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_all_joints_share_is_said_once() {
        let row = |remarks: &[&str], noise_rad| LogHealthRow {
            file: "a.csv".into(),
            role: "fit".into(),
            samples: 100,
            duration_s: 1.0,
            period_s: 0.01,
            jitter_s: 0.0,
            lost: 0,
            resolution_rad: 0.001,
            noise_rad: Some(noise_rad),
            release_s: None,
            rest_from_s: None,
            remarks: remarks.iter().map(|remark| (*remark).to_owned()).collect(),
            more: Default::default(),
        };
        let (elbow, wrist) = ([row(&["uneven sampling"], 0.001)], [row(&["uneven sampling", "never moves"], 0.002)]);
        let text = robot_health_text(&[("elbow", &elbow), ("wrist", &wrist)]);
        assert_eq!(
            (text.matches("uneven").count(), text.matches("a.csv, wrist: never moves").count()),
            (1, 1),
            "{text}"
        );
        assert!(text.contains("2.00"), "{text}");
    }
}
