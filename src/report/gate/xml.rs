//! The gate as JUnit XML, which CI systems show as tests.

use crate::gap::gate::{GateRow, GateStudy};
use std::fmt::Write as _;

/// Writes one suite for each study and one case for each joint in each log.
pub fn gate_junit(studies: &[GateStudy]) -> String {
    let failures = |study: &GateStudy| study.rows.iter().filter(|row| !row.passes()).count();
    let tests = |study: &GateStudy| study.rows.len() + usize::from(study.error.is_some());
    let errors = |study: &GateStudy| usize::from(study.error.is_some());
    let sum = |of: &dyn Fn(&GateStudy) -> usize| studies.iter().map(of).sum::<usize>();
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let _ = writeln!(
        text,
        "<testsuites name=\"aibo-fit gate\" tests=\"{}\" failures=\"{}\" errors=\"{}\">",
        sum(&tests),
        sum(&failures),
        sum(&errors)
    );
    for study in studies {
        let _ = writeln!(
            text,
            "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\">",
            escaped(&study.study),
            tests(study),
            failures(study),
            errors(study)
        );
        study.rows.iter().for_each(|row| text += &case(row));
        if let Some(error) = &study.error {
            let name = escaped(&study.study);
            let _ = writeln!(text, "    <testcase classname=\"{name}\" name=\"study\">");
            let _ = writeln!(text, "      <error message=\"no answer\">{}</error>\n    </testcase>", escaped(error));
        }
        text += "  </testsuite>\n";
    }
    text + "</testsuites>\n"
}

fn case(row: &GateRow) -> String {
    let (joint, log) = (escaped(&row.joint), escaped(&row.log));
    let head = format!("    <testcase classname=\"{joint}\" name=\"{log}\"");
    match row.exceeds() {
        None => head + "/>\n",
        Some(exceeds) => format!(
            "{head}>\n      <failure message=\"{}\" type=\"{}\">{}</failure>\n    </testcase>\n",
            escaped(&exceeds),
            escaped(&row.cause),
            escaped(&row.sentence)
        ),
    }
}

/// A text as XML has it; control characters that it cannot have are left out.
fn escaped(text: &str) -> String {
    let mut done = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => done += "&amp;",
            '<' => done += "&lt;",
            '>' => done += "&gt;",
            '"' => done += "&quot;",
            '\n' => done += "&#10;",
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => done.push(c),
        }
    }
    done
}
