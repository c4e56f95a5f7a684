//! Faults that the catalogue does not have, as they alter the true robot and its setpoints.

use super::cause::RobotOutside;
use crate::blind::dice::Dice;
use crate::joint::{Contact, FrictionTerm};
use crate::number::math;
use crate::robot::simulate::{Column, Setpoints};
use crate::robot::{JointId, Nominal};
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// Frames for which lost setpoints stay away, least and most.
const LOST_FRAMES: [usize; 2] = [4, 14];

impl RobotOutside {
    /// Names and units of its numbers.
    pub(super) fn named(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Boot => &[("mass", "kg")],
            Self::TiltedTrunk => &[("tilt", "rad"), ("towards", "rad")],
            Self::CoarseSetpoints => &[("step", "rad")],
            Self::LostSetpoints => &[("losses", "per frame")],
            Self::SlowSetpoints => &[("time", "s")],
            Self::Cogging => &[("amplitude", "N m"), ("cogs", "1/rad")],
            Self::HotGear => &[("mu_g at the end", ""), ("end", "s")],
        }
    }
}

/// A fault with its numbers, ready to alter.
pub(super) struct Altered {
    pub outside: RobotOutside,
    pub joints: Vec<String>,
    pub values: Vec<f64>,
    pub seed: u64,
}

impl Altered {
    fn ids<'a>(&'a self, names: impl Iterator<Item = (JointId, String)> + 'a) -> impl Iterator<Item = JointId> + 'a {
        names.filter(|(_, name)| self.joints.contains(name)).map(|(id, _)| id)
    }

    /// Alters the robot.
    pub fn robot(&self, robot: &mut Nominal) {
        let names: Vec<(JointId, String)> =
            robot.model.joint_ids().zip(robot.model.joints()).map(|(id, joint)| (id, joint.name.clone())).collect();
        match self.outside {
            RobotOutside::TiltedTrunk => {
                let (tilt, towards) = (self.values[0], self.values[1]);
                let axis = Unit::new_normalize(Vector3::new(math::cos(towards), 0.0, math::sin(towards)));
                let turned = UnitQuaternion::from_axis_angle(&axis, tilt) * robot.model.gravity_m_s2();
                robot.model = robot.model.with_gravity(turned);
            }
            RobotOutside::Cogging | RobotOutside::HotGear => {
                for id in self.ids(names.into_iter()) {
                    let term: Box<dyn FrictionTerm<f64>> = match self.outside {
                        RobotOutside::Cogging => Box::new(Cogs { most_nm: self.values[0], cogs_1_rad: self.values[1] }),
                        _ => Box::new(Heat { share: self.values[0], end_s: self.values[1] }),
                    };
                    robot.joints.drive_mut(id).chain.friction.terms.push(term);
                }
            }
            _ => {}
        }
    }

    /// Alters setpoints on their way to the controllers.
    pub fn setpoints(&self, setpoints: &mut Setpoints) {
        let period_s = setpoints.t_s.windows(2).map(|w| w[1] - w[0]).next().unwrap_or(0.008);
        let model = crate::robot::Model::ers7();
        let names = model.joint_ids().zip(model.joints()).map(|(id, joint)| (id, joint.name.clone()));
        let mut lost = Lost { dice: Dice::new(self.seed, 0), share: self.values[0] };
        let is_lost: Vec<bool> = lost.frames(setpoints.t_s.len());
        for id in self.ids(names) {
            let Some(Some(column)) = setpoints.columns.get_mut(id.index()) else { continue };
            self.column(column, period_s, &is_lost);
        }
    }

    fn column(&self, column: &mut Column, period_s: f64, is_lost: &[bool]) {
        let angles = &mut column.angle_rad;
        match self.outside {
            RobotOutside::CoarseSetpoints => {
                let step = self.values[0];
                angles.iter_mut().for_each(|q| *q = (*q / step).round() * step);
            }
            RobotOutside::SlowSetpoints => {
                let share = 1.0 - math::exp(-period_s / self.values[0]);
                for k in 1..angles.len() {
                    angles[k] = angles[k - 1] + share * (angles[k] - angles[k - 1]);
                }
            }
            RobotOutside::LostSetpoints => {
                for k in 1..angles.len() {
                    if is_lost[k] {
                        angles[k] = angles[k - 1];
                    }
                }
            }
            _ => {}
        }
    }
}

/// Frames that get lost in bursts, for all joints of the fault at once.
struct Lost {
    dice: Dice,
    share: f64,
}

impl Lost {
    fn frames(&mut self, count: usize) -> Vec<bool> {
        let mut is_lost = vec![false; count];
        for k in 0..count {
            // The same draws at every share: more losses are added to those that are there.
            let (draw, frames) = (self.dice.uniform(0.0, 1.0), self.dice.whole(LOST_FRAMES[0], LOST_FRAMES[1]));
            if draw < self.share {
                is_lost[k..(k + frames).min(count)].fill(true);
            }
        }
        is_lost
    }
}

/// `a (1 + cos(n q))`
struct Cogs {
    most_nm: f64,
    cogs_1_rad: f64,
}

impl FrictionTerm<f64> for Cogs {
    fn resistance_nm(&self, at: &Contact<f64>) -> f64 {
        0.5 * self.most_nm * (1.0 + math::cos(self.cogs_1_rad * at.angle_rad))
    }

    fn slope_nm_s_rad(&self, _speed_rad_s: f64, _t_s: f64) -> f64 {
        0.0
    }
}

/// `mu_g |motor torque|`, growing from nothing in proportion to the time.
struct Heat {
    share: f64,
    end_s: f64,
}

impl FrictionTerm<f64> for Heat {
    fn resistance_nm(&self, at: &Contact<f64>) -> f64 {
        self.share * at.t_s / self.end_s * at.motor_nm.abs()
    }

    fn slope_nm_s_rad(&self, _speed_rad_s: f64, _t_s: f64) -> f64 {
        0.0
    }

    fn changes_with_time(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Hold;

    fn altered(outside: RobotOutside, value: f64) -> Vec<f64> {
        let model = crate::robot::Model::ers7();
        let t_s: Vec<f64> = (0..200).map(|k| 0.008 * f64::from(k)).collect();
        let asked: Vec<f64> = t_s.iter().map(|t| if *t > 0.4 { 0.33 } else { 0.0 }).collect();
        let column = || Some(Column { angle_rad: asked.clone(), on: None });
        let columns = model.joints().iter().map(|_| column()).collect();
        let mut setpoints = Setpoints { t_s, columns, hold: Hold::Linear };
        let fault = Altered { outside, joints: vec!["rf2".into()], values: vec![value], seed: 4 };
        fault.setpoints(&mut setpoints);
        let id = model.joint("rf2").unwrap();
        let others = setpoints.columns.iter().enumerate().filter(|(k, _)| *k != id.index());
        assert!(others.into_iter().all(|(_, column)| column.as_ref().unwrap().angle_rad == asked), "only its joint");
        setpoints.columns[id.index()].clone().unwrap().angle_rad
    }

    #[test]
    fn setpoints_are_coarse_slow_or_lost_in_the_joint_of_the_fault_only() {
        let coarse = altered(RobotOutside::CoarseSetpoints, 0.25);
        assert!(coarse.iter().all(|q| *q == 0.0 || *q == 0.25));
        let slow = altered(RobotOutside::SlowSetpoints, 0.1);
        // 63 % after the time constant, which begins at the frame before the step
        let at = (0.5 / 0.008) as usize;
        assert!((slow[at] / 0.33 - 0.63).abs() < 0.03, "{}", slow[at] / 0.33);
        let lost = altered(RobotOutside::LostSetpoints, 0.9);
        assert!(lost.iter().all(|q| *q == 0.0), "all but a few frames are lost");
    }
}
