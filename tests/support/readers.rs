//! Every reader of the program by name, from a file on: what `fuzz/run` drives, and what `tests/corpus.rs` gives good and
//! spoilt files to.

use aibo_fit::geometry::RobotTables;
use aibo_fit::log::{
    Columns, read_about, read_clamped_study, read_joint_log, read_robot_log, read_robot_study, read_sidecar_for,
    read_source, read_study, study_columns,
};
use aibo_fit::report::FitFile;
use aibo_fit::robot::description::Description;
use aibo_fit::robot::tree::{Tree, TreeBase};
use aibo_fit::robot::{Gait, Model, Motion};
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

/// A reader: it may refuse a file but must end soon, in little memory, without a panic.
pub struct Reader {
    /// What it reads: the name of its folder of inputs.
    pub name: &'static str,
    /// The name that a file has to have for it.
    pub file: &'static str,
    /// Reads such a file; whether it is accepted.
    pub read: fn(&Path) -> bool,
}

/// All readers.
pub const READERS: [Reader; 12] = [
    Reader { name: "csv", file: "log.csv", read: any_log },
    Reader { name: "study", file: "study.toml", read: any_study },
    Reader { name: "robot", file: "robot.toml", read: robot_file },
    Reader { name: "urdf", file: "robot.urdf", read: description },
    Reader { name: "mjcf", file: "robot.xml", read: description },
    Reader { name: "mcap", file: "log.mcap", read: any_log },
    Reader { name: "db3", file: "log.db3", read: any_log },
    Reader { name: "bag", file: "log.bag", read: any_log },
    Reader { name: "parquet", file: "log.parquet", read: any_log },
    Reader { name: "npz", file: "log.npz", read: any_log },
    Reader { name: "gait", file: "gait.toml", read: gait_or_motion },
    Reader { name: "fit", file: "fit.json", read: fit_or_json },
];

fn any_log(file: &Path) -> bool {
    let accepted = read_source(file, &Columns::default()).is_ok();
    let _ = (read_joint_log(file, None), read_robot_log(file));
    accepted
}

/// What studies of the repository name, so that they are read to their end.
const NAMED: [(&str, &str); 6] = [
    ("swing-0.csv", include_str!("../corpus/csv/swing.csv")),
    ("swing-1.csv", include_str!("../corpus/csv/swing.csv")),
    ("chirp-0.csv", include_str!("../corpus/csv/swing.csv")),
    ("log0.csv", include_str!("../corpus/csv/arm.csv")),
    ("log1.csv", include_str!("../corpus/csv/arm.csv")),
    ("arm.urdf", include_str!("../../data/examples/arm/arm.urdf")),
];

fn any_study(file: &Path) -> bool {
    for (name, text) in NAMED {
        let beside = file.with_file_name(name);
        if !beside.exists() {
            fs::write(beside, text).expect("a file beside the study");
        }
    }
    let _ = (read_about(file), study_columns(file));
    let is_sidecar = matches!(read_sidecar_for(&file.with_extension("csv")), Ok(Some(_)));
    is_sidecar | read_study(file).is_ok() | read_robot_study(file).is_ok() | read_clamped_study(file).is_ok()
}

fn robot_file(file: &Path) -> bool {
    let text = fs::read_to_string(file).unwrap_or_default();
    RobotTables::from_toml(file, &text).is_ok()
}

fn description(file: &Path) -> bool {
    let Ok(description) = Description::read(file) else { return false };
    for base in [TreeBase::Fixed, TreeBase::Free] {
        if let Ok(tree) = Tree::new(&description, base) {
            let _ = tree.servos(&description);
        }
    }
    true
}

fn gait_or_motion(file: &Path) -> bool {
    static ERS7: LazyLock<Model> = LazyLock::new(|| Model::ers7().clone());
    Gait::read(file, &ERS7).is_ok() | Motion::read(file, &ERS7).is_ok()
}

fn fit_or_json(file: &Path) -> bool {
    let text = fs::read_to_string(file).unwrap_or_default();
    serde_json::from_str::<FitFile>(&text).is_ok() | any_log(file)
}
