//! The reference walk as numbers, gaits that the robot can do, files that it cannot, and motion files.

use super::*;
use crate::robot::{JointId, Model, RobotError};
use std::f64::consts::TAU;
use std::path::Path;

fn error(text: &str) -> String {
    let found = Gait::from_toml(Path::new("my.toml"), text, Model::ers7());
    found.expect_err("a wrong gait").to_string().replace("found ", "")
}

/// A gait of one wave on one joint, with something of it replaced.
fn small(what: &str, with: &str) -> String {
    let text = "schema = 1\nname = \"small\"\nstand_s = 0.5\nwalk_s = 2.0\nperiod_s = 1.0\nramp_s = 0.5\n\
                [[wave]]\njoints = [\"lf1\", \"rf1\"]\nstand_rad = -0.3\nshape = \"sin\"\nphase = [0.0, 0.5]\n\
                amplitude_rad = 0.1\n";
    assert!(text.contains(what), "{what}");
    text.replace(what, with)
}

/// The formulas of the reference walk.
fn reference(joint: &str, t_s: f64, a: [f64; 3]) -> f64 {
    let s = (t_s - 2.0).max(0.0);
    let x = (s / 0.5).min(1.0);
    let e = x * x * (3.0 - 2.0 * x);
    let phi = TAU * s + if joint.starts_with("lf") || joint.starts_with("rr") { 0.0 } else { TAU / 2.0 };
    let sense = if joint.as_bytes()[1] == b'f' { 1.0 } else { -1.0 };
    match &joint[2..] {
        "1" => -0.30 + sense * e * a[0] * phi.sin(),
        "2" => 0.10 + e * a[1] * phi.cos(),
        _ => 0.10 + e * a[2] * phi.cos(),
    }
}

#[test]
fn the_trot_is_the_reference_walk() {
    let model = Model::ers7();
    let trot = Gait::built_in("trot", model).unwrap();
    let sets = [("floor", [0.115, 0.05, 0.15]), ("air", [0.35, 0.2, 0.4])];
    for (set, amplitudes) in sets {
        let trot = trot.with_amplitude(set).unwrap();
        for joint in model.joint_ids().take(12) {
            let name = &model.joints()[joint.index()].name;
            for k in 0..1251 {
                let t_s = f64::from(k) * 0.008;
                let (found, expected) = (trot.angle_rad(joint, t_s), reference(name, t_s, amplitudes));
                assert!((found - expected).abs() < 1e-12, "{name} at {t_s}: {found} {expected}");
            }
        }
    }
    let angle = |name: &str| trot.angle_rad(model.joint(name).unwrap(), 5.3);
    assert_eq!((angle("mouth"), angle("neck_tilt1"), angle("tail_tilt")), (-0.0524, 0.0, 0.0));
    assert_eq!((trot.stand_s(), trot.walk_s(), trot.period_s(), trot.amplitude()), (2.0, 8.0, 1.0, "floor"));
}

#[test]
fn the_trot_equals_the_shared_setpoints() {
    let file = std::env::var_os("AIBO_FIT_SHARED").map(|shared| Path::new(&shared).join("ers7/trot-setpoints.csv"));
    let Some(mut reader) = file.and_then(|file| csv::Reader::from_path(file).ok()) else {
        println!("skipped: AIBO_FIT_SHARED names no folder that holds ers7/trot-setpoints.csv");
        return;
    };
    let model = Model::ers7();
    let trot = Sampled::frames(Gait::built_in("trot", model).unwrap());
    let header = reader.headers().unwrap().clone();
    let joints: Vec<JointId> = header.iter().skip(1).map(|name| model.joint(name).unwrap()).collect();
    let (mut rows, mut worst) = (0, 0.0_f64);
    for row in reader.records() {
        let row: Vec<f64> = row.unwrap().iter().map(|cell| cell.parse().unwrap()).collect();
        for (joint, expected) in joints.iter().zip(&row[1..]) {
            worst = worst.max((trot.angle_rad(*joint, row[0]) - expected).abs());
        }
        rows += 1;
    }
    assert_eq!((rows, joints.len()), (1251, 12));
    assert!(worst <= 0.51e-6, "{worst:e} rad apart; six decimals are printed");
}

#[test]
fn every_gait_that_is_compiled_in_is_one() {
    let model = Model::ers7();
    for name in Gait::names() {
        let gait = Gait::built_in(name, model).unwrap();
        assert_eq!(gait.name(), name);
        assert!(!gait.about().is_empty());
        let mut setpoints = [f64::NAN; 22];
        gait.setpoints(gait.stand_s() + 1.3 * gait.period_s(), &mut setpoints);
        assert!(setpoints.iter().all(|angle| angle.is_finite()), "{name}");
        // Cycles repeat once it has grown in.
        let later = gait.stand_s() + 10.0 * gait.period_s() + 0.3;
        for joint in model.joint_ids() {
            let (a, b) = (gait.angle_rad(joint, later), gait.angle_rad(joint, later + gait.period_s()));
            approx::assert_abs_diff_eq!(a, b, epsilon = 1e-12);
        }
    }
}

#[test]
fn a_crawl_lifts_one_leg_at_a_time_and_a_pace_two_of_a_side() {
    let model = Model::ers7();
    let bent = |gait: &Gait, t_s: f64, over: f64| -> Vec<&str> {
        let knees = ["lf3", "rf3", "lr3", "rr3"];
        knees.into_iter().filter(|knee| gait.angle_rad(model.joint(knee).unwrap(), t_s) > over).collect()
    };
    let crawl = Gait::built_in("crawl", model).unwrap();
    let order: Vec<_> = (0..4).map(|k| bent(&crawl, 2.0 + 4.0 + 0.25 + 0.5 * f64::from(k), 0.2)).collect();
    assert_eq!(order, [["lr3"], ["lf3"], ["rr3"], ["rf3"]]);
    assert!((0..250).all(|k| bent(&crawl, 6.0 + 0.008 * f64::from(k), 0.06).len() <= 1));
    assert_eq!(bent(&Gait::built_in("pace", model).unwrap(), 2.0 + 4.0, 0.15), ["rf3", "rr3"]);
    assert_eq!(bent(&Gait::built_in("trot", model).unwrap(), 2.0 + 4.0, 0.15), ["lf3", "rr3"]);
}

#[test]
fn a_wrong_gait_is_named_with_its_line() {
    let cases = [
        (small("\"rf1\"", "\"rf4\""), "my.toml: line 8, key `[[wave]] 1 joints`: \"rf4\"", "a joint of ers7: lf1, lf2"),
        (small("\"rf1\"", "\"lf1\""), "line 8, key `[[wave]] 1 joints`: lf1 a second time", "one wave"),
        (
            small("0.1\n", "0.9\n"),
            "line 12, key `[[wave]] 1 amplitude_rad`: lf1: a jump at 4.87 rad/s",
            "at most 4.865 rad/s",
        ),
        (small("-0.3", "-2.05"), "line 12, key `[[wave]] 1 amplitude_rad`: lf1: -2.09", "an angle from -2.0944"),
        (small("ramp_s = 0.5", "ramp_s = 0.0\nhop = 1"), "hop", "unknown field"),
        (small("[0.0, 0.5]", "[0.0]"), "line 11, key `[[wave]] 1 phase`: 1 numbers", "2 numbers, one for each"),
        (small("[0.0, 0.5]", "[0.0, 180.0]"), "line 11, key `[[wave]] 1 phase`: 180", "degrees"),
        (small("\"sin\"", "\"saw\""), "line 10, key `[[wave]] 1 shape`: \"saw\"", "\"linear\" or \"smooth\""),
        (small("\"sin\"", "\"linear\""), "[[wave]] 1 keys", "[phase, value] pairs"),
        (
            small("\"sin\"", "\"linear\"\nkeys = [[0.0, 1.0], [0.5, 0.0], [0.4, 1.0]]"),
            "line 11, key `[[wave]] 1 keys`: [0.4, 1]",
            "each larger than the one before",
        ),
        (small("\"sin\"", "\"linear\"\nkeys = [[0.1, 1.0], [0.5, 0.0]]"), "[0.1, 1]", "phases from 0"),
        (small("\"sin\"", "\"linear\"\nkeys = [[0.0, 1.0]]"), "a gap", "at least two pairs"),
        (small("0.1\n", "{ floor = 0.1 }\n"), "[\"floor\"]", "one for each of `amplitudes`"),
        (small("period_s = 1.0", "period_s = 0.0"), "line 5, key `period_s`: 0", "0.05 to 60 s"),
        (small("schema = 1", "schema = 2"), "line 1, key `schema`: 2", "1, the only schema"),
    ];
    for (text, place, expected) in cases {
        let message = error(&text);
        assert!(message.contains(place) && message.contains(expected), "{place}, {expected}:\n{message}");
    }
    let model = Model::ers7();
    let unknown = Gait::built_in("gallop", model).unwrap_err().to_string();
    assert!(unknown.starts_with("no gait gallop; there are trot, trot-2hz, crawl"), "{unknown}");
    let set = Gait::built_in("trot", model).unwrap().with_amplitude("moon").unwrap_err();
    assert_eq!(set.to_string(), "no amplitude set moon; there are floor, air");
}

#[test]
fn frames_are_held_or_joined() {
    let model = Model::ers7();
    let (gait, joint) = (Gait::built_in("trot-2hz", model).unwrap(), model.joint("lf1").unwrap());
    let held = Sampled::motion_frames(gait.clone(), Between::Hold);
    let joined = Sampled::motion_frames(gait.clone(), Between::Linear);
    for k in 20..60_u32 {
        let t_s = f64::from(k) * 0.128;
        let (here, next) = (gait.angle_rad(joint, t_s), gait.angle_rad(joint, t_s + 0.128));
        for sampled in [&held, &joined] {
            approx::assert_abs_diff_eq!(sampled.angle_rad(joint, t_s), here, epsilon = 1e-9);
        }
        approx::assert_abs_diff_eq!(held.angle_rad(joint, t_s + 0.1279), here, epsilon = 1e-9);
        approx::assert_abs_diff_eq!(joined.angle_rad(joint, t_s + 0.064), 0.5 * (here + next), epsilon = 1e-9);
    }
    // 2 Hz on 128 ms frames: 3.9 frames a cycle are not the sine (Figure C.3). 8 ms frames are, to 1e-3 of it.
    let gap = |sampled: &dyn Setpoints| {
        (0..4000)
            .map(|k| 3.0 + f64::from(k) * 1e-3)
            .map(|t| (sampled.angle_rad(joint, t) - gait.angle_rad(joint, t)).abs())
            .fold(0.0, f64::max)
    };
    assert!(gap(&held) > 0.1 && gap(&joined) > 0.03, "{} {}", gap(&held), gap(&joined));
    assert!(gap(&Sampled::frames(gait.clone())) < 3e-4);
}

#[test]
fn a_motion_file_comes_back_as_it_was_written() {
    let model = Model::ers7();
    for name in Gait::names() {
        let gait = Gait::built_in(name, model).unwrap();
        let end_s = gait.stand_s() + gait.walk_s();
        let motion = Motion::of(&gait, model, Motion::FRAME_MS, end_s);
        let text = motion.to_text(model);
        assert!(text.starts_with("#MSq\nradians\nsetTime 0\nLFr:rotor ") && text.ends_with("#END\n"), "{text}");
        let back = Motion::from_text(Path::new("walk.mot"), &text, model).unwrap();
        approx::assert_abs_diff_eq!(back.end_s(), motion.end_s());
        assert!(motion.end_s() >= end_s && motion.end_s() < end_s + 0.128);
        let joined = Sampled::motion_frames(gait, Between::Linear);
        for joint in model.joint_ids() {
            let limits = &model.joints()[joint.index()];
            for k in 0..(end_s * 500.0) as u32 {
                let t_s = f64::from(k) * 2e-3;
                let (a, b, c) =
                    (motion.angle_rad(joint, t_s), back.angle_rad(joint, t_s), joined.angle_rad(joint, t_s));
                // Five decimals; the ears have no output, and stand at 0.
                assert!((a - b).abs() <= 0.51e-5, "{name} {} at {t_s}: {a} {b}", limits.name);
                assert!((a - c).abs() <= 1e-9, "{name} {} at {t_s}: {a} {c}", limits.name);
            }
        }
        // The standing legs need no frames.
        assert!(motion.keys[0][1].0 >= 1900, "{:?}", &motion.keys[0][..3]);
        assert_eq!(back.to_text(model), text);
    }
}

#[test]
fn degrees_comments_weights_and_filled_names_are_read() {
    let text = "#MSq\r\n# a comment\r\ndegrees\r\nadvanceTime 50\r\nNECK:pan~ 45 1\r\nLED:botL 1\r\nEAR:left 1\r\n\r\ndelay 500\r\n\
                NECK:pan~ 0\r\nMOUTH~~~~ -10 0\r\nsettime 1000\r\nneck:pan 10\r\n#END\r\n";
    let model = Model::ers7();
    let motion = Motion::from_text(Path::new("a.mot"), text, model).unwrap();
    let pan = |t_s: f64| motion.angle_rad(model.joint("neck_pan").unwrap(), t_s).to_degrees();
    let found = [pan(0.0), pan(0.05), pan(0.3), pan(0.55), pan(0.775), pan(2.0)];
    for (found, expected) in found.into_iter().zip([45.0, 45.0, 22.5, 0.0, 5.0, 10.0]) {
        approx::assert_abs_diff_eq!(found, expected, epsilon = 1e-9);
    }
    assert_eq!(motion.angle_rad(model.joint("mouth").unwrap(), 1.0), 0.0);
}

#[test]
fn a_wrong_motion_file_is_named_with_its_line() {
    let cases = [
        ("degrees\n#END\n", "a.mot: line 1, key `#MSq`: `degrees`"),
        ("", "line 1, key `#MSq`: an empty file"),
        ("#MSq\nLFr:rotor 0.1\n", "key `#END`: the end of the file"),
        ("#MSq\nLFr:hip 0.1\n#END\n", "line 2, key `LFr:hip`: `LFr:hip`"),
        ("#MSq\nLFr:rotor\n#END\n", "line 2, key `LFr:rotor`: nothing"),
        ("#MSq\nLFr:rotor x\n#END\n", "line 2, key `LFr:rotor`: `x`"),
        ("#MSq\ndelay 70000\n#END\n", "line 2, key `delay`: `70000`"),
        ("#MSq\ndelay 0.128\n#END\n", "line 2, key `delay`: `0.128`"),
        ("#MSq\ndelay\n#END\n", "line 2, key `delay`: nothing"),
        ("#MSq\ndelay 100\nsetTime 50\n#END\n", "line 3, key `setTime`: 50 ms"),
        (
            "#MSq\nLFr:rotor 0\ndelay 128\nLFr:rotor 1.0\n#END\n",
            "line 4, key `LFr:rotor`: a jump of 1.000 rad in 128 ms",
        ),
        ("#MSq\nload stand.pos\n#END\n", "line 2, key `load`: `load`"),
    ];
    for (text, expected) in cases {
        let error = Motion::from_text(Path::new("a.mot"), text, Model::ers7()).unwrap_err();
        assert!(matches!(error, RobotError::File(_)));
        let message = error.to_string().replace("found ", "");
        assert!(message.contains(expected), "{expected}:\n{message}");
    }
}
