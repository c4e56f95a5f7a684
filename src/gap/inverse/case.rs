//! A study of a robot with a clamped base whose torques are predicted along its measured motion.

use super::design::{JointData, LogData};
use super::numbers::{Values, believed};
use super::signals::{Motion, Signals, TorqueOf, cutoff_hz, logged, without_armature};
use crate::gap::clamped::{ClampedCaseError, ClampedSetup};
use crate::log::{Derivative, DriveMode, Hold, MotorModel, RobotLog, Role};
use crate::robot::tree::{Tree, TreeBase};
use std::collections::BTreeMap;

/// A robot, its logs, and what the motion in them asks of its drives.
#[derive(Clone, Debug)]
pub struct TorqueCase {
    /// The robot's name.
    pub robot: String,
    /// Joints that may share a cause, by the group's name.
    pub groups: BTreeMap<String, Vec<String>>,
    /// What the reader has to know of how the case was made.
    pub notes: Vec<String>,
    pub(super) joints: Vec<JointData>,
    pub(super) logs: Vec<LogData>,
}

impl TorqueCase {
    /// The case of a robot whose logs have the torques of its drives.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where no log has a torque.
    pub fn of(setup: &ClampedSetup) -> Result<Self, ClampedCaseError> {
        let torques = |k: usize| logged(&setup.logs[k]);
        let case = Self::with(setup, &torques)?;
        if case.joints.is_empty() {
            return Err(ClampedCaseError::NoTorque { file: setup.study.file.clone() });
        }
        Ok(case)
    }

    /// The case of a robot whose drives' torques follow from its setpoints, as study and description state its servos:
    /// good enough to ask which bodies are other than described. `late_s` are delays of the setpoints by joint.
    ///
    /// # Errors
    /// [`ClampedCaseError`], which does not depend on the logs.
    pub(super) fn commanded(setup: &ClampedSetup, late_s: &BTreeMap<String, f64>) -> Result<Self, ClampedCaseError> {
        let ClampedSetup { study, description, logs, .. } = setup;
        let torques = |k: usize| -> Box<TorqueOf<'_>> {
            let (entry, log) = (&study.logs[k], &logs[k]);
            if entry.drive == DriveMode::Torque {
                return logged(log);
            }
            Box::new(move |columns, angle_rad, rate_rad_s, grid| {
                let at = description.joint(&columns.name)?;
                let said = setup.beliefs(at);
                if entry.drive == DriveMode::Off || columns.drive.is_some() {
                    // Who switches a motor within a log is not asked.
                    return (columns.drive.is_none()).then(|| vec![0.0; angle_rad.len()]);
                }
                let (kp, kd) = (said.kp_nm_rad?, said.kd_nm_s_rad.unwrap_or(0.0));
                // A value that is held acts half a period later, on average.
                let held_s =
                    if study.hold == Hold::Step { 0.5 * study.sample_period_s.unwrap_or(grid.period_s) } else { 0.0 };
                let late_s = held_s + late_s.get(&columns.name).copied().unwrap_or(0.0);
                let setpoint_rad = grid.late(log, columns.q_ref_rad.as_ref()?, late_s);
                let most_nm = said.torque_limit_nm.unwrap_or(f64::INFINITY);
                let is_torque = said.model.is_none_or(|model| model == MotorModel::Torque);
                let torque = |k: usize| {
                    let damped = match study.derivative {
                        Derivative::Measurement => rate_rad_s[k],
                        Derivative::Error => rate_rad_s[k] - grid.slope(&setpoint_rad, k),
                    };
                    (kp * (setpoint_rad[k] - angle_rad[k]) - kd * damped).clamp(-most_nm, most_nm)
                };
                is_torque.then(|| (0..angle_rad.len()).map(torque).collect())
            })
        };
        Self::with(setup, &torques)
    }

    /// The motion of the robot along each log.
    pub(super) fn motions(&self, setup: &ClampedSetup, tree: &Tree) -> Vec<Motion> {
        let cutoff_hz = cutoff_hz(&setup.logs);
        setup.logs.iter().map(|log| Motion::new(tree, log, cutoff_hz)).collect()
    }

    /// The same with torques of any kind, by the log's place in the study.
    pub(super) fn with<'a>(
        setup: &'a ClampedSetup,
        torques: &dyn Fn(usize) -> Box<TorqueOf<'a>>,
    ) -> Result<Self, ClampedCaseError> {
        let ClampedSetup { study, description, logs, .. } = setup;
        let of_tree = |source| ClampedCaseError::Tree { file: study.model_path.clone(), source };
        let bare = Tree::new(&without_armature(description), TreeBase::Fixed).map_err(of_tree)?;
        let bare = bare.with_gravity(setup.tree.gravity_m_s2());
        let cutoff_hz = cutoff_hz(logs);
        let motions: Vec<Motion> = logs.iter().map(|log| Motion::new(&bare, log, cutoff_hz)).collect();
        let mut signals: Vec<Vec<Option<Signals>>> =
            (0..logs.len()).map(|k| motions[k].signals((description, &bare), &logs[k], &*torques(k))).collect();
        let gravity_m_s2 = Some(bare.gravity_m_s2().norm()).filter(|g| *g > 0.0);
        let gravity_m_s2 = gravity_m_s2.unwrap_or(crate::number::STANDARD_GRAVITY_M_S2);
        let mut joints = Vec::new();
        for (j, at) in bare.joints().iter().enumerate() {
            let own: Vec<Option<Signals>> = signals.iter_mut().map(|log| log[j].take()).collect();
            let own: Vec<Option<Signals>> =
                own.into_iter().map(|signals| signals.filter(|signals| signals.torque_nm.is_some())).collect();
            let mover = &description.joints[at.0];
            if let Some(believed) = beliefs(setup, &mover.name, at.0, &own, gravity_m_s2) {
                joints.push(JointData { name: mover.name.clone(), believed, logs: own });
            }
        }
        let resampled = motions.iter().any(|motion| motion.grid.is_resampled);
        let entries = study.logs.iter().zip(motions);
        let log_data = |(entry, motion): (&crate::log::ClampedStudyLog, Motion)| LogData {
            file: entry.file.clone(),
            is_fit: entry.role == Role::Fit,
            tied: motion.grid.tied(),
            grid: motion.grid,
        };
        let mut notes = vec![format!(
            "Torques along the measured motion: inverse dynamics with armature and friction against the drives' torques, \
             both below {} Hz (Butterworth, third order, forward and back; {} s are left out at either end). At rest \
             friction is only bounded.",
            crate::number::as_given(cutoff_hz),
            crate::number::as_given(2.5 / cutoff_hz)
        )];
        if resampled {
            notes.push("Stamps are uneven: readings were put on an even grid by straight lines.".to_owned());
        }
        notes.extend(without_torque(logs, &joints));
        notes.extend(description.left_out.iter().cloned());
        Ok(Self {
            robot: description.name.clone(),
            groups: setup.groups(),
            notes,
            joints,
            logs: entries.map(log_data).collect(),
        })
    }
}

/// What is known of a joint; `None` where no log has a torque of it.
fn beliefs(
    setup: &ClampedSetup,
    name: &str,
    at: usize,
    logs: &[Option<Signals>],
    gravity_m_s2: f64,
) -> Option<super::numbers::Believed> {
    let shown: Vec<&Signals> = logs.iter().flatten().collect();
    if shown.is_empty() {
        return None;
    }
    let mover = &setup.description.joints[at];
    let said = setup.study.of_joint(name);
    let most = |of: fn(&Signals) -> &[f64]| {
        shown.iter().flat_map(|signals| of(signals)).fold(0.0_f64, |most, value| most.max(value.abs()))
    };
    let inertia = shown.iter().map(|signals| signals.own_inertia_kg_m2).sum::<f64>() / shown.len() as f64;
    let gravity_nm = most(|signals| &signals.gravity_nm);
    let values: Values = [
        inertia,
        if gravity_nm > 1e-6 { gravity_nm / gravity_m_s2 } else { 0.0 },
        said.armature_kg_m2.unwrap_or(mover.armature_kg_m2),
        said.coulomb_nm.unwrap_or(mover.friction_nm),
        said.viscous_nm_s_rad.unwrap_or(mover.damping[0]),
        1.0,
    ];
    let uncertain = &setup.study.uncertain;
    let mass = uncertain.mass.of(name);
    let friction = uncertain.friction.of(name);
    let by_position = setup.study.logs.iter().any(|log| log.drive == DriveMode::Position);
    let gain = if by_position { uncertain.gain.of(name) } else { uncertain.torque.of(name) };
    let relative = [mass, mass, uncertain.inertia.of(name), friction, friction, gain];
    let largest_nm = most(|signals| signals.torque_nm.as_deref().unwrap_or_default());
    Some(believed(values, relative, largest_nm, most(|signals| &signals.rate_rad_s)))
}

/// Joints that move without a torque.
fn without_torque(logs: &[RobotLog], joints: &[JointData]) -> Option<String> {
    let mut names: Vec<&str> = logs.iter().flat_map(|log| log.joints.iter().map(|joint| joint.name.as_str())).collect();
    names.retain(|name| joints.iter().all(|joint| joint.name != *name));
    names.sort_unstable();
    names.dedup();
    (!names.is_empty()).then(|| format!("No torque of {}: taken to move as measured.", names.join(", ")))
}
