use super::*;
use serde_json::json;

fn study(day: &str, verdict: &str, before: f64) -> FleetStudy {
    let effects = if verdict == "effect" {
        json!([{ "id": "compliance", "parameters": {
            "d": { "value": 0.1, "unit": "N m s/rad", "interval": null },
            "k": { "value": 9.0, "unit": "N m/rad", "interval": [8.0, 10.0] } } }])
    } else {
        json!([])
    };
    let answer = json!({
        "name": "knee", "verdict": verdict, "effect": "moment", "probability": 0.9, "sentence": "knee: <so>.",
        "effects": effects, "detectable": { "compliance": { "parameter": "k" } },
        "beliefs": { "moment": { "found": 0.2, "unit": "kg m" } }, "joint": { "moment": { "interval": [0.1, 0.3] } },
        "gap": { "unit": "rad", "before": before, "per_log": [{ "file": "a.csv", "before": before, "after": 0.001 }] },
    });
    FleetStudy {
        study: format!("{day}/study.toml"),
        robot: Some("dog".to_owned()),
        days: [("a.csv".to_owned(), (Day::parse(day).unwrap(), DayFrom::Path))].into(),
        answer: Ok(answer),
        page: None,
    }
}

fn report(studies: &[FleetStudy]) -> FleetReport {
    FleetReport::new(studies, "0", "aibo-fit fleet '*.toml'")
}

#[test]
fn a_joint_drifts_since_the_first_of_the_last_studies_that_say_so() {
    let studies = [
        study("2026-03-04", "effect", 0.04),
        study("2026-03-01", "effect", 0.01),
        study("2026-03-02", "none", 0.002),
        study("2026-03-03", "calibration", 0.03),
    ];
    let found = report(&studies);
    let joint = &found.joints[0];
    assert_eq!((found.joints.len(), joint.since, joint.is_off()), (1, Day::parse("2026-03-03"), true));
    assert_eq!((joint.growth(), joint.latest.study.as_str()), (Some(4.0), "2026-03-04/study.toml"));
    assert!(found.rows.iter().all(|row| row.since == joint.since));
    let mended = report(&[study("2026-03-01", "effect", 0.01), study("2026-03-02", "none", 0.002)]);
    assert_eq!((mended.joints[0].since, mended.off().count()), (None, 0));
    assert_eq!(mended.sentence(), "2 studies are answered; none of 1 joint parts from its model.");
}

#[test]
fn a_size_is_the_effects_own_or_the_number_that_is_off() {
    let found = report(&[study("2026-03-01", "effect", 0.01), study("2026-03-02", "calibration", 0.01)]);
    let size = |parameter: &str, value, interval, unit: &str| {
        let [parameter, unit] = [parameter, unit].map(str::to_owned);
        Some(FleetSize { parameter, value, interval: Some(interval), unit })
    };
    assert_eq!(found.rows[0].size, size("k", 9.0, [8.0, 10.0], "N m/rad"));
    assert_eq!(found.rows[1].size, size("moment", 0.2, [0.1, 0.3], "kg m"));
    assert_eq!(report(&[study("2026-03-01", "none", 0.01)]).rows[0].size, None);
}

/// A study of an arm of one joint whose body `hand` has a payload, or has not.
fn arm_study(day: &str, joint: &str, has_payload: bool) -> FleetStudy {
    let of_joint = study(day, "effect", 0.01);
    let payload = json!({ "id": "payload", "body": "hand", "parameters": { "mass": { "value": 0.3, "unit": "kg" } } });
    let arm = json!({
        "name": "arm", "verdict": "effect", "probability": 0.5, "sentence": "arm: so.",
        "gap": { "unit": "rad", "before": 0.2, "after": 0.1 }, "joints": { joint: of_joint.answer.clone().unwrap() },
        "effects": if has_payload { json!([payload]) } else { json!([]) },
    });
    FleetStudy { answer: Ok(arm), ..of_joint }
}

#[test]
fn joints_of_a_robot_and_its_bodies_have_rows_of_their_own() {
    let found = report(&[arm_study("2026-03-01", "elbow", true)]);
    let names: Vec<_> =
        found.rows.iter().map(|row| (row.joint.as_deref(), row.cause.as_deref(), row.gap_before)).collect();
    let [hand, elbow] = [(Some("hand"), Some("payload"), Some(0.2)), (Some("elbow"), Some("compliance"), Some(0.01))];
    assert_eq!(names, [hand, elbow]);
}

#[test]
fn a_body_with_the_name_of_a_joint_has_a_trend_of_its_own() {
    let found = report(&[arm_study("2026-03-01", "hand", true)]);
    let causes: Vec<_> = found.joints.iter().map(|joint| (joint.latest.cause.as_deref(), joint.gap())).collect();
    assert_eq!(causes, [(Some("payload"), 0.2), (Some("compliance"), 0.01)]);
}

#[test]
fn a_payload_that_later_studies_do_not_find_has_ended() {
    let studies = [("2026-03-01", true), ("2026-03-02", false)].map(|(day, has)| arm_study(day, "elbow", has));
    let found = report(&studies);
    let hand = found.joints.iter().find(|joint| joint.joint == "hand").unwrap();
    assert_eq!((hand.points.len(), hand.since, hand.is_off()), (2, None, false));
    assert_eq!((hand.latest.joint.as_deref(), hand.latest.study.as_str()), (Some("hand"), "2026-03-02/study.toml"));
    assert!(found.rows.iter().filter(|row| row.is_body).all(|row| row.since.is_none()));
    assert_eq!(found.rows.len(), 3);
}

#[test]
fn a_study_without_an_answer_is_a_row_and_texts_are_escaped() {
    let failed = FleetStudy { answer: Err("line 1: <oops>".to_owned()), ..study("2026-03-02", "none", 0.0) };
    let found = report(&[study("2026-03-01", "effect", 0.01), failed]);
    assert_eq!(found.rows[1].error.as_deref(), Some("line 1: <oops>"));
    assert_eq!(found.rows[1].joint, None);
    let page = fleet_html(&found).unwrap();
    assert!(page.contains("line 1: &lt;oops&gt;") && page.contains("knee: &lt;so&gt;.") && !page.contains("<oops>"));
    assert!(!page.contains("<script") && !page.contains("http"));
    let text = fleet_text(&found);
    assert!(text.contains("no answer: line 1") && text.contains("1 of 2 studies are answered"), "{text}");
    let document = fleet_json(&found).unwrap();
    assert_eq!(
        (document["failed"][0]["study"].as_str(), document["rows"][0]["since"].as_str()),
        (Some("2026-03-02/study.toml"), Some("2026-03-01"))
    );
}
