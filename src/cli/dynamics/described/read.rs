//! Reads states of a described robot: by joint name, or as lists in joint order.

use crate::cli::CliError;
use crate::cli::dynamics::read::{QUATERNION_TOLERANCE, kind, list, opened};
use crate::robot::description::Description;
use crate::robot::tree::{Tree, TreeBase, TreeState};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::{Map, Value};
use std::path::Path;

/// A state, and the torques that act there.
pub(super) struct Asked {
    pub state: TreeState,
    /// On every joint of the description.
    pub torque: Vec<f64>,
}

/// A file of states, before anything is known of the robot.
pub(super) struct Question {
    value: Value,
    /// How the base is held, if the file says so.
    pub base: Option<TreeBase>,
    /// Gravity, if the file says so \[m/s^2\].
    pub gravity_m_s2: Option<Vector3<f64>>,
}

impl Question {
    /// Opens a file.
    pub fn open(file: &Path) -> Result<Self, CliError> {
        let value = opened(file)?;
        let wrong = |what: String| CliError::States { file: file.to_path_buf(), what };
        let base = match value.get("base") {
            None | Some(Value::Null) => None,
            Some(Value::String(word)) if word == "fixed" => Some(TreeBase::Fixed),
            Some(Value::String(word)) if word == "free" => Some(TreeBase::Free),
            Some(other) => return Err(wrong(format!("base: found {}, expected \"fixed\" or \"free\"", kind(other)))),
        };
        let gravity_m_s2 = match value.get("gravity") {
            None | Some(Value::Null) => None,
            Some(found) => {
                Some(Vector3::from(fixed::<3>(found).map_err(|what| wrong(format!("gravity{what} [m/s^2]")))?))
            }
        };
        Ok(Self { value, base, gravity_m_s2 })
    }

    /// The states for a robot, and warnings of numbers that do not go together.
    pub fn states(
        &self,
        file: &Path,
        description: &Description,
        tree: &Tree,
    ) -> Result<(Vec<Asked>, Vec<String>), CliError> {
        let wrong = |what: String| CliError::States { file: file.to_path_buf(), what };
        let mut warnings = Vec::new();
        let mut all = Vec::new();
        for (index, value) in list(&self.value).map_err(wrong)?.iter().enumerate() {
            let Value::Object(object) = value else {
                return Err(wrong(format!("states[{index}]: found {}, expected an object", kind(value))));
            };
            let reader = Reader { object, index, description, tree };
            all.push(reader.read(&mut warnings).map_err(wrong)?);
        }
        Ok((all, warnings))
    }
}

/// So many numbers, or what is wrong.
fn fixed<const N: usize>(value: &Value) -> Result<[f64; N], String> {
    let wrong = || format!(": found {}, expected {N} finite numbers", kind(value));
    let list = value.as_array().ok_or_else(wrong)?;
    let numbers: Option<Vec<f64>> = list.iter().map(finite).collect();
    numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok()).ok_or_else(wrong)
}

fn finite(value: &Value) -> Option<f64> {
    value.as_f64().filter(|number| number.is_finite())
}

/// A follower may be off by rounding.
const FOLLOWS: f64 = 1e-6;

struct Reader<'a> {
    object: &'a Map<String, Value>,
    index: usize,
    description: &'a Description,
    tree: &'a Tree,
}

impl Reader<'_> {
    fn read(&self, warnings: &mut Vec<String>) -> Result<Asked, String> {
        let mut state = TreeState::drawn(self.tree);
        if self.tree.base() == TreeBase::Free {
            state.base_position_m = self.base("base_pos", "m")?.into();
            state.base_velocity_m_s = self.base("base_vel_world", "m/s")?.into();
            state.base_rate_rad_s = self.base("base_omega_body", "rad/s")?.into();
            let [w, x, y, z] = self.base::<4>("base_quat_wxyz", "-")?;
            let turned = Quaternion::new(w, x, y, z);
            if !((turned.norm() - 1.0).abs() <= QUATERNION_TOLERANCE) {
                let (index, length) = (self.index, turned.norm());
                return Err(format!("states[{index}].base_quat_wxyz: found one of length {length}, expected length 1"));
            }
            state.base_orientation = UnitQuaternion::new_normalize(turned);
        } else if let Some(key) = self.object.keys().find(|key| key.starts_with("base_")) {
            let (index, name) = (self.index, &self.description.name);
            return Err(format!(
                "states[{index}].{key}: the base of {name} is fixed; leave it out or ask with --base free"
            ));
        }
        let (q, dq) = (self.joints("q", "rad or m")?, self.joints("dq", "rad/s or m/s")?);
        let torque = self.joints("tau", "N m or N")?.into_iter().map(Option::unwrap_or_default).collect();
        for (place, joint) in self.tree.joints().iter().enumerate() {
            state.position[place] = q[joint.0].ok_or_else(|| self.missing("q", joint.0))?;
            state.rate[place] = dq[joint.0].ok_or_else(|| self.missing("dq", joint.0))?;
        }
        for coupling in &self.description.couplings {
            let joint = coupling.follower;
            let expected = self.tree.position_of(joint, &state.position);
            if let Some(found) = q[joint.0].filter(|found| !((found - expected).abs() <= FOLLOWS)) {
                let (index, name) = (self.index, &self.description.joints[joint.0].name);
                warnings.push(format!(
                    "states[{index}].q.{name}: found {found}; it follows another joint, taken as {expected}"
                ));
            }
        }
        Ok(Asked { state, torque })
    }

    fn base<const N: usize>(&self, key: &str, unit: &str) -> Result<[f64; N], String> {
        let place = format!("states[{}].{key}", self.index);
        let missing = || format!("{place} is missing, expected {N} numbers [{unit}]: the base is free");
        fixed(self.object.get(key).ok_or_else(missing)?).map_err(|what| format!("{place}{what} [{unit}]"))
    }

    fn missing(&self, key: &str, joint: usize) -> String {
        let name = &self.description.joints[joint].name;
        format!("states[{}].{key}: joint \"{name}\" is missing, expected a number", self.index)
    }

    /// A number for each joint of the description, where there is one.
    fn joints(&self, key: &str, unit: &str) -> Result<Vec<Option<f64>>, String> {
        let (place, joints) = (format!("states[{}].{key}", self.index), &self.description.joints);
        let mut found = vec![None; joints.len()];
        let number = |at: String, value: &Value| {
            finite(value).ok_or_else(|| format!("{place}{at}: found {}, expected a number [{unit}]", kind(value)))
        };
        match self.object.get(key) {
            Some(Value::Object(by_name)) => {
                for (name, value) in by_name {
                    let joint = self.description.joint(name).ok_or_else(|| {
                        format!("{place}: no joint \"{name}\" in {}; it has {}", self.description.name, self.names())
                    })?;
                    found[joint.0] = Some(number(format!(".{name}"), value)?);
                }
            }
            Some(Value::Array(list)) => {
                let order: Vec<usize> = match list.len() {
                    length if length == self.tree.joints().len() => self.tree.joints().iter().map(|id| id.0).collect(),
                    length if length == joints.len() => (0..length).collect(),
                    length => {
                        let expected = self.tree.joints().len();
                        return Err(format!(
                            "{place}: found {length} numbers, expected {expected} [{unit}]: {}",
                            self.names()
                        ));
                    }
                };
                for (k, (joint, value)) in order.into_iter().zip(list).enumerate() {
                    found[joint] = Some(number(format!("[{k}]"), value)?);
                }
            }
            Some(other) => {
                return Err(format!("{place}: found {}, expected numbers by joint name [{unit}]", kind(other)));
            }
            None => return Err(format!("{place} is missing, expected numbers by joint name [{unit}]")),
        }
        Ok(found)
    }

    fn names(&self) -> String {
        let names: Vec<&str> = self.tree.joint_names().collect();
        names.join(", ")
    }
}
