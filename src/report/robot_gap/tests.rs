//! What the report of a robot's diagnosis says, whatever was found.

use super::sample;
use super::*;
use crate::report::html::tests::is_alone;
use serde_json::Value;

#[test]
fn verdict_opens_the_text_and_no_line_is_wider_than_the_page() {
    for (name, report) in sample::all() {
        let text = robot_gap_text(&report);
        let widest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        assert!(widest <= 100, "{name}, {widest} columns:\n{text}");
        assert!(text.ends_with('\n') && !text.contains(" \n") && !text.contains("NaN"), "{name}:\n{text}");
        assert!(text.starts_with(&report.diagnosis.answer.sentence), "{name}:\n{text}");
    }
    let text = robot_gap_text(&sample::effect());
    assert!(text.contains("torque_limit") && text.contains("  lf2, rf2, lr2, rr2 *"), "{text}");
    assert!(text.contains("(with torque_limit lf2, rf2,") && text.contains("lr2, rr2 and floor_friction)"), "{text}");
    assert!(text.contains("0.362") && text.contains("Withheld from the catalogue on demand: floor_slope."), "{text}");
    assert!(robot_gap_text(&sample::nothing()).contains("There is no gap to place."));
    assert!(robot_gap_text(&sample::unexplained()).contains("* comes closest"));
}

#[test]
fn page_opens_with_the_verdict_needs_no_network_and_shows_only_numbers() {
    for (name, report) in sample::all() {
        let page = robot_gap_html(&report).expect("a page");
        is_alone(&page);
        let body = page.split_once("<body>").expect("a body").1;
        assert!(!body.contains("NaN") && !body.contains(">inf"), "{name}");
        assert!(!body.contains("<b>walk") && body.contains("&lt;b&gt;walk"), "{name}");
        let order = ["class=\"verdict\"", ">Where<", ">Which<", ">How far<", ">Joints<", ">Provenance<"];
        let places: Vec<_> = order.iter().map(|heading| page.find(heading)).collect();
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{name}: {places:?}");
        assert_eq!(page, robot_gap_html(&report).expect("a page"), "{name}");
    }
}

#[test]
fn json_names_cause_joints_and_changes() {
    let of = |report: &RobotGapReport| serde_json::to_value(robot_gap_json(report)).expect("it can be written");
    let json: Value = of(&sample::effect());
    assert_eq!((&json["effect"], &json["second"]), (&"torque_limit".into(), &"floor_friction".into()));
    assert_eq!((&json["where"]["stage"], &json["where"]["phase"]), (&"motor".into(), &"stance".into()));
    assert_eq!(json["changes"][0]["joints"], serde_json::json!(["lf2", "rf2", "lr2", "rr2"]));
    assert_eq!(json["changes"][0]["values"]["tau_max"], 0.12);
    assert_eq!(
        (&json["detectable"]["payload"]["value"], &json["second_joints"]),
        (&Value::Null, &serde_json::json!([]))
    );
    let none = of(&sample::nothing());
    assert!(none["effect"].is_null() && none["next"].is_null() && none["gap"]["closed"].is_null());
    let left = json["repaired"]["rms"].as_f64().expect("cycles are held out");
    assert!((1e-4..2e-3).contains(&left), "{left}: 0.3 against 0.299 rad");
    assert_eq!(of(&sample::unexplained())["partial"], "floor_friction");
}

#[test]
fn every_figure_has_a_name_of_its_own() {
    for (name, report) in sample::all() {
        let figures = robot_gap_figures(&report).expect("figures");
        let mut names: Vec<&str> = figures.iter().map(|figure| figure.file_name.as_str()).collect();
        assert!(names.contains(&"map.svg"), "{name}: {names:?}");
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count, "{name}");
        assert!(figures.iter().all(|figure| !figure.svg.contains("NaN")), "{name}");
    }
}
