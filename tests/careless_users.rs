//! Whatever a careless user types or hands over: the exit code of the specification, one error that says where and what
//! to do, nothing on standard output, and no file or folder left behind.

mod support;

use aibo_fit::identify::Case;
use aibo_fit::log::DriveMode;
use std::fs;
use std::path::Path;
use support::*;

const DONE: i32 = 0;
const NO: i32 = 1;
const USAGE: i32 = 2;
const DATA: i32 = 3;
const IO: i32 = 5;

/// A folder with a good log, a good study and a good fit.
fn bench() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
    put("good.csv", &good_log());
    put("study.toml", STUDY);
    put("fit.json", FIT);
    dir
}

/// Runs a command that has to fail, and checks all that a failing command promises.
fn refused(what: &str, dir: &Path, words: &[&str], code: i32, parts: &[&str]) {
    let before = everything_in(dir);
    let output = run_in(dir, words);
    let (out, err) = (stdout(&output), stderr(&output));
    let told = format!("{what}: aibo-fit {}\n{err}", words.join(" "));
    assert_eq!(output.status.code(), Some(code), "{told}\n{out}");
    assert!(!err.contains("panicked") && !err.contains("RUST_BACKTRACE"), "{told}");
    assert_eq!(err.matches("error:").count(), 1, "{told}");
    assert!(err.starts_with("error: "), "{told}");
    assert!(out.is_empty(), "{told}\nstandard output: {out}");
    for part in parts {
        assert!(err.contains(part), "`{part}` not in {told}");
    }
    assert_eq!(everything_in(dir), before, "{told}");
}

#[test]
fn command_lines_that_cannot_be_are_refused_as_usage() {
    let cases: &[(&str, &[&str], &[&str])] = &[
        ("no log", &["drop"], &["<LOG>", "--help"]),
        ("unknown command", &["fit", "good.csv"], &["fit", "--help"]),
        ("unknown option", &["drop", "good.csv", "--joints", "q1"], &["--joints", "--joint"]),
        ("unknown method", &["drop", "good.csv", "--method", "newton"], &["newton", "lm, bfgs, dfp"]),
        ("no such parameter", &["drop", "good.csv", "--fix", "nosuch=1"], &["`nosuch`", "inertia, ml2, moment"]),
        (
            "a parameter of the leg",
            &["drop", "good.csv", "--free", "mass_shoulder"],
            &["`mass_shoulder`", "this fit has"],
        ),
        ("a negative bound", &["drop", "good.csv", "--bound", "viscous=-1:2"], &["`viscous` = -1", "zero or above"]),
        ("bounds the wrong way round", &["drop", "good.csv", "--bound", "viscous=2:1"], &["LOW must be below HIGH"]),
        ("half a bound", &["drop", "good.csv", "--bound", "viscous=2"], &["NAME=LOW:HIGH"]),
        ("a bound of text", &["drop", "good.csv", "--bound", "viscous=a:b"], &["`a` is not a number"]),
        ("inertia from zero", &["drop", "good.csv", "--start", "inertia=0"], &["`inertia` = 0 kg m^2", "above zero"]),
        ("a start without value", &["drop", "good.csv", "--start", "inertia"], &["write inertia=VALUE"]),
        ("a start that is nan", &["drop", "good.csv", "--start", "inertia=nan"], &["`nan` is not a number"]),
        ("fixed at infinity", &["drop", "good.csv", "--fix", "coulomb=inf"], &["`inf` is not a number"]),
        (
            "fixed at nothing known",
            &["drop", "good.csv", "--fix", "coulomb"],
            &["no nominal value", "--fix coulomb=VALUE"],
        ),
        (
            "fixed twice",
            &["drop", "good.csv", "--fix", "coulomb=1", "--fix", "coulomb=2"],
            &["`coulomb`", "given twice"],
        ),
        ("fixed and free", &["drop", "good.csv", "--fix", "coulomb=1", "--free", "coulomb"], &["--fix and --free"]),
        (
            "started outside its bounds",
            &["drop", "good.csv", "--bound", "coulomb=0:1", "--start", "coulomb=5"],
            &["--start 5 lies outside --bound 0:1"],
        ),
        ("no threads", &["drop", "good.csv", "--threads", "0"], &["--threads", "1..=1024"]),
        ("threads in words", &["drop", "good.csv", "--threads", "two"], &["--threads", "two"]),
        ("log and study", &["drop", "good.csv", "--study", "study.toml"], &["--study", "cannot be used with"]),
        ("joint of a study", &["drop", "--joint", "q1", "--study", "study.toml"], &["--joint", "cannot be used with"]),
        ("a joint without name", &["drop", "good.csv", "--joint", " "], &["--joint", "needs a name"]),
        ("study without file", &["drop", "--study"], &["--study <FILE>"]),
        ("nothing to diagnose", &["gap"], &["<STUDY>"]),
        (
            "an effect that is none",
            &["gap", "study.toml", "--without", "delay,friction"],
            &["`friction` is not an effect", "stribeck, load_friction"],
        ),
        (
            "withheld and considered",
            &["gap", "study.toml", "--without", "delay", "--only", "stribeck, delay"],
            &["`delay`", "--without and in --only"],
        ),
        ("twins in words", &["gap", "study.toml", "--twins", "few"], &["--twins", "few"]),
        ("nothing to simulate", &["simulate"], &["<STUDY>"]),
        ("two studies", &["simulate", "study.toml", "study.toml"], &["unexpected argument"]),
        ("JSON over the log", &["drop", "good.csv", "--json", "good.csv"], &["good.csv", "written over this input"]),
        (
            "JSON over the fit",
            &["simulate", "study.toml", "--fit", "fit.json", "--json", "./fit.json"],
            &["fit.json", "choose another"],
        ),
        ("fit.json over the fit", &["drop", "--study", "fit.toml", "--out", "."], &["fit.toml", "choose another"]),
        (
            "logs of two joints",
            &["drop", "good.csv", "q1.csv"],
            &["q1.csv: a log of joint q1", "joint good", "--joint"],
        ),
    ];
    let dir = bench();
    fs::write(dir.path().join("q1.csv"), good_log()).unwrap();
    fs::write(dir.path().join("fit.toml"), STUDY).unwrap();
    for (what, words, parts) in cases {
        refused(what, dir.path(), words, USAGE, parts);
    }
    assert_eq!(fs::read_to_string(dir.path().join("good.csv")).unwrap(), good_log());
}

#[test]
fn files_that_cannot_be_read_or_written_are_an_input_output_failure() {
    let dir = bench();
    fs::create_dir(dir.path().join("folder")).unwrap();
    fs::write(dir.path().join("lost.toml"), STUDY.replace("good.csv", "gone.csv")).unwrap();
    let cases: &[(&str, &[&str], &[&str])] = &[
        ("no such log", &["drop", "gone.csv"], &["gone.csv: could not be read", "check the path"]),
        ("no such second log", &["drop", "good.csv", "gone.csv", "--joint", "j"], &["gone.csv: could not be read"]),
        ("a folder as log", &["drop", "folder"], &["folder: could not be read", "name of a file"]),
        ("no such study", &["drop", "--study", "gone.toml"], &["gone.toml: could not be read", "check the path"]),
        ("no such study to diagnose", &["gap", "gone.toml"], &["gone.toml: could not be read"]),
        ("a folder as study", &["simulate", "folder"], &["folder: could not be read"]),
        (
            "a log of the study is gone",
            &["drop", "--study", "lost.toml"],
            &["line 9, key `[[log]] 1 file`", "gone.csv"],
        ),
        ("no such fit", &["simulate", "study.toml", "--fit", "gone.json"], &["gone.json: could not be read"]),
        ("no such log to simulate", &["simulate", "study.toml", "--log", "gone.csv"], &["gone.csv: could not be read"]),
        ("a file as output folder", &["drop", "good.csv", "--out", "study.toml"], &["study.toml", "another folder"]),
        ("a folder below a file", &["drop", "good.csv", "--out", "study.toml/a/b"], &["could not be written"]),
        (
            "a file as simulate's folder",
            &["simulate", "study.toml", "--out", "good.csv"],
            &["good.csv", "another folder"],
        ),
        (
            "a folder as JSON file",
            &["drop", "good.csv", "--out", "new/deep", "--json", "folder"],
            &["folder: could not be written", "name of a file"],
        ),
        (
            "a folder as JSON file of simulate",
            &["simulate", "study.toml", "--out", "new", "--json", "folder"],
            &["folder: could not be written"],
        ),
    ];
    for (what, words, parts) in cases {
        refused(what, dir.path(), words, IO, parts);
    }
    if cfg!(target_os = "linux") {
        // Not even root makes folders there.
        let words = ["drop", "good.csv", "--out", "/proc/no-such-place/here"];
        refused(
            "a folder that cannot be made",
            dir.path(),
            &words,
            IO,
            &["/proc/no-such-place", "could not be written"],
        );
    }
}

#[test]
fn logs_that_cannot_be_are_refused_as_data() {
    let swing = |t: f64| format!("{t:.3},{:.4}", decaying(t));
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("empty", String::new(), &["empty", "header row"]),
        ("header only", "t,q\n".into(), &["line 1", "no samples"]),
        (
            "three samples",
            log_of("t,q", 3, 0.008, |t| format!("{t},{}", 1.0 - t)),
            &["only 3 samples", "record longer"],
        ),
        ("seven samples", log_of("t,q", 7, 0.008, swing), &["only 7 samples", "at least 8"]),
        (
            "let go at the end",
            log_of("t,q,drive", 60, 0.008, |t| format!("{t:.3},0.3,{}", u8::from(t < 0.45))),
            &["only 3 samples"],
        ),
        ("a NaN", log_of("t,q", 40, 0.008, |t| format!("{t:.3},nan")), &["line 2, column `q`", "finite"]),
        ("1e308", log_of("t,q", 40, 0.008, |t| format!("{t:.3},1e308")), &["line 2, column `q`", "1e308", "unit"]),
        ("1e308 in time", "t,q\n0,0.1\n1e308,0.2\n".into(), &["line 3, column `t`", "1e308"]),
        ("epoch in milliseconds", log_of("t,q", 40, 8.0, |t| format!("{},0.1", 1.7e12 + t)), &["`t`", "milliseconds"]),
        (
            "degrees",
            log_of("t,q", 40, 0.008, |t| format!("{t:.3},{}", 57.3 * decaying(t))),
            &["`q`", "degrees", "pi/180"],
        ),
        ("semicolons", log_of("t;q", 40, 0.008, |t| format!("{t:.3};0.1")), &["line 1", "semicolons"]),
        (
            "time runs back",
            log_of("t,q", 40, 0.008, |t| format!("{:.3},0.1", 0.5 - t)),
            &["line 3, column `t`", "back"],
        ),
        (
            "several joints, none chosen",
            log_of("t,lf1.q,lf2.q", 40, 0.008, |t| format!("{t:.3},0.1,0.2")),
            &["line 1", "several joints (`lf1`, `lf2`)", "--joint"],
        ),
        ("binary", "t,q\n0,\0\0\0\0\0\0\0\0".into(), &["line 1", "CSV"]),
    ];
    let dir = bench();
    for (i, (what, text, parts)) in cases.iter().enumerate() {
        let name = format!("swing-{i}.csv");
        fs::write(dir.path().join(&name), text).unwrap();
        let parts: Vec<&str> = std::iter::once(name.as_str()).chain(parts.iter().copied()).collect();
        refused(what, dir.path(), &["drop", &name, "--out", "out", "--json", "out.json"], DATA, &parts);
        refused(what, dir.path(), &["simulate", "study.toml", "--log", &name, "--out", "out"], DATA, &parts);
    }
    fs::write(dir.path().join("walk.csv"), &cases[12].1).unwrap();
    refused("no such joint", dir.path(), &["drop", "walk.csv", "--joint", "lf9"], DATA, &["`lf9.q`", "`lf1`, `lf2`"]);
}

#[test]
fn a_log_that_is_commanded_is_no_free_swing_unless_something_says_so() {
    let dir = bench();
    let followed = |t: f64| format!("{t:.3},{:.4},{:.4}", decaying(t), 1.1 * decaying(t));
    let write = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
    write("arm.csv", &log_of("t,q,q_ref", 200, 0.008, followed));
    write("pushed.csv", &log_of("t,q,tau", 200, 0.008, followed));
    let ways: [&str; 5] = ["arm.csv", "column `q_ref` varies", "arm.toml", "drive = \"position\"", "[motor]"];
    refused("setpoints", dir.path(), &["drop", "arm.csv", "--out", "out"], DATA, &ways);
    let ways: [&str; 4] = ["pushed.csv", "column `tau` varies", "pushed.toml", "drive = \"torque\""];
    refused("torques", dir.path(), &["drop", "pushed.csv", "--out", "out"], DATA, &ways);
    // A sidecar that is silent about the drive does not help, and one without the column that it needs is wrong.
    write("arm.toml", "schema = 1\n[sensor]\nperiod = 0.008\n");
    refused("silent sidecar", dir.path(), &["drop", "arm.csv", "--out", "out"], DATA, &["`q_ref` varies"]);
    write("pushed.toml", "schema = 1\n[motor]\nkp = 1.0\nkd = 0.0\n[[log]]\ndrive = \"position\"\n");
    refused("no setpoint", dir.path(), &["drop", "pushed.csv", "--out", "out"], DATA, &["`q_ref` is missing"]);

    let case = |text: &str| {
        write("arm.toml", text);
        Case::of_logs(&[dir.path().join("arm.csv")], None).map(|case| case.items[0].entry.drive)
    };
    assert_eq!(case("schema = 1\n[[log]]\ndrive = \"off\"\n").unwrap(), DriveMode::Off);
    assert_eq!(
        case("schema = 1\n[motor]\nkp = 1.0\nkd = 0.0\n[[log]]\ndrive = \"position\"\n").unwrap(),
        DriveMode::Position
    );
    fs::remove_file(dir.path().join("arm.toml")).unwrap();
    write("arm.csv", &log_of("t,q,q_ref,drive", 200, 0.008, |t| format!("{},0", followed(t))));
    assert!(Case::of_logs(&[dir.path().join("arm.csv")], None).is_ok(), "the column drive says it");
    write("arm.csv", &log_of("t,q,q_ref", 200, 0.008, |t| format!("{t:.3},{:.4},0.1", decaying(t))));
    assert!(Case::of_logs(&[dir.path().join("arm.csv")], None).is_ok(), "a setpoint that stays asks for nothing");
}

#[test]
fn a_log_in_the_place_of_a_study_is_called_a_log_first() {
    let dir = bench();
    for words in [
        &["gap", "good.csv", "--out", "out"][..],
        &["drop", "--study", "good.csv", "--out", "out"],
        &["simulate", "good.csv", "--out", "out"],
    ] {
        let said = "error: good.csv is a log, not a study; write one with `aibo-fit init good.csv`";
        refused("a log", dir.path(), words, DATA, &[said]);
    }
}

#[test]
fn lines_that_do_not_read_a_log_are_not_offered() {
    let dir = bench();
    let arm = |t: f64| format!("{t:.3},{0:.4},{0:.4},{0:.4},{0:.4}", 30.0 * decaying(t));
    fs::write(dir.path().join("arm.csv"), log_of("time,A1_act,A1_cmd,A2_act,A2_cmd", 200, 0.008, arm)).unwrap();
    let dates = |t: f64| format!("2024-05-01T12:00:{t:06.3},{:.4}", decaying(t));
    fs::write(dir.path().join("dates.csv"), log_of("time,q", 200, 0.008, dates)).unwrap();
    let naming = ["`time` looks like it", "{ name = \"A1_act\" }", "`aibo-fit init`"];
    for (log, parts) in [("arm.csv", &naming[..]), ("dates.csv", &["a date or a time of day"])] {
        let words = ["init", log, "--study", "new.toml"];
        refused(log, dir.path(), &words, DATA, parts);
        let said = stderr(&run_in(dir.path(), &words));
        assert!(!said.contains("as it is"), "{said}");
    }
}

#[test]
fn sidecars_and_studies_that_cannot_be_are_refused_as_data() {
    let dir = bench();
    const NOMINAL: &str = "inertia = 9.0e-4\nmoment = 5.0e-3\ncoulomb = 0.001\nviscous = 0.001\n";
    let study = |old: &str, new: &str| STUDY.replacen(old, new, 1);
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("misspelt key", study("inertia", "intertia"), &["line 4", "intertia"]),
        ("no schema", study("schema = 1\n", ""), &["`schema` is missing"]),
        ("no nominal model", study(NOMINAL, ""), &["[joint] does not say inertia (kg m^2)", "viscous (N m s/rad)"]),
        ("inertia of zero", study("9.0e-4", "0"), &["line 4, key `[joint] inertia`", "above 0"]),
        ("inertia of infinity", study("9.0e-4", "inf"), &["key `[joint] inertia`", "inf"]),
        ("a number beyond all numbers", study("5.0e-3", "1e999"), &["line 5"]),
        ("validate only", study("\"fit\"", "\"validate\""), &["role = \"fit\""]),
        ("driven without setpoint", study("\"off\"", "\"position\""), &["`[motor]` is missing"]),
        ("driven without torque", study("\"off\"", "\"torque\""), &["good.csv", "`tau`", "\"torque\""]),
        ("a robot study", "schema = 1\n[robot]\nmodel = \"ers7\"\n".into(), &["line 2", "robot study"]),
        ("not TOML", "t,q\n0,1\n".into(), &["line 1"]),
        ("empty", String::new(), &["`schema` is missing"]),
    ];
    for (i, (what, text, parts)) in cases.iter().enumerate() {
        let name = format!("study-{i}.toml");
        fs::write(dir.path().join(&name), text).unwrap();
        for words in [
            &["drop", "--study", &name, "--out", "out", "--json", "o.json"][..],
            &["simulate", &name],
            &["gap", &name, "--out", "out", "--json", "o.json"],
        ] {
            // `gap` reads robot studies, and this one is not whole.
            let of_robot: &[&str] = &["key `[robot] scenario` is missing"];
            let parts = if *what == "a robot study" && words[0] == "gap" { of_robot } else { *parts };
            refused(what, dir.path(), words, DATA, parts);
        }
    }
    let sidecars: &[(&str, &str, &[&str])] = &[
        ("another log's", "schema = 1\n[[log]]\nfile = \"b.csv\"\n", &["good.toml", "\"good.csv\", the log beside it"]),
        (
            "half a model",
            "schema = 1\n[joint]\ninertia = 1e-3\n",
            &["good.toml", "[joint] does not say moment (kg m), coulomb (N m)"],
        ),
        ("unknown key", "schema = 1\nweight = 3\n", &["good.toml", "line 2", "weight"]),
        ("mass in grams", "schema = 1\n[[log]]\n[log.extra]\nmass = 220\ndistance = 0.1\n", &["good.toml", "grams"]),
    ];
    for (what, text, parts) in sidecars {
        fs::write(dir.path().join("good.toml"), text).unwrap();
        refused(what, dir.path(), &["drop", "good.csv", "--out", "out"], DATA, parts);
    }
    fs::remove_file(dir.path().join("good.toml")).unwrap();
    fs::write(dir.path().join("q1.csv"), good_log()).unwrap();
    fs::write(dir.path().join("q1.toml"), "schema = 1\n").unwrap();
    fs::write(dir.path().join("pose.toml"), "leg = \"xx\"\n").unwrap();
    refused("a leg that dogs do not have", dir.path(), &["drop", "q1.csv"], DATA, &["pose.toml", "line 1, key `leg`"]);
}

#[test]
fn fits_that_cannot_be_are_refused_as_data() {
    let fit = |old: &str, new: &str| FIT.replacen(old, new, 1).into_bytes();
    let effect = |text: &str| fit("\"effects\": []", &format!("\"effects\": [{text}]"));
    let cases: Vec<(&str, Vec<u8>, &[&str])> = vec![
        ("empty", vec![], &["line 1", "expected a fit.json"]),
        ("cut off", FIT.as_bytes()[..60].to_vec(), &["line 2", "expected a fit.json"]),
        ("not an object", b"[1, 2]".to_vec(), &["`schema` is missing"]),
        ("a study", STUDY.into(), &["line 1", "expected a fit.json"]),
        ("schema of the future", fit("\"schema\": 1", "\"schema\": 2"), &["schema is 2, expected 1"]),
        ("schema in words", fit("\"schema\": 1", "\"schema\": \"1\""), &["schema is \"1\", expected 1"]),
        ("no joint", fit("\"joint\"", "\"joined\""), &["`joint`"]),
        ("no inertia", fit("\"inertia\"", "\"intertia\""), &["`inertia`", "line"]),
        ("null", fit("9e-4", "null"), &["joint.inertia.value is null", "does not determine"]),
        ("text", fit("9e-4", "\"9e-4\""), &["line 2", "string"]),
        ("zero inertia", fit("9e-4", "0"), &["joint.inertia.value is 0", "above zero"]),
        ("negative friction", fit("0.0018", "-1"), &["joint.viscous.value is -1", "not below zero"]),
        ("huge", fit("9e-4", "1e300"), &["joint.inertia.value is 1e300", "below 1e6"]),
        ("beyond all numbers", fit("9e-4", "1e999"), &["out of range", "line 2"]),
        ("rest in degrees", fit("{\"value\": 0.0} }", "{\"value\": 45} }"), &["joint.rest.value is 45", "2 pi"]),
        ("unknown effect", effect("{\"id\": \"ghost\", \"parameters\": {}}"), &["`ghost`", "stribeck"]),
        ("half an effect", effect("{\"id\": \"stribeck\", \"parameters\": {}}"), &["stribeck lacks mu_st"]),
        (
            "an effect of null",
            effect("{\"id\": \"stribeck\", \"parameters\": {\"mu_st\": {\"value\": null}, \"v_st\": {\"value\": 1}}}"),
            &["mu_st.value is null"],
        ),
        ("Latin-1", b"{ \"name\": \"K\xFChler\" }".to_vec(), &["UTF-8"]),
        ("a joint that never moved", br#"{ "schema": 1, "moved": false }"#.to_vec(), &["never moved"]),
    ];
    let dir = bench();
    for (i, (what, text, parts)) in cases.iter().enumerate() {
        let name = format!("fit-{i}.json");
        fs::write(dir.path().join(&name), text).unwrap();
        let parts: Vec<&str> = std::iter::once(name.as_str()).chain(parts.iter().copied()).collect();
        refused(what, dir.path(), &["simulate", "study.toml", "--fit", &name, "--json", "o.json"], DATA, &parts);
    }
}

#[test]
fn a_joint_that_shows_nothing_is_an_answer_and_leaves_only_the_json() {
    let cases: &[(&str, String, &str)] = &[
        ("all held", log_of("t,q,drive", 100, 0.008, |t| format!("{t:.3},0.3,1")), "held throughout"),
        ("twenty identical samples", log_of("t,q", 20, 0.008, |t| format!("{t:.3},0.3")), "friction holds it"),
        (
            "noise alone",
            log_of("t,q", 400, 0.008, |t| format!("{t:.3},{:.4}", 0.3 * (t * 1e5).sin())),
            "no motion stands out",
        ),
    ];
    for (what, text, said) in cases {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("still.csv"), text).unwrap();
        let out = expect_code(dir.path(), &["drop", "still.csv", "--json", "deep/no.json"], NO);
        assert!(out.contains(said), "{what}: {out}");
        let names: Vec<String> =
            everything_in(dir.path()).iter().map(|p| p.strip_prefix(&dir).unwrap().display().to_string()).collect();
        assert_eq!(names, ["deep", "deep/no.json", "still.csv"], "{what}");
        assert_eq!(json(&dir.path().join("deep/no.json"))["moved"], false, "{what}");
    }
}

#[test]
fn what_is_only_untidy_is_fitted() {
    let dir = bench();
    let put = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
    put("epoch.csv", &log_of("t,q", 500, 0.008, |t| format!("{:.3},{:.5}", 1.7e9 + t, decaying(t))));
    put("windows.csv", &format!("\u{feff}{}", good_log().replace('\n', "\r\n")));
    put("walk.csv", &log_of("t,lf1.q,lf2.q", 500, 0.008, |t| format!("{t:.3},{:.5},0.1", decaying(t))));
    for words in [
        &["drop", "epoch.csv", "--out", "out", "--quiet"][..],
        &["drop", "windows.csv", "--out", "out", "--quiet"],
        &["drop", "walk.csv", "--joint", "lf1", "--out", "out", "--quiet"],
        &["drop", "good.csv", "--out", "out", "--json", "not/yet/there.json", "--threads", "1024", "--quiet"],
        &["drop", "good.csv", "--out", "out", "--fix", "coulomb=0", "--fix", "viscous=0", "--fix", "rest=0", "--quiet"],
        &["drop", "--study", "study.toml", "--out", "out", "--fix", "moment", "--stribeck", "--quiet"],
        &["--help"],
        &["drop", "--help"],
        &["gap", "--help"],
        &["--version"],
    ] {
        expect_code(dir.path(), words, DONE);
    }
    assert!(dir.path().join("not/yet/there.json").is_file());
    assert!(!everything_in(dir.path()).iter().any(|p| p.to_string_lossy().contains(".aibo-fit-")));
}

/// Fits a swing at 1 kHz and checks that report and figures stay small.
fn fit_long_log(rows: u32) {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("long.csv"), long_swing(rows, 0.001)).unwrap();
    let begun = std::time::Instant::now();
    let out = expect_code(dir.path(), &["drop", "long.csv", "--out", "out"], DONE);
    println!("{rows} rows: {:.1} s", begun.elapsed().as_secs_f64());
    assert!(out.contains("per unit of inertia") && out.contains("long.csv is long:"), "{out}");
    for path in everything_in(&dir.path().join("out")) {
        let size = fs::metadata(&path).unwrap().len();
        assert!(size < 3_000_000, "{}: {size} bytes", path.display());
    }
    let page = fs::read_to_string(dir.path().join("out/report.html")).unwrap();
    assert!(page.contains("long log:"), "the report says that not every sample is fitted");
    let ratio = json(&dir.path().join("out/fit.json"))["ratios"]["moment_per_inertia"]["value"].as_f64().unwrap();
    assert!((ratio * 9.81 - 40.0).abs() < 0.4, "{ratio}");
    assert!(begun.elapsed().as_secs() < 60);
}

#[test]
fn a_log_of_fifty_thousand_rows_is_fitted() {
    fit_long_log(50_000);
}

/// `cargo test --release --test careless_users -- --ignored --nocapture`; for the memory run the same log through
/// `/usr/bin/time -v aibo-fit drop`.
#[test]
#[ignore = "takes half a minute"]
fn a_log_of_a_million_rows_is_fitted_within_a_minute() {
    fit_long_log(1_000_000);
}
