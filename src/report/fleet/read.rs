//! Rows of what `gap --json` says.

use super::FleetStudy;
use super::rows::{FleetRow, FleetSize};
use crate::report::gate::{cause, text_of};
use serde_json::Value;

/// The rows of a study.
pub(super) fn rows(study: &FleetStudy) -> Vec<FleetRow> {
    let of_study = of_study(study);
    let document = match &study.answer {
        Ok(document) => document,
        Err(why) => return vec![FleetRow { error: Some(why.clone()), ..of_study }],
    };
    let Some(joints) = document.get("joints").and_then(Value::as_object) else {
        return of_joint(study, &of_study, text_of(document, "name"), document);
    };
    let bodies = document.get("effects").and_then(Value::as_array).into_iter().flatten();
    let bodies = bodies.filter(|effect| effect.get("body").is_some());
    let bodies = bodies.map(|body| of_body(study, &of_study, body, document));
    bodies.chain(joints.iter().flat_map(|(joint, own)| of_joint(study, &of_study, joint, own))).collect()
}

fn of_study(study: &FleetStudy) -> FleetRow {
    FleetRow { study: study.study.clone(), robot: study.robot.clone(), ..FleetRow::default() }
}

fn of_joint(study: &FleetStudy, of_study: &FleetRow, joint: &str, document: &Value) -> Vec<FleetRow> {
    let judged = FleetRow { joint: Some(joint.to_owned()), size: size(document), ..judged(of_study, document) };
    let logs = document["gap"]["per_log"].as_array();
    let row = |log: &Value| {
        let file = text_of(log, "file");
        let (day, day_from) = study.days.get(file).copied().unzip();
        FleetRow {
            log: Some(file.to_owned()),
            day,
            day_from,
            gap_before: log["before"].as_f64(),
            gap_after: log["after"].as_f64(),
            ..judged.clone()
        }
    };
    logs.into_iter().flatten().map(row).collect()
}

/// A payload, or a mass that is another, is no joint's.
fn of_body(study: &FleetStudy, of_study: &FleetRow, body: &Value, document: &Value) -> FleetRow {
    FleetRow {
        joint: body["body"].as_str().map(str::to_owned),
        cause: body["id"].as_str().map(str::to_owned),
        size: size_of(body, None),
        ..of_bodies(study, of_study, document)
    }
}

/// What a study of a robot says of each body that it does not name: it is as modelled. `None` for a study of one joint.
pub(super) fn of_other_bodies(study: &FleetStudy) -> Option<FleetRow> {
    let document = study.answer.as_ref().ok().filter(|document| document["joints"].is_object())?;
    let none = || Some("none".to_owned());
    let as_modelled = FleetRow {
        verdict: none(),
        cause: none(),
        probability: None,
        sentence: None,
        ..of_bodies(study, &of_study(study), document)
    };
    Some(as_modelled)
}

/// What is said of all bodies of a robot.
fn of_bodies(study: &FleetStudy, of_study: &FleetRow, document: &Value) -> FleetRow {
    let (day, day_from) = study.days.values().max_by_key(|(day, _)| *day).copied().unzip();
    FleetRow {
        is_body: true,
        day,
        day_from,
        gap_before: document["gap"]["before"].as_f64(),
        gap_after: document["gap"]["after"].as_f64(),
        ..judged(of_study, document)
    }
}

/// What is said of a joint in all its logs.
fn judged(of_study: &FleetRow, document: &Value) -> FleetRow {
    let text = |key: &str| document[key].as_str().map(str::to_owned);
    FleetRow {
        unit: document["gap"]["unit"].as_str().map(str::to_owned),
        verdict: text("verdict"),
        cause: Some(cause(document)),
        probability: document["probability"].as_f64(),
        sentence: text("sentence"),
        ..of_study.clone()
    }
}

/// The size of the first cause, or the number that is off most.
fn size(document: &Value) -> Option<FleetSize> {
    match document["verdict"].as_str()? {
        "effect" => {
            let first = &document["effects"][0];
            let id = first["id"].as_str()?;
            size_of(first, document["detectable"][id]["parameter"].as_str())
        }
        "calibration" => {
            let name = document["effect"].as_str()?;
            let belief = &document["beliefs"][name];
            Some(FleetSize {
                parameter: name.to_owned(),
                value: belief["found"].as_f64()?,
                interval: interval(&document["joint"][name]),
                unit: text_of(belief, "unit").to_owned(),
            })
        }
        _ => None,
    }
}

/// The parameter that is the effect's size, or its first.
fn size_of(effect: &Value, main: Option<&str>) -> Option<FleetSize> {
    let parameters = effect["parameters"].as_object()?;
    let named = main.and_then(|main| parameters.get_key_value(main));
    let (parameter, quantity) = named.or_else(|| parameters.iter().next())?;
    Some(FleetSize {
        parameter: parameter.clone(),
        value: quantity["value"].as_f64()?,
        interval: interval(quantity),
        unit: text_of(quantity, "unit").to_owned(),
    })
}

fn interval(quantity: &Value) -> Option<[f64; 2]> {
    Some([quantity["interval"][0].as_f64()?, quantity["interval"][1].as_f64()?])
}
