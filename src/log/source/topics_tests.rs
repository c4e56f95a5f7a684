use super::*;
use crate::log::source::message::Point;

fn point(after_ns: i64, position: &[f64]) -> Point {
    Point { after_ns, position: position.to_vec(), ..Point::default() }
}

fn message(stamp_ns: Option<i64>, points: Vec<Point>) -> Message<'static> {
    Message { stamp_ns, points, ..Message::default() }
}

fn source(topics: Topics) -> Source {
    topics.into_source(Path::new("a.db3"), Format::Rosbag2).unwrap()
}

const S: i64 = 1_000_000_000;

#[test]
fn a_later_trajectory_takes_the_place_of_what_was_still_to_come() {
    let mut topics = Topics::default();
    for k in 0..4 {
        let read = message(Some(k * S), vec![point(0, &[k as f64])]);
        topics.take("/joint_states", Kind::JointState, &["a"], k * S, read).unwrap();
    }
    let first = message(Some(S), vec![point(0, &[0.1]), point(S, &[0.2]), point(2 * S, &[0.3])]);
    topics.take("/goal", Kind::JointTrajectory, &["a"], S, first).unwrap();
    let second = message(Some(2 * S), vec![point(0, &[0.5]), point(S / 2, &[0.6])]);
    topics.take("/goal", Kind::JointTrajectory, &["a"], 2 * S, second).unwrap();
    let source = source(topics);
    let asked = source.ours("a.q_ref").unwrap();
    assert_eq!((source.t_s(asked), &asked.values[..]), (&[1.0, 2.0, 2.5][..], &[0.1, 0.5, 0.6][..]));
    assert!(source.notes.iter().any(|note| note.contains("2 trajectories")), "{:?}", source.notes);
}

#[test]
fn headers_without_stamps_are_taken_at_their_receipt_and_repeats_once() {
    let mut topics = Topics::default();
    for k in [0, 2, 1, 2, 3] {
        let read = message(None, vec![point(0, &[k as f64])]);
        topics.take("/joint_states", Kind::JointState, &["a"], 5 * S + k * S, read).unwrap();
    }
    let source = source(topics);
    assert_eq!(source.ours("a.q").unwrap().values, [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(source.clocks[0], [0.0, 1.0, 2.0, 3.0]);
    for part in ["taken at its receipt", "1 messages repeat a stamp"] {
        assert!(source.notes.iter().any(|note| note.contains(part)), "{:?}", source.notes);
    }
}

#[test]
fn a_topic_that_says_the_same_again_is_left_out_and_named() {
    let mut topics = Topics::default();
    for k in 0..4 {
        for topic in ["/joint_states", "/filtered"] {
            let read = message(Some(k * S + 1), vec![point(0, &[k as f64])]);
            topics.take(topic, Kind::JointState, &["a"], k * S, read).unwrap();
        }
    }
    let source = source(topics);
    assert_eq!(source.ours("a.q").unwrap().theirs, "/joint_states/a/position");
    let note = "/filtered: a left out, which /joint_states has";
    assert!(source.notes.iter().any(|found| found == note), "{:?}", source.notes);
}

#[test]
fn publishers_that_share_a_topic_are_told_apart_by_their_names() {
    let mut topics = Topics::default();
    for k in 0..3 {
        for (name, late) in [("a", 0), ("b", S / 2)] {
            let read = message(Some(k * S + late + 1), vec![point(0, &[1.0])]);
            topics.take("/joint_states", Kind::JointState, &[name], 0, read).unwrap();
        }
    }
    let source = source(topics);
    assert_eq!(source.joints(), [Some("a"), Some("b")]);
    assert_eq!(source.clocks[1], [0.5, 1.5, 2.5]);
    let none = Topics::default().into_source(Path::new("a.db3"), Format::Rosbag2).unwrap_err().to_string();
    assert!(none.contains("a.db3: a rosbag2 file (SQLite): no message of a kind"), "{none}");
}

#[test]
fn what_is_left_out_is_named_where_nothing_says_what_is_asked() {
    let read = |topic: &str, kind: Kind| {
        let mut topics = Topics::default();
        for k in 0..4 {
            let read = message(Some(k * S), vec![point(0, &[k as f64])]);
            topics.take("/joint_states", Kind::JointState, &["a"], k * S, read).unwrap();
            let other = message(Some(k * S), vec![point(0, &[k as f64])]);
            topics.take(topic, kind, &["a"], k * S, other).unwrap();
        }
        topics.leave_out("/goal (my_msgs/msg/Goal)");
        topics.leave_out("/goal (my_msgs/msg/Goal)");
        source(topics).notes
    };
    let missed = |notes: &[String]| notes.iter().filter(|note| note.contains("/goal (my_msgs/msg/Goal)")).count();
    let notes = read("/more_states", Kind::JointState);
    assert_eq!(missed(&notes), 1, "{notes:?}");
    let notes = read("/asked", Kind::JointTrajectory);
    assert_eq!(missed(&notes), 0, "{notes:?}");
}

/// 600 messages of 1200 were kept once: of each order of the names, and of each choice of joints, one.
#[test]
fn joints_are_told_by_their_names_in_every_message() {
    let mut topics = Topics::default();
    let values =
        |names: &[&str], k: i64| names.iter().map(|n| k as f64 + f64::from(n.as_bytes()[0])).collect::<Vec<_>>();
    let orders: [&[&str]; 4] = [&["a", "b", "c"], &["c", "a", "b"], &["b", "a"], &["b", "c", "a"]];
    for k in 0..40 {
        let names = orders[k as usize % 4];
        let point = Point { velocity: values(names, -k), ..point(0, &values(names, k)) };
        topics.take("/joint_states", Kind::JointState, names, k * S, message(Some(k * S + 1), vec![point])).unwrap();
    }
    let source = source(topics);
    for (joint, samples) in [("a", 40), ("b", 40), ("c", 30)] {
        let [q, dq] = ["q", "dq"].map(|of| source.ours(&format!("{joint}.{of}")).unwrap());
        assert_eq!((q.values.len(), dq.values.len()), (samples, samples), "{joint}");
        let own = f64::from(joint.as_bytes()[0]);
        let is_right = |(t, (q, dq)): (&f64, (&f64, &f64))| (q - own - t).abs() < 1e-6 && (dq - own + t).abs() < 1e-6;
        assert!(source.t_s(q).iter().zip(q.values.iter().zip(&dq.values)).all(is_right), "{joint}");
    }
}

/// Two takes of which the second began anew were woven into one another once, and nothing was missing.
#[test]
fn a_clock_that_is_set_back_is_refused() {
    let read = |stamps: &dyn Fn(i64) -> i64| {
        let mut topics = Topics::default();
        for k in 0..200 {
            let read = message(Some(stamps(k)), vec![point(0, &[k as f64])]);
            topics.take("/joint_states", Kind::JointState, &["a"], k * S, read).unwrap();
        }
        topics.into_source(Path::new("a.db3"), Format::Rosbag2).map(|source| source.channels[0].values.len())
    };
    let error = read(&|k| S * (1 + k % 120)).unwrap_err().to_string();
    assert!(error.contains("run back by 119.000 s at message 121"), "{error}");
    // One that overtakes another, and two publishers of which one is late.
    assert_eq!(
        read(&|k| S
            * (1 + if k == 90 {
                91
            } else if k == 91 {
                90
            } else {
                k
            }))
        .unwrap(),
        200
    );
    assert_eq!(read(&|k| S * (20 + if k % 2 == 0 { k } else { k - 7 }) + k).unwrap(), 200);
}

#[test]
fn who_leads_asks_and_a_joint_is_read_from_one_topic() {
    let mut topics = Topics::default();
    for k in 0..40 {
        for topic in ["/leader/joint_states", "/servo", "/follower/joint_states"] {
            let point = Point { effort: vec![0.5], ..point(0, &[topic.len() as f64]) };
            let is_servo = topic == "/servo";
            let point = if is_servo { point } else { Point { effort: Vec::new(), ..point } };
            topics.take(topic, Kind::JointState, &["a"], k * S, message(Some(k * S + 1), vec![point])).unwrap();
        }
    }
    let source = source(topics);
    let theirs = |ours: &str| source.ours(ours).map(|channel| channel.theirs.as_str());
    assert_eq!(theirs("a.q"), Some("/follower/joint_states/a/position"));
    assert_eq!((theirs("a.q_ref"), theirs("a.tau")), (Some("/leader/joint_states/a/position"), None));
}
