use super::*;
use crate::log::{LogError, read_study};
use std::fs;

const LOG: &str = "t,lf1.q\n0,0\n0.008,0\n";

fn read(text: &str) -> Result<RobotStudy, LogError> {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("a.csv"), LOG).unwrap();
    fs::write(dir.path().join("b.csv"), LOG).unwrap();
    let path = dir.path().join("study.toml");
    fs::write(&path, text).unwrap();
    read_robot_study(&path)
}

const FLOOR: &str = r#"
schema = 1
[robot]
model = "ers7"
scenario = "floor"
drop_height = 0.03
[friction]
coulomb = [0.001, 0.007, 0.010]
[control]
gains = { q1 = [5.0, 2.44e-4, 0.5], lf2 = [7, 0, 0.5] }
[floor]
static = 0.9
[sensor]
resolution = 0.006
period = 0.008
noise = 0.002
[[log]]
file = "a.csv"
role = "fit"
forward = 0.52
forward_from = 2.0
forward_to = 10.0
"#;

#[test]
fn a_study_of_a_walk_is_read() {
    let study = read(FLOOR).unwrap();
    assert_eq!((study.scenario, study.drop_height_m, study.model_path.clone()), (RobotScenario::Floor, 0.03, None));
    assert_eq!(study.friction.coulomb_nm, Some([0.001, 0.007, 0.010]));
    assert_eq!(study.friction.viscous_nm_s_rad, None);
    assert_eq!((study.control.hold, study.control.derivative), (Hold::Linear, Derivative::Error));
    assert_eq!(study.control.gains["lf2"], [7.0, 0.0, 0.5]);
    assert_eq!((study.floor.static_friction, study.floor.coulomb), (Some(0.9), None));
    assert_eq!((study.sensor.resolution_rad, study.sensor.noise_rad), (Some(0.006), Some(0.002)));
    assert_eq!(study.logs[0].forward, Some(Forward { distance_m: 0.52, from_s: 2.0, to_s: 10.0 }));
}

const DOG: &str = r#"
schema = 1
[robot]
model = "dog.xml"
scenario = "floor"
feet = { FL_foot = 0.022 }
[joints.default]
kp = 60.0
kd = 3.0
[joints.FL_calf]
coulomb = 0.3
[[log]]
file = "a.csv"
role = "fit"
"#;

#[test]
fn a_walk_of_a_robot_that_others_describe_is_read() {
    let study = read(DOG).unwrap();
    assert_eq!((study.control.hold, study.control.derivative), (Hold::Step, Derivative::Measurement));
    let described = study.described.unwrap();
    assert_eq!(described.feet_m["FL_foot"], 0.022);
    let (own, other) = (described.of_joint("FL_calf"), described.of_joint("FR_calf"));
    assert_eq!((own.kp_nm_rad, own.coulomb_nm), (Some(60.0), Some(0.3)));
    assert_eq!((other.kp_nm_rad, other.coulomb_nm), (Some(60.0), None));
}

#[test]
fn keys_of_other_robots_are_refused_where_they_stand() {
    let with = |text: &str| DOG.replace("kd = 3.0", &format!("kd = 3.0\n{text}"));
    let cases = [
        (format!("{FLOOR}[joints.default]\nkp = 60.0\n"), "[joints.default]", "URDF or MJCF"),
        (FLOOR.replace("drop_height", "feet = { a = 0.1 }\ndrop_height"), "[robot] feet.a", "URDF or MJCF"),
        (format!("{DOG}[friction]\ncoulomb = [1, 1, 1]\n"), "[friction]", "[joints.NAME]"),
        (with("ki = 1.0"), "[joints.default] ki", "[control] gains.NAME"),
        (with("model = \"voltage\""), "[joints.default] model", "scenario = \"fixed\""),
        (DOG.replace("0.022", "22"), "[robot] feet.FL_foot", "millimetres"),
        (with("[control]\nderivative = \"error\""), "[control] hold", "derivative = \"measurement\""),
    ];
    for (text, key, expected) in cases {
        let said = read(&text).unwrap_err().to_string();
        assert!(said.contains(key) && said.contains(expected), "{said}");
    }
}

#[test]
fn a_study_of_drops_is_read_and_its_robot_found_beside_it() {
    let study = read(
        "schema = 1\n[robot]\nmodel = \"my.toml\"\nscenario = \"drop\"\n[[log]]\nfile = \"a.csv\"\nrole = \"fit\"\n\
         released = \"lf2\"\nrelease_time = 0.5\n[log.extra]\nmass = 0.22\ndistance = 0.12\n",
    )
    .unwrap();
    assert!(study.model_path.unwrap().ends_with("my.toml"));
    assert_eq!(study.logs[0].release, Some(RobotRelease { joint: "lf2".into(), time_s: 0.5 }));
    assert_eq!(study.logs[0].extra.map(|extra| extra.mass_kg), Some(0.22));
}

#[test]
fn the_two_kinds_are_told_apart() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("study.toml");
    let kind = |text: &str| {
        fs::write(&path, text).unwrap();
        study_kind(&path).unwrap()
    };
    assert_eq!(kind(FLOOR), StudyKind::Robot);
    assert_eq!(kind("schema = 1\n[joint]\nname = \"q1\"\n"), StudyKind::Joint);
    assert_eq!(kind("schema = 1\n[robot]\nmodel = \n"), StudyKind::Robot);
    assert!(matches!(read_study(&path), Err(LogError::Toml { .. })));
    fs::write(&path, FLOOR).unwrap();
    assert!(matches!(read_study(&path), Err(LogError::RobotStudy { .. })));
}

#[test]
fn each_fault_is_one_error_that_names_the_key() {
    let swap = |from: &str, to: &str| {
        assert!(FLOOR.contains(from), "{from}");
        FLOOR.replace(from, to)
    };
    let drop =
        "schema = 1\n[robot]\nmodel = \"ers7\"\nscenario = \"drop\"\n[[log]]\nfile = \"a.csv\"\nrole = \"fit\"\n";
    for (text, expected) in [
        (swap("schema = 1", ""), "key `schema` is missing"),
        (swap("schema = 1", "schema = 2"), "key `schema`: found 2"),
        (swap("model = \"ers7\"", ""), "key `[robot] model` is missing"),
        (
            swap("\"floor\"", "\"flor\""),
            "key `[robot] scenario`: found \"flor\", expected \"air\", \"floor\" or \"drop\" for a robot that walks, \"fixed\"",
        ),
        (swap("\"floor\"", "\"air\""), "key `[robot] drop_height`: found it in scenario = \"air\""),
        (swap("drop_height = 0.03", "drop_height = 20"), "key `[robot] drop_height`: found 20"),
        (swap("[0.001, 0.007, 0.010]", "[0.001, 0.007]"), "key `[friction] coulomb`: found 2 numbers"),
        (swap("[0.001, 0.007, 0.010]", "[0.001, -0.007, 0.010]"), "key `[friction] coulomb`: found -0.007"),
        (swap("[7, 0, 0.5]", "[7, 0]"), "key `[control] gains.lf2`: found 2 numbers"),
        (swap("[control]", "[control]\nhold = \"step\""), "key `[control] hold`: found \"step\" with derivative"),
        (swap("static = 0.9", "stiffness = -1"), "key `[floor] stiffness`: found -1"),
        (swap("static = 0.9", "slope = 0.1"), "unknown field `slope`"),
        (swap("noise = 0.002", "noise = 2"), "key `[sensor] noise`: found 2"),
        (swap("forward_to = 10.0", ""), "key `[[log]] 1 forward_to` is missing"),
        (swap("forward_to = 10.0", "forward_to = 1"), "key `[[log]] 1 forward_to`: found 1"),
        (swap("forward_to = 10.0", "released = \"lf2\""), "key `[[log]] 1 released`: found it in scenario"),
        (swap("\"a.csv\"", "\"c.csv\""), "the log"),
        (swap("\"fit\"", "\"validate\""), "at least one log with role"),
        (format!("{FLOOR}[[log]]\nfile = \"./a.csv\"\nrole = \"fit\"\n"), "which is also [[log]] 1"),
        (format!("{drop}release_time = 0.5\n"), "key `[[log]] 1 released` is missing"),
        (format!("{drop}released = \"lf2\"\n"), "key `[[log]] 1 release_time` is missing"),
        (format!("{drop}[floor]\n"), "key `[floor]`: found it in scenario = \"drop\""),
        ("schema = 1\n[joint]\nname = \"q1\"\n".to_owned(), "this is a joint study"),
    ] {
        let message = read(&text).unwrap_err().to_string();
        assert!(message.contains(expected) && message.contains("study.toml"), "{expected}: {message}");
    }
}
