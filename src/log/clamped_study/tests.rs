use super::*;
use crate::log::LogError;

fn read(text: &str) -> Result<ClampedStudy, LogError> {
    let dir = tempfile::tempdir().unwrap();
    for file in ["a.csv", "b.csv"] {
        std::fs::write(dir.path().join(file), "t,x.q\n0,0\n1,0\n").unwrap();
    }
    let path = dir.path().join("study.toml");
    std::fs::write(&path, text).unwrap();
    read_clamped_study(&path)
}

const ROBOT: &str = "schema = 1\n[robot]\nmodel = \"arm.urdf\"\nscenario = \"fixed\"\n";
const TORQUE: &str = "drive = \"torque\"\npredict = \"torque\"\n";
const LOG: &str = "[[log]]\nfile = \"a.csv\"\nrole = \"fit\"\n";

#[test]
fn a_joints_own_beliefs_stand_over_those_of_all() {
    let joints = "[joints.default]\ncoulomb = 0.05\nkp = 17.8\n[joints.Elbow]\nkp = 16.0\n";
    let study = read(&format!("{ROBOT}gravity = [0.0, -9.81, 0.0]\n{joints}{LOG}")).unwrap();
    let elbow = study.of_joint("Elbow");
    assert_eq!((elbow.kp_nm_rad, elbow.coulomb_nm), (Some(16.0), Some(0.05)));
    assert_eq!(study.of_joint("Wrist").kp_nm_rad, Some(17.8));
    assert_eq!((study.gravity_m_s2, study.hold), (Some([0.0, -9.81, 0.0]), Hold::Step));
    assert_eq!(study.logs[0].drive, DriveMode::Position);
}

#[test]
fn each_fault_is_one_error_that_names_the_key() {
    for (text, expected) in [
        (format!("{ROBOT}gravity = [0.0]\n{LOG}"), "[robot] gravity"),
        (format!("{ROBOT}[joints.a]\nkp = -1.0\n{LOG}"), "[joints.a] kp"),
        (format!("{ROBOT}[joints.a]\nkq = 1.0\n{LOG}"), "kq"),
        (format!("{ROBOT}[joints.a]\nmodel = \"voltage\"\n{LOG}"), "[joints.a] kt"),
        (format!("{ROBOT}[control]\nderivative = \"error\"\n{LOG}"), "[control] derivative"),
        (format!("{ROBOT}{LOG}predict = \"torque\"\n"), "[[log]] 1 predict"),
        (format!("{ROBOT}{LOG}predict = \"speed\"\n"), "[[log]] 1 predict"),
        (format!("{ROBOT}{LOG}{TORQUE}[[log]]\nfile = \"b.csv\"\nrole = \"fit\"\n"), "[[log]] 2 predict"),
        (ROBOT.to_owned(), "[[log]]"),
        (format!("[robot]\nscenario = \"fixed\"\n{LOG}"), "schema"),
        (format!("schema = 1\n[robot]\nscenario = \"fixed\"\n{LOG}"), "[robot] model"),
    ] {
        let message = read(&text).unwrap_err().to_string();
        assert!(message.contains(expected), "`{expected}` is not in\n{message}");
    }
}

#[test]
fn torques_along_a_motion_are_asked_for_of_all_logs() {
    let study = read(&format!("{ROBOT}{LOG}{TORQUE}[[log]]\nfile = \"b.csv\"\nrole = \"validate\"\n{TORQUE}")).unwrap();
    assert_eq!(study.predict, Predict::Torque);
    assert_eq!(read(&format!("{ROBOT}{LOG}")).unwrap().predict, Predict::Motion);
}
