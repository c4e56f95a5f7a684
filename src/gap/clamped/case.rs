//! A study of a robot with a clamped base, made ready: one bench case for each joint.

use super::along::Along;
use super::followed::SimulatedMotion;
use super::setup::{ClampedCaseError, ClampedSetup};
use crate::gap::hypothesis::evidence::WholeLeft;
use crate::gap::verdict::told::AtBest;
use crate::identify::Case;
use crate::log::{
    ArrayLog, DriveMode, JointBeliefs, JointSpec, Nominal, RobotLog, Spread, Uncertain, check_joint_inputs,
};
use crate::number::extent;
use crate::robot::description::{FoundNumber, Mover, MoverId};
use std::collections::BTreeMap;

/// A robot and its logs.
#[derive(Clone, Debug)]
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
#[derive(Clone, Debug)]
pub struct ClampedJoint {
    /// Its name.
    pub name: String,
    /// Its logs, each with what it carries along it.
    pub case: Case,
    /// The same of the robot as described, where bodies have other masses in `case`, or others move otherwise.
    pub as_described: Option<Case>,
    /// Whether it carries bodies which are other than described.
    pub(in crate::gap) has_bodies: bool,
    /// What the whole robot, simulated at its best, leaves of it.
    pub(in crate::gap) whole: Option<WholeLeft>,
    /// Its causes as that has them, where it explains all joints.
    pub(in crate::gap) at_best: Vec<AtBest>,
    /// Whether the whole robot needs no causes of joints.
    pub(in crate::gap) needs_no_cause: bool,
}

impl ClampedCase {
    /// The case of a robot and its logs, for each of which a simulation may help to follow the joints' motion. What joints push
    /// one another with is that of `masses`, where there are any; the joints' own numbers are as described.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where a joint's logs make no case.
    pub(in crate::gap) fn along(
        setup: &ClampedSetup,
        masses: &[FoundNumber],
        simulated: &[Option<SimulatedMotion>],
    ) -> Result<Self, ClampedCaseError> {
        let ClampedSetup { description, tree, logs, .. } = setup;
        let along = Along::new(description, tree);
        let mut links = along.links(logs, simulated);
        if !masses.is_empty() {
            let weighed = setup.with_masses(masses)?;
            let with_them = Along::new(&weighed.description, &weighed.tree).links(logs, simulated);
            let pairs = links.into_iter().zip(with_them);
            links = pairs.map(|(own, weighed)| Some((own?.0, weighed?.1))).collect();
        }
        let mut joints = Vec::new();
        let mut unseen = Vec::new();
        for (at, link) in tree.joints().iter().zip(links) {
            let mover = &description.joints[at.0];
            if logs.iter().all(|log| log.joint(&mover.name).is_none()) {
                unseen.push(mover.name.clone());
                continue;
            }
            let (bare, carriages) = link.ok_or_else(|| ClampedCaseError::NoInertia { joint: mover.name.clone() })?;
            let maker = Maker { setup, at: *at, mover, said: setup.beliefs(*at), gravity_m_s2: along.gravity_m_s2() };
            let mut case = maker.case(bare, logs)?;
            let with_it = logs.iter().zip(carriages).filter(|(log, _)| log.joint(&mover.name).is_some());
            for (item, (_, carriage)) in case.items.iter_mut().zip(with_it) {
                for e in &mut item.experiments {
                    e.carriage = Some(carriage.clone());
                }
            }
            joints.push(ClampedJoint {
                name: mover.name.clone(),
                case,
                as_described: None,
                has_bodies: false,
                whole: None,
                at_best: Vec::new(),
                needs_no_cause: false,
            });
        }
        let mut notes = Vec::new();
        if !unseen.is_empty() {
            notes.push(format!("No log has {}: taken to stand as drawn.", unseen.join(", ")));
        }
        notes.extend(description.joints.iter().filter_map(|mover| beyond(mover, logs)));
        notes.extend(logs.iter().filter_map(RobotLog::remark));
        notes.extend(description.left_out.iter().cloned());
        Ok(Self { robot: description.name.clone(), joints, groups: setup.groups(), notes })
    }
}

/// A remark where what is asked of a joint lies where the description says that it cannot go.
fn beyond(mover: &Mover, logs: &[RobotLog]) -> Option<String> {
    const SLACK: f64 = 0.01;
    let asked = logs.iter().filter_map(|log| log.joint(&mover.name)?.q_ref_rad.as_ref()).flatten();
    let what = mover.beyond_limits("setpoints go", extent(asked.copied()), SLACK)?;
    Some(format!("{what}, where a simulation of the whole robot holds it: is its zero, sign or unit another?"))
}

/// What a joint's case is made from.
struct Maker<'a> {
    setup: &'a ClampedSetup,
    at: MoverId,
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
        let entries = self.setup.study.logs.iter().zip(logs);
        for (i, (entry, log)) in entries.clone().enumerate() {
            let own = log.joint(name).map(|own| (log, own));
            own.map_or(Ok(()), |own| check_joint_inputs(&self.setup.study.file, i, entry.drive, own))?;
        }
        let arrays = entries.filter_map(|(entry, log)| {
            let own = log.joint(name)?;
            let tau_is = self.said.tau_is.filter(|_| entry.drive == DriveMode::Position && own.tau_nm.is_some());
            Some(ArrayLog {
                q_ref_rad: own.q_ref_rad.clone(),
                setpoints: own.setpoints.clone(),
                holes_are_known: true,
                tau_nm: own.tau_nm.clone().filter(|_| entry.drive == DriveMode::Torque || tau_is.is_some()),
                tau_is,
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
            Some(kp_nm_rad) => self.setup.motor_with(self.at, &self.said, kp_nm_rad),
            None if is_driven_by_position => {
                return Err(ClampedCaseError::NoGain { file: self.setup.study.file.clone(), joint: name.clone() });
            }
            // Only its gears matter.
            None => self.setup.motor_with(self.at, &self.said, 0.0),
        };
        Case::of_arrays(joint, self.setup.study.sensor, Some(motor), self.uncertain(), arrays)
            .map_err(|source| ClampedCaseError::Joint { joint: name.clone(), source: Box::new(source) })
    }

    /// What is uncertain of this joint: inertia and moment by the masses of what it carries.
    fn uncertain(&self) -> Uncertain {
        let name = &self.mover.name;
        let all = &self.setup.study.uncertain;
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
