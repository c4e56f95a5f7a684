//! `fit.json`: what a fit found, for programs (specification, section 6).

use super::{DropReport, FullRow, ModelSummary, ParameterRow, ParameterStatus, RefitSummary};
use crate::identify::{BeliefFound, DropFit, Named};
use crate::joint::LawTable;
use crate::number::quantity;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The format's version.
pub const SCHEMA: u32 = 1;

/// A fit as it is written and read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitFile {
    /// [`SCHEMA`].
    pub schema: u32,
    /// The joint's name.
    #[serde(default)]
    pub name: String,
    /// The bare link and its friction.
    pub joint: JointFit,
    /// Effects beyond the baseline joint.
    #[serde(default)]
    pub effects: Vec<EffectFit>,
    /// A law without a formula, beside the effects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<LawTable>,
    /// Masses of the link's bodies \[kg\], where they were the parameters.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub masses: BTreeMap<String, Quantity>,
    /// Gains that the study states of the drive: `joint.gain` and `joint.kd` are factors of them. Absent where logs have
    /// different ones, and of a motor that is fed by voltage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive: Option<DriveGains>,
    /// Ratios to the inertia, where the logs determine nothing else.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub ratios: BTreeMap<String, Quantity>,
    /// What the study states of the numbers and what the logs made of it, where it states anything.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub beliefs: BTreeMap<String, BeliefFound>,
    /// What the logs leave to what is believed, in sentences.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub undetermined: Vec<String>,
    /// The models that were fitted, `simple` and `extensive`.
    #[serde(default)]
    pub models: BTreeMap<String, ModelFit>,
    /// RMS per log, of the extensive model.
    #[serde(default)]
    pub logs: Vec<LogFit>,
    /// Each drop in the whole robot, where the logs are of a leg whose pose is known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub whole_robot: Vec<FullRow>,
    /// The whole robot refitted to the drops, with each explanation and without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whole_robot_refit: Option<RefitSummary>,
    /// What was said to the reader.
    #[serde(default)]
    pub notes: Vec<String>,
    /// One sentence.
    #[serde(default)]
    pub sentence: String,
    /// `lm`, `bfgs` or `dfp`.
    #[serde(default)]
    pub method: String,
    /// Why the optimiser stopped.
    #[serde(default)]
    pub stop: String,
    /// Version of the program.
    #[serde(default)]
    pub version: String,
    /// Input files and their SHA-256.
    #[serde(default)]
    pub inputs: BTreeMap<String, String>,
}

/// The baseline joint's numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointFit {
    /// `I*` \[kg m^2\]
    pub inertia: Quantity,
    /// `M*` \[kg m\]
    pub moment: Quantity,
    /// `mu_c` \[N m\]
    pub coulomb: Quantity,
    /// `mu_v` \[N m s/rad\]
    pub viscous: Quantity,
    /// Inertia of what turns with the motor \[kg m^2\], where the study states one and the fit scaled it with the link's;
    /// absent: as stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub armature: Option<Quantity>,
    /// Angle at which the bare link hangs \[rad\].
    #[serde(default)]
    pub rest: Option<Quantity>,
    /// Torque that arrives per torque that is commanded; absent where it was not fitted, and then 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<Quantity>,
    /// The control law's derivative gain per stated one; absent where it was not fitted, and then 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kd: Option<Quantity>,
    /// Its integral gain per stated one, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ki: Option<Quantity>,
}

/// Gains of a drive, `torque = kp (q_ref - q) - kd q'`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DriveGains {
    /// \[N m/rad\]
    pub kp_nm_rad: f64,
    /// \[N m s/rad\]
    pub kd_nm_s_rad: f64,
}

/// A number with its unit and its intervals.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// The estimate, or the value at which it was held; null where there is none.
    pub value: Option<f64>,
    /// Its unit.
    #[serde(default)]
    pub unit: String,
    /// 95 % by logs and beliefs, allowing for correlated residuals; null where they do not determine the quantity.
    #[serde(default)]
    pub interval: Option<[f64; 2]>,
    /// 95 %, as if residuals were white.
    #[serde(default)]
    pub interval_naive: Option<[f64; 2]>,
    /// Whether the logs determine it, with what is believed of the numbers.
    #[serde(default)]
    pub identifiable: bool,
}

/// An effect with its parameters, by the catalogue's names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectFit {
    /// The catalogue's id.
    pub id: String,
    /// Its form; the family's default where none is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<String>,
    /// Files of the logs in which it holds; empty: all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub logs: Vec<String>,
    /// By name.
    pub parameters: BTreeMap<String, Quantity>,
}

/// One fitted model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelFit {
    /// \[rad\]
    pub rms: f64,
    /// The integral (3.7) \[rad^2 s\].
    pub criterion: f64,
    /// By name.
    pub parameters: BTreeMap<String, Quantity>,
}

/// One log's residual.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogFit {
    /// As the user named it.
    pub file: String,
    /// `fit` or `validate`.
    pub role: String,
    /// \[rad\]
    pub rms: f64,
    /// Predicted from the other logs alone \[rad\]; absent where that was not done.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_held_out: Option<f64>,
}

impl EffectFit {
    /// `delay (T = 0.0161 [0.0156, 0.0167] s)`
    pub(crate) fn words(&self) -> String {
        let value =
            |(name, of): (&String, &Quantity)| Some(format!("{name} = {}", quantity(of.value?, of.interval, &of.unit)));
        let values: Vec<String> = self.parameters.iter().filter_map(value).collect();
        let values = if values.is_empty() { String::new() } else { format!(" ({})", values.join(", ")) };
        let only = if self.logs.is_empty() { String::new() } else { format!(" in {} only", self.logs.join(", ")) };
        format!("{}{values}{only}", self.id)
    }
}

impl Quantity {
    /// What a row of the tables says; JSON has no word for what is not finite, so that becomes null.
    pub(super) fn of(row: &ParameterRow) -> Self {
        let finite = |interval: Option<[f64; 2]>| interval.filter(|ends| ends.iter().all(|end| end.is_finite()));
        Self {
            value: row.value.is_finite().then_some(row.value),
            unit: row.unit.clone(),
            interval: finite(row.interval),
            interval_naive: finite(row.interval_naive),
            identifiable: row.status == ParameterStatus::Determined,
        }
    }
}

impl JointFit {
    /// From rows with the names of the baseline's parameters.
    pub(super) fn of(rows: &[ParameterRow]) -> Self {
        let quantity = |name: &str| rows.iter().find(|r| r.name == name).map(Quantity::of);
        let searched =
            |name: &str| rows.iter().find(|r| r.name == name && r.status != ParameterStatus::Held).map(Quantity::of);
        Self {
            inertia: quantity("inertia").unwrap_or_default(),
            moment: quantity("moment").unwrap_or_default(),
            coulomb: quantity("coulomb").unwrap_or_default(),
            viscous: quantity("viscous").unwrap_or_default(),
            armature: None,
            rest: quantity("rest"),
            gain: searched("gain"),
            kd: searched("kd"),
            ki: searched("ki"),
        }
    }
}

impl FitFile {
    /// The file of a drop fit and its report.
    pub fn of_drop(fit: &DropFit, report: &DropReport) -> Self {
        let rows = super::assemble::joint_rows(fit);
        let joint = JointFit::of(&rows);
        let masses = fit.extensive.estimates.iter().filter(|e| matches!(e.named(), Some(Named::Mass(_))));
        let stribeck = super::assemble::stribeck_rows(fit);
        let effects = if stribeck.is_empty() {
            Vec::new()
        } else {
            let parameters = stribeck.iter().map(|row| (row.name.clone(), Quantity::of(row))).collect();
            vec![EffectFit { id: "stribeck".into(), form: None, logs: Vec::new(), parameters }]
        };
        let ratios = super::assemble::ratio_rows(fit);
        let key = |m: &ModelSummary| if m.name.starts_with("simple") { "simple" } else { "extensive" };
        let model = |m: &ModelSummary| ModelFit {
            rms: m.rms_rad,
            criterion: m.criterion_rad2_s,
            parameters: m.parameters.iter().map(|row| (row.name.clone(), Quantity::of(row))).collect(),
        };
        let extensive = report.models.iter().find(|m| key(m) == "extensive");
        Self {
            schema: SCHEMA,
            name: report.joint.clone(),
            joint,
            effects,
            law: None,
            masses: masses.map(|e| (e.name.clone(), Quantity::of(&super::assemble::row(e)))).collect(),
            drive: None,
            ratios: ratios.iter().map(|row| (row.name.clone(), Quantity::of(row))).collect(),
            beliefs: fit.beliefs.iter().map(|belief| (belief.name.clone(), belief.clone())).collect(),
            undetermined: fit.undetermined.clone(),
            models: report.models.iter().map(|m| (key(m).to_owned(), model(m))).collect(),
            whole_robot: report.full.as_ref().map(|full| full.rows.clone()).unwrap_or_default(),
            whole_robot_refit: report.full.as_ref().and_then(|full| full.refit.clone()),
            logs: report
                .logs
                .iter()
                .enumerate()
                .map(|(i, l)| LogFit {
                    file: l.file.clone(),
                    role: l.role.clone(),
                    rms: l.extensive_rms_rad,
                    // Held out in turn only where every log is a fitted one, so the order is the same.
                    rms_held_out: fit.held_out_rms_rad.get(i).copied().filter(|rms| rms.is_finite()),
                })
                .collect(),
            notes: report.notes.clone(),
            sentence: report.sentence.clone(),
            method: extensive.map(|m| m.method.clone()).unwrap_or_default(),
            stop: extensive.map(|m| m.stop.clone()).unwrap_or_default(),
            version: report.provenance.version.clone(),
            inputs: report.provenance.inputs.iter().cloned().collect(),
        }
    }
}
