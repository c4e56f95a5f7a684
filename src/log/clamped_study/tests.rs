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
        (format!("{ROBOT}[joints.a]\nkt = 2.0\n{LOG}"), "[joints.a] kt"),
        (format!("{ROBOT}[joints.a]\ntau_is = \"current\"\n{LOG}"), "`[joints.a] kt` is missing"),
        (format!("{ROBOT}[joints.a]\ntau_is = \"applied\"\ngear = 9.0\n{LOG}"), "[joints.a] gear"),
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
fn currents_of_all_joints_become_torques_by_each_joints_own_constant() {
    let joints = "[joints.default]\ntau_is = \"current\"\nkt = 0.5\n[joints.Elbow]\nkt = 2.0\ngear = 3.0\n";
    let joints = format!("{joints}[joints.Wrist]\ntau_is = \"applied\"\n");
    let tau_is = |text: &str, joint: &str| read(text).map(|study| study.of_joint(joint).tau_is);
    let elbow_only = format!("{ROBOT}[joints.Elbow]\nkt = 2.0\ntau_is = \"current\"\n{LOG}");
    assert_eq!(tau_is(&elbow_only, "Elbow").unwrap(), Some(TauIs::Current { nm_per_a: 2.0 }));
    assert_eq!(tau_is(&elbow_only, "Wrist").unwrap(), None);
    let all = format!("{ROBOT}{joints}{LOG}");
    assert_eq!(tau_is(&all, "Elbow").unwrap(), Some(TauIs::Current { nm_per_a: 6.0 }));
    assert_eq!(tau_is(&all, "Wrist").unwrap(), Some(TauIs::Applied));
    assert_eq!(tau_is(&all, "Shoulder").unwrap(), Some(TauIs::Current { nm_per_a: 0.5 }));
}

/// What is said of all joints was checked as if it were the motor of one.
#[test]
fn what_all_joints_have_may_lack_what_each_joint_says_of_itself() {
    let of = |all: &str, own: &str| {
        read(&format!("{ROBOT}[joints.default]\n{all}\n[joints.Elbow]\n{own}\n{LOG}")).map(|study| {
            let elbow = study.of_joint("Elbow");
            (elbow.tau_is, elbow.model, study.all_lacks)
        })
    };
    let lacks = |lacks: &Option<String>, what: &str| lacks.as_ref().is_some_and(|lacks| lacks.contains(what));
    let (tau_is, _, common) = of("tau_is = \"current\"", "kt = 2.0").unwrap();
    assert_eq!(tau_is, Some(TauIs::Current { nm_per_a: 2.0 }));
    assert!(lacks(&common, "`[joints.default] kt` is missing"), "{common:?}");
    let (tau_is, _, common) = of("gear = 30.0", "kt = 0.1\ntau_is = \"current\"").unwrap();
    assert_eq!(tau_is, Some(TauIs::Current { nm_per_a: 0.1 * 30.0 }));
    assert!(lacks(&common, "[joints.default] gear"), "{common:?}");
    let (_, model, common) = of("model = \"voltage\"\nresistance = 3.0\nsupply = 12.0", "kt = 4.0").unwrap();
    assert!(matches!(model, Some(MotorModel::Voltage(motor)) if motor.kt_nm_a == 4.0), "{model:?}");
    assert!(lacks(&common, "`[joints.default] kt` is missing"), "{common:?}");
    assert_eq!(of("tau_is = \"current\"\nkt = 0.5", "gear = 2.0").unwrap().2, None);
}

#[test]
fn a_fault_of_what_all_joints_have_is_told_there_and_what_a_joint_lacks_on_the_joint() {
    for (all, own, expected) in [
        ("tau_is = \"amperes\"", "kt = 2.0", "`[joints.default] tau_is`: found \"amperes\""),
        ("tau_is = \"current\"\nkt = -1.0", "kt = 2.0", "`[joints.default] kt`: found -1"),
        ("model = \"voltage\"\nduty_limit = 2.0", "kt = 2.0", "`[joints.default] duty_limit`: found 2"),
        ("tau_is = \"current\"", "kp = 2.0", "`[joints.Elbow] kt` is missing"),
        ("gear = 30.0", "kt = 2.0", "`[joints.Elbow] kt`"),
    ] {
        let text = format!("{ROBOT}[joints.default]\n{all}\n[joints.Elbow]\n{own}\n{LOG}");
        let message = read(&text).unwrap_err().to_string();
        assert!(message.contains(expected), "`{expected}` is not in\n{message}");
    }
}

/// Amperes were once read as N m where torques drive the joints.
#[test]
fn what_a_torque_is_is_refused_where_no_log_is_driven_by_position() {
    let second = "[[log]]\nfile = \"b.csv\"\nrole = \"validate\"\n";
    for (joint, drives) in [("Elbow", "torque"), ("default", "torque"), ("Elbow", "off")] {
        let joints = format!("[joints.{joint}]\nkt = 2.0\ntau_is = \"current\"\n");
        let drives = format!("drive = \"{drives}\"\n");
        let message = read(&format!("{ROBOT}{joints}{LOG}{drives}{second}{drives}")).unwrap_err().to_string();
        let expected = format!("`[joints.{joint}] tau_is`: found \"current\" in a study without a log");
        assert!(message.contains(&expected), "`{expected}` is not in\n{message}");
        // Beside a log that setpoints drive it is said of that one.
        assert!(read(&format!("{ROBOT}{joints}{LOG}{drives}{second}")).is_ok());
    }
}

#[test]
fn a_joint_fed_by_voltage_may_have_a_constant_of_its_own() {
    let all = "[joints.default]\nmodel = \"voltage\"\nkt = 2.0\nresistance = 3.0\nsupply = 12.0\n";
    let study = read(&format!("{ROBOT}{all}[joints.Elbow]\nkt = 4.0\n{LOG}")).unwrap();
    let kt_nm_a = |joint: &str| match study.of_joint(joint).model {
        Some(MotorModel::Voltage(motor)) => motor.kt_nm_a,
        other => panic!("{other:?}"),
    };
    assert_eq!((kt_nm_a("Elbow"), kt_nm_a("Wrist")), (4.0, 2.0));
}

#[test]
fn torques_along_a_motion_are_asked_for_of_all_logs() {
    let study = read(&format!("{ROBOT}{LOG}{TORQUE}[[log]]\nfile = \"b.csv\"\nrole = \"validate\"\n{TORQUE}")).unwrap();
    assert_eq!(study.predict, Predict::Torque);
    assert_eq!(read(&format!("{ROBOT}{LOG}")).unwrap().predict, Predict::Motion);
}
