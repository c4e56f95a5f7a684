use super::*;
use crate::log::{
    Predict, StudyKind, read_clamped_study, read_clamped_study_logs, read_source, read_study, study_kind,
};
use std::fs;

/// 200 samples of two joints, with names and units of a user's own logger.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let mut text = "stamp_ms,elbow_angle_deg,elbow_target_deg\n".to_owned();
    for k in 0..200 {
        let asked = 40.0 * (0.1 * f64::from(k)).sin();
        text += &format!("{},{:.2},{asked:.4}\n", 10 * k, 40.0 * (0.1 * f64::from(k - 2)).sin());
    }
    fs::write(dir.path().join("log.csv"), text).unwrap();
    dir
}

/// The text with the keys that a user fills in.
fn filled(text: &str) -> String {
    ["inertia", "moment", "coulomb", "viscous", "kp", "kd"]
        .iter()
        .fold(text.to_owned(), |text, key| text.replace(&format!("# {key} = 0.0"), &format!("{key} = 0.01")))
}

#[test]
fn a_users_own_columns_are_guessed_and_the_study_reads_them() {
    let dir = folder();
    let draft = draft_study(&[dir.path().join("log.csv")], None, None, dir.path()).unwrap();
    for part in [
        "t = { name = \"stamp_ms\", unit = \"ms\" }",
        "q = { name = \"elbow_angle_deg\", unit = \"deg\" }",
        "q_ref = { name = \"elbow_target_deg\", unit = \"deg\" }",
        "file = \"log.csv\"",
        "drive = \"position\"",
        "period = 0.01 ",
        "# inertia = 0.0",
        "guess",
    ] {
        assert!(draft.text.contains(part), "`{part}` is not in\n{}", draft.text);
    }
    let study = dir.path().join("study.toml");
    fs::write(&study, &draft.text).unwrap();
    let missing = read_study(&study).unwrap_err().to_string();
    assert!(missing.contains("[joint] does not say inertia"), "{missing}");
    fs::write(&study, filled(&draft.text)).unwrap();
    let logs = crate::log::read_study_logs(&read_study(&study).unwrap()).unwrap();
    assert!((logs[0].t_s[1] - 0.01).abs() < 1e-12 && logs[0].q_rad.iter().all(|q| q.abs() < 0.7));
    assert!(draft.untold.iter().any(|sentence| sentence.contains("gains")), "{:?}", draft.untold);
}

const ARM: &str = r#"<robot name="arm"><link name="base"/>
<link name="a"><inertial><origin xyz="0 0 -0.1"/><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="b"><inertial><origin xyz="0 0 -0.1"/><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="arm/elbow" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="9" velocity="9"/></joint>
<joint name="gripper" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/><limit lower="-0.2" upper="1.8" effort="9" velocity="9"/></joint>
</robot>"#;

#[test]
fn joints_of_a_folder_become_the_robots() {
    let dir = tempfile::tempdir().unwrap();
    let take = dir.path().join("take");
    fs::create_dir(&take).unwrap();
    let rows = |at: &dyn Fn(i32) -> [f64; 3]| -> String {
        (0..100).map(|k| format!("X,{},\"{:?}\"\n", 20_000 * k, at(k))).collect()
    };
    let wave = |k: i32, late: i32| (0.1 * f64::from(k - late)).sin();
    let head = "type,timestamp,positions\n";
    fs::write(take.join("state_motor.csv"), format!("{head}{}", rows(&|k| [wave(k, 2), 0.5 + 0.4 * wave(k, 1), 0.1])))
        .unwrap();
    fs::write(take.join("control.csv"), format!("{head}{}", rows(&|k| [wave(k, 0), 0.5 + 0.4 * wave(k, 0), 0.1])))
        .unwrap();
    fs::write(take.join("joint_list.txt"), "Elbow\nGripper\nWheel\n").unwrap();
    fs::write(dir.path().join("arm.urdf"), ARM).unwrap();
    let draft = draft_study(std::slice::from_ref(&take), Some(&dir.path().join("arm.urdf")), None, dir.path()).unwrap();
    for part in [
        "model = \"arm.urdf\"",
        "file = \"take\"",
        "without = [\"Wheel\"]",
        "\"arm/elbow.q\" = { name = \"Elbow.positions\" }",
        // A range of 2 rad from -0.2 rad on.
        "\"gripper.q\" = { name = \"Gripper.positions\", unit = \"ticks\", per_rev = 3.141593, zero = 0.2 }",
        "period = 0.02 ",
    ] {
        assert!(
            draft.text.replace("gripper.q = ", "\"gripper.q\" = ").contains(part),
            "`{part}` is not in\n{}",
            draft.text
        );
    }
    let study = dir.path().join("study.toml");
    fs::write(&study, &draft.text).unwrap();
    assert_eq!(study_kind(&study).unwrap(), StudyKind::Clamped);
    let study = read_clamped_study(&study).unwrap();
    assert_eq!(study.without, ["Wheel"]);
    let logs = read_clamped_study_logs(&study).unwrap();
    let joints = logs[0].joints.iter().map(|joint| joint.name.as_str());
    assert_eq!(joints.collect::<Vec<_>>(), ["arm/elbow", "gripper", "Wheel"]);
    let gripper = logs[0].joint("gripper").unwrap();
    assert!((gripper.q_rad[1] - (2.0 * 0.5 - 0.2)).abs() < 1e-5, "{}", gripper.q_rad[1]);
    assert!(
        gripper.q_ref_rad.is_some() && draft.untold.iter().any(|sentence| sentence.contains("kp")),
        "{:?}",
        draft.untold
    );
}

#[test]
fn other_names_are_paired_from_the_base_on_however_the_file_is_ordered() {
    // The gripper first, as in the URDF of an SO-101.
    let (links, joints) = ARM.split_at(ARM.find("<joint").unwrap());
    let (elbow, gripper) = joints.split_at(joints.rfind("<joint").unwrap());
    let turned = format!("{links}{}{elbow}</robot>", gripper.trim_end().trim_end_matches("</robot>"));
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("arm.urdf"), turned).unwrap();
    let rows: String = (0..100)
        .map(|k| (f64::from(k), (0.1 * f64::from(k)).sin()))
        .fold(String::from("t,A.q,A.q_ref,B.q,B.q_ref\n"), |text, (k, q)| {
            text + &format!("{:?},{q:?},{q:?},{:?},{:?}\n", 0.02 * k, 0.5 * q, 0.5 * q)
        });
    let logs = ["one.csv", "two.csv"].map(|name| dir.path().join(name));
    logs.iter().for_each(|log| fs::write(log, &rows).unwrap());
    let draft = draft_study(&logs, Some(&dir.path().join("arm.urdf")), None, dir.path()).unwrap();
    assert!(draft.untold.iter().any(|told| told.contains("A is arm/elbow, B is gripper")), "{:?}", draft.untold);
    // Of several logs one may be held out, which the last says.
    assert_eq!(draft.text.matches("or \"validate\"").count(), 1, "{}", draft.text);
}

#[test]
fn of_a_single_long_log_the_last_part_may_be_held_out() {
    let row = |wave: &dyn Fn(i32) -> f64| format!("{},{}", wave(0), wave(3));
    let (short, _) = drafted(&table("t,q_ref,q", row), None);
    assert!(!short.text.contains("# to ="), "2 s are not worth parting: {}", short.text);
    let rows = (0..1000).map(|k| (0.01 * f64::from(k), (0.1 * f64::from(k)).sin()));
    let (long, _) = drafted(&rows.fold("t,q\n".to_owned(), |text, (t, q)| text + &format!("{t:.2},{q}\n")), None);
    assert!(long.text.contains("role = \"fit\"\n# to = 7.0 "), "{}", long.text);
}

/// 200 rows of a user's own logger, of waves that come late by so many samples.
fn table(header: &str, row: impl Fn(&dyn Fn(i32) -> f64) -> String) -> String {
    let rows = (0..200_i32)
        .map(|k| format!("{:.2},{}\n", 0.01 * f64::from(k), row(&|late| (0.1 * f64::from(k - late)).sin())));
    format!("{header}\n{}", rows.collect::<String>())
}

/// The draft of one log, of a robot where it is given, and the folder that has them.
fn drafted(log: &str, robot: Option<&str>) -> (Draft, tempfile::TempDir) {
    let dir = tempfile::tempdir().unwrap();
    let (file, model) = (dir.path().join("log.csv"), dir.path().join("arm.urdf"));
    fs::write(&file, log).unwrap();
    fs::write(&model, robot.unwrap_or("")).unwrap();
    let draft = draft_study(&[file], robot.map(|_| model.as_path()), None, dir.path()).unwrap();
    fs::write(dir.path().join("study.toml"), &draft.text).unwrap();
    (draft, dir)
}

fn tells(draft: &Draft, part: &str) -> bool {
    draft.untold.iter().any(|sentence| sentence.contains(part))
}

#[test]
fn columns_of_joints_that_have_other_names_stand_under_the_robots_alone() {
    let in_degrees = table("t,A1.q,A1.q_ref,A1.dq,A2.q,A2.q_ref", |wave| {
        let [q, q_ref] = [2, 0].map(|late| 40.0 * wave(late));
        format!("{q:.3},{q_ref:.3},0,{q:.3},{q_ref:.3}")
    });
    let (draft, dir) = drafted(&in_degrees, Some(ARM));
    for line in [
        "\"arm/elbow.q\" = { name = \"A1.q\", unit = \"deg\" }",
        "\"arm/elbow.q_ref\" = { name = \"A1.q_ref\", unit = \"deg\" }",
        "\"arm/elbow.dq\" = { name = \"A1.dq\", unit = \"deg\" }",
        "gripper.q\" = { name = \"A2.q\", unit = \"deg\" }",
    ] {
        assert!(draft.text.contains(line), "`{line}` is not in\n{}", draft.text);
    }
    assert!(!draft.text.contains("\n\"A1.") && !draft.text.contains("\n\"A2."), "{}", draft.text);
    let study = read_clamped_study(&dir.path().join("study.toml")).unwrap();
    let logs = read_clamped_study_logs(&study).unwrap();
    assert_eq!(logs[0].joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>(), ["arm/elbow", "gripper"]);
    assert!(logs[0].joints.iter().all(|joint| joint.q_rad.iter().all(|q| q.abs() < 0.7)));
    // As `convert --columns` reads it, speeds too.
    let source = read_source(&dir.path().join("log.csv"), &study.columns).unwrap();
    assert!(source.ours("arm/elbow.dq").is_some());
}

#[test]
fn friction_and_rotor_inertia_are_asked_for_where_the_description_has_none() {
    let log = table("t,elbow.q,elbow.q_ref,gripper.q,gripper.q_ref", |wave| {
        let [q, q_ref] = [2, 0].map(|late| 0.5 * wave(late));
        format!("{q:.4},{q_ref:.4},{q:.4},{q_ref:.4}")
    });
    let (draft, _) = drafted(&log, Some(ARM));
    assert_eq!(draft.to_fill, ["kp", "kd", "coulomb", "viscous", "armature"]);
    assert!(
        tells(&draft, "friction: the description has none") && tells(&draft, "rotor inertia"),
        "{:?}",
        draft.untold
    );
    let with_friction = ARM.replace("<axis", "<dynamics damping=\"0.1\" friction=\"0.1\"/><axis");
    let (draft, _) = drafted(&log, Some(with_friction.as_str()));
    assert_eq!(draft.to_fill, ["kp", "kd", "armature"]);
    assert!(!tells(&draft, "friction"), "{:?}", draft.untold);
}

/// One joint more, and the end of the arm.
const WRIST: &str = r#"<link name="c"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="wrist" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="9" velocity="9"/></joint>
</robot>"#;

/// The draft of a log of the elbow of this arm.
fn drafted_of_elbow(arm: &str) -> (Draft, tempfile::TempDir) {
    let log = table("t,elbow.q,elbow.q_ref", |wave| format!("{:.4},{:.4}", 0.5 * wave(2), 0.5 * wave(0)));
    drafted(&log, Some(arm))
}

#[test]
fn what_a_description_says_of_some_joints_is_asked_of_the_others_by_name() {
    let arm = ARM.replace("</robot>", WRIST).replacen("<axis", "<dynamics damping=\"0.1\" friction=\"0.1\"/><axis", 1);
    let (draft, dir) = drafted_of_elbow(&arm);
    let asked =
        "friction: the description has none of gripper, wrist; state coulomb and viscous under [joints.NAME] of each";
    assert!(tells(&draft, asked), "{:?}", draft.untold);
    assert!(tells(&draft, "gear ratio squared, under [joints.default]"), "{:?}", draft.untold);
    assert_eq!(draft.to_fill, ["kp", "kd", "coulomb", "viscous", "armature"]);
    let own = "# coulomb = 0.0        # N m\n# viscous = 0.0        # N m s/rad\n\n";
    for joint in ["gripper", "wrist"] {
        let its = format!("[joints.{joint}]   # the description does not have these\n{own}");
        assert!(draft.text.contains(&its), "`{its}` is not in\n{}", draft.text);
    }
    assert!(!draft.text.contains("[joints.\"arm/elbow\"]"), "{}", draft.text);
    read_clamped_study(&dir.path().join("study.toml")).unwrap();
}

#[test]
fn a_joint_that_slides_is_asked_for_forces() {
    let (draft, dir) =
        drafted_of_elbow(&ARM.replace("name=\"gripper\" type=\"revolute\"", "name=\"gripper\" type=\"prismatic\""));
    let its = "[joints.gripper]   # it slides: forces in N, ways in m\n# coulomb = 0.0        # N\n# viscous = 0.0        # N s/m\n\
               # armature = 0.0       # kg\n# kp = 0.0             # N/m\n# kd = 0.0             # N s/m\n# torque_limit = 0.0   # N\n";
    assert!(draft.text.contains(its), "`{its}` is not in\n{}", draft.text);
    let study = dir.path().join("study.toml");
    let (all, own) = draft.text.split_once("[joints.gripper]").unwrap();
    fs::write(&study, format!("{all}[joints.gripper]{}", filled(own))).unwrap();
    assert_eq!(read_clamped_study(&study).unwrap().of_joint("gripper").kp_nm_rad, Some(0.01));
}

#[test]
fn torques_without_setpoints_may_be_compared_instead_of_simulated() {
    let log = table("t,elbow.q,elbow.dq,elbow.tau,gripper.q,gripper.dq,gripper.tau", |wave| {
        let [q, tau] = [2, 0].map(|late| 0.5 * wave(late));
        format!("{q:.4},0,{tau:.4},{q:.4},0,{tau:.4}")
    });
    let (draft, dir) = drafted(&log, Some(ARM));
    assert!(draft.text.contains("drive = \"torque\"") && tells(&draft, "predict = \"torque\""), "{}", draft.text);
    let study = dir.path().join("study.toml");
    fs::write(&study, draft.text.replace("# predict = ", "predict = ")).unwrap();
    assert_eq!(read_clamped_study(&study).unwrap().predict, Predict::Torque);
}

#[test]
fn an_encoder_that_counts_from_somewhere_else_has_rest_to_be_filled_in() {
    let log = |from_rad: f64| {
        table("t,q,q_ref", move |wave| format!("{:.4},{:.4}", from_rad + 0.3 * wave(2), from_rad + 0.3 * wave(0)))
    };
    let (draft, _) = drafted(&log(3.2), None);
    assert_eq!(draft.to_fill, ["inertia", "moment", "coulomb", "viscous", "rest", "kp", "kd"]);
    assert!(tells(&draft, "readings stay from 2.90 to 3.50 rad"), "{:?}", draft.untold);
    let (draft, _) = drafted(&log(0.1), None);
    assert!(!draft.to_fill.contains(&"rest"), "{:?}", draft.to_fill);
    assert!(tells(&draft, "`gap` and `check` take 0 (`drop` and `simulate` estimate it)"), "{:?}", draft.untold);
    assert!(
        draft.text.contains("`drop` and `simulate` estimate it") && !draft.text.contains("assumed"),
        "{}",
        draft.text
    );
}

#[test]
fn a_current_in_counts_is_a_question() {
    let log = table("time,Present Position,Goal Position,Present Current", |wave| {
        let ticks = [2, 0].map(|late| (2048.0 + 500.0 * wave(late)).round());
        format!("{},{},{}", ticks[0], ticks[1], (29.0 * wave(1)).round())
    });
    let (draft, dir) = drafted(&log, None);
    for part in ["tau = { name = \"Present Current\" }", "# \"Present Current\": counts? 1 count is 1 mA on an XL330"] {
        assert!(draft.text.contains(part), "`{part}` is not in\n{}", draft.text);
    }
    assert!(tells(&draft, "the unit of \"Present Current\""), "{:?}", draft.untold);
    let study = dir.path().join("study.toml");
    fs::write(&study, filled(&draft.text)).unwrap();
    assert!(crate::log::read_study_logs(&read_study(&study).unwrap()).is_ok());
}

#[test]
fn what_a_sidecar_says_of_columns_stands_in_the_study() {
    let dir = tempfile::tempdir().unwrap();
    let log = table("zeit,winkel,soll", |wave| format!("{:.3},{:.3}", 40.0 * wave(2), 40.0 * wave(0)));
    let lines = "t = { name = \"zeit\" }\nq = { name = \"winkel\", unit = \"deg\", sign = -1 }\n\
                 q_ref = { name = \"soll\", unit = \"deg\", sign = -1 }\n";
    let [file, sidecar, study] = ["log.csv", "log.toml", "study.toml"].map(|name| dir.path().join(name));
    fs::write(&file, log).unwrap();
    fs::write(&sidecar, format!("schema = 1\n[columns]\n{lines}")).unwrap();
    let draft = draft_study(std::slice::from_ref(&file), None, None, dir.path()).unwrap();
    assert_eq!(draft.inputs, [file, sidecar]);
    assert!(draft.text.contains("as the log's sidecar says") && !draft.text.contains("guess: by"), "{}", draft.text);
    fs::write(&study, filled(&draft.text)).unwrap();
    let logs = crate::log::read_study_logs(&read_study(&study).unwrap()).unwrap();
    assert!((logs[0].q_rad[0] - 40f64.to_radians() * 0.2_f64.sin()).abs() < 1e-4, "{}", logs[0].q_rad[0]);
}

/// The draft of two logs with these headers and sidecars' `[columns]`.
fn drafted_of_two(logs: [(&str, &str); 2]) -> Result<Draft, DraftError> {
    let dir = tempfile::tempdir().unwrap();
    let paths = ["one", "two"].map(|name| dir.path().join(name).with_extension("csv"));
    for (path, (header, columns)) in paths.iter().zip(logs) {
        fs::write(path, table(header, |wave| format!("{:.4},{:.4}", 0.5 * wave(2), 0.5 * wave(0)))).unwrap();
        if !columns.is_empty() {
            fs::write(path.with_extension("toml"), format!("schema = 1\n[columns]\n{columns}")).unwrap();
        }
    }
    draft_study(&paths, None, None, dir.path())
}

#[test]
fn logs_whose_sidecars_differ_make_no_study() {
    let turned = "q = { name = \"q\", sign = -1, zero = 0.3 }\nq_ref = { name = \"q_ref\", sign = -1, zero = 0.3 }\n";
    let in_degrees = "q = { name = \"q\", unit = \"deg\" }\nq_ref = { name = \"q_ref\", unit = \"deg\" }\n";
    let later = "t = { name = \"t\", zero = 5.0 }\n";
    for (first, second, parts) in [
        (
            "",
            turned,
            ["two.csv: read with `q = { name = \"q\", sign = -1, zero = 0.3 }`", "with `q = { name = \"q\" }`"],
        ),
        (turned, "", ["one.csv: read with `q = ", "two.csv with `q = { name = \"q\" }`"]),
        (in_degrees, turned, ["one.csv: read with `q = { name = \"q\", unit = \"deg\" }`", "two.csv with `q = "]),
        (later, "", ["one.csv: read with `t = ", "two.csv with `t = { name = \"t\" }`"]),
    ] {
        let error = drafted_of_two([("t,q,q_ref", first), ("t,q,q_ref", second)]).unwrap_err();
        let said = error.to_string();
        assert!(matches!(error, DraftError::ColumnsDiffer { .. }), "{said}");
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    }
    for (first, second) in [(turned, turned), ("q = { name = \"q\", unit = \"rad\" }\n", "")] {
        assert!(drafted_of_two([("t,q,q_ref", first), ("t,q,q_ref", second)]).is_ok(), "{first}");
    }
}

#[test]
fn a_line_is_no_other_logs_that_has_our_own_names() {
    let own = "t = { name = \"zeit\" }\nq = { name = \"winkel\", unit = \"deg\" }\nq_ref = { name = \"soll\", unit = \"deg\" }\n";
    let error = drafted_of_two([("zeit,winkel,soll", own), ("t,q,q_ref", "")]).unwrap_err();
    assert!(matches!(error, DraftError::ColumnsDiffer { .. }), "{error}");
    let error = drafted_of_two([("t,winkel,soll", "q = { name = \"winkel\" }\n"), ("t,q,winkel", "")]).unwrap_err();
    assert!(error.to_string().contains("but ") && matches!(error, DraftError::ColumnsDiffer { .. }), "{error}");
}

#[test]
fn paths_are_relative_to_the_study() {
    assert_eq!(relative(Path::new("/home/a/logs/x.csv"), Path::new("/home/a/study")), "../logs/x.csv");
    assert_eq!(relative(Path::new("/home/a/x.csv"), Path::new("/home/a")), "x.csv");
    assert_eq!(relative(Path::new("/mnt/x.csv"), Path::new("/home/a")), "/mnt/x.csv");
    assert_eq!(relative(Path::new("/home/a/x.csv"), Path::new("/home/a/..")), "a/x.csv");
    assert_eq!(relative(Path::new("tests/x.csv"), Path::new("")), "tests/x.csv");
    assert_eq!(digits(0.020_083_44), "0.0200834");
}
