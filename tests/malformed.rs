//! Every file that a careless user hands over is refused with a message that says where and what to do.

use std::fs;
use std::path::Path;

use aibo_fit::log::{
    LogError, SensorSpec, check_period, read_joint_log, read_log, read_sidecar_for, read_study, read_study_logs,
};

/// A good log of 40 samples with a row changed by the user.
fn log_with(line: usize, row: &str) -> Vec<u8> {
    let mut rows = vec!["t,q,drive".to_owned()];
    rows.extend((0..40).map(|i| format!("{:.3},{:.3},0", f64::from(i) * 0.008, 0.5 - 0.01 * f64::from(i))));
    rows[line - 1] = row.to_owned();
    (rows.join("\n") + "\n").into_bytes()
}

/// 40 samples with every row made by the user's own logger.
fn log_of(header: &str, row: impl Fn(f64) -> String) -> Vec<u8> {
    let rows: Vec<String> = (0..40).map(|i| row(f64::from(i))).collect();
    format!("{header}\n{}\n", rows.join("\n")).into_bytes()
}

fn utf16(text: &str, mark: bool) -> Vec<u8> {
    let start = if mark { vec![0xFF, 0xFE] } else { vec![] };
    start.into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect()
}

/// The message has to name the file and to contain every part expected.
fn check(what: &str, file: &str, error: Option<LogError>, parts: &[&str]) {
    let error = error.unwrap_or_else(|| panic!("{what}: accepted"));
    let message = error.to_string();
    for part in std::iter::once(&file).chain(parts) {
        assert!(message.contains(part), "{what}: `{part}` not in:\n{message}");
    }
    assert!(!error.is_io() || what.contains("not there"), "{what}: counted as input/output");
}

#[test]
fn malformed_logs_are_refused_with_line_column_and_fix() {
    let swing = |t: f64| format!("{:.3},{:.4}", t * 0.008, 0.5 - 0.01 * t);
    let cases: Vec<(&str, Vec<u8>, &[&str])> = vec![
        ("empty file", vec![], &["empty", "header row"]),
        ("blank lines only", b"\n  \n\n".to_vec(), &["empty", "header row"]),
        ("byte order mark only", b"\xEF\xBB\xBF".to_vec(), &["empty"]),
        ("header only", b"t,q\n".to_vec(), &["line 1", "no samples", "at least 2"]),
        ("one sample", b"t,q\n0.0,0.1\n".to_vec(), &["line 2", "1 sample", "at least 2"]),
        ("no header", b"0.0,0.1\n0.1,0.2\n".to_vec(), &["line 1", "first row holds numbers", "add a header"]),
        ("time misspelt", log_of("time,q", swing), &["line 1", "column `t`", "`time` looks like it", "in s"]),
        ("time with unit", log_of("t [s],q", swing), &["column `t`", "`t [s]` looks like it: rename it to `t`"]),
        ("capital T", log_of("T,q", swing), &["column `t`", "`T` looks like it"]),
        ("capital Q", log_of("t,Q", swing), &["column `q`", "`Q` looks like it", "in rad"]),
        ("angle by its name", log_of("t,angle", swing), &["column `q`", "`angle` looks like it", "`t`, `angle`"]),
        (
            "no angle at all",
            log_of("t,volts", swing),
            &["column `q` is missing", "`t`, `volts`", "name them in a study", "{ name = \"volts\" }"],
        ),
        (
            "names that tell nothing",
            log_of("time,A1,A2", |t| format!("{},0.1,0.2", t * 0.008)),
            &["`time` looks like it", "\"joint_1.q\" = { name = \"A1\" }", "\nt = { name = \"time\" }"],
        ),
        (
            "dates",
            log_of("t,q", |t| format!("2024-05-01T12:00:{t:02},0.1")),
            &["line 2, column `t`", "a date or a time of day", "write stamps in seconds", "39 more of this kind"],
        ),
        ("doubled time", log_of("t,t,q", |t| format!("{t},{t},0.1")), &["column `t`", "twice", "cells 1 and 2"]),
        ("doubled angle", log_of("t,q,q", |t| format!("{t},0.1,0.1")), &["column `q`", "twice", "rename or delete"]),
        ("doubled drive", log_of("t,q,drive,drive", |t| format!("{t},0.1,0,0")), &["`drive`", "twice"]),
        ("comment before the header", log_of("# swing 3\nt,q", swing), &["line 1", "comment sign of `# swing 3`"]),
        ("commented header", log_of("# t,q", swing), &["column `t`", "remove the comment sign of `# t`"]),
        ("semicolons", log_of("t;q", |t| format!("{t};0.1")), &["line 1", "semicolons", "expected commas"]),
        ("semicolons and decimal commas", log_of("t;q", |_| "0,1;0,2".into()), &["semicolons", "`.` as decimal mark"]),
        ("tabs", log_of("t\tq", |t| format!("{t}\t0.1")), &["line 1", "tabs", "expected commas"]),
        ("blanks", log_of("t q", |t| format!("{t} 0.1")), &["line 1", "blanks", "expected commas"]),
        (
            "decimal commas",
            log_of("t,q", |t| format!("0,00{t},0,1")),
            &["line 2", "4 cells, expected 2", "`0.5`, not `0,5`"],
        ),
        ("quoted decimal comma", log_with(5, "0.024,\"0,47\",0"), &["line 5, column `q`", "decimal comma", "`0.47`"]),
        ("text in a cell", log_with(12, "0.080,abc,0"), &["line 12, column `q`", "`abc`", "number [rad]", "^^^"]),
        ("units under the header", log_with(2, "s,rad,-"), &["line 2, column `t`", "`s`", "holds units, delete it"]),
        ("a unit in the cell", log_with(9, "0.056,0.44 rad,0"), &["line 9, column `q`", "`0.44 rad`", "number [rad]"]),
        ("typographic minus", log_with(9, "0.056,\u{2212}0.44,0"), &["line 9, column `q`", "typographic minus"]),
        ("empty cell", log_with(7, "0.040,,0"), &["line 7, column `q`", "empty", "delete the row or fill"]),
        ("blank cell", log_with(7, "0.040,  ,0"), &["line 7, column `q`", "empty"]),
        ("NaN", log_with(20, "0.144,NaN,0"), &["line 20, column `q`", "`NaN`", "finite"]),
        ("infinity", log_with(20, "0.144,-inf,0"), &["line 20, column `q`", "`-inf`", "finite"]),
        ("a number beyond all numbers", log_with(20, "0.144,1e999,0"), &["line 20, column `q`", "finite"]),
        ("missing cell", log_with(8, "0.048,0.44"), &["line 8", "2 cells, expected 3", "cut off"]),
        ("extra cell", log_with(8, "0.048,0.44,0,7"), &["line 8", "4 cells, expected 3"]),
        ("comma at the end", log_with(8, "0.048,0.44,0,"), &["line 8", "4 cells, expected 3", "remove the comma"]),
        (
            "another separator in a row",
            log_with(8, "0.048;0.44;0"),
            &["line 8", "1 cells, expected 3", "not separated by commas"],
        ),
        ("recording cut off", log_with(41, "0.3"), &["line 41", "1 cells, expected 3", "cut off"]),
        (
            "time repeats",
            log_with(6, "0.024,0.46,0"),
            &["line 6, column `t`", "repeats", "(line 5)", "delete the doubled"],
        ),
        ("time runs back", log_with(6, "0.010,0.46,0"), &["line 6, column `t`", "runs back", "sort the samples"]),
        ("drive of 2", log_with(10, "0.064,0.42,2"), &["line 10, column `drive`", "`2`", "expected 0"]),
        ("drive in words", log_with(10, "0.064,0.42,true"), &["line 10, column `drive`", "`true`", "or 1"]),
        (
            "gap of two minutes",
            log_with(41, "120.0,0.1,0"),
            &["line 41, column `t`", "lines 40 and 41", "split the log"],
        ),
        (
            "absurd torque",
            log_of("t,q,tau", |t| format!("{},0.1,3e7", t * 0.008)),
            &["line 2, column `tau`", "another unit"],
        ),
        ("absurd angle", log_with(15, "0.104,1e30,0"), &["line 15, column `q`", "`1e30`", "at most"]),
        (
            "degrees",
            log_of("t,q", |t| format!("{},{}", t * 0.008, 40.5 - t)),
            &["line 2, column `q`", "40.5", "degrees", "pi/180"],
        ),
        (
            "small swing in degrees",
            log_of("t,q", |t| format!("{},{}", t * 0.008, 10.0 * (t * 0.1).cos())),
            &["column `q`", "degrees"],
        ),
        (
            "encoder counts",
            log_of("t,q", |t| format!("{},{}", t * 0.008, 2048.0 + 10.0 * t)),
            &["line 41, column `q`", "counts"],
        ),
        (
            "setpoint in degrees",
            log_of("t,q,q_ref", |t| format!("{},0.5,30", t * 0.008)),
            &["column `q_ref`", "degrees", "radians"],
        ),
        (
            "small setpoint in degrees",
            log_of("t,q,q_ref", |t| format!("{},0.1,6", t * 0.008)),
            &["column `q_ref`", "degrees"],
        ),
        (
            "milliseconds",
            log_of("t,q", |t| format!("{},0.1", t * 8.0)),
            &["line 2, column `t`", "milliseconds", "seconds"],
        ),
        (
            "epoch in microseconds",
            log_of("t,q", |t| format!("{},0.1", 1.7e15 + t * 8000.0)),
            &["column `t`", "microseconds"],
        ),
        ("UTF-16", utf16("t,q\r\n0.0,0.1\r\n0.1,0.2\r\n", true), &["line 1", "UTF-16", "CSV UTF-8"]),
        ("UTF-16 without mark", utf16("t,q\r\n0.0,0.1\r\n0.1,0.2\r\n", false), &["line 1", "UTF-16"]),
        ("Latin-1 header", b"t,q,winkel [\xB0]\n0,0.1,5\n".to_vec(), &["line 1", "0xb0", "UTF-8"]),
        (
            "Latin-1 note",
            b"t,q,note\r\n0,0.1,a\r\n0.1,0.1,gr\xFC\xDF\r\n".to_vec(),
            &["line 3, column `note`", "0xfc", "save the file as UTF-8"],
        ),
        ("a spreadsheet", b"PK\x03\x04rest".to_vec(), &["spreadsheet", "exported as CSV"]),
        ("a gzip file", b"\x1F\x8B\x08rest".to_vec(), &["gzip", "gunzip"]),
        ("a binary file", [&b"t,q\n0,0.1,\x00"[..], &[7; 50]].concat(), &["binary"]),
        (
            "several joints",
            log_of("t,lf1.q,rr3.q", |t| format!("{t},0.1,0.1")),
            &["line 1", "several joints", "`lf1`, `rr3`"],
        ),
        (
            "line counted after blank lines",
            b"t,q\r\n\r\n\r\n0,0.1\r\n0.1,x\r\n".to_vec(),
            &["line 5, column `q`", "`x`"],
        ),
    ];
    let dir = tempfile::tempdir().unwrap();
    for (i, (what, bytes, parts)) in cases.iter().enumerate() {
        let name = format!("swing-{i}.csv");
        fs::write(dir.path().join(&name), bytes).unwrap();
        check(what, &name, read_log(&dir.path().join(&name)).err(), parts);
    }
}

#[test]
fn the_joint_that_is_not_in_the_log_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("walk.csv");
    fs::write(&path, log_of("t,lf1.q,lf2.q,lf2.drive", |t| format!("{},0.1,0.2,1", t * 0.008))).unwrap();
    check("no such joint", "walk.csv", read_joint_log(&path, Some("lf9")).err(), &["`lf9.q`", "`lf1`, `lf2`"]);
    let log = read_joint_log(&path, Some("lf2")).unwrap();
    assert_eq!((log.q_rad[0], log.drive.unwrap()[0]), (0.2, true));
    assert_eq!(log.ignored_columns, ["lf1.q"]);
    check("not there", "none.csv", read_log(&dir.path().join("none.csv")).err(), &["could not be read"]);
    check(
        "a folder, not there as a file",
        &dir.path().display().to_string(),
        read_log(dir.path()).err(),
        &["could not be read"],
    );
}

#[test]
fn what_is_only_untidy_is_accepted() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("untidy.csv");
    let text =
        "\u{feff}\" q \", note , t ,drive\r\n 0.5 ,a,1700000000.000, 1\r\n0.49,\"b,c\",1700000000.008,0.0\r\n\r\n";
    fs::write(&path, text).unwrap();
    let log = read_log(&path).unwrap();
    assert_eq!(log.q_rad, [0.5, 0.49]);
    assert_eq!(log.drive.unwrap(), [true, false]);
    assert_eq!(log.ignored_columns, ["note"]);
}

const STUDY: &str = r#"schema = 1
[joint]
name = "q1"
inertia = 9.0e-4
moment = 5.0e-3
coulomb = 0.001
viscous = 0.017
[sensor]
resolution = 0.006
period = 0.008
[motor]
kp = 5
kd = 0.05
[[log]]
file = "a.csv"
role = "fit"
drive = "off"
[[log]]
file = "b.csv"
role = "validate"
drive = "position"
motor = { kp = 7.0 }
[log.extra]
mass = 0.22
distance = 0.12
radius = 0.015
length = 0.03
"#;

fn study_folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("a.csv"), log_of("t,q", |t| format!("{},0.1", t * 0.008))).unwrap();
    fs::write(dir.path().join("b.csv"), log_of("t,q,q_ref", |t| format!("{},0.1,0.1", t * 0.008))).unwrap();
    dir
}

#[test]
fn the_good_study_is_read() {
    let dir = study_folder();
    let path = dir.path().join("study.toml");
    fs::write(&path, STUDY).unwrap();
    let study = read_study(&path).unwrap();
    assert_eq!((study.joint.gravity_m_s2, study.logs.len()), (9.81, 2));
    assert_eq!(study.motor.unwrap().kp_nm_rad, 5.0);
    assert_eq!(study.logs[1].motor.unwrap().kp_nm_rad, 7.0);
    assert_eq!(study.logs[1].motor.unwrap().kd_nm_s_rad, 0.05);
    assert_eq!(study.logs[1].extra.unwrap().mass_kg, 0.22);
    assert_eq!(read_study_logs(&study).unwrap().len(), 2);
}

#[test]
fn malformed_studies_are_refused_with_key_and_fix() {
    // what the user did, the text that was there, what is there now, and what the message has to say
    let cases: &[(&str, &str, &str, &[&str])] = &[
        ("no schema", "schema = 1\n", "", &["`schema` is missing", "schema = 1"]),
        ("schema of the future", "schema = 1", "schema = 2", &["line 1, key `schema`", "found 2", "expected 1"]),
        ("misspelt key", "inertia =", "intertia =", &["line 4", "intertia", "inertia"]),
        ("unknown table", "[sensor]", "[sensors]", &["line 8", "sensors"]),
        ("broken TOML", "name = \"q1\"", "name = \"q1", &["line 3", "^"]),
        ("number in quotes", "moment = 5.0e-3", "moment = \"5.0e-3\"", &["line 5", "string", "without quotes"]),
        ("decimal comma", "coulomb = 0.001", "coulomb = 0,001", &["line 6"]),
        ("no inertia", "inertia = 9.0e-4\n", "", &["`[joint] inertia` is missing", "above 0"]),
        ("no viscous", "viscous = 0.017\n", "", &["`[joint] viscous` is missing"]),
        ("no joint name", "name = \"q1\"\n", "", &["`[joint] name` is missing"]),
        (
            "inertia of zero",
            "inertia = 9.0e-4",
            "inertia = 0",
            &["line 4, key `[joint] inertia`", "found 0", "above 0"],
        ),
        ("inertia of nan", "inertia = 9.0e-4", "inertia = nan", &["key `[joint] inertia`", "NaN"]),
        ("inertia beyond reason", "inertia = 9.0e-4", "inertia = 2e4", &["key `[joint] inertia`", "below 1e4"]),
        (
            "negative moment",
            "moment = 5.0e-3",
            "moment = -5.0e-3",
            &["line 5, key `[joint] moment`", "-0.005", "not below 0"],
        ),
        ("negative friction", "coulomb = 0.001", "coulomb = -0.001", &["key `[joint] coulomb`", "not below 0"]),
        ("negative damping", "viscous = 0.017", "viscous = -1", &["key `[joint] viscous`", "not below 0"]),
        ("gravity with sign", "[sensor]", "gravity = -9.81\n[sensor]", &["key `[joint] gravity`", "without sign"]),
        ("rest in degrees", "[sensor]", "rest = 45\n[sensor]", &["key `[joint] rest`", "looks like degrees"]),
        ("resolution in degrees", "0.006", "0.6", &["key `[sensor] resolution`", "looks like degrees"]),
        (
            "period in milliseconds",
            "period = 0.008",
            "period = 8",
            &["key `[sensor] period`", "looks like milliseconds"],
        ),
        ("negative gain", "kd = 0.05", "kd = -0.05", &["key `[motor] kd`", "not below 0"]),
        ("no gain", "kp = 5\n", "", &["`[motor] kp` is missing"]),
        ("zero torque limit", "kd = 0.05", "kd = 0.05\ntorque_limit = 0", &["`[motor] torque_limit`", "above 0"]),
        (
            "speed limit alone",
            "kd = 0.05",
            "kd = 0.05\nspeed_limit = 5",
            &["`[motor] speed_limit`", "torque_limit beside it"],
        ),
        (
            "unknown hold",
            "kd = 0.05",
            "kd = 0.05\nhold = \"zoh\"",
            &["`[motor] hold`", "\"zoh\"", "\"step\" or \"linear\""],
        ),
        (
            "derivative of steps",
            "kd = 0.05",
            "kd = 0.05\nderivative = \"error\"",
            &["`[motor] derivative`", "hold = \"linear\""],
        ),
        (
            "negative belief",
            "[motor]",
            "[uncertain]\ngain = -0.1\n[motor]",
            &["line 12, key `[uncertain] gain`", "-0.1"],
        ),
        (
            "belief in percent",
            "[motor]",
            "[uncertain]\ngain = 15\n[motor]",
            &["`[uncertain] gain`", "0.1 is ten percent"],
        ),
        ("unknown belief", "[motor]", "[uncertain]\ngains = 0.1\n[motor]", &["line 12", "gains"]),
        ("a winding alone", "kd = 0.05", "kd = 0.05\nresistance = 2", &["`[motor] resistance`", "model = \"voltage\""]),
        (
            "no supply",
            "kd = 0.05",
            "kd = 0.05\nmodel = \"voltage\"\nkt = 1\nresistance = 2",
            &["`[motor] supply` is missing"],
        ),
        (
            "empty session",
            "drive = \"position\"",
            "drive = \"position\"\nsession = \"\"",
            &["`[[log]] 2 session`", "\"feb\""],
        ),
        (
            "current without kt",
            "drive = \"position\"",
            "drive = \"position\"\ntau_is = \"current\"",
            &["`[[log]] 2 kt` is missing"],
        ),
        ("single brackets", "[[log]]\nfile = \"b.csv\"", "[log]\nfile = \"b.csv\"", &["line 18", "log"]),
        ("log without file", "file = \"a.csv\"\n", "", &["`[[log]] 1 file` is missing"]),
        (
            "log not there",
            "\"a.csv\"",
            "\"c.csv\"",
            &["line 15, key `[[log]] 1 file`", "c.csv", "relative to the study"],
        ),
        ("a log twice", "\"b.csv\"", "\"./a.csv\"", &["key `[[log]] 2 file`", "also [[log]] 1"]),
        ("log without role", "role = \"fit\"\n", "", &["`[[log]] 1 role` is missing", "\"fit\" or \"validate\""]),
        (
            "unknown role",
            "\"fit\"",
            "\"train\"",
            &["line 16, key `[[log]] 1 role`", "\"train\"", "\"fit\" or \"validate\""],
        ),
        ("nothing to fit", "\"fit\"", "\"validate\"", &["at least one log with role = \"fit\""]),
        (
            "unknown drive",
            "\"position\"",
            "\"pos\"",
            &["key `[[log]] 2 drive`", "\"off\" or \"position\" or \"torque\""],
        ),
        ("negative override", "kp = 7.0", "kp = -7.0", &["key `[[log]] 2 motor.kp`", "-7", "not below 0"]),
        ("unknown override", "{ kp = 7.0 }", "{ kP = 7.0 }", &["line 22", "kP"]),
        (
            "mass in grams",
            "mass = 0.22",
            "mass = 220",
            &["key `[[log]] 2 extra.mass`", "found 220", "looks like grams"],
        ),
        (
            "distance in millimetres",
            "distance = 0.12",
            "distance = 120",
            &["`[[log]] 2 extra.distance`", "millimetres"],
        ),
        ("negative radius", "radius = 0.015", "radius = -0.015", &["`[[log]] 2 extra.radius`", "from 0"]),
        ("mass of nothing", "mass = 0.22\n", "", &["`[[log]] 2 extra.mass` is missing"]),
        ("a release in a study", "[sensor]", "[release]\ntime = 0.4\n[sensor]", &["key `[release]`", "sidecar"]),
        ("a robot study", "[joint]", "[robot]\nmodel = \"ers7\"\n[joint]", &["line 2", "robot study"]),
        ("no motor", "[motor]\nkp = 5\nkd = 0.05\n", "", &["`[[log]] 2 motor.kd` is missing"]),
    ];
    let dir = study_folder();
    let path = dir.path().join("study.toml");
    for (what, old, new, parts) in cases {
        assert!(STUDY.contains(old), "{what}");
        fs::write(&path, STUDY.replacen(old, new, 1)).unwrap();
        let what = if *what == "log not there" { "log not there" } else { what };
        check(what, "study.toml", read_study(&path).err(), parts);
    }
    let (top, _) = STUDY.split_once("[[log]]").unwrap();
    for (what, text, parts) in [
        ("no logs", top.to_owned(), &["`[[log]]` is missing", "at least one log"][..]),
        ("no joint", "schema = 1\n".to_owned(), &["`[joint]` is missing"]),
        (
            "no motor at all",
            STUDY.replace("motor = { kp = 7.0 }\n", "").replace("[motor]\nkp = 5\nkd = 0.05\n", ""),
            &["`[motor]` is missing", "[[log]] 2"],
        ),
    ] {
        fs::write(&path, text).unwrap();
        check(what, "study.toml", read_study(&path).err(), parts);
    }
    fs::write(&path, b"schema = 1 # \xE4\n").unwrap();
    check("Latin-1", "study.toml", read_study(&path).err(), &["line 1", "0xe4", "UTF-8"]);
    check("not there", "none.toml", read_study(&dir.path().join("none.toml")).err(), &["could not be read"]);
    let as_study = ["a.csv is a log, not a study", "write one with `aibo-fit init ", "a.csv`"];
    check("a log as study", "a.csv", read_study(&dir.path().join("a.csv")).err(), &as_study);
    check("a study as log", "study.toml", read_log(&path).err(), &["study.toml", "UTF-8"]);
}

/// Reads the study's logs after one of its log files was replaced.
fn logs_error(dir: &Path, study: &str, name: &str, log: &[u8]) -> Option<LogError> {
    let path = dir.join("study.toml");
    fs::write(&path, study).unwrap();
    fs::write(dir.join(name), log).unwrap();
    read_study_logs(&read_study(&path).unwrap()).err()
}

#[test]
fn logs_that_do_not_fit_their_study_are_refused() {
    let dir = study_folder();
    let plain = log_of("t,q,setpoint", |t| format!("{},0.1,0.1", t * 0.008));
    let error = logs_error(dir.path(), STUDY, "b.csv", &plain);
    check(
        "no setpoint",
        "b.csv",
        error,
        &["`q_ref`", "\"position\" in [[log]] 2", "study.toml", "`setpoint` looks like it"],
    );

    let torque = STUDY.replace("\"position\"", "\"torque\"");
    let error = logs_error(dir.path(), &torque, "b.csv", &plain);
    check("no torque", "b.csv", error, &["`tau`", "\"torque\" in [[log]] 2", "found `t`, `q`, `setpoint`"]);

    let fast = STUDY.replace("period = 0.008", "period = 0.0004");
    let slow = log_of("t,q", |t| format!("{},0.1", t * 0.4));
    let error = logs_error(dir.path(), &fast, "a.csv", &slow);
    check("milliseconds by the study", "a.csv", error, &["median step", "`[sensor] period` is 0.0004", "milliseconds"]);

    // the first log's fault comes first, whatever thread is faster
    let error = logs_error(dir.path(), STUDY, "a.csv", b"t,q\n");
    check("in order", "a.csv", error, &["no samples"]);
}

#[test]
fn sidecars_are_checked_like_studies() {
    let dir = study_folder();
    let (log, sidecar) = (dir.path().join("a.csv"), dir.path().join("a.toml"));
    assert_eq!(read_sidecar_for(&log).unwrap(), None);
    fs::write(&sidecar, "schema = 1\n[release]\ntime = 0.4\n").unwrap();
    let study = read_sidecar_for(&log).unwrap().unwrap();
    assert_eq!((study.joint.name.as_str(), study.joint.nominal, study.logs[0].path.clone()), ("a", None, log.clone()));
    for (what, text, parts) in [
        ("half a model", "schema = 1\n[joint]\ninertia = 1e-3\n", &["[joint] does not say moment (kg m)"][..]),
        ("another log", "schema = 1\n[[log]]\nfile = \"b.csv\"\n", &["`[[log]] 1 file`", "\"b.csv\"", "\"a.csv\""]),
        (
            "two logs",
            "schema = 1\n[[log]]\nfile = \"a.csv\"\n[[log]]\nfile = \"b.csv\"\n",
            &["`[[log]] 2 file`", "another name"],
        ),
        ("release in degrees", "schema = 1\n[release]\nangle = 54.0\n", &["`[release] angle`", "looks like degrees"]),
        ("robot", "schema = 1\n[robot]\nmodel = \"ers7\"\n", &["robot study"]),
    ] {
        fs::write(&sidecar, text).unwrap();
        check(what, "a.toml", read_sidecar_for(&log).err(), parts);
    }
}

#[test]
fn a_period_that_is_merely_different_is_no_error() {
    let dir = study_folder();
    let log = read_log(&dir.path().join("a.csv")).unwrap();
    for period in [0.002, 0.0079, 0.1] {
        let sensor = SensorSpec { resolution_rad: None, period_s: Some(period) };
        assert!(check_period(&log, &sensor).is_ok());
    }
}
