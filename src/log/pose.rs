//! Reads `pose.toml`: how the robot was clamped while the joints of one leg were swung.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use toml::Spanned;

use super::document::{ANGLE, Document, range};
use super::error::LogError;
use super::schema::{RawJointPose, RawPose};

/// Where the rest of the robot was while one joint swung.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// The leg that was swung: `lf`, `rf`, `lr` or `rr`.
    pub leg: String,
    /// Angles of the joints that were held \[rad\], by joint.
    pub held_rad: BTreeMap<String, f64>,
    /// Gravity in trunk axes \[m/s^2\].
    pub gravity_m_s2: [f64; 3],
    /// Knee axis to the centre of the extra mass, along the lower leg \[m\].
    pub mount_m: Option<f64>,
    /// Angle at which the released joint carries no gravity torque \[rad\], by load (`bare`, `220g`).
    pub hanging_rad: BTreeMap<String, f64>,
}

/// Reads the pose for one joint (`q1`, `q2`, `q3`) from `pose.toml` in the folder of a log.
///
/// `None` if there is no such file, or no table for the joint in it.
///
/// # Errors
/// As [`read_study`](super::read_study): unknown keys and values out of range, with the key.
pub fn read_pose_for(log_path: &Path, joint: &str) -> Result<Option<Pose>, LogError> {
    let path = log_path.with_file_name("pose.toml");
    if matches!(fs::metadata(&path), Err(error) if error.kind() == io::ErrorKind::NotFound) {
        return Ok(None);
    }
    let document = Document::open(&path)?;
    let raw: RawPose = document.parse()?;
    let leg = match &raw.leg {
        Some(leg) if ["lf", "rf", "lr", "rr"].contains(&leg.get_ref().as_str()) => leg.get_ref().clone(),
        Some(leg) => {
            let found = format!("\"{}\"", leg.get_ref());
            return Err(document.wrong("leg", leg.span(), found, "\"lf\", \"rf\", \"lr\" or \"rr\""));
        }
        None => return Err(document.missing("leg", "\"lf\", \"rf\", \"lr\" or \"rr\"")),
    };
    let table = match joint {
        "q1" => &raw.q1,
        "q2" => &raw.q2,
        "q3" => &raw.q3,
        _ => &None,
    };
    table.as_ref().map(|table| pose(&document, leg, joint, table)).transpose()
}

fn pose(document: &Document<'_>, leg: String, joint: &str, raw: &RawJointPose) -> Result<Pose, LogError> {
    let key = |name: &str| format!("[{joint}] {name}");
    let angles = |name: &str, map: &BTreeMap<String, Spanned<f64>>| -> Result<BTreeMap<String, f64>, LogError> {
        let checked = map.iter().map(|(entry, value)| {
            let angle = document.needed(&key(&format!("{name}.{entry}")), &Some(value.clone()), ANGLE)?;
            Ok((entry.clone(), angle))
        });
        checked.collect()
    };
    let expected = "three numbers in m/s^2, in trunk axes, of a magnitude above 0 and at most 30";
    let gravity = raw.gravity.as_ref().ok_or_else(|| document.missing(key("gravity"), expected))?;
    let magnitude = gravity.get_ref().iter().map(|g| g * g).sum::<f64>().sqrt();
    if !(magnitude > 0.0 && magnitude <= 30.0) {
        return Err(document.wrong(&key("gravity"), gravity.span(), format!("{:?}", gravity.get_ref()), expected));
    }
    let mount = range(|x| x.abs() <= 10.0, "a length within 10 m; a larger one looks like millimetres");
    Ok(Pose {
        leg,
        held_rad: angles("held", &raw.held)?,
        gravity_m_s2: *gravity.get_ref(),
        mount_m: document.number(&key("mount"), &raw.mount, mount)?,
        hanging_rad: angles("hanging", &raw.hanging)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pose_of_the_reference_swings_is_read() {
        let log = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/thesis-robot/q2-220g-0.csv");
        let pose = read_pose_for(&log, "q2").unwrap().unwrap();
        assert_eq!(pose.leg, "rf");
        assert_eq!(pose.held_rad["rf3"], -0.4363);
        assert_eq!(pose.gravity_m_s2[0], 5.127562);
        assert_eq!(pose.mount_m, Some(0.1));
        assert_eq!(pose.hanging_rad["bare"], 0.5216);
        assert_eq!(read_pose_for(&log, "neck").unwrap(), None);
        assert_eq!(read_pose_for(Path::new("nowhere/log.csv"), "q1").unwrap(), None);
    }

    #[test]
    fn a_wrong_pose_names_the_key() {
        let dir = tempfile::tempdir().unwrap();
        let log = dir.path().join("a.csv");
        for (toml, expected) in [
            ("[q1]\ngravity = [0, -9.81, 0]\n", "`leg` is missing"),
            ("leg = \"rf\"\n[q1]\nheld = { rf2 = 30 }\ngravity = [0, -9.81, 0]\n", "`[q1] held.rf2`: found 30"),
            ("leg = \"rf\"\n[q1]\ngravity = [0, -9.81]\n", "array of length 3"),
            ("leg = \"rf\"\n[q1]\ngravity = [0, 0, 0]\n", "`[q1] gravity`"),
            ("leg = \"rf\"\n[q1]\nmonut = 0.1\n", "unknown field `monut`"),
        ] {
            fs::write(dir.path().join("pose.toml"), toml).unwrap();
            let message = read_pose_for(&log, "q1").unwrap_err().to_string();
            assert!(message.contains(expected) && message.contains("pose.toml"), "{message}");
        }
    }
}
