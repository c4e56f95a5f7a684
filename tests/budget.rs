//! What `gap --budget` promises: an answer of any study soon after the time that is allowed, which says what it left out and
//! states no probability where the search was not finished; with time enough, the answer that there is without it.

mod support;

use serde_json::{Map, Value};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use support::{expect_code, json, make_study, root};

/// With one second a study is answered within so many times that, drawing and writing included, on a machine that is busy
/// with other tests; what no search is without (reading, the joint or the robot as given, its recalibrated numbers) takes as
/// long as it takes.
const MULTIPLE: u32 = 30;

/// Robot studies: a walk in the air, one on the floor, and a joint that is let go.
const ROBOTS: [(&str, &str); 3] = [
    (
        "air",
        "[[effect]]\nid = \"torque_limit\"\njoints = [\"lr3\", \"rr3\"]\ntau_max = 0.03\n[[log]]\nfile = \"trot.csv\"\nduration = 5.0\n",
    ),
    (
        "floor",
        "[truth]\npayload = [{ mass = 0.25, at = [0.0, 0.03, 0.0] }]\n[[log]]\nfile = \"trot.csv\"\nduration = 5.0\n",
    ),
    (
        "drop",
        "[truth.friction.lf1]\ncoulomb = 0.003\nviscous = 0.051\n[[log]]\nfile = \"far.csv\"\nduration = 4.0\n\
         released = \"lf1\"\nrelease_time = 0.4\nangles = { lf1 = 1.2 }\n",
    ),
];

/// The answer of a study with an option or without, and how long it took.
fn answered(study: &Path, options: &[&str]) -> (Value, String, Duration) {
    let out = tempfile::tempdir().unwrap();
    let (folder, document) = (out.path().join("out"), out.path().join("gap.json"));
    let mut words = vec!["gap", study.to_str().unwrap(), "--out", folder.to_str().unwrap()];
    words.extend(["--json", document.to_str().unwrap()]);
    words.extend(options);
    let began = Instant::now();
    let text = expect_code(root(), &words, 0);
    let took = began.elapsed();
    let page = fs::read_to_string(folder.join("report.html")).unwrap();
    let document = json(&document);
    if document["budget"].is_object() {
        assert!(page.contains("--budget"), "{}: the page says nothing of the time", study.display());
    }
    (document, text, took)
}

/// Examples, studies of robots made here, and real ones where they are at hand.
fn studies(folder: &Path) -> Vec<PathBuf> {
    let example = |name: &&str| root().join("data/examples").join(name).join("study.toml");
    let mut studies: Vec<PathBuf> = ["ambiguous", "arm", "delay", "resolved"].iter().map(example).collect();
    for (scenario, more) in ROBOTS {
        let made = folder.join(scenario);
        fs::create_dir(&made).unwrap();
        let spec = format!(
            "schema = 1\nseed = 11\n[robot]\nmodel = \"ers7\"\nscenario = \"{scenario}\"\n[sensor]\nresolution = 0.006\nperiod = 0.008\n\
             noise = 0.001\n{more}"
        );
        make_study(&made, &spec);
        studies.push(made.join("study.toml"));
    }
    match std::env::var_os("AIBO_FIT_SHARED").map(PathBuf::from) {
        Some(shared) => {
            let real = ["xl330-bam/kp100", "rotary-pendulum", "so101/study", "double-pendulum"];
            studies.extend(real.map(|name| shared.join("real").join(name).join("study.toml")));
        }
        None => println!("AIBO_FIT_SHARED is not set: real studies are skipped"),
    }
    studies
}

#[test]
#[ignore = "slow"]
fn slow_every_study_is_answered_soon_after_its_time() {
    let made = tempfile::tempdir().unwrap();
    let mut unfinished = 0;
    for study in studies(made.path()) {
        let (document, text, took) = answered(&study, &["--budget", "1s"]);
        let name = study.display();
        let budget = &document["budget"];
        println!(
            "{name}: {:.1} s, search {:.1} s, {}",
            took.as_secs_f64(),
            budget["used_s"].as_f64().unwrap(),
            budget["not_tried"]
        );
        assert!(took < Duration::from_secs(1) * MULTIPLE, "{name}: {took:?}");
        assert_eq!(budget["asked_s"], 1.0, "{name}");
        assert!(text.contains("--budget"), "{name}: {text}");
        let sentence = document["sentence"].as_str().unwrap();
        let left_out = budget["not_tried"].as_array().unwrap();
        if budget["finished"] == true {
            assert!(document["probability"].is_number() && !sentence.contains("not finished"), "{name}: {sentence}");
        } else {
            unfinished += 1;
            assert!(!left_out.is_empty() && document["probability"].is_null(), "{name}: {budget}");
            assert!(sentence.contains("is not finished"), "{name}: {sentence}");
            let told = text.split_whitespace().collect::<Vec<_>>().join(" ");
            left_out.iter().for_each(|what| assert!(told.contains(what.as_str().unwrap()), "{name}: {what} in {text}"));
        }
    }
    assert!(unfinished > 0, "one second was enough for every study");
}

#[test]
fn with_time_enough_the_answer_is_the_one_without() {
    let study = root().join("data/examples/resolved/study.toml");
    let (without, _, _) = answered(&study, &[]);
    let (with, _, _) = answered(&study, &["--budget", "60min"]);
    assert_eq!(
        (&with["budget"]["finished"], with["budget"]["not_tried"].as_array().map(Vec::len)),
        (&true.into(), Some(0))
    );
    assert!(without.get("budget").is_none(), "a key of a time that nobody asked for");
    let bare = |document: Value| -> Map<String, Value> {
        let Value::Object(mut document) = document else { panic!("an object") };
        ["budget", "command", "notes"].iter().for_each(|key| drop(document.remove(*key)));
        document
    };
    let notes = |document: &Value| document["notes"].as_array().unwrap().clone();
    assert_eq!(notes(&with)[1..], notes(&without)[..], "one note more");
    assert_eq!(bare(with), bare(without));
}

#[test]
fn a_time_needs_a_unit_and_has_no_twins() {
    for words in [&["--budget", "60"][..], &["--budget", "0s"], &["--budget", "5s", "--twins", "3"]] {
        let all = [&["gap", "data/examples/resolved/study.toml"], words].concat();
        expect_code(root(), &all, 2);
    }
}
