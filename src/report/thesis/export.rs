//! The tables for programs and for pages: JSON, CSV, Markdown.

use super::ThesisReport;
use super::sections::sections;
use super::words::explanations;
use crate::thesis::Approach;
use serde_json::{Map, Value, json};

/// The tables as JSON: `table_3_1` to `table_3_4` and those beside them.
pub fn thesis_json(report: &ThesisReport) -> Value {
    let mut map = Map::new();
    map.insert("schema".into(), json!(1));
    map.insert("data".into(), json!(report.data));
    map.insert("version".into(), json!(report.provenance.version));
    map.insert("command".into(), json!(report.provenance.command));
    map.insert("inputs".into(), json!(report.provenance.hashed()));
    for section in sections(&report.tables) {
        let rows: Vec<Value> = section
            .rows
            .iter()
            .map(|row| {
                let mut value = json!(row);
                if let Some(object) = value.as_object_mut() {
                    object.insert("average".into(), json!(row.average()));
                    object.insert("difference".into(), json!(row.difference()));
                    object.insert("inside".into(), json!(row.inside()));
                }
                value
            })
            .collect();
        map.insert(section.key.into(), Value::Array(rows));
    }
    let answers: Vec<Value> = explanations(report)
        .iter()
        .map(|answer| json!({ "question": answer.question, "sentences": answer.sentences }))
        .collect();
    map.insert("explanation".into(), json!({ "answers": answers, "scan": puzzle_json(report) }));
    Value::Object(map)
}

/// All tables as one CSV file, full digits.
pub fn thesis_csv(report: &ThesisReport) -> String {
    let mut text = String::from("table,of,quantity,swings,unit,thesis,four_tests,ours,low,high,identifiable,remark\n");
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for section in sections(&report.tables) {
        for row in section.rows {
            let fields = [
                section.key.to_owned(),
                row.of.name().to_owned(),
                row.quantity.clone(),
                row.swings.clone(),
                row.unit.clone(),
                number(row.thesis),
                number(row.average()),
                number(row.ours),
                number(row.interval.map(|[low, _]| low)),
                number(row.interval.map(|[_, high]| high)),
                row.identifiable.to_string(),
                format!("\"{}\"", row.remark.replace('"', "\"\"")),
            ];
            text += &(fields.join(",") + "\n");
        }
    }
    text
}

/// All tables and the explanation as Markdown.
pub fn thesis_markdown(report: &ThesisReport) -> String {
    let mut text = format!("# Chapter 3 on {}\n\nPrinted by `{}`.\n", report.data, report.provenance.command);
    let grid = |columns: &[&str], rows: &[Vec<String>]| {
        let mut text = format!("\n| {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len()));
        for cells in rows {
            text += &format!("| {} |\n", cells.join(" | "));
        }
        text
    };
    for section in sections(&report.tables).iter().filter(|section| !section.rows.is_empty()) {
        let shown = section.shown();
        text += &format!("\n## {}\n\n{}\n", section.title, section.words);
        text += &grid(&shown.columns, &shown.rows);
        for remark in &shown.remarks {
            text += &format!("\n{remark}\n");
        }
    }
    for answer in explanations(report) {
        text += &format!("\n## {}\n\n", answer.question);
        for sentence in &answer.sentences {
            text += &format!("- {sentence}\n");
        }
        if let Some(table) = &answer.table {
            text += &grid(&table.columns, &table.rows);
        }
    }
    text
}

/// The scans as JSON.
fn puzzle_json(report: &ThesisReport) -> Value {
    let puzzle = &report.tables.puzzle;
    let approach = |a: &Approach| {
        let what: Vec<Value> =
            a.what.iter().map(|(c, size)| json!({ "candidate": c.name, "size": size, "unit": c.unit })).collect();
        json!({ "what": what, "b_over_ml2": a.ratios_1_s, "mass_kg": a.mass_kg, "misfit": a.misfit,
            "coulomb_bare_nm": a.coulomb.and_then(|c| c.bare_nm),
            "coulomb_loaded_nm": a.coulomb.map(|c| c.loaded_nm) })
    };
    let ranges: Vec<Value> = puzzle
        .candidates()
        .iter()
        .map(|c| json!({ "candidate": c.name, "size": c.size, "unit": c.unit, "range": c.range }))
        .collect();
    let joints: Vec<Value> = puzzle
        .joints
        .iter()
        .map(|j| {
            json!({ "joint": j.joint.to_string(), "printed": j.printed_1_s, "release_rad": j.release_rad,
                "table_3_3": j.as_printed.as_ref().map(approach),
                "alone": j.alone.iter().map(|s| json!({ "candidate": s.candidate.name, "curve": s.curve,
                    "nearest": approach(&s.nearest) })).collect::<Vec<_>>(),
                "with_load": j.with_load.iter().map(approach).collect::<Vec<_>>(),
                "pairs": j.pairs.iter().map(approach).collect::<Vec<_>>() })
        })
        .collect();
    json!({ "ranges": ranges, "joints": joints })
}
