use super::*;
use serde_json::json;

fn study(dir: &Path) -> PathBuf {
    let path = dir.join("a/study.toml");
    fs::create_dir_all(dir.join("a")).unwrap();
    fs::write(&path, "schema = 1\n[[log]]\nfile = 'log.csv'\n").unwrap();
    fs::write(dir.join("a/log.csv"), "t,q\n0,0\n").unwrap();
    path
}

fn begin(dir: &Path, options: &FleetOptions) -> Fleet {
    let pattern = dir.join("**/study.toml").to_string_lossy().into_owned();
    Fleet::begin(&[pattern], &dir.join("out"), options.clone()).unwrap()
}

fn answer() -> Outcome {
    Outcome::Answer(Box::new(json!({ "name": "knee", "verdict": "none", "gap": { "unit": "rad", "per_log": [] } })))
}

#[test]
fn an_answer_holds_until_study_log_or_options_change() {
    let dir = tempfile::tempdir().unwrap();
    let (path, plain) = (study(dir.path()), FleetOptions::default());
    let pending = |options: &FleetOptions| begin(dir.path(), options).pending();
    begin(dir.path(), &plain).store(0, answer()).unwrap();
    assert!(pending(&plain).is_empty());
    assert_eq!(pending(&FleetOptions { without: vec!["delay".into()], ..plain.clone() }), [0]);
    assert_eq!(pending(&FleetOptions { pages: true, ..plain.clone() }), [0]);
    let log = dir.path().join("a/log.csv");
    let before = fs::read(&log).unwrap();
    fs::write(&log, "t,q\n0,1\n").unwrap();
    assert_eq!(pending(&plain), [0]);
    fs::write(&log, before).unwrap();
    assert!(pending(&plain).is_empty());
    fs::write(&path, "schema = 1\n").unwrap();
    assert_eq!(pending(&plain), [0]);
}

#[test]
fn what_was_read_beyond_what_the_study_names_counts_too() {
    let dir = tempfile::tempdir().unwrap();
    study(dir.path());
    let mesh = dir.path().join("included.xml");
    fs::write(&mesh, "<a/>").unwrap();
    let (file, sha256) = (mesh.display().to_string(), crate::log::sha256(b"<a/>"));
    let document = json!({ "gap": {}, "inputs": [{ "file": file, "sha256": sha256 }] });
    let plain = FleetOptions::default();
    begin(dir.path(), &plain).store(0, Outcome::Answer(Box::new(document))).unwrap();
    assert!(begin(dir.path(), &plain).pending().is_empty());
    fs::write(&mesh, "<b/>").unwrap();
    assert_eq!(begin(dir.path(), &plain).pending(), [0]);
}

#[test]
fn a_bad_study_is_not_asked_again_and_a_lost_one_is() {
    let dir = tempfile::tempdir().unwrap();
    study(dir.path());
    let plain = FleetOptions::default();
    begin(dir.path(), &plain).store(0, Outcome::None("line 2".into())).unwrap();
    let fleet = begin(dir.path(), &plain);
    assert!(fleet.pending().is_empty());
    drop(fleet);
    // It has no page either, and needs none.
    let fleet = begin(dir.path(), &FleetOptions { pages: true, ..plain.clone() });
    assert!(fleet.pending().is_empty());
    assert_eq!(fleet.report().unwrap().failed().map(|(_, why)| why).collect::<Vec<_>>(), ["line 2"]);
    fleet.store(0, Outcome::Lost("killed".into())).unwrap();
    drop(fleet);
    assert_eq!(begin(dir.path(), &plain).pending(), [0]);
}

#[test]
fn half_an_answer_is_none_and_one_fleet_at_a_time_writes() {
    let dir = tempfile::tempdir().unwrap();
    study(dir.path());
    let plain = FleetOptions::default();
    let fleet = begin(dir.path(), &plain);
    fleet.store(0, answer()).unwrap();
    let pattern = [dir.path().join("a/study.toml").to_string_lossy().into_owned()];
    let busy = Fleet::begin(&pattern, &dir.path().join("out"), plain.clone()).unwrap_err();
    assert!(matches!(busy, FleetError::Busy { .. }), "{busy}");
    let file = answer_file(&dir.path().join("out"), &fleet.studies[0].name);
    drop(fleet);
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, &text[..text.len() / 2]).unwrap();
    let fleet = begin(dir.path(), &plain);
    assert_eq!(fleet.pending(), [0]);
    assert!(matches!(fleet.report(), Err(FleetError::Missing { .. })));
}
