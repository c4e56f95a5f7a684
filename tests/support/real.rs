//! Real studies that a test changes: read with the logs' full paths, their columns altered, written to a folder of its own.

use super::{expect_code, json};
use serde_json::Value;
use std::fs;
use std::path::Path;
use toml::Table;

/// A study whose logs are named by their full paths, so that it can be written anywhere.
pub fn study_of(folder: &Path) -> Table {
    let mut study: Table = toml::from_str(&fs::read_to_string(folder.join("study.toml")).unwrap()).unwrap();
    for log in logs(&mut study) {
        let file = folder.join(log["file"].as_str().unwrap());
        log.insert("file".into(), file.to_str().unwrap().into());
    }
    study
}

pub fn logs(study: &mut Table) -> impl Iterator<Item = &mut Table> {
    study["log"].as_array_mut().unwrap().iter_mut().map(|log| log.as_table_mut().unwrap())
}

/// Multiplies a number of a table, where it is given.
pub fn scale(table: &mut Table, key: &str, by: f64) {
    if let Some(value) = table.get(key).and_then(|value| value.as_float()) {
        table.insert(key.into(), (value * by).into());
    }
}

/// Rewrites all logs into a folder; `change` gets the stamps \[s\] of a log, the name of a column and the column.
pub fn change_columns(study: &mut Table, folder: &Path, change: impl Fn(&[f64], &str, &mut [f64])) {
    for (k, log) in logs(study).enumerate() {
        let text = fs::read_to_string(log["file"].as_str().unwrap()).unwrap();
        let mut rows = text.lines().map(|row| row.split(',').collect::<Vec<_>>());
        let header = rows.next().unwrap();
        let rows: Vec<Vec<f64>> = rows.map(|row| row.iter().map(|cell| cell.parse().unwrap()).collect()).collect();
        let mut columns: Vec<Vec<f64>> = (0..header.len()).map(|i| rows.iter().map(|row| row[i]).collect()).collect();
        let stamps = columns[header.iter().position(|name| *name == "t").unwrap()].clone();
        for (name, column) in header.iter().zip(&mut columns) {
            change(&stamps, name, column);
        }
        let row = |i: usize| columns.iter().map(|column| format!("{:.6}", column[i])).collect::<Vec<_>>().join(",");
        let lines: Vec<String> = std::iter::once(header.join(",")).chain((0..rows.len()).map(row)).collect();
        let file = folder.join(format!("{k}.csv"));
        fs::write(&file, lines.join("\n") + "\n").unwrap();
        log.insert("file".into(), file.to_str().unwrap().into());
    }
}

/// What `gap` says of a study that is written into the folder.
pub fn diagnosed(study: &Table, folder: &Path) -> Value {
    fs::write(folder.join("study.toml"), toml::to_string(study).unwrap()).unwrap();
    expect_code(folder, &["gap", "study.toml", "--json", "gap.json", "--out", "out", "--quiet"], 0);
    json(&folder.join("gap.json"))
}
