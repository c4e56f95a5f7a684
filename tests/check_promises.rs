//! What `aibo-fit check` promises, as the whole program: the health of any log, and of a study what its logs can tell.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use support::arm::{JOINTS, Truth};
use support::*;

fn checked(path: &str) -> (String, Value) {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("check.json");
    let said = expect_code(root(), &["check", path, "--json", &file.to_string_lossy()], 0);
    (said, json(&file))
}

#[test]
fn a_study_is_told_what_its_logs_cannot_determine_and_what_they_would_show() {
    let (said, json) = checked("data/examples/delay/study.toml");
    for part in ["chirp-0.csv", "period", "What these logs cannot determine", "weigh the link", "Smallest size"] {
        assert!(said.contains(part), "`{part}` is missing in\n{said}");
    }
    assert_eq!((&json["schema"], &json["health"][0]["samples"]), (&1.into(), &1250.into()));
    let sentences = json["undetermined"].as_array().unwrap();
    // Setpoints alone: a heavier link under a stronger drive moves the same.
    assert!(sentences.iter().any(|s| s.as_str().unwrap().contains("gain")), "{sentences:?}");
    // The logs were made with a delay of 16 ms, and the answer is a delay: they have to be able to show one.
    let shown = json["detectable"]["delay"]["value"].as_f64().unwrap();
    assert!(shown > 0.0 && shown < 0.016, "{shown} s");
    let gap = ["before", "calibrated", "floor"].map(|key| json["gap"][key].as_f64().unwrap());
    assert!(gap.is_sorted_by(|a, b| a > b), "{gap:?}");
    let (moved, unit) = (&json["beliefs"]["inertia"]["moved_sd"], &json["beliefs"]["inertia"]["unit"]);
    assert!(moved.is_number() && unit == "kg m^2");
}

#[test]
fn of_a_log_alone_the_health_is_told_and_that_a_study_is_needed_for_the_rest() {
    let (said, json) = checked("data/q1.csv");
    assert!(said.contains("data/q1.csv") && said.contains("give a study"), "{said}");
    assert!(!said.contains("Smallest size") && json.get("detectable").is_none());
    let step_rad = json["health"][0]["resolution_rad"].as_f64().unwrap();
    assert!((step_rad - 0.006).abs() < 1e-5, "{step_rad}");
}

#[test]
fn a_drive_at_its_limit_and_noise_that_hangs_together_are_told_on_one_page() {
    let dir = tempfile::tempdir().unwrap();
    // 20 s at 100 Hz: a sine that a stop cuts off and a drive cannot follow, then a rest; noise of a slow filter.
    let (mut noise, mut state) = (0.0, 7_u64);
    let mut text = "t,q,q_ref,tau\n".to_owned();
    for k in 0..2000 {
        let t = 0.01 * f64::from(k);
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        noise = 0.85 * noise + 4e-4 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        let asked = if t < 12.0 { 0.8 * (1.3 * t).sin() } else { 0.0 };
        let tau = (0.6 * (1.3 * t).cos()).clamp(-0.5, 0.5);
        text += &format!("{t:.2},{:.6},{asked:.6},{tau:.6}\n", asked.min(0.5) + noise);
    }
    fs::write(dir.path().join("limit.csv"), text).unwrap();
    let said = expect_code(dir.path(), &["check", "limit.csv", "--json", "check.json", "--out", "out"], 0);
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "the torque stands at its largest, 0.500 N m",
        "readings stand at 0.5",
        "the noise at rest hangs together over",
    ] {
        assert!(words.contains(part), "`{part}` is missing in\n{said}");
    }
    let health = &json(&dir.path().join("check.json"))["health"][0];
    let number = |key: &str| health[key].as_f64().unwrap_or_else(|| panic!("{key}: {health}"));
    assert!((number("torque_limit_nm") - 0.5).abs() < 1e-9 && (0.2..0.6).contains(&number("torque_limit_share")));
    assert!(number("stuck_s") > 2.0 && (number("travel_rad") - 1.3).abs() < 0.01, "{health}");
    // A filter that forgets 15 % a sample: correlated over some eleven samples.
    assert!((0.05..0.2).contains(&number("noise_lasts_s")), "{health}");
    let page = fs::read_to_string(dir.path().join("out/check.html")).unwrap();
    assert!(
        page.contains("Data health") && page.matches("<figure").count() == 2 && page.matches("<script").count() <= 1
    );
    let text = fs::read_to_string(dir.path().join("out/check.txt")).unwrap();
    assert!(said.starts_with(&text), "{text}");
}

#[test]
fn what_the_text_says_of_a_log_the_document_says_too() {
    let dir = tempfile::tempdir().unwrap();
    let rows = |of: &dyn Fn(f64) -> String| -> String {
        (0..400).map(|k| 0.01 * f64::from(k)).map(|t| format!("{t:.2},{}\n", of(t))).collect()
    };
    let moves = |t: f64| format!("{:.6}", 0.5 * (3.0 * t).sin());
    fs::write(dir.path().join("two.csv"), format!("t,a.q,b.q\n{}", rows(&|t| moves(t) + ",0.1"))).unwrap();
    let said = expect_code(dir.path(), &["check", "two.csv", "--json", "two.json"], 0);
    let two = json(&dir.path().join("two.json"));
    assert!(said.contains("== b ==\nIt never moved"), "{said}");
    assert_eq!((&two["still"], &two["notes"]), (&serde_json::json!(["b"]), &serde_json::json!([])));
    // A log of one joint without a name has its remarks, too.
    fs::write(dir.path().join("one.csv"), format!("t,q,lamp\n{}", rows(&|t| moves(t) + ",7"))).unwrap();
    let said = expect_code(dir.path(), &["check", "one.csv", "--json", "one.json"], 0);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let remarks = json(&dir.path().join("one.json"))["health"][0]["remarks"].to_string();
    assert!(said.contains("columns not used: lamp") && remarks.contains("columns not used: lamp"), "{said}\n{remarks}");
}

/// It went unread where a log has several joints, and one joint was refused for want of a drive that its health does not need.
#[test]
fn a_sidecar_that_tells_columns_alone_is_enough_for_the_health_of_a_log() {
    let dir = tempfile::tempdir().unwrap();
    let in_degrees = |name: &str| format!("\"{name}\" = {{ name = \"{name}\", unit = \"deg\" }}\n");
    let row = |k: u32| {
        let t = 0.01 * f64::from(k);
        format!("{t:.2},{:.5},{:.5}\n", 3.0 * (3.0 * t).sin(), 3.0 * (3.0 * t + 0.1).sin())
    };
    let rows: String = (0..400).map(row).collect();
    for (file, [first, second]) in [("one", ["q", "q_ref"]), ("two", ["a.q", "b.q"])] {
        let [log, sidecar, answer] = ["csv", "toml", "json"].map(|ending| format!("{file}.{ending}"));
        fs::write(dir.path().join(&log), format!("t,{first},{second}\n{rows}")).unwrap();
        let columns = in_degrees(first) + &in_degrees(second);
        fs::write(dir.path().join(&sidecar), format!("schema = 1\n[columns]\n{columns}")).unwrap();
        expect_code(dir.path(), &["check", &log, "--json", &answer], 0);
        let document = json(&dir.path().join(&answer));
        let of_joint = document["joints"].get("a").unwrap_or(&document);
        let travel_rad = of_joint["health"][0]["travel_rad"].as_f64().unwrap();
        assert!((travel_rad - 6f64.to_radians()).abs() < 1e-3, "{log}: {travel_rad} rad");
        // What was read is not written over.
        expect_code(dir.path(), &["check", &log, "--json", &sidecar], 2);
    }
}

/// Seconds that were said to be nanoseconds made a log of 4e-9 s, without a word; what is wrong with the log of several joints was
/// said to be that it has several.
#[test]
fn stamps_that_are_said_to_be_in_a_smaller_unit_are_refused_by_file_and_key() {
    let dir = tempfile::tempdir().unwrap();
    let row = |k: u32| {
        let t = 0.01 * f64::from(k);
        format!("{t:.2},{:.5},{:.5}\n", 0.5 * (3.0 * t).sin(), 0.4 * (3.0 * t + 0.1).sin())
    };
    let rows: String = (0..400).map(row).collect();
    for (file, header) in [("one", "t,q,dq"), ("two", "t,a.q,b.q")] {
        let log = format!("{file}.csv");
        fs::write(dir.path().join(&log), format!("{header}\n{rows}")).unwrap();
        for unit in ["ns", "us", "ms"] {
            let sidecar = format!("schema = 1\n[columns]\nt = {{ name = \"t\", unit = \"{unit}\" }}\n");
            fs::write(dir.path().join(format!("{file}.toml")), sidecar).unwrap();
            let said = refused(dir.path(), &log);
            for part in [log.as_str(), "column `t`", "`[columns] t.unit`", "t = { name = \"t\", unit = \"s\" }"] {
                assert!(said.contains(part), "`{part}` is missing in\n{said}");
            }
        }
    }
}

/// They were read, and nothing was said of them.
#[test]
fn tables_of_a_sidecar_that_are_not_used_and_mistakes_of_a_description_are_said() {
    let dir = tempfile::tempdir().unwrap();
    let rows: String =
        (0..200).map(|k| 0.01 * f64::from(k)).map(|t| format!("{t:.2},{0:.5},{0:.5}\n", t.sin())).collect();
    fs::write(dir.path().join("two.csv"), format!("t,a.q,b.q\n{rows}")).unwrap();
    fs::write(dir.path().join("two.toml"), "schema = 1\n[release]\ntime = 0.1\n").unwrap();
    let output = run_in(dir.path(), &["check", "two.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("two.toml: not used: [release]"), "{}", stderr(&output));
    assert_eq!(stderr(&run_in(dir.path(), &["check", "two.csv", "--quiet"])), "");

    changed(dir.path(), "arm", ["", ""], |line| format!("{line}\n").replace("ixx=\"0.006\"", "ixx=\"0.6\""));
    let output = run_in(dir.path(), &["check", "study.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = "warning: arm.urdf: link \"upper\": principal moments of inertia";
    assert!(stderr(&output).contains(said) && !stdout(&output).contains("warning"), "{}", stderr(&output));
    assert_eq!(stderr(&run_in(dir.path(), &["check", "study.toml", "--quiet"])), "");
}

/// An example's study in a folder, with other words in it and other readings.
fn changed(folder: &Path, example: &str, words: [&str; 2], reading: impl Fn(&str) -> String) {
    for entry in fs::read_dir(root().join("data/examples").join(example)).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        let text = match path.extension().is_some_and(|ending| ending == "toml") {
            true => text.replace(words[0], words[1]),
            false => text.lines().map(&reading).collect(),
        };
        fs::write(folder.join(path.file_name().unwrap()), text).unwrap();
    }
}

/// What a check questions, in its text and in its document.
fn questioned(folder: &Path) -> String {
    let said = expect_code(folder, &["check", "study.toml", "--json", "check.json"], 0);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let document = json(&folder.join("check.json"));
    let doubts = document["doubts"].as_array().unwrap().iter();
    let doubts: Vec<&str> = doubts.map(|doubt| doubt.as_str().unwrap()).collect();
    assert!(!said.contains("Nothing to remark") && doubts.iter().all(|doubt| said.contains(*doubt)), "{said}");
    doubts.join("\n")
}

/// A servo's firmware gain was once taken for N m/rad without a word, though refitted it is a fiftieth of it.
#[test]
fn a_firmware_gain_in_the_place_of_newton_metres_is_questioned() {
    let dir = tempfile::tempdir().unwrap();
    changed(dir.path(), "delay", ["kp = 8.0", "kp = 400.0"], |line| format!("{line}\n"));
    let doubts = questioned(dir.path());
    assert!(doubts.contains("in place of 400: is kp in N m/rad") && doubts.contains("servo.md"), "{doubts}");
}

/// The same of a joint that was simulated upside down, because its ticks count from the other side.
#[test]
fn a_zero_at_which_the_link_does_not_hang_is_questioned() {
    let dir = tempfile::tempdir().unwrap();
    let half_a_turn_on = |line: &str| match line.split_once(',') {
        Some((t, q)) => q.parse::<f64>().map_or(format!("{line}\n"), |q| format!("{t},{}\n", q + std::f64::consts::PI)),
        None => format!("{line}\n"),
    };
    changed(dir.path(), "ambiguous", ["rest = 0.0\n", ""], half_a_turn_on);
    let doubts = questioned(dir.path());
    assert!(doubts.contains("At rest = 3.14 rad") && doubts.contains("state `rest` in [joint]"), "{doubts}");
}

/// The motion of an arm under its torques was once simulated where no study asks for it, and was many turns off.
#[test]
fn a_study_that_predicts_torques_is_told_no_errors_of_a_motion() {
    let dir = tempfile::tempdir().unwrap();
    support::arm::study(dir.path(), &Truth { by_torque: true, period_s: 0.004, ..Truth::default() }, 3.0);
    let words = ["check", "study.toml", "--json", "check.json", "--out", "out"];
    let said = expect_code(dir.path(), &words, 0);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in ["This study predicts torques", "`gap` compares", "next: aibo-fit gap study.toml", "log0.csv"] {
        assert!(said.contains(part), "`{part}` is missing in\n{said}");
    }
    for part in ["as given", "calibrated", "Smallest size", "give a study", "they tell nothing of its numbers"] {
        assert!(!said.contains(part), "`{part}` is in\n{said}");
    }
    let document = json(&dir.path().join("check.json"));
    for joint in JOINTS {
        let own = &document["joints"][joint];
        assert!(own["health"].is_array() && own.get("gap").is_none() && own.get("detectable").is_none(), "{own}");
        assert!(own["doubts"].is_array(), "where nothing is questioned, too: {own}");
    }
    let page = fs::read_to_string(dir.path().join("out/check.html")).unwrap();
    assert!(page.contains("This study predicts torques") && !page.contains("they tell nothing of its numbers"));
}

#[test]
fn nothing_to_check_is_said_with_the_exit_codes_of_every_command() {
    let dir = tempfile::tempdir().unwrap();
    expect_code(dir.path(), &["check", "nowhere.toml"], 5);
    expect_code(dir.path(), &["check"], 2);
    let still: String = (0..200).map(|k| format!("{:.3},0.1\n", 0.008 * f64::from(k))).collect();
    fs::write(dir.path().join("still.csv"), format!("t,q\n{still}")).unwrap();
    assert!(expect_code(dir.path(), &["check", "still.csv"], 1).contains("nothing to check"));
    fs::write(dir.path().join("dog.toml"), "schema = 1\n[robot]\nmodel = \"ers7\"\n").unwrap();
    assert!(refused(dir.path(), "dog.toml").contains("`[robot] scenario` is missing"));
}

/// What is said of a study that cannot be read.
fn refused(folder: &Path, study: &str) -> String {
    let output = run_in(folder, &["check", study]);
    assert_eq!(output.status.code(), Some(3), "{}", stdout(&output));
    stderr(&output)
}

#[test]
fn what_is_wrong_with_the_study_of_a_robot_is_said_by_its_key() {
    let dir = tempfile::tempdir().unwrap();
    let study = |robot: &str| {
        let log = "[[log]]\nfile = \"log.csv\"\nrole = \"fit\"\n";
        fs::write(dir.path().join("log.csv"), "t,a.q\n0,0\n0.01,0\n").unwrap();
        fs::write(dir.path().join("arm.toml"), format!("schema = 1\n[robot]\n{robot}\n[joints.a]\nkp = 1.0\n{log}"))
            .unwrap();
        refused(dir.path(), "arm.toml")
    };
    let held = study("model = \"arm.urdf\"");
    assert!(held.contains("`[robot] scenario` is missing") && held.contains("\"fixed\""), "{held}");
    let nowhere = study("model = \"package://arm/arm.urdf\"\nscenario = \"fixed\"");
    for part in ["arm.toml", "`[robot] model`", "relative to the study", "package:// is not resolved"] {
        assert!(nowhere.contains(part), "`{part}` is missing in\n{nowhere}");
    }
}
