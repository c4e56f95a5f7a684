//! The gate as a short summary in Markdown, for a pull request.

use super::text::verdict;
use crate::gap::gate::{GateRow, GateStudy};
use std::fmt::Write as _;

/// Writes the summary: the verdict, what is exceeded and why, all rows folded away.
pub fn gate_markdown(studies: &[GateStudy]) -> String {
    let mut text = format!("### Sim-to-real: {}\n", verdict(studies));
    let rows: Vec<&GateRow> = studies.iter().flat_map(|study| &study.rows).collect();
    let has_several = studies.len() > 1;
    for row in &rows {
        if let Some(exceeds) = row.exceeds() {
            let _ = write!(
                text,
                "\n- {}**{}**, `{}`: {} — {}",
                if has_several { format!("`{}`, ", row.study.replace('`', "'")) } else { String::new() },
                escaped(&row.joint),
                row.log.replace('`', "'"),
                escaped(&exceeds),
                escaped(&row.sentence)
            );
        }
    }
    for study in studies {
        if let Some(error) = &study.error {
            let first = error.lines().next().unwrap_or_default();
            let _ = write!(text, "\n- `{}` has no answer: {}", study.study.replace('`', "'"), escaped(first));
        }
    }
    if !rows.is_empty() {
        text += "\n\n<details><summary>All logs</summary>\n\n";
        let [head, line] = if has_several { ["| study ", "|---"] } else { [""; 2] };
        let _ = write!(
            text,
            "{head}| joint | log | gap | baseline | growth | cause | |\n{line}|---|---|---:|---:|---:|---|---|\n"
        );
        for row in rows {
            let measure = row.measure();
            let _ = writeln!(
                text,
                "{}| {} | {} | {} | {} | {} | {} | {} |",
                if has_several { format!("| {} ", escaped(&row.study)) } else { String::new() },
                escaped(&row.joint),
                escaped(&row.log),
                measure.quantity(row.gap),
                row.baseline.map_or_else(|| "-".to_owned(), |before| measure.quantity(before)),
                row.growth().map_or_else(|| "-".to_owned(), |growth| format!("{:+.1} %", 100.0 * growth)),
                escaped(&row.cause),
                if row.passes() { "✅" } else { "❌" }
            );
        }
        text += "\n</details>\n";
    }
    text
}

/// A text in which nothing is markup.
fn escaped(text: &str) -> String {
    let one_line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    one_line.chars().fold(String::new(), |mut done, c| {
        if matches!(c, '\\' | '*' | '_' | '`' | '<' | '>' | '[' | ']' | '#' | '|') {
            done.push('\\');
        }
        done.push(c);
        done
    })
}
