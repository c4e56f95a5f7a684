//! A study of a robot with a clamped base, made ready: one bench case for each joint.

use super::along::Along;
use super::setup::{ClampedCaseError, ClampedSetup};
use crate::identify::Case;
use crate::log::{
    ArrayLog, ClampedStudy, DriveMode, JointBeliefs, JointSpec, MotorSpec, Nominal, RobotLog, Spread, Uncertain,
};
use crate::robot::description::Mover;
use std::collections::BTreeMap;

/// A robot and its logs.
#[derive(Debug)]
pub struct ClampedCase {
    /// The robot's name.
    pub robot: String,
    /// In the description's order; those that logs show.
    pub joints: Vec<ClampedJoint>,
    /// Joints that may share a cause, by the group's name.
    pub groups: BTreeMap<String, Vec<String>>,
    /// What the reader has to know of how the case was made.
    pub notes: Vec<String>,
}

/// One joint of a robot as a case of the bench.
#[derive(Debug)]
pub struct ClampedJoint {
    /// Its name.
    pub name: String,
    /// Its logs, each with what it carries along it.
    pub case: Case,
}

impl ClampedCase {
    /// The case of a robot and its logs.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where a joint's logs make no case.
    pub fn of(setup: &ClampedSetup) -> Result<Self, ClampedCaseError> {
        let ClampedSetup { study, description, tree, logs } = setup;
        let along = Along::new(description, tree);
        let links = along.links(logs);
        let mut joints = Vec::new();
        let mut unseen = Vec::new();
        for (at, link) in tree.joints().iter().zip(links) {
            let mover = &description.joints[at.0];
            if logs.iter().all(|log| log.joint(&mover.name).is_none()) {
                unseen.push(mover.name.clone());
                continue;
            }
            let (bare, carriages) = link.ok_or_else(|| ClampedCaseError::NoInertia { joint: mover.name.clone() })?;
            let maker = Maker { study, mover, said: setup.beliefs(*at), gravity_m_s2: along.gravity_m_s2() };
            let mut case = maker.case(bare, logs)?;
            let with_it = logs.iter().zip(carriages).filter(|(log, _)| log.joint(&mover.name).is_some());
            for (item, (_, carriage)) in case.items.iter_mut().zip(with_it) {
                for e in &mut item.experiments {
                    e.carriage = Some(carriage.clone());
                }
            }
            joints.push(ClampedJoint { name: mover.name.clone(), case });
        }
        let mut notes = Vec::new();
        if !unseen.is_empty() {
            notes.push(format!("No log has {}: taken to stand as drawn.", unseen.join(", ")));
        }
        notes.extend(description.left_out.iter().cloned());
        Ok(Self { robot: description.name.clone(), joints, groups: setup.groups(), notes })
    }
}

/// What a joint's case is made from.
struct Maker<'a> {
    study: &'a ClampedStudy,
    mover: &'a Mover,
    said: JointBeliefs,
    gravity_m_s2: f64,
}

impl Maker<'_> {
    fn case(&self, bare: Nominal, logs: &[RobotLog]) -> Result<Case, ClampedCaseError> {
        let name = &self.mover.name;
        let coulomb_nm = self.said.coulomb_nm.unwrap_or(self.mover.friction_nm);
        let viscous_nm_s_rad = self.said.viscous_nm_s_rad.unwrap_or(self.mover.damping[0]);
        let joint = JointSpec {
            name: name.clone(),
            nominal: Some(Nominal { coulomb_nm, viscous_nm_s_rad, ..bare }),
            gravity_m_s2: self.gravity_m_s2,
            rest_rad: None,
        };
        let arrays = self.study.logs.iter().zip(logs).filter_map(|(entry, log)| {
            let own = log.joint(name)?;
            Some(ArrayLog {
                q_ref_rad: own.q_ref_rad.clone(),
                tau_nm: if entry.drive == DriveMode::Torque { own.tau_nm.clone() } else { None },
                on: own.drive.clone(),
                role: entry.role,
                drive: entry.drive,
                session: entry.session.clone(),
                ..ArrayLog::new(entry.file.clone(), log.t_s.clone(), own.q_rad.clone())
            })
        });
        let arrays: Vec<ArrayLog> = arrays.collect();
        let is_driven_by_position = arrays.iter().any(|log| log.drive == DriveMode::Position);
        let motor = match self.said.kp_nm_rad {
            Some(kp_nm_rad) => self.motor(kp_nm_rad),
            None if is_driven_by_position => {
                return Err(ClampedCaseError::NoGain { file: self.study.file.clone(), joint: name.clone() });
            }
            // Only its gears matter.
            None => self.motor(0.0),
        };
        Case::of_arrays(joint, self.study.sensor, Some(motor), self.uncertain(), arrays)
            .map_err(|source| ClampedCaseError::Joint { joint: name.clone(), source: Box::new(source) })
    }

    fn motor(&self, kp_nm_rad: f64) -> MotorSpec {
        let said = &self.said;
        MotorSpec {
            kp_nm_rad,
            ki_nm_rad_s: said.ki_nm_rad_s.unwrap_or(0.0),
            kd_nm_s_rad: said.kd_nm_s_rad.unwrap_or(0.0),
            hold: self.study.hold,
            derivative: self.study.derivative,
            sample_period_s: self.study.sample_period_s,
            torque_limit_nm: said.torque_limit_nm,
            // A line of torque against speed needs the stall torque.
            speed_limit_rad_s: said.speed_limit_rad_s.filter(|_| said.torque_limit_nm.is_some()),
            model: said.model.unwrap_or_default(),
            encoder: said.encoder.unwrap_or_default(),
            armature_kg_m2: said.armature_kg_m2.unwrap_or(self.mover.armature_kg_m2),
        }
    }

    /// What is uncertain of this joint: inertia and moment by the masses of what it carries.
    fn uncertain(&self) -> Uncertain {
        let name = &self.mover.name;
        let all = &self.study.uncertain;
        let own = |spread: &Spread| Spread::of_all(spread.of(name));
        Uncertain {
            inertia: own(&all.mass),
            moment: own(&all.mass),
            friction: own(&all.friction),
            gain: own(&all.gain),
            torque: own(&all.torque),
            ..all.clone()
        }
    }
}
