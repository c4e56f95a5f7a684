use super::*;
use crate::log::{EncoderSide, MotorModel, Spread, TauIs, Uncertain, VoltageMotor, read_robot_study, read_study_logs};

const TOP: &str = "schema = 1\n[joint]\nname = \"elbow\"\ninertia = 0.1\nmoment = 0.2\ncoulomb = 0.3\nviscous = 0.4\n";

/// Reads a study whose log has every column.
fn read(rest: &str) -> Result<Study, LogError> {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("a.csv"), "t,q,q_ref,tau\n0,0,0,0\n0.01,0,0,0\n").unwrap();
    let path = dir.path().join("study.toml");
    std::fs::write(&path, format!("{TOP}{rest}")).unwrap();
    read_study(&path)
}

fn with_motor(motor: &str, log: &str) -> Result<Study, LogError> {
    let entry = "[[log]]\nfile = \"a.csv\"\nrole = \"fit\"\ndrive = \"position\"\n";
    read(&format!("[motor]\nkp = 1.0\nkd = 0.0\n{motor}\n{entry}{log}\n"))
}

/// The error has to name every part.
fn refused(study: Result<Study, LogError>, parts: &[&str]) {
    let message = study.unwrap_err().to_string();
    for part in parts {
        assert!(message.contains(part), "`{part}` not in:\n{message}");
    }
}

#[test]
fn beliefs_are_numbers_or_tables_by_name_and_keep_their_defaults() {
    let believed = "[uncertain]\ninertia = 0.2\ngain = 0\nfriction = { coulomb = 0.3, viscous = 0.6 }\n\
                    torque = { default = 0.5, tau = 0 }\n";
    let u = with_motor(believed, "").unwrap().uncertain;
    assert_eq!((u.inertia, u.gain), (Spread::of_all(0.2), Spread::of_all(0.0)));
    assert_eq!((u.friction.of("coulomb"), u.friction.of("viscous"), u.friction.all), (0.3, 0.6, 0.5));
    assert_eq!((u.torque.of("tau"), u.torque.of("torque_limit")), (0.0, 0.5));
    assert_eq!(u.moment, Uncertain::default().moment);
    assert_eq!(with_motor("", "").unwrap().uncertain, Uncertain::default());
}

#[test]
fn a_log_under_two_spellings_is_one_log() {
    let entry = |file: &str| format!("[[log]]\nfile = \"{file}\"\nrole = \"fit\"\ndrive = \"off\"\n");
    for again in ["a.csv", "./a.csv", ".//a.csv"] {
        let parts = ["key `[[log]] 2 file`", "which is also [[log]] 1, expected every log once"];
        refused(read(&(entry("a.csv") + &entry(again))), &parts);
    }
}

#[cfg(unix)]
#[test]
fn a_link_to_a_log_is_the_log() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("a.csv"), "t\n").unwrap();
    std::os::unix::fs::symlink("a.csv", dir.path().join("b.csv")).unwrap();
    let path = dir.path().join("study.toml");
    let entry = |file: &str| format!("[[log]]\nfile = \"{file}\"\nrole = \"fit\"\n");
    let robot = "schema = 1\n[robot]\nmodel = \"ers7\"\nscenario = \"air\"\n";
    std::fs::write(&path, format!("{robot}{}{}", entry("a.csv"), entry("b.csv"))).unwrap();
    let message = read_robot_study(&path).unwrap_err().to_string();
    assert!(message.contains("found \"b.csv\", which is also [[log]] 1"), "{message}");
}

#[test]
fn beliefs_that_cannot_be_are_refused_by_key() {
    for (uncertain, parts) in [
        ("inertia = -0.1", &["key `[uncertain] inertia`", "-0.1", "from 0 (exact) to 10"][..]),
        ("inertia = 20", &["key `[uncertain] inertia`", "20", "to 10"]),
        ("gain = inf", &["key `[uncertain] gain`", "inf"]),
        ("gain = nan", &["key `[uncertain] gain`", "NaN"]),
        ("gain = \"0.1\"", &["key `[uncertain] gain`", "\"0.1\"", "relative standard deviation"]),
        ("gain = { kp = 11.0 }", &["key `[uncertain] gain.kp`", "11"]),
        ("gain = { kp = [1.0] }", &["key `[uncertain] gain.kp`", "[1.0]"]),
        ("friction = { colomb = 0.1 }", &["key `[uncertain] friction.colomb`", "coulomb, viscous"]),
        ("frict = 0.1", &["frict"]),
    ] {
        refused(with_motor(&format!("[uncertain]\n{uncertain}"), ""), parts);
    }
}

#[test]
fn a_robot_study_has_beliefs_by_any_name() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("a.csv"), "t\n").unwrap();
    let path = dir.path().join("study.toml");
    let study = |uncertain: &str| {
        let robot = "schema = 1\n[robot]\nmodel = \"ers7\"\nscenario = \"air\"\n";
        std::fs::write(&path, format!("{robot}[uncertain]\n{uncertain}\n[[log]]\nfile = \"a.csv\"\nrole = \"fit\"\n"))
            .unwrap();
        read_robot_study(&path)
    };
    assert_eq!(study("friction = { lf1 = 0.2 }").unwrap().uncertain.friction.of("lf1"), 0.2);
    assert!(study("floor = -1.0").unwrap_err().to_string().contains("`[uncertain] floor`"));
    assert!(study("flor = 1.0").unwrap_err().to_string().contains("flor"));
}

#[test]
fn a_motor_is_fed_by_voltage_and_a_log_may_have_another() {
    let voltage =
        "model = \"voltage\"\nkt = 1.5\nresistance = 2.0\nsupply = 12.0\nencoder = \"motor\"\narmature = 0.02";
    let of = |log: &str| with_motor(voltage, log).unwrap().logs[0].motor.unwrap();
    let plain = VoltageMotor { kt_nm_a: 1.5, resistance_ohm: 2.0, supply_v: 12.0, duty_limit: 1.0 };
    let motor = of("");
    assert_eq!((motor.model, motor.encoder), (MotorModel::Voltage(plain), EncoderSide::Motor));
    assert_eq!(motor.armature_kg_m2, 0.02);
    let own = of("motor = { supply = 9.0, duty_limit = 0.8, encoder = \"link\" }");
    let expected = VoltageMotor { supply_v: 9.0, duty_limit: 0.8, ..plain };
    assert_eq!((own.model, own.encoder), (MotorModel::Voltage(expected), EncoderSide::Link));
    assert_eq!(of("motor = { model = \"torque\" }").model, MotorModel::Torque);
    let usual = with_motor("", "").unwrap().motor.unwrap();
    assert_eq!((usual.model, usual.encoder, usual.armature_kg_m2), (MotorModel::Torque, EncoderSide::Link, 0.0));
}

#[test]
fn half_a_voltage_motor_is_refused_by_the_key_that_lacks_or_strays() {
    for (motor, parts) in [
        ("model = \"voltage\"\nresistance = 2.0\nsupply = 12.0", &["`[motor] kt` is missing", "voltage", "N m/A"][..]),
        ("model = \"voltage\"\nkt = 2.0\nsupply = 12.0", &["`[motor] resistance` is missing", "Ohm"]),
        ("model = \"voltage\"\nkt = 2.0\nresistance = 12.0", &["`[motor] supply` is missing", "[V]"]),
        ("kt = 2.0", &["key `[motor] kt`", "model = \"voltage\" (or tau_is = \"current\")"]),
        ("model = \"torque\"\nresistance = 2.0", &["key `[motor] resistance`", "model = \"voltage\""]),
        ("supply = 12.0", &["key `[motor] supply`", "model = \"voltage\""]),
        ("duty_limit = 0.5", &["key `[motor] duty_limit`", "model = \"voltage\""]),
        ("model = \"current\"", &["key `[motor] model`", "\"torque\" or \"voltage\""]),
        ("encoder = \"joint\"", &["key `[motor] encoder`", "\"link\" or \"motor\""]),
        ("armature = -1.0", &["key `[motor] armature`", "not below 0"]),
        ("gear = 30.0", &["key `[motor] gear`", "tau_is = \"current\""]),
    ] {
        refused(with_motor(motor, ""), parts);
    }
    let whole = "model = \"voltage\"\nkt = 2.0\nsupply = 12.0\nresistance = 3.0\nduty_limit = 1.5";
    refused(with_motor(whole, ""), &["key `[motor] duty_limit`", "at most 1"]);
}

#[test]
fn what_tau_is_comes_from_the_log_or_else_from_the_motor() {
    let of = |motor: &str, log: &str| with_motor(motor, log).unwrap().logs[0].tau_is;
    assert_eq!(of("", ""), None);
    assert_eq!(of("tau_is = \"commanded\"", ""), Some(TauIs::Commanded));
    assert_eq!(of("tau_is = \"commanded\"", "tau_is = \"applied\""), Some(TauIs::Applied));
    let current = |nm_per_a| Some(TauIs::Current { nm_per_a });
    assert_eq!(of("", "tau_is = \"current\"\nkt = 0.5\ngear = 30.0"), current(15.0));
    assert_eq!(of("tau_is = \"current\"\nkt = 0.5", ""), current(0.5));
    assert_eq!(of("tau_is = \"current\"\nkt = 0.5\ngear = 3.0", "kt = 0.4"), current(0.4 * 3.0));
    refused(with_motor("", "tau_is = \"current\""), &["`[[log]] 1 kt` is missing", "N m/A"]);
    refused(with_motor("tau_is = \"current\"", ""), &["`[motor] kt` is missing"]);
    refused(with_motor("", "kt = 0.4"), &["key `[[log]] 1 kt`", "tau_is = \"current\""]);
    refused(with_motor("", "tau_is = \"measured\""), &["`[[log]] 1 tau_is`", "\"applied\" or \"commanded\" or"]);
    let free = "[[log]]\nfile = \"a.csv\"\nrole = \"fit\"\ndrive = \"off\"\ntau_is = \"applied\"\n";
    refused(read(free), &["`[[log]] 1 tau_is`", "drive = \"position\" only"]);
}

#[test]
fn a_session_has_a_name() {
    assert_eq!(with_motor("", "session = \"feb\"").unwrap().logs[0].session.as_deref(), Some("feb"));
    refused(with_motor("", "session = \" \""), &["key `[[log]] 1 session`", "empty name"]);
}

#[test]
fn a_torque_without_its_sign_is_refused_where_the_study_says_what_it_is() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("study.toml");
    let logs = |tau_is: &str, lift_rad: f64, tau: fn(f64) -> f64| {
        let row = |k: u32| {
            let t = f64::from(k) * 0.01;
            let (q, q_ref) = ((3.0 * t - 0.3).sin(), (3.0 * t).sin() + lift_rad);
            format!("{t},{q},{q_ref},{}\n", tau(q_ref - q))
        };
        let rows: String = (0..600).map(row).collect();
        std::fs::write(dir.path().join("a.csv"), format!("t,q,q_ref,tau\n{rows}")).unwrap();
        let entry = "[motor]\nkp = 1.0\nkd = 0.0\n[[log]]\nfile = \"a.csv\"\nrole = \"fit\"\ndrive = \"position\"\n";
        std::fs::write(&path, format!("{TOP}{entry}{tau_is}")).unwrap();
        read_study_logs(&read_study(&path).unwrap()).map(|logs| logs.len())
    };
    let error = logs("tau_is = \"applied\"", 0.0, f64::abs).unwrap_err().to_string();
    assert!(error.contains("a.csv: column `tau`: no negative value") && error.contains("tau_is"), "{error}");
    assert_eq!(logs("tau_is = \"applied\"", 0.0, |pull| pull).unwrap(), 1);
    assert_eq!(logs("", 0.0, f64::abs).unwrap(), 1);
    // an arm that has to be held up all the time
    assert_eq!(logs("tau_is = \"applied\"", 0.5, f64::abs).unwrap(), 1);
}
