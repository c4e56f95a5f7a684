//! What `aibo-fit synth` promises: logs from a known truth, in which an effect changes what it should and nothing else, a
//! study that says nothing of it, and one clear error for what cannot be.

mod support;

use aibo_fit::log::{RobotLog, RobotScenario, read_robot_log, read_robot_study, read_robot_study_logs, read_study};
use aibo_fit::robot::Nominal;
use aibo_fit::robot::simulate::{Method, run};
use support::{everything_in, expect_code, json, make_study, root, run_in, stderr};

const AIR: &str = r#"
schema = 1
seed = 5
[robot]
model = "ers7"
scenario = "air"
[sensor]
period = 0.008
[truth]
step = 1e-3
[[log]]
file = "a.csv"
duration = 3.0
"#;

const FLOOR: &str = r#"
schema = 1
[robot]
model = "ers7"
scenario = "floor"
[truth]
step = 5e-4
[[log]]
file = "a.csv"
duration = 4.0
base = true
forward = [2.0, 4.0]
"#;

const DROP: &str = r#"
schema = 1
[robot]
model = "ers7"
scenario = "drop"
[sensor]
resolution = 0.006
[truth]
step = 1e-3
[[log]]
file = "a.csv"
released = "rf2"
angles = { rf2 = 0.9 }
duration = 2.0
gravity = [5.127562, -8.363266, 0.0]
"#;

fn log(text: &str) -> RobotLog {
    let folder = tempfile::tempdir().expect("a folder");
    make_study(folder.path(), text);
    read_robot_log(&folder.path().join("a.csv")).expect("a log")
}

fn largest_change(a: &RobotLog, b: &RobotLog, joint: &str) -> f64 {
    let (a, b) = (&a.joint(joint).expect("there").q_rad, &b.joint(joint).expect("there").q_rad);
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn same_spec_same_bytes_on_any_number_of_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let spec = root().join("data/examples/synth/weak-knees.toml");
    let spec = spec.to_str().expect("UTF-8");
    for (out, threads) in [("one", "1"), ("two", "2"), ("again", "2")] {
        let said = expect_code(folder.path(), &["synth", spec, "--out", out, "--threads", threads], 0);
        // `check` refuses the study of a walking robot.
        assert!(said.contains("aibo-fit gap") && !said.contains("aibo-fit check"), "{said}");
    }
    let read = |out: &str, file: &str| std::fs::read(folder.path().join(out).join(file)).expect("written");
    for file in ["study.toml", "trot.csv", "fast.csv"] {
        assert_eq!(read("one", file), read("two", file), "{file}");
        assert_eq!(read("again", file), read("two", file), "{file}");
    }
    expect_code(folder.path(), &["synth", spec, "--out", "other", "--seed", "8"], 0);
    assert_ne!(read("one", "trot.csv"), read("other", "trot.csv"));
    // The truth is beside the folder, not in it, and nothing in the folder hints at it.
    let truth = json(&folder.path().join("one-truth.json"));
    assert_eq!(truth["effects"][0]["id"], "torque_limit");
    assert_eq!(truth["effects"][0]["joints"], serde_json::json!(["lr3", "rr3"]));
    assert!((truth["friction"]["lf3"]["viscous"].as_f64().expect("a number") / 0.012 - 1.0).abs() < 0.03);
    assert_eq!(everything_in(&folder.path().join("one")).len(), 4);
    let study = String::from_utf8(read("one", "study.toml")).expect("UTF-8");
    assert!(!study.contains("truth") && !study.contains("torque_limit") && !study.contains("weak"), "{study}");
}

#[test]
fn the_study_is_read_back_and_the_believed_robot_follows_logs_without_an_effect() {
    for (text, scenario, within_rad) in [
        (AIR, RobotScenario::Air, 1e-4),
        // The clock of a log has six digits: where a step ends, and so how a foot meets the floor, differs by rounding.
        (FLOOR, RobotScenario::Floor, 0.015),
        (DROP, RobotScenario::Drop, 0.0035),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        make_study(folder.path(), text);
        let study = read_robot_study(&folder.path().join("study.toml")).expect("a study");
        assert_eq!(study.scenario, scenario);
        let logs = read_robot_study_logs(&study).expect("logs");
        let nominal = Nominal::of(&study).expect("a robot");
        let scene = nominal.scene(&study.logs[0], &logs[0]).expect("a scene");
        let answer = run(&nominal.scenario(&scene, 0.008), Method::Stiff { step_s: 5e-4 }).expect("a run");
        for joint in &logs[0].joints {
            let id = nominal.model.joint(&joint.name).expect("a joint");
            let worst = joint.q_rad.iter().zip(&logs[0].t_s).map(|(q, t)| (q - answer.angle_at_rad(id, *t)).abs());
            let worst = worst.fold(0.0, f64::max);
            assert!(worst <= within_rad, "{scenario:?} {}: {worst}", joint.name);
        }
        if scenario == RobotScenario::Floor {
            let forward = study.logs[0].forward.expect("stated");
            let z = logs[0].base.as_ref().and_then(|base| base.z_m.clone()).expect("there");
            assert!((forward.distance_m - (z[250] - z[500])).abs() <= 5.1e-4 && forward.distance_m > 0.05);
        }
    }
}

#[test]
fn an_effect_changes_its_joint_and_no_other() {
    let plain = log(AIR);
    let weak = log(&format!("{AIR}[[effect]]\nid = \"torque_limit\"\njoints = \"rr2\"\ntau_max = 0.03\n"));
    assert!(largest_change(&plain, &weak, "rr2") > 0.02);
    for joint in ["lf2", "rf2", "lr2", "neck_pan"] {
        // The trunk is clamped: no other leg can know of it.
        assert!(largest_change(&plain, &weak, joint) < 1e-6, "{joint}");
    }
    let late = log(&format!("{AIR}[[effect]]\nid = \"delay\"\njoints = [\"q1\"]\nT = 0.02\n"));
    for joint in ["lf1", "rr1"] {
        assert!(largest_change(&plain, &late, joint) > 0.01, "{joint}");
    }
}

#[test]
fn payload_friction_and_slope_change_the_walk() {
    let swap = |truth: &str| log(&FLOOR.replace("step = 5e-4", &format!("step = 5e-4\n{truth}")));
    let end = |log: &RobotLog| {
        let base = log.base.as_ref().expect("there");
        (*base.y_m.as_ref().expect("y").last().expect("a sample"), *base.z_m.as_ref().expect("z").last().expect("one"))
    };
    let plain = end(&log(FLOOR));
    let heavy = end(&swap("payload = [{ mass = 0.5, at = [0.0, 0.03, 0.0] }]"));
    assert!(heavy.0 < plain.0 - 1e-4, "{} {}", heavy.0, plain.0);
    let uphill = end(&swap("slope = 0.1"));
    assert!(uphill.0 > plain.0 + 5e-3, "{} {}", uphill.0, plain.0);
    let slippery = end(&swap("floor = { static = 0.1, coulomb = 0.05 }"));
    assert!((slippery.1 - plain.1).abs() > 1e-3, "{} {}", slippery.1, plain.1);
}

#[test]
fn a_joint_on_the_bench_makes_a_joint_study_that_drop_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let spec = root().join("data/examples/synth/bench.toml");
    let said = expect_code(folder.path(), &["synth", spec.to_str().expect("UTF-8"), "--out", "bench"], 0);
    assert!(said.contains("  aibo-fit check bench/study.toml\n  aibo-fit gap bench/study.toml\n"), "{said}");
    let study = read_study(&folder.path().join("bench/study.toml")).expect("a joint study");
    assert_eq!((study.joint.name.as_str(), study.logs.len()), ("q2", 3));
    assert_eq!(study.logs[1].extra.map(|extra| extra.mass_kg), Some(0.22));
    let nominal = study.joint.nominal.expect("stated");
    assert_eq!(nominal.coulomb_nm, 0.007);
    let out = expect_code(folder.path(), &["drop", "--study", "bench/study.toml", "--out", "fit"], 0);
    assert!(out.contains("coulomb") || out.contains("Coulomb"), "{out}");
}

#[test]
fn what_cannot_be_is_one_error_with_exit_code_3() {
    let folder = tempfile::tempdir().expect("a folder");
    let effect = |effect: &str| format!("{AIR}[[effect]]\n{effect}\n");
    for (text, expected) in [
        (AIR.replace("schema = 1", "schema = 3"), "key `schema`: found 3"),
        (AIR.replace("\"air\"", "\"moon\""), "key `[robot] scenario`"),
        (AIR.replace("step = 1e-3", "scatter = 2.0"), "key `[truth] scatter`: found 2"),
        (AIR.replace("step = 1e-3", "mass_scale = { wing = 1.1 }"), "ers7 has no body wing"),
        (AIR.replace("step = 1e-3", "mass_scale = -1.0"), "key `[truth] mass_scale`: found -1"),
        (AIR.replace("step = 1e-3", "slope = 0.1"), "it with scenario = \"floor\" only"),
        (AIR.replace("step = 1e-3", "stepp = 1e-3"), "unknown field `stepp`"),
        (AIR.replace("step = 1e-3", "friction = { q9 = { coulomb = 0.1 } }"), "key `[truth] friction.q9`"),
        (AIR.replace("duration = 3.0", "duration = -3.0"), "key `[[log]] 1 duration`: found -3"),
        (AIR.replace("duration = 3.0", "gait = \"gallop\""), "no gait gallop"),
        (AIR.replace("duration = 3.0", "released = \"lf2\""), "key `[[log]] 1 released`"),
        (AIR.replace("\"a.csv\"", "\"../a.csv\""), "key `[[log]] 1 file`"),
        (effect("id = \"magic\""), "`magic` is not an effect"),
        (effect("id = \"torque_limit\"\njoints = \"lf9\"\ntau_max = 0.1"), "key `[[effect]] 1 joints`: found \"lf9\""),
        (effect("id = \"torque_limit\"\njoints = \"lf1\"\ntau = 0.1"), "key `[[effect]] 1 tau`"),
        (effect("id = \"torque_limit\"\njoints = \"lf1\""), "key `[[effect]] 1 tau_max`: found nothing"),
        (effect("id = \"torque_limit\"\njoints = \"lf1\"\ntau_max = -0.1"), "tau_max is -0.1"),
        (effect("id = \"delay\"\njoints = \"ear_l_pan\"\nT = 0.01"), "joints with a controller"),
        (FLOOR.replace("step = 5e-4", "floor = { stiffness = -1.0 }"), "floor: stiffness = -1"),
        (
            FLOOR.replace("step = 5e-4", "payload = [{ mass = -1.0, at = [0.0, 0.0, 0.0] }]"),
            "payload]] 1 mass`: found -1",
        ),
        (DROP.replace("rf2 = 0.9", "rf2 = 9.0"), "key `[[log]] 1 angles.rf2`: found 9"),
        (DROP.replace("5.127562", "1.0"), "key `[[log]] 1 gravity`"),
        (DROP.replace("released = \"rf2\"", ""), "key `[[log]] 1 released`: found nothing"),
        (
            AIR.replace("[robot]\nmodel = \"ers7\"\nscenario = \"air\"", "[joint]\nname = \"neck\""),
            "key `[joint] name`",
        ),
    ] {
        std::fs::write(folder.path().join("spec.toml"), &text).expect("written");
        let output = run_in(folder.path(), &["synth", "spec.toml", "--out", "out"]);
        let message = stderr(&output);
        assert!(message.contains(expected) && message.contains("spec.toml"), "{expected}: {message}");
        assert_eq!(output.status.code(), Some(3), "{message}");
        assert!(!folder.path().join("out").exists());
    }
}

#[test]
#[ignore = "slow"]
fn slow_logs_of_a_described_arm_are_those_of_its_truth_and_gap_names_it() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.urdf"), support::arm::ARM).unwrap();
    // Fast and damped enough for what the elbow feels of the shoulder's measured motion.
    let spec = |truth: &str| {
        let believed = "schema = 1\n[robot]\nmodel = \"arm.urdf\"\nscenario = \"fixed\"\n[joints.default]\nkp = 20.0\nkd = 1.0\n\
                        [sensor]\nperiod = 0.01\nresolution = 0.0005\n";
        let log = |file: &str, gait: &str, role: &str| {
            format!("[[log]]\nfile = \"{file}.csv\"\ngait = \"{gait}\"\nrole = \"{role}\"\nduration = 8.0\n")
        };
        let logs = [log("a", "sines", "fit"), log("b", "steps", "fit"), log("c", "sines", "validate")];
        format!("{believed}{truth}{}", logs.concat())
    };
    let late = "[truth.friction.\"arm/shoulder\"]\ncoulomb = 0.09\n[[effect]]\nid = \"delay\"\njoints = \"arm/elbow\"\nT = 0.04\n";
    for (out, truth) in [("plain", ""), ("late", late)] {
        let file = format!("{out}.toml");
        std::fs::write(folder.path().join(&file), spec(truth)).unwrap();
        let run = run_in(folder.path(), &["synth", &file, "--quiet", "--out", out]);
        assert!(run.status.success(), "{}", stderr(&run));
    }
    let truth = json(&folder.path().join("late-truth.json"));
    assert_eq!(truth["effects"][0]["joints"][0], "arm/elbow", "{truth}");
    assert_eq!(truth["friction"]["arm/shoulder"]["coulomb"], 0.09);
    let study = std::fs::read_to_string(folder.path().join("late/study.toml")).unwrap();
    assert!(!study.contains("delay") && !study.contains("0.09"), "{study}");
    let read = |name: &str| read_robot_log(&folder.path().join(name).join("a.csv")).expect("a log");
    assert!(largest_change(&read("plain"), &read("late"), "arm/elbow") > 0.005);

    // Simulated as believed the arm without an effect is off by its encoders' noise, the late one by far more.
    let off = |out: &str| {
        let study = format!("{out}/study.toml");
        let args = ["simulate", &study, "--quiet", "--json", "simulated.json", "--out", "simulated"];
        let run = run_in(folder.path(), &args);
        assert!(run.status.success(), "{}", stderr(&run));
        json(&folder.path().join("simulated.json"))["logs"][0]["per_joint"]["arm/elbow"].as_f64().unwrap()
    };
    assert!(off("plain") < 0.0015 && off("late") > 0.005, "{} {}", off("plain"), off("late"));

    let args = ["gap", "late/study.toml", "--quiet", "--json", "gap.json", "--out", "gap"];
    assert!(run_in(folder.path(), &args).status.success());
    let found = json(&folder.path().join("gap.json"));
    let elbow = &found["joints"]["arm/elbow"];
    assert_eq!(elbow["effect"], "delay", "{}", found["sentence"]);
    let late_s = elbow["effects"][0]["parameters"]["T"]["value"].as_f64().unwrap();
    assert!((late_s - 0.04).abs() < 0.004, "{late_s}");
    // What was found predicts the whole arm, and Isaac Lab's and PACE's formats have it.
    let args = ["simulate", "late/study.toml", "--fit", "gap.json", "--json", "fitted.json", "--out", "fitted"];
    let run = run_in(folder.path(), &args);
    assert!(run.status.success(), "{}", stderr(&run));
    let fitted = json(&folder.path().join("fitted.json"));
    assert!(fitted["logs"][2]["per_joint"]["arm/elbow"].as_f64().unwrap() < 0.002, "{fitted}");
    let export = |to: &str, file: &str| {
        let run = run_in(folder.path(), &["export", "gap.json", "--to", to, "--out", "exported"]);
        assert!(run.status.success(), "{}", stderr(&run));
        std::fs::read_to_string(folder.path().join("exported").join(file)).unwrap()
    };
    let (isaac, pace) = (export("isaac", "isaac.py"), export("pace", "pace.yaml"));
    assert!(
        isaac.contains("\"arm/elbow\": DelayedPDActuatorCfg(") && isaac.contains("# aibo-fit: delay 0.0"),
        "{isaac}"
    );
    assert!(isaac.contains("\"arm/shoulder\": ImplicitActuatorCfg("), "{isaac}");
    assert!(
        pace.contains("joint_order: [\"arm/shoulder\", \"arm/elbow\"]")
            && pace.contains("# steps of dt, one for all joints, arm/elbow's"),
        "{pace}"
    );

    let quick = |effect: &str| {
        let robot = ["synth", "--robot", "arm.urdf", "--servo", "20,1", "--logs", "2", "--seconds", "2", "--quiet"];
        let args: Vec<&str> = robot.into_iter().chain(["--effect", effect, "--out", "quick"]).collect();
        run_in(folder.path(), &args)
    };
    assert!(quick("lower.payload=0.1").status.success());
    assert_eq!(json(&folder.path().join("quick-truth.json"))["mass_kg"]["lower"], 0.6);
    for (effect, expected) in [
        ("arm/elbow.dealy=0.02", "dealy"),
        ("arm/elbow.backlash=0.02", "values, expected"),
        ("wrist.delay=0.02", "wrist"),
        ("arm/elbow.delay=x", "is no number"),
        ("hand.mass=2", "hand"),
    ] {
        let run = quick(effect);
        assert!(!run.status.success() && stderr(&run).contains(expected), "{effect}: {}", stderr(&run));
    }
}

/// An arm whose second joint follows the first, as a parallel gripper's does.
const PAIR: &str = r#"<robot name="pair"><link name="base"/>
<link name="one"><inertial><origin xyz="0.02 0 -0.15"/><mass value="0.4"/>
  <inertia ixx="0.003" iyy="0.003" izz="0.0005" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="two"><inertial><origin xyz="0 0.01 -0.1"/><mass value="0.2"/>
  <inertia ixx="0.001" iyy="0.001" izz="0.0002" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lead" type="revolute"><parent link="base"/><child link="one"/><axis xyz="0 1 0"/>
  <dynamics damping="0.05" friction="0.02"/><limit lower="-2" upper="2" effort="20" velocity="20"/></joint>
<joint name="follow" type="revolute"><parent link="one"/><child link="two"/><origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/>
  <limit lower="-3" upper="3" effort="20" velocity="20"/><mimic joint="lead" multiplier="-0.8" offset="0.1"/></joint>
</robot>"#;

#[test]
fn a_joint_that_follows_another_is_made_and_predicted_with_it() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("pair.urdf"), PAIR).unwrap();
    let words = ["synth", "--robot", "pair.urdf", "--servo", "12,0.4", "--out", "sealed", "--quiet"];
    expect_code(dir.path(), &words, 0);
    let log = read_robot_log(&dir.path().join("sealed/log-00.csv")).unwrap();
    assert_eq!(log.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>(), ["lead"]);
    expect_code(dir.path(), &["simulate", "sealed/study.toml", "--json", "sim.json", "--quiet"], 0);
    let told = json(&dir.path().join("sim.json"));
    let rms = told["logs"].as_array().unwrap().iter().map(|log| log["rms"].as_f64().unwrap());
    assert!(rms.fold(0.0, f64::max) < 2e-3, "{told:#}");
}

#[test]
fn a_robot_that_is_free_in_its_description_is_held_in_its_study() {
    let robot = |free: &str| {
        format!(
            r#"<mujoco model="leg"><worldbody><body name="trunk">{free}
            <inertial pos="0 0 0" mass="3" diaginertia="0.02 0.03 0.03"/>
            <body name="thigh"><inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.002 0.002 0.0002"/>
            <joint name="hip" axis="0 1 0" range="-1 1" damping="0.3" frictionloss="0.05"/>
            </body></body></worldbody>
            <actuator><position joint="hip" kp="20"/></actuator></mujoco>"#
        )
    };
    let folder = tempfile::tempdir().expect("a folder");
    let logs = [("free", "<freejoint/>"), ("held", "")].map(|(name, free)| {
        let file = format!("{name}.xml");
        std::fs::write(folder.path().join(&file), robot(free)).expect("the robot");
        let words = ["synth", "--robot", &file, "--logs", "2", "--seconds", "2", "--quiet", "--out", name];
        let run = run_in(folder.path(), &words);
        assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
        std::fs::read_to_string(folder.path().join(name).join("log-00.csv")).expect("a log")
    });
    assert!(logs[0] == logs[1], "a robot that falls hangs in no gravity, and its legs push nothing but one another");
}
