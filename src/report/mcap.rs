//! What was measured, what the model predicts and what is left between them, as topics for a viewer.

use crate::gap::LogTraces;
use crate::log::McapTopic;
use std::path::Path;

/// Topics of each log: `/<log>/measured`, `/setpoint`, `/nominal` (the study's numbers as given), `/predicted` (with what
/// was found) and `/residual` (measured less predicted), joints that were compared at the same times in one message.
pub fn trace_topics(joints: &[(&str, &[LogTraces])]) -> Vec<McapTopic> {
    let mut topics: Vec<McapTopic> = Vec::new();
    for (joint, traces) in joints {
        for log in *traces {
            let stem = name_of(&log.file);
            let residual =
                log.measured_rad.iter().zip(&log.after_rad).map(|(measured, after)| measured - after).collect();
            let kinds = [
                ("measured", Some(log.measured_rad.clone())),
                ("setpoint", log.setpoint_rad.clone()),
                ("nominal", Some(log.before_rad.clone())),
                ("predicted", Some(log.after_rad.clone())),
                ("residual", Some(residual)),
            ];
            for (kind, values) in kinds.into_iter().filter_map(|(kind, values)| Some((kind, values?))) {
                let name = format!("/{stem}/{kind}");
                let is_same = |topic: &&mut McapTopic| {
                    topic.name == name && topic.t_s == log.t_s && !topic.joints.iter().any(|other| other == joint)
                };
                match topics.iter_mut().find(is_same) {
                    Some(topic) => {
                        topic.joints.push((*joint).to_owned());
                        topic.position_rad.push(values);
                    }
                    None => topics.push(McapTopic {
                        name,
                        joints: vec![(*joint).to_owned()],
                        t_s: log.t_s.clone(),
                        position_rad: vec![values],
                        ..McapTopic::default()
                    }),
                }
            }
        }
    }
    topics
}

/// A log's name as part of a topic: without ending, and of letters, digits and `_`.
fn name_of(file: &str) -> String {
    let path = Path::new(file);
    let stem = path.file_stem().map_or_else(|| file.to_owned(), |stem| stem.to_string_lossy().into_owned());
    let part = if file.contains(" (part ") {
        file.rsplit(" (part ").next().map(|n| format!("_part{}", n.trim_end_matches(')')))
    } else {
        None
    };
    let stem = stem + &part.unwrap_or_default();
    stem.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::ResidualTorque;

    #[test]
    fn joints_of_one_log_share_messages_and_the_residual_is_what_is_left() {
        let traces = |t_s: Vec<f64>| LogTraces {
            file: "logs/step 1.csv".into(),
            role: "fit".into(),
            measured_rad: vec![1.0; t_s.len()],
            setpoint_rad: None,
            before_rad: vec![0.5; t_s.len()],
            calibrated_rad: vec![0.5; t_s.len()],
            after_rad: vec![0.75; t_s.len()],
            residual_torque: ResidualTorque::default(),
            t_s,
        };
        let (a, b, c) = ([traces(vec![0.0, 0.1])], [traces(vec![0.0, 0.1])], [traces(vec![0.0, 0.2])]);
        let topics = trace_topics(&[("a", &a), ("b", &b), ("c", &c)]);
        let residual: Vec<&McapTopic> = topics.iter().filter(|topic| topic.name == "/step_1/residual").collect();
        assert_eq!((residual.len(), &residual[0].joints[..]), (2, &["a".to_owned(), "b".to_owned()][..]));
        assert_eq!(residual[1].position_rad, [[0.25, 0.25]]);
    }
}
