//! `aibo-fit init`, `gap`, `check` and `convert` on logs as people have them, as the whole program: from a bag, a CSV of
//! PlotJuggler or a LeRobot folder to a verdict in two commands, without an edit beyond the physical numbers.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use support::*;

/// The arm of the logs, under the names that they have.
fn arm(folder: &Path) {
    let urdf = fs::read_to_string(root().join("data/examples/arm/arm.urdf")).unwrap();
    fs::write(folder.join("arm.urdf"), urdf.replace("arm/", "")).unwrap();
}

fn log(name: &str) -> String {
    root().join("tests/logs").join(name).display().to_string()
}

/// Fills in what `init` leaves open.
fn fill_in(study: &Path, numbers: &[(&str, f64)]) {
    let mut text = fs::read_to_string(study).unwrap();
    for (key, value) in numbers {
        let open = format!("# {key} = 0.0 ");
        assert!(text.contains(&open), "no `{open}` in\n{text}");
        text = text.replacen(&open, &format!("{key} = {value} "), 1);
    }
    fs::write(study, text).unwrap();
}

#[test]
fn a_bag_comes_to_a_verdict_in_two_commands() {
    let dir = tempfile::tempdir().unwrap();
    arm(dir.path());
    let said = expect_code(dir.path(), &["init", &log("arm.mcap"), "--robot", "arm.urdf", "--study", "study.toml"], 0);
    assert!(said.contains("What the logs do not tell") && said.contains("kp"), "{said}");
    fill_in(&dir.path().join("study.toml"), &[("kp", 25.0), ("kd", 0.5)]);
    let said = expect_code(dir.path(), &["gap", "study.toml", "--json", "gap.json", "--mcap", "gap.mcap"], 0);
    let verdict = json(&dir.path().join("gap.json"));
    assert!(verdict["verdict"].is_string() && said.contains("elbow"), "{said}");
    // What was measured, what is predicted and what is left, of every joint, for a viewer.
    expect_code(dir.path(), &["convert", "gap.mcap", "back.csv"], 0);
    let bytes = fs::read(dir.path().join("gap.mcap")).unwrap();
    for topic in ["/arm/measured", "/arm/predicted", "/arm/residual", "/arm/setpoint"] {
        assert!(bytes.windows(topic.len()).any(|part| part == topic.as_bytes()), "no {topic}");
    }
}

#[test]
fn a_study_that_was_filled_in_is_not_written_over_by_the_log_that_it_came_of() {
    let dir = tempfile::tempdir().unwrap();
    arm(dir.path());
    let bag = log("arm.mcap");
    let check = || run_in(dir.path(), &["check", &bag, "--robot", "arm.urdf", "--out", "out"]);
    let (first, study) = (check(), dir.path().join("out/study.toml"));
    let draft = fs::read_to_string(&study).unwrap();
    assert_eq!((check().status.code(), fs::read_to_string(&study).unwrap()), (first.status.code(), draft));
    fill_in(&study, &[("kp", 25.0), ("kd", 0.5)]);
    let filled = fs::read_to_string(&study).unwrap();
    let again = check();
    let said = stderr(&again);
    assert_eq!((again.status.code(), fs::read_to_string(&study).unwrap()), (Some(2), filled), "{said}");
    assert!(said.contains("aibo-fit gap out/study.toml") && said.contains("--out"), "{said}");
}

#[test]
fn joints_under_a_users_own_names_in_degrees_come_to_a_check() {
    let dir = tempfile::tempdir().unwrap();
    arm(dir.path());
    let text = fs::read_to_string(root().join("data/examples/arm/log0.csv")).unwrap();
    let in_degrees = |row: &str| {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let angles: String = cells[1..].iter().map(|angle| format!(",{:.4}", angle.to_degrees())).collect();
        format!("{:.4}{angles}\n", cells[0])
    };
    let (header, rows) = text.split_once('\n').unwrap();
    let header = header.replace("arm/shoulder", "A1").replace("arm/elbow", "A2");
    let rows: String = rows.lines().map(in_degrees).collect();
    fs::write(dir.path().join("own.csv"), format!("{header}\n{rows}")).unwrap();
    let said = expect_code(dir.path(), &["init", "own.csv", "--robot", "arm.urdf"], 0);
    assert!(said.contains("A1 is shoulder, A2 is elbow") && said.contains("fill in kp, kd, armature in"), "{said}");
    fill_in(&dir.path().join("study.toml"), &[("kp", 25.0), ("kd", 0.5)]);
    let said = expect_code(dir.path(), &["check", "study.toml"], 0);
    assert!(said.contains("shoulder") && said.contains("elbow"), "{said}");
}

#[test]
fn a_sidecar_tells_init_and_convert_what_the_columns_are() {
    let dir = tempfile::tempdir().unwrap();
    let row = |k: u32| {
        let t = 0.01 * f64::from(k);
        format!("{t:.2},{:.3},{:.3}\n", 30.0 * (5.0 * t - 0.1).sin(), 30.0 * (5.0 * t).sin())
    };
    let rows: String = (0..200).map(row).collect();
    fs::write(dir.path().join("raw.csv"), format!("zeit,winkel,soll\n{rows}")).unwrap();
    let untold = run_in(dir.path(), &["init", "raw.csv"]);
    assert!(stderr(&untold).contains("in NAME.toml beside the log"), "{}", stderr(&untold));
    let sidecar = "schema = 1\n[columns]\nt = { name = \"zeit\" }\nq = { name = \"winkel\", unit = \"deg\" }\n\
                   q_ref = { name = \"soll\", unit = \"deg\" }\n";
    fs::write(dir.path().join("raw.toml"), sidecar).unwrap();
    expect_code(dir.path(), &["init", "raw.csv"], 0);
    let study = fs::read_to_string(dir.path().join("study.toml")).unwrap();
    assert!(study.contains("q = { name = \"winkel\", unit = \"deg\" }"), "{study}");
    expect_code(dir.path(), &["convert", "raw.csv", "log.csv"], 0);
    let log = aibo_fit::log::read_log(&dir.path().join("log.csv")).unwrap();
    assert!(log.q_rad.iter().all(|q| q.abs() < 0.53) && log.q_ref_rad.is_some());
    // What tells the columns is not written over.
    let refused = stderr(&run_in(dir.path(), &["init", "raw.csv", "--study", "raw.toml", "--force"]));
    assert!(refused.contains("raw.toml") && refused.contains("--study") && !refused.contains("--out"), "{refused}");
    assert_eq!(fs::read_to_string(dir.path().join("raw.toml")).unwrap(), sidecar);
}

/// All but its columns was passed over without a word, and so was a key that no sidecar has.
#[test]
fn what_a_sidecar_has_beside_columns_is_said_and_a_key_that_is_none_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let row = |k: u32| format!("{:.2},{:.3}\n", 0.01 * f64::from(k), 0.5 * (0.05 * f64::from(k)).sin());
    fs::write(dir.path().join("raw.csv"), format!("t,q\n{}", (0..200).map(row).collect::<String>())).unwrap();
    let sidecar = |table: &str| fs::write(dir.path().join("raw.toml"), format!("schema = 1\n{table}")).unwrap();
    sidecar("[release]\ntime = 0.1\n[columns]\nq = { name = \"q\", sign = -1 }\n");
    let output = run_in(dir.path(), &["init", "raw.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = stderr(&output);
    assert!(said.contains("warning: raw.toml: not used: [release]") && said.contains("only [columns]"), "{said}");
    assert_eq!(stderr(&run_in(dir.path(), &["init", "raw.csv", "--force", "--quiet"])), "");
    sidecar("[relase]\ntime = 0.1\n");
    for words in [&["init", "raw.csv", "--force"][..], &["convert", "raw.csv", "log.csv"], &["check", "raw.csv"]] {
        let output = run_in(dir.path(), words);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{words:?}: {said}");
        assert!(said.contains("raw.toml") && said.contains("relase") && said.contains("line 2"), "{words:?}: {said}");
    }
}

/// A study with its log's name was once read as the log's sidecar: it could not be written anew, and guesses were told as known.
#[test]
fn a_study_that_has_the_name_of_its_log_is_no_sidecar_until_somebody_changes_its_columns() {
    let dir = tempfile::tempdir().unwrap();
    let row = |k: u32| {
        let t = 0.01 * f64::from(k);
        format!("{t:.2},{:.3},{:.3}\n", 30.0 * (5.0 * t - 0.1).sin(), 30.0 * (5.0 * t).sin())
    };
    fs::write(dir.path().join("swing.csv"), format!("time,angle,goal\n{}", (0..200).map(row).collect::<String>()))
        .unwrap();
    let init = |study: &str| {
        let output = run_in(dir.path(), &["init", "swing.csv", "--study", study, "--force"]);
        let text = fs::read_to_string(dir.path().join(study)).unwrap();
        (output.status.code(), stderr(&output), text)
    };
    for study in ["swing.toml", "swing.toml", "other.toml"] {
        let (code, said, text) = init(study);
        assert_eq!(code, Some(0), "{said}");
        assert!(text.contains("# guess: by the columns' names") && !text.contains("sidecar says"), "{text}");
    }
    let (_, _, text) = init("swing.toml");
    let turned =
        text.replace("q = { name = \"angle\", unit = \"deg\" }", "q = { name = \"angle\", unit = \"deg\", sign = -1 }");
    fs::write(dir.path().join("swing.toml"), &turned).unwrap();
    let (code, said, text) = init("other.toml");
    assert_eq!(code, Some(0), "{said}");
    assert!(text.contains("as the log's sidecar says") && text.contains("unit = \"deg\", sign = -1 }"), "{text}");
    let (code, said, text) = init("swing.toml");
    assert_eq!((code, &text), (Some(2), &turned), "{said}");
}

#[test]
fn a_csv_of_plotjuggler_comes_to_a_verdict_in_two_commands() {
    let dir = tempfile::tempdir().unwrap();
    expect_code(dir.path(), &["init", &log("plotjuggler.csv"), "--joint", "elbow", "--study", "study.toml"], 0);
    let numbers =
        [("inertia", 0.0102), ("moment", 0.06), ("coulomb", 0.04), ("viscous", 0.05), ("kp", 12.0), ("kd", 0.2)];
    fill_in(&dir.path().join("study.toml"), &numbers);
    expect_code(dir.path(), &["gap", "study.toml", "--json", "gap.json"], 0);
    assert!(json(&dir.path().join("gap.json"))["verdict"].is_string());
}

#[test]
fn a_lerobot_folder_comes_to_a_verdict_in_two_commands() {
    let dir = tempfile::tempdir().unwrap();
    expect_code(dir.path(), &["init", &log("lerobot-v3"), "--joint", "elbow", "--study", "study.toml"], 0);
    let numbers =
        [("inertia", 0.0102), ("moment", 0.06), ("coulomb", 0.04), ("viscous", 0.05), ("kp", 12.0), ("kd", 0.2)];
    fill_in(&dir.path().join("study.toml"), &numbers);
    let said = expect_code(dir.path(), &["gap", "study.toml", "--json", "gap.json"], 0);
    assert!(json(&dir.path().join("gap.json"))["verdict"].is_string());
    assert!(said.contains("part") || said.contains("hole"), "two episodes are two parts:\n{said}");
}

#[test]
fn init_refuses_to_write_over_a_study_and_names_what_it_cannot_find() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("study.toml"), "mine").unwrap();
    expect_code(dir.path(), &["init", &log("echo.csv"), "--study", "study.toml"], 2);
    assert_eq!(fs::read_to_string(dir.path().join("study.toml")).unwrap(), "mine");
    expect_code(dir.path(), &["init", &log("echo.csv"), "--study", "study.toml", "--force"], 0);
    let output = run_in(dir.path(), &["init", &log("echo.csv"), "--joint", "knee", "--study", "x.toml"]);
    assert!(stderr(&output).contains("no joint `knee`; the log has shoulder, elbow"), "{}", stderr(&output));
    assert!(!dir.path().join("x.toml").exists());
}

#[test]
fn check_tells_the_health_of_every_joint_of_any_log() {
    let dir = tempfile::tempdir().unwrap();
    let said = expect_code(dir.path(), &["check", &log("bag"), "--json", "check.json"], 0);
    for part in ["== shoulder ==", "== elbow ==", "rosbag2", "taken at its receipt"] {
        assert!(said.contains(part), "`{part}` is missing in\n{said}");
    }
    let found: Value = json(&dir.path().join("check.json"));
    assert_eq!(found["joints"]["elbow"]["health"][0]["samples"], 60);
    let period_s = found["joints"]["elbow"]["health"][0]["period_s"].as_f64().unwrap();
    assert!((period_s - 0.02).abs() < 1e-9, "{period_s}");
}

#[test]
fn what_convert_writes_is_what_was_read() {
    let dir = tempfile::tempdir().unwrap();
    for (from, to) in [("arm-json.mcap", "a.csv"), ("arm.npz", "b.mcap"), ("bag", "c.csv")] {
        expect_code(dir.path(), &["convert", &log(from), to], 0);
        let read = |path: &Path| aibo_fit::log::read_source(path, &Default::default()).unwrap();
        let (first, second) = (read(Path::new(&log(from))), read(&dir.path().join(to)));
        for name in ["shoulder.q", "elbow.q", "elbow.q_ref"] {
            let (before, after) = (first.ours(name).unwrap(), second.ours(name).unwrap());
            assert_eq!(before.values, after.values, "{from} {name}");
            let shift =
                |source: &aibo_fit::log::Source, c: &aibo_fit::log::Channel| source.t_s(c)[1] - source.clocks[0][0];
            assert!((shift(&first, before) - shift(&second, after)).abs() < 1e-8, "{from} {name}");
        }
    }
    expect_code(dir.path(), &["convert", &log("bag"), "bag.txt"], 2);
}

#[test]
fn a_sage_folder_and_a_robot_are_enough_for_a_verdict() {
    let (Some(take), Some(robot)) =
        (shared("real/so101/raw/single_joint_elbow"), shared("robots/so101/so101_new_calib.xml"))
    else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let [take, robot] = [take, robot].map(|path| path.display().to_string());
    let said = expect_code(dir.path(), &["gap", &take, "--robot", &robot, "--out", "out", "--json", "gap.json"], 0);
    assert!(json(&dir.path().join("gap.json"))["verdict"].is_string(), "{said}");
    assert!(said.contains("by their order") && said.contains("Rotation is shoulder_pan"), "{said}");
}
