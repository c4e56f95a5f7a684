//! Numbers that are never quite right: masses, friction and floor of a real robot are off everywhere.

use super::case::RobotCase;
use crate::identify::Deviations;
use crate::joint::Reach;
use crate::log::Uncertain;
use crate::robot::Model;
use crate::robot::simulate::standard_normal;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Robots that are drawn to see how a walk changes with anything: standard deviations of masses and of the floor, relative,
/// and of friction. They probe how feet land, and are no beliefs.
const MASS: f64 = 0.03;
const FRICTION: f64 = 0.04;
pub(super) const FLOOR: f64 = 0.05;
/// No mass and no property of the floor is off by more than this factor.
const LEAST: f64 = 0.2;

/// By how much the study's numbers are off.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scatter {
    /// Factors of the masses, by body.
    pub mass: Vec<f64>,
    /// What Coulomb \[N m\] and viscous friction \[N m s/rad\] have more, by joint.
    pub friction: Vec<[f64; 2]>,
    /// Factors of the floor's stiffness, damping and friction.
    pub floor: [f64; 3],
}

/// One of the uncertain numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Mass(usize),
    Coulomb(usize),
    Viscous(usize),
}

/// Standard deviations of what the study states.
#[derive(Clone, Debug)]
pub(super) struct Spreads {
    /// Relative, by body.
    mass: Vec<f64>,
    /// Of Coulomb \[N m\] and viscous friction \[N m s/rad\], by joint.
    friction: Vec<[f64; 2]>,
}

impl Spreads {
    /// By `[uncertain]`, of joints that go so far.
    pub fn of(case: &RobotCase, reach: &[Reach]) -> Self {
        let model = case.model();
        let Uncertain { mass, friction, .. } = &case.study.uncertain;
        let joint = |(id, (name, reach)): (crate::robot::JointId, (&String, &Reach))| {
            let law = &case.nominal.joints.drive(id).chain.friction;
            let (share, least_nm) = (friction.of(name), Deviations::LEAST_FRICTION * reach.torque_nm);
            [
                Deviations::of_friction(share, law.coulomb_nm, least_nm),
                Deviations::of_friction(share, law.viscous_nm_s_rad, least_nm / reach.speed_rad_s),
            ]
        };
        Self {
            mass: model.bodies().iter().map(|body| mass.of(&body.name)).collect(),
            friction: model.joint_ids().zip(case.names.iter().zip(reach)).map(joint).collect(),
        }
    }

    /// Of a number; masses relative.
    pub fn sd(&self, number: Number) -> f64 {
        match number {
            Number::Mass(body) => self.mass[body],
            Number::Coulomb(joint) => self.friction[joint][0],
            Number::Viscous(joint) => self.friction[joint][1],
        }
    }
}

impl Scatter {
    /// Moves a number, masses relative.
    pub fn put(&mut self, number: Number, by: f64) {
        match number {
            Number::Mass(body) => self.mass[body] = (self.mass[body] + by).max(LEAST),
            Number::Coulomb(joint) => self.friction[joint][0] += by,
            Number::Viscous(joint) => self.friction[joint][1] += by,
        }
    }

    pub fn none(model: &Model) -> Self {
        let (bodies, joints) = (model.bodies().len(), model.joints().len());
        Self { mass: vec![1.0; bodies], friction: vec![[0.0; 2]; joints], floor: [1.0; 3] }
    }

    /// A robot drawn at random, of joints with such friction, on a floor that is off by such a share; the same number gives the
    /// same robot.
    pub fn drawn(model: &Model, friction: &[[f64; 2]], floor: f64, number: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        let mut off = |sd: f64| (1.0 + sd * standard_normal(&mut rng)).max(LEAST);
        let mut scatter = Self::none(model);
        scatter.mass.iter_mut().for_each(|factor| *factor = off(MASS));
        for (more, has) in scatter.friction.iter_mut().zip(friction) {
            *more = [(off(FRICTION) - 1.0) * has[0], (off(FRICTION) - 1.0) * has[1]];
        }
        scatter.floor.iter_mut().for_each(|factor| *factor = off(floor));
        scatter
    }
}
