//! Logs in the formats that people have, written by those formats' own libraries (`tests/logs/make.py`), are read as what
//! they hold: readings and setpoints at their own stamps, in radians and seconds.

use aibo_fit::log::{
    Format, Log, LogError, McapTopic, RobotLog, Source, mcap_bytes, read_joint_log, read_robot_log, read_source,
};
use std::fs;
use std::path::{Path, PathBuf};

fn logs(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/logs").join(name)
}

/// What all of them hold: stamps, and of shoulder and elbow readings and setpoints.
fn arm() -> RobotLog {
    read_robot_log(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data/examples/arm/log0.csv")).unwrap()
}

fn source(name: &str) -> Source {
    read_source(&logs(name), &Default::default()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn joint(name: &str, joint: &str) -> Log {
    read_joint_log(&logs(name), Some(joint)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn near(found: &[f64], expected: impl IntoIterator<Item = f64>, within: f64, what: &str) {
    let expected: Vec<f64> = expected.into_iter().take(found.len()).collect();
    assert_eq!(found.len(), expected.len(), "{what}");
    for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= within, "{what}, sample {k}: {found}, expected {expected}");
    }
}

#[test]
fn every_format_holds_the_same_readings() {
    let arm = arm();
    for (name, format, samples, stride) in [
        ("bag", Format::Rosbag2, 60, 2),
        ("bag/bag.db3", Format::Rosbag2, 60, 2),
        ("arm.mcap", Format::Mcap, 501, 1),
        ("arm-json.mcap", Format::Mcap, 100, 1),
        ("lerobot-v2", Format::LeRobot, 250, 2),
        ("lerobot-v3", Format::LeRobot, 250, 2),
        ("lerobot-v3/data/chunk-000/file-000.parquet", Format::LeRobot, 250, 2),
        ("arm.npz", Format::Npz, 200, 1),
        ("plotjuggler.csv", Format::JointStateTable, 501, 1),
        ("echo.csv", Format::JointStateTable, 60, 1),
        ("long.csv", Format::JointStateTable, 60, 1),
        ("frame.csv", Format::JointStateTable, 60, 1),
        ("bag-messages", Format::Rosbag2, 60, 1),
        ("bag-messages/metadata.yaml", Format::Rosbag2, 60, 1),
        ("bag-files", Format::Rosbag2, 60, 1),
        ("bag-files/bag-files.db3.zstd", Format::Rosbag2, 60, 1),
        ("ros1.bag", Format::Rosbag1, 60, 1),
        ("ros1-bz2.bag", Format::Rosbag1, 60, 1),
        ("ros1-lz4.bag", Format::Rosbag1, 60, 1),
        ("turned.npz", Format::Npz, 60, 1),
    ] {
        let source = source(name);
        assert_eq!(source.format, format, "{name}");
        for (own, theirs) in [("shoulder", "arm/shoulder"), ("elbow", "arm/elbow")] {
            let q = source.ours(&format!("{own}.q")).unwrap_or_else(|| panic!("{name}: no {own}"));
            assert_eq!(q.values.len(), samples, "{name}");
            let of = &arm.joint(theirs).unwrap().q_rad;
            // Single precision and degrees keep six digits.
            near(&q.values, of.iter().copied().step_by(stride), 1e-6, &format!("{name} {own}"));
        }
        assert!(source.notes[0].contains(&format.to_string()), "{name}: {:?}", source.notes);
    }
}

#[test]
fn setpoints_keep_their_own_stamps() {
    let arm = arm();
    let asked = arm.joint("arm/elbow").unwrap().q_ref_rad.clone().unwrap();
    // Header stamps of the readings, receipt stamps of commands that have no header.
    let bag = joint("bag", "elbow");
    let own = bag.setpoints.expect("commands are stamped apart");
    near(&own.t_s, arm.t_s.iter().copied(), 1e-9, "bag: stamps");
    near(&own.values, asked.iter().copied(), 1e-12, "bag: setpoints");
    near(&bag.t_s, arm.t_s.iter().copied().step_by(2), 1e-9, "bag: stamps of readings");
    assert!(bag.notes.iter().any(|note| note.contains("taken at its receipt")), "{:?}", bag.notes);
    assert!(
        bag.notes.iter().any(|note| note.contains("q_ref of elbow, shoulder") && note.contains("guess")),
        "{:?}",
        bag.notes
    );

    let mcap = joint("arm.mcap", "elbow");
    near(mcap.q_ref_rad.as_ref().unwrap(), asked.iter().copied(), 1e-12, "mcap: setpoints");

    let plotted = joint("plotjuggler.csv", "elbow");
    near(plotted.q_ref_rad.as_ref().unwrap(), asked, 1e-6, "PlotJuggler: setpoints");
}

#[test]
fn a_controllers_state_is_what_was_asked_and_what_was_read() {
    let arm = arm();
    let of = |joint: &str| arm.joint(joint).unwrap();
    let asked = of("arm/elbow").q_ref_rad.clone().unwrap();
    // Its reference comes at half the rate of the readings, which are those of the other topic.
    let bag = joint("controller", "elbow");
    let own = bag.setpoints.expect("the controller is stamped apart");
    near(&own.values, asked.iter().copied().step_by(2), 1e-12, "controller: setpoints");
    near(&bag.q_rad, of("arm/elbow").q_rad.iter().copied().skip(4), 1e-12, "controller: readings that are numbers");
    for part in ["no position of finger", "4 messages with a position that is not a number are left out"] {
        assert!(bag.notes.iter().any(|note| note.contains(part)), "{part}: {:?}", bag.notes);
    }
    // PlotJuggler exports it without names, and with errors that are neither.
    let source = source("plotjuggler-controller.csv");
    assert_eq!(source.joints(), [Some("joint1"), Some("joint2")]);
    near(&source.ours("joint2.q").unwrap().values, of("arm/elbow").q_rad.iter().copied(), 1e-9, "plotted");
    near(&source.ours("joint2.q_ref").unwrap().values, asked, 1e-9, "plotted setpoints");
    assert!((source.clocks[0][1] - 0.01).abs() < 1e-6, "stamps of the header: {:?}", &source.clocks[0][..3]);
}

#[test]
fn a_command_of_one_number_is_the_joints_that_its_topic_is_named_after() {
    let arm = arm();
    for name in ["ros1.bag", "ros1-bz2.bag", "ros1-lz4.bag"] {
        let log = joint(name, "shoulder");
        let asked = arm.joint("arm/shoulder").unwrap().q_ref_rad.clone().unwrap();
        near(log.q_ref_rad.as_ref().unwrap(), asked, 1e-12, name);
        assert!(log.notes.iter().any(|note| note.contains("by the topic's name (a guess)")), "{:?}", log.notes);
    }
}

#[test]
fn one_array_is_read_by_its_fields_or_by_what_columns_says_of_it() {
    let arm = arm();
    let elbow = arm.joint("arm/elbow").unwrap();
    let fields = joint("fields.npy", "joint2");
    near(&fields.q_rad, elbow.q_rad.iter().copied(), 1e-6, "fields: single precision");
    near(fields.q_ref_rad.as_ref().unwrap(), elbow.q_ref_rad.clone().unwrap(), 1e-12, "fields: setpoints");
    // Columns without names are an error that says what would read them.
    let error = read_source(&logs("columns.npy"), &Default::default()).unwrap_err();
    let LogError::Defects { mend, .. } = &error else { panic!("{error}") };
    for line in ["t = { name = \"[:, 0]\" }", "q = { name = \"[:, 1]\" }", "q_ref = { name = \"[:, 2]\" }"] {
        assert!(error.to_string().contains(line), "`{line}` is not in\n{error}");
    }
    let columns = read_source(&logs("columns.npy"), mend).unwrap();
    near(&columns.ours("q").unwrap().values, elbow.q_rad.iter().copied(), 1e-12, "columns");
    near(&columns.clocks[0], arm.t_s.iter().copied(), 1e-12, "columns: stamps");
}

#[test]
fn datasets_are_read_in_degrees_with_a_hole_between_episodes() {
    for name in ["lerobot-v2", "lerobot-v3"] {
        let log = joint(name, "elbow");
        assert!(
            // Half a frame beyond a second: no frame is lost.
            (log.t_s[149] - 2.98).abs() < 1e-9 && (log.t_s[150] - 3.99).abs() < 1e-9,
            "{name}: {:?}",
            &log.t_s[148..152]
        );
        assert!(log.setpoints.is_none() && log.q_ref_rad.is_some());
        let source = source(name);
        // 100 percent are read as 100 degrees until [columns] knows better.
        let grip = &source.ours("gripper.q").unwrap().values;
        assert!((grip[0] - 50_f64.to_radians()).abs() < 1e-5, "{name}: {}", grip[0]);
        assert!(source.notes.iter().any(|note| note.contains("2 episodes")), "{:?}", source.notes);
        assert!(source.notes.iter().any(|note| note.contains("degrees")), "{:?}", source.notes);
    }
    let one = source("lerobot-v2/data/chunk-000/episode_000001.parquet");
    assert_eq!(one.ours("elbow.q").unwrap().values.len(), 100);
}

#[test]
fn a_servo_on_a_bench_is_one_joint() {
    let log = read_joint_log(&logs("bam.json"), None).unwrap();
    assert_eq!(log.drive.as_ref().map(|on| (on[79], on[80])), Some((true, false)));
    assert!(log.notes.iter().any(|note| note.contains("motor xl330, kp 100, mass 0.49")), "{:?}", log.notes);
}

#[test]
fn real_folders_and_bags_are_read() {
    let Some(real) = std::env::var_os("AIBO_FIT_SHARED").map(|path| Path::new(&path).join("real")) else {
        eprintln!("AIBO_FIT_SHARED is not set: real logs are not read");
        return;
    };
    let sage = read_robot_log(&real.join("so101/raw/step_response")).unwrap();
    assert_eq!((sage.len(), sage.joints.len()), (6000, 6));
    assert!((sage.t_s[1] - 0.020080609).abs() < 1e-8);
    let csv = read_robot_log(&real.join("so101/study/step_response.csv")).unwrap();
    let elbow = sage.joint("Elbow").unwrap();
    near(&elbow.q_rad[..2000], csv.joint("elbow_flex").unwrap().q_rad[..2000].iter().copied(), 1e-6, "Elbow");
    near(
        &elbow.q_ref_rad.as_ref().unwrap()[..2000],
        csv.joint("elbow_flex").unwrap().q_ref_rad.as_ref().unwrap()[..2000].iter().copied(),
        1e-6,
        "setpoint",
    );
    let ur10 = read_robot_log(&real.join("rosbag2/ur10_exciting_trajectory.db3")).unwrap();
    assert_eq!((ur10.len(), ur10.joints.len()), (3441, 6));
    assert!((ur10.joint("elbow_joint").unwrap().q_rad[0] - 1.6689).abs() < 1e-4);
    let most = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    assert!((most(ur10.joint("shoulder_lift_joint").unwrap().tau_nm.as_ref().unwrap()) - 143.4).abs() < 0.1);
    let panda = read_robot_log(&real.join("rosbag2/panda_exciting_trajectory.db3")).unwrap();
    assert_eq!((panda.len(), panda.joints.len()), (727, 7));
    assert!((panda.t_s[1] - 0.0333).abs() < 1e-3, "{:?}", &panda.t_s[..3]);
}

/// `AIBO_FIT_TIME_LOG=FILE`: any file of a million rows, timed; without it, one of each format that can be made here.
#[test]
#[ignore = "writes files of 100 MB"]
fn a_million_rows_of_any_format_are_read_within_two_seconds() {
    let timed = |path: &Path| {
        let start = std::time::Instant::now();
        let source = read_source(path, &Default::default()).unwrap();
        let (seconds, samples) = (start.elapsed().as_secs_f64(), source.clocks.iter().map(Vec::len).max());
        let most = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let most = most.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("").to_owned();
        eprintln!("{}: {seconds:.2} s, {samples:?} samples, {most}", path.display());
        assert!(seconds < 2.0, "{}: {seconds} s", path.display());
    };
    if let Some(path) = std::env::var_os("AIBO_FIT_TIME_LOG") {
        return timed(Path::new(&path));
    }
    let dir = tempfile::tempdir().unwrap();
    let t_s: Vec<f64> = (0..1_000_000).map(|k| 0.001 * f64::from(k)).collect();
    let q: Vec<Vec<f64>> = (0..6).map(|j| t_s.iter().map(|t| (t + f64::from(j)).sin()).collect()).collect();
    let joints = (0..6).map(|j| format!("joint_{j}")).collect();
    let topic = McapTopic { name: "/joint_states".into(), joints, t_s, position_rad: q, ..McapTopic::default() };
    fs::write(dir.path().join("a.mcap"), mcap_bytes(std::slice::from_ref(&topic))).unwrap();
    timed(&dir.path().join("a.mcap"));
    let mut csv = "t,joint.q,joint.q_ref\n".to_owned();
    for (t, q) in topic.t_s.iter().zip(&topic.position_rad[0]) {
        csv += &format!("{t:.3},{q:.6},{q:.6}\n");
    }
    fs::write(dir.path().join("a.csv"), csv).unwrap();
    timed(&dir.path().join("a.csv"));
}
