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
    assert!(doubts.contains("in place of 400: is kp in N m/rad?") && doubts.contains("servo.md"), "{doubts}");
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
    expect_code(dir.path(), &["check", "dog.toml"], 2);
}
