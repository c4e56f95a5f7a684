use super::*;
use crate::log::source::read::read_wanted;

fn read(text: &str) -> Result<Source, LogError> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("log.csv");
    std::fs::write(&path, text).unwrap();
    read_wanted(&path, Want::Any, &Columns::default())
}

/// 60 rows of a user's own logger.
fn table(header: &str, row: impl Fn(f64) -> String) -> String {
    let rows: Vec<String> = (0..60).map(|k| row(f64::from(k))).collect();
    format!("{header}\n{}\n", rows.join("\n"))
}

#[test]
fn everything_that_is_wrong_is_told_in_one_run_with_the_lines_that_mend_it() {
    let wave = |k: f64| 40.0 * (0.2 * k).sin();
    let text = table("stamp,elbow_angle,elbow_goal,wrist_angle", |k| {
        format!("{},{},{},{}", 10.0 * k, wave(k), wave(k + 1.0), wave(k + 2.0))
    });
    let message = read(&text).unwrap_err().to_string();
    for part in [
        "column `t` is missing",
        "looks like milliseconds",
        "looks like degrees",
        "t = { name = \"stamp\", unit = \"ms\" }",
        "\"elbow.q\" = { name = \"elbow_angle\", unit = \"deg\" }",
        "\"elbow.q_ref\" = { name = \"elbow_goal\", unit = \"deg\" }",
        "\"wrist.q\" = { name = \"wrist_angle\", unit = \"deg\" }",
    ] {
        assert!(message.replace("elbow.q = ", "\"elbow.q\" = ").contains(part), "`{part}` is not in\n{message}");
    }
}

#[test]
fn each_kind_of_bad_cell_is_told_once_with_its_number() {
    let text = table("t,q,tau", |k| match k as i32 {
        3 | 5 | 9 => format!("{},x,0", 0.01 * k),
        20 => format!("{},0.1,", 0.01 * k),
        30 => "0.1,0.1,0".to_owned(),
        _ => format!("{},0.1,0", 0.01 * k),
    });
    let message = read(&text).unwrap_err().to_string();
    for part in [
        "line 5, column `q`: found `x`",
        "and 2 more of this kind",
        "line 22, column `tau`",
        "line 32, column `t`: time runs back",
    ] {
        assert!(message.contains(part), "`{part}` is not in\n{message}");
    }
}

#[test]
fn rows_for_each_message_are_channels_with_stamps_of_their_own() {
    let text = table("t,q,q_ref", |k| match k as i32 % 3 {
        0 => format!("{},,0.5", 0.01 * k),
        _ => format!("{},0.1,", 0.01 * k),
    });
    let source = read(&text).unwrap();
    assert_eq!(source.format, Format::StaggeredCsv);
    let (q, q_ref) = (source.ours("q").unwrap(), source.ours("q_ref").unwrap());
    assert_eq!((q.values.len(), q_ref.values.len()), (40, 20));
    assert!((source.t_s(q_ref)[1] - 0.03).abs() < 1e-12 && (source.t_s(q)[2] - 0.04).abs() < 1e-12);
}
