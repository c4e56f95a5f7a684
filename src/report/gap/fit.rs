//! `fit.json` of a diagnosis: the joint with the effects of the answer, for `simulate`.

use super::GapReport;
use super::rows::{joint_rows, number_row, residual_rms_rad};
use crate::gap::hypothesis::rotor::armature_kg_m2;
use crate::gap::{Diagnosis, LogTraces, Number};
use crate::identify::{Case, Signal};
use crate::joint::EffectId;
use crate::log::MotorModel;
use crate::report::{DriveGains, EffectFit, FitFile, JointFit, LogFit, Quantity, SCHEMA};
use std::collections::BTreeMap;

/// The effects of the answer with their forms and their parameters by the catalogue's names.
fn effect_fits(diagnosis: &Diagnosis) -> Vec<EffectFit> {
    let cause = |effect: EffectId| diagnosis.causes.iter().find(|cause| cause.effect == effect);
    let form = |effect| cause(effect).map(|cause| cause.form).filter(|form| !form.is_empty()).map(str::to_owned);
    let logs = |effect| cause(effect).and_then(|cause| cause.only.as_ref()).map(|only| only.files.clone());
    let fit = |(effect, numbers): &(EffectId, Vec<Number>)| EffectFit {
        id: effect.id().to_owned(),
        form: form(*effect),
        logs: logs(*effect).unwrap_or_default(),
        parameters: quantities(numbers),
    };
    diagnosis.effect_parameters.iter().map(fit).collect()
}

/// Parameters by name.
pub(in crate::report) fn quantities(numbers: &[Number]) -> BTreeMap<String, Quantity> {
    numbers.iter().map(|number| (number.name.clone(), Quantity::of(&number_row(number)))).collect()
}

/// The armature that all motors of a joint's logs state \[kg m^2\]; `None`: none, or not the same.
pub(super) fn stated_armature_kg_m2(case: &Case) -> Option<f64> {
    let motors = case.items.iter().flat_map(|item| &item.experiments).filter_map(|e| e.motor.as_ref());
    let mut stated_kg_m2 = motors.map(|motor| motor.armature_kg_m2);
    let first_kg_m2 = stated_kg_m2.next().filter(|first_kg_m2| *first_kg_m2 > 0.0)?;
    stated_kg_m2.all(|other_kg_m2| other_kg_m2 == first_kg_m2).then_some(first_kg_m2)
}

/// The gains that all drives of a joint's logs state; `None`: none, not the same, or those of a motor fed by voltage.
pub(super) fn stated_gains(case: &Case) -> Option<DriveGains> {
    let all = case.items.iter().flat_map(|item| &item.experiments);
    let driven = all.filter(|e| matches!(e.signal, Signal::Position { .. })).filter_map(|e| e.motor.as_ref());
    let mut stated = driven.map(|motor| {
        let gains = DriveGains { kp_nm_rad: motor.kp_nm_rad, kd_nm_s_rad: motor.kd_nm_s_rad };
        (motor.model == MotorModel::Torque).then_some(gains)
    });
    let first = stated.next()??;
    stated.all(|other| other == Some(first)).then_some(first)
}

/// The joint's numbers as they were fitted.
pub(super) fn joint(report: &GapReport) -> JointFit {
    JointFit { armature: armature(report), ..JointFit::of(&joint_rows(&report.diagnosis)) }
}

/// The armature with which a diagnosis was fitted: it has the share of what is stated that the inertia has.
fn armature(report: &GapReport) -> Option<Quantity> {
    let stated_kg_m2 = report.armature_kg_m2?;
    let rows = joint_rows(&report.diagnosis);
    let inertia = rows.iter().find(|row| row.name == "inertia")?;
    let nominal_kg_m2 = inertia.nominal?;
    let of = |inertia_kg_m2: f64| armature_kg_m2(stated_kg_m2, inertia_kg_m2 / nominal_kg_m2);
    let inertia = Quantity::of(inertia);
    Some(Quantity {
        value: inertia.value.map(of),
        interval: inertia.interval.map(|ends| ends.map(of)),
        interval_naive: inertia.interval_naive.map(|ends| ends.map(of)),
        ..inertia
    })
}

impl FitFile {
    /// The file of a diagnosis: the joint's parameters and those of the effects of the answer, fitted together.
    pub fn of_diagnosis(report: &GapReport) -> Self {
        let GapReport { diagnosis, provenance, .. } = report;
        let mut joint = joint(report);
        // A gain that is named as an effect stands there alone: what simulates the file would have it twice.
        if diagnosis.effect_parameters.iter().any(|(effect, _)| *effect == EffectId::MotorGain) {
            joint.gain = None;
        }
        Self {
            schema: SCHEMA,
            name: diagnosis.joint.clone(),
            joint,
            effects: effect_fits(diagnosis),
            law: diagnosis.law.as_ref().map(|law| law.table.clone()),
            masses: BTreeMap::new(),
            drive: report.drive,
            ratios: BTreeMap::new(),
            beliefs: diagnosis.beliefs.iter().map(|belief| (belief.name.clone(), belief.clone())).collect(),
            undetermined: diagnosis.undetermined.clone(),
            models: BTreeMap::new(),
            whole_robot: Vec::new(),
            whole_robot_refit: None,
            logs: diagnosis.traces.iter().filter_map(|log| log_fit(diagnosis, log)).collect(),
            notes: diagnosis.notes.clone(),
            sentence: diagnosis.answer.sentence.clone(),
            method: String::new(),
            stop: String::new(),
            version: provenance.version.clone(),
            inputs: provenance.inputs.iter().cloned().collect(),
        }
    }
}

/// What the answer leaves of a log; `None` where it predicts nothing that can be compared.
fn log_fit(diagnosis: &Diagnosis, log: &LogTraces) -> Option<LogFit> {
    let rms = residual_rms_rad(log, &log.after_rad);
    let predicted = if diagnosis.gap.is_held_out() { &diagnosis.gap.per_log[..] } else { &[][..] };
    let held_out = predicted.iter().find(|gap| gap.file == log.file).map(|gap| gap.after);
    rms.is_finite().then(|| LogFit {
        file: log.file.clone(),
        role: log.role.clone(),
        rms,
        rms_held_out: held_out.filter(|rms| rms.is_finite()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_are_told_where_all_logs_state_the_same() {
        let mut case = Case::of_study("data/examples/delay/study.toml".as_ref()).unwrap();
        let stated = DriveGains { kp_nm_rad: 8.0, kd_nm_s_rad: 0.15 };
        assert_eq!(stated_gains(&case), Some(stated));
        let mut another = case.items[0].clone();
        another.experiments.iter_mut().for_each(|e| e.motor.as_mut().unwrap().kp_nm_rad = 9.0);
        case.items.push(another);
        assert_eq!(stated_gains(&case), None);
        case.items.clear();
        assert_eq!(stated_gains(&case), None);
    }
}
