//! What was measured, what the model predicts and what is left between them, as topics for a viewer.

use crate::gap::LogTraces;
use crate::log::McapTopic;
use crate::report::plot::bare;
use std::collections::BTreeMap;

/// Topics of each log: `/<log>/measured`, `/setpoint`, `/nominal` (the study's numbers as given), `/predicted` (with what
/// was found) and `/residual` (measured less predicted), joints that were compared at the same times in one message.
///
/// Logs of the same name in different folders are `<log>` and `<log>_2`.
pub fn trace_topics(joints: &[(&str, &[LogTraces])]) -> Vec<McapTopic> {
    let mut topics: Vec<McapTopic> = Vec::new();
    let names = names(joints.iter().flat_map(|(_, traces)| traces.iter()).map(|log| log.file.as_str()));
    for (joint, traces) in joints {
        for log in *traces {
            let own = &names[log.file.as_str()];
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
                let name = format!("/{own}/{kind}");
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

/// The part of a topic for each file, with a number where another file has that name already.
fn names<'a>(files: impl Iterator<Item = &'a str>) -> BTreeMap<&'a str, String> {
    let mut names: BTreeMap<&str, String> = BTreeMap::new();
    for file in files {
        if names.contains_key(file) {
            continue;
        }
        let plain = name_of(file);
        let mut own = plain.clone();
        let mut count = 1;
        while names.values().any(|other| *other == own) {
            count += 1;
            own = format!("{plain}_{count}");
        }
        names.insert(file, own);
    }
    names
}

/// A log's name as part of a topic: of letters, digits and `_`.
fn name_of(log: &str) -> String {
    bare(log).chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::ResidualTorque;

    fn traces_of(file: &str, t_s: Vec<f64>) -> LogTraces {
        LogTraces {
            file: file.into(),
            role: "fit".into(),
            measured_rad: vec![1.0; t_s.len()],
            setpoint_rad: None,
            before_rad: vec![0.5; t_s.len()],
            calibrated_rad: vec![0.5; t_s.len()],
            after_rad: vec![0.75; t_s.len()],
            residual_torque: ResidualTorque::default(),
            t_s,
        }
    }

    #[test]
    fn logs_of_one_name_have_topics_of_their_own() {
        let files = ["1/log.csv", "2/log.csv", "1/log_2.csv", "1/log.csv (part 2)", "1/log.csv (6.5 to 9 s)"];
        let logs = files.map(|file| traces_of(file, vec![0.0, 0.1]));
        let measured = |joints: &[(&str, &[LogTraces])]| -> Vec<(String, usize)> {
            let topics = trace_topics(joints).into_iter().filter(|topic| topic.name.ends_with("/measured"));
            topics.map(|topic| (topic.name, topic.joints.len())).collect()
        };
        let names = [
            "/log/measured",
            "/log_2/measured",
            "/log_2_2/measured",
            "/log_part_2/measured",
            "/log_6_5_to_9_s/measured",
        ];
        assert_eq!(measured(&[("a", &logs), ("b", &logs)]), names.map(|name| (name.to_owned(), 2)));
        // Joints that are each in one of two logs do not meet in one message.
        assert_eq!(measured(&[("a", &logs[..1]), ("b", &logs[1..2])]).len(), 2);
    }

    #[test]
    fn joints_of_one_log_share_messages_and_the_residual_is_what_is_left() {
        let traces = |t_s: Vec<f64>| traces_of("logs/step 1.csv", t_s);
        let (a, b, c) = ([traces(vec![0.0, 0.1])], [traces(vec![0.0, 0.1])], [traces(vec![0.0, 0.2])]);
        let topics = trace_topics(&[("a", &a), ("b", &b), ("c", &c)]);
        let residual: Vec<&McapTopic> = topics.iter().filter(|topic| topic.name == "/step_1/residual").collect();
        assert_eq!((residual.len(), &residual[0].joints[..]), (2, &["a".to_owned(), "b".to_owned()][..]));
        assert_eq!(residual[1].position_rad, [[0.25, 0.25]]);
    }
}
