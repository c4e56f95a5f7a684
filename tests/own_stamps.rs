//! Setpoints that have stamps of their own act at these, in the program as a whole: a delay comes out as it is although the
//! joint is read far more rarely than it is asked.

mod support;

use std::fmt::Write as _;
use std::fs;
use support::*;

/// The example whose logs were made with a delay of 16 ms, read at every third sample only: 24 ms apart, while setpoints
/// come every 8 ms, each message in a row of its own.
#[test]
fn a_delay_is_found_where_setpoints_come_between_the_readings() {
    let dir = tempfile::tempdir().unwrap();
    let example = root().join("data/examples/delay");
    let study = fs::read_to_string(example.join("study.toml")).unwrap();
    let head = study.split("[[log]]").next().unwrap();
    let mut study = head.lines().filter(|line| !line.starts_with("period")).collect::<Vec<_>>().join("\n");
    for (k, role) in [(0, "fit"), (1, "fit"), (2, "fit"), (3, "validate")] {
        let log = aibo_fit::log::read_log(&example.join(format!("chirp-{k}.csv"))).unwrap();
        let mut text = "t,q,q_ref\n".to_owned();
        for (i, q_ref) in log.q_ref_rad.as_ref().unwrap().iter().enumerate() {
            writeln!(text, "{},,{q_ref}", log.t_s[i]).unwrap();
            if i % 3 == 0 {
                writeln!(text, "{},{},", log.t_s[i] + 0.004, q_between(&log, i)).unwrap();
            }
        }
        fs::write(dir.path().join(format!("chirp-{k}.csv")), text).unwrap();
        write!(study, "\n[[log]]\nfile = \"chirp-{k}.csv\"\nrole = \"{role}\"\ndrive = \"position\"\n").unwrap();
    }
    fs::write(dir.path().join("study.toml"), study).unwrap();
    let said = expect_code(dir.path(), &["gap", "study.toml", "--json", "gap.json"], 0);
    let found = json(&dir.path().join("gap.json"));
    assert_eq!(found["effect"], "delay", "{said}");
    let delay_s = found["effects"][0]["parameters"]["T"]["value"].as_f64().unwrap();
    // Setpoints moved to the readings would come late by half their distance on average, or early by as much.
    assert!((delay_s - 0.016).abs() < 0.003, "{delay_s} s\n{said}");
    assert!(said.contains("stamps of their own"), "{said}");
}

/// The angle half a sample after a reading.
fn q_between(log: &aibo_fit::log::Log, i: usize) -> f64 {
    match log.q_rad.get(i + 1) {
        Some(next) => 0.5 * (log.q_rad[i] + next),
        None => log.q_rad[i],
    }
}
