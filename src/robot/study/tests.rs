use super::*;
use crate::log::{BaseColumns, FloorSpec, RobotSensorSpec};
use crate::robot::simulate::PositionSensor;
use crate::robot::simulate::log_csv;
use approx::assert_relative_eq;

fn study(scenario: RobotScenario) -> RobotStudy {
    RobotStudy {
        file: "study.toml".into(),
        model: "ers7".into(),
        model_path: None,
        described: None,
        scenario,
        drop_height_m: 0.02,
        friction: LegFrictionSpec { coulomb_nm: Some([0.001, 0.009, 0.010]), viscous_nm_s_rad: None },
        control: ControlSpec {
            gains: [("q1".into(), [6.0, 0.0, 0.4]), ("rr1".into(), [7.0, 0.0, 0.4])].into(),
            ..ControlSpec::default()
        },
        floor: FloorSpec { static_friction: Some(0.9), ..FloorSpec::default() },
        sensor: RobotSensorSpec::default(),
        uncertain: crate::log::Uncertain::default(),
        columns: crate::log::Columns::default(),
        logs: Vec::new(),
    }
}

/// A log in which every joint of a leg is asked to stand at an angle.
fn log(joints: &[&str], angle_rad: f64) -> RobotLog {
    let t_s: Vec<f64> = (0..=250).map(|k| f64::from(k) * 0.008).collect();
    let joint = |name: &&str| JointColumns {
        name: (*name).to_owned(),
        q_rad: vec![angle_rad; t_s.len()],
        q_ref_rad: Some(vec![angle_rad; t_s.len()]),
        ..JointColumns::default()
    };
    let joints = joints.iter().map(joint).collect();
    RobotLog {
        file: "log.csv".into(),
        joints,
        base: None,
        acceleration_m_s2: None,
        ignored_columns: Vec::new(),
        notes: Vec::new(),
        t_s,
    }
}

const LEGS: [&str; 12] = ["lf1", "lf2", "lf3", "rf1", "rf2", "rf3", "lr1", "lr2", "lr3", "rr1", "rr2", "rr3"];

fn entry(release: Option<(&str, f64)>, extra: Option<ExtraMass>) -> RobotStudyLog {
    RobotStudyLog {
        file: "log.csv".into(),
        path: "log.csv".into(),
        role: crate::log::Role::Fit,
        release: release.map(|(joint, time_s)| RobotRelease { joint: joint.into(), time_s }),
        extra,
        forward: None,
    }
}

#[test]
fn the_study_s_numbers_override_the_robot_s() {
    let nominal = Nominal::of(&study(RobotScenario::Floor)).unwrap();
    let drive = |name: &str| nominal.joints.drive(nominal.model.joint(name).unwrap());
    assert_eq!(drive("lr2").chain.friction.coulomb_nm, 0.009);
    // Table 3.4 where the study says nothing.
    assert_eq!(drive("lr2").chain.friction.viscous_nm_s_rad, 0.019);
    let stiffness =
        |name: &str| drive(name).chain.motor.as_ref().unwrap().stiffness_and_damping(crate::joint::Driven::ByLaw).0;
    assert_eq!((stiffness("lf1"), stiffness("rr1"), stiffness("lf2")), (6.0, 7.0, 7.0));
    let floor = nominal.floor.as_ref().unwrap().parameters();
    assert_eq!((floor.static_friction, floor.coulomb), (0.9, 0.6));
}

#[test]
fn a_robot_on_the_floor_begins_at_its_setpoints_and_the_drop_height() {
    let nominal = Nominal::of(&study(RobotScenario::Floor)).unwrap();
    let mut log = log(&LEGS, 0.1);
    let yaw = Some(vec![0.3; log.len()]);
    log.base = Some(BaseColumns { yaw_rad: yaw, ..BaseColumns::default() });
    let scene = nominal.scene(&entry(None, None), &log).unwrap();
    let floor = nominal.floor.as_ref().unwrap();
    let on_m = floor.height_on_m(&mut Dynamics::new(&scene.model), &scene.start);
    assert_relative_eq!(scene.start.base_position_m.y - on_m, 0.02, epsilon = 1e-12);
    assert_eq!(scene.start.angle_rad[4], 0.1);
    assert_relative_eq!(scene.start.base_orientation.angle(), 0.3, epsilon = 1e-12);
    let answer = run(&nominal.scenario(&scene, 0.008), Method::default()).unwrap();
    assert!(answer.diverged.is_none() && answer.t_s.len() == 251);
}

#[test]
fn a_joint_that_is_let_go_falls_from_where_it_was_held_and_a_load_hangs_on_it() {
    let nominal = Nominal::of(&study(RobotScenario::Drop)).unwrap();
    // Only the leg that moves is needed.
    let log = log(&["rf1", "rf2", "rf3"], 0.4);
    let extra = ExtraMass { mass_kg: 0.22, distance_m: 0.12, radius_m: 0.015, length_m: 0.03 };
    let scene = nominal.scene(&entry(Some(("rf2", 0.5003)), Some(extra)), &log).unwrap();
    assert_relative_eq!(scene.model.total_mass_kg() - nominal.model.total_mass_kg(), 0.22, epsilon = 1e-12);
    let released = nominal.model.joint("rf2").unwrap();
    let answer = run(&nominal.scenario(&scene, 0.008), Method::default()).unwrap();
    let swung = &answer.angle_rad[released.index()];
    // Held with a droop until 0.5003 s, then it swings.
    assert!((swung[0] - 0.4).abs() < 0.05 && (swung[62] - swung[0]).abs() < 1e-3, "{} {}", swung[0], swung[62]);
    assert!((swung[125] - swung[0]).abs() > 0.1, "{}", swung[125]);
    let text = log_csv(&scene.model, &nominal.joints, &answer, PositionSensor::Ideal, 1);
    assert!(text.starts_with("t,lf1.q"));
}

#[test]
fn a_clamped_trunk_stands_as_the_log_says() {
    let nominal = Nominal::of(&study(RobotScenario::Air)).unwrap();
    let mut log = log(&LEGS, 0.1);
    let (roll, pitch, yaw) = (0.2, -0.5, 0.9);
    let column = |x: f64| Some(vec![x; 251]);
    let base = BaseColumns {
        roll_rad: column(roll),
        pitch_rad: column(pitch),
        yaw_rad: column(yaw),
        ..BaseColumns::default()
    };
    log.base = Some(base);
    let scene = nominal.scene(&entry(None, None), &log).unwrap();
    let answer = run(&nominal.scenario(&scene, 0.008), Method::default()).unwrap();
    let [r, p, y] = answer.base[0].roll_pitch_yaw_rad();
    assert_relative_eq!(r, roll, epsilon = 1e-12);
    assert_relative_eq!(p, pitch, epsilon = 1e-12);
    assert_relative_eq!(y, yaw, epsilon = 1e-12);
}

#[test]
fn what_does_not_fit_the_robot_is_one_error() {
    let on = |scenario, log: &RobotLog, entry: &RobotStudyLog| {
        Nominal::of(&study(scenario)).unwrap().scene(entry, log).unwrap_err().to_string()
    };
    let plain = entry(None, None);
    let air = RobotScenario::Air;
    assert!(on(air, &log(&["lf1", "wheel"], 0.0), &plain).starts_with("log.csv: ers7 has no joint wheel"));
    assert!(on(air, &log(&LEGS[..11], 0.0), &plain).contains("column `rr3.q` is missing"));
    let mut lacks = log(&LEGS, 0.0);
    lacks.joints[4].q_ref_rad = None;
    assert!(on(air, &lacks, &plain).contains("column `rf2.q_ref` is missing"));
    let drop = RobotScenario::Drop;
    assert!(
        on(drop, &log(&LEGS, 0.0), &entry(Some(("wheel", 0.5)), None))
            .contains("study.toml: released: ers7 has no joint")
    );
    assert!(on(drop, &log(&LEGS, 0.0), &entry(Some(("lf2", 9.5)), None)).contains("expected before the log's end"));
    let near = ExtraMass { mass_kg: 0.22, distance_m: 1e-3, radius_m: 0.0, length_m: 0.0 };
    assert!(
        Nominal::of(&study(drop)).unwrap().scene(&entry(Some(("lf2", 0.5)), Some(near)), &log(&LEGS, 0.0)).is_err()
    );
    let mut gains = study(air);
    gains.control.gains = [("q9".into(), [1.0; 3])].into();
    assert!(Nominal::of(&gains).err().unwrap().to_string().contains("study.toml: [control] gains.q9"));
}
