//! The tables for programs and for pages: JSON, CSV, Markdown.

use super::ThesisReport;
use super::sections::{COLUMNS, cells, sections};
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

/// All tables as Markdown.
pub fn thesis_markdown(report: &ThesisReport) -> String {
    let mut text = format!("# Chapter 3 on {}\n\nPrinted by `{}`.\n", report.data, report.provenance.command);
    for section in sections(&report.tables).iter().filter(|section| !section.rows.is_empty()) {
        text += &format!("\n## {}\n\n{}\n\n", section.title, section.words);
        text += &format!("| {} |\n|{}\n", COLUMNS.join(" | "), "---|".repeat(COLUMNS.len()));
        for row in &section.rows {
            text += &format!("| {} |\n", cells(row).join(" | "));
        }
    }
    text
}
