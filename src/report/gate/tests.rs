use super::*;
use serde_json::json;

fn document(before: f64) -> Value {
    json!({
        "name": "hip", "verdict": "effect", "effect": "delay", "sentence": "hip: the gap is a delay <16 ms>.",
        "effects": [{ "id": "delay" }, { "id": "stribeck" }],
        "gap": { "unit": "rad", "before": before, "per_log": [
            { "file": "a.csv", "before": before }, { "file": "b|c.csv", "before": 0.001 },
        ] },
    })
}

fn judged(before: f64, bounds: GateBounds, earlier: Option<f64>) -> GateStudy {
    gate_study("study.toml", &document(before), &bounds, &|_, log| earlier.filter(|_| log == "a.csv"))
}

#[test]
fn a_gap_beyond_its_bound_is_named_with_joint_log_and_cause() {
    let bounds = GateBounds { max_gap: Some(0.01), max_growth: None };
    assert!(judged(0.01, bounds, None).passes());
    let failed = judged(0.02, bounds, None);
    let exceeding: Vec<&GateRow> = failed.rows.iter().filter(|row| !row.passes()).collect();
    assert_eq!((exceeding.len(), exceeding[0].joint.as_str(), exceeding[0].log.as_str()), (1, "hip", "a.csv"));
    assert_eq!(exceeding[0].cause, "delay, stribeck");
    assert_eq!(exceeding[0].exceeds().as_deref(), Some("20.0 mrad is more than 10.0 mrad"));
}

#[test]
fn growth_counts_against_the_baseline_only() {
    let bounds = GateBounds { max_gap: None, max_growth: Some(0.1) };
    assert!(judged(0.0109, bounds, Some(0.01)).passes() && judged(0.5, bounds, None).passes());
    let failed = judged(0.012, bounds, Some(0.01));
    let words = failed.rows[0].exceeds().unwrap();
    assert_eq!(words, "12.0 mrad has grown by 20.0 % from 10.0 mrad, more than 10.0 %");
    // What the baseline does not have is said to be new.
    let new = judged(0.5, bounds, None);
    assert!(new.rows.iter().all(|row| row.is_new) && failed.rows.iter().filter(|row| row.is_new).count() == 1);
    let text = gate_text(&[new]);
    assert!(
        text.contains(" new") && text.contains("0 of 2 logs exceed what they may, 2 are not in the baseline"),
        "{text}"
    );
    // What is not a number passes nothing.
    assert!(!judged(f64::NAN, GateBounds { max_gap: Some(1.0), max_growth: None }, None).passes());
}

#[test]
fn a_gate_is_the_baseline_of_the_next_and_so_is_a_diagnosis() {
    let study = judged(0.02, GateBounds::default(), None);
    let gate = gate_json(&[study], &GateBounds::default(), "0", "aibo-fit gate study.toml");
    let key = |study: &str| (study.to_owned(), "hip".to_owned(), "a.csv".to_owned());
    assert_eq!(gate_baseline(&gate).unwrap()[&key("study.toml")], 0.02);
    assert_eq!(gate_baseline(&document(0.03)).unwrap()[&key("")], 0.03);
    assert_eq!(gate_baseline(&json!({ "schema": 1 })), None);
}

#[test]
fn xml_and_markdown_hold_what_names_hold() {
    let bounds = GateBounds { max_gap: Some(1e-4), max_growth: None };
    let studies = [judged(0.02, bounds, None), GateStudy::failed("bad & worse.toml", "line 1:\n<oops>".to_owned())];
    let xml = gate_junit(&studies);
    let read = roxmltree::Document::parse(&xml).unwrap();
    let count = |name: &str| read.descendants().filter(|node| node.has_tag_name(name)).count();
    assert_eq!((count("testsuite"), count("testcase"), count("failure"), count("error")), (2, 3, 2, 1), "{xml}");
    let root = read.root_element();
    assert_eq!(
        (root.attribute("tests"), root.attribute("failures"), root.attribute("errors")),
        (Some("3"), Some("2"), Some("1"))
    );
    let markdown = gate_markdown(&studies);
    assert!(markdown.contains("b\\|c.csv") && markdown.contains("gate failed: 2 of 2 logs"), "{markdown}");
    let text = gate_text(&studies);
    assert!(text.contains("bad & worse.toml: no answer"), "{text}");
    // Of several studies each row says whose it is, of one it need not.
    assert!(text.starts_with("study ") && markdown.contains("| study.toml | hip |"), "{text}\n{markdown}");
    let [text, markdown] = [gate_text(&studies[..1]), gate_markdown(&studies[..1])];
    assert!(text.starts_with("joint ") && markdown.contains("\n| hip |"), "{text}\n{markdown}");
}
