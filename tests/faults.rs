//! What a fault leaves: a run that is broken off, a disk that is full, a folder that cannot be written, two runs into one
//! folder, a log that grows. Nothing half-written, the old result as it was, exit codes as `docs/reference/commands.md` says.
#![cfg(unix)]

mod support;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};
use support::{root, stderr};

const PROGRAM: &str = env!("CARGO_BIN_EXE_aibo-fit");
/// Begin of the names of files that are being written.
const TEMPORARY: &str = ".aibo-fit-";
const KILL: i32 = 9;

/// A command that writes into a folder, on one input or another; the second word is the input.
struct Work {
    words: &'static [&'static str],
    other: &'static [&'static str],
}

const WORKS: [Work; 3] = [
    Work { words: &["drop", "data/q1.csv"], other: &["drop", "data/sealed-robot/q1-220g-0.csv"] },
    Work {
        words: &["gap", "data/examples/resolved/study.toml"],
        other: &["gap", "data/examples/ambiguous/study.toml", "--only", "stribeck"],
    },
    Work {
        words: &["simulate", "data/examples/resolved/study.toml"],
        other: &["simulate", "data/examples/ambiguous/study.toml"],
    },
];

fn start(words: &[&str], out: &Path) -> Child {
    let mut command = Command::new(PROGRAM);
    command.current_dir(root()).args(words).arg("--quiet").arg("--out").arg(out);
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program can be started")
}

fn finished(words: &[&str], out: &Path) {
    let output = start(words, out).wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{words:?}: {}", stderr(&output));
}

/// Files of a folder by name; those that are being written are told apart.
fn files(folder: &Path) -> (BTreeMap<String, Vec<u8>>, usize) {
    let (mut files, mut unfinished) = (BTreeMap::new(), 0);
    let mut folders = vec![folder.to_path_buf()];
    while let Some(inside) = folders.pop() {
        for entry in fs::read_dir(inside).into_iter().flatten() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().unwrap().to_string_lossy().starts_with(TEMPORARY) {
                unfinished += 1;
            } else {
                files.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    (files, unfinished)
}

fn send(child: &Child, signal: &str) {
    // it may have ended by itself
    let _ = Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status();
}

fn ended_by(status: ExitStatus, signal: i32) -> bool {
    status.code() == Some(0) || status.signal() == Some(signal)
}

/// Breaks a run off by each signal at moments that are drawn; every file is the old one or the new one, and a last run has
/// the whole new result.
fn break_off(work: &Work, seed: u64, goes: usize) {
    let dir = tempfile::tempdir().unwrap();
    let (old, new, out) = (dir.path().join("old"), dir.path().join("new"), dir.path().join("out"));
    finished(work.words, &old);
    let began = Instant::now();
    finished(work.other, &new);
    let lasts = began.elapsed();
    let (old, new) = (files(&old).0, files(&new).0);
    assert_ne!(old, new);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for go in 0..goes {
        let (signal, number) = [("-INT", 2), ("-TERM", 15), ("-KILL", KILL)][go % 3];
        fs::create_dir_all(&out).unwrap();
        for (name, content) in &old {
            fs::write(out.join(name), content).unwrap();
        }
        let mut child = start(work.other, &out);
        // the last tenth, in which files are written, as often as all before it
        let share = if go % 2 == 0 { random.random_range(0.0..1.0) } else { random.random_range(0.9..1.05) };
        thread::sleep(Duration::from_secs_f64(share * lasts.as_secs_f64()));
        send(&child, signal);
        let status = child.wait().unwrap();
        assert!(ended_by(status, number), "{:?} {signal}: {status}", work.other);
        let (left, unfinished) = files(&out);
        assert!(unfinished == 0 || status.signal().is_some(), "{unfinished} files left unfinished by {status}");
        for (name, content) in &left {
            let whole = [&old, &new].iter().any(|files| files.get(name) == Some(content));
            assert!(whole, "{:?} {signal} at {share:.3}: {name} is neither the old nor the new one", work.other);
        }
        for name in old.keys().filter(|name| new.contains_key(*name)) {
            assert!(left.contains_key(name), "{:?} {signal} at {share:.3}: {name} is gone", work.other);
        }
    }
    finished(work.other, &out);
    let (left, unfinished) = files(&out);
    assert_eq!(unfinished, 0, "what broken-off runs left is removed");
    for (name, content) in &new {
        assert!(left.get(name) == Some(content), "{name} is not the new one");
    }
    fs::remove_dir_all(&out).unwrap();
}

#[test]
#[ignore = "slow"]
fn slow_a_fit_that_is_broken_off_leaves_whole_files() {
    break_off(&WORKS[0], 1, 6);
}

#[test]
fn a_diagnosis_that_is_broken_off_leaves_whole_files() {
    break_off(&WORKS[1], 2, 6);
}

#[test]
fn a_simulation_that_is_broken_off_leaves_whole_files() {
    break_off(&WORKS[2], 3, 12);
}

#[test]
#[ignore = "slow"]
fn slow_an_exam_that_is_broken_off_has_no_score_and_can_be_taken_again() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("exam");
    let words = ["blind", "--trials", "1", "--seed", "4"];
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut scored = Vec::new();
    for signal in ["-INT", "-KILL"] {
        let mut child = start(&words, &out);
        thread::sleep(Duration::from_secs_f64(random.random_range(0.05..2.0)));
        send(&child, signal);
        child.wait().unwrap();
        let mut left = files(&out).0;
        left.retain(|name, _| !name.starts_with(TEMPORARY));
        for (name, content) in &left {
            assert!(!content.is_empty(), "{name} is empty");
        }
        if left.contains_key("score.json") {
            scored.push(left);
        }
    }
    finished(&words, &out);
    let (left, unfinished) = files(&out);
    assert!(left.contains_key("score.json") && unfinished == 0, "{:?}", left.keys());
    for earlier in scored {
        assert!(earlier.keys().eq(left.keys()), "a score of a run that was broken off beside {:?}", earlier.keys());
    }
    // another exam that is broken off changes nothing of it
    let mut child = start(&["blind", "--trials", "1", "--seed", "5"], &out);
    thread::sleep(Duration::from_secs_f64(random.random_range(0.05..1.0)));
    send(&child, "-KILL");
    if child.wait().unwrap().signal().is_some() {
        let mut after = files(&out).0;
        after.retain(|name, _| !name.starts_with(TEMPORARY));
        assert!(after == left, "{:?}", after.keys());
    }
}

#[test]
#[ignore = "slow"]
fn slow_a_fleet_that_is_broken_off_goes_on_where_it_was() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["a", "b", "c"] {
        let folder = dir.path().join("logs").join(name);
        fs::create_dir_all(&folder).unwrap();
        for entry in fs::read_dir(root().join("data/examples/resolved")).unwrap() {
            let path = entry.unwrap().path();
            fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        }
    }
    let pattern = dir.path().join("logs/*/study.toml").to_string_lossy().into_owned();
    let words = ["fleet", &pattern, "--only", "stribeck"];
    let (whole, out) = (dir.path().join("whole"), dir.path().join("out"));
    finished(&words, &whole);
    let mut random = ChaCha8Rng::seed_from_u64(6);
    for signal in ["-TERM", "-KILL", "-INT"] {
        let mut child = start(&words, &out);
        thread::sleep(Duration::from_secs_f64(random.random_range(0.2..2.0)));
        send(&child, signal);
        child.wait().unwrap();
        for (name, content) in files(&out).0.iter().filter(|(name, _)| name.ends_with(".json")) {
            assert!(serde_json::from_slice::<serde_json::Value>(content).is_ok(), "{name} is half-written");
        }
    }
    finished(&words, &out);
    let names = |folder: &Path| files(folder).0.into_keys().collect::<BTreeSet<_>>();
    assert_eq!(names(&out), names(&whole));
}

#[test]
fn a_full_disk_is_an_input_output_failure_and_the_old_result_stays() {
    let dir = tempfile::tempdir().unwrap();
    for work in &WORKS {
        let out = dir.path().join(work.words[0]);
        finished(work.words, &out);
        let before = files(&out);
        // no file may grow beyond one block: what a disk does when it is full, for every file
        let line = format!(
            "trap '' XFSZ; ulimit -f 1; exec {PROGRAM} {} --quiet --out {}",
            work.other.join(" "),
            out.display()
        );
        let output = Command::new("sh").current_dir(root()).args(["-c", &line]).output().unwrap();
        assert_eq!(output.status.code(), Some(5), "{line}: {}", stderr(&output));
        let said = stderr(&output);
        assert!(said.starts_with("error: ") && said.contains(&*out.to_string_lossy()), "{said}");
        assert!(files(&out) == before, "{:?} changed what was there", work.other);
    }
}

#[test]
fn results_that_cannot_be_printed_are_an_input_output_failure_but_for_a_closed_pipe() {
    let full = || OpenOptions::new().write(true).open("/dev/full");
    let Ok(first) = full() else { return println!("skipped: there is no /dev/full") };
    drop(first);
    for words in [&["dynamics", "data/examples/states.json"][..], &["check", "data/q1.csv"]] {
        let mut command = Command::new(PROGRAM);
        let output = command.current_dir(root()).args(words).stdout(full().unwrap()).output().unwrap();
        assert_eq!(output.status.code(), Some(5), "{words:?}: {}", stderr(&output));
        assert!(stderr(&output).contains("standard output"), "{}", stderr(&output));
    }
    let line = format!("{PROGRAM} check data/q1.csv | true");
    assert!(Command::new("sh").current_dir(root()).args(["-c", &line]).status().unwrap().success());
}

#[test]
fn a_folder_that_cannot_be_written_is_an_input_output_failure() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().unwrap();
    let locked = dir.path().join("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    let mut folders = vec![dir.path().join("file/out"), "/proc/aibo-fit".into()];
    fs::write(dir.path().join("file"), "in the way").unwrap();
    if fs::write(locked.join("probe"), "").is_err() {
        folders.push(locked);
    } else {
        println!("skipped: this user may write into a read-only folder");
    }
    for out in folders.iter().filter(|out| !out.starts_with("/proc") || Path::new("/proc/self").exists()) {
        for work in &WORKS {
            let output = start(work.words, out).wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(5), "{:?}: {}", work.words, stderr(&output));
            assert!(stderr(&output).contains(&*out.to_string_lossy()), "{}", stderr(&output));
        }
    }
}

#[test]
fn of_two_runs_into_one_folder_one_stays_whole() {
    let dir = tempfile::tempdir().unwrap();
    for work in &WORKS[1..] {
        let (one, two) = (dir.path().join("one"), dir.path().join("two"));
        finished(work.words, &one);
        finished(work.other, &two);
        let (one, two) = (files(&one).0, files(&two).0);
        for go in 0..4 {
            let out = dir.path().join(format!("both-{go}"));
            let both = [work.words, work.other].map(|words| start(words, &out));
            for child in both {
                let output = child.wait_with_output().unwrap();
                assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
            }
            let (left, unfinished) = files(&out);
            let is_of = |run: &BTreeMap<String, Vec<u8>>| left == *run;
            assert!(
                unfinished == 0 && (is_of(&one) || is_of(&two)),
                "{:?} mixes two runs: {:?}",
                work.words,
                left.keys()
            );
        }
        fs::remove_dir_all(dir.path()).unwrap();
    }
}

#[test]
fn a_log_that_grows_is_read_as_far_as_it_is_whole_or_refused_with_its_line() {
    let dir = tempfile::tempdir().unwrap();
    let log = dir.path().join("growing.csv");
    let whole = fs::read_to_string(root().join("data/q1.csv")).unwrap();
    let rows: Vec<&str> = whole.split_inclusive('\n').collect();
    fs::write(&log, rows[..200].concat()).unwrap();
    let mut child = None;
    let mut outcomes = BTreeSet::new();
    for row in &rows[200..] {
        let mut file = OpenOptions::new().append(true).open(&log).unwrap();
        // a row in two parts, as a logger's buffer may end anywhere
        let (first, second) = row.split_at(row.len() / 2);
        file.write_all(first.as_bytes()).unwrap();
        let run = child.get_or_insert_with(|| {
            let mut command = Command::new(PROGRAM);
            command.arg("check").arg(&log).args(["--quiet", "--out"]).arg(dir.path().join("out"));
            command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
        });
        if run.try_wait().unwrap().is_some() {
            let output = child.take().unwrap().wait_with_output().unwrap();
            let code = output.status.code();
            assert!(matches!(code, Some(0 | 3)), "{code:?}: {}", stderr(&output));
            assert!(code == Some(0) || stderr(&output).contains("growing.csv"), "{}", stderr(&output));
            outcomes.insert(code);
        }
        thread::sleep(Duration::from_millis(2));
        file.write_all(second.as_bytes()).unwrap();
    }
    if let Some(child) = child {
        child.wait_with_output().unwrap();
    }
    assert!(!outcomes.is_empty(), "no run ended while the log grew");
    let output = Command::new(PROGRAM).arg("check").arg(&log).arg("--quiet").output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}
