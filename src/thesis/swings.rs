//! A folder of swings, sorted by joint and by extra mass.

use super::TablesError;
use crate::fit::{Budget, Method};
use crate::geometry::LegJoint;
use crate::identify::{
    Case, Directives, Experiment, ExtensiveModel, Fitted, JointModel, LegCase, Scale, SimpleModel, conclude,
};
use crate::log::{LogError, read_sidecar_for};
use std::path::{Path, PathBuf};

/// The swings of one joint.
#[derive(Clone, Debug)]
pub struct JointSwings {
    /// The joint.
    pub joint: LegJoint,
    /// Logs, sidecars, pose.
    pub case: Case,
    /// By extra mass, the bare ones first.
    pub loads: Vec<Load>,
}

/// The swings of one joint with one extra mass.
#[derive(Clone, Debug)]
pub struct Load {
    /// `bare`, or the extra mass, e.g. `0.220 kg`.
    pub name: String,
    /// 0 for bare ones \[kg\].
    pub extra_mass_kg: f64,
    /// Logs in which the joint moves, in the order of their names.
    pub moving: Vec<Experiment>,
    /// Logs in which it does not.
    pub still: Vec<String>,
}

/// Reads every log of a folder that has a sidecar, for the three joints of a leg.
///
/// # Errors
/// [`TablesError`] where a file cannot be read or a joint has no logs.
pub(super) fn read(folder: &Path) -> Result<Vec<JointSwings>, TablesError> {
    let unreadable = |source| TablesError::Log(LogError::Read { file: folder.to_path_buf(), source });
    let mut files: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|ending| ending == "csv") {
            files.push(path);
        }
    }
    files.sort();
    let mut by_joint: Vec<(LegJoint, Vec<PathBuf>)> = LegJoint::ALL.map(|joint| (joint, Vec::new())).into();
    for file in files {
        let Some(sidecar) = read_sidecar_for(&file)? else { continue };
        let of = |joint: &LegJoint| sidecar.joint.name == joint.to_string();
        if let Some((_, logs)) = by_joint.iter_mut().find(|(joint, _)| of(joint)) {
            logs.push(file);
        }
    }
    by_joint.into_iter().map(|(joint, logs)| of_joint(folder, joint, &logs)).collect()
}

fn of_joint(folder: &Path, joint: LegJoint, logs: &[PathBuf]) -> Result<JointSwings, TablesError> {
    let case = Case::of_logs(logs, None)?;
    let mut loads: Vec<Load> = Vec::new();
    for item in &case.items {
        let extra_mass_kg = item.entry.extra.map_or(0.0, |extra| extra.mass_kg);
        let at = loads.iter().position(|load| load.extra_mass_kg == extra_mass_kg).unwrap_or_else(|| {
            let name = if extra_mass_kg > 0.0 { format!("{extra_mass_kg:.3} kg") } else { "bare".to_owned() };
            loads.push(Load { name, extra_mass_kg, moving: Vec::new(), still: Vec::new() });
            loads.len() - 1
        });
        loads[at].moving.extend(item.experiments.iter().cloned());
        if item.experiments.is_empty() {
            loads[at].still.push(item.entry.file.clone());
        }
    }
    loads.sort_by(|a, b| a.extra_mass_kg.total_cmp(&b.extra_mass_kg));
    let swings = JointSwings { joint, case, loads };
    if swings.loaded().count() < 2 {
        return Err(TablesError::TooFewSwings { folder: folder.to_path_buf(), joint });
    }
    swings.leg()?;
    Ok(swings)
}

impl JointSwings {
    /// Loads with an extra mass with which the joint moves, the lightest first.
    pub fn loaded(&self) -> impl Iterator<Item = &Load> {
        self.loads.iter().filter(|load| load.extra_mass_kg > 0.0 && !load.moving.is_empty())
    }

    /// The bare swings, where there are any.
    pub fn bare(&self) -> Option<&Load> {
        self.loads.iter().find(|load| load.extra_mass_kg == 0.0)
    }

    /// The load whose tests the thesis took (3.3.2): the bare one, or the lightest with which the joint moves.
    pub fn thesis_choice(&self) -> Option<&Load> {
        self.loads.iter().find(|load| !load.moving.is_empty())
    }

    /// All logs in which the joint moves.
    pub fn moving(&self) -> Vec<Experiment> {
        self.loads.iter().flat_map(|load| load.moving.iter().cloned()).collect()
    }

    pub(super) fn leg(&self) -> Result<&LegCase, TablesError> {
        self.case.leg.as_ref().ok_or(TablesError::NoPose { joint: self.joint })
    }

    /// The simple model (3.2) fitted to swings with one load; `g_over_l_1_s2` is set where it is given.
    pub(super) fn simple(
        &self,
        experiments: &[Experiment],
        g_over_l_1_s2: Option<f64>,
    ) -> Result<Fitted<SimpleModel>, TablesError> {
        let scale = Scale::of(experiments, self.case.joint.nominal.as_ref(), None);
        let mut model = SimpleModel::new(&scale, false);
        if let Some(set) = g_over_l_1_s2 {
            let fix = vec![("g_over_l".to_owned(), Some(set))];
            Directives { fix, ..Directives::default() }.apply(model.parameters_mut())?;
        }
        Ok(conclude(&model, experiments, Method::Lm, Budget::default())?)
    }

    /// The extensive model (3.13) by its bodies: the first body that swings is weighed, `held` holds parameters.
    pub(super) fn extensive(
        &self,
        experiments: &[Experiment],
        held: &[(String, f64)],
    ) -> Result<Fitted<ExtensiveModel>, TablesError> {
        let leg = self.leg()?;
        let nominal = self.case.joint.nominal.as_ref();
        let scale = Scale::of(experiments, nominal, None);
        let mut model = ExtensiveModel::bodies(&scale, experiments, &leg.masses()?, leg.pose_known, nominal, false);
        let fix = held.iter().map(|(name, value)| (name.clone(), Some(*value))).collect();
        Directives { fix, ..Directives::default() }.apply(model.parameters_mut())?;
        Ok(conclude(&model, experiments, Method::Lm, Budget::default())?)
    }
}
