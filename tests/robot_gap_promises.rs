//! What `aibo-fit gap` promises on the study of a whole robot: an answer with every key, the same bytes on any number of
//! threads, a repaired robot with which the gap is closed, and one clear error for a wrong study.

mod support;

use aibo_fit::gap::robot::Cause;
use aibo_fit::log::{RobotLog, read_robot_log};
use serde_json::Value;
use std::fs;
use std::path::Path;
use support::{everything_in, expect_code, json, make_study, run_in, stderr};

/// A walk in the air whose rear knees are weak; a short one, for the tests.
const WEAK: &str = r#"
schema = 1
seed = 11
[robot]
model = "ers7"
scenario = "air"
[sensor]
period = 0.016
noise = 0.001
[truth]
step = 1e-3
[[effect]]
id = "torque_limit"
joints = ["lr3", "rr3"]
tau_max = 0.03
[[log]]
file = "trot.csv"
duration = 5.0
"#;

/// A leg whose friction is three times the believed one, let go twice.
const STIFF: &str = r#"
schema = 1
seed = 5
[robot]
model = "ers7"
scenario = "drop"
[friction]
coulomb = [0.001, 0.007, 0.01]
viscous = [0.017, 0.019, 0.01]
[sensor]
resolution = 0.006
period = 0.008
[truth]
step = 1e-4
scatter = 0.03
[truth.friction.lf1]
coulomb = 0.003
viscous = 0.051
[[log]]
file = "far.csv"
duration = 4.0
released = "lf1"
release_time = 0.4
angles = { lf1 = 1.2 }
[[log]]
file = "near.csv"
duration = 4.0
released = "lf1"
release_time = 0.4
angles = { lf1 = 0.84 }
"#;

/// A trot on a slippery floor.
const SLIPPERY: &str = r#"
schema = 1
seed = 7
[robot]
model = "ers7"
scenario = "floor"
[sensor]
resolution = 0.006
period = 0.008
noise = 0.002
[truth]
step = 1e-4
scatter = 0.03
floor = { static = 0.2, coulomb = 0.15 }
[[log]]
file = "trot.csv"
duration = 6.0
forward = [2.0, 6.0]
"#;

/// Causes that stand for all, so that the tests are quick.
const ONLY: &str = "torque_limit,motor_gain,viscous";

fn diagnosed(folder: &Path, out: &str, words: &[&str]) -> Value {
    let all = ["gap", "study.toml", "--only", ONLY, "--out", out, "--json", "gap.json", "--quiet"];
    expect_code(folder, &all.iter().chain(words).copied().collect::<Vec<_>>(), 0);
    json(&folder.join("gap.json"))
}

#[test]
fn an_answer_has_every_key_is_the_same_on_any_number_of_threads_and_its_robot_closes_the_gap() {
    let dir = tempfile::tempdir().unwrap();
    make_study(dir.path(), WEAK);
    let with = |threads: &str| {
        let found = diagnosed(dir.path(), "out", &["--threads", threads]);
        let out = dir.path().join("out");
        let files: Vec<_> =
            everything_in(&out).into_iter().map(|file| (file.clone(), fs::read(file).unwrap())).collect();
        (found, files)
    };
    let ((mut one, one_files), (mut two, two_files)) = (with("1"), with("2"));

    // The contract of the specification's section 6, and what goes beyond it.
    let keys = |of: &Value, keys: &str| {
        for key in keys.split(' ') {
            assert!(of.get(key).is_some(), "`{key}` is missing");
        }
    };
    keys(&one, "schema verdict effect second equivalent probability sentence where gap ranking detectable joint next");
    keys(&one, "places second_joints changes notes inputs version command");
    keys(&one["where"], "joints stage variable range phase logs share cells");
    keys(
        &one["gap"],
        "unit before calibrated after_first after floor closed closed_interval per_log per_joint displacement",
    );
    keys(&one["gap"]["per_log"][0], "file before calibrated after floor");
    keys(&one["ranking"][0], "effect joints probability after closed parameters");
    keys(&one["ranking"][0]["parameters"]["tau_max"], "value unit interval");
    for key in ["inertia", "moment", "coulomb", "viscous"] {
        assert!(one["joint"][key].is_object() && one["joint"][key]["value"].is_null(), "`joint.{key}`");
    }
    assert_eq!(one["detectable"].as_object().unwrap().len(), ONLY.split(',').count());
    assert_eq!((&one["verdict"], &one["effect"]), (&"effect".into(), &"torque_limit".into()));
    assert_eq!(one["where"]["joints"], serde_json::json!(["lr3", "rr3"]));
    assert_eq!(one["where"]["cells"].as_array().unwrap().len() % 12, 0);

    // What the answer leaves is one number, wherever it is told, and probabilities are those of one whole.
    assert!(one["second"].is_null(), "{}", one["second"]);
    let ranking = one["ranking"].as_array().unwrap();
    let of_answer = |row: &&Value| row["effect"] == one["effect"] && row["joints"] == one["where"]["joints"];
    assert_eq!(ranking.iter().find(of_answer).unwrap()["after"], one["gap"]["after"]);
    let shared_out: f64 = ranking.iter().map(|row| row["probability"].as_f64().unwrap()).sum();
    assert!((shared_out - one["probability"].as_f64().unwrap()).abs() < 1e-9, "{shared_out}");

    // The command line, with its number of threads, is part of the provenance.
    for found in [&mut one, &mut two] {
        found["command"].take();
    }
    assert_eq!(one, two);
    assert_eq!(one_files.len(), two_files.len());
    for ((name, a), (_, b)) in one_files.iter().zip(&two_files) {
        // The list of files has a digest of the page.
        let quotes_the_command = name.ends_with("report.html") || name.ends_with(".aibo-fit.toml");
        assert!(a == b || quotes_the_command, "{}", name.display());
    }

    // A walk with the robot's file goes as the log; a walk without it does not.
    let follows = |robot: &[&str], out: &str| {
        let words = ["walk", "--air", "--duration", "5", "--quiet", "--out", out];
        expect_code(dir.path(), &words.iter().chain(robot).copied().collect::<Vec<_>>(), 0);
        rms_rad(&logged(&dir.path().join("trot.csv")), &logged(&dir.path().join(out).join("log.csv")), "rr3")
    };
    let nominal = follows(&[], "nominal");
    let repaired = follows(&["--robot", "out/repaired.toml"], "repaired");
    assert!(nominal > 0.02 && repaired < 0.1 * nominal, "{nominal} and {repaired} rad");

    // A study of the repaired robot has no gap left.
    let study = fs::read_to_string(dir.path().join("study.toml")).unwrap();
    assert!(study.contains("model = \"ers7\""), "{study}");
    fs::write(dir.path().join("study.toml"), study.replace("\"ers7\"", "\"out/repaired.toml\"")).unwrap();
    let closed = diagnosed(dir.path(), "closed", &[]);
    assert_eq!(closed["verdict"], "none", "{}", closed["sentence"]);
}

#[test]
fn friction_three_times_the_believed_one_is_never_nothing() {
    let dir = tempfile::tempdir().unwrap();
    make_study(dir.path(), STIFF);
    let only = "load_friction,asymmetric_friction,coulomb,viscous";
    expect_code(dir.path(), &["gap", "study.toml", "--only", only, "--json", "gap.json", "--quiet"], 0);
    let found = json(&dir.path().join("gap.json"));
    assert_eq!((&found["verdict"], &found["where"]["joints"][0]), (&"calibration".into(), &"lf1".into()), "{found:#}");
    for (number, tripled) in [("lf1.coulomb", 0.003), ("lf1.viscous", 0.051)] {
        let belief = &found["beliefs"][number];
        assert!(belief["moved_sd"].as_f64().unwrap() > 1.5, "{belief}");
        let off = belief["found"].as_f64().unwrap() / tripled;
        assert!((0.8..1.2).contains(&off), "{number} is {off} of the truth");
    }
    let gap = |key: &str| found["gap"][key].as_f64().unwrap();
    assert!(gap("before") > 0.1 && gap("after") < 1.2 * gap("floor"), "{}", found["gap"]);
    // Nothing but noise is left, whatever the numbers are believed to.
    assert!(found["sentence"].as_str().unwrap().contains("numbers of the study are off"), "{}", found["sentence"]);
}

#[test]
fn a_slippery_floor_is_the_floors() {
    let dir = tempfile::tempdir().unwrap();
    make_study(dir.path(), SLIPPERY);
    let only = "floor_friction,floor_slope,payload";
    expect_code(dir.path(), &["gap", "study.toml", "--only", only, "--json", "gap.json", "--quiet"], 0);
    let found = json(&dir.path().join("gap.json"));
    assert_eq!((&found["verdict"], &found["effect"]), (&"effect".into(), &"floor_friction".into()), "{found:#}");
    let mu = &found["effects"][0]["parameters"]["mu"];
    assert!((mu["value"].as_f64().unwrap() - 0.15).abs() < 0.05, "{mu}");
    assert_eq!(found["where"]["stage"], "floor");
}

/// Knees whose motors are weak, which a trot shows and a crawl hardly does.
const WEAK_AT_SPEED: &str = r#"
schema = 1
[robot]
model = "ers7"
scenario = "air"
[sensor]
resolution = 0.006
period = 0.008
noise = 0.001
[[effect]]
id = "torque_limit"
joints = ["lf3", "rf3", "lr3", "rr3"]
tau_max = 0.05
[[log]]
file = "trot.csv"
gait = "trot-2hz"
duration = 4
[[log]]
file = "crawl.csv"
gait = "crawl"
duration = 4
role = "validate"
"#;

#[test]
fn a_limit_is_named_that_the_held_out_log_hardly_reaches() {
    let dir = tempfile::tempdir().unwrap();
    make_study(dir.path(), WEAK_AT_SPEED);
    let found = diagnosed(dir.path(), "out", &[]);
    assert_eq!(
        (&found["verdict"], &found["effect"]),
        (&"effect".into(), &"torque_limit".into()),
        "{}",
        found["sentence"]
    );
    assert_eq!(found["where"]["joints"].as_array().map(Vec::len), Some(4), "{}", found["where"]);
    let limit_nm = found["effects"][0]["parameters"]["tau_max"]["value"].as_f64().unwrap();
    assert!((limit_nm - 0.05).abs() < 0.005, "{limit_nm} N m");
}

fn logged(path: &Path) -> RobotLog {
    read_robot_log(path).expect("a log")
}

/// Difference of a joint in two logs at the first one's times that the other one has \[rad RMS\].
fn rms_rad(a: &RobotLog, b: &RobotLog, joint: &str) -> f64 {
    let (of_a, of_b) = (&a.joint(joint).expect("there").q_rad, &b.joint(joint).expect("there").q_rad);
    let (mut sum, mut count) = (0.0, 0.0);
    for (k, t_s) in a.t_s.iter().enumerate() {
        if let Some(j) = b.t_s.iter().position(|other| (other - t_s).abs() < 1e-6) {
            sum += (of_a[k] - of_b[j]).powi(2);
            count += 1.0;
        }
    }
    assert!(count > 100.0, "{count} common samples");
    f64::sqrt(sum / count)
}

#[test]
fn wrong_words_are_usage_errors() {
    let dir = tempfile::tempdir().unwrap();
    make_study(dir.path(), WEAK);
    let fails = |words: &[&str], says: &str| {
        let all: Vec<&str> = ["gap", "study.toml"].iter().chain(words).copied().collect();
        let output = run_in(dir.path(), &all);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(says), "{}", stderr(&output));
    };
    fails(&["--twins", "3"], "--twins is for the study of a joint");
    fails(&["--only", "gremlins"], "floor_stiffness");
    fails(&["--only", "delay", "--without", "delay"], "`delay` stands in --without and in --only");
    assert!(Cause::all().all(|cause| cause.id() != "gremlins"));
}

/// Each row: file, what is replaced in it (all of it where this is empty), by what, what the one error says.
const WRONG: [(&str, &str, &str, &str); 8] = [
    ("trot.csv", "rr3.q,rr3.q_ref", "wheel.q,wheel.q_ref", "ers7 has no joint wheel"),
    ("trot.csv", "rr3.q_ref", "unread", "column `rr3.q_ref` is missing"),
    ("study.toml", "scenario = \"air\"", "scenario = \"flying\"", "`[robot] scenario`"),
    ("study.toml", "scenario = \"air\"", "scenario = \"drop\"", "released"),
    ("study.toml", "file = \"trot.csv\"", "file = \"gone.csv\"", "gone.csv"),
    ("study.toml", "schema = 1", "schema = 1\ncolour = 2", "unknown field `colour`"),
    ("study.toml", "model = \"ers7\"", "model = \"none.toml\"", "none.toml"),
    ("trot.csv", "", "t,lf1.q\n0,0\n0,1\n", "trot.csv"),
];

#[test]
fn a_wrong_study_is_one_error() {
    for (file, from, to, says) in WRONG {
        let dir = tempfile::tempdir().unwrap();
        make_study(dir.path(), WEAK);
        let path = dir.path().join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{file} has no {from}:\n{}", &text[..text.len().min(600)]);
        fs::write(&path, if from.is_empty() { to.to_owned() } else { text.replacen(from, to, 1) }).unwrap();
        let output = run_in(dir.path(), &["gap", "study.toml"]);
        let said = stderr(&output);
        let code = output.status.code();
        let is_gone = ["gone.csv", "none.toml"].contains(&says);
        assert_eq!(code, Some(if is_gone { 5 } else { 3 }), "{from} -> {to}: {said}");
        assert!(said.starts_with("error: ") && said.contains(says), "{from} -> {to}: {said}");
        assert_eq!(said.matches("error:").count(), 1, "{said}");
        assert!(!dir.path().join("fits").exists(), "{from} -> {to}");
    }
}

#[test]
fn a_robot_that_is_not_asked_to_move_gets_no_diagnosis() {
    let dir = tempfile::tempdir().unwrap();
    make_study(dir.path(), WEAK);
    // Every row as the first one, but for its time.
    let text = fs::read_to_string(dir.path().join("trot.csv")).unwrap();
    let mut rows = text.lines();
    let (header, first) = (rows.next().unwrap(), rows.next().unwrap());
    let rest = first.split_once(',').unwrap().1;
    let still: Vec<String> =
        text.lines().skip(1).map(|row| format!("{},{rest}", row.split_once(',').unwrap().0)).collect();
    fs::write(dir.path().join("trot.csv"), format!("{header}\n{}\n", still.join("\n"))).unwrap();
    let said = expect_code(dir.path(), &["gap", "study.toml", "--json", "gap.json"], 1);
    assert!(said.contains("no diagnosis: no joint of the study moves"), "{said}");
    assert_eq!(json(&dir.path().join("gap.json"))["moved"], false);
}
