//! Numbers that are never quite right: masses, friction and floor of a real robot are off by some percent everywhere.

use crate::robot::Model;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Standard deviation of a part's mass, as a share.
pub(super) const MASS: f64 = 0.03;
/// Of a joint's Coulomb and viscous friction.
pub(super) const FRICTION: f64 = 0.04;
/// Of the floor's stiffness, damping and friction.
pub(super) const FLOOR: f64 = 0.05;
/// No number is off by more than this factor.
const LEAST: f64 = 0.5;

/// Factors on the study's numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scatter {
    /// Of the masses, by body.
    pub mass: Vec<f64>,
    /// Of Coulomb and viscous friction, by joint.
    pub friction: Vec<[f64; 2]>,
    /// Of the floor's stiffness, damping and friction.
    pub floor: [f64; 3],
}

/// One of them.
#[derive(Clone, Copy, Debug)]
pub(super) enum Number {
    Mass(usize),
    Coulomb(usize),
    Viscous(usize),
}

impl Scatter {
    /// Moves a number by so many of its standard deviations.
    pub fn put(&mut self, number: Number, by_sd: f64) {
        let (factor, sd) = match number {
            Number::Mass(body) => (&mut self.mass[body], MASS),
            Number::Coulomb(joint) => (&mut self.friction[joint][0], FRICTION),
            Number::Viscous(joint) => (&mut self.friction[joint][1], FRICTION),
        };
        *factor = (*factor + sd * by_sd).max(LEAST);
    }

    pub fn none(model: &Model) -> Self {
        Self { mass: vec![1.0; model.bodies().len()], friction: vec![[1.0; 2]; model.joints().len()], floor: [1.0; 3] }
    }

    /// A robot drawn at random; the same number gives the same robot.
    pub fn drawn(model: &Model, number: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        let mut off = |sd: f64| {
            let (a, b): (f64, f64) = (rng.random(), rng.random());
            let normal = (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos();
            (1.0 + sd * normal).max(LEAST)
        };
        let mut scatter = Self::none(model);
        scatter.mass.iter_mut().for_each(|factor| *factor = off(MASS));
        scatter.friction.iter_mut().for_each(|factors| *factors = [off(FRICTION), off(FRICTION)]);
        scatter.floor.iter_mut().for_each(|factor| *factor = off(FLOOR));
        scatter
    }
}
